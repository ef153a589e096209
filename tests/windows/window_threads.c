/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* window_threads.c -- windows and threads: frames from another thread than the creator's, two threads on one surface,
 * two surfaces of one context, jobs beside frames, sizes and modes changed meanwhile. Afterwards every window shows the
 * picture that it should, and every job has its own.
 *
 *     window_threads BACKEND xlib|xcb [ROUNDS, to 90] */
#include "host.h"

#include <stdlib.h>
#include <string.h>

#define WIDTH 96u
#define HEIGHT 64u
#define BYTES (WIDTH * HEIGHT * 4u)

static uint32_t rounds = 40; /* frames of each thread in each test */

static unsigned char expected[BYTES]; /* the scene that all of these render */

typedef struct Task {
    BhrContext *context;
    BhrSurface *surface;
    const Host *host;
} Task;

static void check_shows(const Host *host, const char *what) {
    const int difference = host_difference(host, WIDTH, HEIGHT, expected, 1);
    CHECK(difference <= 1, "%s: the window differs by %d steps", what, difference);
}

/* ---- what threads do ---- */

static void *present(void *argument) {
    const Task *task = argument;
    for (uint32_t round = 0; round < rounds; round++) {
        const BhrStatus status = bhr_render_surface(task->context, task->surface);
        CHECK(status == BHR_OK || status == BHR_FRAME_SKIPPED, "%s: %s", bhr_status_name(status), bhr_error_message());
    }
    return NULL;
}

static void *present_and_resize(void *argument) {
    const Task *task = argument;
    for (uint32_t round = 0; round < rounds; round++) {
        CHECK_OK(bhr_surface_resize(task->surface, WIDTH - round, HEIGHT));
        const BhrStatus status = bhr_render_surface(task->context, task->surface);
        CHECK(status == BHR_OK || status == BHR_FRAME_SKIPPED, "%s: %s", bhr_status_name(status), bhr_error_message());
        CHECK_OK(bhr_surface_set_present_mode(task->surface, (BhrPresentMode)(round % 3)));
    }
    return NULL;
}

/* Changes the window itself, too: its connection is used by this thread only meanwhile. */
static void *resize_window(void *argument) {
    const Task *task = argument;
    for (uint32_t round = 0; round < rounds; round++) {
        host_resize(task->host, WIDTH + 3 * round, HEIGHT + round);
        CHECK_OK(bhr_surface_resize(task->surface, WIDTH + 3 * round, HEIGHT + round));
        pause_ms(3);
    }
    host_resize(task->host, WIDTH, HEIGHT);
    CHECK_OK(bhr_surface_resize(task->surface, WIDTH, HEIGHT));
    return NULL;
}

static void *render_jobs(void *argument) {
    const Task   *task = argument;
    unsigned char pixels[3][BYTES];
    BhrJob       *jobs[3];
    for (uint32_t round = 0; round < rounds / 2; round++) {
        for (int i = 0; i < 3; i++) {
            const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels[i], BYTES);
            memset(pixels[i], UNTOUCHED, BYTES);
            if (!CHECK_OK(bhr_render_image_async(task->context, &target, &jobs[i]))) {
                return NULL;
            }
        }
        for (int i = 2; i >= 0; i--) {
            CHECK_OK(bhr_job_wait(jobs[i], UINT64_MAX, NULL));
            CHECK(memcmp(pixels[i], expected, BYTES) == 0, "a job beside windows differs");
            bhr_job_destroy(jobs[i]);
        }
    }
    return NULL;
}

static void *render_images(void *argument) {
    const Task    *task = argument;
    unsigned char  pixels[BYTES];
    const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
    for (uint32_t round = 0; round < rounds / 2; round++) {
        CHECK_OK(bhr_render_image(task->context, &target));
        CHECK(memcmp(pixels, expected, BYTES) == 0, "an image beside windows differs");
    }
    return NULL;
}

static void *destroy(void *argument) {
    bhr_surface_destroy(((Task *)argument)->surface);
    return NULL;
}

/* Threads that do different things: each has one of these. */
typedef struct Different {
    ThreadBody body;
    Task       task;
} Different;

static void *do_different(void *argument) {
    Different *different = argument;
    return different->body(&different->task);
}

/* ---- tests ---- */

/* A clean end: one frame from this thread, and the window shows it. */
static void settle(Task *task, const char *what) {
    BhrStatus status = BHR_FRAME_SKIPPED;
    CHECK_OK(bhr_surface_resize(task->surface, WIDTH, HEIGHT));
    for (int i = 0; i < 4 && status == BHR_FRAME_SKIPPED; i++) {
        status = bhr_render_surface(task->context, task->surface);
    }
    CHECK(status == BHR_OK, "%s: %s: %s", what, bhr_status_name(status), bhr_error_message());
    check_shows(task->host, what);
}

static void one_surface(Task *task) {
    Task tasks[2] = {*task, *task};
    run_threads(present, tasks, sizeof *tasks, 1);
    settle(task, "another thread than the creator's");
    run_threads(present, tasks, sizeof *tasks, 2);
    settle(task, "two threads on one surface");
    run_threads(present_and_resize, tasks, sizeof *tasks, 2);
    settle(task, "two threads that resize one surface");
    Different different[2] = {{present, *task}, {resize_window, *task}};
    run_threads(do_different, different, sizeof *different, 2);
    settle(task, "a window resized while its frames are rendered");
}

static void two_surfaces(Task *task, BhrWindowKind kind) {
    Host second_host = host_open(kind, NULL, WIDTH, HEIGHT);
    host_move(&second_host, 800, 400);
    Task second = {task->context, check_surface(task->context, &second_host, WIDTH, HEIGHT, BHR_PRESENT_MAILBOX),
                   &second_host};
    Different different[4] = {{present, *task}, {present, second}, {render_jobs, *task}, {render_images, *task}};
    run_threads(do_different, different, sizeof *different, 4);
    settle(task, "the first of two windows");
    settle(&second, "the second of two windows");
    run_threads(destroy, &second, sizeof second, 1);
    settle(task, "the window that is left");
    host_close(&second_host);
}

/* A context and a surface each, on two threads that know nothing of each other. */
static void two_contexts(Task *task, BhrBackend backend, BhrWindowKind kind) {
    Host second_host = host_open(kind, NULL, WIDTH, HEIGHT);
    host_move(&second_host, 800, 400);
    Task second = {check_context(backend), NULL, &second_host};
    second.surface = check_surface(second.context, &second_host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    Different different[4] = {{present, *task}, {present, second}, {render_jobs, second}, {render_jobs, *task}};
    run_threads(do_different, different, sizeof *different, 4);
    settle(task, "the first context's window");
    settle(&second, "the second context's window");
    bhr_surface_destroy(second.surface);
    bhr_context_destroy(second.context);
    host_close(&second_host);
}

int main(int argc, char **argv) {
    const BhrBackend    backend = check_begin(argc, argv);
    const BhrWindowKind kind = host_kind(argc > 2 ? argv[2] : NULL);
    if (argc > 3) {
        rounds = (uint32_t)atoi(argv[3]);
    }
    BhrContext         *context = check_context(backend);
    Host                host = host_open(kind, NULL, WIDTH, HEIGHT);
    const BhrImage      image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, expected, BYTES);
    CHECK_OK(bhr_render_image(context, &image));
    Task task = {context, check_surface(context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC), &host};
    one_surface(&task);
    two_surfaces(&task, kind);
    two_contexts(&task, backend, kind);
    run_threads(destroy, &task, sizeof task, 1);
    bhr_context_destroy(context);
    host_close(&host);
    return check_end();
}
