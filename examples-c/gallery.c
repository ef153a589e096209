/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gallery.c -- named scenes into PNG files, and a contact sheet of them: what the renderer can show, each in a few
 * lines. Lengths are in units of the hole's mass M, angles in degrees. */
#include "matter.h"
#include "options.h"
#include "picture.h"
#include "scene.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHEET "contact-sheet.png"
#define SHEET_COLUMNS 4u
#define SHEET_MARGIN 8u
#define LEAST_CELL 132u    /* pixels across: the longest name */
#define MOST_CELL 208u
#define SHEET_GREY 40      /* of 255 */
#define LEAST_WIDTH 16u    /* of a picture: of shape 16 : 9 that is 9 rows */
#define MOST_WIDTH 16384u

/* ---- parts of scenes ---- */

/* The scenes begin with this. */
static const SceneOptions BEGINNING = {
    .mass = 1.0,
    .distance = 30.0,
    .azimuth = -90.0,
    .elevation = 6.0,
    .fov = 50.0,
    .disk_outer = 17.0,
    .turbulence = 1.0,
    .exposure = 0.0,
};

/* Puts the camera there, looking at the hole. */
static BhrStatus stand(Scene *scene, double distance, double azimuth, double elevation, double fov) {
    scene->camera.fov_y = fov * PI / 180.0;
    return bhr_camera_orbit(&scene->camera, distance, azimuth * PI / 180.0, elevation * PI / 180.0);
}

static void dome(Scene *scene, double angle) {
    scene->camera.projection = BHR_PROJECTION_FISHEYE;
    scene->camera.fov_y = angle * PI / 180.0;
}

/* Turns the look away from the hole. */
static void turn(Scene *scene, double right, double up) {
    camera_make_orthonormal(&scene->camera);
    camera_turn(&scene->camera, right * PI / 180.0, up * PI / 180.0);
}

/* Puts the hole, seen from `distance`, in front of a place of the real sky, north up: sky axes are scene axes. */
static void stand_before(Scene *scene, double right_ascension, double declination, double distance, double fov) {
    const double ra = right_ascension * PI / 180.0, dec = declination * PI / 180.0;
    const double place[3] = {cos(dec) * cos(ra), cos(dec) * sin(ra), sin(dec)};
    for (int i = 0; i < 3; i++) {
        scene->camera.position[i] = -distance * place[i];
        scene->camera.forward[i] = place[i];
    }
    scene->camera.up[0] = scene->camera.up[1] = 0.0;
    scene->camera.up[2] = 1.0;
    scene->camera.fov_y = fov * PI / 180.0;
}

/* Matter with depth instead of the thin disk, or beside it: one volume more. NULL after an error, and *status is it. */
static BhrVolume *add_volume(Scene *scene, BhrVolumeShape kind, BhrStatus *status) {
    BhrVolume *volume = &scene->volumes[scene->volume_count];
    *status = volume_begin(volume, kind);
    scene->volume_count += *status >= 0;
    return *status >= 0 ? volume : NULL;
}

static BhrHotSpot *add_hot_spot(Scene *scene, double radius, double size, double azimuth, BhrStatus *status) {
    BhrHotSpot *spot = &scene->hot_spots[scene->hot_spot_count];
    *status = bhr_hot_spot_init(spot, sizeof *spot);
    if (*status < 0) {
        return NULL;
    }
    scene->hot_spot_count++;
    spot->radius = radius;
    spot->size = size;
    spot->azimuth = azimuth * PI / 180.0;
    return spot;
}

/* Matter whose receding side is dim: a softer tone curve, more light, and the sky as dark as it was. */
static void expose(Scene *scene, double stops) {
    scene->film.tone_map = BHR_TONE_MAP_AGX;
    scene->film.exposure_ev = stops;
    scene->sky.stars_brightness *= pow(2.0, -stops);
    scene->sky.map_brightness *= pow(2.0, -stops);
}

static void set_colour(double tint[3], double r, double g, double b) {
    tint[0] = r;
    tint[1] = g;
    tint[2] = b;
}

/* ---- the scenes ---- */

/* The scene of a new context. */
static BhrStatus cinematic(Scene *scene) {
    return bhr_camera_init(&scene->camera, sizeof scene->camera);
}

static BhrStatus physical(Scene *scene) {
    scene->spin = 0.9;
    scene->disk.emission_law = BHR_DISK_LIMB_DARKENED;
    return stand(scene, 44.0, 90.0, 14.0, 46.0);
}

/* The hole of M87 is seen from 17 degrees off the disk's axis; the preset's beam is made for this distance. */
static BhrStatus observatory(Scene *scene) {
    scene->spin = 0.9;
    return stand(scene, 30.0, 160.0, 73.0, 60.0);
}

static BhrStatus teaching(Scene *scene) {
    scene->spin = 0.6;
    return stand(scene, 26.0, 90.0, 12.0, 50.0);
}

static BhrStatus schwarzschild_edge_on(Scene *scene) {
    return stand(scene, 30.0, 110.0, 4.0, 45.0);
}

static BhrStatus schwarzschild_face_on(Scene *scene) {
    return stand(scene, 36.0, -90.0, 88.0, 60.0);
}

static BhrStatus kerr(Scene *scene) {
    scene->spin = 0.998;
    scene->film.exposure_ev = -0.5;
    scene->disk.brightness = 0.15; /* the disk reaches so far in that its middle outshines the rest */
    return stand(scene, 32.0, 75.0, 9.0, 42.0);
}

static BhrStatus translucent(Scene *scene) {
    scene->spin = 0.9;
    scene->disk.opacity = 0.5;
    scene->disk.temperature = 4500.0;
    return stand(scene, 30.0, -90.0, 20.0, 45.0);
}

/* Between Orion's belt and his shoulders. From there the Einstein ring is sqrt(4 M / distance) wide. */
static const double ORION[2] = {83.0, 1.0};

static BhrStatus orion(Scene *scene) {
    scene->has_disk = 0;
    scene->film.exposure_ev = 2.0;
    stand_before(scene, ORION[0], ORION[1], 1e9, 34.0); /* from so far the hole bends nothing that shows */
    return BHR_OK;
}

static BhrStatus einstein_ring(Scene *scene) {
    scene->has_disk = 0;
    scene->film.exposure_ev = 2.0;
    stand_before(scene, ORION[0], ORION[1], 100.0, 34.0);
    return BHR_OK;
}

/* The Milky Way's middle becomes a ring. */
static BhrStatus galactic_centre(Scene *scene) {
    scene->has_disk = 0;
    scene->film.exposure_ev = 0.5;
    stand_before(scene, 266.4, -28.9, 40.0, 60.0);
    return BHR_OK;
}

static BhrStatus fall(Scene *scene, double radius) {
    scene->film.exposure_ev = -1.5; /* ahead all light is bluer and brighter */
    scene->camera.motion = BHR_MOTION_FREE_FALL;
    return stand(scene, radius, -90.0, 25.0, 110.0);
}

static BhrStatus fall_4(Scene *scene) {
    return fall(scene, 4.0);
}

static BhrStatus fall_2_5(Scene *scene) {
    return fall(scene, 2.5);
}

static BhrStatus fall_1_5(Scene *scene) {
    return fall(scene, 1.5);
}

static BhrStatus orbiting_observer(Scene *scene) {
    scene->camera.motion = BHR_MOTION_ORBIT;
    BhrStatus status = stand(scene, 7.0, -90.0, 20.0, 95.0);
    turn(scene, 45.0, 0.0); /* between the hole and where the way leads */
    return status;
}

static BhrStatus dome_master(Scene *scene) {
    scene->film.exposure_ev = -0.5;
    BhrStatus status = stand(scene, 12.0, -90.0, 30.0, 60.0);
    turn(scene, 0.0, 40.0);
    dome(scene, 180.0);
    return status;
}

static BhrStatus equirect(Scene *scene) {
    scene->film.exposure_ev = -0.5;
    scene->camera.projection = BHR_PROJECTION_EQUIRECT;
    return stand(scene, 15.0, -90.0, 25.0, 60.0);
}

static BhrStatus cube(Scene *scene) {
    scene->film.exposure_ev = -0.5;
    scene->camera.projection = BHR_PROJECTION_CUBE;
    return stand(scene, 15.0, -90.0, 25.0, 60.0);
}

static BhrStatus grid(Scene *scene) {
    scene->has_disk = 0;
    scene->sky.flags = BHR_SKY_GRID | BHR_SKY_PROCEDURAL | BHR_SKY_MILKY_WAY;
    scene->sky.seed = 5;
    return stand(scene, 20.0, -90.0, 20.0, 80.0);
}

/* A disk of a twentieth of its radius, dense but not hard: the library's default volume. */
static BhrStatus soft_disk(Scene *scene) {
    BhrStatus status;
    scene->has_disk = 0;
    scene->spin = 0.6;
    if (add_volume(scene, BHR_VOLUME_DISK, &status) == NULL) {
        return status;
    }
    expose(scene, 1.5);
    return stand(scene, 28.0, 75.0, 6.5, 37.6);
}

/* So thin that the shadow and all rings shine through it, and thick as a torus. */
static BhrStatus torus(Scene *scene) {
    BhrStatus  status;
    BhrVolume *volume = add_volume(scene, BHR_VOLUME_DISK, &status);
    if (volume == NULL) {
        return status;
    }
    scene->has_disk = 0;
    scene->spin = 0.9;
    volume->thickness = 0.14;
    volume->absorption = 0.3;
    volume->inner_radius = 2.55;
    volume->slope = 0.9;
    volume->temperature = 5400.0;
    expose(scene, 2.5);
    return stand(scene, 30.0, 75.0, 10.0, 39.6);
}

/* Thin matter all about the hole, as in the models of Sgr A*. */
static BhrStatus halo(Scene *scene) {
    BhrStatus  status;
    BhrVolume *volume = add_volume(scene, BHR_VOLUME_HALO, &status);
    if (volume == NULL) {
        return status;
    }
    scene->has_disk = 0;
    scene->spin = 0.9;
    volume->flags = BHR_VOLUME_POWER_LAW;
    volume->radius = 6.0;
    volume->thickness = 0.45;
    volume->absorption = 0.05;
    volume->spectral_index = 0.5;
    volume->brightness = 0.05;
    set_colour(volume->tint, 1.0, 0.42, 0.13);
    return stand(scene, 30.0, 75.0, 28.0, 48.0);
}

/* Two cones that a soft disk feeds: the near one is brightened by its motion. */
static BhrStatus jet(Scene *scene) {
    BhrStatus  status;
    BhrVolume *disk = add_volume(scene, BHR_VOLUME_DISK, &status);
    BhrVolume *volume = disk != NULL ? add_volume(scene, BHR_VOLUME_JET, &status) : NULL;
    if (volume == NULL) {
        return status;
    }
    scene->has_disk = 0;
    scene->spin = 0.9;
    disk->thickness = 0.08;
    disk->absorption = 1.0;
    volume->flags = BHR_VOLUME_POWER_LAW;
    volume->outer_radius = 60.0;
    volume->absorption = 0.002;
    volume->spectral_index = 0.7;
    volume->brightness = 0.15;
    volume->speed = 0.8;
    expose(scene, 1.5);
    set_colour(volume->tint, 0.45, 0.65, 1.0);
    return stand(scene, 50.0, 75.0, 22.0, 52.0);
}

/* The flare of a spot that approaches: its second image is beside the shadow. */
static BhrStatus hot_spot(Scene *scene) {
    BhrStatus   status;
    BhrVolume  *disk = add_volume(scene, BHR_VOLUME_DISK, &status);
    BhrHotSpot *spot = disk != NULL ? add_hot_spot(scene, 7.0, 0.7, 20.0, &status) : NULL;
    if (spot == NULL) {
        return status;
    }
    scene->has_disk = 0;
    scene->spin = 0.6;
    disk->thickness = 0.08;
    disk->absorption = 0.6;
    disk->brightness = 0.5;
    spot->brightness = 1.5;
    expose(scene, 1.5);
    set_colour(spot->tint, 1.0, 0.75, 0.45);
    return stand(scene, 28.0, 75.0, 25.0, 42.0);
}

/* The eye in the matter: mist before the shadow, light all around. */
static BhrStatus inside_the_torus(Scene *scene) {
    BhrStatus  status;
    BhrVolume *volume = add_volume(scene, BHR_VOLUME_TORUS, &status);
    if (volume == NULL) {
        return status;
    }
    scene->has_disk = 0;
    scene->spin = 0.9;
    volume->radius = 9.0;
    volume->width = 2.5;
    volume->thickness = 0.2;
    volume->absorption = 0.07;
    scene->film.exposure_ev = -1.5;
    status = stand(scene, 10.5, 75.0, 12.0, 85.0);
    turn(scene, 25.0, 0.0); /* towards the side that recedes, which is not so bright */
    return status;
}

/* The views of one scene, whose disk is opaque: false colour is legible without stars behind it. */
static BhrStatus view(Scene *scene, BhrView which) {
    scene->disk.edge_softness = 0.0;
    scene->view = which;
    scene->spin = 0.9;
    return stand(scene, 30.0, -90.0, 12.0, 45.0);
}

static BhrStatus view_redshift(Scene *scene) {
    return view(scene, BHR_VIEW_REDSHIFT);
}

static BhrStatus view_order(Scene *scene) {
    return view(scene, BHR_VIEW_ORDER);
}

static BhrStatus view_deflection(Scene *scene) {
    return view(scene, BHR_VIEW_DEFLECTION);
}

static BhrStatus view_steps(Scene *scene) {
    scene->quality.method = BHR_METHOD_RK4; /* AUTO looks most pixels up in tables, without a step */
    return view(scene, BHR_VIEW_STEPS);
}

static BhrStatus view_metric(Scene *scene) {
    return view(scene, BHR_VIEW_METRIC);
}

typedef struct Exhibit {
    const char *name;
    const char *about;
    uint32_t    shape[2]; /* width : height */
    BhrPreset   look;     /* that the scene begins with */
    BhrStatus (*describe)(Scene *scene);
} Exhibit;

#define CINEMATIC BHR_PRESET_CINEMATIC

static const Exhibit EXHIBITS[] = {
    {"cinematic", "what the library shows first: the look of a film", {16, 9}, CINEMATIC, cinematic},
    {"physical", "spin 0.9, a smooth and limb-darkened disk, no glare, no tone curve",
     {16, 9}, BHR_PRESET_PHYSICAL, physical},
    {"observatory", "as the Event Horizon Telescope would show it",
     {16, 9}, BHR_PRESET_OBSERVATORY, observatory},
    {"teaching", "colours that are frequency shifts, and a grid on the sky",
     {16, 9}, BHR_PRESET_TEACHING, teaching},
    {"schwarzschild-edge-on", "no spin, from 4 degrees above the disk's plane",
     {16, 9}, CINEMATIC, schwarzschild_edge_on},
    {"schwarzschild-face-on", "no spin, from near the axis", {16, 9}, CINEMATIC, schwarzschild_face_on},
    {"kerr-0.998", "the fastest hole that accretion makes: the disk reaches in to 1.24 M",
     {16, 9}, CINEMATIC, kerr},
    {"translucent", "a thin disk: the images of all orders through each other",
     {16, 9}, CINEMATIC, translucent},
    {"orion", "the constellation with no hole before it", {16, 9}, CINEMATIC, orion},
    {"einstein-ring", "the same, with a hole 100 M away before its centre", {16, 9}, CINEMATIC, einstein_ring},
    {"galactic-centre", "the middle of the Milky Way behind a hole", {16, 9}, CINEMATIC, galactic_centre},
    {"grid", "the coordinates of a random sky: all of them again within the Einstein ring",
     {16, 9}, CINEMATIC, grid},
    {"fall-4", "free fall, at r = 4 M, looking in", {16, 9}, CINEMATIC, fall_4},
    {"fall-2.5", "free fall, at r = 2.5 M", {16, 9}, CINEMATIC, fall_2_5},
    {"fall-1.5", "free fall, inside the horizon, at r = 1.5 M", {16, 9}, CINEMATIC, fall_1_5},
    {"orbiting-observer", "in orbit at r = 7 M, at 0.45 of the speed of light",
     {16, 9}, CINEMATIC, orbiting_observer},
    {"dome-master", "half the sky for a planetarium", {1, 1}, CINEMATIC, dome_master},
    {"equirect", "the whole sky, 360 x 180 degrees", {2, 1}, CINEMATIC, equirect},
    {"cube", "the whole sky as the faces of a cube: right left up down front back", {6, 1}, CINEMATIC, cube},
    {"soft-disk", "a disk with depth: soft edges, mist before the shadow", {16, 9}, CINEMATIC, soft_disk},
    {"torus", "thick and thin matter: the shadow and its rings shine through", {16, 9}, CINEMATIC, torus},
    {"halo", "thin matter all about the hole", {16, 9}, CINEMATIC, halo},
    {"jet", "two cones of matter that flows out, above a soft disk", {16, 9}, CINEMATIC, jet},
    {"hot-spot", "a glowing spot in orbit, and its second image", {16, 9}, CINEMATIC, hot_spot},
    {"inside-the-torus", "the same matter from within", {16, 9}, CINEMATIC, inside_the_torus},
    {"view-redshift", "false colour: frequency here over frequency there", {16, 9}, CINEMATIC, view_redshift},
    {"view-order", "false colour: which image of the disk", {16, 9}, CINEMATIC, view_order},
    {"view-deflection", "false colour: how far the light was bent", {16, 9}, CINEMATIC, view_deflection},
    {"view-steps", "false colour: integration steps per pixel", {16, 9}, CINEMATIC, view_steps},
    {"view-metric", "false colour: -g_tt where the light met the disk's plane",
     {16, 9}, CINEMATIC, view_metric},
};

/* ---- the contact sheet ---- */

typedef struct Sheet {
    BhrImage image;
    uint32_t cell[2];  /* room for a picture; its name is below */
    uint32_t shown;    /* pictures so far */
} Sheet;

/* 1, or 0 after a message. */
static int sheet_begin(Sheet *sheet, uint32_t width) {
    const uint32_t rows = ((uint32_t)COUNT_OF(EXHIBITS) + SHEET_COLUMNS - 1) / SHEET_COLUMNS;
    sheet->cell[0] = width < LEAST_CELL ? LEAST_CELL : width > MOST_CELL ? MOST_CELL : width;
    sheet->cell[1] = sheet->cell[0] * 9 / 16;
    sheet->shown = 0;
    if (!picture_allocate(&sheet->image, BHR_FORMAT_RGBA8_SRGB,
                          SHEET_COLUMNS * (sheet->cell[0] + SHEET_MARGIN) + SHEET_MARGIN,
                          rows * (sheet->cell[1] + SHEET_MARGIN + 2 * CELL_HEIGHT) + SHEET_MARGIN)) {
        return 0;
    }
    picture_fill(&sheet->image, SHEET_GREY);
    return 1;
}

/* The largest picture of its shape in the middle of the next cell, and its name below. */
static void sheet_add(Sheet *sheet, const BhrImage *picture, const char *name) {
    const uint32_t *cell = sheet->cell;
    uint32_t        x = SHEET_MARGIN + sheet->shown % SHEET_COLUMNS * (cell[0] + SHEET_MARGIN);
    uint32_t        y = SHEET_MARGIN + sheet->shown / SHEET_COLUMNS * (cell[1] + SHEET_MARGIN + 2 * CELL_HEIGHT);
    uint32_t        width = cell[0], height = cell[0] * picture->height / picture->width;
    if (height > cell[1]) {
        width = cell[1] * picture->width / picture->height;
        height = cell[1];
    }
    picture_scale(picture, &sheet->image, x + (cell[0] - width) / 2, y + (cell[1] - height) / 2, width, height);
    uint32_t text = CELL_WIDTH * (uint32_t)strlen(name);
    x += text < cell[0] ? (cell[0] - text) / 2 : 0;
    picture_write(&sheet->image, x, y + cell[1] + CELL_HEIGHT / 2, 1, name);
    sheet->shown++;
}

/* ---- pictures ---- */

typedef struct Settings {
    const char *output;
    const char *only; /* NULL: all scenes */
    uint32_t    width, samples;
    int32_t     backend, preset; /* BHR_PRESET_*; NO_PRESET: each scene's own look */
    int         list, help;
} Settings;

/* 1, or 0 after a message. */
static int set_scene(BhrContext *context, const Settings *s, const Exhibit *exhibit) {
    Scene     scene;
    BhrStatus status = scene_init(&scene, &BEGINNING);
    if (status >= 0) {
        scene.quality.samples_per_pixel = s->samples;
        status = scene_set_preset(&scene, context, exhibit->look);
    }
    if (status >= 0) {
        status = exhibit->describe(&scene);
    }
    if (status >= 0 && s->preset != NO_PRESET) {
        const int has_disk = scene.has_disk;
        status = scene_set_preset(&scene, context, s->preset);
        scene.has_disk = has_disk;
    }
    if (status >= 0) {
        status = scene_apply(&scene, context);
    }
    if (status < 0) {
        fprintf(stderr, "%s: ", exhibit->name);
        report_failure("set the scene", status);
    }
    return status >= 0;
}

/* Renders into the picture and saves it. 1, or 0 after a message. */
static int render(BhrContext *context, const Settings *s, const Exhibit *exhibit, const BhrImage *picture) {
    char   name[64];
    double begin = wall_seconds();
    if (!set_scene(context, s, exhibit)) {
        return 0;
    }
    BhrStatus status = bhr_render_image(context, picture);
    if (status < 0) {
        fprintf(stderr, "%s: ", exhibit->name);
        report_failure("render", status);
        return 0;
    }
    snprintf(name, sizeof name, "%s.png", exhibit->name);
    if (!picture_save_into(picture, s->output, name)) {
        return 0;
    }
    printf("%s/%s  %u x %u, %.1f s\n", s->output, name, (unsigned)picture->width, (unsigned)picture->height,
           wall_seconds() - begin);
    fflush(stdout);
    return 1;
}

/* Renders one scene, and puts it on the sheet unless that is NULL. 1, or 0 after a message. */
static int make_picture(BhrContext *context, const Settings *s, const Exhibit *exhibit, Sheet *sheet) {
    BhrImage       picture;
    const uint32_t unit = s->width / exhibit->shape[0]; /* exactly that shape: a cube must be six squares */
    if (!picture_allocate(&picture, BHR_FORMAT_RGBA8_SRGB, unit * exhibit->shape[0], unit * exhibit->shape[1])) {
        return 0;
    }
    int made = render(context, s, exhibit, &picture);
    if (made && sheet != NULL) {
        sheet_add(sheet, &picture, exhibit->name);
    }
    free(picture.pixels);
    return made;
}

static int make_all(BhrContext *context, const Settings *s) {
    Sheet sheet;
    if (!sheet_begin(&sheet, s->width)) {
        return 0;
    }
    int made = 1;
    for (size_t i = 0; made && i < COUNT_OF(EXHIBITS); i++) {
        made = make_picture(context, s, &EXHIBITS[i], &sheet);
    }
    made = made && picture_save_into(&sheet.image, s->output, SHEET);
    free(sheet.image.pixels);
    if (made) {
        printf("%s/%s\n", s->output, SHEET);
    }
    return made;
}

static const Exhibit *find_exhibit(const char *name) {
    for (size_t i = 0; i < COUNT_OF(EXHIBITS); i++) {
        if (strcmp(EXHIBITS[i].name, name) == 0) {
            return &EXHIBITS[i];
        }
    }
    return NULL;
}

/* An exit status. */
static int make_pictures(const Settings *s) {
    if (!make_folder(s->output) && errno != EEXIST) {
        fprintf(stderr, "cannot make the folder %s: %s\n", s->output, strerror(errno));
        return EXIT_FAILURE;
    }
    BhrContext *context = NULL;
    BhrStatus   status = create_context_on(s->backend, &context);
    if (status < 0) {
        return report_failure("create a context", status);
    }
    int made = s->only != NULL ? make_picture(context, s, find_exhibit(s->only), NULL) : make_all(context, s);
    bhr_context_destroy(context);
    return made ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* ---- command line ---- */

static void list_exhibits(void) {
    for (size_t i = 0; i < COUNT_OF(EXHIBITS); i++) {
        printf("%-22s %s\n", EXHIBITS[i].name, EXHIBITS[i].about);
    }
}

/* 0, or EXIT_USAGE after a message. */
static int check(const char *program, const Settings *s) {
    if (s->width < LEAST_WIDTH || s->width > MOST_WIDTH) {
        fprintf(stderr, "%s: --width is %u; it must be %u to %u\n", program, (unsigned)s->width, LEAST_WIDTH,
                MOST_WIDTH);
        return EXIT_USAGE;
    }
    if (s->only != NULL && find_exhibit(s->only) == NULL) {
        fprintf(stderr, "%s: there is no scene '%s'; --list shows them\n", program, s->only);
        return EXIT_USAGE;
    }
    return 0;
}

static int run(int argc, char **argv) {
    Settings     s = {.output = "gallery-out", .width = 960, .samples = 8, .backend = BHR_BACKEND_AUTO,
                      .preset = NO_PRESET};
    const Option options[] = {
        {"--output", OPTION_TEXT, &s.output, "FOLDER", "for the pictures; made if need be", NULL, NULL},
        {"--only", OPTION_TEXT, &s.only, "NAME", "this scene alone, and no contact sheet", NULL, NULL},
        {"--width", OPTION_UINT, &s.width, "N", "pixels across, 16 to 16384, to fit the shape", NULL, NULL},
        {"--preset", OPTION_CHOICE, &s.preset, NULL, "this look for all scenes, instead of their own", PRESETS, NULL},
        {"--samples", OPTION_UINT, &s.samples, "N", "per pixel, 1 to 256", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--list", OPTION_FLAG, &s.list, NULL, "names the scenes", NULL, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.help) {
        printf("Usage: gallery [options]\nRenders named scenes into PNG files, and a contact sheet, " SHEET ".\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    if (s.list) {
        list_exhibits();
        return EXIT_SUCCESS;
    }
    result = check(argv[0], &s);
    return result != 0 ? result : make_pictures(&s);
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
