/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* at_detach.c -- a DLL of a host's that does something as the process ends, as destructors of its static objects would.
 */
#include <windows.h>

typedef void (*Handler)(void);

static Handler handler;

__declspec(dllexport) void at_detach(Handler it) { handler = it; }

BOOL WINAPI DllMain(HINSTANCE dll, DWORD reason, LPVOID ends) {
    (void)dll;
    if (reason == DLL_PROCESS_DETACH && ends && handler) handler();
    return TRUE;
}
