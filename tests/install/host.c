/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* host.c -- the smallest host that knows whether it got a picture: one frame on the CPU tracer, with the shadow's
 * darkness and the disk's light in it. Compiled as C and as C++; linked as tests/install/run says. With ANOTHER defined
 * it also calls another Rust library, before and after. */
#include <bhr.h>
#include <stdio.h>
#include <string.h>

#ifdef ANOTHER
#ifdef __cplusplus
extern "C"
#endif
long long another_sum(unsigned count);
#else
#define another_sum(count) 499500
#endif

enum { WIDTH = 64, HEIGHT = 36 };

static unsigned char pixels[HEIGHT][WIDTH][4];

static int failed(const char *what) {
    fprintf(stderr, "%s: %s\n", what, bhr_error_message());
    return 1;
}

int main(void) {
    BhrContextOptions options;
    BhrContext *context;
    BhrCamera camera;
    BhrImage image;
    int x, y, dark = 0, bright = 0;
    if (another_sum(1000) != 499500) return failed("the other library failed");
    if (bhr_abi_version() != BHR_ABI_VERSION) return failed("the library has another ABI");
    bhr_context_options_init(&options, sizeof options);
    options.backend = BHR_BACKEND_CPU;
    if (bhr_context_create(BHR_ABI_VERSION, &options, &context) < 0) return failed("no context");
    bhr_camera_init(&camera, sizeof camera);
    bhr_camera_orbit(&camera, 25.0, 0.0, 0.15);
    bhr_image_init(&image, sizeof image);
    image.width = WIDTH;
    image.height = HEIGHT;
    image.pixels = pixels;
    image.byte_size = sizeof pixels;
    if (bhr_set_camera(context, &camera) < 0 || bhr_render_image(context, &image) < 0) return failed("no frame");
    bhr_context_destroy(context);
    for (y = 0; y < HEIGHT; y++) {
        for (x = 0; x < WIDTH; x++) {
            dark += pixels[y][x][0] + pixels[y][x][1] + pixels[y][x][2] < 24 && pixels[y][x][3] == 255;
            bright += pixels[y][x][0] > 160;
        }
    }
    printf("bhr %s: %d dark pixels, %d bright ones\n", bhr_version_string(), dark, bright);
    if (another_sum(1000) != 499500) return failed("the other library failed after the frame");
    if (bhr_camera_init(NULL, sizeof camera) >= 0 || strlen(bhr_error_message()) == 0) return failed("no refusal");
    return dark < 20 || bright < 20;
}
