/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* host.c -- see host.h. */
#define _POSIX_C_SOURCE 200809L

#include "host.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PATIENCE 60.0 /* seconds until a window must show what was presented: lavapipe presents on threads of its own */

static void give_up(const char *why) {
    CHECK(0, "%s", why);
    exit(check_end());
}

BhrWindowKind host_kind(const char *name) {
    if (name != NULL && strcmp(name, "xlib") == 0) {
        return BHR_WINDOW_XLIB;
    }
    if (name != NULL && strcmp(name, "xcb") == 0) {
        return BHR_WINDOW_XCB;
    }
    fprintf(stderr, "the second argument is xlib or xcb\n");
    exit(2);
}

/* ---- windows ---- */

/* Returns when the server has done all that was asked. */
static void settle(const Host *host) {
    if (host->display != NULL) {
        XSync(host->display, False);
    } else {
        free(xcb_get_input_focus_reply(host->connection, xcb_get_input_focus(host->connection), NULL));
    }
}

/* Without a background, so that the server itself never draws into them. */
static uint32_t new_xlib_window(Display *display, uint32_t width, uint32_t height) {
    const Window id = XCreateWindow(display, DefaultRootWindow(display), 0, 0, width, height, 0, CopyFromParent,
                                    InputOutput, CopyFromParent, 0, NULL);
    XMapWindow(display, id);
    return (uint32_t)id;
}

static uint32_t new_xcb_window(xcb_connection_t *connection, uint32_t width, uint32_t height) {
    const xcb_screen_t *root = xcb_setup_roots_iterator(xcb_get_setup(connection)).data;
    const uint32_t      id = xcb_generate_id(connection);
    xcb_create_window(connection, XCB_COPY_FROM_PARENT, id, root->root, 0, 0, (uint16_t)width, (uint16_t)height, 0,
                      XCB_WINDOW_CLASS_INPUT_OUTPUT, XCB_COPY_FROM_PARENT, 0, NULL);
    xcb_map_window(connection, id);
    return id;
}

void host_new_window(Host *host, uint32_t width, uint32_t height) {
    host_destroy_window(host);
    host->id = host->display != NULL ? new_xlib_window(host->display, width, height)
                                     : new_xcb_window(host->connection, width, height);
    settle(host);
}

Host host_open(BhrWindowKind kind, const char *server, uint32_t width, uint32_t height) {
    Host host = {kind, NULL, NULL, 0};
    if (kind == BHR_WINDOW_XLIB) {
        host.display = XOpenDisplay(server);
    } else {
        host.connection = xcb_connect(server, NULL);
    }
    if (kind == BHR_WINDOW_XLIB ? host.display == NULL : xcb_connection_has_error(host.connection)) {
        give_up("no X server");
    }
    host_new_window(&host, width, height);
    return host;
}

/* A visual of 32 bits; 0 when the screen has none. */
static xcb_visualid_t visual_with_alpha(const xcb_screen_t *screen) {
    for (xcb_depth_iterator_t depth = xcb_screen_allowed_depths_iterator(screen); depth.rem > 0;
         xcb_depth_next(&depth)) {
        if (depth.data->depth == 32 && depth.data->visuals_len > 0) {
            return xcb_depth_visuals(depth.data)->visual_id;
        }
    }
    return 0;
}

Host host_open_with_alpha(uint32_t width, uint32_t height) {
    Host                 host = host_open(BHR_WINDOW_XCB, NULL, width, height);
    const xcb_screen_t  *root = xcb_setup_roots_iterator(xcb_get_setup(host.connection)).data;
    const xcb_visualid_t visual = visual_with_alpha(root);
    const xcb_colormap_t map = xcb_generate_id(host.connection);
    const uint32_t       values[] = {0, map}; /* neither the parent's border nor its colours fit */
    if (visual == 0) {
        give_up("the X server has no visual with alpha");
    }
    host_destroy_window(&host);
    xcb_create_colormap(host.connection, XCB_COLORMAP_ALLOC_NONE, map, root->root, visual);
    host.id = xcb_generate_id(host.connection);
    xcb_create_window(host.connection, 32, host.id, root->root, 0, 0, (uint16_t)width, (uint16_t)height, 0,
                      XCB_WINDOW_CLASS_INPUT_OUTPUT, visual, XCB_CW_BORDER_PIXEL | XCB_CW_COLORMAP, values);
    xcb_map_window(host.connection, host.id);
    settle(&host);
    return host;
}

void host_show(const Host *host, int shown) {
    if (host->kind == BHR_WINDOW_XLIB) {
        (shown ? XMapWindow : XUnmapWindow)(host->display, host->id);
    } else {
        (shown ? xcb_map_window : xcb_unmap_window)(host->connection, host->id);
    }
    settle(host);
}

BhrWindow host_window(const Host *host) {
    BhrWindow window;
    memset(&window, 0, sizeof window);
    window.struct_size = sizeof window;
    window.kind = host->kind;
    window.display = host->kind == BHR_WINDOW_XLIB ? (void *)host->display : (void *)host->connection;
    window.id = host->id;
    return window;
}

void host_resize(const Host *host, uint32_t width, uint32_t height) {
    if (host->kind == BHR_WINDOW_XLIB) {
        XResizeWindow(host->display, host->id, width, height);
    } else {
        const uint32_t size[] = {width, height};
        xcb_configure_window(host->connection, host->id, XCB_CONFIG_WINDOW_WIDTH | XCB_CONFIG_WINDOW_HEIGHT, size);
    }
    settle(host);
}

void host_move(const Host *host, uint32_t x, uint32_t y) {
    if (host->kind == BHR_WINDOW_XLIB) {
        XMoveWindow(host->display, host->id, (int)x, (int)y);
    } else {
        const uint32_t place[] = {x, y};
        xcb_configure_window(host->connection, host->id, XCB_CONFIG_WINDOW_X | XCB_CONFIG_WINDOW_Y, place);
    }
    settle(host);
}

void host_destroy_window(Host *host) {
    if (host->id != 0 && host->display != NULL) {
        XDestroyWindow(host->display, host->id);
        settle(host);
    } else if (host->id != 0 && host->connection != NULL) {
        xcb_destroy_window(host->connection, host->id);
        settle(host);
    }
    host->id = 0;
}

void host_close(Host *host) {
    if (host->display != NULL) {
        XCloseDisplay(host->display);
    }
    if (host->connection != NULL) {
        xcb_disconnect(host->connection);
    }
    host->display = NULL;
    host->connection = NULL;
    host->id = 0;
}

/* ---- what is to be seen ---- */

static xcb_connection_t *onlooker(void) {
    static xcb_connection_t *connection;
    if (connection == NULL) {
        connection = xcb_connect(NULL, NULL);
        if (xcb_connection_has_error(connection)) {
            give_up("no X server to look at");
        }
    }
    return connection;
}

Host host_screen(void) {
    const Host screen = {BHR_WINDOW_XCB, NULL, NULL, xcb_setup_roots_iterator(xcb_get_setup(onlooker())).data->root};
    return screen;
}

int host_exists(uint32_t id) {
    xcb_connection_t         *connection = onlooker();
    xcb_get_geometry_reply_t *reply = xcb_get_geometry_reply(connection, xcb_get_geometry(connection, id), NULL);
    free(reply);
    return reply != NULL;
}

int host_depth(const Host *host) {
    xcb_connection_t         *connection = onlooker();
    xcb_get_geometry_reply_t *reply = xcb_get_geometry_reply(connection, xcb_get_geometry(connection, host->id), NULL);
    const int                 depth = reply != NULL ? reply->depth : 0;
    free(reply);
    return depth;
}

static const xcb_visualtype_t *visual_of(const xcb_setup_t *setup, xcb_visualid_t id) {
    const xcb_screen_t *screen = xcb_setup_roots_iterator(setup).data;
    for (xcb_depth_iterator_t depth = xcb_screen_allowed_depths_iterator(screen); depth.rem > 0;
         xcb_depth_next(&depth)) {
        const xcb_visualtype_t *visuals = xcb_depth_visuals(depth.data);
        for (int i = 0; i < xcb_depth_visuals_length(depth.data); i++) {
            if (visuals[i].visual_id == id) {
                return &visuals[i];
            }
        }
    }
    return NULL;
}

/* The image's bytes of a pixel, and of a row of `width` pixels; 0 and 0 for depths that the server has not. */
static void form_of(const xcb_setup_t *setup, int depth, uint32_t width, uint32_t *pixel, uint32_t *row) {
    const xcb_format_t *formats = xcb_setup_pixmap_formats(setup);
    *pixel = *row = 0;
    for (int i = 0; i < xcb_setup_pixmap_formats_length(setup); i++) {
        if (formats[i].depth == depth) {
            const uint32_t pad = formats[i].scanline_pad;
            *pixel = formats[i].bits_per_pixel / 8u;
            *row = (width * formats[i].bits_per_pixel + pad - 1) / pad * pad / 8;
        }
    }
}

/* The bits of a mask, as a code of 0 .. 255. */
static unsigned char code_of(uint32_t pixel, uint32_t mask) {
    const uint32_t lowest = mask & (~mask + 1), most = mask / lowest;
    return (unsigned char)(((pixel & mask) / lowest * 255u + most / 2) / most);
}

/* Servers of this machine's byte order, which is little-endian; a window of 32 bits has its alpha in the highest. */
int host_grab(const Host *host, uint32_t width, uint32_t height, unsigned char *rgba) {
    xcb_connection_t      *connection = onlooker();
    const xcb_setup_t     *setup = xcb_get_setup(connection);
    xcb_get_image_cookie_t asked = xcb_get_image(connection, XCB_IMAGE_FORMAT_Z_PIXMAP, host->id, 0, 0,
                                                 (uint16_t)width, (uint16_t)height, UINT32_MAX);
    xcb_get_image_reply_t *image = xcb_get_image_reply(connection, asked, NULL);
    const xcb_visualtype_t *visual = image != NULL ? visual_of(setup, image->visual) : NULL;
    uint32_t                bytes = 0, row = 0;
    if (visual != NULL) {
        form_of(setup, image->depth, width, &bytes, &row);
    }
    const int is_there = bytes > 0 && (size_t)xcb_get_image_data_length(image) == (size_t)row * height;
    for (size_t i = 0; is_there && i < (size_t)width * height; i++) {
        const unsigned char *from = xcb_get_image_data(image) + i / width * row + i % width * bytes;
        unsigned char       *to = rgba + 4 * i;
        uint32_t             pixel = 0;
        for (uint32_t k = 0; k < bytes; k++) {
            pixel |= (uint32_t)from[k] << (8 * k);
        }
        to[0] = code_of(pixel, visual->red_mask);
        to[1] = code_of(pixel, visual->green_mask);
        to[2] = code_of(pixel, visual->blue_mask);
        to[3] = image->depth == 32 ? (unsigned char)(pixel >> 24) : 255;
    }
    free(image);
    return is_there;
}

static int largest_difference(const unsigned char *a, const unsigned char *b, size_t bytes) {
    int largest = 0;
    for (size_t i = 0; i < bytes; i++) {
        const int difference = abs((int)a[i] - (int)b[i]);
        largest = difference > largest ? difference : largest;
    }
    return largest;
}

int host_difference(const Host *host, uint32_t width, uint32_t height, const unsigned char *rgba, int tolerance) {
    const size_t   bytes = (size_t)width * height * 4;
    unsigned char *seen = malloc(bytes);
    const double   end = seconds_now() + PATIENCE;
    int            difference;
    while ((difference = host_grab(host, width, height, seen) ? largest_difference(seen, rgba, bytes) : 999) >
               tolerance &&
           seconds_now() < end) {
        pause_ms(10);
    }
    free(seen);
    return difference;
}

/* ---- bhr ---- */

BhrSurface *check_surface(BhrContext *context, const Host *host, uint32_t width, uint32_t height, BhrPresentMode mode) {
    const BhrWindow window = host_window(host);
    BhrSurface     *surface = NULL;
    CHECK_OK(bhr_surface_create(context, &window, width, height, mode, &surface));
    if (surface == NULL) {
        give_up("success without a surface");
    }
    return surface;
}

void run_threads(ThreadBody body, void *arguments, size_t argument_size, int count) {
    pthread_t threads[8];
    for (int i = 0; i < count; i++) {
        if (i >= (int)COUNT_OF(threads) ||
            pthread_create(&threads[i], NULL, body, (char *)arguments + (size_t)i * argument_size) != 0) {
            give_up("cannot start a thread");
    }
    }
    for (int i = 0; i < count; i++) {
        pthread_join(threads[i], NULL);
    }
}
