/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_window.c -- whatever a host passes for a window, and in whatever state it calls, it gets a status and a message
 * that names the value and the limit; nothing breaks, and the next good call works.
 *
 *     bad_window BACKEND xlib|xcb      environment: DISPLAY, and OTHER_DISPLAY, another X server */
#define _POSIX_C_SOURCE 200809L

#include "host.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define WIDTH 64u
#define HEIGHT 48u
#define SMALL 8u /* pixels of the windows that only matter by their number */

typedef struct Scene {
    BhrBackend    backend;
    BhrWindowKind kind;
    BhrContext   *context;
    Watch         watch;
} Scene;

/* A frame gets into a window of the kind that is tested. */
static void check_works(const Scene *scene, const char *after) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    Host                 host = host_open(scene->kind, NULL, WIDTH, HEIGHT);
    BhrSurface          *surface = check_surface(scene->context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    CHECK_OK(bhr_render_image(scene->context, &image));
    CHECK_OK(bhr_render_surface(scene->context, surface));
    CHECK(host_difference(&host, WIDTH, HEIGHT, pixels, 1) <= 1, "no frame gets into a window after %s", after);
    bhr_surface_destroy(surface);
    host_close(&host);
}

static void refuse(const Scene *scene, const BhrWindow *window, BhrStatus status, const char *words) {
    BhrSurface *surface = (BhrSurface *)&surface;
    CHECK_REFUSED(&scene->watch, status, words,
                  bhr_surface_create(scene->context, window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    CHECK(surface == NULL, "a refused surface is not NULL");
    bhr_surface_destroy(surface); /* lest one wrong answer spoil the following */
    /* A context that is asked for such a window is refused for the same reason. */
    BhrContextOptions options;
    BhrContext       *context = (BhrContext *)&context;
    CHECK_OK(bhr_context_options_init(&options, sizeof options));
    options.backend = scene->backend;
    options.compatible_window = window;
    CHECK_FAILS(status, words, bhr_context_create(BHR_ABI_VERSION, &options, &context));
    CHECK(context == NULL, "a refused context is not NULL");
    bhr_context_destroy(context);
}

/* ---- structs ---- */

static void kinds(const Scene *scene, const BhrWindow *good) {
    static const BhrWindowKind unknown[] = {0, 9, -1, 1000};
    static const struct {
        BhrWindowKind kind;
        const char   *name;
    } elsewhere[] = {{BHR_WINDOW_WIN32, "BHR_WINDOW_WIN32"},
                     {BHR_WINDOW_APPKIT, "BHR_WINDOW_APPKIT"},
                     {BHR_WINDOW_UIKIT, "BHR_WINDOW_UIKIT"},
                     {BHR_WINDOW_METAL_LAYER, "BHR_WINDOW_METAL_LAYER"},
                     {BHR_WINDOW_ANDROID, "BHR_WINDOW_ANDROID"}};
    BhrWindow window = *good;
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        window.kind = unknown[i];
        refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "kind");
    }
    window.handle = window.aux = &window;
    for (size_t i = 0; i < COUNT_OF(elsewhere); i++) {
        window.kind = elsewhere[i].kind;
        refuse(scene, &window, BHR_ERROR_UNSUPPORTED, elsewhere[i].name);
        window.handle = NULL;
        refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "handle");
        window.handle = &window;
    }
}

static void fields(const Scene *scene, const BhrWindow *good) {
    BhrWindow window = *good;
    window.display = NULL;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "display");
    window = *good;
    window.id = 0;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "id");
    window.id = UINT64_C(0x100000000) + good->id;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "0x100");
    window = *good;
    window.reserved = 1;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "reserved");
    window = *good;
    window.struct_size = FIRST_WINDOW - 1;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "struct_size");
    window.struct_size = 0;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "struct_size");
    window = *good;
    window.kind = BHR_WINDOW_WAYLAND;
    window.handle = NULL;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "handle");
    window.handle = &window;
    window.display = NULL;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "display");

    BhrSurface *surface = (BhrSurface *)&surface;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "window",
                bhr_surface_create(scene->context, NULL, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    CHECK(surface == NULL, "a surface without a window");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_surface",
                bhr_surface_create(scene->context, good, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, NULL));
    surface = (BhrSurface *)&surface;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context",
                bhr_surface_create(NULL, good, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    CHECK(surface == NULL, "a surface without a context");
}

/* A struct of a later version, all zero beyond what this library knows, is taken; else it is not. */
static void later_struct(const Scene *scene, const BhrWindow *good) {
    struct {
        BhrWindow window;
        uint64_t  later;
    } longer = {*good, 0};
    BhrSurface *surface = NULL;
    longer.window.struct_size = sizeof longer;
    CHECK_OK(bhr_surface_create(scene->context, &longer.window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
    bhr_surface_destroy(surface);
    longer.later = 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "",
                bhr_surface_create(scene->context, &longer.window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &surface));
}

/* ---- windows that are not there ---- */

static void absent(const Scene *scene) {
    Host      host = host_open(scene->kind, NULL, SMALL, SMALL);
    BhrWindow window = host_window(&host);
    host_destroy_window(&host);
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "window");
    window.id = 0x7ffffff;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "0x7ffffff");
    /* The window of another server, whose number means nothing on this one. */
    Host other = host_open(scene->kind, getenv("OTHER_DISPLAY"), SMALL, SMALL);
    while (host_exists(other.id)) { /* both servers begin with the same numbers */
        host_new_window(&other, SMALL, SMALL);
    }
    window.id = other.id;
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "window");
    /* A window with its own display is a good one, although that display is not DISPLAY. */
    BhrSurface *surface = check_surface(scene->context, &other, SMALL, SMALL, BHR_PRESENT_VSYNC);
    CHECK_OK(bhr_render_surface(scene->context, surface));
    bhr_surface_destroy(surface);
    host_close(&other);
    host_close(&host);
}

/* A window that takes input only, and shows nothing. */
static void input_only(const Scene *scene, const Host *host) {
    Display        *display = XOpenDisplay(NULL);
    const BhrWindow good = host_window(host);
    BhrWindow       window = good;
    if (!CHECK(display != NULL, "no X server")) {
        return;
    }
    window.id = XCreateWindow(display, DefaultRootWindow(display), 0, 0, WIDTH, HEIGHT, 0, 0, InputOnly, CopyFromParent,
                              0,
                              NULL);
    XSync(display, False);
    refuse(scene, &window, BHR_ERROR_INVALID_ARGUMENT, "window");
    XCloseDisplay(display);
}

/* ---- sizes and modes ---- */

static void sizes(const Scene *scene, const Host *host) {
    static const uint32_t sides[] = {(1u << 20) + 1u, 0x80000000u, UINT32_MAX};
    static const uint32_t large[] = {100000u, 1u << 20};
    const BhrWindow       window = host_window(host);
    BhrSurface           *surface = NULL, *refused = NULL;
    for (size_t i = 0; i < COUNT_OF(sides); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "1048576",
                    bhr_surface_create(scene->context, &window, sides[i], 10, BHR_PRESENT_VSYNC, &refused));
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "1048576",
                    bhr_surface_create(scene->context, &window, 10, sides[i], BHR_PRESENT_VSYNC, &refused));
    }
    for (size_t i = 0; i < COUNT_OF(large); i++) {
        CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "100000|1048576",
                    bhr_surface_create(scene->context, &window, large[i], 10, BHR_PRESENT_VSYNC, &refused));
    }
    CHECK(refused == NULL, "a refused surface is not NULL");
    surface = check_surface(scene->context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "surface", bhr_surface_resize(NULL, 10, 10));
    for (size_t i = 0; i < COUNT_OF(sides); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "1048576", bhr_surface_resize(surface, sides[i], 10));
    }
    for (size_t i = 0; i < COUNT_OF(large); i++) {
        CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "100000|1048576", bhr_surface_resize(surface, 10, large[i]));
    }
    CHECK_OK(bhr_render_surface(scene->context, surface)); /* with the size it had */
    /* A size that is none of the window's: X11 knows better. */
    CHECK_OK(bhr_surface_resize(surface, 3000, 2000));
    const BhrStatus status = bhr_render_surface(scene->context, surface);
    CHECK(status == BHR_OK || status == BHR_FRAME_SKIPPED, "%s: %s", bhr_status_name(status), bhr_error_message());
    bhr_surface_destroy(surface);
}

static void modes(const Scene *scene, const Host *host) {
    static const BhrPresentMode unknown[] = {-1, 3, 1000};
    const BhrWindow             window = host_window(host);
    BhrSurface                 *refused = NULL;
    BhrSurface                 *surface;
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "mode",
                    bhr_surface_create(scene->context, &window, WIDTH, HEIGHT, unknown[i], &refused));
    }
    surface = check_surface(scene->context, host, WIDTH, HEIGHT, BHR_PRESENT_MAILBOX);
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "mode", bhr_surface_set_present_mode(surface, unknown[i]));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "surface", bhr_surface_set_present_mode(NULL, BHR_PRESENT_VSYNC));
    CHECK_OK(bhr_render_surface(scene->context, surface));
    bhr_surface_destroy(surface);
}

/* A window that is itself larger than the device's images: said, or shown where the host's memory is the way; and no
 * more once it is small again. */
static void large_window(const Scene *scene) {
    Host        host = host_open(scene->kind, NULL, WIDTH, HEIGHT);
    BhrSurface *surface = check_surface(scene->context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    CHECK_OK(bhr_render_surface(scene->context, surface));
    host_resize(&host, 32767, 3);
    for (int i = 0; i < 3; i++) {
        check_mark_message();
        const BhrStatus status = bhr_render_surface(scene->context, surface);
        if (status < 0) {
            check_fails(status, BHR_ERROR_UNSUPPORTED, "32767", __FILE__, __LINE__, "a frame in a large window");
        }
    }
    host_resize(&host, WIDTH, HEIGHT);
    CHECK_OK(bhr_surface_resize(surface, WIDTH, HEIGHT));
    CHECK_OK(bhr_render_surface(scene->context, surface));
    bhr_surface_destroy(surface);
    host_close(&host);
    check_works(scene, "a large window");
}

/* ---- surfaces of others ---- */

static void two_surfaces(const Scene *scene, const Host *host) {
    BhrWindow   window = host_window(host);
    BhrSurface *surface = check_surface(scene->context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC), *second = NULL;
    BhrContext *other = check_context(scene->backend);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "surface",
                bhr_surface_create(scene->context, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &second));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "surface",
                bhr_surface_create(other, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &second));
    CHECK(second == NULL, "a second surface on one window");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_render_surface(other, surface));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "surface", bhr_render_surface(other, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_render_surface(NULL, surface));
    CHECK_OK(bhr_render_surface(scene->context, surface));
    bhr_surface_destroy(surface);
    /* Free again: for the other one, too. */
    CHECK_OK(bhr_surface_create(other, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &second));
    CHECK_OK(bhr_render_surface(other, second));
    bhr_surface_destroy(second);
    bhr_context_destroy(other);
}

/* The window is named in another way: by the other library, and with the server's name spelt otherwise. */
static void two_roads(const Scene *scene, const Host *host) {
    char       *name = malloc(strlen(getenv("DISPLAY")) + 3);
    BhrSurface *surface = check_surface(scene->context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC), *second = NULL;
    strcpy(name, getenv("DISPLAY"));
    strcat(name, ".0");
    for (int i = 0; i < 2; i++) {
        Host road = host_open(i == 0 ? BHR_WINDOW_XLIB : BHR_WINDOW_XCB, name, SMALL, SMALL);
        BhrWindow window = host_window(&road);
        window.id = host->id;
        CHECK_FAILS(BHR_ERROR_INVALID_STATE, "surface",
                    bhr_surface_create(scene->context, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &second));
        bhr_surface_destroy(second);
        host_close(&road);
    }
    bhr_surface_destroy(surface);
    free(name);
}

/* ---- too late ---- */

/* The window, or all of the host's connection, goes first. */
static void window_goes_first(const Scene *scene, int connection_too, int rendered) {
    Host        host = host_open(scene->kind, NULL, WIDTH, HEIGHT);
    BhrSurface *surface = check_surface(scene->context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    if (rendered) {
        CHECK_OK(bhr_render_surface(scene->context, surface));
    }
    host_destroy_window(&host);
    if (connection_too) {
        host_close(&host);
    }
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "window", bhr_render_surface(scene->context, surface));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "window", bhr_render_surface(scene->context, surface));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "window", bhr_surface_resize(surface, 20, 20));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "window", bhr_surface_set_present_mode(surface, BHR_PRESENT_MAILBOX));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "1048576", bhr_surface_resize(surface, UINT32_MAX, 20));
    bhr_surface_destroy(surface);
    host_close(&host);
    check_works(scene, "a window that went first");
}

/* An X server of this program's, to be ended. Returns its process, and its name in `name`. */
static pid_t start_server(char name[16]) {
    int    ends[2];
    char   descriptor[16];
    size_t length = 1;
    pid_t  process;
    if (!CHECK(pipe(ends) == 0, "no pipe")) {
        exit(check_end());
    }
    snprintf(descriptor, sizeof descriptor, "%d", ends[1]);
    if ((process = fork()) == 0) {
        dup2(open("/dev/null", O_WRONLY), 2);
        execlp("Xvfb", "Xvfb", "-displayfd", descriptor, "-screen", "0", "640x480x24", "-noreset", (char *)NULL);
        _exit(127);
    }
    close(ends[1]);
    name[0] = ':';
    while (length < 15 && read(ends[0], name + length, 1) == 1 && name[length] != '\n') {
        length++;
    }
    name[length] = '\0';
    close(ends[0]);
    CHECK(process > 0 && length > 1, "Xvfb does not start");
    return process;
}

/* The X server goes, and with it every window and connection: bhr's own, too. */
static void server_goes_first(const Scene *scene) {
    char        name[16];
    const pid_t server = start_server(name);
    Host        host = host_open(BHR_WINDOW_XCB, name, WIDTH, HEIGHT); /* Xlib would end this process */
    BhrSurface *surface = check_surface(scene->context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC), *second = NULL;
    BhrWindow   window = host_window(&host);
    CHECK_OK(bhr_render_surface(scene->context, surface));
    kill(server, SIGKILL);
    waitpid(server, NULL, 0);
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "window", bhr_render_surface(scene->context, surface));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "window", bhr_surface_resize(surface, 20, 20));
    bhr_surface_destroy(surface);
    const BhrStatus status = bhr_surface_create(scene->context, &window, WIDTH, HEIGHT, BHR_PRESENT_VSYNC, &second);
    CHECK(status == BHR_ERROR_INVALID_ARGUMENT || status == BHR_ERROR_UNSUPPORTED, "%s", bhr_status_name(status));
    host_close(&host);
    check_works(scene, "an X server that went first");
}

/* The window goes, and the host resizes the surface before it renders. */
static void resized_too_late(const Scene *scene) {
    Host        host = host_open(scene->kind, NULL, WIDTH, HEIGHT);
    BhrSurface *surface = check_surface(scene->context, &host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    CHECK_OK(bhr_render_surface(scene->context, surface));
    host_destroy_window(&host);
    const BhrStatus resized = bhr_surface_resize(surface, 30, 20);
    const BhrStatus moded = bhr_surface_set_present_mode(surface, BHR_PRESENT_IMMEDIATE);
    CHECK(resized == BHR_OK || resized == BHR_ERROR_SURFACE_LOST, "%s", bhr_status_name(resized));
    CHECK(moded == BHR_OK || moded == BHR_ERROR_SURFACE_LOST, "%s", bhr_status_name(moded));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "window", bhr_render_surface(scene->context, surface));
    bhr_surface_destroy(surface);
    host_close(&host);
}

static void context_goes_first(const Scene *scene, const Host *host) {
    BhrContext *context = check_context(scene->backend);
    BhrSurface *surface = check_surface(context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    CHECK_OK(bhr_render_surface(context, surface));
    bhr_context_destroy(context);
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "context", bhr_surface_resize(surface, 20, 20));
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "context", bhr_surface_set_present_mode(surface, BHR_PRESENT_VSYNC));
    const BhrStatus status = bhr_render_surface(scene->context, surface);
    CHECK(status == BHR_ERROR_SURFACE_LOST || status == BHR_ERROR_INVALID_ARGUMENT, "%s", bhr_status_name(status));
    bhr_surface_destroy(surface);
    bhr_surface_destroy(NULL);
}

/* Scenes that no frame can be made of leave the surface as it was. */
static void impossible_scene(const Scene *scene, const Host *host) {
    BhrContext *context = check_context(scene->backend);
    BhrSurface *surface = check_surface(context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    BhrCamera   good = {.struct_size = sizeof good}, camera;
    CHECK_OK(bhr_get_camera(context, &good));
    camera = good;
    camera.position[0] = 1.5;
    camera.position[1] = camera.position[2] = 0.0;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "horizon|static|STATIC", bhr_render_surface(context, surface));
    CHECK_OK(bhr_set_camera(context, &good));
    CHECK_OK(bhr_render_surface(context, surface));
    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
}

/* ---- from inside a callback ---- */

typedef struct Listener {
    BhrContext *context;
    BhrSurface *surface;
    BhrWindow   window;
    int         calls;
} Listener;

static void on_log(void *user, BhrLogLevel level, const char *message) {
    Listener   *listener = user;
    BhrSurface *surface = (BhrSurface *)&surface;
    (void)level;
    (void)message;
    if (listener->surface == NULL) {
        return;
    }
    listener->calls++;
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_render_surface(listener->context, listener->surface));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_surface_resize(listener->surface, 9, 9));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback",
                bhr_surface_set_present_mode(listener->surface, BHR_PRESENT_IMMEDIATE));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback",
                bhr_surface_create(listener->context, &listener->window, 9, 9, BHR_PRESENT_VSYNC, &surface));
    CHECK(surface == NULL, "a surface from inside a callback");
    check_mark_message();
    bhr_surface_destroy(listener->surface);
    CHECK(strstr(bhr_error_message(), "callback") != NULL, "bhr_surface_destroy in a callback says: %s",
          bhr_error_message());
}

static void from_callbacks(const Scene *scene, const Host *host) {
    Listener          listener = {NULL, NULL, host_window(host), 0};
    BhrContextOptions options;
    CHECK_OK(bhr_context_options_init(&options, sizeof options));
    options.backend = scene->backend;
    options.log_level = BHR_LOG_ERROR;
    options.log_fn = on_log;
    options.log_user = &listener;
    if (!CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &listener.context))) {
        return;
    }
    BhrSurface *surface = check_surface(listener.context, host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    listener.surface = surface;
    CHECK(bhr_surface_resize(surface, UINT32_MAX, 1) == BHR_ERROR_INVALID_ARGUMENT, "a huge size was taken");
    CHECK(listener.calls == 1, "%d messages about one failure", listener.calls);
    CHECK_OK(bhr_render_surface(listener.context, surface));
    listener.surface = NULL;
    bhr_surface_destroy(surface);
    bhr_context_destroy(listener.context);
}

int main(int argc, char **argv) {
    Scene scene = {check_begin(argc, argv), host_kind(argc > 2 ? argv[2] : NULL), NULL, {0}};
    if (getenv("OTHER_DISPLAY") == NULL || getenv("DISPLAY") == NULL) {
        CHECK(0, "DISPLAY or OTHER_DISPLAY is not set");
        return check_end();
    }
    scene.context = check_context(scene.backend);
    watch_begin(&scene.watch, scene.context);
    Host            host = host_open(scene.kind, NULL, WIDTH, HEIGHT);
    const BhrWindow good = host_window(&host);
    kinds(&scene, &good);
    fields(&scene, &good);
    later_struct(&scene, &good);
    check_works(&scene, "bad structs");
    absent(&scene);
    input_only(&scene, &host);
    check_works(&scene, "absent windows");
    sizes(&scene, &host);
    large_window(&scene);
    modes(&scene, &host);
    two_surfaces(&scene, &host);
    two_roads(&scene, &host);
    check_works(&scene, "bad sizes, modes and owners");
    for (int i = 0; i < 4; i++) {
        window_goes_first(&scene, i & 1, i >> 1);
    }
    server_goes_first(&scene);
    resized_too_late(&scene);
    context_goes_first(&scene, &host);
    impossible_scene(&scene, &host);
    from_callbacks(&scene, &host);
    check_works(&scene, "all of this");
    bhr_context_destroy(scene.context);
    host_close(&host);
    return check_end();
}
