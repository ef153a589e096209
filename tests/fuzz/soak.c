/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* soak.c -- frames of ever-changing scenes in one context, and jobs between them: memory, descriptors and threads of
 * the process do not grow. Linux only.
 *
 *     soak BACKEND FRAMES
 */
#define _POSIX_C_SOURCE 200809L

#include <bhr.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 32u
#define HEIGHT 18u
#define WARM 400u /* frames after which everything has been made once, and half of the frames at most */

static unsigned char pixels[WIDTH * HEIGHT * 16];

static void must(BhrStatus status) {
    if (status < 0) {
        fprintf(stderr, "%s\n", bhr_error_message());
        exit(1);
    }
}

static unsigned entries(const char *path) {
    unsigned count = 0;
    DIR     *folder = opendir(path);
    while (folder != NULL && readdir(folder) != NULL) {
        count++;
    }
    if (folder != NULL) {
        closedir(folder);
    }
    return count;
}

static long resident_kb(void) {
    long  all = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file == NULL || fscanf(file, "%ld %ld", &all, &resident) != 2) {
        resident = 0;
    }
    if (file != NULL) {
        fclose(file);
    }
    return resident * 4;
}

/* The scene of frame n: spin, camera, disk, looks, views, sizes and methods change, each with a period of its own. */
static void frame(BhrContext *context, unsigned n) {
    static const BhrFormat FORMATS[] = {BHR_FORMAT_RGBA8_SRGB, BHR_FORMAT_BGRA8_SRGB, BHR_FORMAT_RGBA16F,
                                        BHR_FORMAT_RGBA32F};
    BhrCamera  camera;
    BhrDisk    disk;
    BhrQuality quality;
    BhrImage   image;
    must(bhr_set_preset(context, (BhrPreset)(n % 7 % 4)));
    must(bhr_set_spin(context, n % 3 == 0 ? 0.0 : (double)(n % 199) / 200.0));
    must(bhr_set_time(context, (double)n));
    bhr_camera_init(&camera, sizeof camera);
    must(bhr_camera_orbit(&camera, 5.0 + n % 37, 0.01 * n, 0.02 * (n % 70)));
    camera.motion = n % 11 == 0 ? BHR_MOTION_FREE_FALL : BHR_MOTION_STATIC;
    must(bhr_set_camera(context, &camera));
    bhr_disk_init(&disk, sizeof disk);
    disk.turbulence = n % 5 == 0 ? 0.0 : 1.0, disk.seed = n;
    must(bhr_set_disk(context, n % 13 == 0 ? NULL : &disk));
    bhr_quality_init(&quality, sizeof quality);
    quality.method = n % 17 == 0 ? BHR_METHOD_RK4 : BHR_METHOD_AUTO;
    must(bhr_set_quality(context, &quality));
    bhr_image_init(&image, sizeof image);
    image.width = WIDTH - n % 5, image.height = HEIGHT - n % 3;
    image.format = FORMATS[n % 19 % 4];
    image.pixels = pixels, image.byte_size = sizeof pixels;
    if (n % 4 != 0) {
        must(bhr_render_image(context, &image));
        return;
    }
    BhrJob *job;
    must(bhr_render_image_async(context, &image, &job));
    if (n % 8 == 0) {
        bhr_job_cancel(job);
    } else {
        must(bhr_job_wait(job, UINT64_MAX, NULL));
    }
    bhr_job_destroy(job);
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fprintf(stderr, "usage: %s cpu|vulkan FRAMES\n", argv[0]);
        return 2;
    }
    const unsigned    frames = (unsigned)strtoul(argv[2], NULL, 10), warm = frames / 2 < WARM ? frames / 2 : WARM;
    BhrContextOptions options;
    BhrContext       *context;
    unsigned          descriptors = 0, threads = 0;
    long              resident = 0;
    bhr_context_options_init(&options, sizeof options);
    options.backend = strcmp(argv[1], "vulkan") == 0 ? BHR_BACKEND_VULKAN : BHR_BACKEND_CPU;
    must(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    for (unsigned n = 0; n < frames; n++) {
        if (n == warm) {
            descriptors = entries("/proc/self/fd"), threads = entries("/proc/self/task"), resident = resident_kb();
        }
        frame(context, n);
    }
    const long     grown = resident_kb() - resident;
    const unsigned more_descriptors = entries("/proc/self/fd"), more_threads = entries("/proc/self/task");
    bhr_context_destroy(context);
    printf("%u frames: %+ld KB, descriptors %u to %u, threads %u to %u\n", frames, grown, descriptors, more_descriptors,
           threads, more_threads);
    /* Software drivers keep programs; an allocator's arenas settle late. What leaks in a frame shows in many. */
    return grown > 60000 || more_descriptors > descriptors + 2 || more_threads > threads + 2;
}
