/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* scene.h -- everything that a frame of viewer or render_frame shows, as plain values that are copied to try a change
 * and thrown away when bhr refuses it. Knows no window and no input. */
#ifndef EXAMPLES_SCENE_H
#define EXAMPLES_SCENE_H

#include "common.h"

#include <bhr.h>

#define NO_PRESET (-1) /* none of BHR_PRESET_* */

typedef struct Scene {
    double     mass; /* scene lengths */
    double     spin; /* a / M */
    double     axis[3];
    double     time, shutter; /* scene lengths */
    BhrCamera  camera;
    BhrDisk    disk;
    int        has_disk;
    BhrVolume  volumes[BHR_MAX_VOLUMES];
    uint32_t   volume_count;
    BhrHotSpot hot_spots[BHR_MAX_HOT_SPOTS];
    uint32_t   hot_spot_count;
    BhrSky     sky;
    int        has_sky;
    BhrFilm    film;
    uint32_t   effects; /* BHR_EFFECT_* */
    double     effect_strengths[3]; /* of GRADED_EFFECTS in scene.c */
    BhrView    view;
    BhrQuality quality;
} Scene;

/* A scene that a program begins with, where it differs from the library's. Lengths in units of M, angles in degrees. */
typedef struct SceneOptions {
    double mass, spin;
    double distance, azimuth, elevation, fov;
    double disk_outer, turbulence, exposure;
} SceneOptions;

extern const SceneOptions SCENE_DEFAULTS;

/* The library's defaults. Errors: as the library's. */
BhrStatus scene_defaults(Scene *scene);

/* Lays a program's beginning over them, without the camera's place. */
void scene_begin(Scene *scene, const SceneOptions *options);

/* The look of a preset, disk, volumes, sky, film and effects, as the context has it then: `options` ask for its matter
 * (bhr_set_preset_with); *out_matter is THIN or DEEP. Errors: as the library's. */
BhrStatus scene_set_preset_with(Scene *scene, BhrContext *context, BhrPreset preset, const BhrPresetOptions *options,
                                BhrPresetMatter *out_matter);

/* All of it as the context has it. Errors: as the library's. */
BhrStatus scene_read(Scene *scene, BhrContext *context);

/* Sets all of it in a context; at the first failure stops and returns it. What was the same before costs nothing. */
BhrStatus scene_apply(const Scene *scene, BhrContext *context);

/* Gives one context the scene of another, with its map of the sky and its LUT, as text: what moves in that is as it
 * begins. Errors: as the library's. */
BhrStatus scene_copy(const BhrContext *from, BhrContext *to);

/* Makes forward and up unit vectors, up turned until it stands on forward. */
void camera_make_orthonormal(BhrCamera *camera);

/* Turns the look of an orthonormal camera to the right, then upwards; radians. */
void camera_turn(BhrCamera *camera, double right, double up);

/* Whether frames differ while time goes by and the camera stands still. */
int scene_changes_with_time(const Scene *scene);

#endif
