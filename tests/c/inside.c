/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* inside.c -- cameras in the chart RAIN: a fall through the horizon of a spinning hole to the inner one, as hosts film
 * it; axes carried along in parallel (de Sitter 1916); rays, paths and points in the chart; hosts whose BhrCamera has
 * no chart yet; holes of spin 1, which rays and cameras have and frames do not; and what is not possible. M = 2. */
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

/* How near a ray's path comes to a point; parabolas through three points each. */
static double nearest(BhrContext *context, const BhrRay *ray, const double point[3]) {
    enum { COUNT = 65536 };
    static double path[COUNT][4];
    uint32_t      count = 0, best = 1;
    CHECK_OK(bhr_trace_path(context, ray, COUNT, &path[0][0], &count));
    for (uint32_t i = 1; i + 1 < count; i++) {
        best = apart(path[i], point) < apart(path[best], point) ? i : best;
    }
    double low = -1.0, high = 1.0, least = 0.0;
    for (int i = 0; i < 80; i++) {
        double far[2];
        for (int side = 0; side < 2; side++) {
            const double x = side == 0 ? low + 0.382 * (high - low) : high - 0.382 * (high - low);
            double       place[3];
            for (int k = 0; k < 3; k++) {
                const double a = path[best - 1][k], b = path[best][k], c = path[best + 1][k];
                place[k] = b + 0.5 * x * (c - a) + 0.5 * x * x * (a + c - 2.0 * b);
            }
            far[side] = apart(place, point);
        }
        if (far[0] < far[1]) {
            high = high - 0.382 * (high - low);
        } else {
            low = low + 0.382 * (high - low);
        }
        least = fmin(far[0], far[1]);
    }
    return least;
}

/* From inside a spinning hole the rays that are told pass their points; the pictures of cameras on both sides of the
 * horizon have them at the same places. */
static void points_inside(BhrContext *context) {
    static const double points[][3] = {{9.0, 2.0, 3.0}, {-6.0, 7.0, -1.0}, {-20.0, -30.0, 0.0}, {0.0, 2.5, 1.5}};
    static const double radii[] = {0.6, 0.9, 1.3, 1.43, 1.44, 1.6};
    const double        outer = 1.0 + sqrt(1.0 - SPIN * SPIN);
    spin_up(context, SPIN);
    for (size_t i = 0; i < COUNT_OF(points); i++) {
        double point[3];
        for (int k = 0; k < 3; k++) {
            point[k] = points[i][k] * MASS;
        }
        for (size_t j = 0; j < COUNT_OF(radii); j++) {
            for (uint32_t order = 0; order < 2; order++) {
                BhrCamera camera = camera_at(BHR_MOTION_VELOCITY, radii[j]);
                camera.velocity[0] = 0.1, camera.velocity[2] = -0.2;
                CHECK_OK(bhr_set_camera(context, &camera));
                BhrProjectedPoint found;
                BHR_INIT(found);
                CHECK_OK(bhr_project_point(context, 64, 64, point, order, &found));
                CHECK(found.found == 1 && found.redshift > 0.0 && found.delay > 0.0 && isfinite(found.magnification),
                      "point %u from r = %g M: found %u", (unsigned)i, radii[j], found.found);
                const double miss = nearest(context, &found.ray, point) / apart(point, camera.position);
                CHECK(miss < 1e-8, "point %u, order %u from r = %g M: missed by %g", (unsigned)i, (unsigned)order,
                      radii[j], miss);
                if (found.on_screen) {
                    BhrRay ray;
                    CHECK_OK(bhr_camera_ray(context, 64, 64, found.x, found.y, &ray));
                    CHECK(apart(ray.direction, found.ray.direction) < 1e-9, "%g",
                          apart(ray.direction, found.ray.direction));
                }
            }
        }
        BhrProjectedPoint both[2];
        for (int side = 0; side < 2; side++) {
            BhrCamera camera = camera_at(BHR_MOTION_FREE_FALL, outer * (side == 0 ? 1.0 + 1e-6 : 1.0 - 1e-6));
            camera.projection = BHR_PROJECTION_EQUIRECT;
            CHECK_OK(bhr_set_camera(context, &camera));
            BHR_INIT(both[side]);
            CHECK_OK(bhr_project_point(context, 360, 180, point, 0, &both[side]));
        }
        CHECK(hypot(both[0].x - both[1].x, both[0].y - both[1].y) < 1e-3 &&
                  fabs(both[0].redshift / both[1].redshift - 1.0) < 1e-4 &&
                  fabs(both[0].delay / both[1].delay - 1.0) < 1e-4,
              "(%g, %g) and (%g, %g)", both[0].x, both[0].y, both[1].x, both[1].y);
    }
    /* A point inside has no image that is looked for. */
    const double      within[3] = {0.5 * MASS, 0.5 * MASS, 0.5 * MASS};
    BhrProjectedPoint found;
    BHR_INIT(found);
    CHECK_OK(bhr_project_point(context, 64, 64, within, 0, &found));
    CHECK(found.found == 0 && found.lost == 0, "%u, %u", found.found, found.lost);
}

/* ---- spins of 1 ---- */

/* A ray of the reference (tests/golden/worldlines.json): spin 1, r = 1.1 M, 70 degrees, azimuth 0. */
typedef struct FastRay {
    double look[3], sky[3], redshift;
    double radius, azimuth; /* Of its crossing, in RAIN; 0: it has none. */
} FastRay;

static const FastRay FAST_RAYS[] = {
    {{0.875, 0.17543398929568, -0.45121825694425},
     {0.93605175067069, 0.011534608417445, 0.35167324731204},
     0.44631834383794, 0.0, 0.0},
    {{0.625, -0.70005086633365, 0.34540379926327},
     {0.53503346168807, 0.40598916699646, 0.7408859501675},
     0.74437509036542, 0.0, 0.0},
    {{-0.375, 0.74718540905431, -0.5487157410685},
     {0.82737758385037, -0.42668505835102, -0.3652207479346},
     0.93327082809769, 2.1566211986737, -0.20468282036935},
    {{-0.625, -0.77605953365534, -0.084300653749919},
     {-0.5539173932879, -0.16796551742014, 0.81545270026589},
     2.2503783108505, 0.0, 0.0},
};

static void fast_rays(BhrContext *context) {
    const double theta = 70.0 * PI / 180.0, r = 1.1 * MASS;
    BhrCamera    camera = camera_at(BHR_MOTION_FREE_FALL, 5.0);
    camera.position[0] = r * sin(theta), camera.position[1] = 0.0, camera.position[2] = r * cos(theta);
    CHECK_OK(bhr_set_camera(context, &camera));
    BhrRay all[COUNT_OF(FAST_RAYS)];
    BhrHit hits[COUNT_OF(FAST_RAYS)];
    for (size_t i = 0; i < COUNT_OF(FAST_RAYS); i++) {
        const double *look = FAST_RAYS[i].look;
        const BhrRay  ray = {{camera.position[0], 0.0, camera.position[2]},
                             {look[0] * sin(theta) + look[1] * cos(theta), look[2],
                              look[0] * cos(theta) - look[1] * sin(theta)},
                             1.0};
        all[i] = ray;
    }
    CHECK_OK(bhr_trace_rays(context, all, sizeof all[0], COUNT_OF(FAST_RAYS), hits, sizeof hits[0]));
    for (size_t i = 0; i < COUNT_OF(FAST_RAYS); i++) {
        const FastRay *expected = &FAST_RAYS[i];
        CHECK(hits[i].fate == BHR_FATE_ESCAPED && apart(hits[i].sky_direction, expected->sky) < 1e-8,
              "ray %u: fate %d, off by %g", (unsigned)i, hits[i].fate, apart(hits[i].sky_direction, expected->sky));
        CHECK(fabs(hits[i].sky_redshift / expected->redshift - 1.0) < 1e-10, "ray %u: %.14g", (unsigned)i,
              hits[i].sky_redshift);
        CHECK(hits[i].crossing_count == (expected->radius > 0.0), "ray %u: %u crossings", (unsigned)i,
              (unsigned)hits[i].crossing_count);
        if (expected->radius > 0.0) {
            const BhrCrossing *crossing = &hits[i].crossings[0];
            CHECK(fabs(crossing->radius / MASS - expected->radius) < 1e-8, "at %.14g", crossing->radius / MASS);
            CHECK(crossing->redshift > 0.0 && isfinite(crossing->redshift + crossing->delay + crossing->azimuth),
                  "redshift %g, delay %g, azimuth %g", crossing->redshift, crossing->delay, crossing->azimuth);
        }
    }
    double   path[32][4];
    uint32_t count = 0;
    CHECK_OK(bhr_trace_path(context, &all[2], 32, &path[0][0], &count));
    for (uint32_t i = 1; i < count; i++) {
        CHECK(isfinite(length(path[i])) && path[i][3] < path[i - 1][3], "point %u", i);
    }
    /* A camera in both charts: what its pixels see differs by an azimuth. */
    BhrHit seen[2];
    for (int chart = 0; chart < 2; chart++) {
        BhrRay ray;
        camera.chart = chart;
        CHECK_OK(bhr_set_camera(context, &camera));
        CHECK_OK(bhr_camera_ray(context, 32, 32, 5.0, 11.0, &ray));
        CHECK_OK(bhr_trace_rays(context, &ray, sizeof ray, 1, &seen[chart], sizeof seen[chart]));
    }
    CHECK(seen[0].fate == seen[1].fate && seen[0].fate == BHR_FATE_ESCAPED, "%d, %d", seen[0].fate, seen[1].fate);
    CHECK(fabs(seen[0].sky_redshift / seen[1].sky_redshift - 1.0) < 1e-9 &&
              fabs(seen[0].sky_direction[2] - seen[1].sky_direction[2]) < 1e-8,
          "g %.12g and %.12g, z %.12g and %.12g", seen[0].sky_redshift, seen[1].sky_redshift,
          seen[0].sky_direction[2], seen[1].sky_direction[2]);
}

/* Calls that the context refuses at its spin, and changes nothing by. */
static void no_frames(BhrContext *context) {
    static const char    limit[] = "[-0.9999, 0.9999]";
    static unsigned char pixels[16 * 16 * 4];
    static float         depths[16 * 16];
    memset(pixels, UNTOUCHED, sizeof pixels), memset(depths, UNTOUCHED, sizeof depths);
    BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels, sizeof pixels);
    const BhrImage depth = image_of(BHR_FORMAT_R32F, 16, 16, depths, sizeof depths);
    BhrOutput      output;
    BHR_INIT(output);
    output.kind = BHR_OUTPUT_DEPTH, output.image = &depth;
    BhrJob     *job = NULL;
    BhrRay      ray = {{9.0 * MASS, 0.0, 0.0}, {-1.0, 0.1, 0.2}, 1.0};
    BhrTransfer transfer;
    memset(&transfer, UNTOUCHED, sizeof transfer);
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, limit, bhr_render_image(context, &image));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, limit, bhr_render_image_async(context, &image, &job));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, limit, bhr_render_outputs(context, &output, sizeof output, 1, NULL));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, limit, bhr_prepare(context, &image));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, limit, bhr_prepare(context, NULL));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, limit,
                bhr_transfer_rays(context, &ray, sizeof ray, 1, &transfer, sizeof transfer));
    CHECK(job == NULL && all_untouched(pixels, sizeof pixels) && all_untouched(depths, sizeof depths) &&
              all_untouched(&transfer, sizeof transfer),
          "a refused call wrote");
}

static void fast_numbers(BhrContext *context, double spin) {
    const BhrHoleInfo info = info_of(context);
    const double      co = spin > 0.0 ? info.isco_prograde : info.isco_retrograde;
    const double      counter = spin > 0.0 ? info.isco_retrograde : info.isco_prograde;
    const double      slack = fabs(spin) == 1.0 ? 1e-12 : 0.2; /* cbrt(4e-6) = 0.016 */
    CHECK(fabs(info.horizon_radius / MASS - 1.0) < slack && fabs(info.inner_horizon_radius / MASS - 1.0) < slack &&
              fabs(co / MASS - 1.0) < slack && fabs(counter / MASS - 9.0) < slack,
          "r+ %.15g, r- %.15g, ISCOs %.15g and %.15g", info.horizon_radius, info.inner_horizon_radius, co, counter);
    CHECK(fabs(fmax(info.photon_orbit_prograde, info.photon_orbit_retrograde) / MASS - 4.0) < slack &&
              fmin(info.photon_orbit_prograde, info.photon_orbit_retrograde) >= info.horizon_radius,
          "photon orbits %.17g, %.17g", info.photon_orbit_prograde, info.photon_orbit_retrograde);
    double       metric[16];
    const double place[3] = {0.3 * MASS, 1.2 * MASS, 0.1 * MASS};
    CHECK_OK(bhr_metric_at(context, place, metric));
    for (int i = 0; i < 16; i++) {
        CHECK(isfinite(metric[i]), "g[%d] = %g", i, metric[i]);
    }
}

static void fast_cameras(BhrContext *context) {
    /* A fall, whose clock shows the rain time: the way ends where the two horizons are one. */
    BhrCamera camera = camera_at(BHR_MOTION_FREE_FALL, 3.0);
    double    passed;
    CHECK_OK(bhr_camera_advance(context, &camera, 1.0 * MASS, &passed));
    CHECK(fabs(passed - MASS) < 1e-9 && length(camera.position) > MASS && length(camera.position) < 3.0 * MASS,
          "%g at %g", passed, length(camera.position));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "inner horizon", bhr_camera_advance(context, &camera, 9.0 * MASS, NULL));
    camera = camera_at(BHR_MOTION_ORBIT, 1.2);
    CHECK_OK(bhr_camera_orbit(&camera, 9.5 * MASS, 0.0, 0.0));
    const BhrCamera before = camera;
    CHECK_OK(bhr_camera_advance(context, &camera, 20.0, &passed));
    CHECK(fabs(length(camera.position) - 9.5 * MASS) < 1e-9 && apart(camera.position, before.position) > 1.0 &&
              passed > 20.0,
          "%g, %g", length(camera.position), passed);
    /* A point behind the hole is seen, and the ray that is told passes it. */
    camera = camera_at(BHR_MOTION_STATIC, 8.0);
    CHECK_OK(bhr_set_camera(context, &camera));
    const double      point[3] = {-7.0 * MASS, 2.0 * MASS, 1.0 * MASS};
    BhrProjectedPoint found;
    BHR_INIT(found);
    CHECK_OK(bhr_project_point(context, 32, 32, point, 0, &found));
    CHECK(found.found == 1 && found.redshift > 0.0 && isfinite(found.magnification) && found.delay > 0.0,
          "found %u, lost %u, g %g", found.found, found.lost, found.redshift);
}

static void fast_holes(BhrContext *context) {
    static unsigned char pixels[16 * 16 * 4], again[16 * 16 * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels, sizeof pixels);
    BhrImage             image_again = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, again, sizeof again);
    BhrCamera            camera = camera_at(BHR_MOTION_STATIC, 9.0);
    spin_up(context, SPIN);
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_render_image(context, &image));
    static const double spins[] = {1.0, -1.0, 0.99995, 1.0 - 1e-6, 1e-12 - 1.0};
    for (size_t i = 0; i < COUNT_OF(spins); i++) {
        double mass, spin, axis[3];
        CHECK_OK(bhr_set_spin(context, spins[i]));
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "[-1, 1]", bhr_set_spin(context, 1.0000001));
        CHECK_OK(bhr_set_camera(context, &camera));
        no_frames(context);
        CHECK_OK(bhr_get_hole(context, &mass, &spin, axis));
        CHECK(spin == spins[i], "%.17g", spin);
        fast_numbers(context, spin);
        fast_cameras(context);
    }
    CHECK_OK(bhr_set_spin(context, 1.0));
    fast_rays(context);
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "spin is 1;", bhr_render_image(context, &image_again));
    CHECK_OK(bhr_set_spin(context, SPIN));
    CHECK_OK(bhr_render_image(context, &image_again));
    CHECK(memcmp(pixels, again, sizeof pixels) == 0, "a frame after refused ones is another");
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
    points_inside(context);
    fast_holes(context);
    impossible(context);
    bhr_context_destroy(context);
    return check_end();
}
