/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* telescope.h -- an observer far from a hole: which hole, how large it is on the sky, and the matter along a square
 * grid of rays. Writes no file and no picture. */
#ifndef EXAMPLES_TELESCOPE_H
#define EXAMPLES_TELESCOPE_H

#include "common.h"

#include <bhr.h>

#define SPEED_OF_LIGHT 299792458.0     /* m / s, exact in the SI */
#define BOLTZMANN 1.380649e-23         /* J / K, exact in the SI (CODATA 2018) */
#define SOLAR_GM 1.3271244e20          /* m^3 / s^2: IAU 2015, Resolution B3 */
#define PARSEC 3.0856775814913673e16   /* m: 648000 / pi au (IAU 2015, B2) of 149597870700 m (IAU 2012, B2) */
#define JANSKY 1e-26                   /* W / m^2 / Hz */
#define MICROARCSECOND (PI / 648000e6) /* radians */

/* A hole in the sky. */
typedef struct Target {
    const char *name;           /* of files */
    const char *object;         /* as catalogues write it */
    double      mass;           /* in those of the Sun */
    double      distance;       /* kpc */
    double      right_ascension, declination; /* degrees, ICRS */
    double      inclination;    /* degrees between the spin and the way to us: above 90 the spin points away */
    double      position_angle; /* degrees of the projected spin, from north over east */
    double      flux;           /* Jy at 230 GHz */
    const char *date;           /* a day of the Event Horizon Telescope on which it was seen so, and that day in MJD */
    double      day;
} Target;

extern const Choice TARGETS[]; /* indices of TARGET_LIST */
extern const Target TARGET_LIST[];

/* G M / c^2 in metres; as an angle on the sky, radians; as a time, seconds. */
double metres_of(const Target *target);
double angle_of(const Target *target);
double seconds_of(const Target *target);

#define FAR 1e6 /* M: from there light bends by 1e-6 of what it does beside the hole, and rays are parallel */

/* Rays from an observer through a square grid in the plane of the hole that faces the observer, as if they were
 * straight: row by row from the top, the first point of a row on the left. Lengths in M. */
typedef struct Grid {
    double   inclination, position_angle; /* radians */
    double   distance;                    /* from the hole, where the observer is at rest */
    double   half;                        /* of the first and the last point from the middle */
    uint32_t side;                        /* points in a row, and rows; 2 or more */
    int      refines;                     /* points are centres of pixels: those beside the shadow's edge, where images
                                           * of order 1 and more lie, become the mean of many rays */
} Grid;

/* The grid of the centres of side x side pixels that fill a square of this width. */
Grid grid_of_pixels(double inclination, double position_angle, double distance, double width, uint32_t side,
                    int refines);

/* The light's way from r = 0 to an observer, in M: flat, and Shapiro's delay beyond r = 2. A scene whose time is later
 * by this shows what happens at the hole at the time itself. */
double travel_time(double distance);

/* The numbers that grid_transfer finds, and the part of the work that the progress counts for it: `share`, from `done`
 * on. */
typedef struct Transferred {
    double   *intensity; /* of each point, as in BhrTransfer */
    double   *depth;     /* of the ray through each point, NaN where it is captured; NULL: not asked for */
    Progress *progress;
    double    done, share;
} Transferred;

/* The matter of the context's scene along the rays. 0, or an exit status after a message. */
int grid_transfer(BhrContext *context, const Grid *grid, Transferred *out);

#endif
