/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* video.c -- see video.h. ffmpeg is started without a shell: no name of a file can be taken for a command. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200112L /* posix_spawnp, waitpid, fcntl */
#endif

#include "video.h"

#include <stdio.h>

#ifdef _WIN32

int video_open(Video *video, const char *path, uint32_t width, uint32_t height, double rate) {
    (void)video, (void)path, (void)width, (void)height, (void)rate;
    fprintf(stderr, "cannot make a video: not on Windows; make pictures, and a video of them by ffmpeg\n");
    return 0;
}

int video_add(Video *video, const BhrImage *image) {
    (void)video, (void)image;
    return 0;
}

int video_close(Video *video) {
    (void)video;
    return 0;
}

#else

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* ffmpeg, its standard input being `input`. A terminal sends Ctrl-C to a whole process group: in one of its own ffmpeg
 * goes on, and ends the file when its input ends. 0, or the number of the error. */
static int start(pid_t *process, int input, char *const arguments[]) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t          attributes;
    int                        error = posix_spawnattr_init(&attributes);
    if (error != 0) {
        return error;
    }
    error = posix_spawn_file_actions_init(&actions);
    if (error != 0) {
        posix_spawnattr_destroy(&attributes);
        return error;
    }
    error = posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    error = error != 0 ? error : posix_spawnattr_setpgroup(&attributes, 0);
    error = error != 0 ? error : posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    if (error == 0) {
        error = posix_spawnp(process, arguments[0], &actions, &attributes, arguments, environ);
    }
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return error;
}

/* Neither end may stay open in ffmpeg (it would never see the end of its input) nor in what else is started. */
static int make_pipe(int ends[2]) {
    if (pipe(ends) != 0) {
        return errno;
    }
    if (fcntl(ends[0], F_SETFD, FD_CLOEXEC) != 0 || fcntl(ends[1], F_SETFD, FD_CLOEXEC) != 0) {
        int error = errno;
        close(ends[0]);
        close(ends[1]);
        return error;
    }
    return 0;
}

static int start_with_pipe(Video *video, char *const arguments[]) {
    int   ends[2];
    int   error = make_pipe(ends);
    pid_t process = 0;
    if (error != 0) {
        return error;
    }
    /* A write to an ffmpeg that has ended shall fail, not end this program. */
    signal(SIGPIPE, SIG_IGN);
    /* Where a parent had SIGCHLD ignored, as some job servers do, nobody would be told how ffmpeg ended. */
    signal(SIGCHLD, SIG_DFL);
    error = start(&process, ends[0], arguments);
    close(ends[0]);
    if (error != 0) {
        close(ends[1]);
        return error;
    }
    video->process = (long)process;
    video->pipe = ends[1];
    return 0;
}

/* Whether the path ends so, in any case. */
static int ends_in(const char *path, const char *ending) {
    const size_t length = strlen(path), most = strlen(ending);
    for (size_t i = 1; i <= most; i++) {
        if (i > length || tolower((unsigned char)path[length - i]) != ending[most - i]) {
            return 0;
        }
    }
    return 1;
}

int video_open(Video *video, const char *path, uint32_t width, uint32_t height, double rate) {
    char   frame_size[32], frame_rate[32], keyframes[16];
    size_t length = strlen(path) + sizeof "file:";
    char  *file = malloc(length);
    if (file == NULL) {
        fprintf(stderr, "cannot make a video: no memory for its name\n");
        return 0;
    }
    snprintf(frame_size, sizeof frame_size, "%ux%u", (unsigned)width, (unsigned)height);
    snprintf(frame_rate, sizeof frame_rate, "%.10g", rate);
    snprintf(keyframes, sizeof keyframes, "%.0f", rate < 1.0 ? 1.0 : rate > 600.0 ? 600.0 : rate);
    /* "file:" keeps ffmpeg from reading a protocol or an option into the name. Most players want 4:2:0; the primaries
     * of sRGB are those of Rec. 709. Each second begins with a keyframe. */
    snprintf(file, length, "file:%s", path);
    char *arguments[32] = {"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y",
                           "-f", "rawvideo", "-pixel_format", "rgba", "-video_size", frame_size,
                           "-framerate", frame_rate, "-i", "pipe:0",
                           "-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
                           "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1",
                           "-g", keyframes, "-flush_packets", "1"}; /* those behind are NULL */
    size_t count = 0;
    while (arguments[count] != NULL) {
        count++;
    }
    /* MP4's index comes last, and without it nothing plays: in fragments, one a second, the file is whole up to the
     * last one, even if ffmpeg was killed. */
    if (ends_in(path, ".mp4") || ends_in(path, ".mov") || ends_in(path, ".m4v")) {
        arguments[count++] = "-movflags";
        arguments[count++] = "+frag_keyframe+empty_moov+default_base_moof";
    }
    arguments[count] = file;
    int error = start_with_pipe(video, arguments);
    free(file);
    if (error == ENOENT) {
        fprintf(stderr, "cannot make a video: ffmpeg was not found; install it, or make pictures without --video\n");
    } else if (error != 0) {
        fprintf(stderr, "cannot make a video: ffmpeg did not start: %s\n", strerror(error));
    }
    return error == 0;
}

int video_add(Video *video, const BhrImage *image) {
    const char *bytes = image->pixels;
    size_t      left = 4 * (size_t)image->width * image->height;
    while (left > 0) {
        ssize_t written = write(video->pipe, bytes, left);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            fprintf(stderr, "cannot add a frame to the video: %s\n", strerror(errno));
            return 0;
        }
        bytes += written;
        left -= (size_t)written;
    }
    return 1;
}

int video_close(Video *video) {
    int status = 0;
    close(video->pipe);
    while (waitpid((pid_t)video->process, &status, 0) < 0) {
        if (errno != EINTR) {
            fprintf(stderr, "cannot wait for ffmpeg: %s\n", strerror(errno));
            return 0;
        }
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fprintf(stderr, "ffmpeg failed; what it said is above\n");
        return 0;
    }
    return 1;
}

#endif
