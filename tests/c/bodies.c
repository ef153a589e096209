/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bodies.c -- world lines of bodies in free fall (bhr_world_line) against closed forms: a fall from rest at infinity
 * (Painleve 1921, Gullstrand 1922), a circular orbit (Bardeen, Press & Teukolsky 1972), energy and angular momentum by
 * bhr_metric_at, the ends of lines at horizons; and arguments that are none. M = 2, about an axis of its own. */
#include "check.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define MASS 2.0
#define SPIN 0.9

/* ---- the scene's axes ---- */

static const double AXIS[3] = {0.48, 0.64, 0.6};

/* The hole's chart in scene axes, by the shortest rotation that takes +z to the axis: its columns are x, y and z. */
static double chart_axes[3][3];

static void set_chart_axes(void) {
    const double f = 1.0 / (1.0 + AXIS[2]);
    const double x[3] = {1.0 - f * AXIS[0] * AXIS[0], -f * AXIS[0] * AXIS[1], -AXIS[0]};
    const double y[3] = {-f * AXIS[0] * AXIS[1], 1.0 - f * AXIS[1] * AXIS[1], -AXIS[1]};
    for (int k = 0; k < 3; k++) {
        chart_axes[k][0] = x[k], chart_axes[k][1] = y[k], chart_axes[k][2] = AXIS[k];
    }
}

static void in_scene(double to[3], double scale, double x, double y, double z) {
    for (int k = 0; k < 3; k++) {
        to[k] = scale * (chart_axes[k][0] * x + chart_axes[k][1] * y + chart_axes[k][2] * z);
    }
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length(const double a[3]) {
    return sqrt(dot(a, a));
}

static double distance(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return length(d);
}

/* A body at chart coordinates, M, with a velocity along the chart's axes. */
static BhrBody body_at(BhrChart chart, double x, double y, double z, double vx, double vy, double vz) {
    BhrBody body;
    BHR_INIT(body);
    body.chart = chart;
    in_scene(body.position, MASS, x, y, z);
    in_scene(body.velocity, 1.0, vx, vy, vz);
    return body;
}

static BhrBody followed(BhrContext *context, const BhrBody *body, double proper_time) {
    BhrBody found;
    memset(&found, UNTOUCHED, sizeof found);
    CHECK_OK(bhr_world_line(context, body, &proper_time, 1, &found, sizeof found));
    CHECK(found.struct_size == sizeof found && found.chart == body->chart && found.reserved == 0, "size %u, chart %d",
          (unsigned)found.struct_size, (int)found.chart);
    return found;
}

/* ---- physics ---- */

/* From rest at infinity without spin: r^(3/2) falls by (3/2) sqrt(2 M) in each proper length, which the rain observer's
 * clock shows. */
static void fall_without_spin(BhrContext *context) {
    CHECK_OK(bhr_set_spin(context, 0.0));
    const BhrBody start = body_at(BHR_CHART_RAIN, 6.0, 8.0, 0.0, 0.0, 0.0, 0.0);
    const double  r0 = 10.0, whole = pow(r0, 1.5) / (1.5 * sqrt(2.0));
    for (int i = -8; i < 16; i++) {
        const double  proper = whole * i / 16.0, r = pow(r0, 1.5) - 1.5 * sqrt(2.0) * proper;
        const BhrBody found = followed(context, &start, MASS * proper);
        double        place[3];
        in_scene(place, MASS * pow(r, 2.0 / 3.0) / r0, 6.0, 8.0, 0.0);
        CHECK(distance(found.position, place) < 1e-10 * MASS, "after %g M: off by %g", proper,
              distance(found.position, place));
        CHECK(length(found.velocity) < 1e-10, "the rain observer moves: %g", length(found.velocity));
        CHECK(fabs(found.time - MASS * proper) < 1e-10 * MASS, "its clock is at %.15g", found.time);
        CHECK(found.proper_time == MASS * proper && found.end == BHR_WORLD_LINE_GOES_ON, "end %d", (int)found.end);
    }
    const BhrBody end = followed(context, &start, MASS * 1.001 * whole);
    CHECK(end.end == BHR_WORLD_LINE_INNER_HORIZON && fabs(length(end.position) / (MASS * 1e-9) - 1.0) < 1e-6,
          "end %d at %g", (int)end.end, length(end.position));
    CHECK(fabs(end.proper_time / (MASS * whole) - 1.0) < 1e-10, "after %.15g", end.proper_time);
    /* Told by the static observer the same fall has the speed sqrt(2 / r), and does not pass the horizon. */
    const double  v = sqrt(2.0 / r0);
    const BhrBody outside = body_at(BHR_CHART_STATIC, 6.0, 8.0, 0.0, -0.6 * v, -0.8 * v, 0.0);
    const BhrBody held = followed(context, &outside, MASS * whole);
    const double  to_horizon = (pow(r0, 1.5) - pow(2.0, 1.5)) / (1.5 * sqrt(2.0));
    CHECK(held.end == BHR_WORLD_LINE_HORIZON && fabs(length(held.position) / (2.0 * MASS) - 1.0) < 1.1e-6,
          "end %d at %g", (int)held.end, length(held.position));
    CHECK(fabs(held.proper_time / MASS - to_horizon) < 1e-5, "after %g M, not %g M", held.proper_time / MASS,
          to_horizon);
    const BhrBody halfway = followed(context, &outside, MASS * 0.5 * to_horizon);
    const double  r = pow(pow(r0, 1.5) - 0.75 * sqrt(2.0) * to_horizon, 2.0 / 3.0);
    CHECK(fabs(length(halfway.position) / MASS - r) < 1e-10, "r = %.15g", length(halfway.position) / MASS);
    CHECK(fabs(length(halfway.velocity) - sqrt(2.0 / r)) < 1e-10, "v = %.15g", length(halfway.velocity));
    CHECK_OK(bhr_set_spin(context, SPIN));
}

/* A circle in the equatorial plane at r = 10 M: d ph / d t = 1 / (r^(3/2) + a), and after a turn all is as it was. */
static void circle(BhrContext *context, double a) {
    CHECK_OK(bhr_set_spin(context, a));
    const double  r = 10.0, root = sqrt(r);
    const double  delta = r * r - 2.0 * r + a * a, rate = 1.0 / (r * root + a);
    const double  v = (r * r - 2.0 * a * root + a * a) / (sqrt(delta) * (r * root + a));
    const double  ut = (1.0 + a / (r * root)) / sqrt(1.0 - 3.0 / r + 2.0 * a / (r * root));
    const double  turn = 2.0 * PI / rate;
    const BhrBody start = body_at(BHR_CHART_STATIC, r, 0.0, 0.0, 0.0, v, 0.0);
    for (int quarter = -4; quarter <= 8; quarter++) {
        const double  time = 0.25 * quarter * turn, ph = time * rate;
        const BhrBody found = followed(context, &start, MASS * time / ut);
        double        place[3], velocity[3];
        in_scene(place, MASS * r, cos(ph), sin(ph), 0.0);
        in_scene(velocity, v, -sin(ph), cos(ph), 0.0);
        CHECK(distance(found.position, place) < 1e-8 * MASS, "%d quarters: off by %g", quarter,
              distance(found.position, place));
        CHECK(distance(found.velocity, velocity) < 1e-9, "%d quarters: the velocity is off by %g", quarter,
              distance(found.velocity, velocity));
        CHECK(fabs(found.time - MASS * time) < 1e-8 * MASS, "%d quarters: at the time %.15g", quarter, found.time);
    }
    /* docs/cameras.md says how long a line may be. */
    const BhrBody later = followed(context, &start, MASS * 1e5);
    const double  ph = 1e5 * ut * rate;
    double        place[3];
    in_scene(place, MASS * r, cos(ph), sin(ph), 0.0);
    CHECK(distance(later.position, place) < 1e-5 * MASS && later.end == BHR_WORLD_LINE_GOES_ON,
          "after 1e5 M: off by %g", distance(later.position, place));
    CHECK_OK(bhr_set_spin(context, SPIN));
}

/* About a hole of spin 1 or -1: a fall from rest at infinity in the plane, after the proper time that the integral of
 * r^2 / sqrt(2 r (r^2 + 1)) says, to r = 1; and a line of the reference (tests/golden/worldlines.json). */
static void fastest(BhrContext *context) {
    for (double spin = -1.0; spin < 2.0; spin += 2.0) {
        CHECK_OK(bhr_set_spin(context, spin));
        const BhrBody start = body_at(BHR_CHART_RAIN, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0);
        enum { STEPS = 200 };
        for (double r = 3.5; r > 1.0; r -= 0.249) {
            double proper = 0.0;
            for (int i = 0; i <= STEPS; i++) {
                const double x = r + (4.0 - r) * i / STEPS;
                const int    weight = i == 0 || i == STEPS ? 1 : 2 + 2 * (i % 2); /* Simpson's rule */
                proper += weight * (4.0 - r) / (3.0 * STEPS) * x * x / sqrt(2.0 * x * (x * x + 1.0));
            }
            const BhrBody found = followed(context, &start, MASS * proper);
            CHECK(found.end == BHR_WORLD_LINE_GOES_ON && fabs(length(found.position) / MASS - r) < 1e-9,
                  "%.14g, not %g", length(found.position) / MASS, r);
            CHECK(distance(found.position, start.position) < 4.0 * MASS - length(found.position) + 1e-9 &&
                      fabs(found.time - MASS * proper) < 1e-9 * MASS && length(found.velocity) < 1e-9,
                  "the rain observer moves: %g", length(found.velocity));
        }
        const BhrBody end = followed(context, &start, MASS * 10.0);
        CHECK(end.end == BHR_WORLD_LINE_INNER_HORIZON && fabs(length(end.position) / MASS - 1.0) < 1.1e-6,
              "end %d at r = %.12g M", (int)end.end, length(end.position) / MASS);
        const BhrBody zamo = body_at(BHR_CHART_STATIC, 4.0, 0.0, 1.0, -0.1, 0.2, -0.1);
        const BhrBody held = followed(context, &zamo, 1000.0);
        CHECK(held.end == BHR_WORLD_LINE_HORIZON && fabs(length(held.position) / MASS - 1.0) < 1.1e-6 &&
                  isfinite(held.time),
              "end %d at r = %.12g M", (int)held.end, length(held.position) / MASS);
    }
    const double  theta = 70.0 * PI / 180.0, s = sin(theta), c = cos(theta);
    const BhrBody start = body_at(BHR_CHART_RAIN, 5.0 * s, 0.0, 5.0 * c, 0.62 * s - 0.1 * c, 0.42, 0.62 * c + 0.1 * s);
    const BhrBody found = followed(context, &start, 200.0 * MASS);
    CHECK(fabs(length(found.position) / MASS - 35.962884854654) < 1e-8, "%.14g", length(found.position) / MASS);
    CHECK_OK(bhr_set_spin(context, SPIN));
}

/* E and L per mass, of a body told by the ZAMO, from the metric there. */
static void constants(BhrContext *context, const BhrBody *body, double out[2]) {
    double metric[16], around[3], e_ph[3];
    CHECK_OK(bhr_metric_at(context, body->position, metric));
    const double v2 = dot(body->velocity, body->velocity), gamma = 1.0 / sqrt(1.0 - v2);
    /* e_ph = axis x position, as long as 1. */
    for (int k = 0; k < 3; k++) {
        around[k] = AXIS[(k + 1) % 3] * body->position[(k + 2) % 3] - AXIS[(k + 2) % 3] * body->position[(k + 1) % 3];
    }
    for (int k = 0; k < 3; k++) {
        e_ph[k] = around[k] / length(around);
    }
    const double g_tph = metric[3], g_phph = metric[15];
    const double lapse = sqrt(g_tph * g_tph / g_phph - metric[0]), omega = -g_tph / g_phph;
    out[1] = gamma * sqrt(g_phph) * dot(body->velocity, e_ph);
    out[0] = gamma * lapse + omega * out[1];
}

/* An eccentric, inclined orbit keeps E and L, and goes back the way that it came; a hasty body, too. */
static void conserved(BhrContext *context) {
    const BhrBody starts[] = {body_at(BHR_CHART_STATIC, 8.0, 0.0, 3.0, 0.05, 0.34, 0.1),
                              body_at(BHR_CHART_STATIC, 0.0, -5.0, 1.0, -0.3, 0.1, -0.4),
                              body_at(BHR_CHART_STATIC, 30.0, 5.0, -9.0, -0.9, 0.2, 0.1)};
    for (size_t i = 0; i < COUNT_OF(starts); i++) {
        enum { COUNT = 40 };
        double  times[COUNT], first[2];
        BhrBody found[COUNT];
        for (int k = 0; k < COUNT; k++) {
            times[k] = 25.0 * (k - COUNT / 2);
        }
        CHECK_OK(bhr_world_line(context, &starts[i], times, COUNT, found, sizeof found[0]));
        constants(context, &starts[i], first);
        for (int k = 0; k < COUNT; k++) {
            double now[2];
            if (found[k].end != BHR_WORLD_LINE_GOES_ON) {
                continue; /* beside the horizon gamma is without end */
            }
            constants(context, &found[k], now);
            CHECK(fabs(now[0] - first[0]) < 1e-9 && fabs(now[1] - first[1]) < 1e-8 * MASS,
                  "line %u at %g: E is off by %g, L by %g", (unsigned)i, times[k], now[0] - first[0],
                  now[1] - first[1]);
            const BhrBody back = followed(context, &found[k], -times[k]);
            CHECK(distance(back.position, starts[i].position) < 1e-7 &&
                      distance(back.velocity, starts[i].velocity) < 1e-8 && fabs(back.time) < 1e-6,
                  "line %u back from %g: off by %g, in time by %g", (unsigned)i, times[k],
                  distance(back.position, starts[i].position), back.time);
        }
    }
}

/* A fall through r+ of a spinning hole: in RAIN to r-, in STATIC to r+. */
static void through_the_horizon(BhrContext *context) {
    const double  outer = 1.0 + sqrt(1.0 - SPIN * SPIN), inner = 1.0 - sqrt(1.0 - SPIN * SPIN);
    const BhrBody rain = body_at(BHR_CHART_RAIN, 4.0, 0.0, 1.0, 0.1, 0.2, -0.1);
    const BhrBody end = followed(context, &rain, 1000.0);
    CHECK(end.end == BHR_WORLD_LINE_INNER_HORIZON && fabs(length(end.position) / (MASS * inner) - 1.0) < 1.1e-6,
          "end %d at r = %.12g M", (int)end.end, length(end.position) / MASS);
    CHECK(end.proper_time > 0.0 && end.proper_time < 20.0 * MASS && length(end.velocity) < 1.0, "after %g",
          end.proper_time);
    const BhrBody zamo = body_at(BHR_CHART_STATIC, 4.0, 0.0, 1.0, -0.1, 0.2, -0.1);
    const BhrBody held = followed(context, &zamo, 1000.0);
    CHECK(held.end == BHR_WORLD_LINE_HORIZON && fabs(length(held.position) / (MASS * outer) - 1.0) < 1.1e-6,
          "end %d at r = %.12g M", (int)held.end, length(held.position) / MASS);
    CHECK(held.proper_time > 0.0 && length(held.velocity) < 1.0, "after %g at %.17g", held.proper_time,
          length(held.velocity));
    /* The end lies where the line comes to, not where it was asked for. */
    const BhrBody nearly = followed(context, &rain, 0.999 * end.proper_time);
    CHECK(nearly.end == BHR_WORLD_LINE_GOES_ON && length(nearly.position) > length(end.position), "end %d",
          (int)nearly.end);
    /* From inside on, and out again by the way in. */
    const BhrBody inside = followed(context, &rain, 0.9 * end.proper_time);
    CHECK(length(inside.position) < MASS * outer, "r = %g M", length(inside.position) / MASS);
    const BhrBody again = followed(context, &inside, 0.05 * end.proper_time);
    const BhrBody direct = followed(context, &rain, 0.95 * end.proper_time);
    CHECK(distance(again.position, direct.position) < 1e-9 * MASS, "off by %g",
          distance(again.position, direct.position));
    const BhrBody out = followed(context, &inside, -0.9 * end.proper_time);
    CHECK(distance(out.position, rain.position) < 1e-8 * MASS, "back: off by %g",
          distance(out.position, rain.position));
    BhrBody refused = inside, found;
    refused.chart = BHR_CHART_STATIC;
    const double time = 1.0;
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "r+", bhr_world_line(context, &refused, &time, 1, &found, sizeof found));
}

/* ---- arrays ---- */

/* Each event is that of its time alone, whatever the others are, and the elements of hosts may be longer. */
static void many(BhrContext *context) {
    static const double times[] = {40.0, -3.0, 0.0, 40.0, 12.5, -90.0, 5000.0};
    struct Longer {
        BhrBody body;
        double  later;
    } found[COUNT_OF(times) + 1];
    BhrBody start = body_at(BHR_CHART_STATIC, 9.0, 1.0, -2.0, 0.0, 0.3, 0.1);
    start.time = 11.0;
    memset(found, UNTOUCHED, sizeof found);
    CHECK_OK(bhr_world_line(context, &start, times, COUNT_OF(times), &found[0].body, sizeof found[0]));
    for (size_t i = 0; i < COUNT_OF(times); i++) {
        BhrBody alone = followed(context, &start, times[i]);
        CHECK(found[i].body.struct_size == sizeof found[0] && found[i].later == 0.0, "size %u",
              (unsigned)found[i].body.struct_size);
        alone.struct_size = sizeof found[0];
        CHECK(memcmp(&alone, &found[i].body, sizeof alone) == 0, "time %g differs from itself alone", times[i]);
    }
    CHECK(all_untouched(&found[COUNT_OF(times)], sizeof found[0]), "written beyond the array");
    CHECK(found[2].body.time == 11.0 && distance(found[2].body.position, start.position) < 1e-12, "the start moved");

    /* A longer struct of the host's, 0 beyond; arrays without alignment; and the body in the place of its own end. */
    struct Longer longer;
    unsigned char loose[2 * sizeof(BhrBody) + sizeof(double) + 2];
    memset(&longer, 0, sizeof longer);
    longer.body = start;
    longer.body.struct_size = sizeof longer;
    longer.body.proper_time = NAN, longer.body.end = -7; /* outputs: not read */
    memcpy(loose + 1, times, sizeof(double));
    CHECK_OK(bhr_world_line(context, &longer.body, (const double *)(const void *)(loose + 1), 1,
                            (BhrBody *)(void *)(loose + 11), sizeof(BhrBody)));
    memcpy(&longer.body, loose + 11, sizeof(BhrBody));
    CHECK(distance(longer.body.position, found[0].body.position) == 0.0, "a loose array differs");
    BhrBody self = start;
    CHECK_OK(bhr_world_line(context, &self, times, 1, &self, sizeof self));
    CHECK(distance(self.position, found[0].body.position) == 0.0 && self.proper_time == times[0], "in its own place");
}

/* ---- arguments that are none ---- */

static int is_clear(const void *memory, size_t size) {
    const unsigned char *bytes = memory;
    while (size > 0 && bytes[size - 1] == 0) {
        size--;
    }
    return size == 0;
}

/* The call is refused, and leaves nothing but zeros. */
static void refused(Watch *watch, BhrStatus status, const char *words, const BhrBody *body, double time) {
    const double times[2] = {1.0, time};
    BhrBody      out[3];
    memset(out, UNTOUCHED, sizeof out);
    CHECK_REFUSED(watch, status, words, bhr_world_line(watch->context, body, times, 2, out, sizeof out[0]));
    CHECK(is_clear(out, 2 * sizeof out[0]), "a call that fails leaves bodies");
    CHECK(all_untouched(&out[2], sizeof out[2]), "written beyond the array");
}

static void bad_arguments(Watch *watch, BhrContext *context) {
    static const double not_finite[] = {NAN, INFINITY, -INFINITY};
    const BhrBody       good = body_at(BHR_CHART_STATIC, 10.0, 0.0, 0.0, 0.0, 0.3, 0.0);
    const double        times[2] = {1.0, 2.0};
    BhrBody             out[2], body = good;
    memset(out, UNTOUCHED, sizeof out);
    CHECK_OK(bhr_world_line(context, NULL, NULL, 0, NULL, sizeof out[0]));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_world_line(NULL, &good, times, 2, out, sizeof out[0]));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "proper_times",
                  bhr_world_line(context, &good, NULL, 2, out, sizeof out[0]));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_bodies",
                  bhr_world_line(context, &good, times, 2, NULL, sizeof out[0]));
    static const size_t sizes[] = {0, 4, FIRST_BODY - 1, 1u << 20, SIZE_MAX};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "body_size",
                      bhr_world_line(context, &good, times, 2, out, sizes[i]));
    }
    static const size_t counts[] = {SIZE_MAX, SIZE_MAX / 8, SIZE_MAX / 80 / 2 + 1};
    for (size_t i = 0; i < COUNT_OF(counts); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "count",
                      bhr_world_line(context, &good, times, counts[i], out, sizeof out[0]));
    }
    CHECK(all_untouched(out, sizeof out), "a refused call wrote to out_bodies");

    refused(watch, BHR_ERROR_INVALID_ARGUMENT, "body is NULL", NULL, 1.0);
    static const uint32_t struct_sizes[] = {0, 4, FIRST_BODY - 1, 1u << 20, UINT32_MAX};
    for (size_t i = 0; i < COUNT_OF(struct_sizes); i++) {
        body.struct_size = struct_sizes[i];
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", &body, 1.0);
    }
    struct {
        BhrBody body;
        double  later;
    } longer = {good, 1.0};
    longer.body.struct_size = sizeof longer;
    refused(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", &longer.body, 1.0);
    static const BhrChart charts[] = {-1, 2, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(charts); i++) {
        body = good, body.chart = charts[i];
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "chart", &body, 1.0);
    }
    body = good, body.reserved = 1;
    refused(watch, BHR_ERROR_INVALID_ARGUMENT, "reserved", &body, 1.0);
    for (size_t i = 0; i < COUNT_OF(not_finite); i++) {
        body = good, body.position[i] = not_finite[i];
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "position", &body, 1.0);
        body = good, body.velocity[i] = not_finite[i];
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "velocity", &body, 1.0);
        body = good, body.time = not_finite[i];
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "time", &body, 1.0);
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "proper_times[1]", &good, not_finite[i]);
    }
    refused(watch, BHR_ERROR_INVALID_ARGUMENT, "1e12", &good, 1.1e12 * MASS);
    refused(watch, BHR_ERROR_INVALID_ARGUMENT, "1e12", &good, -DBL_MAX);
    refused(watch, BHR_ERROR_UNSUPPORTED, "steps", &good, 1e9);
    refused(watch, BHR_ERROR_UNSUPPORTED, "steps", &good, -1e9);
    for (BhrChart chart = BHR_CHART_STATIC; chart <= BHR_CHART_RAIN; chart++) {
        body = body_at(chart, 10.0, 0.0, 0.0, 0.0, 0.8, 0.6000001);
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "velocity", &body, 1.0);
        body.velocity[0] = 1e300;
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "velocity", &body, 1.0);
        body = body_at(chart, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "place", &body, 1.0);
        body = body_at(chart, 1.1e12, 0.0, 0.0, 0.0, 0.0, 0.0);
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "1e12", &body, 1.0);
        body.position[1] = DBL_MAX;
        refused(watch, BHR_ERROR_INVALID_ARGUMENT, "place|1e12", &body, 1.0);
        body = body_at(chart, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0); /* inside r-, 0.564 M */
        refused(watch, BHR_ERROR_UNSUPPORTED, "at or within", &body, 1.0);
    }
    body = body_at(BHR_CHART_STATIC, 1.4, 0.0, 0.0, 0.0, 0.0, 0.0); /* inside r+, 1.436 M */
    refused(watch, BHR_ERROR_UNSUPPORTED, "r+", &body, 1.0);
    body = body_at(BHR_CHART_STATIC, 1.0 + sqrt(1.0 - SPIN * SPIN), 0.0, 0.0, 0.0, 0.0, 0.0);
    refused(watch, BHR_ERROR_UNSUPPORTED, "r+", &body, 1.0);
}

/* ---- contexts on which little is valid ---- */

static void on_log(void *user, BhrLogLevel level, const char *message) {
    BhrBody      body = body_at(BHR_CHART_STATIC, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0), out;
    const double time = 1.0;
    (void)level, (void)message;
    BhrContext *const *const context = user;
    if (*context != NULL) {
        memset(&out, UNTOUCHED, sizeof out);
        CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_world_line(*context, &body, &time, 1, &out, sizeof out));
        CHECK(all_untouched(&out, sizeof out), "a call from a callback writes");
    }
}

static void in_a_callback(BhrBackend backend) {
    BhrContext       *context = NULL;
    BhrContextOptions options = check_options(backend);
    options.log_level = BHR_LOG_ERROR;
    options.log_fn = on_log;
    options.log_user = &context;
    context = check_context_with(&options);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "spin", bhr_set_spin(context, 2.0));
    bhr_context_destroy(context);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    BhrContext      *context = check_context(backend);
    Watch            watch;
    set_chart_axes();
    CHECK_OK(bhr_set_mass(context, MASS));
    CHECK_OK(bhr_set_spin(context, SPIN));
    CHECK_OK(bhr_set_axis(context, AXIS));
    fall_without_spin(context);
    circle(context, SPIN);
    circle(context, 1.0);
    fastest(context);
    conserved(context);
    through_the_horizon(context);
    many(context);
    watch_begin(&watch, context);
    bad_arguments(&watch, context);
    bhr_context_destroy(context);
    in_a_callback(backend);
    return check_end();
}
