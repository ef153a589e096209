/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* scene.c -- see scene.h. */
#include "scene.h"

#include "vectors.h"

#include <stdlib.h>

/* The first look is the library's default scene: the camera is at (0, 26, 2.5). */
const SceneOptions SCENE_DEFAULTS = {
    .mass = 1.0,
    .spin = 0.0,
    .distance = 26.12,
    .azimuth = 90.0,
    .elevation = 5.492,
    .fov = 45.0,
    .disk_outer = 17.0,
    .turbulence = 1.0,
    .exposure = 0.0,
};

/* The effects that have strengths, in the order of the option and of scene files. */
static const uint32_t GRADED_EFFECTS[3] = {BHR_EFFECT_DOPPLER_SHIFT, BHR_EFFECT_GRAVITY_SHIFT, BHR_EFFECT_BEAMING};

BhrStatus scene_defaults(Scene *scene) {
    scene->mass = 1.0;
    scene->spin = 0.0;
    scene->axis[0] = scene->axis[1] = 0.0;
    scene->axis[2] = 1.0;
    scene->time = scene->shutter = 0.0;
    scene->effects = BHR_EFFECT_ALL;
    scene->effect_strengths[0] = scene->effect_strengths[1] = scene->effect_strengths[2] = 1.0;
    scene->view = BHR_VIEW_LIGHT;
    scene->has_disk = scene->has_sky = 1;
    scene->volume_count = scene->hot_spot_count = 0;
    BhrStatus status = bhr_camera_init(&scene->camera, sizeof scene->camera);
    if (status >= 0) {
        status = bhr_disk_init(&scene->disk, sizeof scene->disk);
    }
    if (status >= 0) {
        status = bhr_sky_init(&scene->sky, sizeof scene->sky);
    }
    if (status >= 0) {
        status = bhr_film_init(&scene->film, sizeof scene->film);
    }
    if (status >= 0) {
        status = bhr_quality_init(&scene->quality, sizeof scene->quality);
    }
    return status;
}

void scene_begin(Scene *scene, const SceneOptions *options) {
    scene->mass = options->mass;
    scene->spin = options->spin;
    scene->disk.outer_radius = options->disk_outer;
    scene->disk.turbulence = options->turbulence;
    scene->film.exposure_ev = options->exposure;
    scene->camera.fov_y = options->fov * PI / 180.0;
}

/* Disk, sky, film and effects, as the context has them. */
static BhrStatus read_look(Scene *scene, BhrContext *context) {
    int32_t   present;
    BhrStatus status = bhr_get_disk(context, &scene->disk, &present);
    if (status >= 0) {
        scene->has_disk = present;
        status = bhr_get_sky(context, &scene->sky);
    }
    if (status >= 0) {
        scene->has_sky = 1;
        status = bhr_get_film(context, &scene->film);
    }
    if (status >= 0) {
        status = bhr_get_effects(context, &scene->effects);
    }
    for (int i = 0; i < 3 && status >= 0; i++) {
        status = bhr_get_effect_strength(context, GRADED_EFFECTS[i], &scene->effect_strengths[i]);
    }
    return status;
}

BhrStatus scene_set_preset_with(Scene *scene, BhrContext *context, BhrPreset preset, const BhrPresetOptions *options,
                                BhrPresetMatter *out_matter) {
    BhrStatus status = bhr_set_preset_with(context, preset, options, out_matter);
    if (status >= 0) {
        status = bhr_get_volumes(context, scene->volumes, sizeof(BhrVolume), BHR_MAX_VOLUMES, &scene->volume_count);
    }
    return status >= 0 ? read_look(scene, context) : status;
}

static BhrStatus read_matter(Scene *scene, BhrContext *context) {
    BhrStatus status =
        bhr_get_volumes(context, scene->volumes, sizeof *scene->volumes, BHR_MAX_VOLUMES, &scene->volume_count);
    if (status >= 0) {
        status = bhr_get_hot_spots(context, scene->hot_spots, sizeof *scene->hot_spots, BHR_MAX_HOT_SPOTS,
                                   &scene->hot_spot_count);
    }
    return status;
}

BhrStatus scene_read(Scene *scene, BhrContext *context) {
    BhrStatus status = scene_defaults(scene); /* structs that are read into say their size */
    if (status >= 0) {
        status = bhr_get_hole(context, &scene->mass, &scene->spin, scene->axis);
    }
    if (status >= 0) {
        status = bhr_get_time(context, &scene->time);
    }
    if (status >= 0) {
        status = bhr_get_shutter(context, &scene->shutter);
    }
    if (status >= 0) {
        status = bhr_get_camera(context, &scene->camera);
    }
    if (status >= 0) {
        status = read_matter(scene, context);
    }
    if (status >= 0) {
        status = read_look(scene, context);
    }
    if (status >= 0) {
        status = bhr_get_view(context, &scene->view);
    }
    return status >= 0 ? bhr_get_quality(context, &scene->quality) : status;
}

BhrStatus scene_apply(const Scene *scene, BhrContext *context) {
    BhrStatus status = bhr_set_mass(context, scene->mass);
    if (status >= 0) {
        status = bhr_set_spin(context, scene->spin);
    }
    if (status >= 0) {
        status = bhr_set_axis(context, scene->axis);
    }
    if (status >= 0) {
        status = bhr_set_time(context, scene->time);
    }
    if (status >= 0) {
        status = bhr_set_shutter(context, scene->shutter);
    }
    if (status >= 0) {
        status = bhr_set_camera(context, &scene->camera);
    }
    if (status >= 0) {
        status = bhr_set_disk(context, scene->has_disk ? &scene->disk : NULL);
    }
    if (status >= 0) {
        status = bhr_set_volumes(context, scene->volumes, sizeof *scene->volumes, scene->volume_count);
    }
    if (status >= 0) {
        status = bhr_set_hot_spots(context, scene->hot_spots, sizeof *scene->hot_spots, scene->hot_spot_count);
    }
    if (status >= 0) {
        status = bhr_set_sky(context, scene->has_sky ? &scene->sky : NULL);
    }
    if (status >= 0) {
        status = bhr_set_film(context, &scene->film);
    }
    if (status >= 0) {
        status = bhr_set_effects(context, scene->effects);
    }
    for (int i = 0; i < 3 && status >= 0; i++) {
        status = bhr_set_effect_strength(context, GRADED_EFFECTS[i], scene->effect_strengths[i]);
    }
    if (status >= 0) {
        status = bhr_set_view(context, scene->view);
    }
    if (status >= 0) {
        status = bhr_set_quality(context, &scene->quality);
    }
    return status;
}

BhrStatus scene_copy(const BhrContext *from, BhrContext *to) {
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

void camera_make_orthonormal(BhrCamera *camera) {
    scale(camera->forward, 1.0 / length(camera->forward));
    add(camera->up, -dot(camera->up, camera->forward), camera->forward);
    scale(camera->up, 1.0 / length(camera->up));
}

void camera_turn(BhrCamera *camera, double right, double up) {
    double axis[3];
    rotate(camera->forward, camera->up, -right);
    cross(camera->forward, camera->up, axis);
    rotate(camera->forward, axis, up);
    rotate(camera->up, axis, up);
}

int scene_changes_with_time(const Scene *scene) {
    const int shows_matter = scene->view == BHR_VIEW_LIGHT || scene->view == BHR_VIEW_OPTICAL_DEPTH ||
                             scene->view == BHR_VIEW_INTENSITY;
    int moves = scene->hot_spot_count > 0;
    for (uint32_t i = 0; i < scene->volume_count; i++) {
        moves |= scene->volumes[i].turbulence > 0.0;
    }
    return (scene->has_disk && scene->disk.turbulence > 0.0 && scene->view == BHR_VIEW_LIGHT) ||
           (moves && shows_matter);
}
