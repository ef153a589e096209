/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* shared.c -- targets in shared memory: another VkDevice on the same GPU reads what bhr wrote, and bhr writes into what
 * that device made. The bytes are those of bhr_render_image, in every format, with regions, strides, several samples,
 * glare and many frames. No semaphores between devices, which lavapipe does not have; those are tested where they are.
 * Arguments: vulkan [validate]. */
#include "share.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define WIDTH 157u
#define HEIGHT 61u
#define MOST_BYTES (WIDTH * HEIGHT * 16u)

static unsigned char expected[MOST_BYTES], seen[4 * MOST_BYTES];

static BhrTargetOptions options_of(size_t at, BhrTargetKind kind, uint64_t stride) {
    return share_options(formats[at].format, kind, WIDTH, HEIGHT, stride);
}

/* The picture that bhr_render_image makes of the present scene. */
static void expect(size_t at, uint32_t flags) {
    BhrImage image = image_of(formats[at].format, WIDTH, HEIGHT, expected, sizeof expected);
    image.flags = flags;
    memset(expected, 0xee, sizeof expected);
    CHECK_OK(bhr_render_image(context, &image));
}

static void frame_into(BhrTarget *target) {
    BhrJob *job;
    if (!CHECK_OK(bhr_render_target(context, target, NULL, &job)))
        return;
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    BhrFrameStats stats = {.struct_size = sizeof stats};
    CHECK_OK(bhr_job_stats(job, &stats));
    CHECK(stats.rays >= WIDTH * HEIGHT, "%llu rays", (unsigned long long)stats.rays);
    bhr_job_destroy(job);
}

/* Rows of `seen`, stride bytes apart, are those expected, and what is between them is `between`. */
static void compare(BhrTargetKind kind, size_t at, uint64_t stride, int between, const char *what) {
    uint64_t row = (uint64_t)WIDTH * formats[at].bytes;
    uint32_t wrong = 0, touched = 0;
    for (uint32_t y = 0; y < HEIGHT; y++) {
        wrong += memcmp(seen + y * stride, expected + y * row, row) != 0;
        for (uint64_t i = row; between >= 0 && y + 1 < HEIGHT && i < stride; i++)
            touched += seen[y * stride + i] != (unsigned char)between;
    }
    double apart = 0;
    for (uint32_t y = 0; wrong && y < HEIGHT; y++)
        apart = fmax(apart, vk_apart(formats[at].format, seen + y * stride, expected + y * row, row));
    CHECK(apart <= vk_most_apart(context, kind, formats[at].format), "%s, %s: %u rows of %u differ, by up to %g",
          formats[at].name, what, wrong, HEIGHT, apart);
    CHECK(touched == 0, "%s, %s: %u bytes between rows were written", formats[at].name, what, touched);
}

/* bhr's memory, imported by the host. */
static void exported(size_t at, BhrTargetKind kind, uint64_t stride, uint32_t flags, const char *what) {
    uint64_t         row = (uint64_t)WIDTH * formats[at].bytes, step = stride ? stride : row;
    uint64_t         bytes = step * (HEIGHT - 1) + row;
    BhrTargetOptions options = options_of(at, kind, stride);
    options.flags = flags;
    BhrTarget *target = share_make(&options);
    if (!target)
        return;
    VkPicture picture = share_import(target, bytes);
    expect(at, flags);
    frame_into(target);
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, formats[at].bytes, bytes, NULL, seen);
    compare(kind, at, kind == BHR_TARGET_IMAGE ? row : step, -1, what);
    /* The memory stays while the host has it. */
    bhr_target_destroy(target);
    memset(seen, 0, sizeof seen);
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, formats[at].bytes, bytes, NULL, seen);
    compare(kind, at, kind == BHR_TARGET_IMAGE ? row : step, -1, "after bhr's end");
    vk_drop(&host, &picture);
}

/* The host's memory, imported by bhr. */
static void imported_by_bhr(size_t at, BhrTargetKind kind, uint64_t stride) {
    uint64_t         row = (uint64_t)WIDTH * formats[at].bytes, step = stride ? stride : row;
    uint64_t         bytes = step * (HEIGHT - 1) + row;
    BhrTargetOptions options = options_of(at, kind, stride);
    BhrTarget       *target;
    VkImageUsageFlags usage =
        formats[at].format == BHR_FORMAT_BGRA8_SRGB ? VK_IMAGE_USAGE_TRANSFER_DST_BIT : VK_IMAGE_USAGE_STORAGE_BIT;
    VkPicture picture = share_host_memory(&options, usage, bytes, &target);
    if (target) {
        expect(at, 0);
        frame_into(target);
        vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, formats[at].bytes, bytes, NULL, seen);
        compare(kind, at, kind == BHR_TARGET_IMAGE ? row : step, -1, "the host's memory");
        bhr_target_destroy(target);
    }
    vk_drop(&host, &picture);
}

/* The host's own pixels, where the device takes them; bytes between rows stay. */
static void host_pixels(size_t at) {
    size_t           room = 4 << 20;
    uint64_t         stride = (uint64_t)WIDTH * formats[at].bytes + 20;
    BhrTargetOptions options = options_of(at, BHR_TARGET_BUFFER, stride);
    BhrTargetInfo    memory = {.struct_size = sizeof memory, .allocation_size = room};
    BhrHandle        handle = {BHR_HANDLE_HOST_POINTER, -1, NULL};
    BhrTarget       *target;
    options.handle_type = BHR_HANDLE_HOST_POINTER;
    void *pixels;
    if (!CHECK(posix_memalign(&pixels, 65536, room) == 0, "no memory"))
        return;
    memset(pixels, 0x5a, room);
    handle.handle = pixels;
    if (CHECK_OK(bhr_target_import(context, &options, &memory, &handle, &target))) {
        expect(at, 0);
        frame_into(target);
        memcpy(seen, pixels, stride * HEIGHT);
        compare(BHR_TARGET_BUFFER, at, stride, 0x5a, "the host's own pixels");
        bhr_target_destroy(target);
        handle.handle = (char *)pixels + 16;
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "multiples of",
                    bhr_target_import(context, &options, &memory, &handle, &target));
    }
    /* Freed when no frame uses them. */
    BhrImage small = image_of(BHR_FORMAT_RGBA8_SRGB, 8, 8, seen, sizeof seen);
    CHECK_OK(bhr_render_image(context, &small));
    free(pixels);
}

/* Rows so far apart that kernels bind the buffer in parts: 128 MiB at once is what lavapipe has. */
static void far_rows(void) {
    uint64_t         stride = UINT64_C(4) << 20, bytes = stride * (HEIGHT - 1) + WIDTH * 8;
    BhrTargetOptions options = options_of(2, BHR_TARGET_BUFFER, stride);
    BhrTarget       *target = share_make(&options);
    unsigned char   *all = malloc(bytes);
    uint32_t         wrong = 0;
    if (!CHECK(all != NULL, "no memory") || !target)
        return;
    VkPicture picture = share_import(target, bytes);
    expect(2, 0);
    frame_into(target);
    vk_read(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 8, bytes, NULL, all);
    for (uint32_t y = 0; y < HEIGHT; y++)
        wrong += memcmp(all + y * stride, expected + y * WIDTH * 8, WIDTH * 8) != 0;
    CHECK(wrong == 0, "rows 4 MiB apart: %u of %u differ", wrong, HEIGHT);
    bhr_target_destroy(target);
    vk_drop(&host, &picture);
    free(all);
}

/* Frames of a scene that changes, into two targets by turns, several on their way at a time. */
static void many_frames(uint32_t frames) {
    BhrTarget   *targets[2];
    BhrSemaphore *done;
    VkPicture    pictures[2];
    BhrTargetOptions options = options_of(2, BHR_TARGET_BUFFER, 0);
    uint64_t     bytes = (uint64_t)WIDTH * HEIGHT * 8;
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &done));
    for (int i = 0; i < 2; i++) {
        targets[i] = share_make(&options);
        pictures[i] = share_import(targets[i], bytes);
    }
    for (uint32_t frame = 1; frame <= frames; frame++) {
        BhrSemaphoreValue signal = {done, frame};
        BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &signal};
        CHECK_OK(bhr_set_time(context, 3.0 * frame));
        if (frame % 2)
            CHECK_OK(bhr_render_target(context, targets[frame % 2], &sync, NULL));
        else
            CHECK_OK(bhr_render_target_async(context, targets[frame % 2], &sync, NULL));
        CHECK_OK(bhr_semaphore_wait(done, frame, UINT64_MAX));
        if (frame % 10 == 0 || frame == frames) {
            expect(2, 0);
            vk_read(&host, &pictures[frame % 2], VK_QUEUE_FAMILY_EXTERNAL, 8, bytes, NULL, seen);
            compare(BHR_TARGET_BUFFER, 2, WIDTH * 8, -1, "one of many frames");
        }
    }
    for (int i = 0; i < 2; i++) {
        bhr_target_destroy(targets[i]);
        vk_drop(&host, &pictures[i]);
    }
    bhr_semaphore_destroy(done);
}

/* Made, exported, imported and destroyed again and again: no descriptor and no memory stays. */
static void descriptors(void) {
    uint64_t         bytes = (uint64_t)WIDTH * HEIGHT * 8;
    BhrTargetOptions options = options_of(2, BHR_TARGET_BUFFER, 0);
    int              before = open_descriptors();
    BhrFrameStats    first = {.struct_size = sizeof first}, last = {.struct_size = sizeof last};
    for (int i = 0; i < (check_runs_all() ? 60 : 24); i++) {
        BhrTarget *target, *again;
        BhrHandle  handle;
        BhrTargetInfo info = {.struct_size = sizeof info};
        options.kind = i % 2 ? BHR_TARGET_IMAGE : BHR_TARGET_BUFFER;
        CHECK_OK(bhr_target_create(context, &options, &target));
        CHECK_OK(bhr_target_info(target, &info));
        VkPicture picture = share_import(target, bytes);
        CHECK_OK(bhr_target_export(target, &handle));
        CHECK_OK(bhr_target_import(context, &options, &info, &handle, &again));
        CHECK_OK(bhr_render_target(context, again, NULL, NULL)); /* in flight while all goes */
        vk_drop(&host, &picture);
        bhr_target_destroy(i % 3 ? target : again);
        bhr_target_destroy(i % 3 ? again : target);
        expect(0, 0);
        CHECK_OK(bhr_frame_stats(context, i < 10 ? &first : &last));
    }
    CHECK(open_descriptors() == before, "%d descriptors before, %d after", before, open_descriptors());
    CHECK(last.device_bytes <= first.device_bytes, "device memory: %llu bytes early, %llu late",
          (unsigned long long)first.device_bytes, (unsigned long long)last.device_bytes);
}

int main(int argc, char **argv) {
    share_begin(argc, argv);
    CHECK(can.export_buffers & can.import_buffers & BHR_HANDLE_OPAQUE_FD, "export %#x, import %#x", can.export_buffers,
          can.import_buffers);
    int32_t index;
    CHECK_OK(bhr_adapter_find(can.device_uuid, NULL, &index));
    CHECK(index >= 0, "index %d", index);
    share_set_quality(1, 0);
    for (size_t at = 0; at < FORMATS; at++) {
        CHECK_OK(bhr_set_view(context, formats[at].format == BHR_FORMAT_R32F ? BHR_VIEW_REDSHIFT : BHR_VIEW_LIGHT));
        exported(at, BHR_TARGET_BUFFER, 0, 0, "buffer");
        exported(at, BHR_TARGET_BUFFER, (uint64_t)WIDTH * formats[at].bytes + 52, 0, "buffer with a stride");
        exported(at, BHR_TARGET_IMAGE, 0, 0, "image");
        imported_by_bhr(at, BHR_TARGET_BUFFER, (uint64_t)WIDTH * formats[at].bytes + 4);
        imported_by_bhr(at, BHR_TARGET_IMAGE, 0);
        if (can.import_buffers & BHR_HANDLE_HOST_POINTER)
            host_pixels(at);
    }
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    exported(0, BHR_TARGET_IMAGE, 0, BHR_IMAGE_TRANSPARENT, "transparent image");
    for (size_t at = 0; at < 4; at++) {
        share_set_quality(5, 0);
        exported(at, BHR_TARGET_BUFFER, 0, 0, "5 samples, buffer");
        exported(at, BHR_TARGET_IMAGE, 0, 0, "5 samples, image");
        share_set_quality(1, at == 2 || at == 3 ? 0 : 0.3);
        exported(at, BHR_TARGET_BUFFER, 0, 0, "glare, buffer");
        exported(at, BHR_TARGET_IMAGE, 0, 0, "glare, image");
    }
    share_set_quality(1, 0);
    BhrRegion region = {.struct_size = sizeof region, .full_width = 400, .full_height = 300, .x = 170, .y = 130};
    CHECK_OK(bhr_set_region(context, &region));
    for (size_t at = 0; at < 4; at++) {
        exported(at, BHR_TARGET_BUFFER, 0, 0, "region, buffer");
        exported(at, BHR_TARGET_IMAGE, 0, 0, "region, image");
    }
    CHECK_OK(bhr_set_region(context, NULL));
    far_rows();
    many_frames(check_runs_all() ? 100 : 30);
    descriptors();
    return share_end();
}
