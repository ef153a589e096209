/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* telescope.c -- see telescope.h. */
#include "telescope.h"

#include <math.h>
#include <stdlib.h>

#define CHUNK 2048u  /* rays that are traced at a time: 200 kB on the stack */

const Choice TARGETS[] = {{"sgra", 0}, {"m87", 1}, {NULL, 0}};

/* Sgr A*: mass and distance of the GRAVITY Collaboration 2022 (A&A 657, L12), place of Reid and Brunthaler 2004 (ApJ
 * 616, 872), inclination of the models that the Event Horizon Telescope favours, and the flux that its models have (2022,
 * ApJL 930, L16); where its spin points is not known. M87*: mass, distance and inclination of the EHT 2019 (ApJL 875, L1
 * and L5), place of Lambert and Gontier 2009 (A&A 493, 317); the jet that comes towards us lies at the position angle of
 * 288 degrees and the spin points away from us, opposite to it; the flux of the compact part that L5 gives the models. */
const Target TARGET_LIST[] = {
    {"sgra", "Sgr A*", 4.297e6, 8.277, 266.4168167, -29.0078250, 30.0, 0.0, 2.4},
    {"m87", "M87*", 6.5e9, 16800.0, 187.7059308, 12.3911233, 163.0, 108.0, 0.5},
};

double metres_of(const Target *target) {
    return target->mass * SOLAR_GM / (SPEED_OF_LIGHT * SPEED_OF_LIGHT);
}

double angle_of(const Target *target) {
    return metres_of(target) / (target->distance * 1e3 * PARSEC);
}

double seconds_of(const Target *target) {
    return metres_of(target) / SPEED_OF_LIGHT;
}

Grid grid_of_pixels(double inclination, double position_angle, double distance, double width, uint32_t side) {
    const Grid grid = {inclination, position_angle, distance, 0.5 * width * (side - 1.0) / side, side};
    return grid;
}

double travel_time(double distance) {
    return distance + 2.0 * log(0.5 * distance);
}

/* The ray through the point `column`, `row`. The observer is at azimuth 0: outwards = (sin i, 0, cos i), the spin's
 * projection up = (-cos i, 0, sin i), and y is to the right of it. */
static BhrRay ray_at(const Grid *grid, uint32_t column, uint32_t row) {
    const double s = sin(grid->inclination), c = cos(grid->inclination), far = grid->distance;
    const double right = grid->half * (2.0 * column / (grid->side - 1.0) - 1.0);
    const double north = grid->half * (1.0 - 2.0 * row / (grid->side - 1.0));
    /* East is to the left: the spin is turned to it by the position angle. */
    const double turn_c = cos(grid->position_angle), turn_s = sin(grid->position_angle);
    const double x = right * turn_c + north * turn_s, y = north * turn_c - right * turn_s;
    /* A frequency at rest there is higher than at infinity, where it is meant. */
    const BhrRay ray = {{s * far, 0.0, c * far}, {-s * far - c * y, x, -c * far + s * y}, sqrt(1.0 - 2.0 / far)};
    return ray;
}

static int is_traced(const BhrTransfer *found) {
    return (found->fate == BHR_FATE_CAPTURED || found->fate == BHR_FATE_ESCAPED) && isfinite(found->intensity);
}

int grid_transfer(BhrContext *context, const Grid *grid, double *out_intensity, double *out_depth, Progress *progress,
                  double done, double share) {
    BhrRay      rays[CHUNK];
    BhrTransfer found[COUNT_OF(rays)];
    const size_t count = (size_t)grid->side * grid->side;
    for (size_t begin = 0; begin < count; begin += COUNT_OF(rays)) {
        const size_t length = count - begin < COUNT_OF(rays) ? count - begin : COUNT_OF(rays);
        for (size_t i = 0; i < length; i++) {
            rays[i] = ray_at(grid, (uint32_t)((begin + i) % grid->side), (uint32_t)((begin + i) / grid->side));
        }
        const BhrStatus status = bhr_transfer_rays(context, rays, sizeof *rays, length, found, sizeof *found);
        if (status < 0) {
            progress_clear(progress);
            return report_failure("trace the rays", status);
        }
        for (size_t i = 0; i < length; i++) {
            if (!is_traced(&found[i])) {
                progress_clear(progress);
                fprintf(stderr, "cannot trace the ray of row %u, column %u to its end\n",
                        (unsigned)((begin + i) / grid->side), (unsigned)((begin + i) % grid->side));
                return EXIT_FAILURE;
            }
            out_intensity[begin + i] = found[i].intensity;
            if (out_depth != NULL) {
                out_depth[begin + i] = found[i].optical_depth;
            }
        }
        progress_draw(progress, done + share * (double)(begin + length) / (double)count);
    }
    return 0;
}
