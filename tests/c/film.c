#include <stdlib.h>
/* film.c -- the film: 8-bit images are exposed, bloom, and are mapped; float images are left alone; bloom needs the
 * whole frame. Numbers out of range are in bad_scene.c. */
#include "check.h"

#include <string.h>

#define WIDTH 64u
#define HEIGHT 40u
#define MOST_BYTES (WIDTH * HEIGHT * 16u)

static unsigned char before[MOST_BYTES], after[MOST_BYTES];

static void set_film(BhrContext *context, BhrToneMap tone_map, double exposure_ev, double bloom) {
    BhrFilm film;
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.tone_map = tone_map;
    film.exposure_ev = exposure_ev;
    film.bloom = bloom;
    CHECK_OK(bhr_set_film(context, &film));
    BhrFilm got;
    CHECK_OK(bhr_film_init(&got, sizeof got));
    CHECK_OK(bhr_get_film(context, &got));
    CHECK(got.bloom == bloom && got.exposure_ev == exposure_ev && got.tone_map == tone_map,
          "another film than was set");
}

static size_t render(BhrContext *context, BhrFormat format, uint32_t flags, unsigned char *pixels) {
    const size_t bytes = WIDTH * HEIGHT * bytes_per_pixel(format);
    BhrImage     image = image_of(format, WIDTH, HEIGHT, pixels, bytes);
    image.flags = flags;
    CHECK_OK(bhr_render_image(context, &image));
    return bytes;
}

static void floats_are_left_alone(BhrContext *context) {
    static const BhrFormat formats[] = {BHR_FORMAT_RGBA16F, BHR_FORMAT_RGBA32F};
    for (size_t i = 0; i < COUNT_OF(formats); i++) {
        set_film(context, BHR_TONE_MAP_NONE, 0.0, 0.0);
        const size_t bytes = render(context, formats[i], 0, before);
        set_film(context, BHR_TONE_MAP_AGX, 4.0, 1.0);
        render(context, formats[i], 0, after);
        CHECK(memcmp(before, after, bytes) == 0, "format %d: film changes linear radiance", (int)formats[i]);
    }
}

static void eight_bits_bloom(BhrContext *context) {
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 0.0);
    const size_t bytes = render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 1.0);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    size_t lifted = 0;
    for (size_t i = 0; i < bytes; i += 4) {
        lifted += before[i] == 0 && after[i] > 4;
    }
    CHECK(lifted > 50, "bloom lights %u black pixels only", (unsigned)lifted);
    memcpy(before, after, bytes);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(memcmp(before, after, bytes) == 0, "two frames with bloom differ");

    BhrJob        *job = NULL;
    const BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, after, bytes);
    memset(after, UNTOUCHED, sizeof after);
    CHECK_OK(bhr_render_image_async(context, &image, &job));
    CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
    bhr_job_destroy(job);
    CHECK(memcmp(before, after, bytes) == 0, "a job's frame with bloom differs");
}

/* Glare adds light; alpha is still what the hole and the disk cover. */
static void transparent_images(BhrContext *context) {
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 0.0);
    const size_t bytes = render(context, BHR_FORMAT_BGRA8_SRGB, BHR_IMAGE_TRANSPARENT, before);
    set_film(context, BHR_TONE_MAP_ACES, 2.0, 1.0);
    render(context, BHR_FORMAT_BGRA8_SRGB, BHR_IMAGE_TRANSPARENT, after);
    size_t same = 0, glare = 0;
    for (size_t i = 0; i < bytes; i += 4) {
        /* Light that spreads is kept in half floats, alpha with it. */
        same += abs(before[i + 3] - after[i + 3]) <= 1;
        glare += after[i + 3] == 0 && after[i + 2] > 4;
    }
    CHECK(same == WIDTH * HEIGHT, "bloom keeps the alpha of %u pixels only", (unsigned)same);
    CHECK(glare > 100, "glare shows on %u open pixels only", (unsigned)glare);
}

/* Refused where it would matter, and only there. */
static void regions(BhrContext *context) {
    const BhrRegion region = {.struct_size = sizeof region, .full_width = 2 * WIDTH, .full_height = HEIGHT, .x = 5};
    const size_t    bytes = WIDTH * HEIGHT * 4;
    const BhrImage  image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, after, bytes);
    BhrJob         *job = (BhrJob *)after;
    set_film(context, BHR_TONE_MAP_ACES, 0.0, 0.5);
    CHECK_OK(bhr_set_region(context, &region));
    memset(after, UNTOUCHED, sizeof after);
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bloom is 0.5", bhr_render_image(context, &image));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "bloom is 0.5", bhr_render_image_async(context, &image, &job));
    CHECK(job == NULL, "out_job is not NULL after a failure");
    CHECK(all_untouched(after, sizeof after), "a refused image was written to");
    render(context, BHR_FORMAT_RGBA32F, 0, after);
    CHECK_OK(bhr_set_view(context, BHR_VIEW_ORDER));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    set_film(context, BHR_TONE_MAP_ACES, 0.0, 0.0);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    set_film(context, BHR_TONE_MAP_ACES, 0.0, 0.5);
    CHECK_OK(bhr_set_region(context, NULL));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
}

int main(int argc, char **argv) {
    BhrContext *context = check_context(check_begin(argc, argv));
    floats_are_left_alone(context);
    eight_bits_bloom(context);
    transparent_images(context);
    regions(context);
    bhr_context_destroy(context);
    return check_end();
}
