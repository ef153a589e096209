/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* video.h -- frames into a video file, by ffmpeg, which runs beside the program and reads raw pixels from a pipe. Knows
 * no scene. Needs POSIX; on Windows it refuses. */
#ifndef EXAMPLES_VIDEO_H
#define EXAMPLES_VIDEO_H

#include <bhr.h>

typedef struct Video {
    long process;
    int  pipe; /* its end for writing */
} Video;

/* Starts ffmpeg, which overwrites `path` with width x height frames (both even), `rate` of them a second; the ending of
 * the path decides the kind of file. Ctrl-C in a terminal does not reach ffmpeg; when this program ends, however it
 * does, ffmpeg ends the file. Should ffmpeg be killed as well, .mp4, .mov and .m4v play but for the last seconds. 1,
 * or 0 after a message, such as that there is no ffmpeg. */
int video_open(Video *video, const char *path, uint32_t width, uint32_t height, double rate);

/* Adds a packed RGBA8_SRGB frame of the video's size. 1, or 0 after a message. */
int video_add(Video *video, const BhrImage *image);

/* Ends the file, and waits for ffmpeg. 1, or 0 after a message. */
int video_close(Video *video);

#endif
