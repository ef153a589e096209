/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gallery.c -- scene files (examples-c/scenes) into PNG files, and a contact sheet of them: what the renderer can
 * show. */
#include "colour_bar.h"
#include "options.h"
#include "picture.h"
#include "scene_files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define SHEET "contact-sheet.png"
#define SHEET_COLUMNS 4u
#define SHEET_MARGIN 8u
#define LEAST_CELL 132u    /* pixels across: the longest name */
#define MOST_CELL 208u
#define SHEET_GREY 40      /* of 255 */
#define LEAST_WIDTH 16u    /* of a picture: of shape 16 : 9 that is 9 rows */
#define MOST_WIDTH 16384u
#define NO_PRESET (-1) /* each scene's own look */
#define OWN_SAMPLES UINT32_MAX

/* The scenes in the order of the contact sheet; what each is, its file says. */
static const char *const EXHIBITS[] = {
    "cinematic", "physical", "observatory", "teaching", "gargantua", "tilt", "crescent", "plunge", "polar", "storm",
    "anamorphic", "schwarzschild-edge-on", "schwarzschild-face-on", "kerr-0.998", "translucent", "orion",
    "einstein-ring", "galactic-centre", "grid", "fall-4", "fall-2.5", "fall-1.5",
    "inside-kerr-horizon", "inside-kerr-between", "inside-kerr-inner", "inside-kerr-dome",
    "inside-kerr-horizon-dome", "inside-kerr-inner-dome", "orbiting-observer",
    "dome-master", "equirect", "cube", "soft-disk", "torus", "halo", "jet", "hot-spot",
    "inside-the-torus", "view-redshift", "view-order", "view-deflection", "view-steps", "view-metric",
};

/* ---- the contact sheet ---- */

typedef struct Sheet {
    BhrImage image;
    uint32_t cell[2];  /* room for a picture; its name is below */
    uint32_t shown;    /* pictures so far */
} Sheet;

/* 1, or 0 after a message. */
static int sheet_begin(Sheet *sheet, uint32_t width) {
    const uint32_t rows = ((uint32_t)COUNT_OF(EXHIBITS) + SHEET_COLUMNS - 1) / SHEET_COLUMNS;
    sheet->cell[0] = width < LEAST_CELL ? LEAST_CELL : width > MOST_CELL ? MOST_CELL : width;
    sheet->cell[1] = sheet->cell[0] * 9 / 16;
    sheet->shown = 0;
    if (!picture_allocate(&sheet->image, BHR_FORMAT_RGBA8_SRGB,
                          SHEET_COLUMNS * (sheet->cell[0] + SHEET_MARGIN) + SHEET_MARGIN,
                          rows * (sheet->cell[1] + SHEET_MARGIN + 2 * CELL_HEIGHT) + SHEET_MARGIN)) {
        return 0;
    }
    picture_fill(&sheet->image, SHEET_GREY);
    return 1;
}

/* The largest picture of its shape in the middle of the next cell, and its name below. */
static void sheet_add(Sheet *sheet, const BhrImage *picture, const char *name) {
    const uint32_t *cell = sheet->cell;
    uint32_t        x = SHEET_MARGIN + sheet->shown % SHEET_COLUMNS * (cell[0] + SHEET_MARGIN);
    uint32_t        y = SHEET_MARGIN + sheet->shown / SHEET_COLUMNS * (cell[1] + SHEET_MARGIN + 2 * CELL_HEIGHT);
    uint32_t        width = cell[0], height = cell[0] * picture->height / picture->width;
    if (height > cell[1]) {
        width = cell[1] * picture->width / picture->height;
        height = cell[1];
    }
    picture_scale(picture, &sheet->image, x + (cell[0] - width) / 2, y + (cell[1] - height) / 2, width, height);
    uint32_t text = CELL_WIDTH * (uint32_t)strlen(name);
    x += text < cell[0] ? (cell[0] - text) / 2 : 0;
    picture_write(&sheet->image, x, y + cell[1] + CELL_HEIGHT / 2, 1, name);
    sheet->shown++;
}

/* ---- pictures ---- */

typedef struct Settings {
    const char *scenes; /* NULL: where the program finds them */
    const char *output;
    const char *only; /* NULL: all scenes */
    uint32_t    width, samples;
    int32_t     backend, preset;
    int         list, help;
} Settings;

/* This look in place of the scene's own; a scene without a disk gets none. */
static BhrStatus set_preset(BhrContext *context, BhrPreset preset) {
    BhrDisk disk;
    BHR_INIT(disk);
    int32_t   has_disk;
    BhrStatus status = bhr_get_disk(context, &disk, &has_disk);
    if (status >= 0) {
        status = bhr_set_preset(context, preset);
    }
    return status >= 0 && !has_disk ? bhr_set_disk(context, NULL) : status;
}

static BhrStatus set_samples(BhrContext *context, uint32_t samples) {
    BhrQuality quality;
    BHR_INIT(quality);
    BhrStatus status = bhr_get_quality(context, &quality);
    quality.samples_per_pixel = samples;
    return status >= 0 ? bhr_set_quality(context, &quality) : status;
}

/* The largest whole number that divides both. */
static uint32_t common_divisor(uint32_t a, uint32_t b) {
    while (b != 0) {
        const uint32_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* Sets the scene, and *size to the picture that it asks for, shrunk to exactly its shape: a cube must be six squares.
 * 1, or 0 after a message. */
static int set_scene(BhrContext *context, const Settings *s, const char *name, uint32_t size[2]) {
    char path[MOST_PATH];
    if (!scene_file_path(s->scenes, name, path)) {
        return 0;
    }
    BhrStatus status = bhr_scene_load_file(context, path);
    if (status >= 0) {
        status = bhr_scene_pictures(context, &size[0], &size[1], NULL, NULL);
    }
    if (status >= 0 && s->preset != NO_PRESET) {
        status = set_preset(context, s->preset);
    }
    if (status >= 0 && s->samples != OWN_SAMPLES) {
        status = set_samples(context, s->samples);
    }
    if (status < 0) {
        fprintf(stderr, "%s: ", name);
        report_failure("set the scene", status);
        return 0;
    }
    const uint32_t divisor = common_divisor(size[0], size[1]), columns = size[0] / divisor, rows = size[1] / divisor;
    const uint32_t unit = s->width > columns ? s->width / columns : 1;
    size[0] = unit * columns;
    size[1] = unit * rows;
    return 1;
}

/* Renders into the picture, with a colour bar where its colours are false, and saves it. 1, or 0 after a message. */
static int render(BhrContext *context, const Settings *s, const char *scene, BhrImage *picture) {
    char      name[64];
    double    begin = wall_seconds();
    BhrStatus status = bhr_render_image(context, picture);
    if (status >= 0) {
        status = colour_bar_add(context, picture);
    }
    if (status < 0) {
        fprintf(stderr, "%s: ", scene);
        report_failure("render", status);
        return 0;
    }
    snprintf(name, sizeof name, "%s.png", scene);
    if (!picture_save_into(picture, s->output, name)) {
        return 0;
    }
    printf("%s/%s  %u x %u, %.1f s\n", s->output, name, (unsigned)picture->width, (unsigned)picture->height,
           wall_seconds() - begin);
    fflush(stdout);
    return 1;
}

/* Renders one scene, and puts it on the sheet unless that is NULL. 1, or 0 after a message. */
static int make_picture(BhrContext *context, const Settings *s, const char *scene, Sheet *sheet) {
    BhrImage picture;
    uint32_t size[2];
    if (!set_scene(context, s, scene, size) || !picture_allocate(&picture, BHR_FORMAT_RGBA8_SRGB, size[0], size[1])) {
        return 0;
    }
    int made = render(context, s, scene, &picture);
    if (made && sheet != NULL) {
        sheet_add(sheet, &picture, scene);
    }
    free(picture.pixels);
    return made;
}

static int make_all(BhrContext *context, const Settings *s) {
    Sheet sheet;
    if (!sheet_begin(&sheet, s->width)) {
        return 0;
    }
    int made = 1;
    for (size_t i = 0; made && i < COUNT_OF(EXHIBITS); i++) {
        made = make_picture(context, s, EXHIBITS[i], &sheet);
    }
    made = made && picture_save_into(&sheet.image, s->output, SHEET);
    free(sheet.image.pixels);
    if (made) {
        printf("%s/%s\n", s->output, SHEET);
    }
    return made;
}

static int is_exhibit(const char *name) {
    for (size_t i = 0; i < COUNT_OF(EXHIBITS); i++) {
        if (strcmp(EXHIBITS[i], name) == 0) {
            return 1;
        }
    }
    return 0;
}

/* An exit status. */
static int make_pictures(const Settings *s) {
    if (!make_folder(s->output) && errno != EEXIST) {
        fprintf(stderr, "cannot make the folder %s: %s\n", s->output, strerror(errno));
        return EXIT_FAILURE;
    }
    BhrContext *context = NULL;
    BhrStatus   status = create_context_on(s->backend, &context);
    if (status < 0) {
        return report_failure("create a context", status);
    }
    int made = s->only != NULL ? make_picture(context, s, s->only, NULL) : make_all(context, s);
    bhr_context_destroy(context);
    return made ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* ---- command line ---- */

/* Each with what its file says. An exit status. */
static int list_exhibits(const Settings *s) {
    char path[MOST_PATH], about[MOST_ABOUT];
    for (size_t i = 0; i < COUNT_OF(EXHIBITS); i++) {
        if (!scene_file_path(s->scenes, EXHIBITS[i], path) || !scene_file_about(path, about)) {
            return EXIT_FAILURE;
        }
        printf("%-22s %s\n", EXHIBITS[i], about);
    }
    return EXIT_SUCCESS;
}

/* 0, or EXIT_USAGE after a message. */
static int check(const char *program, const Settings *s) {
    if (s->width < LEAST_WIDTH || s->width > MOST_WIDTH) {
        fprintf(stderr, "%s: --width is %u; it must be %u to %u\n", program, (unsigned)s->width, LEAST_WIDTH,
                MOST_WIDTH);
        return EXIT_USAGE;
    }
    if (s->only != NULL && !is_exhibit(s->only)) {
        fprintf(stderr, "%s: there is no scene '%s'; --list shows them\n", program, s->only);
        return EXIT_USAGE;
    }
    return 0;
}

static int run(int argc, char **argv) {
    Settings     s = {.output = "gallery-out", .width = 960, .samples = OWN_SAMPLES, .backend = BHR_BACKEND_AUTO,
                      .preset = NO_PRESET};
    const Option options[] = {
        {"--scenes", OPTION_TEXT, &s.scenes, "FOLDER", "of the scene files; " SCENES_DEFAULT, NULL, NULL},
        {"--output", OPTION_TEXT, &s.output, "FOLDER", "for the pictures; made if need be", NULL, NULL},
        {"--only", OPTION_TEXT, &s.only, "NAME", "this scene alone, and no contact sheet", NULL, NULL},
        {"--width", OPTION_UINT, &s.width, "N", "pixels across, 16 to 16384, to fit the shape", NULL, NULL},
        {"--preset", OPTION_CHOICE, &s.preset, NULL, "this look for all scenes, instead of their own", PRESETS, NULL},
        {"--samples", OPTION_UINT, &s.samples, "N", "per pixel, 1 to 256, instead of each scene's own", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--list", OPTION_FLAG, &s.list, NULL, "names the scenes", NULL, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.help) {
        printf("Usage: gallery [options]\nRenders scene files into PNG files, and a contact sheet, " SHEET ".\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    if (s.list) {
        return list_exhibits(&s);
    }
    result = check(argv[0], &s);
    return result != 0 ? result : make_pictures(&s);
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
