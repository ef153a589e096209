/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* telescope.c -- see telescope.h. */
#include "telescope.h"

#include <math.h>
#include <stdlib.h>

#define CHUNK 2048u /* rays that are traced at a time: 200 kB on the stack */
/* Where a grid is refined: pixels within RING (in M) outside the shadow's edge, in parts that are at most FINE wide.
 * The second image of a spot is a tenth of M across there. */
#define RING 0.5
#define FINE 0.05
#define MOST_PARTS 16u

const Choice TARGETS[] = {{"sgra", 0}, {"m87", 1}, {NULL, 0}};

/* Sgr A*: mass and distance of the GRAVITY Collaboration 2022 (A&A 657, L12), place of Reid and Brunthaler 2004 (ApJ
 * 616, 872), inclination of the models that the Event Horizon Telescope favours, and the flux that its models have
 * (2022, ApJL 930, L16); where its spin points is not known. M87*: mass, distance and inclination of the EHT 2019 (ApJL
 * 875, L1 and L5), place of Lambert and Gontier 2009 (A&A 493, 317); the jet that comes towards us lies at the position
 * angle of 288 degrees and the spin points away from us, opposite to it; the flux of the compact part that L5 gives the
 * models. The days are those of the pictures in the first papers of both series (ApJL 930, L12, and 875, L1). */
const Target TARGET_LIST[] = {
    {"sgra", "Sgr A*", 4.297e6, 8.277, 266.4168167, -29.0078250, 30.0, 0.0, 2.4, "2017-04-07", 57850.0},
    {"m87", "M87*", 6.5e9, 16800.0, 187.7059308, 12.3911233, 163.0, 108.0, 0.5, "2017-04-11", 57854.0},
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

Grid grid_of_pixels(double inclination, double position_angle, double distance, double width, uint32_t side,
                    int refines) {
    const Grid grid = {inclination, position_angle, distance, 0.5 * width * (side - 1.0) / side, side, refines};
    return grid;
}

double travel_time(double distance) {
    return distance + 2.0 * log(0.5 * distance);
}

/* The ray through the point `column`, `row`, which may lie between points of the grid. The observer is at azimuth 0:
 * outwards = (sin i, 0, cos i), the spin's projection up = (-cos i, 0, sin i), and y is to the right of it. */
static BhrRay ray_at(const Grid *grid, double column, double row) {
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

/* ---- a ray for each point ---- */

static int is_traced(const BhrTransfer *found) {
    return (found->fate == BHR_FATE_CAPTURED || found->fate == BHR_FATE_ESCAPED) && isfinite(found->intensity);
}

/* Traces up to CHUNK rays. 0, or an exit status after a message. */
static int trace(BhrContext *context, const BhrRay *rays, size_t count, BhrTransfer *out, Progress *progress) {
    const BhrStatus status = bhr_transfer_rays(context, rays, sizeof *rays, count, out, sizeof *out);
    int             result = 0;
    if (status < 0) {
        progress_clear(progress);
        return report_failure("trace the rays", status);
    }
    for (size_t i = 0; result == 0 && i < count; i++) {
        if (!is_traced(&out[i])) {
            progress_clear(progress);
            fprintf(stderr, "cannot trace a ray to its end: it began towards (%g, %g, %g)\n", rays[i].direction[0],
                    rays[i].direction[1], rays[i].direction[2]);
            result = EXIT_FAILURE;
        }
    }
    return result;
}

/* `captured`: 1 for each ray that ends in the hole. */
static int trace_points(BhrContext *context, const Grid *grid, Transferred *out, unsigned char *captured) {
    BhrRay       rays[CHUNK];
    BhrTransfer  found[CHUNK];
    const size_t count = (size_t)grid->side * grid->side;
    for (size_t begin = 0; begin < count; begin += CHUNK) {
        const size_t length = count - begin < CHUNK ? count - begin : CHUNK;
        for (size_t i = 0; i < length; i++) {
            rays[i] = ray_at(grid, (double)((begin + i) % grid->side), (double)((begin + i) / grid->side));
        }
        const int result = trace(context, rays, length, found, out->progress);
        if (result != 0) {
            return result;
        }
        for (size_t i = 0; i < length; i++) {
            out->intensity[begin + i] = found[i].intensity;
            captured[begin + i] = found[i].fate == BHR_FATE_CAPTURED;
            if (out->depth != NULL) {
                out->depth[begin + i] = found[i].optical_depth;
            }
        }
        const double all = grid->refines ? 0.4 : 1.0; /* of the work, about */
        progress_draw(out->progress, out->done + out->share * all * (double)(begin + length) / (double)count);
    }
    return 0;
}

/* ---- more rays beside the shadow's edge ---- */

/* Marks, along a row or column of `side` points `stride` apart, those within `reach` of a marked one. */
static void widen(const unsigned char *from, unsigned char *to, size_t stride, uint32_t side, uint32_t reach) {
    uint32_t near = UINT32_MAX; /* steps since the last marked one */
    for (uint32_t i = 0; i < side; i++) {
        near = from[stride * i] ? 0 : near == UINT32_MAX ? near : near + 1;
        to[stride * i] = near <= reach;
    }
    near = UINT32_MAX;
    for (uint32_t i = side; i-- > 0;) {
        near = from[stride * i] ? 0 : near == UINT32_MAX ? near : near + 1;
        to[stride * i] |= near <= reach;
    }
}

/* Marks a square about each marked point. `room` and `to` have room for all points. */
static void widen_all(const unsigned char *from, unsigned char *room, unsigned char *to, uint32_t side,
                      uint32_t reach) {
    for (uint32_t i = 0; i < side; i++) {
        widen(from + (size_t)i * side, room + (size_t)i * side, 1, side, reach);
    }
    for (uint32_t i = 0; i < side; i++) {
        widen(room + i, to + i, side, side, reach);
    }
}

/* Pixels that wait for their rays, as many as fit into a chunk. */
typedef struct Batch {
    BhrRay      rays[CHUNK];
    BhrTransfer found[CHUNK];
    size_t      pixels[CHUNK]; /* their indices */
    size_t      count;
} Batch;

/* Adds `parts` x `parts` rays that are spread evenly over a pixel. */
static void add_pixel(Batch *batch, const Grid *grid, size_t pixel, uint32_t parts) {
    const double left = (double)(pixel % grid->side) - 0.5, top = (double)(pixel / grid->side) - 0.5;
    BhrRay      *rays = batch->rays + batch->count * parts * parts;
    for (uint32_t i = 0; i < parts * parts; i++) {
        rays[i] = ray_at(grid, left + (i % parts + 0.5) / parts, top + (i / parts + 0.5) / parts);
    }
    batch->pixels[batch->count++] = pixel;
}

/* Gives each pixel of the batch the mean of its rays, and empties it. */
static int trace_batch(BhrContext *context, Batch *batch, uint32_t parts, Transferred *out) {
    const size_t rays = (size_t)parts * parts;
    const int    result = trace(context, batch->rays, batch->count * rays, batch->found, out->progress);
    for (size_t k = 0; result == 0 && k < batch->count; k++) {
        double sum = 0.0;
        for (size_t i = 0; i < rays; i++) {
            sum += batch->found[k * rays + i].intensity;
        }
        out->intensity[batch->pixels[k]] = sum / (double)rays;
    }
    batch->count = 0;
    return result;
}

/* Outside the edge, in a ring that is thinner than pixels often are, lie all images but the first. */
static int refine(BhrContext *context, const Grid *grid, Transferred *out, const unsigned char *captured,
                  unsigned char *room) {
    const uint32_t side = grid->side;
    const size_t   count = (size_t)side * side;
    const double   pixel = 2.0 * grid->half / (side - 1.0);
    const uint32_t parts = (uint32_t)fmin(ceil(pixel / FINE), MOST_PARTS);
    const uint32_t reach = (uint32_t)fmin(ceil(RING / pixel), side);
    unsigned char *near_hole = room, *escaped = room + count, *near_sky = room + 2 * count, *between = room + 3 * count;
    widen_all(captured, between, near_hole, side, reach);
    for (size_t i = 0; i < count; i++) {
        escaped[i] = !captured[i];
    }
    widen_all(escaped, between, near_sky, side, 1);
    size_t todo = 0, ready = 0;
    for (size_t i = 0; i < count; i++) {
        todo += near_hole[i] && near_sky[i];
    }
    Batch *batch = parts > 1 && todo > 0 ? malloc(sizeof *batch) : NULL;
    if (batch == NULL) {
        if (parts > 1 && todo > 0) {
            fprintf(stderr, "cannot hold %u rays\n", CHUNK);
            return EXIT_FAILURE;
        }
        return 0;
    }
    batch->count = 0;
    int result = 0;
    for (size_t i = 0; result == 0 && ready < todo && i < count; i++) {
        if (near_hole[i] && near_sky[i]) {
            add_pixel(batch, grid, i, parts);
            ready++;
            if (ready == todo || (batch->count + 1) * parts * parts > CHUNK) {
                result = trace_batch(context, batch, parts, out);
                progress_draw(out->progress, out->done + out->share * (0.4 + 0.6 * (double)ready / (double)todo));
            }
        }
    }
    free(batch);
    return result;
}

int grid_transfer(BhrContext *context, const Grid *grid, Transferred *out) {
    const size_t   count = (size_t)grid->side * grid->side;
    unsigned char *room = malloc(5 * count);
    if (room == NULL) {
        fprintf(stderr, "cannot hold a grid of %u x %u rays\n", (unsigned)grid->side, (unsigned)grid->side);
        return EXIT_FAILURE;
    }
    int result = trace_points(context, grid, out, room);
    if (result == 0 && grid->refines) {
        result = refine(context, grid, out, room, room + count);
    }
    free(room);
    return result;
}
