/* lifetimes.c -- creates, renders and destroys again and again, and watches the process's resident memory. Its second
 * argument is the number of cycles (default 200); below 100 nothing is measured, for valgrind, which counts better.
 *
 * The CPU tracer must not grow: what glibc's arenas keep after 40 cycles is enough for all that follow. A Vulkan
 * driver leaks by itself (lavapipe keeps compiled code of some submits), so there the bound is its own:
 * MAX_GROWTH_OF_DRIVER a cycle. */

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WARM_UP 40
#define MAX_GROWTH_ON_CPU (2 << 20)       /* bytes over all measured cycles */
#define MAX_GROWTH_OF_DRIVER (32 << 10)   /* bytes a cycle; lavapipe (Mesa 22.3): less than 1 KiB measured */

/* Bytes of the process's own memory that are resident now; 0 where /proc does not say. Not the pages of files, such as
 * those of the driver's compiler: the kernel takes them away and brings them back as it likes. */
static long resident_bytes(void) {
    char  line[256];
    long  kibibytes = 0;
    FILE *file = fopen("/proc/self/status", "r");
    if (file == NULL) {
        return 0;
    }
    while (fgets(line, sizeof line, file) != NULL && sscanf(line, "RssAnon: %ld", &kibibytes) != 1) {
    }
    fclose(file);
    return kibibytes << 10;
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
    const int        cycles = argc > 2 ? atoi(argv[2]) : 200;
    long             before = 0;
    for (int i = 0; i < cycles; i++) {
        if (i == WARM_UP) {
            before = resident_bytes();
        }
        cycle(backend);
    }
    if (cycles >= 100) {
        const long after = resident_bytes();
        const long bound =
            backend == BHR_BACKEND_CPU ? MAX_GROWTH_ON_CPU : MAX_GROWTH_OF_DRIVER * (long)(cycles - WARM_UP);
        printf("resident: %ld KiB after %d cycles, %ld KiB after %d\n", before >> 10, WARM_UP, after >> 10, cycles);
        CHECK(before > 0 && after > 0, "no RssAnon in /proc/self/status to measure with");
        CHECK(after - before <= bound, "grew by %ld KiB; at most %ld KiB are granted", (after - before) >> 10,
              bound >> 10);
    }
    return check_end();
}
