/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* images.c -- frames for targets that write images in the host's memory as well, and wait for what the host signals
 * later: no call waits for that; an image is complete when the job is, and the host's again once that is destroyed.
 * VkImages and buffers have the same bytes whoever made their memory and whichever call rendered, those of
 * bhr_render_image where the same kernels write them. Binary semaphores, and descriptors of both kinds where the
 * driver shares semaphores. Arguments: vulkan [validate]. */
#include "share.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 107u
#define HEIGHT 45u
#define MOST (WIDTH * HEIGHT * 16u)

static unsigned char depths[WIDTH * HEIGHT * 4], expected[WIDTH * HEIGHT * 4];
static unsigned char picture_expected[MOST], picture_seen[MOST];

static void expect_picture(size_t at) {
    BhrImage image = image_of(formats[at].format, WIDTH, HEIGHT, picture_expected, sizeof picture_expected);
    CHECK_OK(bhr_render_image(context, &image));
}

/* The pixels of a picture in the host's hands, as another device sees them, are those of bhr_render_image. */
static void see(const VkPicture *picture, size_t at, const VkTurn *turn, const char *what) {
    size_t bytes = (size_t)WIDTH * HEIGHT * formats[at].bytes;
    memset(picture_seen, 0x77, sizeof picture_seen);
    vk_read(&host, picture, VK_QUEUE_FAMILY_EXTERNAL, formats[at].bytes, bytes, turn, picture_seen);
    double apart = vk_apart(formats[at].format, picture_seen, picture_expected, bytes);
    double most = vk_most_apart(context, picture->info.kind, formats[at].format);
    CHECK(apart <= most && (most > 0 || memcmp(picture_seen, picture_expected, bytes) == 0),
          "%s, %s, kind %d: up to %g apart", formats[at].name, what, (int)picture->info.kind, apart);
}

/* The picture into a target. */
static BhrOutput lit(BhrTarget *light) {
    BhrOutput output;
    CHECK_OK(bhr_output_init(&output, sizeof output));
    output.target = light;
    return output;
}

/* The depth into the host's memory. */
static BhrOutput imaged(BhrImage *image, void *pixels) {
    BhrOutput output;
    CHECK_OK(bhr_output_init(&output, sizeof output));
    *image = image_of(BHR_FORMAT_R32F, WIDTH, HEIGHT, pixels, sizeof depths);
    output.kind = BHR_OUTPUT_DEPTH;
    output.image = image;
    return output;
}

/* A frame that waits for what the host signals later: the call does not, nor does the job's end; images are complete
 * when the job is, and are the host's again once it is destroyed. */
static void images_wait(void) {
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA16F, BHR_TARGET_IMAGE, WIDTH, HEIGHT, 0);
    BhrTarget       *light = share_make(&options);
    VkPicture        picture = share_import(light, 0);
    BhrSemaphore    *line;
    BhrImage         image;
    expect_picture(RGBA16F);
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &line));
    BhrOutput in_memory = imaged(&image, expected);
    CHECK_OK(bhr_render_outputs(context, &in_memory, sizeof in_memory, 1, NULL));
    for (uint64_t turn = 0; turn < 6; turn++) {
        int               async = turn % 2, destroyed = turn / 2 == 1, alone = turn / 2 == 2;
        BhrSemaphoreValue wait = {line, 3 * turn + 1}, signal = {line, 3 * turn + 2};
        BhrSync   sync = {.struct_size = sizeof sync, .wait_count = 1, .signal_count = 1, .waits = &wait};
        BhrOutput list[2] = {imaged(&image, depths), lit(light)};
        BhrJob   *job = NULL, *after = NULL;
        double    fraction;
        size_t    bytes = sizeof depths;
        sync.signals = &signal;
        memset(depths, 0x77, bytes);
        CHECK_OK(async ? bhr_render_outputs_shared_async(context, list, sizeof *list, 2 - alone, &sync, &job)
                       : bhr_render_outputs_shared(context, list, sizeof *list, 2 - alone, &sync, &job));
        BhrStatus status = bhr_job_wait(job, 20000000, &fraction);
        CHECK(status == BHR_NOT_READY, "the frame did not wait: status %d", (int)status);
        for (size_t i = 0; i < bytes; i++)
            if (depths[i] != 0x77) {
                CHECK(0, "turn %u: byte %zu was written before the frame ran", (unsigned)turn, i);
                break;
            }
        if (destroyed)
            bhr_job_destroy(job);
        CHECK_OK(bhr_semaphore_signal(line, wait.value));
        if (!destroyed) {
            CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
            CHECK(memcmp(depths, expected, bytes) == 0, "turn %u: depth differs", (unsigned)turn);
            bhr_job_destroy(job);
        }
        CHECK_OK(bhr_semaphore_wait(line, signal.value, UINT64_MAX));
        if (!alone)
            see(&picture, RGBA16F, NULL, "beside an image in memory");
        /* A later frame ends after that one. */
        CHECK_OK(bhr_render_target(context, light, NULL, &after));
        share_finish(after);
        for (size_t i = 0; destroyed && i < bytes; i++)
            if (depths[i] != 0x77) {
                CHECK(0, "turn %u: byte %zu was written after the job's end", (unsigned)turn, i);
                break;
            }
        CHECK_OK(bhr_semaphore_signal(line, 3 * turn + 3));
    }
    /* One that is cancelled before its turn writes nothing, and signals. */
    BhrSemaphoreValue wait = {line, 101}, signal = {line, 102}, second = {line, 103};
    BhrSync           sync = {.struct_size = sizeof sync, .wait_count = 1, .signal_count = 1, .waits = &wait};
    BhrOutput         one = imaged(&image, depths);
    BhrJob           *first, *job;
    sync.signals = &signal;
    memset(depths, 0x77, sizeof depths);
    CHECK_OK(bhr_render_outputs_shared_async(context, &one, sizeof one, 1, &sync, &first));
    sync.waits = &signal, sync.signals = &second;
    CHECK_OK(bhr_render_outputs_shared_async(context, &one, sizeof one, 1, &sync, &job));
    bhr_job_destroy(first);
    bhr_job_cancel(job);
    CHECK_OK(bhr_semaphore_signal(line, 101));
    CHECK_OK(bhr_semaphore_wait(line, 103, UINT64_MAX));
    BhrStatus status = bhr_job_wait(job, UINT64_MAX, NULL);
    CHECK(status == BHR_ERROR_CANCELLED || status == BHR_OK, "status %d", (int)status);
    CHECK(depths[0] == 0x77 || status == BHR_OK, "a cancelled frame wrote");
    bhr_job_destroy(job);
    bhr_target_destroy(light);
    bhr_semaphore_destroy(line);
    vk_drop(&host, &picture);
}

/* The calls that render. */
typedef enum Way { AT_ONCE, BY_JOB, OUTPUT, OUTPUT_BY_JOB, WAYS } Way;

/* A frame that waits for what the host signals when the call has returned. */
static void render_by(Way way, BhrTarget *target) {
    BhrSemaphore     *line;
    BhrJob           *job = NULL;
    BhrOutput         output = lit(target);
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &line));
    BhrSemaphoreValue wait = {line, 1}, signal = {line, 2};
    BhrSync           sync = {.struct_size = sizeof sync, .wait_count = 1, .signal_count = 1, .waits = &wait};
    sync.signals = &signal;
    switch (way) {
    case AT_ONCE: CHECK_OK(bhr_render_target(context, target, &sync, &job)); break;
    case BY_JOB: CHECK_OK(bhr_render_target_async(context, target, &sync, &job)); break;
    case OUTPUT: CHECK_OK(bhr_render_outputs_shared(context, &output, sizeof output, 1, &sync, &job)); break;
    default: CHECK_OK(bhr_render_outputs_shared_async(context, &output, sizeof output, 1, &sync, &job));
    }
    CHECK_OK(bhr_semaphore_signal(line, 1));
    CHECK_OK(bhr_semaphore_wait(line, 2, UINT64_MAX));
    share_finish(job);
    bhr_semaphore_destroy(line);
}

/* An image, or a buffer, has the same bytes in bhr's memory and in the host's, by each call, whatever was there. */
static void same_bytes(size_t at, BhrTargetKind kind) {
    static unsigned char first[MOST], junk[MOST];
    size_t               bytes = (size_t)WIDTH * HEIGHT * formats[at].bytes;
    BhrTargetOptions     options = share_options(formats[at].format, kind, WIDTH, HEIGHT, 0);
    int                  views = formats[at].format == BHR_FORMAT_R32F;
    VkImageUsageFlags    usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (formats[at].format != BHR_FORMAT_BGRA8_SRGB)
        usage |= VK_IMAGE_USAGE_STORAGE_BIT;
    CHECK_OK(bhr_set_view(context, views ? BHR_VIEW_REDSHIFT : BHR_VIEW_LIGHT));
    expect_picture(at);
    for (int hosts = 0; hosts < 2; hosts++) {
        BhrTarget *target;
        VkPicture  picture;
        if (hosts)
            picture = share_host_memory(&options, usage, bytes, &target);
        else
            target = share_make(&options), picture = share_import(target, bytes);
        for (int way = 0; target && way < (views ? OUTPUT : WAYS); way++) {
            char what[64];
            snprintf(what, sizeof what, "%s memory, way %d", hosts ? "the host's" : "bhr's", way);
            memset(junk, 0x30 + way, sizeof junk);
            vk_write(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, formats[at].bytes, (uint64_t)WIDTH * formats[at].bytes,
                     bytes, junk);
            render_by((Way)way, target);
            see(&picture, at, NULL, what);
            if (!hosts && way == 0)
                memcpy(first, picture_seen, bytes);
            CHECK(memcmp(first, picture_seen, bytes) == 0, "%s, %s, kind %d: other bytes than by the first way",
                  formats[at].name, what, (int)kind);
        }
        bhr_target_destroy(target);
        vk_drop(&host, &picture);
    }
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
}

/* Binary semaphores between frames of bhr's: each has the place of the one before it. */
static void binary(void) {
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA16F, BHR_TARGET_IMAGE, WIDTH, HEIGHT, 0);
    BhrTarget       *target = share_make(&options);
    VkPicture        picture = share_import(target, 0);
    BhrSemaphore    *turns[2];
    BhrJob          *job = NULL;
    for (int i = 0; i < 2; i++)
        CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_BINARY, 0, &turns[i]));
    for (unsigned frame = 0; frame < 9; frame++) {
        BhrSemaphoreValue wait = {turns[frame % 2], 0}, signal = {turns[1 - frame % 2], 0};
        BhrSync           sync = {.struct_size = sizeof sync, .wait_count = frame > 0, .signal_count = frame < 8};
        sync.waits = &wait, sync.signals = &signal;
        CHECK_OK(bhr_set_time(context, 5.0 * frame));
        CHECK_OK(bhr_render_target(context, target, &sync, frame < 8 ? NULL : &job));
    }
    share_finish(job);
    expect_picture(RGBA16F);
    see(&picture, RGBA16F, NULL, "after eight binary semaphores");
    for (int i = 0; i < 2; i++)
        bhr_semaphore_destroy(turns[i]);
    bhr_target_destroy(target);
    vk_drop(&host, &picture);
}

/* Semaphores by descriptor: the other device waits on the GPU for the frame, and bhr for the other device's copy. bhr
 * makes them, or the host does. Where the driver shares none, bhr says so. */
static void by_descriptor(BhrSemaphoreKind kind, int hosts) {
    const char     *name = kind == BHR_SEMAPHORE_BINARY ? "BINARY" : "TIMELINE";
    VkSemaphoreType type = kind == BHR_SEMAPHORE_BINARY ? VK_SEMAPHORE_TYPE_BINARY : VK_SEMAPHORE_TYPE_TIMELINE;
    BhrSemaphore   *ours[2] = {NULL, NULL};
    VkSemaphore     theirs[2];
    if (!(can.semaphores[kind] & BHR_HANDLE_OPAQUE_FD) || !host.has_semaphore_fd) {
        printf("%s semaphores are not shared by this driver: their turns between devices were not run\n", name);
        CHECK_FAILS(BHR_ERROR_UNSUPPORTED, name, bhr_semaphore_create(context, kind, BHR_HANDLE_OPAQUE_FD, &ours[0]));
        return;
    }
    for (int i = 0; i < 2; i++) {
        BhrHandle handle = {BHR_HANDLE_OPAQUE_FD, -1, NULL};
        if (hosts) {
            theirs[i] = vk_semaphore(&host, type, &handle.fd);
            CHECK_OK(bhr_semaphore_import(context, kind, &handle, &ours[i]));
        } else {
            CHECK_OK(bhr_semaphore_create(context, kind, BHR_HANDLE_OPAQUE_FD, &ours[i]));
            CHECK_OK(bhr_semaphore_export(ours[i], &handle));
            theirs[i] = vk_import_semaphore(&host, type, handle.fd);
        }
    }
    for (int image = 0; image < 2; image++) {
        BhrTargetOptions options =
            share_options(BHR_FORMAT_RGBA16F, image ? BHR_TARGET_IMAGE : BHR_TARGET_BUFFER, WIDTH, HEIGHT, 0);
        BhrTarget *target = share_make(&options);
        VkPicture  picture = share_import(target, WIDTH * HEIGHT * 8);
        for (uint64_t frame = 0; frame < 12; frame++) {
            uint64_t          value = 12 * (uint64_t)image + frame + 1;
            BhrSemaphoreValue signal = {ours[0], value}, wait = {ours[1], value - 1};
            BhrSync           sync = {.struct_size = sizeof sync, .wait_count = value > 1, .signal_count = 1};
            VkTurn            turn = {.wait = theirs[0], .signal = theirs[1], .wait_value = value};
            turn.signal_value = value;
            sync.waits = &wait, sync.signals = &signal;
            CHECK_OK(bhr_set_time(context, 4.0 * (double)value));
            expect_picture(RGBA16F);
            CHECK_OK(bhr_render_target(context, target, &sync, NULL));
            see(&picture, RGBA16F, &turn, name);
        }
        bhr_target_destroy(target);
        vk_drop(&host, &picture);
    }
    for (int i = 0; i < 2; i++) {
        bhr_semaphore_destroy(ours[i]);
        vkDestroySemaphore(host.device, theirs[i], NULL);
    }
}

int main(int argc, char **argv) {
    share_begin(argc, argv);
    images_wait();
    for (size_t at = 0; at < FORMATS; at++) {
        same_bytes(at, BHR_TARGET_IMAGE);
        same_bytes(at, BHR_TARGET_BUFFER);
    }
    binary();
    int before = open_descriptors();
    for (int hosts = 0; hosts < 2; hosts++) {
        by_descriptor(BHR_SEMAPHORE_TIMELINE, hosts);
        by_descriptor(BHR_SEMAPHORE_BINARY, hosts);
    }
    CHECK(open_descriptors() == before, "%d descriptors before, %d after", before, open_descriptors());
    return share_end();
}
