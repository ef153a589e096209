/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_frame.h -- a thread that renders the window's frames, one at a time, so that the window answers while one
 * takes long. Calls on the context and its surface wait for that frame: leave both alone until it is done. On macOS,
 * where surfaces belong to the main thread, frames are rendered at once. */
#ifndef EXAMPLES_VIEWER_FRAME_H
#define EXAMPLES_VIEWER_FRAME_H

#include "scene.h"

typedef struct FrameSystem FrameSystem; /* the system's thread, and what it waits for */

typedef struct FrameThread {
    FrameSystem  *system;
    void        (*on_done)(void); /* called on the thread, or NULL */
    int           busy;           /* a frame was begun, and its end not taken */
    BhrContext   *context;
    BhrSurface   *surface;
    Scene         scene;  /* that it shows */
    BhrStatus     status; /* of the last one; a failure was reported */
    BhrFrameStats stats;  /* of the last good one */
} FrameThread;

/* 1, or 0 after a message. */
int frame_thread_start(FrameThread *thread, void (*on_done)(void));

/* Begins a frame of `scene`: sets it in the context, renders and presents. None may be under way. */
void frame_thread_begin(FrameThread *thread, BhrContext *context, BhrSurface *surface, const Scene *scene);

/* Takes the end of the frame that is under way, if it is there, or waits for it. 1: the status is this frame's. */
int frame_thread_take(FrameThread *thread, int wait);

/* Waits for a frame that is under way, and ends the thread. */
void frame_thread_end(FrameThread *thread);

#endif
