/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_keys.h -- text over the viewer's window, in an overlay at its top-left corner. Knows no scene and no keys. */
#ifndef EXAMPLES_VIEWER_KEYS_H
#define EXAMPLES_VIEWER_KEYS_H

#include "viewer_overlay.h"

#include <stddef.h>

/* All zero before it is shown. */
typedef struct TextWindow {
    Overlay            overlay;
    const char *const *lines; /* the caller's, as long as they are shown */
    size_t             count;
    size_t             columns; /* that they stand in */
    uint32_t           scale;
} TextWindow;

int text_window_is_shown(const TextWindow *text);

/* Shows lines of text over the window below, as large as it has room for beside `foot` screen units at its foot, in one
 * column or more. 1, or 0 where that is not possible, after GLFW's error callback heard why. */
int text_window_show(TextWindow *text, GLFWwindow *below, const char *const *lines, size_t count, int foot);

/* Follows the window below and its size; hides the text when the program has lost the keyboard, of which has_focus
 * tells, or its window is to be closed. In each turn of the loop, also from callbacks; overlay_tidy is the caller's. */
void text_window_follow(TextWindow *text, GLFWwindow *below, int foot, int has_focus);

/* Takes the text away, if it is shown. */
void text_window_hide(TextWindow *text);

#endif
