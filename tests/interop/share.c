/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* share.c -- see share.h. */
#include "share.h"

#include <string.h>

BhrContext    *context;
Vk             host;
BhrInteropInfo can = {.struct_size = sizeof can};

const ShareFormat formats[FORMATS] = {
    [RGBA8] = {BHR_FORMAT_RGBA8_SRGB, VK_FORMAT_R8G8B8A8_UNORM, 4, "RGBA8"},
    [BGRA8] = {BHR_FORMAT_BGRA8_SRGB, VK_FORMAT_B8G8R8A8_UNORM, 4, "BGRA8"},
    [RGBA16F] = {BHR_FORMAT_RGBA16F, VK_FORMAT_R16G16B16A16_SFLOAT, 8, "RGBA16F"},
    [RGBA32F] = {BHR_FORMAT_RGBA32F, VK_FORMAT_R32G32B32A32_SFLOAT, 16, "RGBA32F"},
    [R32F] = {BHR_FORMAT_R32F, VK_FORMAT_R32_SFLOAT, 4, "R32F"},
};

BhrBackend share_begin(int argc, char **argv) {
    BhrBackend        backend = check_begin(argc, argv);
    int               validate = argc > 2 && strcmp(argv[2], "validate") == 0;
    BhrContextOptions options = check_options(backend);
    if (validate)
        options.flags |= BHR_CONTEXT_VALIDATION, options.log_fn = vk_log;
    context = check_context_with(&options);
    share_open(validate);
    return backend;
}

void share_open(int validate) {
    CHECK_OK(bhr_interop_info(context, &can));
    vk_open_instance(&host, can.device_uuid, VK_API_VERSION_1_3, validate);
    vk_open_device(&host);
}

int share_end(void) {
    bhr_context_destroy(context);
    vk_close(&host);
    CHECK(vk_complaints == 0, "the validation layers had %d complaints", vk_complaints);
    return check_end();
}

BhrTargetOptions share_options(BhrFormat format, BhrTargetKind kind, uint32_t width, uint32_t height,
                               uint64_t row_stride) {
    BhrTargetOptions options;
    CHECK_OK(bhr_target_options_init(&options, sizeof options));
    options.kind = kind;
    options.format = format;
    options.width = width;
    options.height = height;
    options.handle_type = BHR_HANDLE_OPAQUE_FD;
    options.row_stride = row_stride;
    return options;
}

BhrSemaphore *share_timeline(int *fd) {
    int           shared = (can.semaphores[BHR_SEMAPHORE_TIMELINE] & BHR_HANDLE_OPAQUE_FD) != 0;
    BhrSemaphore *timeline = NULL;
    BhrHandle     handle = {BHR_HANDLE_OPAQUE_FD, -1, NULL};
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, shared ? BHR_HANDLE_OPAQUE_FD : 0, &timeline));
    if (shared)
        CHECK_OK(bhr_semaphore_export(timeline, &handle));
    *fd = handle.fd;
    return timeline;
}

BhrTarget *share_make(const BhrTargetOptions *options) {
    BhrTarget *target = NULL;
    CHECK_OK(bhr_target_create(context, options, &target));
    return target;
}

VkPicture share_import(BhrTarget *target, uint64_t bytes) {
    BhrTargetInfo info = {.struct_size = sizeof info};
    BhrHandle     handle;
    CHECK_OK(bhr_target_info(target, &info));
    CHECK_OK(bhr_target_export(target, &handle));
    CHECK(handle.type == BHR_HANDLE_OPAQUE_FD && handle.fd >= 0, "type %u, fd %d", handle.type, handle.fd);
    return vk_import(&host, &info, handle.fd, bytes);
}

VkPicture share_host_memory(const BhrTargetOptions *options, VkImageUsageFlags usage, uint64_t bytes,
                            BhrTarget **target) {
    BhrHandle handle = {BHR_HANDLE_OPAQUE_FD, -1, NULL};
    VkPicture picture;
    size_t    at = 0;
    while (at + 1 < FORMATS && formats[at].format != options->format)
        at++;
    picture = options->kind == BHR_TARGET_IMAGE
                  ? vk_make_image(&host, formats[at].vk, options->width, options->height, usage, &handle.fd)
                  : vk_make_buffer(&host, bytes, &handle.fd);
    *target = NULL;
    CHECK_OK(bhr_target_import(context, options, &picture.info, &handle, target));
    return picture;
}

void share_set_quality(uint32_t samples, double bloom) {
    BhrQuality quality = {.struct_size = sizeof quality};
    BhrFilm    film = {.struct_size = sizeof film};
    CHECK_OK(bhr_get_quality(context, &quality));
    CHECK_OK(bhr_get_film(context, &film));
    quality.samples_per_pixel = samples;
    film.bloom = bloom;
    CHECK_OK(bhr_set_quality(context, &quality));
    CHECK_OK(bhr_set_film(context, &film));
}

void share_finish(BhrJob *job) {
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
}
