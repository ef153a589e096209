/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* check.h -- the harness of the C tests: counted checks that print file, line and the library's message when they
 * fail, and a watch that tells whether a refused call changed its context. Knows the C API only; tests nothing by
 * itself.
 *
 * Every program takes the backend as its first argument (cpu, vulkan, gl) and exits with 0 only if all its checks
 * passed.
 */
#ifndef BHR_CHECK_H
#define BHR_CHECK_H

#include <bhr.h>
#include <stddef.h>
#include <stdint.h>

#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))
#define PI 3.14159265358979323846

/* ---- a program's frame ---- */
BhrBackend  check_begin(int argc, char **argv); /* exits with 2 when there is no backend among the arguments */
int         check_end(void);                    /* prints the count; the exit status of main */
BhrContext *check_context(BhrBackend backend);  /* a new one, silent, with a plain scene; ends the program else */

int check_runs_all(void); /* whether this is tests/run all: BHR_TESTS_ALL=1 in the environment */

BhrContextOptions check_options(BhrBackend backend); /* the defaults, with this backend */
BhrContext       *check_context_with(const BhrContextOptions *options); /* as check_context */

/* The sky of check_context. It has no Milky Way, which takes long to make in every program anew, but in `tests/run all`
 * without CHECK_WITHOUT_MILKY_WAY in the environment, which is for valgrind. */
void check_set_sky(BhrContext *context);

/* ---- checks: the condition, then a printf message that says what was seen. Any thread may check. ---- */
#define CHECK(condition, ...) check_that((condition) != 0, __FILE__, __LINE__, #condition, __VA_ARGS__)
/* The call succeeds. Its value is whether it did. */
#define CHECK_OK(call) check_ok((call), __FILE__, __LINE__, #call)
/* The call fails with this status and a message of its own (not an earlier call's) that holds one of `words`,
 * separated by |, or is any sentence when words is "". */
#define CHECK_FAILS(expected, words, call) \
    (check_mark_message(), check_fails((call), (expected), (words), __FILE__, __LINE__, #call))
/* CHECK_FAILS, and the watched context is as it was: its getters and a small frame. */
#define CHECK_REFUSED(watch, expected, words, call)     \
    (CHECK_FAILS(expected, words, call),                \
     check_unchanged((watch), __FILE__, __LINE__, #call))

int  check_that(int passed, const char *file, int line, const char *text, const char *format, ...);
int  check_ok(BhrStatus status, const char *file, int line, const char *call);
void check_mark_message(void);
int  check_fails(BhrStatus status, BhrStatus expected, const char *words, const char *file, int line, const char *call);

/* ---- a watched context ---- */
#define WATCH_WIDTH 24
#define WATCH_HEIGHT 16
typedef struct Watch {
    BhrContext   *context;
    double        mass, spin, axis[3];
    BhrCamera     camera;
    BhrDisk       disk;
    int32_t       disk_present;
    BhrVolume     volumes[BHR_MAX_VOLUMES];
    uint32_t      volume_count;
    BhrHotSpot    hot_spots[BHR_MAX_HOT_SPOTS];
    uint32_t      hot_spot_count;
    BhrSky        sky;
    BhrFilm       film;
    BhrQuality    quality;
    double        time, shutter;
    uint32_t      effects;
    double        effect_strengths[3];
    BhrView       view;
    BhrRegion     region;
    int32_t       region_present;
    BhrStatus     frame_status; /* some scenes cannot be rendered; they stay so */
    unsigned char frame[WATCH_WIDTH * WATCH_HEIGHT * 4];
} Watch;
void watch_begin(Watch *watch, BhrContext *context); /* again after every change that is meant */
int  check_unchanged(const Watch *watch, const char *file, int line, const char *call);

/* ---- sizes of structs in the library's first release (with pointers of 8 bytes): hosts compiled then go on saying
 * them, however the structs have grown ---- */
enum {
    FIRST_BODY = 80,
    FIRST_CAMERA = 120,
    FIRST_CONTEXT_OPTIONS = 48,
    FIRST_DISK = 64,
    FIRST_FILM = 24,
    FIRST_HIT = 184,
    FIRST_HOT_SPOT = 88,
    FIRST_IMAGE = 48,
    FIRST_OUTPUT = 32,
    FIRST_QUALITY = 48,
    FIRST_RAY = 56,
    FIRST_REGION = 24,
    FIRST_SKY = 64,
    FIRST_TRANSFER = 48,
    FIRST_VOLUME = 168,
    FIRST_WINDOW = 56
};

/* ---- images ---- */
/* A packed image over `pixels`, of byte_size bytes. */
BhrImage image_of(BhrFormat format, uint32_t width, uint32_t height, void *pixels, uint64_t byte_size);
size_t   bytes_per_pixel(BhrFormat format);
#define UNTOUCHED 0xA5 /* what the tests fill memory with before the library may write to it */
int all_untouched(const void *memory, size_t size);

/* ---- time ---- */
void   pause_ms(long ms);
double seconds_now(void);

#endif
