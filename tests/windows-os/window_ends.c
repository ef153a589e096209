/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* window_ends.c -- several Win32 windows, and their ends: two windows of one context, each with a picture of its own;
 * a window that its thread resizes, or destroys, while another thread renders into it; context, surface, job and window
 * ended in every order there is.
 *
 *     window_ends BACKEND SHOWN GO LEFT RIGHT       writes what the two windows should show to LEFT and RIGHT, makes
 *                                                   the file SHOWN once they do, and goes on once GO is there
 */
#include "host.h"

#include <stdio.h>
#include <string.h>

enum { WIDTH = 240, HEIGHT = 150, ROUNDS = 8 };

static void look_from(BhrContext *context, double azimuth) {
    BhrCamera camera;
    BHR_INIT(camera);
    CHECK_OK(bhr_camera_orbit(&camera, 25.0, azimuth, 0.15));
    CHECK_OK(bhr_set_camera(context, &camera));
}

static void two_windows(BhrContext *context, char **files) {
    HWND        windows[2] = {host_open(40, 40, WIDTH, HEIGHT), host_open(320, 40, WIDTH, HEIGHT)};
    BhrSurface *surfaces[2];
    for (int i = 0; i < 2; i++) {
        surfaces[i] = host_surface(context, windows[i], WIDTH, HEIGHT, i ? BHR_PRESENT_MAILBOX : BHR_PRESENT_VSYNC);
        if (surfaces[i] == NULL) return;
    }
    for (int round = 0; round < 6; round++) {
        look_from(context, round % 2 * 1.5);
        int shown = host_frames(context, surfaces[round % 2], 1);
        CHECK(shown == 1, "no frame for window %d", round % 2);
    }
    for (int i = 0; i < 2; i++) {
        look_from(context, i * 1.5);
        host_save_frame(context, WIDTH, HEIGHT, files[2 + i]);
    }
    host_wait_for_onlooker(files[0], files[1]);
    CHECK(host_errors() == 0, "%ld errors in the log, the last: %s", (long)host_errors(), host_last_error());
    bhr_surface_destroy(surfaces[0]);
    DestroyWindow(windows[0]);
    int shown = host_frames(context, surfaces[1], 2);
    CHECK(shown == 2, "%d frames in the window that is left", shown);
    bhr_surface_destroy(surfaces[1]);
    DestroyWindow(windows[1]);
    host_pump();
}

/* ---- a thread that renders ---- */

typedef struct Renderer {
    BhrContext   *context;
    BhrSurface   *surface;
    volatile LONG frames, stops, size; /* size: the window's new one, width above 16 bits of height; 0: none */
    BhrStatus     last;                /* that the thread got */
} Renderer;

/* Frames until it is told to stop, or one fails. The surface gets a new size from this thread: the window's own thread
 * must not wait for a frame, as whoever presents may wait for that thread. */
static DWORD WINAPI renders(void *argument) {
    Renderer *renderer = argument;
    while (!renderer->stops) {
        uint32_t size = (uint32_t)InterlockedExchange(&renderer->size, 0);
        if (size != 0) CHECK_OK(bhr_surface_resize(renderer->surface, size >> 16, size & 0xffff));
        renderer->last = bhr_render_surface(renderer->context, renderer->surface);
        if (renderer->last < 0) break;
        if (renderer->last == BHR_OK) InterlockedIncrement(&renderer->frames);
    }
    return 0;
}

/* The window's thread pumps its messages meanwhile, as a host does: whoever presents may send it some, and wait. */
static int waits_for(HANDLE thread, DWORD most_ms) {
    ULONGLONG end = GetTickCount64() + most_ms;
    while (WaitForSingleObject(thread, 5) == WAIT_TIMEOUT) {
        host_pump();
        if (GetTickCount64() > end) return 0;
    }
    return 1;
}

static int pump_until(const Renderer *renderer, LONG frames) {
    for (int i = 0; i < 6000 && renderer->frames < frames && renderer->last >= 0; i++) {
        host_pump();
        Sleep(5);
    }
    return renderer->frames >= frames;
}

/* The window changes its size, or goes, at another moment of a frame in every round. */
static void changes_meanwhile(BhrContext *context, int round, int destroys) {
    HWND     window = host_open(40, 40, WIDTH, HEIGHT);
    Renderer renderer = {.context = context};
    renderer.surface = host_surface(context, window, WIDTH, HEIGHT, BHR_PRESENT_IMMEDIATE);
    if (renderer.surface == NULL) return;
    HANDLE thread = CreateThread(NULL, 0, renders, &renderer, 0, NULL);
    if (!CHECK(thread != NULL, "no thread: error %lu", GetLastError())) return;
    CHECK(pump_until(&renderer, 2), "round %d: no frames", round);
    Sleep((DWORD)(3 * round));
    if (destroys) {
        DestroyWindow(window);
        CHECK(waits_for(thread, 60000), "round %d: frames of a window that is gone", round);
    } else {
        SetWindowPos(window, NULL, 60, 60, WIDTH + 7 * round, HEIGHT - round, SWP_NOZORDER);
        InterlockedExchange(&renderer.size, (WIDTH + 7 * round) << 16 | (HEIGHT - round));
        CHECK(pump_until(&renderer, renderer.frames + 3), "round %d: no frames of the new size", round);
    }
    Sleep(20);
    renderer.stops = 1;
    CHECK(waits_for(thread, 60000), "round %d: the thread does not come back", round);
    CloseHandle(thread);
    CHECK(destroys ? renderer.last == BHR_ERROR_SURFACE_LOST : renderer.last >= 0, "round %d: %s", round,
          bhr_status_name(renderer.last));
    bhr_surface_destroy(renderer.surface);
    if (!destroys) DestroyWindow(window);
    host_pump();
    unsigned char pixels[24 * 16 * 4];
    BhrImage      image = image_of(BHR_FORMAT_RGBA8_SRGB, 24, 16, pixels, sizeof pixels);
    CHECK_OK(bhr_render_image(context, &image)); /* the context has lost nothing */
}

/* ---- orders ---- */

enum { THE_CONTEXT, THE_SURFACE, THE_JOB, THE_WINDOW, ENDS };
static const char *const names[ENDS] = {"context", "surface", "job", "window"};

static void ends_in(const int order[ENDS], BhrBackend backend) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    char                 said[64] = "";
    int                  alive[ENDS] = {1, 1, 1, 1};
    BhrContext          *context = check_context(backend);
    HWND                 window = host_open(40, 40, WIDTH, HEIGHT);
    BhrSurface          *surface = host_surface(context, window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    BhrJob              *job = NULL;
    if (surface == NULL) return;
    CHECK(host_frames(context, surface, 1) == 1, "no frame");
    CHECK_OK(bhr_render_image_async(context, &image, &job));
    for (int i = 0; i < ENDS; i++) {
        strcat(strcat(said, " "), names[order[i]]);
        switch (order[i]) {
            case THE_CONTEXT: bhr_context_destroy(context); break;
            case THE_SURFACE: bhr_surface_destroy(surface); break;
            case THE_JOB: bhr_job_destroy(job); break;
            default: DestroyWindow(window); break;
        }
        alive[order[i]] = 0;
        host_pump();
        if (alive[THE_CONTEXT] && alive[THE_SURFACE]) {
            BhrStatus status = bhr_render_surface(context, surface);
            CHECK(alive[THE_WINDOW] ? status >= 0 : status == BHR_ERROR_SURFACE_LOST, "after%s: %s: %s", said,
                  bhr_status_name(status), bhr_error_message());
        }
        if (alive[THE_SURFACE] && !alive[THE_CONTEXT])
            CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "", bhr_surface_resize(surface, 30, 20));
    }
}

static void every_order(BhrBackend backend) {
    int ran = 0;
    for (int i = 0; i < ENDS * ENDS * ENDS * ENDS; i++) {
        int order[ENDS] = {i % ENDS, i / ENDS % ENDS, i / (ENDS * ENDS) % ENDS, i / (ENDS * ENDS * ENDS)};
        int set = 0;
        for (int k = 0; k < ENDS; k++) set |= 1 << order[k];
        if (set != (1 << ENDS) - 1) continue;
        ends_in(order, backend);
        ran++;
    }
    CHECK(ran == 24, "%d orders", ran);
}

int main(int argc, char **argv) {
    BhrBackend backend = check_begin(argc, argv);
    if (argc != 6) return 2;
    BhrContext *context = host_context(backend);
    two_windows(context, argv + 2);
    for (int round = 0; round < ROUNDS; round++) {
        changes_meanwhile(context, round, 0);
        CHECK(host_errors() == 0, "%ld errors in the log, the last: %s", (long)host_errors(), host_last_error());
    }
    for (int round = 0; round < ROUNDS; round++) changes_meanwhile(context, round, 1);
    printf("%ld errors in the log where windows went first: %s\n", (long)host_errors(), host_last_error());
    bhr_context_destroy(context);
    every_order(backend);
    return check_end();
}
