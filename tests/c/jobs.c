/* jobs.c -- frames in the background: every job shows the scene as it was when the job was begun, whatever is set,
 * waited for, cancelled or destroyed meanwhile and in whatever order; waits end in time; progress is heard by the
 * waiter; a target is left alone once its job is gone; jobs outlive their context.
 *
 * A second argument is for valgrind: "small" leaves out what takes long there, "brief" all but the callbacks and the
 * ends of jobs that are under way. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define WIDTH 40u
#define HEIGHT 30u
#define BYTES (WIDTH * HEIGHT * 4u)
#define FLIGHT 8        /* jobs under way at once */
#define MAX_JOBS 64     /* unfinished ones of a context, by the header */
#define FOR_EVER UINT64_MAX

/* A job that is far from its end whenever it is looked at: many samples, every ray integrated. */
#define SLOW_WIDTH 640u
#define SLOW_HEIGHT 480u
#define SLOW_BYTES (SLOW_WIDTH * SLOW_HEIGHT * 4u)

static unsigned char slow_pixels[SLOW_BYTES];
static uint32_t      slow_samples = 256;

static void pause_ms(long ms) {
    const struct timespec time = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&time, NULL);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static BhrImage frame_of(unsigned char *pixels) {
    return image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
}

static BhrJob *submit(BhrContext *context, const BhrImage *target) {
    BhrJob *job = NULL;
    CHECK_OK(bhr_render_image_async(context, target, &job));
    if (!CHECK(job != NULL, "success without a job")) {
        exit(check_end());
    }
    return job;
}

static void set_quality(BhrContext *context, BhrMethod method, uint32_t samples) {
    BhrQuality quality;
    CHECK_OK(bhr_quality_init(&quality, sizeof quality));
    quality.method = method;
    quality.samples_per_pixel = samples;
    CHECK_OK(bhr_set_quality(context, &quality));
}

/* Without a region; the context's quality is the default one again afterwards. */
static BhrJob *submit_slow(BhrContext *context) {
    const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, SLOW_WIDTH, SLOW_HEIGHT, slow_pixels, SLOW_BYTES);
    CHECK_OK(bhr_set_region(context, NULL));
    set_quality(context, BHR_METHOD_RK4, slow_samples);
    BhrJob *job = submit(context, &target);
    set_quality(context, BHR_METHOD_AUTO, 1);
    return job;
}

/* Waits until some, but not all, of a job is done. */
static double wait_for_a_part(BhrJob *job, double part) {
    double    fraction = 0.0;
    BhrStatus status = BHR_NOT_READY;
    while (status == BHR_NOT_READY && fraction < part) {
        status = bhr_job_wait(job, 1000000, &fraction);
    }
    CHECK(status == BHR_NOT_READY, "no moment at which a part was done: %s, %g", bhr_status_name(status), fraction);
    return fraction;
}

static void end_slow(BhrJob *job) {
    bhr_job_cancel(job);
    CHECK_FAILS(BHR_ERROR_CANCELLED, "cancel", bhr_job_wait(job, FOR_EVER, NULL));
    bhr_job_destroy(job);
}

/* ---- snapshots ---- */

/* One of FLIGHT scenes that differ in what a job has to take along. */
static void set_scene(BhrContext *context, int index) {
    BhrCamera camera;
    BhrDisk   disk;
    BhrRegion region = {.struct_size = sizeof region, .full_width = 2 * WIDTH, .full_height = 2 * HEIGHT};
    region.x = WIDTH / 2 + (uint32_t)index;
    region.y = HEIGHT / 2;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    CHECK_OK(bhr_camera_orbit(&camera, 15.0 + index, 0.7 * index, 0.1 * index - 0.3));
    CHECK_OK(bhr_disk_init(&disk, sizeof disk));
    disk.turbulence = 0.8;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_disk(context, index == 5 ? NULL : &disk));
    CHECK_OK(bhr_set_mass(context, 1.0 + 0.1 * index));
    CHECK_OK(bhr_set_spin(context, index % 2 == 0 ? 0.0 : 0.2 * index - 0.5));
    CHECK_OK(bhr_set_time(context, 10.0 * index));
    CHECK_OK(bhr_set_region(context, index % 3 == 0 ? &region : NULL));
    CHECK_OK(bhr_set_effects(context, index == 6 ? 0u : BHR_EFFECT_ALL));
    CHECK_OK(bhr_set_view(context, index == 7 ? BHR_VIEW_ORDER : BHR_VIEW_LIGHT));
}

static unsigned char expected[FLIGHT][BYTES], got[FLIGHT][BYTES];

static void render_expected(BhrContext *context) {
    for (int i = 0; i < FLIGHT; i++) {
        const BhrImage target = frame_of(expected[i]);
        set_scene(context, i);
        CHECK_OK(bhr_render_image(context, &target));
        for (int k = 0; k < i; k++) {
            CHECK(memcmp(expected[i], expected[k], BYTES) != 0, "scenes %d and %d look alike: nothing is tested", i, k);
        }
    }
}

/* Begins all; the target's struct and the scene are gone as soon as each is begun. */
static void submit_all(BhrContext *context, BhrJob *jobs[FLIGHT]) {
    memset(got, UNTOUCHED, sizeof got);
    for (int i = 0; i < FLIGHT; i++) {
        BhrImage target = frame_of(got[i]);
        set_scene(context, i);
        jobs[i] = submit(context, &target);
        memset(&target, 0xEE, sizeof target);
        set_scene(context, (i + 3) % FLIGHT);
    }
}

static void check_frame(int index) {
    CHECK(memcmp(got[index], expected[index], BYTES) == 0, "job %d does not show the scene as it was", index);
}

static void poll_to_the_end(BhrJob *job) {
    double    fraction = -1.0, last = 0.0;
    BhrStatus status;
    while ((status = bhr_job_wait(job, 0, &fraction)) == BHR_NOT_READY) {
        CHECK(fraction >= last && fraction <= 1.0, "fraction %g after %g", fraction, last);
        last = fraction;
        pause_ms(1);
    }
    CHECK(status == BHR_OK && fraction == 1.0, "%s, fraction %g", bhr_status_name(status), fraction);
}

static void snapshots(BhrContext *context) {
    static const int orders[][FLIGHT] = {{0, 1, 2, 3, 4, 5, 6, 7}, {7, 6, 5, 4, 3, 2, 1, 0}, {3, 0, 7, 1, 6, 2, 5, 4}};
    BhrJob          *jobs[FLIGHT];
    for (size_t k = 0; k < COUNT_OF(orders); k++) {
        submit_all(context, jobs);
        for (int i = 0; i < FLIGHT; i++) {
            const int index = orders[k][i];
            if (index % 2 == 0) {
                CHECK_OK(bhr_job_wait(jobs[index], FOR_EVER, NULL));
            } else {
                poll_to_the_end(jobs[index]);
            }
            check_frame(index);
            if (k != 0) {
                bhr_job_destroy(jobs[index]);
            }
        }
        for (int i = 0; k == 0 && i < FLIGHT; i++) {
            CHECK_OK(bhr_job_wait(jobs[i], 0, NULL)); /* again and again */
            bhr_job_destroy(jobs[i]);
        }
    }
}

/* Some are cancelled, some destroyed, in an order of their own: the others come out right. */
static void mixed_ends(BhrContext *context) {
    BhrJob *jobs[FLIGHT];
    submit_all(context, jobs);
    bhr_job_destroy(jobs[4]);
    bhr_job_cancel(jobs[2]);
    bhr_job_cancel(jobs[2]);
    bhr_job_destroy(jobs[7]);
    CHECK_OK(bhr_job_wait(jobs[6], FOR_EVER, NULL));
    check_frame(6);
    bhr_job_cancel(jobs[6]); /* too late */
    CHECK_OK(bhr_job_wait(jobs[6], 0, NULL));
    const BhrStatus cancelled = bhr_job_wait(jobs[2], FOR_EVER, NULL);
    CHECK(cancelled == BHR_ERROR_CANCELLED || cancelled == BHR_OK, "%s", bhr_status_name(cancelled));
    CHECK(bhr_job_wait(jobs[2], 0, NULL) == cancelled, "another status the second time");
    bhr_job_destroy(jobs[2]);
    poll_to_the_end(jobs[5]);
    check_frame(5);
    static const int left[] = {6, 5, 0, 3, 1};
    for (size_t i = 0; i < COUNT_OF(left); i++) {
        CHECK_OK(bhr_job_wait(jobs[left[i]], FOR_EVER, NULL));
        check_frame(left[i]);
        bhr_job_destroy(jobs[left[i]]);
    }
    bhr_job_cancel(NULL);
    bhr_job_destroy(NULL);
}

/* Frames that are rendered at once while jobs are under way do not disturb them, nor they it. */
static void beside_frames(BhrContext *context) {
    static unsigned char pixels[BYTES];
    const BhrImage       target = frame_of(pixels);
    BhrJob              *jobs[FLIGHT];
    submit_all(context, jobs);
    set_scene(context, 4);
    CHECK_OK(bhr_render_image(context, &target));
    CHECK(memcmp(pixels, expected[4], BYTES) == 0, "a frame beside jobs differs");
    for (int i = 0; i < FLIGHT; i++) {
        CHECK_OK(bhr_job_wait(jobs[i], FOR_EVER, NULL));
        check_frame(i);
        bhr_job_destroy(jobs[i]);
    }
}

/* ---- formats and layouts ---- */

/* Into the middle of a larger block: each row as bhr_render_image has it, every other byte as it was. */
static void check_layout(BhrContext *context, BhrFormat format, size_t padding, int flip, uint32_t flags) {
    const size_t   row = WIDTH * bytes_per_pixel(format), stride = row + padding;
    const size_t   needed = stride * (HEIGHT - 1) + row, margin = 64, bytes = needed + 2 * margin;
    unsigned char *first = malloc(bytes), *second = malloc(bytes);
    for (int async = 0; async <= 1; async++) {
        unsigned char *block = async ? second : first, *lowest = block + margin;
        memset(block, UNTOUCHED, bytes);
        BhrImage image = image_of(format, WIDTH, HEIGHT, flip ? lowest + stride * (HEIGHT - 1) : lowest, needed);
        image.row_stride = flip ? -(int64_t)stride : (int64_t)stride;
        image.flags = flags;
        if (async) {
            BhrJob *job = submit(context, &image);
            CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
            bhr_job_destroy(job);
        } else {
            CHECK_OK(bhr_render_image(context, &image));
        }
    }
    CHECK(memcmp(first, second, bytes) == 0, "format %d, padding %u, flip %d, flags %u: a job's block differs",
          (int)format, (unsigned)padding, flip, (unsigned)flags);
    CHECK(!all_untouched(second, bytes), "format %d: nothing was written", (int)format);
    free(first);
    free(second);
}

static void layouts(BhrContext *context) {
    static const BhrFormat formats[] = {BHR_FORMAT_RGBA8_SRGB, BHR_FORMAT_BGRA8_SRGB, BHR_FORMAT_RGBA16F,
                                        BHR_FORMAT_RGBA32F};
    set_scene(context, 1);
    for (size_t i = 0; i < COUNT_OF(formats); i++) {
        check_layout(context, formats[i], 0, 1, 0);
        check_layout(context, formats[i], i < 2 ? 7 : 12, 0, BHR_IMAGE_TRANSPARENT);
        check_layout(context, formats[i], i < 2 ? 1 : 4, 1, 0);
        check_layout(context, formats[i], i < 2 ? 3 : 8, 0, BHR_IMAGE_BOTTOM_UP);
    }
    CHECK_OK(bhr_set_view(context, BHR_VIEW_DEFLECTION));
    check_layout(context, BHR_FORMAT_R32F, 20, 1, 0);
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
}

/* ---- waiting ---- */

static void timeouts(BhrContext *context) {
    double  fraction = -1.0;
    BhrJob *job = submit_slow(context);
    CHECK(bhr_job_wait(job, 0, &fraction) == BHR_NOT_READY, "done at once");
    CHECK(fraction >= 0.0 && fraction < 1.0, "fraction %g", fraction);
    const double begin = seconds();
    CHECK(bhr_job_wait(job, 5000000, NULL) == BHR_NOT_READY, "done within 5 ms");
    CHECK(seconds() - begin >= 0.005, "5 ms were over after %g s", seconds() - begin);
    wait_for_a_part(job, 1e-6);
    end_slow(job);
    set_scene(context, 0);
    const BhrImage target = frame_of(got[0]);
    job = submit(context, &target);
    CHECK_OK(bhr_job_wait(job, FOR_EVER - 1, &fraction)); /* beyond what clocks can add */
    CHECK(fraction == 1.0, "fraction %g of a finished job", fraction);
    bhr_job_destroy(job);
}

typedef struct Waiter {
    BhrJob   *job;
    BhrStatus status;
    double    fraction;
} Waiter;

static void *wait_for_ever(void *argument) {
    Waiter *waiter = argument;
    waiter->status = bhr_job_wait(waiter->job, FOR_EVER, &waiter->fraction);
    return NULL;
}

static void start(pthread_t *thread, void *(*body)(void *), void *argument) {
    if (pthread_create(thread, NULL, body, argument) != 0) {
        CHECK(0, "cannot start a thread");
        exit(check_end());
    }
}

/* Two threads wait for one job that a third, this one, lets run or cancels. */
static void two_waiters(BhrContext *context) {
    for (int cancels = 0; cancels <= 1; cancels++) {
        BhrJob *ahead = submit_slow(context); /* keeps the other from being done before both wait */
        set_scene(context, 3);
        const BhrImage target = frame_of(got[3]);
        BhrJob        *job = submit(context, &target);
        Waiter         waiters[2] = {{job, -1000, -1.0}, {job, -1000, -1.0}};
        pthread_t      threads[2];
        for (int i = 0; i < 2; i++) {
            start(&threads[i], wait_for_ever, &waiters[i]);
        }
        pause_ms(20);
        if (cancels) {
            bhr_job_cancel(job);
        }
        end_slow(ahead);
        for (int i = 0; i < 2; i++) {
            pthread_join(threads[i], NULL);
            CHECK(waiters[i].status == (cancels ? BHR_ERROR_CANCELLED : BHR_OK), "waiter %d got %s", i,
                  bhr_status_name(waiters[i].status));
            CHECK(waiters[i].fraction == (cancels ? 0.0 : 1.0), "waiter %d heard %g", i, waiters[i].fraction);
        }
        if (!cancels) {
            check_frame(3);
        }
        bhr_job_destroy(job);
    }
}

/* ---- progress ---- */

typedef struct Progress {
    BhrContext *context;
    BhrJob     *job;
    pthread_t   thread; /* the waiter */
    int         calls, elsewhere, out_of_order;
    double      last;
    int         calls_back_in, cancels, answers_no;
} Progress;

static void call_back_in(const Progress *progress) {
    static unsigned char pixels[BYTES];
    const BhrImage       target = frame_of(pixels);
    BhrFrameStats        stats = {.struct_size = sizeof stats};
    BhrJob              *job = progress->job;
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_set_mass(progress->context, 3.0));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_render_image(progress->context, &target));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_render_image_async(progress->context, &target, &job));
    CHECK(job == NULL, "a job from inside a callback");
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_job_wait(progress->job, 0, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_job_stats(progress->job, &stats));
    check_mark_message();
    bhr_job_destroy(progress->job);
    CHECK(strstr(bhr_error_message(), "callback") != NULL, "bhr_job_destroy in a callback says: %s",
          bhr_error_message());
    check_mark_message();
    bhr_context_destroy(progress->context);
    CHECK(strstr(bhr_error_message(), "callback") != NULL, "bhr_context_destroy in a callback says: %s",
          bhr_error_message());
}

static int32_t on_progress(void *user, double fraction) {
    Progress *progress = user;
    progress->calls++;
    progress->elsewhere += !pthread_equal(pthread_self(), progress->thread);
    progress->out_of_order += !(fraction >= progress->last && fraction <= 1.0);
    progress->last = fraction;
    if (progress->calls_back_in) {
        call_back_in(progress);
    }
    if (progress->cancels) {
        bhr_job_cancel(progress->job);
    }
    return !progress->answers_no;
}

/* A job begun with `progress` listening; the context forgets it at once. */
static BhrJob *submit_heard(BhrContext *context, Progress *progress, int slow) {
    const BhrImage target = frame_of(got[0]);
    set_scene(context, 0);
    CHECK_OK(bhr_set_progress(context, on_progress, progress));
    progress->context = context;
    progress->thread = pthread_self();
    progress->job = slow ? submit_slow(context) : submit(context, &target);
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
    return progress->job;
}

static void *wait_as_listener(void *argument) {
    Progress *progress = argument;
    progress->thread = pthread_self();
    CHECK_OK(bhr_job_wait(progress->job, FOR_EVER, NULL));
    return NULL;
}

static void progress_is_heard(BhrContext *context) {
    Progress  progress = {0};
    pthread_t thread;
    double    m, a, axis[3];
    BhrJob   *job = submit_heard(context, &progress, 0);
    pause_ms(10);
    CHECK(progress.calls == 0, "%d calls outside of bhr_job_wait", progress.calls);
    progress.calls_back_in = 1;
    start(&thread, wait_as_listener, &progress);
    pthread_join(thread, NULL);
    CHECK(progress.calls > 0 && progress.elsewhere == 0, "%d calls, %d on another thread than the waiter's",
          progress.calls, progress.elsewhere);
    CHECK(progress.out_of_order == 0 && progress.last == 1.0, "%d out of order, the last %g", progress.out_of_order,
          progress.last);
    check_frame(0);
    CHECK_OK(bhr_get_hole(context, &m, &a, axis));
    CHECK(m == 1.0, "a refused call set the mass to %g", m);
    bhr_job_destroy(job);
}

static void progress_cancels(BhrContext *context) {
    for (int by_answer = 0; by_answer <= 1; by_answer++) {
        Progress progress = {.cancels = !by_answer, .answers_no = by_answer};
        BhrJob  *job = submit_heard(context, &progress, 1);
        CHECK_FAILS(BHR_ERROR_CANCELLED, "cancel", bhr_job_wait(job, FOR_EVER, NULL));
        CHECK(progress.calls > 0 && progress.elsewhere == 0, "%d calls, %d elsewhere", progress.calls,
              progress.elsewhere);
        CHECK(progress.last < 1.0, "the last word of a cancelled job is %g", progress.last);
        bhr_job_destroy(job);
    }
}

/* ---- targets ---- */

/* The pixels of a frame that was stopped, against the whole one: `finished`, `untouched` or `other`. */
typedef struct Outcome {
    size_t finished, untouched, other;
} Outcome;

static Outcome compare(const unsigned char *part, const unsigned char *whole, size_t pixels) {
    Outcome outcome = {0, 0, 0};
    for (size_t i = 0; i < pixels; i++) {
        if (whole != NULL && memcmp(part + 4 * i, whole + 4 * i, 4) == 0) {
            outcome.finished++;
        } else if (all_untouched(part + 4 * i, 4)) {
            outcome.untouched++;
        } else {
            outcome.other++;
        }
    }
    return outcome;
}

/* Nothing is written after the destroy call, however far the job was. */
static void destroy_while_running(BhrContext *context, int small) {
    static const double parts[] = {0.0, 1e-6, 0.01};
    for (size_t i = 0; i < COUNT_OF(parts) - (small ? 1 : 0); i++) {
        BhrJob *job = submit_slow(context);
        if (parts[i] > 0.0) {
            wait_for_a_part(job, parts[i]);
        }
        bhr_job_destroy(job);
        memset(slow_pixels, UNTOUCHED, sizeof slow_pixels);
        pause_ms(60);
        CHECK(all_untouched(slow_pixels, sizeof slow_pixels), "written to after the job was destroyed");
    }
}

/* Jobs that have not begun end at once when they are cancelled or destroyed: the one before them goes on. */
static void end_queued(BhrContext *context) {
    double         fraction = 0.0;
    const BhrImage target = frame_of(got[0]);
    BhrJob        *slow = submit_slow(context);
    wait_for_a_part(slow, 1e-6);
    memset(got[0], UNTOUCHED, BYTES);
    BhrJob *jobs[3] = {submit(context, &target), submit(context, &target), submit(context, &target)};
    bhr_job_destroy(jobs[1]);
    bhr_job_cancel(jobs[0]);
    CHECK_FAILS(BHR_ERROR_CANCELLED, "cancel", bhr_job_wait(jobs[0], FOR_EVER, NULL));
    bhr_job_destroy(jobs[2]);
    bhr_job_destroy(jobs[0]);
    CHECK(bhr_job_wait(slow, 0, &fraction) == BHR_NOT_READY, "the end of queued jobs waited for the job before them");
    CHECK(all_untouched(got[0], BYTES), "a job that never began wrote into its target");
    end_slow(slow);
}

/* A large frame, cancelled at about a third: every pixel is either finished or untouched. */
static void cancel_large(BhrContext *context) {
    enum { LARGE_WIDTH = 2000, LARGE_HEIGHT = 1500 };
    const size_t   pixels = (size_t)LARGE_WIDTH * LARGE_HEIGHT;
    unsigned char *whole = malloc(4 * pixels), *part = malloc(4 * pixels);
    BhrImage       target = image_of(BHR_FORMAT_RGBA8_SRGB, LARGE_WIDTH, LARGE_HEIGHT, whole, 4 * pixels);
    set_scene(context, 2);
    BhrJob *job = submit(context, &target);
    CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
    bhr_job_destroy(job);

    memset(part, UNTOUCHED, 4 * pixels);
    target.pixels = part;
    job = submit(context, &target);
    double    fraction = 0.0;
    BhrStatus status;
    do {
        status = bhr_job_wait(job, 100000, &fraction);
    } while (status == BHR_NOT_READY && fraction < 0.3);
    bhr_job_cancel(job);
    check_mark_message();
    status = bhr_job_wait(job, FOR_EVER, NULL);
    const Outcome outcome = compare(part, whole, pixels);
    CHECK(outcome.other == 0, "%u pixels are neither finished nor untouched", (unsigned)outcome.other);
    if (status == BHR_OK) { /* a fast device, in few pieces */
        CHECK(outcome.finished == pixels, "%u pixels of a finished job are not", (unsigned)outcome.untouched);
    } else {
        check_fails(status, BHR_ERROR_CANCELLED, "part of the target has been written", __FILE__, __LINE__, "wait");
        CHECK(outcome.finished > 0 && outcome.untouched > 0, "%u pixels finished, %u untouched",
              (unsigned)outcome.finished, (unsigned)outcome.untouched);
    }
    bhr_job_destroy(job);
    free(whole);
    free(part);
}

/* ---- how many ---- */

static void too_many(BhrContext *context) {
    static unsigned char pixels[MAX_JOBS][16 * 16 * 4];
    BhrJob              *jobs[MAX_JOBS], *refused = (BhrJob *)&refused;
    set_scene(context, 0);
    CHECK_OK(bhr_set_region(context, NULL));
    jobs[0] = submit_slow(context);
    for (int i = 1; i < MAX_JOBS; i++) {
        const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels[i], sizeof pixels[i]);
        jobs[i] = submit(context, &target);
    }
    memset(pixels[0], UNTOUCHED, sizeof pixels[0]);
    const BhrImage target = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels[0], sizeof pixels[0]);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "64", bhr_render_image_async(context, &target, &refused));
    CHECK(refused == NULL, "a refused job is not NULL");
    bhr_job_cancel(jobs[0]);
    CHECK_OK(bhr_job_wait(jobs[1], FOR_EVER, NULL));
    CHECK(all_untouched(pixels[0], sizeof pixels[0]), "a refused job's target was written");
    refused = submit(context, &target); /* there is room again */
    CHECK_OK(bhr_job_wait(refused, FOR_EVER, NULL));
    bhr_job_destroy(refused);
    for (int i = 0; i < MAX_JOBS; i++) {
        if (i > 0) {
            CHECK_OK(bhr_job_wait(jobs[i], FOR_EVER, NULL));
            CHECK(memcmp(pixels[i], pixels[0], sizeof pixels[0]) == 0, "job %d of the same scene differs", i);
        }
        bhr_job_destroy(jobs[i]);
    }
}

/* ---- contexts end ---- */

static int32_t count_call(void *user, double fraction) {
    (void)fraction;
    ++*(int *)user;
    return 1;
}

static void count_message(void *user, BhrLogLevel level, const char *message) {
    (void)level;
    (void)message;
    ++*(int *)user;
}

/* The end of a context leaves its jobs done, with their pixels, numbers and failures, and silences both callbacks. */
static void outlive_context(BhrBackend backend) {
    BhrContextOptions options;
    BhrContext       *context = NULL;
    BhrFrameStats     stats = {.struct_size = sizeof stats};
    int               calls = 0, messages = 0;
    CHECK_OK(bhr_context_options_init(&options, sizeof options));
    options.backend = backend;
    options.log_level = BHR_LOG_ERROR;
    options.log_fn = count_message;
    options.log_user = &messages;
    if (!CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &context))) {
        return;
    }
    check_set_sky(context);
    const BhrImage target = frame_of(got[1]);
    memset(got, UNTOUCHED, sizeof got);
    set_scene(context, 1);
    CHECK_OK(bhr_set_progress(context, count_call, &calls));
    BhrJob *slow = submit_slow(context), *job = submit(context, &target);
    bhr_job_cancel(slow);
    bhr_context_destroy(context);
    check_frame(1);
    messages = 0;
    CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
    CHECK(calls == 0, "%d words of progress after the context's end", calls);
    CHECK_OK(bhr_job_stats(job, &stats));
    CHECK(stats.rays == WIDTH * HEIGHT && stats.frame_index == 1, "%u rays, frame %u", (unsigned)stats.rays,
          (unsigned)stats.frame_index);
    CHECK_FAILS(BHR_ERROR_CANCELLED, "cancel", bhr_job_wait(slow, 0, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "", bhr_job_stats(slow, &stats));
    CHECK(messages == 0, "%d messages in the log of a context that is gone", messages);
    bhr_job_destroy(job);
    bhr_job_destroy(slow);
}

/* A context ends while a thread waits for one of its jobs. */
static void end_beside_waiter(BhrBackend backend) {
    BhrContext *context = check_context(backend);
    set_scene(context, 2);
    const BhrImage target = frame_of(got[2]);
    BhrJob        *slow = submit_slow(context), *job = submit(context, &target);
    Waiter         waiter = {job, -1000, -1.0};
    pthread_t      thread;
    start(&thread, wait_for_ever, &waiter);
    pause_ms(10);
    bhr_job_cancel(slow);
    bhr_context_destroy(context);
    pthread_join(thread, NULL);
    CHECK(waiter.status == BHR_OK, "the waiter got %s", bhr_status_name(waiter.status));
    check_frame(2);
    bhr_job_destroy(slow);
    bhr_job_destroy(job);
}

/* ---- numbers ---- */

static void numbers(BhrContext *context) {
    BhrFrameStats  before = {.struct_size = sizeof before}, stats = {.struct_size = sizeof stats}, frame = stats;
    BhrFrameStats  small = {.struct_size = 4};
    const BhrImage target = frame_of(got[0]);
    set_scene(context, 0);
    CHECK_OK(bhr_frame_stats(context, &before));
    BhrJob *slow = submit_slow(context);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "done|running|finished", bhr_job_stats(slow, &stats));
    end_slow(slow);
    CHECK_OK(bhr_frame_stats(context, &stats));
    CHECK(memcmp(&before, &stats, sizeof stats) == 0, "a cancelled job counts as a finished frame");
    set_quality(context, BHR_METHOD_RK4, 4);
    const double begin = seconds();
    BhrJob      *job = submit(context, &target);
    CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
    const double lasted = seconds() - begin;
    CHECK_OK(bhr_job_stats(job, &stats));
    CHECK_OK(bhr_frame_stats(context, &frame));
    CHECK(memcmp(&frame, &stats, sizeof stats) == 0, "the context's last frame has other numbers than the last job");
    CHECK(stats.frame_index == before.frame_index + 1, "frame %u after %u", (unsigned)stats.frame_index,
          (unsigned)before.frame_index);
    CHECK(stats.rays == 4 * WIDTH * HEIGHT && stats.steps > stats.rays, "%u rays, %u steps", (unsigned)stats.rays,
          (unsigned)stats.steps);
    CHECK(stats.cpu_ns > 0 && (double)stats.cpu_ns * 1e-9 <= lasted, "%g s of %g s",
          (double)stats.cpu_ns * 1e-9, lasted);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "stats", bhr_job_stats(job, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_job_stats(job, &small));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "job", bhr_job_stats(NULL, &stats));
    bhr_job_destroy(job);
    set_quality(context, BHR_METHOD_AUTO, 1);
}

/* ---- bad calls ---- */

/* A job that is refused, at once or when it is waited for, with the status that bhr_render_image has. */
static void check_refused(BhrContext *context, const BhrImage *target, BhrStatus status, const char *words) {
    BhrJob *job = (BhrJob *)&job;
    CHECK_FAILS(status, words, bhr_render_image(context, target));
    check_mark_message();
    BhrStatus got_status = bhr_render_image_async(context, target, &job);
    if (got_status == BHR_OK) {
        check_mark_message();
        got_status = bhr_job_wait(job, FOR_EVER, NULL);
    } else {
        CHECK(job == NULL, "a refused job is not NULL");
        job = NULL;
    }
    check_fails(got_status, status, words, __FILE__, __LINE__, "a job");
    bhr_job_destroy(job);
}

static void bad_calls(BhrContext *context) {
    static unsigned char pixels[WIDTH * HEIGHT * 16];
    BhrImage             target = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES), bad = target;
    BhrJob              *job = (BhrJob *)&job;
    memset(pixels, UNTOUCHED, sizeof pixels);
    set_scene(context, 0);
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_render_image_async(NULL, &target, &job));
    CHECK(job == NULL, "a job without a context");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_job", bhr_render_image_async(context, &target, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "target", bhr_render_image_async(context, NULL, &job));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "job", bhr_job_wait(NULL, 0, NULL));
    bad.width = 0;
    check_refused(context, &bad, BHR_ERROR_INVALID_ARGUMENT, "width");
    bad = target;
    bad.byte_size = BYTES - 1;
    check_refused(context, &bad, BHR_ERROR_INVALID_ARGUMENT, "byte_size");
    bad = target;
    bad.format = 99;
    check_refused(context, &bad, BHR_ERROR_INVALID_ARGUMENT, "format");
    bad = target;
    bad.row_stride = 3;
    check_refused(context, &bad, BHR_ERROR_INVALID_ARGUMENT, "stride");
    bad = target;
    bad.pixels = NULL;
    check_refused(context, &bad, BHR_ERROR_INVALID_ARGUMENT, "pixels");
    bad = image_of(BHR_FORMAT_R32F, WIDTH, HEIGHT, pixels, BYTES);
    check_refused(context, &bad, BHR_ERROR_INVALID_ARGUMENT, "R32F");
    CHECK_OK(bhr_set_view(context, BHR_VIEW_STEPS));
    bad = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, pixels, sizeof pixels);
    check_refused(context, &bad, BHR_ERROR_INVALID_ARGUMENT, "RGBA32F|Rgba32F");
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    const BhrRegion region = {.struct_size = sizeof region, .full_width = WIDTH, .full_height = HEIGHT, .x = 1};
    CHECK_OK(bhr_set_region(context, &region));
    check_refused(context, &target, BHR_ERROR_INVALID_ARGUMENT, "region|frame");
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK(all_untouched(pixels, sizeof pixels), "a refused job wrote into its target");
}

/* Scenes that no frame can be made of, and one that can right after. */
static void impossible_scenes(BhrContext *context) {
    static unsigned char pixels[BYTES];
    const BhrImage       target = frame_of(pixels);
    BhrCamera            camera = {.struct_size = sizeof camera};
    memset(pixels, UNTOUCHED, sizeof pixels);
    set_scene(context, 0);
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK_OK(bhr_get_camera(context, &camera));
    camera.position[0] = 1.5;
    camera.position[1] = camera.position[2] = 0.0;
    CHECK_OK(bhr_set_camera(context, &camera)); /* static, inside the horizon */
    check_refused(context, &target, BHR_ERROR_INVALID_STATE, "horizon|STATIC|static");
    CHECK_OK(bhr_set_spin(context, 0.9));
    camera.position[0] = 1.2;
    camera.motion = BHR_MOTION_FREE_FALL;
    CHECK_OK(bhr_set_camera(context, &camera));
    check_refused(context, &target, BHR_ERROR_UNSUPPORTED, "horizon");
    CHECK(all_untouched(pixels, sizeof pixels), "an impossible job wrote into its target");
    set_scene(context, 1);
    BhrJob *job = submit(context, &target);
    CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
    CHECK(memcmp(pixels, expected[1], BYTES) == 0, "a job after an impossible one differs");
    bhr_job_destroy(job);
}

/* ---- the host's thread is free ---- */

/* All that a host does between two frames is done while a slow job runs, which is still running afterwards. */
static void nothing_waits(BhrContext *context) {
    static BhrRay rays[32 * 24];
    BhrJob       *jobs[FLIGHT];
    double        m, a, axis[3], fraction = 0.0;
    BhrFrameStats stats = {.struct_size = sizeof stats};
    BhrJob       *slow = submit_slow(context);
    wait_for_a_part(slow, 1e-6);
    for (int i = 0; i < FLIGHT; i++) {
        const BhrImage target = frame_of(got[i]);
        set_scene(context, i);
        CHECK_OK(bhr_get_hole(context, &m, &a, axis));
        CHECK_OK(bhr_camera_rays(context, 32, 24, rays));
        CHECK_OK(bhr_frame_stats(context, &stats));
        jobs[i] = submit(context, &target);
        CHECK(bhr_job_wait(jobs[i], 0, &fraction) == BHR_NOT_READY && fraction == 0.0,
              "a job that cannot have begun is at %g", fraction);
        bhr_job_cancel(jobs[i]);
    }
    CHECK(bhr_job_wait(slow, 0, &fraction) == BHR_NOT_READY, "the calls waited until the job was done");
    end_slow(slow);
    for (int i = 0; i < FLIGHT; i++) {
        CHECK_FAILS(BHR_ERROR_CANCELLED, "cancel", bhr_job_wait(jobs[i], FOR_EVER, NULL));
        bhr_job_destroy(jobs[i]);
    }
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    const int        brief = argc > 2 && strcmp(argv[2], "brief") == 0;
    const int        small = brief || (argc > 2 && strcmp(argv[2], "small") == 0);
    BhrContext      *context = check_context(backend);
    if (small) {
        slow_samples = 16; /* slow enough there */
    }
    render_expected(context);
    if (brief) {
        progress_is_heard(context);
        progress_cancels(context);
        destroy_while_running(context, small);
        outlive_context(backend);
        end_beside_waiter(backend);
        bhr_context_destroy(context);
        return check_end();
    }
    snapshots(context);
    mixed_ends(context);
    beside_frames(context);
    layouts(context);
    timeouts(context);
    two_waiters(context);
    progress_is_heard(context);
    progress_cancels(context);
    destroy_while_running(context, small);
    end_queued(context);
    if (!small) {
        cancel_large(context);
    }
    too_many(context);
    outlive_context(backend);
    end_beside_waiter(backend);
    numbers(context);
    bad_calls(context);
    impossible_scenes(context);
    nothing_waits(context);
    bhr_context_destroy(context);
    return check_end();
}
