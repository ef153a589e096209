/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* depths.c -- windows of a display whose pixels are not 8 bits of each colour in 32, such as depth 16 and 30: they show
 * what bhr_render_image gives of the same scene and size, to half a step of their own colours.
 *
 *     depths BACKEND xlib|xcb DEPTH        environment: DISPLAY, of a screen of this depth */
#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 160u
#define HEIGHT 120u

/* The sizes have rows that are no multiple of four bytes too. */
static const uint32_t SIZES[][2] = {{WIDTH, HEIGHT}, {33, 17}, {1, 1}, {WIDTH - 1, HEIGHT}};

static void check_shows(BhrContext *context, BhrSurface *surface, const Host *host, const uint32_t size[2],
                        int tolerance) {
    static unsigned char expected[WIDTH * HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, size[0], size[1], expected, sizeof expected);
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_render_surface(context, surface));
    const int difference = host_difference(host, size[0], size[1], expected, tolerance);
    CHECK(difference <= tolerance, "%u x %u: the window and the image differ by %d steps", (unsigned)size[0],
          (unsigned)size[1], difference);
}

/* A picture of many colours: the sky beside the hole, in false colours, and the disk. */
static void scenes(BhrContext *context, BhrSurface *surface, const Host *host, int tolerance) {
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        host_resize(host, SIZES[i][0], SIZES[i][1]);
        CHECK_OK(bhr_surface_resize(surface, SIZES[i][0], SIZES[i][1]));
        check_shows(context, surface, host, SIZES[i], tolerance);
    }
    CHECK_OK(bhr_set_view(context, BHR_VIEW_REDSHIFT));
    check_shows(context, surface, host, SIZES[3], tolerance);
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
}

/* The window's own colours, by the pixels that the server holds: some are bright, and the three differ. */
static void colours(const Host *host) {
    static unsigned char seen[WIDTH * HEIGHT * 4];
    int                  brightest[3] = {0, 0, 0}, unlike = 0;
    CHECK(host_grab(host, WIDTH - 1, HEIGHT, seen), "nothing to look at");
    for (size_t i = 0; i < (size_t)(WIDTH - 1) * HEIGHT; i++) {
        const unsigned char *pixel = seen + 4 * i;
        for (int c = 0; c < 3; c++) {
            brightest[c] = pixel[c] > brightest[c] ? pixel[c] : brightest[c];
        }
        unlike += abs(pixel[0] - pixel[2]) > 40;
    }
    CHECK(brightest[0] > 200 && brightest[1] > 150 && brightest[2] > 100, "the brightest: %d %d %d", brightest[0],
          brightest[1], brightest[2]);
    CHECK(unlike > 100, "%d pixels have a colour", unlike);
}

int main(int argc, char **argv) {
    const BhrBackend    backend = check_begin(argc, argv);
    const BhrWindowKind kind = host_kind(argc > 2 ? argv[2] : NULL);
    const int           depth = argc > 3 ? atoi(argv[3]) : 0;
    const int           tolerance = depth >= 24 ? 1 : 5; /* half of 255 / 31, and a rounding */
    BhrContextOptions   options = check_options(backend);
    BhrContext         *context = check_context_with(&options);
    Host                host = host_open(kind, NULL, WIDTH, HEIGHT);
    CHECK(host_depth(&host) == depth, "the window's depth is %d", host_depth(&host));
    BhrSurface *surface = check_surface(context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    scenes(context, surface, &host, tolerance);
    check_shows(context, surface, &host, SIZES[3], tolerance);
    colours(&host);
    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
    host_close(&host);
    return check_end();
}
