/* scene.c -- see scene.h. */
#include "scene.h"

#include "vectors.h"

/* The first look: a fast hole seen from a little above a disk with structure, so that its light turns and bends. */
const SceneOptions SCENE_DEFAULTS = {
    .mass = 1.0,
    .spin = 0.7,
    .distance = 34.0,
    .azimuth = 20.0,
    .elevation = 10.0,
    .fov = 42.0,
    .disk_outer = 15.0,
    .turbulence = 0.8,
    .exposure = 0.5,
    .view = BHR_VIEW_LIGHT,
};

const Choice VIEWS[] = {{"light", BHR_VIEW_LIGHT}, {"redshift", BHR_VIEW_REDSHIFT},     {"order", BHR_VIEW_ORDER},
                        {"steps", BHR_VIEW_STEPS}, {"deflection", BHR_VIEW_DEFLECTION}, {"metric", BHR_VIEW_METRIC},
                        {NULL, 0}};
const Choice PROJECTIONS[] = {{"perspective", BHR_PROJECTION_PERSPECTIVE},
                              {"fisheye", BHR_PROJECTION_FISHEYE},
                              {"equirect", BHR_PROJECTION_EQUIRECT},
                              {"cube", BHR_PROJECTION_CUBE},
                              {NULL, 0}};

/* The library's defaults. */
static BhrStatus fill_in(Scene *scene) {
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

BhrStatus scene_init(Scene *scene, const SceneOptions *options) {
    BhrStatus status = fill_in(scene);
    if (status < 0) {
        return status;
    }
    scene->mass = options->mass;
    scene->spin = options->spin;
    scene->time = 0.0;
    scene->effects = BHR_EFFECT_ALL;
    scene->view = options->view;
    scene->has_disk = !options->no_disk;
    scene->has_sky = !options->no_sky;
    scene->disk.outer_radius = options->disk_outer;
    scene->disk.turbulence = options->turbulence;
    scene->film.exposure_ev = options->exposure;
    scene->camera.fov_y = options->fov * PI / 180.0;
    return bhr_camera_orbit(&scene->camera, options->distance * options->mass, options->azimuth * PI / 180.0,
                            options->elevation * PI / 180.0);
}

BhrStatus scene_apply(const Scene *scene, BhrContext *context) {
    BhrStatus status = bhr_set_mass(context, scene->mass);
    if (status >= 0) {
        status = bhr_set_spin(context, scene->spin);
    }
    if (status >= 0) {
        status = bhr_set_time(context, scene->time);
    }
    if (status >= 0) {
        status = bhr_set_camera(context, &scene->camera);
    }
    if (status >= 0) {
        status = bhr_set_disk(context, scene->has_disk ? &scene->disk : NULL);
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
    if (status >= 0) {
        status = bhr_set_view(context, scene->view);
    }
    if (status >= 0) {
        status = bhr_set_quality(context, &scene->quality);
    }
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
    return scene->has_disk && scene->disk.turbulence > 0.0 && scene->view == BHR_VIEW_LIGHT;
}
