/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* film.c -- plays a scene file (docs/scenes.md) into numbered pictures or a video; scenes/fall.toml unless told other.
 * Two jobs are under way at a time, so that one frame is written while the next is rendered. */
#include "colour_bar.h"
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

typedef struct Film {
    const char *scene, *output, *video_file;
    uint32_t    frames, size[2];
    int32_t     backend;
    int         clock, help;
    double      rate; /* frames a second */
    BhrContext *context;
    BhrJob     *jobs[JOBS]; /* NULL: none is under way */
    BhrImage    images[JOBS];
    ColourBar   bars[JOBS]; /* without marks where a frame's colours are its light's */
    char        clocks[JOBS][96];
    Video       video;
} Film;

/* Reads the scene, and makes room for its pictures. 0, or an exit status after a message. */
static int prepare(Film *f) {
    char     path[MOST_PATH];
    uint32_t size[2], frames;
    if (f->scene == NULL && !scene_file_path(NULL, "fall", path)) {
        return EXIT_FAILURE;
    }
    BhrStatus status = create_context_on(f->backend, &f->context);
    if (status >= 0) {
        status = bhr_scene_load_file(f->context, f->scene != NULL ? f->scene : path);
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
    int held = 1;
    for (int i = 0; held && i < JOBS; i++) {
        held = picture_allocate(&f->images[i], BHR_FORMAT_RGBA8_SRGB, f->size[0], f->size[1]);
    }
    return held ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* Begins a frame, which has a job and a picture of its own. 1, or 0 after a message. */
static int begin(Film *f, uint32_t frame) {
    BhrHoleInfo info;
    BHR_INIT(info);
    const double seconds = frame / f->rate;
    BhrStatus    status = bhr_scene_at(f->context, seconds);
    if (status >= 0) {
        status = bhr_hole_info(f->context, &info);
    }
    if (status >= 0) { /* M is half of the ergosphere's radius */
        snprintf(f->clocks[frame % JOBS], sizeof f->clocks[0], "t = %.2f s   r = %.2f M%s", seconds,
                 2.0 * info.camera_radius / info.ergosphere_equatorial_radius,
                 info.camera_radius < info.horizon_radius ? "   inside the horizon" : "");
        status = colour_bar_of_frames(f->context, &f->bars[frame % JOBS]);
    }
    if (status >= 0) {
        status = bhr_render_image_async(f->context, &f->images[frame % JOBS], &f->jobs[frame % JOBS]);
    }
    return status >= 0 || !report_failure("begin a frame", status);
}

/* Waits for a frame, and puts it where the film goes. 1, or 0 after a message. */
static int finish(Film *f, uint32_t frame) {
    BhrImage *image = &f->images[frame % JOBS];
    BhrStatus status = bhr_job_wait(f->jobs[frame % JOBS], UINT64_MAX, NULL);
    bhr_job_destroy(f->jobs[frame % JOBS]);
    f->jobs[frame % JOBS] = NULL;
    if (status < 0) {
        return !report_failure("render a frame", status);
    }
    const uint32_t foot = colour_bar_put(image, &f->bars[frame % JOBS]);
    if (f->clock) {
        const uint32_t scale = image->width < 960 ? 1 : image->width / 480; /* the text is 300 wide at 1 */
        picture_write(image, 4 * scale, image->height - foot - CELL_HEIGHT * scale, scale, f->clocks[frame % JOBS]);
    }
    char name[24];
    snprintf(name, sizeof name, "frame-%05u.png", (unsigned)frame);
    return f->video_file != NULL ? video_add(&f->video, image) : picture_save_into(image, f->output, name);
}

/* 1, or 0 after a message. */
static int make(Film *f) {
    int made = 1;
    if (f->video_file != NULL && !video_open(&f->video, f->video_file, f->size[0], f->size[1], f->rate)) {
        return 0;
    }
    if (f->video_file == NULL && !make_folder(f->output) && errno != EEXIST) {
        fprintf(stderr, "cannot make the folder %s: %s\n", f->output, strerror(errno));
        return 0;
    }
    Progress progress = progress_begin(is_terminal(stderr));
    for (uint32_t i = 0; made && i < f->frames + JOBS; i++) { /* at last there are those under way */
        made = (i < JOBS || i - JOBS >= f->frames || finish(f, i - JOBS)) && (i >= f->frames || begin(f, i));
        progress_draw(&progress, (double)i / (f->frames + JOBS));
    }
    progress_clear(&progress);
    made = (f->video_file == NULL || video_close(&f->video)) && made;
    if (made) {
        printf("%u frames: %s\n", f->frames, f->video_file != NULL ? f->video_file : f->output);
    }
    return made;
}

int main(int argc, char **argv) {
    Film         f = {.output = "film-out", .frames = AS_SCENE, .size = {AS_SCENE, AS_SCENE}}; /* BACKEND_AUTO is 0 */
    const Option options[] = {
        {"--scene", OPTION_TEXT, &f.scene, "FILE", "to play, such as scenes/fall-kerr.toml; else fall.toml, a fall",
         NULL, NULL},
        {"--output", OPTION_TEXT, &f.output, "FOLDER", "for the pictures; made if need be", NULL, NULL},
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
        result = prepare(&f);
        result = result == 0 && !make(&f) ? EXIT_FAILURE : result;
        for (int i = 0; i < JOBS; i++) { /* jobs first: until then the pixels are theirs */
            bhr_job_destroy(f.jobs[i]);
            free(f.images[i].pixels);
        }
        bhr_context_destroy(f.context);
    }
    return end_output(result);
}
