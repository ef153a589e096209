/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad.c -- bhr_interop.h called badly: every refusal has its status and a message, takes no descriptor of the host's,
 * and changes nothing; the next frame is made all the same. Backends that share nothing say so. Arguments: a backend.
 */
#include "../c/check.h"
#include "vk.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define BAD BHR_ERROR_INVALID_ARGUMENT
#define PROC ((BhrGetInstanceProcAddr)vkGetInstanceProcAddr)

static BhrContext *context;

static BhrTargetOptions good(BhrTargetKind kind) {
    BhrTargetOptions options;
    CHECK_OK(bhr_target_options_init(&options, sizeof options));
    options.kind = kind;
    options.width = 64;
    options.height = 32;
    options.handle_type = BHR_HANDLE_OPAQUE_FD;
    return options;
}

static void frame_works(BhrTarget *target) {
    BhrJob *job;
    if (CHECK_OK(bhr_render_target(context, target, NULL, &job)))
        CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
}

/* The CPU tracer and OpenGL. */
static void without_sharing(void) {
    BhrInteropInfo   info = {.struct_size = sizeof info};
    BhrTargetOptions options = good(BHR_TARGET_BUFFER);
    BhrTargetInfo    memory = {.struct_size = sizeof memory, .allocation_size = 8192};
    BhrHandle        handle = {BHR_HANDLE_OPAQUE_FD, 0, NULL};
    BhrTarget       *target = (BhrTarget *)&info;
    BhrSemaphore    *semaphore = (BhrSemaphore *)&info;
    CHECK_OK(bhr_interop_info(context, &info));
    CHECK(!(info.export_buffers | info.export_images | info.import_buffers | info.import_images | info.semaphores[0] |
            info.semaphores[1]),
          "it shares something");
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "bhr_render_image", bhr_target_create(context, &options, &target));
    CHECK(target == NULL, "not cleared");
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "bhr_render_image",
                bhr_target_import(context, &options, &memory, &handle, &target));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "bhr_render_image",
                bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &semaphore));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "bhr_render_image",
                bhr_semaphore_import(context, BHR_SEMAPHORE_BINARY, &handle, &semaphore));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "host",
                (options.handle_type = 0, options.kind = BHR_TARGET_IMAGE,
                 bhr_target_wrap_vulkan(context, &options, 1, 8, NULL, NULL, &target)));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "host",
                bhr_semaphore_wrap_vulkan(context, BHR_SEMAPHORE_TIMELINE, 1, &semaphore));
    CHECK_FAILS(BAD, "target", bhr_render_target(context, NULL, NULL, NULL));
    BhrOutput output;
    CHECK_OK(bhr_output_init(&output, sizeof output));
    CHECK_FAILS(BAD, "target", bhr_render_outputs_shared(context, &output, sizeof output, 1, NULL, NULL));
    CHECK_FAILS(BAD, "target", bhr_render_outputs_shared_async(context, &output, sizeof output, 1, NULL, NULL));
    CHECK_OK(bhr_set_occluder_target(context, NULL, 0));
    CHECK_OK(bhr_set_sky_target(context, NULL));
    CHECK(fcntl(0, F_GETFD) != -1, "the host's descriptor was closed");
}

static void nothing_given(void) {
    BhrInteropInfo   info = {.struct_size = sizeof info};
    BhrTargetOptions options = good(BHR_TARGET_IMAGE);
    BhrTargetInfo    memory = {.struct_size = sizeof memory};
    BhrHandle        handle;
    BhrTarget       *target;
    BhrSemaphore    *semaphore;
    uint64_t         raw;
    int32_t          index = 7;
    CHECK_FAILS(BAD, "context", bhr_interop_info(NULL, &info));
    CHECK_FAILS(BAD, "info", bhr_interop_info(context, NULL));
    info.struct_size = 12;
    CHECK_FAILS(BAD, "struct_size", bhr_interop_info(context, &info));
    CHECK_FAILS(BAD, "uuid", bhr_adapter_find(NULL, NULL, &index));
    CHECK(index == -1, "index %d", index);
    CHECK_FAILS(BAD, "out_index", bhr_adapter_find((const uint8_t *)"0123456789abcdef", NULL, NULL));
    CHECK_FAILS(BHR_ERROR_NO_ADAPTER, "30313233", bhr_adapter_find((const uint8_t *)"0123456789abcdef", NULL, &index));
    CHECK_FAILS(BHR_ERROR_NO_ADAPTER, "luid", bhr_adapter_find(NULL, (const uint8_t *)"01234567", &index));
    CHECK_FAILS(BAD, "options", bhr_target_options_init(NULL, sizeof options));
    CHECK_FAILS(BAD, "struct_size", bhr_target_options_init(&options, 4));
    options = good(BHR_TARGET_IMAGE);
    CHECK_FAILS(BAD, "context", bhr_target_create(NULL, &options, &target));
    CHECK_FAILS(BAD, "options", bhr_target_create(context, NULL, &target));
    CHECK_FAILS(BAD, "out_target", bhr_target_create(context, &options, NULL));
    CHECK_FAILS(BAD, "memory", bhr_target_import(context, &options, NULL, &handle, &target));
    CHECK_FAILS(BAD, "handle", bhr_target_import(context, &options, &memory, NULL, &target));
    CHECK_FAILS(BAD, "target", bhr_target_info(NULL, &memory));
    CHECK_FAILS(BAD, "target", bhr_target_export(NULL, &handle));
    CHECK(handle.fd == -1, "fd %d", handle.fd);
    CHECK_FAILS(BAD, "target", bhr_target_vulkan(NULL, &raw, &raw));
    CHECK_FAILS(BAD, "out_semaphore", bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, NULL));
    CHECK_FAILS(BAD, "kind", bhr_semaphore_create(context, 2, 0, &semaphore));
    CHECK_FAILS(BAD, "handle_type", bhr_semaphore_create(context, 0, 3, &semaphore));
    CHECK_FAILS(BAD, "handle_type", bhr_semaphore_create(context, 0, 1u << 20, &semaphore));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "handle_type", bhr_semaphore_create(context, 0, BHR_HANDLE_DMA_BUF, &semaphore));
    CHECK_FAILS(BAD, "semaphore", bhr_semaphore_wait(NULL, 1, 0));
    CHECK_FAILS(BAD, "semaphore", bhr_semaphore_signal(NULL, 1));
    CHECK_FAILS(BAD, "semaphore", bhr_semaphore_export(NULL, &handle));
    CHECK_FAILS(BAD, "semaphore", bhr_semaphore_vulkan(NULL, &raw));
    CHECK_FAILS(BAD, "target", bhr_render_target_async(context, NULL, NULL, NULL));
    bhr_target_destroy(NULL);
    bhr_semaphore_destroy(NULL);
}

/* Options that no device takes; `words` is what the message names. */
static void bad_options(void) {
    const struct {
        size_t      offset;
        uint32_t    value;
        BhrStatus   status;
        const char *words;
    } list[] = {
        {offsetof(BhrTargetOptions, struct_size), 8, BAD, "struct_size"},
        {offsetof(BhrTargetOptions, kind), 2, BAD, "kind"},
        {offsetof(BhrTargetOptions, kind), UINT32_MAX, BAD, "kind"},
        {offsetof(BhrTargetOptions, format), 0, BAD, "format"},
        {offsetof(BhrTargetOptions, format), 8, BAD, "format"},
        {offsetof(BhrTargetOptions, width), 0, BAD, "width"},
        {offsetof(BhrTargetOptions, height), (1u << 20) + 1, BAD, "height"},
        {offsetof(BhrTargetOptions, width), 1u << 20, BHR_ERROR_UNSUPPORTED, "images here have"},
        {offsetof(BhrTargetOptions, flags), BHR_IMAGE_BOTTOM_UP, BAD, "flags"},
        {offsetof(BhrTargetOptions, flags), BHR_TARGET_COPY, BAD, "flags"},
        {offsetof(BhrTargetOptions, handle_type), 3, BAD, "handle_type"},
        {offsetof(BhrTargetOptions, handle_type), 128, BAD, "handle_type"},
        {offsetof(BhrTargetOptions, handle_type), BHR_HANDLE_DMA_BUF, BHR_ERROR_UNSUPPORTED, "not built in"},
        {offsetof(BhrTargetOptions, handle_type), BHR_HANDLE_OPAQUE_WIN32, BHR_ERROR_UNSUPPORTED, "not built in"},
        {offsetof(BhrTargetOptions, handle_type), BHR_HANDLE_D3D12, BHR_ERROR_UNSUPPORTED, "not built in"},
        {offsetof(BhrTargetOptions, handle_type), BHR_HANDLE_APPLE, BHR_ERROR_UNSUPPORTED, "not built in"},
        {offsetof(BhrTargetOptions, handle_type), BHR_HANDLE_HOST_POINTER, BHR_ERROR_UNSUPPORTED, "handle_type"},
        {offsetof(BhrTargetOptions, layout), UINT32_MAX, BAD, "layout"},
        {offsetof(BhrTargetOptions, layout), 9, BAD, "layout"},
        {offsetof(BhrTargetOptions, layout), 77, BAD, "layout"},
        {offsetof(BhrTargetOptions, row_stride), 1024, BAD, "row_stride"},
    };
    BhrTarget *target;
    int        before = open_descriptors();
    for (size_t at = 0; at < COUNT_OF(list); at++) {
        BhrTargetOptions options = good(BHR_TARGET_IMAGE);
        memcpy((char *)&options + list[at].offset, &list[at].value, 4);
        CHECK_FAILS(list[at].status, list[at].words, bhr_target_create(context, &options, &target));
        CHECK(target == NULL, "not cleared");
    }
    BhrTargetOptions options = good(BHR_TARGET_BUFFER);
    options.row_stride = 252;
    CHECK_FAILS(BAD, "row_stride", bhr_target_create(context, &options, &target));
    options.row_stride = 258;
    CHECK_FAILS(BAD, "row_stride", bhr_target_create(context, &options, &target));
    options.row_stride = UINT64_MAX - 3;
    CHECK_FAILS(BAD, "row_stride", bhr_target_create(context, &options, &target));
    /* 4 GiB by 2^20 rows: whatever the driver says to that, it is no success that a frame could be written to. */
    options.row_stride = UINT32_MAX - 3u;
    options.height = 1u << 20;
    BhrStatus status = bhr_target_create(context, &options, &target);
    CHECK(status == BHR_ERROR_OUT_OF_MEMORY || status == BHR_ERROR_UNSUPPORTED, "2^52 bytes: status %d", status);
    CHECK(open_descriptors() == before, "%d descriptors before, %d after", before, open_descriptors());
}

/* Descriptors that are no memory stay the host's. */
static void bad_handles(const BhrInteropInfo *info) {
    BhrTargetOptions options = good(BHR_TARGET_BUFFER);
    BhrTarget       *source, *target;
    BhrTargetInfo    real = {.struct_size = sizeof real};
    BhrHandle        exported;
    int              pipes[2], sockets[2];
    int              file = open("/proc/self/exe", O_RDONLY), folder = open("/", O_RDONLY);
    int              null = open("/dev/null", O_RDWR);
    CHECK_OK(bhr_target_create(context, &options, &source));
    CHECK_OK(bhr_target_info(source, &real));
    CHECK_OK(bhr_target_export(source, &exported));
    CHECK(pipe(pipes) == 0 && socketpair(AF_UNIX, SOCK_STREAM, 0, sockets) == 0, "no pipes");
    int       before = open_descriptors();
    const int fds[] = {-1, -7, 12345, INT32_MAX, pipes[0], pipes[1], sockets[0], folder, null, file};
    for (size_t at = 0; at < COUNT_OF(fds); at++) {
        BhrHandle     handle = {BHR_HANDLE_OPAQUE_FD, fds[at], NULL};
        BhrSemaphore *semaphore;
        check_mark_message();
        BhrStatus status = bhr_target_import(context, &options, &real, &handle, &target);
        CHECK(status < BHR_OK && status != BHR_ERROR_INTERNAL && target == NULL, "fd %d: %s", fds[at],
              bhr_error_message());
        status = bhr_semaphore_import(context, BHR_SEMAPHORE_TIMELINE, &handle, &semaphore);
        CHECK(status < BHR_OK && status != BHR_ERROR_INTERNAL && semaphore == NULL, "fd %d", fds[at]);
    }
    CHECK(open_descriptors() == before, "%d descriptors before, %d after", before, open_descriptors());
    /* The right descriptor, described wrongly. */
    const struct {
        size_t      offset;
        uint64_t    value;
        size_t      bytes;
        const char *words;
    } list[] = {
        {offsetof(BhrTargetInfo, struct_size), 4, 4, "struct_size"},
        {offsetof(BhrTargetInfo, reserved), 1, 4, "reserved"},
        {offsetof(BhrTargetInfo, allocation_size), 0, 8, "allocation_size"},
        {offsetof(BhrTargetInfo, allocation_size), 100, 8, "allocation_size"},
        {offsetof(BhrTargetInfo, allocation_size), UINT64_MAX, 8, ""},
        {offsetof(BhrTargetInfo, allocation_size), UINT64_C(1) << 40, 8, ""},
        {offsetof(BhrTargetInfo, offset), 1, 8, "offset|allocation_size"},
        {offsetof(BhrTargetInfo, offset), UINT64_MAX, 8, "offset"},
        {offsetof(BhrTargetInfo, memory_type), 31, 4, "memory_type"},
        {offsetof(BhrTargetInfo, memory_type), UINT32_MAX, 4, "memory_type"},
    };
    for (size_t at = 0; at < COUNT_OF(list); at++) {
        BhrTargetInfo memory = real;
        memcpy((char *)&memory + list[at].offset, &list[at].value, list[at].bytes);
        check_mark_message();
        BhrStatus status = bhr_target_import(context, &options, &memory, &exported, &target);
        CHECK(status < BHR_OK && status != BHR_ERROR_INTERNAL, "case %zu: status %d", at, status);
        if (list[at].words[0])
            CHECK_FAILS(BAD, list[at].words, bhr_target_import(context, &options, &memory, &exported, &target));
        CHECK(fcntl(exported.fd, F_GETFD) != -1, "case %zu took the host's descriptor", at);
    }
    BhrHandle other = exported;
    other.type = 5;
    CHECK_FAILS(BAD, "type", bhr_target_import(context, &options, &real, &other, &target));
    other.type = BHR_HANDLE_HOST_POINTER;
    CHECK_FAILS(BAD, "type", bhr_target_import(context, &options, &real, &other, &target));
    options.handle_type = 0;
    CHECK_FAILS(BAD, "NULL", bhr_target_import(context, &options, &real, &other, &target));
    other.type = BHR_HANDLE_DMA_BUF;
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "not built in", bhr_target_import(context, &options, &real, &other, &target));
    options.handle_type = BHR_HANDLE_OPAQUE_FD;
    /* Images that nothing can write, or that are not what the memory was made for. */
    BhrTargetOptions image = good(BHR_TARGET_IMAGE);
    BhrTargetInfo    memory = real;
    memory.vk_usage = VK_IMAGE_USAGE_SAMPLED_BIT;
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "vk_usage", bhr_target_import(context, &image, &memory, &exported, &target));
    memory.vk_usage = VK_IMAGE_USAGE_STORAGE_BIT;
    memory.vk_tiling = VK_IMAGE_TILING_LINEAR;
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "vk_tiling", bhr_target_import(context, &image, &memory, &exported, &target));
    memory.vk_tiling = 0;
    memory.vk_flags = 0x40;
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "vk_flags", bhr_target_import(context, &image, &memory, &exported, &target));
    CHECK(open_descriptors() == before, "%d descriptors before, %d after", before, open_descriptors());
    frame_works(source);
    /* After all that, the right one. */
    CHECK_OK(bhr_target_import(context, &options, &real, &exported, &target));
    CHECK(open_descriptors() <= before, "the descriptor is still there");
    frame_works(target);
    bhr_target_destroy(target);
    bhr_target_destroy(source);
    /* Targets that were not made for export are not exported. */
    options.handle_type = 0;
    CHECK_OK(bhr_target_create(context, &options, &source));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "handle_type", bhr_target_export(source, &exported));
    CHECK(exported.fd == -1 && exported.handle == NULL, "fd %d", exported.fd);
    frame_works(source);
    bhr_target_destroy(source);
    if (!info->semaphores[BHR_SEMAPHORE_TIMELINE]) {
        BhrSemaphore *semaphore;
        CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "TIMELINE",
                    bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, BHR_HANDLE_OPAQUE_FD, &semaphore));
    }
    const int left[] = {pipes[0], pipes[1], sockets[0], sockets[1], folder, null, file};
    for (size_t at = 0; at < COUNT_OF(left); at++)
        CHECK(close(left[at]) == 0, "descriptor %d was closed", left[at]);
}

static void bad_frames(BhrBackend backend) {
    BhrContext      *stranger = check_context(backend);
    BhrTargetOptions options = good(BHR_TARGET_BUFFER);
    BhrTarget       *target, *floats, *strange;
    BhrSemaphore    *timeline, *binary, *other;
    BhrHandle        handle;
    options.handle_type = 0;
    CHECK_OK(bhr_target_create(context, &options, &target));
    CHECK_OK(bhr_target_create(stranger, &options, &strange));
    options.format = BHR_FORMAT_R32F;
    CHECK_OK(bhr_target_create(context, &options, &floats));
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &timeline));
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_BINARY, 0, &binary));
    CHECK_OK(bhr_semaphore_create(stranger, BHR_SEMAPHORE_TIMELINE, 0, &other));
    CHECK_FAILS(BAD, "another context", bhr_render_target(context, strange, NULL, NULL));
    CHECK_FAILS(BAD, "R32F", bhr_render_target(context, floats, NULL, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "handle_type", bhr_semaphore_export(timeline, &handle));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "BINARY", bhr_semaphore_wait(binary, 1, 0));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "BINARY", bhr_semaphore_signal(binary, 1));
    BhrSemaphoreValue one = {timeline, 5}, two[2] = {{timeline, 6}, {timeline, 7}}, null = {NULL, 1}, far = {other, 1},
                      old = {timeline, 5}, dual = {binary, 0};
    BhrSync sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &one}, wrong;
    CHECK_OK(bhr_render_target(context, target, &sync, NULL));
    CHECK_OK(bhr_semaphore_wait(timeline, 5, UINT64_MAX));
    CHECK(bhr_semaphore_wait(timeline, 6, 1000000) == BHR_NOT_READY, "value 6 is there");
    CHECK_FAILS(BAD, "grow", bhr_render_target(context, target, &sync, NULL));
    CHECK_FAILS(BAD, "grow", bhr_render_target_async(context, target, &sync, NULL));
    CHECK_FAILS(BAD, "value", bhr_semaphore_signal(timeline, 5));
    wrong = (BhrSync){.struct_size = 3};
    CHECK_FAILS(BAD, "struct_size", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .reserved = 1};
    CHECK_FAILS(BAD, "reserved", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .wait_count = 9, .waits = &one};
    CHECK_FAILS(BAD, "wait_count", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .signal_count = 1};
    CHECK_FAILS(BAD, "signals is NULL", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .wait_count = 1, .waits = &null};
    CHECK_FAILS(BAD, "waits[0]", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .signal_count = 2, .signals = two};
    CHECK_FAILS(BAD, "twice", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .signal_count = 1, .signals = &far};
    CHECK_FAILS(BAD, "another context", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .signal_count = 1, .signals = two};
    wrong.wait_count = 1, wrong.waits = &two[1];
    CHECK_FAILS(BAD, "grow", bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .signal_count = 1, .signals = &dual};
    CHECK_FAILS(BAD, "BINARY", bhr_render_target_async(context, target, &wrong, NULL));
    wrong.wait_count = 1, wrong.waits = &dual;
    CHECK_FAILS(BAD, "BINARY", bhr_render_target(context, target, &wrong, NULL));
    /* Refused frames wait for nothing and signal nothing. */
    CHECK(bhr_semaphore_wait(timeline, 6, 0) == BHR_NOT_READY, "a refused frame has signalled");
    sync.waits = &old, sync.wait_count = 1, sync.signals = two;
    CHECK_OK(bhr_render_target(context, target, &sync, NULL));
    CHECK_OK(bhr_semaphore_wait(timeline, 6, UINT64_MAX));
    /* A binary semaphore from one frame to the next. */
    wrong = (BhrSync){.struct_size = sizeof wrong, .signal_count = 1, .signals = &dual};
    CHECK_OK(bhr_render_target(context, target, &wrong, NULL));
    wrong = (BhrSync){.struct_size = sizeof wrong, .wait_count = 1, .waits = &dual};
    CHECK_OK(bhr_render_target(context, target, &wrong, NULL));
    /* A frame that waits until the CPU signals; a job behind it that is cancelled gives its signal in its turn. */
    BhrSemaphoreValue eight = {timeline, 8}, nine = {timeline, 9}, ten = {timeline, 10};
    BhrJob           *job, *cancelled;
    sync = (BhrSync){.struct_size = sizeof sync, .wait_count = 1, .waits = &eight, .signal_count = 1, .signals = &nine};
    CHECK_OK(bhr_render_target_async(context, target, &sync, &job));
    sync = (BhrSync){.struct_size = sizeof sync, .signal_count = 1, .signals = &ten};
    CHECK_OK(bhr_render_target_async(context, target, &sync, &cancelled));
    bhr_job_cancel(cancelled);
    CHECK(bhr_job_wait(job, 50000000, NULL) == BHR_NOT_READY, "it did not wait");
    CHECK_FAILS(BAD, "will signal 9", bhr_semaphore_signal(timeline, 12));
    CHECK_OK(bhr_semaphore_signal(timeline, 8));
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    BhrStatus status = bhr_job_wait(cancelled, UINT64_MAX, NULL);
    CHECK(status == BHR_OK || status == BHR_ERROR_CANCELLED, "status %d", status);
    CHECK_OK(bhr_semaphore_wait(timeline, 10, UINT64_MAX));
    bhr_job_destroy(job);
    bhr_job_destroy(cancelled);
    /* More than 64 frames that wait are refused, and none of them is lost. */
    uint32_t          taken = 0;
    BhrSemaphoreValue gate = {timeline, 11}, last = {timeline, 12};
    sync = (BhrSync){.struct_size = sizeof sync, .wait_count = 1, .waits = &gate, .signal_count = 1, .signals = &last};
    while ((status = bhr_render_target_async(context, target, &sync, NULL)) == BHR_OK && taken < 100)
        taken++, last.value++;
    CHECK(status == BHR_ERROR_INVALID_STATE && taken >= 60 && taken <= 64, "status %d after %u", status, taken);
    CHECK_OK(bhr_semaphore_signal(timeline, 11));
    CHECK_OK(bhr_semaphore_wait(timeline, last.value - 1, UINT64_MAX));
    frame_works(target);
    /* Their context ends first. */
    bhr_context_destroy(stranger);
    BhrTargetInfo info = {.struct_size = sizeof info};
    uint64_t      raw;
    CHECK_OK(bhr_target_info(strange, &info));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "destroyed", bhr_target_export(strange, &handle));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "destroyed", bhr_target_vulkan(strange, &raw, NULL));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "destroyed", bhr_semaphore_wait(other, 1, UINT64_MAX));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "destroyed", bhr_semaphore_signal(other, 1));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "destroyed", bhr_render_target(context, strange, NULL, NULL));
    bhr_target_destroy(strange);
    bhr_semaphore_destroy(other);
    /* And a recovery. */
    CHECK_OK(bhr_context_recover(context));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "recovered", bhr_render_target(context, target, NULL, NULL));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "recovered", bhr_semaphore_wait(timeline, 100, UINT64_MAX));
    bhr_target_destroy(target);
    bhr_target_destroy(floats);
    bhr_semaphore_destroy(timeline);
    bhr_semaphore_destroy(binary);
}

static void *finds_nothing(void *instance, const char *name) {
    (void)instance, (void)name;
    return NULL;
}

static int  released;
static void release(void *user) {
    (void)user;
    released++;
}

static void bad_devices(const BhrInteropInfo *info) {
    Vk                    host, old;
    BhrVulkanRequirements required = {.struct_size = sizeof required};
    BhrContextOptions     options;
    BhrContext           *made;
    vk_open_instance(&host, info->device_uuid, VK_API_VERSION_1_3, 0);
    CHECK_FAILS(BAD, "requirements", bhr_vulkan_requirements(PROC, host.instance, host.physical, NULL));
    CHECK_FAILS(BAD, "get_instance_proc_addr",
                bhr_vulkan_requirements(NULL, host.instance, host.physical, &required));
    CHECK_FAILS(BAD, "finds no", bhr_vulkan_requirements((BhrGetInstanceProcAddr)finds_nothing, host.instance,
                                                         host.physical, &required));
    CHECK_FAILS(BAD, "NULL", bhr_vulkan_requirements(PROC, NULL, host.physical, &required));
    CHECK_FAILS(BAD, "physical_device", bhr_vulkan_requirements(PROC, host.instance, (void *)&host, &required));
    CHECK_OK(bhr_vulkan_requirements(PROC, host.instance, host.physical, &required));
    vk_open_required(&host, &required);
    BhrVulkanDevice device = vk_for_bhr(&host), wrong;
    device.release = release;
    CHECK_FAILS(BAD, "device", bhr_context_create_vulkan(BHR_ABI_VERSION, NULL, NULL, &made));
    CHECK_FAILS(BAD, "out_context", bhr_context_create_vulkan(BHR_ABI_VERSION, NULL, &device, NULL));
    CHECK_FAILS(BHR_ERROR_INCOMPATIBLE_ABI, "", bhr_context_create_vulkan(99, NULL, &device, &made));
#define REFUSED(words, field, value)                                                                                   \
    (wrong = device, wrong.field = (value),                                                                            \
     CHECK_FAILS(BAD, words, bhr_context_create_vulkan(BHR_ABI_VERSION, NULL, &wrong, &made)))
    REFUSED("struct_size", struct_size, 7);
    REFUSED("get_instance_proc_addr", get_instance_proc_addr, NULL);
    REFUSED("instance", instance, NULL);
    REFUSED("physical_device", physical_device, NULL);
    REFUSED("physical_device", physical_device, &host);
    REFUSED("device", device, NULL);
    REFUSED("api_version", api_version, VK_API_VERSION_1_1);
    REFUSED("api_version", api_version, 0);
    REFUSED("queue_family", queue_family, 99);
    REFUSED("queue_index", queue_index, 99);
    REFUSED("VK_KHR_surface", instance_extension_count, 1);
    REFUSED("VK_KHR_get_physical_device_properties2", instance_extension_count, 0);
    REFUSED("instance_extensions", instance_extensions, NULL);
    REFUSED("device_extension", device_extension_count, 0);
    REFUSED("device_extension", device_extension_count, 100000);
    REFUSED("unlock", lock, release);
    const char *names[64];
    memcpy(names, host.device_extensions, sizeof names);
    names[0] = NULL;
    REFUSED("NULL", device_extensions, names);
    names[0] = "VK_KHR_made_up";
    REFUSED(host.device_extensions[0], device_extensions, names);
    options = check_options(BHR_BACKEND_CPU);
    CHECK_FAILS(BAD, "backend", bhr_context_create_vulkan(BHR_ABI_VERSION, &options, &device, &made));
    options = check_options(BHR_BACKEND_AUTO);
    options.adapter_index = 0;
    CHECK_FAILS(BAD, "adapter_index", bhr_context_create_vulkan(BHR_ABI_VERSION, &options, &device, &made));
    options = check_options(BHR_BACKEND_AUTO);
    options.flags = BHR_CONTEXT_VALIDATION;
    CHECK_FAILS(BAD, "VALIDATION", bhr_context_create_vulkan(BHR_ABI_VERSION, &options, &device, &made));
    CHECK(released == 0, "released after an error");
    /* An instance of an older version, whatever the host says of it: wgpu would end the process. */
    vk_open_instance(&old, NULL, VK_API_VERSION_1_0, 0);
    wrong = vk_for_bhr(&old);
    wrong.device = host.device;
    check_mark_message();
    CHECK(bhr_context_create_vulkan(BHR_ABI_VERSION, NULL, &wrong, &made) < BHR_OK, "version 1.0 was taken");
    vk_close(&old);
    /* The device serves after all that. */
    if (CHECK_OK(bhr_context_create_vulkan(BHR_ABI_VERSION, NULL, &device, &made))) {
        BhrTargetOptions image;
        BhrTarget       *target;
        BhrSemaphore    *semaphore;
        CHECK_OK(bhr_target_options_init(&image, sizeof image));
        image.width = image.height = 16;
        VkPicture picture = vk_make_image(&host, VK_FORMAT_R8G8B8A8_UNORM, 16, 16, VK_IMAGE_USAGE_STORAGE_BIT, NULL);
        uint64_t  raw = (uint64_t)picture.image;
        uint32_t  usage = picture.info.vk_usage;
        CHECK_FAILS(BAD, "vk_image", bhr_target_wrap_vulkan(made, &image, 0, usage, release, NULL, &target));
        CHECK_FAILS(BAD, "STORAGE", bhr_target_wrap_vulkan(made, &image, raw, 4, release, NULL, &target));
        CHECK_FAILS(BAD, "vk_semaphore", bhr_semaphore_wrap_vulkan(made, BHR_SEMAPHORE_TIMELINE, 0, &semaphore));
        image.flags = BHR_TARGET_COPY;
        CHECK_FAILS(BAD, "TRANSFER_DST", bhr_target_wrap_vulkan(made, &image, raw, usage, release, NULL, &target));
        image.flags = 0;
        image.kind = BHR_TARGET_BUFFER;
        CHECK_FAILS(BAD, "kind", bhr_target_wrap_vulkan(made, &image, raw, usage, release, NULL, &target));
        image.kind = BHR_TARGET_IMAGE;
        image.format = BHR_FORMAT_BGRA8_SRGB;
        BhrStatus status = bhr_target_wrap_vulkan(made, &image, raw, usage, release, NULL, &target);
        CHECK(status == BHR_ERROR_UNSUPPORTED, "status %d", status);
        CHECK(released == 0, "released after an error");
        bhr_context_destroy(made);
        CHECK(released == 1, "released %d times", released);
        vk_drop(&host, &picture);
    }
    vk_close(&host);
}

int main(int argc, char **argv) {
    BhrBackend backend = check_begin(argc, argv);
    context = check_context(backend);
    BhrInteropInfo info = {.struct_size = sizeof info};
    CHECK_OK(bhr_interop_info(context, &info));
    if (backend != BHR_BACKEND_VULKAN) {
        without_sharing();
    } else {
        nothing_given();
        bad_options();
        bad_handles(&info);
        bad_frames(backend);
        bad_devices(&info);
    }
    bhr_context_destroy(context);
    return check_end();
}
