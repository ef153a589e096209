/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* log_waits.c -- a log callback that waits for another thread's calls on another context: create, render, destroy. It
 * does so at moments of every call that logs: bhr holds no lock then that such calls need. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#define WIDTH 48u
#define HEIGHT 32u
#define BYTES (WIDTH * HEIGHT * 4u)
/* Seconds that the other context may take on a machine that is busy with other tests; it takes less than one. */
#define LIMIT 120
/* The callback waits at its 1st, 32nd, 1024th ... message of a call; everyday at its 1st and its 1024th. */
#define RARER (check_runs_all() ? 32 : 1024)

/* The other context's thread, which may outlive the wait for it: never freed. */
typedef struct Other {
    BhrBackend      backend;
    pthread_mutex_t lock;
    pthread_cond_t  ended;
    int             done;
} Other;

typedef struct Listener {
    BhrBackend      backend;
    pthread_mutex_t lock;
    long            heard, next; /* messages of this call; the one at which to wait */
    long            waits;       /* of all calls */
    int             hung;
} Listener;

static Listener listener = {0, PTHREAD_MUTEX_INITIALIZER, 0, 1, 0, 0};

static void render(BhrContext *context) {
    static unsigned char pixels[BYTES];
    unsigned char       *own = malloc(BYTES);
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, own ? own : pixels, BYTES);
    CHECK_OK(bhr_render_image(context, &image));
    free(own);
}

static void *use_another_context(void *argument) {
    Other      *other = argument;
    BhrContext *context = check_context(other->backend);
    render(context);
    bhr_context_destroy(context);
    pthread_mutex_lock(&other->lock);
    other->done = 1;
    pthread_cond_signal(&other->ended);
    pthread_mutex_unlock(&other->lock);
    return NULL;
}

/* Whether the other thread was through in time. */
static int wait_for_another_context(BhrBackend backend) {
    Other          *other = calloc(1, sizeof *other);
    pthread_t       thread;
    struct timespec end;
    int             done, waited = 0;
    if (other == NULL || pthread_mutex_init(&other->lock, NULL) != 0 || pthread_cond_init(&other->ended, NULL) != 0) {
        return 0;
    }
    other->backend = backend;
    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += LIMIT;
    if (pthread_create(&thread, NULL, use_another_context, other) != 0) {
        return 0;
    }
    pthread_mutex_lock(&other->lock);
    while (!other->done && waited != ETIMEDOUT) {
        waited = pthread_cond_timedwait(&other->ended, &other->lock, &end);
    }
    done = other->done;
    pthread_mutex_unlock(&other->lock);
    if (done) {
        pthread_join(thread, NULL);
        free(other);
    } else {
        pthread_detach(thread);
    }
    return done;
}

static void on_log(void *user, BhrLogLevel level, const char *message) {
    Listener *self = user;
    int       due;
    pthread_mutex_lock(&self->lock);
    self->heard++;
    due = self->heard == self->next && !self->hung;
    if (due) {
        self->next *= RARER;
        self->waits++;
    }
    pthread_mutex_unlock(&self->lock);
    if (due && !wait_for_another_context(self->backend)) {
        pthread_mutex_lock(&self->lock);
        self->hung = 1;
        pthread_mutex_unlock(&self->lock);
        CHECK(0, "while this was told, another context hung: %d %s", (int)level, message);
    }
}

/* Before each call: how many messages the last one had. */
static long next_call(void) {
    long heard;
    pthread_mutex_lock(&listener.lock);
    heard = listener.heard;
    listener.heard = 0;
    listener.next = 1;
    pthread_mutex_unlock(&listener.lock);
    return heard;
}

static BhrContext *listening_context(void) {
    BhrContextOptions options = check_options(listener.backend);
    options.log_level = BHR_LOG_TRACE;
    options.log_fn = on_log;
    options.log_user = &listener;
    return check_context_with(&options);
}

static void render_in_background(BhrContext *context) {
    unsigned char *pixels = malloc(BYTES);
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
    BhrJob        *job = NULL;
    double         fraction;
    CHECK_OK(bhr_render_image_async(context, &image, &job));
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, &fraction));
    bhr_job_destroy(job);
    free(pixels);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    uint32_t         count;
    listener.backend = backend;

    BhrContext *context = listening_context(); /* the first search for drivers of this process is part of it */
    CHECK(next_call() > 0, "a context was created in silence");
    render(context);
    CHECK(next_call() > 0 || backend == BHR_BACKEND_CPU, "the first frame was made in silence");
    render_in_background(context);
    CHECK(next_call() > 0 || backend == BHR_BACKEND_CPU, "a job was made in silence");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "mass", bhr_set_mass(context, -1.0));
    CHECK(next_call() > 0, "a failed call is not told");
    CHECK_OK(bhr_adapter_count(&count));
    next_call();
    CHECK_OK(bhr_context_recover(context));
    CHECK(next_call() > 0 || backend == BHR_BACKEND_CPU, "drivers were asked anew in silence");
    render(context);
    next_call();
    bhr_context_destroy(context);
    CHECK(next_call() > 0 || backend == BHR_BACKEND_CPU, "a device was closed in silence");
    CHECK(listener.waits >= (backend == BHR_BACKEND_CPU ? 2 : 8), "the callback waited %ld times", listener.waits);
    return check_end();
}
