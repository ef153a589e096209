/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* stdio.h -- as much of it as hole.c needs, for the ABI of Microsoft's compiler, whose own headers no distribution may
 * pass on. start.c has the functions. */
#ifndef BHR_TEST_STDIO_H
#define BHR_TEST_STDIO_H
typedef struct TestFile TestFile;
extern TestFile        *stderr_file;
#define stderr stderr_file
int fprintf(TestFile *file, const char *format, ...);
#endif
