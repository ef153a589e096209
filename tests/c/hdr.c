/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* hdr.c -- pictures of high dynamic range: codes of PQ and HLG are those of ITU-R BT.2100 and BT.2390 for the light of
 * the same frame in floats; files say what they hold; views are refused. Colour spaces of float images: light is
 * converted, files say so, and it is refused where Rec. 709 is expected. Gets an empty folder. */
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 96u
#define HEIGHT 64u
#define PIXELS (WIDTH * HEIGHT)

static float    light[PIXELS][4];
static uint32_t words[PIXELS], again[PIXELS];

static void set_film(BhrContext *context, double paper_white, double peak, double exposure_ev, double bloom) {
    BhrFilm film;
    BHR_INIT(film);
    film.paper_white = paper_white, film.peak = peak;
    film.exposure_ev = exposure_ev, film.bloom = bloom;
    CHECK_OK(bhr_set_film(context, &film));
    BhrFilm got;
    BHR_INIT(got);
    CHECK_OK(bhr_get_film(context, &got));
    CHECK(got.paper_white == paper_white && got.peak == peak, "%g and %g are got as %g and %g", paper_white, peak,
          got.paper_white, got.peak);
}

static void render(BhrContext *context, BhrFormat format, uint32_t flags, void *pixels) {
    BhrImage image = image_of(format, WIDTH, HEIGHT, pixels, PIXELS * bytes_per_pixel(format));
    image.flags = flags;
    CHECK_OK(bhr_render_image(context, &image));
}

/* ITU-R BT.2100, table 4: light in parts of 10000 cd/m^2. */
static double pq_code(double y) {
    const double power = pow(y, 2610.0 / 16384);
    return pow((3424.0 / 4096 + 2413.0 / 128 * power) / (1 + 2392.0 / 128 * power), 2523.0 / 32);
}

static double pq_light(double code) {
    const double root = pow(code, 32 / 2523.0);
    return pow(fmax(root - 3424.0 / 4096, 0) / (2413.0 / 128 - 2392.0 / 128 * root), 16384 / 2610.0);
}

/* The light that a display shows, in parts of 10000 cd/m^2, in Rec. 2020: ITU-R BT.2390, 5.4.1, and BT.2087. */
static void display(const float *rgb, double exposure, double white, double peak, double shown[3]) {
    double most = 0, in[3];
    for (int c = 0; c < 3; c++) {
        in[c] = rgb[c] * exposure * white / 10000;
    }
    shown[0] = 0.627404 * in[0] + 0.329283 * in[1] + 0.043313 * in[2];
    shown[1] = 0.069097 * in[0] + 0.919540 * in[1] + 0.011362 * in[2];
    shown[2] = 0.016391 * in[0] + 0.088013 * in[1] + 0.895595 * in[2];
    for (int c = 0; c < 3; c++) {
        most = fmax(most, shown[c]);
    }
    const double e = pq_code(peak / 10000), knee = 1.5 * e - 0.5, code = pq_code(fmin(most, 1));
    const double t = (code - knee) / (1 - knee);
    const double t2 = t * t, t3 = t2 * t;
    const double bent = (2 * t3 - 3 * t2 + 1) * knee + (t3 - 2 * t2 + t) * (1 - knee) + (3 * t2 - 2 * t3) * e;
    const double rolled = code <= knee ? code : bent;
    const double factor = most > 0 ? pq_light(rolled) / most : 0;
    for (int c = 0; c < 3; c++) {
        shown[c] *= factor;
    }
}

/* ITU-R BT.2100, table 5, for a display of 1000 cd/m^2. */
static void hlg_codes(const double shown[3], double codes[3]) {
    const double luminance = 10 * (0.2627 * shown[0] + 0.678 * shown[1] + 0.0593 * shown[2]);
    for (int c = 0; c < 3; c++) {
        const double scene = luminance > 0 ? fmin(10 * shown[c] * pow(luminance, (1 - 1.2) / 1.2), 1) : 0;
        codes[c] = scene <= 1.0 / 12 ? sqrt(3 * scene) : 0.17883277 * log(12 * scene - 0.28466892) + 0.55991073;
    }
}

/* Codes against the light of the same frame in floats: rounded by a dither of one step, and a step more. */
static void codes_are_those_of_the_light(BhrContext *context, BhrFormat format, double white, double peak, double ev) {
    set_film(context, white, peak, ev, 0);
    render(context, BHR_FORMAT_RGBA32F, 0, light);
    render(context, format, 0, words);
    double  most = 0;
    uint32_t brightest = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        double shown[3], codes[3];
        display(light[i], exp2(ev), white, peak, shown);
        hlg_codes(shown, codes);
        for (int c = 0; c < 3; c++) {
            const uint32_t got = words[i] >> (10 * c) & 1023;
            const double   wanted = format == BHR_FORMAT_RGB10A2_PQ ? pq_code(fmin(shown[c], 1)) : codes[c];
            most = fmax(most, fabs(got - 1023 * wanted));
            brightest = got > brightest ? got : brightest;
        }
        CHECK(words[i] >> 30 == 3, "pixel %u is transparent", (unsigned)i);
    }
    CHECK(most <= 1.6, "format %d, white %g, peak %g: %g codes off", format, white, peak, most);
    CHECK(brightest > 500, "format %d, white %g, peak %g: the brightest code is %u", format, white, peak, brightest);
}

/* Whether the picture shows light that differs from `words`. */
static int differs(BhrContext *context, BhrFormat format) {
    render(context, format, 0, again);
    return memcmp(words, again, sizeof words) != 0;
}

static void films_that_are_heeded(BhrContext *context) {
    BhrFilm film, changed;
    BHR_INIT(film);
    film.bloom = 0;
    CHECK_OK(bhr_set_film(context, &film));
    render(context, BHR_FORMAT_RGB10A2_PQ, 0, words);
    changed = film, changed.tone_map = BHR_TONE_MAP_AGX, changed.colour_map = BHR_COLOUR_MAP_AFMHOT;
    CHECK_OK(bhr_set_film(context, &changed));
    CHECK(!differs(context, BHR_FORMAT_RGB10A2_PQ), "a tone map or colour map changes PQ");
    changed = film, changed.bloom = 1;
    CHECK_OK(bhr_set_film(context, &changed));
    CHECK(differs(context, BHR_FORMAT_RGB10A2_PQ), "PQ has no glare");
    changed = film, changed.saturation = 0;
    CHECK_OK(bhr_set_film(context, &changed));
    CHECK(differs(context, BHR_FORMAT_RGB10A2_PQ), "PQ has no grade");
    changed = film, changed.auto_exposure = 1, changed.auto_target = 4;
    CHECK_OK(bhr_set_film(context, &changed));
    CHECK(differs(context, BHR_FORMAT_RGB10A2_PQ), "PQ is not metered");
    CHECK_OK(bhr_set_film(context, &film));
    render(context, BHR_FORMAT_RGB10A2_PQ, BHR_IMAGE_TRANSPARENT, again);
    size_t clear = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        clear += again[i] >> 30 == 0;
    }
    CHECK(clear > PIXELS / 10, "%u pixels are transparent", (unsigned)clear);
}

/* A file of 16 bits, whose light is that of the codes over diffuse white of 203 cd/m^2, as files are read. */
static void files_say_what_they_hold(BhrContext *context, const char *folder) {
    static const BhrFormat formats[] = {BHR_FORMAT_RGB10A2_PQ, BHR_FORMAT_RGB10A2_HLG};
    for (size_t i = 0; i < COUNT_OF(formats); i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/hdr%u.png", folder, (unsigned)i);
        set_film(context, 203, 10000, -2, 0);
        render(context, formats[i], 0, words);
        const BhrImage image = image_of(formats[i], WIDTH, HEIGHT, words, sizeof words);
        CHECK_OK(bhr_image_save(&image, path));
        BhrImage read;
        BHR_INIT(read);
        if (!CHECK_OK(bhr_image_load(path, &read))) {
            continue;
        }
        CHECK(read.format == BHR_FORMAT_RGBA32F && read.width == WIDTH && read.height == HEIGHT, "format %d, %u x %u",
              read.format, read.width, read.height);
        render(context, BHR_FORMAT_RGBA32F, 0, light);
        double most = 0;
        for (size_t p = 0; p < PIXELS && formats[i] == BHR_FORMAT_RGB10A2_PQ; p++) {
            for (int c = 0; c < 3; c++) {
                /* Dim light, and what Rec. 709 rounds, aside: a code is up to 2 % of light. */
                const double wanted = light[p][c] / 4, got = ((const float *)read.pixels)[4 * p + (size_t)c];
                most = fmax(most, wanted > 0.05 ? fabs(got / wanted - 1) : 0);
            }
        }
        CHECK(most < 0.05, "light of a file is %g off", most);
        CHECK_OK(bhr_image_release(&read));
        char other[4096];
        snprintf(other, sizeof other, "%s/hdr%u.exr", folder, (unsigned)i);
        CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "RGB10A2", bhr_image_save(&image, other));
    }
}

static BhrImage float_image(float (*pixels)[4]) {
    BhrImage image;
    BHR_INIT(image);
    image.format = BHR_FORMAT_RGBA32F, image.width = WIDTH, image.height = HEIGHT;
    image.pixels = pixels, image.byte_size = sizeof light;
    return image;
}

static void colour_spaces(BhrContext *context, const char *folder) {
    static const double acescg[3][3] = {
        {0.613097, 0.339523, 0.047379}, {0.070194, 0.916354, 0.013452}, {0.020616, 0.109570, 0.869815}};
    static float other[PIXELS][4];
    BhrImage     image = float_image(other);
    render(context, BHR_FORMAT_RGBA32F, 0, light);
    memcpy(other, light, sizeof light);
    CHECK_OK(bhr_image_convert(&image, BHR_COLOUR_SPACE_ACESCG));
    CHECK(image.colour_space == BHR_COLOUR_SPACE_ACESCG, "its colour space is %d", image.colour_space);
    double most = 0;
    for (size_t p = 0; p < PIXELS; p++) {
        for (int row = 0; row < 3; row++) {
            double wanted = 0;
            for (int c = 0; c < 3; c++) {
                wanted += acescg[row][c] * light[p][c];
            }
            most = fmax(most, fabs(other[p][row] - wanted) / (wanted + 1e-3));
        }
        CHECK(other[p][3] == light[p][3], "alpha changes");
    }
    CHECK(most < 1e-5, "light in ACEScg is %g off", most);

    char path[4096];
    snprintf(path, sizeof path, "%s/acescg.exr", folder);
    CHECK_OK(bhr_image_save(&image, path));
    BhrImage read;
    BHR_INIT(read);
    if (CHECK_OK(bhr_image_load(path, &read))) {
        most = 0;
        for (size_t i = 0; i < 4 * PIXELS; i++) {
            const double wanted = light[i / 4][i % 4];
            most = fmax(most, fabs(((const float *)read.pixels)[i] - wanted) / (fabs(wanted) + 1e-3));
        }
        CHECK(most < 1e-4 && read.colour_space == BHR_COLOUR_SPACE_REC709, "a file's light is %g off", most);
        CHECK_OK(bhr_image_release(&read));
    }

    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "colour_space", bhr_render_image(context, &image));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "colour_space", bhr_set_sky_map(context, &image));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "colour", bhr_image_convert(&image, 4));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "colour", bhr_image_convert(&image, -1));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "NULL", bhr_image_convert(NULL, BHR_COLOUR_SPACE_REC709));
    BhrImage bad = image;
    bad.format = BHR_FORMAT_RGBA8_SRGB;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "RGBA8_SRGB", bhr_image_convert(&bad, BHR_COLOUR_SPACE_REC709));
    bad = image, bad.byte_size--;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "byte_size", bhr_image_convert(&bad, BHR_COLOUR_SPACE_REC709));
    bad = image, bad.struct_size = (uint32_t)offsetof(BhrImage, colour_space);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_image_convert(&bad, BHR_COLOUR_SPACE_REC2020));

    CHECK_OK(bhr_image_convert(&image, BHR_COLOUR_SPACE_P3_D65));
    CHECK_OK(bhr_image_convert(&image, BHR_COLOUR_SPACE_REC2020));
    CHECK_OK(bhr_image_convert(&image, BHR_COLOUR_SPACE_REC709));
    CHECK_OK(bhr_render_image(context, &image));
}

static void what_does_not_go_is_refused(BhrContext *context) {
    const BhrImage image = image_of(BHR_FORMAT_RGB10A2_PQ, WIDTH, HEIGHT, words, sizeof words);
    CHECK_OK(bhr_set_view(context, BHR_VIEW_REDSHIFT));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "RGB10A2_PQ", bhr_render_image(context, &image));
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "RGB10A2_PQ", bhr_set_sky_map(context, &image));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "RGB10A2_PQ", bhr_set_occluder(context, &image));
    BhrImage odd = image;
    odd.pixels = (char *)odd.pixels + 2, odd.height = 1, odd.byte_size = sizeof words - 2;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "multiple of 4", bhr_render_image(context, &odd));
    odd = image, odd.format = 8;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "format", bhr_render_image(context, &odd));
    CHECK_OK(bhr_render_image(context, &image));
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    codes_are_those_of_the_light(context, BHR_FORMAT_RGB10A2_PQ, 203, 1000, 0);
    codes_are_those_of_the_light(context, BHR_FORMAT_RGB10A2_PQ, 100, 10000, 2);
    codes_are_those_of_the_light(context, BHR_FORMAT_RGB10A2_PQ, 300, 400, 1);
    codes_are_those_of_the_light(context, BHR_FORMAT_RGB10A2_HLG, 203, 1000, 0);
    films_that_are_heeded(context);
    files_say_what_they_hold(context, argc > 2 ? argv[2] : ".");
    colour_spaces(context, argc > 2 ? argv[2] : ".");
    what_does_not_go_is_refused(context);
    bhr_context_destroy(context);
    return check_end();
}
