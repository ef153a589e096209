/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* callbacks.c -- the host's functions that the library calls: progress that watches, cancels or calls back in, and
 * the log. A refused call from inside leaves the frame in progress and the context as they were.
 *
 * A second argument "brief" is for valgrind: it leaves out large frames and frames of many samples. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- progress ---- */

typedef struct Progress {
    BhrContext *context;
    int         calls;
    double      last;         /* fraction heard last; -1: none yet */
    int         out_of_order; /* a fraction below the one before, or not in 0 .. 1 */
    double      inside;       /* a fraction strictly between 0 and 1 that was heard; 0: none */
    double      cancel_at;    /* cancels at the first fraction that is as large; > 1: never */
    double      cancelled_at;
    int         call_back_in; /* tries the API at every call */
} Progress;

/* Every call on the context whose frame is in progress is refused, whatever it is. */
static void call_back_in(BhrContext *context) {
    static unsigned char pixels[64];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 4, 4, pixels, sizeof pixels);
    const BhrRay         ray = {{30.0, 0.0, 4.0}, {-1.0, 0.0, 0.0}, 1.0};
    BhrHit               hit;
    BhrCamera            camera = {.struct_size = sizeof camera};
    BhrFrameStats        stats = {.struct_size = sizeof stats};
    BhrHoleInfo          info = {.struct_size = sizeof info};
    double               m, a, axis[3];
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_set_mass(context, 3.0));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_get_hole(context, &m, &a, axis));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_get_camera(context, &camera));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_hole_info(context, &info));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_render_image(context, &image));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_trace_rays(context, &ray, sizeof ray, 1, &hit, sizeof hit));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_set_progress(context, NULL, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_frame_stats(context, &stats));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "callback", bhr_context_recover(context));
}

static int32_t on_progress(void *user, double fraction) {
    Progress *progress = user;
    progress->calls++;
    if (!(fraction >= 0.0 && fraction <= 1.0) || fraction < progress->last) {
        progress->out_of_order++;
    }
    progress->last = fraction;
    if (fraction > 0.0 && fraction < 1.0) {
        progress->inside = fraction;
    }
    if (progress->call_back_in) {
        call_back_in(progress->context);
    }
    if (fraction >= progress->cancel_at) {
        progress->cancelled_at = fraction;
        return 0;
    }
    return 1;
}

static Progress silent_progress(BhrContext *context) {
    const Progress progress = {context, 0, -1.0, 0, 0.0, 2.0, -1.0, 0};
    return progress;
}

static void progress_from_inside(BhrContext *context) {
    Watch    watch;
    Progress progress = silent_progress(context);
    watch_begin(&watch, context);
    progress.call_back_in = 1;
    CHECK_OK(bhr_set_progress(context, on_progress, &progress));
    check_unchanged(&watch, __FILE__, __LINE__, "a frame whose callback calls back in");
    CHECK(progress.calls > 0, "the callback was not called");
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
    progress.calls = 0;
    check_unchanged(&watch, __FILE__, __LINE__, "a frame without a callback");
    CHECK(progress.calls == 0, "a callback that was taken away was called");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_progress(NULL, on_progress, &progress));
}

/* The pixels of a cancelled frame: how many are finished, untouched, or neither. */
typedef struct Outcome {
    size_t finished, untouched, other;
} Outcome;

static Outcome compare(const unsigned char *part, const unsigned char *whole, uint32_t size, size_t stride) {
    Outcome outcome = {0, 0, 0};
    for (uint32_t y = 0; y < size; y++) {
        for (uint32_t x = 0; x < size; x++) {
            const size_t at = y * stride + x * 4;
            if (memcmp(part + at, whole + at, 4) == 0) {
                outcome.finished++;
            } else if (all_untouched(part + at, 4)) {
                outcome.untouched++;
            } else {
                outcome.other++;
            }
        }
        CHECK(all_untouched(part + y * stride + size * 4, stride - size * 4), "padding of row %u written", (unsigned)y);
    }
    return outcome;
}

/* Renders into `whole`, then again into `part`, cancelling in the middle; in `tests/run all` then to the end. Every
 * pixel of the cancelled frame must be that of the whole frame or untouched. 0 when the frame is too small to be
 * cancelled between two of its pieces. */
static int cancel_halfway(BhrContext *context, uint32_t size, unsigned char *whole, unsigned char *part) {
    const size_t stride = (size_t)size * 4 + 12, bytes = stride * size;
    BhrImage     image = image_of(BHR_FORMAT_RGBA8_SRGB, size, size, whole, bytes);
    Progress     progress = silent_progress(context);
    image.row_stride = (int64_t)stride;
    CHECK_OK(bhr_set_progress(context, on_progress, &progress));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(progress.out_of_order == 0, "fractions out of order or out of range at size %u", (unsigned)size);
    CHECK(progress.last == 1.0, "the last fraction is %g", progress.last);
    if (progress.inside == 0.0) {
        return 0;
    }

    memset(part, UNTOUCHED, bytes);
    image.pixels = part;
    progress = silent_progress(context);
    progress.cancel_at = 0.4;
    CHECK_FAILS(BHR_ERROR_CANCELLED, "cancel", bhr_render_image(context, &image));
    CHECK(progress.last == progress.cancelled_at && progress.last < 1.0, "cancelled at %g, went on to %g",
          progress.cancelled_at, progress.last);
    const Outcome outcome = compare(part, whole, size, stride);
    CHECK(outcome.other == 0, "%u pixels are neither finished nor untouched", (unsigned)outcome.other);
    if (outcome.finished == 0) {
        return 0;
    }
    /* Progress says how much there is, to a piece or two. */
    const double finished = (double)outcome.finished / ((double)size * size);
    CHECK(finished > 0.1 && finished < 0.9, "cancelled at %g, but a part of %g was finished", progress.cancelled_at,
          finished);

    if (check_runs_all()) {
        progress = silent_progress(context);
        CHECK_OK(bhr_render_image(context, &image));
        CHECK(compare(part, whole, size, stride).finished == (size_t)size * size, "a frame after a cancelled one");
    }
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
    return 1;
}

/* A tracer may finish small frames in one piece, so the size grows until there is a middle. After that the context
 * renders as before. */
static void cancel_in_the_middle(BhrContext *context) {
    enum { LARGEST = 4096 };
    const size_t   bytes = (size_t)LARGEST * (LARGEST * 4 + 12);
    unsigned char *whole = malloc(bytes), *part = malloc(bytes);
    uint32_t       size = 256;
    Watch          watch;
    watch_begin(&watch, context);
    while (size <= LARGEST && !cancel_halfway(context, size, whole, part)) {
        size *= check_runs_all() ? 2 : LARGEST / 256; /* lavapipe finishes 3072 x 3072 in one piece */
    }
    check_unchanged(&watch, __FILE__, __LINE__, "a frame after a cancelled one");
    CHECK(size <= LARGEST, "no frame up to %d x %d can be cancelled halfway", LARGEST, LARGEST);
    free(whole);
    free(part);
}

/* Cancelled at the first word: nothing more is heard, and the numbers about the last frame stay. A frame that is done
 * in one piece may have no word before its last one, 1, which comes too late to cancel. */
static void cancel_at_once(BhrContext *context) {
    static unsigned char pixels[16 * 16 * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels, sizeof pixels);
    BhrFrameStats        before = {.struct_size = sizeof before}, after = {.struct_size = sizeof after};
    Progress             progress = silent_progress(context);
    progress.cancel_at = 0.0;
    memset(pixels, UNTOUCHED, sizeof pixels);
    CHECK_OK(bhr_frame_stats(context, &before));
    CHECK_OK(bhr_set_progress(context, on_progress, &progress));
    check_mark_message();
    const BhrStatus status = bhr_render_image(context, &image);
    CHECK(progress.calls == 1, "called %d times although it cancelled", progress.calls);
    if (progress.cancelled_at == 1.0) {
        CHECK(status == BHR_OK, "a finished frame gives %s", bhr_status_name(status));
        CHECK_OK(bhr_set_progress(context, NULL, NULL));
        return;
    }
    check_fails(status, BHR_ERROR_CANCELLED, "cancel", __FILE__, __LINE__, "bhr_render_image");
    CHECK(progress.cancelled_at > 0.0 || all_untouched(pixels, sizeof pixels), "cancelled at 0, yet pixels changed");
    CHECK_OK(bhr_frame_stats(context, &after));
    CHECK(memcmp(&before, &after, sizeof before) == 0, "a cancelled frame counts as the last finished one");
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
}

/* ---- the log ---- */

typedef struct Log {
    BhrContext *context;
    int         messages, destroyed, after_destroy, empty, level_out_of_range;
    BhrLogLevel limit;
} Log;

static void on_log(void *user, BhrLogLevel level, const char *message) {
    Log *log = user;
    log->messages++;
    log->after_destroy += log->destroyed;
    log->empty += message == NULL || message[0] == '\0';
    log->level_out_of_range += level < BHR_LOG_ERROR || level > log->limit;
    if (log->context != NULL) {
        const BhrStatus status = bhr_set_mass(log->context, 3.0);
        CHECK(status == BHR_ERROR_INVALID_STATE, "a log callback that calls back in got %s", bhr_status_name(status));
    }
}

static void check_log(BhrBackend backend, BhrLogLevel level, int expects_messages) {
    static unsigned char pixels[16 * 16 * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels, sizeof pixels);
    Log                  log = {NULL, 0, 0, 0, 0, 0, level};
    BhrContextOptions    options = check_options(backend);
    options.log_level = level;
    options.log_fn = on_log;
    options.log_user = &log;
    BhrContext *context = check_context_with(&options);
    log.context = context;
    CHECK_OK(bhr_render_image(context, &image));
    double m = 0.0, a = 0.0, axis[3];
    CHECK_OK(bhr_get_hole(context, &m, &a, axis));
    CHECK(m == 1.0, "the log callback set the mass to %g", m);
    bhr_context_destroy(context);
    log.context = NULL;
    log.destroyed = 1;
    /* Another context's work must not reach a destroyed context's log. */
    context = check_context(backend);
    CHECK_OK(bhr_render_image(context, &image));
    bhr_context_destroy(context);
    CHECK(log.after_destroy == 0, "%d messages after the context was destroyed", log.after_destroy);
    CHECK(log.empty == 0, "%d empty messages", log.empty);
    CHECK(log.level_out_of_range == 0, "%d messages above level %d", log.level_out_of_range, (int)level);
    CHECK(!expects_messages || log.messages > 0, "no message at level %d", (int)level);
    CHECK(level != BHR_LOG_OFF || log.messages == 0, "%d messages although the log is off", log.messages);
}

/* A cancel is the host's own wish: no error in the log, but a line for those who want to know. */
static void check_log_of_cancel(BhrBackend backend, BhrLogLevel level, int expected) {
    enum { SIDE = 16 };
    static unsigned char pixels[SIDE * SIDE * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    Log                  log = {NULL, 0, 0, 0, 0, 0, level};
    Progress             progress = silent_progress(NULL);
    BhrContextOptions    options = check_options(backend);
    options.log_level = level;
    options.log_fn = on_log;
    options.log_user = &log;
    BhrContext *context = check_context_with(&options);
    progress.cancel_at = 0.0;
    CHECK_OK(bhr_set_progress(context, on_progress, &progress));
    const int before = log.messages;
    const BhrStatus status = bhr_render_image(context, &image);
    CHECK(status == BHR_ERROR_CANCELLED, "%s", bhr_status_name(status));
    CHECK(log.messages == before + expected, "%d messages about a cancel at level %d", log.messages - before,
          (int)level);
    bhr_context_destroy(context);
}

/* Software takes long for a sample: a frame that is cancelled ends after the next one, whatever its number. */
static void software_asks_after_each_sample(BhrContext *context) {
    enum { SIDE = 64, SAMPLES = 12 };
    static unsigned char pixels[SIDE * SIDE * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    Progress             progress = silent_progress(context);
    BhrAdapterInfo       adapter;
    BhrQuality           quality;
    adapter.struct_size = sizeof adapter;
    CHECK_OK(bhr_context_adapter(context, &adapter));
    CHECK_OK(bhr_quality_init(&quality, sizeof quality));
    quality.samples_per_pixel = SAMPLES;
    CHECK_OK(bhr_set_quality(context, &quality));
    CHECK_OK(bhr_set_progress(context, on_progress, &progress));
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(!(adapter.flags & BHR_ADAPTER_SOFTWARE) || progress.calls >= SAMPLES, "%d calls for %d samples",
          progress.calls, SAMPLES);
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    const int        brief = argc > 2 && strcmp(argv[2], "brief") == 0;
    BhrContext      *context = check_context(backend);
    progress_from_inside(context);
    cancel_at_once(context);
    if (!brief) {
        cancel_in_the_middle(context);
        software_asks_after_each_sample(context);
    }
    bhr_context_destroy(context);
    check_log(backend, BHR_LOG_OFF, 0);
    if (check_runs_all()) { /* the levels between the least and the most */
        check_log(backend, BHR_LOG_ERROR, 0);
        check_log(backend, BHR_LOG_INFO, 0);
    }
    check_log(backend, BHR_LOG_TRACE, backend == BHR_BACKEND_VULKAN); /* wgpu always has something to say */
    check_log_of_cancel(backend, BHR_LOG_WARN, 0);
    check_log_of_cancel(backend, BHR_LOG_INFO, 1);
    return check_end();
}
