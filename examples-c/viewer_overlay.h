/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_overlay.h -- a picture over the viewer's window: bhr presents frames into that by itself and leaves a host no
 * place to draw, so the picture has a small window of its own that lies on it, without a frame, and goes along. OpenGL
 * copies its pixels there. On Wayland, where no program says where its windows are, the system places it. Knows no
 * scene, no keys, and not what it shows. */
#ifndef EXAMPLES_VIEWER_OVERLAY_H
#define EXAMPLES_VIEWER_OVERLAY_H

#include "glfw_window.h"

/* All zero before it is shown. */
typedef struct Overlay {
    GLFWwindow *window;    /* NULL: there is none */
    BhrImage    image;     /* that it shows, the lowest row first */
    int         place[2];  /* of its top-left corner from that of the window below, in screen units */
    double      drawn_at;  /* by glfwGetTime */
    int         had_focus; /* whether the program has had the keyboard since it was shown */
    int         is_placed; /* by the program */
    int         passes_mouse; /* set it before: clicks are for the window below, where GLFW can do that (3.4) */
} Overlay;

/* Whether a program can say where a window lies that is to be over this one; else the system decides. */
int overlay_has_place(GLFWwindow *below);

/* Shows an 8-bit picture, whose pixels are the overlay's from then on, at a place over the window below, a pixel for
 * each screen unit. A window that is there already changes to it and stays the same one. `title`: of a new one. 1, or 0
 * where that is not possible, after GLFW's error callback heard why; then there is no window. */
int overlay_show(Overlay *overlay, GLFWwindow *below, const char *title, const BhrImage *image, int x, int y);

/* Whether the overlay has the keyboard, or one that was closed and is not destroyed yet. */
int overlay_has_focus(const Overlay *overlay);

/* Whether it may be shown: 0 after the program has lost the keyboard, until it has it again. has_focus: whether one of
 * its windows has it. */
int overlay_is_in_use(Overlay *overlay, int has_focus);

/* Follows the window below. Call it in each turn of the loop. */
void overlay_follow(Overlay *overlay, GLFWwindow *below);

/* Takes the window away, if there is one: hides it, also from callbacks, in which GLFW destroys none. */
void overlay_close(Overlay *overlay);

/* Destroys the windows of all overlays that were closed, once the keyboard has left them: GLFW fails where a window is
 * destroyed between a key's press and its release. Call it in each turn of the loop, but not from GLFW's callbacks.
 * What is left at the end goes with glfwTerminate. */
void overlay_tidy(void);

#endif
