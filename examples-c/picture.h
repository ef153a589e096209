/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* picture.h -- blocks of pixels in the program's memory: made, scaled, written on, saved into a folder. 8-bit pictures
 * are packed RGBA8_SRGB. Knows no scene and no context. */
#ifndef EXAMPLES_PICTURE_H
#define EXAMPLES_PICTURE_H

#include <bhr.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A character's cell, in pixels at scale 1: 5 x 9 with one empty column and two empty rows between cells. */
#define CELL_WIDTH 6u
#define CELL_HEIGHT 11u

/* Fills in the image and allocates its pixels, packed and zero. 1, or 0 after a message; pixels are NULL then. Give the
 * pixels back by free(). */
int picture_allocate(BhrImage *image, BhrFormat format, uint32_t width, uint32_t height);

/* Makes it all opaque grey, 0 to 255. */
void picture_fill(BhrImage *image, unsigned char grey);

/* `from` shrunk (or stretched) into a rectangle of `to`, which must lie inside it: each pixel is the mean light of the
 * area that it covers. */
void picture_scale(const BhrImage *from, BhrImage *to, uint32_t x, uint32_t y, uint32_t width, uint32_t height);

/* Writes text, white with a dark rim, with the top-left corner of its first cell at x, y; what lies outside the picture
 * is left out. Has a to z, A to Z, 0 to 9 and " %'()*+,-./:;<=>[\]_"; other characters are blank. */
void picture_write(BhrImage *image, uint32_t x, uint32_t y, uint32_t scale, const char *text);

/* Saves it as FOLDER/NAME. 1, or 0 after a message. */
int picture_save_into(const BhrImage *image, const char *folder, const char *name);

#ifdef __cplusplus
}
#endif

#endif
