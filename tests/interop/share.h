/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* share.h -- what the tests of shared memory begin and end with, and do again and again: a context on bhr's own device,
 * the host's device on the same GPU, targets of bhr's and their memory in the host's hands. Counts its checks as the
 * program's own; knows no pictures. */
#ifndef BHR_TESTS_SHARE_H
#define BHR_TESTS_SHARE_H

#include "../c/check.h"
#include "vk.h"

extern BhrContext    *context;
extern Vk             host;
extern BhrInteropInfo can; /* of the context */

/* Every format of pixels. */
enum { RGBA8, BGRA8, RGBA16F, RGBA32F, R32F, FORMATS };
typedef struct ShareFormat {
    BhrFormat   format;
    VkFormat    vk;    /* of images */
    uint32_t    bytes; /* of a pixel */
    const char *name;
} ShareFormat;
extern const ShareFormat formats[FORMATS];

/* Arguments: vulkan [validate]. Makes context and host. Returns the backend. */
BhrBackend share_begin(int argc, char **argv);
/* Makes host for a context that the program has made. */
void share_open(int validate);
/* Ends both; the layers had nothing to say. The exit status of main. */
int share_end(void);

/* A target for OPAQUE_FD; row_stride 0: packed. */
BhrTargetOptions share_options(BhrFormat format, BhrTargetKind kind, uint32_t width, uint32_t height,
                               uint64_t row_stride);
/* Its target in memory of bhr's; NULL after a failed check. */
BhrTarget *share_make(const BhrTargetOptions *options);
/* A timeline of bhr's, and its descriptor; -1 where the device shares none. */
BhrSemaphore *share_timeline(int *fd);
/* The memory of one of bhr's in the host's hands; `bytes` of a buffer. */
VkPicture share_import(BhrTarget *target, uint64_t bytes);
/* The other way round: memory of the host's, for `usage` of an image or `bytes` of a buffer, as a target of bhr's;
 * that is NULL after a failed check. */
VkPicture share_host_memory(const BhrTargetOptions *options, VkImageUsageFlags usage, uint64_t bytes,
                            BhrTarget **target);

void share_set_quality(uint32_t samples, double bloom);
/* Waits until the job is done, and ends it. */
void share_finish(BhrJob *job);

#endif
