/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* images.c -- frames for targets that write images in the host's memory as well, and wait for what the host signals
 * later: no call waits for that; an image is complete when the job is, and the host's again once that is destroyed.
 * Arguments: vulkan [validate]. */
#include "../c/check.h"
#include "vk.h"

#include <string.h>

#define WIDTH 107u
#define HEIGHT 45u

static BhrContext   *context;
static unsigned char depths[WIDTH * HEIGHT * 4], expected[WIDTH * HEIGHT * 4];

static BhrTarget *target(void) {
    BhrTargetOptions options;
    BhrTarget       *made = NULL;
    CHECK_OK(bhr_target_options_init(&options, sizeof options));
    options.kind = BHR_TARGET_IMAGE;
    options.format = BHR_FORMAT_RGBA16F;
    options.width = WIDTH;
    options.height = HEIGHT;
    CHECK_OK(bhr_target_create(context, &options, &made));
    return made;
}

/* The picture into a target. */
static BhrOutput lit(BhrTarget *light) {
    BhrOutput output;
    CHECK_OK(bhr_output_init(&output, sizeof output));
    output.target = light;
    return output;
}

/* The depth into the host's memory. */
static BhrOutput imaged(BhrImage *image, void *pixels) {
    BhrOutput output;
    CHECK_OK(bhr_output_init(&output, sizeof output));
    CHECK_OK(bhr_image_init(image, sizeof *image));
    image->format = BHR_FORMAT_R32F;
    image->width = WIDTH;
    image->height = HEIGHT;
    image->pixels = pixels;
    image->byte_size = sizeof depths;
    output.kind = BHR_OUTPUT_DEPTH;
    output.image = image;
    return output;
}

/* A frame that waits for what the host signals later: the call does not, nor does the job's end; images are complete
 * when the job is, and are the host's again once it is destroyed. */
static void images_wait(void) {
    BhrTarget    *light = target();
    BhrSemaphore *line;
    BhrImage      image;
    CHECK_OK(bhr_semaphore_create(context, BHR_SEMAPHORE_TIMELINE, 0, &line));
    BhrOutput in_memory = imaged(&image, expected);
    CHECK_OK(bhr_render_outputs(context, &in_memory, sizeof in_memory, 1, NULL));
    for (uint64_t turn = 0; turn < 6; turn++) {
        int               async = turn % 2, destroyed = turn / 2 == 1, alone = turn / 2 == 2;
        BhrSemaphoreValue wait = {line, 3 * turn + 1}, signal = {line, 3 * turn + 2};
        BhrSync   sync = {.struct_size = sizeof sync, .wait_count = 1, .signal_count = 1, .waits = &wait};
        BhrOutput list[2] = {imaged(&image, depths), lit(light)};
        BhrJob   *job = NULL, *after = NULL;
        double    fraction;
        size_t    bytes = sizeof depths;
        sync.signals = &signal;
        memset(depths, 0x77, bytes);
        CHECK_OK(async ? bhr_render_outputs_shared_async(context, list, sizeof *list, 2 - alone, &sync, &job)
                       : bhr_render_outputs_shared(context, list, sizeof *list, 2 - alone, &sync, &job));
        BhrStatus status = bhr_job_wait(job, 20000000, &fraction);
        CHECK(status == BHR_NOT_READY, "the frame did not wait: status %d", (int)status);
        for (size_t i = 0; i < bytes; i++)
            if (depths[i] != 0x77) {
                CHECK(0, "turn %u: byte %zu was written before the frame ran", (unsigned)turn, i);
                break;
            }
        if (destroyed)
            bhr_job_destroy(job);
        CHECK_OK(bhr_semaphore_signal(line, wait.value));
        if (!destroyed) {
            CHECK_OK(bhr_job_wait(job, UINT64_MAX, NULL));
            CHECK(memcmp(depths, expected, bytes) == 0, "turn %u: depth differs", (unsigned)turn);
            bhr_job_destroy(job);
        }
        CHECK_OK(bhr_semaphore_wait(line, signal.value, UINT64_MAX));
        /* A later frame ends after that one. */
        CHECK_OK(bhr_render_target(context, light, NULL, &after));
        CHECK_OK(bhr_job_wait(after, UINT64_MAX, NULL));
        bhr_job_destroy(after);
        for (size_t i = 0; destroyed && i < bytes; i++)
            if (depths[i] != 0x77) {
                CHECK(0, "turn %u: byte %zu was written after the job's end", (unsigned)turn, i);
                break;
            }
        CHECK_OK(bhr_semaphore_signal(line, 3 * turn + 3));
    }
    /* One that is cancelled before its turn writes nothing, and signals. */
    BhrSemaphoreValue wait = {line, 101}, signal = {line, 102}, second = {line, 103};
    BhrSync           sync = {.struct_size = sizeof sync, .wait_count = 1, .signal_count = 1, .waits = &wait};
    BhrOutput         one = imaged(&image, depths);
    BhrJob           *first, *job;
    sync.signals = &signal;
    memset(depths, 0x77, sizeof depths);
    CHECK_OK(bhr_render_outputs_shared_async(context, &one, sizeof one, 1, &sync, &first));
    sync.waits = &signal, sync.signals = &second;
    CHECK_OK(bhr_render_outputs_shared_async(context, &one, sizeof one, 1, &sync, &job));
    bhr_job_destroy(first);
    bhr_job_cancel(job);
    CHECK_OK(bhr_semaphore_signal(line, 101));
    CHECK_OK(bhr_semaphore_wait(line, 103, UINT64_MAX));
    BhrStatus status = bhr_job_wait(job, UINT64_MAX, NULL);
    CHECK(status == BHR_ERROR_CANCELLED || status == BHR_OK, "status %d", (int)status);
    CHECK(depths[0] == 0x77 || status == BHR_OK, "a cancelled frame wrote");
    bhr_job_destroy(job);
    bhr_target_destroy(light);
    bhr_semaphore_destroy(line);
}

int main(int argc, char **argv) {
    BhrBackend        backend = check_begin(argc, argv);
    BhrContextOptions made = check_options(backend);
    if (argc > 2 && strcmp(argv[2], "validate") == 0)
        made.flags |= BHR_CONTEXT_VALIDATION, made.log_fn = vk_log;
    context = check_context_with(&made);
    images_wait();
    bhr_context_destroy(context);
    CHECK(vk_complaints == 0, "the validation layers had %d complaints", vk_complaints);
    return check_end();
}
