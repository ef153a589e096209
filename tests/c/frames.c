/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* frames.c -- frames in the host's memory: every legal layout holds the same pixels and nothing else is written;
 * tiles make the whole; two runs are equal; the formats agree with each other. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 48u
#define HEIGHT 32u

static const BhrFormat FORMATS[] = {BHR_FORMAT_RGBA8_SRGB, BHR_FORMAT_BGRA8_SRGB, BHR_FORMAT_RGBA16F,
                                    BHR_FORMAT_RGBA32F};

/* The frame, packed, in memory the caller frees. */
static unsigned char *packed_frame(BhrContext *context, BhrFormat format) {
    const size_t   bytes = WIDTH * HEIGHT * bytes_per_pixel(format);
    unsigned char *pixels = malloc(bytes);
    const BhrImage image = image_of(format, WIDTH, HEIGHT, pixels, bytes);
    CHECK_OK(bhr_render_image(context, &image));
    return pixels;
}

/* ---- layouts ---- */

/* Rows from the top down; from the bottom up, said by a negative stride and by the flag. */
typedef enum Rows { TOP_DOWN, NEGATIVE, BOTTOM_UP, WAYS } Rows;
static const char *const ROWS[WAYS] = {"top-down", "negative", "bottom-up"};

/* Renders with `stride` into the middle of a larger block. Each row must equal the packed frame's, and every other
 * byte of the block must stay. */
static void check_layout(BhrContext *context, BhrFormat format, size_t stride, Rows rows, const unsigned char *packed) {
    const size_t   row = WIDTH * bytes_per_pixel(format), margin = 64;
    const size_t   needed = stride * (HEIGHT - 1) + row, bytes = needed + 2 * margin;
    unsigned char *block = malloc(bytes), *first = block + margin;
    memset(block, UNTOUCHED, bytes);
    BhrImage image = image_of(format, WIDTH, HEIGHT, first, needed);
    image.row_stride = (int64_t)stride;
    if (rows == NEGATIVE) {
        image.pixels = first + stride * (HEIGHT - 1);
        image.row_stride = -(int64_t)stride;
    } else if (rows == BOTTOM_UP) {
        image.flags = BHR_IMAGE_BOTTOM_UP;
        image.row_stride = stride == row ? 0 : (int64_t)stride;
    }
    CHECK_OK(bhr_render_image(context, &image));
    for (uint32_t y = 0; y < HEIGHT; y++) {
        const size_t at = margin + stride * (rows == TOP_DOWN ? y : HEIGHT - 1 - y);
        CHECK(memcmp(block + at, packed + y * row, row) == 0, "format %d, %s stride %u: row %u differs", (int)format,
              ROWS[rows], (unsigned)stride, (unsigned)y);
        memset(block + at, UNTOUCHED, row);
    }
    CHECK(all_untouched(block, bytes), "format %d, %s stride %u: a byte beside the rows was written", (int)format,
          ROWS[rows], (unsigned)stride);
    free(block);
}

static void layouts(BhrContext *context) {
    for (size_t i = 0; i < COUNT_OF(FORMATS); i++) {
        const BhrFormat format = FORMATS[i];
        const size_t    row = WIDTH * bytes_per_pixel(format);
        const size_t    channel = format == BHR_FORMAT_RGBA32F ? 4 : format == BHR_FORMAT_RGBA16F ? 2 : 1;
        unsigned char  *packed = packed_frame(context, format);
        for (Rows rows = TOP_DOWN; rows < WAYS; rows++) {
            check_layout(context, format, row, rows, packed);
            check_layout(context, format, row + channel, rows, packed); /* odd, for 8-bit formats */
            check_layout(context, format, row + 7 * channel, rows, packed);
            check_layout(context, format, row + 260, rows, packed);
            check_layout(context, format, 4096, rows, packed);
        }
        free(packed);
    }
    /* 8-bit pixels may begin anywhere. */
    static unsigned char block[WIDTH * HEIGHT * 4 + 3];
    unsigned char       *packed = packed_frame(context, BHR_FORMAT_RGBA8_SRGB);
    for (size_t shift = 1; shift <= 3; shift++) {
        const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, block + shift, WIDTH * HEIGHT * 4);
        CHECK_OK(bhr_render_image(context, &image));
        CHECK(memcmp(block + shift, packed, WIDTH * HEIGHT * 4) == 0, "shifted by %u bytes, the frame differs",
              (unsigned)shift);
    }
    free(packed);
}

/* ---- determinism, tiles ---- */

static void two_runs(BhrContext *context, BhrBackend backend) {
    for (size_t i = 0; i < COUNT_OF(FORMATS); i++) {
        const size_t   bytes = WIDTH * HEIGHT * bytes_per_pixel(FORMATS[i]);
        unsigned char *first = packed_frame(context, FORMATS[i]), *second = packed_frame(context, FORMATS[i]);
        CHECK(memcmp(first, second, bytes) == 0, "format %d: two runs differ", (int)FORMATS[i]);
        BhrContext *other = check_context(backend);
        free(second);
        second = packed_frame(other, FORMATS[i]);
        CHECK(memcmp(first, second, bytes) == 0, "format %d: another context's frame differs", (int)FORMATS[i]);
        bhr_context_destroy(other);
        free(first);
        free(second);
    }
}

/* Renders the frame in tiles of at most `tile_width` x `tile_height`, each straight into its place in `joined`. */
static void render_tiles(BhrContext *context, BhrFormat format, uint32_t tile_width, uint32_t tile_height,
                         unsigned char *joined) {
    const size_t pixel = bytes_per_pixel(format), stride = WIDTH * pixel;
    for (uint32_t y = 0; y < HEIGHT; y += tile_height) {
        for (uint32_t x = 0; x < WIDTH; x += tile_width) {
            BhrRegion      region = {.struct_size = sizeof region, .full_width = WIDTH, .full_height = HEIGHT};
            const uint32_t width = x + tile_width <= WIDTH ? tile_width : WIDTH - x;
            const uint32_t height = y + tile_height <= HEIGHT ? tile_height : HEIGHT - y;
            BhrImage       image = image_of(format, width, height, joined + y * stride + x * pixel,
                                            (height - 1) * stride + width * pixel);
            image.row_stride = (int64_t)stride;
            region.x = x;
            region.y = y;
            CHECK_OK(bhr_set_region(context, &region));
            CHECK_OK(bhr_render_image(context, &image));
        }
    }
    CHECK_OK(bhr_set_region(context, NULL));
}

/* In the first `formats` formats. */
static void tiles(BhrContext *context, size_t formats) {
    static const struct {
        uint32_t width, height;
    } sizes[] = {{16, 16}, {13, 7}, {WIDTH, 1}, {5, HEIGHT}};
    for (size_t i = 0; i < formats; i++) {
        const size_t   bytes = WIDTH * HEIGHT * bytes_per_pixel(FORMATS[i]);
        unsigned char *whole = packed_frame(context, FORMATS[i]), *joined = malloc(bytes);
        for (size_t k = 0; k < COUNT_OF(sizes); k++) {
            memset(joined, 0, bytes);
            render_tiles(context, FORMATS[i], sizes[k].width, sizes[k].height, joined);
            CHECK(memcmp(whole, joined, bytes) == 0, "format %d: tiles of %u x %u differ from the whole frame",
                  (int)FORMATS[i], (unsigned)sizes[k].width, (unsigned)sizes[k].height);
        }
        free(whole);
        free(joined);
    }
}

/* The rays of a region are those of the whole frame. */
static void tile_rays(BhrContext *context) {
    static BhrRay whole[WIDTH * HEIGHT], part[5 * 3];
    BhrRegion     region = {.struct_size = sizeof region, .full_width = WIDTH, .full_height = HEIGHT, .x = 11, .y = 6};
    CHECK_OK(bhr_camera_rays(context, WIDTH, HEIGHT, whole));
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_OK(bhr_camera_rays(context, 5, 3, part));
    CHECK_OK(bhr_set_region(context, NULL));
    for (uint32_t i = 0; i < COUNT_OF(part); i++) {
        const BhrRay *same = &whole[(6 + i / 5) * WIDTH + 11 + i % 5];
        CHECK(memcmp(&part[i], same, sizeof *same) == 0, "ray %u of the region differs", (unsigned)i);
    }
}

/* ---- pixel formats ---- */

static double half_to_double(uint16_t half) {
    const int    exponent = half >> 10 & 31, mantissa = half & 1023;
    const double size = exponent == 0 ? ldexp(mantissa, -24) : ldexp(1024 + mantissa, exponent - 25);
    return exponent == 31 ? NAN : half >> 15 ? -size : size;
}

static void formats_agree(BhrContext *context) {
    unsigned char *rgba = packed_frame(context, BHR_FORMAT_RGBA8_SRGB);
    unsigned char *bgra = packed_frame(context, BHR_FORMAT_BGRA8_SRGB);
    unsigned char *halves = packed_frame(context, BHR_FORMAT_RGBA16F);
    unsigned char *floats = packed_frame(context, BHR_FORMAT_RGBA32F);
    double         brightest = 0.0;
    size_t         swapped = 0, opaque = 0, not_finite = 0, unlike = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        const unsigned char *a = rgba + 4 * i, *b = bgra + 4 * i;
        uint16_t             half[4];
        float                value[4];
        memcpy(half, halves + 8 * i, sizeof half);
        memcpy(value, floats + 16 * i, sizeof value);
        swapped += a[0] == b[2] && a[1] == b[1] && a[2] == b[0] && a[3] == b[3];
        opaque += a[3] == 255 && half[3] == 0x3C00 && value[3] == 1.0f;
        for (int k = 0; k < 3; k++) {
            const double h = half_to_double(half[k]);
            not_finite += !isfinite(value[k]) || value[k] < 0.0f || !isfinite(h);
            /* binary16 holds 11 bits; half a unit in the last place, and a little for subnormals. */
            unlike += fabs(h - value[k]) > fabs(value[k]) * 0x1p-11 + 0x1p-25;
            brightest = fmax(brightest, value[k]);
        }
    }
    CHECK(swapped == WIDTH * HEIGHT, "BGRA is RGBA with red and blue swapped in %u pixels only", (unsigned)swapped);
    CHECK(opaque == WIDTH * HEIGHT, "alpha is 1 in %u pixels only", (unsigned)opaque);
    CHECK(not_finite == 0, "%u channels are negative or not finite", (unsigned)not_finite);
    CHECK(unlike == 0, "%u channels of RGBA16F are not RGBA32F's, rounded", (unsigned)unlike);
    CHECK(brightest > 0.05, "the brightest channel is %g: an empty picture", brightest);
    free(rgba);
    free(bgra);
    free(halves);
    free(floats);
}

/* Premultiplied alpha = 1 - the sky's share: without a disk the hole is opaque and black, the sky is nothing at all. */
static void transparent(BhrContext *context) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    static const double  position[3] = {0.0, -30.0, 5.0}, up[3] = {0.0, 0.0, 1.0}, hole[3] = {0.0, 0.0, 0.0};
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    BhrCamera            camera;
    image.flags = BHR_IMAGE_TRANSPARENT;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    CHECK_OK(bhr_camera_look_at(&camera, position, hole, up));
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_disk(context, NULL));
    CHECK_OK(bhr_render_image(context, &image));
    static const unsigned char clear[4] = {0, 0, 0, 0}, black[4] = {0, 0, 0, 255};
    const unsigned char       *middle = pixels + (HEIGHT / 2 * WIDTH + WIDTH / 2) * 4;
    CHECK(memcmp(pixels, clear, 4) == 0, "the sky is (%u, %u, %u, %u)", pixels[0], pixels[1], pixels[2], pixels[3]);
    CHECK(memcmp(middle, black, 4) == 0, "the hole is (%u, %u, %u, %u)", middle[0], middle[1], middle[2], middle[3]);
    BhrDisk disk;
    CHECK_OK(bhr_disk_init(&disk, sizeof disk));
    CHECK_OK(bhr_set_disk(context, &disk));
}

/* A frame is of the scene as it is when asked for, so a scene set back gives the same bytes whatever was rendered
 * between. */
static void history(BhrContext *context) {
    unsigned char *before = packed_frame(context, BHR_FORMAT_RGBA32F);
    CHECK_OK(bhr_set_spin(context, 0.9));
    CHECK_OK(bhr_set_mass(context, 1.1));
    unsigned char *other = packed_frame(context, BHR_FORMAT_RGBA32F);
    CHECK(memcmp(before, other, WIDTH * HEIGHT * 16) != 0, "spin and mass change nothing");
    free(other);
    CHECK_OK(bhr_set_spin(context, 0.0));
    CHECK_OK(bhr_set_mass(context, 1.0));
    other = packed_frame(context, BHR_FORMAT_RGBA32F);
    CHECK(memcmp(before, other, WIDTH * HEIGHT * 16) == 0, "the frame depends on what was rendered before");
    free(other);
    free(before);
}

/* ---- prepared frames ---- */

static int32_t count_calls(void *user, double fraction) {
    (void)fraction;
    ++*(int *)user;
    return 1;
}

/* Without a target it is for windows, whose frames have BhrQuality.render_scale: smaller ones have fewer parts. */
static void prepared_windows(BhrContext *context, BhrBackend backend) {
    const double scales[] = {1.0, 0.1};
    int          calls[COUNT_OF(scales)] = {0, 0};
    BhrQuality   quality, usual;
    quality.struct_size = usual.struct_size = sizeof quality;
    CHECK_OK(bhr_get_quality(context, &usual));
    quality = usual;
    quality.method = BHR_METHOD_RK4; /* more work, and so more parts */
    for (size_t i = 0; i < COUNT_OF(scales); i++) {
        quality.render_scale = scales[i];
        CHECK_OK(bhr_set_quality(context, &quality));
        CHECK_OK(bhr_set_progress(context, count_calls, &calls[i]));
        CHECK_OK(bhr_prepare(context, NULL));
    }
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
    CHECK_OK(bhr_set_quality(context, &usual));
    CHECK(backend == BHR_BACKEND_CPU || (calls[1] >= 1 && calls[1] < calls[0]), "%d and %d reports", calls[0],
          calls[1]);
}

/* A window shows the six faces as large as they fit; an image has their shape. */
static void prepared_cubes(BhrContext *context) {
    BhrCamera camera, usual;
    camera.struct_size = usual.struct_size = sizeof camera;
    CHECK_OK(bhr_get_camera(context, &usual));
    camera = usual;
    camera.projection = BHR_PROJECTION_CUBE;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_prepare(context, NULL));
    const BhrImage cube = image_of(BHR_FORMAT_RGBA8_SRGB, 96, 16, NULL, 0);
    CHECK_OK(bhr_prepare(context, &cube));
    const BhrImage other = image_of(BHR_FORMAT_RGBA8_SRGB, 96, 17, NULL, 0);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "6 times", bhr_prepare(context, &other));
    CHECK_OK(bhr_set_camera(context, &usual));
}

/* A frame that was prepared is rendered as it would have been without, and no frame is counted. */
static void prepared(BhrContext *context, BhrBackend backend) {
    BhrFrameStats before, after;
    BhrContext   *other = check_context(backend);
    CHECK_OK(bhr_set_spin(other, 0.3));
    unsigned char *unprepared = packed_frame(other, BHR_FORMAT_RGBA8_SRGB);
    bhr_context_destroy(other);
    before.struct_size = after.struct_size = sizeof before;
    CHECK_OK(bhr_set_spin(context, 0.3));
    CHECK_OK(bhr_frame_stats(context, &before));
    const BhrImage nowhere = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, NULL, 0);
    CHECK_OK(bhr_prepare(context, &nowhere));
    CHECK_OK(bhr_frame_stats(context, &after));
    CHECK(after.frame_index == before.frame_index, "frame %u after %u", (unsigned)after.frame_index,
          (unsigned)before.frame_index);
    unsigned char *later = packed_frame(context, BHR_FORMAT_RGBA8_SRGB);
    CHECK(memcmp(later, unprepared, WIDTH * HEIGHT * 4) == 0, "a frame that was prepared is another one");
    CHECK_OK(bhr_set_spin(context, 0.0));
    free(later), free(unprepared);

    CHECK_OK(bhr_prepare(context, NULL));
    prepared_windows(context, backend);
    prepared_cubes(context);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_prepare(NULL, &nowhere));
    BhrImage bad = nowhere;
    bad.width = 0;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "width is 0", bhr_prepare(context, &bad));
    bad = nowhere, bad.format = 77;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "format is 77", bhr_prepare(context, &bad));
    bad = nowhere, bad.flags = 1u << 30;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_prepare(context, &bad));
    bad = nowhere, bad.flags = BHR_IMAGE_BOTTOM_UP, bad.row_stride = -(int64_t)WIDTH * 4;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "BHR_IMAGE_BOTTOM_UP", bhr_prepare(context, &bad));
    bad = nowhere, bad.struct_size = 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_prepare(context, &bad));
    bad = nowhere, bad.format = BHR_FORMAT_R32F;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "R32F", bhr_prepare(context, &bad));
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    BhrContext      *context = check_context(backend);
    layouts(context);
    two_runs(context, backend);
    tiles(context, COUNT_OF(FORMATS));
    tile_rays(context);
    formats_agree(context);
    history(context);
    prepared(context, backend);
    transparent(context);
    BhrQuality quality;
    CHECK_OK(bhr_quality_init(&quality, sizeof quality));
    quality.samples_per_pixel = 3;
    CHECK_OK(bhr_set_quality(context, &quality));
    tiles(context, check_runs_all() ? COUNT_OF(FORMATS) : 1);
    bhr_context_destroy(context);
    return check_end();
}
