/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* common.h -- what the example programs, in C and C++, share: names of constants, a clock, reports of failures. Needs
 * libc and bhr.h only; knows no scene and makes no frame. */
#ifndef EXAMPLES_COMMON_H
#define EXAMPLES_COMMON_H

#include <bhr.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))
#define PI 3.14159265358979323846

/* Exit statuses: 0, EXIT_FAILURE (1) when something could not be done, EXIT_USAGE when the command line is wrong. */
#define EXIT_USAGE 2

typedef struct Choice {
    const char *name;
    int32_t     value;
} Choice;

/* ---- names: all lists are in fields.c ---- */
extern const Choice BACKENDS[], PROJECTIONS[], MOTIONS[], EYES[], PRESETS[], PRESET_MATTERS[], METHODS[],
    VOLUME_RESOLUTIONS[], VIEWS[], TONE_MAPS[], COLOUR_MAPS[];
const char *choice_name(const Choice *choices, int32_t value); /* "?" for none of them */

/* ---- reports ---- */
/* Says on stderr what could not be done and why; returns EXIT_FAILURE. Call it on the thread of the failed call. */
int  report_failure(const char *what, BhrStatus status);
void log_to_stderr(void *user, BhrLogLevel level, const char *message); /* a BhrLogFn */
void print_adapter(FILE *out, const BhrAdapterInfo *info);              /* one line without its end */
/* Where AUTO found no GPU: says so, and what to install. Lines that begin with `indent`; nothing for a GPU. */
void print_driver_advice(FILE *out, const BhrAdapterInfo *info, const char *indent);

/* A context with the defaults and this backend. */
BhrStatus create_context_on(BhrBackend backend, BhrContext **out);
/* A context with the defaults on the adapter of another one: what takes long there leaves that one free. */
BhrStatus create_context_beside(const BhrAdapterInfo *adapter, BhrContext **out);

/* ---- a bar on stderr, while something takes long ---- */
typedef struct Progress {
    int    shown;   /* 0: never drawn */
    int    percent; /* drawn last; -1: nothing drawn yet */
    double begin;   /* of wall_seconds */
    double drawn;   /* when, by the same clock */
    int    width;   /* columns that are drawn on */
} Progress;

Progress progress_begin(int shown);
void     progress_draw(Progress *progress, double fraction); /* nothing in the first half second */
/* Draws how many of all frames are done, how many a second, and the time that is left. `made`: frames since
 * progress_begin, with the finished share of the next one; `before`: frames that were there then. */
void progress_draw_frames(Progress *progress, double made, uint32_t before, uint32_t all);
void progress_clear(Progress *progress); /* takes the bar off the line */

/* ---- the process ---- */
void     say_at_once(void);             /* stdout can be read while the program runs, from a file too; call it first */
int      end_output(int result);        /* an exit status: EXIT_FAILURE instead of 0 when stdout cannot be written */
double   wall_seconds(void);            /* monotonic; only differences mean something */
uint32_t cores(void);                   /* 1 or more; a guess where the system does not tell */
int      is_terminal(FILE *stream);
/* From now on SIGINT, which is Ctrl-C, and SIGTERM are only noted. A signal that was ignored at the start, as shells
 * do with SIGINT for what runs in the background, stays ignored. A second Ctrl-C ends the program at once. */
void     note_signals(void);
int      noted_signal(void); /* the first one's number; 0: none came */
void     program_folder(char *out, size_t size); /* its file's; "." where the system does not tell */
int      make_folder(const char *path); /* 1; 0 with errno when it could not be made, EEXIST when there is one */
/* All of a file as text, to be given back by free(). NULL with errno, which is ENOENT where there is no file. */
char    *read_text(const char *path);

#ifdef __cplusplus
}
#endif

#endif
