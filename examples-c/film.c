/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* film.c -- a fall into a black hole without spin, through the horizon to near its centre, as numbered pictures or as a
 * video: the frames are evenly spaced in the time of the one who falls, whose clock and radius each of them shows. Two
 * jobs are under way at a time, so that one frame is written while the next is rendered. Lengths in units of M, angles
 * in degrees. */
#include "common.h"
#include "picture.h"
#include "scene_options.h"
#include "vectors.h"
#include "video.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define JOBS 2
#define MOST_FRAMES 99999u /* what five digits number */
#define MOST_RATE 1000u
#define MOST_RADIUS 1e6
#define LEAST_RADIUS 1e-3
#define HORIZON 2.0

typedef enum Look { LOOK_IN, LOOK_OUT, LOOK_SIDE } Look;

static const Choice LOOKS[] = {{"in", LOOK_IN}, {"out", LOOK_OUT}, {"side", LOOK_SIDE}, {NULL, 0}};

typedef struct Settings {
    SceneInput    *input; /* the look: laid over the preset once there is a context, by these arguments */
    const Options *options;
    int            argc;
    char         **argv;
    const char    *output, *video;
    uint32_t       frames, rate, size[2], samples;
    double         from, to, elevation, fov;
    int32_t        look, projection, backend;
    int            no_clock, help;
} Settings;

/* A frame under way: job is NULL when there is none. */
typedef struct Slot {
    BhrJob  *job;
    BhrImage image;
    uint32_t number;
    double   proper_time, radius;
} Slot;

typedef struct Film {
    const Settings *settings;
    BhrContext     *context;
    Scene           scene;
    double          proper_time; /* since the first frame */
    Slot            slots[JOBS];
    Video           video;
} Film;

/* ---- the fall ---- */

/* Proper time from r to the centre, falling from rest at infinity: (2/3) sqrt(r^3 / 2). */
static double time_left(double radius) {
    return 2.0 / 3.0 * sqrt(0.5 * radius * radius * radius);
}

/* The look where it differs from the library's, before the options. */
static void begin_look(Scene *scene) {
    scene->disk.outer_radius = 16.0;
    scene->disk.turbulence = 0.8;
    scene->film.exposure_ev = -1.5;
    scene->film.tone_map = BHR_TONE_MAP_AGX;
    scene->film.bloom = 0.15;
}

static BhrStatus begin_fall(Scene *scene, const Settings *s) {
    *scene = s->input->scene;
    BhrStatus status = bhr_camera_orbit(&scene->camera, s->from, -0.5 * PI, s->elevation * PI / 180.0);
    scene->camera.fov_y = s->fov * PI / 180.0;
    scene->camera.motion = BHR_MOTION_FREE_FALL;
    scene->camera.projection = s->projection;
    scene->quality.samples_per_pixel = s->samples;
    camera_make_orthonormal(&scene->camera);
    camera_turn(&scene->camera, s->look == LOOK_OUT ? PI : s->look == LOOK_SIDE ? -0.5 * PI : 0.0, 0.0);
    return status;
}

/* On to the next frame. What the library says went by is added to the scene's time, outside the horizon and inside: so
 * the disk is seen at its retarded time all the way. */
static BhrStatus fall_on(Film *film, double proper_time) {
    double    elapsed;
    BhrStatus status = bhr_camera_advance(film->context, &film->scene.camera, proper_time, &elapsed);
    if (status >= 0) {
        film->proper_time += proper_time;
        film->scene.time += elapsed;
    }
    return status;
}

/* ---- frames ---- */

static void write_clock(Slot *slot) {
    char     text[96];
    uint32_t scale = slot->image.width / 480 > 1 ? slot->image.width / 480 : 1; /* the text is 300 wide at 1 */
    snprintf(text, sizeof text, "tau = %.2f M   r = %.2f M%s", slot->proper_time, slot->radius,
             slot->radius < HORIZON ? "   inside the horizon" : "");
    picture_write(&slot->image, 4 * scale, slot->image.height - CELL_HEIGHT * scale, scale, text);
}

/* Waits for the slot's frame and puts it where the film goes. 1, or 0 after a message. */
static int finish(Film *film, Slot *slot) {
    const Settings *s = film->settings;
    BhrStatus       status = bhr_job_wait(slot->job, UINT64_MAX, NULL);
    if (status < 0) {
        report_failure("render a frame", status);
        return 0;
    }
    bhr_job_destroy(slot->job);
    slot->job = NULL;
    if (!s->no_clock) {
        write_clock(slot);
    }
    if (is_terminal(stderr)) {
        fprintf(stderr, "\rframe %u of %u", (unsigned)slot->number + 1, (unsigned)s->frames);
    }
    if (s->video != NULL) {
        return video_add(&film->video, &slot->image);
    }
    char name[32];
    snprintf(name, sizeof name, "frame-%05u.png", (unsigned)slot->number);
    return picture_save_into(&slot->image, s->output, name);
}

/* Begins the frame of the scene as it is now. 1, or 0 after a message. */
static int begin(Film *film, Slot *slot, uint32_t number) {
    BhrStatus status = scene_apply(&film->scene, film->context);
    if (status >= 0) {
        status = bhr_render_image_async(film->context, &slot->image, &slot->job);
    }
    if (status < 0) {
        report_failure("begin a frame", status);
        return 0;
    }
    slot->number = number;
    slot->proper_time = film->proper_time;
    slot->radius = length(film->scene.camera.position);
    return 1;
}

/* 1, or 0 after a message. */
static int make_frames(Film *film) {
    const Settings *s = film->settings;
    double          step = s->frames > 1 ? (time_left(s->from) - time_left(s->to)) / (s->frames - 1) : 0.0;
    for (uint32_t i = 0; i < s->frames; i++) {
        Slot     *slot = &film->slots[i % JOBS];
        BhrStatus status = i > 0 ? fall_on(film, step) : BHR_OK;
        if (status < 0) {
            report_failure("fall on", status);
            return 0;
        }
        if ((slot->job != NULL && !finish(film, slot)) || !begin(film, slot, i)) {
            return 0;
        }
    }
    for (uint32_t i = s->frames; i < s->frames + JOBS; i++) { /* the last ones, in their order */
        Slot *slot = &film->slots[i % JOBS];
        if (slot->job != NULL && !finish(film, slot)) {
            return 0;
        }
    }
    return 1;
}

/* ---- the film ---- */

/* 1, or 0 after a message. */
static int prepare(Film *film) {
    const Settings *s = film->settings;
    for (int i = 0; i < JOBS; i++) {
        if (!picture_allocate(&film->slots[i].image, BHR_FORMAT_RGBA8_SRGB, s->size[0], s->size[1])) {
            return 0;
        }
    }
    BhrStatus status = create_context_on(s->backend, &film->context);
    if (status >= 0 && scene_input_finish(s->input, film->context, s->options, s->argc, s->argv) != 0) {
        return 0;
    }
    if (status >= 0) {
        status = begin_fall(&film->scene, s);
    }
    if (status >= 0) {
        status = scene_apply(&film->scene, film->context);
    }
    if (status < 0) {
        report_failure("prepare the film", status);
    }
    return status >= 0;
}

/* 1, or 0 after a message. */
static int make_film(Film *film) {
    const Settings *s = film->settings;
    if (s->video != NULL) {
        if (!video_open(&film->video, s->video, s->size[0], s->size[1], s->rate)) {
            return 0;
        }
        int made = make_frames(film);
        return video_close(&film->video) && made;
    }
    if (!make_folder(s->output) && errno != EEXIST) {
        fprintf(stderr, "cannot make the folder %s: %s\n", s->output, strerror(errno));
        return 0;
    }
    return make_frames(film);
}

/* Jobs first: until then the pixels are theirs. */
static void give_back(Film *film) {
    for (int i = 0; i < JOBS; i++) {
        bhr_job_destroy(film->slots[i].job);
    }
    bhr_context_destroy(film->context);
    for (int i = 0; i < JOBS; i++) {
        free(film->slots[i].image.pixels);
    }
}

/* An exit status. */
static int film_fall(const Settings *s) {
    Film   film = {.settings = s};
    double start = wall_seconds();
    int    made = prepare(&film) && make_film(&film);
    give_back(&film);
    if (is_terminal(stderr)) {
        fputc('\n', stderr);
    }
    if (!made) {
        return EXIT_FAILURE;
    }
    printf("%u frame%s of %u x %u in %.1f s: %s%s\n", (unsigned)s->frames, s->frames == 1 ? "" : "s",
           (unsigned)s->size[0], (unsigned)s->size[1], wall_seconds() - start, s->video != NULL ? s->video : s->output,
           s->video != NULL ? "" : "/frame-00000.png and on");
    return EXIT_SUCCESS;
}

/* ---- command line ---- */

/* 1 when it is in the range; else 0 after a message. */
static int in_range(const char *option, double value, double least, double most) {
    if (value >= least && value <= most) {
        return 1;
    }
    fprintf(stderr, "film: %s is %g; it must be %g to %g\n", option, value, least, most);
    return 0;
}

/* 0, or EXIT_USAGE after a message. What is not checked here the library checks. */
static int check(const Settings *s) {
    if (!in_range("--frames", s->frames, 1.0, MOST_FRAMES) || !in_range("--fps", s->rate, 1.0, MOST_RATE) ||
        !in_range("--to", s->to, LEAST_RADIUS, MOST_RADIUS) || !in_range("--from", s->from, s->to, MOST_RADIUS)) {
        return EXIT_USAGE;
    }
    if (s->video != NULL && (s->size[0] % 2 != 0 || s->size[1] % 2 != 0)) {
        fprintf(stderr, "film: --size is %ux%u; a video's width and height must be even\n", (unsigned)s->size[0],
                (unsigned)s->size[1]);
        return EXIT_USAGE;
    }
    return 0;
}

static int run(int argc, char **argv) {
    SceneInput input;
    Options    options = {.count = 0};
    Settings   s = {.input = &input, .options = &options, .argc = argc, .argv = argv, .output = "film-out",
                    .frames = 240, .rate = 24, .size = {640, 360}, .samples = 4, .from = 12.0, .to = 0.05,
                    .elevation = 20.0, .fov = 100.0, .look = LOOK_IN, .projection = BHR_PROJECTION_PERSPECTIVE,
                    .backend = BHR_BACKEND_AUTO};
    const Option own[] = {
        {"--output", OPTION_TEXT, &s.output, "FOLDER", "for the pictures; made if need be", NULL, NULL},
        {"--video", OPTION_TEXT, &s.video, "FILE", "a video instead of pictures, by ffmpeg; overwritten", NULL, NULL},
        {"--frames", OPTION_UINT, &s.frames, "N", "evenly spaced in proper time", NULL, "1 to 99999"},
        {"--fps", OPTION_UINT, &s.rate, "N", "frames per second of the video", NULL, "1 to 1000"},
        {"--size", OPTION_SIZE, s.size, "WxH", "pixels", NULL, NULL},
        {"--samples", OPTION_UINT, &s.samples, "N", "per pixel", NULL, "1 to 256"},
        {"--from", OPTION_DOUBLE, &s.from, "R", "the first frame's radius in M", NULL, NULL},
        {"--to", OPTION_DOUBLE, &s.to, "R", "the last frame's radius in M", NULL, NULL},
        {"--elevation", OPTION_DOUBLE, &s.elevation, "DEG", "above the disk's plane", NULL, NULL},
        {"--fov", OPTION_DOUBLE, &s.fov, "DEG", "vertical field of view", NULL, NULL},
        {"--projection", OPTION_CHOICE, &s.projection, NULL, "fisheye for domes", PROJECTIONS, NULL},
        {"--look", OPTION_CHOICE, &s.look, NULL, "to the hole, from it, or across", LOOKS, NULL},
        {"--no-clock", OPTION_FLAG, &s.no_clock, NULL, "writes no proper time and radius into the picture", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    BhrStatus status = scene_input_init(&input);
    if (status < 0) {
        return report_failure("begin", status);
    }
    begin_look(&input.scene);
    options_add(&options, own, COUNT_OF(own));
    options_add_scene(&options, &input,
                      SCENE_PRESET | SCENE_LENS | SCENE_EYES | SCENE_DISK | SCENE_MATTER | SCENE_SKY | SCENE_FILM |
                          SCENE_EFFECTS);
    int result = options_parse(options.list, options.count, argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.help) {
        printf("Usage: film [options]\nA fall into a black hole, as numbered pictures or as a video.\n\n");
        options_print(stdout, options.list, options.count);
        return EXIT_SUCCESS;
    }
    result = check(&s);
    return result != 0 ? result : film_fall(&s);
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
