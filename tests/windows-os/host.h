/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* host.h -- plain Win32 windows of a host, for the tests of surfaces: made, asked for their messages, rendered into.
 * Tests nothing by itself. Windows belong to the thread that makes them, which alone may destroy them. */
#ifndef BHR_WINDOWS_OS_HOST_H
#define BHR_WINDOWS_OS_HOST_H

#include "../c/check.h"

#include <windows.h>

/* A visible window without a frame, so that all of it is bhr's; NULL, and a failed check, where there is none. */
HWND        host_open(int x, int y, int width, int height);
BhrWindow   host_window(HWND window); /* without its HINSTANCE, as hosts with GLFW have it */
BhrSurface *host_surface(BhrContext *context, HWND window, uint32_t width, uint32_t height, BhrPresentMode mode);
void        host_pump(void); /* the messages of this thread's windows */
/* Renders until so many frames are in the window, or a minute is over. How many there were. */
int host_frames(BhrContext *context, BhrSurface *surface, int count);

/* A context that counts two kinds of messages: those of level ERROR (host_errors), and those that say that another
 * adapter than the context's, or none, presents to a window (host_detours). */
BhrContext *host_context(BhrBackend backend);
LONG        host_errors(void);
const char *host_last_error(void);
LONG        host_detours(void);

/* Writes the context's frame to a file, as RGBA8: the script compares the screen with it. */
void host_save_frame(BhrContext *context, uint32_t width, uint32_t height, const char *path);
/* Makes the file `shown`, and waits until somebody, who has looked at the screen, makes the file `go`. */
void host_wait_for_onlooker(const char *shown, const char *go);

#endif
