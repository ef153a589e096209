/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_pictures.h -- pictures and recordings: frames that are rendered into memory and saved as PNG, under names that
 * overwrite nothing. A picture to keep is rendered in the background, by a context of its own, so that the window goes
 * on. Knows no window: what the context holds is what is saved. */
#ifndef EXAMPLES_VIEWER_PICTURES_H
#define EXAMPLES_VIEWER_PICTURES_H

#include "scene.h"

#define RECORDED_RATE 60.0 /* frames per second of a recording */
#define FOLDER_NAME 32
#define PICTURE_NAME 32

typedef struct Recorder {
    int      running;
    uint32_t width, height; /* of every frame: a film does not change its size when the window does */
    unsigned frames;        /* saved */
    char     folder[FOLDER_NAME];
} Recorder;

/* Renders the context's scene and saves it. 1, or 0 after a message. */
int picture_save(BhrContext *context, uint32_t width, uint32_t height, const char *path);

/* A picture that is rendered in the background. */
typedef struct PictureJob {
    BhrContext *context; /* its own, from the first picture on */
    BhrJob     *job;     /* NULL: none is under way */
    BhrImage    image;
    double      fraction; /* the part that is done */
    char        path[PICTURE_NAME];
} PictureJob;

typedef enum PictureEnd { PICTURE_NONE, PICTURE_RUNNING, PICTURE_SAVED, PICTURE_FAILED } PictureEnd;

/* Begins a picture of a scene, as viewer-0001.png or the next free number, in the working folder, on the adapter of
 * `context` and with its map of the sky and its LUT. 1, or 0 after a message. */
int picture_begin_numbered(PictureJob *picture, const BhrContext *context, const Scene *scene, uint32_t width,
                           uint32_t height);

/* Whether one is under way; the one that is done is saved, and it is said where. */
PictureEnd picture_poll(PictureJob *picture);

/* Breaks the picture off, if one is under way; the context stays for the next. */
void picture_cancel(PictureJob *picture);

/* The end of all pictures. */
void picture_end(PictureJob *picture);

/* Begins a film in a new folder, viewer-film-01 or the next free number; says where. 1, or 0 after a message. */
int recorder_start(Recorder *recorder, uint32_t width, uint32_t height);

/* Saves the context's scene as the next frame; ends the recording when that fails. */
void recorder_add(Recorder *recorder, BhrContext *context);

/* Ends the recording and says what was recorded. */
void recorder_stop(Recorder *recorder);

#endif
