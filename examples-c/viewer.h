/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer.h -- what the viewer's parts share: its one struct, which GLFW's callbacks find through the window's user
 * pointer. viewer.c renders and presents, viewer_input.c turns keys and mouse into wishes, viewer_news.c tells. */
#ifndef EXAMPLES_VIEWER_H
#define EXAMPLES_VIEWER_H

#include "glfw_window.h"
#include "scene.h"
#include "viewer_bar.h"
#include "viewer_camera.h"
#include "viewer_frame.h"
#include "viewer_keys.h"
#include "viewer_pictures.h"
#include "viewer_quality.h"

#define SAID 96
#define MOST_LATE 8
#define SAVED_SCENE "viewer-scene.toml"
#define FIRST_PACE 3.0 /* M per second: the disk's inner edge turns in half a minute */

typedef struct Mouse {
    double x, y;    /* window coordinates, not pixels */
    int    orbits;  /* left button: the camera goes about the hole */
    int    looks;   /* right button: the view turns */
} Mouse;

typedef struct Viewer {
    GLFWwindow *window;
    BhrContext *context;
    BhrContext *tester; /* renders nothing: changes are tried on it, and it answers while a frame is rendered; has the
                           map and the LUT of the other one, too */
    BhrAdapterInfo adapter; /* that renders */
    BhrSurface *surface;
    BhrPresentMode present;
    uint32_t    size[2]; /* of the framebuffer, in pixels: larger than the window on a high-density display */

    Scene    first;      /* for going back to the beginning */
    Scene    scene;      /* what the next frame shows */
    Pilot    pilot;
    Frame    frame;
    Scene    frame_scene; /* that the frame in work, or the last one, was begun for */
    int      frame_moves; /* whether it is one of a moving picture */
    int      resized;     /* the surface does not know yet */
    int      late[MOST_LATE], late_count; /* keys that wait for the frame's end, by their place in the table */
    Scene    good;       /* what the last presented frame showed: to go back to when a frame fails */
    double   pace;       /* M of the camera's proper time that go by in a second; < 0: backwards */
    int      paused;
    Governor governor;
    Recorder recorder;
    PictureJob picture;
    TextWindow keys;     /* shows what keys do */
    BarWindow  bar;      /* shows what false colours mean */
    int        quitting; /* the viewer ends when picture and film are saved */

    Mouse   mouse;
    int     windowed[4]; /* position and size to come back to from the full screen */
    int32_t tried_view, tried_projection, preset, matter; /* the cycling keys pass over what is refused */
    BhrPresetOptions preset_options;  /* the matter that presets have */
    BhrPresetMatter  preset_matter;   /* that this one has */
    const char *scene_path; /* what the key loads: --scene, or the file that was saved last */
    char    said[SAID];  /* by the last key; printed when bhr has accepted the change */

    double   now;           /* wall_seconds() of this turn of the loop */
    double   changed_at;    /* when the picture was last changed by hand */
    double   presented_at;  /* when the last frame was done; 0: there was a pause since */
    double   titled_at;
    char     news[FOLDER_NAME + PICTURE_NAME + 96]; /* of pictures and films, in the title */
    double   news_until;
    unsigned frames_untitled; /* presented since the title was written */
    uint64_t frames;          /* presented */
    unsigned failures;        /* frames that failed since the last good one */
    int      skipped;         /* the last frame was: the window cannot be seen */
    int      still;           /* nothing moves any more: --hold */
    int      dirty;           /* the window needs a frame even if the picture rests */
    int      broken;          /* it cannot go on; the reason was said */
    uint64_t most_frames;     /* 0: no limit */
    double   fixed_step;      /* seconds of every step; 0: the wall clock's */
} Viewer;

/* Shows the scene of a file, and begins there: what is asked for by keys begins anew. Errors: as the library's; then it
 * shows what it did. */
BhrStatus viewer_load(Viewer *viewer, const char *path);

#endif
