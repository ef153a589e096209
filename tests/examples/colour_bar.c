/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* colour_bar.c -- the colours of examples-c/colour_bar.c are the library's: every view is rendered twice, as values and
 * as colours. The bar that is drawn has them, and leaves the rest of the picture alone. Says what is amiss; exit status
 * 1 then. */
#include "colour_bar.h"
#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 320u /* of a picture that has room for a bar */
#define HEIGHT 180u
#define COLUMNS 96u /* of the pictures that are rendered */
#define ROWS 54u
#define MOST_OFF 2 /* of 255: the library computes colours in single precision */

static int failures;

#define CHECK(condition, ...) \
    do { \
        if (!(condition)) { \
            failures++; \
            printf("line %d: ", __LINE__); \
            printf(__VA_ARGS__); \
            putchar('\n'); \
        } \
    } while (0)

static void must(BhrStatus status) {
    if (status < 0) {
        printf("%s\n", bhr_error_message());
        exit(EXIT_FAILURE);
    }
}

/* Something for every view: a disk, and beside it matter that shines by a power law. */
static BhrContext *scene(void) {
    BhrContext       *context;
    BhrContextOptions options;
    BhrVolume         volume;
    BHR_INIT(options);
    options.backend = BHR_BACKEND_CPU;
    must(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    BHR_INIT(volume);
    volume.flags = BHR_VOLUME_POWER_LAW;
    volume.absorption = 0.3;
    volume.outer_radius = 30.0;
    must(bhr_set_spin(context, 0.9));
    must(bhr_set_volumes(context, &volume, sizeof volume, 1));
    return context;
}

static int distance(const unsigned char a[3], const unsigned char b[3]) {
    int most = 0;
    for (int i = 0; i < 3; i++) {
        most = abs(a[i] - b[i]) > most ? abs(a[i] - b[i]) : most;
    }
    return most;
}

/* A view's colours against its values. */
static void compare(BhrContext *context, BhrView view) {
    static const unsigned char GREY[3] = {128, 128, 128};
    BhrImage                   values, shown;
    ColourBar                  bar;
    unsigned                   counted = 0;
    CHECK(colour_bar_of_view(view, &bar), "view %d has no bar", (int)view);
    if (!picture_allocate(&values, BHR_FORMAT_R32F, COLUMNS, ROWS) ||
        !picture_allocate(&shown, BHR_FORMAT_RGBA8_SRGB, COLUMNS, ROWS)) {
        exit(EXIT_FAILURE);
    }
    must(bhr_set_view(context, view));
    must(bhr_render_image(context, &values));
    must(bhr_render_image(context, &shown));
    int most = 0, least = 255, greatest = 0, greys = 0;
    for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
        const float          value = ((const float *)values.pixels)[i];
        const unsigned char *pixel = (const unsigned char *)shown.pixels + 4 * (size_t)i;
        unsigned char        rgb[3];
        if (isnan(value)) {
            CHECK(distance(pixel, GREY) == 0, "view %d: no value is not grey", (int)view);
            greys++;
            continue;
        }
        const double share = colour_bar_share(view, value);
        bar.colour(share, rgb);
        const int off = distance(rgb, pixel);
        most = off > most ? off : most;
        least = 255.0 * share < least ? (int)(255.0 * share) : least;
        greatest = 255.0 * share > greatest ? (int)(255.0 * share) : greatest;
        counted++;
    }
    free(values.pixels);
    free(shown.pixels);
    printf("view %d: %u pixels from %d to %d of 255 along the bar, %d grey; off by at most %d\n", (int)view, counted,
           least, greatest, greys, most);
    CHECK(most <= MOST_OFF, "view %d: a colour is off by %d", (int)view, most);
    CHECK(greatest - least > 40, "view %d shows too little to compare", (int)view);
    CHECK((bar.no_value != NULL) == (greys > 0), "view %d has %d grey pixels, but its bar says %s", (int)view, greys,
          bar.no_value != NULL ? bar.no_value : "nothing of them");
}

/* Words do not run into each other, and numbers neither, in the narrowest picture that gets a bar. */
static void fits(const ColourBar *bar) {
    const double width = 300 - 2 * (300 / 12);
    const size_t words = strlen(bar->title) + (bar->no_value != NULL ? 2 + strlen(bar->no_value) : 0);
    CHECK((double)(words * CELL_WIDTH) < width, "\"%s\" has no room", bar->title);
    for (uint32_t i = 1; i < bar->count && bar->steps == 0; i++) {
        const double apart = (bar->marks[i].share - bar->marks[i - 1].share) * width;
        const size_t letters = strlen(bar->marks[i].text) + strlen(bar->marks[i - 1].text);
        CHECK(apart > 0.5 * (double)(letters * CELL_WIDTH) + 2.0, "%s: %s and %s are too near", bar->title,
              bar->marks[i - 1].text, bar->marks[i].text);
    }
}

/* The bar that is added: rows above it are as they were; somewhere in it is a row that runs through the colours. */
static void draw(BhrContext *context, BhrView view, BhrImage *picture) {
    const size_t   row_bytes = 4 * (size_t)WIDTH, bytes = row_bytes * HEIGHT;
    unsigned char *before = malloc(bytes);
    ColourBar      bar;
    int            runs = 0;
    if (before == NULL || !colour_bar_of_view(view, &bar)) {
        exit(EXIT_FAILURE);
    }
    picture_fill(picture, 200);
    memcpy(before, picture->pixels, bytes);
    must(colour_bar_add(context, picture));
    CHECK(memcmp(before, picture->pixels, row_bytes * (HEIGHT - COLOUR_BAR_ROWS)) == 0, "view %d: above the bar",
          (int)view);
    for (uint32_t y = HEIGHT - COLOUR_BAR_ROWS; y < HEIGHT; y++) {
        const unsigned char *row = (const unsigned char *)picture->pixels + row_bytes * y;
        int                  matches = 1;
        for (uint32_t i = 0; i < bar.count; i++) {
            const double   share = bar.steps != 0 ? (i + 0.5) / bar.steps : bar.marks[i].share;
            const uint32_t margin = WIDTH / 12, across = WIDTH - 2 * margin;
            unsigned char  rgb[3];
            bar.colour(bar.marks[i].share, rgb);
            matches = matches && distance(rgb, row + 4 * (margin + (uint32_t)(share * (across - 1) + 0.5))) <= 6;
        }
        runs += matches;
    }
    CHECK(runs >= 5, "view %d: %d rows have the colours at the marks", (int)view, runs);
    free(before);
}

/* IEC 61966-2-1. */
static double light_of(unsigned char code) {
    const double v = code / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* How far a colour, were it as bright as can be shown, is from that of the bar at its nearest. */
static double off_bar(const ColourBar *bar, const float light[3]) {
    const double most = fmax(fmax(light[0], light[1]), light[2]);
    double       nearest = 1.0;
    for (int step = 0; step <= 400; step++) {
        unsigned char rgb[3];
        double        off = 0.0;
        bar->colour(step / 400.0, rgb);
        for (int i = 0; i < 3; i++) {
            off = fmax(off, fabs(light_of(rgb[i]) - light[i] / most));
        }
        nearest = fmin(nearest, off);
    }
    return nearest;
}

/* The bar of temperatures is that of BHR_PRESET_TEACHING alone, and its disk has no other colours. */
static void explains_temperatures(void) {
    BhrContextOptions options;
    BhrContext       *context;
    ColourBar         bar;
    BhrImage          seen;
    double            worst = 0.0;
    unsigned          counted = 0;
    BHR_INIT(options);
    options.backend = BHR_BACKEND_CPU;
    must(bhr_context_create(BHR_ABI_VERSION, &options, &context));
    for (BhrPreset preset = BHR_PRESET_CINEMATIC; preset <= BHR_PRESET_TEACHING; preset++) {
        must(bhr_set_preset(context, preset));
        CHECK(colour_bar_of_temperatures(context, &bar) == (preset == BHR_PRESET_TEACHING), "preset %d", (int)preset);
    }
    fits(&bar);
    ColourBar other;
    BhrFilm   film;
    BHR_INIT(film);
    must(bhr_set_effect_strength(context, BHR_EFFECT_DOPPLER_SHIFT, 0.5));
    CHECK(!colour_bar_of_temperatures(context, &other), "half of the Doppler shift");
    must(bhr_set_effect_strength(context, BHR_EFFECT_DOPPLER_SHIFT, 1.0));
    must(bhr_get_film(context, &film));
    film.saturation = 0.5;
    must(bhr_set_film(context, &film));
    CHECK(!colour_bar_of_temperatures(context, &other), "a grade");
    film.saturation = 1.0;
    must(bhr_set_film(context, &film));
    if (!picture_allocate(&seen, BHR_FORMAT_RGBA32F, COLUMNS, ROWS)) {
        exit(EXIT_FAILURE);
    }
    BhrSky sky;
    BHR_INIT(sky);
    sky.flags = 0; /* lines of the grid have colours of their own */
    must(bhr_set_sky(context, &sky));
    must(bhr_render_image(context, &seen));
    for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
        const float *light = (const float *)seen.pixels + 4 * (size_t)i;
        if (light[0] + light[1] + light[2] > 0.1f) {
            worst = fmax(worst, off_bar(&bar, light));
            counted++;
        }
    }
    free(seen.pixels);
    bhr_context_destroy(context);
    printf("temperatures: %u pixels, off by at most %.3f\n", counted, worst);
    CHECK(counted > 300 && worst < 0.03, "%u pixels, off by %.3f", counted, worst);
}

/* No bar: in pictures of light, and in those that are too small. The film's colour map has one. */
static void is_drawn_where_it_belongs(BhrContext *context, BhrImage *picture) {
    BhrImage small = *picture;
    BhrFilm  film;
    small.width = 299;
    memset(picture->pixels, 90, 4 * (size_t)WIDTH * HEIGHT);
    must(bhr_set_view(context, BHR_VIEW_STEPS));
    must(colour_bar_add(context, &small));
    must(bhr_set_view(context, BHR_VIEW_LIGHT));
    must(colour_bar_add(context, picture));
    const unsigned char *pixels = picture->pixels;
    for (size_t i = 0; i < 4 * (size_t)WIDTH * HEIGHT; i++) {
        CHECK(pixels[i] == 90, "a bar where none belongs");
    }
    BHR_INIT(film);
    film.colour_map = BHR_COLOUR_MAP_AFMHOT;
    must(bhr_set_film(context, &film));
    must(colour_bar_add(context, picture));
    CHECK(pixels[4 * (size_t)WIDTH * HEIGHT - 4] < 90, "the film's colour map has no bar");
}

int main(void) {
    BhrContext *context = scene();
    BhrImage    picture;
    if (!picture_allocate(&picture, BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT)) {
        return EXIT_FAILURE;
    }
    for (BhrView view = BHR_VIEW_REDSHIFT; view <= BHR_VIEW_INTENSITY; view++) {
        compare(context, view);
        draw(context, view, &picture);
        ColourBar bar;
        CHECK(colour_bar_of_view(view, &bar), "view %d has no bar", (int)view);
        fits(&bar);
    }
    explains_temperatures();
    is_drawn_where_it_belongs(context, &picture);
    free(picture.pixels);
    bhr_context_destroy(context);
    return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
