/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_bar.c -- see viewer_bar.h. */
#include "viewer_bar.h"

#include <stdio.h>

#define GROUND 96 /* grey, before the bar darkens it */

/* The bar for the window below as large as that is. 1, or 0 where it is too small, or after a message. */
static int show(BarWindow *window, GLFWwindow *below) {
    int *size = window->size;
    glfwGetWindowSize(below, &size[0], &size[1]);
    const uint32_t width = (uint32_t)size[0], scale = colour_bar_scale(width, (uint32_t)size[1]);
    BhrImage       image;
    if (scale == 0 || !picture_allocate(&image, BHR_FORMAT_RGBA8_SRGB, width, COLOUR_BAR_ROWS * scale)) {
        return 0;
    }
    picture_fill(&image, GROUND);
    colour_bar_draw(&image, &window->bar, scale);
    window->overlay.passes_mouse = 1;
    window->hidden = 0;
    return overlay_show(&window->overlay, below, "bhr: colours", &image, 0, size[1] - (int)image.height);
}

/* On the terminal, where there is no window for it, or a full screen may hide that. */
static void say(const ColourBar *bar) {
    printf("colours: %s, from %s to %s", bar->title, bar->marks[0].text, bar->marks[bar->count - 1].text);
    if (bar->no_value != NULL) {
        printf("; grey: %s", bar->no_value);
    }
    putchar('\n');
}

static int has_room(GLFWwindow *below) {
    int width, height;
    glfwGetWindowSize(below, &width, &height);
    return colour_bar_scale((uint32_t)width, (uint32_t)height) > 0;
}

int bar_window_set(BarWindow *window, GLFWwindow *below, const ColourBar *bar) {
    const int is_open = window->overlay.window != NULL, is_other = window->bar.title != bar->title;
    window->unwanted = is_open && glfwWindowShouldClose(window->overlay.window) ? window->bar.title
                       : is_other                                                ? NULL
                                                                                 : window->unwanted;
    window->bar = *bar;
    overlay_tidy();
    if (bar->count == 0 || window->unwanted == bar->title || !has_room(below)) {
        bar_window_hide(window);
        return 0;
    }
    /* A window that fills the screen anew, or no more, may lie over what was there before. */
    GLFWmonitor *monitor = glfwGetWindowMonitor(below);
    if (monitor != window->monitor) {
        bar_window_hide(window);
        window->monitor = monitor;
    }
    if (window->overlay.window != NULL && !is_other) {
        return 0;
    }
    /* Where the system places windows, it would take the keyboard, and lie anywhere. */
    const int is_new = window->overlay.window == NULL, good = overlay_has_place(below) && show(window, below);
    if (!good) {
        window->unwanted = bar->title;
    }
    if (!good || monitor != NULL) {
        say(bar);
    }
    return good && is_new;
}

/* Shows and hides it as the program gets the keyboard and loses it: other programs' windows are not to be covered.
 * Whether it is shown. */
static int keep_with_focus(BarWindow *window, GLFWwindow *below, int has_focus) {
    GLFWwindow *own = window->overlay.window;
    const int   in_use = overlay_is_in_use(&window->overlay, has_focus);
    if (!in_use && !window->hidden) {
        glfwHideWindow(own);
    } else if (in_use && window->hidden) {
        glfwSetWindowAttrib(own, GLFW_FLOATING, GLFW_FALSE); /* X11's window managers forget it of hidden windows */
        glfwSetWindowAttrib(own, GLFW_FLOATING, GLFW_TRUE);
        glfwShowWindow(own);
    }
    window->hidden = !in_use;
    /* Not while the mouse drags: it would be let go. */
    if (in_use && glfwGetWindowAttrib(own, GLFW_FOCUSED) &&
        glfwGetMouseButton(own, GLFW_MOUSE_BUTTON_LEFT) == GLFW_RELEASE &&
        glfwGetMouseButton(own, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_RELEASE) {
        glfwFocusWindow(below);
    }
    return in_use;
}

void bar_window_follow(BarWindow *window, GLFWwindow *below, int has_focus) {
    int width, height;
    if (window->overlay.window == NULL || !keep_with_focus(window, below, has_focus)) {
        return;
    }
    glfwGetWindowSize(below, &width, &height);
    if (width == window->size[0] && height == window->size[1]) {
        overlay_follow(&window->overlay, below);
    } else if (has_room(below)) {
        show(window, below);
    }
}

int bar_window_height(const BarWindow *window) {
    return window->overlay.window != NULL ? (int)window->overlay.image.height : 0;
}

void bar_window_hide(BarWindow *window) { overlay_close(&window->overlay); }
