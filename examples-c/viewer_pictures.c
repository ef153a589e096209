/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_pictures.c -- see viewer_pictures.h. */
#include "viewer_pictures.h"

#include "common.h"
#include "picture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define MOST_PICTURES 9999
#define MOST_FILMS 99

static BhrStatus render_and_save(BhrContext *context, const BhrImage *image, const char *path) {
    BhrStatus status = bhr_render_image(context, image);
    return status < 0 ? status : bhr_image_save(image, path);
}

int picture_save(BhrContext *context, uint32_t width, uint32_t height, const char *path) {
    BhrImage image;
    if (!picture_allocate(&image, BHR_FORMAT_RGBA8_SRGB, width, height)) {
        return 0;
    }
    BhrStatus status = render_and_save(context, &image, path);
    free(image.pixels);
    if (status < 0) {
        report_failure("save a picture", status);
    }
    return status >= 0;
}

static int exists(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file != NULL) {
        fclose(file);
    }
    return file != NULL;
}

int picture_save_numbered(BhrContext *context, uint32_t width, uint32_t height) {
    char path[32];
    for (int i = 1; i <= MOST_PICTURES; i++) {
        snprintf(path, sizeof path, "viewer-%04d.png", i);
        if (exists(path)) {
            continue;
        }
        if (!picture_save(context, width, height, path)) {
            return 0;
        }
        printf("picture saved: %s, %u x %u\n", path, (unsigned)width, (unsigned)height);
        return 1;
    }
    fprintf(stderr, "cannot save a picture: there are viewer-0001.png to viewer-%d.png already\n", MOST_PICTURES);
    return 0;
}

int recorder_start(Recorder *recorder, uint32_t width, uint32_t height) {
    Recorder fresh = {.running = 1, .width = width, .height = height};
    for (int i = 1; i <= MOST_FILMS; i++) {
        snprintf(fresh.folder, sizeof fresh.folder, "viewer-film-%02d", i);
        if (make_folder(fresh.folder)) {
            *recorder = fresh;
            printf("recording %u x %u at %g frames per second into %s\n", (unsigned)width, (unsigned)height,
                   RECORDED_RATE, fresh.folder);
            return 1;
        }
        if (errno != EEXIST) {
            break;
        }
    }
    fprintf(stderr, "cannot record: no folder %s: %s\n", fresh.folder, strerror(errno));
    return 0;
}

void recorder_add(Recorder *recorder, BhrContext *context) {
    char path[FOLDER_NAME + 32];
    snprintf(path, sizeof path, "%s/frame-%06u.png", recorder->folder, recorder->frames + 1);
    if (picture_save(context, recorder->width, recorder->height, path)) {
        recorder->frames++;
    } else {
        recorder_stop(recorder);
    }
}

void recorder_stop(Recorder *recorder) {
    recorder->running = 0;
    printf("recorded %u frames in %s; a film of them: ffmpeg -framerate %g -i %s/frame-%%06d.png film.mp4\n",
           recorder->frames, recorder->folder, RECORDED_RATE, recorder->folder);
}
