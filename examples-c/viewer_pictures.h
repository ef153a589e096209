/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_pictures.h -- pictures and recordings: frames that are rendered into memory and saved as PNG, under names that
 * overwrite nothing. Both are rendered in the background, by contexts of their own, so that the window goes on. Knows
 * no window. */
#ifndef EXAMPLES_VIEWER_PICTURES_H
#define EXAMPLES_VIEWER_PICTURES_H

#include "scene.h"
#include "viewer_worker.h"

#define RECORDED_RATE 60.0 /* frames per second of a recording */
#define FOLDER_NAME 32
#define PICTURE_NAME 32

/* Renders the context's scene and saves it. 1, or 0 after a message. */
int picture_save(BhrContext *context, uint32_t width, uint32_t height, const char *path);

/* A picture on its way into a file, on a thread: to compress a large one takes longer than a window may be deaf. */
typedef struct Saving {
    Worker          worker; /* from the first file on */
    const BhrImage *image;
    char            path[FOLDER_NAME + PICTURE_NAME];
    BhrStatus       status; /* a failure was reported */
} Saving;

/* A picture that is rendered in the background. */
typedef struct PictureJob {
    BhrContext *context; /* its own, from the first picture on */
    BhrJob     *job;     /* NULL: none is under way */
    Saving      saving;  /* of the job that is done */
    BhrImage    image;
    double      fraction; /* the part that is done */
    char        path[PICTURE_NAME];
} PictureJob;

typedef enum PictureEnd { PICTURE_NONE, PICTURE_RUNNING, PICTURE_SAVED, PICTURE_FAILED } PictureEnd;

/* Begins a picture of a scene, as viewer-0001.png or the next free number, in the working folder, on an adapter and
 * with the map of the sky and the LUT that `from` has. 1, or 0 after a message. */
int picture_begin_numbered(PictureJob *picture, const BhrAdapterInfo *adapter, const BhrContext *from,
                           const Scene *scene, uint32_t width, uint32_t height);

/* Whether one is under way; the one that is done is saved, and it is said where. */
PictureEnd picture_poll(PictureJob *picture);

/* Breaks the picture off, if one is under way, and says so; the context stays for the next. */
void picture_cancel(PictureJob *picture);

/* The end of all pictures. */
void picture_end(PictureJob *picture);

/* A film: scenes that the window shows are kept, and rendered one after the other, also when no more are taken. */
typedef struct Recorder {
    int         taking;         /* scenes from the window */
    uint32_t    width, height;  /* of every frame: a film does not change its size when the window does */
    Scene      *scenes;         /* of all frames */
    unsigned    taken, room;    /* how many there are, and fit */
    unsigned    begun, saved;   /* frames */
    BhrContext *context;        /* its own; NULL: there is no film */
    BhrJob     *job;            /* the next frame's; NULL: none is under way */
    Saving      saving;         /* of the one before */
    BhrImage    images[2];      /* frames in turn: one is rendered while the other is saved */
    char        folder[FOLDER_NAME];
} Recorder;

/* Begins a film in a new folder, viewer-film-01 or the next free number, on an adapter and with the map of the sky and
 * the LUT that `from` has; says where. 1, or 0 after a message. */
int recorder_start(Recorder *recorder, const BhrAdapterInfo *adapter, const BhrContext *from, uint32_t width,
                   uint32_t height);

/* The next frame's scene, if it takes any. */
void recorder_take(Recorder *recorder, const Scene *scene);

/* Takes no more; what was taken is rendered. */
void recorder_stop(Recorder *recorder);

/* Whether there is a film; saves the frame that is done, begins the next, and says when all are saved. */
PictureEnd recorder_poll(Recorder *recorder);

/* Breaks the film off, if there is one: frames that are saved stay, and it says how many. */
void recorder_cancel(Recorder *recorder);

#endif
