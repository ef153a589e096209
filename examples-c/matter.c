/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* matter.c -- see matter.h. */
#include "matter.h"

#include "fields.h"

#include <stdlib.h>
#include <string.h>

#define MOST_ITEM 96 /* characters of FIELD=X */

/* A word that takes a bit away; the fields' own words give one. */
typedef struct Unword {
    const char *name, *about;
    size_t      offset;
    uint32_t    bit;
} Unword;

/* A struct as text: its fields, and a word more where it has one. */
typedef struct Syntax {
    const Field  *fields;
    const Choice *first;  /* of the field that its text begins with, which no key sets; NULL: none */
    const Unword *unword; /* NULL: none */
} Syntax;

static const Unword THERMAL = {"thermal", "the light is a blackbody's: takes power-law back",
                               offsetof(BhrVolume, flags), BHR_VOLUME_POWER_LAW};
static const Syntax VOLUME = {VOLUME_FIELDS, VOLUME_KINDS, &THERMAL};
static const Syntax HOT_SPOT = {HOT_SPOT_FIELDS, NULL, NULL};

/* ---- values ---- */

static const Choice *find_choice(const Choice *choices, const char *text) {
    for (; choices->name != NULL; choices++) {
        if (strcmp(choices->name, text) == 0) {
            return choices;
        }
    }
    return NULL;
}

/* 1 when all of `text` is `count` numbers, four at most, with slashes between them. */
static int read_numbers(const char *text, int count, double *out) {
    double value[4];
    for (int i = 0; i < count; i++) {
        text = option_read_double(text, &value[i]);
        if (text == NULL || *text != (i + 1 < count ? '/' : '\0')) {
            return 0;
        }
        text++;
    }
    memcpy(out, value, (size_t)count * sizeof *value);
    return 1;
}

/* `value`: NULL for a word alone. 1 when it is one of the field's; only then is anything written. */
static int read_value(const Field *field, const char *value, void *out) {
    char         *target = (char *)out + field->offset;
    const Choice *choice;
    double        number;
    uint64_t      whole;
    if ((value == NULL) != (field->kind == OPTION_BIT)) {
        return 0;
    }
    switch (field->kind) {
    case OPTION_BIT:
        *(uint32_t *)(void *)target |= (uint32_t)field->choices[0].value;
        return 1;
    case OPTION_CHOICE:
        choice = find_choice(field->choices, value);
        if (choice != NULL) {
            *(int32_t *)(void *)target = choice->value;
        }
        return choice != NULL;
    case OPTION_UINT:
        if (!option_read_uint64(value, &whole) || whole > UINT32_MAX) {
            return 0;
        }
        *(uint32_t *)(void *)target = (uint32_t)whole;
        return 1;
    case OPTION_UINT64:
        return option_read_uint64(value, (uint64_t *)(void *)target);
    case OPTION_PAIR:
        return read_numbers(value, 2, (double *)(void *)target);
    case OPTION_VECTOR:
        return read_numbers(value, 3, (double *)(void *)target);
    case OPTION_FOUR:
        return read_numbers(value, 4, (double *)(void *)target);
    case OPTION_DOUBLE:
    case OPTION_DEGREES:
        if (!read_numbers(value, 1, &number)) {
            return 0;
        }
        *(double *)(void *)target = field->kind == OPTION_DEGREES ? number * PI / 180.0 : number;
        return 1;
    default:
        return 0;
    }
}

static void print_value_name(FILE *out, const Field *field) {
    switch (field->kind) {
    case OPTION_BIT: fputs("no value", out); return;
    case OPTION_PAIR: fputs("X/Y", out); return;
    case OPTION_VECTOR: fputs("R/G/B", out); return;
    case OPTION_FOUR: fputs("X/Y/Z/W", out); return;
    case OPTION_UINT:
    case OPTION_UINT64: fputs("a whole number", out); return;
    case OPTION_DEGREES: fputs("degrees", out); return;
    case OPTION_CHOICE: break;
    default: fputs("a number", out); return;
    }
    for (const Choice *choice = field->choices; choice->name != NULL; choice++) {
        fprintf(out, "%s%s", choice == field->choices ? "" : "|", choice->name);
    }
}

/* ---- texts ---- */

static int is_key(const Syntax *syntax, const Field *field) {
    return syntax->first == NULL || field->choices != syntax->first;
}

/* Says what keys there are, with what bhr.h says of each. */
static int refuse_field(const char *name, const char *text, const char *item, const Syntax *syntax) {
    fprintf(stderr, "%s '%s': there is no field '%s'; the fields are\n", name, text, item);
    for (const Field *field = syntax->fields; field->option != NULL; field++) {
        if (is_key(syntax, field)) {
            fprintf(stderr, "  %s: ", FIELD_NAME(field));
            print_value_name(stderr, field);
            options_print_help(stderr, field->about);
            if (field->range != NULL && strstr(field->about, " .. ") == NULL) {
                fprintf(stderr, "; %s", field->range);
            }
            fputc('\n', stderr);
        }
    }
    if (syntax->unword != NULL) {
        fprintf(stderr, "  %s: no value\n        %s\n", syntax->unword->name, syntax->unword->about);
    }
    return EXIT_USAGE;
}

static int refuse_value(const char *name, const char *text, const char *item, const char *value) {
    fprintf(stderr, "%s '%s': '%s' is no value for %s, which takes ", name, text, value != NULL ? value : "", item);
    return EXIT_USAGE;
}

/* One FIELD=X, or a word. 0, or EXIT_USAGE after a message with all of the option's text. */
static int read_item(const char *name, const char *text, char *item, const Syntax *syntax, void *out) {
    const Unword *unword = syntax->unword;
    char         *value = strchr(item, '=');
    if (value != NULL) {
        *value++ = '\0';
    }
    for (const Field *field = syntax->fields; field->option != NULL; field++) {
        if (is_key(syntax, field) && strcmp(FIELD_NAME(field), item) == 0) {
            if (read_value(field, value, out)) {
                return 0;
            }
            const int result = refuse_value(name, text, item, value);
            print_value_name(stderr, field);
            fputc('\n', stderr);
            return result;
        }
    }
    if (unword != NULL && strcmp(unword->name, item) == 0) {
        if (value != NULL) {
            const int result = refuse_value(name, text, item, value);
            fputs("no value\n", stderr);
            return result;
        }
        *(uint32_t *)(void *)((char *)out + unword->offset) &= ~unword->bit;
        return 0;
    }
    return refuse_field(name, text, item, syntax);
}

/* Items with commas between them, from `rest`, a part of `text`, on. */
static int read_items(const char *name, const char *text, const char *rest, const Syntax *syntax, void *out) {
    for (;;) {
        char         item[MOST_ITEM + 1];
        const size_t length = strcspn(rest, ",");
        if (length > MOST_ITEM) {
            fprintf(stderr, "%s '%s': a field and its value have %u characters; %d is most\n", name, text,
                    (unsigned)length, MOST_ITEM);
            return EXIT_USAGE;
        }
        memcpy(item, rest, length);
        item[length] = '\0';
        const int result = read_item(name, text, item, syntax, out);
        if (result != 0 || rest[length] == '\0') {
            return result;
        }
        rest += length + 1;
    }
}

BhrStatus volume_begin(BhrVolume *volume, BhrVolumeShape kind) {
    BhrStatus status = bhr_volume_init(volume, sizeof *volume);
    if (status < 0) {
        return status;
    }
    volume->shape = kind;
    switch (kind) {
    case BHR_VOLUME_TORUS:
        volume->radius = 9.0;
        volume->width = 2.5;
        volume->thickness = 0.2;
        volume->absorption = 0.12;
        volume->brightness = 0.6;
        volume->outer_radius = 40.0;
        break;
    case BHR_VOLUME_HALO:
        volume->thickness = 0.5;
        volume->absorption = 0.05;
        volume->brightness = 0.6;
        volume->radius = 6.0;
        volume->outer_radius = 40.0;
        break;
    case BHR_VOLUME_JET:
        volume->flow = BHR_FLOW_OUTFLOW;
        volume->inner_radius = 3.0;
        volume->outer_radius = 60.0;
        volume->thickness = 0.02;
        volume->opening = 0.35;
        volume->slope = 1.2;
        volume->flags = BHR_VOLUME_POWER_LAW; /* thermal matter as thin as this shines too little */
        volume->absorption = 0.002;
        volume->spectral_index = 0.7;
        volume->brightness = 0.15;
        volume->speed = 0.8;
        volume->tint[0] = 0.45;
        volume->tint[1] = 0.65;
        break;
    default:
        break;
    }
    return BHR_OK;
}

int volume_read(const char *name, const char *text, double turbulence, BhrVolume *out) {
    const size_t length = strcspn(text, ",");
    for (const Choice *kind = VOLUME_KINDS; kind->name != NULL; kind++) {
        if (strlen(kind->name) == length && strncmp(kind->name, text, length) == 0) {
            const BhrStatus status = volume_begin(out, kind->value);
            if (status < 0) {
                return report_failure("begin a volume", status);
            }
            out->turbulence = turbulence;
            return text[length] == '\0' ? 0
                                        : read_items(name, text, text + length + 1, &VOLUME, out);
        }
    }
    fprintf(stderr, "%s '%s': it begins with disk, torus, halo or jet\n", name, text);
    return EXIT_USAGE;
}

int hot_spot_read(const char *name, const char *text, BhrHotSpot *out) {
    const BhrStatus status = bhr_hot_spot_init(out, sizeof *out);
    return status < 0 ? report_failure("begin a hot spot", status)
                      : read_items(name, text, text, &HOT_SPOT, out);
}

static int count_texts(const char *name, const TextList *texts, uint32_t most) {
    if (texts->count <= most) {
        return 0;
    }
    fprintf(stderr, "%s is given %u times; %u is most\n", name, (unsigned)texts->count, (unsigned)most);
    return EXIT_USAGE;
}

int volumes_read(const char *name, const TextList *texts, double turbulence, BhrVolume *out, uint32_t most,
                 uint32_t *out_count) {
    int result = count_texts(name, texts, most);
    for (size_t i = 0; result == 0 && i < texts->count; i++) {
        result = volume_read(name, texts->list[i], turbulence, &out[i]);
    }
    *out_count = result == 0 ? (uint32_t)texts->count : 0;
    return result;
}

int hot_spots_read(const char *name, const TextList *texts, BhrHotSpot *out, uint32_t most, uint32_t *out_count) {
    int result = count_texts(name, texts, most);
    for (size_t i = 0; result == 0 && i < texts->count; i++) {
        result = hot_spot_read(name, texts->list[i], &out[i]);
    }
    *out_count = result == 0 ? (uint32_t)texts->count : 0;
    return result;
}
