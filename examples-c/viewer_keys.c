/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_keys.c -- see viewer_keys.h. */
#include "viewer_keys.h"

#include "picture.h"

#include <stdio.h>
#include <string.h>

#define BACKGROUND 24
#define LARGEST_SCALE 3
#define MARGIN 2 /* cells */
#define MOST_COLUMNS 3
#define PLACE 12 /* of the text, from the window's corner, in screen units */

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

/* The largest that the window below holds above its foot, with the fewest columns of that size; the smallest of all
 * when none fits. */
static Layout choose_layout(GLFWwindow *below, int foot, const char *const *lines, size_t count) {
    int width, height;
    glfwGetWindowSize(below, &width, &height);
    height = height > foot ? height - foot : 0;
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

static int show(TextWindow *text, GLFWwindow *below, const Layout *layout) {
    BhrImage image;
    if (!picture_allocate(&image, BHR_FORMAT_RGBA8_SRGB, layout->width, layout->height)) {
        return 0;
    }
    picture_fill(&image, BACKGROUND);
    write_lines(&image, layout, text->lines, text->count);
    text->columns = layout->columns;
    text->scale = layout->scale;
    return overlay_show(&text->overlay, below, "bhr: keys", &image, PLACE, PLACE);
}

int text_window_is_shown(const TextWindow *text) { return text->overlay.window != NULL; }

int text_window_show(TextWindow *text, GLFWwindow *below, const char *const *lines, size_t count, int foot) {
    const Layout layout = choose_layout(below, foot, lines, count);
    text->lines = lines;
    text->count = count;
    return show(text, below, &layout);
}

void text_window_follow(TextWindow *text, GLFWwindow *below, int foot, int has_focus) {
    if (!text_window_is_shown(text)) {
        return;
    }
    if (!overlay_is_in_use(&text->overlay, has_focus) || glfwWindowShouldClose(text->overlay.window)) {
        text_window_hide(text);
        return;
    }
    const Layout layout = choose_layout(below, foot, text->lines, text->count);
    if (layout.columns == text->columns && layout.scale == text->scale) {
        overlay_follow(&text->overlay, below);
    } else if (!show(text, below, &layout)) {
        text_window_hide(text);
    }
}

void text_window_hide(TextWindow *text) { overlay_close(&text->overlay); }
