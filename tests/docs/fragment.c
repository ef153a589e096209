/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* fragment.c -- the program around a piece of C that a page of docs/ shows without its main. The piece, FRAGMENT, finds
 * a context on the CPU tracer, a camera, and an image of its pixels, and may make structs and blocks of its own. After
 * it a frame is rendered: what the piece has set must go together. No call may have failed, as pages leave out what a
 * program does about failures. */
#include <bhr.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 64, HEIGHT = 32 };
static unsigned char pixels[WIDTH * HEIGHT * 4];

int main(void) {
    BhrContext *context = NULL;
    BhrContextOptions cpu;
    BhrCamera camera;
    BhrImage image;
    bhr_context_options_init(&cpu, sizeof cpu);
    cpu.backend = BHR_BACKEND_CPU;
    if (bhr_context_create(BHR_ABI_VERSION, &cpu, &context) < 0) return 2;
    bhr_set_sky(context, NULL); /* the Milky Way takes a second to make */
    bhr_camera_init(&camera, sizeof camera);
    bhr_image_init(&image, sizeof image);
    image.width = WIDTH, image.height = HEIGHT;
    image.pixels = pixels, image.byte_size = sizeof pixels;
    {
#include FRAGMENT
    }
    bhr_render_image(context, &image);
    bhr_context_destroy(context);
    if (bhr_error_message()[0] != 0) fprintf(stderr, "%s\n", bhr_error_message());
    return bhr_error_message()[0] != 0;
}
