/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_keys.c -- see viewer_keys.h. OpenGL is asked for what version 1.1 has, by GLFW, so that the viewer links none
 * of it. */
#include "viewer_keys.h"

#include "picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BACKGROUND 24
#define LARGEST_SCALE 3
#define MARGIN 2 /* cells */
#define MOST_COLUMNS 3
#define PLACE 12 /* of the text, from the window's corner, in screen units */
#define REDRAW_SECONDS 0.25 /* for what has covered it meanwhile */

#ifdef _WIN32
#define GL_CALL __stdcall
#else
#define GL_CALL
#endif
#define GL_RGBA 0x1908
#define GL_UNSIGNED_BYTE 0x1401

typedef void(GL_CALL *GlViewport)(int x, int y, int width, int height);
typedef void(GL_CALL *GlFloats)(float x, float y);
typedef void(GL_CALL *GlDrawPixels)(int width, int height, unsigned format, unsigned type, const void *pixels);

typedef struct Layout {
    size_t   columns, rows;  /* of lines */
    size_t   widest[MOST_COLUMNS], across; /* characters */
    uint32_t scale, width, height;
} Layout;

static size_t longest_of(const char *const *lines, size_t count) {
    size_t longest = 0;
    for (size_t i = 0; i < count; i++) {
        longest = strlen(lines[i]) > longest ? strlen(lines[i]) : longest;
    }
    return longest;
}

static Layout lay_out(const char *const *lines, size_t count, size_t columns, uint32_t scale) {
    Layout layout = {.columns = columns, .rows = (count + columns - 1) / columns, .scale = scale};
    layout.across = MARGIN * (columns + 1);
    for (size_t i = 0; i < columns; i++) {
        const size_t first = i * layout.rows, left = first < count ? count - first : 0;
        layout.widest[i] = longest_of(lines + (left > 0 ? first : 0), left < layout.rows ? left : layout.rows);
        layout.across += layout.widest[i];
    }
    layout.width = (uint32_t)layout.across * CELL_WIDTH * scale;
    layout.height = (uint32_t)(layout.rows + MARGIN) * CELL_HEIGHT * scale;
    return layout;
}

/* The largest that the window below holds, with the fewest columns of that size; the smallest of all when none fits. */
static Layout choose_layout(GLFWwindow *below, const char *const *lines, size_t count) {
    int width, height;
    glfwGetWindowSize(below, &width, &height);
    for (uint32_t scale = LARGEST_SCALE; scale > 0; scale--) {
        for (size_t columns = 1; columns <= MOST_COLUMNS; columns++) {
            const Layout layout = lay_out(lines, count, columns, scale);
            if (layout.width + 2 * PLACE <= (uint32_t)width && layout.height + 2 * PLACE <= (uint32_t)height) {
                return layout;
            }
        }
    }
    return lay_out(lines, count, 2, 1);
}

static void write_lines(BhrImage *image, const Layout *layout, const char *const *lines, size_t count) {
    size_t cells = MARGIN;
    for (size_t i = 0; i < count; i++) {
        const size_t column = i / layout->rows, row = i % layout->rows;
        if (row == 0 && column > 0) {
            cells += layout->widest[column - 1] + MARGIN;
        }
        picture_write(image, (uint32_t)cells * CELL_WIDTH * layout->scale,
                      (uint32_t)(row + MARGIN / 2) * CELL_HEIGHT * layout->scale, layout->scale, lines[i]);
    }
}

/* OpenGL begins with the lowest row. 1, or 0 after a message. */
static int turn_upside_down(BhrImage *image) {
    const size_t   row = 4 * (size_t)image->width;
    unsigned char *pixels = image->pixels, *kept = malloc(row);
    if (kept == NULL) {
        fprintf(stderr, "cannot show text: no memory\n");
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
static int draw(TextWindow *text) {
    int width, height;
    glfwGetFramebufferSize(text->window, &width, &height);
    glfwMakeContextCurrent(text->window);
    GlViewport   viewport = (GlViewport)glfwGetProcAddress("glViewport");
    GlFloats     raster_position = (GlFloats)glfwGetProcAddress("glRasterPos2f");
    GlFloats     zoom = (GlFloats)glfwGetProcAddress("glPixelZoom");
    GlDrawPixels draw_pixels = (GlDrawPixels)glfwGetProcAddress("glDrawPixels");
    const int    able = viewport != NULL && raster_position != NULL && zoom != NULL && draw_pixels != NULL;
    if (able) {
        glfwSwapInterval(0);
        viewport(0, 0, width, height);
        raster_position(-1.0f, -1.0f);
        zoom((float)width / (float)text->image.width, (float)height / (float)text->image.height);
        draw_pixels((int)text->image.width, (int)text->image.height, GL_RGBA, GL_UNSIGNED_BYTE, text->image.pixels);
        glfwSwapBuffers(text->window);
    }
    glfwMakeContextCurrent(NULL);
    text->drawn_at = glfwGetTime();
    return able;
}

static void place(const TextWindow *text, GLFWwindow *below) {
    int x, y, now_x, now_y;
    glfwGetWindowPos(below, &x, &y);
    glfwGetWindowPos(text->window, &now_x, &now_y);
    if (now_x != x + PLACE || now_y != y + PLACE) {
        glfwSetWindowPos(text->window, x + PLACE, y + PLACE);
    }
}

static GLFWwindow *open_window(const Layout *layout) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_DECORATED, GLFW_FALSE);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_FLOATING, GLFW_TRUE);
    glfwWindowHint(GLFW_FOCUSED, GLFW_FALSE);
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE); /* keys stay the viewer's */
    GLFWwindow *window = glfwCreateWindow((int)layout->width, (int)layout->height, "bhr: keys", NULL, NULL);
    glfwDefaultWindowHints();
    return window;
}

int text_window_show(TextWindow *text, GLFWwindow *below, const char *const *lines, size_t count) {
    const Layout layout = choose_layout(below, lines, count);
    text_window_hide(text);
    if (!picture_allocate(&text->image, BHR_FORMAT_RGBA8_SRGB, layout.width, layout.height)) {
        return 0;
    }
    picture_fill(&text->image, BACKGROUND);
    write_lines(&text->image, &layout, lines, count);
    text->window = turn_upside_down(&text->image) ? open_window(&layout) : NULL;
    if (text->window == NULL) {
        free(text->image.pixels);
        return 0;
    }
    text->had_focus = 0;
    place(text, below);
    glfwShowWindow(text->window);
    if (!draw(text)) {
        text_window_hide(text);
        return 0;
    }
    return 1;
}

void text_window_follow(TextWindow *text, GLFWwindow *below) {
    if (text->window == NULL) {
        return;
    }
    const int has_focus = glfwGetWindowAttrib(below, GLFW_FOCUSED) || glfwGetWindowAttrib(text->window, GLFW_FOCUSED);
    if ((text->had_focus && !has_focus) || glfwWindowShouldClose(text->window)) {
        text_window_hide(text);
        return;
    }
    text->had_focus |= has_focus;
    place(text, below);
    if (glfwGetTime() - text->drawn_at >= REDRAW_SECONDS) {
        draw(text);
    }
}

void text_window_hide(TextWindow *text) {
    if (text->window != NULL) {
        glfwDestroyWindow(text->window);
        text->window = NULL;
        free(text->image.pixels);
    }
}
