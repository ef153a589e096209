/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include <stdlib.h>
/* film.c -- the film: 8-bit images are exposed, bloom, and are mapped; float images are left alone; bloom needs the
 * whole frame, as a beam does; colour maps. Numbers out of range are in bad_scene.c. */
#include "check.h"

#include <string.h>

#define WIDTH 64u
#define HEIGHT 40u
#define MOST_BYTES (WIDTH * HEIGHT * 16u)

static unsigned char before[MOST_BYTES], after[MOST_BYTES];

static void set_film(BhrContext *context, BhrToneMap tone_map, double exposure_ev, double bloom) {
    BhrFilm film;
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.tone_map = tone_map;
    film.exposure_ev = exposure_ev;
    film.bloom = bloom;
    CHECK_OK(bhr_set_film(context, &film));
    BhrFilm got;
    CHECK_OK(bhr_film_init(&got, sizeof got));
    CHECK_OK(bhr_get_film(context, &got));
    CHECK(got.bloom == bloom && got.exposure_ev == exposure_ev && got.tone_map == tone_map,
          "another film than was set");
}

static size_t render(BhrContext *context, BhrFormat format, uint32_t flags, unsigned char *pixels) {
    const size_t bytes = WIDTH * HEIGHT * bytes_per_pixel(format);
    BhrImage     image = image_of(format, WIDTH, HEIGHT, pixels, bytes);
    image.flags = flags;
    CHECK_OK(bhr_render_image(context, &image));
    return bytes;
}

static void floats_are_left_alone(BhrContext *context) {
    static const BhrFormat formats[] = {BHR_FORMAT_RGBA16F, BHR_FORMAT_RGBA32F};
    for (size_t i = 0; i < COUNT_OF(formats); i++) {
        set_film(context, BHR_TONE_MAP_NONE, 0.0, 0.0);
        const size_t bytes = render(context, formats[i], 0, before);
        set_film(context, BHR_TONE_MAP_AGX, 4.0, 1.0);
        render(context, formats[i], 0, after);
        CHECK(memcmp(before, after, bytes) == 0, "format %d: film changes linear radiance", (int)formats[i]);
    }
}

static void eight_bits_bloom(BhrContext *context) {
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 0.0);
    const size_t bytes = render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 1.0);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    size_t lifted = 0;
    for (size_t i = 0; i < bytes; i += 4) {
        lifted += before[i] == 0 && after[i] > 4;
    }
    CHECK(lifted > 50, "bloom lights %u black pixels only", (unsigned)lifted);
    memcpy(before, after, bytes);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(memcmp(before, after, bytes) == 0, "two frames with bloom differ");

    BhrJob        *job = NULL;
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, after, bytes);
    memset(after, UNTOUCHED, sizeof after);
    CHECK_OK(bhr_render_image_async(context, &image, &job));
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    CHECK(memcmp(before, after, bytes) == 0, "a job's frame with bloom differs");
}

static void set_beam(BhrContext *context, double fwhm, BhrColourMap map) {
    BhrFilm film;
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.tone_map = BHR_TONE_MAP_NONE;
    film.bloom = 0.0;
    film.beam_fwhm = fwhm;
    film.colour_map = map;
    CHECK_OK(bhr_set_film(context, &film));
    BhrFilm got;
    CHECK_OK(bhr_film_init(&got, sizeof got));
    CHECK_OK(bhr_get_film(context, &got));
    CHECK(got.beam_fwhm == fwhm && got.colour_map == map, "another beam than was set");
}

/* The largest step between neighbours of a row. */
static int sharpest(const unsigned char *pixels) {
    int most = 0;
    for (size_t i = 4; i < WIDTH * HEIGHT * 4; i++) {
        const int step = i / 4 % WIDTH == 0 ? 0 : abs(pixels[i] - pixels[i - 4]);
        most = step > most ? step : most;
    }
    return most;
}

/* A beam blurs; a colour map has its own colours only; a struct of the first release has neither. */
static void beams_and_colour_maps(BhrContext *context) {
    set_beam(context, 0.0, BHR_COLOUR_MAP_NONE);
    const size_t bytes = render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    set_beam(context, 0.3, BHR_COLOUR_MAP_NONE);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(sharpest(after) * 3 < sharpest(before), "with a beam %d, without %d", sharpest(after), sharpest(before));
    set_beam(context, 0.3, BHR_COLOUR_MAP_AFMHOT);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    size_t hot = 0;
    for (size_t i = 0; i < bytes; i += 4) {
        const int red = after[i], green = after[i + 1], blue = after[i + 2];
        /* Green begins where red is half, blue where green is half. */
        const int on_map = red < 126 ? green <= 1 && blue == 0 : abs(green - (red < 255 ? red - 127 : green)) <= 2;
        CHECK(on_map, "pixel %u is %d %d %d", (unsigned)(i / 4), red, green, blue);
        hot += red > 100;
    }
    CHECK(hot > 50, "%u pixels are bright", (unsigned)hot);
    render(context, BHR_FORMAT_RGBA32F, 0, before);
    set_beam(context, 0.0, BHR_COLOUR_MAP_NONE);
    render(context, BHR_FORMAT_RGBA32F, 0, after);
    CHECK(memcmp(before, after, MOST_BYTES) == 0, "a beam changes linear radiance");

    const BhrRegion region = {.struct_size = sizeof region, .full_width = 2 * WIDTH, .full_height = HEIGHT, .x = 5};
    const BhrImage  image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, after, bytes);
    set_beam(context, 0.25, BHR_COLOUR_MAP_NONE);
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "beam_fwhm is 0.25", bhr_render_image(context, &image));
    CHECK_OK(bhr_set_region(context, NULL));

    set_film(context, BHR_TONE_MAP_NONE, 0.0, 0.0);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    BhrFilm old;
    memset(&old, UNTOUCHED, sizeof old);
    old.struct_size = FIRST_FILM, old.tone_map = BHR_TONE_MAP_NONE, old.exposure_ev = old.bloom = 0.0;
    set_beam(context, 0.3, BHR_COLOUR_MAP_AFMHOT);
    CHECK_OK(bhr_set_film(context, &old));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(memcmp(before, after, bytes) == 0, "a film of the first release has another picture");
    CHECK_OK(bhr_film_init(&old, FIRST_FILM));
    CHECK(old.bloom == 0.0, "a film of the first release begins with a bloom of %g", old.bloom);
}

/* Glare adds light; alpha is still what the hole and the disk cover. */
static void transparent_images(BhrContext *context) {
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 0.0);
    const size_t bytes = render(context, BHR_FORMAT_BGRA8_SRGB, BHR_IMAGE_TRANSPARENT, before);
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 1.0);
    render(context, BHR_FORMAT_BGRA8_SRGB, BHR_IMAGE_TRANSPARENT, after);
    size_t same = 0, glare = 0;
    for (size_t i = 0; i < bytes; i += 4) {
        /* Light that spreads is kept in half floats, alpha with it. */
        same += abs(before[i + 3] - after[i + 3]) <= 1;
        glare += after[i + 3] == 0 && after[i + 2] > 4;
    }
    CHECK(same == WIDTH * HEIGHT, "bloom keeps the alpha of %u pixels only", (unsigned)same);
    CHECK(glare > 100, "glare shows on %u open pixels only", (unsigned)glare);
}

/* Refused where it would matter, and only there. */
static void regions(BhrContext *context) {
    const BhrRegion region = {.struct_size = sizeof region, .full_width = 2 * WIDTH, .full_height = HEIGHT, .x = 5};
    const size_t    bytes = WIDTH * HEIGHT * 4;
    const BhrImage  image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, after, bytes);
    BhrJob         *job = (BhrJob *)after;
    set_film(context, BHR_TONE_MAP_ACES, 0.0, 0.5);
    CHECK_OK(bhr_set_region(context, &region));
    memset(after, UNTOUCHED, sizeof after);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bloom is 0.5", bhr_render_image(context, &image));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bloom is 0.5", bhr_render_image_async(context, &image, &job));
    CHECK(job == NULL, "out_job is not NULL after a failure");
    CHECK(all_untouched(after, sizeof after), "a refused image was written to");
    render(context, BHR_FORMAT_RGBA32F, 0, after);
    CHECK_OK(bhr_set_view(context, BHR_VIEW_ORDER));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    set_film(context, BHR_TONE_MAP_ACES, 0.0, 0.0);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    set_film(context, BHR_TONE_MAP_ACES, 0.0, 0.5);
    CHECK_OK(bhr_set_region(context, NULL));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    floats_are_left_alone(context);
    eight_bits_bloom(context);
    beams_and_colour_maps(context);
    transparent_images(context);
    regions(context);
    bhr_context_destroy(context);
    return check_end();
}
