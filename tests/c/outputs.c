/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* outputs.c -- outputs beside the picture, and things before the camera, as a C host asks for them: rightly, with jobs,
 * regions, rows of any stride and files of layers; and wrongly in every field. A refusal leaves the context and the
 * host's memory as they were. */
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH  40u
#define HEIGHT 24u
#define PIXELS (WIDTH * HEIGHT)

/* Memory for the largest number of outputs. */
static float blocks[BHR_MAX_OUTPUTS][PIXELS * 4];

static BhrFormat format_of(BhrOutputKind kind) {
    switch (kind) {
    case BHR_OUTPUT_DEPTH:
    case BHR_OUTPUT_TRANSMISSION:
    case BHR_OUTPUT_VIEW:
        return BHR_FORMAT_R32F;
    default:
        return BHR_FORMAT_RGBA32F;
    }
}

static BhrOutput output_of(BhrOutputKind kind, uint32_t index, const BhrImage *image) {
    BhrOutput output;
    CHECK_OK(bhr_output_init(&output, sizeof output));
    output.kind = kind;
    output.index = index;
    output.image = image;
    return output;
}

static const BhrOutputKind every[] = {BHR_OUTPUT_LIGHT,    BHR_OUTPUT_DEPTH, BHR_OUTPUT_SKY, BHR_OUTPUT_TRANSMISSION,
                                      BHR_OUTPUT_POSITION, BHR_OUTPUT_DISK,  BHR_OUTPUT_VIEW};

static BhrImage  images[COUNT_OF(every)];
static BhrOutput outputs[COUNT_OF(every)];

/* One of every kind, in untouched memory. */
static void fresh(void) {
    memset(blocks, UNTOUCHED, sizeof blocks);
    for (size_t i = 0; i < COUNT_OF(every); i++) {
        const BhrFormat format = format_of(every[i]);
        images[i] = image_of(format, WIDTH, HEIGHT, blocks[i], PIXELS * bytes_per_pixel(format));
        outputs[i] = output_of(every[i], every[i] == BHR_OUTPUT_VIEW ? BHR_VIEW_REDSHIFT : 0, &images[i]);
    }
}

static void every_kind(BhrContext *context) {
    static float alone[PIXELS * 4];
    fresh();
    CHECK_OK(bhr_render_outputs(context, outputs, sizeof *outputs, COUNT_OF(outputs), NULL));
    const BhrImage image = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, alone, sizeof alone);
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(memcmp(alone, blocks[0], sizeof alone) == 0, "LIGHT is not the picture");
    const float *depth = blocks[1], *sky = blocks[2], *left = blocks[3], *place = blocks[4], *disk = blocks[5],
                *redshift = blocks[6];
    BhrCamera camera = {0};
    camera.struct_size = sizeof camera;
    CHECK_OK(bhr_get_camera(context, &camera));
    size_t hits = 0, sights = 0, captures = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        const float *direction = sky + 4 * i, *crossing = place + 4 * i;
        const double length = sqrt((double)direction[0] * direction[0] + (double)direction[1] * direction[1] +
                                   (double)direction[2] * direction[2]);
        const int    escapes = direction[3] != 0.0f;
        CHECK(fabs(length - escapes) < 1e-5, "pixel %u: the sky's direction has length %g", (unsigned)i, length);
        CHECK(left[i] >= 0.0f && left[i] <= (escapes ? 1.0f : 0.0f), "pixel %u: %g comes through", (unsigned)i,
              left[i]);
        if (crossing[3] == 0.0f) {
            double sum = 0.0, r = 0.0;
            for (int k = 0; k < 3; k++) {
                sum += pow(crossing[k] - camera.position[k], 2.0);
                r += (double)crossing[k] * crossing[k];
            }
            CHECK(fabs(sqrt(sum) - depth[i]) < 1e-3, "pixel %u: depth %g, place at %g", (unsigned)i, depth[i],
                  sqrt(sum));
            CHECK(fabs(sqrt(r) - disk[4 * i]) < 1e-3, "pixel %u: radius %g, place at %g", (unsigned)i, disk[4 * i],
                  sqrt(r));
            CHECK(disk[4 * i + 2] == redshift[i], "pixel %u: g %g and %g", (unsigned)i, disk[4 * i + 2], redshift[i]);
            hits++;
        } else if (crossing[3] == -1.0f) {
            CHECK(isinf(depth[i]) && isnan(disk[4 * i]) && redshift[i] == direction[3], "pixel %u: sky", (unsigned)i);
            sights++;
        } else if (crossing[3] == -2.0f) {
            CHECK(isfinite(depth[i]) && isnan(redshift[i]) && !escapes, "pixel %u: captured", (unsigned)i);
            captures++;
        }
    }
    CHECK(hits > 30 && sights > 100 && captures > 3, "%u hits, %u sights, %u captures", (unsigned)hits,
          (unsigned)sights, (unsigned)captures);
}

/* Outputs by a job, into rows with gaps from the bottom up, and of a part of the frame. */
static void ways(BhrContext *context) {
    static float expected[PIXELS * 4], gaps[(WIDTH + 3) * HEIGHT * 4];
    fresh();
    CHECK_OK(bhr_render_outputs(context, &outputs[2], sizeof *outputs, 1, NULL));
    memcpy(expected, blocks[2], sizeof expected);
    BhrJob *job = NULL;
    memset(gaps, UNTOUCHED, sizeof gaps);
    images[2].pixels = gaps;
    images[2].row_stride = (WIDTH + 3) * 16;
    images[2].byte_size = sizeof gaps;
    images[2].flags = BHR_IMAGE_BOTTOM_UP;
    CHECK_OK(bhr_render_outputs(context, &outputs[1], sizeof *outputs, 2, &job));
    CHECK(job != NULL, "no job");
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    for (size_t y = 0; y < HEIGHT; y++) {
        const float *row = gaps + (HEIGHT - 1 - y) * (WIDTH + 3) * 4;
        CHECK(memcmp(row, expected + y * WIDTH * 4, WIDTH * 16) == 0, "row %u of a job", (unsigned)y);
        CHECK(all_untouched(row + WIDTH * 4, 3 * 16), "row %u: bytes between rows", (unsigned)y);
    }
    const BhrRegion region = {sizeof region, WIDTH, HEIGHT, 16, 8, 0};
    CHECK_OK(bhr_set_region(context, &region));
    images[2] = image_of(BHR_FORMAT_RGBA32F, 9, 5, blocks[2], sizeof blocks[2]);
    CHECK_OK(bhr_render_outputs(context, &outputs[2], sizeof *outputs, 1, NULL));
    for (size_t y = 0; y < 5; y++) {
        CHECK(memcmp(blocks[2] + y * 36, expected + ((8 + y) * WIDTH + 16) * 4, 9 * 16) == 0, "row %u of a part",
              (unsigned)y);
    }
    CHECK_OK(bhr_set_region(context, NULL));
}

/* The file's header names the channels and the parameters; its picture is LIGHT. */
static void layers(BhrContext *context, const char *folder) {
    static const char *const words[] = {"depth.Z",        "sky.g",         "transmission.Y",   "position.order",
                                        "disk.delay",     "redshift.Y",    "bhr.version",      "bhr.adapter",
                                        "bhr.hole.spin",  "bhr.disk.seed", "bhr.disk.opacity", "bhr.film.bloom",
                                        "bhr.camera.fov_y", "bhr.time",    "bhr.quality.method"};
    static unsigned char     head[16384];
    char                     path[512];
    snprintf(path, sizeof path, "%s/layers.exr", folder);
    fresh();
    CHECK_OK(bhr_render_outputs(context, outputs, sizeof *outputs, COUNT_OF(outputs), NULL));
    if (!CHECK_OK(bhr_save_outputs(context, outputs, sizeof *outputs, COUNT_OF(outputs), path))) {
        return;
    }
    FILE        *file = fopen(path, "rb");
    const size_t read = file == NULL ? 0 : fread(head, 1, sizeof head, file);
    if (file != NULL) {
        fclose(file);
    }
    /* OpenEXR's magic number; version 2, one part of scan lines, short names. */
    CHECK(read > 4096 && memcmp(head, "\x76\x2f\x31\x01\x02\0\0\0", 8) == 0, "%u bytes of another kind",
          (unsigned)read);
    for (size_t i = 0; i < COUNT_OF(words); i++) {
        int found = 0;
        for (size_t at = 0; at + strlen(words[i]) < read && !found; at++) {
            found = memcmp(head + at, words[i], strlen(words[i]) + 1) == 0;
        }
        CHECK(found, "the header has no %s", words[i]);
    }
    BhrImage loaded = {0};
    loaded.struct_size = sizeof loaded;
    CHECK_OK(bhr_image_load(path, &loaded));
    CHECK(loaded.width == WIDTH && loaded.height == HEIGHT && memcmp(loaded.pixels, blocks[0], sizeof blocks[0]) == 0,
          "the file's picture is another");
    CHECK_OK(bhr_image_release(&loaded));
    remove(path);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "path", bhr_save_outputs(context, outputs, sizeof *outputs, 1, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "path", bhr_save_outputs(context, outputs, sizeof *outputs, 1, ""));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "exr", bhr_save_outputs(context, outputs, sizeof *outputs, 1, "layers.png"));
    CHECK_FAILS(BHR_ERROR_IO, "absent", bhr_save_outputs(context, outputs, sizeof *outputs, 1, "/absent/layers.exr"));
    BhrOutput twice[] = {outputs[1], outputs[1]};
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "depth.Z", bhr_save_outputs(context, twice, sizeof *twice, 2, path));
    images[0] = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, blocks[0], sizeof blocks[0]);
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "RGBA8", bhr_save_outputs(context, outputs, sizeof *outputs, 1, path));
    images[0] = image_of(BHR_FORMAT_RGB10A2_PQ, WIDTH, HEIGHT, blocks[0], sizeof blocks[0]);
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "RGB10A2_PQ is no format of layers",
                bhr_save_outputs(context, outputs, sizeof *outputs, 1, path));
    file = fopen(path, "rb");
    CHECK(file == NULL, "a refused file is there");
    if (file != NULL) {
        fclose(file);
    }
}

/* A number among the attributes of a file of outputs, which is its name, "double", 8, and eight bytes; NAN without it,
 * or where the number's bytes are in another order on this machine. */
static double attribute_of(const char *path, const char *name) {
    static const char        kind[] = "double\0\10\0\0";
    static unsigned char     head[16384];
    double                   value = NAN;
    const size_t             length = strlen(name) + 1;
    FILE                    *file = fopen(path, "rb");
    const size_t             read = file == NULL ? 0 : fread(head, 1, sizeof head, file);
    for (size_t at = 0; at + length + sizeof kind + sizeof value <= read; at++) {
        if (memcmp(head + at, name, length) == 0 && memcmp(head + at + length, kind, sizeof kind) == 0) {
            memcpy(&value, head + at + length + sizeof kind, sizeof value);
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return value;
}

/* Saves a depth image and checks the time and the width of the full frame that the file has. */
static void saved_as(BhrContext *context, const BhrImage *image, const char *path, double time, double full, int line) {
    const BhrOutput output = output_of(BHR_OUTPUT_DEPTH, 0, image);
    if (CHECK_OK(bhr_save_outputs(context, &output, sizeof output, 1, path))) {
        const double found = attribute_of(path, "bhr.time"), width = attribute_of(path, "bhr.region.full_width");
        CHECK(found == time && width == full, "line %d: the file has the time %g and the width %g, not %g and %g", line,
              found, width, time, full);
        remove(path);
    }
}

/* A file has the scene of the frame that its pixels are of, whatever the scene is when it is saved. */
static void scenes_of_frames(BhrContext *context, const char *folder) {
    static float    pixels[3][PIXELS], light[PIXELS * 4];
    const BhrRegion region = {sizeof region, 4 * WIDTH, 4 * HEIGHT, 16, 8, 0};
    BhrImage        depth[3];
    BhrOutput       each[3];
    BhrJob         *jobs[2] = {NULL, NULL};
    char            path[512];
    snprintf(path, sizeof path, "%s/scene.exr", folder);
    for (size_t i = 0; i < 3; i++) {
        depth[i] = image_of(BHR_FORMAT_R32F, WIDTH, HEIGHT, pixels[i], sizeof pixels[i]);
        each[i] = output_of(BHR_OUTPUT_DEPTH, 0, &depth[i]);
    }
    /* Two frames; the older one is saved last. */
    CHECK_OK(bhr_set_time(context, 1.5));
    CHECK_OK(bhr_render_outputs(context, &each[0], sizeof *each, 1, NULL));
    CHECK_OK(bhr_set_time(context, 2.5));
    CHECK_OK(bhr_render_outputs(context, &each[1], sizeof *each, 1, NULL));
    CHECK_OK(bhr_set_time(context, 3.5));
    saved_as(context, &depth[1], path, 2.5, WIDTH, __LINE__);
    saved_as(context, &depth[0], path, 1.5, WIDTH, __LINE__);
    /* Pixels of no frame: the scene as it is. */
    saved_as(context, &depth[2], path, 3.5, WIDTH, __LINE__);
    /* Jobs that end in another scene than they were ordered in, one of them a part of its frame. */
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_OK(bhr_render_outputs(context, &each[1], sizeof *each, 1, &jobs[0]));
    CHECK_OK(bhr_set_time(context, 4.5));
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK_OK(bhr_render_outputs(context, &each[2], sizeof *each, 1, &jobs[1]));
    CHECK_OK(bhr_set_time(context, 5.5));
    for (size_t i = 0; i < 2; i++) {
        CHECK_OK(bhr_job_wait(jobs[i], UINT64_MAX, NULL));
        bhr_job_destroy(jobs[i]);
    }
    saved_as(context, &depth[1], path, 3.5, 4 * WIDTH, __LINE__);
    saved_as(context, &depth[2], path, 4.5, WIDTH, __LINE__);
    saved_as(context, &depth[0], path, 1.5, WIDTH, __LINE__);
    /* A picture of bhr_render_image takes the place of what was in its memory. */
    const BhrImage  picture = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, light, sizeof light);
    const BhrOutput both[] = {output_of(BHR_OUTPUT_LIGHT, 0, &picture), each[0]};
    CHECK_OK(bhr_render_outputs(context, both, sizeof *both, 2, NULL));
    CHECK_OK(bhr_set_time(context, 6.5));
    CHECK_OK(bhr_render_image(context, &picture));
    CHECK_OK(bhr_set_time(context, 0.0));
    CHECK_OK(bhr_save_outputs(context, both, sizeof *both, 2, path));
    CHECK(attribute_of(path, "bhr.time") == 6.5, "a picture's file has the time %g", attribute_of(path, "bhr.time"));
    remove(path);
    /* A refused frame changes no pixel, and the scene of none. */
    BhrImage wrong = depth[0];
    wrong.format = BHR_FORMAT_RGBA32F;
    wrong.width = 1;
    const BhrOutput refused = output_of(BHR_OUTPUT_DEPTH, 0, &wrong);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "format", bhr_render_outputs(context, &refused, sizeof refused, 1, NULL));
    saved_as(context, &depth[0], path, 5.5, WIDTH, __LINE__);
}

static void check_bad(Watch *watch, const BhrOutput *bad, uint32_t count, const char *words, int line) {
    BhrJob *job = (BhrJob *)&job;
    for (int async = 0; async <= 1; async++) {
        check_mark_message();
        const BhrStatus status = bhr_render_outputs(watch->context, bad, sizeof *bad, count, async ? &job : NULL);
        check_fails(status, BHR_ERROR_INVALID_ARGUMENT, words, __FILE__, line, "bhr_render_outputs");
    }
    CHECK(job == NULL, "line %d: a job that was refused is not NULL", line);
    check_mark_message();
    check_fails(bhr_save_outputs(watch->context, bad, sizeof *bad, count, "/absent/bad.exr"),
                BHR_ERROR_INVALID_ARGUMENT, words, __FILE__, line, "bhr_save_outputs");
    check_unchanged(watch, __FILE__, line, "bhr_render_outputs");
    CHECK(all_untouched(blocks, sizeof blocks), "line %d: refused outputs were written to", line);
}
#define CHECK_BAD(bad, count, words) check_bad(watch, (bad), (count), (words), __LINE__)

/* Each field of each, one at a time. */
static void fields(Watch *watch) {
    for (size_t i = 0; i < COUNT_OF(outputs); i++) {
        fresh();
        BhrOutput bad = outputs[i];
        bad.reserved = 1;
        CHECK_BAD(&bad, 1, "reserved");
        bad = outputs[i];
        bad.target = &bad;
        CHECK_BAD(&bad, 1, "target");
        bad = outputs[i];
        bad.image = NULL;
        CHECK_BAD(&bad, 1, "NULL");
        bad = outputs[i];
        bad.index = every[i] == BHR_OUTPUT_VIEW ? 8 : every[i] >= BHR_OUTPUT_POSITION ? 16 : 1;
        CHECK_BAD(&bad, 1, "index");
        bad.index = UINT32_MAX;
        CHECK_BAD(&bad, 1, "index");
        bad = outputs[i];
        bad.struct_size = sizeof bad - 1;
        CHECK_BAD(&bad, 1, "struct_size");
        bad.struct_size = sizeof bad + 1;
        CHECK_BAD(&bad, 1, "struct_size");
        bad.struct_size = 0;
        CHECK_BAD(&bad, 1, "struct_size");
        images[i].byte_size--;
        CHECK_BAD(&outputs[i], 1, "byte_size");
        fresh();
        images[i].pixels = NULL;
        CHECK_BAD(&outputs[i], 1, "pixels");
        fresh();
        images[i].format = format_of(every[i]) == BHR_FORMAT_R32F ? BHR_FORMAT_RGBA32F : BHR_FORMAT_R32F;
        images[i].byte_size = sizeof blocks[i];
        CHECK_BAD(&outputs[i], 1, "format");
        images[i].format = 99;
        CHECK_BAD(&outputs[i], 1, "format");
    }
    fresh();
    static const BhrOutputKind unknown[] = {-1, 7, INT32_MAX, INT32_MIN};
    for (size_t i = 0; i < COUNT_OF(unknown); i++) {
        BhrOutput bad = outputs[0];
        bad.kind = unknown[i];
        CHECK_BAD(&bad, 1, "kind");
    }
    BhrOutput light = outputs[6];
    light.index = BHR_VIEW_LIGHT;
    CHECK_BAD(&light, 1, "LIGHT");
}

/* Counts, sizes of elements, pictures of several sizes, and pointers. */
static void arrays(Watch *watch) {
    BhrContext *context = watch->context;
    fresh();
    CHECK_BAD(outputs, 0, "count");
    CHECK_BAD(outputs, BHR_MAX_OUTPUTS + 1, "count");
    CHECK_BAD(outputs, UINT32_MAX, "count");
    images[3].height--;
    CHECK_BAD(outputs, 4, "outputs\\[3\\]|size");
    fresh();
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "outputs", bhr_render_outputs(context, NULL, sizeof *outputs, 1, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_render_outputs(NULL, outputs, sizeof *outputs, 1, NULL));
    static const size_t sizes[] = {0, 1, FIRST_OUTPUT - 1, 1 << 20, SIZE_MAX};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "output_size",
                      bhr_render_outputs(context, outputs, sizes[i], 1, NULL));
    }
    const BhrRegion region = {sizeof region, WIDTH + 1, HEIGHT, 2, 0, 0};
    CHECK_OK(bhr_set_region(context, &region));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "region",
                bhr_render_outputs(context, &outputs[1], sizeof *outputs, 1, NULL));
    CHECK_OK(bhr_set_region(context, NULL));
    CHECK(all_untouched(blocks, sizeof blocks), "refused outputs were written to");
    BhrOutput output;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "NULL", bhr_output_init(NULL, sizeof output));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_output_init(&output, FIRST_OUTPUT - 1));
    /* A host of a later header: its elements are larger, and 0 beyond what this library knows. */
    struct {
        BhrOutput known;
        uint64_t  later;
    } larger[2] = {{outputs[1], 0}, {outputs[2], 0}};
    larger[0].known.struct_size = larger[1].known.struct_size = sizeof larger[0];
    CHECK_OK(bhr_render_outputs(context, &larger[0].known, sizeof larger[0], 2, NULL));
    fresh();
    larger[1].later = 1;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "not 0",
                bhr_render_outputs(context, &larger[0].known, sizeof larger[0], 2, NULL));
    CHECK(all_untouched(blocks, sizeof blocks), "refused outputs were written to");
}

/* A camera that cannot be where it is fails as a picture's does. */
static void impossible(BhrContext *context) {
    BhrCamera good = {0}, inside;
    good.struct_size = sizeof good;
    CHECK_OK(bhr_get_camera(context, &good));
    inside = good;
    inside.position[0] = inside.position[1] = 0.0;
    inside.position[2] = 1.5;
    CHECK_OK(bhr_set_camera(context, &inside));
    fresh();
    BhrJob *job = NULL;
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "horizon", bhr_render_outputs(context, outputs, sizeof *outputs, 7, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "horizon", bhr_render_outputs(context, outputs, sizeof *outputs, 7, &job));
    CHECK(job == NULL && all_untouched(blocks, sizeof blocks), "outputs of a camera that cannot be");
    CHECK_OK(bhr_set_camera(context, &good));
}

/* Things before the camera: all of the picture, half of it, none; and distances that are none. */
static void occluders(Watch *watch) {
    static float         distances[PIXELS];
    static unsigned char whole[PIXELS * 4], seen[PIXELS * 4];
    BhrContext          *context = watch->context;
    BhrImage             picture = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, whole, sizeof whole);
    BhrImage             given = image_of(BHR_FORMAT_R32F, WIDTH, HEIGHT, distances, sizeof distances);
    picture.flags = BHR_IMAGE_TRANSPARENT;
    CHECK_OK(bhr_render_image(context, &picture));
    for (size_t i = 0; i < PIXELS; i++) {
        distances[i] = i % WIDTH < WIDTH / 2 ? 0.0f : INFINITY;
    }
    CHECK_OK(bhr_set_occluder(context, &given));
    memset(distances, 0, sizeof distances); /* it was copied */
    picture.pixels = seen;
    CHECK_OK(bhr_render_image(context, &picture));
    size_t hidden = 0, differ = 0;
    for (size_t i = 0; i < PIXELS * 4; i++) {
        const int before = i / 4 % WIDTH < WIDTH / 2;
        hidden += before && seen[i] != 0;
        differ += !before && abs(seen[i] - whole[i]) > 2;
    }
    CHECK(hidden == 0 && differ < 20, "%u bytes seen behind things, %u changed beside them", (unsigned)hidden,
          (unsigned)differ);
    BhrJob *job = NULL;
    memset(seen, UNTOUCHED, sizeof seen);
    CHECK_OK(bhr_render_image_async(context, &picture, &job));
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    CHECK(seen[0] == 0, "a job does not regard things");
    BhrImage smaller = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH - 1, HEIGHT, seen, sizeof seen);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "occluder is 40 x 24", bhr_render_image(context, &smaller));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "occluder", bhr_render_image_async(context, &smaller, &job));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "occluder", bhr_prepare(context, &smaller));
    BhrVolume volume;
    CHECK_OK(bhr_volume_init(&volume, sizeof volume));
    CHECK_OK(bhr_set_volumes(context, &volume, sizeof volume, 1));
    memset(seen, UNTOUCHED, sizeof seen);
    CHECK_OK(bhr_render_image(context, &picture));
    CHECK(seen[0] == 0 && seen[3] == 0, "matter is seen behind things: %d %d", seen[0], seen[3]);
    CHECK_OK(bhr_set_volumes(context, NULL, sizeof volume, 0));
    CHECK_OK(bhr_set_occluder(context, NULL));
    static const float bad[] = {-1.0f, -0.001f, -INFINITY, NAN};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        distances[WIDTH + 3] = bad[i];
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "distance at (3, 1)", bhr_set_occluder(context, &given));
    }
    distances[WIDTH + 3] = 0.0f;
    BhrImage wrong = given;
    wrong.format = BHR_FORMAT_RGBA8_SRGB;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "R32F", bhr_set_occluder(context, &wrong));
    wrong = given;
    wrong.byte_size--;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "byte_size", bhr_set_occluder(context, &wrong));
    wrong = given;
    wrong.pixels = NULL;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "pixels", bhr_set_occluder(context, &wrong));
    wrong = given;
    wrong.struct_size = 3;
    CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_set_occluder(context, &wrong));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_occluder(NULL, &given));
}

static int32_t stop(void *user, double fraction) {
    *(double *)user = fraction;
    return fraction < 0.5;
}

static void cancelled(BhrContext *context) {
    double told = 0.0;
    CHECK_OK(bhr_set_progress(context, stop, &told));
    fresh();
    CHECK_FAILS(BHR_ERROR_CANCELLED, "cancelled", bhr_render_outputs(context, outputs, sizeof *outputs, 7, NULL));
    CHECK(told >= 0.5 && told < 1.0, "cancelled at %g", told);
    CHECK_OK(bhr_set_progress(context, NULL, NULL));
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    BhrContext      *context = check_context(backend);
    Watch            watch;
    every_kind(context);
    ways(context);
    layers(context, argc > 2 ? argv[2] : ".");
    scenes_of_frames(context, argc > 2 ? argv[2] : ".");
    watch_begin(&watch, context);
    fields(&watch);
    arrays(&watch);
    occluders(&watch);
    impossible(context);
    cancelled(context);
    bhr_context_destroy(context);
    return check_end();
}
