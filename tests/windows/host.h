/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* host.h -- a host's X11 window for the tests of surfaces, by Xlib or by XCB, and what a person would see in it. Knows
 * bhr's image and window structs only; tests nothing by itself, but ends the program when there is no X server.
 *
 * Pixels on the screen are read through a connection of its own, as another program would, so that it can be asked for
 * whatever has become of the host's. */
#ifndef BHR_HOST_H
#define BHR_HOST_H

#include "../c/check.h"

#include <X11/Xlib.h>
#include <xcb/xcb.h>

typedef struct Host {
    BhrWindowKind     kind;       /* BHR_WINDOW_XLIB or _XCB */
    Display          *display;    /* Xlib's; NULL once it is closed */
    xcb_connection_t *connection; /* XCB's; NULL once it is closed */
    uint32_t          id;         /* 0 once it is destroyed */
} Host;

BhrWindowKind host_kind(const char *name); /* of a program's argument: xlib, xcb; ends the program for others */
/* A visible window of the server (NULL: that of DISPLAY) whose content nobody but bhr draws. */
Host      host_open(BhrWindowKind kind, const char *server, uint32_t width, uint32_t height);
void      host_new_window(Host *host, uint32_t width, uint32_t height); /* instead of the one it has */
BhrWindow host_window(const Host *host);
/* A window whose pixels have an alpha channel, by XCB; else as host_open's. */
Host      host_open_with_alpha(uint32_t width, uint32_t height);
void      host_show(const Host *host, int shown);
void      host_resize(const Host *host, uint32_t width, uint32_t height); /* returns when it has happened */
void      host_move(const Host *host, uint32_t x, uint32_t y);            /* from under another */
void      host_destroy_window(Host *host);
void      host_close(Host *host); /* the connection, and with it the window; both only once */

Host host_screen(void); /* all of DISPLAY's: to look at only */
int host_depth(const Host *host); /* bits of a pixel that count; 0 when it is gone */
int host_exists(uint32_t id); /* DISPLAY's server has a window of this number */
/* The window's width x height pixels as RGBA; 0 when it has no such part, or is gone. */
int host_grab(const Host *host, uint32_t width, uint32_t height, unsigned char *rgba);
/* Looks at the window until it shows these pixels, to `tolerance` 8-bit steps of each channel, for some seconds at
 * most. The largest difference of the last look; 999 when there was nothing to look at. */
int host_difference(const Host *host, uint32_t width, uint32_t height, const unsigned char *rgba, int tolerance);

/* A surface that must be made. */
BhrSurface *check_surface(BhrContext *context, const Host *host, uint32_t width, uint32_t height, BhrPresentMode mode);

/* Starts a thread, or ends the program. <pthread.h>'s types stay out of this header. */
typedef void *(*ThreadBody)(void *);
/* Returns when all have ended. */
void          run_threads(ThreadBody body, void *arguments, size_t argument_size, int count);

#endif
