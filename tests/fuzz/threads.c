/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* threads.c -- four threads that share two contexts of the CPU tracer, with a log callback: settings, frames, jobs that
 * are waited for, cancelled and dropped, rays, messages, and contexts that come and go beside them. For
 * ThreadSanitizer, which ends the program with a status of its own for a data race; the program itself fails for a
 * status that no call may give.
 *
 *     threads ROUNDS [SEED]
 *     threads race            two frames into the same pixels at once, which the sanitizer has to find
 */
#define _POSIX_C_SOURCE 200809L

#include <bhr.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define THREADS 4
#define SIDE 16u

static BhrContext     *shared[2];
static unsigned        rounds;
static int             failures;
static unsigned long   calls, heard;
static pthread_mutex_t counts = PTHREAD_MUTEX_INITIALIZER;

typedef struct Worker {
    unsigned      number;
    unsigned long state;
    unsigned long calls;
} Worker;

static unsigned pick(Worker *worker, unsigned below) {
    worker->state = worker->state * 6364136223846793005ul + 1442695040888963407ul;
    return (unsigned)(worker->state >> 33) % below;
}

/* BHR_OK, or one of the two statuses that are no fault here. */
static void may(Worker *worker, const char *what, BhrStatus status, BhrStatus other, BhrStatus another) {
    worker->calls++;
    if (status != BHR_OK && status != other && status != another) {
        fprintf(stderr, "thread %u, %s: status %d, %s\n", worker->number, what, (int)status, bhr_error_message());
        pthread_mutex_lock(&counts);
        failures++;
        pthread_mutex_unlock(&counts);
    }
}

static void listen(void *user, BhrLogLevel level, const char *message) {
    (void)level;
    /* A lock, or an ordered atomic, would put the threads' work in an order, and hide what the sanitizer looks for. */
    __atomic_fetch_add((unsigned long *)user, strlen(message) > 0, __ATOMIC_RELAXED);
}

static BhrContext *create(Worker *worker, BhrLogFn log_fn) {
    BhrContextOptions options;
    BhrContext       *context = NULL;
    may(worker, "init", bhr_context_options_init(&options, sizeof options), BHR_OK, BHR_OK);
    options.backend = BHR_BACKEND_CPU, options.cpu_threads = pick(worker, 3);
    options.log_level = BHR_LOG_DEBUG, options.log_fn = log_fn, options.log_user = &heard;
    may(worker, "create", bhr_context_create(BHR_ABI_VERSION, &options, &context), BHR_OK, BHR_OK);
    return context;
}

static BhrImage image_of(unsigned char *pixels, size_t size, unsigned side) {
    BhrImage image;
    bhr_image_init(&image, sizeof image);
    image.width = image.height = side;
    image.pixels = pixels, image.byte_size = size;
    return image;
}

static void background(Worker *worker, BhrContext *context, unsigned char *pixels, size_t size) {
    const BhrImage image = image_of(pixels, size, SIDE);
    BhrJob        *job = NULL;
    may(worker, "async", bhr_render_image_async(context, &image, &job), BHR_OK, BHR_OK);
    if (job == NULL) {
        return;
    }
    switch (pick(worker, 3)) {
        case 0: may(worker, "wait", bhr_job_wait(job, UINT64_MAX, NULL), BHR_OK, BHR_OK); break;
        case 1:
            bhr_job_cancel(job);
            may(worker, "wait", bhr_job_wait(job, UINT64_MAX, NULL), BHR_ERROR_CANCELLED, BHR_OK);
            break;
        default: break; /* ended while it is under way */
    }
    bhr_job_destroy(job);
}

static void *work(void *argument) {
    Worker       *worker = argument;
    unsigned char pixels[SIDE * SIDE * 4];
    char          text[200];
    for (unsigned i = 0; i < rounds; i++) {
        BhrContext *own = pick(worker, 8) == 0 ? create(worker, listen) : NULL;
        BhrContext *context = own != NULL ? own : shared[pick(worker, 2)];
        switch (pick(worker, 10)) {
            case 0: may(worker, "spin", bhr_set_spin(context, pick(worker, 9) / 10.0), BHR_OK, BHR_OK); break;
            case 1: may(worker, "mass", bhr_set_mass(context, -1.0), BHR_ERROR_INVALID_ARGUMENT, BHR_OK); break;
            case 2: may(worker, "time", bhr_set_time(context, pick(worker, 1000)), BHR_OK, BHR_OK); break;
            case 3: {
                BhrCamera camera;
                bhr_camera_init(&camera, sizeof camera);
                bhr_camera_orbit(&camera, 6.0 + pick(worker, 40), 0.1 * pick(worker, 60), 0.3);
                may(worker, "camera", bhr_set_camera(context, &camera), BHR_OK, BHR_OK);
                break;
            }
            case 4:
                may(worker, "preset", bhr_set_preset(context, (BhrPreset)pick(worker, 4)), BHR_OK, BHR_OK);
                break;
            case 5: {
                const BhrRay ray = {{30.0, 0.0, 4.0}, {-1.0, 0.01 * pick(worker, 90), 0.1}, 1.0};
                BhrHit       hit;
                may(worker, "rays", bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit), BHR_OK, BHR_OK);
                break;
            }
            case 6:
                bhr_context_error_message(context, text, sizeof text);
                (void)bhr_error_message();
                break;
            case 7: {
                const BhrImage image = image_of(pixels, sizeof pixels, 1 + pick(worker, SIDE));
                may(worker, "image", bhr_render_image(context, &image), BHR_OK, BHR_OK);
                break;
            }
            default: background(worker, context, pixels, sizeof pixels); break;
        }
        bhr_context_destroy(own);
    }
    return NULL;
}

static pthread_barrier_t both;

static void *render_over(void *context) {
    static unsigned char pixels[64 * 64 * 4];
    const BhrImage       image = image_of(pixels, sizeof pixels, 64);
    pthread_barrier_wait(&both);
    for (int i = 0; i < 20; i++) {
        if (bhr_render_image(context, &image) != BHR_OK) {
            fprintf(stderr, "%s\n", bhr_error_message());
        }
    }
    return NULL;
}

/* Threads that do what no host may: whether the library's own accesses are watched shows in that. */
static int race(void) {
    pthread_t threads[2];
    Worker    worker = {0, 1, 0};
    if (pthread_barrier_init(&both, NULL, 2) != 0) {
        return 1;
    }
    for (int i = 0; i < 2; i++) {
        shared[i] = create(&worker, NULL);
    }
    for (int i = 0; i < 2; i++) {
        if (shared[i] == NULL || pthread_create(&threads[i], NULL, render_over, shared[i]) != 0) {
            return 1;
        }
    }
    for (int i = 0; i < 2; i++) {
        pthread_join(threads[i], NULL);
        bhr_context_destroy(shared[i]);
    }
    return 0;
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "race") == 0) {
        return race();
    }
    const unsigned long seed = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    pthread_t           threads[THREADS];
    Worker              workers[THREADS], first = {THREADS, seed, 0};
    rounds = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 100;
    for (int i = 0; i < 2; i++) {
        shared[i] = create(&first, listen);
        if (shared[i] == NULL) {
            return 1;
        }
    }
    for (unsigned i = 0; i < THREADS; i++) {
        workers[i] = (Worker){i, seed * 1000 + i, 0};
        if (pthread_create(&threads[i], NULL, work, &workers[i]) != 0) {
            return 1;
        }
    }
    for (unsigned i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        calls += workers[i].calls;
    }
    bhr_context_destroy(shared[0]);
    bhr_context_destroy(shared[1]);
    printf("%lu calls by %d threads, %lu messages, %d failures\n", calls, THREADS, heard, failures);
    return failures != 0 || calls < rounds;
}
