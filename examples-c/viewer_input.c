/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_input.c -- see viewer_input.h. */
#include "viewer_input.h"

#include "matter.h"
#include "viewer_news.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#define DRAG_PER_HEIGHT PI  /* radians about the hole when the mouse is dragged over the window's height */
#define ZOOM_PER_NOTCH 0.18 /* of ln(r - r_horizon) */
#define LARGEST_SPIN 0.998  /* a disk's own light keeps a hole from turning faster (Thorne 1974) */
#define FASTEST_PACE 1e4    /* M per second */

/* ---- what keys do: each changes the scene or a wish and says so; `act` asks bhr whether it agrees ---- */

#define SAY(viewer, ...) snprintf((viewer)->said, SAID, __VA_ARGS__)

static double clamp(double x, double least, double most) { return fmax(least, fmin(most, x)); }

static void change_mass(Viewer *v, double factor) {
    v->scene.mass *= factor;
    v->pilot.steered = 1;
    SAY(v, "mass %.4g", v->scene.mass);
}

static void change_spin(Viewer *v, double by) {
    double spin = v->scene.spin + by;
    v->scene.spin = clamp(fabs(spin) < 1e-9 ? 0.0 : spin, -LARGEST_SPIN, LARGEST_SPIN);
    v->pilot.steered = 1;
    SAY(v, "spin %.3f", v->scene.spin);
}

static void toggle_disk(Viewer *v, double unused) {
    (void)unused;
    v->scene.has_disk = !v->scene.has_disk;
    SAY(v, "disk %s", v->scene.has_disk ? "on" : "off");
}

static void toggle_retrograde(Viewer *v, double unused) {
    (void)unused;
    v->scene.disk.flags ^= BHR_DISK_RETROGRADE;
    SAY(v, "disk turns %s", v->scene.disk.flags & BHR_DISK_RETROGRADE ? "retrograde" : "prograde");
}

static void change_opacity(Viewer *v, double by) {
    v->scene.disk.opacity = clamp(v->scene.disk.opacity + by, 0.0, 1.0);
    SAY(v, "opacity of the disk %.2f", v->scene.disk.opacity);
}

static void change_turbulence(Viewer *v, double by) {
    v->scene.disk.turbulence = clamp(v->scene.disk.turbulence + by, 0.0, 1.0);
    SAY(v, "turbulence of the disk %.2f", v->scene.disk.turbulence);
}

/* Goes on to the next kind of volume, which takes the thin disk's place but for the jet, which comes from it; after the
 * last one to the matter that the viewer began with. */
static void cycle_matter(Viewer *v, double unused) {
    (void)unused;
    v->matter = v->matter < 0 || VOLUME_KINDS[v->matter].name == NULL ? 0 : v->matter + 1;
    const Choice *kind = &VOLUME_KINDS[v->matter];
    if (kind->name == NULL) {
        memcpy(v->scene.volumes, v->first.volumes, sizeof v->scene.volumes);
        v->scene.volume_count = v->first.volume_count;
        v->scene.has_disk = v->first.has_disk;
        SAY(v, "matter as in the beginning");
        return;
    }
    BhrStatus status = volume_begin(&v->scene.volumes[0], kind->value);
    if (status < 0) {
        report_failure("begin a volume", status);
        return;
    }
    v->scene.volume_count = 1;
    v->scene.has_disk = kind->value == BHR_VOLUME_JET;
    SAY(v, "matter with depth: %s", kind->name);
}

static void toggle_hot_spot(Viewer *v, double unused) {
    (void)unused;
    if (v->scene.hot_spot_count > 0) {
        v->scene.hot_spot_count = 0;
    } else if (v->first.hot_spot_count > 0) {
        memcpy(v->scene.hot_spots, v->first.hot_spots, sizeof v->scene.hot_spots);
        v->scene.hot_spot_count = v->first.hot_spot_count;
    } else {
        BhrStatus status = bhr_hot_spot_init(&v->scene.hot_spots[0], sizeof v->scene.hot_spots[0]);
        if (status < 0) {
            report_failure("begin a hot spot", status);
            return;
        }
        v->scene.hot_spot_count = 1;
    }
    SAY(v, "hot spot %s", v->scene.hot_spot_count > 0 ? "on" : "off");
}

static void toggle_effect(Viewer *v, double bit) {
    static const Choice names[] = {{"Doppler shift", BHR_EFFECT_DOPPLER_SHIFT},
                                   {"gravitational redshift", BHR_EFFECT_GRAVITY_SHIFT},
                                   {"beaming", BHR_EFFECT_BEAMING},
                                   {"light delay", BHR_EFFECT_LIGHT_DELAY},
                                   {NULL, 0}};
    uint32_t effect = (uint32_t)bit;
    v->scene.effects ^= effect;
    SAY(v, "%s %s", choice_name(names, (int32_t)effect), v->scene.effects & effect ? "on" : "off");
}

/* By quarters, from what physics says down to nothing, and back to it. */
static void grade_effect(Viewer *v, double which) {
    static const char *const names[] = {"Doppler shift", "gravitational redshift", "beaming"};
    double                  *strength = &v->scene.effect_strengths[(int)which];
    *strength = *strength > 0.0 ? fmax(ceil(*strength * 4.0 - 1.0) / 4.0, 0.0) : 1.0;
    SAY(v, "%s at %.0f %%", names[(int)which], 100.0 * *strength);
}

static void toggle_sky(Viewer *v, double unused) {
    (void)unused;
    v->scene.has_sky = !v->scene.has_sky;
    SAY(v, "stars %s", v->scene.has_sky ? "on" : "off");
}

static void look_at_hole(Viewer *v) {
    v->pilot.centring = 1;
    v->pilot.looked_away = 0;
}

static void cycle_motion(Viewer *v, double unused) {
    BhrHoleInfo info;
    BHR_INIT(info);
    (void)unused;
    if (bhr_hole_info(v->tester, &info) >= 0 && info.camera_radius <= info.horizon_radius) {
        SAY(v, "inside the horizon every observer falls");
        return;
    }
    v->pilot.motion = v->pilot.motion == BHR_MOTION_STATIC      ? BHR_MOTION_FREE_FALL
                      : v->pilot.motion == BHR_MOTION_FREE_FALL ? BHR_MOTION_ORBIT
                                                                : BHR_MOTION_STATIC;
    v->pilot.flying = 0;
    look_at_hole(v);
    v->pilot.steered = 1;
    SAY(v, "motion of the camera: %s", choice_name(MOTIONS, v->pilot.motion));
}

static void toggle_flight(Viewer *v, double unused) {
    (void)unused;
    v->pilot.flying = !v->pilot.flying;
    v->pilot.centring = !v->pilot.flying;
    SAY(v, v->pilot.flying ? "free flight: W A S D Q E, Shift for speed, right drag to look" : "about the hole again");
    BhrHoleInfo info;
    BHR_INIT(info);
    if (v->pilot.flying && bhr_hole_info(v->tester, &info) >= 0 && info.camera_radius > info.horizon_radius) {
        v->pilot.motion = BHR_MOTION_STATIC;
    }
}

static void thrust_right(Viewer *v, double by) { v->pilot.thrust[0] += by; }
static void thrust_up(Viewer *v, double by) { v->pilot.thrust[1] += by; }
static void thrust_forward(Viewer *v, double by) { v->pilot.thrust[2] += by; }
static void thrust_more(Viewer *v, double by) { v->pilot.boost += by; }

static void centre_hole(Viewer *v, double unused) {
    (void)unused;
    look_at_hole(v);
}

static void cycle_view(Viewer *v, double unused) {
    (void)unused;
    v->tried_view = (v->tried_view + 1) % (BHR_VIEW_INTENSITY + 1);
    v->scene.view = v->tried_view;
    SAY(v, "view: %s", choice_name(VIEWS, v->scene.view));
}

static void cycle_projection(Viewer *v, double unused) {
    (void)unused;
    v->tried_projection = (v->tried_projection + 1) % (BHR_PROJECTION_CUBE + 1);
    v->scene.camera.projection = v->tried_projection;
    SAY(v, "projection: %s", choice_name(PROJECTIONS, v->scene.camera.projection));
}

static void cycle_method(Viewer *v, double unused) {
    (void)unused;
    v->scene.quality.method = (v->scene.quality.method + 1) % (BHR_METHOD_ADAPTIVE + 1);
    SAY(v, "method: %s", choice_name(METHODS, v->scene.quality.method));
}

static void change_samples(Viewer *v, double factor) {
    v->scene.quality.samples_per_pixel = (uint32_t)clamp(v->scene.quality.samples_per_pixel * factor, 1.0, 256.0);
    SAY(v, "%u samples a pixel%s", (unsigned)v->scene.quality.samples_per_pixel,
        v->governor.enabled ? ", at rest; 1 while moving" : "");
}

static void toggle_adaptive(Viewer *v, double unused) {
    (void)unused;
    v->governor.enabled = !v->governor.enabled;
    SAY(v, v->governor.enabled ? "quality follows the display's rate" : "quality as it is set, whatever the rate");
}

/* The next look: disk, stars, film and effects; hole and camera stay. */
static void cycle_preset(Viewer *v, double unused) {
    (void)unused;
    v->preset = (v->preset + 1) % (BHR_PRESET_TEACHING + 1);
    BhrStatus status =
        scene_set_preset_with(&v->scene, v->context, v->preset, &v->preset_options, &v->preset_matter);
    if (status < 0) {
        report_failure("set the preset", status);
        return;
    }
    governor_take_resolution(&v->governor, v->context);
    SAY(v, "preset: %s, %s matter", choice_name(PRESETS, v->preset), choice_name(PRESET_MATTERS, v->preset_matter));
}

static void cycle_tone_map(Viewer *v, double unused) {
    (void)unused;
    v->scene.film.tone_map = (v->scene.film.tone_map + 1) % (BHR_TONE_MAP_FILMIC + 1);
    SAY(v, "tone map: %s", choice_name(TONE_MAPS, v->scene.film.tone_map));
}

static void change_exposure(Viewer *v, double by) {
    v->scene.film.exposure_ev += by;
    SAY(v, "exposure %+.2f EV", v->scene.film.exposure_ev);
}

static void change_fov(Viewer *v, double factor) {
    v->scene.camera.fov_y *= factor;
    SAY(v, "field of view %.1f degrees", v->scene.camera.fov_y * 180.0 / PI);
}

static void toggle_pause(Viewer *v, double unused) {
    (void)unused;
    v->paused = !v->paused;
    SAY(v, v->paused ? "time stands still" : "time goes on");
}

static void change_pace(Viewer *v, double factor) {
    v->pace = clamp(v->pace * factor, -FASTEST_PACE, FASTEST_PACE);
    SAY(v, "%.4g M of the camera's time a second", v->pace);
}

static void reset(Viewer *v, double unused) {
    (void)unused;
    v->scene = v->first;
    pilot_stop(&v->pilot, BHR_MOTION_STATIC);
    v->pace = FIRST_PACE;
    v->paused = 0;
    v->tried_view = v->scene.view;
    v->tried_projection = v->scene.camera.projection;
    v->preset = NO_PRESET;
    v->matter = -1;
    SAY(v, "back to the beginning");
}

/* Over the one that was saved before. */
static void save_scene(Viewer *v, double unused) {
    (void)unused;
    BhrStatus status = scene_apply(&v->scene, v->tester);
    if (status >= 0) {
        status = bhr_scene_save_file(v->tester, SAVED_SCENE);
    }
    if (status < 0) {
        report_failure("save the scene", status);
        return;
    }
    v->scene_path = SAVED_SCENE;
    SAY(v, "scene saved: %s", SAVED_SCENE);
}

static void load_scene(Viewer *v, double unused) {
    (void)unused;
    uint32_t  frames = 1;
    BhrStatus status = viewer_load(v, v->scene_path);
    if (status >= 0) {
        status = bhr_scene_pictures(v->tester, NULL, NULL, &frames, NULL);
    }
    if (status < 0) {
        report_failure("load the scene", status);
        return;
    }
    SAY(v, "scene loaded: %.60s%s", v->scene_path, frames > 1 ? ", as a film begins" : "");
}

static void save_picture(Viewer *v, double unused) {
    (void)unused;
    if (v->picture.job != NULL) {
        picture_cancel(&v->picture);
        v->news_until = 0.0;
    } else if (v->size[0] != 0 && v->size[1] != 0) {
        Scene scene = v->scene;
        governor_choose_for_picture(&v->governor, &scene.quality);
        scene.film.auto_adaptation = 1.0; /* the picture's context has shown nothing before */
        picture_begin_numbered(&v->picture, &v->adapter, v->tester, &scene, v->size[0], v->size[1]);
    }
}

/* Begins, ends the taking, and breaks off what is still being rendered. */
static void toggle_recording(Viewer *v, double unused) {
    (void)unused;
    if (v->recorder.taking) {
        recorder_stop(&v->recorder);
        SAY(v, "recording ends: %u frames; R again breaks off what is not rendered yet", v->recorder.taken);
    } else if (v->recorder.context != NULL) {
        recorder_cancel(&v->recorder);
        v->news_until = 0.0;
    } else if (v->size[0] != 0 && v->size[1] != 0) {
        recorder_start(&v->recorder, &v->adapter, v->tester, v->size[0], v->size[1]);
    }
}

static void toggle_full_screen(Viewer *v, double unused) {
    int               *w = v->windowed;
    GLFWmonitor       *monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode *mode = monitor != NULL ? glfwGetVideoMode(monitor) : NULL;
    (void)unused;
    if (glfwGetWindowMonitor(v->window) != NULL) {
        glfwSetWindowMonitor(v->window, NULL, w[0], w[1], w[2], w[3], GLFW_DONT_CARE);
    } else if (mode != NULL) {
        glfwGetWindowPos(v->window, &w[0], &w[1]);
        glfwGetWindowSize(v->window, &w[2], &w[3]);
        glfwSetWindowMonitor(v->window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
    }
}

static void show_keys(Viewer *v, double unused);

static void quit(Viewer *v, double unused) {
    (void)unused;
    viewer_quit(v);
}

/* ---- the table ---- */

typedef struct Key {
    int         key;   /* GLFW_KEY_*; 0: a line of the help only */
    int         shift; /* 1: with Shift */
    const char *name;  /* NULL: what the keyboard's layout prints on it */
    const char *help;  /* also what could not be done when bhr refuses the change */
    void (*act)(Viewer *, double argument);
    double argument;
    int    kind; /* HELD, LATE or 0 */
} Key;

#define HELD 1 /* acts with -argument when the key is let go */
#define LATE 2 /* needs the context: acts when no frame is rendered */

static const Key KEYS[] = {
    {0, 0, "left drag", "go about the hole", NULL, 0, 0},
    {0, 0, "right drag", "look around", NULL, 0, 0},
    {0, 0, "wheel", "go nearer, or away", NULL, 0, 0},
    {GLFW_KEY_C, 0, NULL, "look at the hole", centre_hole, 0, 0},
    {GLFW_KEY_F, 0, NULL, "fly freely, and back", toggle_flight, 0, 0},
    {GLFW_KEY_W, 0, NULL, "fly forward", thrust_forward, 1, HELD},
    {GLFW_KEY_S, 0, NULL, "fly backward", thrust_forward, -1, HELD},
    {GLFW_KEY_A, 0, NULL, "fly to the left", thrust_right, -1, HELD},
    {GLFW_KEY_D, 0, NULL, "fly to the right", thrust_right, 1, HELD},
    {GLFW_KEY_Q, 0, NULL, "fly down", thrust_up, -1, HELD},
    {GLFW_KEY_E, 0, NULL, "fly up", thrust_up, 1, HELD},
    {GLFW_KEY_LEFT_SHIFT, 0, "Shift", "fly four times as fast", thrust_more, 1, HELD},
    {GLFW_KEY_N, 0, NULL, "move the camera as: static, free fall (into the hole), orbit", cycle_motion, 0, 0},

    {GLFW_KEY_SPACE, 0, "Space", "stop time, and let it go on", toggle_pause, 0, 0},
    {GLFW_KEY_PERIOD, 0, NULL, "let time run twice as fast", change_pace, 2, 0},
    {GLFW_KEY_COMMA, 0, NULL, "let time run half as fast", change_pace, 0.5, 0},
    {GLFW_KEY_SLASH, 0, NULL, "let time run the other way", change_pace, -1, 0},

    {GLFW_KEY_RIGHT, 0, "Right", "raise the spin", change_spin, 0.1, 0},
    {GLFW_KEY_LEFT, 0, "Left", "lower the spin", change_spin, -0.1, 0},
    {GLFW_KEY_RIGHT, 1, "Right", "raise the spin a little", change_spin, 0.01, 0},
    {GLFW_KEY_LEFT, 1, "Left", "lower the spin a little", change_spin, -0.01, 0},
    {GLFW_KEY_M, 0, NULL, "raise the mass", change_mass, 1.1, 0},
    {GLFW_KEY_M, 1, NULL, "lower the mass", change_mass, 1 / 1.1, 0},

    {GLFW_KEY_X, 0, NULL, "show the disk, or leave it out", toggle_disk, 0, 0},
    {GLFW_KEY_Z, 0, NULL, "turn the disk the other way", toggle_retrograde, 0, 0},
    {GLFW_KEY_O, 0, NULL, "make the disk more opaque", change_opacity, 0.1, 0},
    {GLFW_KEY_O, 1, NULL, "make the disk less opaque", change_opacity, -0.1, 0},
    {GLFW_KEY_T, 0, NULL, "make the disk more turbulent", change_turbulence, 0.1, 0},
    {GLFW_KEY_T, 1, NULL, "make the disk less turbulent", change_turbulence, -0.1, 0},
    {GLFW_KEY_U, 0, NULL, "change the matter: disk, torus, halo, jet, as it was", cycle_matter, 0, 0},
    {GLFW_KEY_J, 0, NULL, "show a hot spot in orbit, or leave it out", toggle_hot_spot, 0, 0},
    {GLFW_KEY_K, 0, NULL, "show the stars, or leave them out", toggle_sky, 0, 0},

    {GLFW_KEY_1, 0, NULL, "switch the Doppler shift", toggle_effect, BHR_EFFECT_DOPPLER_SHIFT, 0},
    {GLFW_KEY_2, 0, NULL, "switch the gravitational redshift", toggle_effect, BHR_EFFECT_GRAVITY_SHIFT, 0},
    {GLFW_KEY_3, 0, NULL, "switch the beaming", toggle_effect, BHR_EFFECT_BEAMING, 0},
    {GLFW_KEY_4, 0, NULL, "switch the light delay", toggle_effect, BHR_EFFECT_LIGHT_DELAY, 0},

    {GLFW_KEY_1, 1, NULL, "show less of the Doppler shift, by quarters, then all", grade_effect, 0, 0},
    {GLFW_KEY_2, 1, NULL, "show less of the gravitational redshift, then all", grade_effect, 1, 0},
    {GLFW_KEY_3, 1, NULL, "show less of the beaming, then all", grade_effect, 2, 0},

    {GLFW_KEY_V, 0, NULL, "show another quantity: light, redshift, order, deflection ..", cycle_view, 0, 0},
    {GLFW_KEY_P, 0, NULL, "change the projection", cycle_projection, 0, 0},
    {GLFW_KEY_RIGHT_BRACKET, 0, NULL, "widen the field of view", change_fov, 1.1, 0},
    {GLFW_KEY_LEFT_BRACKET, 0, NULL, "narrow the field of view", change_fov, 1 / 1.1, 0},
    {GLFW_KEY_UP, 0, "Up", "expose more", change_exposure, 0.25, 0},
    {GLFW_KEY_DOWN, 0, "Down", "expose less", change_exposure, -0.25, 0},
    {GLFW_KEY_G, 0, NULL, "change the tone map", cycle_tone_map, 0, 0},
    {GLFW_KEY_Y, 0, NULL, "change the look: cinematic, physical, observatory, teaching", cycle_preset, 0, LATE},

    {GLFW_KEY_L, 0, NULL, "let the quality follow the display's rate, or not", toggle_adaptive, 0, 0},
    {GLFW_KEY_B, 0, NULL, "take more samples a pixel", change_samples, 2, 0},
    {GLFW_KEY_B, 1, NULL, "take fewer samples a pixel", change_samples, 0.5, 0},
    {GLFW_KEY_I, 0, NULL, "change the method of integration", cycle_method, 0, 0},

    {GLFW_KEY_F5, 0, "F5", "save the scene as " SAVED_SCENE, save_scene, 0, 0},
    {GLFW_KEY_F9, 0, "F9", "load the scene that was saved, or --scene's file anew", load_scene, 0, LATE},
    {GLFW_KEY_F12, 0, "F12", "save a picture; again: break it off", save_picture, 0, 0},
    {GLFW_KEY_R, 0, NULL, "record a film as pictures; again: stop; again: break off", toggle_recording, 0, 0},
    {GLFW_KEY_F11, 0, "F11", "fill the screen, or not", toggle_full_screen, 0, 0},
    {GLFW_KEY_BACKSPACE, 0, "Backspace", "begin again", reset, 0, 0},
    {GLFW_KEY_H, 0, NULL, "show this, or hide it", show_keys, 0, 0},
    {GLFW_KEY_ESCAPE, 0, "Esc", "quit, when picture and film are saved; again: without them", quit, 0, 0},
};

static void key_name(const Key *key, char *out, size_t size) {
    /* GLFW's printable keys are places on the keyboard, called after what the US layout prints there. Where GLFW runs,
     * it knows what this layout prints. */
    const char  ascii[2] = {(char)key->key, '\0'};
    const char *printed = key->name != NULL ? key->name : glfwGetKeyName(key->key, 0);
    snprintf(out, size, "%s%s", key->shift ? "Shift " : "", printed != NULL ? printed : ascii);
    if (key->name == NULL && out[0] != '\0') {
        char *last = out + strlen(out) - 1;
        *last = (char)toupper((unsigned char)*last);
    }
}

#define LINE 128

static void key_line(const Key *key, char out[LINE]) {
    char name[32];
    key_name(key, name, sizeof name);
    snprintf(out, LINE, "%-12s %s", name, key->help);
}

void input_print_keys(void) {
    for (size_t i = 0; i < COUNT_OF(KEYS); i++) {
        char line[LINE];
        key_line(&KEYS[i], line);
        printf("  %s\n", line);
    }
}

static void attach(Viewer *v, GLFWwindow *window);

/* Over the window; where that cannot be, on the terminal. */
static void show_keys(Viewer *v, double unused) {
    static char        lines[COUNT_OF(KEYS)][LINE];
    static const char *list[COUNT_OF(KEYS)];
    (void)unused;
    if (text_window_is_shown(&v->keys)) {
        glfwSetWindowShouldClose(v->keys.overlay.window, GLFW_TRUE);
        return;
    }
    for (size_t i = 0; i < COUNT_OF(KEYS); i++) {
        key_line(&KEYS[i], lines[i]);
        list[i] = lines[i];
    }
    if (text_window_show(&v->keys, v->window, list, COUNT_OF(KEYS), bar_window_height(&v->bar))) {
        attach(v, v->keys.overlay.window); /* a click may give it the keyboard */
    } else {
        input_print_keys();
    }
}

/* ---- callbacks of GLFW ---- */

static const Key *find_key(int code, int mods) {
    for (size_t i = 0; i < COUNT_OF(KEYS); i++) {
        if (KEYS[i].act != NULL && KEYS[i].key == code &&
            (KEYS[i].kind == HELD || KEYS[i].shift == ((mods & GLFW_MOD_SHIFT) != 0))) {
            return &KEYS[i];
        }
    }
    return NULL;
}

/* Every change is tried at once: what bhr refuses is said and taken back, and the viewer goes on. */
static void act(Viewer *v, const Key *key) {
    const Scene scene = v->scene;
    const Pilot pilot = v->pilot;
    v->said[0] = '\0';
    key->act(v, key->argument);
    BhrStatus status = scene_apply(&v->scene, v->tester);
    if (status < 0) {
        report_failure(key->help, status);
        v->scene = scene;
        v->pilot = pilot;
        status = scene_apply(&v->scene, v->tester);
        if (status < 0) {
            report_failure("take that back", status); /* a frame will say what is to be done */
        }
    } else if (v->said[0] != '\0') {
        puts(v->said);
    }
    v->changed_at = wall_seconds();
    v->dirty = 1;
}

static void on_key(GLFWwindow *window, int code, int scancode, int action, int mods) {
    Viewer    *v = glfwGetWindowUserPointer(window);
    const Key *key = find_key(code, mods);
    (void)scancode;
    if (key == NULL || v->still) {
        return;
    }
    if (key->kind == HELD) {
        if (action != GLFW_REPEAT) {
            key->act(v, action == GLFW_PRESS ? key->argument : -key->argument);
        }
        return;
    }
    /* Ctrl, Alt and Super belong to the desktop. */
    if (action == GLFW_RELEASE || (mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) {
        return;
    }
    if (key->kind != LATE || (!v->frame.busy && v->late_count == 0)) {
        act(v, key);
    } else if (v->late_count < MOST_LATE) {
        v->late[v->late_count++] = (int)(key - KEYS);
    }
}

void input_act_late(Viewer *v) {
    const int count = v->late_count;
    v->late_count = 0;
    for (int i = 0; i < count; i++) {
        act(v, &KEYS[v->late[i]]);
    }
}

/* The keys alone, of either window. */
static void attach(Viewer *v, GLFWwindow *window) {
    glfwSetWindowUserPointer(window, v);
    glfwSetKeyCallback(window, on_key);
}

static void on_button(GLFWwindow *window, int button, int action, int mods) {
    Viewer *v = glfwGetWindowUserPointer(window);
    int     pressed = action == GLFW_PRESS;
    (void)mods;
    glfwGetCursorPos(window, &v->mouse.x, &v->mouse.y);
    if (button == GLFW_MOUSE_BUTTON_LEFT) {
        v->mouse.orbits = pressed;
    } else if (button == GLFW_MOUSE_BUTTON_RIGHT) {
        v->mouse.looks = pressed;
        if (window != v->window) {
            return; /* the cursor is not this one's to take */
        }
        /* Without an edge of the screen to stop it. */
        glfwSetInputMode(window, GLFW_CURSOR, pressed ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
        glfwGetCursorPos(window, &v->mouse.x, &v->mouse.y);
    }
}

static void on_cursor(GLFWwindow *window, double x, double y) {
    Viewer *v = glfwGetWindowUserPointer(window);
    int     width, height;
    glfwGetWindowSize(v->window, &width, &height);
    double dx = (x - v->mouse.x) / fmax(height, 1), dy = (y - v->mouse.y) / fmax(height, 1);
    v->mouse.x = x;
    v->mouse.y = y;
    if (v->still) {
        return;
    }
    /* In free flight both buttons look: there is nothing to go about. */
    if (v->mouse.looks || (v->mouse.orbits && v->pilot.flying)) {
        double angle = fmin(v->scene.camera.fov_y, PI / 2.0); /* what lies under the mouse goes along with it, nearly */
        v->pilot.look[0] += angle * dx;
        v->pilot.look[1] -= angle * dy;
    } else if (v->mouse.orbits) {
        v->pilot.turn[0] -= DRAG_PER_HEIGHT * dx;
        v->pilot.turn[1] += DRAG_PER_HEIGHT * dy;
    }
}

static void on_wheel(GLFWwindow *window, double dx, double dy) {
    Viewer *v = glfwGetWindowUserPointer(window);
    (void)dx;
    if (!v->still) {
        v->pilot.zoom -= ZOOM_PER_NOTCH * dy;
    }
}

void input_attach(Viewer *v, GLFWwindow *window) {
    attach(v, window);
    glfwSetMouseButtonCallback(window, on_button);
    glfwSetCursorPosCallback(window, on_cursor);
    glfwSetScrollCallback(window, on_wheel);
}
