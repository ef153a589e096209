/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* render_frame.c -- one frame of a black hole into a file: what a host does from context to pixels, each step with its
 * check. Lengths on the command line are in units of the hole's mass M, angles in degrees. */
#include "colour_bar.h"
#include "picture.h"
#include "scene_options.h"

#include <stdlib.h>
#include <string.h>

#define NOT_GIVEN UINT32_MAX
/* Rays for each core below which the CPU tracer is done with a picture before Mesa's software driver, which traces a
 * ray in a third of the time (0.2 us of a core, not 0.6), has compiled its kernels: 1.5 s of a core (Debian 12, Mesa
 * 22, nothing cached). A picture of 1280 x 720 pixels and 4 samples has 1.8 million for each of two cores. */
#define RAYS_WORTH_COMPILING 2000000.0

typedef struct Settings {
    uint32_t    size[2];
    SceneInput  input;
    int32_t     backend;
    uint32_t    adapter, threads;
    const char *output;
    int         no_colour_bar, progress, verbose, list_adapters, help;
} Settings;

static int32_t show_progress(void *user, double fraction) {
    progress_draw(user, fraction);
    return 1; /* go on */
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
    const BhrQuality *quality = &s->input.scene.quality;
    printf("frame     %u x %u, %u sample%s per pixel, method %s\n", (unsigned)s->size[0], (unsigned)s->size[1],
           (unsigned)quality->samples_per_pixel, quality->samples_per_pixel == 1 ? "" : "s",
           choice_name(METHODS, quality->method));
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
static int render_and_save(BhrContext *context, const Settings *s, BhrImage *image) {
    Progress  progress = progress_begin(s->progress || is_terminal(stderr));
    BhrStatus status = BHR_OK;
    if (progress.shown) {
        status = bhr_set_progress(context, show_progress, &progress);
    }
    if (status >= 0) {
        status = bhr_render_image(context, image);
    }
    progress_clear(&progress);
    if (status < 0) {
        return report_failure("render the frame", status);
    }
    if (image->format == BHR_FORMAT_RGBA8_SRGB && !s->no_colour_bar) {
        status = colour_bar_add(context, image);
    }
    if (status >= 0) {
        status = bhr_image_save(image, s->output);
    }
    if (status < 0) {
        return report_failure("save the frame", status);
    }
    BhrAdapterInfo adapter;
    BHR_INIT(adapter);
    BhrFrameStats  stats;
    BHR_INIT(stats);
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
    BhrStatus status = scene_apply(&s->input.scene, context);
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
    BhrAdapterInfo info;
    BHR_INIT(info);
    const double   rays = (double)s->size[0] * (double)s->size[1] * (double)s->input.scene.quality.samples_per_pixel;
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
        BhrAdapterInfo info;
        BHR_INIT(info);
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
    Settings s = {.size = {1280, 720}, .backend = BHR_BACKEND_AUTO, .adapter = NOT_GIVEN, .output = "frame.png"};
    const Option first[] = {
        {"--output", OPTION_TEXT, &s.output, "FILE", ".png .exr (linear light) .ppm", NULL, NULL},
        {"--size", OPTION_SIZE, s.size, "WxH", "pixels", NULL, NULL},
    };
    const Option last[] = {
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--adapter", OPTION_UINT, &s.adapter, "N", "one of --list-adapters", NULL, NULL},
        {"--threads", OPTION_UINT, &s.threads, "N", "of the CPU tracer; 0: one per core", NULL, NULL},
        {"--no-colour-bar", OPTION_FLAG, &s.no_colour_bar, NULL, "false colour without the bar that explains it", NULL,
         NULL},
        {"--progress", OPTION_FLAG, &s.progress, NULL, "a bar on long renders, even if stderr is no terminal", NULL,
         NULL},
        {"--verbose", OPTION_FLAG, &s.verbose, NULL, "the library's log on stderr", NULL, NULL},
        {"--list-adapters", OPTION_FLAG, &s.list_adapters, NULL, "lists what can trace light here, best first", NULL,
         NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    BhrStatus status = scene_input_init(&s.input);
    if (status < 0) {
        return report_failure("begin", status);
    }
    Options options = {.count = 0};
    options_add(&options, first, COUNT_OF(first));
    options_add_scene(&options, &s.input, ALL_OF_SCENE);
    options_add(&options, last, COUNT_OF(last));
    int result = options_parse(options.list, options.count, argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.adapter != NOT_GIVEN && s.adapter > INT32_MAX) {
        fprintf(stderr, "%s: there is no adapter %u; --list-adapters shows them\n", argv[0], (unsigned)s.adapter);
        return EXIT_USAGE;
    }
    if (s.help) {
        printf("Usage: render_frame [options]\nRenders a black hole into a file. Lengths in units of its mass M.\n\n");
        options_print(stdout, options.list, options.count);
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
    result = scene_input_finish(&s.input, context, &options, argc, argv);
    if (result == 0) {
        result = make_frame(context, &s);
    }
    bhr_context_destroy(context);
    return result;
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
