/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* lifetimes.c -- creates, renders and destroys again and again, and watches what the process holds. Its second
 * argument is the number of cycles (default 120); up to WARM_UP nothing is measured, for valgrind, which counts
 * better.
 *
 * The CPU tracer must not grow. A Vulkan driver may leak by itself, so there the bound is its own:
 * MAX_GROWTH_OF_DRIVER a cycle. */

#include "check.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WARM_UP 10
#define MAX_GROWTH_ON_CPU (16 << 10)       /* bytes a cycle; measured: less than 1 KiB */
#define MAX_GROWTH_OF_DRIVER (32 << 10)    /* bytes a cycle; lavapipe (Mesa 22.3): nothing measured */

/* Bytes that the process has taken from the heap and not given back; 0 where the C library does not say. Not the
 * resident memory: of that the heap keeps tens of megabytes, or gives them back, as its last pieces happen to lie. */
static long held_bytes(void) {
#ifdef __GLIBC__
    const struct mallinfo2 heap = mallinfo2();
    return (long)(heap.uordblks + heap.hblkhd);
#else
    return 0;
#endif
}

static void cycle(BhrBackend backend) {
    static unsigned char pixels[48 * 32 * 4], first[48 * 32 * 4];
    static int           have_first;
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 48, 32, pixels, sizeof pixels);
    BhrContext          *context = check_context(backend);
    CHECK_OK(bhr_render_image(context, &image));
    CHECK(bhr_set_mass(context, -1.0) == BHR_ERROR_INVALID_ARGUMENT, "mass -1 was taken");
    if (!have_first) {
        memcpy(first, pixels, sizeof first);
        have_first = 1;
    }
    CHECK(memcmp(first, pixels, sizeof first) == 0, "the frame differs from the first cycle's");
    bhr_context_destroy(context);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    const int        cycles = argc > 2 ? atoi(argv[2]) : 120;
    long             before = 0;
    for (int i = 0; i < cycles; i++) {
        if (i == WARM_UP) {
            before = held_bytes();
        }
        cycle(backend);
    }
    if (cycles > WARM_UP) {
        const long after = held_bytes();
        const long bound =
            (cycles - WARM_UP) * (long)(backend == BHR_BACKEND_CPU ? MAX_GROWTH_ON_CPU : MAX_GROWTH_OF_DRIVER);
        printf("held: %ld KiB after %d cycles, %ld KiB after %d\n", before >> 10, WARM_UP, after >> 10, cycles);
        CHECK(before > 0 && after > 0, "no heap to measure");
        CHECK(after - before <= bound, "grew by %ld KiB; at most %ld KiB are granted", (after - before) >> 10,
              bound >> 10);
    }
    return check_end();
}
