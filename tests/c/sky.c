/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* sky.c -- the host's map of the sky asked wrongly and filled oddly: zero, huge, NaN-filled, of every format and of
 * none, at strange strides; and orientations that are no unit quaternions. A refusal leaves the context as it was;
 * what is taken gives a frame of finite light. */
#include "check.h"

#include <math.h>
#include <string.h>

#define WIDTH 48
#define HEIGHT 24
#define FRAME_WIDTH 32
#define FRAME_HEIGHT 18

static float map_pixels[WIDTH * HEIGHT * 4];

static void fill(float red, float green, float blue, float alpha) {
    const float pixel[4] = {red, green, blue, alpha};
    for (size_t i = 0; i < COUNT_OF(map_pixels); i++) {
        map_pixels[i] = pixel[i % 4];
    }
}

static void show(BhrContext *context, uint32_t flags) {
    BhrSky sky;
    CHECK_OK(bhr_sky_init(&sky, sizeof sky));
    sky.flags = flags;
    CHECK_OK(bhr_set_sky(context, &sky));
}

/* The largest light of a frame, every value of which must be finite and not negative. */
static float frame_light(BhrContext *context) {
    static float frame[FRAME_WIDTH * FRAME_HEIGHT * 4];
    BhrImage     target = image_of(BHR_FORMAT_RGBA32F, FRAME_WIDTH, FRAME_HEIGHT, frame, sizeof frame);
    float        largest = 0.0f;
    size_t       odd = 0;
    CHECK_OK(bhr_render_image(context, &target));
    for (size_t i = 0; i < COUNT_OF(frame); i++) {
        odd += !isfinite(frame[i]) || frame[i] < 0.0f;
        largest = i % 4 < 3 && frame[i] > largest ? frame[i] : largest;
    }
    CHECK(odd == 0, "%u values of a frame are no light", (unsigned)odd);
    return largest;
}

static void odd_content(BhrContext *context) {
    static const float values[] = {0.0f, -0.0f, -1.0f, 1e-40f, 1.0f, 1e30f, NAN, INFINITY, -INFINITY};
    BhrImage           map = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, map_pixels, sizeof map_pixels);
    show(context, BHR_SKY_MAP);
    for (size_t i = 0; i < COUNT_OF(values); i++) {
        const int lit = values[i] >= 1.0f;
        fill(values[i], values[i], values[i], values[i]);
        CHECK_OK(bhr_set_sky_map(context, &map));
        const float light = frame_light(context);
        CHECK((light > 0.5f) == lit, "a map of %g gives a frame of %g", (double)values[i], (double)light);
    }
    /* The map was copied. */
    fill(1.0f, 0.5f, 0.25f, 0.0f);
    CHECK_OK(bhr_set_sky_map(context, &map));
    fill(0.0f, 0.0f, 0.0f, 0.0f);
    CHECK(frame_light(context) > 0.5f, "a map is not copied, or its alpha counts");
    CHECK_OK(bhr_set_sky_map(context, NULL));
    CHECK(frame_light(context) == 0.0f, "a removed map is still there");
}

static void formats(Watch *watch) {
    static const BhrFormat good[] = {BHR_FORMAT_RGBA8_SRGB, BHR_FORMAT_BGRA8_SRGB, BHR_FORMAT_RGBA16F,
                                     BHR_FORMAT_RGBA32F};
    static const BhrFormat bad[] = {0, -1, 99, 1000, BHR_FORMAT_R32F};
    BhrImage               map = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, map_pixels, sizeof map_pixels);
    memset(map_pixels, 0x3c, sizeof map_pixels);
    for (size_t i = 0; i < COUNT_OF(good); i++) {
        map.format = good[i];
        CHECK_OK(bhr_set_sky_map(watch->context, &map));
    }
    watch_begin(watch, watch->context);
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        map.format = bad[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "format", bhr_set_sky_map(watch->context, &map));
    }
}

/* A map whose bottom row comes first is the same sky as its rows turned round. */
static void bottom_up(BhrContext *context, BhrImage map) {
    static float turned[WIDTH * HEIGHT * 4], seen[3][FRAME_WIDTH * FRAME_HEIGHT * 4], all[WIDTH * HEIGHT * 4];
    memcpy(all, map_pixels, sizeof all);
    for (size_t i = 0; i < COUNT_OF(turned); i++) {
        map_pixels[i] = (float)(i / (WIDTH * 4)) / HEIGHT;
    }
    for (size_t y = 0; y < HEIGHT; y++) {
        memcpy(turned + (HEIGHT - 1 - y) * WIDTH * 4, map_pixels + y * WIDTH * 4, WIDTH * 16);
    }
    for (int i = 0; i < 3; i++) {
        const BhrImage target = image_of(BHR_FORMAT_RGBA32F, FRAME_WIDTH, FRAME_HEIGHT, seen[i], sizeof seen[i]);
        map.pixels = i == 0 ? (void *)map_pixels : (void *)turned;
        map.flags = i == 1 ? BHR_IMAGE_BOTTOM_UP : 0;
        CHECK_OK(bhr_set_sky_map(context, &map));
        CHECK_OK(bhr_render_image(context, &target));
    }
    CHECK(memcmp(seen[0], seen[1], sizeof seen[0]) == 0, "a map whose bottom row comes first gives another sky");
    CHECK(memcmp(seen[0], seen[2], sizeof seen[0]) != 0, "a map upside down gives the same sky");
    memcpy(map_pixels, all, sizeof all);
    map.pixels = map_pixels;
    CHECK_OK(bhr_set_sky_map(context, &map));
}

static void shapes(Watch *watch) {
    const BhrImage good = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, map_pixels, sizeof map_pixels);
    static const uint32_t sizes[][2] = {{1, 1}, {1, HEIGHT}, {WIDTH, 1}, {3, 2}, {2, 5}, {WIDTH, HEIGHT}};
    BhrImage              map;
    fill(1.0f, 1.0f, 1.0f, 1.0f);
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        map = good;
        map.width = sizes[i][0];
        map.height = sizes[i][1];
        CHECK_OK(bhr_set_sky_map(watch->context, &map));
        CHECK(frame_light(watch->context) > 0.5f, "a map of %u x %u is dark", (unsigned)map.width,
              (unsigned)map.height);
        map.row_stride = -(int64_t)(WIDTH * 16);
        map.pixels = map_pixels + (size_t)(map.height - 1) * WIDTH * 4;
        CHECK_OK(bhr_set_sky_map(watch->context, &map));
    }
    bottom_up(watch->context, good);
    watch_begin(watch, watch->context);
    map = good;
    map.width = 0;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "width", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.height = 0x200000;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "height", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.pixels = NULL;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "pixels", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.pixels = (char *)map_pixels + 1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "pixels", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.byte_size--;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "byte_size", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.row_stride = WIDTH * 16 - 4;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "row_stride", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.row_stride = WIDTH * 16 + 2;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "row_stride", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.struct_size = 8;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_set_sky_map(watch->context, &map));
    map = good;
    map.reserved = 1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "reserved", bhr_set_sky_map(watch->context, &map));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_sky_map(NULL, &good));
}

/* Every sum of the flags that this version draws gives a frame; quaternions must be of unit length within 1e-3. */
static void flags_and_orientations(Watch *watch) {
    static const double bad[][4] = {{0, 0, 0, 0}, {0, 0, 0, 1.002}, {0.5, 0.5, 0.5, 0.4}, {0, 0, NAN, 1},
                                   {INFINITY, 0, 0, 1},
                                    {1e300, 1e300, 0, 0}, {1e-200, 0, 0, 0}};
    static const double good[][4] = {{0, 0, 0, -1}, {0.5, -0.5, 0.5, 0.5}, {0, 0, 0, 1.0009}, {1, 0, 0, 0}};
    const uint32_t      drawn[] = {0, BHR_SKY_STARS, BHR_SKY_MILKY_WAY, BHR_SKY_MAP, BHR_SKY_GRID,
                                   BHR_SKY_STARS | BHR_SKY_MILKY_WAY | BHR_SKY_MAP | BHR_SKY_GRID};
    BhrContext         *context = watch->context;
    BhrSky              sky;
    for (size_t i = 0; i < COUNT_OF(drawn); i++) {
        show(context, drawn[i]);
        frame_light(context);
    }
    watch_begin(watch, context);
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_OK(bhr_get_sky(context, (sky.struct_size = sizeof sky, &sky)));
        memcpy(sky.orientation, bad[i], sizeof sky.orientation);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "orientation", bhr_set_sky(context, &sky));
    }
    for (size_t i = 0; i < COUNT_OF(good); i++) {
        CHECK_OK(bhr_get_sky(context, (sky.struct_size = sizeof sky, &sky)));
        memcpy(sky.orientation, good[i], sizeof sky.orientation);
        CHECK_OK(bhr_set_sky(context, &sky));
        frame_light(context);
    }
    CHECK_OK(bhr_get_sky(context, (sky.struct_size = sizeof sky, &sky)));
    sky.map_brightness = 1e6;
    sky.stars_brightness = 1e6;
    fill(INFINITY, 1e30f, 65504.0f, 1.0f);
    const BhrImage map = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, map_pixels, sizeof map_pixels);
    CHECK_OK(bhr_set_sky_map(context, &map));
    CHECK_OK(bhr_set_sky(context, &sky));
    frame_light(context);
}

int main(int argc, char **argv) {
    BhrContext  *context = check_context(check_begin(argc, argv));
    static Watch watch;
    CHECK_OK(bhr_set_disk(context, NULL));
    watch_begin(&watch, context);
    odd_content(context);
    watch_begin(&watch, context);
    formats(&watch);
    shapes(&watch);
    flags_and_orientations(&watch);
    bhr_context_destroy(context);
    return check_end();
}
