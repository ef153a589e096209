/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* outputs.c -- outputs beside the picture in targets on the GPU, and in the host's memory with them: their bytes are
 * those of bhr_render_outputs, in buffers, buffers with strides and images, alone and all together, however the frame's
 * rays are found; with semaphores and as jobs; and what is refused, which changes nothing.
 * Arguments: vulkan [validate]. */
#include "share.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define WIDTH 107u
#define HEIGHT 45u
#define MOST (WIDTH * HEIGHT * 16u)
#define BAD BHR_ERROR_INVALID_ARGUMENT

static unsigned char expected[BHR_MAX_OUTPUTS][MOST];
static unsigned char seen[4 * MOST];
static unsigned char memory[BHR_MAX_OUTPUTS][MOST + 16];
/* The outputs (bits) that go into the host's memory, not into targets. */
static uint32_t in_memory;

static const struct {
    BhrOutputKind kind;
    uint32_t      index;
    BhrFormat     format;
    uint32_t      bytes;
} kinds[BHR_MAX_OUTPUTS] = {
    {BHR_OUTPUT_DEPTH, 0, BHR_FORMAT_R32F, 4},       {BHR_OUTPUT_LIGHT, 0, BHR_FORMAT_RGBA16F, 8},
    {BHR_OUTPUT_SKY, 0, BHR_FORMAT_RGBA32F, 16},     {BHR_OUTPUT_TRANSMISSION, 0, BHR_FORMAT_R32F, 4},
    {BHR_OUTPUT_POSITION, 0, BHR_FORMAT_RGBA32F, 16}, {BHR_OUTPUT_DISK, 1, BHR_FORMAT_RGBA32F, 16},
    {BHR_OUTPUT_VIEW, BHR_VIEW_REDSHIFT, BHR_FORMAT_R32F, 4},
    {BHR_OUTPUT_VIEW, BHR_VIEW_DEFLECTION, BHR_FORMAT_R32F, 4},
};

static BhrTarget *target_of(BhrFormat format, BhrTargetKind kind, uint64_t stride, uint32_t flags) {
    BhrTargetOptions options = share_options(format, kind, WIDTH, HEIGHT, stride);
    options.flags = flags;
    return share_make(&options);
}

static BhrOutput output_of(size_t at, BhrTarget *target) {
    BhrOutput output;
    CHECK_OK(bhr_output_init(&output, sizeof output));
    output.kind = kinds[at].kind;
    output.index = kinds[at].index;
    output.target = target;
    return output;
}

/* An output into the host's memory. */
static BhrOutput imaged(size_t at, BhrImage *image, void *pixels, uint32_t flags) {
    BhrOutput output = output_of(at, NULL);
    *image = image_of(kinds[at].format, WIDTH, HEIGHT, pixels, MOST);
    image->flags = kinds[at].kind == BHR_OUTPUT_LIGHT ? flags : 0;
    output.image = image;
    return output;
}

/* The outputs of `chosen` (bits) in the host's memory. */
static void expect(uint32_t chosen, uint32_t flags) {
    BhrImage  images[BHR_MAX_OUTPUTS];
    BhrOutput outputs[BHR_MAX_OUTPUTS];
    uint32_t  count = 0;
    for (size_t at = 0; at < BHR_MAX_OUTPUTS; at++) {
        if (!(chosen >> at & 1))
            continue;
        outputs[count] = imaged(at, &images[count], expected[at], flags);
        count++;
    }
    CHECK_OK(bhr_render_outputs(context, outputs, sizeof *outputs, count, NULL));
}

typedef enum Way { BUFFERS, STRIDES, IMAGES, MIXED } Way;

/* Renders `chosen` into targets, and what is in_memory of it into images, and compares. */
static void compare(uint32_t chosen, Way way, uint32_t flags, int async, const char *what) {
    BhrTarget   *targets[BHR_MAX_OUTPUTS] = {0};
    VkPicture    pictures[BHR_MAX_OUTPUTS];
    BhrOutput    outputs[BHR_MAX_OUTPUTS];
    uint64_t     strides[BHR_MAX_OUTPUTS];
    BhrImage     images[BHR_MAX_OUTPUTS];
    BhrSemaphore *done;
    BhrJob       *job = NULL;
    uint32_t     count = 0;
    expect(chosen, flags);
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &done));
    for (size_t at = 0; at < BHR_MAX_OUTPUTS; at++) {
        if (!(chosen >> at & 1))
            continue;
        if (in_memory >> at & 1) {
            memset(memory[at], 0x77, sizeof memory[at]);
            outputs[count] = imaged(at, &images[count], memory[at], flags);
            count++;
            continue;
        }
        int      image = way == IMAGES || (way == MIXED && at % 2);
        uint64_t row = (uint64_t)WIDTH * kinds[at].bytes, stride = way == STRIDES ? row + 4 * (at + 1) : row;
        strides[at] = stride;
        targets[at] = target_of(kinds[at].format, image ? BHR_TARGET_IMAGE : BHR_TARGET_BUFFER,
                                way == STRIDES ? stride : 0, kinds[at].kind == BHR_OUTPUT_LIGHT ? flags : 0);
        pictures[at] = share_import(targets[at], stride * (HEIGHT - 1) + row);
        outputs[count++] = output_of(at, targets[at]);
    }
    BhrSemaphoreValue signal = {done, 1};
    BhrSync           sync = {.struct_size = sizeof sync, .signal_count = 1, .signals = &signal};
    CHECK_OK(async ? bhr_render_outputs_shared_async(context, outputs, sizeof *outputs, count, &sync, &job)
                   : bhr_render_outputs_shared(context, outputs, sizeof *outputs, count, &sync, &job));
    CHECK_OK(bhr_semaphore_wait(done, 1, UINT64_MAX));
    for (size_t at = 0; at < BHR_MAX_OUTPUTS; at++) {
        if (!((chosen & ~in_memory) >> at & 1))
            continue;
        uint64_t row = (uint64_t)WIDTH * kinds[at].bytes, stride = strides[at];
        uint32_t wrong = 0;
        double   apart = 0;
        memset(seen, 0x77, sizeof seen);
        vk_read(&host, &pictures[at], VK_QUEUE_FAMILY_EXTERNAL, kinds[at].bytes, stride * (HEIGHT - 1) + row, NULL,
                seen);
        for (uint32_t y = 0; y < HEIGHT; y++)
            if (memcmp(seen + y * stride, expected[at] + y * row, row) != 0)
                wrong++, apart = fmax(apart, vk_apart(kinds[at].format, seen + y * stride, expected[at] + y * row,
                                                      row));
        CHECK(apart <= vk_most_apart(context, BHR_TARGET_IMAGE, kinds[at].format),
              "%s, way %d: output %zu differs in %u rows, up to %g",
              what, (int)way, at, wrong, apart);
    }
    if (job) {
        BhrFrameStats stats = {.struct_size = sizeof stats};
        CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
        CHECK_OK(bhr_job_stats(job, &stats));
        CHECK(stats.rays >= WIDTH * HEIGHT, "%llu rays", (unsigned long long)stats.rays);
    }
    for (size_t at = 0; at < BHR_MAX_OUTPUTS; at++) {
        if (!((chosen & in_memory) >> at & 1))
            continue;
        size_t bytes = (size_t)WIDTH * HEIGHT * kinds[at].bytes;
        int    same = memcmp(memory[at], expected[at], bytes) == 0;
        double apart = same ? 0 : vk_apart(kinds[at].format, memory[at], expected[at], bytes);
        /* The picture is made by the kernel of bhr_render_image. */
        double most = at == 1 ? 0 : vk_most_apart(context, BHR_TARGET_IMAGE, kinds[at].format);
        CHECK(same || (at != 1 && apart <= most), "%s, way %d: output %zu in memory differs, up to %g", what, (int)way,
              at, apart);
        CHECK(memory[at][bytes] == 0x77, "%s: output %zu is written beyond its end", what, at);
    }
    bhr_job_destroy(job);
    for (size_t at = 0; at < BHR_MAX_OUTPUTS; at++)
        if ((chosen & ~in_memory) >> at & 1) {
            bhr_target_destroy(targets[at]);
            vk_drop(&host, &pictures[at]);
        }
    bhr_semaphore_destroy(done);
}

/* A part of a frame so large that its rays are looked up in tables, or a small frame, whose rays are traced. */
static void set_frame(int large) {
    BhrRegion region = {.struct_size = sizeof region, .full_width = 1920, .full_height = 1080, .x = 905, .y = 510};
    CHECK_OK(bhr_set_region(context, large ? &region : NULL));
}

static void set_disk(double opacity, double turbulence) {
    BhrDisk disk = {.struct_size = sizeof disk};
    int32_t present;
    CHECK_OK(bhr_get_disk(context, &disk, &present));
    disk.opacity = opacity;
    disk.turbulence = turbulence;
    CHECK_OK(bhr_set_disk(context, &disk));
}

enum { ALL = 0xff, THREE = 7, RAYS_ONLY = 0xfd, DEPTH_ONLY = 1, LIGHT_ONLY = 2 };

/* However rays are found, with disks that hide and disks that do not: in `tests/run all` each with each, everyday one
 * look for small frames without spin and one for large ones with it. */
static void scenes(void) {
    for (int spins = 0; spins < 2; spins++)
        for (int large = 0; large < 2; large++)
            for (int look = 0; look < 3; look++) {
                char what[80];
                if (!check_runs_all() && (spins != large || look != 1 + spins))
                    continue;
                snprintf(what, sizeof what, "spin %g, large %d, look %d", spins ? 0.9 : 0.0, large, look);
                CHECK_OK(bhr_set_spin(context, spins ? 0.9 : 0));
                set_frame(large);
                set_disk(look == 1 ? 0.5 : 1, look == 2 ? 0.6 : 0);
                compare(ALL, look == 0 ? MIXED : STRIDES, 0, 0, what);
                compare(THREE, look == 1 ? IMAGES : BUFFERS, look == 1 ? BHR_IMAGE_TRANSPARENT : 0, 1, what);
                compare(look == 1 ? DEPTH_ONLY : RAYS_ONLY, BUFFERS, 0, look == 2, what);
            }
    set_disk(1, 0);
    for (int large = 0; large < 2; large++) {
        set_frame(large);
        share_set_quality(5, 0);
        compare(THREE, BUFFERS, 0, 0, "5 samples");
    }
    set_frame(0);
    share_set_quality(1, 0.4);
    compare(THREE, IMAGES, 0, 0, "glare");
    share_set_quality(3, 0.4);
    compare(ALL, MIXED, 0, 1, "3 samples and glare");
    share_set_quality(1, 0);
    compare(LIGHT_ONLY, IMAGES, 0, 0, "the picture alone");
    BhrVolume volume;
    CHECK_OK(bhr_volume_init(&volume, sizeof volume));
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
    compare(ALL, BUFFERS, 0, 0, "a volume");
    CHECK_OK(bhr_set_volumes(context, NULL, sizeof volume, 0));
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
}

/* Some outputs in the host's memory, others in targets, from one frame; and all in the host's memory. */
static void mixed(void) {
    static const uint32_t masks[] = {LIGHT_ONLY, RAYS_ONLY, DEPTH_ONLY, 0x55, 0x3c, ALL};
    for (size_t i = 0; i < COUNT_OF(masks); i++) {
        char what[80];
        int  large = i % 2;
        /* Everyday three of them, without the tables of a spinning hole's lens, which scenes() has made. */
        int  spins = check_runs_all() && i % 3 != 0;
        if (!check_runs_all() && i % 2 == 0)
            continue;
        snprintf(what, sizeof what, "in memory 0x%x", masks[i]);
        in_memory = masks[i];
        CHECK_OK(bhr_set_spin(context, spins ? 0.9 : 0));
        set_frame(large);
        compare(ALL, MIXED, BHR_IMAGE_TRANSPARENT, large, what);
        compare(THREE, IMAGES, 0, !large, what);
        compare(RAYS_ONLY, STRIDES, 0, large, what);
    }
    CHECK_OK(bhr_set_spin(context, 0));
    set_frame(0);
    in_memory = 0x35;
    share_set_quality(3, 0.4);
    compare(ALL, MIXED, 0, 1, "in memory, 3 samples and glare");
    share_set_quality(5, 0);
    in_memory = LIGHT_ONLY;
    compare(THREE, BUFFERS, 0, 0, "in memory, 5 samples");
    share_set_quality(1, 0);
    in_memory = 0;
}

/* The host's things are in the picture, and in no other output. */
static void occluded(void) {
    static float distances[WIDTH * HEIGHT];
    BhrImage     image = image_of(BHR_FORMAT_R32F, WIDTH, HEIGHT, distances, sizeof distances);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        distances[i] = i % WIDTH < WIDTH / 2 ? 24.0f : INFINITY;
    CHECK_OK(bhr_set_occluder(context, &image));
    compare(THREE, BUFFERS, BHR_IMAGE_TRANSPARENT, 0, "an occluder");
    compare(RAYS_ONLY, IMAGES, 0, 0, "an occluder");
    CHECK_OK(bhr_set_occluder(context, NULL));
}

/* Writes `pixels` into a picture of the host's, which bhr is to read. */
static void fill(const VkPicture *picture, const float *pixels, size_t stride) {
    static unsigned char rows[2 * MOST];
    memset(rows, 0xff, sizeof rows);
    for (uint32_t y = 0; y < HEIGHT; y++)
        memcpy(rows + y * stride, pixels + (size_t)y * WIDTH, WIDTH * sizeof *pixels);
    vk_write(&host, picture, VK_QUEUE_FAMILY_EXTERNAL, 4, stride, stride * (HEIGHT - 1) + WIDTH * sizeof *pixels, rows);
}

/* The host's things on the GPU: pictures are those with the same distances from host memory, which change from frame to
 * frame. `stride` 0: an image. */
static void occluder_on_gpu(BhrTargetKind kind, uint64_t stride, int hosts_memory) {
    static float   distances[WIDTH * HEIGHT], in_memory[WIDTH * HEIGHT * 4], from_gpu[WIDTH * HEIGHT * 4];
    uint64_t       row = WIDTH * 4, step = stride ? stride : row;
    uint64_t       bytes = step * (HEIGHT - 1) + row;
    BhrTarget     *target = NULL, *light = target_of(BHR_FORMAT_RGBA16F, BHR_TARGET_IMAGE, 0, BHR_IMAGE_TRANSPARENT);
    VkPicture      picture, seen_light = share_import(light, 0);
    BhrImage       image = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, in_memory, sizeof in_memory);
    BhrImage       given = image_of(BHR_FORMAT_R32F, WIDTH, HEIGHT, distances, sizeof distances);
    unsigned char *expected_light = expected[1];
    image.flags = BHR_IMAGE_TRANSPARENT;
    if (hosts_memory) {
        BhrTargetOptions options = share_options(BHR_FORMAT_R32F, kind, WIDTH, HEIGHT, stride);
        picture = share_host_memory(&options, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, bytes,
                                    &target);
    } else {
        target = target_of(BHR_FORMAT_R32F, kind, stride, 0);
        picture = share_import(target, bytes);
    }
    for (int frame = 0; frame < 4; frame++) {
        for (uint32_t y = 0; y < HEIGHT; y++)
            for (uint32_t x = 0; x < WIDTH; x++)
                distances[y * WIDTH + x] =
                    (x * 3 + y + 40 * (uint32_t)frame) % 97 < 50 ? 20.0f + (float)(x % 16) : INFINITY;
        image.format = BHR_FORMAT_RGBA32F;
        image.pixels = in_memory;
        image.byte_size = sizeof in_memory;
        given.flags = frame % 2 ? BHR_IMAGE_LENSED : 0;
        CHECK_OK(bhr_set_occluder(context, &given));
        CHECK_OK(bhr_render_image(context, &image));
        image.format = BHR_FORMAT_RGBA16F;
        image.pixels = expected_light;
        image.byte_size = MOST;
        CHECK_OK(bhr_render_image(context, &image));
        fill(&picture, distances, step);
        CHECK_OK(bhr_set_occluder_target(context, target, given.flags));
        image.format = BHR_FORMAT_RGBA32F;
        image.pixels = from_gpu;
        image.byte_size = sizeof from_gpu;
        CHECK_OK(bhr_render_image(context, &image));
        double apart = vk_apart(BHR_FORMAT_RGBA32F, from_gpu, in_memory, sizeof in_memory);
        CHECK(apart <= vk_most_apart(context, BHR_TARGET_IMAGE, BHR_FORMAT_RGBA32F),
              "kind %d, stride %u, frame %d: %g apart", kind, (unsigned)stride, frame, apart);
        BhrOutput output = output_of(1, light);
        BhrJob   *job;
        fill(&picture, distances, step);
        CHECK_OK(frame % 2 ? bhr_render_outputs_shared_async(context, &output, sizeof output, 1, NULL, &job)
                           : bhr_render_outputs_shared(context, &output, sizeof output, 1, NULL, &job));
        share_finish(job);
        vk_read(&host, &seen_light, VK_QUEUE_FAMILY_EXTERNAL, 8, 0, NULL, seen);
        apart = vk_apart(BHR_FORMAT_RGBA16F, seen, expected_light, WIDTH * HEIGHT * 8);
        CHECK(apart <= vk_most_apart(context, BHR_TARGET_IMAGE, BHR_FORMAT_RGBA16F), "into a target: %g apart", apart);
    }
    /* The occluder's target is destroyed while it is set: frames say so until another is set. */
    fill(&picture, distances, step);
    BhrOutput output = output_of(0, target);
    CHECK_FAILS(BAD, "occluder", bhr_render_outputs_shared(context, &output, sizeof output, 1, NULL, NULL));
    CHECK_FAILS(BAD, "occluder", bhr_render_target(context, target, NULL, NULL));
    output = output_of(1, light);
    CHECK_OK(bhr_render_outputs_shared(context, &output, sizeof output, 1, NULL, NULL)); /* in flight while it goes */
    bhr_target_destroy(target);
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "occluder", bhr_render_image(context, &image));
    CHECK_OK(bhr_set_occluder_target(context, NULL, 0));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(memcmp(from_gpu, in_memory, sizeof in_memory) != 0, "the occluder is still there");
    bhr_target_destroy(light);
    vk_drop(&host, &picture);
    vk_drop(&host, &seen_light);
}

/* Rows of which no binding of 128 MiB, as lavapipe has them, holds more than one. */
static void occluder_far_rows(void) {
    enum { ROWS = 3 };
    static float     distances[ROWS][WIDTH], one[ROWS * WIDTH * 4], other[ROWS * WIDTH * 4];
    size_t           stride = ((size_t)140 << 20) + 4, room = ROWS * stride / 65536 * 65536 + 65536;
    BhrTargetOptions options = share_options(BHR_FORMAT_R32F, BHR_TARGET_BUFFER, WIDTH, ROWS, stride);
    BhrTargetInfo    info = {.struct_size = sizeof info, .allocation_size = room};
    BhrHandle        handle = {BHR_HANDLE_HOST_POINTER, -1, NULL};
    BhrTarget       *target;
    BhrImage         image = image_of(BHR_FORMAT_RGBA32F, WIDTH, ROWS, one, sizeof one);
    BhrImage         given = image_of(BHR_FORMAT_R32F, WIDTH, ROWS, distances, sizeof distances);
    char            *rows =
        mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (!CHECK(rows != MAP_FAILED, "no memory"))
        return;
    for (uint32_t y = 0; y < ROWS; y++) {
        for (uint32_t x = 0; x < WIDTH; x++)
            distances[y][x] = (x + 5 * y) % 23 < 9 ? 2.0f : INFINITY;
        memcpy(rows + y * stride, distances[y], sizeof distances[y]);
    }
    image.flags = BHR_IMAGE_TRANSPARENT;
    options.handle_type = BHR_HANDLE_HOST_POINTER;
    handle.handle = rows;
    CHECK_OK(bhr_set_occluder(context, &given));
    CHECK_OK(bhr_render_image(context, &image));
    if (CHECK_OK(bhr_target_import(context, &options, &info, &handle, &target))) {
        image.pixels = other;
        CHECK_OK(bhr_set_occluder_target(context, target, 0));
        CHECK_OK(bhr_render_image(context, &image));
        CHECK(memcmp(one, other, sizeof one) == 0, "rows of distances %zu bytes apart", stride);
        CHECK_OK(bhr_set_occluder_target(context, NULL, 0));
        bhr_target_destroy(target);
        CHECK_OK(bhr_render_image(context, &image));
        CHECK(memcmp(one, other, sizeof one) != 0, "the occluder makes no change");
    }
    munmap(rows, room);
}

/* A side that no texture has. */
static void occluder_too_long(Watch *watch, uint32_t width, uint32_t height) {
    BhrTargetOptions options = share_options(BHR_FORMAT_R32F, BHR_TARGET_BUFFER, width, height, 0);
    BhrTarget       *target = share_make(&options);
    char             words[40];
    snprintf(words, sizeof words, "%u x %u; textures", width, height);
    CHECK_REFUSED(watch, BHR_ERROR_UNSUPPORTED, words, bhr_set_occluder_target(context, target, 0));
    bhr_target_destroy(target);
}

static void occluder_refused(BhrBackend backend) {
    BhrTarget  *colours = target_of(BHR_FORMAT_RGBA16F, BHR_TARGET_IMAGE, 0, 0);
    BhrTarget  *depth = target_of(BHR_FORMAT_R32F, BHR_TARGET_BUFFER, 0, 0);
    BhrContext *other = check_context(backend);
    BhrImage    image;
    Watch       watch;
    watch_begin(&watch, context);
    CHECK_FAILS(BAD, "context", bhr_set_occluder_target(NULL, depth, 0));
    CHECK_REFUSED(&watch, BAD, "R32F", bhr_set_occluder_target(context, colours, 0));
    CHECK_FAILS(BAD, "another context", bhr_set_occluder_target(other, depth, 0));
    CHECK_REFUSED(&watch, BAD, "flags 0x1", bhr_set_occluder_target(context, depth, BHR_IMAGE_TRANSPARENT));
    occluder_too_long(&watch, 16385, 1);
    occluder_too_long(&watch, 1, 16385);
    CHECK_OK(bhr_set_occluder_target(context, depth, 0));
    CHECK_OK(bhr_image_init(&image, sizeof image));
    image.width = WIDTH, image.height = 4, image.pixels = seen, image.byte_size = sizeof seen;
    CHECK_FAILS(BAD, "the occluder is", bhr_render_image(context, &image));
    CHECK_OK(bhr_set_occluder(context, NULL));
    CHECK_OK(bhr_render_image(context, &image));
    bhr_context_destroy(other);
    bhr_target_destroy(colours);
    bhr_target_destroy(depth);
}

/* Many frames into one set of targets, that go on their way without being waited for. */
static void many(void) {
    BhrTarget *targets[3];
    BhrOutput  outputs[3];
    BhrSemaphore *done;
    BhrFrameStats first = {.struct_size = sizeof first}, last = {.struct_size = sizeof last};
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &done));
    for (size_t at = 0; at < 3; at++) {
        targets[at] = target_of(kinds[at].format, BHR_TARGET_IMAGE, 0, 0);
        outputs[at] = output_of(at, targets[at]);
    }
    for (uint64_t frame = 1; frame <= 60; frame++) {
        BhrSemaphoreValue wait = {done, frame - 1}, signal = {done, frame};
        BhrSync sync = {.struct_size = sizeof sync, .wait_count = frame > 1, .signal_count = 1, .waits = &wait};
        sync.signals = &signal;
        CHECK_OK(bhr_set_spin(context, frame % 3 ? 0 : 0.5));
        CHECK_OK(bhr_render_outputs_shared(context, outputs, sizeof *outputs, 1 + frame % 3, &sync, NULL));
        if (frame == 20)
            CHECK_OK(bhr_semaphore_wait(done, 20, UINT64_MAX)), bhr_frame_stats(context, &first);
    }
    CHECK_OK(bhr_semaphore_wait(done, 60, UINT64_MAX));
    CHECK_OK(bhr_frame_stats(context, &last));
    /* Each frame on its way may have a staging buffer, of a few bytes. */
    CHECK(last.device_bytes <= first.device_bytes + 8192, "device memory: %llu bytes early, %llu late",
          (unsigned long long)first.device_bytes, (unsigned long long)last.device_bytes);
    for (size_t at = 0; at < 3; at++)
        bhr_target_destroy(targets[at]);
    bhr_semaphore_destroy(done);
    CHECK_OK(bhr_set_spin(context, 0));
}

static void refused(BhrBackend backend) {
    BhrTarget *depth = target_of(BHR_FORMAT_R32F, BHR_TARGET_BUFFER, 0, 0);
    BhrTarget *sky = target_of(BHR_FORMAT_RGBA32F, BHR_TARGET_IMAGE, 0, 0);
    BhrTarget *light = target_of(BHR_FORMAT_RGBA8_SRGB, BHR_TARGET_IMAGE, 0, 0);
    BhrOutput  list[9], one;
    BhrImage   image;
    BhrJob    *job = (BhrJob *)&one;
    BhrSync    sync = {.struct_size = sizeof sync, .reserved = 1};
    Watch      watch;
    watch_begin(&watch, context);
    for (size_t i = 0; i < COUNT_OF(list); i++)
        list[i] = output_of(0, depth);
#define SHARED(outputs, count) bhr_render_outputs_shared(context, outputs, sizeof(BhrOutput), count, NULL, &job)
#define REFUSED(status, words, call) CHECK_REFUSED(&watch, status, words, call), CHECK(job == NULL, "not cleared")
    CHECK_FAILS(BAD, "context", bhr_render_outputs_shared(NULL, list, sizeof *list, 1, NULL, NULL));
    CHECK_FAILS(BAD, "context", bhr_render_outputs_shared_async(NULL, list, sizeof *list, 1, NULL, NULL));
    REFUSED(BAD, "outputs", SHARED(NULL, 1));
    REFUSED(BAD, "output count is 0", SHARED(list, 0));
    REFUSED(BAD, "9", SHARED(list, 9));
    REFUSED(BAD, "size", bhr_render_outputs_shared(context, list, 8, 1, NULL, &job));
    REFUSED(BAD, "sync", bhr_render_outputs_shared(context, list, sizeof *list, 1, &sync, &job));
    REFUSED(BAD, "outputs[0] target", (one = output_of(0, NULL), SHARED(&one, 1)));
    REFUSED(BAD, "that of another", SHARED(list, 2));
    REFUSED(BAD, "takes RGBA32F", (one = output_of(2, depth), SHARED(&one, 1)));
    REFUSED(BAD, "takes R32F", (one = output_of(0, sky), SHARED(&one, 1)));
    REFUSED(BAD, "R32F holds views", (one = output_of(1, depth), SHARED(&one, 1)));
    REFUSED(BAD, "frame of its own", (one = output_of(6, depth), one.index = BHR_VIEW_STEPS, SHARED(&one, 1)));
    REFUSED(BAD, "second LIGHT", (list[0] = output_of(1, light), list[1] = output_of(1, sky), SHARED(list, 2)));
    REFUSED(BAD, "kind", (one = output_of(0, depth), one.kind = 99, SHARED(&one, 1)));
    REFUSED(BAD, "index", (one = output_of(0, depth), one.index = 1, SHARED(&one, 1)));
    REFUSED(BAD, "reserved", (one = output_of(0, depth), one.reserved = 1, SHARED(&one, 1)));
    CHECK_OK(bhr_image_init(&image, sizeof image));
    one = output_of(0, depth);
    one.image = &image;
    REFUSED(BAD, "an image and a target", SHARED(&one, 1));
    one = imaged(0, &image, seen, 0);
    CHECK_REFUSED(&watch, BAD, "out_job is NULL",
                  bhr_render_outputs_shared(context, &one, sizeof one, 1, NULL, NULL));
    CHECK_REFUSED(&watch, BAD, "out_job is NULL",
                  bhr_render_outputs_shared_async(context, &one, sizeof one, 1, NULL, NULL));
    REFUSED(BAD, "image pixels is NULL", (image.pixels = NULL, SHARED(&one, 1)));
    REFUSED(BAD, "image format is R32F; its kind takes RGBA32F", (one = imaged(0, &image, seen, 0),
                                                                  one.kind = BHR_OUTPUT_SKY, SHARED(&one, 1)));
    REFUSED(BAD, "outputs[1] image is 107 x 44", (list[0] = output_of(2, sky), list[1] = imaged(0, &image, seen, 0),
                                                  image.height--, SHARED(list, 2)));
    REFUSED(BAD, "second LIGHT", (list[0] = output_of(1, light), list[1] = imaged(1, &image, seen, 0),
                                  SHARED(list, 2)));
    one = output_of(0, depth);
    REFUSED(BAD, "bhr_render_outputs_shared", bhr_render_outputs(context, &one, sizeof one, 1, &job));
    REFUSED(BAD, "bhr_render_outputs_shared", bhr_save_outputs(context, &one, sizeof one, 1, "none.exr"));
    BhrTargetOptions options;
    BhrTarget       *small;
    CHECK_OK(bhr_target_options_init(&options, sizeof options));
    options.kind = BHR_TARGET_BUFFER, options.format = BHR_FORMAT_R32F, options.width = WIDTH, options.height = 7;
    CHECK_OK(bhr_target_create(context, &options, &small));
    list[0] = output_of(2, sky), list[1] = output_of(0, small);
    REFUSED(BAD, "one size", SHARED(list, 2));
    bhr_target_destroy(small);
    BhrRegion region = {.struct_size = sizeof region, .full_width = 50, .full_height = 50};
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_FAILS(BAD, "", (one = output_of(0, depth), SHARED(&one, 1)));
    CHECK_OK(bhr_set_region(context, NULL));
    BhrContext *other = check_context(backend);
    CHECK_FAILS(BAD, "another context", bhr_render_outputs_shared(other, &one, sizeof one, 1, NULL, NULL));
    bhr_context_destroy(other);
    BhrSemaphore     *binary;
    BhrSemaphoreValue use = {NULL, 0};
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_BINARY, 0, &binary));
    use.semaphore = binary;
    sync.reserved = 0, sync.signal_count = 1, sync.signals = &use;
    REFUSED(BAD, "BINARY", bhr_render_outputs_shared_async(context, &one, sizeof one, 1, &sync, &job));
    CHECK_OK(SHARED(&one, 1));
    share_finish(job);
    bhr_semaphore_destroy(binary);
    bhr_target_destroy(depth);
    bhr_target_destroy(sky);
    bhr_target_destroy(light);
}

int main(int argc, char **argv) {
    BhrBackend backend = share_begin(argc, argv);
    share_set_quality(1, 0);
    mixed();
    scenes();
    occluded();
    for (int hosts_memory = 0; hosts_memory < 2; hosts_memory++) {
        occluder_on_gpu(BHR_TARGET_IMAGE, 0, hosts_memory);
        occluder_on_gpu(BHR_TARGET_BUFFER, 0, hosts_memory);
        occluder_on_gpu(BHR_TARGET_BUFFER, WIDTH * 4 + 36, hosts_memory);
    }
    if (can.import_buffers & BHR_HANDLE_HOST_POINTER)
        occluder_far_rows();
    occluder_refused(backend);
    many();
    refused(backend);
    return share_end();
}
