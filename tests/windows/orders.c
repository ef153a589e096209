/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* orders.c -- context, surface, job, window and the window system's connection end in every order there is, 120, each
 * with frames under way; after each end, what is left still answers as the header says. Nothing may break, and the log
 * stays silent but for the failures of calls that fail: with "validation", the driver's validation layers speak there
 * too.
 *
 *     orders BACKEND xlib|xcb|glfw [steps|few] [validation]
 *
 * steps: only as many of the orders as have every step, for a developer. A step is one of the five and what else is
 * still there when it ends; there are 80. few: as many as have every step of the four but the job, of which there are
 * 32; the job ends among them wherever most is new. glfw: the connection is the library's, ended by glfwTerminate. */
#include "host.h"

#define GLFW_INCLUDE_NONE
#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 48u
#define HEIGHT 32u

enum { CONTEXT, SURFACE, JOB, WINDOW, CONNECTION, ENDS };
static const char *const NAMES[ENDS] = {"context", "surface", "job", "window", "connection"};

static int use_glfw, use_validation, messages;

/* ---- the log ---- */

/* Debian 12's layers (1.3.239) do not know WGSL, which naga names as the language of its shaders: no complaint about
 * what bhr does. */
static const char KNOWN[] = "Invalid source language operand";

static void on_log(void *user, BhrLogLevel level, const char *message) {
    (void)user;
    (void)level;
    if (strncmp(message, "bhr_", 4) == 0 || strstr(message, KNOWN) != NULL) {
        return; /* a failed call, which is checked where it is made */
    }
    messages++;
    CHECK(0, "the log says: %s", message);
}

/* The layers are at work, or their silence means nothing. */
static int has_layers(void) {
    char  line[1024];
    int   found = 0;
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps != NULL && !found && fgets(line, sizeof line, maps) != NULL) {
        found = strstr(line, "VkLayer_khronos_validation") != NULL;
    }
    if (maps != NULL) {
        fclose(maps);
    }
    return found;
}

/* ---- a set of all that can end ---- */

typedef struct Set {
    BhrContext *context;
    BhrSurface *surface;
    BhrJob     *job;
    Host        host;
    GLFWwindow *glfw;
    int         alive[ENDS];
} Set;

static unsigned char job_pixels[WIDTH * HEIGHT * 4];

static void open_glfw_window(Set *set) {
    if (!CHECK(glfwInit() == GLFW_TRUE, "GLFW does not start")) {
        exit(check_end());
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    set->glfw = glfwCreateWindow((int)WIDTH, (int)HEIGHT, "orders", NULL, NULL);
    if (!CHECK(set->glfw != NULL, "GLFW makes no window")) {
        exit(check_end());
    }
    glfwPollEvents();
    set->host.kind = BHR_WINDOW_XLIB;
    set->host.display = glfwGetX11Display();
    set->host.id = (uint32_t)glfwGetX11Window(set->glfw);
}

static BhrContext *open_context(BhrBackend backend) {
    BhrContextOptions options = check_options(backend);
    options.flags = use_validation ? BHR_CONTEXT_VALIDATION : 0;
    options.log_fn = on_log;
    return check_context_with(&options);
}

/* Everything is there, frames have been presented, and a job is under way. */
static void begin(Set *set, BhrBackend backend, BhrWindowKind kind) {
    const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, job_pixels, sizeof job_pixels);
    BhrQuality     quality;
    memset(set, 0, sizeof *set);
    set->context = open_context(backend);
    if (use_glfw) {
        open_glfw_window(set);
    } else {
        set->host = host_open(kind, NULL, WIDTH, HEIGHT);
    }
    CHECK(!use_validation || has_layers(), "the validation layers are not loaded");
    set->surface = check_surface(set->context, &set->host, WIDTH, HEIGHT, BHR_PRESENT_VSYNC);
    CHECK_OK(bhr_render_surface(set->context, set->surface));
    CHECK_OK(bhr_render_surface(set->context, set->surface));
    CHECK_OK(bhr_quality_init(&quality, sizeof quality));
    quality.samples_per_pixel = check_runs_all() ? 16 : 6;
    quality.method = BHR_METHOD_RK4;
    CHECK_OK(bhr_set_quality(set->context, &quality));
    CHECK_OK(bhr_render_image_async(set->context, &target, &set->job));
    quality.samples_per_pixel = 1;
    CHECK_OK(bhr_set_quality(set->context, &quality));
    for (int i = 0; i < ENDS; i++) {
        set->alive[i] = 1;
    }
}

static void end_window(Set *set) {
    if (!use_glfw) {
        host_destroy_window(&set->host);
    } else if (set->alive[CONNECTION]) {
        glfwDestroyWindow(set->glfw);
    }
}

static void end_connection(Set *set) {
    if (use_glfw) {
        glfwTerminate();
    } else {
        host_close(&set->host);
    }
}

static void end(Set *set, int what) {
    switch (what) {
        case CONTEXT:
            bhr_context_destroy(set->context);
            break;
        case SURFACE:
            bhr_surface_destroy(set->surface);
            break;
        case JOB:
            bhr_job_destroy(set->job);
            memset(job_pixels, UNTOUCHED, sizeof job_pixels);
            break;
        case WINDOW:
            end_window(set);
            break;
        default:
            end_connection(set);
            break;
    }
    set->alive[what] = 0;
}

/* ---- what is left ---- */

static void check_left(const Set *set, const char *order) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    const int            shown = set->alive[WINDOW] && set->alive[CONNECTION]; /* which takes its windows along */
    if (set->alive[CONTEXT] && set->alive[SURFACE]) {
        const BhrStatus status = bhr_render_surface(set->context, set->surface);
        CHECK(shown ? status == BHR_OK || status == BHR_FRAME_SKIPPED : status == BHR_ERROR_SURFACE_LOST, "%s: %s: %s",
              order, bhr_status_name(status), bhr_error_message());
    }
    if (set->alive[CONTEXT]) {
        CHECK_OK(bhr_render_image(set->context, &image));
    }
    if (set->alive[SURFACE] && !set->alive[CONTEXT]) {
        CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "", bhr_surface_resize(set->surface, 30, 20));
    }
    if (set->alive[JOB]) {
        const BhrStatus status = bhr_job_wait(set->job, 0, NULL);
        CHECK(status == BHR_OK || (status == BHR_NOT_READY && set->alive[CONTEXT]), "%s: the job: %s", order,
              bhr_status_name(status));
    }
    if (!set->alive[JOB]) {
        CHECK(all_untouched(job_pixels, sizeof job_pixels), "%s: written to after the job's end", order);
    }
}

/* ---- all orders ---- */

static void run_order(const int order[ENDS], BhrBackend backend, BhrWindowKind kind) {
    char name[128] = "";
    Set  set;
    begin(&set, backend, kind);
    for (int i = 0; i < ENDS; i++) {
        strcat(strcat(name, i > 0 ? ", " : ""), NAMES[order[i]]);
        end(&set, order[i]);
        check_left(&set, name);
    }
}

#define ORDERS 120 /* 5! */
#define STEPS 80   /* 5 that end, each beside the 2^4 sets of the others */
#define FEW 32     /* 4, each beside 2^3 */

static int orders[ORDERS][ENDS];

/* Lists every permutation of order[first ..]; count is how many there are so far, and the result how many then. */
static int list_orders(int order[ENDS], int first, int count) {
    if (first == ENDS) {
        memcpy(orders[count], order, sizeof orders[count]);
        return count + 1;
    }
    for (int i = first; i < ENDS; i++) {
        const int kept = order[first];
        order[first] = order[i];
        order[i] = kept;
        count = list_orders(order, first + 1, count);
        order[i] = order[first];
        order[first] = kept;
    }
    return count;
}

typedef unsigned char Seen[1 << ENDS][ENDS]; /* by the set of what is alive, and which of them ends */

/* How many steps of the order, without those of `ignored` (or ENDS), have not been seen; with mark they have been from
 * now on. */
static int new_steps(const int order[ENDS], int ignored, Seen seen, int mark) {
    int alive = ((1 << ENDS) - 1) & ~(1 << ignored), count = 0;
    for (int i = 0; i < ENDS; i++) {
        if (order[i] != ignored) {
            count += !seen[alive][order[i]];
            seen[alive][order[i]] |= (unsigned char)mark;
            alive &= ~(1 << order[i]);
        }
    }
    return count;
}

/* Runs the order with the most new steps until none is left, without those of `ignored`, which count only where others
 * are as many; how many steps there were. */
static int run_steps(BhrBackend backend, BhrWindowKind kind, int ignored) {
    static Seen seen, seen_all;
    int         steps = 0, ran = 0;
    for (;;) {
        int best = 0, most = -1;
        for (int i = 0; i < ORDERS; i++) {
            const int news =
                2 * ENDS * new_steps(orders[i], ignored, seen, 0) + new_steps(orders[i], ENDS, seen_all, 0);
            if (news > most) {
                best = i, most = news;
            }
        }
        const int more = new_steps(orders[best], ignored, seen, 1);
        if (more == 0) {
            printf("%d orders with %d steps\n", ran, steps);
            return steps;
        }
        (void)new_steps(orders[best], ENDS, seen_all, 1);
        run_order(orders[best], backend, kind);
        steps += more;
        ran++;
    }
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    int              only_steps = 0, few = 0;
    use_glfw = argc > 2 && strcmp(argv[2], "glfw") == 0;
    for (int i = 3; i < argc; i++) {
        use_validation |= strcmp(argv[i], "validation") == 0;
        few |= strcmp(argv[i], "few") == 0;
        only_steps |= few || strcmp(argv[i], "steps") == 0;
    }
    const BhrWindowKind kind = use_glfw ? BHR_WINDOW_XLIB : host_kind(argc > 2 ? argv[2] : NULL);
    int                 order[ENDS] = {CONTEXT, SURFACE, JOB, WINDOW, CONNECTION};
    const int           count = list_orders(order, 0, 0);
    CHECK(count == ORDERS, "%d orders", count);
    if (only_steps) {
        const int steps = run_steps(backend, kind, few ? JOB : ENDS);
        CHECK(steps == (few ? FEW : STEPS), "%d steps", steps);
    }
    for (int i = 0; !only_steps && i < ORDERS; i++) {
        run_order(orders[i], backend, kind);
    }
    CHECK(messages == 0, "%d messages in the log", messages);
    return check_end();
}
