/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* gallery.c -- named scenes (gallery_scenes.c) into PNG files, and a contact sheet of them: what the renderer can
 * show. */
#include "gallery_scenes.h"
#include "options.h"
#include "picture.h"
#include "scene.h"

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

/* ---- the contact sheet ---- */

typedef struct Sheet {
    BhrImage image;
    uint32_t cell[2];  /* room for a picture; its name is below */
    uint32_t shown;    /* pictures so far */
} Sheet;

/* 1, or 0 after a message. */
static int sheet_begin(Sheet *sheet, uint32_t width) {
    const uint32_t rows = ((uint32_t)EXHIBIT_COUNT + SHEET_COLUMNS - 1) / SHEET_COLUMNS;
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
    const char *output;
    const char *only; /* NULL: all scenes */
    uint32_t    width, samples;
    int32_t     backend, preset; /* BHR_PRESET_*; NO_PRESET: each scene's own look */
    int         list, help;
} Settings;

/* 1, or 0 after a message. */
static int set_scene(BhrContext *context, const Settings *s, const Exhibit *exhibit) {
    Scene     scene;
    BhrStatus status = scene_init(&scene, &GALLERY_BEGINNING);
    if (status >= 0) {
        scene.quality.samples_per_pixel = s->samples;
        status = scene_set_preset(&scene, context, exhibit->look);
    }
    if (status >= 0) {
        status = exhibit->describe(&scene);
    }
    if (status >= 0 && s->preset != NO_PRESET) {
        const int has_disk = scene.has_disk;
        status = scene_set_preset(&scene, context, s->preset);
        scene.has_disk = has_disk;
    }
    if (status >= 0) {
        status = scene_apply(&scene, context);
    }
    if (status < 0) {
        fprintf(stderr, "%s: ", exhibit->name);
        report_failure("set the scene", status);
    }
    return status >= 0;
}

/* Renders into the picture and saves it. 1, or 0 after a message. */
static int render(BhrContext *context, const Settings *s, const Exhibit *exhibit, const BhrImage *picture) {
    char   name[64];
    double begin = wall_seconds();
    if (!set_scene(context, s, exhibit)) {
        return 0;
    }
    BhrStatus status = bhr_render_image(context, picture);
    if (status < 0) {
        fprintf(stderr, "%s: ", exhibit->name);
        report_failure("render", status);
        return 0;
    }
    snprintf(name, sizeof name, "%s.png", exhibit->name);
    if (!picture_save_into(picture, s->output, name)) {
        return 0;
    }
    printf("%s/%s  %u x %u, %.1f s\n", s->output, name, (unsigned)picture->width, (unsigned)picture->height,
           wall_seconds() - begin);
    fflush(stdout);
    return 1;
}

/* Renders one scene, and puts it on the sheet unless that is NULL. 1, or 0 after a message. */
static int make_picture(BhrContext *context, const Settings *s, const Exhibit *exhibit, Sheet *sheet) {
    BhrImage       picture;
    const uint32_t unit = s->width / exhibit->shape[0]; /* exactly that shape: a cube must be six squares */
    if (!picture_allocate(&picture, BHR_FORMAT_RGBA8_SRGB, unit * exhibit->shape[0], unit * exhibit->shape[1])) {
        return 0;
    }
    int made = render(context, s, exhibit, &picture);
    if (made && sheet != NULL) {
        sheet_add(sheet, &picture, exhibit->name);
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
    for (size_t i = 0; made && i < EXHIBIT_COUNT; i++) {
        made = make_picture(context, s, &EXHIBITS[i], &sheet);
    }
    made = made && picture_save_into(&sheet.image, s->output, SHEET);
    free(sheet.image.pixels);
    if (made) {
        printf("%s/%s\n", s->output, SHEET);
    }
    return made;
}

static const Exhibit *find_exhibit(const char *name) {
    for (size_t i = 0; i < EXHIBIT_COUNT; i++) {
        if (strcmp(EXHIBITS[i].name, name) == 0) {
            return &EXHIBITS[i];
        }
    }
    return NULL;
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
    int made = s->only != NULL ? make_picture(context, s, find_exhibit(s->only), NULL) : make_all(context, s);
    bhr_context_destroy(context);
    return made ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* ---- command line ---- */

static void list_exhibits(void) {
    for (size_t i = 0; i < EXHIBIT_COUNT; i++) {
        printf("%-22s %s\n", EXHIBITS[i].name, EXHIBITS[i].about);
    }
}

/* 0, or EXIT_USAGE after a message. */
static int check(const char *program, const Settings *s) {
    if (s->width < LEAST_WIDTH || s->width > MOST_WIDTH) {
        fprintf(stderr, "%s: --width is %u; it must be %u to %u\n", program, (unsigned)s->width, LEAST_WIDTH,
                MOST_WIDTH);
        return EXIT_USAGE;
    }
    if (s->only != NULL && find_exhibit(s->only) == NULL) {
        fprintf(stderr, "%s: there is no scene '%s'; --list shows them\n", program, s->only);
        return EXIT_USAGE;
    }
    return 0;
}

static int run(int argc, char **argv) {
    Settings     s = {.output = "gallery-out", .width = 960, .samples = 8, .backend = BHR_BACKEND_AUTO,
                      .preset = NO_PRESET};
    const Option options[] = {
        {"--output", OPTION_TEXT, &s.output, "FOLDER", "for the pictures; made if need be", NULL, NULL},
        {"--only", OPTION_TEXT, &s.only, "NAME", "this scene alone, and no contact sheet", NULL, NULL},
        {"--width", OPTION_UINT, &s.width, "N", "pixels across, 16 to 16384, to fit the shape", NULL, NULL},
        {"--preset", OPTION_CHOICE, &s.preset, NULL, "this look for all scenes, instead of their own", PRESETS, NULL},
        {"--samples", OPTION_UINT, &s.samples, "N", "per pixel, 1 to 256", NULL, NULL},
        {"--backend", OPTION_CHOICE, &s.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--list", OPTION_FLAG, &s.list, NULL, "names the scenes", NULL, NULL},
        {"--help", OPTION_FLAG, &s.help, NULL, "this text", NULL, NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result != 0) {
        return result;
    }
    if (s.help) {
        printf("Usage: gallery [options]\nRenders named scenes into PNG files, and a contact sheet, " SHEET ".\n\n");
        options_print(stdout, options, COUNT_OF(options));
        return EXIT_SUCCESS;
    }
    if (s.list) {
        list_exhibits();
        return EXIT_SUCCESS;
    }
    result = check(argv[0], &s);
    return result != 0 ? result : make_pictures(&s);
}

int main(int argc, char **argv) {
    return end_output(run(argc, argv));
}
