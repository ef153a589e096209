/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* plot.c -- see plot.h. */
#include "plot.h"

#include "common.h"

#include <math.h>
#include <string.h>

#define TICKS 5.0 /* about as many numbers along an axis */
#define TICK_LENGTH 5.0

static const Colour GREY = {150, 150, 150};

/* ---- strokes ---- */

static void blend(BhrImage *image, long x, long y, double cover, Colour colour) {
    if (x < 0 || y < 0 || x >= (long)image->width || y >= (long)image->height || cover <= 0.0) {
        return;
    }
    unsigned char      *pixel = (unsigned char *)image->pixels + 4 * ((size_t)y * image->width + (size_t)x);
    const unsigned char to[3] = {colour.r, colour.g, colour.b};
    for (int i = 0; i < 3; i++) {
        pixel[i] = (unsigned char)(pixel[i] + fmin(cover, 1.0) * (to[i] - pixel[i]) + 0.5);
    }
}

void draw_line(BhrImage *image, double x0, double y0, double x1, double y1, double thickness, Colour colour) {
    if (!isfinite(x0 + y0 + x1 + y1)) {
        return;
    }
    const double reach = 0.5 * thickness + 1.0;
    const double dx = x1 - x0, dy = y1 - y0, square = dx * dx + dy * dy;
    const long   left = (long)fmax(0.0, floor(fmin(x0, x1) - reach));
    const long   top = (long)fmax(0.0, floor(fmin(y0, y1) - reach));
    const long   right = (long)fmin((double)image->width, ceil(fmax(x0, x1) + reach));
    const long   bottom = (long)fmin((double)image->height, ceil(fmax(y0, y1) + reach));
    for (long y = top; y < bottom; y++) {
        for (long x = left; x < right; x++) {
            const double px = (double)x + 0.5 - x0, py = (double)y + 0.5 - y0;
            const double along = square > 0.0 ? fmin(fmax((px * dx + py * dy) / square, 0.0), 1.0) : 0.0;
            blend(image, x, y, 0.5 * thickness + 0.5 - hypot(px - along * dx, py - along * dy), colour);
        }
    }
}

/* ---- axes ---- */

static double place_x(const Plot *plot, double x) {
    return plot->left + plot->width * (x - plot->x_low) / (plot->x_high - plot->x_low);
}

static double place_y(const Plot *plot, double y) {
    return plot->top + plot->height * (1.0 - (y - plot->y_low) / (plot->y_high - plot->y_low));
}

/* The power of ten, or 2 or 5 times one, that makes about five steps of a range. */
static double nice_step(double low, double high) {
    const double least = fabs(high - low) / TICKS, power = pow(10.0, floor(log10(least)));
    const double factor = least / power;
    return power * (factor <= 1.0 ? 1.0 : factor <= 2.0 ? 2.0 : factor <= 5.0 ? 5.0 : 10.0);
}

static void write_at(BhrImage *image, double x, double y, const char *text) {
    if (x >= 0.0 && y >= 0.0) {
        picture_write(image, (uint32_t)x, (uint32_t)y, 1, text);
    }
}

/* The numbers of one axis. */
static void mark(const Plot *plot, double low, double high, int is_x) {
    const double step = nice_step(low, high), least = fmin(low, high), most = fmax(low, high);
    for (double n = ceil(least / step - 1e-9); n * step <= most + 1e-9 * step; n++) {
        char         text[32];
        const double value = n == 0.0 ? 0.0 : n * step; /* no -0 */
        snprintf(text, sizeof text, "%.6g", value);
        const double wide = (double)(strlen(text) * CELL_WIDTH);
        if (is_x) {
            const double x = place_x(plot, value), y = plot->top + plot->height;
            draw_line(plot->image, x, y, x, y + TICK_LENGTH, 1.0, GREY);
            write_at(plot->image, x - 0.5 * wide + 0.5, y + TICK_LENGTH + 4.0, text);
        } else {
            const double y = place_y(plot, value);
            draw_line(plot->image, plot->left - TICK_LENGTH, y, plot->left, y, 1.0, GREY);
            write_at(plot->image, plot->left - TICK_LENGTH - 3.0 - wide, y - 3.5, text);
        }
    }
}

void plot_axes(const Plot *plot, const char *x_name, const char *y_name) {
    const double right = plot->left + plot->width, bottom = plot->top + plot->height;
    draw_line(plot->image, plot->left, plot->top, right, plot->top, 1.0, GREY);
    draw_line(plot->image, plot->left, bottom, right, bottom, 1.0, GREY);
    draw_line(plot->image, plot->left, plot->top, plot->left, bottom, 1.0, GREY);
    draw_line(plot->image, right, plot->top, right, bottom, 1.0, GREY);
    mark(plot, plot->x_low, plot->x_high, 1);
    mark(plot, plot->y_low, plot->y_high, 0);
    const double wide = (double)(strlen(x_name) * CELL_WIDTH);
    write_at(plot->image, plot->left + 0.5 * (plot->width - wide), bottom + TICK_LENGTH + 21.0, x_name);
    write_at(plot->image, plot->left, plot->top - 18.0, y_name);
}

/* ---- curves ---- */

void plot_curve(const Plot *plot, const double *x, const double *y, size_t count, double thickness, Colour colour) {
    for (size_t i = 1; i < count; i++) {
        draw_line(plot->image, place_x(plot, x[i - 1]), place_y(plot, y[i - 1]), place_x(plot, x[i]),
                  place_y(plot, y[i]), thickness, colour);
    }
}

void plot_dot(const Plot *plot, double x, double y, double radius, Colour colour) {
    const double at_x = place_x(plot, x), at_y = place_y(plot, y);
    draw_line(plot->image, at_x, at_y, at_x, at_y, 2.0 * radius, colour);
}
