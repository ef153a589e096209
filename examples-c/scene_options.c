/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* scene_options.c -- see scene_options.h. */
#include "scene_options.h"

#include "fields.h"
#include "matter.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const Choice EFFECTS[] = {{"doppler", BHR_EFFECT_DOPPLER_SHIFT}, {"gravity", BHR_EFFECT_GRAVITY_SHIFT},
                                 {"beaming", BHR_EFFECT_BEAMING}, {"delay", BHR_EFFECT_LIGHT_DELAY}, {NULL, 0}};

/* ---- the tables ---- */

typedef struct SceneOption {
    const char   *name;
    unsigned      group;
    OptionKind    kind;
    size_t        offset; /* of what it sets, in SceneInput */
    const char   *value, *range;
    const char   *help;
    const Choice *choices;
} SceneOption;

#define AT(member) offsetof(SceneInput, member)

/* Options that are no field of a struct, or not only. */
static const SceneOption TABLE[] = {
    {"--preset", SCENE_PRESET, OPTION_CHOICE, AT(preset), NULL, NULL, "a look; other options change it", PRESETS},
    {"--matter", SCENE_PRESET, OPTION_CHOICE, AT(preset_options.matter), NULL, NULL,
     "of the preset: a thin disk, a volume, or the volume where it is fast", PRESET_MATTERS},

    {"--mass", SCENE_HOLE, OPTION_DOUBLE, AT(scene.mass), "M", "above 0", "in scene lengths: the scale", NULL},
    {"--spin", SCENE_HOLE, OPTION_DOUBLE, AT(scene.spin), "A", "-0.9999 to 0.9999", "a / M", NULL},
    {"--axis", SCENE_HOLE, OPTION_VECTOR, AT(scene.axis), "X,Y,Z", NULL, "the spin's direction", NULL},

    {"--distance", SCENE_PLACE, OPTION_DOUBLE, AT(distance), "R", "above 0", "the camera's radius in M", NULL},
    {"--azimuth", SCENE_PLACE, OPTION_DOUBLE, AT(azimuth), "DEG", NULL, "the camera's, about +z", NULL},
    {"--elevation", SCENE_PLACE, OPTION_DOUBLE, AT(elevation), "DEG", "-90 to 90", "of the camera above z = 0", NULL},
    {"--position", SCENE_PLACE, OPTION_VECTOR, AT(position), "X,Y,Z", NULL, "of the camera in M, instead of these",
     NULL},
    {"--forward", SCENE_PLACE, OPTION_VECTOR, AT(forward), "X,Y,Z", NULL, "where it looks, instead of at the hole",
     NULL},
    {"--up", SCENE_PLACE, OPTION_VECTOR, AT(scene.camera.up), "X,Y,Z", NULL, "what is up in the picture", NULL},
    {"--velocity", SCENE_PLACE, OPTION_VECTOR, AT(scene.camera.velocity), "X,Y,Z", "length below 1",
     "v / c, for --motion velocity", NULL},
    {"--motion", SCENE_CAMERA, OPTION_CHOICE, AT(scene.camera.motion), NULL, NULL, "of the camera", MOTIONS},
    {"--fov", SCENE_CAMERA, OPTION_DEGREES, AT(scene.camera.fov_y), "DEG", "below 180; fisheye: to 360",
     "vertical field of view; fisheye: across", NULL},
    {"--projection", SCENE_CAMERA, OPTION_CHOICE, AT(scene.camera.projection), NULL, NULL,
     "equirect: W = 2 H; cube: W = 6 H", PROJECTIONS},
    {"--frustum", SCENE_LENS, OPTION_FOUR, AT(scene.camera.tan_left), "L,R,D,U", "L below R, D below U",
     "tangents of the picture's left, right, lower and upper border, for --projection frustum", NULL},
    {"--jitter", SCENE_LENS, OPTION_PAIR, AT(scene.camera.jitter), "X,Y", "-1 to 1",
     "pixels by which a flat picture moves to the right and down", NULL},
    {"--eye", SCENE_EYES, OPTION_CHOICE, AT(scene.camera.eye), NULL, NULL,
     "for --projection equirect and --bloom 0: that of a pair for 360-degree stereo", EYES},
    {"--eye-distance", SCENE_EYES, OPTION_DOUBLE, AT(eye_distance), "X", "from 0 on",
     "of the two eyes in M, for --eye; 0: no stereo", NULL},

    {"--no-disk", SCENE_DISK, OPTION_UNFLAG, AT(scene.has_disk), NULL, NULL, "leaves the disk out", NULL},
    {"--time", SCENE_DISK, OPTION_DOUBLE, AT(time), "T", NULL, "in M; turns the disk's structure", NULL},
    {"--shutter", SCENE_DISK, OPTION_DOUBLE, AT(shutter), "T", NULL,
     "in M: how long the shutter is open; matter that moves is blurred, with a moment for each sample", NULL},

    {"--volume", SCENE_MATTER, OPTION_TEXTS, AT(volumes), VOLUME_VALUE, "4 of them",
     "matter with depth: disk, torus, halo or jet, then fields as BhrVolume has them, with - for _, degrees and R/G/B "
     "(disk,help lists them); torus,radius=9,infall=0.2,power-law", NULL},
    {"--hot-spot", SCENE_MATTER, OPTION_TEXTS, AT(hot_spots), HOT_SPOT_VALUE, "8 of them",
     "a blob in orbit: fields as BhrHotSpot has them (help lists them); radius=7,size=0.7,azimuth=90", NULL},

    {"--no-stars", SCENE_SKY, OPTION_UNFLAG, AT(scene.has_sky), NULL, NULL, "makes the sky black", NULL},
    {"--sky-map", SCENE_SKY, OPTION_TEXT, AT(sky_map), "FILE", NULL, "a picture of the whole sky, .png .ppm .exr",
     NULL},

    {"--lut", SCENE_FILM, OPTION_TEXT, AT(lut), "FILE", NULL, "a 3D LUT for the picture's colours, .cube", NULL},

    {"--effects", SCENE_EFFECTS, OPTION_BITS, AT(scene.effects), NULL, NULL, "effects of relativity on light",
     EFFECTS},
    {"--effect-strengths", SCENE_EFFECTS, OPTION_VECTOR, AT(scene.effect_strengths), "D,G,B", "0 to 1 each",
     "how strongly the Doppler shift, gravity's shift and beaming show", NULL},

    {"--view", SCENE_VIEW, OPTION_CHOICE, AT(scene.view), NULL, NULL, "what a pixel shows", VIEWS},
};

/* The structs whose fields are options, by the fields' names and with the first sentence that bhr.h says of each. */
static const struct {
    unsigned     group;
    size_t       offset; /* of the struct, in SceneInput */
    const Field *fields;
    const char  *note; /* behind their help; NULL: none */
} STRUCTS[] = {
    {SCENE_DISK, AT(scene.disk), DISK_FIELDS, NULL},
    {SCENE_SKY, AT(scene.sky), SKY_FIELDS, NULL},
    {SCENE_FILM, AT(scene.film), FILM_FIELDS, "8-bit files only"},
    {SCENE_QUALITY, AT(scene.quality), QUALITY_FIELDS, NULL},
};

/* Fields whose names would not say, on a command line, what has them; and shorter names. */
static const struct {
    const Field *fields;
    const char  *option, *name; /* NULL: no option */
    const char  *help;          /* NULL: bhr.h's sentence */
} RENAMED[] = {
    {DISK_FIELDS, "--retrograde", "--retrograde", "the disk turns towards -azimuth"},
    {DISK_FIELDS, "--plunges", "--plunges", "the disk shines to the horizon"},
    {DISK_FIELDS, "--inner-radius", "--disk-inner", "in M; 0: the innermost stable orbit or the horizon"},
    {DISK_FIELDS, "--outer-radius", "--disk-outer", NULL},
    {DISK_FIELDS, "--temperature", "--disk-temperature", NULL},
    {DISK_FIELDS, "--brightness", "--disk-brightness", "luminance of that ring"},
    {DISK_FIELDS, "--opacity", "--opacity", "of the disk"},
    {DISK_FIELDS, "--reference", "--disk-reference", NULL},
    {SKY_FIELDS, "--flags", "--sky", "what is at infinity"},
    {SKY_FIELDS, "--orientation", "--sky-orientation", NULL},
    {SKY_FIELDS, "--seed", "--sky-seed", NULL},
    {FILM_FIELDS, "--exposure-ev", "--exposure", NULL},
    {FILM_FIELDS, "--beam-fwhm", "--beam", NULL},
    {QUALITY_FIELDS, "--samples-per-pixel", "--samples", NULL},
    {QUALITY_FIELDS, "--max-disk-order", "--max-order", NULL},
    {QUALITY_FIELDS, "--render-scale", NULL, NULL}, /* for windows */
};

void options_add(Options *options, const Option *list, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (options->count == MOST_OPTIONS) { /* a mistake in this program, not in its command line */
            fprintf(stderr, "there are more than %u options: MOST_OPTIONS is too small\n", MOST_OPTIONS);
            exit(2);
        }
        options->list[options->count++] = list[i];
    }
}

/* The value of a field, as --help calls it. */
static const char *value_name(const Field *field) {
    switch (field->kind) {
    case OPTION_DEGREES:
        return "DEG";
    case OPTION_PAIR:
        return "X,Y";
    case OPTION_VECTOR:
        return "X,Y,Z";
    case OPTION_FOUR:
        return "X,Y,Z,W";
    case OPTION_UINT:
    case OPTION_UINT64:
        return "N";
    default:
        return field->unit != NULL && strlen(field->unit) <= 2 ? field->unit : "X";
    }
}

static void add_field(Options *options, const Field *fields, const Field *field, char *target, const char *note) {
    const char *name = field->option, *help = field->about;
    for (size_t i = 0; i < COUNT_OF(RENAMED); i++) {
        if (RENAMED[i].fields == fields && strcmp(RENAMED[i].option, field->option) == 0) {
            name = RENAMED[i].name;
            help = RENAMED[i].help != NULL ? RENAMED[i].help : help;
        }
    }
    if (name != NULL) {
        /* The header's sentences often name the range themselves. */
        const char  *range = strstr(help, " .. ") == NULL && field->range != NULL ? field->range : note;
        const Option option = {name, field->kind, target + field->offset, value_name(field), help, field->choices,
                               range};
        options_add(options, &option, 1);
    }
}

void options_add_scene(Options *options, SceneInput *input, unsigned groups) {
    for (unsigned group = 1; group <= ALL_OF_SCENE; group <<= 1) {
        for (size_t i = 0; i < COUNT_OF(TABLE); i++) {
            const SceneOption *row = &TABLE[i];
            if (row->group & group & groups) {
                const Option option = {row->name, row->kind, (char *)input + row->offset, row->value, row->help,
                                       row->choices, row->range};
                options_add(options, &option, 1);
            }
        }
        for (size_t i = 0; i < COUNT_OF(STRUCTS); i++) {
            const Field *field = STRUCTS[i].group & group & groups ? STRUCTS[i].fields : NULL;
            for (; field != NULL && field->option != NULL; field++) {
                add_field(options, STRUCTS[i].fields, field, (char *)input + STRUCTS[i].offset, STRUCTS[i].note);
            }
        }
    }
}

/* ---- from options to a scene ---- */

BhrStatus scene_input_init(SceneInput *input) {
    memset(input, 0, sizeof *input);
    input->preset = NO_PRESET;
    input->distance = SCENE_DEFAULTS.distance;
    input->azimuth = SCENE_DEFAULTS.azimuth;
    input->elevation = SCENE_DEFAULTS.elevation;
    for (int i = 0; i < 3; i++) {
        input->position[i] = input->forward[i] = NAN;
    }
    const BhrStatus status = bhr_preset_options_init(&input->preset_options, sizeof input->preset_options);
    input->preset_options.matter = BHR_PRESET_MATTER_THIN;
    return status >= 0 ? scene_defaults(&input->scene) : status;
}

void scene_input_begin(SceneInput *input, const SceneOptions *begin) {
    input->distance = begin->distance;
    input->azimuth = begin->azimuth;
    input->elevation = begin->elevation;
    scene_begin(&input->scene, begin);
}

static BhrStatus set_map(Scene *scene, BhrContext *context, const char *path) {
    BhrImage  map;
    BhrStatus status = bhr_image_init(&map, sizeof map);
    if (status >= 0) {
        status = bhr_image_load(path, &map);
    }
    if (status >= 0) {
        status = bhr_set_sky_map(context, &map);
        bhr_image_release(&map);
        scene->sky.flags |= BHR_SKY_MAP;
    }
    return status;
}

static BhrStatus place_camera(SceneInput *input) {
    BhrCamera *camera = &input->scene.camera;
    double     up[3];
    memcpy(up, camera->up, sizeof up);
    BhrStatus status = bhr_camera_orbit(camera, input->distance * input->scene.mass, input->azimuth * PI / 180.0,
                                        input->elevation * PI / 180.0);
    const int placed = !isnan(input->position[0]), turned = !isnan(input->forward[0]);
    for (int i = 0; i < 3; i++) {
        if (placed) {
            camera->position[i] = input->position[i] * input->scene.mass;
            camera->forward[i] = -camera->position[i];
        }
        if (turned) {
            camera->forward[i] = input->forward[i];
        }
        if (placed || turned || up[0] != 0.0 || up[1] != 0.0) {
            camera->up[i] = up[i];
        }
    }
    return status;
}

/* 0, or an exit status after a message. */
static int read_matter(SceneInput *input, const char *program) {
    char      name[128];
    Scene    *scene = &input->scene;
    snprintf(name, sizeof name, "%.100s: --volume", program);
    /* Without the option the preset's volumes stay. */
    const int result = input->volumes.count == 0 ? 0
                                                 : volumes_read(name, &input->volumes, 1.0, scene->volumes,
                                                                BHR_MAX_VOLUMES, &scene->volume_count);
    snprintf(name, sizeof name, "%.100s: --hot-spot", program);
    return result != 0 ? result
                       : hot_spots_read(name, &input->hot_spots, scene->hot_spots, BHR_MAX_HOT_SPOTS,
                                        &scene->hot_spot_count);
}

int scene_input_finish(SceneInput *input, BhrContext *context, const Options *options, int argc, char **argv) {
    BhrStatus status = BHR_OK;
    if (input->preset != NO_PRESET) {
        status = scene_set_preset_with(&input->scene, context, input->preset, &input->preset_options,
                                       &input->preset_matter);
        if (status < 0) {
            return report_failure("set the preset", status);
        }
        /* The options once more, over the preset. */
        input->volumes.count = input->hot_spots.count = 0;
        const int result = options_parse(options->list, options->count, argc, argv);
        if (result != 0) {
            return result;
        }
    }
    const int result = read_matter(input, argv[0]);
    if (result != 0) {
        return result;
    }
    if (input->sky_map != NULL) {
        status = set_map(&input->scene, context, input->sky_map);
    }
    if (status >= 0 && input->lut != NULL) {
        status = bhr_set_film_lut_file(context, input->lut);
    }
    if (status >= 0) {
        input->scene.time = input->time * input->scene.mass;
        input->scene.shutter = input->shutter * input->scene.mass;
        input->scene.camera.eye_distance = input->eye_distance * input->scene.mass;
        status = place_camera(input);
    }
    return status < 0 ? report_failure("set the scene", status) : 0;
}
