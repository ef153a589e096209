/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* large.c -- large frames: the peak memory of an 8192 x 8192 render into the host's buffer stays within 600 MB above
 * that buffer, and a part of a 16384 x 16384 frame can be rendered, equal to the same pixels rendered in smaller
 * parts. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define WIDE 16384u

static long long peak_resident_bytes(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (long long)usage.ru_maxrss * 1024 : -1; /* KiB on Linux */
}

/* The CPU tracer takes minutes for 67 million rays through the default scene. Without disk and stars, seen from far
 * away, most rays end after a few steps; tiles, film and the way into the buffer are the same. */
static void cheap_scene(BhrContext *context) {
    BhrCamera camera;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    CHECK_OK(bhr_camera_orbit(&camera, 1000.0, 0.0, 0.3));
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_disk(context, NULL));
    CHECK_OK(bhr_set_sky(context, NULL));
}

/* First in the process: the peak is of all that came before, too. Everyday the frame is 4096 x 4096, whose light in
 * single precision, 268 MB, is too much in any case; lavapipe itself holds 340 MB. */
static void peak_memory(BhrContext *context, BhrBackend backend) {
    const uint32_t  side = check_runs_all() ? 8192 : 4096;
    const long long most = check_runs_all() ? 600000000 : backend == BHR_BACKEND_CPU ? 220000000 : 520000000;
    const uint64_t bytes = (uint64_t)side * side * 4;
    unsigned char *pixels = malloc(bytes);
    if (!CHECK(pixels != NULL, "no %llu bytes for the host's buffer", (unsigned long long)bytes)) {
        return;
    }
    memset(pixels, UNTOUCHED, bytes); /* resident before the render, so that it is not counted as the library's */
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, side, side, pixels, bytes);
    CHECK_OK(bhr_render_image(context, &image));
    const long long peak = peak_resident_bytes(), above = peak - (long long)bytes;
    printf("%u x %u: peak %lld MB, %lld MB above the buffer\n", side, side, peak / 1000000, above / 1000000);
    CHECK(peak > (long long)bytes && above <= most, "%lld bytes above the buffer", above);
    size_t opaque = 0;
    for (uint64_t i = 3; i < bytes; i += 4) {
        opaque += pixels[i] == 255;
    }
    CHECK(opaque == (size_t)side * side, "%llu of %llu pixels were written", (unsigned long long)opaque,
          (unsigned long long)side * side);
    free(pixels);
}

static void wide_region(BhrContext *context) {
    enum { ROWS = 4, PART = 1000 };
    BhrRegion      region = {.struct_size = sizeof region, .full_width = WIDE, .full_height = WIDE, .x = 0, .y = 8190};
    unsigned char *pixels = malloc((size_t)WIDE * ROWS * 4);
    static unsigned char part[PART * ROWS * 4];
    BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDE, ROWS, pixels, (uint64_t)WIDE * ROWS * 4);
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_OK(bhr_render_image(context, &image));
    static const uint32_t begins[] = {0, 7700, WIDE - PART};
    for (size_t i = 0; i < COUNT_OF(begins); i++) {
        const BhrImage small = image_of(BHR_FORMAT_RGBA8_SRGB, PART, ROWS, part, sizeof part);
        region.x = begins[i];
        CHECK_OK(bhr_set_region(context, &region));
        CHECK_OK(bhr_render_image(context, &small));
        for (size_t row = 0; row < ROWS; row++) {
            CHECK(memcmp(part + row * PART * 4, pixels + (row * WIDE + begins[i]) * 4, PART * 4) == 0,
                  "row %u from pixel %u on differs", (unsigned)row, (unsigned)begins[i]);
        }
    }
    CHECK_OK(bhr_set_region(context, NULL));
    free(pixels);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    BhrContext      *context = check_context(backend);
    if (backend == BHR_BACKEND_CPU) {
        cheap_scene(context);
    }
    peak_memory(context, backend);
    bhr_context_destroy(context);
    context = check_context(backend);
    wide_region(context);
    bhr_context_destroy(context);
    return check_end();
}
