/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* sky.c -- the host's surroundings from a target on the GPU: pictures are those with the same map from host memory,
 * within one step of 255, whatever holds the map and however often it changes; and what is refused. Arguments: vulkan
 * [validate]. */
#include "share.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 200u
#define HEIGHT 120u
#define MAP_WIDTH 509u
#define MAP_HEIGHT 251u
#define BAD BHR_ERROR_INVALID_ARGUMENT

static unsigned char from_memory[WIDTH * HEIGHT * 4], from_gpu[WIDTH * HEIGHT * 4];
static float         map[MAP_WIDTH * MAP_HEIGHT * 4];
static uint16_t      halves[MAP_WIDTH * MAP_HEIGHT * 4];
static unsigned char rows[sizeof map + MAP_HEIGHT * 64];

/* A half float of what lies in 2^-14 .. 65504, cut off. */
static uint16_t half(float value) {
    uint32_t bits;
    memcpy(&bits, &value, 4);
    return value < 6.2e-5f ? 0 : (uint16_t)((bits >> 13) - (112u << 10));
}

/* Smooth light, lines, a chequerboard and points; another for each `frame`. */
static void paint(uint32_t frame) {
    for (uint32_t y = 0; y < MAP_HEIGHT; y++)
        for (uint32_t x = 0; x < MAP_WIDTH; x++) {
            float *texel = map + 4 * (y * MAP_WIDTH + x);
            float  wave = 0.5f + 0.5f * sinf(0.02f * (float)(x + 60 * frame)) * cosf(0.03f * (float)y);
            int    line = (x + 7 * frame) % 32 == 0 || y % 25 == 0, point = (x * 31 + y * 17 + frame) % 997 == 0;
            texel[0] = 0.3f * wave + (line ? 0.6f : 0.0f) + (point ? 900.0f : 0.0f);
            texel[1] = 0.2f + (((x / 9) + (y / 9)) % 2 ? 0.25f : 0.0f) + (point ? 700.0f : 0.0f);
            texel[2] = 0.4f - 0.3f * wave + (point ? 500.0f : 0.0f);
            texel[3] = 0.5f;
        }
    map[0] = -1.0f, map[5] = NAN, map[10] = INFINITY;
    for (size_t i = 0; i < COUNT_OF(map); i++) {
        halves[i] = i == 0 ? 0xbc00 : i == 5 ? 0x7e00 : i == 10 ? 0x7c00 : half(map[i]);
    }
}

static void render(unsigned char *pixels) {
    BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, WIDTH * HEIGHT * 4);
    memset(pixels, 0, WIDTH * HEIGHT * 4);
    CHECK_OK(bhr_render_image(context, &image));
}

static void compare(BhrFormat format, BhrTargetKind kind, uint64_t gap) {
    uint32_t         bytes = format == BHR_FORMAT_RGBA16F ? 8 : 16;
    uint64_t         row = (uint64_t)MAP_WIDTH * bytes, stride = row + gap, all = stride * (MAP_HEIGHT - 1) + row;
    BhrTargetOptions options = share_options(format, kind, MAP_WIDTH, MAP_HEIGHT, gap ? stride : 0);
    BhrTarget       *target = share_make(&options);
    if (!target)
        return;
    VkPicture picture = share_import(target, all);
    for (uint32_t frame = 0; frame < 3; frame++) {
        const unsigned char *texels = format == BHR_FORMAT_RGBA16F ? (unsigned char *)halves : (unsigned char *)map;
        paint(frame);
        BhrImage image = image_of(format, MAP_WIDTH, MAP_HEIGHT, (void *)(uintptr_t)texels, MAP_HEIGHT * row);
        CHECK_OK(bhr_set_sky_map(context, &image));
        render(from_memory);
        for (uint32_t y = 0; y < MAP_HEIGHT; y++)
            memcpy(rows + y * stride, texels + y * row, row);
        vk_write(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, bytes, stride, all, rows);
        CHECK_OK(bhr_set_sky_target(context, target));
        render(from_gpu);
        double   apart = vk_apart(BHR_FORMAT_RGBA8_SRGB, from_gpu, from_memory, sizeof from_gpu);
        uint32_t bright = 0;
        for (size_t i = 0; i < sizeof from_gpu; i++)
            bright += i % 4 != 3 && from_gpu[i] > 40;
        CHECK(apart <= 1, "format %d, kind %d, gap %u, frame %u: %g steps apart", format, kind, (unsigned)gap, frame,
              apart);
        CHECK(bright > WIDTH * HEIGHT / 4, "only %u channels are bright: the map is not shown", bright);
    }
    vk_write(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, bytes, stride, all, rows);
    CHECK_FAILS(BAD, "sky", bhr_render_target(context, target, NULL, NULL));
    BhrTargetOptions other = options;
    BhrTarget       *light;
    other.kind = BHR_TARGET_IMAGE, other.row_stride = 0;
    CHECK_OK(bhr_target_create(context, &other, &light));
    CHECK_OK(bhr_render_target(context, light, NULL, NULL)); /* in flight while the sky goes */
    bhr_target_destroy(target);
    BhrImage small = image_of(BHR_FORMAT_RGBA8_SRGB, 8, 8, from_gpu, sizeof from_gpu);
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "sky", bhr_render_image(context, &small));
    CHECK_OK(bhr_set_sky_target(context, NULL));
    render(from_gpu);
    CHECK(vk_apart(BHR_FORMAT_RGBA8_SRGB, from_gpu, from_memory, sizeof from_gpu) > 20, "the map is still there");
    bhr_target_destroy(light);
    vk_drop(&host, &picture);
}

/* The host's own memory, which frames copy first: its rows one after another, or `gap` bytes apart. */
static void from_pointer(BhrFormat format, uint64_t gap) {
    size_t           room = 4 << 20, texel = format == BHR_FORMAT_RGBA16F ? 8 : 16, row = MAP_WIDTH * texel;
    BhrTargetOptions options = share_options(format, BHR_TARGET_BUFFER, MAP_WIDTH, MAP_HEIGHT, gap ? row + gap : 0);
    BhrTargetInfo    memory = {.struct_size = sizeof memory, .allocation_size = room};
    BhrHandle        handle = {BHR_HANDLE_HOST_POINTER, -1, NULL};
    BhrTarget       *target;
    options.handle_type = BHR_HANDLE_HOST_POINTER;
    if (!CHECK(posix_memalign(&handle.handle, 65536, room) == 0, "no memory"))
        return;
    if (CHECK_OK(bhr_target_import(context, &options, &memory, &handle, &target))) {
        for (uint32_t frame = 0; frame < 3; frame++) {
            char *texels = format == BHR_FORMAT_RGBA16F ? (char *)halves : (char *)map;
            paint(frame);
            memset(handle.handle, 0xff, room);
            for (uint32_t y = 0; y < MAP_HEIGHT; y++)
                memcpy((char *)handle.handle + y * (row + gap), texels + y * row, row);
            CHECK_OK(bhr_set_sky_target(context, target));
            render(from_gpu);
            BhrImage image = image_of(format, MAP_WIDTH, MAP_HEIGHT, texels, MAP_HEIGHT * row);
            CHECK_OK(bhr_set_sky_map(context, &image));
            render(from_memory);
            double apart = vk_apart(BHR_FORMAT_RGBA8_SRGB, from_gpu, from_memory, sizeof from_gpu);
            CHECK(apart <= 1, "host memory, format %d, gap %u, frame %u: %g steps apart", format, (unsigned)gap, frame,
                  apart);
        }
        bhr_target_destroy(target);
    }
    /* Freed when no frame uses it. */
    render(from_memory);
    free(handle.handle);
}

/* Smooth light of a direction in sky axes, other in each channel. */
static void light_of(const double v[3], float texel[4]) {
    texel[0] = (float)(0.4 + 0.3 * sin(3 * v[0] + v[1]) * cos(2 * v[2]));
    texel[1] = (float)(0.4 + 0.3 * sin(4 * v[1] - v[2]));
    texel[2] = (float)(0.4 + 0.3 * cos(5 * v[2] + 2 * v[0]));
    texel[3] = 1.0f;
}

/* A cube of known light shows what an equirectangular map of the same light does. */
static void cube(void) {
    enum { SIDE = 96 };
    static float     faces[SIDE * SIDE * 6 * 4], plain[SIDE * SIDE * 8 * 4];
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA32F, BHR_TARGET_IMAGE, 6 * SIDE, SIDE, 0);
    BhrImage         image = image_of(BHR_FORMAT_RGBA32F, 4 * SIDE, 2 * SIDE, plain, sizeof plain);
    Watch            watch;
    /* Middle, right and up of each face. */
    static const int axes[6][3][3] = {
        {{0, -1, 0}, {-1, 0, 0}, {0, 0, 1}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},  {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
        {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    };
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < 6 * SIDE; x++) {
            const int(*axis)[3] = axes[x / SIDE];
            double right = 2 * (x % SIDE + 0.5) / SIDE - 1, up = 1 - 2 * (y + 0.5) / SIDE, v[3];
            double length = sqrt(1 + right * right + up * up);
            for (int i = 0; i < 3; i++)
                v[i] = (axis[0][i] + right * axis[1][i] + up * axis[2][i]) / length;
            light_of(v, faces + 4 * (y * 6 * SIDE + x));
        }
    for (int y = 0; y < 2 * SIDE; y++)
        for (int x = 0; x < 4 * SIDE; x++) {
            double ra = 6.283185307179586 * (0.5 - (x + 0.5) / (4 * SIDE));
            double dec = 3.141592653589793 * (0.5 - (y + 0.5) / (2 * SIDE));
            double v[3] = {cos(dec) * cos(ra), cos(dec) * sin(ra), sin(dec)};
            light_of(v, plain + 4 * (y * 4 * SIDE + x));
        }
    BhrTarget *target = share_make(&options);
    VkPicture  picture = share_import(target, sizeof faces);
    CHECK_OK(bhr_set_sky_map(context, &image));
    render(from_memory);
    vk_write(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 16, SIDE * 96, sizeof faces, (unsigned char *)faces);
    CHECK_OK(bhr_set_sky_target_as(context, target, BHR_PROJECTION_CUBE));
    render(from_gpu);
    double apart = vk_apart(BHR_FORMAT_RGBA8_SRGB, from_gpu, from_memory, sizeof from_gpu);
    CHECK(apart <= 1, "a cube is %g steps from the same light in a map", apart);
    /* Seen as an equirect it is another sky. */
    vk_write(&host, &picture, VK_QUEUE_FAMILY_EXTERNAL, 16, SIDE * 96, sizeof faces, (unsigned char *)faces);
    CHECK_OK(bhr_set_sky_target_as(context, target, BHR_PROJECTION_EQUIRECT));
    render(from_gpu);
    CHECK(vk_apart(BHR_FORMAT_RGBA8_SRGB, from_gpu, from_memory, sizeof from_gpu) > 20, "the layout makes no change");
    watch_begin(&watch, context);
    CHECK_FAILS(BAD, "context", bhr_set_sky_target_as(NULL, target, BHR_PROJECTION_CUBE));
    CHECK_REFUSED(&watch, BAD, "layout", bhr_set_sky_target_as(context, target, BHR_PROJECTION_FISHEYE));
    CHECK_REFUSED(&watch, BAD, "layout", bhr_set_sky_target_as(context, target, -1));
    CHECK_OK(bhr_set_sky_target_as(context, NULL, BHR_PROJECTION_CUBE));
    bhr_target_destroy(target);
    vk_drop(&host, &picture);
    watch_begin(&watch, context);
    options.width = 6 * SIDE + 1;
    target = share_make(&options);
    CHECK_REFUSED(&watch, BAD, "6 times", bhr_set_sky_target_as(context, target, BHR_PROJECTION_CUBE));
    bhr_target_destroy(target);
}

static void refused(BhrBackend backend) {
    static const struct {
        BhrFormat   format;
        uint32_t    width, height;
        BhrStatus   status;
        const char *words;
    } list[] = {{BHR_FORMAT_RGBA8_SRGB, 64, 32, BAD, "RGBA16F or RGBA32F"},
                {BHR_FORMAT_R32F, 64, 32, BAD, "RGBA16F or RGBA32F"},
                {BHR_FORMAT_RGBA16F, 32, 33, BAD, "as wide as high"},
                {BHR_FORMAT_RGBA16F, 16385, 2, BAD, "16384 x 8192"}};
    Watch       watch;
    BhrContext *other = check_context(backend);
    watch_begin(&watch, context);
    CHECK_FAILS(BAD, "context", bhr_set_sky_target(NULL, NULL));
    for (size_t i = 0; i < COUNT_OF(list); i++) {
        BhrTargetOptions options =
            share_options(list[i].format, BHR_TARGET_BUFFER, list[i].width, list[i].height, 0);
        BhrTarget *target = share_make(&options);
        if (!target)
            continue;
        CHECK_REFUSED(&watch, list[i].status, list[i].words, bhr_set_sky_target(context, target));
        bhr_target_destroy(target);
    }
    BhrTargetOptions options = share_options(BHR_FORMAT_RGBA16F, BHR_TARGET_BUFFER, MAP_WIDTH, MAP_HEIGHT, 0);
    BhrTarget       *target = share_make(&options);
    CHECK_FAILS(BAD, "another context", bhr_set_sky_target(other, target));
    bhr_target_destroy(target);
    bhr_context_destroy(other);
}

int main(int argc, char **argv) {
    BhrBackend backend = share_begin(argc, argv);
    BhrSky     sky;
    BhrCamera  camera = {.struct_size = sizeof camera};
    CHECK_OK(bhr_sky_init(&sky, sizeof sky));
    sky.flags = BHR_SKY_MAP;
    CHECK_OK(bhr_set_sky(context, &sky));
    compare(BHR_FORMAT_RGBA32F, BHR_TARGET_IMAGE, 0);
    compare(BHR_FORMAT_RGBA16F, BHR_TARGET_BUFFER, 40);
    /* From near by, where pixels see much of the sky. */
    CHECK_OK(bhr_get_camera(context, &camera));
    camera.projection = BHR_PROJECTION_EQUIRECT;
    camera.position[1] = -8.0;
    CHECK_OK(bhr_set_camera(context, &camera));
    compare(BHR_FORMAT_RGBA16F, BHR_TARGET_IMAGE, 0);
    compare(BHR_FORMAT_RGBA32F, BHR_TARGET_BUFFER, 0);
    if (can.import_buffers & BHR_HANDLE_HOST_POINTER) {
        from_pointer(BHR_FORMAT_RGBA16F, 0);
        from_pointer(BHR_FORMAT_RGBA16F, 40);
        from_pointer(BHR_FORMAT_RGBA32F, 4);
    }
    cube();
    refused(backend);
    return share_end();
}
