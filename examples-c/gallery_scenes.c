/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gallery_scenes.c -- see gallery_scenes.h. Lengths are in units of the hole's mass M, angles in degrees. */
#include "gallery_scenes.h"

#include "matter.h"

#include <math.h>

/* ---- parts of scenes ---- */

const SceneOptions GALLERY_BEGINNING = {
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
    expose(scene, 1.5);
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
    volume->absorption = 0.07;
    volume->brightness = 1.0;
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

#define CINEMATIC BHR_PRESET_CINEMATIC

const Exhibit EXHIBITS[] = {
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

const size_t EXHIBIT_COUNT = COUNT_OF(EXHIBITS);
