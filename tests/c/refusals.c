/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* refusals.c -- see refusals.h. */
#include "refusals.h"

int is_after(const void *structure, size_t begin, size_t end, unsigned char value) {
    const unsigned char *bytes = structure;
    while (begin < end && bytes[begin] == value) {
        begin++;
    }
    return begin >= end;
}

void put(void *destination, size_t offset, double value) {
    memcpy((char *)destination + offset, &value, sizeof value);
}

BhrCamera default_camera(void) {
    BhrCamera camera;
    memset(&camera, 0, sizeof camera);
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    return camera;
}

void watch_unusual_scene(Watch *watch, BhrContext *context) {
    static const double tilted[3] = {0.1, -0.2, 1.0};
    BhrCamera           camera = default_camera();
    CHECK_OK(bhr_set_mass(context, 1.25));
    CHECK_OK(bhr_set_spin(context, 0.5));
    CHECK_OK(bhr_set_axis(context, tilted));
    camera.motion = BHR_MOTION_FREE_FALL;
    camera.fov_y = 0.9;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_time(context, 3.0));
    CHECK_OK(bhr_set_effects(context, BHR_EFFECT_ALL & ~BHR_EFFECT_BEAMING));
    watch_begin(watch, context);
    CHECK(watch->frame_status == BHR_OK, "the watched scene cannot be rendered: %s", bhr_error_message());
}

void finite_frame(BhrContext *context, const char *what, size_t index) {
    static float   light[WATCH_WIDTH * WATCH_HEIGHT * 4];
    const uint32_t part = check_runs_all() ? 1 : 2; /* everyday a quarter of the rays through the same view */
    const size_t   count = WATCH_WIDTH / part * (WATCH_HEIGHT / part) * 4;
    const BhrImage image =
        image_of(BHR_FORMAT_RGBA32F, WATCH_WIDTH / part, WATCH_HEIGHT / part, light, sizeof light);
    CHECK_OK(bhr_render_image(context, &image));
    size_t finite = 0;
    for (size_t i = 0; i < count; i++) {
        finite += isfinite(light[i]) && light[i] >= 0.0f;
    }
    CHECK(finite == count, "%s %u: %u numbers are finite", what, (unsigned)index, (unsigned)finite);
}
