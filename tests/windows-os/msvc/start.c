/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* start.c -- a C run-time library of two functions for hole.c, where Microsoft's is not at hand: it starts the program,
 * and prints. */
#include "stdio.h"

__declspec(dllimport) __declspec(noreturn) void ExitProcess(unsigned status);
__declspec(dllimport) void *GetStdHandle(unsigned which);
__declspec(dllimport) int WriteFile(void *file, const void *bytes, unsigned size, unsigned *written, void *unused);

int       main(void);
TestFile *stderr_file;
int       _fltused = 1; /* every object that computes with floating point asks for it */

/* hole.c prints one string. */
int fprintf(TestFile *file, const char *format, ...) {
    __builtin_va_list arguments;
    unsigned          written, length = 0;
    __builtin_va_start(arguments, format);
    const char *text = __builtin_va_arg(arguments, const char *);
    __builtin_va_end(arguments);
    (void)file;
    while (text[length]) length++;
    WriteFile(GetStdHandle((unsigned)-12), text, length, &written, 0);
    return (int)length;
}

void mainCRTStartup(void) { ExitProcess((unsigned)main()); }
