/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* trace_ray.c -- one photon around a black hole, in numbers: its path, crossings of the equatorial plane, deflection,
 * fate. The light is followed backward, from a static observer (ZAMO) into the direction it looks. Asks for
 * rays; makes no image. Lengths on the command line are in units of the hole's mass M, angles in degrees. */
#include "options.h"
#include "vectors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PATH_CAPACITY 1024u /* points per path: enough for the plot to look smooth after several turns */
#define PLOT_RADIUS 9.0     /* half the plot's height, in M */
#define PLOT_ROWS 37
#define PLOT_COLUMNS (2 * PLOT_ROWS) /* a terminal's cell is about twice as high as wide */

typedef struct Settings {
    double   mass, spin;
    double   distance, elevation;
    double   impact, angle; /* NaN: not given */
    double   position_angle;
    int32_t  backend, method;
    uint32_t rows;
    int      help;
} Settings;

/* ---- angles ---- */

static double angle_between(const double a[3], const double b[3]) {
    double normal[3];
    cross(a, b, normal);
    return atan2(length(normal), dot(a, b)); /* exact for small angles and near pi, as acos is not */
}

static double degrees(double radians) {
    return radians * 180.0 / PI;
}

/* ---- the ray ---- */

/* Synge 1966: a static observer at r (in M) sees a photon of impact parameter b at the angle psi from the hole's
 * centre, sin(psi) = b sqrt(1 - 2 / r) / r. NaN where there is no such angle. */
static double look_angle_of_impact(double impact, double distance) {
    return asin(impact * sqrt(1.0 - 2.0 / distance) / distance);
}

/* The observer sits at azimuth 0, so that e_r = (cos el, 0, sin el), up = -e_th = (-sin el, 0, cos el) and right = e_ph
 * = y. `psi`: from the hole's centre; `position_angle`: from up towards right. */
static BhrRay make_ray(const Settings *s, double psi, double position_angle) {
    const double elevation = s->elevation * PI / 180.0;
    const double outward[3] = {cos(elevation), 0.0, sin(elevation)};
    const double up[3] = {-sin(elevation), 0.0, cos(elevation)};
    const double right[3] = {0.0, 1.0, 0.0};
    BhrRay       ray = {.frequency_ratio = 1.0};
    for (int i = 0; i < 3; i++) {
        ray.position[i] = s->distance * s->mass * outward[i];
        ray.direction[i] =
            -cos(psi) * outward[i] + sin(psi) * (cos(position_angle) * up[i] + sin(position_angle) * right[i]);
    }
    return ray;
}

/* ---- printing ---- */

/* At most `rows` points of the path, evenly chosen by index, the first and the last among them. "swept" is the angle
 * about the hole since the observer, summed over all points in between. */
static void print_path(const Settings *s, const double (*points)[4], uint32_t count) {
    printf("      r / M   theta deg     phi deg   swept deg       t / M\n");
    double   swept = 0.0;
    uint32_t rows = s->rows < count ? s->rows : count;
    uint32_t next_row = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double *p = points[i];
        if (i > 0) {
            swept += angle_between(points[i - 1], p);
        }
        uint32_t row_point = rows < 2 ? count - 1 : (uint32_t)((uint64_t)next_row * (count - 1) / (rows - 1));
        if (i != row_point) {
            continue;
        }
        next_row++;
        printf("%11.5g %11.4f %11.4f %11.4f %11.5g\n", length(p) / s->mass, degrees(atan2(hypot(p[0], p[1]), p[2])),
               degrees(atan2(p[1], p[0])), degrees(swept), p[3] / s->mass + 0.0); /* -0 would be printed as such */
    }
}

static void print_crossings(const Settings *s, const BhrHit *hit) {
    for (uint32_t i = 0; i < hit->crossing_count; i++) {
        const BhrCrossing *crossing = &hit->crossings[i];
        printf("crossing %u   r = %.6f M, azimuth %.4f deg, ", (unsigned)i, crossing->radius / s->mass,
               degrees(crossing->azimuth));
        if (isnan(crossing->redshift)) {
            printf("no circular orbit there (inside the ISCO), ");
        } else {
            printf("g = %.6f, ", crossing->redshift);
        }
        printf("left %.4f M ago\n", crossing->delay / s->mass);
    }
    if (hit->crossing_count == 0) {
        printf("crossings    none\n");
    }
}

/* `psi`: the look direction's angle from the hole. Without a hole the ray would sweep pi - psi about its centre. */
static void print_fate(const Settings *s, const BhrRay *ray, const BhrHit *hit, double psi) {
    static const char *const names[] = {"captured by the hole", "escapes to the sky", "unresolved: max_steps ran out",
                                        "not a valid ray"};
    const int known = hit->fate >= 0 && hit->fate < (BhrFate)COUNT_OF(names);
    printf("fate         %s, after %u steps\n", known ? names[hit->fate] : "?", (unsigned)hit->steps);
    if (!isnan(hit->swept_angle)) {
        printf("swept        %.6f deg about the hole", degrees(hit->swept_angle));
        if (hit->fate == BHR_FATE_ESCAPED) {
            printf(", so bent by %.6f deg in all", degrees(hit->swept_angle - (PI - psi)));
        }
        putchar('\n');
    }
    if (hit->fate == BHR_FATE_ESCAPED) {
        const double *sky = hit->sky_direction;
        printf("deflection   %.6f deg between look and sky direction (%.6f, %.6f, %.6f)\n",
               degrees(angle_between(ray->direction, sky)), sky[0], sky[1], sky[2]);
        printf("sky redshift %.6f = nu(observer) / nu(at infinity)\n", hit->sky_redshift);
    }
    print_crossings(s, hit);
    putchar('\n');
}

/* ---- the plot: the plane of hole, observer and look direction; observer to the right, looked-at side up ---- */

/* Unit vectors of that plane; a look straight at the hole or away leaves `across` to any perpendicular. */
static void plot_axes(const BhrRay *ray, double along[3], double across[3]) {
    const double radius = length(ray->position);
    for (int i = 0; i < 3; i++) {
        along[i] = ray->position[i] / radius;
    }
    const double side = dot(ray->direction, along);
    for (int i = 0; i < 3; i++) {
        across[i] = ray->direction[i] - side * along[i];
    }
    double size = length(across);
    if (size < 1e-12) {
        const double y[3] = {0.0, 1.0, 0.0}; /* the observer is at azimuth 0 */
        memcpy(across, y, sizeof y);
        size = 1.0;
    }
    for (int i = 0; i < 3; i++) {
        across[i] /= size;
    }
}

static void plot_point(char cells[PLOT_ROWS][PLOT_COLUMNS + 1], double x, double y) {
    const double column = (x / PLOT_RADIUS + 1.0) * 0.5 * PLOT_COLUMNS;
    const double row = (1.0 - y / PLOT_RADIUS) * 0.5 * PLOT_ROWS;
    if (column >= 0.0 && column < PLOT_COLUMNS && row >= 0.0 && row < PLOT_ROWS) {
        cells[(int)row][(int)column] = '*';
    }
}

/* A straight piece of the path, cut to where it can be seen, in steps of less than a cell. */
static void plot_piece(char cells[PLOT_ROWS][PLOT_COLUMNS + 1], const double from[2], const double to[2]) {
    const double dx = to[0] - from[0], dy = to[1] - from[1];
    const double size = hypot(dx, dy);
    if (!(size > 0.0) || isinf(size)) {
        return;
    }
    /* Only the part within a circle around the plot matters: |from + t (to - from)| <= 2 PLOT_RADIUS. */
    const double middle = -(from[0] * dx + from[1] * dy) / (size * size);
    const double reach = 2.0 * PLOT_RADIUS / size;
    const double begin = fmax(0.0, middle - reach), end = fmin(1.0, middle + reach);
    const double step = 0.25 * PLOT_RADIUS / PLOT_COLUMNS / size;
    for (double t = begin; t <= end; t += step) {
        plot_point(cells, from[0] + t * dx, from[1] + t * dy);
    }
}

static void print_plot(const Settings *s, const BhrRay *ray, const double (*points)[4], uint32_t count,
                       const BhrHoleInfo *hole) {
    static char  cells[PLOT_ROWS][PLOT_COLUMNS + 1];
    const double horizon = hole->horizon_radius / s->mass;
    const double photon_orbit = hole->photon_orbit_prograde / s->mass;
    for (int row = 0; row < PLOT_ROWS; row++) {
        for (int column = 0; column < PLOT_COLUMNS; column++) {
            const double x = ((column + 0.5) / PLOT_COLUMNS * 2.0 - 1.0) * PLOT_RADIUS;
            const double y = (1.0 - (row + 0.5) / PLOT_ROWS * 2.0) * PLOT_RADIUS;
            const double r = hypot(x, y);
            const int    on_photon_orbit = s->spin == 0.0 && fabs(r - photon_orbit) < 0.5 * PLOT_RADIUS / PLOT_ROWS;
            cells[row][column] = r < horizon ? '#' : on_photon_orbit ? '.' : ' ';
        }
        cells[row][PLOT_COLUMNS] = '\0';
    }
    double along[3], across[3], last[2] = {0.0, 0.0};
    plot_axes(ray, along, across);
    for (uint32_t i = 0; i < count; i++) {
        const double here[2] = {dot(points[i], along) / s->mass, dot(points[i], across) / s->mass};
        if (i > 0) {
            plot_piece(cells, last, here);
        }
        memcpy(last, here, sizeof last);
    }
    for (int row = 0; row < PLOT_ROWS; row++) {
        int end = PLOT_COLUMNS;
        while (end > 0 && cells[row][end - 1] == ' ') {
            end--;
        }
        if (end > 0) {
            printf("    %.*s\n", end, cells[row]);
        }
    }
    printf("    # hole%s, * path; %g M across, observer to the right\n\n", s->spin == 0.0 ? ", . photon sphere" : "",
           2.0 * PLOT_RADIUS);
}

/* ---- one photon ---- */

static int show_photon(BhrContext *context, const Settings *s, double psi, double position_angle) {
    const BhrRay  ray = make_ray(s, psi, position_angle);
    BhrHit        hit;
    BhrHoleInfo   hole;
    BHR_INIT(hole);
    static double points[PATH_CAPACITY][4];
    uint32_t      count = 0;
    BhrStatus     status = bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit);
    if (status >= 0) {
        status = bhr_hole_info(context, &hole);
    }
    if (status >= 0) {
        status = bhr_trace_path(context, &ray, PATH_CAPACITY, &points[0][0], &count);
    }
    if (status < 0) {
        return report_failure("trace the photon", status);
    }
    const double(*path)[4] = (const double(*)[4])points;
    print_path(s, path, count);
    print_fate(s, &ray, &hit, psi);
    print_plot(s, &ray, path, count, &hole);
    return EXIT_SUCCESS;
}

/* Three photons that pass a hole without spin below, at and above the critical impact parameter 3 sqrt(3) M. */
static int demonstrate(BhrContext *context, const Settings *s) {
    const double critical = 3.0 * sqrt(3.0);
    const struct {
        const char *title;
        double      impact;
    } photons[] = {
        {"Capture: impact parameter 4.5 M, below the critical 3 sqrt(3) M = 5.196 M", 4.5},
        {"Photon sphere: 1e-9 above the critical one, the photon circles at r = 3 M", critical * (1.0 + 1e-9)},
        {"Escape: impact parameter 6.5 M, the photon is bent and gets away", 6.5},
    };
    for (size_t i = 0; i < COUNT_OF(photons); i++) {
        printf("%s\n\n", photons[i].title);
        const double psi = look_angle_of_impact(photons[i].impact, s->distance);
        const int    result = show_photon(context, s, psi, s->position_angle * PI / 180.0);
        if (result != EXIT_SUCCESS) {
            return result;
        }
    }
    return EXIT_SUCCESS;
}

static BhrStatus describe_scene(BhrContext *context, const Settings *s) {
    BhrQuality quality;
    BhrStatus  status = bhr_set_mass(context, s->mass);
    if (status >= 0) {
        status = bhr_set_spin(context, s->spin);
    }
    if (status >= 0) {
        status = bhr_quality_init(&quality, sizeof quality);
    }
    if (status >= 0) {
        quality.method = s->method;
        status = bhr_set_quality(context, &quality);
    }
    return status;
}

static int trace(const Settings *s, double psi, int demonstration) {
    BhrContext *context = NULL;
    BhrStatus   status = create_context_on(s->backend, &context);
    if (status < 0) {
        return report_failure("create a context", status);
    }
    status = describe_scene(context, s);
    int result;
    if (status < 0) {
        result = report_failure("set the scene", status);
    } else if (demonstration) {
        result = demonstrate(context, s);
    } else {
        result = show_photon(context, s, psi, s->position_angle * PI / 180.0);
    }
    bhr_context_destroy(context);
    return result;
}

/* ---- command line ---- */

/* The look angle that --impact or --angle ask for. 0, or EXIT_USAGE after a message. */
static int find_look_angle(const Settings *s, const char *program, double *out_psi) {
    if (isnan(s->impact) == isnan(s->angle)) {
        fprintf(stderr, "%s: give either --impact or --angle; with no option there is a demonstration\n", program);
        return EXIT_USAGE;
    }
    if (!isnan(s->angle)) {
        *out_psi = s->angle * PI / 180.0;
        return 0;
    }
    if (s->spin != 0.0) {
        fprintf(stderr, "%s: --impact is for spin 0; give --angle for a spinning hole\n", program);
        return EXIT_USAGE;
    }
    if (!(s->distance > 2.0)) {
        fprintf(stderr, "%s: --impact needs a static observer: --distance is %g M, but must be above 2 M\n", program,
                s->distance);
        return EXIT_USAGE;
    }
    *out_psi = look_angle_of_impact(s->impact, s->distance);
    if (isnan(*out_psi)) {
        fprintf(stderr, "%s: --impact is %g M; at a distance of %g M it is at most %g M\n", program, s->impact,
                s->distance, s->distance / sqrt(1.0 - 2.0 / s->distance));
        return EXIT_USAGE;
    }
    return 0;
}

static int run(int argc, char **argv) {
    Settings s = {
        .mass = 1.0, .distance = 30.0, .impact = NAN, .angle = NAN, .backend = BHR_BACKEND_CPU, .rows = 16};
    const Option options[] = {
        {"--mass", OPTION_DOUBLE, &s.mass, "M", "in scene lengths", NULL, NULL},
        {"--spin", OPTION_DOUBLE, &s.spin, "A", "a / M, -1 to 1", NULL, NULL},
        {"--distance", OPTION_DOUBLE, &s.distance, "R", "the observer's radius in M", NULL, NULL},
        {"--elevation", OPTION_DOUBLE, &s.elevation, "DEG", "the observer above the equatorial plane", NULL, NULL},
        {"--impact", OPTION_DOUBLE, &s.impact, "B", "impact parameter in M, for spin 0; looks towards the hole",
         NULL, NULL},
        {"--angle", OPTION_DOUBLE, &s.angle, "DEG", "look direction, from the hole's centre; at any spin", NULL, NULL},
        {"--position-angle", OPTION_DOUBLE, &s.position_angle, "DEG",
         "to which side of the hole: 0 up, 90 right (+azimuth)", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces it", BACKENDS, NULL},
        {"--method", OPTION_CHOICE, &s.method, NULL, "of integration", METHODS, NULL},
        {"--rows", OPTION_UINT, &s.rows, "N", "of the printed path", NULL, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.help) {
        printf("Usage: trace_ray [options]\n"
               "Follows one photon backward from the observer. Lengths in units of the hole's mass M.\n"
               "With no option: three photons, one captured, one at the photon sphere, one that escapes.\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    double    psi = 0.0;
    const int demonstration = argc == 1;
    if (!demonstration) {
        result = find_look_angle(&s, argv[0], &psi);
    }
    return result != 0 ? result : trace(&s, psi, demonstration);
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
