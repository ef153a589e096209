/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* observatory_hotspot.c -- a hot spot on a circular orbit: its light curve and the track of its centroid through one
 * orbit, as CSV and as a plot. The light is seen as it was when it left the spot, unless --fast-light. */
#include "matter.h"
#include "observatory.h"
#include "plot.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_SPOT "radius=7,size=0.7"
#define PLOT_GREY 24

/* One time of the orbit. */
typedef struct Phase {
    double time;     /* M since phase 0: the spot at its azimuth, as light shows it that needs as long as from r = 0 */
    double flux;     /* M^2: intensities, where 1 M of density 1 sends 1, times the area of the sky in M^2 */
    double x, y;     /* of the centroid: M to the right and along the projected spin */
} Phase;

typedef struct Curve {
    Settings   *s;
    BhrContext *context;
    BhrHotSpot  spot;
    double      period; /* M */
    double      width;  /* M, of what is seen */
    Phase      *phases; /* s->phases of them */
    double     *light;
    double      mean, least, most;
} Curve;

/* ---- the orbit ---- */

/* The spot from the options, the scene without its time, the period and the frame. 0, or an exit status. */
static int begin_curve(Curve *curve) {
    const Settings *s = curve->s;
    const TextList  one = {{DEFAULT_SPOT}, 1};
    uint32_t        count;
    const int       result = hot_spots_read("observatory: --hot-spot", s->hot_spots.count > 0 ? &s->hot_spots : &one,
                                            &curve->spot, 1, &count);
    if (result != 0) {
        return result;
    }
    if (curve->spot.flags & BHR_HOT_SPOT_THERMAL) {
        fprintf(stderr, "observatory: the light of the spot must be a power law of the frequency: leave thermal out\n");
        return EXIT_USAGE;
    }
    BhrHoleInfo hole;
    BHR_INIT(hole);
    BhrStatus   status = bhr_set_spin(curve->context, s->spin);
    if (status >= 0) {
        status = bhr_set_hot_spots(curve->context, &curve->spot, sizeof curve->spot, 1);
    }
    if (status >= 0) {
        status = bhr_set_effects(curve->context,
                                 s->fast_light ? BHR_EFFECT_ALL & ~(uint32_t)BHR_EFFECT_LIGHT_DELAY : BHR_EFFECT_ALL);
    }
    if (status >= 0) {
        status = bhr_hole_info(curve->context, &hole);
    }
    if (status < 0) {
        return report_failure("set the scene", status);
    }
    /* Bardeen, Press and Teukolsky 1972, eq. 2.16; inside the ISCO the library puts the spot there. */
    const int    retrograde = (curve->spot.flags & BHR_HOT_SPOT_RETROGRADE) != 0;
    const double radius = fmax(curve->spot.radius, retrograde ? hole.isco_retrograde : hole.isco_prograde);
    curve->spot.radius = radius;
    curve->period = 2.0 * PI * (pow(radius, 1.5) + (retrograde ? -s->spin : s->spin));
    /* Lensing shows the orbit larger than it is, most where it passes behind the hole. */
    curve->width = s->fov > 0.0 ? s->fov : 2.0 * (1.25 * radius + 5.0 * curve->spot.size + 2.0);
    return check_width(s, curve->width);
}

static int find_phase(Curve *curve, uint32_t number) {
    const Settings *s = curve->s;
    Phase          *phase = &curve->phases[number];
    phase->time = curve->period * number / s->phases;
    const double    way = s->fast_light ? 0.0 : travel_time(s->observer);
    const BhrStatus status = bhr_set_time(curve->context, phase->time + way);
    if (status < 0) {
        return report_failure("set the time", status);
    }
    const Grid  grid = grid_of_pixels(s->inclination, 0.0, s->observer, curve->width, s->pixels, !s->plain);
    Transferred out = {curve->light, NULL, &curve->s->progress, (double)number / s->phases, 1.0 / s->phases};
    const int   result = grid_transfer(curve->context, &grid, &out);
    if (result != 0) {
        return result;
    }
    double sum = 0.0, x = 0.0, y = 0.0;
    for (size_t i = 0; i < (size_t)s->pixels * s->pixels; i++) {
        const double light = curve->light[i];
        sum += light;
        x += light * (2.0 * (double)(i % s->pixels) / (s->pixels - 1.0) - 1.0) * grid.half;
        y += light * (1.0 - 2.0 * (double)(i / s->pixels) / (s->pixels - 1.0)) * grid.half;
    }
    if (!(sum > 0.0)) {
        progress_clear(&curve->s->progress);
        fprintf(stderr, "observatory: no light of the spot arrives in phase %u: more --pixels, or another --fov, may "
                        "show it\n", (unsigned)number);
        return EXIT_FAILURE;
    }
    phase->flux = sum * pow(curve->width / s->pixels, 2.0);
    phase->x = x / sum;
    phase->y = y / sum;
    return 0;
}

static int find_curve(Curve *curve) {
    const uint32_t count = curve->s->phases;
    int            result = 0;
    for (uint32_t i = 0; result == 0 && i < count; i++) {
        result = find_phase(curve, i);
    }
    curve->mean = 0.0;
    curve->least = INFINITY;
    curve->most = 0.0;
    for (uint32_t i = 0; result == 0 && i < count; i++) {
        curve->mean += curve->phases[i].flux / count;
        curve->least = fmin(curve->least, curve->phases[i].flux);
        curve->most = fmax(curve->most, curve->phases[i].flux);
    }
    return result;
}

/* ---- the table ---- */

static int write_table(const Curve *curve, const char *path) {
    const Settings *s = curve->s;
    FILE           *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "cannot write %s: %s\n", path, strerror(errno));
        return 0;
    }
    const double minutes = seconds_of(&s->target) / 60.0, uas = angle_of(&s->target) / MICROARCSECOND;
    fprintf(file, "phase,time_M,time_min,flux_M2,flux_over_mean,x_M,y_M,x_uas,y_uas\n");
    for (uint32_t i = 0; i < s->phases; i++) {
        const Phase *p = &curve->phases[i];
        fprintf(file, "%.10g,%.10g,%.10g,%.10g,%.10g,%.10g,%.10g,%.10g,%.10g\n", (double)i / s->phases, p->time,
                p->time * minutes, p->flux, p->flux / curve->mean, p->x, p->y, p->x * uas, p->y * uas);
    }
    const int failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed) {
        fprintf(stderr, "cannot write %s: %s\n", path, errno != 0 ? strerror(errno) : "the disk may be full");
        remove(path);
        return 0;
    }
    return 1;
}

/* ---- the plot ---- */

static const Colour CURVE = {255, 170, 60}, DOT = {255, 235, 200}, HOLE = {110, 110, 130};

static double largest(const double *values, size_t count) {
    double most = 0.0;
    for (size_t i = 0; i < count; i++) {
        most = fmax(most, fabs(values[i]));
    }
    return most;
}

static void draw_curve(const Plot *plot, const double *x, const double *y, size_t count) {
    plot_curve(plot, x, y, count, 2.0, CURVE);
    for (size_t i = 0; count <= 66 && i < count; i++) {
        plot_dot(plot, x[i], y[i], 2.5, DOT);
    }
}

static void draw_plots(const Curve *curve, BhrImage *picture, double *const column[4]) {
    const Settings *s = curve->s;
    const size_t    count = (size_t)s->phases + 1;
    const double    minutes = seconds_of(&s->target) / 60.0, uas = angle_of(&s->target) / MICROARCSECOND;
    for (size_t i = 0; i < count; i++) {
        const Phase *p = &curve->phases[i % s->phases]; /* the first again closes the orbit */
        column[0][i] = curve->period * minutes * (double)i / s->phases;
        column[1][i] = p->flux / curve->mean;
        column[2][i] = p->x * uas;
        column[3][i] = p->y * uas;
    }
    char words[160];
    snprintf(words, sizeof words, "%s  hot spot at r = %.4g M, a = %.3g, i = %.4g, %s", s->target.object,
             curve->spot.radius, s->spin, s->inclination * 180.0 / PI, s->fast_light ? "fast light" : "slow light");
    picture_write(picture, 70, 14, 2, words);
    const Plot light = {picture, 70.0, 70.0, 560.0, 420.0, 0.0, column[0][count - 1], 0.0,
                        1.08 * largest(column[1], count)};
    plot_axes(&light, "time (min)", "flux / mean");
    draw_curve(&light, column[0], column[1], count);
    /* The mean of the orbit's radius keeps the hole in the middle, with the same scale on both axes. */
    const double half = 1.15 * fmax(largest(column[2], count), largest(column[3], count));
    const Plot   track = {picture, 720.0, 70.0, 420.0, 420.0, -half, half, -half, half};
    plot_axes(&track, "to the right (uas)", "centroid, along the projected spin (uas)");
    const double circle = sqrt(27.0) * uas; /* the shadow's radius without spin (Synge 1966) */
    for (int i = 0; s->spin == 0.0 && i < 90; i++) {
        const double x[2] = {circle * cos(PI * i / 45.0), circle * cos(PI * (i + 1) / 45.0)};
        const double y[2] = {circle * sin(PI * i / 45.0), circle * sin(PI * (i + 1) / 45.0)};
        plot_curve(&track, x, y, 2, 1.0, HOLE);
    }
    draw_curve(&track, column[2], column[3], count);
}

static int write_plot(const Curve *curve) {
    const size_t count = (size_t)curve->s->phases + 1;
    double      *room = allocate_doubles(4 * count);
    BhrImage     picture;
    if (room == NULL) {
        return 0;
    }
    int done = picture_allocate(&picture, BHR_FORMAT_RGBA8_SRGB, 1180, 560);
    if (done) {
        double *const column[4] = {room, room + count, room + 2 * count, room + 3 * count};
        picture_fill(&picture, PLOT_GREY);
        draw_plots(curve, &picture, column);
        done = picture_save_into(&picture, curve->s->output, "hotspot.png");
        free(picture.pixels);
    }
    free(room);
    return done;
}

/* ---- the command ---- */

static int write_files(const Curve *curve) {
    const Settings *s = curve->s;
    char           *path = output_path(s, "hotspot.csv");
    if (path == NULL) {
        return EXIT_FAILURE;
    }
    const int written = write_table(curve, path) && write_plot(curve);
    if (written) {
        printf("%s: period %.6g M, %.5g min; flux from %.6g to %.6g M^2, mean %.6g; contrast %.4g; %s\n",
               s->target.object, curve->period, curve->period * seconds_of(&s->target) / 60.0, curve->least,
               curve->most, curve->mean, curve->most / curve->least, path);
    }
    free(path);
    return written ? EXIT_SUCCESS : EXIT_FAILURE;
}

int observatory_hotspot(BhrContext *context, Settings *s) {
    Curve curve = {.s = s, .context = context};
    int   result = begin_curve(&curve);
    if (result == 0) {
        result = prepare_output(s);
    }
    if (result != 0) {
        return result;
    }
    curve.phases = calloc(s->phases, sizeof *curve.phases);
    curve.light = allocate_doubles((size_t)s->pixels * s->pixels);
    if (curve.phases == NULL || curve.light == NULL) {
        fprintf(stderr, "observatory: no memory for %u phases\n", (unsigned)s->phases);
        result = EXIT_FAILURE;
    }
    if (result == 0) {
        result = find_curve(&curve);
    }
    progress_clear(&s->progress);
    if (result == 0) {
        result = write_files(&curve);
    }
    free(curve.phases);
    free(curve.light);
    return result;
}
