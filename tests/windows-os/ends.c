/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* ends.c -- the process ends while a job renders: Windows ends all other threads where they are, then tells the DLL.
 *
 *     ends BACKEND return|exit|thread|fast       main returns; exit() from main; ExitProcess from another thread;
 *                                                TerminateProcess
 *     ends BACKEND detach                        main returns, and a DLL of the host's then destroys job and context
 *
 * The exit status is 42, and the script sees to it that there is one.
 */
#include "../c/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

enum { WIDTH = 1280, HEIGHT = 720, STATUS = 42 };

static DWORD WINAPI ends_the_process(void *unused) {
    (void)unused;
    ExitProcess(STATUS);
}

static BhrContext *context;
static BhrJob     *job;

/* All other threads are gone: a call that waited for one would hang. */
static void destroys_all(void) {
    double part = 0.0;
    int    refused = bhr_job_wait(job, UINT64_MAX, &part) == BHR_ERROR_INVALID_STATE;
    bhr_job_cancel(job);
    bhr_job_destroy(job);
    refused &= bhr_set_spin(context, 0.5) == BHR_ERROR_INVALID_STATE;
    bhr_context_destroy(context);
    TerminateProcess(GetCurrentProcess(), refused ? STATUS : STATUS + 1);
}

static int hears_of_the_end(void) {
    typedef void (*AtDetach)(void (*)(void));
    HMODULE  dll = LoadLibraryA("at_detach.dll");
    FARPROC  found = dll ? GetProcAddress(dll, "at_detach") : NULL;
    AtDetach at_detach;
    if (!CHECK(found != NULL, "at_detach.dll is not there")) return 0;
    memcpy(&at_detach, &found, sizeof at_detach);
    at_detach(destroys_all);
    return 1;
}

int main(int argc, char **argv) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    if (argc != 3) return 2;
    context = check_context(check_begin(argc, argv));
    BhrImage   image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    BhrQuality quality;
    BHR_INIT(quality);
    quality.samples_per_pixel = 16; /* so that it takes longer than this program */
    CHECK_OK(bhr_set_quality(context, &quality));
    CHECK_OK(bhr_render_image_async(context, &image, &job));
    pause_ms(100);
    double    part = 0.0;
    BhrStatus status = bhr_job_wait(job, 0, &part);
    CHECK(status == BHR_NOT_READY, "the job is over already: %s", bhr_status_name(status));
    int detaches = !strcmp(argv[2], "detach") && hears_of_the_end();
    if (check_end() != EXIT_SUCCESS) return 1;
    fflush(stdout);
    if (!strcmp(argv[2], "exit")) exit(STATUS);
    if (!strcmp(argv[2], "thread")) {
        CreateThread(NULL, 0, ends_the_process, NULL, 0, NULL);
        Sleep(INFINITE);
    }
    if (!strcmp(argv[2], "fast")) TerminateProcess(GetCurrentProcess(), STATUS);
    return detaches ? 1 : STATUS;
}
