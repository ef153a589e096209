/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* glfw_window.h -- how a GLFW window becomes the BhrWindow that bhr_context_create and bhr_surface_create take. The
 * only home of that translation; needs GLFW and bhr.h, makes and destroys nothing. */
#ifndef EXAMPLES_GLFW_WINDOW_H
#define EXAMPLES_GLFW_WINDOW_H

#ifndef GLFW_INCLUDE_NONE
#define GLFW_INCLUDE_NONE /* no OpenGL header */
#endif
#include <GLFW/glfw3.h>
#include <bhr.h>

/* Fills in *out; the window stays the caller's and must outlive every surface made from it. 1, or 0 when this program
 * was built without the platform that the window is on. The window must have been made with GLFW_CLIENT_API =
 * GLFW_NO_API: bhr brings its own graphics. */
int window_from_glfw(GLFWwindow *window, BhrWindow *out);

#endif
