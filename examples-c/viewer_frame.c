/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_frame.c -- see viewer_frame.h. */
#include "viewer_frame.h"

#ifdef __APPLE__
#define HAS_THREAD 0
#else
#define HAS_THREAD 1
#endif

static void render(void *argument) {
    Frame *frame = argument;
    BhrStatus status = scene_apply(&frame->scene, frame->context);
    if (status >= 0) {
        status = bhr_render_surface(frame->context, frame->surface);
    }
    if (status < 0) {
        report_failure("render the frame", status); /* here: messages belong to the thread that called */
    } else if (status == BHR_OK && bhr_frame_stats(frame->context, &frame->work_stats) < 0) {
        BHR_INIT(frame->work_stats);
    }
    frame->work_status = status;
}

int frame_start(Frame *frame, void (*on_done)(void)) {
    BHR_INIT(frame->work_stats);
    frame->stats = frame->work_stats;
    return !HAS_THREAD || worker_start(&frame->worker, on_done);
}

void frame_begin(Frame *frame, BhrContext *context, BhrSurface *surface, const Scene *scene) {
    frame->context = context;
    frame->surface = surface;
    frame->scene = *scene;
    frame->busy = 1;
    if (HAS_THREAD) {
        worker_begin(&frame->worker, render, frame);
    } else {
        render(frame);
    }
}

int frame_take(Frame *frame, int wait) {
    if (!frame->busy || (HAS_THREAD && !worker_take(&frame->worker, wait))) {
        return 0;
    }
    frame->busy = 0;
    frame->status = frame->work_status;
    frame->stats = frame->work_stats;
    return 1;
}

void frame_end(Frame *frame) { worker_end(&frame->worker); }
