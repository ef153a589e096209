/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* unwinds.c -- a host in which the library panics: clock_gettime fails, which Rust's standard library takes for
 * impossible. The panic must unwind through the library and end in a status. */
#include <bhr.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static volatile int clock_fails;

/* Stands before the C library's function of this name, for this program and for the libraries that it links. */
int clock_gettime(clockid_t clock, struct timespec *now) {
    return clock_fails ? -1 : (int)syscall(SYS_clock_gettime, clock, now);
}

static unsigned char pixels[36][64][4];

int main(void) {
    BhrContextOptions options;
    BhrContext *context;
    BhrImage image;
    BhrStatus status;
    bhr_context_options_init(&options, sizeof options);
    options.backend = BHR_BACKEND_CPU;
    if (bhr_context_create(BHR_ABI_VERSION, &options, &context) < 0) return 1;
    bhr_image_init(&image, sizeof image);
    image.width = 64;
    image.height = 36;
    image.pixels = pixels;
    image.byte_size = sizeof pixels;
    clock_fails = 1;
    status = bhr_render_image(context, &image);
    clock_fails = 0;
    printf("%s: %s\n", bhr_status_name(status), bhr_error_message());
    if (status != BHR_ERROR_INTERNAL || strstr(bhr_error_message(), "panic") == NULL) return 1;
    bhr_context_destroy(context);
    return 0;
}
