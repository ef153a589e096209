/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* job_ends.c -- how jobs end while the host goes on: waits end in time, on several threads too; progress is heard by
 * the waiter and may cancel; a target is left alone once its job is gone; jobs outlive their context; and no call waits
 * for a job but those that say so. The frames of jobs are in jobs.c.
 *
 * A second argument "small" is for valgrind: it leaves out what takes long there. */
#include "check.h"
#include "job_scenes.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* ---- waiting ---- */

static void timeouts(BhrContext *context) {
    double  fraction = -1.0;
    BhrJob *job = submit_slow(context);
    CHECK(bhr_job_wait(job, 0, &fraction) == BHR_NOT_READY, "done at once");
    CHECK(fraction >= 0.0 && fraction < 1.0, "fraction %g", fraction);
    const double begin = seconds_now();
    CHECK(bhr_job_wait(job, 5000000, NULL) == BHR_NOT_READY, "done within 5 ms");
    CHECK(seconds_now() - begin >= 0.005, "5 ms were over after %g s", seconds_now() - begin);
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

static int32_t hear_between(void *user, double fraction) {
    *(int *)user += fraction > 0.0 && fraction < 1.0;
    return 1;
}

/* A frame of one tile is heard of between its begin and its end: once in a while, as the waiter may sleep so long. */
static void small_job_is_heard_of(BhrContext *context) {
    enum { SIDE = 12, MOST = 200 };
    static unsigned char pixels[SIDE * SIDE * 4];
    const BhrImage       target = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    int                  heard = 0;
    CHECK_OK(bhr_set_progress(context, hear_between, &heard));
    for (int i = 0; i < MOST && heard == 0; i++) {
        BhrJob *job = submit(context, &target);
        CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
        bhr_job_destroy(job);
    }
    CHECK(heard > 0, "of %d jobs only begin and end were heard", MOST);
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
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

/* No pixel is written after the destroy call, however far the job was. */
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
    const uint32_t width = check_runs_all() ? 2000 : 1000, height = width / 4 * 3;
    const size_t   pixels = (size_t)width * height;
    unsigned char *whole = malloc(4 * pixels), *part = malloc(4 * pixels);
    BhrImage       target = image_of(BHR_FORMAT_RGBA8_SRGB, width, height, whole, 4 * pixels);
    set_scene(context, 2);
    BhrJob *job = submit(context, &target);
    CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
    bhr_job_destroy(job);

    memset(part, UNTOUCHED, 4 * pixels);
    target.pixels = part;
    job = submit(context, &target);
    double    fraction = 0.0;
    BhrStatus status;
    /* Up to 0.5 it may be of pixels that are only submitted. */
    do {
        status = bhr_job_wait(job, 100000, &fraction);
    } while (status == BHR_NOT_READY && fraction < 0.55);
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
    BhrContextOptions options = check_options(backend);
    BhrFrameStats     stats = {.struct_size = sizeof stats};
    int               calls = 0, messages = 0;
    options.log_level = BHR_LOG_ERROR;
    options.log_fn = count_message;
    options.log_user = &messages;
    BhrContext    *context = check_context_with(&options);
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
    set_scene(context, 1);
    const BhrImage target = frame_of(got[1]);
    BhrJob        *slow = submit_slow(context), *job = submit(context, &target);
    Waiter         waiter = {job, -1000, -1.0};
    pthread_t      thread;
    start(&thread, wait_for_ever, &waiter);
    pause_ms(10);
    bhr_job_cancel(slow);
    bhr_context_destroy(context);
    pthread_join(thread, NULL);
    CHECK(waiter.status == BHR_OK, "the waiter got %s", bhr_status_name(waiter.status));
    check_frame(1);
    bhr_job_destroy(slow);
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
    const int        small = argc > 2 && strcmp(argv[2], "small") == 0;
    BhrContext      *context = check_context(backend);
    if (small) {
        slow_samples = 16;
    }
    render_expected(context, FLIGHT);
    timeouts(context);
    two_waiters(context);
    progress_is_heard(context);
    small_job_is_heard_of(context);
    progress_cancels(context);
    destroy_while_running(context, small);
    end_queued(context);
    if (!small) {
        cancel_large(context);
    }
    outlive_context(backend);
    end_beside_waiter(backend);
    nothing_waits(context);
    bhr_context_destroy(context);
    return check_end();
}
