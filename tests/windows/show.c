/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* show.c -- a window shows what bhr_render_image gives of the same scene and size, in every way that frames get there:
 * `direct` (by the device that traces), `uploaded` (traced by the CPU, presented by a device), `memory` (no driver at
 * all). The test goes through ten sizes, with and without word from the host that they have changed; minimised; in
 * every present mode.
 *
 *     show BACKEND xlib|xcb direct|uploaded|memory */
#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 160u
#define HEIGHT 120u
#define LARGEST (700u * 700u * 4u)
#define ONE_STEP 1

static char said[4096]; /* by the log at level INFO */

static void remember(void *user, BhrLogLevel level, const char *message) {
    const size_t used = strlen(said);
    (void)user;
    (void)level;
    snprintf(said + used, sizeof said - used, "%s\n", message);
}

static BhrContext *open_context(BhrBackend backend, const BhrWindow *compatible) {
    BhrContextOptions options = check_options(backend);
    options.log_level = BHR_LOG_INFO;
    options.log_fn = remember;
    options.compatible_window = compatible;
    return check_context_with(&options);
}

/* ---- a window against an image ---- */

/* The surface's frame is the image of this size. Another frame is presented as often as the window is being resized. */
static void check_shows(BhrContext *context, BhrSurface *surface, const Host *host, uint32_t width, uint32_t height,
                        const char *what) {
    static unsigned char expected[LARGEST];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, width, height, expected, LARGEST);
    BhrStatus            status = BHR_FRAME_SKIPPED;
    CHECK_OK(bhr_render_image(context, &image));
    for (int i = 0; i < 4 && status == BHR_FRAME_SKIPPED; i++) {
        status = bhr_render_surface(context, surface);
    }
    CHECK(status == BHR_OK, "%s, %u x %u: %s: %s", what, (unsigned)width, (unsigned)height, bhr_status_name(status),
          status < 0 ? bhr_error_message() : "");
    const int difference = host_difference(host, width, height, expected, ONE_STEP);
    CHECK(difference <= ONE_STEP, "%s, %u x %u: the window and the image differ by %d steps", what, (unsigned)width,
          (unsigned)height, difference);
}

/* ---- scenes ---- */

static void set_samples(BhrContext *context, uint32_t samples, double render_scale) {
    BhrQuality quality;
    CHECK_OK(bhr_quality_init(&quality, sizeof quality));
    quality.samples_per_pixel = samples;
    quality.render_scale = render_scale;
    CHECK_OK(bhr_set_quality(context, &quality));
}

static void scenes(BhrContext *context, BhrSurface *surface, const Host *host) {
    BhrFilm film;
    check_shows(context, surface, host, WIDTH, HEIGHT, "the default scene");
    CHECK_OK(bhr_set_spin(context, 0.9));
    check_shows(context, surface, host, WIDTH, HEIGHT, "spin 0.9");
    CHECK_OK(bhr_set_view(context, BHR_VIEW_REDSHIFT));
    check_shows(context, surface, host, WIDTH, HEIGHT, "a view");
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.exposure_ev = 1.5;
    film.tone_map = BHR_TONE_MAP_AGX;
    CHECK_OK(bhr_set_film(context, &film));
    check_shows(context, surface, host, WIDTH, HEIGHT, "a film");
    film.bloom = 0.7;
    CHECK_OK(bhr_set_film(context, &film));
    check_shows(context, surface, host, WIDTH, HEIGHT, "bloom");
    CHECK_OK(bhr_film_init(&film, sizeof film));
    CHECK_OK(bhr_set_film(context, &film));
    set_samples(context, 5, 1.0);
    check_shows(context, surface, host, WIDTH, HEIGHT, "5 samples");
    set_samples(context, 1, 1.0);
    CHECK_OK(bhr_set_spin(context, 0.0));
}

/* Windows do not obey the region, and so bloom while one is set. */
static void region(BhrContext *context, BhrSurface *surface, const Host *host) {
    static unsigned char whole[WIDTH * HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, whole, sizeof whole);
    const BhrRegion      part = {.struct_size = sizeof part, .full_width = 1000, .full_height = 999, .x = 3, .y = 5};
    BhrFilm              film;
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.bloom = 0.5;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_set_region(context, &part));
    CHECK_OK(bhr_render_surface(context, surface));
    CHECK(host_difference(host, WIDTH, HEIGHT, whole, ONE_STEP) <= ONE_STEP, "a window obeys the region");
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK_OK(bhr_film_init(&film, sizeof film));
    CHECK_OK(bhr_set_film(context, &film));
}

/* The half-size image by bilinear interpolation between its pixels' centres. */
static void upscale(const unsigned char *half, unsigned char *full) {
    const int width = WIDTH / 2, height = HEIGHT / 2;
    for (int y = 0; y < (int)HEIGHT; y++) {
        for (int x = 0; x < (int)WIDTH; x++) {
            /* (x + 1/2) / 2 - 1/2, in quarters. */
            const int qx = 2 * x - 1, qy = 2 * y - 1;
            const int left = qx < 0 ? 0 : qx / 4, top = qy < 0 ? 0 : qy / 4;
            const int right = left + 1 < width && qx >= 0 ? left + 1 : left;
            const int below = top + 1 < height && qy >= 0 ? top + 1 : top;
            const int u = qx < 0 ? 0 : qx % 4, v = qy < 0 ? 0 : qy % 4;
            for (int c = 0; c < 4; c++) {
                const int upper = (4 - u) * half[4 * (top * width + left) + c] +
                                  u * half[4 * (top * width + right) + c];
                const int lower =
                    (4 - u) * half[4 * (below * width + left) + c] + u * half[4 * (below * width + right) + c];
                full[4 * (y * (int)WIDTH + x) + c] = (unsigned char)(((4 - v) * upper + v * lower + 8) / 16);
            }
        }
    }
}

#define RENDER_SCALE_STEPS 3 /* filters of GPUs interpolate in 8 bits, and those of the host round twice */

/* At render_scale 1/2 the window shows the half-size picture, stretched, and not the whole one. */
static void half_size(BhrContext *context, BhrSurface *surface, const Host *host) {
    static unsigned char half[WIDTH * HEIGHT], full[WIDTH * HEIGHT * 4], whole[WIDTH * HEIGHT * 4];
    const BhrImage       small = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH / 2, HEIGHT / 2, half, sizeof half);
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, whole, sizeof whole);
    CHECK_OK(bhr_render_image(context, &small));
    CHECK_OK(bhr_render_image(context, &image));
    upscale(half, full);
    set_samples(context, 1, 0.5);
    CHECK_OK(bhr_render_surface(context, surface));
    const int difference = host_difference(host, WIDTH, HEIGHT, full, RENDER_SCALE_STEPS);
    CHECK(difference <= RENDER_SCALE_STEPS, "at render_scale 1/2 the window and the stretched image differ by %d steps",
          difference);
    int unlike = 0;
    for (size_t i = 0; i < sizeof full; i++) {
        unlike += abs((int)full[i] - (int)whole[i]) > 4 * RENDER_SCALE_STEPS;
    }
    CHECK(unlike > 100, "a stretched picture is like the whole one: nothing is tested");
    set_samples(context, 1, 1.0);
}

/* ---- sizes ---- */

static const uint32_t SIZES[][2] = {{200, 100}, {1, 1},   {640, 360}, {100, 400}, {33, 17},
                                    {2, 300},   {500, 2}, {401, 251}, {64, 64},   {WIDTH, HEIGHT}};

static void sizes(BhrContext *context, BhrSurface *surface, const Host *host) {
    for (size_t i = 0; i < COUNT_OF(SIZES); i++) {
        host_resize(host, SIZES[i][0], SIZES[i][1]);
        CHECK_OK(bhr_surface_resize(surface, SIZES[i][0], SIZES[i][1]));
        check_shows(context, surface, host, SIZES[i][0], SIZES[i][1], "resized");
    }
}

/* A host that is late with its word: frames go on, and soon have the window's size, which X11 knows. */
static void sizes_untold(BhrContext *context, BhrSurface *surface, const Host *host) {
    for (size_t i = 1; i < COUNT_OF(SIZES); i += check_runs_all() ? 1 : 2) { /* everyday every second one */
        host_resize(host, SIZES[i][0], SIZES[i][1]);
        for (int k = 0; k < 3; k++) {
            const BhrStatus status = bhr_render_surface(context, surface);
            CHECK(status == BHR_OK || status == BHR_FRAME_SKIPPED, "%s: %s", bhr_status_name(status),
                  bhr_error_message());
        }
        check_shows(context, surface, host, SIZES[i][0], SIZES[i][1], "resized without a word");
    }
    CHECK_OK(bhr_surface_resize(surface, WIDTH, HEIGHT));
}

/* Many words between two frames, the last of them the right one. */
static void sizes_at_once(BhrContext *context, BhrSurface *surface, const Host *host) {
    for (uint32_t i = 1; i < 200; i++) {
        CHECK_OK(bhr_surface_resize(surface, i, 2 * i));
    }
    host_resize(host, 123, 45);
    CHECK_OK(bhr_surface_resize(surface, 123, 45));
    check_shows(context, surface, host, 123, 45, "resized often");
    host_resize(host, WIDTH, HEIGHT);
    CHECK_OK(bhr_surface_resize(surface, WIDTH, HEIGHT));
    check_shows(context, surface, host, WIDTH, HEIGHT, "back");
}

static void minimised(BhrContext *context, BhrSurface *surface, const Host *host) {
    static const uint32_t none[][2] = {{0, 0}, {0, 100}, {100, 0}};
    BhrFrameStats         before = {.struct_size = sizeof before}, after = before;
    CHECK_OK(bhr_frame_stats(context, &before));
    for (size_t i = 0; i < COUNT_OF(none); i++) {
        CHECK_OK(bhr_surface_resize(surface, none[i][0], none[i][1]));
        const BhrStatus status = bhr_render_surface(context, surface);
        CHECK(status == BHR_FRAME_SKIPPED, "%u x %u: %s", (unsigned)none[i][0], (unsigned)none[i][1],
              bhr_status_name(status));
    }
    CHECK_OK(bhr_frame_stats(context, &after));
    CHECK(after.frame_index <= before.frame_index + 4, "skipped frames are counted"); /* those under way before */
    CHECK_OK(bhr_surface_resize(surface, WIDTH, HEIGHT));
    check_shows(context, surface, host, WIDTH, HEIGHT, "after being minimised");
}

static void modes(BhrContext *context, BhrSurface *surface, const Host *host) {
    static const BhrPresentMode all[] = {BHR_PRESENT_IMMEDIATE, BHR_PRESENT_MAILBOX, BHR_PRESENT_VSYNC,
                                         BHR_PRESENT_IMMEDIATE, BHR_PRESENT_VSYNC};
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        CHECK_OK(bhr_surface_set_present_mode(surface, all[i]));
        CHECK_OK(bhr_set_time(context, (double)i));
        CHECK_OK(bhr_set_mass(context, 1.0 + 0.2 * (double)i)); /* another picture each time */
        check_shows(context, surface, host, WIDTH, HEIGHT, "a present mode");
    }
    CHECK_OK(bhr_set_mass(context, 1.0));
}

/* bhr_frame_stats tells of the window's frames. */
static void numbers(BhrContext *context, BhrSurface *surface) {
    BhrFrameStats before = {.struct_size = sizeof before}, after = before;
    CHECK_OK(bhr_frame_stats(context, &before));
    for (int i = 0; i < 10; i++) {
        CHECK_OK(bhr_render_surface(context, surface));
    }
    CHECK_OK(bhr_frame_stats(context, &after));
    CHECK(after.frame_index > before.frame_index && after.frame_index <= before.frame_index + 15, "frame %u after %u",
          (unsigned)after.frame_index, (unsigned)before.frame_index);
    CHECK(after.rays == WIDTH * HEIGHT, "%u rays", (unsigned)after.rays);
    CHECK(after.cpu_ns > 0, "no time");
}

/* ---- windows and surfaces ---- */

/* Two windows of one context, of different kinds and sizes, in turns. */
static void two_windows(BhrContext *context, BhrWindowKind kind) {
    Host        first = host_open(kind, NULL, WIDTH, HEIGHT);
    Host        second = host_open(BHR_WINDOW_XLIB + BHR_WINDOW_XCB - kind, NULL, 77, 99);
    host_move(&second, 800, 0);
    BhrSurface *surfaces[2] = {check_surface(context, &first, WIDTH, HEIGHT, BHR_PRESENT_VSYNC),
                               check_surface(context, &second, 77, 99, BHR_PRESENT_MAILBOX)};
    for (int i = 0; i < 3; i++) {
        CHECK_OK(bhr_set_mass(context, 1.0 + 0.1 * i));
        check_shows(context, surfaces[0], &first, WIDTH, HEIGHT, "the first of two windows");
        check_shows(context, surfaces[1], &second, 77, 99, "the second of two windows");
    }
    bhr_surface_destroy(surfaces[0]);
    check_shows(context, surfaces[1], &second, 77, 99, "the one that is left");
    bhr_surface_destroy(surfaces[1]);
    host_close(&first);
    host_close(&second);
    CHECK_OK(bhr_set_mass(context, 1.0));
}

/* A window has one surface after another, made 0 x 0 or with a wrong size at first. */
static void one_after_another(BhrContext *context, const Host *host) {
    static const uint32_t first_sizes[][2] = {{0, 0}, {1, 1}, {WIDTH, HEIGHT}, {400, 300}};
    for (size_t i = 0; i < COUNT_OF(first_sizes); i++) {
        BhrSurface *surface = check_surface(context, host, first_sizes[i][0], first_sizes[i][1], BHR_PRESENT_VSYNC);
        const BhrStatus status = bhr_render_surface(context, surface);
        CHECK(status == (i == 0 ? BHR_FRAME_SKIPPED : BHR_OK), "%s", bhr_status_name(status));
        CHECK_OK(bhr_surface_resize(surface, WIDTH, HEIGHT));
        check_shows(context, surface, host, WIDTH, HEIGHT, "another surface");
        bhr_surface_destroy(surface);
    }
}

/* A window with an alpha channel, which a desktop would show through: whatever the way, it is opaque all over. */
static void with_alpha(BhrContext *context) {
    Host        host = host_open_with_alpha(WIDTH, HEIGHT);
    BhrSurface *surface = check_surface(context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    check_shows(context, surface, &host, WIDTH, HEIGHT, "a window with alpha");
    bhr_surface_destroy(surface);
    host_close(&host);
}

/* A window that is hidden takes frames, or says that it takes none; shown again, it shows the next. */
static void hidden(BhrContext *context, const Host *host) {
    BhrSurface *surface = check_surface(context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    host_show(host, 0);
    for (int i = 0; i < 5; i++) {
        const BhrStatus status = bhr_render_surface(context, surface);
        CHECK(status == BHR_OK || status == BHR_FRAME_SKIPPED, "hidden: %s: %s", bhr_status_name(status),
              bhr_error_message());
    }
    host_show(host, 1);
    check_shows(context, surface, host, WIDTH, HEIGHT, "hidden and shown");
    bhr_surface_destroy(surface);
}

/* A context that was asked for this window presents to it; one that opens its device anew without need loses its
 * surface. */
static void compatible(BhrBackend backend, const Host *host) {
    const BhrWindow window = host_window(host);
    BhrContext     *context = open_context(backend, &window);
    BhrSurface     *surface = check_surface(context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    check_shows(context, surface, host, WIDTH, HEIGHT, "a compatible window");
    CHECK_OK(bhr_set_mass(context, 1.3));
    CHECK_OK(bhr_context_recover(context));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "recovered", bhr_render_surface(context, surface));
    bhr_surface_destroy(surface);
    surface = check_surface(context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    check_shows(context, surface, host, WIDTH, HEIGHT, "recovered");
    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
}

/* The frames went the way that this run is meant to test. */
static void check_way(const char *way) {
    const int presented = strstr(said, "are presented by") != NULL, memory = strstr(said, "as memory") != NULL;
    CHECK(presented == (strcmp(way, "uploaded") == 0) && memory == (strcmp(way, "memory") == 0), "not %s; the log: %s",
          way, said);
}

int main(int argc, char **argv) {
    const BhrBackend    backend = check_begin(argc, argv);
    const BhrWindowKind kind = host_kind(argc > 2 ? argv[2] : NULL);
    const char         *way = argc > 3 ? argv[3] : "direct";
    BhrContext         *context = open_context(backend, NULL);
    Host                host = host_open(kind, NULL, WIDTH, HEIGHT);
    BhrSurface         *surface = check_surface(context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    scenes(context, surface, &host);
    region(context, surface, &host);
    half_size(context, surface, &host);
    sizes(context, surface, &host);
    sizes_untold(context, surface, &host);
    sizes_at_once(context, surface, &host);
    minimised(context, surface, &host);
    modes(context, surface, &host);
    numbers(context, surface);
    bhr_surface_destroy(surface);
    one_after_another(context, &host);
    two_windows(context, kind);
    hidden(context, &host);
    check_way(way);
    with_alpha(context);
    compatible(backend, &host);
    bhr_context_destroy(context);
    host_close(&host);
    return check_end();
}
