/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* colour_bar.c -- see colour_bar.h. */
#include "colour_bar.h"

#include "common.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
#define GROUND 0.25 /* light of the picture that is left behind the bar, of codes */
#define NO_VALUE 128
#define LEAST_WIDTH 300u /* of a picture, in pixels, for text of scale 1 */
#define LEAST_HEIGHT 150u
/* Pixels at scale 1: above the title and below the numbers, the bar's thickness, capitals, ticks, and what is between
 * these and the numbers. COLOUR_BAR_ROWS is all of it, with two rows of text. */
#define EDGE 4u
#define THICK 9u
#define GLYPH_HEIGHT 7u
#define TICK 3u
#define GAP 2u

/* ---- colours ---- */

/* IEC 61966-2-1. */
static unsigned char encoded(double light) {
    const double clipped = fmin(fmax(light, 0.0), 1.0);
    const double v = clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * pow(clipped, 1.0 / 2.4) - 0.055;
    return (unsigned char)(255.0 * v + 0.5);
}

static double lab_inverse(double t) {
    return t > 6.0 / 29.0 ? t * t * t : (t - 16.0 / 116.0) * (108.0 / 841.0);
}

/* CIELAB, whose white is that of Rec. 709, as sRGB. */
static void from_lab(double lightness, double a, double b, unsigned char rgb[3]) {
    const double f = (lightness + 16.0) / 116.0;
    const double x = 0.950456 * lab_inverse(f + a / 500.0), y = lab_inverse(f);
    const double z = 1.089058 * lab_inverse(f - b / 200.0);
    rgb[0] = encoded(3.240970 * x - 1.537383 * y - 0.498611 * z);
    rgb[1] = encoded(-0.969244 * x + 1.875968 * y + 0.041555 * z);
    rgb[2] = encoded(0.055630 * x - 0.203977 * y + 1.056972 * z);
}

/* The two maps of docs/views.md. */
static void sequential(double s, unsigned char rgb[3]) {
    const double w = 4.76 + 3.78 * s;
    from_lab(15.0 + 76.0 * s, 11.0 + 56.0 * cos(w), 21.0 + 56.0 * sin(w), rgb);
}

static void diverging(double s, unsigned char rgb[3]) {
    const double m = fabs(2.0 * s - 1.0);
    const int    is_red = s < 0.5;
    from_lab(95.0 - 57.0 * m, (is_red ? 52.0 : 21.21) * m, (is_red ? 33.77 : -58.26) * m, rgb);
}

void colour_afmhot(double s, unsigned char rgb[3]) {
    for (int i = 0; i < 3; i++) {
        rgb[i] = (unsigned char)(255.0 * fmin(fmax(2.0 * s - 0.5 * i, 0.0), 1.0) + 0.5);
    }
}

/* ---- what views show ---- */

double colour_bar_share(BhrView view, double value) {
    double share;
    switch (view) {
    case BHR_VIEW_REDSHIFT: share = 0.5 + log(value) / (2.0 * log(3.0)); break;
    case BHR_VIEW_ORDER: share = (value + 2.0) / 5.0; break;
    case BHR_VIEW_DEFLECTION: share = 1.0 + log2(value / PI) / 6.0; break;
    case BHR_VIEW_STEPS: share = log2(value / 8.0) / 6.0; break;
    case BHR_VIEW_METRIC: share = 1.0 - sqrt(1.0 - fmin(value, 1.0)); break;
    case BHR_VIEW_OPTICAL_DEPTH: share = (log2(value) + 6.0) / 10.0; break;
    default: share = (log2(value) + 6.0) / 12.0; break;
    }
    return fmin(fmax(share, 0.0), 1.0);
}

typedef struct Named {
    double      value;
    const char *text;
} Named;

/* A view, with the values that are marked along its bar. */
typedef struct Shown {
    BhrView     view;
    const char *title, *no_value;
    Named       marks[MOST_MARKS]; /* as far as there is a text */
} Shown;

static const Shown SHOWN[] = {
    {BHR_VIEW_REDSHIFT, "frequency ratio g = seen / sent", "captured",
     {{1.0 / 3.0, "1/3"}, {0.5, "0.5"}, {0.7, "0.7"}, {1.0, "1"}, {1.5, "1.5"}, {2.0, "2"}, {3.0, "3"}}},
    {BHR_VIEW_ORDER, "image of the disk", NULL,
     {{-2.0, "hole"}, {-1.0, "sky"}, {0.0, "0"}, {1.0, "1"}, {2.0, "2"}, {3.0, "3 +"}}},
    {BHR_VIEW_DEFLECTION, "deflection of light, degrees", "captured",
     {{PI / 64.0, "2.8"}, {PI / 32.0, "5.6"}, {PI / 16.0, "11"}, {PI / 8.0, "22"}, {PI / 4.0, "45"}, {PI / 2.0, "90"},
      {PI, "180"}}},
    {BHR_VIEW_STEPS, "integration steps of a ray", NULL,
     {{8.0, "8"}, {16.0, "16"}, {32.0, "32"}, {64.0, "64"}, {128.0, "128"}, {256.0, "256"}, {512.0, "512"}}},
    {BHR_VIEW_METRIC, "-g_tt = 1 - 2 M / r, equator", "not met",
     {{0.0, "0"}, {0.3, "0.3"}, {0.6, "0.6"}, {0.8, "0.8"}, {0.9, "0.9"}, {0.96, "0.96"}, {1.0, "1"}}},
    {BHR_VIEW_OPTICAL_DEPTH, "optical depth", "captured",
     {{1.0 / 64.0, "1/64"}, {1.0 / 16.0, "1/16"}, {0.25, "1/4"}, {1.0, "1"}, {4.0, "4"}, {16.0, "16"}}},
    {BHR_VIEW_INTENSITY, "intensity, that of 1 M of density 1", NULL,
     {{1.0 / 64.0, "1/64"}, {1.0 / 8.0, "1/8"}, {1.0, "1"}, {8.0, "8"}, {64.0, "64"}}},
};

int colour_bar_of_view(BhrView view, ColourBar *bar) {
    for (size_t i = 0; i < COUNT_OF(SHOWN); i++) {
        const Shown *shown = &SHOWN[i];
        if (shown->view != view) {
            continue;
        }
        *bar = (ColourBar){.title = shown->title, .no_value = shown->no_value,
                           .colour = view == BHR_VIEW_REDSHIFT ? diverging : sequential};
        for (; bar->count < MOST_MARKS && shown->marks[bar->count].text != NULL; bar->count++) {
            const Named *mark = &shown->marks[bar->count];
            bar->marks[bar->count].share = colour_bar_share(view, mark->value);
            snprintf(bar->marks[bar->count].text, sizeof bar->marks->text, "%s", mark->text);
        }
        bar->steps = view == BHR_VIEW_ORDER ? bar->count : 0;
        return 1;
    }
    return 0;
}

int colour_bar_of_film(const BhrFilm *film, ColourBar *bar) {
    if (film->colour_map != BHR_COLOUR_MAP_AFMHOT) {
        return 0;
    }
    *bar = (ColourBar){.title = "luminance as developed, 1 = white", .colour = colour_afmhot};
    colour_bar_mark(bar, 1.0);
    return 1;
}

void colour_bar_mark(ColourBar *bar, double most) {
    const double power = pow(10.0, floor(log10(most))), leading = most / power;
    const double step = power * (leading < 1.5 ? 0.2 : leading < 3.0 ? 0.5 : leading < 6.0 ? 1.0 : 2.0);
    for (bar->count = 0; bar->count < MOST_MARKS && bar->count * step <= most * (1.0 + 1e-9); bar->count++) {
        bar->marks[bar->count].share = bar->count * step / most;
        snprintf(bar->marks[bar->count].text, sizeof bar->marks->text, "%g", bar->count * step);
    }
}

/* ---- drawing ---- */

static void fill(BhrImage *image, uint32_t x, uint32_t y, uint32_t width, uint32_t height, const unsigned char rgb[3]) {
    for (uint32_t row = y; row < y + height && row < image->height; row++) {
        for (uint32_t column = x; column < x + width && column < image->width; column++) {
            unsigned char *pixel = (unsigned char *)image->pixels + 4 * ((size_t)row * image->width + column);
            memcpy(pixel, rgb, 3);
            pixel[3] = 255;
        }
    }
}

/* Darkens the last rows, so that the picture is still seen there and text is legible. */
static void darken(BhrImage *image, uint32_t height) {
    for (uint32_t row = image->height - height; row < image->height; row++) {
        unsigned char *pixel = (unsigned char *)image->pixels + 4 * (size_t)row * image->width;
        for (uint32_t i = 0; i < 4 * image->width; i++) {
            pixel[i] = i % 4 == 3 ? 255 : (unsigned char)(GROUND * pixel[i]);
        }
    }
}

static uint32_t text_width(const char *text, uint32_t scale) {
    return (uint32_t)strlen(text) * CELL_WIDTH * scale;
}

static void draw_colours(BhrImage *image, const ColourBar *bar, uint32_t left, uint32_t top, uint32_t width,
                         uint32_t height) {
    for (uint32_t x = 0; x < width; x++) {
        double share = (x + 0.5) / width;
        if (bar->steps != 0) {
            share = bar->marks[(uint32_t)(share * bar->steps)].share;
        }
        unsigned char rgb[3];
        bar->colour(share, rgb);
        fill(image, left + x, top, 1, height, rgb);
    }
}

static void draw_marks(BhrImage *image, const ColourBar *bar, uint32_t left, uint32_t top, uint32_t width,
                       uint32_t scale) {
    static const unsigned char WHITE[3] = {235, 235, 235};
    for (uint32_t i = 0; i < bar->count; i++) {
        const double   share = bar->steps != 0 ? (i + 0.5) / bar->steps : bar->marks[i].share;
        const uint32_t x = left + (uint32_t)(share * (width - 1) + 0.5);
        if (bar->steps == 0) {
            fill(image, x, top, scale, TICK * scale, WHITE);
        }
        picture_write(image, x - text_width(bar->marks[i].text, scale) / 2 + scale, top + (TICK + GAP) * scale, scale,
                      bar->marks[i].text);
    }
}

void colour_bar_draw(BhrImage *image, const ColourBar *bar, uint32_t scale) {
    static const unsigned char GREY[3] = {NO_VALUE, NO_VALUE, NO_VALUE};
    const uint32_t             height = COLOUR_BAR_ROWS * scale, line = CELL_HEIGHT * scale, edge = EDGE * scale;
    const uint32_t             margin = image->width / 12, width = image->width - 2 * margin;
    const uint32_t             top = image->height - height;
    darken(image, height);
    picture_write(image, margin, top + edge, scale, bar->title);
    if (bar->no_value != NULL) {
        const uint32_t x = margin + width - text_width(bar->no_value, scale);
        fill(image, x - line, top + edge, GLYPH_HEIGHT * scale, GLYPH_HEIGHT * scale, GREY);
        picture_write(image, x, top + edge, scale, bar->no_value);
    }
    draw_colours(image, bar, margin, top + edge + line, width, THICK * scale);
    draw_marks(image, bar, margin, top + edge + line + THICK * scale, width, scale);
}

BhrStatus colour_bar_of_frames(const BhrContext *context, ColourBar *bar) {
    BhrView view;
    BhrFilm film;
    BHR_INIT(film);
    BhrStatus status = bhr_get_view(context, &view);
    if (status >= 0) {
        status = bhr_get_film(context, &film);
    }
    if (status < 0 || !(view == BHR_VIEW_LIGHT ? colour_bar_of_film(&film, bar) : colour_bar_of_view(view, bar))) {
        *bar = (ColourBar){.count = 0};
    }
    return status;
}

uint32_t colour_bar_put(BhrImage *image, const ColourBar *bar) {
    /* Text looks alike on a page, whatever a picture's resolution. */
    const uint32_t by_width = image->width / LEAST_WIDTH, by_height = image->height / LEAST_HEIGHT;
    const uint32_t scale = ((by_width < by_height ? by_width : by_height) + 1) / 2;
    if (scale == 0 || bar->count == 0) {
        return 0;
    }
    colour_bar_draw(image, bar, scale);
    return COLOUR_BAR_ROWS * scale;
}

BhrStatus colour_bar_add(const BhrContext *context, BhrImage *image) {
    ColourBar       bar;
    const BhrStatus status = colour_bar_of_frames(context, &bar);
    colour_bar_put(image, &bar);
    return status;
}
