/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* fragment.c -- the program around a piece of C that a page of docs/ shows without its main. The piece, FRAGMENT, finds
 * a context on the CPU tracer, a camera, and an image of its pixels, and may make structs and blocks of its own. After
 * it a frame is rendered: what the piece has set must go together. No call may have failed, as pages leave out what a
 * program does about failures.
 *
 * With ON_THE_GPU the context is on Vulkan, and the piece finds the UUID of the host's GPU, which is the context's. */
#define _POSIX_C_SOURCE 200809L /* posix_memalign, close */
#ifdef ON_THE_GPU
#include <bhr_interop.h>
#define BACKEND BHR_BACKEND_VULKAN
#else
#include <bhr.h>
#define BACKEND BHR_BACKEND_CPU
#endif
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WIDTH = 64, HEIGHT = 32 };
static unsigned char pixels[WIDTH * HEIGHT * 4];

int main(void) {
    BhrContext *context = NULL;
    BhrContextOptions chosen;
    BhrCamera camera;
    BhrImage image;
    bhr_context_options_init(&chosen, sizeof chosen);
    chosen.backend = BACKEND;
    if (bhr_context_create(BHR_ABI_VERSION, &chosen, &context) < 0) return 2;
    bhr_set_sky(context, NULL); /* the Milky Way takes a second to make */
    bhr_camera_init(&camera, sizeof camera);
    bhr_image_init(&image, sizeof image);
    image.width = WIDTH, image.height = HEIGHT;
    image.pixels = pixels, image.byte_size = sizeof pixels;
#ifdef ON_THE_GPU
    uint8_t uuid[16];
    BhrInteropInfo known = {.struct_size = sizeof known};
    if (bhr_interop_info(context, &known) < 0) return 2;
    memcpy(uuid, known.device_uuid, sizeof uuid);
#endif
    {
#include FRAGMENT
    }
    bhr_render_image(context, &image);
    bhr_context_destroy(context);
    if (bhr_error_message()[0] != 0) fprintf(stderr, "%s\n", bhr_error_message());
    return bhr_error_message()[0] != 0;
}
