/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* scene_options.h -- the options for everything that a scene has, in one table that render_frame and viewer share:
 * each says which of its groups it takes. Knows no window and makes no frame. */
#ifndef EXAMPLES_SCENE_OPTIONS_H
#define EXAMPLES_SCENE_OPTIONS_H

#include "options.h"
#include "scene.h"

/* Groups of options, in the order of --help. */
#define SCENE_PRESET 1u
#define SCENE_HOLE 2u
#define SCENE_PLACE 4u    /* where the camera is */
#define SCENE_CAMERA 8u   /* how it looks and moves */
#define SCENE_LENS 16u    /* the picture's borders as hosts have them */
#define SCENE_EYES 32u    /* 360-degree stereo, which windows do not show */
#define SCENE_DISK 64u
#define SCENE_MATTER 128u /* volumes and hot spots */
#define SCENE_SKY 256u
#define SCENE_FILM 512u
#define SCENE_EFFECTS 1024u
#define SCENE_VIEW 2048u
#define SCENE_QUALITY 4096u
#define ALL_OF_SCENE 8191u

#define MOST_OPTIONS 160u

/* A scene as the command line describes it. */
typedef struct SceneInput {
    Scene       scene;
    int32_t     preset;                        /* BHR_PRESET_* or NO_PRESET */
    BhrPresetOptions preset_options;           /* the preset's matter; THIN, but where a program says otherwise */
    BhrPresetMatter  preset_matter;            /* once finished: whichever it has */
    double      distance, azimuth, elevation;  /* about the hole: in M, degrees */
    double      position[3], forward[3];       /* in M; NaN: by those above, and towards the hole */
    double      time, shutter;                 /* in M */
    double      eye_distance;                  /* in M */
    const char *sky_map;                       /* a file; NULL: none */
    const char *lut;                           /* a .cube file; NULL: none */
    TextList    volumes, hot_spots;            /* as matter.h reads them */
} SceneInput;

/* The options of a program: its own and a scene's. */
typedef struct Options {
    Option list[MOST_OPTIONS];
    size_t count;
} Options;

/* The library's defaults, with a camera 26.12 M from the hole and 5.49 degrees above the disk's plane. Errors: as the
 * library's. */
BhrStatus scene_input_init(SceneInput *input);

/* The camera about the hole, and the look where they differ from the library's, as a program begins. */
void scene_input_begin(SceneInput *input, const SceneOptions *begin);

void options_add(Options *options, const Option *list, size_t count);
void options_add_scene(Options *options, SceneInput *input, unsigned groups);

/* After the options were parsed: gives the context the preset that was asked for and the sky's map, lays the options
 * over the preset, and completes `input->scene`, which scene_apply can then set. 0, or an exit status after a
 * message. */
int scene_input_finish(SceneInput *input, BhrContext *context, const Options *options, int argc, char **argv);

#endif
