/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* observatory_gold.c -- the tests of Gold et al. 2020 (ApJ 897, 148), in which codes of the Event Horizon Telescope
 * were compared: the flux of five media, found by the library and as published. Writes no file. */
#include "observatory.h"

#include <math.h>
#include <stdlib.h>

/* The paper's hole and medium, in cgs units as the codes have them (ipole's model "analytic"): G M / c^2, the distance,
 * and the emissivity where the density is 1, per G M / c^2. */
#define LENGTH_OF_M 6.0e11
#define DISTANCE 2.4e22
#define EMISSIVITY 1.8e-6
#define CGS_JANSKY 1e-23
/* 128 x 128 rays from -15 to 15 M, both included; each stands for an area of (30 M / 128)^2 all the same. */
#define SIDE 128u
#define HALF 15.0

typedef struct GoldTest {
    double spin, absorption, spectral_index, thickness, angular_momentum;
    double published; /* Jy, by the paper's code without shortcuts */
    double tolerance; /* half of the last printed digit */
} GoldTest;

/* In the first test light is from matter at rest down to the horizon, where it piles up as the square root of the way
 * that is left: where a code stops decides the fourth digit. */
static const GoldTest TESTS[] = {
    {0.9, 0.0, -3.0, 1e6, 0.0, 1.6465, 0.5e-4 + 2e-4 * 1.6465},
    {0.0, 0.0, -2.0, 1e6, 1.0, 1.4360, 0.5e-4},
    {0.9, 0.0, 0.0, 0.3, 1.0, 0.4418, 0.5e-4},
    {0.9, 0.18, 0.0, 0.3, 1.0, 0.2710, 0.5e-4},
    {0.9, 1.8, 0.0, 0.03, 1.0, 0.0255, 0.5e-4},
};

static BhrStatus set_scene(BhrContext *context, const GoldTest *test) {
    BhrVolume volume;
    BhrStatus status = bhr_volume_init(&volume, sizeof volume);
    if (status < 0) {
        return status;
    }
    volume.turbulence = 0.0;
    volume.flags = BHR_VOLUME_POWER_LAW;
    volume.shape = BHR_VOLUME_HALO;
    volume.flow = BHR_FLOW_ANGULAR_MOMENTUM;
    volume.radius = 10.0;
    volume.outer_radius = 150.0;
    volume.thickness = test->thickness;
    volume.absorption = test->absorption;
    volume.spectral_index = test->spectral_index;
    volume.angular_momentum = test->angular_momentum;
    status = bhr_set_spin(context, test->spin);
    return status < 0 ? status : bhr_set_volumes(context, &volume, sizeof volume, 1);
}

/* The flux in Jy; NaN after a message. */
static double find_flux(BhrContext *context, Settings *s, size_t number, double *intensity) {
    const BhrStatus status = set_scene(context, &TESTS[number]);
    if (status < 0) {
        report_failure("set the scene", status);
        return NAN;
    }
    const Grid   grid = {PI / 3.0, 0.0, FAR, HALF, SIDE, 0};
    const double share = 1.0 / COUNT_OF(TESTS);
    Transferred  out = {intensity, NULL, &s->progress, (double)number * share, share};
    if (grid_transfer(context, &grid, &out) != 0) {
        return NAN;
    }
    double sum = 0.0;
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        sum += intensity[i];
    }
    const double side = 2.0 * HALF / SIDE * LENGTH_OF_M / DISTANCE; /* of a pixel, radians */
    return EMISSIVITY * sum * side * side / CGS_JANSKY;
}

int observatory_gold(BhrContext *context, Settings *s) {
    double *intensity = allocate_doubles((size_t)SIDE * SIDE);
    if (intensity == NULL) {
        return EXIT_FAILURE;
    }
    printf("Gold et al. 2020 (ApJ 897, 148): fluxes at 230 GHz in Jy, %u x %u rays\n\n", SIDE, SIDE);
    printf("test   spin   l0   1/h  index  absorption   published      found  difference\n");
    int    result = EXIT_SUCCESS;
    double found = 0.0;
    for (size_t i = 0; i < COUNT_OF(TESTS) && !isnan(found); i++) {
        const GoldTest *test = &TESTS[i];
        found = find_flux(context, s, i, intensity);
        if (!isnan(found)) {
            const double difference = found - test->published;
            const int    holds = fabs(difference) <= test->tolerance;
            progress_clear(&s->progress);
            printf("%4u %6g %4g %5g %6g %11g %11.4f %10.6f %11.6f%s\n", (unsigned)(i + 1), test->spin,
                   test->angular_momentum, test->thickness < 1e6 ? test->thickness : INFINITY, test->spectral_index,
                   test->absorption, test->published, found, difference, holds ? "" : "  off");
            fflush(stdout);
            result = holds ? result : EXIT_FAILURE;
        }
    }
    free(intensity);
    return isnan(found) ? EXIT_FAILURE : result;
}
