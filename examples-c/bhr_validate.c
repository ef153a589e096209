/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bhr_validate.c -- compares what libbhr computes with formulas and with numbers that others published: prints each
 * truth with its source, bhr's value, the error and the tolerance, as a table, as Markdown (docs/validation.md) or as
 * JSON. Exits with 1 when one does not hold. Asks the library for rays and numbers only, on the CPU tracer, which
 * traces in double precision; shares no formula of the library's. G = c = M = 1. */
#include "options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum Form { TABLE, MARKDOWN, JSON } Form;

static BhrContext *context;
static Form        form;
static int         count, failed;
static const char *section_source;

/* ---- the report ---- */

static void begin_section(const char *title, const char *source) {
    section_source = source;
    if (form == TABLE) {
        printf("\n%s\n  %s\n", title, source);
    } else if (form == MARKDOWN) {
        printf("\n## %s\n\nSource: %s\n\n", title, source);
        printf("| quantity | truth | bhr | error | tolerance |\n|---|---|---|---|---|\n");
    }
}

/* Errors are relative to truths above 1, absolute else. */
static void compare(const char *what, double truth, double found, double tolerance) {
    const double error = fabs(found - truth) / fmax(1.0, fabs(truth));
    const int    holds = error <= tolerance; /* false for NaN */
    count++;
    failed += !holds;
    if (form == JSON) {
        /* JSON has neither NaN nor infinity. */
        printf("%s  {\"quantity\": \"%s\", \"source\": \"%s\", \"truth\": %.17g, ", count > 1 ? ",\n" : "", what,
               section_source, truth);
        if (!isfinite(found)) {
            printf("\"value\": null, \"error\": null, ");
        } else {
            printf("\"value\": %.17g, \"error\": %.3g, ", found, error);
        }
        printf("\"tolerance\": %g, \"holds\": %s}", tolerance, holds ? "true" : "false");
    } else if (form == MARKDOWN) {
        printf("| %s | %.12g | %.12g | %.1e | %.0e |%s\n", what, truth, found, error, tolerance,
               holds ? "" : " **does not hold**");
    } else {
        printf("  %s  %-58s %.12g  error %.1e of %.0e\n", holds ? "ok  " : "FAIL", what, found, error, tolerance);
    }
}

/* A call that fails leaves NaN to be compared, so that nothing holds by accident. */
static int worked(BhrStatus status) {
    if (status < 0) {
        fprintf(stderr, "%s\n", bhr_error_message());
    }
    return status >= 0;
}

/* ---- asking the library ---- */

static void set_spin(double spin) {
    worked(bhr_set_spin(context, spin));
}

static BhrHoleInfo hole_info(void) {
    BhrHoleInfo info;
    BHR_INIT(info);
    if (!worked(bhr_hole_info(context, &info))) {
        info.isco_prograde = info.isco_retrograde = info.photon_orbit_prograde = info.photon_orbit_retrograde = NAN;
        info.shadow_angular_radius = info.camera_time_rate = NAN;
    }
    return info;
}

/* A camera at radius r and angle theta from the axis, azimuth 0. */
static void set_camera(double r, double theta, BhrMotion motion) {
    BhrCamera camera;
    BHR_INIT(camera);
    camera.position[0] = r * sin(theta), camera.position[1] = 0.0, camera.position[2] = r * cos(theta);
    camera.forward[0] = -sin(theta), camera.forward[1] = 0.0, camera.forward[2] = -cos(theta);
    camera.up[0] = -cos(theta), camera.up[1] = 0.0, camera.up[2] = sin(theta);
    camera.motion = motion;
    worked(bhr_set_camera(context, &camera));
}

/* Traces the ray that the local static observer (ZAMO) at (r, theta, azimuth 0) sees in the direction with these
 * components along e_r, e_theta, e_phi. */
static BhrHit trace(double r, double theta, double n_r, double n_theta, double n_phi) {
    const double s = sin(theta), c = cos(theta);
    const BhrRay ray = {{r * s, 0.0, r * c}, {n_r * s + n_theta * c, n_phi, n_r * c - n_theta * s}, 1.0};
    BhrHit       hit;
    if (!worked(bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit))) {
        memset(&hit, 0, sizeof hit);
        hit.fate = BHR_FATE_INVALID;
        hit.swept_angle = NAN;
    }
    return hit;
}

/* The angle from the inward radial direction, towards (0, n_theta, n_phi), at which rays cease to be captured. */
static double shadow_edge(double r, double theta, double n_theta, double n_phi) {
    double low = 0.0, high = 1.5;
    for (int i = 0; i < 60; i++) {
        const double psi = 0.5 * (low + high);
        const BhrHit hit = trace(r, theta, -cos(psi), n_theta * sin(psi), n_phi * sin(psi));
        if (hit.fate == BHR_FATE_CAPTURED) {
            low = psi;
        } else if (hit.fate == BHR_FATE_ESCAPED) {
            high = psi;
        } else if (hit.fate == BHR_FATE_UNRESOLVED) {
            return psi; /* it circles on until the steps run out */
        } else {
            return NAN;
        }
    }
    return 0.5 * (low + high);
}

/* ---- formulas ---- */

/* Carlson's R_F by duplication (Carlson 1995, Numer. Algor. 10, 13), symmetric in its arguments. */
static double carlson_rf(double x, double y, double z) {
    for (int i = 0; i < 40; i++) {
        const double lambda = sqrt(x * y) + sqrt(y * z) + sqrt(z * x);
        x = 0.25 * (x + lambda), y = 0.25 * (y + lambda), z = 0.25 * (z + lambda);
    }
    return 1.0 / sqrt((x + y + z) / 3.0);
}

/* The integral of du / sqrt(2 (u - u1) (u - u2) (u - u3)) between u = from and u = to, both between u1 and u2 or at
 * one of these (Carlson 1988, Math. Comp. 51, 267, eq. 2.1: sums of products give the arguments of R_F). */
static double elliptic(const double u[3], double from, double to) {
    const double x[3] = {fabs(to - u[0]), fabs(to - u[1]), fabs(to - u[2])};
    const double y[3] = {fabs(from - u[0]), fabs(from - u[1]), fabs(from - u[2])};
    double       square[3];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double a = sqrt(x[i] * y[j] * y[k]), b = sqrt(y[i] * x[j] * x[k]);
        square[i] = pow((a + b) / (to - from), 2.0);
    }
    return sqrt(2.0) * carlson_rf(square[0], square[1], square[2]);
}

/* The angle that a ray of impact parameter b > sqrt(27) sweeps from radius r inwards, about its periastron, to infinity
 * (Darwin 1959, Proc. R. Soc. A 249, 180): (du/dphi)^2 = 1/b^2 - u^2 + 2 u^3 = 2 (u - u1) (u - u2) (u - u3). */
static double swept_angle(double b, double r) {
    const double turn = acos(1.0 - 54.0 / (b * b)) / 3.0;
    double       u[3];
    for (int k = 0; k < 3; k++) {
        u[k] = 1.0 / 6.0 + cos(turn + 2.0 * PI * (double)k / 3.0) / 3.0;
    }
    /* u[1] < 0 < u[2] < u[0]; the periastron is at u[2]. */
    const double order[3] = {u[1], u[2], u[0]};
    return elliptic(order, 0.0, u[2]) + elliptic(order, 1.0 / r, u[2]);
}

/* Bardeen, Press and Teukolsky 1972, eq. 2.21, with a < 0 for retrograde orbits. */
static double isco(double a) {
    const double z1 = 1.0 + cbrt(1.0 - a * a) * (cbrt(1.0 + a) + cbrt(1.0 - a));
    const double z2 = sqrt(3.0 * a * a + z1 * z1);
    return 3.0 + z2 - (a > 0.0 ? 1.0 : -1.0) * sqrt((3.0 - z1) * (3.0 + z1 + 2.0 * z2));
}

/* The local static observer (ZAMO) of Boyer-Lindquist coordinates (Bardeen, Press and Teukolsky 1972, section III). */
typedef struct Zamo {
    double sigma, delta, lapse, drag, ring; /* ring: sqrt(g_phph) */
} Zamo;

static Zamo zamo(double a, double r, double theta) {
    Zamo         z;
    const double s = sin(theta), c = cos(theta), rr = r * r + a * a;
    z.sigma = r * r + a * a * c * c;
    z.delta = r * r - 2.0 * r + a * a;
    const double big = rr * rr - a * a * z.delta * s * s;
    z.lapse = sqrt(z.sigma * z.delta / big);
    z.drag = 2.0 * a * r / big;
    z.ring = s * sqrt(big / z.sigma);
    return z;
}

/* ---- the truths ---- */

static void deflections(void) {
    static const double IMPACTS[] = {5.19615243, 5.1962, 5.2, 5.5, 6.0, 8.0, 12.0, 20.0};
    begin_section("Deflection without spin: the swept angle of a ray",
                  "Darwin 1959, closed form by Carlson 1988; observer at r = 30");
    set_spin(0.0);
    for (size_t i = 0; i < COUNT_OF(IMPACTS); i++) {
        const double b = IMPACTS[i], psi = asin(b * sqrt(1.0 - 2.0 / 30.0) / 30.0);
        char         what[64];
        snprintf(what, sizeof what, "impact parameter %.9g", b);
        /* Near sqrt(27) the angle is that of the last digits of b: d angle / d b = 1 / (b - sqrt(27)). */
        const double tolerance = 1e-11 + 3e-15 / (b - sqrt(27.0));
        compare(what, swept_angle(b, 30.0), trace(30.0, 1.0, -cos(psi), sin(psi), 0.0).swept_angle, tolerance);
    }
}

static void shadows_without_spin(void) {
    static const double RADII[] = {2.1, 3.0, 4.0, 10.0, 100.0, 1e5};
    begin_section("The shadow without spin: its angular radius", "Synge 1966, MNRAS 131, 463: sin = sqrt(27) "
                                                                  "sqrt(1 - 2 / r) / r; bhr_hole_info, and rays");
    set_spin(0.0);
    for (size_t i = 0; i < COUNT_OF(RADII); i++) {
        const double r = RADII[i], sine = sqrt(27.0) * sqrt(1.0 - 2.0 / r) / r;
        const double truth = r < 3.0 ? PI - asin(sine) : asin(fmin(sine, 1.0));
        char         what[64];
        set_camera(r, 1.0, BHR_MOTION_STATIC);
        snprintf(what, sizeof what, "static observer at r = %g", r);
        /* At the photon sphere the sine is 1, where an arcsine has half the digits. */
        compare(what, truth, hole_info().shadow_angular_radius, r == 3.0 ? 3e-8 : 1e-14);
        if (r > 3.0) {
            snprintf(what, sizeof what, "the same, between captured and escaping rays");
            compare(what, truth, shadow_edge(r, 1.0, 1.0, 0.0), 1e-13);
        }
    }
}

/* Gralla and Lupsasca 2020; Johnson et al. 2020. Digits of an independent computation with 30. */
static void shadows_on_the_axis(void) {
    static const double SPINS[][2] = {
        {0.0, 5.1961524227066318806}, {0.1, 5.1932605767317594369},   {0.5, 5.1205311916259374447},
        {0.9, 4.9160633802283307284}, {0.94, 4.8837008130703059317}, {0.998, 4.8304213185114872627}};
    begin_section("The shadow seen along the axis: its radius",
                  "Johnson et al. 2020, Sci. Adv. 6 eaaz1310; Gralla and Lupsasca 2020, arXiv:1910.12881");
    for (size_t i = 0; i < COUNT_OF(SPINS); i++) {
        const double a = SPINS[i][0], r = 30.0;
        char         what[64];
        set_spin(a);
        /* On the axis, where the radial potential is (r^2 + a^2)^2 - delta b^2. */
        const double psi = shadow_edge(r, 0.0, 1.0, 0.0);
        snprintf(what, sizeof what, "spin %g, by rays from r = 30", a);
        compare(what, SPINS[i][1], sin(psi) * (r * r + a * a) / sqrt(r * r - 2.0 * r + a * a), 1e-9);
    }
}

static void shadows_in_the_plane(void) {
    static const double SPINS[] = {0.1, 0.5, 0.9, 0.998};
    begin_section("The shadow seen in the equatorial plane: its two edges",
                  "Bardeen 1973, Les Houches, p. 215: L / E of the equatorial photon orbits");
    for (size_t i = 0; i < COUNT_OF(SPINS); i++) {
        const double a = SPINS[i], r = 50.0;
        const Zamo   z = zamo(a, r, 0.5 * PI);
        set_spin(a);
        for (int sense = 1; sense >= -1; sense -= 2) {
            const double orbit = 2.0 * (1.0 + cos(2.0 / 3.0 * acos(-(double)sense * a)));
            const double truth = -(pow(orbit, 3.0) - 3.0 * orbit * orbit + a * a * orbit + a * a) / (a * (orbit - 1.0));
            /* Photons of L > 0 come from the side towards which one looks with n_phi < 0. */
            const double sine = (double)sense * sin(shadow_edge(r, 0.5 * PI, 0.0, -(double)sense));
            char         what[64];
            snprintf(what, sizeof what, "spin %g, %s edge", a, sense > 0 ? "prograde" : "retrograde");
            compare(what, truth, sine * z.ring / (z.lapse + z.drag * sine * z.ring), 1e-9);
        }
    }
}

static void special_orbits(void) {
    static const double SPINS[] = {0.0, 0.1, 0.5, 0.9, 0.998};
    begin_section("Innermost stable orbits and photon orbits", "Bardeen, Press and Teukolsky 1972, ApJ 178, 347, "
                                                               "eqs. 2.18 and 2.21");
    for (size_t i = 0; i < COUNT_OF(SPINS); i++) {
        const double a = SPINS[i];
        char         what[64];
        set_spin(a);
        const BhrHoleInfo info = hole_info();
        snprintf(what, sizeof what, "ISCO, prograde, spin %g", a);
        compare(what, isco(a), info.isco_prograde, 1e-12);
        snprintf(what, sizeof what, "ISCO, retrograde, spin %g", a);
        compare(what, isco(-a), info.isco_retrograde, 1e-12);
        snprintf(what, sizeof what, "photon orbit, prograde, spin %g", a);
        compare(what, 2.0 * (1.0 + cos(2.0 / 3.0 * acos(-a))), info.photon_orbit_prograde, 1e-12);
        snprintf(what, sizeof what, "photon orbit, retrograde, spin %g", a);
        compare(what, 2.0 * (1.0 + cos(2.0 / 3.0 * acos(a))), info.photon_orbit_retrograde, 1e-12);
    }
    begin_section("Innermost stable orbits of another code", "Gradus.jl 181f52a5, test/smoke-tests/special-radii.jl");
    set_spin(0.998);
    compare("ISCO, prograde, spin 0.998", 1.2369706551751847, hole_info().isco_prograde, 1e-12);
    compare("ISCO, retrograde, spin 0.998", 8.99437445480357, hole_info().isco_retrograde, 1e-12);
}

/* achael/kgeo 5844b39d, tests/test_geodesics_kerr_ana.py, gives x and y to six digits; r was computed anew, by RK4 in
 * Mino time with steps of 2e-5, which holds about 1e-6. */
static void first_crossings(void) {
    static const struct Crossing {
        double a, inclination, alpha, beta, radius; /* radius 0: captured before it reaches the plane */
    } CROSSINGS[] = {
        {0.42, 60, -17, 0, 16.034319}, {0.42, 60, -9, 0, 8.098499},  {0.42, 60, -4, 0, 3.2192319},
        {0.42, 60, 1, 0, 0},           {0.42, 60, 6, 0, 4.943524},   {0.42, 60, 8, 0, 6.9495017},
        {0.9, 10, -12, 0, 11.009419},  {0.9, 10, -4, 0, 3.0664736},  {0.9, 10, 1, 0, 0},
        {0.9, 10, 2, 0, 0},            {0.73, 35, 1e-4, -10, 11.82614}, {0.73, 35, 1e-4, -1, 0},
        {0.73, 35, 1e-4, 1, 0},        {0.73, 35, 1e-4, 3, 0},       {0.73, 35, 1e-4, 4, 2.3470017},
    };
    begin_section("Where rays of a distant observer first cross the equatorial plane (r; 0: they do not)",
                  "kgeo 5844b39d, tests/test_geodesics_kerr_ana.py, r computed anew to about 1e-6");
    for (size_t i = 0; i < COUNT_OF(CROSSINGS); i++) {
        const struct Crossing *c = &CROSSINGS[i];
        const double           a = c->a, theta = c->inclination * PI / 180.0, r = 1000.0;
        const double           lambda = -c->alpha * sin(theta);
        const double           eta = (c->alpha * c->alpha - a * a) * pow(cos(theta), 2.0) + c->beta * c->beta;
        const Zamo             z = zamo(a, r, theta);
        /* The photon's momentum per energy at infinity; the look direction is opposite to it. */
        const double energy = (1.0 - z.drag * lambda) / z.lapse, p_phi = lambda / z.ring;
        const double potential = eta + a * a * pow(cos(theta), 2.0) - pow(lambda / tan(theta), 2.0);
        const double p_theta = copysign(sqrt(fmax(potential, 0.0) / z.sigma), c->beta);
        const double p_r = sqrt(fmax(energy * energy - p_phi * p_phi - p_theta * p_theta, 0.0));
        char         what[96];
        set_spin(a);
        const BhrHit hit = trace(r, theta, -p_r, -p_theta, -p_phi);
        snprintf(what, sizeof what, "spin %g, %g degrees, alpha %g, beta %g", a, c->inclination, c->alpha, c->beta);
        const double none = hit.fate == BHR_FATE_CAPTURED ? 0.0 : NAN;
        compare(what, c->radius, hit.crossing_count > 0 ? hit.crossings[0].radius : none, 1e-6);
    }
}

/* u^phi of circular orbits, from how far the library moves an orbiting camera in a unit of its own time. */
static void circular_orbits(void) {
    static const double SPINS[][2] = {
        {0.0, 0.5432533304149215}, {0.5, NAN}, {0.998, NAN}, {-0.998, NAN}};
    begin_section("Circular orbits: sum of u^phi over r = 6, 6.5 ... 10 (9 ... 13 at spin -0.998), and u^t",
                  "Bardeen, Press and Teukolsky 1972, in closed form; the first sum is that of Gradus.jl 181f52a5");
    for (size_t i = 0; i < COUNT_OF(SPINS); i++) {
        const double a = SPINS[i][0], first = a < 0.0 ? 9.0 : 6.0;
        double       truth = 0.0, found = 0.0, rate = 0.0, rate_truth = 0.0;
        char         what[64];
        set_spin(a);
        for (int step = 0; step <= 8; step++) {
            const double r = first + 0.5 * (double)step, w = 1.0 / (r * sqrt(r));
            BhrCamera    camera;
            set_camera(r, 0.5 * PI, BHR_MOTION_ORBIT);
            BHR_INIT(camera);
            double passed = NAN;
            if (!worked(bhr_get_camera(context, &camera)) ||
                !worked(bhr_camera_advance(context, &camera, 1.0, &passed))) {
                found = NAN;
            }
            found += atan2(camera.position[1], camera.position[0]);
            truth += w / sqrt(1.0 - 3.0 / r + 2.0 * a * w);
            rate += 1.0 / hole_info().camera_time_rate;
            rate_truth += (1.0 + a * w) / sqrt(1.0 - 3.0 / r + 2.0 * a * w);
        }
        snprintf(what, sizeof what, "u^phi, spin %g", a);
        compare(what, isnan(SPINS[i][1]) ? truth : SPINS[i][1], found, isnan(SPINS[i][1]) ? 1e-13 : 2e-12);
        snprintf(what, sizeof what, "u^t, spin %g", a);
        compare(what, rate_truth, rate, 1e-13);
    }
}

/* Seen from the axis the photons of a disk have no angular momentum, so that g has a closed form at every radius. */
static void redshifts(void) {
    static const double SPINS[] = {0.0, 0.5, 0.9, 0.998};
    begin_section("Redshift factor g of a disk that is seen along the axis",
                  "Cunningham 1975, ApJ 202, 788; Luminet 1979, A&A 75, 228: in closed form for photons without L");
    for (size_t i = 0; i < COUNT_OF(SPINS); i++) {
        const double a = SPINS[i], r = 40.0, clock = sqrt((r * r - 2.0 * r + a * a) / (r * r + a * a));
        double       worst = 0.0;
        int          seen = 0;
        char         what[64];
        set_spin(a);
        for (int step = 8; step < 40; step++) {
            const double psi = 0.01 * (double)step + 0.005;
            const BhrHit hit = trace(r, 0.0, -cos(psi), sin(psi), 0.0);
            if (hit.crossing_count == 0 || isnan(hit.crossings[0].redshift)) {
                continue;
            }
            const double w = pow(hit.crossings[0].radius, -1.5);
            const double truth = sqrt(1.0 - 3.0 / hit.crossings[0].radius + 2.0 * a * w) / (1.0 + a * w) / clock;
            const double error = fabs(hit.crossings[0].redshift / truth - 1.0);
            if (!(error <= worst)) {
                worst = isnan(error) ? INFINITY : error; /* which no later ray takes away */
            }
            seen++;
        }
        snprintf(what, sizeof what, "spin %g: worst ratio to the truth of %d rays", a, seen);
        compare(what, 1.0, seen >= 20 ? 1.0 + worst : NAN, 1e-12);
    }
}

/* A body of this four-velocity, (t, r, theta, phi), as the chart STATIC has it: the ZAMO measures its velocity. */
static BhrBody body_of(double a, const double place[4], const double velocity[4]) {
    const double r = place[1], s = sin(place[2]), c = cos(place[2]);
    const Zamo   z = zamo(a, r, place[2]);
    const double gamma = z.lapse * velocity[0];
    const double v_r = sqrt(z.sigma / z.delta) * velocity[1] / gamma, v_th = sqrt(z.sigma) * velocity[2] / gamma;
    const double v_ph = z.ring * (velocity[3] - z.drag * velocity[0]) / gamma;
    const double across = s * v_r + c * v_th, cos_ph = cos(place[3]), sin_ph = sin(place[3]);
    BhrBody      body;
    BHR_INIT(body);
    body.time = place[0];
    body.position[0] = r * s * cos_ph, body.position[1] = r * s * sin_ph, body.position[2] = r * c;
    body.velocity[0] = across * cos_ph - v_ph * sin_ph, body.velocity[1] = across * sin_ph + v_ph * cos_ph;
    body.velocity[2] = c * v_r - s * v_th;
    return body;
}

/* Orbits, eccentric and inclined, followed back to t = 0: there the body is at its pericentre and farthest north, at
 * the azimuth 0. */
static void world_lines(void) {
    static const struct {
        double a, p, e, x, place[4], velocity[4];
    } ORBITS[] = {
        {0.5, 12.0, 0.0, -0.5,
         {166.7059177650897, 12.0, 2.10812757877503, -4.259771928330167},
         {1.156891515688051, 0.0, -0.02303176634052743, -0.01848460266616635}},
        {0.842, 10.327, 0.016, -0.177,
         {126.2072096081305, 10.4525578382111, 2.406599648616607, -4.311970939013157},
         {1.184534194830607, 0.002477766622217036, -0.03394367724249028, -0.01206359235158676}},
        {0.356, 14.311, 0.046, -0.634,
         {231.4275724231566, 15.00084341883831, 1.875096646444973, -4.393484457675461},
         {1.11768870080849, -0.0002436675582642042, -0.01432761896233935, -0.01310901616874933}},
        {0.223, 16.8, 0.62, 0.203,
         {766.4365971134416, 35.19414289251847, 1.705115106148005, 4.712287471752534},
         {1.04151991778144, -0.07658938356174062, -0.003615502704521024, 0.0007741333022853813}},
        {0.186, 8.077, 0.623, 0.117,
         {48.76910710478514, 7.61866634125127, 2.559874420819628, 4.632161533186826},
         {1.309672501577718, 0.143229479994781, -0.06246994326402222, 0.02587196214589515}},
        {0.479, 19.892, 0.159, 0.839,
         {473.2286147256612, 21.78763307921255, 1.5361609325533, 4.812954183340091},
         {1.074651984152358, -0.02774025530969955, -0.005466991248590246, 0.008544838055377722}},
    };
    begin_section("World lines of bodies on inclined, eccentric orbits: back from Mino time 1 to the pericentre",
                  "KerrGeoPy (Black Hole Perturbation Toolkit), commit 58dac1d0, tests/data, by Mathematica");
    for (size_t i = 0; i < COUNT_OF(ORBITS); i++) {
        const double a = ORBITS[i].a, pericentre = ORBITS[i].p / (1.0 + ORBITS[i].e);
        char         what[96];
        set_spin(a);
        const BhrBody body = body_of(a, ORBITS[i].place, ORBITS[i].velocity);
        BhrBody       there = body;
        double        proper_time = 0.0;
        /* The secant is Newton's method by the mean rate, which is near the one at the end. */
        for (int k = 0; k < 40 && (k == 0 || fabs(there.time) > 1e-12 * body.time); k++) {
            proper_time -= there.time * (k == 0 ? 1.0 / ORBITS[i].velocity[0] : proper_time / (there.time - body.time));
            BHR_INIT(there);
            if (!worked(bhr_world_line(context, &body, &proper_time, 1, &there, sizeof there))) {
                there.position[0] = NAN;
                break;
            }
        }
        const double *n = there.position, *v = there.velocity;
        const double  r = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        snprintf(what, sizeof what, "r, spin %g, p %g, e %g, x %g", a, ORBITS[i].p, ORBITS[i].e, ORBITS[i].x);
        compare(what, pericentre, r, 1e-10);
        compare("  cos theta", sqrt(1.0 - ORBITS[i].x * ORBITS[i].x), n[2] / r, 1e-10);
        compare("  azimuth", 0.0, atan2(n[1], n[0]), 1e-9);
        compare("  velocity outwards", 0.0, (n[0] * v[0] + n[1] * v[1] + n[2] * v[2]) / r, 1e-9);
        compare("  velocity north", 0.0, v[2], 1e-9);
    }
}

/* Rays that the rain observer sees inside the horizon, azimuth 0. */
static void inside(void) {
    static const struct {
        double a, r, theta, look[3], sky[3], g;
    } RAYS[] = {
        {0.9, 1.2, 75.0, {0.625, -0.70005086633365, 0.34540379926327},
         {0.63012924494023, 0.39759849438169, 0.66697269204704}, 0.72502765063561},
        {0.9, 1.2, 75.0, {-0.625, -0.77605953365534, -0.08430065374991901},
         {-0.55113592377173, -0.13719073550564, 0.82306008020053}, 2.3537419630672},
        {0.9, 0.6, 30.0, {0.375, 0.89007786358257, 0.25910692148281},
         {0.75411860289181, 0.44488832176735, 0.48309369063105}, 0.79514867774623},
        {0.5, 0.2, 100.0, {0.875, 0.17543398929568, -0.45121825694425},
         {0.93752604539429, 0.057048412295763, -0.34320605015338}, 0.32049999687272},
        {0.998, 1.0, 85.0, {0.125, -0.51510661398772, -0.84796236722281},
         {0.87241163352091, -0.34416515380542, 0.34705660720331}, 0.50859457693729},
        {0.9999, 1.005, 50.0, {0.625, -0.70005086633365, 0.34540379926327},
         {0.19840024105736, 0.31768901280283, 0.92720603723916}, 0.71264386112761},
        {-0.9, 1.0, 120.0, {-0.625, -0.77605953365534, -0.08430065374991901},
         {-0.3565614244984, -0.20055675813782, 0.91249160945453}, 3.4575864092086},
    };
    begin_section("Light inside a spinning hole, as an observer sees it who falls from rest at infinity",
                  "rays integrated in Cartesian Kerr-Schild coordinates, without Carter's constant: tests/golden");
    for (size_t i = 0; i < COUNT_OF(RAYS); i++) {
        const double theta = RAYS[i].theta * PI / 180.0, r = RAYS[i].r, *look = RAYS[i].look;
        BhrCamera    camera;
        char         what[96];
        set_spin(RAYS[i].a);
        set_camera(r, theta, BHR_MOTION_FREE_FALL);
        BHR_INIT(camera);
        worked(bhr_get_camera(context, &camera));
        camera.chart = BHR_CHART_RAIN;
        worked(bhr_set_camera(context, &camera));
        const BhrHit hit = trace(r, theta, look[0], look[1], look[2]);
        double       off = 0.0;
        for (int k = 0; k < 3; k++) {
            off += pow(hit.sky_direction[k] - RAYS[i].sky[k], 2.0);
        }
        snprintf(what, sizeof what, "spin %g, r = %g: angle to the true place in the sky", RAYS[i].a, r);
        compare(what, 0.0, hit.fate == BHR_FATE_ESCAPED ? sqrt(off) : NAN, 1e-9);
        compare("  frequency by that at infinity", RAYS[i].g, hit.sky_redshift, 1e-11);
    }
    set_camera(40.0, 1.0, BHR_MOTION_STATIC);
}

int main(int argc, char **argv) {
    int          json = 0, markdown = 0, help = 0;
    const Option options[] = {
        {"--json", OPTION_FLAG, &json, NULL, "for machines: a list of objects", NULL, NULL},
        {"--markdown", OPTION_FLAG, &markdown, NULL, "as docs/validation.md has it", NULL, NULL},
        {"--help", OPTION_FLAG, &help, NULL, "this text", NULL, NULL},
    };
    if (options_parse(options, COUNT_OF(options), argc, argv) != 0) {
        return EXIT_USAGE;
    }
    if (help) {
        printf("bhr_validate: compares libbhr with formulas and published numbers.\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return end_output(0);
    }
    form = json ? JSON : markdown ? MARKDOWN : TABLE;
    const BhrStatus status = create_context_on(BHR_BACKEND_CPU, &context);
    if (status < 0) {
        return report_failure("no context", status);
    }
    BhrQuality quality;
    BHR_INIT(quality);
    quality.method = BHR_METHOD_ADAPTIVE, quality.tolerance = 1e-14, quality.max_steps = 100000;
    worked(bhr_set_quality(context, &quality));
    if (form == JSON) {
        printf("[\n");
    }
    deflections();
    shadows_without_spin();
    shadows_on_the_axis();
    shadows_in_the_plane();
    special_orbits();
    first_crossings();
    circular_orbits();
    redshifts();
    world_lines();
    inside();
    bhr_context_destroy(context);
    if (form == JSON) {
        printf("\n]\n");
    } else {
        printf("\n%d truths, %d do not hold; bhr %s\n", count, failed, bhr_version_string());
    }
    return end_output(failed > 0 ? EXIT_FAILURE : 0);
}
