/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* fields.h -- the fields of structs that a scene has, as options, keys of texts and widgets show them. fields.c is
 * generated from bhr.json, so that a new field of the library is here without a line of anybody's. */
#ifndef EXAMPLES_FIELDS_H
#define EXAMPLES_FIELDS_H

#include "options.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A field, or one bit of a field (OPTION_BIT) that begins without any. */
typedef struct Field {
    const char   *option;    /* its name with - for _, after two dashes */
    OptionKind    kind;
    size_t        offset;    /* in its struct */
    const char   *unit;      /* NULL: none */
    double        low, high; /* the values that the library takes; both 0: bhr.h has no range in numbers */
    const char   *range;     /* the same as text, of angles in degrees, or NULL */
    const char   *about;     /* bhr.h's first sentence of it, without the stop */
    const Choice *choices;   /* as an Option has them; of a BIT that one alone counts */
} Field;

/* The end of a list has no `option`. */
extern const Field DISK_FIELDS[], VOLUME_FIELDS[], HOT_SPOT_FIELDS[], SKY_FIELDS[], FILM_FIELDS[], QUALITY_FIELDS[];

/* A field's name as keys have it. */
#define FIELD_NAME(field) ((field)->option + 2)

#ifdef __cplusplus
}
#endif

#endif
