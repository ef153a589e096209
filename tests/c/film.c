/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* film.c -- the film: 8-bit images are exposed, bloom, and are mapped; float images are left alone; bloom needs the
 * whole frame, as a beam does; colour maps; grades. Numbers out of range are in bad_light.c. */
#include "check.h"

#include <stdlib.h>
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

/* A film of no glare, without a curve, to be graded. */
static BhrFilm plain_film(void) {
    BhrFilm film;
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.tone_map = BHR_TONE_MAP_NONE;
    film.bloom = 0.0;
    film.exposure_ev = -1.0;
    return film;
}

static void render_film(BhrContext *context, const BhrFilm *film, unsigned char *pixels) {
    BhrFilm got;
    CHECK_OK(bhr_film_init(&got, sizeof got));
    CHECK_OK(bhr_set_film(context, film));
    CHECK_OK(bhr_get_film(context, &got));
    CHECK(memcmp(&got, film, sizeof got) == 0, "another film than was set");
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, pixels);
}

static unsigned sum_of(const unsigned char *pixels, size_t channel) {
    unsigned sum = 0;
    for (size_t i = channel; i < WIDTH * HEIGHT * 4; i += 4) {
        sum += pixels[i];
    }
    return sum;
}

/* Each setting changes pictures of light in 8 bits as it says, and nothing else. */
static void grades(BhrContext *context) {
    const size_t bytes = WIDTH * HEIGHT * 4;
    BhrFilm      film = plain_film();
    render_film(context, &film, before);

    film.white_balance = 3500.0;
    render_film(context, &film, after);
    CHECK(sum_of(after, 2) > sum_of(before, 2) * 6 / 5 && sum_of(after, 0) < sum_of(before, 0),
          "a balance for warm light leaves blue %u of %u, red %u of %u", sum_of(after, 2), sum_of(before, 2),
          sum_of(after, 0), sum_of(before, 0));
    film.white_balance = 0.0, film.tint = 1.0;
    render_film(context, &film, after);
    CHECK(sum_of(after, 1) < sum_of(before, 1) && sum_of(after, 2) > sum_of(before, 2), "tint makes no magenta");
    film.tint = 0.0, film.saturation = 0.0;
    render_film(context, &film, after);
    size_t coloured = 0;
    for (size_t i = 0; i < bytes; i += 4) {
        coloured += after[i] != after[i + 1] || after[i] != after[i + 2];
    }
    CHECK(coloured == 0 && sum_of(after, 0) > 1000, "%u pixels have colours without saturation", (unsigned)coloured);
    film.saturation = 1.0, film.contrast = 2.0;
    render_film(context, &film, after);
    size_t wrong = 0, darker = 0;
    for (size_t i = 0; i < bytes; i++) {
        /* Middle grey is 118 of 255, and stays. */
        const int moved = after[i] - before[i];
        wrong += i % 4 < 3 && (before[i] < 115 ? moved > 1 : before[i] > 121 ? moved < -1 : 0);
        darker += moved < -3;
    }
    CHECK(wrong == 0 && darker > 50, "contrast: %u wrong, %u darker", (unsigned)wrong, (unsigned)darker);

    film = plain_film();
    film.vignette = film.saturation = 0.5;
    film.white_balance = 25000.0, film.tint = -1.0, film.contrast = 0.25;
    CHECK_OK(bhr_set_film(context, &film));
    render(context, BHR_FORMAT_RGBA32F, 0, after);
    set_film(context, BHR_TONE_MAP_NONE, 0.0, 0.0);
    static unsigned char light[MOST_BYTES];
    render(context, BHR_FORMAT_RGBA32F, 0, light);
    CHECK(memcmp(light, after, sizeof light) == 0, "a grade changes linear radiance");
    CHECK_OK(bhr_set_view(context, BHR_VIEW_REDSHIFT));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, light);
    render_film(context, &film, after);
    CHECK(memcmp(light, after, bytes) == 0, "a grade changes the colours of a view");
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));

    /* Hosts of older headers: the film of 0.1.0, and the one that had a beam but no grade. */
    static const uint32_t sizes[] = {FIRST_FILM, offsetof(BhrFilm, white_balance)};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        BhrFilm old = plain_film();
        old.struct_size = sizes[i];
        memset((unsigned char *)&old + sizes[i], UNTOUCHED, sizeof old - sizes[i]);
        CHECK_OK(bhr_set_film(context, &film));
        CHECK_OK(bhr_set_film(context, &old));
        render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
        CHECK(memcmp(before, after, bytes) == 0, "a film of %u bytes has another picture", sizes[i]);
    }
}

/* A third brighter in the middle than half the way to a corner, and a part is as the whole. */
static void vignettes(BhrContext *context) {
    static unsigned char whole[2 * WIDTH * HEIGHT * 4];
    const BhrRegion      region = {
             .struct_size = sizeof region, .full_width = 2 * WIDTH, .full_height = HEIGHT, .x = WIDTH / 2};
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, 2 * WIDTH, HEIGHT, whole, sizeof whole);
    BhrFilm        film = plain_film();
    film.exposure_ev = 0.0;
    film.vignette = 1.0;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_set_region(context, &region));
    render_film(context, &film, after);
    film.vignette = 0.0;
    render_film(context, &film, before);
    CHECK_OK(bhr_set_region(context, NULL));
    size_t near = 0, corners = 0, darkened = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT * 4; i++) {
        const size_t y = i / (WIDTH * 4), x = i % (WIDTH * 4);
        near += abs(whole[y * 2 * WIDTH * 4 + WIDTH / 2 * 4 + x] - after[i]) <= 1;
        /* An edge's middle is at half of r^2 = 1/4 here, cos^4 = 0.64: some 0.82 of the code. */
        const int lit = before[i] > 60 && before[i] < 255 && x / 4 < 4 && i % 4 < 3;
        corners += lit;
        darkened += lit && after[i] * 10 < before[i] * 9;
    }
    CHECK(near * 1000 >= (size_t)WIDTH * HEIGHT * 4 * 999, "only %u bytes are as in the whole", (unsigned)near);
    CHECK(darkened == corners, "%u of %u bytes are darkened", (unsigned)darkened, (unsigned)corners);
    film.vignette = 1.0;
    film.bloom = 0.5;
    render_film(context, &film, after);
    film.vignette = 0.0;
    render_film(context, &film, before);
    CHECK(sum_of(after, 0) < sum_of(before, 0), "with glare there is no vignette");
}

/* The curve rises, ends in white, and its settings change it. */
static void filmic(BhrContext *context) {
    BhrFilm film = plain_film();
    film.tone_map = BHR_TONE_MAP_FILMIC;
    film.exposure_ev = 2.0;
    render_film(context, &film, before);
    const unsigned usual = sum_of(before, 0);
    film.toe_strength = 0.0;
    render_film(context, &film, after);
    CHECK(sum_of(after, 0) > usual, "without a toe %u, with one %u", sum_of(after, 0), usual);
    film.toe_strength = 0.5, film.shoulder_strength = 6.0;
    render_film(context, &film, after);
    CHECK(sum_of(after, 0) < usual, "a longer shoulder gives %u, not less than %u", sum_of(after, 0), usual);
    static const double ends[] = {0.0, 1.0};
    for (size_t i = 0; i < 32; i++) {
        film.toe_strength = ends[i % 2], film.toe_length = ends[i / 2 % 2];
        film.shoulder_length = ends[i / 4 % 2], film.shoulder_angle = ends[i / 8 % 2];
        film.shoulder_strength = 16.0 * ends[i / 16];
        film.exposure_ev = 20.0;
        render_film(context, &film, after);
        CHECK(sum_of(after, 0) > sum_of(before, 0), "curve %u has no white", (unsigned)i);
    }
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
    grades(context);
    vignettes(context);
    filmic(context);
    transparent_images(context);
    regions(context);
    bhr_context_destroy(context);
    return check_end();
}
