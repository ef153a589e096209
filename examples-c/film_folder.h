/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* film_folder.h -- the folder of a film's pictures: which film they are of, which the file film.txt in it says, and
 * which of them are there. Pictures of two films never lie side by side. Knows no scene and no context. */
#ifndef EXAMPLES_FILM_FOLDER_H
#define EXAMPLES_FILM_FOLDER_H

#include <stdint.h>

#define FRAME_NAME 16 /* bytes of a picture's name with its NUL: frame-00000.png */

/* film.txt begins so, and has lines "frames = N" and "format = ENDING" behind it; every other line is the program's. */
#define FILM_FOLDER_TITLE "# The film whose pictures are in this folder, for `film --continue`: leave it as it is.\n"

/* Creates the folder if it is missing, and prepares it for a film. `film`: what film.txt is to say about it.
 *
 *   film.txt there     with go_on                          without
 *   none               error if there are pictures         the same
 *   this film's        its pictures stay                   they are removed, with a line about it on stderr
 *   another film's     error, with the first difference    they are removed as well
 *
 * Even this film's pictures may be out of date: film.txt does not cover the contents of maps and LUTs. A picture that
 * film.txt does not tell of, or a film.txt of another program, is never touched: it is an error. 1, or 0 after a
 * message. */
int film_folder_open(const char *folder, const char *film, int go_on);

/* Puts the name of a picture into `name`. */
void film_folder_name(char name[FRAME_NAME], uint32_t number, const char *ending);

/* Whether the picture is there. */
int film_folder_has(const char *folder, uint32_t number, const char *ending);

#endif
