/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* film.c -- plays a scene file (docs/scenes.md) into numbered pictures or a video; scenes/fall.toml unless told other.
 * Two jobs are under way at a time, so that one frame is written while the next is rendered. Ctrl-C leaves whole
 * pictures, which --continue goes on with, or a video that plays. */
#include "colour_bar.h"
#include "film_folder.h"
#include "options.h"
#include "picture.h"
#include "scene_files.h"
#include "video.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define JOBS 2
#define MOST_FRAMES 99999u /* what five digits number */
#define AS_SCENE UINT32_MAX
#define POLL_NS 50000000u /* how often a signal is looked for */

static const Choice FORMATS[] = {{"png", BHR_FORMAT_RGBA8_SRGB}, {"exr", BHR_FORMAT_RGBA16F}, {NULL, 0}};

/* A frame in the making. */
typedef struct Slot {
    BhrJob   *job; /* NULL: none is under way */
    uint32_t  frame;
    BhrImage  image;
    ColourBar bar; /* without marks where a frame's colours are its light's */
    char      clock[96];
} Slot;

typedef struct Film {
    const char *scene, *output, *video_file;
    uint32_t    frames, size[2];
    int32_t     backend, format;
    int         clock, go_on, help;
    double      rate; /* frames a second */
    char        fall[MOST_PATH]; /* the scene where none is named */
    BhrContext *context;
    Slot        slots[JOBS];
    Video       video;
    uint32_t    before, made; /* frames that were there, and that this program added */
    int         is_open;      /* the place that it goes to */
    Progress    progress;
} Film;

/* ---- preparations ---- */

/* 0, or EXIT_USAGE after a message. */
static int check_options(const Film *f) {
    const char *wrong = NULL;
    if (f->video_file != NULL && f->go_on) {
        wrong = "--continue goes on with pictures; with videos `bhr render SCENE --out film.mp4` does (docs/farms.md)";
    } else if (f->video_file != NULL && f->format != BHR_FORMAT_RGBA8_SRGB) {
        wrong = "--format is for pictures; frames of a --video have 8 bits";
    } else if (f->clock && f->format != BHR_FORMAT_RGBA8_SRGB) {
        wrong = "--clock is for pictures of 8 bits; those of --format exr hold light alone";
    }
    if (wrong != NULL) {
        fprintf(stderr, "film: %s\n", wrong);
    }
    return wrong != NULL ? EXIT_USAGE : 0;
}

/* Whether the pictures can hold what every frame shows. 0, or an exit status after a message. */
static int check_views(const Film *f) {
    for (uint32_t i = 0; f->format != BHR_FORMAT_RGBA8_SRGB && i < f->frames; i++) {
        BhrView   view = BHR_VIEW_LIGHT;
        BhrStatus status = bhr_scene_at(f->context, i / f->rate);
        status = status >= 0 ? bhr_get_view(f->context, &view) : status;
        if (status < 0) {
            return report_failure("play the scene", status);
        }
        if (view != BHR_VIEW_LIGHT) {
            fprintf(stderr,
                    "film: the scene's view is %s at %.6g seconds, but --format exr holds light alone. --format png\n"
                    "shows the view in false colour; view = \"light\" in the scene makes it light\n",
                    choice_name(VIEWS, view), i / f->rate);
            return EXIT_USAGE;
        }
    }
    return EXIT_SUCCESS;
}

/* Reads the scene, and makes room for its pictures. 0, or an exit status after a message. */
static int prepare(Film *f) {
    uint32_t size[2], frames;
    if (f->scene == NULL) {
        if (!scene_file_path(NULL, "fall", f->fall)) {
            return EXIT_FAILURE;
        }
        f->scene = f->fall;
    }
    BhrStatus status = create_context_on(f->backend, &f->context);
    if (status >= 0) {
        status = bhr_scene_load_file(f->context, f->scene);
    }
    if (status >= 0) {
        status = bhr_scene_pictures(f->context, &size[0], &size[1], &frames, &f->rate);
    }
    if (status < 0) {
        return report_failure("play the scene", status);
    }
    memcpy(f->size, f->size[0] == AS_SCENE ? size : f->size, sizeof size);
    f->frames = f->frames == AS_SCENE ? frames : f->frames;
    f->rate = f->frames == frames ? f->rate : f->rate * f->frames / frames; /* of any number, over the same time */
    if (f->frames < 1 || f->frames > MOST_FRAMES) {
        fprintf(stderr, "film: %u frames are asked for; it must be 1 to %u\n", f->frames, MOST_FRAMES);
        return EXIT_USAGE;
    }
    if (f->video_file != NULL && (f->size[0] % 2 != 0 || f->size[1] % 2 != 0)) {
        fprintf(stderr, "film: the size is %ux%u; a video's must be even\n", f->size[0], f->size[1]);
        return EXIT_USAGE;
    }
    const int result = check_views(f);
    if (result != EXIT_SUCCESS) {
        return result;
    }
    int held = 1;
    for (int i = 0; held && i < JOBS; i++) {
        held = picture_allocate(&f->slots[i].image, f->format, f->size[0], f->size[1]);
    }
    return held ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* The text of film.txt: all that decides what the pictures show, but for the adapter and what the files hold that the
 * scene names. The scene is the file's own text, which is the same wherever the program is started. To be given back by
 * free(); NULL after a message. */
static char *describe(const Film *f) {
    char  head[512];
    char *scene = read_text(f->scene);
    if (scene == NULL) {
        fprintf(stderr, "film: cannot read %s: %s\n", f->scene, strerror(errno));
        return NULL;
    }
    snprintf(head, sizeof head,
             FILM_FOLDER_TITLE "bhr = %s\nsize = %ux%u\nframes = %u\nframes a second = %.17g\n"
                               "format = %s\nclock = %s\n\n# Its scene file:\n",
             bhr_version_string(), f->size[0], f->size[1], f->frames, f->rate, choice_name(FORMATS, f->format),
             f->clock ? "yes" : "no");
    const size_t size = strlen(head) + strlen(scene) + 1;
    char        *text = malloc(size);
    if (text != NULL) {
        snprintf(text, size, "%s%s", head, scene);
    } else {
        fprintf(stderr, "film: no memory for film.txt\n");
    }
    free(scene);
    return text;
}

/* The frames that are in the folder. */
static uint32_t count_saved(const Film *f) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < f->frames; i++) {
        count += film_folder_has(f->output, i, choice_name(FORMATS, f->format)) ? 1u : 0u;
    }
    return count;
}

/* Opens the place that the film goes to. 1, or 0 after a message. */
static int open_output(Film *f) {
    if (f->video_file != NULL) {
        f->is_open = video_open(&f->video, f->video_file, f->size[0], f->size[1], f->rate);
        return f->is_open;
    }
    char *film = describe(f);
    f->is_open = film != NULL && film_folder_open(f->output, film, f->go_on);
    free(film);
    f->before = f->is_open && f->go_on ? count_saved(f) : 0;
    return f->is_open;
}

/* ---- frames ---- */

/* Auto exposure that adapts slowly needs every frame before: a film with gaps would flicker. */
static BhrStatus check_adaptation(const Film *f, int *goes_on) {
    BhrFilm   film;
    BhrStatus status = bhr_film_init(&film, sizeof film);
    status = status >= 0 ? bhr_get_film(f->context, &film) : status;
    *goes_on = status < 0 || f->before == 0 || film.auto_exposure <= 0.0 || film.auto_adaptation >= 1.0;
    return status;
}

/* Begins a frame. 1, or 0 after a message. */
static int begin(Film *f, Slot *slot, uint32_t frame) {
    BhrHoleInfo info;
    BHR_INIT(info);
    int          goes_on = 1;
    const double seconds = frame / f->rate;
    BhrStatus    status = bhr_scene_at(f->context, seconds);
    if (status >= 0) {
        status = check_adaptation(f, &goes_on);
    }
    if (!goes_on) {
        fprintf(stderr,
                "film: --continue cannot go on where auto_adaptation is below 1: a picture's exposure then depends on\n"
                "those before it; without --continue all are made anew\n");
        return 0;
    }
    if (status >= 0) {
        status = bhr_hole_info(f->context, &info);
    }
    if (status >= 0) { /* M is half of the ergosphere's radius */
        snprintf(slot->clock, sizeof slot->clock, "t = %.2f s   r = %.2f M%s", seconds,
                 2.0 * info.camera_radius / info.ergosphere_equatorial_radius,
                 info.camera_radius < info.horizon_radius ? "   inside the horizon" : "");
        status = colour_bar_of_frames(f->context, &slot->bar);
    }
    if (status >= 0) {
        slot->frame = frame;
        status = bhr_render_image_async(f->context, &slot->image, &slot->job);
    }
    return status >= 0 || !report_failure("begin a frame", status);
}

/* Writes the bar and the clock into a frame of 8 bits. Frames of --format exr hold light alone, and stay as they
 * are. */
static void write_words(const Film *f, Slot *slot) {
    BhrImage *image = &slot->image;
    if (f->format != BHR_FORMAT_RGBA8_SRGB) {
        return;
    }
    const uint32_t foot = colour_bar_put(image, &slot->bar);
    if (f->clock) {
        const uint32_t scale = image->width < 960 ? 1 : image->width / 480; /* the text is 300 wide at 1 */
        picture_write(image, 4 * scale, image->height - foot - CELL_HEIGHT * scale, scale, slot->clock);
    }
}

/* Waits for a frame, and puts it where the film goes. 1; 0 after a signal, or after a message. */
static int finish(Film *f, Slot *slot) {
    BhrStatus status;
    double    fraction = 0.0;
    while ((status = bhr_job_wait(slot->job, POLL_NS, &fraction)) == BHR_NOT_READY) {
        if (noted_signal() != 0) {
            return 0;
        }
        progress_draw_frames(&f->progress, f->made + fraction, f->before, f->frames);
    }
    if (status < 0) {
        return !report_failure("render a frame", status);
    }
    bhr_job_destroy(slot->job);
    slot->job = NULL;
    write_words(f, slot);
    char name[FRAME_NAME]; /* the picture is there whole or not at all: bhr_image_save sees to that */
    film_folder_name(name, slot->frame, choice_name(FORMATS, f->format));
    if (f->video_file != NULL ? !video_add(&f->video, &slot->image)
                              : !picture_save_into(&slot->image, f->output, name)) {
        return 0;
    }
    f->made++;
    progress_draw_frames(&f->progress, f->made, f->before, f->frames);
    return 1;
}

/* The first frame from this one on that is not there. */
static uint32_t next_frame(const Film *f, uint32_t frame) {
    while (f->before > 0 && frame < f->frames && film_folder_has(f->output, frame, choice_name(FORMATS, f->format))) {
        frame++;
    }
    return frame;
}

/* Makes all frames. The output is opened only once the first frame has begun, so that a scene that cannot be played
 * removes nothing. 1; 0 after a signal while frames were left, or after a message. */
static int make_frames(Film *f) {
    uint32_t next = next_frame(f, 0), idle = 0;
    for (uint32_t i = 0; idle < JOBS; i = (i + 1) % JOBS) {
        Slot *slot = &f->slots[i];
        if (slot->job != NULL && !finish(f, slot)) {
            return 0;
        }
        if (next == f->frames) { /* nothing is left to begin: those under way are waited for */
            idle++;
            continue;
        }
        if (noted_signal() != 0 || !begin(f, slot, next) || (!f->is_open && !open_output(f))) {
            return 0;
        }
        next = next_frame(f, next + 1);
    }
    return 1;
}

/* Cancels what is under way. The jobs may write to the pixels until then. */
static void drop_jobs(Film *f) {
    for (int i = 0; i < JOBS; i++) {
        bhr_job_destroy(f->slots[i].job);
        f->slots[i].job = NULL;
    }
}

/* ---- the film ---- */

static void say_done(const Film *f, double seconds) {
    printf("%u frames", f->frames);
    if (f->before > 0) {
        printf(", %u of them new", f->made);
    }
    printf(": %s", f->video_file != NULL ? f->video_file : f->output);
    if (f->made > 0 && seconds > 0.0) {
        printf(", %.3g a second", f->made / seconds);
    }
    printf("\n");
}

static void say_stopped(const Film *f) {
    if (f->video_file != NULL) {
        fprintf(stderr,
                "film: stopped; %s has %u of %u frames. --continue goes on with pictures, without --video; with\n"
                "videos `bhr render SCENE --out film.mp4` does (docs/farms.md)\n",
                f->video_file, f->made, f->frames);
    } else {
        fprintf(stderr, "film: stopped; %s has %u of %u frames, and the same command with --continue makes the rest\n",
                f->output, count_saved(f), f->frames);
    }
}

/* An exit status; it tells the signal that ended it, as shells do. */
static int make(Film *f) {
    note_signals();
    if (f->go_on && !open_output(f)) { /* which removes nothing, and tells which frames are there */
        return EXIT_FAILURE;
    }
    f->progress = progress_begin(is_terminal(stderr));
    int          made = make_frames(f);
    const double seconds = wall_seconds() - f->progress.begin;
    const int    signal = made ? 0 : noted_signal();
    progress_clear(&f->progress);
    drop_jobs(f);
    const int closed = f->video_file == NULL || !f->is_open || video_close(&f->video);
    if (signal != 0) {
        if (f->is_open && closed) {
            say_stopped(f);
        }
        return 128 + signal;
    }
    if (made && closed) {
        say_done(f, seconds);
    }
    return made && closed ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv) {
    Film f = {.output = "film-out", .frames = AS_SCENE, .size = {AS_SCENE, AS_SCENE}, .format = BHR_FORMAT_RGBA8_SRGB};
    const Option options[] = {
        {"--scene", OPTION_TEXT, &f.scene, "FILE", "to play, such as scenes/fall-kerr.toml; else fall.toml, a fall",
         NULL, NULL},
        {"--output", OPTION_TEXT, &f.output, "FOLDER",
         "for the pictures; made if need be; pictures of an earlier film in it are removed", NULL, NULL},
        {"--continue", OPTION_FLAG, &f.go_on, NULL, "makes only the pictures that are missing in the folder", NULL,
         NULL},
        {"--format", OPTION_CHOICE, &f.format, NULL,
         "of the pictures: png as seen, in 8 bits; exr linear light in 16-bit floats, without colour bars", FORMATS,
         NULL},
        {"--video", OPTION_TEXT, &f.video_file, "FILE", "a video instead, by ffmpeg; overwritten", NULL, NULL},
        {"--frames", OPTION_UINT, &f.frames, "N", "over the same time, in place of the scene's", NULL, "1 to 99999"},
        {"--size", OPTION_SIZE, f.size, "WxH", "pixels, in place of the scene's", NULL, NULL},
        {"--clock", OPTION_FLAG, &f.clock, NULL, "writes the time and the radius into the picture", NULL, NULL},
        {"--backend", OPTION_CHOICE, &f.backend, NULL, "what traces the light", BACKENDS, NULL},
        {"--help", OPTION_FLAG, &f.help, NULL, "this text", NULL, NULL},
    };
    int result = options_parse(options, COUNT_OF(options), argc, argv);
    if (result == 0 && f.help) {
        printf("Usage: film [options]\nPlays a scene file, into numbered pictures or into a video.\n\n");
        options_print(stdout, options, COUNT_OF(options));
    } else if (result == 0) {
        result = check_options(&f);
        result = result == 0 ? prepare(&f) : result;
        result = result == 0 ? make(&f) : result;
        drop_jobs(&f);
        for (int i = 0; i < JOBS; i++) {
            free(f.slots[i].image.pixels);
        }
        bhr_context_destroy(f.context);
    }
    return end_output(result);
}
