/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* options.h -- command lines as tables: a program lists what it takes, one line each, and the table reads the arguments
 * and prints --help. Knows no scene; scene_options.h has the table of those. */
#ifndef EXAMPLES_OPTIONS_H
#define EXAMPLES_OPTIONS_H

#include "common.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum OptionKind {  /* what Option.target points to */
    OPTION_FLAG,           /* int: becomes 1; takes no value */
    OPTION_UNFLAG,         /* int: becomes 0; takes no value */
    OPTION_BIT,            /* uint32_t: gets the bit of the first of `choices`; takes no value */
    OPTION_DOUBLE,         /* double */
    OPTION_DEGREES,        /* double: radians, written in degrees */
    OPTION_PAIR,           /* double[2], written X,Y */
    OPTION_VECTOR,         /* double[3], written X,Y,Z */
    OPTION_FOUR,           /* double[4], written A,B,C,D */
    OPTION_UINT,           /* uint32_t */
    OPTION_UINT64,         /* uint64_t */
    OPTION_SIZE,           /* uint32_t[2], written WxH */
    OPTION_CHOICE,         /* int32_t: the value of one of `choices` */
    OPTION_BITS,           /* uint32_t: the bits of some of `choices`, written with commas, or "none" */
    OPTION_TEXT,           /* const char *: the argument itself */
    OPTION_TEXTS           /* TextList: one argument more; the option may be given again */
} OptionKind;

#define MOST_TEXTS 8u

/* The arguments of an option that may be given again, in their order. */
typedef struct TextList {
    const char *list[MOST_TEXTS];
    size_t      count;
} TextList;

typedef struct Option {
    const char   *name;    /* with its dashes */
    OptionKind    kind;
    void         *target;  /* holds the default; written only when the option is given */
    const char   *value;   /* what --help calls the value; NULL for flags and choices */
    const char   *help;
    const Choice *choices; /* of CHOICE, BIT and BITS: ends with a NULL name; else NULL */
    const char   *range;   /* of numbers, for --help; NULL: said in `help`, or none */
} Option;

/* Reads `--name value` and `--name=value`. 0, or EXIT_USAGE after a message on stderr. Ranges are left to the
 * library, whose messages name them. */
int options_parse(const Option *options, size_t count, int argc, char **argv);

/* Each with its value, its help, its range and what its target holds, the default. UINT32_MAX, NaN, NULL and numbers
 * of no choice are no defaults. */
void options_print(FILE *out, const Option *options, size_t count);

/* Words on lines of their own, of at most 120 columns, each behind 8 blanks; the last one is not ended. */
void options_print_help(FILE *out, const char *words);

/* Puts the number that `text` begins with into *out and returns where it ends; NULL when there is none or it
 * overflows. */
const char *option_read_double(const char *text, double *out);

/* 1 when all of `text` is a whole number from 0 on that fits; only then is anything written. */
int option_read_uint64(const char *text, uint64_t *out);

#ifdef __cplusplus
}
#endif

#endif
