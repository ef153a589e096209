/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_rays.c -- rays, paths, tensors and the camera's world line asked wrongly, and the cameras that no observer can
 * carry, which are found when a frame or rays are asked for. What right rays give is tested against golden values
 * elsewhere. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double NOT_FINITE[] = {NAN, INFINITY, -INFINITY};

static BhrRay good_ray(void) {
    const BhrRay ray = {{30.0, 0.0, 4.0}, {-1.0, 0.25, 0.1}, 1.0};
    return ray;
}

/* ---- bhr_trace_rays ---- */

/* One bad ray is INVALID; its neighbours are traced as if it were not there. */
static void bad_ray_in_a_batch(BhrContext *context) {
    enum { COUNT = 9 };
    BhrRay rays[COUNT];
    BhrHit hits[COUNT], alone;
    for (int i = 0; i < COUNT; i++) {
        rays[i] = good_ray();
    }
    rays[1].position[0] = NAN;
    rays[2].direction[1] = INFINITY;
    memset(rays[3].direction, 0, sizeof rays[3].direction);
    memset(rays[4].position, 0, sizeof rays[4].position);
    rays[5].frequency_ratio = 0.0;
    rays[6].frequency_ratio = -1.0;
    rays[7].frequency_ratio = NAN;
    CHECK_OK(bhr_trace_rays(context, rays, sizeof rays[0], COUNT, hits, sizeof hits[0]));
    CHECK_OK(bhr_trace_rays(context, rays, sizeof rays[0], 1, &alone, sizeof alone));
    CHECK(alone.fate == BHR_FATE_ESCAPED, "the good ray's fate is %d", (int)alone.fate);
    for (int i = 0; i < COUNT; i++) {
        if (i == 0 || i == COUNT - 1) {
            CHECK(memcmp(&hits[i], &alone, sizeof alone) == 0, "ray %d differs from the same ray alone", i);
        } else {
            CHECK(hits[i].fate == BHR_FATE_INVALID && hits[i].crossing_count == 0, "bad ray %d has fate %d", i,
                  (int)hits[i].fate);
        }
    }
    /* No frame there: inside a spinning horizon. */
    double m, a, axis[3];
    CHECK_OK(bhr_get_hole(context, &m, &a, axis));
    CHECK_OK(bhr_set_spin(context, 0.5));
    rays[0].position[0] = 1.0;
    rays[0].position[2] = 0.1;
    CHECK_OK(bhr_trace_rays(context, rays, sizeof rays[0], 1, hits, sizeof hits[0]));
    CHECK(hits[0].fate == BHR_FATE_INVALID, "a ray inside a spinning horizon has fate %d", (int)hits[0].fate);
    CHECK_OK(bhr_set_spin(context, a));
}

static void trace_rays(Watch *watch, BhrContext *context) {
    BhrRay ray = good_ray();
    BhrHit hit;
    memset(&hit, UNTOUCHED, sizeof hit);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_trace_rays(NULL, &ray, sizeof ray, 1, &hit, sizeof hit));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "rays",
                  bhr_trace_rays(context, NULL, sizeof ray, 1, &hit, sizeof hit));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hits",
                  bhr_trace_rays(context, &ray, sizeof ray, 1, NULL, sizeof hit));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "ray_size",
                  bhr_trace_rays(context, &ray, FIRST_RAY - 1, 1, &hit, sizeof hit));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "ray_size", bhr_trace_rays(context, &ray, 0, 1, &hit, sizeof hit));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "hit_size",
                  bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, FIRST_HIT - 1));
    /* Arrays no memory holds: count times size does not fit into size_t, or not into half of it. */
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "count",
                  bhr_trace_rays(context, &ray, sizeof ray, SIZE_MAX, &hit, sizeof hit));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "count",
                  bhr_trace_rays(context, &ray, sizeof ray, SIZE_MAX / sizeof ray, &hit, sizeof hit));
    bad_ray_in_a_batch(context);

    /* A newer host's larger structs. */
    struct {
        BhrRay        known;
        unsigned char tail[8];
    } rays[2];
    struct {
        BhrHit        known;
        unsigned char tail[8];
    } hits[2];
    BhrHit plain;
    memset(rays, 0, sizeof rays);
    memset(hits, UNTOUCHED, sizeof hits);
    rays[0].known = ray;
    rays[1].known = ray;
    rays[1].known.direction[1] = -0.3;
    CHECK_OK(bhr_trace_rays(context, &rays[1].known, sizeof(BhrRay), 1, &plain, sizeof plain));
    CHECK_OK(bhr_trace_rays(context, &rays[0].known, sizeof rays[0], 2, &hits[0].known, sizeof hits[0]));
    CHECK(memcmp(&hits[1].known, &plain, sizeof plain) == 0, "the second hit of grown structs differs");
    CHECK(hits[0].tail[0] == 0 && hits[1].tail[7] == 0, "the tail of a grown hit is not zeroed");
}

/* ---- bhr_camera_ray(s), bhr_trace_path ---- */

static void camera_rays(Watch *watch, BhrContext *context) {
    BhrRay rays[12], one;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_camera_rays(NULL, 4, 3, rays));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_rays", bhr_camera_rays(context, 4, 3, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "width|frame", bhr_camera_rays(context, 0, 3, rays));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "height|frame", bhr_camera_rays(context, 4, 0, rays));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "width|height|frame|size",
                  bhr_camera_rays(context, UINT32_MAX, UINT32_MAX, rays));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_camera_ray(NULL, 4, 3, 0.5, 0.5, &one));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_ray", bhr_camera_ray(context, 4, 3, 0.5, 0.5, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "width|frame", bhr_camera_ray(context, 0, 3, 0.5, 0.5, &one));
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "x", bhr_camera_ray(context, 4, 3, NOT_FINITE[i], 0.5, &one));
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "y", bhr_camera_ray(context, 4, 3, 0.5, NOT_FINITE[i], &one));
    }
    CHECK_OK(bhr_camera_rays(context, 4, 3, rays));
    for (uint32_t i = 0; i < 12; i++) {
        CHECK_OK(bhr_camera_ray(context, 4, 3, i % 4 + 0.5, i / 4 + 0.5, &one));
        CHECK(memcmp(&one, &rays[i], sizeof one) == 0, "bhr_camera_ray differs from ray %u of the frame", (unsigned)i);
    }
}

static void trace_path(Watch *watch, BhrContext *context) {
    enum { CAPACITY = 32 };
    BhrRay   ray = good_ray();
    double   points[CAPACITY][4];
    uint32_t count = 7;
    memset(points, UNTOUCHED, sizeof points);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_trace_path(NULL, &ray, CAPACITY, points[0], &count));
    CHECK(count == 0, "out_count is %u after a failure", (unsigned)count);
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "ray", bhr_trace_path(context, NULL, CAPACITY, points[0], &count));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_points",
                  bhr_trace_path(context, &ray, CAPACITY, NULL, &count));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_count",
                  bhr_trace_path(context, &ray, CAPACITY, points[0], NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "capacity", bhr_trace_path(context, &ray, 0, points[0], &count));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "capacity", bhr_trace_path(context, &ray, 1, points[0], &count));
    ray.direction[2] = NAN;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "direction",
                  bhr_trace_path(context, &ray, CAPACITY, points[0], &count));
    ray = good_ray();
    ray.position[0] = INFINITY;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "position",
                  bhr_trace_path(context, &ray, CAPACITY, points[0], &count));
    CHECK(all_untouched(points, sizeof points), "a refused path was written");

    ray = good_ray();
    static const uint32_t capacities[] = {2, 3, 17, CAPACITY};
    for (size_t i = 0; i < COUNT_OF(capacities); i++) {
        memset(points, UNTOUCHED, sizeof points);
        CHECK_OK(bhr_trace_path(context, &ray, capacities[i], points[0], &count));
        CHECK(count >= 2 && count <= capacities[i], "%u points for a capacity of %u", (unsigned)count,
              (unsigned)capacities[i]);
        CHECK(all_untouched(&points[count], (CAPACITY - count) * sizeof points[0]), "points beyond out_count written");
        CHECK(fabs(points[0][0] - ray.position[0]) < 1e-9 && points[0][3] == 0.0,
              "the path begins at (%g, %g, %g), t %g", points[0][0], points[0][1], points[0][2], points[0][3]);
        for (uint32_t k = 1; k < count; k++) {
            CHECK(points[k][3] <= points[k - 1][3], "time goes forward along a backward path");
        }
    }
}

/* ---- tensors and numbers ---- */

static void tensors(Watch *watch, BhrContext *context) {
    static const double place[3] = {8.0, 3.0, 1.0}, origin[3] = {0.0, 0.0, 0.0}, pole[3] = {0.0, 0.0, 9.0};
    double              metric[16], gamma[64], horizon[3] = {0.0, 0.0, 0.0};
    BhrHoleInfo         info = {.struct_size = sizeof info};
    CHECK_OK(bhr_hole_info(context, &info));
    horizon[0] = info.horizon_radius;
    CHECK_OK(bhr_metric_at(context, place, metric));
    CHECK_OK(bhr_christoffel_at(context, place, gamma));
    CHECK_OK(bhr_metric_at(context, pole, metric));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_metric_at(NULL, place, metric));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_christoffel_at(NULL, place, gamma));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "position", bhr_metric_at(context, NULL, metric));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "position", bhr_christoffel_at(context, NULL, gamma));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_metric", bhr_metric_at(context, place, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_gamma", bhr_christoffel_at(context, place, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "horizon", bhr_metric_at(context, horizon, metric));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "horizon", bhr_christoffel_at(context, horizon, gamma));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "position", bhr_metric_at(context, origin, metric));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "axis", bhr_christoffel_at(context, pole, gamma));
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        const double bad[3] = {8.0, NOT_FINITE[i], 1.0};
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "position", bhr_metric_at(context, bad, metric));
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "position", bhr_christoffel_at(context, bad, gamma));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_hole_info(NULL, &info));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "info", bhr_hole_info(context, NULL));
    info.struct_size = 16;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_hole_info(context, &info));
}

/* ---- the camera's observer ---- */

static BhrCamera camera_at(double x, double y, double z, BhrMotion motion) {
    const double position[3] = {x, y, z}, target[3] = {0.0, 0.0, 0.0};
    const double up[3] = {0.0, 0.6, 0.8};
    BhrCamera    camera;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    CHECK_OK(bhr_camera_look_at(&camera, position, target, up));
    camera.motion = motion;
    return camera;
}

static void camera_advance(Watch *watch, BhrContext *context) {
    BhrCamera camera = camera_at(10.0, 0.0, 0.0, BHR_MOTION_FREE_FALL);
    BhrCamera before = camera;
    double    time = 5.0;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_camera_advance(NULL, &camera, 1.0, &time));
    CHECK(time == 0.0, "out_coordinate_time is %g after a failure", time);
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_advance(context, NULL, 1.0, &time));
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "proper_time",
                      bhr_camera_advance(context, &camera, NOT_FINITE[i], &time));
    }
    camera.motion = before.motion = BHR_MOTION_STATIC;
    camera.transport = before.transport = BHR_TRANSPORT_PARALLEL;
    CHECK_REFUSED(watch, BHR_ERROR_UNSUPPORTED, "PARALLEL", bhr_camera_advance(context, &camera, 1.0, &time));
    CHECK(memcmp(&camera, &before, sizeof camera) == 0, "a failed advance moved the camera");
    camera.up[1] = NAN;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "up", bhr_camera_advance(context, &camera, 1.0, NULL));
    camera = before;
    camera.transport = BHR_TRANSPORT_TRIAD;
    CHECK_OK(bhr_camera_advance(context, &camera, 1.0, NULL)); /* out_coordinate_time may be NULL */
}

/* Setting the camera succeeds, asking for a frame or rays does not; memory stays untouched, the context usable. */
static void check_impossible(BhrContext *context, double spin, const BhrCamera *camera, BhrStatus expected,
                             const char *words, int line) {
    static unsigned char pixels[WATCH_WIDTH * WATCH_HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WATCH_WIDTH, WATCH_HEIGHT, pixels, sizeof pixels);
    BhrRay               ray, rays[4];
    memset(pixels, UNTOUCHED, sizeof pixels);
    CHECK_OK(bhr_set_spin(context, spin));
    CHECK_OK(bhr_set_camera(context, camera));
    check_mark_message();
    check_fails(bhr_render_image(context, &image), expected, words, __FILE__, line, "bhr_render_image");
    CHECK(all_untouched(pixels, sizeof pixels), "line %d: a frame that cannot be wrote pixels", line);
    check_mark_message();
    check_fails(bhr_camera_ray(context, 4, 3, 1.0, 1.0, &ray), expected, words, __FILE__, line, "bhr_camera_ray");
    check_mark_message();
    check_fails(bhr_camera_rays(context, 2, 2, rays), expected, words, __FILE__, line, "bhr_camera_rays");
    BhrCamera kept = {.struct_size = sizeof kept};
    CHECK_OK(bhr_get_camera(context, &kept));
    CHECK(memcmp(&kept, camera, sizeof kept) == 0, "line %d: a failed frame changed the camera", line);
}

static void impossible_cameras(BhrContext *context) {
    static const struct {
        double      spin, x, y, z;
        BhrMotion   motion;
        BhrStatus   expected;
        const char *words;
        int         line;
    } all[] = {
        {0.0, 1.5, 0.0, 0.0, BHR_MOTION_STATIC, BHR_ERROR_INVALID_STATE, "horizon", __LINE__},
        {0.0, 2.0, 0.0, 0.0, BHR_MOTION_STATIC, BHR_ERROR_INVALID_STATE, "horizon", __LINE__},
        {0.0, 0.0, 1.2, 0.9, BHR_MOTION_STATIC, BHR_ERROR_INVALID_STATE, "horizon", __LINE__},
        {0.0, 1.0, 0.0, 0.0, BHR_MOTION_ORBIT, BHR_ERROR_INVALID_STATE, "orbit|horizon|ORBIT", __LINE__},
        {0.0, 3.0, 0.0, 0.0, BHR_MOTION_ORBIT, BHR_ERROR_INVALID_STATE, "orbit|ORBIT", __LINE__},
        {0.0, 2.9, 0.0, 0.0, BHR_MOTION_ORBIT, BHR_ERROR_INVALID_STATE, "orbit|ORBIT", __LINE__},
        {0.5, 10.0, 0.0, 1.0, BHR_MOTION_ORBIT, BHR_ERROR_INVALID_STATE, "equator", __LINE__},
        {-0.5, 10.0, 0.0, -1e-3, BHR_MOTION_ORBIT, BHR_ERROR_INVALID_STATE, "equator", __LINE__},
        {0.9, 1.5, 0.0, 0.0, BHR_MOTION_ORBIT, BHR_ERROR_INVALID_STATE, "orbit|ORBIT", __LINE__},
        {-0.9, 3.8, 0.0, 0.0, BHR_MOTION_ORBIT, BHR_ERROR_INVALID_STATE, "orbit|ORBIT", __LINE__},
        {0.5, 1.0, 0.0, 0.0, BHR_MOTION_STATIC, BHR_ERROR_UNSUPPORTED, "horizon", __LINE__},
        {0.5, 1.0, 0.0, 0.0, BHR_MOTION_FREE_FALL, BHR_ERROR_UNSUPPORTED, "horizon", __LINE__},
        {0.5, 1.0, 0.0, 0.0, BHR_MOTION_ORBIT, BHR_ERROR_UNSUPPORTED, "horizon", __LINE__},
        {0.5, 1.0, 0.0, 0.0, BHR_MOTION_VELOCITY, BHR_ERROR_UNSUPPORTED, "horizon", __LINE__},
    };
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        const BhrCamera camera = camera_at(all[i].x, all[i].y, all[i].z, all[i].motion);
        check_impossible(context, all[i].spin, &camera, all[i].expected, all[i].words, all[i].line);
    }
    /* The limits are those of the mass: at mass 2 the horizon is at 4. */
    const BhrCamera camera = camera_at(3.9, 0.0, 0.0, BHR_MOTION_STATIC);
    CHECK_OK(bhr_set_mass(context, 2.0));
    check_impossible(context, 0.0, &camera, BHR_ERROR_INVALID_STATE, "horizon", __LINE__);
    CHECK_OK(bhr_set_mass(context, 1.0));
}

/* A cube is six faces side by side; whatever the frame's shape, the camera itself can be set. */
static void cube(Watch *watch, BhrContext *context) {
    enum { SIDE = 5 };
    static unsigned char pixels[6 * SIDE * SIDE * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, 6 * SIDE, SIDE, pixels, sizeof pixels);
    BhrRay               rays[6 * SIDE * SIDE];
    BhrCamera            camera = camera_at(8.0, 2.0, 3.0, BHR_MOTION_STATIC);
    camera.projection = BHR_PROJECTION_CUBE;
    check_impossible(context, 0.0, &camera, BHR_ERROR_INVALID_STATE, "CUBE", __LINE__);
    check_impossible(context, 0.9, &camera, BHR_ERROR_INVALID_STATE, "CUBE", __LINE__);
    memset(rays, UNTOUCHED, sizeof rays);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "6 times", bhr_camera_rays(context, 6 * SIDE, SIDE - 1, rays));
    CHECK(rays[0].frequency_ratio == 0.0 && rays[0].direction[0] == 0.0, "the rays of no frame are not cleared");
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_camera_rays(context, 6 * SIDE, SIDE, rays));
    /* The middles of the faces are the camera's axes: right left up down front back. */
    for (int i = 0; i < 6; i += 2) {
        const double *a = rays[2 * 6 * SIDE + i * SIDE + 2].direction;
        const double *b = rays[2 * 6 * SIDE + (i + 1) * SIDE + 2].direction;
        CHECK(fabs(a[0] + b[0]) + fabs(a[1] + b[1]) + fabs(a[2] + b[2]) < 1e-12, "faces %d and %d are not opposite", i,
              i + 1);
    }
    /* The full frame of a region counts; the part that the image holds may have any shape. */
    BhrRegion region = {.struct_size = sizeof region, .full_width = 12 * SIDE, .full_height = 2 * SIDE, .x = 7, .y = 3};
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_OK(bhr_render_image(context, &image));
    region.full_height = 3 * SIDE;
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "CUBE", bhr_render_image(context, &image));
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK_OK(bhr_set_spin(context, 0.0));
    CHECK_OK(bhr_set_camera(context, &watch->camera));
    check_unchanged(watch, __FILE__, __LINE__, "the camera set back after a cube");
}

/* Outside a fisheye's circle there is no direction: such a ray is INVALID, and the picture transparent. */
static void fisheye(Watch *watch, BhrContext *context) {
    enum { SIDE = 8 };
    static unsigned char pixels[SIDE * SIDE * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    BhrRay               rays[SIDE * SIDE], one;
    BhrHit               hits[SIDE * SIDE];
    BhrCamera            camera = camera_at(8.0, 2.0, 3.0, BHR_MOTION_STATIC);
    camera.projection = BHR_PROJECTION_FISHEYE;
    camera.fov_y = 6.0;
    image.flags |= BHR_IMAGE_TRANSPARENT;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK_OK(bhr_camera_rays(context, SIDE, SIDE, rays));
    CHECK_OK(bhr_trace_rays(context, rays, sizeof rays[0], SIDE * SIDE, hits, sizeof hits[0]));
    int outside = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double *d = rays[i].direction;
        const int     none = d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0;
        const double  x = i % SIDE + 0.5 - SIDE / 2, y = i / SIDE + 0.5 - SIDE / 2;
        CHECK(none == (sqrt(x * x + y * y) > SIDE / 2), "ray %d: (%g, %g, %g)", i, d[0], d[1], d[2]);
        CHECK(none == (hits[i].fate == BHR_FATE_INVALID), "ray %d has fate %d", i, (int)hits[i].fate);
        CHECK(!none || (rays[i].frequency_ratio == 1.0 && pixels[4 * i + 3] == 0), "pixel %d is covered", i);
        outside += none;
    }
    CHECK(outside >= 4, "%d pixels lie outside the circle", outside);
    CHECK_OK(bhr_camera_ray(context, SIDE, SIDE, -3.0, 1e8, &one));
    CHECK(one.direction[0] == 0.0 && one.direction[1] == 0.0 && one.direction[2] == 0.0,
          "a ray far outside the circle");
    /* An angle does not end a fall: any camera advances. */
    camera.motion = BHR_MOTION_FREE_FALL;
    CHECK_OK(bhr_camera_advance(context, &camera, 0.5, NULL));
    CHECK(camera.projection == BHR_PROJECTION_FISHEYE && camera.fov_y == 6.0, "advancing changed the lens");
    CHECK_OK(bhr_set_camera(context, &watch->camera));
    check_unchanged(watch, __FILE__, __LINE__, "the camera set back after a fisheye");
}

/* The other side of each limit: these observers exist. */
static void possible_cameras(BhrContext *context) {
    static const struct {
        double    spin, x, y, z;
        BhrMotion motion;
    } all[] = {
        {0.0, 2.01, 0.0, 0.0, BHR_MOTION_STATIC},     {0.0, 1.5, 0.0, 0.0, BHR_MOTION_FREE_FALL},
        {0.0, 3.01, 0.0, 0.0, BHR_MOTION_ORBIT},      {0.0, 10.0, 0.0, 5.0, BHR_MOTION_ORBIT},
        {0.5, 10.0, 0.0, 0.0, BHR_MOTION_ORBIT},      {-0.5, 10.0, 0.0, 0.0, BHR_MOTION_ORBIT},
        {0.5, 1.9, 0.0, 0.0, BHR_MOTION_STATIC},      {0.5, 1.9, 0.0, 0.0, BHR_MOTION_FREE_FALL},
        {0.9, 0.0, 0.0, 10.0, BHR_MOTION_STATIC},     {0.9, 0.0, 0.0, -10.0, BHR_MOTION_FREE_FALL},
        {0.998, 500.0, 0.0, 80.0, BHR_MOTION_STATIC}, {0.0, 1e6, 0.0, 0.0, BHR_MOTION_STATIC},
    };
    static unsigned char pixels[WATCH_WIDTH * WATCH_HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WATCH_WIDTH, WATCH_HEIGHT, pixels, sizeof pixels);
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        const BhrCamera camera = camera_at(all[i].x, all[i].y, all[i].z, all[i].motion);
        CHECK_OK(bhr_set_spin(context, all[i].spin));
        CHECK_OK(bhr_set_camera(context, &camera));
        CHECK(bhr_render_image(context, &image) == BHR_OK, "camera %u: %s", (unsigned)i, bhr_error_message());
    }
    CHECK_OK(bhr_set_spin(context, 0.0));
}

/* Masses at the ends of double: any status, no crash, and the context lives on. */
static void extreme_masses(Watch *watch, BhrContext *context) {
    static const double masses[] = {1e-300, 5e-324, 1e-30, 1e30, 1e300, 1.7e308};
    static unsigned char pixels[WATCH_WIDTH * WATCH_HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WATCH_WIDTH, WATCH_HEIGHT, pixels, sizeof pixels);
    for (size_t i = 0; i < COUNT_OF(masses); i++) {
        check_mark_message();
        if (bhr_set_mass(context, masses[i]) == BHR_OK) {
            const BhrStatus status = bhr_render_image(context, &image);
            CHECK(status <= 0 && status != BHR_ERROR_INTERNAL && (status == BHR_OK || bhr_error_message()[0] != '\0'),
                  "mass %g: %s: %s", masses[i], bhr_status_name(status), bhr_error_message());
        }
    }
    CHECK_OK(bhr_set_mass(context, watch->mass));
    check_unchanged(watch, __FILE__, __LINE__, "the mass set back");
}

int main(int argc, char **argv) {
    BhrContext  *context = check_context(check_begin(argc, argv));
    static Watch watch;
    watch_begin(&watch, context);
    CHECK(watch.frame_status == BHR_OK, "the default scene cannot be rendered: %s", bhr_error_message());
    trace_rays(&watch, context);
    camera_rays(&watch, context);
    trace_path(&watch, context);
    tensors(&watch, context);
    camera_advance(&watch, context);
    extreme_masses(&watch, context);
    impossible_cameras(context);
    possible_cameras(context);
    cube(&watch, context);
    fisheye(&watch, context);
    CHECK_OK(bhr_set_camera(context, &watch.camera));
    check_unchanged(&watch, __FILE__, __LINE__, "the camera set back");
    bhr_context_destroy(context);
    return check_end();
}
