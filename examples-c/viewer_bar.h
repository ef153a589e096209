/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_bar.h -- the colour bar at the foot of the viewer's window, in an overlay. Knows no scene and no keys. */
#ifndef EXAMPLES_VIEWER_BAR_H
#define EXAMPLES_VIEWER_BAR_H

#include "colour_bar.h"
#include "viewer_overlay.h"

/* All zero before it is shown. */
typedef struct BarWindow {
    Overlay      overlay;
    ColourBar    bar;
    int          size[2];  /* of the window below, that it was made for */
    GLFWmonitor *monitor;  /* that the window below fills; NULL: none */
    int          hidden;   /* while the program has lost the keyboard */
    const char  *unwanted; /* title of the bar whose window cannot be, or was closed by hand */
} BarWindow;

/* Shows this bar in place of any other; a bar without marks hides it. Where it cannot lie on the window below, or a
 * full screen may hide it, the terminal says what the colours mean. 1 if a new window was made, whose callbacks of keys
 * and mouse the caller then sets. Call it in each turn of the loop, but not from GLFW's callbacks: overlay_tidy is
 * called here, for the other overlays, too. */
int bar_window_set(BarWindow *window, GLFWwindow *below, const ColourBar *bar);

/* Follows the window below and its size. Hides the bar while the program lacks the keyboard (has_focus), and hands the
 * keyboard on to the window below where the system gave it to the bar. In each turn, also from callbacks. */
void bar_window_follow(BarWindow *window, GLFWwindow *below, int has_focus);

/* The height that it takes of the foot of the window below, in screen units. */
int bar_window_height(const BarWindow *window);

/* Takes the bar away, if it is shown. */
void bar_window_hide(BarWindow *window);

#endif
