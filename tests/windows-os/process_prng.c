/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* process_prng.c -- a stand-in for Windows' bcryptprimitives.dll, of which Rust's standard library wants one function;
 * Wine has it from version 9 on. tests/windows-os/run puts it where Windows has its own, if there is none. */
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(void *buffer, ULONG length); /* RtlGenRandom, of advapi32.dll */

__declspec(dllexport) BOOL WINAPI ProcessPrng(BYTE *data, SIZE_T length) {
    while (length > 0) {
        ULONG part = length < 65536 ? (ULONG)length : 65536;
        if (!SystemFunction036(data, part)) return FALSE;
        data += part;
        length -= part;
    }
    return TRUE;
}
