/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* state.c -- what a host has set of its process and threads, as Windows has it: exceptions of floating point, rounding,
 * the filter of exceptions that nobody handles; and threads with the least stack that the header asks for.
 *
 *     state BACKEND
 */
#include "../c/check.h"

#include <float.h>
#include <string.h>
#include <windows.h>

enum { WIDTH = 64, HEIGHT = 36, LEAST_STACK = 512 * 1024 };

static BhrBackend backend;

static int frame(unsigned char *pixels) {
    BhrContextOptions options = check_options(backend);
    BhrContext       *context = NULL;
    BhrImage          image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, WIDTH * HEIGHT * 4);
    int               made = CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &context)) &&
               CHECK_OK(bhr_set_spin(context, 0.5)) && CHECK_OK(bhr_render_image(context, &image));
    bhr_context_destroy(context);
    return made;
}

static DWORD WINAPI on_little_stack(void *pixels) { return !frame(pixels); }

/* Exceptions are reported to the first of these; the library may raise none that reaches a host. */
static volatile LONG traps;
static LONG CALLBACK on_exception(EXCEPTION_POINTERS *about) {
    DWORD code = about->ExceptionRecord->ExceptionCode;
    if (code >= EXCEPTION_FLT_DENORMAL_OPERAND && code <= EXCEPTION_FLT_UNDERFLOW) InterlockedIncrement(&traps);
    return EXCEPTION_CONTINUE_SEARCH;
}
static LONG WINAPI filter(EXCEPTION_POINTERS *about) {
    (void)about;
    return EXCEPTION_CONTINUE_SEARCH;
}

int main(int argc, char **argv) {
    static unsigned char plain[WIDTH * HEIGHT * 4], same[sizeof plain];
    backend = check_begin(argc, argv);
    SetUnhandledExceptionFilter(filter);
    AddVectoredExceptionHandler(1, on_exception);
    if (!frame(plain)) return check_end();

    /* Exceptions trap but for inexact results, results are rounded up, subnormal numbers become zero. */
    _controlfp(_EM_INEXACT | _RC_UP | _DN_FLUSH, _MCW_EM | _MCW_RC | _MCW_DN);
    unsigned before = _controlfp(0, 0);
    int      made = frame(same);
    unsigned after = _controlfp(0, 0);
    _controlfp(_CW_DEFAULT, _MCW_EM | _MCW_RC | _MCW_DN);
    unsigned trapped = _EM_INVALID | _EM_ZERODIVIDE | _EM_OVERFLOW | _EM_UNDERFLOW;
    unsigned set = _MCW_RC | _MCW_DN;
    CHECK((before & trapped) == 0 && (before & set) == (_RC_UP | _DN_FLUSH), "the words were not set: %x", before);
    CHECK(before == after, "the words were %x, and are %x", before, after);
    CHECK(made && memcmp(plain, same, sizeof plain) == 0, "the frame is another one");
    CHECK(traps == 0, "%ld exceptions of floating point", (long)traps);

    for (int i = 0; i < 3; i++) {
        DWORD status = 1;
        memset(same, UNTOUCHED, sizeof same);
        HANDLE thread = CreateThread(NULL, LEAST_STACK, on_little_stack, same, STACK_SIZE_PARAM_IS_A_RESERVATION, NULL);
        if (!CHECK(thread != NULL, "no thread")) break;
        CHECK(WaitForSingleObject(thread, 120000) == WAIT_OBJECT_0, "the thread hangs");
        GetExitCodeThread(thread, &status);
        CloseHandle(thread);
        CHECK(status == 0 && memcmp(plain, same, sizeof plain) == 0, "on 512 KiB of stack: status %lu", status);
    }
    CHECK(SetUnhandledExceptionFilter(NULL) == filter, "the process has another filter of exceptions");
    return check_end();
}
