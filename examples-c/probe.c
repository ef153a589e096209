/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* probe.c -- a probe falls into a spinning hole while a camera at rest looks after it: where the probe is seen, how
 * red, how dim, and how slowly its clock is seen to go. The light that arrives at a time left it at the proper time
 * that solves time + delay = arrival: bhr_world_line says when and where the probe is, bhr_project_point how long its
 * light takes and where on the screen it comes from. The probe crosses the horizon, but is never seen to. All is told
 * in the chart RAIN, in which its world line goes on inside. Draws direct images, in front of whatever hides them. */
#include "options.h"
#include "picture.h"
#include "plot.h"
#include "vectors.h"

#include <errno.h>
#include <stdlib.h>

#define MOST_FRAMES 99999u
#define HALVINGS 52             /* of the proper times between which the one that is seen lies: to the last bit */
#define RATE_STEP 1e-3          /* of the proper time that is left: over which the rate of the clock is measured */
#define LONGEST 1e5             /* M of proper time: a probe that is outside then is said to stay there */
#define LAST_STEP 0.01          /* M: and at most */
#define LAMP 8.0                /* how bright the probe is in its own frame: at half the frequency it is white */
#define FAINTEST 1e-4           /* of white: dimmer lamps are not drawn */

typedef struct Settings {
    double      spin, distance, elevation, fov, ahead, aside, sideways, step; /* M, degrees, c */
    uint32_t    frames, size[2];
    int32_t     backend;
    const char *output;
    int         help;
} Settings;

/* The probe, and the camera that sees it. */
typedef struct Chase {
    BhrContext *context;
    BhrBody     start;
    uint32_t    size[2];
    double      crossing;    /* proper time at which the probe passes the horizon, or its line ends */
    double      horizon;     /* r+ */
    double      camera_rate; /* d tau / d T of the camera */
} Chase;

/* An event of the probe, and its image. */
typedef struct Sight {
    BhrBody           body;
    BhrProjectedPoint image;
    double            arrival; /* T at the camera; INFINITY: no light of it ever comes there */
} Sight;

/* The probe at a proper time; *out_outside: whether it is outside the horizon still. Errors: as the library's. */
static BhrStatus find_probe(const Chase *chase, double proper_time, BhrBody *out, int *out_outside) {
    BHR_INIT(*out);
    BhrStatus status = bhr_world_line(chase->context, &chase->start, &proper_time, 1, out, sizeof *out);
    *out_outside = status >= 0 && out->end == BHR_WORLD_LINE_GOES_ON && length(out->position) > chase->horizon;
    return status;
}

/* The probe at a proper time, and its image. */
static BhrStatus look_at(const Chase *chase, double proper_time, Sight *out) {
    int outside;
    BHR_INIT(out->image);
    out->arrival = INFINITY;
    BhrStatus status = find_probe(chase, proper_time, &out->body, &outside);
    if (status >= 0 && outside) {
        status = bhr_project_point(chase->context, chase->size[0], chase->size[1], out->body.position, 0, &out->image);
    }
    if (status >= 0 && out->image.found) {
        out->arrival = out->body.time + out->image.delay;
    }
    return status;
}

/* The proper time at which the probe passes the horizon. */
static BhrStatus find_crossing(Chase *chase) {
    double    low = 0.0, high = 1.0;
    int       outside = 1;
    BhrBody   body;
    BhrStatus status = BHR_OK;
    while (status >= 0 && outside && high < LONGEST) {
        high *= 2.0;
        status = find_probe(chase, high, &body, &outside);
    }
    for (int i = 0; status >= 0 && i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        status = find_probe(chase, middle, &body, &outside);
        *(outside ? &low : &high) = middle;
    }
    chase->crossing = low;
    return status;
}

/* The proper time whose light arrives at the time: events of one world line are seen in their order. */
static BhrStatus find_seen(const Chase *chase, double arrival, double *out_proper_time, Sight *sight) {
    double    low = 0.0, high = chase->crossing;
    BhrStatus status = BHR_OK;
    for (int i = 0; status >= 0 && i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        status = look_at(chase, middle, sight);
        *(sight->arrival < arrival ? &low : &high) = middle;
    }
    *out_proper_time = low;
    return status >= 0 ? look_at(chase, low, sight) : status;
}

/* How fast the probe's clock is seen to go, by the camera's: nu(camera) / nu(probe) is the same number, as the crests
 * of a wave are ticks of a clock. */
static BhrStatus find_rate(const Chase *chase, double proper_time, double *out) {
    const double step = fmin(LAST_STEP, RATE_STEP * (chase->crossing - proper_time));
    const double begin = fmax(0.0, proper_time - step), end = fmin(chase->crossing, proper_time + step);
    Sight        sights[2];
    BhrStatus    status = look_at(chase, begin, &sights[0]);
    if (status >= 0) {
        status = look_at(chase, end, &sights[1]);
    }
    const double passed = (sights[1].arrival - sights[0].arrival) * chase->camera_rate;
    *out = passed > 0.0 ? (end - begin) / passed : 0.0;
    return status;
}

/* ---- the marker ---- */

/* A white lamp of the probe, seen with a ratio of frequencies: red or blue, and as bright as the cube of the ratio. */
static void shade(double ratio, double out[3]) {
    const double light = fmin(1.0, LAMP * ratio * ratio * ratio), tint = fmin(ratio, 1.0 / ratio);
    out[0] = ratio > 1.0 ? pow(tint, 1.5) : 1.0;
    out[1] = pow(tint, 0.75);
    out[2] = ratio > 1.0 ? 1.0 : pow(tint, 1.5);
    scale(out, pow(light, 1.0 / 2.2)); /* as pixels hold it */
}

/* A soft spot, and four strokes about it that show where it is when it has faded. */
static void draw_marker(BhrImage *image, const Sight *sight, double ratio) {
    const Colour   grey = {120, 150, 160};
    const double   x = sight->image.x, y = sight->image.y, radius = fmax(2.0, image->height / 100.0);
    unsigned char *pixels = image->pixels;
    double         colour[3];
    shade(ratio, colour);
    for (int side = -1; side <= 1; side += 2) {
        const double from = side * 2.0 * radius, to = side * 4.0 * radius;
        draw_line(image, x + from, y, x + to, y, 1.0, grey);
        draw_line(image, x, y + from, x, y + to, 1.0, grey);
    }
    if (LAMP * ratio * ratio * ratio < FAINTEST) {
        return;
    }
    for (uint32_t row = 0; row < image->height; row++) {
        for (uint32_t column = 0; column < image->width; column++) {
            const double away = hypot(column + 0.5 - x, row + 0.5 - y) / radius, share = exp(-away * away);
            if (share > 1e-3) {
                unsigned char *pixel = pixels + 4 * ((size_t)row * image->width + column);
                for (int c = 0; c < 3; c++) {
                    pixel[c] = (unsigned char)fmin(255.0, pixel[c] * (1.0 - share) + 255.0 * share * colour[c] + 0.5);
                }
            }
        }
    }
}

/* ---- frames ---- */

static BhrStatus set_scene(Chase *chase, const Settings *s) {
    BhrCamera   camera;
    BhrDisk     disk;
    BhrHoleInfo info;
    BHR_INIT(camera);
    BHR_INIT(disk);
    BHR_INIT(info);
    BHR_INIT(chase->start);
    const double degree = PI / 180.0;
    camera.chart = chase->start.chart = BHR_CHART_RAIN;
    camera.fov_y = s->fov * degree;
    disk.brightness = 0.15; /* so that the lamp shows beside it */
    BhrStatus status = bhr_set_spin(chase->context, s->spin);
    if (status >= 0) {
        status = bhr_set_disk(chase->context, &disk);
    }
    if (status >= 0) {
        status = bhr_camera_orbit(&camera, s->distance - s->ahead, (s->aside - 90.0) * degree, s->elevation * degree);
    }
    memcpy(chase->start.position, camera.position, sizeof camera.position);
    if (status >= 0) {
        status = bhr_camera_orbit(&camera, s->distance, -90.0 * degree, s->elevation * degree);
    }
    if (status >= 0) {
        status = bhr_set_camera(chase->context, &camera);
    }
    if (status >= 0) {
        status = bhr_hole_info(chase->context, &info);
    }
    chase->horizon = info.horizon_radius;
    chase->camera_rate = info.camera_time_rate;
    /* The probe falls as if from rest at infinity, and may be pushed sideways, towards growing azimuth. */
    const double out[3] = {cos((s->aside - 90.0) * degree), sin((s->aside - 90.0) * degree), 0.0};
    chase->start.velocity[0] = -s->sideways * out[1];
    chase->start.velocity[1] = s->sideways * out[0];
    return status;
}

/* One frame at the camera's time T. */
static BhrStatus make_frame(const Chase *chase, BhrImage *image, double begin, double time, uint32_t frame) {
    Sight     sight;
    double    seen, rate;
    BhrStatus status = find_seen(chase, begin + time / chase->camera_rate, &seen, &sight);
    if (status >= 0) {
        status = find_rate(chase, seen, &rate);
    }
    if (status >= 0) {
        status = bhr_set_time(chase->context, begin + time / chase->camera_rate);
    }
    if (status >= 0) {
        status = bhr_render_image(chase->context, image);
    }
    if (status < 0) {
        return status;
    }
    const double r = length(sight.body.position);
    char         text[96];
    printf("%5u  %9.3f  %9.5f  %10.7f  %9.6f  %s\n", (unsigned)frame, time, seen, r, rate,
           !sight.image.on_screen ? "beside the picture" : rate > 0.0 && rate < 1.0 ? "slow and red" : "fast and blue");
    if (sight.image.on_screen) {
        draw_marker(image, &sight, rate);
    }
    snprintf(text, sizeof text, "%.1f M  clock %.3f M  r = %.3f M  g = %.4f", time, seen, r, rate);
    picture_write(image, 4, image->height - CELL_HEIGHT, 1, text);
    return BHR_OK;
}

/* An exit status. */
static int make_frames(Chase *chase, const Settings *s, BhrImage *image) {
    Sight     first;
    BhrStatus status = set_scene(chase, s);
    if (status >= 0) {
        status = look_at(chase, 0.0, &first);
    }
    if (status >= 0 && first.arrival == INFINITY) {
        fprintf(stderr, "probe: the probe begins at r = %g M, where it is not seen; r+ is %g M\n",
                s->distance - s->ahead, chase->horizon);
        return EXIT_FAILURE;
    }
    if (status >= 0) {
        status = find_crossing(chase);
    }
    if (status < 0) {
        return report_failure("follow the probe", status);
    }
    if (chase->crossing < 0.5 * LONGEST) {
        printf("The probe crosses the horizon, r+ = %.5f M, when its clock shows %.5f M.\n\n", chase->horizon,
               chase->crossing);
    } else {
        printf("The probe does not fall in.\n\n");
    }
    printf("frame     camera      probe           r       rate  is seen\n");
    for (uint32_t frame = 0; frame < s->frames; frame++) {
        char name[24];
        status = make_frame(chase, image, first.arrival, s->step * frame, frame);
        if (status < 0) {
            return report_failure("render a frame", status);
        }
        snprintf(name, sizeof name, "probe-%05u.png", (unsigned)frame);
        if (!picture_save_into(image, s->output, name)) {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}

/* ---- command line ---- */

/* 0, or EXIT_USAGE after a message. */
static int check(const char *program, const Settings *s) {
    if (s->frames < 1 || s->frames > MOST_FRAMES) {
        fprintf(stderr, "%s: --frames is %u; it must be 1 to %u\n", program, (unsigned)s->frames, MOST_FRAMES);
    } else if (!(s->ahead > 0.0 && s->ahead < s->distance)) {
        fprintf(stderr, "%s: --ahead is %g; it must lie between 0 and the camera's distance\n", program, s->ahead);
    } else if (!(s->step > 0.0 && s->step < 1e6)) {
        fprintf(stderr, "%s: --step is %g; it must lie between 0 and 1e6\n", program, s->step);
    } else if (s->size[0] < 1 || s->size[1] < 1 || s->size[0] > 16384 || s->size[1] > 16384) {
        fprintf(stderr, "%s: --size is %ux%u; each side must lie in 1 to 16384\n", program, (unsigned)s->size[0],
                (unsigned)s->size[1]);
    } else {
        return 0;
    }
    return EXIT_USAGE;
}

static int run(int argc, char **argv) {
    Settings     s = {.spin = 0.9, .distance = 12.0, .elevation = 20.0, .fov = 60.0, .ahead = 2.0, .aside = 12.0,
                      .step = 2.0, .frames = 24, .size = {640, 360}, .output = "probe-out"};
    const Option options[] = {
        {"--spin", OPTION_DOUBLE, &s.spin, "A", "a / M", NULL, "-0.9999 to 0.9999"},
        {"--distance", OPTION_DOUBLE, &s.distance, "R", "the radius in M at which the camera rests", NULL, NULL},
        {"--elevation", OPTION_DOUBLE, &s.elevation, "DEG", "of camera and probe above the disk's plane", NULL, NULL},
        {"--fov", OPTION_DOUBLE, &s.fov, "DEG", "full vertical angle", NULL, NULL},
        {"--ahead", OPTION_DOUBLE, &s.ahead, "M", "how much nearer to the hole the probe begins", NULL, NULL},
        {"--aside", OPTION_DOUBLE, &s.aside, "DEG", "how far round the hole the probe begins", NULL, NULL},
        {"--sideways", OPTION_DOUBLE, &s.sideways, "V", "in c: a push of the probe round the hole", NULL, NULL},
        {"--step", OPTION_DOUBLE, &s.step, "M", "between two frames, by the camera's clock", NULL, NULL},
        {"--frames", OPTION_UINT, &s.frames, "N", "to render", NULL, "1 to 99999"},
        {"--size", OPTION_SIZE, s.size, "WxH", "pixels", NULL, NULL},
        {"--output", OPTION_TEXT, &s.output, "FOLDER", "for the pictures; made if need be", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result == 0 && s.help) {
        printf("Usage: probe [options]\nA probe falls into a hole, and is seen to fade and to slow down.\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    result = result == 0 ? check(argv[0], &s) : result;
    if (result != 0) {
        return result;
    }
    if (!make_folder(s.output) && errno != EEXIST) {
        fprintf(stderr, "cannot make the folder %s: %s\n", s.output, strerror(errno));
        return EXIT_FAILURE;
    }
    BhrImage image;
    Chase    chase = {.size = {s.size[0], s.size[1]}};
    if (!picture_allocate(&image, BHR_FORMAT_RGBA8_SRGB, s.size[0], s.size[1])) {
        return EXIT_FAILURE;
    }
    const BhrStatus status = create_context_on(s.backend, &chase.context);
    result = status < 0 ? report_failure("create a context", status) : make_frames(&chase, &s, &image);
    bhr_context_destroy(chase.context);
    free(image.pixels);
    return result;
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
