/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* jobs.c -- frames in the background: every job shows the scene as it was when the job was begun, whatever is set,
 * waited for, cancelled or destroyed meanwhile and in whatever order; in every layout of a target; with its own
 * numbers; as many as a context may have; and a refused job changes nothing. The ends of jobs are in job_ends.c.
 *
 * A second argument, "small", leaves out what takes long under valgrind. */
#include "check.h"
#include "job_scenes.h"

#include <stdlib.h>
#include <string.h>

#define MAX_JOBS 64 /* unfinished ones of a context, by the header */

/* ---- snapshots ---- */

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
    const double begin = seconds_now();
    BhrJob      *job = submit(context, &target);
    CHECK_OK(bhr_job_wait(job, FOR_EVER, NULL));
    const double lasted = seconds_now() - begin;
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

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    if (argc > 2 && strcmp(argv[2], "small") == 0) {
        slow_samples = 16;
    }
    render_expected(context, FLIGHT);
    snapshots(context);
    mixed_ends(context);
    beside_frames(context);
    layouts(context);
    too_many(context);
    numbers(context);
    bad_calls(context);
    impossible_scenes(context);
    bhr_context_destroy(context);
    return check_end();
}
