/* render_frame.c -- one frame of a black hole into a file: what a host does from context to pixels, each step with its
 * check. Lengths on the command line are in units of the hole's mass M, angles in degrees. */
#include "common.h"
#include "picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NOT_GIVEN UINT32_MAX
#define PROGRESS_AFTER_SECONDS 0.5 /* a frame that is done sooner needs no bar */
#define PROGRESS_CELLS 40
/* Rays for each core below which the CPU tracer is done with a picture before Mesa's software driver, which traces a
 * ray in a third of the time (0.2 us of a core, not 0.6), has compiled its kernels: 1.5 s of a core (Debian 12, Mesa
 * 22, nothing cached). A picture of 1280 x 720 pixels and 4 samples has 1.8 million for each of two cores. */
#define RAYS_WORTH_COMPILING 2000000.0

typedef struct Settings {
    uint32_t    size[2];
    double      mass, spin;
    double      distance, azimuth, elevation, fov;
    int32_t     motion;
    double      velocity[3];
    int32_t     backend;
    uint32_t    adapter, threads;
    int32_t     method;
    uint32_t    samples, max_order;
    double      disk_inner, disk_outer, disk_temperature, opacity, turbulence, time;
    uint32_t    seed;
    int         no_disk, retrograde, no_stars;
    double      exposure;
    int32_t     tone_map;
    const char *output;
    int         progress, verbose, list_adapters, help;
} Settings;

static const Settings DEFAULTS = {
    .size = {1280, 720},
    .mass = 1.0,
    .distance = 30.0,
    .azimuth = -90.0,
    .elevation = 9.5,
    .fov = 60.0,
    .motion = BHR_MOTION_STATIC,
    .backend = BHR_BACKEND_AUTO,
    .adapter = NOT_GIVEN,
    .method = BHR_METHOD_AUTO,
    .samples = 1,
    .max_order = 3,
    .disk_outer = 20.0,
    .disk_temperature = 6500.0,
    .opacity = 1.0,
    .tone_map = BHR_TONE_MAP_ACES,
    .output = "frame.png",
};

/* ---- the scene ---- */

static BhrStatus set_camera(BhrContext *context, const Settings *s) {
    BhrCamera camera;
    BhrStatus status = bhr_camera_init(&camera, sizeof camera);
    if (status < 0) {
        return status;
    }
    status = bhr_camera_orbit(&camera, s->distance * s->mass, s->azimuth * PI / 180.0, s->elevation * PI / 180.0);
    if (status < 0) {
        return status;
    }
    camera.fov_y = s->fov * PI / 180.0;
    camera.motion = s->motion;
    memcpy(camera.velocity, s->velocity, sizeof camera.velocity);
    return bhr_set_camera(context, &camera);
}

static BhrStatus set_disk(BhrContext *context, const Settings *s) {
    if (s->no_disk) {
        return bhr_set_disk(context, NULL);
    }
    BhrDisk   disk;
    BhrStatus status = bhr_disk_init(&disk, sizeof disk);
    if (status < 0) {
        return status;
    }
    disk.flags = s->retrograde ? BHR_DISK_RETROGRADE : 0;
    disk.inner_radius = s->disk_inner;
    disk.outer_radius = s->disk_outer;
    disk.temperature = s->disk_temperature;
    disk.opacity = s->opacity;
    disk.turbulence = s->turbulence;
    disk.seed = s->seed;
    return bhr_set_disk(context, &disk);
}

static BhrStatus set_film(BhrContext *context, const Settings *s) {
    BhrFilm   film;
    BhrStatus status = bhr_film_init(&film, sizeof film);
    if (status < 0) {
        return status;
    }
    film.tone_map = s->tone_map;
    film.exposure_ev = s->exposure;
    return bhr_set_film(context, &film);
}

static BhrStatus set_quality(BhrContext *context, const Settings *s) {
    BhrQuality quality;
    BhrStatus  status = bhr_quality_init(&quality, sizeof quality);
    if (status < 0) {
        return status;
    }
    quality.method = s->method;
    quality.samples_per_pixel = s->samples;
    quality.max_disk_order = s->max_order;
    return bhr_set_quality(context, &quality);
}

/* The first failure, or BHR_OK. */
static BhrStatus describe_scene(BhrContext *context, const Settings *s) {
    BhrStatus status = bhr_set_mass(context, s->mass);
    if (status >= 0) {
        status = bhr_set_spin(context, s->spin);
    }
    if (status >= 0) {
        status = set_camera(context, s);
    }
    if (status >= 0) {
        status = set_disk(context, s);
    }
    if (status >= 0) {
        status = bhr_set_time(context, s->time * s->mass);
    }
    if (status >= 0 && s->no_stars) {
        status = bhr_set_sky(context, NULL);
    }
    if (status >= 0) {
        status = set_film(context, s);
    }
    if (status >= 0) {
        status = set_quality(context, s);
    }
    return status;
}

/* ---- progress ---- */

typedef struct Progress {
    double begin;
    int    percent; /* drawn last; -1: nothing drawn yet */
} Progress;

static int32_t draw_progress(void *user, double fraction) {
    Progress *progress = user;
    int       percent = (int)(100.0 * fraction);
    if (percent == progress->percent || wall_seconds() - progress->begin < PROGRESS_AFTER_SECONDS) {
        return 1;
    }
    progress->percent = percent;
    char bar[PROGRESS_CELLS + 1];
    for (int i = 0; i < PROGRESS_CELLS; i++) {
        bar[i] = i < (int)(fraction * PROGRESS_CELLS) ? '#' : '.';
    }
    bar[PROGRESS_CELLS] = '\0';
    fprintf(stderr, "\r[%s] %3d %%", bar, percent);
    fflush(stderr);
    return 1; /* go on */
}

static void clear_progress(const Progress *progress) {
    if (progress->percent >= 0) {
        fprintf(stderr, "\r%*s\r", PROGRESS_CELLS + 8, "");
        fflush(stderr);
    }
}

/* ---- the frame ---- */

/* EXR holds linear light, so it gets floats; the other files hold 8 bits a channel. */
static BhrFormat format_for(const char *path) {
    size_t length = strlen(path);
    return length >= 4 && strcmp(path + length - 4, ".exr") == 0 ? BHR_FORMAT_RGBA32F : BHR_FORMAT_RGBA8_SRGB;
}

static int library_chooses(const Settings *s) {
    return s->backend == BHR_BACKEND_AUTO && s->adapter == NOT_GIVEN;
}

static void print_report(const Settings *s, const BhrAdapterInfo *adapter, const BhrFrameStats *stats) {
    printf("adapter   ");
    print_adapter(stdout, adapter);
    putchar('\n');
    if (library_chooses(s)) {
        print_driver_advice(stdout, adapter, "          ");
    }
    printf("frame     %u x %u, %u sample%s per pixel, method %s\n", (unsigned)s->size[0], (unsigned)s->size[1],
           (unsigned)s->samples, s->samples == 1 ? "" : "s", choice_name(METHODS, s->method));
    printf("time      %.1f ms in all, ", (double)stats->cpu_ns * 1e-6);
    if (stats->gpu_ns != 0) {
        printf("%.2f ms on the GPU, ", (double)stats->gpu_ns * 1e-6);
    } else {
        printf("no GPU timestamps, ");
    }
    printf("%.1f ms reading back\n", (double)stats->readback_ns * 1e-6);
    printf("file      %s\n", s->output);
}

/* Renders into `image`, saves it and reports. */
static int render_and_save(BhrContext *context, const Settings *s, const BhrImage *image) {
    Progress  progress = {wall_seconds(), -1};
    BhrStatus status = BHR_OK;
    if (s->progress || is_terminal(stderr)) {
        status = bhr_set_progress(context, draw_progress, &progress);
    }
    if (status >= 0) {
        status = bhr_render_image(context, image);
    }
    clear_progress(&progress);
    if (status < 0) {
        return report_failure("render the frame", status);
    }
    status = bhr_image_save(image, s->output);
    if (status < 0) {
        return report_failure("save the frame", status);
    }
    BhrAdapterInfo adapter = {.struct_size = sizeof adapter};
    BhrFrameStats  stats = {.struct_size = sizeof stats};
    status = bhr_context_adapter(context, &adapter);
    if (status >= 0) {
        status = bhr_frame_stats(context, &stats);
    }
    if (status < 0) {
        return report_failure("ask about the frame", status);
    }
    print_report(s, &adapter, &stats);
    return EXIT_SUCCESS;
}

static int make_frame(BhrContext *context, const Settings *s) {
    BhrStatus status = describe_scene(context, s);
    if (status < 0) {
        return report_failure("set the scene", status);
    }
    BhrImage image;
    if (!picture_allocate(&image, format_for(s->output), s->size[0], s->size[1])) {
        return EXIT_FAILURE;
    }
    int result = render_and_save(context, s, &image);
    free(image.pixels);
    return result;
}

/* Whether the library took a software driver for what the CPU tracer is done with sooner. */
static int suits_cpu_better(const Settings *s, const BhrContext *context) {
    BhrAdapterInfo info = {.struct_size = sizeof info};
    const double   rays = (double)s->size[0] * (double)s->size[1] * (double)s->samples;
    return library_chooses(s) && bhr_context_adapter(context, &info) >= 0 && (info.flags & BHR_ADAPTER_SOFTWARE) &&
           info.backend != BHR_BACKEND_CPU && rays < RAYS_WORTH_COMPILING * cores();
}

static int create_context(const Settings *s, BhrContext **out_context) {
    BhrContextOptions options;
    BhrStatus         status = bhr_context_options_init(&options, sizeof options);
    if (status >= 0) {
        options.backend = s->backend;
        options.adapter_index = s->adapter == NOT_GIVEN ? -1 : (int32_t)s->adapter;
        options.cpu_threads = s->threads;
        if (s->verbose) {
            options.log_level = BHR_LOG_INFO;
            options.log_fn = log_to_stderr;
        }
        status = bhr_context_create(BHR_ABI_VERSION, &options, out_context);
    }
    if (status >= 0 && suits_cpu_better(s, *out_context)) {
        bhr_context_destroy(*out_context);
        options.backend = BHR_BACKEND_CPU;
        status = bhr_context_create(BHR_ABI_VERSION, &options, out_context);
    }
    return status < 0 ? report_failure("create a context", status) : 0;
}

static int list_adapters(void) {
    uint32_t  count;
    BhrStatus status = bhr_adapter_count(&count);
    for (uint32_t i = 0; status >= 0 && i < count; i++) {
        BhrAdapterInfo info = {.struct_size = sizeof info};
        status = bhr_adapter_info(i, &info);
        if (status >= 0) {
            printf("%2u  ", (unsigned)i);
            print_adapter(stdout, &info);
            putchar('\n');
        }
    }
    return status < 0 ? report_failure("list the adapters", status) : EXIT_SUCCESS;
}

/* ---- command line ---- */

static int run(int argc, char **argv) {
    Settings     s = DEFAULTS;
    const Option options[] = {
        {"--size", OPTION_SIZE, s.size, "WxH", "pixels; default 1280x720", NULL},
        {"--mass", OPTION_DOUBLE, &s.mass, "M", "in scene lengths; only the scale changes with it; default 1", NULL},
        {"--spin", OPTION_DOUBLE, &s.spin, "A", "a / M, -0.999 to 0.999; default 0", NULL},
        {"--distance", OPTION_DOUBLE, &s.distance, "R", "camera's radius in M; default 30", NULL},
        {"--azimuth", OPTION_DOUBLE, &s.azimuth, "DEG", "camera's azimuth about the spin axis; default -90", NULL},
        {"--elevation", OPTION_DOUBLE, &s.elevation, "DEG", "camera above the disk's plane; default 9.5", NULL},
        {"--fov", OPTION_DOUBLE, &s.fov, "DEG", "vertical field of view, below 180; default 60", NULL},
        {"--motion", OPTION_CHOICE, &s.motion, NULL, "of the camera; default static", MOTIONS},
        {"--velocity", OPTION_VECTOR, s.velocity, "X,Y,Z", "v / c for --motion velocity, length below 1", NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light; default auto", BACKENDS},
        {"--adapter", OPTION_UINT, &s.adapter, "N", "one of --list-adapters", NULL},
        {"--threads", OPTION_UINT, &s.threads, "N", "of the CPU tracer; default 0: one per core", NULL},
        {"--method", OPTION_CHOICE, &s.method, NULL, "of integration; default auto", METHODS},
        {"--samples", OPTION_UINT, &s.samples, "N", "per pixel, 1 to 256; default 1", NULL},
        {"--max-order", OPTION_UINT, &s.max_order, "N", "last image of the disk, 0 (direct) to 15; default 3", NULL},
        {"--disk-inner", OPTION_DOUBLE, &s.disk_inner, "R", "in M; default 0: the innermost stable orbit", NULL},
        {"--disk-outer", OPTION_DOUBLE, &s.disk_outer, "R", "in M; default 20", NULL},
        {"--disk-temperature", OPTION_DOUBLE, &s.disk_temperature, "K", "of the hottest ring; default 6500", NULL},
        {"--opacity", OPTION_DOUBLE, &s.opacity, "X", "of the disk, 0 to 1; default 1", NULL},
        {"--turbulence", OPTION_DOUBLE, &s.turbulence, "X", "structure of the disk, 0 (default) to 1", NULL},
        {"--seed", OPTION_UINT, &s.seed, "N", "of the turbulence; default 0", NULL},
        {"--time", OPTION_DOUBLE, &s.time, "T", "in M; turns the disk's structure; default 0", NULL},
        {"--retrograde", OPTION_FLAG, &s.retrograde, NULL, "the disk turns towards -azimuth", NULL},
        {"--no-disk", OPTION_FLAG, &s.no_disk, NULL, "leaves the disk out", NULL},
        {"--no-stars", OPTION_FLAG, &s.no_stars, NULL, "makes the sky black", NULL},
        {"--exposure", OPTION_DOUBLE, &s.exposure, "EV", "stops, -20 to 20; default 0; 8-bit files only", NULL},
        {"--tone-map", OPTION_CHOICE, &s.tone_map, NULL, "default aces; 8-bit files only", TONE_MAPS},
        {"--output", OPTION_TEXT, &s.output, "FILE", ".png .exr (linear light) .ppm; default frame.png", NULL},
        {"--progress", OPTION_FLAG, &s.progress, NULL, "a bar on long renders, even if stderr is no terminal", NULL},
        {"--verbose", OPTION_FLAG, &s.verbose, NULL, "the library's log on stderr", NULL},
        {"--list-adapters", OPTION_FLAG, &s.list_adapters, NULL, "lists what can trace light here, best first", NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.adapter != NOT_GIVEN && s.adapter > INT32_MAX) {
        fprintf(stderr, "%s: there is no adapter %u; --list-adapters shows them\n", argv[0], (unsigned)s.adapter);
        return EXIT_USAGE;
    }
    if (s.help) {
        printf("Usage: render_frame [options]\nRenders a black hole into a file. Lengths in units of its mass M.\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    if (s.list_adapters) {
        return list_adapters();
    }
    BhrContext *context;
    result = create_context(&s, &context);
    if (result != 0) {
        return result;
    }
    result = make_frame(context, &s);
    bhr_context_destroy(context);
    return result;
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
