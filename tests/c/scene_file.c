/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* scene_file.c -- scenes as text: what is saved is loaded again to the same picture, mistakes change nothing, what
 * moves is set to a time, a frame beside a thread that loads shows one of two scenes. Gets an empty folder. */
#include "check.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *folder;

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

static BhrStatus load(BhrContext *context, const char *text) { return bhr_scene_load(context, text, strlen(text)); }

/* The scene's text, which the caller frees. */
static char *saved(const BhrContext *context) {
    size_t size = 0, again = 0;
    CHECK_OK(bhr_scene_save(context, NULL, 0, &size));
    char *text = malloc(size + 2);
    memset(text, 7, size + 2);
    CHECK_OK(bhr_scene_save(context, text, size + 1, &again));
    CHECK(again == size && strlen(text) == size && text[size + 1] == 7, "%zu bytes were to be written, %zu are", size,
          strlen(text));
    return text;
}

static void a_picture(BhrContext *context, unsigned char *pixels) {
    BhrImage image;
    BHR_INIT(image);
    image.width = WATCH_WIDTH, image.height = WATCH_HEIGHT;
    image.pixels = pixels, image.byte_size = WATCH_WIDTH * WATCH_HEIGHT * 4;
    CHECK_OK(bhr_render_image(context, &image));
}

static void round_trips(BhrContext *context, BhrBackend backend) {
    static unsigned char before[WATCH_WIDTH * WATCH_HEIGHT * 4], after[sizeof before];
    BhrCamera            camera;
    BhrHotSpot           spot;
    const double         axis[3] = {0.3, -0.1, 2.0};
    BHR_INIT(camera);
    BHR_INIT(spot);
    CHECK_OK(bhr_set_mass(context, 1.25));
    CHECK_OK(bhr_set_spin(context, 0.1));
    CHECK_OK(bhr_set_axis(context, axis));
    CHECK_OK(bhr_camera_orbit(&camera, 21.0, 0.7, 0.2));
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_hot_spots(context, &spot, sizeof spot, 1));
    CHECK_OK(bhr_set_time(context, 1.0 / 3.0));
    a_picture(context, before);
    char       *text = saved(context);
    BhrContext *other = check_context(backend);
    CHECK_OK(load(other, text));
    a_picture(other, after);
    CHECK(memcmp(before, after, sizeof before) == 0, "the scene that was saved shows another picture");
    char *again = saved(other);
    CHECK(strcmp(text, again) == 0, "it is another text:\n%s\n%s", text, again);
    CHECK_OK(bhr_scene_save_file(context, path_of("scene.toml")));
    CHECK_OK(load(other, "disk = false"));
    CHECK_OK(bhr_scene_load_file(other, path_of("scene.toml")));
    free(again);
    again = saved(other);
    CHECK(strcmp(text, again) == 0, "a file holds another text");
    free(again);
    free(text);
    bhr_context_destroy(other);
}

static void mistakes(BhrContext *context) {
    Watch  watch;
    char   small[8] = "7777777";
    size_t size = 9;
    watch_begin(&watch, context);
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "text", bhr_scene_load(context, NULL, 0));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "size", bhr_scene_load(context, "", SIZE_MAX));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "UTF-8", bhr_scene_load(context, "a\xff", 2));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "line 1", bhr_scene_load(context, "[hole", 5));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "line 3, column 8",
                  load(context, "time = 9\n[hole]\nspin = 1.5\n[film]\nbloom = 0"));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "has no", load(context, "time = 9\nspin = 0.5"));
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "nowhere.png", load(context, "time = 9\n[sky]\nmap = 'nowhere.png'"));
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "nothing.toml", bhr_scene_load_file(context, path_of("nothing.toml")));
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "", bhr_scene_load_file(context, folder));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "path", bhr_scene_load_file(context, NULL));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "path", bhr_scene_load_file(context, ""));
    write_file(path_of("bad.toml"), "[disk]\nradius = 3\n");
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "bad.toml", bhr_scene_load_file(context, path_of("bad.toml")));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "size", bhr_scene_save(context, small, sizeof small, &size));
    CHECK(size == 0 && strcmp(small, "7777777") == 0, "a buffer that is too small was written to");
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "out_size", bhr_scene_save(context, small, sizeof small, NULL));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "path", bhr_scene_save_file(context, NULL));
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "", bhr_scene_save_file(context, path_of("no/folder.toml")));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "seconds", bhr_scene_at(context, 0.0 / 0.0 * 1.0));
    CHECK_REFUSED(&watch, BHR_ERROR_IO, "", bhr_set_sky_map_file(context, path_of("scene.toml")));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "path", bhr_set_sky_map_file(context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_scene_load(NULL, "", 0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_scene_load_file(NULL, "a"));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_scene_save(NULL, NULL, 0, &size));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_scene_save_file(NULL, "a"));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_scene_at(NULL, 0.0));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_scene_pictures(NULL, NULL, NULL, NULL, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_set_sky_map_file(NULL, "a"));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_STATE, "no sky map", bhr_save_sky_map(context, path_of("map.ktx2")));
    CHECK_REFUSED(&watch, BHR_ERROR_INVALID_ARGUMENT, "path", bhr_save_sky_map(context, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "context", bhr_save_sky_map(NULL, "a.ktx2"));
}

static void a_scene_that_was_not_loaded_does_not_move(BhrBackend backend) {
    BhrContext *context = check_context(backend);
    uint32_t    width = 7;
    double      rate = 7.0;
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "no scene was loaded", bhr_scene_at(context, 1.0));
    CHECK_FAILS(BHR_ERROR_INVALID_STATE, "no scene was loaded", bhr_scene_pictures(context, &width, NULL, NULL, &rate));
    CHECK(width == 0 && rate == 0.0, "a failed call left %u, %g", (unsigned)width, rate);
    bhr_context_destroy(context);
}

static void what_moves(BhrContext *context) {
    uint32_t width = 0, height = 0, count = 0;
    double   rate = 0.0, time = 0.0, mass, spin, axis[3];
    BhrFilm  film;
    CHECK_OK(load(context, "time = { keys = [[0, 0], [2, 60]] }\n[hole]\nspin = { keys = [[1, 0.25], [3, 0.75]] }\n"
                           "[render]\nwidth = 64\nheight = 32\nduration = 2.5\nframes_per_second = 30"));
    CHECK_OK(bhr_scene_pictures(context, &width, &height, &count, &rate));
    CHECK(width == 64 && height == 32 && count == 75 && rate == 30.0, "%u x %u, %u at %g", (unsigned)width,
          (unsigned)height, (unsigned)count, rate);
    CHECK_OK(bhr_scene_pictures(context, NULL, NULL, NULL, NULL));
    BHR_INIT(film);
    film.exposure_ev = 1.5;
    CHECK_OK(bhr_set_film(context, &film));
    CHECK_OK(bhr_set_spin(context, -0.7));
    CHECK_OK(bhr_scene_at(context, 2.0));
    CHECK_OK(bhr_get_time(context, &time));
    CHECK_OK(bhr_get_hole(context, &mass, &spin, axis));
    CHECK_OK(bhr_get_film(context, &film));
    CHECK(time == 60.0 && spin == 0.5, "time %g, spin %g", time, spin);
    CHECK(film.exposure_ev == 1.5, "what does not move was set back, to %g", film.exposure_ev);
    /* Values between keys may leave the range that the keys keep to. */
    CHECK_OK(load(context, "[film]\nbloom = { keys = [[0, 0], [1, 1], [2, 1], [3, 0]], curve = 'catmull_rom' }"));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "[film] at 1.5 s", bhr_scene_at(context, 1.5));
    CHECK_OK(bhr_scene_at(context, 2.0));
    CHECK_OK(load(context, ""));
    CHECK_OK(bhr_scene_pictures(context, &width, &height, &count, &rate));
    CHECK(width == 1920 && height == 1080 && count == 1 && rate == 24.0, "%u pictures", (unsigned)count);
}

/* The scene's map comes back from blocks with about the frame `before`; saved and read again, it gives that frame. */
static void maps_in_blocks(BhrContext *context, const unsigned char *before) {
    static unsigned char after[WATCH_WIDTH * WATCH_HEIGHT * 4], again[sizeof after];
    double               sum = 0.0;
    char                *text;
    BhrImage             loaded;
    BHR_INIT(loaded);
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, ".ktx2", bhr_save_sky_map(context, path_of("map.png")));
    CHECK_FAILS(BHR_ERROR_IO, "no/folder", bhr_save_sky_map(context, path_of("no/folder.ktx2")));
    CHECK_OK(bhr_save_sky_map(context, path_of("map.ktx2")));
    CHECK_OK(bhr_set_sky_map_file(context, path_of("map.ktx2")));
    a_picture(context, after);
    for (size_t i = 0; i < sizeof after; i++) {
        sum += abs(after[i] - before[i]);
    }
    /* Neighbouring texels differ strongly, and a block has one line of colours. */
    CHECK(sum / sizeof after < 20.0, "blocks differ from texels by %g of 255", sum / sizeof after);
    text = saved(context);
    CHECK(strstr(text, "/map.ktx2\"") != NULL, "the text does not name the blocks:\n%s", text);
    free(text);
    CHECK_OK(bhr_save_sky_map(context, path_of("again.ktx2")));
    CHECK_OK(bhr_set_sky_map_file(context, path_of("again.ktx2")));
    a_picture(context, again);
    CHECK(memcmp(after, again, sizeof after) == 0, "blocks that are saved again are others");
    CHECK_OK(bhr_image_load(path_of("map.ktx2"), &loaded));
    CHECK(loaded.width == 16 && loaded.height == 8 && loaded.format == BHR_FORMAT_RGBA32F, "%u x %u",
          (unsigned)loaded.width, (unsigned)loaded.height);
    CHECK_OK(bhr_image_release(&loaded));
    write_file(path_of("map.ktx2"), "\253KTX 20\273\r\n\032\n and no more");
    CHECK_FAILS(BHR_ERROR_IO, "map.ktx2", bhr_set_sky_map_file(context, path_of("map.ktx2")));
    a_picture(context, again);
    CHECK(memcmp(after, again, sizeof after) == 0, "a broken file took the map away");
}

static void maps(BhrContext *context) {
    static unsigned char pixels[8][16][4], before[WATCH_WIDTH * WATCH_HEIGHT * 4], after[sizeof before];
    BhrImage             map;
    char                *text;
    size_t               size;
    for (int i = 0; i < 8 * 16 * 4; i++) {
        (&pixels[0][0][0])[i] = (unsigned char)(37 * i);
    }
    BHR_INIT(map);
    map.width = 16, map.height = 8, map.pixels = pixels, map.byte_size = sizeof pixels;
    CHECK_OK(bhr_image_save(&map, path_of("map.png")));
    write_file(path_of("sky.toml"), "disk = false\n[sky]\nflags = ['map']\nmap = 'map.png'\n");
    CHECK_OK(bhr_scene_load_file(context, path_of("sky.toml")));
    a_picture(context, before);
    CHECK_OK(bhr_scene_save_file(context, path_of("again.toml")));
    CHECK_OK(load(context, ""));
    CHECK_OK(bhr_scene_load_file(context, path_of("again.toml")));
    a_picture(context, after);
    CHECK(memcmp(before, after, sizeof before) == 0, "another map than before");
    text = saved(context);
    CHECK(strstr(text, "/map.png\"") != NULL, "the text names no absolute path:\n%s", text);
    CHECK_OK(load(context, text));
    free(text);
    maps_in_blocks(context, before);
    CHECK_OK(bhr_set_sky_map_file(context, path_of("map.png")));
    /* A map from memory has no path. */
    CHECK_OK(bhr_set_sky_map(context, &map));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "memory", bhr_scene_save(context, NULL, 0, &size));
    CHECK_OK(bhr_set_sky_map_file(context, path_of("map.png")));
    CHECK_OK(bhr_scene_save(context, NULL, 0, &size));
    a_picture(context, after);
    CHECK(memcmp(before, after, sizeof before) == 0, "a map from memory is another than from its file");
    CHECK_OK(bhr_set_sky_map(context, NULL));
    CHECK_OK(bhr_scene_save(context, NULL, 0, &size));
}

typedef struct Loader {
    BhrContext *context;
    int         end; /* atomic */
    long        loads;
} Loader;

static const char *const TWO[] = {"[hole]\nspin = 0.9\n[sky]\nflags = []\n[film]\nexposure_ev = 1",
                                  "disk = false\n[sky]\nflags = ['grid']\n[camera]\norbit = { distance = 9 }"};

static void *load_in_turn(void *user) {
    Loader *loader = user;
    while (!__atomic_load_n(&loader->end, __ATOMIC_ACQUIRE)) {
        CHECK_OK(load(loader->context, TWO[loader->loads++ % 2]));
    }
    return NULL;
}

static void frames_show_one_of_two(BhrContext *context) {
    static unsigned char shown[2][WATCH_WIDTH * WATCH_HEIGHT * 4], frame[sizeof shown[0]];
    Loader               loader = {.context = context};
    pthread_t            thread;
    int                  seen[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        CHECK_OK(load(context, TWO[i]));
        a_picture(context, shown[i]);
    }
    CHECK(memcmp(shown[0], shown[1], sizeof shown[0]) != 0, "the two scenes look the same");
    CHECK(pthread_create(&thread, NULL, load_in_turn, &loader) == 0, "no thread");
    for (int i = 0; i < (check_runs_all() ? 2000 : 60); i++) {
        a_picture(context, frame);
        const int is_first = memcmp(frame, shown[0], sizeof frame) == 0;
        CHECK(is_first || memcmp(frame, shown[1], sizeof frame) == 0, "frame %d shows neither scene", i);
        seen[is_first]++;
    }
    __atomic_store_n(&loader.end, 1, __ATOMIC_RELEASE);
    pthread_join(thread, NULL);
    CHECK(loader.loads > 2, "the other thread has loaded %ld scenes", loader.loads);
    printf("of %d frames %d show the first scene, while %ld were loaded\n", seen[0] + seen[1], seen[1], loader.loads);
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    folder = argv[argc - 1];
    BhrContext *context = check_context(backend);
    round_trips(context, backend);
    mistakes(context);
    a_scene_that_was_not_loaded_does_not_move(backend);
    what_moves(context);
    maps(context);
    frames_show_one_of_two(context);
    bhr_context_destroy(context);
    return check_end();
}
