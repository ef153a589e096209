/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* growth.c -- many frames of a moving camera, into a window and into memory by jobs, and many windows: after a warm-up
 * the process holds no more memory (to max_growth, resident and of the heap), descriptors or threads than before. A
 * device's driver counts, too: software drivers once leaked with every submission (shaders/shared/not_inlined.wgsl).
 *
 *     growth BACKEND xlib|xcb [FRAMES [JOBS]] */
#define _POSIX_C_SOURCE 200809L

#include "host.h"

#include <dirent.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define WIDTH 64u
#define HEIGHT 48u
#define BYTES (WIDTH * HEIGHT * 4u)
#define FLIGHT 3 /* jobs under way at once */

static long max_growth = 20L << 20;

/* ---- what the process holds ---- */

typedef struct Holding {
    long bytes; /* of memory of its own, resident */
    long taken; /* from the heap, resident already or not, and not given back; 0 where the C library does not say */
    int  descriptors, threads;
} Holding;

/* Entries of a folder. */
static int entries(const char *path) {
    int  count = 0;
    DIR *folder = opendir(path);
    while (folder != NULL && readdir(folder) != NULL) {
        count++;
    }
    if (folder != NULL) {
        closedir(folder);
    }
    return count;
}

static Holding look(void) {
    Holding holding = {0, 0, entries("/proc/self/fd"), entries("/proc/self/task")};
    long    total = 0, resident = 0, of_files = 0;
    FILE   *file = fopen("/proc/self/statm", "r");
    if (file != NULL) {
        /* Pages of files, such as those of the driver's compiler, come and go as the kernel likes. */
        if (fscanf(file, "%ld %ld %ld", &total, &resident, &of_files) == 3) {
            holding.bytes = (resident - of_files) * sysconf(_SC_PAGESIZE);
        }
        fclose(file);
    }
#ifdef __GLIBC__
    const struct mallinfo2 heap = mallinfo2();
    holding.taken = (long)(heap.uordblks + heap.hblkhd);
#endif
    CHECK(holding.bytes > 0 && holding.descriptors > 0 && holding.threads > 0, "no /proc to look at");
    return holding;
}

static void check_growth(Holding before, const char *what, int frames) {
    const Holding after = look();
    printf("%s: %ld KiB, %d descriptors, %d threads before; %+ld KiB, %+d, %+d after %d frames\n", what,
           before.bytes >> 10, before.descriptors, before.threads, (after.bytes - before.bytes) / 1024,
           after.descriptors - before.descriptors, after.threads - before.threads, frames);
    CHECK(after.bytes - before.bytes < max_growth, "%s: grew by %ld KiB; less than %ld are granted", what,
          (after.bytes - before.bytes) / 1024, max_growth / 1024);
    CHECK(after.taken - before.taken < max_growth, "%s: took %ld KiB more of the heap; less than %ld are granted", what,
          (after.taken - before.taken) / 1024, max_growth / 1024);
    printf("%s: %+ld KiB of the heap\n", what, (after.taken - before.taken) / 1024);
    CHECK(after.descriptors <= before.descriptors, "%s: %d descriptors became %d", what, before.descriptors,
          after.descriptors);
    CHECK(after.threads <= before.threads, "%s: %d threads became %d", what, before.threads, after.threads);
}

/* ---- frames ---- */

/* Moves the camera to another place at every frame, round the hole and in and out, without spin and with it by
 * turns: nothing that one frame has made serves the next. */
static void move_camera(BhrContext *context, int frame) {
    BhrCamera camera;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    CHECK_OK(bhr_camera_orbit(&camera, 20.0 + frame % 97 * 0.1, 0.02 * frame, 0.3));
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_spin(context, frame % 2 == 0 ? 0.0 : 0.5));
}

static void present(BhrContext *context, BhrSurface *surface, int first, int count) {
    for (int i = first; i < first + count; i++) {
        move_camera(context, i);
        CHECK_OK(bhr_render_surface(context, surface));
    }
}

/* The oldest of FLIGHT jobs is waited for before the next is begun. */
static void run_jobs(BhrContext *context, int count) {
    static unsigned char pixels[FLIGHT][BYTES];
    BhrJob              *jobs[FLIGHT] = {NULL};
    for (int i = 0; i < count + FLIGHT; i++) {
        BhrJob        **job = &jobs[i % FLIGHT];
        const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels[i % FLIGHT], BYTES);
        if (*job != NULL) {
            CHECK_OK(bhr_job_wait(*job, UINT64_MAX, NULL));
            bhr_job_destroy(*job);
            *job = NULL;
        }
        if (i < count) {
            move_camera(context, i);
            CHECK_OK(bhr_render_image_async(context, &target, job));
        }
    }
}

/* Windows that come, change and go, each with a surface. */
static void run_surfaces(BhrContext *context, BhrWindowKind kind, int count) {
    for (int i = 0; i < count; i++) {
        Host        host = host_open(kind, NULL, WIDTH, HEIGHT);
        BhrSurface *surface = check_surface(context, &host, WIDTH, HEIGHT, (BhrPresentMode)(i % 3));
        present(context, surface, i, 2);
        host_resize(&host, WIDTH + 9, HEIGHT + 5);
        CHECK_OK(bhr_surface_resize(surface, WIDTH + 9, HEIGHT + 5));
        present(context, surface, i, 2);
        if (i % 2 == 0) { /* either may go first */
            host_close(&host);
        }
        bhr_surface_destroy(surface);
        host_close(&host);
    }
}

int main(int argc, char **argv) {
    const BhrBackend    backend = check_begin(argc, argv);
    const BhrWindowKind kind = host_kind(argc > 2 ? argv[2] : NULL);
    const int           frames = argc > 3 ? atoi(argv[3]) : 5000, jobs = argc > 4 ? atoi(argv[4]) : 1000;
    BhrContext         *context = check_context(backend);
    const int           few = frames < 5000, warm_up = few ? frames / 4 : 500, surfaces = few ? 14 : 100;
    Host                host = host_open(kind, NULL, WIDTH, HEIGHT);
    BhrSurface         *surface = check_surface(context, &host, WIDTH, HEIGHT, BHR_PRESENT_IMMEDIATE);
    if (few) {
        max_growth = 2L << 20; /* the bound of thousands of frames would be met by no leak of some hundred */
    }
    present(context, surface, 0, warm_up);
    Holding before = look();
    present(context, surface, warm_up, frames);
    check_growth(before, "window", frames);

    run_jobs(context, warm_up);
    before = look();
    run_jobs(context, jobs);
    check_growth(before, "jobs", jobs);

    run_surfaces(context, kind, surfaces / 2);
    before = look();
    run_surfaces(context, kind, surfaces);
    check_growth(before, "surfaces", surfaces);

    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
    host_close(&host);
    return check_end();
}
