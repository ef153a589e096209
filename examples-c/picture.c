/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* picture.c -- see picture.h. */
#include "picture.h"

#include "common.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CHANNELS 4u
#define COLOURS 3u /* the fourth channel is alpha, which is no light */
#define OPAQUE 255

/* ---- memory ---- */

static uint32_t bytes_per_pixel(BhrFormat format) {
    switch (format) {
    case BHR_FORMAT_RGBA16F: return 8;
    case BHR_FORMAT_RGBA32F: return 16;
    default: return 4;
    }
}

int picture_allocate(BhrImage *image, BhrFormat format, uint32_t width, uint32_t height) {
    BhrStatus status = bhr_image_init(image, sizeof *image);
    if (status < 0) {
        report_failure("prepare a picture", status);
        return 0;
    }
    /* Two 32-bit numbers multiply without overflow in 64 bits; the bytes per pixel may not fit any more. */
    uint64_t pixels = (uint64_t)width * height;
    if (pixels != 0 && pixels <= SIZE_MAX / bytes_per_pixel(format)) {
        image->pixels = calloc((size_t)pixels, bytes_per_pixel(format));
    }
    if (image->pixels == NULL) {
        fprintf(stderr, "cannot hold a picture of %u x %u pixels\n", (unsigned)width, (unsigned)height);
        return 0;
    }
    image->format = format;
    image->width = width;
    image->height = height;
    image->byte_size = pixels * bytes_per_pixel(format);
    return 1;
}

static unsigned char *pixel(const BhrImage *image, uint32_t x, uint32_t y) {
    return (unsigned char *)image->pixels + CHANNELS * ((size_t)y * image->width + x);
}

void picture_fill(BhrImage *image, unsigned char grey) {
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++) {
            memset(pixel(image, x, y), grey, COLOURS);
            pixel(image, x, y)[COLOURS] = OPAQUE;
        }
    }
}

/* ---- scaling ---- */

/* IEC 61966-2-1: light of an 8-bit value, and back. */
static double light_of(unsigned char value) {
    double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static unsigned char value_of(double light) {
    double v = light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
    return (unsigned char)(255.0 * v + 0.5);
}

/* A stretch of source pixels along one axis, from `begin` to `end`, in pixels. */
typedef struct Stretch {
    double begin, end;
} Stretch;

static Stretch stretch_of(uint32_t i, uint32_t count, uint32_t source) {
    return (Stretch){(double)i * source / count, (double)(i + 1) * source / count};
}

static double share(Stretch stretch, uint32_t i) {
    return fmin(stretch.end, i + 1.0) - fmax(stretch.begin, i);
}

static void mean_light(const BhrImage *from, const double light[256], Stretch across, Stretch down,
                       unsigned char out[CHANNELS]) {
    double sum[COLOURS] = {0.0, 0.0, 0.0};
    for (uint32_t y = (uint32_t)down.begin; y < from->height && y < down.end; y++) {
        for (uint32_t x = (uint32_t)across.begin; x < from->width && x < across.end; x++) {
            double               weight = share(across, x) * share(down, y);
            const unsigned char *source = pixel(from, x, y);
            for (uint32_t i = 0; i < COLOURS; i++) {
                sum[i] += weight * light[source[i]];
            }
        }
    }
    double area = (across.end - across.begin) * (down.end - down.begin);
    for (uint32_t i = 0; i < COLOURS; i++) {
        out[i] = value_of(fmin(sum[i] / area, 1.0));
    }
    out[COLOURS] = OPAQUE;
}

void picture_scale(const BhrImage *from, BhrImage *to, uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    double light[256];
    for (int i = 0; i < 256; i++) {
        light[i] = light_of((unsigned char)i);
    }
    for (uint32_t row = 0; row < height; row++) {
        Stretch down = stretch_of(row, height, from->height);
        for (uint32_t column = 0; column < width; column++) {
            mean_light(from, light, stretch_of(column, width, from->width), down, pixel(to, x + column, y + row));
        }
    }
}

/* ---- text ---- */

/* Nine rows from the top, the last two below the base line; bit 4 is the left column, bit 0 the right one. */
typedef struct Glyph {
    char          character;
    unsigned char rows[9];
} Glyph;

#define GLYPH_WIDTH 5

static const Glyph GLYPHS[] = {
    {' ', {0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00}},
    {'%', {0x18, 0x19, 0x02, 0x04, 0x08, 0x13, 0x03, 0x00, 0x00}},
    {'(', {0x02, 0x04, 0x08, 0x08, 0x08, 0x04, 0x02, 0x00, 0x00}},
    {')', {0x08, 0x04, 0x02, 0x02, 0x02, 0x04, 0x08, 0x00, 0x00}},
    {'*', {0x00, 0x0a, 0x04, 0x1f, 0x04, 0x0a, 0x00, 0x00, 0x00}},
    {'+', {0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00, 0x00, 0x00}},
    {',', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c, 0x04, 0x08}},
    {'-', {0x00, 0x00, 0x00, 0x0e, 0x00, 0x00, 0x00, 0x00, 0x00}},
    {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c, 0x00, 0x00}},
    {'/', {0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10, 0x00, 0x00}},
    {'0', {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e, 0x00, 0x00}},
    {'1', {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e, 0x00, 0x00}},
    {'2', {0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f, 0x00, 0x00}},
    {'3', {0x0e, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0e, 0x00, 0x00}},
    {'4', {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02, 0x00, 0x00}},
    {'5', {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e, 0x00, 0x00}},
    {'6', {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e, 0x00, 0x00}},
    {'7', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08, 0x00, 0x00}},
    {'8', {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e, 0x00, 0x00}},
    {'9', {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c, 0x00, 0x00}},
    {':', {0x00, 0x0c, 0x0c, 0x00, 0x0c, 0x0c, 0x00, 0x00, 0x00}},
    {'=', {0x00, 0x00, 0x1f, 0x00, 0x1f, 0x00, 0x00, 0x00, 0x00}},
    {'A', {0x0e, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11, 0x00, 0x00}},
    {'G', {0x0e, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0f, 0x00, 0x00}},
    {'H', {0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11, 0x00, 0x00}},
    {'J', {0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0c, 0x00, 0x00}},
    {'K', {0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11, 0x00, 0x00}},
    {'M', {0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11, 0x00, 0x00}},
    {'S', {0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e, 0x00, 0x00}},
    {'_', {0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1f, 0x00}},
    {'a', {0x00, 0x00, 0x0e, 0x01, 0x0f, 0x11, 0x0f, 0x00, 0x00}},
    {'b', {0x10, 0x10, 0x1e, 0x11, 0x11, 0x11, 0x1e, 0x00, 0x00}},
    {'c', {0x00, 0x00, 0x0e, 0x11, 0x10, 0x11, 0x0e, 0x00, 0x00}},
    {'d', {0x01, 0x01, 0x0f, 0x11, 0x11, 0x11, 0x0f, 0x00, 0x00}},
    {'e', {0x00, 0x00, 0x0e, 0x11, 0x1f, 0x10, 0x0e, 0x00, 0x00}},
    {'f', {0x06, 0x08, 0x1e, 0x08, 0x08, 0x08, 0x08, 0x00, 0x00}},
    {'g', {0x00, 0x00, 0x0f, 0x11, 0x11, 0x11, 0x0f, 0x01, 0x0e}},
    {'h', {0x10, 0x10, 0x1e, 0x11, 0x11, 0x11, 0x11, 0x00, 0x00}},
    {'i', {0x04, 0x00, 0x0c, 0x04, 0x04, 0x04, 0x0e, 0x00, 0x00}},
    {'j', {0x02, 0x00, 0x06, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0c}},
    {'k', {0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12, 0x00, 0x00}},
    {'l', {0x0c, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e, 0x00, 0x00}},
    {'m', {0x00, 0x00, 0x1a, 0x15, 0x15, 0x15, 0x15, 0x00, 0x00}},
    {'n', {0x00, 0x00, 0x1e, 0x11, 0x11, 0x11, 0x11, 0x00, 0x00}},
    {'o', {0x00, 0x00, 0x0e, 0x11, 0x11, 0x11, 0x0e, 0x00, 0x00}},
    {'p', {0x00, 0x00, 0x1e, 0x11, 0x11, 0x11, 0x1e, 0x10, 0x10}},
    {'q', {0x00, 0x00, 0x0f, 0x11, 0x11, 0x11, 0x0f, 0x01, 0x01}},
    {'r', {0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10, 0x00, 0x00}},
    {'s', {0x00, 0x00, 0x0f, 0x10, 0x0e, 0x01, 0x1e, 0x00, 0x00}},
    {'t', {0x08, 0x08, 0x1e, 0x08, 0x08, 0x09, 0x06, 0x00, 0x00}},
    {'u', {0x00, 0x00, 0x11, 0x11, 0x11, 0x11, 0x0f, 0x00, 0x00}},
    {'v', {0x00, 0x00, 0x11, 0x11, 0x11, 0x0a, 0x04, 0x00, 0x00}},
    {'w', {0x00, 0x00, 0x11, 0x15, 0x15, 0x15, 0x0a, 0x00, 0x00}},
    {'x', {0x00, 0x00, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x00, 0x00}},
    {'y', {0x00, 0x00, 0x11, 0x11, 0x11, 0x11, 0x0f, 0x01, 0x0e}},
    {'z', {0x00, 0x00, 0x1f, 0x02, 0x04, 0x08, 0x1f, 0x00, 0x00}},
};

static const Glyph *find_glyph(char character) {
    for (size_t i = 0; i < COUNT_OF(GLYPHS); i++) {
        if (GLYPHS[i].character == character) {
            return &GLYPHS[i];
        }
    }
    return NULL;
}

static int is_inked(const Glyph *glyph, int column, int row) {
    return column >= 0 && column < GLYPH_WIDTH && row >= 0 && row < (int)COUNT_OF(glyph->rows) &&
           (glyph->rows[row] >> (GLYPH_WIDTH - 1 - column) & 1);
}

static int is_beside_ink(const Glyph *glyph, int column, int row) {
    for (int i = 0; i < 9; i++) {
        if (is_inked(glyph, column + i % 3 - 1, row + i / 3 - 1)) {
            return 1;
        }
    }
    return 0;
}

/* One dot of the font: a square of scale x scale pixels. */
static void fill_dot(BhrImage *image, int64_t x, int64_t y, uint32_t scale, unsigned char value) {
    for (int64_t row = y; row < y + scale; row++) {
        for (int64_t column = x; column < x + scale; column++) {
            if (row >= 0 && row < image->height && column >= 0 && column < image->width) {
                memset(pixel(image, (uint32_t)column, (uint32_t)row), value, COLOURS);
            }
        }
    }
}

static void write_glyph(BhrImage *image, int64_t x, int64_t y, uint32_t scale, const Glyph *glyph) {
    for (int row = -1; row <= (int)COUNT_OF(glyph->rows); row++) {
        for (int column = -1; column <= GLYPH_WIDTH; column++) {
            int inked = is_inked(glyph, column, row);
            if (inked || is_beside_ink(glyph, column, row)) {
                fill_dot(image, x + column * (int64_t)scale, y + row * (int64_t)scale, scale, inked ? 235 : 16);
            }
        }
    }
}

void picture_write(BhrImage *image, uint32_t x, uint32_t y, uint32_t scale, const char *text) {
    for (size_t i = 0; text[i] != '\0'; i++) {
        const Glyph *glyph = find_glyph(text[i]);
        if (glyph != NULL) {
            write_glyph(image, x + (int64_t)(i * CELL_WIDTH * scale), y, scale, glyph);
        }
    }
}

/* ---- files ---- */

int picture_save_into(const BhrImage *image, const char *folder, const char *name) {
    size_t size = strlen(folder) + strlen(name) + 2;
    char  *path = malloc(size);
    if (path == NULL) {
        fprintf(stderr, "cannot save a picture: no memory for its name\n");
        return 0;
    }
    snprintf(path, size, "%s/%s", folder, name);
    BhrStatus status = bhr_image_save(image, path);
    free(path);
    if (status < 0) {
        report_failure("save a picture", status);
    }
    return status >= 0;
}
