/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_input.h -- keys and mouse. One table holds the keys: it dispatches them and prints the help. Changes wishes
 * and values in the Viewer; renders nothing except for the picture keys. */
#ifndef EXAMPLES_VIEWER_INPUT_H
#define EXAMPLES_VIEWER_INPUT_H

#include "viewer.h"

/* Hears the keys and the mouse of the viewer's window, or of one that lies over it, from now on. */
void input_attach(Viewer *viewer, GLFWwindow *window);

/* Does for keys that had to wait for the context. Call it while no frame is rendered. */
void input_act_late(Viewer *viewer);

/* On standard output. */
void input_print_keys(void);

#endif
