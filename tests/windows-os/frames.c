/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* frames.c -- one frame and 256 rays of one scene, as bytes, to be compared with those of another system's library.
 *
 *     frames BACKEND PREFIX [OTHER]       writes PREFIX.pixels and PREFIX.hits, and compares the rays with OTHER.hits
 *
 * The script compares the pixels. Rays end where the other system's do, but for what its sine and logarithm leave.
 */
#include "../c/check.h"

#include <math.h>
#include <stdio.h>

enum { WIDTH = 320, HEIGHT = 180, SIDE = 16 };

static void write_file(const char *prefix, const char *end, const void *bytes, size_t size) {
    char name[1000];
    snprintf(name, sizeof name, "%s.%s", prefix, end);
    FILE *file = fopen(name, "wb");
    if (CHECK(file != NULL, "%s was not made", name)) {
        CHECK(fwrite(bytes, 1, size, file) == size, "%s was not written", name);
        CHECK(fclose(file) == 0, "%s was not written", name);
    }
}

static void compare(const char *other, const BhrHit *hits, double tolerance) {
    static BhrHit theirs[SIDE * SIDE];
    char          name[1000];
    double        largest = 0.0;
    int           fates = 0;
    snprintf(name, sizeof name, "%s.hits", other);
    FILE *file = fopen(name, "rb");
    if (!CHECK(file != NULL && fread(theirs, sizeof *theirs, SIDE * SIDE, file) == SIDE * SIDE, "%s", name)) return;
    fclose(file);
    for (int i = 0; i < SIDE * SIDE; i++) {
        fates += hits[i].fate != theirs[i].fate || hits[i].crossing_count != theirs[i].crossing_count;
        for (int axis = 0; axis < 3; axis++)
            largest = fmax(largest, fabs(hits[i].sky_direction[axis] - theirs[i].sky_direction[axis]));
        for (uint32_t c = 0; c < hits[i].crossing_count && c < BHR_MAX_CROSSINGS; c++)
            largest = fmax(largest, fabs(hits[i].crossings[c].radius / theirs[i].crossings[c].radius - 1.0));
    }
    printf("rays: %d end otherwise; the largest difference of the others is %.1e\n", fates, largest);
    CHECK(fates == 0 && largest <= tolerance, "%d, %g", fates, largest);
}

int main(int argc, char **argv) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    static BhrRay        rays[SIDE * SIDE];
    static BhrHit        hits[SIDE * SIDE];
    BhrContext          *context = NULL;
    BhrCamera            camera;
    BhrAdapterInfo       adapter;
    BhrContextOptions    options = check_options(check_begin(argc, argv));
    if (argc < 3) return 2;

    /* The default scene, which is not check_context's: with its disk's turbulence and the Milky Way. */
    if (!CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &context))) return check_end();
    BHR_INIT(adapter);
    CHECK_OK(bhr_context_adapter(context, &adapter));
    printf("%s, %s\n", adapter.name, adapter.driver);
    BHR_INIT(camera);
    CHECK_OK(bhr_camera_orbit(&camera, 25.0, 0.0, 0.15));
    CHECK_OK(bhr_set_spin(context, 0.9));
    CHECK_OK(bhr_set_camera(context, &camera));

    BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    CHECK_OK(bhr_render_image(context, &image));
    size_t lit = 0;
    for (size_t i = 0; i < sizeof pixels; i += 4) lit += pixels[i] > 64;
    CHECK(lit > WIDTH * HEIGHT / 50, "the frame is dark: %lu pixels are lit", (unsigned long)lit);
    CHECK_OK(bhr_camera_rays(context, SIDE, SIDE, rays));
    CHECK_OK(bhr_trace_rays(context, rays, sizeof *rays, SIDE * SIDE, hits, sizeof *hits));
    write_file(argv[2], "pixels", pixels, sizeof pixels);
    write_file(argv[2], "hits", hits, sizeof hits);
    if (argc > 3) compare(argv[3], hits, options.backend == BHR_BACKEND_CPU ? 1e-12 : 1e-5);

    /* A job renders it again. */
    static unsigned char again[sizeof pixels];
    BhrJob              *job = NULL;
    image.pixels = again;
    if (CHECK_OK(bhr_render_image_async(context, &image, &job))) CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    size_t other = 0;
    for (size_t i = 0; i < sizeof pixels; i++) other += pixels[i] != again[i];
    CHECK(other == 0, "%lu bytes of the job's frame are others", (unsigned long)other);
    bhr_context_destroy(context);
    return check_end();
}
