/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* colour_bar.c -- see colour_bar.h. */
#include "colour_bar.h"

#include "common.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
#define COLDEST 2000.0 /* of the bar of temperatures, in kelvin */
#define HOTTEST 12000.0
#define GROUND 0.25 /* light of the picture that is left behind the bar, of codes */
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

/* A bell whose halves have widths of their own, nm. */
static double lobe(double wavelength, double middle, double below, double above) {
    const double x = (wavelength - middle) / (wavelength < middle ? below : above);
    return exp(-0.5 * x * x);
}

/* The colour of a blackbody at a temperature, in kelvin, as bright as it can be shown: Planck's law, seen by the CIE
 * 1931 observer as C. Wyman, P.-P. Sloan and P. Shirley (JCGT 2, 2013) fit it. */
static void from_temperature(double temperature, unsigned char rgb[3]) {
    double x = 0.0, y = 0.0, z = 0.0;
    for (double nm = 380.0; nm <= 780.0; nm += 5.0) {
        const double power = pow(nm / 560.0, -5.0) / (exp(1.4387769e7 / (nm * temperature)) - 1.0);
        x += power * (1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7) -
                      0.065 * lobe(nm, 501.1, 20.4, 26.2));
        y += power * (0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1));
        z += power * (1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8));
    }
    const double light[3] = {fmax(3.240970 * x - 1.537383 * y - 0.498611 * z, 0.0),
                             fmax(-0.969244 * x + 1.875968 * y + 0.041555 * z, 0.0),
                             fmax(0.055630 * x - 0.203977 * y + 1.056972 * z, 0.0)};
    const double most = fmax(fmax(light[0], light[1]), light[2]);
    for (int i = 0; i < 3; i++) {
        rgb[i] = encoded(light[i] / most);
    }
}

static void by_temperature(double share, unsigned char rgb[3]) {
    from_temperature(COLDEST * pow(HOTTEST / COLDEST, share), rgb);
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

/* Whether the film shows light as it is, but for its exposure. */
static int is_plain(const BhrFilm *film) {
    return film->tone_map == BHR_TONE_MAP_NONE && film->colour_map == BHR_COLOUR_MAP_NONE && film->bloom == 0.0 &&
           film->highlights == 0.0 && film->shadows == 0.0 && film->white_balance == 0.0 && film->tint == 0.0 &&
           film->contrast == 1.0 && film->saturation == 1.0;
}

/* Whether the colours of a context's disk are those of blackbodies as their light is shifted, and nothing else changes
 * them, as in BHR_PRESET_TEACHING. */
static int shows_temperatures(const BhrContext *context) {
    BhrView  view;
    BhrFilm  film;
    BhrDisk  disk;
    BhrSky   sky;
    uint32_t effects;
    int32_t  has_disk;
    double   doppler, gravity;
    BHR_INIT(film), BHR_INIT(disk), BHR_INIT(sky);
    if (bhr_get_view(context, &view) < 0 || bhr_get_film(context, &film) < 0 || bhr_get_sky(context, &sky) < 0 ||
        bhr_get_disk(context, &disk, &has_disk) < 0 || bhr_get_effects(context, &effects) < 0 ||
        bhr_get_effect_strength(context, BHR_EFFECT_DOPPLER_SHIFT, &doppler) < 0 ||
        bhr_get_effect_strength(context, BHR_EFFECT_GRAVITY_SHIFT, &gravity) < 0) {
        return 0;
    }
    const uint32_t shifts = BHR_EFFECT_DOPPLER_SHIFT | BHR_EFFECT_GRAVITY_SHIFT;
    return view == BHR_VIEW_LIGHT && is_plain(&film) && has_disk && (sky.flags & BHR_SKY_GRID) != 0 &&
           (effects & shifts) == shifts && (effects & BHR_EFFECT_BEAMING) == 0 && doppler == 1.0 && gravity == 1.0;
}

int colour_bar_of_temperatures(const BhrContext *context, ColourBar *bar) {
    static const double TEMPERATURES[] = {2000.0, 3000.0, 4500.0, 6500.0, 9000.0, 12000.0};
    if (!shows_temperatures(context)) {
        return 0;
    }
    *bar = (ColourBar){.title = "disk: temperature seen, g T, in kelvin", .colour = by_temperature};
    for (; bar->count < COUNT_OF(TEMPERATURES); bar->count++) {
        Mark *mark = &bar->marks[bar->count];
        mark->share = log(TEMPERATURES[bar->count] / COLDEST) / log(HOTTEST / COLDEST);
        snprintf(mark->text, sizeof mark->text, "%.0f", TEMPERATURES[bar->count]);
    }
    return 1;
}

int colour_bar_of(BhrView view, const BhrFilm *film, ColourBar *bar) {
    if (view == BHR_VIEW_LIGHT ? colour_bar_of_film(film, bar) : colour_bar_of_view(view, bar)) {
        return 1;
    }
    *bar = (ColourBar){.count = 0};
    return 0;
}

void colour_bar_mark(ColourBar *bar, double most) {
    const double power = pow(10.0, floor(log10(most))), leading = most / power;
    const double step = power * (leading < 1.5 ? 0.2 : leading < 3.0 ? 0.5 : leading < 6.0 ? 1.0 : 2.0);
    for (bar->count = 0; bar->count < MOST_MARKS && bar->count * step <= most * (1.0 + 1e-9); bar->count++) {
        bar->marks[bar->count].share = bar->count * step / most;
        snprintf(bar->marks[bar->count].text, sizeof bar->marks->text, "%g", bar->count * step);
    }
}

void colour_bar_at(const ColourBar *bar, double share, unsigned char rgb[3]) {
    if (bar->steps != 0) {
        const uint32_t field = (uint32_t)(share * bar->steps);
        share = bar->marks[field < bar->steps ? field : bar->steps - 1].share;
    }
    bar->colour(share, rgb);
}

double colour_bar_place(const ColourBar *bar, uint32_t mark) {
    return bar->steps != 0 ? (mark + 0.5) / bar->steps : bar->marks[mark].share;
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
        unsigned char rgb[3];
        colour_bar_at(bar, (x + 0.5) / width, rgb);
        fill(image, left + x, top, 1, height, rgb);
    }
}

static void draw_marks(BhrImage *image, const ColourBar *bar, uint32_t left, uint32_t top, uint32_t width,
                       uint32_t scale) {
    static const unsigned char WHITE[3] = {235, 235, 235};
    for (uint32_t i = 0; i < bar->count; i++) {
        const uint32_t x = left + (uint32_t)(colour_bar_place(bar, i) * (width - 1) + 0.5);
        if (bar->steps == 0) {
            fill(image, x, top, scale, TICK * scale, WHITE);
        }
        picture_write(image, x - text_width(bar->marks[i].text, scale) / 2 + scale, top + (TICK + GAP) * scale, scale,
                      bar->marks[i].text);
    }
}

void colour_bar_draw(BhrImage *image, const ColourBar *bar, uint32_t scale) {
    static const unsigned char GREY[3] = {COLOUR_BAR_GREY, COLOUR_BAR_GREY, COLOUR_BAR_GREY};
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
    *bar = (ColourBar){.count = 0};
    if (status >= 0) {
        colour_bar_of(view, &film, bar);
    }
    return status;
}

uint32_t colour_bar_scale(uint32_t width, uint32_t height) {
    /* Text looks alike on a page, whatever a picture's resolution. */
    const uint32_t by_width = width / LEAST_WIDTH, by_height = height / LEAST_HEIGHT;
    return ((by_width < by_height ? by_width : by_height) + 1) / 2;
}

uint32_t colour_bar_put(BhrImage *image, const ColourBar *bar) {
    const uint32_t scale = colour_bar_scale(image->width, image->height);
    if (scale == 0 || bar->count == 0) {
        return 0;
    }
    colour_bar_draw(image, bar, scale);
    return COLOUR_BAR_ROWS * scale;
}

BhrStatus colour_bar_add(const BhrContext *context, BhrImage *image) {
    ColourBar       bar;
    const BhrStatus status = colour_bar_of_frames(context, &bar);
    if (status >= 0 && bar.count == 0) {
        colour_bar_of_temperatures(context, &bar);
    }
    colour_bar_put(image, &bar);
    return status;
}
