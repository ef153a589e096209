/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* job_scenes.c -- see job_scenes.h. */
#include "job_scenes.h"

#include <stdlib.h>
#include <string.h>

unsigned char slow_pixels[SLOW_BYTES], expected[FLIGHT][BYTES], got[FLIGHT][BYTES];
uint32_t      slow_samples = ALL_SAMPLES;

BhrImage frame_of(unsigned char *pixels) {
    return image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, BYTES);
}

BhrJob *submit(BhrContext *context, const BhrImage *target) {
    BhrJob *job = NULL;
    CHECK_OK(bhr_render_image_async(context, target, &job));
    if (!CHECK(job != NULL, "success without a job")) {
        exit(check_end());
    }
    return job;
}

void set_quality(BhrContext *context, BhrMethod method, uint32_t samples) {
    BhrQuality quality;
    CHECK_OK(bhr_quality_init(&quality, sizeof quality));
    quality.method = method;
    quality.samples_per_pixel = samples;
    CHECK_OK(bhr_set_quality(context, &quality));
}

BhrJob *submit_slow(BhrContext *context) {
    BhrAdapterInfo adapter = {.struct_size = sizeof adapter};
    CHECK_OK(bhr_context_adapter(context, &adapter));
    const uint32_t part = adapter.flags & BHR_ADAPTER_SOFTWARE && slow_samples == ALL_SAMPLES ? 3 : 1;
    const BhrImage target =
        image_of(BHR_FORMAT_RGBA8_SRGB, SLOW_WIDTH / part, SLOW_HEIGHT / part, slow_pixels, SLOW_BYTES);
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    set_quality(context, BHR_METHOD_RK4, slow_samples);
    BhrJob *job = submit(context, &target);
    set_quality(context, BHR_METHOD_AUTO, 1);
    return job;
}

double wait_for_a_part(BhrJob *job, double part) {
    double    fraction = 0.0;
    BhrStatus status = BHR_NOT_READY;
    while (status == BHR_NOT_READY && fraction < part) {
        status = bhr_job_wait(job, 1000000, &fraction);
    }
    CHECK(status == BHR_NOT_READY, "no moment at which a part was done: %s, %g", bhr_status_name(status), fraction);
    return fraction;
}

void end_slow(BhrJob *job) {
    bhr_job_cancel(job);
    CHECK_FAILS(BHR_ERROR_CANCELLED, "cancel", bhr_job_wait(job, FOR_EVER, NULL));
    bhr_job_destroy(job);
}

void set_scene(BhrContext *context, int index) {
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

void render_expected(BhrContext *context, int count) {
    for (int i = 0; i < count; i++) {
        const BhrImage target = frame_of(expected[i]);
        set_scene(context, i);
        CHECK_OK(bhr_render_image(context, &target));
        for (int k = 0; k < i; k++) {
            CHECK(memcmp(expected[i], expected[k], BYTES) != 0, "scenes %d and %d look alike: nothing is tested", i, k);
        }
    }
}

void check_frame(int index) {
    CHECK(memcmp(got[index], expected[index], BYTES) == 0, "job %d does not show the scene as it was", index);
}
