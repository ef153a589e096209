/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* check.c -- see check.h. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static unsigned        passed_count, failed_count;
static const char     *program_name = "?", *backend_argument = "?";

/* ---- a program's frame ---- */

BhrBackend check_begin(int argc, char **argv) {
    const char *slash = strrchr(argv[0], '/');
    program_name = slash != NULL ? slash + 1 : argv[0];
    if (argc >= 2) {
        backend_argument = argv[1];
        static const struct {
            const char *name;
            BhrBackend  backend;
        } backends[] = {{"cpu", BHR_BACKEND_CPU},     {"vulkan", BHR_BACKEND_VULKAN}, {"gl", BHR_BACKEND_GL},
                        {"metal", BHR_BACKEND_METAL}, {"d3d12", BHR_BACKEND_D3D12},   {"auto", BHR_BACKEND_AUTO}};
        for (size_t i = 0; i < sizeof backends / sizeof *backends; i++) {
            if (strcmp(argv[1], backends[i].name) == 0) {
                return backends[i].backend;
            }
        }
    }
    fprintf(stderr, "usage: %s cpu|vulkan|gl|metal|d3d12|auto\n", program_name);
    exit(2);
}

int check_end(void) {
    printf("%s %s: %u checks passed, %u failed\n", program_name, backend_argument, passed_count, failed_count);
    return failed_count == 0 && passed_count > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int check_runs_all(void) {
    const char *all = getenv("BHR_TESTS_ALL");
    return all != NULL && strcmp(all, "1") == 0;
}

void check_set_sky(BhrContext *context) {
    BhrSky sky;
    if ((!check_runs_all() || getenv("CHECK_WITHOUT_MILKY_WAY") != NULL) && CHECK_OK(bhr_sky_init(&sky, sizeof sky))) {
        sky.flags &= ~(uint32_t)BHR_SKY_MILKY_WAY;
        CHECK_OK(bhr_set_sky(context, &sky));
    }
}

BhrContextOptions check_options(BhrBackend backend) {
    BhrContextOptions options;
    if (!CHECK_OK(bhr_context_options_init(&options, sizeof options))) {
        exit(check_end());
    }
    options.backend = backend;
    return options;
}

/* Sets the plain scene of Rust's tests: a smooth disk before the stars, whatever the library's default becomes. */
static void set_plain(BhrContext *context) {
    BhrCamera camera;
    BhrFilm   film;
    CHECK_OK(bhr_camera_init(&camera, sizeof camera));
    camera.projection = BHR_PROJECTION_PERSPECTIVE, camera.motion = BHR_MOTION_STATIC;
    camera.position[0] = 0.0, camera.position[1] = -30.0, camera.position[2] = 5.0;
    camera.forward[0] = -0.0, camera.forward[1] = 30.0, camera.forward[2] = -5.0;
    camera.up[0] = camera.up[1] = 0.0, camera.up[2] = 1.0;
    camera.fov_y = 1.0471975511965976; /* pi / 3 */
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_PHYSICAL));
    CHECK_OK(bhr_film_init(&film, sizeof film));
    film.tone_map = BHR_TONE_MAP_ACES;
    film.exposure_ev = film.bloom = film.beam_fwhm = 0.0;
    film.colour_map = BHR_COLOUR_MAP_NONE;
    CHECK_OK(bhr_set_film(context, &film));
}

BhrContext *check_context_with(const BhrContextOptions *options) {
    BhrContext *context = NULL;
    if (!CHECK_OK(bhr_context_create(BHR_ABI_VERSION, options, &context)) ||
        !CHECK(context != NULL, "success without a context")) {
        exit(check_end());
    }
    set_plain(context);
    check_set_sky(context);
    return context;
}

BhrContext *check_context(BhrBackend backend) {
    const BhrContextOptions options = check_options(backend);
    return check_context_with(&options);
}

/* ---- checks ---- */

static int count(int passed) {
    pthread_mutex_lock(&lock);
    if (passed) {
        passed_count++;
    } else {
        failed_count++;
    }
    pthread_mutex_unlock(&lock);
    return passed;
}

int check_that(int passed, const char *file, int line, const char *text, const char *format, ...) {
    if (!passed) {
        char    seen[512];
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(seen, sizeof seen, format, arguments);
        va_end(arguments);
        printf("%s:%d: not so: %s: %s\n", file, line, text, seen);
        fflush(stdout);
    }
    return count(passed);
}

int check_ok(BhrStatus status, const char *file, int line, const char *call) {
    if (status != BHR_OK) {
        printf("%s:%d: %s gave %s: %s\n", file, line, call, bhr_status_name(status), bhr_error_message());
        fflush(stdout);
    }
    return count(status == BHR_OK);
}

/* A failure whose message no other call can give: the ABI version that it names is used nowhere else. */
#define MARK_ABI_VERSION 0xABADCAFEu
static const char *mark_message(void) {
    BhrContext *none = NULL;
    (void)bhr_context_create(MARK_ABI_VERSION, NULL, &none);
    return bhr_error_message();
}

void check_mark_message(void) {
    (void)mark_message();
}

static int holds_one_of(const char *message, const char *words) {
    /* A message begins with "function: ", and the function's name is no proof that the argument is named. */
    const char *colon = strchr(message, ':');
    message = colon != NULL ? colon : message;
    while (*words != '\0') {
        size_t length = strcspn(words, "|");
        for (const char *at = message; *at != '\0'; at++) {
            if (strncmp(at, words, length) == 0) {
                return 1;
            }
        }
        words += length;
        words += *words == '|';
    }
    return 0;
}

int check_fails(BhrStatus status, BhrStatus expected, const char *words, const char *file, int line, const char *call) {
    char message[1024];
    snprintf(message, sizeof message, "%s", bhr_error_message());
    const char *wrong = NULL;
    if (status != expected) {
        wrong = "another status";
    } else if (message[0] == '\0') {
        wrong = "no message";
    } else if (strcmp(message, mark_message()) == 0) {
        wrong = "an earlier call's message";
    } else if (words[0] != '\0' && !holds_one_of(message, words)) {
        wrong = "a message that does not name the argument";
    }
    if (wrong != NULL) {
        printf("%s:%d: %s: %s: got %s (expected %s, words '%s'), message: %s\n", file, line, call, wrong,
               bhr_status_name(status), bhr_status_name(expected), words, message);
        fflush(stdout);
    }
    return count(wrong == NULL);
}

/* ---- a watched context ---- */

static void ask_getters(Watch *watch, BhrContext *context) {
    memset(watch, 0, sizeof *watch);
    watch->context = context;
    watch->camera.struct_size = sizeof watch->camera;
    watch->disk.struct_size = sizeof watch->disk;
    watch->sky.struct_size = sizeof watch->sky;
    watch->film.struct_size = sizeof watch->film;
    watch->quality.struct_size = sizeof watch->quality;
    CHECK_OK(bhr_get_hole(context, &watch->mass, &watch->spin, watch->axis));
    CHECK_OK(bhr_get_camera(context, &watch->camera));
    CHECK_OK(bhr_get_disk(context, &watch->disk, &watch->disk_present));
    CHECK_OK(bhr_get_volumes(context, watch->volumes, sizeof watch->volumes[0], BHR_MAX_VOLUMES, &watch->volume_count));
    CHECK_OK(bhr_get_hot_spots(context, watch->hot_spots, sizeof watch->hot_spots[0], BHR_MAX_HOT_SPOTS,
                               &watch->hot_spot_count));
    CHECK_OK(bhr_get_sky(context, &watch->sky));
    CHECK_OK(bhr_get_film(context, &watch->film));
    CHECK_OK(bhr_get_quality(context, &watch->quality));
    CHECK_OK(bhr_get_time(context, &watch->time));
    CHECK_OK(bhr_get_shutter(context, &watch->shutter));
    CHECK_OK(bhr_get_effects(context, &watch->effects));
    CHECK_OK(bhr_get_effect_strength(context, BHR_EFFECT_DOPPLER_SHIFT, &watch->effect_strengths[0]));
    CHECK_OK(bhr_get_effect_strength(context, BHR_EFFECT_GRAVITY_SHIFT, &watch->effect_strengths[1]));
    CHECK_OK(bhr_get_effect_strength(context, BHR_EFFECT_BEAMING, &watch->effect_strengths[2]));
    CHECK_OK(bhr_get_view(context, &watch->view));
    watch->region.struct_size = sizeof watch->region;
    CHECK_OK(bhr_get_region(context, &watch->region, &watch->region_present));
}

static void look(Watch *watch) {
    const BhrImage image =
        image_of(BHR_FORMAT_RGBA8_SRGB, WATCH_WIDTH, WATCH_HEIGHT, watch->frame, sizeof watch->frame);
    watch->frame_status = bhr_render_image(watch->context, &image);
}

/* Everything the getters say, and a frame, which holds what has no getter. */
void watch_begin(Watch *watch, BhrContext *context) {
    ask_getters(watch, context);
    look(watch);
}

/* Whether the call sets what no getter tells: only a frame shows that nothing changed. */
static int sets_without_getter(const char *call) {
    static const char *const have[] = {"axis(", "mass(", "spin(",    "camera(", "disk(",    "volumes(", "hot_spots(",
                                       "sky(",  "film(", "quality(", "time(",   "effects(", "view(",    "region("};
    const char *what = strstr(call, "bhr_set_");
    for (size_t i = 0; what != NULL && i < COUNT_OF(have); i++) {
        if (strncmp(what + strlen("bhr_set_"), have[i], strlen(have[i])) == 0) {
            return 0;
        }
    }
    return what != NULL;
}

/* On the CPU a frame is looked at after every refusal in `tests/run all`, and everyday after those that no getter
 * tells of. Of all others, and on a GPU, where a software driver takes long for a frame, one look is for eight:
 * arguments are checked before a tracer is asked for anything. Words that are no call, as "the sky set back", always
 * ask for a frame. */
static int has_a_look(const char *call) {
    static unsigned refusals;
    return strstr(call, "bhr_") == NULL ||
           (strcmp(backend_argument, "cpu") == 0 && (check_runs_all() || sets_without_getter(call))) ||
           refusals++ % 8 == 0;
}

int check_unchanged(const Watch *watch, const char *file, int line, const char *call) {
    Watch       now;
    const int   looks = has_a_look(call);
    const char *wrong = NULL;
    ask_getters(&now, watch->context);
    if (looks) {
        look(&now);
    }
    if (now.mass != watch->mass || now.spin != watch->spin || memcmp(now.axis, watch->axis, sizeof now.axis) != 0) {
        wrong = "hole";
    } else if (memcmp(&now.camera, &watch->camera, sizeof now.camera) != 0) {
        wrong = "camera";
    } else if (now.disk_present != watch->disk_present || memcmp(&now.disk, &watch->disk, sizeof now.disk) != 0) {
        wrong = "disk";
    } else if (now.volume_count != watch->volume_count ||
               memcmp(now.volumes, watch->volumes, sizeof now.volumes) != 0) {
        wrong = "volumes";
    } else if (now.hot_spot_count != watch->hot_spot_count ||
               memcmp(now.hot_spots, watch->hot_spots, sizeof now.hot_spots) != 0) {
        wrong = "hot spots";
    } else if (memcmp(&now.sky, &watch->sky, sizeof now.sky) != 0) {
        wrong = "sky";
    } else if (memcmp(&now.film, &watch->film, sizeof now.film) != 0) {
        wrong = "film";
    } else if (memcmp(&now.quality, &watch->quality, sizeof now.quality) != 0) {
        wrong = "quality";
    } else if (now.time != watch->time || now.shutter != watch->shutter || now.effects != watch->effects ||
               now.view != watch->view) {
        wrong = "time, shutter, effects or view";
    } else if (memcmp(now.effect_strengths, watch->effect_strengths, sizeof now.effect_strengths) != 0) {
        wrong = "effect strengths";
    } else if (now.region_present != watch->region_present ||
               memcmp(&now.region, &watch->region, sizeof now.region) != 0) {
        wrong = "region";
    } else if (looks && now.frame_status != watch->frame_status) {
        wrong = "status of a frame";
    } else if (looks && memcmp(now.frame, watch->frame, sizeof now.frame) != 0) {
        wrong = "frame";
    }
    if (wrong != NULL) {
        printf("%s:%d: %s: a refused call, this one or one since the last look, changed the context: %s\n", file, line,
               call, wrong);
        fflush(stdout);
    }
    return count(wrong == NULL);
}

/* ---- images ---- */

size_t bytes_per_pixel(BhrFormat format) {
    return format == BHR_FORMAT_RGBA32F ? 16 : format == BHR_FORMAT_RGBA16F ? 8 : 4;
}

BhrImage image_of(BhrFormat format, uint32_t width, uint32_t height, void *pixels, uint64_t byte_size) {
    BhrImage image;
    memset(&image, 0, sizeof image);
    image.struct_size = sizeof image;
    image.format = format;
    image.width = width;
    image.height = height;
    image.pixels = pixels;
    image.byte_size = byte_size;
    return image;
}

int all_untouched(const void *memory, size_t size) {
    const unsigned char *bytes = memory;
    for (size_t i = 0; i < size; i++) {
        if (bytes[i] != UNTOUCHED) {
            return 0;
        }
    }
    return 1;
}

/* ---- time ---- */

void pause_ms(long ms) {
    const struct timespec time = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&time, NULL);
}

double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
