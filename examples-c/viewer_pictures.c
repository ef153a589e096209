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
#define MOST_FRAMES 18000u /* of a film, five minutes: their scenes take 48 MB */
#define FRAMES_ROOM 600u   /* that memory is asked for at once */

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

static int free_name(char *path) {
    for (int i = 1; i <= MOST_PICTURES; i++) {
        snprintf(path, PICTURE_NAME, "viewer-%04d.png", i);
        if (!exists(path)) {
            return 1;
        }
    }
    fprintf(stderr, "cannot save a picture: there are viewer-0001.png to viewer-%d.png already\n", MOST_PICTURES);
    return 0;
}

/* Gives one context the scene of another, as text. */
static BhrStatus copy_text(const BhrContext *from, BhrContext *to) {
    size_t    size = 0;
    BhrStatus status = bhr_scene_save(from, NULL, 0, &size);
    char     *text = status < 0 ? NULL : malloc(size + 1);
    if (text == NULL) {
        return status < 0 ? status : BHR_ERROR_OUT_OF_MEMORY;
    }
    status = bhr_scene_save(from, text, size + 1, &size);
    if (status >= 0) {
        status = bhr_scene_load(to, text, size);
    }
    free(text);
    return status;
}

int picture_begin_numbered(PictureJob *picture, const BhrContext *context, const Scene *scene, uint32_t width,
                           uint32_t height) {
    picture_cancel(picture);
    if (!free_name(picture->path) || !picture_allocate(&picture->image, BHR_FORMAT_RGBA8_SRGB, width, height)) {
        return 0;
    }
    BhrStatus status = picture->context == NULL ? create_context_beside(context, &picture->context) : BHR_OK;
    if (status >= 0) {
        status = copy_text(context, picture->context);
    }
    if (status >= 0) { /* in the text things that move are as they begin */
        status = scene_apply(scene, picture->context);
    }
    if (status >= 0) {
        status = bhr_render_image_async(picture->context, &picture->image, &picture->job);
    }
    picture->fraction = 0.0;
    if (status < 0) {
        report_failure("begin a picture", status);
        free(picture->image.pixels);
        /* Its device may be lost: the next picture has a new one. */
        bhr_context_destroy(picture->context);
        picture->context = NULL;
    }
    return status >= 0;
}

/* The job first: until it has ended the pixels are its own. */
static void forget(PictureJob *picture) {
    bhr_job_destroy(picture->job);
    picture->job = NULL;
    free(picture->image.pixels);
}

PictureEnd picture_poll(PictureJob *picture) {
    if (picture->job == NULL) {
        return PICTURE_NONE;
    }
    BhrStatus status = bhr_job_wait(picture->job, 0, &picture->fraction);
    if (status == BHR_NOT_READY) {
        return PICTURE_RUNNING;
    }
    if (status >= 0) {
        status = bhr_image_save(&picture->image, picture->path);
    }
    if (status < 0) {
        report_failure("save a picture", status);
    } else {
        printf("picture saved: %s, %u x %u\n", picture->path, (unsigned)picture->image.width,
               (unsigned)picture->image.height);
    }
    forget(picture);
    return status < 0 ? PICTURE_FAILED : PICTURE_SAVED;
}

void picture_cancel(PictureJob *picture) {
    if (picture->job != NULL) {
        printf("picture broken off: %s\n", picture->path);
        forget(picture);
    }
}

void picture_end(PictureJob *picture) {
    picture_cancel(picture);
    bhr_context_destroy(picture->context);
    picture->context = NULL;
}

/* A new folder for a film. 1, or 0 after a message. */
static int make_film_folder(char folder[FOLDER_NAME]) {
    for (int i = 1; i <= MOST_FILMS; i++) {
        snprintf(folder, FOLDER_NAME, "viewer-film-%02d", i);
        if (make_folder(folder)) {
            return 1;
        }
        if (errno != EEXIST) {
            break;
        }
    }
    fprintf(stderr, "cannot record: no folder %s: %s\n", folder, strerror(errno));
    return 0;
}

/* The end of a film, whatever has become of it. */
static void close_film(Recorder *recorder) {
    bhr_job_destroy(recorder->job);
    bhr_context_destroy(recorder->context);
    free(recorder->image.pixels);
    free(recorder->scenes);
    memset(recorder, 0, sizeof *recorder);
}

int recorder_start(Recorder *recorder, const BhrContext *context, uint32_t width, uint32_t height) {
    Recorder  fresh = {.taking = 1, .width = width, .height = height};
    BhrStatus status = create_context_beside(context, &fresh.context);
    if (status >= 0) {
        status = copy_text(context, fresh.context);
    }
    if (status < 0) {
        report_failure("begin a film", status);
    }
    if (status < 0 || !picture_allocate(&fresh.image, BHR_FORMAT_RGBA8_SRGB, width, height) ||
        !make_film_folder(fresh.folder)) {
        close_film(&fresh);
        return 0;
    }
    recorder_cancel(recorder);
    *recorder = fresh;
    printf("recording %u x %u at %g frames per second into %s\n", (unsigned)width, (unsigned)height, RECORDED_RATE,
           fresh.folder);
    return 1;
}

void recorder_take(Recorder *recorder, const Scene *scene) {
    if (!recorder->taking) {
        return;
    }
    if (recorder->taken == recorder->room) {
        const unsigned room = recorder->room + FRAMES_ROOM;
        Scene         *scenes = room <= MOST_FRAMES ? realloc(recorder->scenes, room * sizeof *scenes) : NULL;
        if (scenes == NULL) {
            fprintf(stderr, "cannot record more than %u frames\n", recorder->taken);
            recorder_stop(recorder);
            return;
        }
        recorder->scenes = scenes;
        recorder->room = room;
    }
    recorder->scenes[recorder->taken++] = *scene;
}

void recorder_stop(Recorder *recorder) { recorder->taking = 0; }

/* Says how many frames there are, and ends the film. */
static void tell_film(Recorder *recorder) {
    printf("recorded %u frames in %s", recorder->saved, recorder->folder);
    if (recorder->saved < recorder->taken) {
        printf(", of %u: broken off", recorder->taken);
    }
    printf("; a film of them: ffmpeg -framerate %g -i %s/frame-%%06d.png film.mp4\n", RECORDED_RATE, recorder->folder);
    close_film(recorder);
}

void recorder_cancel(Recorder *recorder) {
    if (recorder->context != NULL) {
        tell_film(recorder);
    }
}

/* Begins the next frame, where there is one. */
static BhrStatus begin_frame(Recorder *recorder) {
    if (recorder->saved == recorder->taken) {
        return BHR_OK;
    }
    BhrStatus status = scene_apply(&recorder->scenes[recorder->saved], recorder->context);
    return status < 0 ? status : bhr_render_image_async(recorder->context, &recorder->image, &recorder->job);
}

/* Saves the frame that is under way, if it is done: BHR_OK then, and BHR_NOT_READY before. */
static BhrStatus end_frame(Recorder *recorder) {
    char      path[FOLDER_NAME + 32];
    BhrStatus status = bhr_job_wait(recorder->job, 0, NULL);
    if (status == BHR_NOT_READY) {
        return status;
    }
    snprintf(path, sizeof path, "%s/frame-%06u.png", recorder->folder, recorder->saved + 1);
    if (status >= 0) {
        status = bhr_image_save(&recorder->image, path);
    }
    bhr_job_destroy(recorder->job);
    recorder->job = NULL;
    recorder->saved += status >= 0 ? 1 : 0;
    return status;
}

PictureEnd recorder_poll(Recorder *recorder) {
    if (recorder->context == NULL) {
        return PICTURE_NONE;
    }
    BhrStatus status = recorder->job != NULL ? end_frame(recorder) : BHR_OK;
    if (status == BHR_OK) {
        status = begin_frame(recorder);
    }
    if (status < 0) {
        report_failure("render a frame of the film", status);
        tell_film(recorder);
        return PICTURE_FAILED;
    }
    if (recorder->taking || recorder->job != NULL) {
        return PICTURE_RUNNING;
    }
    tell_film(recorder);
    return PICTURE_SAVED;
}
