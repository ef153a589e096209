/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* accumulation.c -- frames that are measured, and frames that are added up, as a host asks for them: what auto exposure
 * adds is told, and what cannot be is refused; accumulated frames of one scene are its frame, in any layout, and bad
 * arguments in any order change nothing. */
#include "check.h"

#include <math.h>
#include <string.h>

#define WIDTH 64u
#define HEIGHT 40u
#define BYTES (WIDTH * HEIGHT * 4u)

static unsigned char before[BYTES], after[2 * BYTES];

static BhrImage picture(unsigned char *pixels) {
    return image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
}

static double auto_ev(BhrContext *context) {
    BhrFrameStats stats;
    CHECK_OK(bhr_frame_stats_init(&stats, sizeof stats));
    CHECK_OK(bhr_frame_stats(context, &stats));
    return stats.auto_ev;
}

static size_t differing(const unsigned char *a, const unsigned char *b, int most) {
    size_t count = 0;
    for (size_t i = 0; i < BYTES; i++) {
        count += a[i] > b[i] + most || b[i] > a[i] + most;
    }
    return count;
}

/* Exposures two stops apart come out alike, and the difference is told; so do limits. */
static void exposes(BhrContext *context) {
    BhrFilm        film;
    const BhrImage image = picture(before), other = picture(after);
    CHECK_OK(bhr_film_init(&film, sizeof film));
    CHECK(film.auto_exposure == 0.0 && film.highlights == 0.0 && film.shadows == 0.0, "a film measures by default");
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(auto_ev(context) == 0.0, "%g stops are added without auto exposure", auto_ev(context));
    film.auto_exposure = 1.0, film.auto_percentile = 98.0;
    film.auto_least_ev = -20.0, film.auto_most_ev = 20.0;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &image));
    const double bright = auto_ev(context);
    film.exposure_ev = -2.0;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &other));
    const double dark = auto_ev(context);
    CHECK(fabs(dark - bright - 2.0) < 0.05, "%g and %g stops, two stops apart", bright, dark);
    CHECK(differing(before, after, 3) * 100 < BYTES, "%u bytes differ", (unsigned)differing(before, after, 3));
    film.auto_most_ev = 1.5, film.auto_least_ev = 1.5;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &other));
    CHECK(auto_ev(context) == 1.5, "%g stops, and 1.5 is both limits", auto_ev(context));
    film.auto_exposure = 0.0, film.highlights = film.shadows = 1.0;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &other));
    CHECK(auto_ev(context) == 0.0, "highlights and shadows add %g stops", auto_ev(context));
}

/* A part does not know the whole. */
static void needs_the_whole(BhrContext *context) {
    const BhrRegion region = {.struct_size = sizeof region, .full_width = 2 * WIDTH, .full_height = HEIGHT};
    const BhrImage  image = picture(after);
    static const struct {
        size_t      offset;
        const char *words;
    } fields[] = {{offsetof(BhrFilm, auto_exposure), "auto_exposure is 0.5"},
                  {offsetof(BhrFilm, highlights), "highlights is 0.5"},
                  {offsetof(BhrFilm, shadows), "shadows is 0.5"}};
    CHECK_OK(bhr_set_region(context, &region));
    for (size_t i = 0; i < COUNT_OF(fields); i++) {
        BhrFilm film;
        CHECK_OK(bhr_film_init(&film, sizeof film));
        film.bloom = 0.0;
        *(double *)((char *)&film + fields[i].offset) = 0.5;
        CHECK_OK(bhr_set_film(context, &film));
        CHECK_FAILS(BHR_ERROR_INVALID_STATE, fields[i].words, bhr_render_image(context, &image));
    }
    CHECK_OK(bhr_begin_accumulation(context, WIDTH, HEIGHT, 0));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "region", bhr_accumulate(context, 1.0));
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK_OK(bhr_end_accumulation(context, NULL));
}

/* Three frames of one scene are the frame, top-down, bottom-up and with gaps. */
static void adds_up(BhrContext *context) {
    BhrFilm film;
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.bloom = 0.5, film.auto_exposure = 1.0, film.highlights = 0.4;
    CHECK_OK(bhr_set_film(context, &film));
    const BhrImage whole = picture(before);
    CHECK_OK(bhr_render_image(context, &whole));
    const int64_t strides[] = {0, WIDTH * 8, 0};
    for (size_t k = 0; k < COUNT_OF(strides); k++) {
        CHECK_OK(bhr_begin_accumulation(context, WIDTH, HEIGHT, 0));
        for (int i = 0; i < 3; i++) {
            CHECK_OK(bhr_accumulate(context, 1.0 + i));
        }
        BhrImage image = picture(after);
        image.row_stride = strides[k], image.byte_size = sizeof after;
        image.flags = k == 2 ? BHR_IMAGE_BOTTOM_UP : 0;
        memset(after, 0, sizeof after);
        CHECK_OK(bhr_end_accumulation(context, &image));
        static unsigned char packed[BYTES];
        for (size_t y = 0; y < HEIGHT; y++) {
            const size_t row = k == 2 ? HEIGHT - 1 - y : y;
            memcpy(packed + y * WIDTH * 4, after + row * (k == 1 ? WIDTH * 8 : WIDTH * 4), WIDTH * 4);
        }
        const size_t off = differing(before, packed, 1);
        CHECK(off * 500 < BYTES, "layout %u: %u bytes differ", (unsigned)k, (unsigned)off);
    }
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bhr_begin_accumulation", bhr_end_accumulation(context, &whole));
}

/* Mistakes are refused, whatever the order, and the frames that were added stay. */
static void refuses(BhrContext *context) {
    BhrImage image = picture(after);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_begin_accumulation(NULL, WIDTH, HEIGHT, 0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_accumulate(NULL, 1.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_end_accumulation(NULL, &image));
    CHECK_OK(bhr_end_accumulation(context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bhr_begin_accumulation", bhr_accumulate(context, 1.0));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bhr_begin_accumulation", bhr_end_accumulation(context, &image));
    CHECK_OK(bhr_begin_accumulation(context, WIDTH, HEIGHT, 0));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bhr_accumulate", bhr_end_accumulation(context, &image));
    CHECK_OK(bhr_accumulate(context, 1.0));
    static const uint32_t sizes[][2] = {{0, 4}, {4, 0}, {1u << 21, 1}, {1, UINT32_MAX}, {1u << 20, 1u << 20}};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        CHECK_FAILS(i == 4 ? BHR_ERROR_OUT_OF_MEMORY : BHR_ERROR_INVALID_ARGUMENT, "",
                    bhr_begin_accumulation(context, sizes[i][0], sizes[i][1], 0));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_begin_accumulation(context, WIDTH, HEIGHT, 2));
    static const double weights[] = {0.0, -1.0, 9e-7, 1.1e6, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(weights); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "weight", bhr_accumulate(context, weights[i]));
    }
    CHECK_OK(bhr_set_view(context, BHR_VIEW_REDSHIFT));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "REDSHIFT", bhr_accumulate(context, 1.0));
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    memset(after, 77, sizeof after);
    BhrImage bad = image;
    bad.width--;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "64 x 40", bhr_end_accumulation(context, &bad));
    bad = image, bad.flags = BHR_IMAGE_TRANSPARENT;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "TRANSPARENT", bhr_end_accumulation(context, &bad));
    bad = image, bad.format = BHR_FORMAT_R32F;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "R32F", bhr_end_accumulation(context, &bad));
    bad = image, bad.byte_size = BYTES - 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "", bhr_end_accumulation(context, &bad));
    bad = image, bad.pixels = NULL;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "", bhr_end_accumulation(context, &bad));
    bad = image, bad.struct_size = 3;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "", bhr_end_accumulation(context, &bad));
    for (size_t i = 0; i < sizeof after; i++) {
        if (after[i] != 77) {
            CHECK(0, "a refused image was written to");
            break;
        }
    }
    /* Other frames between them do no harm. */
    const BhrImage other = picture(before);
    CHECK_OK(bhr_render_image(context, &other));
    CHECK_OK(bhr_accumulate(context, 1e6));
    CHECK_OK(bhr_end_accumulation(context, &image));
    CHECK(differing(before, after, 1) * 500 < BYTES, "the frame is not the one that was added");
    /* A context may end with frames that are not developed. */
    CHECK_OK(bhr_begin_accumulation(context, 16, 16, BHR_IMAGE_TRANSPARENT));
    CHECK_OK(bhr_accumulate(context, 1.0));
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    exposes(context);
    needs_the_whole(context);
    adds_up(context);
    refuses(context);
    bhr_context_destroy(context);
    return check_end();
}
