/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* refusals.h -- what the tests of badly called setters share: a scene in which every setter has been used, and checks
 * of a struct's numbers and sizes. Tests nothing by itself. */
#ifndef BHR_REFUSALS_H
#define BHR_REFUSALS_H

#include "check.h"

#include <math.h>
#include <string.h>

/* A struct as hosts of other releases pass it. `grown` has members known and tail, is filled by `init`, a call with
 * `size`, and `set` must take it with every struct_size from `first`, the first release's, to that of the struct;
 * with a tail that this version does not know, only if that is zero; and with none below `first`. `get` must write
 * struct_size bytes, the tail's zero. */
#define CHECK_STRUCT_SIZES(watch, grown, first, init, set, get)                                                        \
    do {                                                                                                               \
        for (size_t size = (first); size <= sizeof(grown); size++) {                                                   \
            memset(&(grown), UNTOUCHED, sizeof(grown));                                                                \
            CHECK_OK(init);                                                                                            \
            CHECK((grown).known.struct_size == size, "init left another struct_size than %u", (unsigned)size);         \
            CHECK(is_after(&(grown), sizeof(grown).known, size, 0), "init at %u: the tail is not 0", (unsigned)size);  \
            CHECK(is_after(&(grown), size, sizeof(grown), UNTOUCHED), "init at %u wrote further", (unsigned)size);     \
            CHECK_OK(set);                                                                                             \
            memset(&(grown), UNTOUCHED, sizeof(grown));                                                                \
            (grown).known.struct_size = (uint32_t)size;                                                                \
            CHECK_OK(get);                                                                                             \
            CHECK((grown).known.struct_size == size, "a getter changed struct_size %u", (unsigned)size);               \
            CHECK(is_after(&(grown), sizeof(grown).known, size, 0), "get at %u: the tail is not 0", (unsigned)size);   \
            CHECK(is_after(&(grown), size, sizeof(grown), UNTOUCHED), "get at %u wrote further", (unsigned)size);      \
        }                                                                                                              \
        watch_begin((watch), (watch)->context);                                                                        \
        (grown).tail[sizeof(grown).tail - 1] = 1;                                                                      \
        CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", set);                                          \
        (grown).tail[sizeof(grown).tail - 1] = 0;                                                                      \
        const uint32_t wrong[] = {(first) - 1, (first) / 2, 4, 0, 1u << 20, UINT32_MAX};                               \
        for (size_t at = 0; at < COUNT_OF(wrong); at++) {                                                              \
            (grown).known.struct_size = wrong[at];                                                                     \
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", set);                                      \
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, "struct_size", get);                                      \
            const size_t size = wrong[at];                                                                             \
            CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", init);                                              \
        }                                                                                                              \
    } while (0)

/* Whether bytes begin .. end - 1 of the struct are all `value`. */
int is_after(const void *structure, size_t begin, size_t end, unsigned char value);

/* A number that a setter must refuse, and what its message must name. */
typedef struct BadNumber {
    size_t      offset; /* of the double in its struct */
    double      value;
    const char *words;
} BadNumber;

/* The struct `value` is refused with each number of the array `bad` in it. `init` and `set` are calls with it. */
#define CHECK_BAD_NUMBERS(watch, value, bad, init, set)                                                                \
    do {                                                                                                               \
        for (size_t at = 0; at < COUNT_OF(bad); at++) {                                                                \
            CHECK_OK(init);                                                                                            \
            put(&(value), (bad)[at].offset, (bad)[at].value);                                                          \
            CHECK_REFUSED(watch, BHR_ERROR_INVALID_ARGUMENT, (bad)[at].words, set);                                    \
        }                                                                                                              \
    } while (0)

/* Writes a double into a struct. */
void put(void *destination, size_t offset, double value);

BhrCamera default_camera(void);
/* Watches a scene in which every setter of a number has been used: the default would hide a refused call that resets
 * something. */
void watch_unusual_scene(Watch *watch, BhrContext *context);
/* A small frame of linear light succeeds, and every number in it is finite. */
void finite_frame(BhrContext *context, const char *what, size_t index);

#endif
