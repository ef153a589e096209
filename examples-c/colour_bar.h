/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* colour_bar.h -- what the colours of a false-colour picture mean: a bar of them with numbers and a unit, written into
 * the picture. The colours of views are those of docs/views.md. Reads settings of a context, but changes none and
 * renders nothing. */
#ifndef EXAMPLES_COLOUR_BAR_H
#define EXAMPLES_COLOUR_BAR_H

#include "picture.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define MOST_MARKS 8u
#define COLOUR_BAR_ROWS 44u
#define COLOUR_BAR_GREY 128 /* of 255, where a view has no value */

/* A number beside the bar. */
typedef struct Mark {
    double share; /* of the way along the bar, 0 to 1 */
    char   text[16];
} Mark;

typedef struct ColourBar {
    const char *title;    /* the quantity and its unit */
    const char *no_value; /* what grey means; NULL: nothing is grey */
    void (*colour)(double share, unsigned char rgb[3]);
    uint32_t steps;       /* so many even fields, each with its mark in the middle; 0: a gradient */
    uint32_t count;       /* of the marks */
    Mark     marks[MOST_MARKS];
} ColourBar;

/* afmhot of gnuplot and matplotlib, in which the Event Horizon Telescope publishes: BHR_COLOUR_MAP_AFMHOT. */
void colour_afmhot(double share, unsigned char rgb[3]);

/* The colours of a view. 0 for BHR_VIEW_LIGHT and for views that this program does not know, which get no bar. */
int colour_bar_of_view(BhrView view, ColourBar *bar);

/* The colours of a film's colour map, along developed light. 0 for BHR_COLOUR_MAP_NONE. */
int colour_bar_of_film(const BhrFilm *film, ColourBar *bar);

/* The bar of a view, for BHR_VIEW_LIGHT that of the film's colour map. Where there is none, 0 and a bar without marks.
 * */
int colour_bar_of(BhrView view, const BhrFilm *film, ColourBar *bar);

/* The place of a view's value along its bar, 0 to 1; what lies beyond the ends is put there. */
double colour_bar_share(BhrView view, double value);

/* Marks at about five round values from 0 to `most`, which is above 0, at the bar's end. */
void colour_bar_mark(ColourBar *bar, double most);

/* The colour at a place along the bar, 0 to 1. */
void colour_bar_at(const ColourBar *bar, double share, unsigned char rgb[3]);

/* Where along the bar, 0 to 1, the mark of this index stands. */
double colour_bar_place(const ColourBar *bar, uint32_t mark);

/* The scale of the text in pictures of this size; 0 where no text could be read. */
uint32_t colour_bar_scale(uint32_t width, uint32_t height);

/* Writes the bar into the last rows of an 8-bit picture, COLOUR_BAR_ROWS times `scale` of them, which become dark
 * behind it. `scale`: of the text, as for picture_write. */
void colour_bar_draw(BhrImage *image, const ColourBar *bar, uint32_t scale);

/* The bar that a context's frames need, as colour_bar_of. */
BhrStatus colour_bar_of_frames(const BhrContext *context, ColourBar *bar);

/* Draws a bar that has marks, and returns the rows that it took: 0 in pictures of less than 300 x 150 pixels, too small
 * for text. */
uint32_t colour_bar_put(BhrImage *image, const ColourBar *bar);

/* The bar of pictures whose disk has the colours of blackbodies, shifted, and no others, as BHR_PRESET_TEACHING makes
 * them: a temperature T is seen as g T. 0 for other scenes, and the bar is as it was. */
int colour_bar_of_temperatures(const BhrContext *context, ColourBar *bar);

/* Draws the bar that the context's settings call for into a picture, of false colour or of temperatures, if any. */
BhrStatus colour_bar_add(const BhrContext *context, BhrImage *image);

#ifdef __cplusplus
}
#endif

#endif
