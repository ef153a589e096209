/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* viewer_news.h -- the viewer's title, what it tells of pictures and films that are rendered in the background, and how
 * the viewer ends while there are some. */
#ifndef EXAMPLES_VIEWER_NEWS_H
#define EXAMPLES_VIEWER_NEWS_H

#include "viewer.h"

/* Whether a picture or a film is in the making. */
int viewer_is_busy(const Viewer *viewer);

/* Looks after them; ends the viewer when it was asked to and the last of them is saved. */
void viewer_watch(Viewer *viewer);

/* Ends the viewer; while something is in the making only when it is saved, or when this is asked for again. */
void viewer_quit(Viewer *viewer);

/* Writes the title, from the first frame on, a few times a second. moving: the picture is, and may be coarser for
 * it. */
void viewer_update_title(Viewer *viewer, int moving);

#endif
