/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_cameras.c -- cameras as hosts have them, asked wrongly: tangents and jitter that are none. Each refusal must
 * leave the context, and what was to be filled in, as the header says. The rest of BhrCamera is in bad_scene.c. */
#include "check.h"
#include "refusals.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const double NOT_FINITE[] = {NAN, INFINITY, -INFINITY};

static BhrCamera frustum(void) {
    BhrCamera camera;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    camera.projection = BHR_PROJECTION_FRUSTUM;
    return camera;
}

/* ---- tangents and jitter ---- */

static const struct {
    size_t      offset;
    const char *name;
} TANGENTS[] = {
    {offsetof(BhrCamera, tan_left), "tan_left"},
    {offsetof(BhrCamera, tan_right), "tan_right"},
    {offsetof(BhrCamera, tan_down), "tan_down"},
    {offsetof(BhrCamera, tan_up), "tan_up"},
};

static void tangents(Watch *watch, BhrContext *context) {
    for (size_t i = 0; i < COUNT_OF(TANGENTS); i++) {
        for (size_t k = 0; k < COUNT_OF(NOT_FINITE) + 1; k++) {
            BhrCamera camera = frustum();
            put(&camera, TANGENTS[i].offset, k < COUNT_OF(NOT_FINITE) ? NOT_FINITE[k] : 1.1e9);
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, TANGENTS[i].name, bhr_set_camera(context, &camera));
        }
    }
    BhrCamera camera = frustum();
    camera.tan_left = camera.tan_right;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "tan_left", bhr_set_camera(context, &camera));
    camera = frustum();
    camera.tan_down = 0.5, camera.tan_up = 0.25;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "tan_down", bhr_set_camera(context, &camera));
}

static void jitter(Watch *watch, BhrContext *context) {
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1.0000001, -1.5, 1e300};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        for (int k = 0; k < 2; k++) {
            for (BhrProjection p = BHR_PROJECTION_PERSPECTIVE; p <= BHR_PROJECTION_FRUSTUM; p++) {
                BhrCamera camera = frustum();
                camera.projection = p;
                camera.jitter[k] = bad[i];
                CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "jitter", bhr_set_camera(context, &camera));
            }
        }
    }
}

/* At the limits, and where a number is ignored. */
static void taken(Watch *watch, BhrContext *context) {
    BhrCamera camera = frustum();
    camera.tan_left = -1e9, camera.tan_right = 1e9, camera.tan_down = 1.0, camera.tan_up = nextafter(1.0, 2.0);
    camera.jitter[0] = -1.0, camera.jitter[1] = 1.0;
    camera.fov_y = NAN;
    CHECK_OK(bhr_set_camera(context, &camera));
    static unsigned char pixels[16 * 8 * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 8, pixels, sizeof pixels);
    CHECK_OK(bhr_render_image(context, &image));
    camera = frustum();
    camera.projection = BHR_PROJECTION_PERSPECTIVE;
    camera.tan_left = NAN, camera.tan_up = INFINITY;
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_camera(context, &watch->camera));
    check_unchanged(watch, __FILE__, __LINE__, "the camera set back");
}

/* A host of 0.1.0, whose BhrCamera ends before the tangents. */
static void earlier_hosts(Watch *watch, BhrContext *context) {
    const uint32_t first = offsetof(BhrCamera, tan_left);
    BhrCamera      camera = watch->camera, got;
    CHECK(first == 120, "the fields of 0.1.0 take %u bytes", (unsigned)first);
    camera.struct_size = first;
    camera.jitter[0] = 0.5; /* beyond what it says to have */
    CHECK_OK(bhr_set_camera(context, &camera));
    got.struct_size = sizeof got;
    CHECK_OK(bhr_get_camera(context, &got));
    CHECK(got.jitter[0] == 0.0 && got.tan_left == -1.0 && got.tan_up == 1.0, "fields that an earlier host lacks");
    CHECK_OK(bhr_set_camera(context, &watch->camera));
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    static Watch watch;
    watch_unusual_scene(&watch, context);
    tangents(&watch, context);
    jitter(&watch, context);
    taken(&watch, context);
    earlier_hosts(&watch, context);
    bhr_context_destroy(context);
    return check_end();
}
