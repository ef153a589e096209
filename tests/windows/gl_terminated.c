/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gl_terminated.c -- a host in which some other library terminates the EGL display that bhr's GL tracer uses too, at
 * random moments of a context's life: while it is made, renders, is recovered and is destroyed. Each call then succeeds
 * or fails as the header says, the process lives, and later contexts of every backend work. The second argument is the
 * number of lives (default 40), the third the seed. */
#define _POSIX_C_SOURCE 200809L

#include "host.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 160u
#define HEIGHT 90u
#define BYTES (WIDTH * HEIGHT * 4u)

/* The parts of a context's life. The display ends during one of them. */
enum Part { CREATE, RENDER, JOB, RAYS, RECOVER, DESTROY, PARTS };

static const char *const NAMES[] = {"create", "render", "job", "rays", "recover", "destroy"};

/* ---- the other library ---- */

typedef void *(*GetPlatformDisplay)(unsigned platform, void *native, const intptr_t *attributes);
typedef unsigned (*Initialise)(void *display, int *major, int *minor);
typedef unsigned (*Terminate)(void *display);

static GetPlatformDisplay get_display;
static Initialise         initialise;
static Terminate          terminate;

/* ISO C has no cast from an object's pointer to a function's. */
static void load(void *function, const char *name) {
    void *library = dlopen("libEGL.so.1", RTLD_NOW);
    void *found = library != NULL ? dlsym(library, name) : NULL;
    memcpy(function, &found, sizeof found);
}

typedef struct Blow {
    pthread_t thread;
    double    after; /* seconds from its request */
} Blow;

static void *strike(void *argument) {
    static const intptr_t none[] = {0x3038 /* EGL_NONE */}; /* as wgpu: else it is another display */
    const Blow           *blow = argument;
    struct timespec       pause;
    void                 *display = get_display(0x31DD /* EGL_PLATFORM_SURFACELESS_MESA */, NULL, none);
    pause.tv_sec = (time_t)blow->after;
    pause.tv_nsec = (long)((blow->after - (double)pause.tv_sec) * 1e9);
    nanosleep(&pause, NULL);
    CHECK(initialise(display, NULL, NULL) && terminate(display), "the display does not end");
    return NULL;
}

/* ---- one life ---- */

static unsigned seed;
static double   took[PARTS]; /* seconds, undisturbed */
static int      lost;        /* calls that failed */

static double random_part_of(double seconds) {
    return seconds * ((double)rand_r(&seed) / (double)RAND_MAX);
}

static BhrStatus part_of_life(enum Part part, BhrContext **context, unsigned char *pixels) {
    const BhrImage    image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
    const BhrRay      ray = {{30.0, 0.0, 4.0}, {-1.0, 0.4, 0.1}, 1.0};
    BhrContextOptions options;
    BhrHit            hit;
    BhrJob           *job = NULL;
    BhrStatus         status;
    switch (part) {
    case CREATE:
        CHECK_OK(bhr_context_options_init(&options, sizeof options));
        options.backend = BHR_BACKEND_GL;
        return bhr_context_create(BHR_ABI_VERSION, &options, context);
    case RENDER:
        return bhr_render_image(*context, &image);
    case JOB:
        status = bhr_render_image_async(*context, &image, &job);
        status = status == BHR_OK ? bhr_job_wait(job, UINT64_MAX, NULL) : status;
        bhr_job_destroy(job);
        return status;
    case RAYS:
        return bhr_trace_rays(*context, &ray, sizeof ray, 1, &hit, sizeof hit);
    case RECOVER:
        return bhr_context_recover(*context);
    case DESTROY:
    default:
        bhr_context_destroy(*context);
        return BHR_OK;
    }
}

static void check_status(enum Part part, BhrStatus status) {
    const BhrStatus failure = part == CREATE || part == RECOVER ? BHR_ERROR_NO_ADAPTER : BHR_ERROR_DEVICE_LOST;
    CHECK(status == BHR_OK || status == failure, "%s gives %d: %s", NAMES[part], (int)status, bhr_error_message());
    lost += status != BHR_OK;
}

/* The display ends at a random moment of the part `hit`; with PARTS of none, and the parts' times are taken. */
static void live(enum Part hit) {
    static unsigned char pixels[BYTES];
    BhrContext          *context = NULL;
    for (int i = 0; i < PARTS; i++) {
        const enum Part part = (enum Part)i;
        const double    start = seconds_now();
        BhrStatus       status;
        Blow            blow;
        blow.after = random_part_of(took[part]);
        if (part == hit && pthread_create(&blow.thread, NULL, strike, &blow) != 0) {
            CHECK(0, "no thread");
            exit(check_end());
        }
        status = part_of_life(part, &context, pixels);
        if (hit == PARTS) {
            took[part] = seconds_now() - start;
            CHECK(status == BHR_OK, "%s: %s", NAMES[part], bhr_error_message());
        } else {
            check_status(part, status);
        }
        if (part == hit) {
            pthread_join(blow.thread, NULL);
        }
        if (context == NULL) {
            return;
        }
    }
}

/* A whole life where nothing is terminated any more. */
static void check_works(BhrBackend backend) {
    static unsigned char pixels[BYTES];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
    BhrContext          *context = check_context(backend);
    memset(pixels, 0, sizeof pixels);
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(pixels[3] == 255 && pixels[BYTES - 1] == 255, "a frame has holes");
    bhr_context_destroy(context);
}

int main(int argc, char **argv) {
    static const BhrBackend BACKENDS[] = {BHR_BACKEND_CPU, BHR_BACKEND_VULKAN, BHR_BACKEND_GL, BHR_BACKEND_AUTO};
    const int               lives = argc > 2 ? atoi(argv[2]) : 40;
    uint32_t                count = 0;
    check_begin(argc, argv);
    seed = argc > 3 ? (unsigned)strtoul(argv[3], NULL, 10) : 1;
    load(&get_display, "eglGetPlatformDisplay");
    load(&initialise, "eglInitialize");
    load(&terminate, "eglTerminate");
    if (!CHECK(get_display != NULL && initialise != NULL && terminate != NULL, "no libEGL")) {
        return check_end();
    }
    live(PARTS);
    live(PARTS); /* the drivers' caches are filled now */
    for (int i = 0; i < lives; i++) {
        live((enum Part)(i % PARTS));
    }
    CHECK(lost > 0, "the display ended %d times, and no call noticed", lives);
    printf("%d of %d calls failed\n", lost, lives * PARTS);
    for (size_t i = 0; i < COUNT_OF(BACKENDS); i++) {
        check_works(BACKENDS[i]);
    }
    CHECK_OK(bhr_adapter_count(&count));
    CHECK(count >= 3, "%u adapters", (unsigned)count);
    return check_end();
}
