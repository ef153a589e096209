/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_quality.c -- see viewer_quality.h.
 *
 * A frame's cost goes with its pixels, so with the square of the scale. Where the GPU tells its time, the load is known
 * also while vsync makes every frame last a period: the scale follows it. Where it does not, a frame that is in time
 * says nothing about how much room there is; then a slightly larger scale is tried now and then, and after a failure
 * the next try waits twice as long, so that the picture does not pump.
 *
 * Matter with depth at half resolution is the first thing to be given up, and the last to be had back, because it shows
 * least. Where a scene has none, that changes nothing, and the scale falls three late frames later. */
#include "viewer_quality.h"

#include <math.h>

#define SMALLEST_SCALE 0.1
#define LOAD_TOO_HIGH 1.08 /* above: the scale falls */
#define LOAD_EASY 0.65     /* below: the scale can rise; between the two nothing changes, or a little more is tried */
#define LOAD_AIMED_AT 0.85
#define LOAD_HALVED 0.4 /* of a frame at half resolution, below which one at full resolution is in time */
#define SMOOTHING 0.25
#define RAISE 1.1
#define BOLD_RAISE 1.3    /* as long as that is not known to be too much */
#define MOST_LOWERING 0.5 /* the machine may only have stumbled */
#define SAME 0.98 /* scales nearer than this to each other are one */
#define LATE_FRAMES 3
#define PATIENCE_LEAST 20
#define PATIENCE_MOST 1200
#define LONGEST_REFINEMENT 1.0 /* seconds: a hand that moves again must not wait longer */

#define PICTURE_SAMPLES 4

static const unsigned REFINED_SAMPLES[] = {1, 4, 16};
#define REFINEMENTS (sizeof REFINED_SAMPLES / sizeof REFINED_SAMPLES[0])

void governor_init(Governor *governor, double rate, double scale) {
    const Governor fresh = {.enabled = 1,
                            .period = 1.0 / (rate > 0.0 ? rate : 60.0),
                            .scale = fmax(SMALLEST_SCALE, fmin(1.0, scale)),
                            .load = LOAD_AIMED_AT,
                            .ceiling = 2.0,
                            .patience = PATIENCE_LEAST};
    *governor = fresh;
}

void governor_take_resolution(Governor *governor, const BhrContext *context) {
    BhrQuality quality;
    BHR_INIT(quality);
    if (bhr_get_quality(context, &quality) >= 0) {
        governor->half = quality.volume_resolution == BHR_VOLUME_RESOLUTION_HALF;
    }
}

void governor_choose(const Governor *governor, int moving, BhrQuality *quality) {
    if (!governor->enabled) {
        return;
    }
    if (moving) {
        quality->render_scale = governor->scale;
        quality->samples_per_pixel = 1;
        if (governor->half) {
            quality->volume_resolution = BHR_VOLUME_RESOLUTION_HALF;
        }
        return;
    }
    quality->render_scale = 1.0;
    unsigned samples = REFINED_SAMPLES[governor->refinement < REFINEMENTS ? governor->refinement : REFINEMENTS - 1];
    /* The user's choice counts where it is finer than ours at its end. */
    if (governor->refinement + 1 < REFINEMENTS || samples > quality->samples_per_pixel) {
        quality->samples_per_pixel = samples;
    }
}

void governor_choose_for_picture(const Governor *governor, BhrQuality *quality) {
    if (governor->enabled && quality->samples_per_pixel < PICTURE_SAMPLES) {
        quality->samples_per_pixel = PICTURE_SAMPLES;
    }
}

static void set_scale(Governor *governor, double scale) {
    governor->scale = fmax(SMALLEST_SCALE, fmin(1.0, scale));
    governor->load = LOAD_AIMED_AT;
    governor->late_frames = governor->easy_frames = 0;
}

static void raise(Governor *governor, double factor) {
    governor->before_raise = governor->scale;
    governor->before_half = governor->half;
    governor->just_raised = 2 * PATIENCE_LEAST;
    set_scale(governor, governor->scale * factor);
}

static void forget_ceiling(Governor *governor) {
    governor->ceiling = 2.0;
    governor->patience = PATIENCE_LEAST;
}

static void lower(Governor *governor, double load) {
    if (governor->just_raised > 0) { /* that was too much: back, and not so soon again */
        if (governor->half == governor->before_half) {
            governor->ceiling = governor->scale;
        }
        governor->patience = governor->patience < PATIENCE_MOST / 2 ? 2 * governor->patience : PATIENCE_MOST;
        governor->half = governor->before_half;
        set_scale(governor, governor->before_raise);
    } else if (!governor->half) { /* the scene has become dearer, perhaps by its matter */
        governor->half = 1;
        set_scale(governor, governor->scale);
    } else {
        forget_ceiling(governor);
        set_scale(governor, governor->scale * fmax(MOST_LOWERING, sqrt(LOAD_AIMED_AT / load)));
    }
    governor->just_raised = 0;
}

/* A late frame may be an accident: the least late of several in a row says what the scale must fall by. */
static void hear_late(Governor *governor, double load) {
    governor->easy_frames = 0;
    governor->least_late = governor->late_frames == 0 ? load : fmin(governor->least_late, load);
    const int can_fall = governor->scale > SMALLEST_SCALE || !governor->half;
    if (++governor->late_frames >= LATE_FRAMES && can_fall) {
        lower(governor, governor->least_late);
    }
}

static void hear_in_time(Governor *governor, double load, int measured) {
    governor->late_frames = 0;
    governor->load += SMOOTHING * (load - governor->load);
    if (governor->just_raised > 0 && --governor->just_raised == 0 && governor->scale >= SAME * governor->ceiling) {
        forget_ceiling(governor); /* it held */
    }
    const int room = governor->load < LOAD_EASY; /* for certain: even vsync did not lengthen these frames */
    const int whole = governor->scale >= 1.0, halved = governor->load < LOAD_HALVED;
    if ((whole && !governor->half) || (whole ? !halved && measured : !room && measured)) {
        governor->easy_frames = 0;
        return;
    }
    if (whole) {
        if (++governor->easy_frames >= (halved ? PATIENCE_LEAST : governor->patience)) {
            raise(governor, 1.0);
            governor->half = 0;
        }
        return;
    }
    const double blind = governor->scale * BOLD_RAISE < SAME * governor->ceiling ? BOLD_RAISE : RAISE;
    const double factor = room ? sqrt(LOAD_AIMED_AT / governor->load) : blind;
    const int    known = room || governor->scale * factor < SAME * governor->ceiling;
    if (++governor->easy_frames >= (known ? PATIENCE_LEAST : governor->patience)) {
        raise(governor, factor);
    }
}

static void hear_moving(Governor *governor, double seconds, double gpu_seconds) {
    const int measured = gpu_seconds > 0.0, late = seconds > LOAD_TOO_HIGH * governor->period;
    /* A late frame counts whatever the GPU says: the time may go elsewhere. */
    double cost = !measured ? seconds : late ? fmax(seconds, gpu_seconds) : gpu_seconds, load = cost / governor->period;
    if (load > LOAD_TOO_HIGH) {
        hear_late(governor, load);
    } else {
        hear_in_time(governor, load, measured);
    }
}

void governor_hear(Governor *governor, int moving, double seconds, double gpu_seconds) {
    if (moving) {
        if (governor->enabled && seconds > 0.0) {
            hear_moving(governor, seconds, gpu_seconds);
        }
        return;
    }
    if (governor->refinement == 0) {
        governor->resting_cost = gpu_seconds > 0.0 ? gpu_seconds : seconds;
    }
    governor->refinement++;
}

void governor_restart(Governor *governor) { governor->refinement = 0; }

int governor_is_done(const Governor *governor, const BhrQuality *quality) {
    if (!governor->enabled) {
        return governor->refinement > 0;
    }
    if (governor->refinement == 0) {
        return 0;
    }
    if (governor->refinement >= REFINEMENTS) {
        return 1;
    }
    BhrQuality next = *quality;
    governor_choose(governor, 0, &next);
    return governor->resting_cost * next.samples_per_pixel > LONGEST_REFINEMENT;
}
