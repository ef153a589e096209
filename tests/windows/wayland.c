/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* wayland.c -- frames into windows of Wayland, made by SDL2: in each way that they can get there, through ten sizes, in
 * every present mode, from other threads. The compositor, whose screen of WIDTH x HEIGHT is the top left of DISPLAY's,
 * shows what bhr_render_image gives, and ends no connection over what bhr sends. VSYNC keeps to the compositor's rate
 * and never hangs: not in a hidden window, not in one that is gone. Wrong handles and states have their status. A
 * context that was made while the environment had no Wayland display serves windows of one that it got later.
 *
 *     wayland BACKEND direct|uploaded|memory
 *         environment: WAYLAND_DISPLAY, SDL_VIDEODRIVER=wayland, DISPLAY, COMPOSITOR (its process, which is stopped a
 *         while) */
#define _POSIX_C_SOURCE 200809L

#include "host.h"

#define SDL_MAIN_HANDLED
#include <SDL.h>
#include <SDL_syswm.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

#define WIDTH 320
#define HEIGHT 240
#define ROUNDS 10
#define PACED 40          /* frames that are timed */
#define HIGHEST_RATE 120. /* frames a second; the compositor's screen has 60, and its timers are coarse */
#define LONGEST 6.        /* seconds of a call that waits for the compositor: one, and what a busy machine adds */

static char said[4096]; /* by the log at level INFO */
static int  warnings;

static void remember(void *user, BhrLogLevel level, const char *message) {
    const size_t used = strlen(said);
    (void)user;
    snprintf(said + used, sizeof said - used, "%s\n", message);
    warnings += level <= BHR_LOG_WARN && strncmp(message, "bhr_", 4) != 0; /* those are of calls that fail */
}

static BhrContext *open_context(BhrBackend backend, const BhrWindow *compatible) {
    BhrContextOptions options = check_options(backend);
    options.log_level = BHR_LOG_INFO;
    options.log_fn = remember;
    options.compatible_window = compatible;
    return check_context_with(&options);
}

/* ---- windows ---- */

static SDL_Window *open_window(void) {
    SDL_Window *window = SDL_CreateWindow("wayland", 0, 0, WIDTH, HEIGHT, SDL_WINDOW_RESIZABLE);
    if (!CHECK(window != NULL, "SDL makes no window: %s", SDL_GetError())) {
        exit(check_end());
    }
    SDL_ShowCursor(SDL_DISABLE);
    SDL_PumpEvents();
    return window;
}

static BhrWindow handle_of(SDL_Window *window) {
    SDL_SysWMinfo info;
    BhrWindow     handle;
    memset(&handle, 0, sizeof handle);
    SDL_VERSION(&info.version);
    if (!CHECK(SDL_GetWindowWMInfo(window, &info) && info.subsystem == SDL_SYSWM_WAYLAND, "no window of Wayland")) {
        exit(check_end());
    }
    handle.struct_size = sizeof handle;
    handle.kind = BHR_WINDOW_WAYLAND;
    handle.display = info.info.wl.display;
    handle.handle = info.info.wl.surface;
    return handle;
}

static BhrSurface *open_surface(BhrContext *context, SDL_Window *window) {
    const BhrWindow handle = handle_of(window);
    BhrSurface     *surface = NULL;
    CHECK_OK(bhr_surface_create(context, &handle, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    if (surface == NULL) {
        exit(check_end());
    }
    return surface;
}

/* The compositor ends the connection of a client that sends what it may not: then nothing is answered any more. */
static void check_connected(const char *after) {
    SDL_Window *window = SDL_CreateWindow("another", 0, 0, 30, 30, 0);
    SDL_PumpEvents();
    CHECK(window != NULL, "no new window after %s: %s", after, SDL_GetError());
    SDL_DestroyWindow(window);
    CHECK(SDL_HasEvent(SDL_QUIT) == SDL_FALSE, "the connection ended after %s", after);
}

/* ---- tests ---- */

static void present(BhrContext *context, BhrSurface *surface, int frames) {
    for (int i = 0; i < frames; i++) {
        CHECK_OK(bhr_render_surface(context, surface));
        SDL_PumpEvents();
    }
}

/* The window, which fills the compositor's screen, shows the scene. */
static void check_shows(BhrContext *context, BhrSurface *surface, const char *what) {
    static unsigned char expected[WIDTH * HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, expected, sizeof expected);
    const Host           screen = host_screen();
    CHECK_OK(bhr_render_image(context, &image));
    present(context, surface, 3);
    const int difference = host_difference(&screen, WIDTH, HEIGHT, expected, 1);
    CHECK(difference <= 1, "%s: the window and the image differ by %d steps", what, difference);
}

static void sizes(BhrContext *context, BhrSurface *surface, SDL_Window *window) {
    static const int sides[][2] = {{200, 100}, {1, 1},   {640, 360}, {100, 400}, {33, 17},
                                   {2, 300},   {500, 2}, {401, 251}, {64, 64},   {WIDTH, HEIGHT}};
    for (size_t i = 0; i < COUNT_OF(sides); i++) {
        BhrFrameStats stats = {.struct_size = sizeof stats};
        SDL_SetWindowSize(window, sides[i][0], sides[i][1]);
        SDL_PumpEvents();
        CHECK_OK(bhr_surface_resize(surface, (uint32_t)sides[i][0], (uint32_t)sides[i][1]));
        present(context, surface, 8); /* more than are counted late */
        CHECK_OK(bhr_frame_stats(context, &stats));
        CHECK(stats.rays == (uint64_t)sides[i][0] * (uint64_t)sides[i][1], "%d x %d: %u rays", sides[i][0], sides[i][1],
              (unsigned)stats.rays);
    }
    CHECK_OK(bhr_surface_resize(surface, 0, 0));
    CHECK(bhr_render_surface(context, surface) == BHR_FRAME_SKIPPED, "a frame in a window of 0 x 0");
    CHECK_OK(bhr_surface_resize(surface, WIDTH, HEIGHT));
    check_shows(context, surface, "ten sizes");
    check_connected("resizing");
}

static void modes(BhrContext *context, BhrSurface *surface) {
    static const BhrPresentMode all[] = {BHR_PRESENT_MAILBOX, BHR_PRESENT_IMMEDIATE, BHR_PRESENT_VSYNC};
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        CHECK_OK(bhr_surface_set_present_mode(surface, all[i]));
        CHECK_OK(bhr_set_mass(context, 1.0 + 0.2 * (double)i)); /* another picture each time */
        check_shows(context, surface, "a present mode");
    }
    check_connected("all present modes");
}

typedef struct Task {
    BhrContext *context;
    BhrSurface *surface;
} Task;

static void *present_on_thread(void *argument) {
    const Task *task = argument;
    for (int i = 0; i < ROUNDS; i++) {
        CHECK_OK(bhr_render_surface(task->context, task->surface));
    }
    return NULL;
}

/* Two threads on one surface, while this one handles the window's events. */
static void threads(BhrContext *context, BhrSurface *surface) {
    Task      task = {context, surface};
    pthread_t both[2];
    for (int i = 0; i < 2; i++) {
        if (!CHECK(pthread_create(&both[i], NULL, present_on_thread, &task) == 0, "cannot start a thread")) {
            exit(check_end());
        }
    }
    for (int i = 0; i < 20; i++) {
        SDL_PumpEvents();
        SDL_Delay(2);
    }
    for (int i = 0; i < 2; i++) {
        pthread_join(both[i], NULL);
    }
    check_connected("two threads");
}

/* The shortest of three measurements, as other programs run too: frames a second. */
static double rate(BhrContext *context, BhrSurface *surface, BhrPresentMode mode) {
    double shortest = 1e9;
    CHECK_OK(bhr_surface_set_present_mode(surface, mode));
    present(context, surface, 3);
    for (int i = 0; i < 3; i++) {
        const double begun = seconds_now();
        present(context, surface, PACED);
        const double time = seconds_now() - begun;
        shortest = time < shortest ? time : shortest;
    }
    return PACED / shortest;
}

/* Small frames of VSYNC, which could be more than the display has, are not. */
static void pace(BhrContext *context, BhrSurface *surface) {
    BhrQuality before = {.struct_size = sizeof before};
    CHECK_OK(bhr_get_quality(context, &before));
    BhrQuality quality = before;
    quality.render_scale = 0.1;
    CHECK_OK(bhr_set_quality(context, &quality));
    const double unpaced = rate(context, surface, BHR_PRESENT_MAILBOX);
    const double paced = rate(context, surface, BHR_PRESENT_VSYNC);
    CHECK(paced < HIGHEST_RATE, "VSYNC has %.0f frames a second", paced);
    CHECK(unpaced > paced, "MAILBOX has %.0f frames a second, VSYNC %.0f: nothing was held back", unpaced, paced);
    CHECK_OK(bhr_set_quality(context, &before));
}

/* Calls that must return while a frame waits for the compositor. */
typedef struct Setters {
    const Task *task;
    pthread_mutex_t lock;
    int             ended;
    double          longest; /* seconds of a call */
    int             calls;
} Setters;

static int is_over(Setters *setters) {
    pthread_mutex_lock(&setters->lock);
    const int ended = setters->ended;
    pthread_mutex_unlock(&setters->lock);
    return ended;
}

static void *set_on_thread(void *argument) {
    Setters *setters = argument;
    while (!is_over(setters)) {
        const double begun = seconds_now();
        CHECK_OK(bhr_set_mass(setters->task->context, 1.0));
        const double between = seconds_now();
        CHECK_OK(bhr_surface_set_present_mode(setters->task->surface, BHR_PRESENT_VSYNC));
        const double first = between - begun, second = seconds_now() - between;
        setters->longest = first > setters->longest ? first : setters->longest;
        setters->longest = second > setters->longest ? second : setters->longest;
        setters->calls++;
        pause_ms(20);
    }
    return NULL;
}

/* Frames while the compositor may be silent: none takes longer than it may. How many were skipped. */
static int skipped_of(BhrContext *context, BhrSurface *surface, int frames, const char *what) {
    int    skipped = 0;
    double longest = 0;
    for (int i = 0; i < frames; i++) {
        const double    begun = seconds_now();
        const BhrStatus status = bhr_render_surface(context, surface);
        const double    time = seconds_now() - begun;
        CHECK(status == BHR_OK || status == BHR_FRAME_SKIPPED, "%s: status %d: %s", what, (int)status,
              bhr_error_message());
        longest = time > longest ? time : longest;
        skipped += status == BHR_FRAME_SKIPPED;
        SDL_PumpEvents();
    }
    CHECK(longest < LONGEST, "%s: a frame took %.1f s", what, longest);
    return skipped;
}

/* A compositor says nothing to a window that it does not show; one that is stopped says nothing at all. */
static void silence(BhrContext *context, BhrSurface *surface, pid_t compositor) {
    const Task task = {context, surface};
    Setters    setters = {.task = &task};
    pthread_t  thread;
    pthread_mutex_init(&setters.lock, NULL);
    if (!CHECK(kill(compositor, SIGSTOP) == 0, "cannot stop the compositor") ||
        !CHECK(pthread_create(&thread, NULL, set_on_thread, &setters) == 0, "cannot start a thread")) {
        exit(check_end());
    }
    const int skipped = skipped_of(context, surface, 4, "a silent compositor");
    CHECK(skipped >= 3, "%d of 4 frames were skipped", skipped); /* the first one's word may have come before */
    kill(compositor, SIGCONT);
    pthread_mutex_lock(&setters.lock);
    setters.ended = 1;
    pthread_mutex_unlock(&setters.lock);
    pthread_join(thread, NULL);
    pthread_mutex_destroy(&setters.lock);
    CHECK(setters.calls > 0 && setters.longest < 2 * LONGEST, "of %d rounds of setters one call took %.1f s",
          setters.calls, setters.longest);
    CHECK(skipped_of(context, surface, 20, "a compositor that goes on") == 0, "frames are still skipped");
    check_shows(context, surface, "after silence");
}

/* The host's own hiding takes away what the window shows; it tells when there is something to show again. */
static void hide(BhrContext *context, BhrSurface *surface, SDL_Window *window) {
    SDL_HideWindow(window);
    SDL_PumpEvents();
    skipped_of(context, surface, 3, "hidden");
    SDL_ShowWindow(window);
    SDL_PumpEvents();
    CHECK_OK(bhr_surface_resize(surface, WIDTH, HEIGHT));
    check_shows(context, surface, "shown again");
    check_connected("hiding");
}

/* Against the header: the wl_surface goes first. Last, as the compositor may end the connection over it. */
static void window_first(BhrBackend backend) {
    SDL_Window *window = open_window();
    BhrContext *context = open_context(backend, NULL);
    BhrSurface *surface = open_surface(context, window);
    present(context, surface, 5);
    SDL_DestroyWindow(window);
    for (int i = 0; i < 3; i++) {
        const double    begun = seconds_now();
        const BhrStatus status = bhr_render_surface(context, surface);
        CHECK(status == BHR_OK || status == BHR_FRAME_SKIPPED || status == BHR_ERROR_SURFACE_LOST,
              "a window that is gone: status %d: %s", (int)status, bhr_error_message());
        CHECK(seconds_now() - begun < LONGEST, "a frame of a window that is gone took %.1f s", seconds_now() - begun);
    }
    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
}

static void bad_calls(BhrContext *context, SDL_Window *taken) {
    BhrWindow   window = handle_of(taken);
    BhrSurface *surface = NULL;
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "surface",
                bhr_surface_create(context, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    window.display = NULL;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "display",
                bhr_surface_create(context, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    window = handle_of(taken);
    window.handle = NULL;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "handle",
                bhr_surface_create(context, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    window = handle_of(taken);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "1048576",
                bhr_surface_create(context, &window, UINT32_MAX, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    CHECK(surface == NULL, "a refused surface is not NULL");
}

/* Windows of one context, one after another and two at once; the context may end before its surfaces. */
static void more_windows(BhrBackend backend) {
    for (int context_first = 0; context_first <= 1; context_first++) {
        SDL_Window *windows[2] = {open_window(), open_window()};
        BhrWindow   handle = handle_of(windows[0]);
        BhrContext *context = open_context(backend, &handle);
        BhrSurface *surfaces[2] = {open_surface(context, windows[0]), open_surface(context, windows[1])};
        present(context, surfaces[0], 2);
        present(context, surfaces[1], 2);
        bhr_surface_destroy(surfaces[0]);
        surfaces[0] = open_surface(context, windows[0]);
        present(context, surfaces[0], 2);
        if (context_first) {
            bhr_context_destroy(context);
            CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "context", bhr_surface_resize(surfaces[0], 10, 10));
        }
        bhr_surface_destroy(surfaces[0]);
        bhr_surface_destroy(surfaces[1]);
        if (!context_first) {
            bhr_context_destroy(context);
        }
        SDL_DestroyWindow(windows[0]);
        SDL_DestroyWindow(windows[1]);
    }
    check_connected("more windows");
}

/* Opens a context while the environment has no folder for the display's socket, as a host does that sets it later. */
static BhrContext *open_early(BhrBackend backend) {
    const char *folder = getenv("XDG_RUNTIME_DIR");
    char        kept[512];
    if (!CHECK(folder != NULL && strlen(folder) < sizeof kept, "no XDG_RUNTIME_DIR")) {
        exit(check_end());
    }
    strcpy(kept, folder);
    unsetenv("XDG_RUNTIME_DIR");
    BhrContext *context = open_context(backend, NULL);
    setenv("XDG_RUNTIME_DIR", kept, 1);
    return context;
}

/* Its device makes no surfaces of Wayland: frames come from there to one that does, where there is a driver. */
static void early(BhrContext *context, SDL_Window *window, const char *way) {
    said[0] = '\0';
    BhrSurface *surface = open_surface(context, window);
    check_shows(context, surface, "a context from before the display");
    const char *expected = strcmp(way, "memory") == 0 ? "as memory" : "are presented by";
    CHECK(strstr(said, expected) != NULL, "not '%s'; the log: %s", expected, said);
    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
    said[0] = '\0';
}

/* The frames went the way that this run is meant to test. */
static void check_way(const char *way) {
    const int presented = strstr(said, "are presented by") != NULL, memory = strstr(said, "as memory") != NULL;
    CHECK(presented == (strcmp(way, "uploaded") == 0) && memory == (strcmp(way, "memory") == 0), "not %s; the log: %s",
          way, said);
    CHECK(warnings == 0, "%d warnings; the log: %s", warnings, said);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    const char      *way = argc > 2 ? argv[2] : "direct";
    const pid_t      compositor = (pid_t)strtol(getenv("COMPOSITOR") != NULL ? getenv("COMPOSITOR") : "0", NULL, 10);
    if (!CHECK(compositor > 1, "COMPOSITOR is no process")) {
        return check_end();
    }
    BhrContext *before = open_early(backend);
    SDL_SetMainReady();
    if (!CHECK(SDL_Init(SDL_INIT_VIDEO) == 0, "SDL does not start: %s", SDL_GetError())) {
        return check_end();
    }
    SDL_Window *window = open_window();
    early(before, window, way);
    BhrContext *context = open_context(backend, NULL);
    BhrSurface *surface = open_surface(context, window);
    present(context, surface, 20);
    check_shows(context, surface, "20 frames");
    check_connected("20 frames");
    sizes(context, surface, window);
    modes(context, surface);
    threads(context, surface);
    if (strcmp(way, "memory") != 0) { /* that has one mode only */
        pace(context, surface);
    }
    silence(context, surface, compositor);
    hide(context, surface, window);
    bad_calls(context, window);
    check_shows(context, surface, "bad calls");
    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
    SDL_DestroyWindow(window);
    more_windows(backend);
    check_way(way);
    if (strcmp(way, "memory") != 0) {
        window_first(backend);
    }
    SDL_Quit();
    return check_end();
}
