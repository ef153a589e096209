/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* bad_cameras.c -- cameras as hosts have them, asked wrongly: tangents and jitter that are none, matrices that are no
 * camera's, points that are nowhere. Each refusal must leave the context, and what was to be filled in, as the header
 * says. The rest of BhrCamera is in bad_scene.c. */
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

static void eyes(Watch *watch, BhrContext *context) {
    static const int32_t unknown[] = {-1, 3, 77, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        BhrCamera camera = frustum();
        camera.eye = unknown[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "eye", bhr_set_camera(context, &camera));
    }
    static const double bad[] = {NAN, INFINITY, -INFINITY, -0.1};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        BhrCamera camera = frustum();
        camera.eye_distance = bad[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "eye_distance", bhr_set_camera(context, &camera));
    }
    BhrCamera camera = frustum();
    camera.reserved2 = 1;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "reserved", bhr_set_camera(context, &camera));
    /* A picture all round for one eye. */
    camera = frustum();
    camera.projection = BHR_PROJECTION_EQUIRECT;
    camera.eye = BHR_EYE_LEFT, camera.eye_distance = 0.4;
    CHECK_OK(bhr_set_camera(context, &camera));
    BhrFilm film = watch->film;
    film.bloom = 0.3;
    CHECK_OK(bhr_set_film(context, &film));
    static unsigned char pixels[16 * 8 * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 8, pixels, sizeof pixels);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "an eye", bhr_render_image(context, &image));
    film.bloom = film.beam_fwhm = 0.0;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_render_image(context, &image));
    static const double point[3] = {1.0, 8.0, 3.0};
    BhrProjectedPoint   projected;
    projected.struct_size = sizeof projected;
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "eye", bhr_project_point(context, 16, 8, point, 0, &projected));
    static BhrRay rays[256];
    CHECK_OK(bhr_camera_rays(context, 256, 1, rays));
    CHECK(rays[0].position[1] != rays[128].position[1], "columns far apart are seen from one place");
    CHECK_OK(bhr_set_film(context, &watch->film));
    CHECK_OK(bhr_set_camera(context, &watch->camera));
    check_unchanged(watch, __FILE__, __LINE__, "the camera of both eyes set back");
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

/* ---- matrices ---- */

/* By columns: a camera at (0, 0, 25) that looks along -z, and an infinite projection with reversed depths. */
static const double VIEW[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -25, 1};
static const double PROJECTION[16] = {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, -1, 0, 0, 0.1, 0};

/* The camera stays as it is when this is refused. */
static void refused(const double view[16], const double projection[16], uint32_t flags, const char *words) {
    BhrCamera camera = frustum(), before = camera;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, words, bhr_camera_from_matrices(&camera, view, projection, flags));
    CHECK(memcmp(&camera, &before, sizeof camera) == 0, "a refusal (%s) changed the camera", words);
}

static void from_matrices(void) {
    BhrCamera camera = frustum();
    CHECK_OK(bhr_camera_from_matrices(&camera, VIEW, PROJECTION, 0));
    CHECK(camera.position[2] == 25.0 && camera.forward[2] == -1.0 && camera.up[1] == 1.0, "the view");
    CHECK(camera.tan_left == -1.0 && camera.tan_right == 1.0 && camera.tan_down == -0.5 && camera.tan_up == 0.5,
          "the projection: %g %g %g %g", camera.tan_left, camera.tan_right, camera.tan_down, camera.tan_up);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "camera", bhr_camera_from_matrices(NULL, VIEW, PROJECTION, 0));
    refused(NULL, PROJECTION, 0, "view");
    refused(VIEW, NULL, 0, "projection");
    refused(VIEW, PROJECTION, 32u, "flags");
    refused(VIEW, PROJECTION, UINT32_MAX, "flags");
    refused(VIEW, PROJECTION, BHR_MATRIX_ROW_MAJOR, "view");
    refused(VIEW, PROJECTION, BHR_MATRIX_Y_DOWN, "left-handed");
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        for (int k = 0; k < 16; k++) {
            double bad[16];
            memcpy(bad, VIEW, sizeof bad);
            bad[k] = NOT_FINITE[i];
            refused(bad, PROJECTION, 0, "view");
            memcpy(bad, PROJECTION, sizeof bad);
            bad[k] = NOT_FINITE[i];
            if (k % 4 == 2) { /* the row of depths */
                CHECK_OK(bhr_camera_from_matrices(&camera, VIEW, bad, 0));
            } else {
                refused(VIEW, bad, 0, "projection");
            }
        }
    }
    static const double at_the_hole[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const double scaled[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, -25, 1};
    static const double mirrored[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -25, 1};
    static const double orthographic[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.1, 0, 0, 0, -1, 1};
    static const double flat[16] = {0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, -1, 0, 0, 0.1, 0};
    static const double narrow[16] = {1e-12, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, -1, 0, 0, 0.1, 0};
    refused(at_the_hole, PROJECTION, 0, "position");
    refused(scaled, PROJECTION, 0, "rigid");
    refused(mirrored, PROJECTION, 0, "left-handed");
    refused(VIEW, orthographic, 0, "orthographic");
    refused(VIEW, flat, 0, "projection [0][0]");
    refused(VIEW, narrow, 0, "tan_left");
    /* A host of 0.1.0 has no room for a frustum. */
    camera = frustum();
    camera.struct_size = offsetof(BhrCamera, jitter);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_from_matrices(&camera, VIEW, PROJECTION, 0));
    camera.struct_size = 3;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_camera_from_matrices(&camera, VIEW, PROJECTION, 0));
}

/* Both matrices are 0 after a refusal. */
static void not_made(const BhrCamera *camera, uint32_t width, uint32_t height, double near_z, double far_z,
                     uint32_t flags, const char *words) {
    double view[16], projection[16];
    memset(view, UNTOUCHED, sizeof view);
    memset(projection, UNTOUCHED, sizeof projection);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, words,
                bhr_camera_matrices(camera, width, height, near_z, far_z, flags, view, projection));
    for (int i = 0; i < 16; i++) {
        CHECK(view[i] == 0.0 && projection[i] == 0.0, "a refusal (%s) left numbers", words);
    }
}

static void matrices(void) {
    BhrCamera camera = frustum();
    double    view[16], projection[16];
    CHECK_OK(bhr_camera_from_matrices(&camera, VIEW, PROJECTION, 0));
    CHECK_OK(bhr_camera_matrices(&camera, 8, 4, 0.1, INFINITY, BHR_MATRIX_ZERO_TO_ONE | BHR_MATRIX_REVERSED, view,
                                 projection));
    for (int i = 0; i < 16; i++) {
        CHECK(fabs(view[i] - VIEW[i]) < 1e-12 && fabs(projection[i] - PROJECTION[i]) < 1e-12, "number %d", i);
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_view",
                bhr_camera_matrices(&camera, 8, 4, 0.1, 9.0, 0, NULL, projection));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "out_projection",
                bhr_camera_matrices(&camera, 8, 4, 0.1, 9.0, 0, view, NULL));
    not_made(NULL, 8, 4, 0.1, 9.0, 0, "camera");
    not_made(&camera, 0, 4, 0.1, 9.0, 0, "frame");
    not_made(&camera, 8, 0, 0.1, 9.0, 0, "frame");
    not_made(&camera, 8, 4, 0.1, 9.0, 64u, "flags");
    static const double bad_near[] = {0.0, -0.1, NAN, INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_near); i++) {
        not_made(&camera, 8, 4, bad_near[i], INFINITY, 0, "near_z");
    }
    static const double bad_far[] = {0.1, 0.0, -9.0, NAN, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad_far); i++) {
        not_made(&camera, 8, 4, 0.1, bad_far[i], 0, "far_z");
    }
    for (BhrProjection p = BHR_PROJECTION_FISHEYE; p <= BHR_PROJECTION_CUBE; p++) {
        camera.projection = p;
        not_made(&camera, 8, 4, 0.1, 9.0, 0, "projection");
    }
    camera = frustum();
    camera.tan_up = -2.0;
    not_made(&camera, 8, 4, 0.1, 9.0, 0, "tan_down");
}

/* ---- points on the screen ---- */

/* Many points: each as one alone, whatever the others are, and structs of hosts that know longer ones. */
static void many_points(Watch *watch, BhrContext *context) {
    static const double points[4][3] = {{1.0, 8.0, 3.0}, {NAN, 0.0, 0.0}, {0.0, 0.0, 0.0}, {-4.0, 2.0, 30.0}};
    struct Longer {
        BhrProjectedPoint image;
        double            later;
    } found[4];
    BhrProjectedPoint   one;
    const size_t        size = sizeof found[0];
    const double *const from = points[0];
    memset(found, 0xff, sizeof found);
    CHECK_OK(bhr_project_points(context, 16, 9, from, 4, 0, &found[0].image, size));
    for (int i = 0; i < 4; i++) {
        const BhrProjectedPoint *image = &found[i].image;
        CHECK(image->struct_size == size && found[i].later == 0.0, "size %u", (unsigned)image->struct_size);
        CHECK(image->found == (i == 0 || i == 3) && image->lost == 0, "point %d: %u", i, (unsigned)image->found);
        one.struct_size = sizeof one;
        if (image->found) {
            CHECK_OK(bhr_project_point(context, 16, 9, points[i], 0, &one));
            CHECK(one.x == image->x && one.y == image->y && one.apparent[1] == image->apparent[1], "point %d", i);
            double sum = 0.0;
            for (int k = 0; k < 3; k++) {
                const double off = points[i][k] - watch->camera.position[k];
                sum += off * off;
            }
            CHECK(fabs(sqrt(sum) / image->distance - 1.0) < 1e-12, "distance %g", image->distance);
        }
    }
    BhrProjectedPoint *const out = &found[0].image;
    memset(found, 0x5a, sizeof found);
    CHECK_OK(bhr_project_points(context, 16, 9, NULL, 0, 0, NULL, size));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_project_points(NULL, 16, 9, from, 4, 0, out, size));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "points",
                  bhr_project_points(context, 16, 9, NULL, 4, 0, out, size));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_images",
                  bhr_project_points(context, 16, 9, from, 4, 0, NULL, size));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "width", bhr_project_points(context, 0, 9, from, 4, 0, out, size));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "order",
                  bhr_project_points(context, 16, 9, from, 4, BHR_MAX_IMAGE_ORDER + 1, out, size));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "count",
                  bhr_project_points(context, 16, 9, from, SIZE_MAX / 8, 0, out, size));
    static const size_t wrong[] = {0, 4, 143, 1u << 20, SIZE_MAX};
    for (size_t i = 0; i < COUNT_OF(wrong); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "image_size",
                      bhr_project_points(context, 16, 9, from, 4, 0, out, wrong[i]));
    }
    CHECK(out->struct_size == 0x5a5a5a5au, "a call that fails writes images: %x", (unsigned)out->struct_size);
}

static void points(Watch *watch, BhrContext *context) {
    static const double point[3] = {1.0, 8.0, 3.0};
    BhrProjectedPoint   image;
    image.struct_size = sizeof image;
    CHECK_OK(bhr_project_point(context, 16, 9, point, 0, &image));
    CHECK(image.found == 1 && image.magnification > 0.0 && image.delay > 0.0 && image.redshift > 0.0, "a point");
    BhrRay ray;
    CHECK_OK(bhr_camera_ray(context, 16, 9, image.x, image.y, &ray));
    for (int k = 0; k < 3; k++) {
        CHECK(fabs(ray.direction[k] - image.ray.direction[k]) < 1e-12, "direction %d: %.17g %.17g", k,
              ray.direction[k], image.ray.direction[k]);
    }
    CHECK(fabs(ray.frequency_ratio - image.ray.frequency_ratio) < 1e-12, "frequency ratio");

    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_project_point(NULL, 16, 9, point, 0, &image));
    CHECK(image.found == 0 && image.x == 0.0 && image.struct_size == sizeof image, "a failure clears the image");
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "out_image", bhr_project_point(context, 16, 9, point, 0, NULL));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "point", bhr_project_point(context, 16, 9, NULL, 0, &image));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "width", bhr_project_point(context, 0, 9, point, 0, &image));
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "height", bhr_project_point(context, 16, 0, point, 0, &image));
    static const uint32_t orders[] = {BHR_MAX_IMAGE_ORDER + 1, 1000u, UINT32_MAX};
    for (size_t i = 0; i < COUNT_OF(orders); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "order",
                      bhr_project_point(context, 16, 9, point, orders[i], &image));
    }
    for (size_t i = 0; i < COUNT_OF(NOT_FINITE); i++) {
        for (int k = 0; k < 3; k++) {
            double bad[3] = {1.0, 8.0, 3.0};
            bad[k] = NOT_FINITE[i];
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "point",
                          bhr_project_point(context, 16, 9, bad, 0, &image));
        }
    }
    static const double far_away[3] = {0.0, 1e300, 0.0};
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_STATE, "position",
                  bhr_project_point(context, 16, 9, far_away, 0, &image));
    static const uint32_t wrong[] = {0, 4, 143, 1u << 20, UINT32_MAX};
    for (size_t i = 0; i < COUNT_OF(wrong); i++) {
        image.struct_size = wrong[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size",
                      bhr_project_point(context, 16, 9, point, 0, &image));
    }
    /* There is nothing to be seen of the hole's inside, and where the camera is. */
    image.struct_size = sizeof image;
    static const double centre[3] = {0.0, 0.0, 0.0};
    const double *const nowhere[] = {centre, watch->camera.position};
    for (size_t i = 0; i < COUNT_OF(nowhere); i++) {
        CHECK_OK(bhr_project_point(context, 16, 9, nowhere[i], 0, &image));
        CHECK(image.found == 0 && image.on_screen == 0 && image.lost == 0 && isnan(image.x) &&
                  isnan(image.magnification) &&
                  image.ray.direction[0] == 0.0,
              "an image of nothing: %g %g", image.x, image.magnification);
    }
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    static Watch watch;
    watch_unusual_scene(&watch, context);
    tangents(&watch, context);
    jitter(&watch, context);
    eyes(&watch, context);
    taken(&watch, context);
    earlier_hosts(&watch, context);
    from_matrices();
    matrices();
    points(&watch, context);
    many_points(&watch, context);
    bhr_context_destroy(context);
    return check_end();
}
