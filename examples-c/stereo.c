/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* stereo.c -- a black hole for two eyes: side by side through asymmetric frusta, as headsets and 3-D screens have them,
 * or with --ods all round, the left eye's picture above the right one's, as players of 360-degree films take it. Short
 * enough to copy from. Lengths on the command line are in units of the hole's mass M, angles in degrees. */
#include "options.h"

#include <math.h>
#include <stdlib.h>

typedef struct Settings {
    uint32_t    size[2]; /* of one eye's picture */
    double      spin, distance, azimuth, elevation, fov;
    double      eyes; /* their distance */
    int         ods, help;
    int32_t     backend;
    const char *output;
} Settings;

/* The camera of one eye, -1 left or 1 right, beside `middle`: it looks ahead, not inwards, and its picture's borders
 * are moved, so that both eyes see the hole's place at the same pixel: nearer things stand before the screen. */
static BhrCamera eye_beside(const BhrCamera *middle, const Settings *s, double side) {
    BhrCamera    eye = *middle;
    const double aside = 0.5 * s->eyes * side;
    const double up = tan(0.5 * s->fov * PI / 180.0), right = up * s->size[0] / s->size[1];
    /* The camera stands at azimuth `azimuth` and looks at the hole: its right is this unit vector. */
    const double azimuth = s->azimuth * PI / 180.0;
    eye.position[0] += aside * -sin(azimuth);
    eye.position[1] += aside * cos(azimuth);
    eye.projection = BHR_PROJECTION_FRUSTUM;
    eye.tan_up = up, eye.tan_down = -up;
    eye.tan_left = -right - aside / s->distance;
    eye.tan_right = right - aside / s->distance;
    return eye;
}

static BhrCamera eye_all_round(const BhrCamera *middle, const Settings *s, double side) {
    BhrCamera eye = *middle;
    eye.projection = BHR_PROJECTION_EQUIRECT;
    eye.eye = side < 0.0 ? BHR_EYE_LEFT : BHR_EYE_RIGHT;
    eye.eye_distance = s->eyes;
    return eye;
}

/* Renders both eyes into one picture and saves it. */
static int render(BhrContext *context, const Settings *s, BhrImage *both, unsigned char *pixels) {
    BhrCamera middle;
    BhrStatus status = bhr_camera_init(&middle, sizeof middle);
    if (status >= 0) {
        status = bhr_camera_orbit(&middle, s->distance, s->azimuth * PI / 180.0, s->elevation * PI / 180.0);
    }
    for (int right = 0; right < 2 && status >= 0; right++) {
        const double    side = right ? 1.0 : -1.0;
        const BhrCamera eye = s->ods ? eye_all_round(&middle, s, side) : eye_beside(&middle, s, side);
        /* A part of the picture: the same rows, from another place on. */
        BhrImage     part = *both;
        const size_t rows = s->ods ? (size_t)right * s->size[1] : 0, columns = s->ods ? 0 : (size_t)right * s->size[0];
        const size_t begin = rows * (size_t)both->row_stride + columns * 4;
        part.width = s->size[0], part.height = s->size[1];
        part.pixels = pixels + begin;
        part.byte_size = both->byte_size - begin;
        status = bhr_set_camera(context, &eye);
        if (status >= 0) {
            status = bhr_render_image(context, &part);
        }
    }
    if (status >= 0) {
        status = bhr_image_save(both, s->output);
    }
    return status < 0 ? report_failure("make the stereo picture", status) : EXIT_SUCCESS;
}

static int make_picture(const Settings *s) {
    BhrImage both;
    BHR_INIT(both);
    both.width = s->size[0] * (s->ods ? 1 : 2);
    both.height = s->size[1] * (s->ods ? 2 : 1);
    both.row_stride = (int64_t)both.width * 4;
    both.byte_size = (uint64_t)both.row_stride * both.height;
    unsigned char *pixels = malloc((size_t)both.byte_size);
    if (pixels == NULL) {
        fprintf(stderr, "no memory for the picture\n");
        return EXIT_FAILURE;
    }
    both.pixels = pixels;
    BhrContext *context = NULL;
    BhrStatus   status = create_context_on(s->backend, &context);
    if (status >= 0) {
        status = bhr_set_spin(context, s->spin);
    }
    const int result = status < 0 ? report_failure("set the scene", status) : render(context, s, &both, pixels);
    if (result == EXIT_SUCCESS) {
        printf("%s: %u x %u, %s\n", s->output, (unsigned)both.width, (unsigned)both.height,
               s->ods ? "left eye above, right eye below" : "left eye left, right eye right");
    }
    bhr_context_destroy(context);
    free(pixels);
    return result;
}

static int run(int argc, char **argv) {
    Settings s = {.size = {640, 640},
                  .spin = 0.9,
                  .distance = 22.0,
                  .elevation = 8.0,
                  .fov = 50.0,
                  .eyes = 1.2,
                  .backend = BHR_BACKEND_AUTO,
                  .output = "stereo.png"};
    const Option options[] = {
        {"--size", OPTION_SIZE, s.size, "WxH", "of each eye's picture", NULL, NULL},
        {"--ods", OPTION_FLAG, &s.ods, NULL, "all round, 360 degrees; best twice as wide as high", NULL, NULL},
        {"--eyes", OPTION_DOUBLE, &s.eyes, "M", "the distance of the eyes", NULL, NULL},
        {"--spin", OPTION_DOUBLE, &s.spin, "A", "a / M, -0.9999 to 0.9999", NULL, NULL},
        {"--distance", OPTION_DOUBLE, &s.distance, "R", "the camera's radius in M", NULL, NULL},
        {"--azimuth", OPTION_DOUBLE, &s.azimuth, "DEG", "of the camera", NULL, NULL},
        {"--elevation", OPTION_DOUBLE, &s.elevation, "DEG", "above the disk's plane", NULL, NULL},
        {"--fov", OPTION_DOUBLE, &s.fov, "DEG", "full vertical angle, without --ods", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces it", BACKENDS, NULL},
        {"--output", OPTION_TEXT, &s.output, "FILE", "the picture", NULL, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    const int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.help) {
        printf("Usage: stereo [options]\n"
               "A black hole for two eyes, side by side; with --ods all round, one above the other.\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    return make_picture(&s);
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
