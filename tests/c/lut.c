/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* lut.c -- LUTs of the film, from memory and from .cube files: they change pictures of light in 8 bits and nothing
 * else, scenes name their files, and what is wrong is refused and changes nothing. Gets an empty folder. */
#include "check.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 48u
#define HEIGHT 32u
#define BYTES (WIDTH * HEIGHT * 4u)
#define MOST_SIDE 65u

static const char *folder;
static float       nodes[3 * MOST_SIDE * MOST_SIDE * MOST_SIDE];

static unsigned char before[BYTES * 4], after[BYTES * 4];

static const char *path_of(const char *name) {
    static char path[4][4096];
    static int  next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    if (CHECK(file != NULL, "%s cannot be written", path)) {
        fwrite(text, 1, strlen(text), file);
        fclose(file);
    }
}

static void render(BhrContext *context, BhrFormat format, uint32_t flags, unsigned char *pixels) {
    BhrImage image = image_of(format, WIDTH, HEIGHT, pixels, WIDTH * HEIGHT * bytes_per_pixel(format));
    image.flags = flags;
    CHECK_OK(bhr_render_image(context, &image));
}

/* The numbers of nodes, red changing fastest: each colour as it is, or turned about, or its negative. */
typedef enum { SAME, TURNED, NEGATIVE } Table;

static size_t fill(uint32_t side, Table table) {
    size_t count = 0;
    for (uint32_t b = 0; b < side; b++) {
        for (uint32_t g = 0; g < side; g++) {
            for (uint32_t r = 0; r < side; r++) {
                const float at[3] = {r / (side - 1.0f), g / (side - 1.0f), b / (side - 1.0f)};
                for (size_t c = 0; c < 3; c++) {
                    nodes[count++] = table == TURNED ? at[(c + 1) % 3] : table == NEGATIVE ? 1.0f - at[c] : at[c];
                }
            }
        }
    }
    return count;
}

static void write_cube(const char *path, uint32_t side, const char *header) {
    FILE *file = fopen(path, "wb");
    if (CHECK(file != NULL, "%s cannot be written", path)) {
        fprintf(file, "# by lut.c\nTITLE \"a look\"\n%sLUT_3D_SIZE %u\n\n", header, side);
        for (size_t i = 0; i < 3u * side * side * side; i += 3) {
            fprintf(file, "%.9g %.9g %.9g\n", nodes[i], nodes[i + 1], nodes[i + 2]);
        }
        fclose(file);
    }
}

static void set_strength(BhrContext *context, double strength, BhrColourMap colour_map) {
    BhrFilm film, got;
    BHR_INIT(film);
    BHR_INIT(got);
    CHECK(film.lut_strength == 1.0, "the default of lut_strength is %g", film.lut_strength);
    film.bloom = 0.0;
    film.lut_strength = strength;
    film.colour_map = colour_map;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_get_film(context, &got));
    CHECK(got.lut_strength == strength, "lut_strength %g is got as %g", strength, got.lut_strength);
}

/* The largest difference of a component. */
static int most_apart(const unsigned char *a, const unsigned char *b) {
    int most = 0;
    for (size_t i = 0; i < BYTES; i++) {
        const int apart = abs(a[i] - b[i]);
        most = apart > most ? apart : most;
    }
    return most;
}

static void tables_take_the_places_of_colours(BhrContext *context) {
    static const uint32_t sides[] = {2, 17, 33, 65};
    set_strength(context, 1.0, BHR_COLOUR_MAP_NONE);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    for (size_t i = 0; i < COUNT_OF(sides); i++) {
        CHECK_OK(bhr_set_film_lut(context, nodes, fill(sides[i], SAME), sides[i]));
        render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
        const int most = most_apart(before, after);
        CHECK(most <= 1, "a LUT of %u nodes a side that changes nothing changes codes by %d", sides[i], most);
    }
    CHECK_OK(bhr_set_film_lut(context, nodes, fill(9, TURNED), 9));
    memset(nodes, 0, sizeof nodes); /* bhr has a copy */
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    size_t wrong = 0;
    for (size_t i = 0; i < BYTES; i += 4) {
        for (size_t c = 0; c < 3; c++) {
            wrong += abs(after[i + c] - before[i + (c + 1) % 3]) > 1;
        }
    }
    CHECK(wrong == 0 && memcmp(before, after, BYTES) != 0, "%u components are not those beside them", (unsigned)wrong);
    CHECK_OK(bhr_set_film_lut(context, nodes, fill(2, NEGATIVE), 2));
    render(context, BHR_FORMAT_BGRA8_SRGB, 0, after);
    for (size_t i = 0; i < BYTES; i += 4) {
        wrong += after[i + 3] != 255;
        for (size_t c = 0; c < 3; c++) {
            wrong += abs(after[i + c] + before[i + 2 - c] - 255) > 1;
        }
    }
    CHECK(wrong == 0, "%u components are no negative", (unsigned)wrong);
    render(context, BHR_FORMAT_RGBA8_SRGB, BHR_IMAGE_TRANSPARENT, after);
    size_t white = 0;
    for (size_t i = 0; i < BYTES; i += 4) {
        white += after[i + 3] == 0 && after[i] == 255 && after[i + 1] == 255 && after[i + 2] == 255;
    }
    CHECK(white > 100, "where a transparent image is black, a negative has %u white pixels", (unsigned)white);
    set_strength(context, 0.5, BHR_COLOUR_MAP_NONE);
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    for (size_t i = 0; i < BYTES; i++) {
        wrong += i % 4 < 3 && abs(after[i] - 127) > 1;
    }
    CHECK(wrong == 0, "%u components are not half way to the negative", (unsigned)wrong);
}

/* Strength 0, colour maps, other views and float formats have the bytes of a context without a LUT; and so has one
 * whose LUT was taken away. */
static void other_pictures_are_left_alone(BhrContext *context) {
    static const BhrFormat floats[] = {BHR_FORMAT_RGBA16F, BHR_FORMAT_RGBA32F};
    for (int with = 0; with < 2; with++) {
        CHECK_OK(bhr_set_film_lut(context, nodes, with ? fill(3, NEGATIVE) : 0, 3));
        static unsigned char kept[5][BYTES * 4];
        unsigned char       *to = with ? after : NULL;
        set_strength(context, 0.0, BHR_COLOUR_MAP_NONE);
        render(context, BHR_FORMAT_RGBA8_SRGB, 0, with ? to : kept[0]);
        CHECK(!with || memcmp(kept[0], after, BYTES) == 0, "a LUT of strength 0 changes a picture");
        set_strength(context, 1.0, BHR_COLOUR_MAP_AFMHOT);
        render(context, BHR_FORMAT_RGBA8_SRGB, 0, with ? to : kept[1]);
        CHECK(!with || memcmp(kept[1], after, BYTES) == 0, "a LUT changes the colours of a map");
        set_strength(context, 1.0, BHR_COLOUR_MAP_NONE);
        for (size_t i = 0; i < COUNT_OF(floats); i++) {
            render(context, floats[i], 0, with ? to : kept[2 + i]);
            CHECK(!with || memcmp(kept[2 + i], after, WIDTH * HEIGHT * bytes_per_pixel(floats[i])) == 0,
                  "a LUT changes linear light");
        }
        CHECK_OK(bhr_set_view(context, BHR_VIEW_REDSHIFT));
        render(context, BHR_FORMAT_RGBA8_SRGB, 0, with ? to : kept[4]);
        CHECK(!with || memcmp(kept[4], after, BYTES) == 0, "a LUT changes the colours of a view");
        CHECK_OK(bhr_set_view(context, BHR_VIEW_LIGHT));
    }
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    CHECK_OK(bhr_set_preset(context, BHR_PRESET_PHYSICAL));
    set_strength(context, 1.0, BHR_COLOUR_MAP_NONE);
    CHECK_OK(bhr_set_film_lut(context, NULL, 0, 0));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(most_apart(before, after) > 100, "a LUT that was taken away is still shown");
    /* A film of an older header leaves the LUT whole. */
    BhrFilm old;
    BHR_INIT(old);
    old.bloom = 0.0, old.lut_strength = 0.25;
    old.struct_size = offsetof(BhrFilm, lut_strength);
    CHECK_OK(bhr_set_film(context, &old));
    BHR_INIT(old);
    CHECK_OK(bhr_get_film(context, &old));
    CHECK(old.lut_strength == 1.0, "a film without lut_strength has %g", old.lut_strength);
}

static char *saved(const BhrContext *context) {
    size_t size = 0;
    CHECK_OK(bhr_scene_save(context, NULL, 0, &size));
    char *text = malloc(size + 1);
    CHECK_OK(bhr_scene_save(context, text, size + 1, &size));
    return text;
}

static void files_are_named_by_scenes(BhrContext *context) {
    size_t size = 0;
    set_strength(context, 1.0, BHR_COLOUR_MAP_NONE);
    CHECK_OK(bhr_set_film_lut(context, nodes, fill(5, TURNED), 5));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "bhr_set_film_lut_file", bhr_scene_save(context, NULL, 0, &size));
    write_cube(path_of("look.cube"), 5, "");
    CHECK_OK(bhr_set_film_lut(context, NULL, 0, 0));
    CHECK_OK(bhr_set_film_lut_file(context, path_of("look.cube")));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(memcmp(before, after, BYTES) == 0, "a LUT from a file is another than from memory");
    char *text = saved(context);
    CHECK(strstr(text, "/look.cube\"") != NULL, "the text names no absolute path:\n%s", text);
    CHECK_OK(bhr_scene_load(context, "", 0));
    char *none = saved(context);
    CHECK(strstr(none, "look.cube") == NULL, "a scene without a LUT keeps the one before:\n%s", none);
    CHECK_OK(bhr_scene_load(context, text, strlen(text)));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(memcmp(before, after, BYTES) == 0, "the scene that was saved has another LUT");
    CHECK_OK(bhr_scene_save_file(context, path_of("scene.toml")));
    CHECK_OK(bhr_scene_load(context, "", 0));
    CHECK_OK(bhr_scene_load_file(context, path_of("scene.toml")));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(memcmp(before, after, BYTES) == 0, "the scene's file has another LUT");
    free(none);
    free(text);
    /* A domain twice as wide, of the table that changes nothing, halves what nodes are asked for. */
    fill(3, SAME);
    write_cube(path_of("domain.cube"), 3, "DOMAIN_MIN -1 -1 -1\nDOMAIN_MAX 1 1 1\n");
    CHECK_OK(bhr_set_film_lut(context, NULL, 0, 0));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, before);
    CHECK_OK(bhr_set_film_lut_file(context, path_of("domain.cube")));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    size_t wrong = 0;
    for (size_t i = 0; i < BYTES; i++) {
        wrong += i % 4 < 3 && abs(2 * after[i] - before[i] - 255) > 3;
    }
    CHECK(wrong == 0, "%u components do not lie in the table's upper half", (unsigned)wrong);
    /* The file is read again when it has changed. */
    write_cube(path_of("domain.cube"), 3, "");
    CHECK_OK(bhr_set_film_lut_file(context, path_of("domain.cube")));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    CHECK(most_apart(before, after) <= 1, "a file that has changed is not read again");
}

static void mistakes(BhrContext *context) {
    static const struct {
        const char *text, *words;
    } bad[] = {
        {"", "no LUT_3D_SIZE"},
        {"LUT_3D_SIZE 1\n", "line 1: LUT_3D_SIZE is \"1\"; it must be an integer in [2, 65]"},
        {"LUT_3D_SIZE 66\n", "[2, 65]"},
        {"LUT_3D_SIZE 4294967298\n", "[2, 65]"},
        {"LUT_1D_SIZE 3\n0 0 0\n", "line 1: LUT_1D_SIZE"},
        {"LUT_3D_SIZE 2\n0 0 0\n", "after 1 colours"},
        {"LUT_3D_SIZE 2\n0 0 0\n0 0 nan\n", "line 3"},
        {"LUT_3D_SIZE 2\n0 inf 0\n", "line 2"},
        {"LUT_3D_SIZE 2\n0 0 0\n0 0\n", "line 3"},
        {"LUT_3D_SIZE 2\n0 0 0\n0 0 0 0\n", "line 3"},
        {"LUT_3D_SIZE 2\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n", "line 10"},
        {"DOMAIN_MIN 1 0 0\nLUT_3D_SIZE 2\n0 0 0\n", "red"},
        {"LOOK 3\n", "\"LOOK\""},
        {"LUT_3D_SIZE 2\n\xff\n", "UTF-8"},
    };
    Watch watch;
    fill(3, TURNED);
    write_cube(path_of("good.cube"), 3, "");
    CHECK_OK(bhr_set_film_lut_file(context, path_of("good.cube")));
    watch_begin(&watch, context);
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        write_file(path_of("bad.cube"), bad[i].text);
        CHECK_REFUSED(&watch, BHR_ERROR_IO, bad[i].words, bhr_set_film_lut_file(context, path_of("bad.cube")));
    }
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "bad.cube",
                  bhr_scene_load(context, "[film]\nlut = 'bad.cube'", strlen("[film]\nlut = 'bad.cube'")));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "line 2, column 7: lut is",
                  bhr_scene_load(context, "[film]\nlut = 3", strlen("[film]\nlut = 3")));
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "no.cube", bhr_set_film_lut_file(context, path_of("no.cube")));
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "regular", bhr_set_film_lut_file(context, folder));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "path is NULL", bhr_set_film_lut_file(context, NULL));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "path is empty", bhr_set_film_lut_file(context, ""));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "nodes is NULL", bhr_set_film_lut(context, NULL, 24, 2));
    static const struct {
        size_t      count;
        uint32_t    side;
        const char *words;
    } sizes[] = {
        {1, 0, "side is 0; it must lie in [2, 65]"},
        {3, 1, "side is 1;"},
        {66u * 66u * 66u * 3u, 66, "side is 66;"},
        {24, UINT32_MAX, "side is 4294967295;"},
        {SIZE_MAX, 2, "it must be 24"},
        {8, 2, "count is 8; for a side of 2 it must be 24"},
        {23, 2, "count is 23"},
        {25, 2, "count is 25"},
    };
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, sizes[i].words,
                      bhr_set_film_lut(context, nodes, sizes[i].count, sizes[i].side));
    }
    static const float numbers[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(numbers); i++) {
        const size_t count = fill(2, SAME);
        nodes[count - 1 - i] = numbers[i];
        CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "nodes[2", bhr_set_film_lut(context, nodes, count, 2));
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_film_lut(NULL, nodes, 24, 2));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_film_lut_file(NULL, "a"));
    /* Numbers at the limits, which are no mistakes; an array that is not aligned. */
    for (size_t i = 0; i < 24; i++) {
        nodes[i] = i % 2 == 0 ? FLT_MAX : -FLT_MAX;
    }
    CHECK_OK(bhr_set_film_lut(context, nodes, 24, 2));
    render(context, BHR_FORMAT_RGBA8_SRGB, 0, after);
    fill(2, SAME);
    memmove((char *)nodes + 1, nodes, 24 * sizeof *nodes);
    CHECK_OK(bhr_set_film_lut(context, (const float *)(const void *)((char *)nodes + 1), 24, 2));
    CHECK_OK(bhr_set_film_lut(context, NULL, 0, 0));
    CHECK_OK(bhr_set_film_lut(context, nodes, 0, 77));
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    folder = argv[argc - 1];
    BhrContext *context = check_context(backend);
    tables_take_the_places_of_colours(context);
    other_pictures_are_left_alone(context);
    files_are_named_by_scenes(context);
    mistakes(context);
    bhr_context_destroy(context);
    return check_end();
}
