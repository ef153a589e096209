/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* timing.c -- frames of 3840 x 2160 in RGBA16F by hand on a GPU, for tests/gpu/interop.sh: how long bhr_render_target
 * holds its thread, how long until its signal, both as a job too, and how long bhr_render_image takes; bytes equal;
 * another device that waits for bhr's timeline on the GPU and signals its own; LIGHT alone against LIGHT, DEPTH and SKY
 * in one frame; then many frames, with descriptors and memory counted. Arguments: vulkan [frames]; with 0 frames only
 * the cost of outputs. */
#include "share.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 3840u
#define HEIGHT 2160u
#define BYTES ((size_t)WIDTH * HEIGHT * 8)
#ifndef TIMED
#define TIMED 40
#endif

/* In us. */
static double now(void) {
    return seconds_now() * 1e6;
}

static int rising(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *times) {
    qsort(times, TIMED, sizeof *times, rising);
    return times[TIMED / 2];
}

static long resident(void) {
    long  pages = 0, all = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &all, &pages) != 2)
        pages = 0;
    if (file)
        fclose(file);
    return pages * 4;
}

static void timed(double spin) {
    static unsigned char *host_pixels, *seen;
    double                call[TIMED], signal[TIMED], memory[TIMED], job_call[TIMED], job_signal[TIMED];
    int                   fds[2] = {-1, -1};
    host_pixels = host_pixels ? host_pixels : malloc(BYTES);
    seen = seen ? seen : malloc(BYTES);
    CHECK_OK(bhr_set_spin(context, spin));
    BhrImage image = image_of(BHR_FORMAT_RGBA16F, WIDTH, HEIGHT, host_pixels, BYTES);
    CHECK_OK(bhr_prepare(context, &image));
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA16F, BHR_TARGET_BUFFER, WIDTH, HEIGHT, 0);
    BhrTarget       *target = share_make(&options);
    BhrSemaphore    *done = share_timeline(&fds[0]), *freed = NULL;
    VkPicture        picture = share_import(target, BYTES);
    uint64_t         value = 0;
    for (int i = -5; i < TIMED; i++) {
        BhrSemaphoreValue one = {done, ++value};
        BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &one};
        double            begin = now();
        CHECK_OK(bhr_render_target(context, target, &sync, NULL));
        double submitted = now();
        CHECK_OK(bhr_semaphore_wait(done, value, UINT64_MAX));
        if (i >= 0)
            call[i] = submitted - begin, signal[i] = now() - begin;
    }
    for (int i = -5; i < TIMED; i++) {
        BhrSemaphoreValue one = {done, ++value};
        BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &one};
        BhrJob           *job;
        double            begin = now();
        CHECK_OK(bhr_render_target_async(context, target, &sync, &job));
        double begun = now();
        CHECK_OK(bhr_semaphore_wait(done, value, UINT64_MAX));
        if (i >= 0)
            job_call[i] = begun - begin, job_signal[i] = now() - begin;
        CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
        bhr_job_destroy(job);
    }
    for (int i = -2; i < TIMED; i++) {
        double begin = now();
        CHECK_OK(bhr_render_image(context, &image));
        if (i >= 0)
            memory[i] = now() - begin;
    }
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, seen);
    CHECK(memcmp(seen, host_pixels, BYTES) == 0, "the bytes differ from those of bhr_render_image");
    printf("spin %.1f: the call %.0f us, until its signal %.0f us; as a job %.0f and %.0f us; ", spin, median(call),
           median(signal), median(job_call), median(job_signal));
    printf("bhr_render_image %.0f us\n", median(memory));
    if (fds[0] >= 0) {
        /* The other device waits for bhr on the GPU, and bhr for it. */
        freed = share_timeline(&fds[1]);
        VkSemaphore host_done = vk_import_semaphore(&host, VK_SEMAPHORE_TYPE_TIMELINE, fds[0]);
        VkSemaphore host_freed = vk_import_semaphore(&host, VK_SEMAPHORE_TYPE_TIMELINE, fds[1]);
        for (uint64_t i = 1; i <= 10; i++) {
            BhrSemaphoreValue wait = {freed, i - 1}, one = {done, ++value};
            BhrSync sync = {.struct_size = sizeof sync, .wait_count = i > 1, .signal_count = 1, .waits = &wait};
            VkTurn  turn = {host_done, host_freed, value, i, NULL, NULL};
            sync.signals = &one;
            CHECK_OK(bhr_render_target(context, target, &sync, NULL));
            vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, &turn, seen);
            CHECK(memcmp(seen, host_pixels, BYTES) == 0, "frame %u differs", (unsigned)i);
        }
        printf("timelines both ways: 10 frames\n");
        vkDestroySemaphore(host.device, host_done, NULL);
        vkDestroySemaphore(host.device, host_freed, NULL);
    }
    bhr_target_destroy(target);
    bhr_semaphore_destroy(done);
    bhr_semaphore_destroy(freed);
    vk_drop(&host, &picture);
}

/* Medians of frames of the first `count` outputs: on the GPU (0 without its clock), and until the signal; us. */
static void time_outputs(const BhrOutput *outputs, uint32_t count, double medians[2]) {
    BhrSemaphore *done;
    double        gpu[TIMED], signal[TIMED];
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &done));
    for (int i = -3; i < TIMED; i++) {
        uint64_t          value = (uint64_t)(i + 4);
        BhrSemaphoreValue one = {done, value};
        BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &one};
        BhrFrameStats     stats = {.struct_size = sizeof stats};
        BhrJob           *job;
        double            begin = now();
        CHECK_OK(bhr_render_outputs_shared(context, outputs, sizeof *outputs, count, &sync, &job));
        CHECK_OK(bhr_semaphore_wait(done, value, UINT64_MAX));
        double end = now();
        CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
        CHECK_OK(bhr_job_stats(job, &stats));
        bhr_job_destroy(job);
        if (i >= 0)
            gpu[i] = (double)stats.gpu_ns * 1e-3, signal[i] = end - begin;
    }
    medians[0] = median(gpu), medians[1] = median(signal);
    bhr_semaphore_destroy(done);
}

/* LIGHT in RGBA16F alone, and LIGHT, DEPTH and SKY: the latter is to take 1.4 times as long at most. */
static void outputs_cost(double spin, BhrTargetKind kind) {
    static const BhrFormat made[] = {BHR_FORMAT_RGBA16F, BHR_FORMAT_R32F, BHR_FORMAT_RGBA32F};
    static const BhrOutputKind kinds[] = {BHR_OUTPUT_LIGHT, BHR_OUTPUT_DEPTH, BHR_OUTPUT_SKY};
    BhrTarget                 *targets[3];
    BhrOutput                  outputs[3];
    double                     alone[2], three[2];
    CHECK_OK(bhr_set_spin(context, spin));
    for (int i = 0; i < 3; i++) {
        BhrTargetOptions options = share_options(made[i], kind, WIDTH, HEIGHT, 0);
        options.handle_type = 0;
        targets[i] = share_make(&options);
        CHECK_OK(bhr_output_init(&outputs[i], sizeof outputs[i]));
        outputs[i].kind = kinds[i];
        outputs[i].target = targets[i];
    }
    time_outputs(outputs, 1, alone);
    time_outputs(outputs, 3, three);
    printf("spin %.1f, %s: LIGHT %.0f us until its signal, with DEPTH and SKY %.0f us: %.2f times as long", spin,
           kind == BHR_TARGET_IMAGE ? "images" : "buffers", alone[1], three[1], three[1] / alone[1]);
    if (alone[0] > 0)
        printf("; on the GPU %.0f and %.0f us: %.2f times", alone[0], three[0], three[0] / alone[0]);
    printf("\n");
    for (int i = 0; i < 3; i++)
        bhr_target_destroy(targets[i]);
}

/* Frames by turns into two targets, two on their way; `value`: that of the last one. */
static void run_frames(BhrTarget *const *targets, BhrSemaphore *done, uint64_t *value, uint64_t count) {
    for (uint64_t i = 0; i < count; i++) {
        BhrSemaphoreValue one = {done, ++*value};
        BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &one};
        CHECK_OK(bhr_render_target(context, targets[*value % 2], &sync, NULL));
        if (*value > 2)
            CHECK_OK(bhr_semaphore_wait(done, *value - 2, UINT64_MAX));
    }
}

static void many(uint64_t frames) {
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA16F, BHR_TARGET_IMAGE, WIDTH, HEIGHT, 0);
    BhrTarget       *targets[2] = {share_make(&options), share_make(&options)};
    BhrSemaphore    *done;
    BhrFrameStats    first = {.struct_size = sizeof first}, last = {.struct_size = sizeof last};
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &done));
    /* Programs for likely changes of the scene are still made in the background, which takes memory: until none has
     * come for 3 s, or for a minute. */
    uint64_t value = 0;
    long     kib = 0;
    double   started = now();
    do {
        double round = now();
        kib = resident();
        while (now() < round + 3e6)
            run_frames(targets, done, &value, 1);
    } while (resident() > kib + 256 && now() < started + 60e6);
    int descriptors = open_descriptors();
    CHECK_OK(bhr_frame_stats(context, &first));
    kib = resident();
    double begin = now();
    run_frames(targets, done, &value, frames);
    CHECK_OK(bhr_semaphore_wait(done, value, UINT64_MAX));
    CHECK_OK(bhr_frame_stats(context, &last));
    printf("%llu frames, two on their way: %.0f us each; descriptors %d -> %d, resident %ld -> %ld KiB\n",
           (unsigned long long)frames, (now() - begin) / (double)frames, descriptors, open_descriptors(), kib,
           resident());
    CHECK(open_descriptors() == descriptors, "descriptors grow");
    CHECK(resident() < kib + 4096, "memory grows");
    /* Frames on their way have a few numbers each. */
    CHECK(last.device_bytes < first.device_bytes + 4096, "device memory grows");
    bhr_target_destroy(targets[0]);
    bhr_target_destroy(targets[1]);
    bhr_semaphore_destroy(done);
}

int main(int argc, char **argv) {
    BhrBackend        backend = check_begin(argc, argv);
    BhrContextOptions options = check_options(backend);
    /* The scene that hosts begin with, not the plain one of tests. */
    if (!CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &context)))
        return check_end();
    share_open(0);
    uint64_t frames = argc > 2 ? strtoull(argv[2], NULL, 10) : 10000;
    if (frames) {
        timed(0);
        timed(0.9);
    }
    for (int spin = 0; spin < 2; spin++) {
        outputs_cost(spin ? 0.9 : 0, BHR_TARGET_BUFFER);
        outputs_cost(spin ? 0.9 : 0, BHR_TARGET_IMAGE);
    }
    if (frames)
        many(frames);
    return share_end();
}
