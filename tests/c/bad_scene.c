/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_scene.c -- the setters of hole, camera, time, effects and view asked wrongly: NULL, NaN, infinities, values
 * beyond each documented limit, unknown constants, structs of other sizes. Each refusal must leave the context as it
 * was. Values at the limits must be taken. Disk, sky, film and quality are in bad_light.c. */
#include "check.h"
#include "refusals.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double NOT_FINITE[] = {NAN, INFINITY, -INFINITY};

/* ---- the hole ---- */

static void mass(Watch *watch, BhrContext *context) {
    static const double bad[] = {0.0, -0.0, -1.0, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "mass", bhr_set_mass(context, bad[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_mass(NULL, 1.0));
}

static void spin(Watch *watch, BhrContext *context) {
    static const double bad[] = {1.0 + DBL_EPSILON, -1.0 - DBL_EPSILON, 1.0000001, 5.0, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "spin", bhr_set_spin(context, bad[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_spin(NULL, 0.0));
    CHECK_OK(bhr_set_spin(context, -1.0));
    CHECK_OK(bhr_set_spin(context, 1.0));
    CHECK_OK(bhr_set_spin(context, watch->spin));
}

static void axis(Watch *watch, BhrContext *context) {
    static const double zero[3] = {0.0, 0.0, -0.0};
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "axis", bhr_set_axis(context, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "axis", bhr_set_axis(context, zero));
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        for (int k = 0; k < 3; k++) {
            double bad[3] = {0.1, 0.2, 1.0};
            bad[k] = NOT_FINITE[i];
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "axis", bhr_set_axis(context, bad));
        }
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_axis(NULL, watch->axis));
    /* Any non-zero length is taken. */
    static const double long_axis[3] = {0.0, 3e300, 4e300}, short_axis[3] = {0.0, 3e-310, 4e-310};
    double              m, a, got[3];
    CHECK_OK(bhr_set_axis(context, long_axis));
    CHECK_OK(bhr_get_hole(context, &m, &a, got));
    CHECK(fabs(got[1] / got[2] - 0.75) < 1e-12, "axis is (%g, %g, %g)", got[0], got[1], got[2]);
    CHECK_OK(bhr_set_axis(context, short_axis));
    CHECK_OK(bhr_get_hole(context, &m, &a, got));
    CHECK(fabs(got[1] / got[2] - 0.75) < 1e-9, "axis is (%g, %g, %g)", got[0], got[1], got[2]);
    CHECK_OK(bhr_set_axis(context, watch->axis));
    check_unchanged(watch, __FILE__, __LINE__, "the axis set back");

    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_hole(NULL, &m, &a, got));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_mass", bhr_get_hole(context, NULL, &a, got));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_spin", bhr_get_hole(context, &m, NULL, got));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_axis", bhr_get_hole(context, &m, &a, NULL));
}

/* ---- the camera ---- */

static void camera_vectors(Watch *watch, BhrContext *context) {
    static const struct {
        size_t      offset;
        const char *name;
    } vectors[] = {
        {offsetof(BhrCamera, position), "position"},
        {offsetof(BhrCamera, forward), "forward"},
        {offsetof(BhrCamera, up), "up"},
        {offsetof(BhrCamera, velocity), "velocity"},
    };
    for (size_t v = 0; v < COUNT_OF(vectors); v++) {
        for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
            for (size_t k = 0; k < 3; k++) {
                BhrCamera camera = default_camera();
                put(&camera, vectors[v].offset + k * sizeof(double), NOT_FINITE[i]);
                CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, vectors[v].name, bhr_set_camera(context, &camera));
            }
        }
        if (strcmp(vectors[v].name, "velocity") != 0) {
            BhrCamera camera = default_camera();
            for (size_t k = 0; k < 3; k++) {
                put(&camera, vectors[v].offset + k * sizeof(double), 0.0);
            }
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, vectors[v].name, bhr_set_camera(context, &camera));
        }
    }
}

static void camera_axes(Watch *watch, BhrContext *context) {
    for (int sign = -1; sign <= 1; sign += 2) {
        BhrCamera camera = default_camera();
        for (int k = 0; k < 3; k++) {
            camera.up[k] = 7.0 * sign * camera.forward[k];
        }
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "parallel", bhr_set_camera(context, &camera));
    }
}

static void camera_numbers(Watch *watch, BhrContext *context) {
    static const double bad_fov[] = {0.0, -0.5, PI, 4.0, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_fov); i++) {
        BhrCamera camera = default_camera();
        camera.fov_y = bad_fov[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "fov_y", bhr_set_camera(context, &camera));
    }
    /* A fisheye may show the whole sphere; the other projections have no such limit. */
    static const double bad_circle[] = {0.0, -0.5, 2.0 * PI + 1e-9, 7.0, NAN, INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_circle); i++) {
        BhrCamera camera = default_camera();
        camera.projection = BHR_PROJECTION_FISHEYE;
        camera.fov_y = bad_circle[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "fov_y", bhr_set_camera(context, &camera));
    }
    static const double fast[][3] = {{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {0.6, 0.6, 0.6}, {0.0, 0.0, 1e300}};
    for (size_t i = 0; i < COUNT_OF(fast); i++) {
        BhrCamera camera = default_camera();
        camera.motion = BHR_MOTION_VELOCITY;
        memcpy(camera.velocity, fast[i], sizeof fast[i]);
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "velocity", bhr_set_camera(context, &camera));
    }
    static const int32_t unknown[] = {-1, 5, 77, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        BhrCamera camera = default_camera();
        camera.motion = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "motion", bhr_set_camera(context, &camera));
        camera = default_camera();
        camera.projection = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "projection", bhr_set_camera(context, &camera));
    }
    BhrCamera camera = default_camera();
    camera.reserved = 1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "reserved", bhr_set_camera(context, &camera));
}

static void camera(Watch *watch, BhrContext *context) {
    camera_vectors(watch, context);
    camera_axes(watch, context);
    camera_numbers(watch, context);
    BhrCamera good = default_camera();
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_set_camera(context, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_get_camera(context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_camera(NULL, &good));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_camera(NULL, &good));
    good = default_camera(); /* a failed getter clears what it was to fill in */
    /* Just inside the limits. */
    good.fov_y = PI - 1e-9;
    good.motion = BHR_MOTION_VELOCITY;
    good.velocity[0] = 1.0 - 1e-9;
    CHECK_OK(bhr_set_camera(context, &good));
    for (BhrProjection projection = BHR_PROJECTION_PERSPECTIVE; projection <= BHR_PROJECTION_CUBE; projection++) {
        BhrCamera kept = {.struct_size = sizeof kept};
        good = default_camera();
        good.projection = projection;
        good.fov_y = projection == BHR_PROJECTION_FISHEYE       ? 2.0 * PI
                     : projection == BHR_PROJECTION_PERSPECTIVE ? 1.0
                                                                : -9.0;
        CHECK_OK(bhr_set_camera(context, &good));
        CHECK_OK(bhr_get_camera(context, &kept));
        CHECK(memcmp(&kept, &good, sizeof kept) == 0, "projection %d is not kept", (int)projection);
    }
    good = default_camera();
    CHECK_OK(bhr_set_camera(context, &good));

    struct {
        BhrCamera     known;
        unsigned char tail[24];
    } grown;
    CHECK_STRUCT_SIZES(watch, grown, FIRST_CAMERA, bhr_camera_init(&grown.known, size),
                       bhr_set_camera(context, &grown.known), bhr_get_camera(context, &grown.known));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_init(NULL, sizeof good));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_init(&good, FIRST_CAMERA - 1));
}

/* The helpers that write a camera leave it alone when they fail. */
static void camera_helpers(void) {
    static const double at[3] = {0.0, -30.0, 5.0}, origin[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    static const double along[3] = {0.0, -60.0, 10.0}, not_finite[3] = {0.0, NAN, 0.0};
    BhrCamera           camera = default_camera();
    const BhrCamera     before = camera;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_look_at(NULL, at, origin, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "position", bhr_camera_look_at(&camera, NULL, origin, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "target", bhr_camera_look_at(&camera, at, NULL, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up", bhr_camera_look_at(&camera, at, origin, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "position", bhr_camera_look_at(&camera, not_finite, origin, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "target", bhr_camera_look_at(&camera, at, not_finite, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up", bhr_camera_look_at(&camera, at, origin, not_finite));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "target", bhr_camera_look_at(&camera, at, at, up));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up", bhr_camera_look_at(&camera, at, origin, origin));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "up|parallel", bhr_camera_look_at(&camera, at, origin, along));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_orbit(NULL, 30.0, 0.0, 0.0));
    static const double bad_distance[] = {0.0, -1.0, NAN, INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_distance); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "distance", bhr_camera_orbit(&camera, bad_distance[i], 0.0, 0.0));
    }
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "azimuth", bhr_camera_orbit(&camera, 30.0, NOT_FINITE[i], 0.0));
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "elevation", bhr_camera_orbit(&camera, 30.0, 0.0, NOT_FINITE[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_through_lens(NULL, 1.0, 10.0, 1.5, 0, 4));
    for (size_t i = 0; i < COUNT_OF(bad_distance); i++) {
        const double bad = bad_distance[i];
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "focus", bhr_camera_through_lens(&camera, 1.0, bad, 1.5, 0, 4));
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "aspect", bhr_camera_through_lens(&camera, 1.0, 10.0, bad, 0, 4));
        if (bad != 0.0) {
            CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "aperture", bhr_camera_through_lens(&camera, bad, 10.0, 1.5, 0, 4));
        }
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "index", bhr_camera_through_lens(&camera, 1.0, 10.0, 1.5, 4, 4));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "count", bhr_camera_through_lens(&camera, 1.0, 10.0, 1.5, 0, 0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "65536", bhr_camera_through_lens(&camera, 1.0, 10.0, 1.5, 0, 65537));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "tan", bhr_camera_through_lens(&camera, 1.0, 1e-12, 1.5, 0, 4));
    CHECK(memcmp(&camera, &before, sizeof camera) == 0, "a failed helper changed the camera");
    camera.projection = BHR_PROJECTION_EQUIRECT;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "projection", bhr_camera_through_lens(&camera, 1.0, 10.0, 1.5, 0, 4));
    camera.projection = BHR_PROJECTION_PERSPECTIVE;
    /* A host of before FRUSTUM has no place for its tangents. */
    camera.struct_size = offsetof(BhrCamera, tan_up);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "tan_up", bhr_camera_through_lens(&camera, 1.0, 10.0, 1.5, 0, 4));
    camera.struct_size = 8;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_orbit(&camera, 30.0, 0.0, 0.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_look_at(&camera, at, origin, up));
    camera.struct_size = sizeof camera;
    CHECK_OK(bhr_camera_orbit(&camera, 30.0, 0.0, PI / 2.0)); /* straight above the pole has axes too */
    CHECK_OK(bhr_camera_orbit(&camera, 30.0, 0.0, -PI / 2.0));
    CHECK_OK(bhr_camera_look_at(&camera, at, origin, up));
}

/* ---- the rest ---- */

static void time_effects_view(Watch *watch, BhrContext *context) {
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "time", bhr_set_time(context, NOT_FINITE[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_time(NULL, 0.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_effects(NULL, BHR_EFFECT_ALL));
    uint32_t effects = 7;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_effects(NULL, &effects));
    CHECK(effects == 0, "a failed bhr_get_effects left %#x", (unsigned)effects);
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_effects", bhr_get_effects(context, NULL));
    /* Unknown bits are ignored: the watched scene is lit with all of them set, all but BEAMING. */
    CHECK_OK(bhr_set_effects(context, BHR_EFFECT_DOPPLER_SHIFT | BHR_EFFECT_GRAVITY_SHIFT | BHR_EFFECT_LIGHT_DELAY));
    CHECK_OK(bhr_get_effects(context, &watch->effects)); /* which tells unknown bits, too */
    check_unchanged(watch, __FILE__, __LINE__, "unknown effects");
    /* BEAMING is off, so that its strength does not show. */
    CHECK_OK(bhr_set_effect_strength(context, BHR_EFFECT_BEAMING, 0.5));
    CHECK_OK(bhr_get_effect_strength(context, BHR_EFFECT_BEAMING, &watch->effect_strengths[2]));
    CHECK(watch->effect_strengths[2] == 0.5, "strength is %g", watch->effect_strengths[2]);
    static const double strengths[] = {-1e-9, 1.000001, -INFINITY, INFINITY, NAN};
    for (size_t i = 0; i < COUNT_OF(strengths); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "strength",
                      bhr_set_effect_strength(context, BHR_EFFECT_BEAMING, strengths[i]));
    }
    static const uint32_t not_graded[] = {0, BHR_EFFECT_LIGHT_DELAY, BHR_EFFECT_BEAMING | 16u, BHR_EFFECT_ALL};
    double                strength;
    for (size_t i = 0; i < COUNT_OF(not_graded); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "effects",
                      bhr_set_effect_strength(context, not_graded[i], 0.5));
        strength = 7.0;
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "effect",
                      bhr_get_effect_strength(context, not_graded[i], &strength));
        CHECK(strength == 0.0, "a failed bhr_get_effect_strength left %g", strength);
    }
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "effect",
                  bhr_get_effect_strength(context, BHR_EFFECT_BEAMING | BHR_EFFECT_GRAVITY_SHIFT, &strength));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_strength",
                  bhr_get_effect_strength(context, BHR_EFFECT_BEAMING, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_effect_strength(NULL, BHR_EFFECT_BEAMING, 0.5));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_get_effect_strength(NULL, BHR_EFFECT_BEAMING, &strength));
    static const int32_t unknown[] = {-1, 8, 1000, INT32_MIN};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "view", bhr_set_view(context, unknown[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_view(NULL, BHR_VIEW_LIGHT));
}


int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    static Watch watch;
    watch_unusual_scene(&watch, context);
    mass(&watch, context);
    spin(&watch, context);
    axis(&watch, context);
    time_effects_view(&watch, context);
    camera(&watch, context);
    camera_helpers();
    bhr_context_destroy(context);
    return check_end();
}
