/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* host.c -- contexts on the host's own VkDevice: what must be on, frames in the host's images with its timelines and
 * its binary semaphores both ways, one queue that another thread of the host uses all the time, images that are filled
 * by a copy, releases, and every order of ends. Arguments: vulkan [validate]. */
#include "../c/check.h"
#include "vk.h"

#include <pthread.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 149u
#define HEIGHT 53u
#define FRAMES 40u

static unsigned char expected[WIDTH * HEIGHT * 16], seen[WIDTH * HEIGHT * 16];
static Vk            host;

/* ---- the queue's lock ---- */
static pthread_mutex_t queue_lock = PTHREAD_MUTEX_INITIALIZER;
static int             held, wrong_turns;
static unsigned        turns;

static void lock(void *user) {
    (void)user;
    pthread_mutex_lock(&queue_lock);
    wrong_turns += held != 0;
    held = 1;
    turns++;
}

static void unlock(void *user) {
    (void)user;
    wrong_turns += held != 1;
    held = 0;
    pthread_mutex_unlock(&queue_lock);
}

static int      stop;
static unsigned submissions;

/* Submits nothing to the queue, all the time: without a pause in `tests/run all`, everyday up to a thousand times a
 * second. */
static void *submit_always(void *nothing) {
    VkSubmitInfo empty = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO};
    for (int ends = 0; !ends;) {
        lock(NULL);
        ends = stop;
        VK(vkQueueSubmit(host.queue, 1, &empty, VK_NULL_HANDLE));
        submissions++;
        unlock(NULL);
        if (!check_runs_all())
            pause_ms(1);
    }
    return nothing;
}

/* ---- contexts ---- */
static int  released;
static void release(void *user) {
    (void)user;
    released++;
}

static BhrContext *adopt(void) {
    BhrVulkanDevice   device = vk_for_bhr(&host);
    BhrContextOptions options = check_options(BHR_BACKEND_VULKAN);
    BhrContext       *context = NULL;
    device.lock = lock;
    device.unlock = unlock;
    device.release = release;
    released = 0;
    if (!CHECK_OK(bhr_context_create_vulkan(BHR_ABI_VERSION, &options, &device, &context)))
        exit(check_end());
    return context;
}

/* Compares with a frame by a context of bhr's own device. */
static void expect(BhrContext *own, BhrFormat format, double time) {
    BhrImage image;
    CHECK_OK(bhr_image_init(&image, sizeof image));
    image.format = format;
    image.width = WIDTH;
    image.height = HEIGHT;
    image.pixels = expected;
    image.byte_size = sizeof expected;
    CHECK_OK(bhr_set_time(own, time));
    CHECK_OK(bhr_render_image(own, &image));
}

static const struct {
    BhrFormat         format;
    VkFormat          vk;
    uint32_t          bytes, flags;
    VkImageUsageFlags usage;
    VkImageLayout     layout;
} images[] = {
    {BHR_FORMAT_RGBA16F, VK_FORMAT_R16G16B16A16_SFLOAT, 8, 0, VK_IMAGE_USAGE_STORAGE_BIT,
     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
    {BHR_FORMAT_RGBA8_SRGB, VK_FORMAT_R8G8B8A8_UNORM, 4, 0, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
     VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL},
    {BHR_FORMAT_RGBA32F, VK_FORMAT_R32G32B32A32_SFLOAT, 16, 0, VK_IMAGE_USAGE_STORAGE_BIT, VK_IMAGE_LAYOUT_GENERAL},
    {BHR_FORMAT_BGRA8_SRGB, VK_FORMAT_B8G8R8A8_UNORM, 4, BHR_TARGET_COPY, VK_IMAGE_USAGE_TRANSFER_DST_BIT,
     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
    {BHR_FORMAT_RGB10A2_PQ, VK_FORMAT_A2B10G10R10_UNORM_PACK32, 4, BHR_TARGET_COPY, VK_IMAGE_USAGE_TRANSFER_DST_BIT,
     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
    {BHR_FORMAT_RGBA16F, VK_FORMAT_R16G16B16A16_SFLOAT, 8, BHR_TARGET_COPY, VK_IMAGE_USAGE_TRANSFER_DST_BIT,
     VK_IMAGE_LAYOUT_GENERAL},
};

static BhrTarget *wrap(BhrContext *context, size_t at, VkPicture *picture) {
    BhrTargetOptions options;
    BhrTarget       *target = NULL;
    CHECK_OK(bhr_target_options_init(&options, sizeof options));
    *picture = vk_make_image(&host, images[at].vk, WIDTH, HEIGHT, images[at].usage, NULL);
    picture->info.layout = options.layout = (int32_t)images[at].layout;
    options.format = images[at].format;
    options.width = WIDTH;
    options.height = HEIGHT;
    options.flags = images[at].flags;
    CHECK_OK(bhr_target_wrap_vulkan(context, &options, (uint64_t)picture->image, picture->info.vk_usage, release, NULL,
                                    &target));
    return target;
}

/* Frames by turns: odd values say that bhr has rendered, even ones that the host has read. */
static void frames_into(BhrContext *context, BhrContext *own, size_t at, uint64_t frames) {
    VkPicture     picture;
    BhrTarget    *target = wrap(context, at, &picture);
    VkSemaphore   timeline = vk_timeline(&host);
    BhrSemaphore *semaphore;
    uint64_t      image = 0, buffer = 1;
    CHECK_OK(bhr_semaphore_wrap_vulkan(context, BHR_SEMAPHORE_TIMELINE, (uint64_t)timeline, &semaphore));
    CHECK_OK(bhr_target_vulkan(target, &image, &buffer));
    CHECK(image == (uint64_t)picture.image && buffer == 0, "another image");
    for (uint64_t frame = 0; frame < frames; frame++) {
        BhrSemaphoreValue wait = {semaphore, 2 * frame}, signal = {semaphore, 2 * frame + 1};
        BhrSync           sync = {.struct_size = sizeof sync, .wait_count = frame > 0, .signal_count = 1};
        VkTurn turn = {timeline, timeline, 2 * frame + 1, 2 * frame + 2, lock, unlock};
        double time = 2.0 * (double)frame;
        sync.waits = &wait, sync.signals = &signal;
        CHECK_OK(bhr_set_time(context, time));
        /* Every other frame as a job; as both use one queue, what waits for it must not be submitted before it. */
        CHECK_OK(frame % 2 ? bhr_render_target_async(context, target, &sync, NULL)
                           : bhr_render_target(context, target, &sync, NULL));
        if (frame % 2)
            CHECK_OK(bhr_semaphore_wait(semaphore, 2 * frame + 1, UINT64_MAX));
        vk_read(&host, &picture, VK_QUEUE_FAMILY_IGNORED, images[at].bytes, 0, &turn, seen);
        if (frame % 8 == 0 || frame + 1 == frames) {
            expect(own, images[at].format, time);
            double apart = vk_apart(images[at].format, seen, expected, WIDTH * HEIGHT * images[at].bytes);
            CHECK(apart <= vk_most_apart(own, BHR_TARGET_IMAGE, images[at].format),
                  "image %zu, frame %u differs by up to %g", at, (unsigned)frame, apart);
        }
    }
    CHECK(released == 0, "released early");
    bhr_target_destroy(target);
    /* The GPU has done with it; the next call lets it go. */
    expect(context, images[at].format, 0);
    expect(context, images[at].format, 0);
    CHECK(released == 1, "released %d times", released);
    released = 0;
    vk_drop(&host, &picture);
    bhr_semaphore_destroy(semaphore);
    expect(context, images[at].format, 0);
    vkDestroySemaphore(host.device, timeline, NULL);
}

/* The host's binary semaphores: one says that bhr has rendered, the other that the host has read. */
static void binary_turns(BhrContext *context, BhrContext *own, size_t at) {
    VkPicture     picture;
    BhrTarget    *target = wrap(context, at, &picture);
    VkSemaphore   made[2];
    BhrSemaphore *wrapped[2];
    for (int i = 0; i < 2; i++) {
        made[i] = vk_semaphore(&host, VK_SEMAPHORE_TYPE_BINARY, NULL);
        CHECK_OK(bhr_semaphore_wrap_vulkan(context, BHR_SEMAPHORE_BINARY, (uint64_t)made[i], &wrapped[i]));
    }
    for (unsigned frame = 0; frame < 6; frame++) {
        BhrSemaphoreValue signal = {wrapped[0], 0}, wait = {wrapped[1], 0};
        BhrSync           sync = {.struct_size = sizeof sync, .wait_count = frame > 0, .signal_count = 1};
        VkTurn            turn = {made[0], made[1], 0, 0, lock, unlock};
        sync.waits = &wait, sync.signals = &signal;
        CHECK_OK(bhr_set_time(context, 3.0 * frame));
        CHECK_OK(bhr_render_target(context, target, &sync, NULL));
        vk_read(&host, &picture, VK_QUEUE_FAMILY_IGNORED, images[at].bytes, 0, &turn, seen);
        expect(own, images[at].format, 3.0 * frame);
        double apart = vk_apart(images[at].format, seen, expected, WIDTH * HEIGHT * images[at].bytes);
        CHECK(apart <= vk_most_apart(own, BHR_TARGET_IMAGE, images[at].format),
              "binary semaphores, image %zu, frame %u differs by up to %g", at, frame, apart);
    }
    bhr_target_destroy(target);
    expect(context, images[at].format, 0);
    expect(context, images[at].format, 0);
    for (int i = 0; i < 2; i++) {
        bhr_semaphore_destroy(wrapped[i]);
        vkDestroySemaphore(host.device, made[i], NULL);
    }
    vk_drop(&host, &picture);
    released = 0;
}

/* Target, semaphore, job and context end in every order, in flight. Everyday in the first twelve, which have every
 * step: each of the four ends beside each set of the others. */
static void orders(void) {
    static const char *const list[] = {"tsjc", "stcj", "jtcs", "csjt", "tjsc", "tcsj", "sjtc", "sctj", "jsct", "jcts",
                                       "ctjs", "cjst", "tscj", "tjcs", "tcjs", "stjc", "sjct", "scjt", "jtsc", "jstc",
                                       "jcst", "ctsj", "cstj", "cjts"};
    const size_t count = check_runs_all() ? COUNT_OF(list) : 12;
    for (size_t at = 0; at < count; at++) {
        BhrContext   *context = adopt();
        VkPicture     picture;
        BhrTarget    *target = wrap(context, at % COUNT_OF(images), &picture);
        BhrSemaphore *semaphore;
        BhrJob       *job = NULL;
        CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &semaphore));
        BhrSemaphoreValue signal = {semaphore, 1};
        BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &signal};
        CHECK_OK(at % 2 ? bhr_render_target(context, target, &sync, &job)
                        : bhr_render_target_async(context, target, &sync, &job));
        for (const char *one = list[at]; *one; one++)
            switch (*one) {
            case 't': bhr_target_destroy(target); break;
            case 's': bhr_semaphore_destroy(semaphore); break;
            case 'j': bhr_job_destroy(job); break;
            default: bhr_context_destroy(context);
            }
        CHECK(released == 2, "%s: released %d times", list[at], released);
        vk_drop(&host, &picture);
    }
}

/* A target ends while a frame into it waits for its turn: it is released when that frame has run, and no frame or call
 * comes after. */
static void ends_before_its_frame(BhrContext *context, size_t at) {
    VkPicture     picture;
    BhrTarget    *target = wrap(context, at, &picture);
    BhrSemaphore *semaphore;
    BhrJob       *job;
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &semaphore));
    /* Frames of the same setup have made what they need. */
    CHECK_OK(bhr_render_target(context, target, NULL, &job));
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    for (uint64_t frame = 0; frame < 6; frame++) {
        BhrSemaphoreValue wait = {semaphore, 1};
        BhrSync           sync = {.struct_size = sizeof sync, .wait_count = 1, .waits = &wait};
        CHECK_OK(bhr_render_target_async(context, target, &sync, frame < 5 ? NULL : &job));
    }
    bhr_target_destroy(target);
    CHECK(released == 0, "released while frames wait");
    CHECK_OK(bhr_semaphore_signal(semaphore, 1));
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    for (int i = 0; i < 200 && released == 0; i++)
        pause_ms(10);
    CHECK(released == 1, "image %zu: released %d times after its last frame", at, released);
    released = 0;
    bhr_semaphore_destroy(semaphore);
    expect(context, images[at].format, 0);
    vk_drop(&host, &picture);
}

int main(int argc, char **argv) {
    BhrBackend  backend = check_begin(argc, argv);
    int         validate = argc > 2 && strcmp(argv[2], "validate") == 0;
    BhrContext *own = check_context(backend);
    BhrVulkanRequirements required = {.struct_size = sizeof required};
    BhrInteropInfo        info = {.struct_size = sizeof info};
    CHECK_OK(bhr_interop_info(own, &info));
    CHECK_OK(bhr_vulkan_requirements(NULL, NULL, NULL, &required));
    CHECK(required.api_version == VK_API_VERSION_1_3 && required.instance_extension_count == 2 &&
              required.device_extension_count == 0 && required.features == NULL,
          "requirements of instances: version %#x, %u extensions", required.api_version,
          required.instance_extension_count);
    vk_open_instance(&host, info.device_uuid, VK_API_VERSION_1_3, validate);
    for (int i = 0; i < 3; i++)
        CHECK_OK(bhr_vulkan_requirements((BhrGetInstanceProcAddr)vkGetInstanceProcAddr, host.instance, host.physical,
                                         &required));
    CHECK(required.features != NULL && required.device_extension_count > 0, "no requirements of devices");
    vk_open_required(&host, &required);
    pthread_t other;
    CHECK(pthread_create(&other, NULL, submit_always, NULL) == 0, "no thread");
    BhrContext *context = adopt();
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "host", bhr_context_recover(context));
    /* Both contexts have one scene. */
    check_set_sky(context);
    BhrCamera camera = {.struct_size = sizeof camera};
    BhrDisk   disk = {.struct_size = sizeof disk};
    BhrFilm   film = {.struct_size = sizeof film};
    BhrQuality quality = {.struct_size = sizeof quality};
    int32_t   present;
    CHECK_OK(bhr_get_camera(own, &camera));
    CHECK_OK(bhr_get_disk(own, &disk, &present));
    CHECK_OK(bhr_get_film(own, &film));
    CHECK_OK(bhr_get_quality(own, &quality));
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_disk(context, present ? &disk : NULL));
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_set_quality(context, &quality));
    for (size_t at = 0; at < COUNT_OF(images); at++)
        frames_into(context, own, at, at ? 9 : check_runs_all() ? FRAMES : 17);
    for (size_t at = 0; at < COUNT_OF(images); at++)
        ends_before_its_frame(context, at);
    binary_turns(context, own, 1);
    binary_turns(context, own, 3);
    bhr_context_destroy(context);
    CHECK(released == 1, "the device was released %d times", released);
    lock(NULL);
    stop = 1;
    unlock(NULL);
    pthread_join(other, NULL);
    CHECK(wrong_turns == 0 && held == 0, "%d wrong turns with the lock", wrong_turns);
    CHECK(turns > submissions && submissions > 0, "%u turns, %u submissions of the host's", turns, submissions);
    orders();
    bhr_context_destroy(own);
    vkDeviceWaitIdle(host.device);
    vk_close(&host);
    CHECK(vk_complaints == 0, "the validation layers had %d complaints", vk_complaints);
    return check_end();
}
