/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_frame.h -- the window's frames, rendered one at a time on a thread of their own. Calls on the context and its
 * surface wait for that frame: leave both alone until it is done. On macOS, where surfaces belong to the main thread,
 * frames are rendered at once. */
#ifndef EXAMPLES_VIEWER_FRAME_H
#define EXAMPLES_VIEWER_FRAME_H

#include "scene.h"
#include "viewer_worker.h"

typedef struct Frame {
    Worker        worker;
    int           busy;   /* it was begun, and its end not taken */
    BhrContext   *context;
    BhrSurface   *surface;
    Scene         scene;  /* that it shows */
    BhrStatus     status, work_status; /* of the last one; a failure was reported. Of the one in work: the thread's */
    BhrFrameStats stats, work_stats;   /* the same, of good ones */
} Frame;

/* Starts the thread, which calls on_done after each frame. 1, or 0 after a message. */
int frame_start(Frame *frame, void (*on_done)(void));

/* Begins a frame of `scene`: sets it in the context, renders and presents. None may be under way. */
void frame_begin(Frame *frame, BhrContext *context, BhrSurface *surface, const Scene *scene);

/* Takes the end of the frame that is under way, if it is there, or waits for it. 1: the status is this frame's. */
int frame_take(Frame *frame, int wait);

/* Waits for a frame that is under way, and ends the thread. */
void frame_end(Frame *frame);

#endif
