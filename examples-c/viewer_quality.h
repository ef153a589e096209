/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_quality.h -- adaptive quality: matter with depth at half resolution and then fewer traced pixels while the
 * picture moves, so that the display's rate is held, and a finer and finer picture when it rests. Decides only; knows
 * no window and renders nothing. */
#ifndef EXAMPLES_VIEWER_QUALITY_H
#define EXAMPLES_VIEWER_QUALITY_H

#include <bhr.h>

typedef struct Governor {
    int      enabled;
    double   period;       /* seconds between frames that it holds */
    double   scale;        /* BhrQuality.render_scale while moving */
    int      half;         /* whether BhrQuality.volume_resolution is HALF while moving */
    double   load;         /* cost of a moving frame in time / period, smoothed */
    int      late_frames;  /* in a row */
    double   least_late;   /* their least load */
    int      easy_frames;  /* since the load last spoke against a larger scale */
    double   ceiling;      /* the scale that was too large when it was tried last */
    int      patience;     /* easy frames to wait for before it is tried again */
    double   before_raise; /* the scale before the last raise */
    int      before_half;  /* whether matter was at half resolution then */
    int      just_raised;  /* frames until a raise counts as a success */
    unsigned refinement;   /* of the resting picture: 0 none, 1 whole scale, 2 .. more samples */
    double   resting_cost; /* seconds of a frame with one sample at whole scale; 0: not known */
} Governor;

/* `rate` in frames per second; `scale` to begin with, 0.1 .. 1. */
void governor_init(Governor *governor, double rate, double scale);

/* Begins with the resolution of matter that AUTO of a preset found fast enough, which the context has since. */
void governor_take_resolution(Governor *governor, const BhrContext *context);

/* Lays scale, samples and the resolution of matter for the next frame over the user's quality. */
void governor_choose(const Governor *governor, int moving, BhrQuality *quality);

/* Lays the samples and the resolution of matter of a picture that is saved over the user's quality. */
void governor_choose_for_picture(const Governor *governor, BhrQuality *quality);

/* Hears what a presented frame cost: `seconds` from the last frame's end to this one's (0: there was a pause between),
 * gpu_seconds 0 where the adapter has no timestamps. */
void governor_hear(Governor *governor, int moving, double seconds, double gpu_seconds);

/* The picture has changed: it is to be refined from the beginning. */
void governor_restart(Governor *governor);

/* Whether a resting picture is as fine as it will get: no frame is needed. */
int governor_is_done(const Governor *governor, const BhrQuality *quality);

#endif
