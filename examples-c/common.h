/* common.h -- what the example programs, in C and C++, share: a table of command-line options, names of constants, a
 * clock, reports of failures. Needs libc and bhr.h only; knows no scene and makes no frame. */
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

/* ---- command line ---- */
typedef struct Choice {
    const char *name;
    int32_t     value;
} Choice;

typedef enum OptionKind {  /* what Option.target points to */
    OPTION_FLAG,           /* int: becomes 1; takes no value */
    OPTION_DOUBLE,         /* double */
    OPTION_VECTOR,         /* double[3], written x,y,z */
    OPTION_UINT,           /* uint32_t */
    OPTION_SIZE,           /* uint32_t[2], written WxH */
    OPTION_CHOICE,         /* int32_t: the value of one of `choices` */
    OPTION_TEXT            /* const char *: the argument itself */
} OptionKind;

typedef struct Option {
    const char   *name;    /* with its dashes */
    OptionKind    kind;
    void         *target;  /* holds the default; written only when the option is given */
    const char   *value;   /* what --help calls the value; NULL for flags and choices */
    const char   *help;
    const Choice *choices; /* OPTION_CHOICE: ends with a NULL name; else NULL */
} Option;

/* Reads `--name value` and `--name=value`. 0, or EXIT_USAGE after a message on stderr. Ranges are left to the
 * library, whose messages name them. */
int  options_parse(const Option *options, size_t count, int argc, char **argv);
void options_print(FILE *out, const Option *options, size_t count);

/* ---- names ---- */
extern const Choice BACKENDS[], METHODS[], MOTIONS[], TONE_MAPS[];
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

/* ---- the process ---- */
int      end_output(int result);        /* an exit status: EXIT_FAILURE instead of 0 when stdout cannot be written */
double   wall_seconds(void);            /* monotonic; only differences mean something */
uint32_t cores(void);                   /* 1 or more; a guess where the system does not tell */
int      is_terminal(FILE *stream);
int      make_folder(const char *path); /* 1; 0 with errno when it could not be made, EEXIST when there is one */

#ifdef __cplusplus
}
#endif

#endif
