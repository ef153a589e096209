/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_context.c -- version, status names, adapters, options and contexts, asked wrongly and rightly. Renders only to
 * see that a context is unchanged. */
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void versions(void) {
    const uint32_t expected = BHR_VERSION_MAJOR << 16 | BHR_VERSION_MINOR << 8 | BHR_VERSION_PATCH;
    char           text[32];
    snprintf(text, sizeof text, "%d.%d.%d", BHR_VERSION_MAJOR, BHR_VERSION_MINOR, BHR_VERSION_PATCH);
    CHECK(bhr_version() == expected, "bhr_version() is %#x", (unsigned)bhr_version());
    CHECK(bhr_abi_version() == BHR_ABI_VERSION, "bhr_abi_version() is %u", (unsigned)bhr_abi_version());
    CHECK(strcmp(bhr_version_string(), text) == 0, "bhr_version_string() is %s", bhr_version_string());
}

static void status_names(void) {
    static const struct {
        BhrStatus   status;
        const char *name;
    } all[] = {
        {BHR_OK, "BHR_OK"},
        {BHR_NOT_READY, "BHR_NOT_READY"},
        {BHR_FRAME_SKIPPED, "BHR_FRAME_SKIPPED"},
        {BHR_ERROR_INVALID_ARGUMENT, "BHR_ERROR_INVALID_ARGUMENT"},
        {BHR_ERROR_INVALID_STATE, "BHR_ERROR_INVALID_STATE"},
        {BHR_ERROR_INCOMPATIBLE_ABI, "BHR_ERROR_INCOMPATIBLE_ABI"},
        {BHR_ERROR_UNSUPPORTED, "BHR_ERROR_UNSUPPORTED"},
        {BHR_ERROR_NO_ADAPTER, "BHR_ERROR_NO_ADAPTER"},
        {BHR_ERROR_OUT_OF_MEMORY, "BHR_ERROR_OUT_OF_MEMORY"},
        {BHR_ERROR_CANCELLED, "BHR_ERROR_CANCELLED"},
        {BHR_ERROR_SURFACE_LOST, "BHR_ERROR_SURFACE_LOST"},
        {BHR_ERROR_DEVICE_LOST, "BHR_ERROR_DEVICE_LOST"},
        {BHR_ERROR_IO, "BHR_ERROR_IO"},
        {BHR_ERROR_INTERNAL, "BHR_ERROR_INTERNAL"},
    };
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        CHECK(strcmp(bhr_status_name(all[i].status), all[i].name) == 0, "status %d is named %s", (int)all[i].status,
              bhr_status_name(all[i].status));
    }
    CHECK(bhr_status_name(12345) != NULL && bhr_status_name(-12345)[0] != '\0', "an unknown status has no name at all");
}

static void options(BhrBackend backend) {
    struct {
        BhrContextOptions known;
        unsigned char     tail[16];
    } grown;
    const size_t known = sizeof grown.known;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "options", bhr_context_options_init(NULL, known));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_context_options_init(&grown.known, 0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_context_options_init(&grown.known, known - 8));
    memset(&grown, UNTOUCHED, sizeof grown);
    CHECK_OK(bhr_context_options_init(&grown.known, sizeof grown));
    CHECK(grown.known.struct_size == sizeof grown, "struct_size is %u", (unsigned)grown.known.struct_size);
    CHECK(grown.known.adapter_index == -1, "adapter_index is %d", (int)grown.known.adapter_index);
    CHECK(grown.known.backend == BHR_BACKEND_AUTO, "backend is %d", (int)grown.known.backend);
    for (size_t i = 0; i < sizeof grown.tail; i++) {
        CHECK(grown.tail[i] == 0, "byte %u of the tail is %u", (unsigned)i, grown.tail[i]);
    }

    BhrContext *context = (BhrContext *)&grown; /* must become NULL */
    grown.known.backend = backend;
    CHECK_FAILS(BHR_ERROR_INCOMPATIBLE_ABI, "abi",
                bhr_context_create(BHR_ABI_VERSION + 1, &grown.known, &context));
    CHECK(context == NULL, "out_context is not NULL after a failure");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_context", bhr_context_create(BHR_ABI_VERSION, &grown.known, NULL));

    grown.tail[7] = 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_context_create(BHR_ABI_VERSION, &grown.known, &context));
    grown.tail[7] = 0;
    grown.known.struct_size = FIRST_CONTEXT_OPTIONS - 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_context_create(BHR_ABI_VERSION, &grown.known, &context));
    grown.known.struct_size = 0;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_context_create(BHR_ABI_VERSION, &grown.known, &context));
    grown.known.struct_size = sizeof grown;

    BhrContextOptions bad = grown.known;
    bad.struct_size = (uint32_t)known;
    bad.backend = 77;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "backend", bhr_context_create(BHR_ABI_VERSION, &bad, &context));
    bad.backend = -1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "backend", bhr_context_create(BHR_ABI_VERSION, &bad, &context));
    bad.backend = backend;
    bad.log_level = 6;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "log_level", bhr_context_create(BHR_ABI_VERSION, &bad, &context));
    bad.log_level = BHR_LOG_OFF;
    bad.flags = 0x80000000u;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "flags", bhr_context_create(BHR_ABI_VERSION, &bad, &context));
    bad.flags = 0;
    bad.adapter_index = -2;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "adapter_index", bhr_context_create(BHR_ABI_VERSION, &bad, &context));
    bad.adapter_index = 9999;
    CHECK_FAILS(BHR_ERROR_NO_ADAPTER, "9999", bhr_context_create(BHR_ABI_VERSION, &bad, &context));
    CHECK(context == NULL, "out_context is not NULL after a failure");

    /* A newer host with a zero tail is served. */
    if (CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &grown.known, &context))) {
        bhr_context_destroy(context);
    }
    bhr_context_destroy(NULL);
}

#ifndef __APPLE__
/* Metal is nowhere but on Apple's systems. */
static void absent_backend(void) {
    BhrContextOptions options;
    BhrContext       *context = (BhrContext *)&options;
    CHECK_OK(bhr_context_options_init(&options, sizeof options));
    options.backend = BHR_BACKEND_METAL;
    const BhrStatus status = bhr_context_create(BHR_ABI_VERSION, &options, &context);
    CHECK(status == BHR_ERROR_NO_ADAPTER || status == BHR_ERROR_UNSUPPORTED, "Metal here gives %s",
          bhr_status_name(status));
    CHECK(context == NULL && bhr_error_message()[0] != '\0', "message: %s", bhr_error_message());
}
#endif

static void adapters(BhrContext *context, BhrBackend backend) {
    uint32_t       count = 0;
    BhrAdapterInfo info = {.struct_size = sizeof info};
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_count", bhr_adapter_count(NULL));
    CHECK_OK(bhr_adapter_count(&count));
    CHECK(count >= 1, "%u adapters", (unsigned)count);
    int seen = 0;
    for (uint32_t i = 0; i < count; i++) {
        memset(&info, UNTOUCHED, sizeof info);
        info.struct_size = sizeof info;
        CHECK_OK(bhr_adapter_info(i, &info));
        CHECK(info.name[0] != '\0' && memchr(info.name, '\0', sizeof info.name) != NULL, "adapter %u has no name",
              (unsigned)i);
        CHECK(memchr(info.driver, '\0', sizeof info.driver) != NULL, "adapter %u: the driver's name has no end",
              (unsigned)i);
        CHECK(info.reserved == 0, "reserved is %u", (unsigned)info.reserved);
        seen |= info.backend == backend;
    }
    CHECK(info.backend == BHR_BACKEND_CPU && (info.flags & BHR_ADAPTER_SOFTWARE), "the last adapter is of backend %d",
          (int)info.backend);
    CHECK(seen, "no adapter of the backend under test is listed");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "index", bhr_adapter_info(count, &info));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "index", bhr_adapter_info(UINT32_MAX, &info));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "info", bhr_adapter_info(0, NULL));
    info.struct_size = 8;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_adapter_info(0, &info));

    struct {
        BhrAdapterInfo known;
        unsigned char  tail[16];
    } grown;
    memset(&grown, UNTOUCHED, sizeof grown);
    grown.known.struct_size = sizeof grown;
    CHECK_OK(bhr_context_adapter(context, &grown.known));
    CHECK(grown.known.backend == backend, "the context is on backend %d", (int)grown.known.backend);
    CHECK(grown.tail[0] == 0 && grown.tail[15] == 0, "the tail of an output is not zeroed");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_context_adapter(NULL, &grown.known));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "info", bhr_context_adapter(context, NULL));
}

static void numbers_about_the_frame(BhrContext *context) {
    BhrFrameStats stats = {.struct_size = sizeof stats};
    CHECK_OK(bhr_frame_stats(context, &stats));
    CHECK(stats.frame_index == 0, "a new context has rendered %u frames", (unsigned)stats.frame_index);
    Watch watch;
    watch_begin(&watch, context);
    CHECK_OK(bhr_frame_stats(context, &stats));
    CHECK(stats.frame_index == 1, "after one frame, frame_index is %u", (unsigned)stats.frame_index);
    CHECK(stats.rays >= WATCH_WIDTH * WATCH_HEIGHT && stats.cpu_ns > 0, "rays %u, cpu_ns %u", (unsigned)stats.rays,
          (unsigned)stats.cpu_ns);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_frame_stats(NULL, &stats));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "stats", bhr_frame_stats(context, NULL));
    stats.struct_size = 4;
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_frame_stats(context, &stats));
}

/* Functions for a later version are there, say so, and take no host down. */
static void later_functions(BhrContext *context) {
    Watch       watch;
    BhrSurface *surface = (BhrSurface *)&watch;
    BhrWindow   window;
    watch_begin(&watch, context);
    memset(&window, 0, sizeof window);
    window.struct_size = sizeof window;
    window.kind = BHR_WINDOW_XLIB;
    CHECK(bhr_surface_create(context, &window, 64, 48, BHR_PRESENT_VSYNC, &surface) < 0 &&
              bhr_error_message()[0] != '\0',
          "a window without a display was taken");
    CHECK(surface == NULL, "out_surface is not NULL after a failure");
    CHECK(bhr_surface_create(context, NULL, 64, 48, BHR_PRESENT_VSYNC, &surface) < 0, "a NULL window was taken");
    CHECK(bhr_surface_create(context, &window, 64, 48, BHR_PRESENT_VSYNC, NULL) < 0, "a NULL out_surface was taken");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context",
                bhr_surface_create(NULL, &window, 64, 48, BHR_PRESENT_VSYNC, &surface));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "surface", bhr_surface_resize(NULL, 64, 48));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "surface", bhr_surface_set_present_mode(NULL, BHR_PRESENT_VSYNC));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "surface", bhr_render_surface(context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_render_surface(NULL, NULL));
    bhr_surface_destroy(NULL);

    double        fraction = 0.5;
    BhrFrameStats stats = {.struct_size = sizeof stats};
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "job", bhr_job_wait(NULL, 0, &fraction));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "job", bhr_job_stats(NULL, &stats));
    bhr_job_cancel(NULL);
    bhr_job_destroy(NULL);
    check_unchanged(&watch, __FILE__, __LINE__, "later_functions");
}

static void recover(BhrContext *context) {
    Watch watch;
    watch_begin(&watch, context);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_context_recover(NULL));
    CHECK_OK(bhr_context_recover(context)); /* of a context that is not lost: a new device, the same scene */
    check_unchanged(&watch, __FILE__, __LINE__, "bhr_context_recover(context)");
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    CHECK(bhr_error_message() != NULL, "NULL before any failure");
    versions();
    status_names();
    options(backend);
#ifndef __APPLE__
    absent_backend();
#endif
    BhrContext *context = check_context(backend);
    numbers_about_the_frame(context);
    adapters(context, backend);
    later_functions(context);
    recover(context);
    bhr_context_destroy(context);
    return check_end();
}
