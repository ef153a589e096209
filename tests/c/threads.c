/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* threads.c -- two contexts on two threads, one context shared by four, messages that belong to a thread, a context
 * that moves between threads, and any order of destruction. Every frame must be the one a single thread gets. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 48u
#define HEIGHT 32u
#define BYTES (WIDTH * HEIGHT * 4u)
#define ROUNDS 6

static unsigned char expected[BYTES];

static void render(BhrContext *context, unsigned char *pixels) {
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
    CHECK_OK(bhr_render_image(context, &image));
}

static void start(pthread_t *thread, void *(*body)(void *), void *argument) {
    if (pthread_create(thread, NULL, body, argument) != 0) {
        CHECK(0, "cannot start a thread");
        exit(check_end());
    }
}

/* ---- contexts of their own ---- */

static void *own_context(void *argument) {
    unsigned char pixels[BYTES];
    for (int i = 0; i < 2; i++) {
        BhrContext *context = check_context(*(const BhrBackend *)argument);
        for (int round = 0; round < ROUNDS; round++) {
            render(context, pixels);
            CHECK(memcmp(pixels, expected, BYTES) == 0, "a frame made beside another context differs");
        }
        bhr_context_destroy(context);
    }
    return NULL;
}

/* ---- one context for all ---- */

/* Renders, asks rays, fails on purpose, and reads settings nobody changes. */
static void *shared_context(void *argument) {
    BhrContext   *context = argument;
    unsigned char pixels[BYTES];
    const BhrRay  ray = {{30.0, 0.0, 4.0}, {-1.0, 0.4, 0.1}, 1.0};
    BhrHit        hit;
    for (int round = 0; round < ROUNDS; round++) {
        double m = 0.0, a = 1.0, axis[3];
        render(context, pixels);
        CHECK(memcmp(pixels, expected, BYTES) == 0, "a frame of a shared context differs");
        CHECK_OK(bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit));
        CHECK(hit.fate == BHR_FATE_ESCAPED, "fate %d", (int)hit.fate);
        CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "mass", bhr_set_mass(context, -1.0));
        CHECK_OK(bhr_get_hole(context, &m, &a, axis));
        CHECK(m == 1.0 && a == 0.0, "mass %g, spin %g", m, a);
    }
    return NULL;
}

/* Sets one thing again and again while others set other things: none may get lost, none may tear. */
typedef struct Setter {
    BhrContext *context;
    double      spin;
} Setter;

static void *set_spin(void *argument) {
    const Setter *setter = argument;
    for (int round = 0; round < 200; round++) {
        double m, a, axis[3];
        CHECK_OK(bhr_set_spin(setter->context, setter->spin));
        CHECK_OK(bhr_get_hole(setter->context, &m, &a, axis));
        CHECK(a == 0.25 || a == -0.75, "a torn spin: %g", a);
    }
    return NULL;
}

/* ---- messages ---- */

static pthread_barrier_t both_failed;

static void *fail_with_spin(void *argument) {
    CHECK(bhr_set_spin(argument, 2.5) == BHR_ERROR_INVALID_ARGUMENT, "spin 2.5 was taken");
    pthread_barrier_wait(&both_failed);
    CHECK(strstr(bhr_error_message(), "spin") != NULL, "this thread's message is: %s", bhr_error_message());
    return NULL;
}

static void *fail_with_mass(void *argument) {
    CHECK(bhr_set_mass(argument, -2.5) == BHR_ERROR_INVALID_ARGUMENT, "mass -2.5 was taken");
    const char *message = bhr_error_message();
    pthread_barrier_wait(&both_failed);
    CHECK(strstr(message, "mass") != NULL && message == bhr_error_message(), "this thread's message is: %s", message);
    return NULL;
}

/* ---- a context that moves ---- */

static void *render_and_destroy(void *argument) {
    unsigned char pixels[BYTES];
    render(argument, pixels);
    CHECK(memcmp(pixels, expected, BYTES) == 0, "a frame made on another thread than the context's differs");
    bhr_context_destroy(argument);
    return NULL;
}

static void *create(void *argument) {
    return check_context(*(const BhrBackend *)argument);
}

/* ---- destruction in any order, from the first to be made to the last and back ---- */

static void destroy_orders(BhrBackend backend) {
    unsigned char pixels[BYTES];
    for (int backward = 0; backward <= 1; backward++) {
        BhrContext *contexts[3];
        for (int i = 0; i < 3; i++) {
            contexts[i] = check_context(backend);
        }
        for (int i = 0; i < 3; i++) {
            bhr_context_destroy(contexts[backward ? 2 - i : i]);
            for (int k = i + 1; k < 3; k++) {
                render(contexts[backward ? 2 - k : k], pixels);
                CHECK(memcmp(pixels, expected, BYTES) == 0, "a frame after another context's end differs");
            }
        }
    }
    BhrContext    *context = check_context(backend);
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
    BhrJob        *job = NULL;
    if (bhr_render_image_async(context, &image, &job) == BHR_OK) { /* else jobs are not there yet: UNSUPPORTED */
        bhr_context_destroy(context);
        bhr_job_destroy(job);
    } else {
        CHECK(job == NULL, "a job without success");
        bhr_context_destroy(context);
    }
}

int main(int argc, char **argv) {
    BhrBackend  backend = check_begin(argc, argv);
    BhrContext *context = check_context(backend);
    pthread_t   threads[4];
    void       *made;
    render(context, expected);

    for (int i = 0; i < 2; i++) {
        start(&threads[i], own_context, &backend);
    }
    for (int i = 0; i < 2; i++) {
        pthread_join(threads[i], NULL);
    }
    for (int i = 0; i < 4; i++) {
        start(&threads[i], shared_context, context);
    }
    for (int i = 0; i < 4; i++) {
        pthread_join(threads[i], NULL);
    }

    Setter setters[2] = {{context, 0.25}, {context, -0.75}};
    for (int i = 0; i < 2; i++) {
        start(&threads[i], set_spin, &setters[i]);
    }
    for (int i = 0; i < 2; i++) {
        pthread_join(threads[i], NULL);
    }
    CHECK_OK(bhr_set_spin(context, 0.0));

    if (CHECK(pthread_barrier_init(&both_failed, NULL, 2) == 0, "no barrier")) {
        start(&threads[0], fail_with_spin, context);
        start(&threads[1], fail_with_mass, context);
        pthread_join(threads[0], NULL);
        pthread_join(threads[1], NULL);
        pthread_barrier_destroy(&both_failed);
    }

    start(&threads[0], render_and_destroy, context);
    pthread_join(threads[0], NULL);
    start(&threads[0], create, &backend);
    pthread_join(threads[0], &made);
    start(&threads[0], render_and_destroy, made);
    pthread_join(threads[0], NULL);
    destroy_orders(backend);
    return check_end();
}
