/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* plot.h -- lines and axes with numbers on 8-bit pictures. Knows no hole and no context. */
#ifndef EXAMPLES_PLOT_H
#define EXAMPLES_PLOT_H

#include "picture.h"

typedef struct Colour {
    unsigned char r, g, b;
} Colour;

/* A rectangle of the picture in which the values low .. high lie, x to the right and y upwards. low > high turns an
 * axis round. */
typedef struct Plot {
    BhrImage *image;
    double    left, top, width, height; /* pixels */
    double    x_low, x_high, y_low, y_high;
} Plot;

/* A line in pixels, `thickness` wide, with smooth edges. */
void draw_line(BhrImage *image, double x0, double y0, double x1, double y1, double thickness, Colour colour);

/* The frame, about five numbers along each side, and what they are: the names below and above on the left. Writes
 * outside the rectangle: 60 pixels to its left, 40 below and 22 above. */
void plot_axes(const Plot *plot, const char *x_name, const char *y_name);

/* Straight pieces between points in the plot's values; and a dot on one of them. */
void plot_curve(const Plot *plot, const double *x, const double *y, size_t count, double thickness, Colour colour);
void plot_dot(const Plot *plot, double x, double y, double radius, Colour colour);

#endif
