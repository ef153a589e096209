/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* fits.h -- writes images as FITS files (the FITS standard 4.0, 2018). Knows no hole and no library. */
#ifndef EXAMPLES_FITS_H
#define EXAMPLES_FITS_H

#include <stddef.h>
#include <stdint.h>

typedef enum FitsKind { FITS_TEXT, FITS_NUMBER, FITS_HISTORY } FitsKind;

/* A line of the header. */
typedef struct FitsCard {
    const char *name;    /* 8 characters at most, A to Z, 0 to 9, - and _; HISTORY has none */
    FitsKind    kind;
    double      number;  /* finite */
    const char *text;    /* ASCII: of TEXT, cut off where the line is full; of HISTORY, as many lines as it needs */
    const char *comment; /* cut off where the line is full */
} FitsCard;

/* Writes width x height doubles, whose rows run from the top downwards; the file has the bottom row first. A file that
 * could not be written whole is removed. 1, or 0 after a message on stderr. */
int fits_write(const char *path, const double *pixels, uint32_t width, uint32_t height, const FitsCard *cards,
               size_t count);

#endif
