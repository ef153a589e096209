/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* observatory.c -- black holes as radio astronomers see them, in numbers: images in Jy at several frequencies, the
 * fluxes of the Event Horizon Telescope's tests, light curves of hot spots. All light is summed along single rays in
 * double precision (bhr_transfer_rays). Reads the command line; observatory_*.c do the rest. */
#include "observatory.h"

#include "matter.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define IMAGE 1u
#define GOLD 2u
#define HOTSPOT 4u

typedef struct Command {
    const char *name;
    unsigned    bit;
    int (*run)(BhrContext *context, Settings *s);
} Command;

static const Command COMMANDS[] = {
    {"image", IMAGE, observatory_image},
    {"gold", GOLD, observatory_gold},
    {"hotspot", HOTSPOT, observatory_hotspot},
};

/* An option, and the commands that take it. */
typedef struct CommandOption {
    Option   option;
    unsigned commands;
} CommandOption;

#define MOST_OBSERVATORY_OPTIONS 24u
#define MOST_WIDTH 0.2 /* of a frame, over the observer's distance */

/* ---- what the commands share ---- */

int check_width(const Settings *s, double width) {
    if (width <= MOST_WIDTH * s->observer) {
        return 0;
    }
    fprintf(stderr, "observatory: the frame is %g M wide; it must be at most %g M, a fifth of --observer: give another "
                    "--fov\n", width, MOST_WIDTH * s->observer);
    return EXIT_USAGE;
}

int prepare_output(const Settings *s) {
    if (!make_folder(s->output) && errno != EEXIST) {
        fprintf(stderr, "cannot make the folder %s: %s\n", s->output, strerror(errno));
        return EXIT_FAILURE;
    }
    return 0;
}

char *output_path(const Settings *s, const char *name) {
    const size_t size = strlen(s->output) + strlen(name) + 2;
    char        *path = malloc(size);
    if (path == NULL) {
        fprintf(stderr, "cannot write %s: no memory for its name\n", name);
        return NULL;
    }
    snprintf(path, size, "%s/%s", s->output, name);
    return path;
}

double *allocate_doubles(size_t count) {
    double *doubles = calloc(count, sizeof *doubles);
    if (doubles == NULL) {
        fprintf(stderr, "cannot hold %lu numbers\n", (unsigned long)count);
    }
    return doubles;
}

/* ---- the command line ---- */

typedef struct Input {
    Settings settings;
    int32_t  target;
    uint32_t threads;
    int      progress, help;
} Input;

static size_t list_options(Input *in, CommandOption out[MOST_OBSERVATORY_OPTIONS]) {
    Settings           *s = &in->settings;
    const CommandOption list[] = {
        {{"--target", OPTION_CHOICE, &in->target, NULL, "whose mass, distance, place, inclination and flux", TARGETS,
          NULL},
         IMAGE | HOTSPOT},
        {{"--mass-msun", OPTION_DOUBLE, &s->target.mass, "M", "in those of the Sun", NULL,
          "1 to 1e12"}, IMAGE | HOTSPOT},
        {{"--distance-kpc", OPTION_DOUBLE, &s->target.distance, "D", "to the hole", NULL, "1e-3 to 1e8"},
         IMAGE | HOTSPOT},
        {{"--spin", OPTION_DOUBLE, &s->spin, "A", "a / M", NULL,
          "-0.9999 to 0.9999"}, IMAGE | HOTSPOT},
        {{"--inclination", OPTION_DEGREES, &s->inclination, "DEG",
          "between the spin and the way to us", NULL, "0 to 180"},
         IMAGE | HOTSPOT},
        {{"--position-angle", OPTION_DEGREES, &s->position_angle, "DEG",
          "of the projected spin, from north over east", NULL, "-360 to 360"},
         IMAGE},
        {{"--volume", OPTION_TEXTS, &s->volumes, VOLUME_VALUE,
          "matter: disk, torus, halo or jet, and fields as BhrVolume has them, with - for _; its light is a power law"
          " of the frequency, its absorption is that at 230 GHz; may be given again", NULL, NULL},
         IMAGE},
        {{"--frequency", OPTION_TEXT, &s->frequencies, "GHZ,...", "of the images", NULL, "1 to 1e5, 8 at most"},
         IMAGE},
        {{"--flux-230", OPTION_DOUBLE, &s->flux, "JY", "scales the emission so that this is the flux at 230 GHz", NULL,
          "above 0"}, IMAGE},
        {{"--beam", OPTION_DOUBLE, &s->beam, "UAS",
          "width at half of its peak of the Gaussian that the images are blurred by, microarcseconds; 0: none", NULL,
          "0 to 1e6"}, IMAGE},
        {{"--hot-spot", OPTION_TEXTS, &s->hot_spots, HOT_SPOT_VALUE,
          "fields as BhrHotSpot has them, with - for _; radius=7,size=0.7 unless given", NULL, NULL}, HOTSPOT},
        {{"--phases", OPTION_UINT, &s->phases, "N", "times in an orbit", NULL, "2 to 1000"}, HOTSPOT},
        {{"--fast-light", OPTION_FLAG, &s->fast_light, NULL, "as if light took no time on its way", NULL, NULL},
         HOTSPOT},
        {{"--observer", OPTION_DOUBLE, &s->observer, "R",
          "M from the hole, at rest: nearer than the default, rays are not parallel", NULL, "100 to 1e6"},
         IMAGE | HOTSPOT},
        {{"--fov", OPTION_DOUBLE, &s->fov, "WIDTH",
          "of the square that is seen; image: microarcseconds, hotspot: M, 0 for what suits the orbit", NULL,
          "above 0"}, IMAGE | HOTSPOT},
        {{"--pixels", OPTION_UINT, &s->pixels, "N", "in a row; a ray goes through the centre of each", NULL,
          "2 to 4096"}, IMAGE | HOTSPOT},
        {{"--plain", OPTION_FLAG, &s->plain, NULL,
          "no more rays than that: images of order 1 and more, beside the shadow, are not resolved then", NULL, NULL},
         IMAGE | HOTSPOT},
        {{"--output", OPTION_TEXT, &s->output, "FOLDER", "for the files; made if need be", NULL, NULL},
         IMAGE | HOTSPOT},
        {{"--threads", OPTION_UINT, &in->threads, "N", "of the tracer; 0: one per core", NULL, NULL},
         IMAGE | GOLD | HOTSPOT},
        {{"--progress", OPTION_FLAG, &in->progress, NULL, "a bar where it takes long, even if stderr is no terminal",
          NULL, NULL}, IMAGE | GOLD | HOTSPOT},
        {{"--help", OPTION_FLAG, &in->help, NULL, "this text", NULL, NULL}, IMAGE | GOLD | HOTSPOT},
    };
    memcpy(out, list, sizeof list);
    return COUNT_OF(list);
}

/* `command`: NULL for all of them, each option with the names of those that take it. */
static void print_help(const CommandOption *list, size_t count, const Command *command) {
    printf("Usage: observatory image|gold|hotspot [options]\n"
           "Makes images and light curves of matter about black holes, in the units of radio astronomers.\n"
           "image: images in Jy at some frequencies, as FITS and PNG files. gold: the fluxes of the tests of\n"
           "Gold et al. 2020 (ApJ 897, 148). hotspot: the light curve of a spot in orbit and the track of its\n"
           "centroid, as CSV and PNG. With --help after it, each shows its own defaults.\n\n");
    for (size_t i = 0; i < count; i++) {
        if (command != NULL && !(list[i].commands & command->bit)) {
            continue;
        }
        char   help[512] = "";
        size_t used = 0;
        for (size_t j = 0; list[i].commands != (IMAGE | GOLD | HOTSPOT) && j < COUNT_OF(COMMANDS); j++) {
            if (command == NULL && list[i].commands & COMMANDS[j].bit) {
                used += (size_t)snprintf(help + used, sizeof help - used, "%s%s", used > 0 ? ", " : "(",
                                         COMMANDS[j].name);
            }
        }
        snprintf(help + used, sizeof help - used, "%s%s", used > 0 ? ") " : "", list[i].option.help);
        Option option = list[i].option;
        option.help = help;
        options_print(stdout, &option, 1);
    }
}

static int refuse(const char *program, const char *option, double value, const char *range) {
    fprintf(stderr, "%s: %s is %g; it must be %s\n", program, option, value, range);
    return EXIT_USAGE;
}

/* The numbers that the library does not see. 0, or EXIT_USAGE after a message; not one NaN passes. */
static int check(const char *program, unsigned bit, const Settings *s) {
    const Target *target = &s->target;
    const double  turn = 2.0 * PI;
    if (!(target->mass >= 1.0 && target->mass <= 1e12)) {
        return refuse(program, "--mass-msun", target->mass, "1 to 1e12");
    }
    if (!(target->distance >= 1e-3 && target->distance <= 1e8)) {
        return refuse(program, "--distance-kpc", target->distance, "1e-3 to 1e8");
    }
    if (!(s->inclination >= 0.0 && s->inclination <= PI)) {
        return refuse(program, "--inclination", s->inclination * 180.0 / PI, "0 to 180");
    }
    if (!(s->position_angle >= -turn && s->position_angle <= turn)) {
        return refuse(program, "--position-angle", s->position_angle * 180.0 / PI, "-360 to 360");
    }
    if (!(s->fov >= 0.0 && s->fov <= 1e6) || (bit == IMAGE && s->fov == 0.0)) {
        return refuse(program, "--fov", s->fov, "above 0, to 1e6");
    }
    if (!(s->observer >= 100.0 && s->observer <= FAR)) {
        return refuse(program, "--observer", s->observer, "100 to 1e6");
    }
    if (!(s->beam >= 0.0 && s->beam <= 1e6)) {
        return refuse(program, "--beam", s->beam, "0 to 1e6");
    }
    if (!(s->flux > 0.0 && s->flux <= 1e9)) {
        return refuse(program, "--flux-230", s->flux, "above 0, to 1e9");
    }
    if (s->pixels < 2 || s->pixels > MOST_PIXELS) {
        return refuse(program, "--pixels", s->pixels, "2 to 4096");
    }
    if (s->phases < 2 || s->phases > 1000) {
        return refuse(program, "--phases", s->phases, "2 to 1000");
    }
    return 0;
}

/* The settings that a command begins with, before its options. */
static void begin(Input *in, const Command *command) {
    const int32_t target = in->target;
    memset(in, 0, sizeof *in);
    in->target = target;
    in->settings.target = TARGET_LIST[target];
    const Target *t = &in->settings.target;
    const int     image = command->bit == IMAGE;
    in->settings.spin = image ? 0.9 : 0.0;
    in->settings.inclination = (image ? t->inclination : 60.0) * PI / 180.0;
    in->settings.position_angle = image ? t->position_angle * PI / 180.0 : 0.0;
    in->settings.flux = t->flux;
    in->settings.observer = FAR;
    in->settings.fov = image ? 180.0 : 0.0;
    in->settings.beam = 20.0;
    in->settings.frequencies = "86,230,345";
    in->settings.pixels = image ? 128 : 96;
    in->settings.phases = 32;
    in->settings.output = "observatory-out";
}

/* Reads the options that the command takes: twice, as the target decides the defaults of others. */
static int read_options(Input *in, const Command *command, int argc, char **argv) {
    for (int pass = 0; pass < 2; pass++) {
        CommandOption list[MOST_OBSERVATORY_OPTIONS];
        Option        options[MOST_OBSERVATORY_OPTIONS];
        size_t        count = 0;
        begin(in, command);
        const size_t all = list_options(in, list);
        for (size_t i = 0; i < all; i++) {
            if (list[i].commands & command->bit) {
                options[count++] = list[i].option;
            }
        }
        const int result = options_parse(options, count, argc, argv);
        if (result != 0) {
            return result;
        }
    }
    return 0;
}

static int run_command(Input *in, const Command *command) {
    BhrContextOptions options;
    BhrContext       *context = NULL;
    BhrStatus         status = bhr_context_options_init(&options, sizeof options);
    if (status >= 0) {
        options.backend = BHR_BACKEND_CPU;
        options.cpu_threads = in->threads;
        status = bhr_context_create(BHR_ABI_VERSION, &options, &context);
    }
    if (status < 0) {
        return report_failure("create a context", status);
    }
    in->settings.progress = progress_begin(in->progress || is_terminal(stderr));
    const int result = command->run(context, &in->settings);
    progress_clear(&in->settings.progress);
    bhr_context_destroy(context);
    return result;
}

static int run(int argc, char **argv) {
    const Command *command = NULL;
    for (size_t i = 0; argc > 1 && i < COUNT_OF(COMMANDS); i++) {
        if (strcmp(argv[1], COMMANDS[i].name) == 0) {
            command = &COMMANDS[i];
        }
    }
    Input in = {.target = 0};
    if (command == NULL && argc > 1 && strcmp(argv[1], "--help") == 0) {
        in.help = 1;
    } else if (command == NULL) {
        fprintf(stderr, "%s: '%s' is no command; it is image, gold or hotspot, and --help says more\n", argv[0],
                argc > 1 ? argv[1] : "");
        return EXIT_USAGE;
    } else {
        argv[1] = argv[0]; /* messages begin with it */
        const int result = read_options(&in, command, argc - 1, argv + 1);
        if (result != 0) {
            return result;
        }
    }
    if (in.help) {
        CommandOption list[MOST_OBSERVATORY_OPTIONS];
        begin(&in, command != NULL ? command : &COMMANDS[0]);
        print_help(list, list_options(&in, list), command);
        return EXIT_SUCCESS;
    }
    const int result = check(argv[0], command->bit, &in.settings);
    return result != 0 ? result : run_command(&in, command);
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
