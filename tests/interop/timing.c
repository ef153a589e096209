/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* timing.c -- frames of 3840 x 2160 in RGBA16F by hand on a GPU, for tests/gpu/interop.sh: how long bhr_render_target
 * holds its thread, how long until its signal, and how long bhr_render_image takes; bytes equal; another device that
 * waits for bhr's timeline on the GPU and signals its own; then many frames, with descriptors and memory counted.
 * Arguments: vulkan [frames]. */
#include "../c/check.h"
#include "vk.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define WIDTH 3840u
#define HEIGHT 2160u
#define BYTES ((size_t)WIDTH * HEIGHT * 8)
#define TIMED 40

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec * 1e6 + (double)time.tv_nsec * 1e-3;
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

static VkSemaphore imported(Vk *host, BhrSemaphore *semaphore) {
    BhrHandle   handle;
    VkSemaphore made = vk_timeline(host);
    CHECK_OK(bhr_semaphore_export(semaphore, &handle));
    VkImportSemaphoreFdInfoKHR import = {.sType = VK_STRUCTURE_TYPE_IMPORT_SEMAPHORE_FD_INFO_KHR,
                                         .semaphore = made,
                                         .handleType = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT,
                                         .fd = handle.fd};
    VK(host->import_semaphore_fd(host->device, &import));
    return made;
}

static void timed(BhrContext *context, double spin) {
    static unsigned char *host_pixels, *seen;
    BhrTargetOptions      options;
    BhrTargetInfo         info = {.struct_size = sizeof info};
    BhrInteropInfo        can = {.struct_size = sizeof can};
    BhrTarget            *target;
    BhrSemaphore         *done, *freed = NULL;
    BhrHandle             handle;
    Vk                    host;
    BhrImage              image;
    double                call[TIMED], signal[TIMED], memory[TIMED];
    host_pixels = host_pixels ? host_pixels : malloc(BYTES);
    seen = seen ? seen : malloc(BYTES);
    CHECK_OK(bhr_set_spin(context, spin));
    CHECK_OK(bhr_image_init(&image, sizeof image));
    image.format = BHR_FORMAT_RGBA16F;
    image.width = WIDTH;
    image.height = HEIGHT;
    image.pixels = host_pixels;
    image.byte_size = BYTES;
    CHECK_OK(bhr_prepare(context, &image));
    CHECK_OK(bhr_interop_info(context, &can));
    CHECK_OK(bhr_target_options_init(&options, sizeof options));
    options.kind = BHR_TARGET_BUFFER;
    options.format = BHR_FORMAT_RGBA16F;
    options.width = WIDTH;
    options.height = HEIGHT;
    options.handle_type = BHR_HANDLE_OPAQUE_FD;
    CHECK_OK(bhr_target_create(context, &options, &target));
    CHECK_OK(bhr_target_info(target, &info));
    CHECK_OK(bhr_target_export(target, &handle));
    int shared = (can.semaphores[BHR_SEMAPHORE_TIMELINE] & BHR_HANDLE_OPAQUE_FD) != 0;
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, shared ? BHR_HANDLE_OPAQUE_FD : 0, &done));
    vk_open_instance(&host, can.device_uuid, VK_API_VERSION_1_3, 0);
    vk_open_device(&host);
    VkPicture picture = vk_import(&host, &info, handle.fd, BYTES);
    uint64_t  value = 0;
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
    for (int i = -2; i < TIMED; i++) {
        double begin = now();
        CHECK_OK(bhr_render_image(context, &image));
        if (i >= 0)
            memory[i] = now() - begin;
    }
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, BYTES, NULL, seen);
    CHECK(memcmp(seen, host_pixels, BYTES) == 0, "the bytes differ from those of bhr_render_image");
    printf("spin %.1f: the call %.0f us, until its signal %.0f us; bhr_render_image %.0f us\n", spin, median(call),
           median(signal), median(memory));
    if (shared) {
        /* The other device waits for bhr on the GPU, and bhr for it. */
        CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, BHR_HANDLE_OPAQUE_FD, &freed));
        VkSemaphore host_done = imported(&host, done), host_freed = imported(&host, freed);
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
    vk_close(&host);
}

static void many(BhrContext *context, uint64_t frames) {
    BhrTargetOptions options;
    BhrTarget       *targets[2];
    BhrSemaphore    *done;
    BhrFrameStats    first = {.struct_size = sizeof first}, last = {.struct_size = sizeof last};
    CHECK_OK(bhr_target_options_init(&options, sizeof options));
    options.format = BHR_FORMAT_RGBA16F;
    options.width = WIDTH;
    options.height = HEIGHT;
    options.handle_type = BHR_HANDLE_OPAQUE_FD;
    CHECK_OK(bhr_target_create(context, &options, &targets[0]));
    CHECK_OK(bhr_target_create(context, &options, &targets[1]));
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &done));
    int    descriptors = 0;
    long   kib = 0;
    double begin = now();
    for (uint64_t i = 1; i <= frames; i++) {
        BhrSemaphoreValue one = {done, i};
        BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &one};
        CHECK_OK(bhr_render_target(context, targets[i % 2], &sync, NULL));
        if (i > 2)
            CHECK_OK(bhr_semaphore_wait(done, i - 2, UINT64_MAX));
        if (i == frames / 10)
            descriptors = open_descriptors(), kib = resident(), bhr_frame_stats(context, &first);
    }
    CHECK_OK(bhr_semaphore_wait(done, frames, UINT64_MAX));
    CHECK_OK(bhr_frame_stats(context, &last));
    printf("%llu frames, two on their way: %.0f us each; descriptors %d -> %d, resident %ld -> %ld KiB\n",
           (unsigned long long)frames, (now() - begin) / (double)frames, descriptors, open_descriptors(), kib,
           resident());
    CHECK(open_descriptors() == descriptors, "descriptors grow");
    CHECK(resident() < kib + 4096, "memory grows");
    CHECK(last.device_bytes == first.device_bytes, "device memory grows");
    bhr_target_destroy(targets[0]);
    bhr_target_destroy(targets[1]);
    bhr_semaphore_destroy(done);
}

int main(int argc, char **argv) {
    BhrBackend        backend = check_begin(argc, argv);
    BhrContextOptions options = check_options(backend);
    BhrContext       *context = NULL;
    if (!CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &context)))
        return check_end();
    timed(context, 0);
    timed(context, 0.9);
    many(context, argc > 2 ? strtoull(argv[2], NULL, 10) : 10000);
    bhr_context_destroy(context);
    return check_end();
}
