/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* glfw_window.c -- see glfw_window.h. */
#include "glfw_window.h"

#include <string.h>

/* GLFW 3.4 holds X11 and Wayland in one library and says at run time which one a window is on; before, a library has
 * one of them, and nothing at compile time tells which: X11, unless EXAMPLES_GLFW_WAYLAND is defined. Each needs its
 * headers (Debian: libx11-dev, libxrandr-dev; libwayland-dev): EXAMPLES_NO_X11, EXAMPLES_NO_WAYLAND leave one out. */
#define GLFW_CHOOSES_PLATFORM (GLFW_VERSION_MAJOR > 3 || (GLFW_VERSION_MAJOR == 3 && GLFW_VERSION_MINOR >= 4))

#if defined(_WIN32)
#define GLFW_EXPOSE_NATIVE_WIN32
#elif defined(__APPLE__)
#define GLFW_EXPOSE_NATIVE_COCOA
#elif GLFW_CHOOSES_PLATFORM
#ifndef EXAMPLES_NO_X11
#define GLFW_EXPOSE_NATIVE_X11
#endif
#ifndef EXAMPLES_NO_WAYLAND
#define GLFW_EXPOSE_NATIVE_WAYLAND
#endif
#elif defined(EXAMPLES_GLFW_WAYLAND)
#define GLFW_EXPOSE_NATIVE_WAYLAND
#else
#define GLFW_EXPOSE_NATIVE_X11
#endif
#include <GLFW/glfw3native.h>

#ifdef GLFW_EXPOSE_NATIVE_COCOA
#include <objc/message.h>
#endif

/* Whether the window is on this platform, one of GLFW_PLATFORM_*. */
#if GLFW_CHOOSES_PLATFORM
#define IS_ON(platform) (glfwGetPlatform() == (platform))
#else
#define IS_ON(platform) 1
#endif

int window_from_glfw(GLFWwindow *window, BhrWindow *out) {
    memset(out, 0, sizeof *out);
    out->struct_size = sizeof *out;
#ifdef GLFW_EXPOSE_NATIVE_WIN32
    if (IS_ON(GLFW_PLATFORM_WIN32)) {
        out->kind = BHR_WINDOW_WIN32;
        out->handle = glfwGetWin32Window(window);
        return out->handle != NULL;
    }
#endif
#ifdef GLFW_EXPOSE_NATIVE_COCOA
    if (IS_ON(GLFW_PLATFORM_COCOA)) {
        /* bhr draws into a view: [window contentView], said in plain C. */
        id (*send)(id, SEL) = (id(*)(id, SEL))objc_msgSend;
        out->kind = BHR_WINDOW_APPKIT;
        out->handle = send((id)glfwGetCocoaWindow(window), sel_registerName("contentView"));
        return out->handle != NULL;
    }
#endif
#ifdef GLFW_EXPOSE_NATIVE_WAYLAND
    if (IS_ON(GLFW_PLATFORM_WAYLAND)) {
        out->kind = BHR_WINDOW_WAYLAND;
        out->display = glfwGetWaylandDisplay();
        out->handle = glfwGetWaylandWindow(window);
        return out->display != NULL && out->handle != NULL;
    }
#endif
#ifdef GLFW_EXPOSE_NATIVE_X11
    if (IS_ON(GLFW_PLATFORM_X11)) {
        Display *display = glfwGetX11Display();
        out->kind = BHR_WINDOW_XLIB;
        out->display = display;
        out->id = glfwGetX11Window(window);
        out->screen = display != NULL ? DefaultScreen(display) : 0;
        return display != NULL && out->id != 0;
    }
#endif
    (void)window; /* no platform at all */
    return 0;
}
