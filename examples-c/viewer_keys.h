/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_keys.h -- text over the viewer's window: bhr presents frames into that by itself and leaves a host no place to
 * draw, so the text has a small window of its own that lies on it, without a frame, and goes along. OpenGL copies its
 * pixels there. Knows no scene and no keys. */
#ifndef EXAMPLES_VIEWER_KEYS_H
#define EXAMPLES_VIEWER_KEYS_H

#include "glfw_window.h"

#include <stddef.h>

typedef struct TextWindow {
    GLFWwindow *window; /* NULL: not shown */
    BhrImage    image;  /* what it shows, the lowest row first */
    double      drawn_at;  /* by glfwGetTime */
    int         had_focus; /* it or the window below; gone with both */
} TextWindow;

/* Shows lines of text over the top-left corner of a window, as large as it has room for, in one column or more. 1, or 0
 * where that is not possible, after GLFW's error callback heard why. */
int text_window_show(TextWindow *text, GLFWwindow *below, const char *const *lines, size_t count);

/* Follows the window below; hides the text when neither of the two has the keyboard any more. Call it in each turn of
 * the loop. */
void text_window_follow(TextWindow *text, GLFWwindow *below);

/* Takes the text away, if it is shown. */
void text_window_hide(TextWindow *text);

#endif
