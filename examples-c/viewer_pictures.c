/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_pictures.c -- see viewer_pictures.h. */
#include "viewer_pictures.h"

#include "colour_bar.h"
#include "common.h"
#include "picture.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_PICTURES 9999
#define MOST_FILMS 99
#define LARGEST_FRACTION 0.99 /* of a job that is not done; 1: the picture is being saved */
#define MOST_FRAMES 18000u /* of a film, five minutes: their scenes take 48 MB */
#define FRAMES_ROOM 600u   /* that memory is asked for at once */

/* False colour gets its bar in files alone: windows are the library's. */
static BhrStatus render_and_save(BhrContext *context, BhrImage *image, const char *path) {
    BhrStatus status = bhr_render_image(context, image);
    if (status >= 0) {
        status = colour_bar_add(context, image);
    }
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

static void save(void *argument) {
    Saving *saving = argument;
    saving->status = bhr_image_save(saving->image, saving->path);
    if (saving->status < 0) {
        report_failure("save a picture", saving->status);
    }
}

/* Saving and image stay as they are until the end is taken. Where there is no thread to be had, saves at once. The
 * context still has the picture's scene. A picture without a bar is better than none. */
static void saving_begin(Saving *saving, const BhrContext *context, BhrImage *image) {
    const BhrStatus status = colour_bar_add(context, image);
    if (status < 0) {
        report_failure("explain a picture's colours", status);
    }
    saving->image = image;
    if (saving->worker.system != NULL || worker_start(&saving->worker, NULL)) {
        worker_begin(&saving->worker, save, saving);
    } else {
        save(saving);
    }
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

int picture_begin_numbered(PictureJob *picture, const BhrAdapterInfo *adapter, const BhrContext *from,
                           const Scene *scene, uint32_t width, uint32_t height) {
    picture_cancel(picture);
    if (!free_name(picture->path) || !picture_allocate(&picture->image, BHR_FORMAT_RGBA8_SRGB, width, height)) {
        return 0;
    }
    BhrStatus status = picture->context == NULL ? create_context_beside(adapter, &picture->context) : BHR_OK;
    if (status >= 0) {
        status = scene_copy(from, picture->context);
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

/* The job and the saving first: until they have ended the pixels are theirs. */
static void forget(PictureJob *picture) {
    worker_take(&picture->saving.worker, 1);
    bhr_job_destroy(picture->job);
    picture->job = NULL;
    free(picture->image.pixels);
}

PictureEnd picture_poll(PictureJob *picture) {
    if (picture->job == NULL) {
        return PICTURE_NONE;
    }
    BhrStatus status = BHR_OK;
    if (picture->fraction < 1.0) {
        status = bhr_job_wait(picture->job, 0, &picture->fraction);
        if (status == BHR_NOT_READY) {
            picture->fraction = fmin(picture->fraction, LARGEST_FRACTION);
            return PICTURE_RUNNING;
        }
        if (status >= 0) {
            picture->fraction = 1.0;
            snprintf(picture->saving.path, sizeof picture->saving.path, "%s", picture->path);
            saving_begin(&picture->saving, picture->context, &picture->image);
        } else {
            report_failure("render a picture", status);
        }
    }
    if (status >= 0) {
        if (picture->saving.worker.busy && !worker_take(&picture->saving.worker, 0)) {
            return PICTURE_RUNNING;
        }
        status = picture->saving.status;
    }
    if (status >= 0) {
        printf("picture saved: %s, %u x %u\n", picture->path, (unsigned)picture->image.width,
               (unsigned)picture->image.height);
    }
    forget(picture);
    return status < 0 ? PICTURE_FAILED : PICTURE_SAVED;
}

void picture_cancel(PictureJob *picture) {
    if (picture->job == NULL) {
        return;
    }
    if (picture->fraction < 1.0) {
        printf("picture broken off: %s\n", picture->path);
        forget(picture);
        return;
    }
    while (picture_poll(picture) == PICTURE_RUNNING) { /* a file is not left half written */
        worker_take(&picture->saving.worker, 1);
    }
}

void picture_end(PictureJob *picture) {
    picture_cancel(picture);
    worker_end(&picture->saving.worker);
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
    worker_end(&recorder->saving.worker);
    bhr_job_destroy(recorder->job);
    bhr_context_destroy(recorder->context);
    free(recorder->images[0].pixels);
    free(recorder->images[1].pixels);
    free(recorder->scenes);
    memset(recorder, 0, sizeof *recorder);
}

int recorder_start(Recorder *recorder, const BhrAdapterInfo *adapter, const BhrContext *from, uint32_t width,
                   uint32_t height) {
    Recorder  fresh = {.taking = 1, .width = width, .height = height};
    BhrStatus status = create_context_beside(adapter, &fresh.context);
    if (status >= 0) {
        status = scene_copy(from, fresh.context);
    }
    if (status < 0) {
        report_failure("begin a film", status);
    }
    if (status < 0 || !picture_allocate(&fresh.images[0], BHR_FORMAT_RGBA8_SRGB, width, height) ||
        !picture_allocate(&fresh.images[1], BHR_FORMAT_RGBA8_SRGB, width, height) || !make_film_folder(fresh.folder)) {
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

/* Takes the end of a frame's saving, if it is there, or waits for it. Errors: as the library's. */
static BhrStatus take_saved(Recorder *recorder, int wait) {
    if (recorder->saved == recorder->begun - (recorder->job != NULL ? 1 : 0)) {
        return BHR_OK; /* none is being saved */
    }
    if (recorder->saving.worker.busy && !worker_take(&recorder->saving.worker, wait)) {
        return BHR_NOT_READY;
    }
    recorder->saved += recorder->saving.status >= 0 ? 1 : 0;
    return recorder->saving.status;
}

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
        take_saved(recorder, 1);
        tell_film(recorder);
    }
}

/* Begins the next frame, where there is one. */
static BhrStatus begin_frame(Recorder *recorder) {
    if (recorder->begun == recorder->taken) {
        return BHR_OK;
    }
    BhrStatus status = scene_apply(&recorder->scenes[recorder->begun], recorder->context);
    if (status >= 0) {
        status = bhr_render_image_async(recorder->context, &recorder->images[recorder->begun % 2], &recorder->job);
    }
    recorder->begun += status >= 0 ? 1 : 0;
    return status;
}

/* Hands the frame that is done to the saving, which must be free. */
static void save_frame(Recorder *recorder) {
    bhr_job_destroy(recorder->job);
    recorder->job = NULL;
    snprintf(recorder->saving.path, sizeof recorder->saving.path, "%s/frame-%06u.png", recorder->folder,
             recorder->begun);
    saving_begin(&recorder->saving, recorder->context, &recorder->images[(recorder->begun - 1) % 2]);
}

/* One step on, as far as jobs and files are. NOT_READY: there is nothing to do yet. */
static BhrStatus go_on(Recorder *recorder) {
    BhrStatus status = take_saved(recorder, 0);
    if (status != BHR_OK) {
        return status;
    }
    if (recorder->job != NULL) {
        status = bhr_job_wait(recorder->job, 0, NULL);
        if (status != BHR_OK) {
            return status;
        }
        save_frame(recorder);
    }
    return begin_frame(recorder);
}

PictureEnd recorder_poll(Recorder *recorder) {
    if (recorder->context == NULL) {
        return PICTURE_NONE;
    }
    const BhrStatus status = go_on(recorder);
    if (status < 0) {
        if (recorder->saving.status >= 0) { /* else it was said */
            report_failure("render a frame of the film", status);
        }
        tell_film(recorder);
        return PICTURE_FAILED;
    }
    if (recorder->taking || recorder->saved < recorder->taken) {
        return PICTURE_RUNNING;
    }
    tell_film(recorder);
    return PICTURE_SAVED;
}
