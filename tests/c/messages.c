/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* messages.c -- bhr_context_error_message and bhr_job_error_message: each tells of its own object's last failure,
 * whichever thread that was on, into buffers of every size; and messages that name constants, short numbers and what is
 * to be installed. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#define SIDE 64u

static const char *of_context(const BhrContext *context) {
    static char text[10000];
    const size_t length = bhr_context_error_message(context, text, sizeof text);
    CHECK(length == strlen(text) && length < sizeof text, "%zu bytes: %s", length, text);
    return text;
}

static const char *of_job(const BhrJob *job) {
    static char text[10000];
    const size_t length = bhr_job_error_message(job, text, sizeof text);
    CHECK(length == strlen(text) && length < sizeof text, "%zu bytes: %s", length, text);
    return text;
}

/* ---- who failed ---- */

static void *fail_elsewhere(void *context) {
    CHECK(bhr_set_spin(context, 2.0) == BHR_ERROR_INVALID_ARGUMENT, "spin 2 is taken");
    return NULL;
}

static void each_context_has_its_own(BhrBackend backend) {
    BhrContext *one = check_context(backend), *other = check_context(backend);
    pthread_t   thread;
    CHECK(of_context(one)[0] == '\0', "a new context has the message %s", of_context(one));
    /* Not CHECK_FAILS, whose own calls leave messages with this thread. */
    CHECK(bhr_set_mass(one, -1.0) == BHR_ERROR_INVALID_ARGUMENT, "mass -1 is taken");
    if (pthread_create(&thread, NULL, fail_elsewhere, other) == 0) {
        pthread_join(thread, NULL);
    }
    CHECK(strstr(of_context(one), "bhr_set_mass: mass is -1;") != NULL, "%s", of_context(one));
    CHECK(strcmp(of_context(other), "bhr_set_spin: spin is 2; it must lie in [-1, 1]") == 0, "%s",
          of_context(other));
    /* This thread has not heard of the other one's failure. */
    CHECK(strstr(bhr_error_message(), "mass") != NULL, "%s", bhr_error_message());
    /* A call that succeeds leaves the message, as with threads. */
    CHECK_OK(bhr_set_mass(one, 1.0));
    CHECK(strstr(of_context(one), "mass") != NULL, "%s", of_context(one));
    bhr_context_destroy(one);
    bhr_context_destroy(other);
}

static void buffers_of_every_size(BhrBackend backend) {
    BhrContext *context = check_context(backend);
    const char *whole;
    size_t      length;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "", bhr_image_save(NULL, "nothing.png"));
    CHECK(of_context(context)[0] == '\0', "a call without a context left %s", of_context(context));
    CHECK(bhr_set_spin(context, 2.0) == BHR_ERROR_INVALID_ARGUMENT, "spin 2 is taken");
    whole = bhr_error_message();
    length = strlen(whole);
    for (size_t size = 0; size <= length + 3; size++) {
        char text[256];
        memset(text, UNTOUCHED, sizeof text);
        CHECK(bhr_context_error_message(context, text, size) == length, "another length at size %zu", size);
        const size_t written = size == 0 ? 0 : (size - 1 < length ? size - 1 : length);
        CHECK(memcmp(text, whole, written) == 0 && (size == 0 || text[written] == '\0'), "size %zu", size);
        CHECK(all_untouched(text + (size == 0 ? 0 : written + 1), sizeof text - written - 1), "size %zu", size);
    }
    CHECK(bhr_context_error_message(context, NULL, 100) == length, "NULL is not asked for the length");
    bhr_context_destroy(context);

    char text[4] = {'x', 'y', 'z', '\0'};
    CHECK(bhr_context_error_message(NULL, text, sizeof text) == 0 && text[0] == '\0', "NULL context: %s", text);
    text[0] = 'x';
    CHECK(bhr_job_error_message(NULL, text, sizeof text) == 0 && text[0] == '\0', "NULL job: %s", text);
    CHECK(bhr_context_error_message(NULL, NULL, 0) == 0 && bhr_job_error_message(NULL, NULL, 9) == 0, "of nothing");
}

/* ---- jobs ---- */

static void each_job_has_its_own(BhrBackend backend) {
    static unsigned char pixels[SIDE * SIDE * 4], more[SIDE * SIDE * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    const BhrImage       second = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, more, sizeof more);
    BhrContext          *context = check_context(backend);
    BhrJob              *done = NULL, *cancelled = NULL, *none = NULL;
    CHECK_OK(bhr_render_image_async(context, &second, &done));
    CHECK_OK(bhr_render_image_async(context, &image, &cancelled));
    bhr_job_cancel(cancelled);
    CHECK_OK(bhr_job_wait(done, UINT64_MAX, NULL));
    const BhrStatus status = bhr_job_wait(cancelled, UINT64_MAX, NULL);
    if (status != BHR_OK) { /* else it was done before it could be cancelled */
        CHECK(status == BHR_ERROR_CANCELLED, "%d", (int)status);
        CHECK(strstr(of_job(cancelled), "bhr_job_wait: the job was cancelled") != NULL, "%s", of_job(cancelled));
    }
    CHECK(of_job(done)[0] == '\0', "a job that is done has the message %s", of_job(done));
    CHECK(of_context(context)[0] == '\0', "a job's failure became its context's: %s", of_context(context));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "", bhr_render_image_async(context, NULL, &none));
    CHECK(strstr(of_context(context), "bhr_render_image_async: target is NULL") != NULL, "%s", of_context(context));
    bhr_context_destroy(context);
    /* Jobs outlive their context, and so do their messages. */
    CHECK(status == BHR_OK || of_job(cancelled)[0] != '\0', "the message went with the context");
    bhr_job_destroy(cancelled);
    bhr_job_destroy(done);
}

/* ---- inside callbacks ---- */

static size_t inside;

static int32_t ask(void *user, double fraction) {
    (void)fraction;
    inside = bhr_context_error_message(user, NULL, 0);
    CHECK(bhr_set_spin(user, 0.0) == BHR_ERROR_INVALID_STATE, "a setter runs inside a callback");
    CHECK(strstr(of_context(user), "bhr_set_spin: called from inside") != NULL, "%s", of_context(user));
    return 0;
}

static void callbacks_may_ask(BhrBackend backend) {
    static unsigned char pixels[SIDE * SIDE * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    BhrContext          *context = check_context(backend);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "", bhr_set_spin(context, 2.0));
    CHECK_OK(bhr_set_progress(context, ask, context));
    CHECK_FAILS(BHR_ERROR_CANCELLED, "cancelled", bhr_render_image(context, &image));
    CHECK(inside > 0, "nothing was to be had inside the callback");
    bhr_context_destroy(context);
}

/* ---- ends ---- */

static int rendering; /* by the compiler's atomic built-ins: C99 has none of its own */

static int32_t cancel_late(void *user, double fraction) {
    (void)user;
    (void)fraction;
    __atomic_store_n(&rendering, 1, __ATOMIC_SEQ_CST);
    pause_ms(5);
    return 0;
}

static void *fail_while_it_ends(void *context) {
    static unsigned char pixels[SIDE * SIDE * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    CHECK(bhr_render_image(context, &image) == BHR_ERROR_CANCELLED, "%s", bhr_error_message());
    return NULL;
}

/* bhr_context_destroy waits for a call that is running; that call's failure is then told without the context. */
static void calls_fail_while_their_context_ends(BhrBackend backend) {
    for (int i = 0; i < (backend == BHR_BACKEND_CPU ? 20 : 3); i++) { /* on lavapipe each takes half a second */
        BhrContext *context = check_context(backend);
        pthread_t   thread;
        __atomic_store_n(&rendering, 0, __ATOMIC_SEQ_CST);
        CHECK_OK(bhr_set_progress(context, cancel_late, NULL));
        if (pthread_create(&thread, NULL, fail_while_it_ends, context) != 0) {
            bhr_context_destroy(context);
            return;
        }
        while (!__atomic_load_n(&rendering, __ATOMIC_SEQ_CST)) {
            pause_ms(1);
        }
        bhr_context_destroy(context);
        pthread_join(thread, NULL);
    }
}

/* ---- words ---- */

static void messages_are_plain(BhrBackend backend) {
    BhrContextOptions options = check_options(BHR_BACKEND_METAL);
    BhrContext       *context = check_context(backend), *none = NULL;
    BhrWindow         window = {0};
    BhrSurface       *surface = NULL;
    BhrCamera         camera;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "spin is 1.33333333;", bhr_set_spin(context, 4.0 / 3.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "spin is 1.00000000000001;", bhr_set_spin(context, 1.00000000000001));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "mass is -1e308;", bhr_set_mass(context, -1e308));
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    camera.fov_y = 60.0;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "fov_y is 60; it must lie in (0, pi), in radians",
                bhr_set_camera(context, &camera));
    window.struct_size = sizeof window, window.kind = BHR_WINDOW_XLIB;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "window display is NULL; windows of kind BHR_WINDOW_XLIB need it",
                bhr_surface_create(context, &window, 1, 1, BHR_PRESENT_VSYNC, &surface));
#ifdef __APPLE__
    options.backend = BHR_BACKEND_D3D12;
#endif
    CHECK_FAILS(BHR_ERROR_NO_ADAPTER, "is there on macOS and iOS only|is there on Windows only",
                bhr_context_create(BHR_ABI_VERSION, &options, &none));
    bhr_context_destroy(context);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    each_context_has_its_own(backend);
    buffers_of_every_size(backend);
    each_job_has_its_own(backend);
    callbacks_may_ask(backend);
    calls_fail_while_their_context_ends(backend);
    messages_are_plain(backend);
    return check_end();
}
