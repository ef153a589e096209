/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gl_host.c -- hosts that draw with OpenGL themselves, by GLX and by EGL: a context that is current on the thread that
 * calls bhr stays so through everything that a context of bhr's does, and draws as before. The second argument is the
 * host's way to GL: glx, egl (both GLFW's), sdl (EGL on Wayland), surfaceless (EGL's display without windows, which bhr
 * uses too) or none. With auto as the first no software GL may trace. */
#define _POSIX_C_SOURCE 200809L

#include "host.h"

#include <dirent.h>
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE /* what is needed of OpenGL is loaded by name */
#include <GLFW/glfw3.h>
#define SDL_MAIN_HANDLED
#include <SDL2/SDL.h>

#define WIDTH 48u
#define HEIGHT 32u
#define BYTES (WIDTH * HEIGHT * 4u)
#define THREADS 2

enum Way { NONE, GLX, EGL, SDL, SURFACELESS };

static enum Way   way;
static BhrBackend asked;

/* ---- OpenGL, GLX and EGL, by name ---- */

typedef void *(*GetPointer)(void);
typedef void *(*GetPointerOf)(int);
typedef unsigned (*GetNumber)(void);
typedef unsigned (*Initialise)(void *display, int *major, int *minor);
typedef void *(*GetPlatformDisplay)(unsigned platform, void *native, const intptr_t *attributes);
typedef unsigned (*ChooseConfig)(void *display, const int *wanted, void **configs, int size, int *count);
typedef void *(*CreateContext)(void *display, void *config, void *shared, const int *attributes);
typedef void *(*CreateSurface)(void *display, void *config, const int *attributes);
typedef unsigned (*MakeCurrent)(void *display, void *draw, void *read, void *context);
typedef unsigned (*OfDisplay)(void *display);
typedef void (*ClearColour)(float r, float g, float b, float a);
typedef void (*Clear)(unsigned mask);
typedef void (*ReadPixels)(int x, int y, int width, int height, unsigned format, unsigned type, void *pixels);

/* NULL where the library or the name is missing. ISO C has no cast from an object's pointer to a function's. */
static void load(void *function, const char *library, const char *name) {
    void *handle = dlopen(library, RTLD_NOW);
    void *found = handle != NULL ? dlsym(handle, name) : NULL;
    memcpy(function, &found, sizeof found);
}

#define EGL(function, name) load(&(function), "libEGL.so.1", (name))
#define GL(function, name) load(&(function), "libGL.so.1", (name)) /* libglvnd's, which serves every current context */

/* The state that GLX and EGL call current on this thread. */
typedef struct Current {
    void *glx_context, *glx_drawable, *glx_display;
    void *egl_context, *egl_display, *egl_draw, *egl_read;
    unsigned egl_api;
} Current;

static void *ask(const char *library, const char *name) {
    GetPointer get;
    load(&get, library, name);
    return get != NULL ? get() : NULL;
}

static void *ask_egl(const char *name, int which) {
    GetPointerOf get;
    EGL(get, name);
    return get != NULL ? get(which) : NULL;
}

static Current current(void) {
    Current now;
    GetNumber query;
    memset(&now, 0, sizeof now);
    now.glx_context = ask("libGL.so.1", "glXGetCurrentContext");
    now.glx_drawable = ask("libGL.so.1", "glXGetCurrentDrawable");
    now.glx_display = ask("libGL.so.1", "glXGetCurrentDisplay");
    now.egl_context = ask("libEGL.so.1", "eglGetCurrentContext");
    now.egl_display = ask("libEGL.so.1", "eglGetCurrentDisplay");
    now.egl_draw = ask_egl("eglGetCurrentSurface", 0x3059 /* EGL_DRAW */);
    now.egl_read = ask_egl("eglGetCurrentSurface", 0x305A /* EGL_READ */);
    EGL(query, "eglQueryAPI");
    now.egl_api = query != NULL ? query() : 0;
    return now;
}

/* ---- the host's own context ---- */

typedef struct HostGl {
    GLFWwindow   *window;
    SDL_Window   *sdl;
    SDL_GLContext sdl_context;
    void         *display, *context, *surface; /* of SURFACELESS */
    Current       current;
} HostGl;

static void give_up(const char *why) {
    CHECK(0, "%s", why);
    exit(check_end());
}

static void open_window(HostGl *host) {
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, way == EGL ? GLFW_EGL_CONTEXT_API : GLFW_NATIVE_CONTEXT_API);
    host->window = glfwCreateWindow((int)WIDTH, (int)HEIGHT, "host", NULL, NULL);
    if (host->window == NULL) {
        const char *why = "no window with a GL context";
        glfwGetError(&why);
        give_up(why);
    }
}

static void open_sdl(HostGl *host) {
    host->sdl = SDL_CreateWindow("host", 0, 0, (int)WIDTH, (int)HEIGHT, SDL_WINDOW_OPENGL);
    host->sdl_context = host->sdl != NULL ? SDL_GL_CreateContext(host->sdl) : NULL;
    if (host->sdl_context == NULL || SDL_GL_MakeCurrent(NULL, NULL) != 0) {
        give_up(SDL_GetError());
    }
}

static void open_surfaceless(HostGl *host) {
    /* EGL_SURFACE_TYPE: EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE: EGL_OPENGL_ES2_BIT, EGL_ALPHA_SIZE: 8, EGL_NONE */
    static const int   wanted[] = {0x3033, 1, 0x3040, 4, 0x3021, 8, 0x3038};
    static const int   version[] = {0x3098 /* EGL_CONTEXT_CLIENT_VERSION */, 2, 0x3038};
    static const intptr_t none[] = {0x3038}; /* as wgpu: else it is another display */
    static const int   size[] = {0x3057 /* EGL_WIDTH */, (int)WIDTH, 0x3056 /* EGL_HEIGHT */, (int)HEIGHT, 0x3038};
    void              *config = NULL;
    int                count = 0;
    GetPlatformDisplay get_display;
    Initialise         initialise;
    ChooseConfig       choose;
    CreateContext      create;
    CreateSurface      create_surface;
    EGL(get_display, "eglGetPlatformDisplay");
    EGL(initialise, "eglInitialize");
    EGL(choose, "eglChooseConfig");
    EGL(create, "eglCreateContext");
    EGL(create_surface, "eglCreatePbufferSurface");
    if (get_display == NULL) {
        give_up("no libEGL");
    }
    host->display = get_display(0x31DD /* EGL_PLATFORM_SURFACELESS_MESA */, NULL, none);
    if (host->display == NULL || !initialise(host->display, NULL, NULL) ||
        !choose(host->display, wanted, &config, 1, &count) || count == 0 ||
        (host->context = create(host->display, config, NULL, version)) == NULL ||
        (host->surface = create_surface(host->display, config, size)) == NULL) {
        give_up("no EGL context without a window");
    }
}

static void make_current(HostGl *host, int is) {
    MakeCurrent make;
    if (way == GLX || way == EGL) {
        glfwMakeContextCurrent(is ? host->window : NULL);
    } else if (way == SDL) {
        CHECK(SDL_GL_MakeCurrent(is ? host->sdl : NULL, is ? host->sdl_context : NULL) == 0, "%s", SDL_GetError());
    } else if (way == SURFACELESS) {
        EGL(make, "eglMakeCurrent");
        void *surface = is ? host->surface : NULL;
        CHECK(make(host->display, surface, surface, is ? host->context : NULL), "the host's context stays out");
    }
    host->current = current();
    CHECK(!is || way == NONE || host->current.glx_context != NULL || host->current.egl_context != NULL,
          "the host's context is not current");
}

static HostGl open_gl(void) {
    HostGl host;
    memset(&host, 0, sizeof host);
    if (way == GLX || way == EGL) {
        open_window(&host);
    } else if (way == SDL) {
        open_sdl(&host);
    } else if (way == SURFACELESS) {
        open_surfaceless(&host);
    }
    host.current = current();
    return host;
}

/* The colour is another one each time, so that it cannot be an old one. */
static void check_draws(const char *after) {
    static unsigned char shade;
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    unsigned char        seen[4] = {0, 0, 0, 0}, wanted;
    ClearColour          colour;
    Clear                clear;
    ReadPixels           read;
    GetNumber            error;
    pthread_mutex_lock(&lock);
    wanted = shade = (unsigned char)(shade + 51);
    pthread_mutex_unlock(&lock);
    GL(colour, "glClearColor");
    GL(clear, "glClear");
    GL(read, "glReadPixels");
    GL(error, "glGetError");
    if (!CHECK(colour != NULL && clear != NULL && read != NULL && error != NULL, "no OpenGL library")) {
        return;
    }
    colour((float)wanted / 255.0f, 0.0f, 1.0f, 1.0f);
    clear(0x4000 /* GL_COLOR_BUFFER_BIT */);
    read((int)WIDTH / 2, (int)HEIGHT / 2, 1, 1, 0x1908 /* GL_RGBA */, 0x1401 /* GL_UNSIGNED_BYTE */, seen);
    CHECK(error() == 0, "an error of the host's GL after %s", after);
    CHECK(abs((int)seen[0] - (int)wanted) <= 1 && seen[1] == 0 && seen[2] == 255,
          "the host drew %u %u %u instead of %u 0 255 after %s", seen[0], seen[1], seen[2], wanted, after);
}

static void check_unchanged_gl(const HostGl *host, const char *after) {
    const Current now = current();
    CHECK(memcmp(&now, &host->current, sizeof now) == 0,
          "another context is current after %s: GLX %p (was %p), EGL %p (was %p)", after, now.glx_context,
          host->current.glx_context, now.egl_context, host->current.egl_context);
    if (host->current.glx_context != NULL || host->current.egl_context != NULL) {
        check_draws(after);
    }
}

/* ---- bhr ---- */

typedef struct Watcher {
    const HostGl *host;
    BhrContext   *context;
    pthread_t     thread;
    int           calls, cancels;
} Watcher;

/* On the calling thread, whose context is current as ever; calls on the context are refused, and none of them hangs. */
static int32_t on_progress(void *user, double fraction) {
    Watcher *watcher = user;
    double   m, a, axis[3];
    (void)fraction;
    watcher->calls++;
    CHECK(pthread_equal(watcher->thread, pthread_self()), "progress on another thread");
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_get_hole(watcher->context, &m, &a, axis));
    check_unchanged_gl(watcher->host, "a part of a frame");
    return !watcher->cancels;
}

/* Calls back in too: the thread may be one of the library's. */
static void on_log(void *user, BhrLogLevel level, const char *message) {
    uint32_t count;
    (void)user;
    (void)level;
    (void)message;
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_adapter_count(&count));
}

static BhrContext *create(const HostGl *host) {
    BhrContextOptions options = check_options(asked);
    BhrAdapterInfo    info = {.struct_size = sizeof info};
    options.log_level = BHR_LOG_INFO;
    options.log_fn = on_log;
    BhrContext *context = check_context_with(&options);
    check_unchanged_gl(host, "bhr_context_create");
    CHECK_OK(bhr_context_adapter(context, &info));
    CHECK(asked == BHR_BACKEND_AUTO || info.backend == asked, "backend %d: %s", (int)info.backend, info.name);
    CHECK(asked != BHR_BACKEND_AUTO || info.backend != BHR_BACKEND_GL || !(info.flags & BHR_ADAPTER_SOFTWARE),
          "AUTO took %s", info.name);
    check_set_sky(context);
    return context;
}

static void render(BhrContext *context, const HostGl *host, unsigned char *pixels) {
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
    memset(pixels, 0, BYTES);
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(pixels[3] == 255 && pixels[BYTES - 1] == 255, "a frame has holes");
    check_unchanged_gl(host, "bhr_render_image");
}

static void ask_ray(BhrContext *context, const HostGl *host) {
    const BhrRay ray = {{30.0, 0.0, 4.0}, {-1.0, 0.4, 0.1}, 1.0};
    BhrHit       hit;
    CHECK_OK(bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit));
    CHECK(hit.fate == BHR_FATE_ESCAPED, "fate %d", (int)hit.fate);
    check_unchanged_gl(host, "bhr_trace_rays");
}

static void watch_progress(BhrContext *context, const HostGl *host) {
    unsigned char  pixels[BYTES];
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    Watcher        watcher = {host, context, pthread_self(), 0, 0};
    CHECK_OK(bhr_set_progress(context, on_progress, &watcher));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(watcher.calls >= 2, "%d reports", watcher.calls);
    watcher.cancels = 1;
    CHECK_FAILS(BHR_ERROR_CANCELLED, "", bhr_render_image(context, &image));
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
    check_unchanged_gl(host, "frames with a progress callback");
}

/* One that is waited for, one that is cancelled, one that is left behind unfinished. */
static void make_jobs(BhrContext *context, const HostGl *host, const unsigned char *frame) {
    static unsigned char pixels[THREADS][3][BYTES];
    static int           next;
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    BhrJob              *jobs[3];
    pthread_mutex_lock(&lock);
    unsigned char(*mine)[BYTES] = pixels[next++ % THREADS];
    pthread_mutex_unlock(&lock);
    for (int i = 0; i < 3; i++) {
        const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, mine[i], BYTES);
        CHECK_OK(bhr_render_image_async(context, &image, &jobs[i]));
    }
    check_unchanged_gl(host, "bhr_render_image_async");
    bhr_job_cancel(jobs[1]);
    CHECK_OK(bhr_job_wait(jobs[0], UINT64_MAX, NULL));
    CHECK(memcmp(mine[0], frame, BYTES) == 0, "a job's frame differs");
    check_unchanged_gl(host, "bhr_job_wait");
    for (int i = 0; i < 3; i++) {
        bhr_job_destroy(jobs[i]);
    }
    check_unchanged_gl(host, "bhr_job_destroy");
}

static void list_adapters(const HostGl *host) {
    uint32_t count = 0;
    CHECK_OK(bhr_adapter_count(&count));
    check_unchanged_gl(host, "bhr_adapter_count");
    for (uint32_t i = 0; i < count; i++) {
        BhrAdapterInfo info = {.struct_size = sizeof info};
        CHECK_OK(bhr_adapter_info(i, &info));
    }
    check_unchanged_gl(host, "bhr_adapter_info");
}

static void destroy(BhrContext *context, const HostGl *host) {
    bhr_context_destroy(context);
    check_unchanged_gl(host, "bhr_context_destroy");
}

/* ---- lives ---- */

/* Everything, with the host's context current throughout. */
static void whole_life(const HostGl *host) {
    unsigned char     first[BYTES], second[BYTES];
    BhrContextOptions options;
    BhrContext       *context, *none = NULL;
    list_adapters(host);
    context = create(host);
    render(context, host, first);
    ask_ray(context, host);
    watch_progress(context, host);
    make_jobs(context, host, first);
    CHECK_OK(bhr_context_recover(context));
    check_unchanged_gl(host, "bhr_context_recover");
    render(context, host, second);
    CHECK(memcmp(first, second, BYTES) == 0, "a frame after the recovery differs");
    make_jobs(context, host, first);
    destroy(context, host);
    CHECK_OK(bhr_context_options_init(&options, sizeof options));
    options.backend = BHR_BACKEND_GL;
    options.adapter_index = 1 << 20;
    CHECK_FAILS(BHR_ERROR_NO_ADAPTER, "adapter", bhr_context_create(BHR_ABI_VERSION, &options, &none));
    check_unchanged_gl(host, "a context that was refused");
}

/* The host's context becomes current, or is current no longer, in the middle. */
static void half_lives(HostGl *host) {
    unsigned char pixels[BYTES];
    for (int first = 0; first < 2; first++) {
        BhrContext *context;
        make_current(host, first);
        context = create(host);
        render(context, host, pixels);
        make_current(host, !first);
        render(context, host, pixels);
        destroy(context, host);
    }
    make_current(host, 0);
}

static void *life_on_a_thread(void *argument) {
    HostGl *host = argument;
    make_current(host, 1);
    whole_life(host);
    make_current(host, 0);
    return NULL;
}

/* The display without windows is one for the whole process: a host that terminates it takes bhr's context along. That
 * is a lost device; its recovery works, and nothing that ends afterwards ends the process. */
static void terminated_display(void) {
    unsigned char  pixels[BYTES];
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    OfDisplay      terminate;
    EGL(terminate, "eglTerminate");
    for (int recovers = 0; recovers < 2; recovers++) {
        HostGl      host = open_gl();
        BhrContext *context = create(&host);
        render(context, &host, pixels);
        CHECK(terminate(host.display), "the display does not end");
        CHECK_FAILS(BHR_ERROR_DEVICE_LOST, "", bhr_render_image(context, &image));
        if (recovers) {
            CHECK_OK(bhr_context_recover(context));
            render(context, &host, pixels);
        }
        bhr_context_destroy(context);
    }
}

/* ---- the library's threads ---- */

/* Drivers start some that inherit the name, and keep them. */
static int threads_of_gl(void) {
    DIR *tasks = opendir("/proc/self/task");
    int  count = 0;
    for (struct dirent *task; tasks != NULL && (task = readdir(tasks)) != NULL;) {
        char  path[300], name[32] = "";
        FILE *file;
        snprintf(path, sizeof path, "/proc/self/task/%s/comm", task->d_name);
        file = fopen(path, "r");
        if (file != NULL) {
            count += fgets(name, sizeof name, file) != NULL && strncmp(name, "bhr-gl", 6) == 0;
            fclose(file);
        }
    }
    if (tasks != NULL) {
        closedir(tasks);
    }
    return count;
}

int main(int argc, char **argv) {
    static const char *const WAYS[] = {"none", "glx", "egl", "sdl", "surfaceless"};
    HostGl                   hosts[THREADS];
    int                      threads;
    asked = check_begin(argc, argv);
    if (argc < 3) {
        fprintf(stderr, "usage: %s gl|auto none|glx|egl|sdl|surfaceless\n", argv[0]);
        return 2;
    }
    while ((size_t)way < COUNT_OF(WAYS) && strcmp(argv[2], WAYS[way]) != 0) {
        way++;
    }
    if ((size_t)way == COUNT_OF(WAYS) || ((way == GLX || way == EGL) && !glfwInit()) ||
        (way == SDL && SDL_Init(SDL_INIT_VIDEO) != 0)) {
        give_up("no such way to GL, or no display");
    }
    for (int i = 0; i < THREADS; i++) {
        hosts[i] = open_gl();
    }
    make_current(&hosts[0], 1);
    whole_life(&hosts[0]);
    make_current(&hosts[0], 0);
    threads = threads_of_gl();
    half_lives(&hosts[0]);
    run_threads(life_on_a_thread, hosts, sizeof hosts[0], THREADS);
    CHECK(threads_of_gl() <= threads, "%d threads for GL, %d before", threads_of_gl(), threads);
    if (way == SURFACELESS && asked == BHR_BACKEND_GL) {
        terminated_display();
    }
    return check_end();
}
