/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_pictures.h -- pictures and recordings: frames that are rendered into memory and saved as PNG, under names that
 * overwrite nothing. Knows no window: what the context holds is what is saved. */
#ifndef EXAMPLES_VIEWER_PICTURES_H
#define EXAMPLES_VIEWER_PICTURES_H

#include <bhr.h>

#define RECORDED_RATE 60.0 /* frames per second of a recording */
#define FOLDER_NAME 32

typedef struct Recorder {
    int      running;
    uint32_t width, height; /* of every frame: a film does not change its size when the window does */
    unsigned frames;        /* saved */
    char     folder[FOLDER_NAME];
} Recorder;

/* Renders the context's scene and saves it. 1, or 0 after a message. */
int picture_save(BhrContext *context, uint32_t width, uint32_t height, const char *path);

/* Saves a picture (picture_save) as viewer-0001.png or the next free number, in the working folder; says where. */
int picture_save_numbered(BhrContext *context, uint32_t width, uint32_t height);

/* Begins a film in a new folder, viewer-film-01 or the next free number; says where. 1, or 0 after a message. */
int recorder_start(Recorder *recorder, uint32_t width, uint32_t height);

/* Saves the context's scene as the next frame; ends the recording when that fails. */
void recorder_add(Recorder *recorder, BhrContext *context);

/* Ends the recording and says what was recorded. */
void recorder_stop(Recorder *recorder);

#endif
