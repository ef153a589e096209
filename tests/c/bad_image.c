/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_image.c -- images asked wrongly: sizes, strides, block sizes, alignment, formats, regions. Each refusal leaves
 * the context and every byte of the host's memory as it was. Files are in files.c, legal layouts in frames.c. */
#include "check.h"

#include <stdlib.h>
#include <string.h>

#define WIDTH 24u
#define HEIGHT 16u
#define PACKED (WIDTH * HEIGHT * 4u)

/* Doubles, so that it is aligned for every format; room for strides wider than a row. */
static double block[4096];

static BhrImage good_image(void) {
    memset(block, UNTOUCHED, sizeof block);
    return image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, block, PACKED);
}

static void check_bad(Watch *watch, const BhrImage *image, BhrStatus expected, const char *words, int line) {
    check_mark_message();
    check_fails(bhr_render_image(watch->context, image), expected, words, __FILE__, line, "bhr_render_image");
    check_unchanged(watch, __FILE__, line, "bhr_render_image");
    CHECK(all_untouched(block, sizeof block), "line %d: a refused image was written to", line);
}
#define CHECK_BAD(image, words) check_bad(watch, &(image), BHR_ERROR_INVALID_ARGUMENT, words, __LINE__)

static void sizes(Watch *watch) {
    static const struct {
        uint32_t width, height;
    } bad[] = {{0, HEIGHT},          {WIDTH, 0},          {0, 0},
               {UINT32_MAX, HEIGHT}, {WIDTH, UINT32_MAX}, {UINT32_MAX, UINT32_MAX},
               {0x80000000u, 2},     {0x40000000u, 1},    {65536, 65536}};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        BhrImage image = good_image();
        image.width = bad[i].width;
        image.height = bad[i].height;
        CHECK_BAD(image, "width|height|size|byte_size|x");
    }
    /* A block said to be large enough does not make a frame of 2^32 pixels a side possible. */
    BhrImage image = good_image();
    image.width = UINT32_MAX;
    image.height = UINT32_MAX;
    image.byte_size = UINT64_MAX;
    CHECK_BAD(image, "width|height|size");
}

static void blocks(Watch *watch) {
    BhrImage image = good_image();
    image.byte_size = PACKED - 1;
    CHECK_BAD(image, "byte_size");
    image = good_image();
    image.byte_size = 0;
    CHECK_BAD(image, "byte_size");
    image = good_image();
    image.pixels = NULL;
    CHECK_BAD(image, "pixels");
    /* With a stride, the block needs (height - 1) |stride| + one row: one byte less is refused, for both directions. */
    for (int sign = -1; sign <= 1; sign += 2) {
        image = good_image();
        image.row_stride = sign * (int64_t)(WIDTH * 4 + 12);
        image.byte_size = (HEIGHT - 1) * (WIDTH * 4 + 12) + WIDTH * 4 - 1;
        if (sign < 0) {
            image.pixels = (unsigned char *)block + (HEIGHT - 1) * (WIDTH * 4 + 12);
        }
        CHECK_BAD(image, "byte_size");
    }
}

static void strides(Watch *watch) {
    static const int64_t bad[] = {1, WIDTH * 4 - 1, -1, -(int64_t)(WIDTH * 4 - 1)};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        BhrImage image = good_image();
        image.row_stride = bad[i];
        image.byte_size = sizeof block;
        CHECK_BAD(image, "row_stride");
    }
    static const int64_t enormous[] = {INT64_MAX, INT64_MIN, INT64_MIN + 1, INT64_MAX / 15, (int64_t)1 << 60};
    for (size_t i = 0; i < COUNT_OF(enormous); i++) {
        BhrImage image = good_image();
        image.row_stride = enormous[i];
        image.byte_size = sizeof block;
        CHECK_BAD(image, "row_stride|byte_size");
    }
}

static void alignment(Watch *watch) {
    static const struct {
        BhrFormat format;
        size_t    offset;
        int64_t   stride; /* 0: the pixels are misaligned; else the stride of aligned pixels is */
    } bad[] = {
        {BHR_FORMAT_RGBA16F, 1, 0},
        {BHR_FORMAT_RGBA32F, 1, 0},
        {BHR_FORMAT_RGBA32F, 2, 0},
        {BHR_FORMAT_RGBA16F, 0, 24 * 8 + 1},
        {BHR_FORMAT_RGBA32F, 0, 24 * 16 + 2},
    };
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        BhrImage image = good_image();
        image.format = bad[i].format;
        image.pixels = (unsigned char *)block + bad[i].offset;
        image.row_stride = bad[i].stride;
        image.byte_size = sizeof block - 8;
        CHECK_BAD(image, bad[i].stride == 0 ? "pixels|align" : "row_stride|align");
    }
}

static void constants(Watch *watch) {
    static const BhrFormat unknown[] = {0, 99, -1, 1000, INT32_MIN};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        BhrImage image = good_image();
        image.format = unknown[i];
        image.byte_size = sizeof block;
        CHECK_BAD(image, "format");
    }
    BhrImage image = good_image();
    for (uint32_t flag = 4; flag != 0; flag <<= 1) {
        image = good_image();
        image.flags = flag | BHR_IMAGE_BOTTOM_UP;
        CHECK_BAD(image, "flags");
    }
    image = good_image();
    image.reserved = 1;
    CHECK_BAD(image, "reserved");
    image = good_image();
    image.reserved2 = 1;
    CHECK_BAD(image, "reserved");
    image = good_image();
    image.colour_space = BHR_COLOUR_SPACE_ACESCG;
    CHECK_BAD(image, "colour_space");
    /* Light is four channels. */
    image = good_image();
    image.format = BHR_FORMAT_R32F;
    CHECK_BAD(image, "R32F|format");
}

/* With BHR_IMAGE_BOTTOM_UP pixels is the lowest address, and a negative stride makes no sense. */
static void bottom_up(Watch *watch) {
    static const int64_t negative[] = {-1, -(int64_t)(WIDTH * 4), -(int64_t)(WIDTH * 4 + 12), INT64_MIN};
    for (size_t i = 0; i < COUNT_OF(negative); i++) {
        BhrImage image = good_image();
        image.flags = BHR_IMAGE_BOTTOM_UP;
        image.row_stride = negative[i];
        image.byte_size = sizeof block;
        CHECK_BAD(image, "BHR_IMAGE_BOTTOM_UP");
    }
    static const int64_t bad[] = {1, WIDTH * 4 - 1, INT64_MAX, (int64_t)1 << 60};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        BhrImage image = good_image();
        image.flags = BHR_IMAGE_BOTTOM_UP | BHR_IMAGE_TRANSPARENT;
        image.row_stride = bad[i];
        image.byte_size = sizeof block;
        CHECK_BAD(image, i < 2 ? "row_stride" : "row_stride|byte_size");
    }
    BhrImage image = good_image();
    image.flags = BHR_IMAGE_BOTTOM_UP;
    image.byte_size = PACKED - 1;
    CHECK_BAD(image, "byte_size");
    image.row_stride = WIDTH * 4 + 12;
    image.byte_size = (HEIGHT - 1) * (WIDTH * 4 + 12) + WIDTH * 4 - 1;
    CHECK_BAD(image, "byte_size");
    image = good_image();
    image.flags = BHR_IMAGE_BOTTOM_UP;
    image.pixels = NULL;
    CHECK_BAD(image, "pixels");
    image.pixels = (unsigned char *)(UINTPTR_MAX - PACKED / 2 + 1);
    CHECK_BAD(image, "address space");
    image.format = BHR_FORMAT_RGBA32F;
    image.byte_size = sizeof block;
    image.pixels = (unsigned char *)block + 2;
    CHECK_BAD(image, "pixels|align");
}

static void views_and_formats(Watch *watch) {
    const BhrStatus status = bhr_set_view(watch->context, BHR_VIEW_ORDER);
    if (status == BHR_ERROR_UNSUPPORTED) {
        return;
    }
    CHECK(status == BHR_OK, "BHR_VIEW_ORDER: %s", bhr_error_message());
    watch_begin(watch, watch->context);
    BhrImage image = good_image();
    image.format = BHR_FORMAT_RGBA32F;
    image.byte_size = WIDTH * HEIGHT * 16;
    CHECK_BAD(image, "view|format");
    image.format = BHR_FORMAT_RGBA16F;
    CHECK_BAD(image, "view|format");
    image = good_image();
    image.format = BHR_FORMAT_R32F;
    CHECK_OK(bhr_render_image(watch->context, &image));
    CHECK_OK(bhr_set_view(watch->context, BHR_VIEW_LIGHT));
    watch_begin(watch, watch->context);
}

static void struct_sizes(Watch *watch) {
    struct {
        BhrImage      known;
        unsigned char tail[16];
    } grown;
    memset(&grown, UNTOUCHED, sizeof grown);
    CHECK_OK(bhr_image_init(&grown.known, sizeof grown));
    CHECK(grown.tail[0] == 0 && grown.tail[15] == 0, "bhr_image_init left the tail");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "image", bhr_image_init(NULL, sizeof grown));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_image_init(&grown.known, FIRST_IMAGE - 1));
    memset(&grown, 0, sizeof grown);
    grown.known = good_image();
    grown.known.struct_size = sizeof grown;
    grown.tail[3] = 1;
    CHECK_BAD(grown.known, "struct_size");
    grown.tail[3] = 0;
    grown.known.struct_size = FIRST_IMAGE - 1;
    CHECK_BAD(grown.known, "struct_size");
    grown.known.struct_size = 0;
    CHECK_BAD(grown.known, "struct_size");
    for (uint32_t size = FIRST_IMAGE; size <= sizeof grown; size++) {
        memset(block, UNTOUCHED, sizeof block);
        grown.known.struct_size = size;
        CHECK_OK(bhr_render_image(watch->context, &grown.known));
        CHECK(memcmp(block, watch->frame, sizeof watch->frame) == 0, "struct_size %u gives another frame",
              (unsigned)size);
    }

    BhrImage image = good_image();
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "target", bhr_render_image(watch->context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_render_image(NULL, &image));
    CHECK(all_untouched(block, sizeof block), "a refused image was written to");
}

/* ---- regions ---- */

static BhrRegion region_of(uint32_t full_width, uint32_t full_height, uint32_t x, uint32_t y) {
    BhrRegion region;
    memset(&region, 0, sizeof region);
    region.struct_size = sizeof region;
    region.full_width = full_width;
    region.full_height = full_height;
    region.x = x;
    region.y = y;
    return region;
}

static void regions(Watch *watch) {
    static const struct {
        uint32_t full_width, full_height, x, y;
    } bad[] = {{0, 100, 0, 0},          {100, 0, 0, 0},       {100, 100, 100, 0},          {100, 100, 0, 100},
               {100, 100, UINT32_MAX, 0}, {100, 100, 0, UINT32_MAX}, {UINT32_MAX, UINT32_MAX, 0, 0}};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        const BhrRegion region = region_of(bad[i].full_width, bad[i].full_height, bad[i].x, bad[i].y);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "region|full_width|full_height",
                      bhr_set_region(watch->context, &region));
    }
    BhrRegion region = region_of(100, 100, 0, 0);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_region(NULL, &region));
    region.reserved = 1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "reserved", bhr_set_region(watch->context, &region));
    region.reserved = 0;
    region.struct_size = FIRST_REGION - 1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_set_region(watch->context, &region));

    /* The region is fine, the image does not fit into its frame. */
    static const struct {
        uint32_t x, y;
    } overrun[] = {{100 - WIDTH + 1, 0}, {0, 100 - HEIGHT + 1}, {99, 99}};
    for (size_t i = 0; i < COUNT_OF(overrun); i++) {
        region = region_of(100, 100, overrun[i].x, overrun[i].y);
        CHECK_OK(bhr_set_region(watch->context, &region));
        BhrImage image = good_image();
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "region|full_width|full_height|frame",
                    bhr_render_image(watch->context, &image));
        CHECK(all_untouched(block, sizeof block), "an image that overruns its frame was written to");
    }
    region = region_of(100, 100, 100 - WIDTH, 100 - HEIGHT);
    CHECK_OK(bhr_set_region(watch->context, &region));
    BhrImage image = good_image();
    CHECK_OK(bhr_render_image(watch->context, &image));
    CHECK_OK(bhr_set_region(watch->context, NULL));
    check_unchanged(watch, __FILE__, __LINE__, "the region taken away");
}

/* ---- what may come in a later version: it works or says that it does not, and changes nothing ---- */

static void jobs(Watch *watch) {
    BhrImage image = good_image();
    BhrJob  *job = (BhrJob *)block;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_render_image_async(NULL, &image, &job));
    CHECK(job == NULL, "out_job is not NULL after a failure");
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "target", bhr_render_image_async(watch->context, NULL, &job));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_job", bhr_render_image_async(watch->context, &image, NULL));
    const BhrStatus status = bhr_render_image_async(watch->context, &image, &job);
    if (status == BHR_ERROR_UNSUPPORTED) {
        CHECK(job == NULL && bhr_error_message()[0] != '\0', "UNSUPPORTED without a message, or with a job");
        CHECK(all_untouched(block, sizeof block), "an unsupported job wrote to its target");
        return;
    }
    double fraction = -1.0;
    CHECK(status == BHR_OK, "bhr_render_image_async: %s", bhr_error_message());
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, &fraction));
    CHECK(fraction == 1.0, "a finished job is done to %g", fraction);
    CHECK(memcmp(block, watch->frame, sizeof watch->frame) == 0, "a job gives another frame");
    bhr_job_destroy(job);
}

static void sky_map(Watch *watch) {
    BhrImage image = good_image();
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_sky_map(NULL, &image));
    image.byte_size = PACKED - 1;
    check_mark_message();
    const BhrStatus status = bhr_set_sky_map(watch->context, &image);
    CHECK(status == BHR_ERROR_INVALID_ARGUMENT || status == BHR_ERROR_UNSUPPORTED, "a short map gives %s",
          bhr_status_name(status));
    check_unchanged(watch, __FILE__, __LINE__, "bhr_set_sky_map");
}

int main(int argc, char **argv) {
    BhrContext  *context = check_context(check_begin(argc, argv));
    static Watch watch;
    watch_begin(&watch, context);
    CHECK(watch.frame_status == BHR_OK, "the default scene cannot be rendered: %s", bhr_error_message());
    sizes(&watch);
    blocks(&watch);
    strides(&watch);
    alignment(&watch);
    constants(&watch);
    bottom_up(&watch);
    views_and_formats(&watch);
    struct_sizes(&watch);
    regions(&watch);
    jobs(&watch);
    sky_map(&watch);
    bhr_context_destroy(context);
    return check_end();
}
