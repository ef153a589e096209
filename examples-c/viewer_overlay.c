/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_overlay.c -- see viewer_overlay.h. OpenGL is asked for what version 1.1 has, by GLFW, so that the viewer links
 * none of it. */
#include "viewer_overlay.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REDRAW_SECONDS 0.25 /* for what has covered it meanwhile */
#define MOST_CLOSED 8

#ifdef _WIN32
#define GL_CALL __stdcall
#else
#define GL_CALL
#endif
#define GL_RGBA 0x1908
#define GL_UNSIGNED_BYTE 0x1401

/* Windows of all overlays that were closed, hidden until they can be destroyed. */
static GLFWwindow *closed[MOST_CLOSED]; /* NULL: none */

typedef void(GL_CALL *GlViewport)(int x, int y, int width, int height);
typedef void(GL_CALL *GlFloats)(float x, float y);
typedef void(GL_CALL *GlDrawPixels)(int width, int height, unsigned format, unsigned type, const void *pixels);

/* OpenGL begins with the lowest row. 1, or 0 after a message. */
static int turn_upside_down(BhrImage *image) {
    const size_t   row = 4 * (size_t)image->width;
    unsigned char *pixels = image->pixels, *kept = malloc(row);
    if (kept == NULL) {
        fprintf(stderr, "cannot show a picture over the window: no memory\n");
        return 0;
    }
    for (uint32_t y = 0; y < image->height / 2; y++) {
        unsigned char *upper = pixels + y * row, *lower = pixels + (image->height - 1 - y) * row;
        memcpy(kept, upper, row);
        memcpy(upper, lower, row);
        memcpy(lower, kept, row);
    }
    free(kept);
    return 1;
}

/* The window's context is current only meanwhile: bhr may draw by OpenGL, too. 1, or 0 where it has no such OpenGL. */
static int draw(Overlay *overlay) {
    const BhrImage *image = &overlay->image;
    int             width, height;
    glfwGetFramebufferSize(overlay->window, &width, &height);
    glfwMakeContextCurrent(overlay->window);
    GlViewport   viewport = (GlViewport)glfwGetProcAddress("glViewport");
    GlFloats     raster_position = (GlFloats)glfwGetProcAddress("glRasterPos2f");
    GlFloats     zoom = (GlFloats)glfwGetProcAddress("glPixelZoom");
    GlDrawPixels draw_pixels = (GlDrawPixels)glfwGetProcAddress("glDrawPixels");
    const int    able = viewport != NULL && raster_position != NULL && zoom != NULL && draw_pixels != NULL;
    if (able) {
        glfwSwapInterval(0);
        viewport(0, 0, width, height);
        raster_position(-1.0f, -1.0f);
        zoom((float)width / (float)image->width, (float)height / (float)image->height);
        draw_pixels((int)image->width, (int)image->height, GL_RGBA, GL_UNSIGNED_BYTE, image->pixels);
        glfwSwapBuffers(overlay->window);
    }
    glfwMakeContextCurrent(NULL);
    overlay->drawn_at = glfwGetTime();
    return able;
}

int overlay_has_place(GLFWwindow *below) {
    int                x, y;
    const GLFWerrorfun on_error = glfwSetErrorCallback(NULL); /* the answer is no error */
    glfwGetError(NULL);
    glfwGetWindowPos(below, &x, &y);
    const int able = glfwGetError(NULL) == GLFW_NO_ERROR;
    glfwSetErrorCallback(on_error);
    return able;
}

static void move_along(const Overlay *overlay, GLFWwindow *below) {
    int x, y, now_x, now_y;
    if (!overlay->is_placed) {
        return;
    }
    glfwGetWindowPos(below, &x, &y);
    glfwGetWindowPos(overlay->window, &now_x, &now_y);
    x += overlay->place[0];
    y += overlay->place[1];
    if (now_x != x || now_y != y) {
        glfwSetWindowPos(overlay->window, x, y);
    }
}

static GLFWwindow *open_window(const Overlay *overlay, const char *title) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_DECORATED, GLFW_FALSE);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_FLOATING, GLFW_TRUE);
    glfwWindowHint(GLFW_FOCUSED, GLFW_FALSE);
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE); /* keys stay the viewer's */
#ifdef GLFW_MOUSE_PASSTHROUGH
    glfwWindowHint(GLFW_MOUSE_PASSTHROUGH, overlay->passes_mouse);
#endif
    GLFWwindow *window = glfwCreateWindow((int)overlay->image.width, (int)overlay->image.height, title, NULL, NULL);
    glfwDefaultWindowHints();
    return window;
}

int overlay_show(Overlay *overlay, GLFWwindow *below, const char *title, const BhrImage *image, int x, int y) {
    free(overlay->image.pixels);
    overlay->image = *image;
    overlay->place[0] = x;
    overlay->place[1] = y;
    int good = turn_upside_down(&overlay->image);
    if (good && overlay->window == NULL) {
        overlay->window = open_window(overlay, title);
        overlay->had_focus = 0;
        overlay->is_placed = overlay_has_place(below);
    } else if (good) {
        glfwSetWindowSize(overlay->window, (int)image->width, (int)image->height);
    }
    if (good && overlay->window != NULL) {
        move_along(overlay, below);
        glfwShowWindow(overlay->window);
        good = draw(overlay);
    }
    if (!good || overlay->window == NULL) {
        overlay_close(overlay);
        return 0;
    }
    return 1;
}

static int is_focused(GLFWwindow *window) { return window != NULL && glfwGetWindowAttrib(window, GLFW_FOCUSED); }

int overlay_has_focus(const Overlay *overlay) {
    int focused = is_focused(overlay->window);
    for (size_t i = 0; i < MOST_CLOSED; i++) {
        focused = focused || is_focused(closed[i]);
    }
    return focused;
}

int overlay_is_in_use(Overlay *overlay, int has_focus) {
    overlay->had_focus |= has_focus;
    return has_focus || !overlay->had_focus;
}

void overlay_follow(Overlay *overlay, GLFWwindow *below) {
    move_along(overlay, below);
    if (glfwGetTime() - overlay->drawn_at >= REDRAW_SECONDS) {
        draw(overlay);
    }
}

void overlay_close(Overlay *overlay) {
    if (overlay->window != NULL) {
        glfwHideWindow(overlay->window);
        for (size_t i = 0; i < MOST_CLOSED; i++) {
            if (closed[i] == NULL) {
                closed[i] = overlay->window;
                break;
            }
        }
    }
    overlay->window = NULL;
    free(overlay->image.pixels);
    overlay->image.pixels = NULL;
}

void overlay_tidy(void) {
    for (size_t i = 0; i < MOST_CLOSED; i++) {
        if (closed[i] != NULL && !is_focused(closed[i])) {
            glfwDestroyWindow(closed[i]);
            closed[i] = NULL;
        }
    }
}
