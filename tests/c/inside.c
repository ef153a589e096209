/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* inside.c -- cameras in the chart RAIN: a fall through the horizon of a spinning hole to the inner one, as hosts film
 * it; axes carried along in parallel (de Sitter 1916); rays, paths and points in the chart; hosts whose BhrCamera has
 * no chart yet; and what is not possible. M = 2. */
#include "check.h"
#include "refusals.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define MASS 2.0
#define SPIN 0.9

static double length(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static double apart(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return length(d);
}

/* A camera at r, M, that looks across the hole. */
static BhrCamera camera_at(BhrMotion motion, double r) {
    BhrCamera camera;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    CHECK_OK(bhr_camera_orbit(&camera, r * MASS, 0.4, 0.25));
    camera.motion = motion;
    camera.chart = BHR_CHART_RAIN;
    camera.fov_y = 2.0;
    return camera;
}

static void spin_up(BhrContext *context, double spin) {
    CHECK_OK(bhr_set_mass(context, MASS));
    CHECK_OK(bhr_set_spin(context, spin));
}

/* ---- a fall ---- */

#define WIDTH 48
#define HEIGHT 32

/* The mean brightness of a picture. */
static double brightness(BhrContext *context) {
    static float pixels[WIDTH * HEIGHT * 4];
    BhrImage     image = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, pixels, sizeof pixels);
    CHECK_OK(bhr_render_image(context, &image));
    double sum = 0.0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        sum += pixels[4 * i] + pixels[4 * i + 1] + pixels[4 * i + 2];
    }
    CHECK(isfinite(sum), "a picture holds numbers that are not finite");
    return sum / (WIDTH * HEIGHT);
}

static BhrHoleInfo info_of(const BhrContext *context) {
    BhrHoleInfo info;
    BHR_INIT(info);
    CHECK_OK(bhr_hole_info(context, &info));
    return info;
}

/* From r = 3.4 M to the inner horizon in steps of 0.05 M: through r = 3 M, where tracers change charts, and r+. */
static void a_fall(BhrContext *context) {
    spin_up(context, SPIN);
    CHECK_OK(bhr_set_disk(context, NULL));
    BhrSky sky;
    CHECK_OK(bhr_sky_init(&sky, sizeof sky));
    sky.flags = BHR_SKY_GRID;
    CHECK_OK(bhr_set_sky(context, &sky));
    BhrCamera   camera = camera_at(BHR_MOTION_FREE_FALL, 3.4);
    const double begin[3] = {camera.position[0], camera.position[1], camera.position[2]};
    double       light[3] = {NAN, NAN, NAN}, worst = 0.0, total = 0.0;
    int          frames = 0, inside = 0;
    BhrStatus    status = BHR_OK;
    while (status == BHR_OK && frames < 200) {
        CHECK_OK(bhr_set_camera(context, &camera));
        const BhrHoleInfo info = info_of(context);
        CHECK(info.camera_time_rate == 1.0, "%g", info.camera_time_rate);
        inside += info.camera_radius < info.horizon_radius;
        light[0] = light[1], light[1] = light[2], light[2] = brightness(context);
        if (frames >= 2) {
            worst = fmax(worst, fabs(light[0] - 2.0 * light[1] + light[2]) / light[1]);
        }
        double passed;
        status = bhr_camera_advance(context, &camera, 0.05 * MASS, &passed);
        if (status == BHR_OK) {
            CHECK(fabs(passed - 0.05 * MASS) < 1e-9, "%g", passed);
            total += passed;
        }
        frames++;
    }
    const BhrHoleInfo info = info_of(context);
    const double      sqrt_of = sqrt(1.0 - SPIN * SPIN);
    CHECK(fabs(info.inner_horizon_radius - MASS * (1.0 - sqrt_of)) < 1e-9, "%g", info.inner_horizon_radius);
    CHECK(status == BHR_ERROR_INVALID_STATE && strstr(bhr_error_message(), "inner horizon"), "%s",
          bhr_error_message());
    CHECK(frames > 20 && inside > 4, "%d frames, %d inside", frames, inside);
    CHECK(length(camera.position) > info.inner_horizon_radius, "%g", length(camera.position));
    /* Small pictures of a grid jump as lines come and go. */
    CHECK(worst < 0.25, "the light of a fall jumps by %g", worst);
    /* The way back. */
    CHECK_OK(bhr_camera_advance(context, &camera, -total, NULL));
    CHECK(apart(camera.position, begin) < 1e-7, "%g", apart(camera.position, begin));
}

/* ---- axes ---- */

static void parallel_axes(BhrContext *context) {
    spin_up(context, 0.0);
    BhrCamera camera = camera_at(BHR_MOTION_ORBIT, 10.0);
    CHECK_OK(bhr_camera_orbit(&camera, 10.0 * MASS, 0.0, 0.0));
    camera.transport = BHR_TRANSPORT_PARALLEL;
    const BhrCamera before = camera;
    const double    period = 2.0 * PI * 10.0 * sqrt(7.0) * MASS;
    CHECK_OK(bhr_camera_advance(context, &camera, period, NULL));
    const double turned = fabs(atan2(camera.forward[1], -camera.forward[0]));
    const double expected = 2.0 * PI * (1.0 - sqrt(0.7));
    CHECK(fabs(turned - expected) < 1e-6 && apart(camera.position, before.position) < 1e-6, "%g, not %g", turned,
          expected);
    camera = before;
    camera.motion = BHR_MOTION_STATIC;
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "PARALLEL", bhr_camera_advance(context, &camera, 1.0, NULL));
    /* A body in free fall, whose velocity changes. */
    camera = before;
    camera.motion = BHR_MOTION_VELOCITY, camera.chart = BHR_CHART_STATIC, camera.transport = BHR_TRANSPORT_TRIAD;
    camera.velocity[1] = 0.2;
    double passed;
    CHECK_OK(bhr_camera_advance(context, &camera, 5.0, &passed));
    CHECK(passed > 5.0 && camera.velocity[1] != 0.2 && camera.velocity[0] < 0.0, "%g, %g", passed, camera.velocity[0]);
    CHECK_OK(bhr_camera_advance(context, &camera, -5.0, NULL));
    CHECK(apart(camera.position, before.position) < 1e-8 && fabs(camera.velocity[1] - 0.2) < 1e-9, "%g",
          camera.velocity[1]);
}

/* ---- rays, paths, points ---- */

/* Two rays of the reference (tests/golden/worldlines.json): spin 0.5, r = 1.5 M, 60 degrees, azimuth 0. */
static void rays(BhrContext *context) {
    spin_up(context, 0.5);
    const double theta = PI / 3.0, r = 1.5 * MASS;
    BhrCamera    camera = camera_at(BHR_MOTION_FREE_FALL, 5.0);
    camera.position[0] = r * sin(theta), camera.position[1] = 0.0, camera.position[2] = r * cos(theta);
    CHECK_OK(bhr_set_camera(context, &camera));
    const double look[3] = {0.875, 0.17543398929568, -0.45121825694425};
    BhrRay       ray = {{camera.position[0], 0.0, camera.position[2]}, {0.0, look[2], 0.0}, 1.0};
    ray.direction[0] = look[0] * sin(theta) + look[1] * cos(theta);
    ray.direction[2] = look[0] * cos(theta) - look[1] * sin(theta);
    BhrHit hit;
    CHECK_OK(bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit));
    const double sky[3] = {0.89469184327478, -0.10726001663882, 0.4336147995724};
    CHECK(hit.fate == BHR_FATE_ESCAPED && apart(hit.sky_direction, sky) < 1e-8, "%d, off by %g", hit.fate,
          apart(hit.sky_direction, sky));
    CHECK(fabs(hit.sky_redshift / 0.47518537693661 - 1.0) < 1e-10, "%.14g", hit.sky_redshift);
    /* Its path begins at the camera and ends far outside. */
    double   path[64][4];
    uint32_t count = 0;
    CHECK_OK(bhr_trace_path(context, &ray, 64, &path[0][0], &count));
    CHECK(count == 64 && apart(path[0], ray.position) < 1e-9 && length(path[63]) > 900.0 * MASS, "%u points", count);
    for (uint32_t i = 1; i < count; i++) {
        CHECK(path[i][3] < path[i - 1][3], "time does not run backward at point %u", i);
    }
    /* Rays of the camera are in its chart; what is traced from them is what pixels show. */
    CHECK_OK(bhr_camera_ray(context, 32, 32, 16.0, 16.0, &ray));
    CHECK_OK(bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit));
    CHECK(ray.frequency_ratio == 1.0 && hit.fate != BHR_FATE_INVALID, "%g", ray.frequency_ratio);
    const double      point[3] = {9.0, 2.0, 3.0};
    BhrProjectedPoint projected;
    BHR_INIT(projected);
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "bhr_project_point",
                bhr_project_point(context, 32, 32, point, 0, &projected));
    /* In STATIC there is no place. */
    camera.chart = BHR_CHART_STATIC;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit));
    CHECK(hit.fate == BHR_FATE_INVALID, "%d", hit.fate);
}

/* Outside, a point is seen at the same place in both charts, if places are told as each has them: here on the axis,
 * where azimuths do not matter, by a camera over a pole of a hole that turns. */
static void points(BhrContext *context) {
    spin_up(context, SPIN);
    const double      point[3] = {0.0, 0.0, -9.0 * MASS};
    BhrProjectedPoint found[2];
    for (int rain = 0; rain < 2; rain++) {
        for (int r = 2; r < 12; r += 7) {
            BhrCamera camera = camera_at(BHR_MOTION_FREE_FALL, r);
            camera.chart = rain ? BHR_CHART_RAIN : BHR_CHART_STATIC;
            camera.fov_y = 2.5;
            CHECK_OK(bhr_set_camera(context, &camera));
            BHR_INIT(found[rain]);
            CHECK_OK(bhr_project_point(context, 32, 32, point, 0, &found[rain]));
        }
    }
    CHECK(fabs(found[0].x - found[1].x) < 1e-6 && fabs(found[0].y - found[1].y) < 1e-6, "(%g, %g) and (%g, %g)",
          found[0].x, found[0].y, found[1].x, found[1].y);
    CHECK(fabs(found[0].redshift / found[1].redshift - 1.0) < 1e-8, "%g", found[1].redshift);
}

/* ---- bad input, and hosts of yesterday ---- */

static void refusals(Watch *watch, BhrContext *context) {
    static const int32_t unknown[] = {-1, 2, 77, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        BhrCamera camera = watch->camera;
        camera.chart = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "chart", bhr_set_camera(context, &camera));
        camera = watch->camera;
        camera.transport = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "transport", bhr_set_camera(context, &camera));
    }
}

static void impossible(BhrContext *context) {
    spin_up(context, SPIN);
    static unsigned char pixels[16 * 16 * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels, sizeof pixels);
    BhrCamera            camera = camera_at(BHR_MOTION_STATIC, 1.2);
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "STATIC", bhr_render_image(context, &image));
    camera.motion = BHR_MOTION_ORBIT;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "ORBIT", bhr_render_image(context, &image));
    camera = camera_at(BHR_MOTION_FREE_FALL, 0.5);
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "r-", bhr_render_image(context, &image));
    double rate = info_of(context).camera_time_rate;
    CHECK(isnan(rate), "%g", rate);
    /* A host that was compiled before there were charts. */
    camera = camera_at(BHR_MOTION_FREE_FALL, 1.2);
    camera.struct_size = offsetof(BhrCamera, chart);
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "BHR_CHART_RAIN", bhr_render_image(context, &image));
    camera.struct_size = sizeof camera;
    CHECK_OK(bhr_get_camera(context, &camera));
    CHECK(camera.chart == BHR_CHART_STATIC && camera.transport == BHR_TRANSPORT_TRIAD, "%d", camera.chart);
    camera = camera_at(BHR_MOTION_VELOCITY, 1.2);
    camera.velocity[0] = 0.5;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_render_image(context, &image));
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    BhrContext      *context = check_context(backend);
    static Watch     watch;
    watch_begin(&watch, context);
    refusals(&watch, context);
    a_fall(context);
    parallel_axes(context);
    rays(context);
    points(context);
    impossible(context);
    bhr_context_destroy(context);
    return check_end();
}
