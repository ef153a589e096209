/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* job_scenes.h -- what the tests of jobs share: eight scenes that differ in what a job has to take along, their frames
 * as bhr_render_image has them, and a job that is far from its end whenever it is looked at. It tests nothing by
 * itself. */
#ifndef BHR_JOB_SCENES_H
#define BHR_JOB_SCENES_H

#include "check.h"

#define WIDTH 40u
#define HEIGHT 30u
#define BYTES (WIDTH * HEIGHT * 4u)
#define FLIGHT 8 /* jobs under way at once */
#define FOR_EVER UINT64_MAX

/* The slow job: many samples, every ray integrated. Software, which takes long for each sample, has a smaller one, but
 * with few samples, as it would be over soon. */
#define ALL_SAMPLES 256u
#define SLOW_WIDTH 640u
#define SLOW_HEIGHT 480u
#define SLOW_BYTES (SLOW_WIDTH * SLOW_HEIGHT * 4u)

extern unsigned char slow_pixels[SLOW_BYTES];
extern uint32_t      slow_samples; /* ALL_SAMPLES; fewer are slow enough under valgrind */
/* The frames of the scenes, and the targets of jobs that must show the same. */
extern unsigned char expected[FLIGHT][BYTES], got[FLIGHT][BYTES];

BhrImage frame_of(unsigned char *pixels);
BhrJob  *submit(BhrContext *context, const BhrImage *target); /* ends the program when there is no job */
void     set_quality(BhrContext *context, BhrMethod method, uint32_t samples);
/* Submits a job that takes long. The scene shows light, as other views take one sample a pixel, and no region.
 * Afterwards the context's quality is the default. */
BhrJob  *submit_slow(BhrContext *context);
/* Waits until some, but not all, of a job is done. */
double   wait_for_a_part(BhrJob *job, double part);
/* Cancels the slow job. */
void     end_slow(BhrJob *job);

/* One of the scenes, 0 to FLIGHT - 1. */
void set_scene(BhrContext *context, int index);
void render_expected(BhrContext *context, int count); /* the first scenes */
void check_frame(int index); /* got is as expected */

#endif
