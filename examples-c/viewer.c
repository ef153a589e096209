/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer.c -- a black hole in a window, to fly around in: how a host hands its window to bhr, presents frames, follows
 * sizes, and lives through a lost window or GPU. Its camera, scene, quality, input and pictures are in viewer_*.c.
 * Lengths on the command line are in units of the hole's mass M, angles in degrees. */
#include "scene_options.h"
#include "viewer.h"
#include "viewer_input.h"
#include "viewer_news.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In seconds: */
#define LONGEST_STEP 0.1          /* after a stall the scene goes on from where it was */
#define MACHINE_STEP (1.0 / 60.0) /* between the frames of --frames */
#define MOVING_FOR 0.2            /* after a change by hand another one is likely for so long */
#define RESTING_WAIT 0.25         /* between looks at a picture that rests, or cannot be seen */
#define BUSY_WAIT 0.02            /* between looks at frames in the background */
#define MOST_FAILURES 3 /* frames in a row, before it gives up */

typedef struct Settings {
    uint32_t       size[2];
    SceneInput    *input;         /* laid over the preset once there is a context: with these arguments */
    const Options *options;
    int            argc;
    char         **argv;
    int32_t        backend, present;
    uint32_t       frames;
    double         rate, hold;
    const char    *scene, *screenshot;
    int            validation, verbose, help;
} Settings;

static const Choice PRESENT_MODES[] = {{"vsync", BHR_PRESENT_VSYNC},
                                       {"immediate", BHR_PRESENT_IMMEDIATE},
                                       {"mailbox", BHR_PRESENT_MAILBOX},
                                       {NULL, 0}};

/* ---- the surface ---- */

/* 1, or 0 after a message. */
static int open_surface(Viewer *v) {
    BhrWindow window;
    if (!window_from_glfw(v->window, &window)) {
        fprintf(stderr, "cannot use the window: this program was built without the platform that GLFW runs on\n");
        return 0;
    }
    BhrStatus status = bhr_surface_create(v->context, &window, v->size[0], v->size[1], v->present, &v->surface);
    if (status < 0) {
        report_failure("render into the window", status);
    }
    v->dirty = 1;
    return status >= 0;
}

static int reopen_surface(Viewer *v) {
    bhr_surface_destroy(v->surface);
    v->surface = NULL;
    return open_surface(v);
}

/* The context keeps the scene; what belonged to the device, the surface, is made again. */
static int recover(Viewer *v) {
    bhr_surface_destroy(v->surface);
    v->surface = NULL;
    BhrStatus status = bhr_context_recover(v->context);
    if (status < 0) {
        report_failure("bring the GPU back", status);
        return 0;
    }
    printf("the GPU is back\n");
    return open_surface(v);
}

/* ---- what has to be done ---- */

static int time_runs(const Viewer *v) { return !v->paused && !v->still && v->pace != 0.0; }

static int is_moving(const Viewer *v) {
    if (v->still) {
        return 0;
    }
    return v->recorder.taking || v->fixed_step > 0.0 || v->now - v->changed_at < MOVING_FOR ||
           pilot_is_moving(&v->pilot) ||
           (time_runs(v) && (v->pilot.motion != BHR_MOTION_STATIC || scene_changes_with_time(&v->scene)));
}

/* All frames that a machine asked for are presented. */
static int is_complete(const Viewer *v) { return v->most_frames != 0 && v->frames >= v->most_frames && !v->still; }

static int is_visible(const Viewer *v) { return v->size[0] != 0 && v->size[1] != 0; }

static int needs_frame(const Viewer *v) {
    return is_visible(v) && !v->broken && !is_complete(v) &&
           (v->dirty || is_moving(v) || !governor_is_done(&v->governor, &v->scene.quality));
}

/* Back to the scene of the last good frame, with everything that led away from it stopped. */
static void go_back(Viewer *v) {
    BhrMotion motion = v->good.camera.motion;
    v->scene = v->good;
    pilot_stop(&v->pilot, motion == BHR_MOTION_VELOCITY ? BHR_MOTION_ORBIT : motion);
    v->tried_view = v->scene.view;
    v->paused = 1;
    v->dirty = 1;
    printf("back to the last picture; time stands still\n");
    v->broken |= ++v->failures >= MOST_FAILURES;
}

/* ---- a frame ---- */

/* Moves the scene on, by the wall clock or by the fixed step of machines and recordings. */
static void move(Viewer *v) {
    double now = wall_seconds(), seconds = fmin(now - v->now, LONGEST_STEP);
    v->now = now;
    if (v->still || is_complete(v) || (v->fixed_step > 0.0 && v->skipped)) {
        return; /* every step of a machine's run is presented */
    }
    if (v->fixed_step > 0.0 || v->recorder.taking) {
        seconds = v->fixed_step > 0.0 ? v->fixed_step : 1.0 / RECORDED_RATE;
    }
    double    proper_time = time_runs(v) ? v->pace * v->scene.mass * seconds : 0.0;
    BhrStatus status = scene_apply(&v->scene, v->tester);
    if (status >= 0) {
        status = pilot_step(&v->pilot, &v->scene, v->tester, seconds, proper_time);
    }
    if (status < 0) {
        report_failure("move the camera", status);
        go_back(v);
    }
}

/* The cost of a presented frame: the governor wants to know. */
static void account(Viewer *v) {
    double now = wall_seconds(), seconds = v->presented_at > 0.0 ? now - v->presented_at : 0.0;
    governor_hear(&v->governor, v->frame_moves, seconds, (double)v->frame.stats.gpu_ns * 1e-9);
    v->presented_at = now;
    v->good = v->frame_scene;
    v->failures = 0;
    v->frames++;
    v->frames_untitled++;
    if (v->recorder.taking) {
        Scene scene = v->frame_scene;
        governor_choose_for_picture(&v->governor, &scene.quality);
        recorder_take(&v->recorder, &scene);
    }
}

/* Begins to render and to present the scene. */
static void start_frame(Viewer *v) {
    Scene shown = v->frame_scene = v->scene;
    v->frame_moves = is_moving(v);
    if (v->frame_moves || v->dirty) {
        governor_restart(&v->governor);
    }
    v->dirty = 0;
    governor_choose(&v->governor, v->frame_moves, &shown.quality);
    frame_begin(&v->frame, v->context, v->surface, &shown);
}

/* Deals with every status that can come of a frame. */
static void finish_frame(Viewer *v) {
    v->skipped = v->frame.status == BHR_FRAME_SKIPPED;
    switch (v->frame.status) {
    case BHR_OK:
        account(v);
        break;
    case BHR_FRAME_SKIPPED:
        v->dirty = 1;
        break;
    case BHR_ERROR_DEVICE_LOST:
        v->broken |= ++v->failures >= MOST_FAILURES || !recover(v);
        break;
    case BHR_ERROR_SURFACE_LOST:
        v->broken |= ++v->failures >= MOST_FAILURES || !reopen_surface(v);
        break;
    default: /* what was set cannot be, or not here: the last picture could */
        go_back(v);
        break;
    }
}

BhrStatus viewer_load(Viewer *v, const char *path) {
    Scene     scene;
    BhrStatus status = bhr_scene_load_file(v->tester, path);
    if (status >= 0) {
        status = bhr_scene_load_file(v->context, path);
    }
    if (status >= 0) {
        status = scene_read(&scene, v->context);
    }
    if (status < 0) {
        return status;
    }
    recorder_stop(&v->recorder); /* its context has the map and the LUT of the scene before */
    governor_take_resolution(&v->governor, v->context);
    v->scene = v->first = scene;
    pilot_stop(&v->pilot, scene.camera.motion == BHR_MOTION_VELOCITY ? BHR_MOTION_ORBIT : scene.camera.motion);
    v->pilot.looked_away = 1; /* the view is the file's, too */
    v->tried_view = scene.view;
    v->tried_projection = scene.camera.projection;
    v->preset = NO_PRESET;
    v->matter = -1;
    return BHR_OK;
}

/* Seconds until the display wants the next frame. Some displays, as one without a screen, do not hold frames back: what
 * nobody would see is not rendered. */
static double spare_time(const Viewer *v) {
    if (v->present == BHR_PRESENT_IMMEDIATE || v->fixed_step > 0.0 || v->presented_at == 0.0) {
        return 0.0;
    }
    double spare = 0.9 * v->governor.period - (wall_seconds() - v->presented_at);
    return spare > 0.5 * v->governor.period ? spare : 0.0; /* less may be the display's own rhythm: leave it alone */
}

/* Sleeps while there is nothing to do: a resting picture costs no power. */
static void handle_events(Viewer *v) {
    const double spare = spare_time(v);
    if (v->frame.busy) {
        glfwWaitEventsTimeout(BUSY_WAIT); /* its end is an event, too */
    } else if (!is_visible(v)) {
        glfwWaitEventsTimeout(RESTING_WAIT);
    } else if (v->skipped || !needs_frame(v)) {
        v->presented_at = 0.0;
        glfwWaitEventsTimeout(viewer_is_busy(v) ? BUSY_WAIT : RESTING_WAIT);
        v->now = wall_seconds(); /* the scene did not move meanwhile */
    } else if (spare > 0.0) {
        glfwWaitEventsTimeout(spare);
    } else {
        glfwPollEvents();
    }
}

/* The window has another size since the last frame. */
static void follow_size(Viewer *v) {
    v->resized = 0;
    BhrStatus status = bhr_surface_resize(v->surface, v->size[0], v->size[1]);
    if (status < 0) {
        report_failure("follow the window's size", status); /* the next frame says whether that matters */
    }
}

/* The windows over this one go along. */
static void take_overlays_along(Viewer *v) {
    const int has_focus = !glfwGetWindowAttrib(v->window, GLFW_ICONIFIED) &&
                          (glfwGetWindowAttrib(v->window, GLFW_FOCUSED) || overlay_has_focus(&v->keys.overlay) ||
                           overlay_has_focus(&v->bar.overlay));
    bar_window_follow(&v->bar, v->window, has_focus);
    text_window_follow(&v->keys, v->window, bar_window_height(&v->bar), has_focus);
}

/* One turn of the loop after the events; also called while the system's own loop drags an edge of the window. Before
 * the next frame there is a turn without one, so that the loop can wait for the display. */
static void turn(Viewer *v) {
    if (v->frame.busy) {
        if (frame_take(&v->frame, 0)) {
            finish_frame(v);
        }
    } else {
        input_act_late(v);
        if (v->resized) {
            follow_size(v);
        }
        move(v);
        if (needs_frame(v)) {
            start_frame(v);
        }
    }
    take_overlays_along(v);
    viewer_watch(v);
    viewer_update_title(v, is_moving(v));
}

/* The context is the caller's again. */
static void wait_for_frame(Viewer *v) {
    if (frame_take(&v->frame, 1)) {
        finish_frame(v);
    }
}

/* The bar that the last frame's colours need. */
static void show_bar(Viewer *v) {
    ColourBar bar;
    colour_bar_of(v->good.view, &v->good.film, &bar);
    if (v->frames > 0 && bar_window_set(&v->bar, v->window, &bar)) {
        input_attach(v, v->bar.overlay.window);
    }
}

/* Until the window is closed, or everything is shown. */
static void show(Viewer *v) {
    v->now = wall_seconds();
    while (!glfwWindowShouldClose(v->window) && !v->broken && !is_complete(v)) {
        handle_events(v);
        turn(v);
        show_bar(v);
    }
    if (glfwWindowShouldClose(v->window)) {
        text_window_hide(&v->keys);
        bar_window_hide(&v->bar);
        glfwHideWindow(v->window); /* a user who has closed it need not see the end of a long frame */
    }
    wait_for_frame(v);
}

/* The last picture stays, as it is: whoever tests the window can compare. */
static void hold(Viewer *v, double seconds) {
    const double end = wall_seconds() + seconds;
    v->still = 1;
    puts("holding");
    while (!glfwWindowShouldClose(v->window) && !v->broken && wall_seconds() < end) {
        handle_events(v);
        turn(v);
        show_bar(v);
    }
}

/* ---- callbacks of GLFW ---- */

static void on_error(int code, const char *description) {
    fprintf(stderr, "GLFW: %s (error 0x%x)\n", description, (unsigned)code);
}

static void on_framebuffer_size(GLFWwindow *window, int width, int height) {
    Viewer *v = glfwGetWindowUserPointer(window);
    v->size[0] = (uint32_t)width;
    v->size[1] = (uint32_t)height;
    v->changed_at = v->now;
    v->dirty = v->resized = 1;
}

/* The system wants the contents again, as while an edge is dragged: GLFW's poll does not return then. */
static void on_refresh(GLFWwindow *window) {
    Viewer *v = glfwGetWindowUserPointer(window);
    v->dirty = 1;
    turn(v);
}

/* By the window's frame. */
static void on_close(GLFWwindow *window) {
    Viewer *v = glfwGetWindowUserPointer(window);
    glfwSetWindowShouldClose(window, GLFW_FALSE);
    viewer_quit(v);
}

/* ---- beginning and end ---- */

static GLFWwindow *open_window(const Settings *s) {
    glfwSetErrorCallback(on_error);
    if (!glfwInit()) {
        fprintf(stderr, "cannot open a window: is there a display? (X11: DISPLAY; Wayland: WAYLAND_DISPLAY)\n");
        return NULL;
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API); /* bhr brings its own graphics */
    /* On a full screen a click on what lies over the window may take the keyboard from it for a moment. */
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    const int      sized = s->size[0] != 0;
    const uint32_t width = sized ? s->size[0] : 1280, height = sized ? s->size[1] : 720;
    /* A size that was asked for is meant in pixels. */
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, sized ? GLFW_FALSE : GLFW_TRUE);
    if (width > INT32_MAX || height > INT32_MAX) {
        fprintf(stderr, "cannot open a window of %u x %u\n", (unsigned)width, (unsigned)height);
        return NULL;
    }
    return glfwCreateWindow((int)width, (int)height, "bhr", NULL, NULL);
}

static double display_rate(void) {
    GLFWmonitor       *monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode *mode = monitor != NULL ? glfwGetVideoMode(monitor) : NULL;
    return mode != NULL ? mode->refreshRate : 0.0;
}

static void print_what_renders(const BhrAdapterInfo *adapter, int32_t backend) {
    printf("rendering on ");
    print_adapter(stdout, adapter);
    putchar('\n');
    if (backend == BHR_BACKEND_AUTO) {
        print_driver_advice(stdout, adapter, "");
    }
    printf("H shows the keys, Esc quits\n");
}

/* A context on an adapter that can present to the window. */
static int open_context(Viewer *v, const Settings *s) {
    BhrContextOptions options;
    BhrWindow         window;
    BhrStatus         status = bhr_context_options_init(&options, sizeof options);
    if (status >= 0) {
        options.backend = s->backend;
        options.compatible_window = window_from_glfw(v->window, &window) ? &window : NULL;
        options.flags = s->validation ? BHR_CONTEXT_VALIDATION : 0;
        options.log_fn = s->verbose || s->validation ? log_to_stderr : NULL;
        options.log_level = s->verbose ? BHR_LOG_INFO : BHR_LOG_WARN;
        status = bhr_context_create(BHR_ABI_VERSION, &options, &v->context);
    }
    if (status >= 0) {
        status = create_context_on(BHR_BACKEND_CPU, &v->tester);
    }
    if (status >= 0) {
        BHR_INIT(v->adapter);
        status = bhr_context_adapter(v->context, &v->adapter);
    }
    if (status < 0) {
        report_failure("create a context", status);
        return 0;
    }
    print_what_renders(&v->adapter, s->backend);
    return 1;
}

/* The goal of --matter auto: the window, at the display's rate. */
static void set_goal(BhrPresetOptions *options, const Viewer *v, const Settings *s) {
    options->width = v->size[0];
    options->height = v->size[1];
    const double rate = s->rate > 0.0 ? s->rate : display_rate();
    options->frame_ms = rate > 0.0 ? fmax(1e-3, fmin(1000.0 / rate, 1e9)) : 0.0; /* 0: the library's */
    options->may_halve = 1; /* while the picture moves: the governor begins with it (governor_take_resolution) */
    if (s->frames != 0 && options->matter == BHR_PRESET_MATTER_AUTO) {
        options->matter = BHR_PRESET_MATTER_THIN; /* the same frames on every machine */
    }
}

static int set_first_scene(Viewer *v, const Settings *s) {
    set_goal(&s->input->preset_options, v, s);
    if (scene_input_finish(s->input, v->context, s->options, s->argc, s->argv) != 0) {
        return 0;
    }
    /* Such an adapter is not asked for a whole picture in time: the quality begins low, and rises. */
    const int software = (v->adapter.flags & BHR_ADAPTER_SOFTWARE) != 0;
    governor_init(&v->governor, s->rate > 0.0 ? s->rate : display_rate(), software ? 0.25 : 1.0);
    governor_take_resolution(&v->governor, v->context);
    v->scene = s->input->scene;
    const int32_t motion = v->scene.camera.motion; /* the pilot sets the motion */
    v->scene.camera.motion = BHR_MOTION_STATIC;
    BhrStatus status = scene_apply(&v->scene, v->context);
    if (status < 0) {
        report_failure("set the scene", status);
        return 0;
    }
    status = scene_copy(v->context, v->tester);
    if (status < 0) {
        report_failure("copy the scene", status);
        return 0;
    }
    v->first = v->good = v->scene;
    v->tried_view = v->scene.view;
    v->tried_projection = v->scene.camera.projection;
    v->preset_options = s->input->preset_options;
    v->preset_matter = s->input->preset_matter;
    v->preset = s->input->preset; /* the key goes on from there; from none to the first */
    v->matter = -1; /* the key's first is the first kind */
    v->pilot.motion = motion;
    v->pilot.steered = 1;
    v->pace = FIRST_PACE;
    v->scene_path = s->scene != NULL ? s->scene : SAVED_SCENE;
    if (s->scene != NULL) {
        status = viewer_load(v, s->scene);
        if (status < 0) {
            report_failure("load the scene", status);
            return 0;
        }
        v->good = v->scene;
    }
    if (s->frames != 0) { /* the same frames on every machine */
        v->most_frames = s->frames;
        v->fixed_step = MACHINE_STEP;
        v->governor.enabled = 0;
    }
    return 1;
}

static int start(Viewer *v, const Settings *s) {
    v->present = s->present;
    v->window = open_window(s);
    if (v->window == NULL) {
        return 0;
    }
    int width, height;
    glfwGetFramebufferSize(v->window, &width, &height);
    v->size[0] = (uint32_t)width;
    v->size[1] = (uint32_t)height;
    if (!open_context(v, s) || !set_first_scene(v, s) || !open_surface(v) ||
        !frame_start(&v->frame, glfwPostEmptyEvent)) {
        return 0;
    }
    glfwSetWindowUserPointer(v->window, v);
    glfwSetFramebufferSizeCallback(v->window, on_framebuffer_size);
    glfwSetWindowRefreshCallback(v->window, on_refresh);
    glfwSetWindowCloseCallback(v->window, on_close);
    input_attach(v, v->window);
    return 1;
}

/* In any order; NULL is fine, except for the window. */
static void finish(Viewer *v) {
    frame_end(&v->frame);
    recorder_cancel(&v->recorder);
    picture_end(&v->picture);
    text_window_hide(&v->keys);
    bar_window_hide(&v->bar);
    bhr_surface_destroy(v->surface);
    bhr_context_destroy(v->context);
    bhr_context_destroy(v->tester);
    if (v->window != NULL) {
        glfwDestroyWindow(v->window);
    }
    glfwTerminate();
}

static int view(const Settings *s) {
    Viewer viewer = {0};
    int    good = start(&viewer, s);
    if (good) {
        show(&viewer);
        if (s->screenshot != NULL && !viewer.broken) {
            good = picture_save(viewer.context, viewer.size[0], viewer.size[1], s->screenshot);
        }
        if (s->hold > 0.0) {
            hold(&viewer, s->hold);
        }
    }
    if (viewer.broken) {
        fprintf(stderr, "the viewer cannot go on\n");
        good = 0;
    }
    finish(&viewer);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* ---- command line ---- */

static int run(int argc, char **argv) {
    SceneInput   input;
    Options      options = {.count = 0};
    Settings     s = {.input = &input, .options = &options, .argc = argc, .argv = argv};
    const Option first[] = {
        {"--size", OPTION_SIZE, s.size, "WxH", "of the window; 0x0: 1280x720", NULL, NULL},
        {"--scene", OPTION_TEXT, &s.scene, "FILE", "what to show (docs/scenes.md), without options of a scene", NULL,
         NULL}};
    const Option last[] = {
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--present", OPTION_CHOICE, &s.present, NULL, "how frames reach the screen", PRESENT_MODES, NULL},
        {"--rate", OPTION_DOUBLE, &s.rate, "FPS", "that the quality gives way to; 0: the display's", NULL, NULL},
        {"--frames", OPTION_UINT, &s.frames, "N", "ends after N frames, 1/60 s of the scene apart; 0: never", NULL,
         NULL},
        {"--screenshot", OPTION_TEXT, &s.screenshot, "FILE", "saves the last picture, .png or .ppm", NULL, NULL},
        {"--hold", OPTION_DOUBLE, &s.hold, "SECONDS", "keeps the last picture before it ends", NULL, NULL},
        {"--validation", OPTION_FLAG, &s.validation, NULL, "the graphics driver's checks, reported on stderr", NULL,
         NULL},
        {"--verbose", OPTION_FLAG, &s.verbose, NULL, "the library's log on stderr", NULL, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    BhrStatus status = scene_input_init(&input);
    if (status < 0) {
        return report_failure("begin", status);
    }
    scene_input_begin(&input, &SCENE_DEFAULTS);
    input.preset_options.matter = BHR_PRESET_MATTER_AUTO;
    options_add(&options, first, COUNT_OF(first));
    /* The quality follows the rate, and a window shows no eye of a pair. */
    options_add_scene(&options, &input, ALL_OF_SCENE & ~(SCENE_QUALITY | SCENE_EYES));
    options_add(&options, last, COUNT_OF(last));
    int result = options_parse(options.list, options.count, argc, argv);
    if (result == 0 && s.scene != NULL) {
        Options without = {.count = 0};
        options_add(&without, first, COUNT_OF(first));
        options_add(&without, last, COUNT_OF(last));
        result = options_parse(without.list, without.count, argc, argv);
        fputs(result != 0 ? "with --scene the file says all of the scene\n" : "", stderr);
    }
    if (result != 0) {
        return result;
    }
    if (s.help) {
        printf("Usage: viewer [options]\nA black hole in a window. Lengths in units of its mass M.\n\n");
        options_print(stdout, options.list, options.count);
        printf("\nKeys:\n");
        input_print_keys();
        return EXIT_SUCCESS;
    }
    if (input.scene.camera.motion == BHR_MOTION_VELOCITY) {
        fprintf(stderr, "%s: --motion velocity is not for a camera that moves by itself\n", argv[0]);
        return EXIT_USAGE;
    }
    return view(&s);
}

int main(int argc, char **argv) {
    say_at_once();
    return end_output(run(argc, argv));
}
