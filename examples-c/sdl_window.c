/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* sdl_window.c -- a black hole in a window of SDL2: all that a host has to do for frames in a window of its own, from
 * the handle to every status that a frame can come back with. Drag with the mouse to go about the hole. Needs SDL 2.26,
 * for sizes in pixels; needs no renderer and no OpenGL of SDL's. */
#include "options.h"

#define SDL_MAIN_HANDLED /* main stays main, on Windows too */
#include <SDL.h>
#include <SDL_syswm.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef SDL_VIDEO_DRIVER_COCOA
#include <objc/message.h>
#endif

#define DISTANCE 28.0             /* of the camera from the hole, in M */
#define STEEPEST 1.5              /* elevation of the camera, radians */
#define RADIANS_PER_PIXEL 0.005   /* of a drag */
#define SCENE_TIME_PER_SECOND 5.0 /* in M */
#define MACHINE_STEP (1.0 / 60.0) /* seconds between the frames of --frames */
#define SKIPPED_WAIT_MS 100       /* for an event, where the window takes no frames */
#define MOST_FAILURES 3           /* frames in a row, before it gives up */

typedef struct Settings {
    uint32_t    size[2], frames;
    double      hold;
    int32_t     backend;
    const char *screenshot;
    int         verbose, help;
} Settings;

typedef struct Program {
    SDL_Window *window;
    BhrContext *context;
    BhrSurface *surface;
    uint32_t    size[2]; /* of the window, in pixels; 0 x 0: minimised */
    double      azimuth, elevation, time;
    uint32_t    frames; /* that were presented */
    int         failures, skipped, closed;
} Program;

/* Says what a call of bhr's on this thread has failed with; returns 0. */
static int complain(const char *what) {
    fprintf(stderr, "cannot %s: %s\n", what, bhr_error_message());
    return 0;
}

/* ---- the window's handle ---- */

/* 1; 0 for a video driver of SDL's that has no windows of bhr's kinds. */
static int window_from_sdl(SDL_Window *window, BhrWindow *out) {
    SDL_SysWMinfo info;
    memset(out, 0, sizeof *out);
    out->struct_size = sizeof *out;
    SDL_VERSION(&info.version);
    if (!SDL_GetWindowWMInfo(window, &info)) {
        return 0;
    }
    switch (info.subsystem) {
#ifdef SDL_VIDEO_DRIVER_X11
    case SDL_SYSWM_X11:
        out->kind = BHR_WINDOW_XLIB;
        out->display = info.info.x11.display;
        out->id = info.info.x11.window;
        return 1;
#endif
#ifdef SDL_VIDEO_DRIVER_WAYLAND
    case SDL_SYSWM_WAYLAND:
        out->kind = BHR_WINDOW_WAYLAND;
        out->display = info.info.wl.display;
        out->handle = info.info.wl.surface;
        return 1;
#endif
#ifdef SDL_VIDEO_DRIVER_WINDOWS
    case SDL_SYSWM_WINDOWS:
        out->kind = BHR_WINDOW_WIN32;
        out->handle = info.info.win.window;
        out->aux = info.info.win.hinstance;
        return 1;
#endif
#ifdef SDL_VIDEO_DRIVER_COCOA
    case SDL_SYSWM_COCOA: {
        /* bhr draws into a view: [window contentView], said in plain C. */
        id (*send)(id, SEL) = (id(*)(id, SEL))objc_msgSend;
        out->kind = BHR_WINDOW_APPKIT;
        out->handle = send((id)info.info.cocoa.window, sel_registerName("contentView"));
        return 1;
    }
#endif
    default:
        return 0;
    }
}

/* ---- the surface; functions that return an int give 0 when the program cannot go on ---- */

/* Also instead of one that was lost. */
static int open_surface(Program *p) {
    BhrWindow window;
    bhr_surface_destroy(p->surface); /* a window takes one at a time */
    p->surface = NULL;
    if (!window_from_sdl(p->window, &window)) {
        fprintf(stderr, "SDL's video driver %s has no windows that bhr knows\n", SDL_GetCurrentVideoDriver());
        return 0;
    }
    return bhr_surface_create(p->context, &window, p->size[0], p->size[1], BHR_PRESENT_VSYNC, &p->surface) >= 0 ||
           complain("render into the window");
}

/* The context keeps its scene; the surface belonged to the device that is gone. */
static int recover(Program *p) {
    return bhr_context_recover(p->context) >= 0 ? open_surface(p) : complain("bring the GPU back");
}

/* Pixels: on a high-DPI display more than SDL's units. */
static void read_size(Program *p) {
    int width, height;
    SDL_GetWindowSizeInPixels(p->window, &width, &height);
    p->size[0] = (uint32_t)width;
    p->size[1] = (uint32_t)height;
}

/* Renders the context's scene into the window. */
static int present(Program *p) {
    BhrStatus status = bhr_render_surface(p->context, p->surface);
    p->skipped = status == BHR_FRAME_SKIPPED;
    if (status >= 0) {
        p->frames += status == BHR_OK;
        p->failures = 0;
        return 1;
    }
    complain("render the frame");
    if (++p->failures < MOST_FAILURES && status == BHR_ERROR_SURFACE_LOST) {
        return open_surface(p);
    }
    return p->failures < MOST_FAILURES && status == BHR_ERROR_DEVICE_LOST && recover(p);
}

/* ---- the scene ---- */

/* Set once, for all frames. */
static int begin_scene(const Program *p) {
    BhrDisk disk;
    if (bhr_disk_init(&disk, sizeof disk) < 0) {
        return complain("make a disk");
    }
    disk.turbulence = 0.7;
    return (bhr_set_spin(p->context, 0.9) >= 0 && bhr_set_disk(p->context, &disk) >= 0) || complain("begin the scene");
}

/* Set anew for each frame. */
static int move_scene(const Program *p) {
    BhrCamera camera;
    return (bhr_camera_init(&camera, sizeof camera) >= 0 &&
            bhr_camera_orbit(&camera, DISTANCE, p->azimuth, p->elevation) >= 0 &&
            bhr_set_camera(p->context, &camera) >= 0 && bhr_set_time(p->context, p->time) >= 0) ||
           complain("move the scene");
}

/* The scene as the window shows it, by way of the host's memory. */
static int save_picture(const Program *p, const char *path) {
    BhrImage image;
    if (bhr_image_init(&image, sizeof image) < 0) {
        return complain("make an image");
    }
    image.width = p->size[0];
    image.height = p->size[1];
    image.byte_size = (uint64_t)4 * image.width * image.height;
    image.pixels = malloc((size_t)image.byte_size);
    int saved = (bhr_render_image(p->context, &image) >= 0 && bhr_image_save(&image, path) >= 0) ||
                complain("save the picture");
    free(image.pixels);
    return saved;
}

/* ---- the loop ---- */

static void handle_window_event(Program *p, Uint8 event) {
    switch (event) {
    case SDL_WINDOWEVENT_MINIMIZED:
    case SDL_WINDOWEVENT_HIDDEN:
        p->size[0] = p->size[1] = 0;
        break;
    case SDL_WINDOWEVENT_SIZE_CHANGED:
    case SDL_WINDOWEVENT_RESTORED:
    case SDL_WINDOWEVENT_SHOWN:
        read_size(p);
        break;
    default:
        return;
    }
    if (bhr_surface_resize(p->surface, p->size[0], p->size[1]) < 0) {
        complain("follow the window's size"); /* the next frame says whether that matters */
    }
}

static void handle_event(Program *p, const SDL_Event *event) {
    if (event->type == SDL_QUIT) {
        p->closed = 1;
    } else if (event->type == SDL_WINDOWEVENT) {
        handle_window_event(p, event->window.event);
    } else if (event->type == SDL_MOUSEMOTION && (event->motion.state & SDL_BUTTON_LMASK)) {
        p->azimuth -= RADIANS_PER_PIXEL * event->motion.xrel;
        p->elevation = fmax(-STEEPEST, fmin(STEEPEST, p->elevation + RADIANS_PER_PIXEL * event->motion.yrel));
    }
}

/* Waits for an event where frames are skipped: presenting then no longer slows the loop down. */
static void handle_events(Program *p) {
    SDL_Event event;
    int       some = p->skipped ? SDL_WaitEventTimeout(&event, SKIPPED_WAIT_MS) : SDL_PollEvent(&event);
    for (; some; some = SDL_PollEvent(&event)) {
        handle_event(p, &event);
    }
}

/* Until the window is closed, or so many frames are presented (0: without end). */
static int show(Program *p, uint32_t frames) {
    double last = wall_seconds();
    while (!p->closed && (frames == 0 || p->frames < frames)) {
        if (!move_scene(p) || !present(p)) {
            return 0;
        }
        handle_events(p);
        double now = wall_seconds();
        if (!p->skipped) { /* what nobody sees stands still */
            p->time += SCENE_TIME_PER_SECOND * (frames != 0 ? MACHINE_STEP : now - last);
        }
        last = now;
    }
    return 1;
}

/* The last picture stays: whoever tests the window can compare. */
static int hold(Program *p, double seconds) {
    const double end = wall_seconds() + seconds;
    puts("holding");
    while (!p->closed && wall_seconds() < end) {
        if (!present(p)) {
            return 0;
        }
        handle_events(p);
    }
    return 1;
}

/* ---- beginning and end ---- */

static int open_window(Program *p, const Settings *s) {
    const int place = SDL_WINDOWPOS_UNDEFINED;
    SDL_SetMainReady();
    SDL_SetHint(SDL_HINT_WINDOWS_DPI_SCALING, "1"); /* else Windows stretches the picture on a dense display */
    if (SDL_Init(SDL_INIT_VIDEO) == 0 && s->size[0] <= INT32_MAX && s->size[1] <= INT32_MAX) {
        p->window = SDL_CreateWindow("bhr", place, place, (int)s->size[0], (int)s->size[1],
                                     SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
    }
    if (p->window == NULL) {
        fprintf(stderr, "cannot open a window of %u x %u: %s\n", s->size[0], s->size[1], SDL_GetError());
        return 0;
    }
    read_size(p);
    return 1;
}

/* On an adapter that can present to the window. */
static int open_context(Program *p, const Settings *s) {
    BhrContextOptions options;
    BhrWindow         window;
    if (bhr_context_options_init(&options, sizeof options) < 0) {
        return complain("make options");
    }
    options.backend = s->backend;
    options.compatible_window = window_from_sdl(p->window, &window) ? &window : NULL;
    options.log_fn = s->verbose ? log_to_stderr : NULL;
    options.log_level = BHR_LOG_INFO;
    return bhr_context_create(BHR_ABI_VERSION, &options, &p->context) >= 0 || complain("create a context");
}

/* The surface goes before its window. bhr takes NULL. */
static void finish(Program *p) {
    bhr_surface_destroy(p->surface);
    bhr_context_destroy(p->context);
    if (p->window != NULL) {
        SDL_DestroyWindow(p->window);
    }
    SDL_Quit();
}

static int run(const Settings *s) {
    Program p = {.azimuth = 0.4, .elevation = 0.15};
    int     good = open_window(&p, s) && open_context(&p, s) && begin_scene(&p) && open_surface(&p) &&
               show(&p, s->frames);
    printf("frames %u\n", p.frames);
    good = good && (s->screenshot == NULL || save_picture(&p, s->screenshot)) && (s->hold <= 0.0 || hold(&p, s->hold));
    finish(&p);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv) {
    Settings     s = {.size = {1280, 720}};
    const Option options[] = {
        {"--size", OPTION_SIZE, s.size, "WxH", "of the window, in SDL's units", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--frames", OPTION_UINT, &s.frames, "N", "ends after N frames, 1/60 s apart; 0: never", NULL, NULL},
        {"--screenshot", OPTION_TEXT, &s.screenshot, "FILE", "saves the last picture, .png or .ppm", NULL, NULL},
        {"--hold", OPTION_DOUBLE, &s.hold, "SECONDS", "keeps the last picture before it ends", NULL, NULL},
        {"--verbose", OPTION_FLAG, &s.verbose, NULL, "the library's log on stderr", NULL, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result != 0) {
        return result;
    }
    say_at_once();
    if (s.help) {
        printf("Usage: sdl_window [options]\nA black hole in a window of SDL2. Drag: about the hole.\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    return run(&s);
}
