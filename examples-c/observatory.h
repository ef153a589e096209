/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* observatory.h -- what the parts of observatory share: its settings, and its three commands. */
#ifndef EXAMPLES_OBSERVATORY_H
#define EXAMPLES_OBSERVATORY_H

#include "options.h"
#include "telescope.h"

#include <bhr.h>

/* Angles in radians; NaN: the target's, or the command's own. */
typedef struct Settings {
    Target      target; /* with what the options say otherwise */
    double      spin, inclination, position_angle;
    double      observer; /* M from the hole */
    double      fov;    /* of image: microarcseconds; of hotspot: M */
    double      beam;   /* microarcseconds across at half of the peak; 0: none */
    double      flux;   /* Jy at 230 GHz */
    const char *frequencies;
    TextList    volumes, hot_spots;
    uint32_t    pixels, phases;
    int         fast_light, plain;
    const char *output;
    Progress    progress;
} Settings;

#define MOST_PIXELS 4096u

/* Each gives an exit status after its messages. */
int observatory_image(BhrContext *context, Settings *s);
int observatory_gold(BhrContext *context, Settings *s);
int observatory_hotspot(BhrContext *context, Settings *s);

/* Whether the observer sees a square of this width, in M, from far enough that rays do not part much. 0, or an exit
 * status after a message. */
int check_width(const Settings *s, double width);

/* Makes the folder of the output, where there is none. 0, or an exit status after a message. */
int prepare_output(const Settings *s);

/* FOLDER/NAME, to be freed; NULL after a message. */
char *output_path(const Settings *s, const char *name);

/* `count` doubles; NULL after a message. Give them back by free(). */
double *allocate_doubles(size_t count);

#endif
