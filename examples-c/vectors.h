/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* vectors.h -- arithmetic of three components, for the example programs' cameras. Needs libc only. */
#ifndef EXAMPLES_VECTORS_H
#define EXAMPLES_VECTORS_H

#include <math.h>
#include <string.h>

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void cross(const double a[3], const double b[3], double out[3]) {
    const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    memcpy(out, c, sizeof c);
}

/* a += s b */
static inline void add(double a[3], double s, const double b[3]) {
    for (int i = 0; i < 3; i++) {
        a[i] += s * b[i];
    }
}

static inline void scale(double a[3], double s) {
    for (int i = 0; i < 3; i++) {
        a[i] *= s;
    }
}

static inline double length(const double a[3]) { return sqrt(dot(a, a)); }

/* Turns v by an angle about a unit axis (Rodrigues 1840). */
static inline void rotate(double v[3], const double axis[3], double angle) {
    double side[3], along = dot(axis, v) * (1.0 - cos(angle));
    cross(axis, v, side);
    scale(v, cos(angle));
    add(v, sin(angle), side);
    add(v, along, axis);
}

#endif
