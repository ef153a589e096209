/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_pictures.c -- see viewer_pictures.h. */
#include "viewer_pictures.h"

#include "colour_bar.h"
#include "common.h"
#include "picture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define MOST_PICTURES 9999
#define MOST_FILMS 99

/* False colour gets its bar in files alone: windows are the library's. */
static BhrStatus explain_and_save(const BhrContext *context, BhrImage *image, const char *path) {
    BhrStatus status = colour_bar_add(context, image);
    return status < 0 ? status : bhr_image_save(image, path);
}

static BhrStatus render_and_save(BhrContext *context, BhrImage *image, const char *path) {
    BhrStatus status = bhr_render_image(context, image);
    return status < 0 ? status : explain_and_save(context, image, path);
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

/* A context on the adapter of another one. */
static BhrStatus open_beside(const BhrContext *context, BhrContext **beside) {
    BhrContextOptions options;
    BhrAdapterInfo    adapter;
    BHR_INIT(options);
    BHR_INIT(adapter);
    BhrStatus status = bhr_context_adapter(context, &adapter);
    if (status < 0) {
        return status;
    }
    options.backend = adapter.backend;
    uint32_t count = 0;
    if (bhr_adapter_count(&count) < 0) {
        count = 0; /* the first one of this kind will do */
    }
    for (uint32_t i = 0; i < count; i++) {
        BhrAdapterInfo listed;
        BHR_INIT(listed);
        if (bhr_adapter_info(i, &listed) >= 0 && listed.backend == adapter.backend &&
            strcmp(listed.name, adapter.name) == 0) {
            options.adapter_index = (int32_t)i;
            break;
        }
    }
    return bhr_context_create(BHR_ABI_VERSION, &options, beside);
}

/* Gives one context the scene of another, as text, and then the values of `scene`: in the text things that move are as
 * they begin. */
static BhrStatus copy_scene(const BhrContext *from, const Scene *scene, BhrContext *to) {
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
    return status < 0 ? status : scene_apply(scene, to);
}

int picture_begin_numbered(PictureJob *picture, const BhrContext *context, const Scene *scene, uint32_t width,
                           uint32_t height) {
    picture_cancel(picture);
    if (!free_name(picture->path) || !picture_allocate(&picture->image, BHR_FORMAT_RGBA8_SRGB, width, height)) {
        return 0;
    }
    BhrStatus status = picture->context == NULL ? open_beside(context, &picture->context) : BHR_OK;
    if (status >= 0) {
        status = copy_scene(context, scene, picture->context);
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

PictureEnd picture_poll(PictureJob *picture) {
    if (picture->job == NULL) {
        return PICTURE_NONE;
    }
    BhrStatus status = bhr_job_wait(picture->job, 0, &picture->fraction);
    if (status == BHR_NOT_READY) {
        return PICTURE_RUNNING;
    }
    if (status >= 0) {
        status = explain_and_save(picture->context, &picture->image, picture->path);
    }
    if (status < 0) {
        report_failure("save a picture", status);
    } else {
        printf("picture saved: %s, %u x %u\n", picture->path, (unsigned)picture->image.width,
               (unsigned)picture->image.height);
    }
    picture_cancel(picture);
    return status < 0 ? PICTURE_FAILED : PICTURE_SAVED;
}

void picture_cancel(PictureJob *picture) {
    if (picture->job != NULL) {
        bhr_job_destroy(picture->job);
        picture->job = NULL;
        free(picture->image.pixels);
    }
}

void picture_end(PictureJob *picture) {
    picture_cancel(picture);
    bhr_context_destroy(picture->context);
    picture->context = NULL;
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
