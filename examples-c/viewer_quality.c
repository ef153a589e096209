/* viewer_quality.c -- see viewer_quality.h.
 *
 * A frame's cost goes with its pixels, so with the square of the scale. Where the GPU tells its time, the load is known
 * also while vsync makes every frame last a period: the scale follows it. Where it does not, a frame that is in time
 * says nothing about how much room there is; then a slightly larger scale is tried now and then, and after a failure
 * the next try waits twice as long, so that the picture does not pump. */
#include "viewer_quality.h"

#include <math.h>

#define SMALLEST_SCALE 0.1
#define LOAD_TOO_HIGH 1.08 /* above: the scale falls */
#define LOAD_EASY 0.65     /* of GPU time, below: the scale may rise; between the two nothing changes */
#define LOAD_AIMED_AT 0.85
#define SMOOTHING 0.25
#define RAISE 1.1
#define PATIENCE_LEAST 20
#define PATIENCE_MOST 1200
#define LONGEST_REFINEMENT 1.0 /* seconds: a hand that moves again must not wait longer */

static const unsigned REFINED_SAMPLES[] = {1, 4, 16};
#define REFINEMENTS (sizeof REFINED_SAMPLES / sizeof REFINED_SAMPLES[0])

void governor_init(Governor *governor, double display_rate) {
    const Governor fresh = {.enabled = 1,
                            .period = 1.0 / (display_rate > 0.0 ? display_rate : 60.0),
                            .scale = 1.0,
                            .patience = PATIENCE_LEAST};
    *governor = fresh;
}

void governor_choose(const Governor *governor, int moving, BhrQuality *quality) {
    if (!governor->enabled) {
        return;
    }
    if (moving) {
        quality->render_scale = governor->scale;
        quality->samples_per_pixel = 1;
        return;
    }
    quality->render_scale = 1.0;
    unsigned samples = REFINED_SAMPLES[governor->refinement < REFINEMENTS ? governor->refinement : REFINEMENTS - 1];
    /* The user's choice counts where it is finer than ours at its end. */
    if (governor->refinement + 1 < REFINEMENTS || samples > quality->samples_per_pixel) {
        quality->samples_per_pixel = samples;
    }
}

static void set_scale(Governor *governor, double scale) {
    governor->scale = fmax(SMALLEST_SCALE, fmin(1.0, scale));
    governor->load = 0.0;
    governor->easy_frames = 0;
}

static void raise(Governor *governor, double factor) {
    set_scale(governor, governor->scale * factor);
    governor->just_raised = 2 * PATIENCE_LEAST;
}

static void lower(Governor *governor) {
    if (governor->just_raised > 0) {
        governor->patience = governor->patience < PATIENCE_MOST / 2 ? 2 * governor->patience : PATIENCE_MOST;
    }
    governor->just_raised = 0;
    set_scale(governor, governor->scale * sqrt(LOAD_AIMED_AT / governor->load));
}

static void hear_moving(Governor *governor, double seconds, double gpu_seconds) {
    double cost = gpu_seconds;
    /* A late frame counts whatever the GPU says: the time may go elsewhere. */
    if (gpu_seconds == 0.0 || seconds > LOAD_TOO_HIGH * governor->period) {
        cost = fmax(cost, seconds);
    }
    double load = cost / governor->period;
    governor->load = governor->load == 0.0 ? load : governor->load + SMOOTHING * (load - governor->load);
    governor->resting_cost = cost / (governor->scale * governor->scale);
    if (governor->just_raised > 0 && --governor->just_raised == 0) {
        governor->patience = PATIENCE_LEAST; /* it held */
    }
    if (governor->load > LOAD_TOO_HIGH) {
        governor->easy_frames = 0;
        /* One late frame is an accident, unless it is far too late. */
        if (load > LOAD_TOO_HIGH && governor->scale > SMALLEST_SCALE) {
            lower(governor);
        }
        return;
    }
    if (governor->scale >= 1.0 || (gpu_seconds > 0.0 && governor->load > LOAD_EASY)) {
        governor->easy_frames = 0;
        return;
    }
    if (++governor->easy_frames >= governor->patience) {
        raise(governor, gpu_seconds > 0.0 ? fmin(2.0 * RAISE, sqrt(LOAD_AIMED_AT / governor->load)) : RAISE);
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
