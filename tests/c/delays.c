/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* delays.c -- times about a hole without spin: the delay of BhrCrossing and the t of bhr_trace_path, against the
 * orbit equation (Darwin 1959), integrated here: u'' = 3 u^2 - u and dt = d phi / (b u^2 (1 - 2 u)), by RK4 in the
 * angle swept about the hole; and the scene time of a fall through the horizon, against Gullstrand's. M = 1. */
#include "check.h"

#include <math.h>
#include <string.h>

#define MASS 2.0
#define STEPS 20000
#define POINTS 64

/* u = 1/r, du/dphi, and the time gone by. */
typedef struct Light {
    double u, slope, time;
} Light;

static Light rates(double b, Light at) {
    const Light rate = {at.slope, 3.0 * at.u * at.u - at.u, 1.0 / (b * at.u * at.u * (1.0 - 2.0 * at.u))};
    return rate;
}

static Light moved(Light at, Light rate, double h) {
    const Light there = {at.u + h * rate.u, at.slope + h * rate.slope, at.time + h * rate.time};
    return there;
}

/* Where light, seen backward, is `angle` further about the hole; u = 0 when it has escaped before. */
static Light turned(double b, Light at, double angle) {
    const int    steps = (int)ceil(STEPS * angle / PI) + 1;
    const double h = angle / steps;
    for (int i = 0; i < steps; i++) {
        const Light k1 = rates(b, at), k2 = rates(b, moved(at, k1, 0.5 * h));
        const Light k3 = rates(b, moved(at, k2, 0.5 * h)), k4 = rates(b, moved(at, k3, h));
        at = moved(moved(at, k1, h / 6.0), k2, h / 3.0);
        at = moved(moved(at, k3, h / 3.0), k4, h / 6.0);
        if (at.u <= 0.0) {
            at.u = 0.0;
            break;
        }
    }
    return at;
}

/* An observer at rest and where it looks: `psi` off the hole's centre, towards `aside`, a unit vector across the line
 * of sight. */
typedef struct Look {
    double r, inclination, alpha, psi;
    double outward[3], aside[3];
} Look;

static Look look_of(double r, double inclination, double alpha, double psi) {
    const double s = sin(inclination), c = cos(inclination);
    const Look   look = {r, inclination, alpha, psi, {s, 0.0, c}, {-c * cos(alpha), sin(alpha), s * cos(alpha)}};
    return look;
}

static BhrRay ray_of(const Look *look) {
    BhrRay ray = {.frequency_ratio = 1.0};
    for (int k = 0; k < 3; k++) {
        ray.position[k] = MASS * look->r * look->outward[k];
        ray.direction[k] = sin(look->psi) * look->aside[k] - cos(look->psi) * look->outward[k];
    }
    return ray;
}

static double impact_parameter(const Look *look) {
    return look->r * sin(look->psi) / sqrt(1.0 - 2.0 / look->r);
}

static Light at_observer(const Look *look) {
    const double b = impact_parameter(look), u = 1.0 / look->r;
    const Light  light = {u, sqrt(1.0 / (b * b) - u * u * (1.0 - 2.0 * u)), 0.0};
    return light;
}

/* Angle swept until the plane is met for the (order + 1)-th time (Luminet 1979, eq. 10). */
static double swept_to_plane(const Look *look, int order) {
    return atan2(cos(look->inclination), -sin(look->inclination) * cos(look->alpha)) + order * PI;
}

/* How many it had. */
static unsigned crossings(BhrContext *context, const Look *look, double bar) {
    const BhrRay ray = ray_of(look);
    BhrHit       hit;
    CHECK_OK(bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit));
    unsigned     found = 0;
    const double nudge = 1e-7;
    Look         beside = *look;
    beside.psi += nudge;
    for (int order = 0; order < 2; order++) {
        const double angle = swept_to_plane(look, order);
        const Light  there = turned(impact_parameter(look), at_observer(look), angle);
        if (there.u == 0.0) {
            break;
        }
        found++;
        CHECK(hit.crossing_count >= found, "r %g alpha %g: %u crossings", look->r, look->alpha,
              (unsigned)hit.crossing_count);
        const Light  nudged = turned(impact_parameter(&beside), at_observer(&beside), angle);
        const double conditioning = fabs(nudged.time / there.time - 1.0) / nudge;
        const double error = fabs(hit.crossings[order].delay / (MASS * there.time) - 1.0) / (1.0 + conditioning);
        CHECK(error < bar, "r %g alpha %g order %d: delay %.12g, not %.12g: %.1e", look->r, look->alpha, order,
              hit.crossings[order].delay, MASS * there.time, error);
        CHECK(fabs(hit.crossings[order].radius * there.u / MASS - 1.0) < 2e-5 * (1.0 + conditioning),
              "r %g alpha %g order %d: radius %.12g, not %.12g", look->r, look->alpha, order,
              hit.crossings[order].radius, MASS / there.u);
    }
    return found;
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void path(BhrContext *context, const Look *look) {
    static double points[POINTS][4];
    const BhrRay  ray = ray_of(look);
    uint32_t      count = 0;
    CHECK_OK(bhr_trace_path(context, &ray, POINTS, points[0], &count));
    CHECK(count == POINTS, "%u points", (unsigned)count);
    CHECK(points[0][3] == 0.0, "the path begins at t = %g", points[0][3]);
    const double b = impact_parameter(look);
    Light        light = at_observer(look);
    double       swept = 0.0, worst = 0.0;
    /* The last point of a ray that is captured lies at the horizon, where t has no end. */
    for (uint32_t i = 1; i + 1 < count; i++) {
        const double place = atan2(dot(points[i], look->aside), dot(points[i], look->outward));
        const double further = remainder(place - swept, 2.0 * PI);
        CHECK(further > 0.0, "point %u turns back by %g", (unsigned)i, further);
        light = turned(b, light, further);
        swept += further;
        const double r = sqrt(dot(points[i], points[i])), wanted = MASS / light.u;
        const double scale = r - points[i][3];
        /* Per radian, a ray that leads away goes r / (b u) far. */
        const double conditioning = 1.0 / (b * light.u);
        worst = fmax(worst, fabs(points[i][3] + MASS * light.time) / scale / (1.0 + conditioning));
        worst = fmax(worst, fabs(r - wanted) / scale / (1.0 + conditioning));
    }
    CHECK(worst < 1e-9, "r %g alpha %g: the path is off by %.1e", look->r, look->alpha, worst);
}

/* Rain time less t, M = 1 (Gullstrand 1922). */
static double rain_offset(double r) {
    return 2.0 * sqrt(2.0 * r) + 2.0 * log((sqrt(r) - sqrt(2.0)) / (sqrt(r) + sqrt(2.0)));
}

/* Adding up what bhr_camera_advance says gives t outside the horizon and t + rain_offset, which goes on, inside: rain
 * time is proper time. Where the fall is follows from r^(3/2), which shrinks evenly. */
static void fall(BhrContext *context) {
    BhrCamera camera;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    camera.position[0] = 0.0, camera.position[1] = 5.0 * MASS, camera.position[2] = 0.0;
    camera.motion = BHR_MOTION_FREE_FALL;
    double              time = 0.0, proper = 0.0;
    unsigned            inside = 0;
    static const double steps[] = {2.0, 1.0, 0.75, 0.1, 0.01, 0.001, 0.2, 0.5, 0.3, -0.6, -0.5, 1.1};
    for (size_t i = 0; i < COUNT_OF(steps); i++) {
        double elapsed = 0.0;
        CHECK_OK(bhr_camera_advance(context, &camera, steps[i] * MASS, &elapsed));
        time += elapsed / MASS;
        proper += steps[i];
        const double r = sqrt(dot(camera.position, camera.position)) / MASS;
        const double way = pow(5.0, 1.5) - 1.5 * sqrt(2.0) * proper;
        CHECK(fabs(r - pow(way, 2.0 / 3.0)) < 1e-12, "after %g M the fall is at %.15g M", proper, r);
        const double expected = proper + rain_offset(5.0) - (r > 2.0 ? rain_offset(r) : 0.0);
        CHECK(fabs(time - expected) < 1e-10, "at %g M the clock is at %.12g, not %.12g", r, time, expected);
        inside += r <= 2.0;
    }
    CHECK(inside > 1 && inside < COUNT_OF(steps) - 1, "%u places lie inside", inside);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    BhrContext      *context = check_context(backend);
    const double     bar = backend == BHR_BACKEND_CPU ? 1e-9 : 2e-5;
    CHECK_OK(bhr_set_mass(context, MASS));
    unsigned         compared = 0;
    static const double observers[][2] = {{10.0, 1.2}, {40.0, 0.7}, {500.0, 1.4}};
    for (size_t e = 0; e < COUNT_OF(observers); e++) {
        const double r = observers[e][0];
        for (int k = 0; k < 8; k++) {
            /* Outside the critical impact parameter: most go round far enough for two crossings. */
            const double b = k % 2 == 0 ? 5.25 : 5.5;
            const Look   look = look_of(r, observers[e][1], 0.3 + 0.7 * k, asin(b * sqrt(1.0 - 2.0 / r) / r));
            compared += crossings(context, &look, bar);
            path(context, &look);
        }
    }
    CHECK(compared > 40, "%u crossings were compared", compared);
    fall(context);
    bhr_context_destroy(context);
    return check_end();
}
