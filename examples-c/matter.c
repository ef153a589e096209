/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* matter.c -- see matter.h. */
#include "matter.h"

#include <stdlib.h>
#include <string.h>

#define MOST_ITEM 96 /* characters of FIELD=X */

typedef enum FieldKind {
    FIELD_WORD,    /* uint32_t: gets the bit of the first of `choices`; the word alone, without a value */
    FIELD_NO_WORD, /* the same; takes the bit away */
    FIELD_CHOICE,  /* int32_t: the value of one of `choices` */
    FIELD_DOUBLE,  /* double */
    FIELD_DEGREES, /* double: radians, written in degrees */
    FIELD_COLOUR,  /* double[3], written R/G/B */
    FIELD_UINT64   /* uint64_t */
} FieldKind;

typedef struct Field {
    const char   *name;
    FieldKind     kind;
    size_t        offset;
    const Choice *choices;
} Field;

const Choice VOLUME_KINDS[] = {{"disk", BHR_VOLUME_DISK}, {"torus", BHR_VOLUME_TORUS}, {"halo", BHR_VOLUME_HALO},
                               {"jet", BHR_VOLUME_JET},   {NULL, 0}};
static const Choice FLOWS[] = {{"keplerian", BHR_FLOW_KEPLERIAN}, {"angular-momentum", BHR_FLOW_ANGULAR_MOMENTUM},
                               {"outflow", BHR_FLOW_OUTFLOW},     {NULL, 0}};
static const Choice VOLUME_RETROGRADE[] = {{"retrograde", BHR_VOLUME_RETROGRADE}, {NULL, 0}};
static const Choice POWER_LAW[] = {{"power-law", BHR_VOLUME_POWER_LAW}, {NULL, 0}};
static const Choice SPOT_RETROGRADE[] = {{"retrograde", BHR_HOT_SPOT_RETROGRADE}, {NULL, 0}};
static const Choice THERMAL[] = {{"thermal", BHR_HOT_SPOT_THERMAL}, {NULL, 0}};

#define OF_VOLUME(member) offsetof(BhrVolume, member)
#define OF_SPOT(member) offsetof(BhrHotSpot, member)

/* A new field of a struct of the library is one line here. */
static const Field VOLUME_FIELDS[] = {
    {"retrograde", FIELD_WORD, OF_VOLUME(flags), VOLUME_RETROGRADE},
    {"power-law", FIELD_WORD, OF_VOLUME(flags), POWER_LAW},
    {"thermal", FIELD_NO_WORD, OF_VOLUME(flags), POWER_LAW},
    {"flow", FIELD_CHOICE, OF_VOLUME(flow), FLOWS},
    {"inner-radius", FIELD_DOUBLE, OF_VOLUME(inner_radius), NULL},
    {"outer-radius", FIELD_DOUBLE, OF_VOLUME(outer_radius), NULL},
    {"radius", FIELD_DOUBLE, OF_VOLUME(radius), NULL},
    {"width", FIELD_DOUBLE, OF_VOLUME(width), NULL},
    {"thickness", FIELD_DOUBLE, OF_VOLUME(thickness), NULL},
    {"opening", FIELD_DEGREES, OF_VOLUME(opening), NULL},
    {"slope", FIELD_DOUBLE, OF_VOLUME(slope), NULL},
    {"absorption", FIELD_DOUBLE, OF_VOLUME(absorption), NULL},
    {"temperature", FIELD_DOUBLE, OF_VOLUME(temperature), NULL},
    {"temperature-slope", FIELD_DOUBLE, OF_VOLUME(temperature_slope), NULL},
    {"spectral-index", FIELD_DOUBLE, OF_VOLUME(spectral_index), NULL},
    {"tint", FIELD_COLOUR, OF_VOLUME(tint), NULL},
    {"brightness", FIELD_DOUBLE, OF_VOLUME(brightness), NULL},
    {"sub-keplerian", FIELD_DOUBLE, OF_VOLUME(sub_keplerian), NULL},
    {"infall", FIELD_DOUBLE, OF_VOLUME(infall), NULL},
    {"angular-momentum", FIELD_DOUBLE, OF_VOLUME(angular_momentum), NULL},
    {"speed", FIELD_DOUBLE, OF_VOLUME(speed), NULL},
    {"turbulence", FIELD_DOUBLE, OF_VOLUME(turbulence), NULL},
    {"clumping", FIELD_DOUBLE, OF_VOLUME(clumping), NULL},
    {"heating", FIELD_DOUBLE, OF_VOLUME(heating), NULL},
    {"seed", FIELD_UINT64, OF_VOLUME(seed), NULL},
};

static const Field HOT_SPOT_FIELDS[] = {
    {"retrograde", FIELD_WORD, OF_SPOT(flags), SPOT_RETROGRADE},
    {"thermal", FIELD_WORD, OF_SPOT(flags), THERMAL},
    {"radius", FIELD_DOUBLE, OF_SPOT(radius), NULL},
    {"size", FIELD_DOUBLE, OF_SPOT(size), NULL},
    {"azimuth", FIELD_DEGREES, OF_SPOT(azimuth), NULL},
    {"absorption", FIELD_DOUBLE, OF_SPOT(absorption), NULL},
    {"temperature", FIELD_DOUBLE, OF_SPOT(temperature), NULL},
    {"spectral-index", FIELD_DOUBLE, OF_SPOT(spectral_index), NULL},
    {"tint", FIELD_COLOUR, OF_SPOT(tint), NULL},
    {"brightness", FIELD_DOUBLE, OF_SPOT(brightness), NULL},
};

/* ---- values ---- */

static const Choice *find_choice(const Choice *choices, const char *text) {
    for (; choices->name != NULL; choices++) {
        if (strcmp(choices->name, text) == 0) {
            return choices;
        }
    }
    return NULL;
}

/* 1 when all of `text` is `count` numbers with slashes between them. */
static int read_numbers(const char *text, int count, double *out) {
    double value[3];
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
    if ((value == NULL) != (field->kind == FIELD_WORD || field->kind == FIELD_NO_WORD)) {
        return 0;
    }
    switch (field->kind) {
    case FIELD_WORD:
        *(uint32_t *)(void *)target |= (uint32_t)field->choices[0].value;
        return 1;
    case FIELD_NO_WORD:
        *(uint32_t *)(void *)target &= ~(uint32_t)field->choices[0].value;
        return 1;
    case FIELD_CHOICE:
        choice = find_choice(field->choices, value);
        if (choice != NULL) {
            *(int32_t *)(void *)target = choice->value;
        }
        return choice != NULL;
    case FIELD_UINT64:
        return option_read_uint64(value, (uint64_t *)(void *)target);
    case FIELD_COLOUR:
        return read_numbers(value, 3, (double *)(void *)target);
    case FIELD_DOUBLE:
    case FIELD_DEGREES:
        if (!read_numbers(value, 1, &number)) {
            return 0;
        }
        *(double *)(void *)target = field->kind == FIELD_DEGREES ? number * PI / 180.0 : number;
        return 1;
    }
    return 0;
}

static void print_value_name(FILE *out, const Field *field) {
    switch (field->kind) {
    case FIELD_WORD:
    case FIELD_NO_WORD: fputs("no value", out); return;
    case FIELD_COLOUR: fputs("R/G/B", out); return;
    case FIELD_UINT64: fputs("a whole number", out); return;
    case FIELD_DEGREES: fputs("degrees", out); return;
    case FIELD_DOUBLE: fputs("a number", out); return;
    case FIELD_CHOICE: break;
    }
    for (const Choice *choice = field->choices; choice->name != NULL; choice++) {
        fprintf(out, "%s%s", choice == field->choices ? "" : "|", choice->name);
    }
}

/* ---- texts ---- */

static int refuse_field(const char *name, const char *text, const char *item, const Field *fields, size_t count) {
    fprintf(stderr, "%s '%s': there is no field '%s'; the fields are", name, text, item);
    for (size_t i = 0; i < count; i++) {
        fprintf(stderr, " %s", fields[i].name);
    }
    fputc('\n', stderr);
    return EXIT_USAGE;
}

/* One FIELD=X, or a word. 0, or EXIT_USAGE after a message with all of the option's text. */
static int read_item(const char *name, const char *text, char *item, const Field *fields, size_t count, void *out) {
    char *value = strchr(item, '=');
    if (value != NULL) {
        *value++ = '\0';
    }
    for (size_t i = 0; i < count; i++) {
        if (strcmp(fields[i].name, item) == 0) {
            if (read_value(&fields[i], value, out)) {
                return 0;
            }
            fprintf(stderr, "%s '%s': '%s' is no value for %s, which takes ", name, text, value != NULL ? value : "",
                    item);
            print_value_name(stderr, &fields[i]);
            fputc('\n', stderr);
            return EXIT_USAGE;
        }
    }
    return refuse_field(name, text, item, fields, count);
}

/* Items with commas between them, from `rest`, a part of `text`, on. */
static int read_items(const char *name, const char *text, const char *rest, const Field *fields, size_t count,
                      void *out) {
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
        const int result = read_item(name, text, item, fields, count, out);
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
                                        : read_items(name, text, text + length + 1, VOLUME_FIELDS,
                                                     COUNT_OF(VOLUME_FIELDS), out);
        }
    }
    fprintf(stderr, "%s '%s': it begins with disk, torus, halo or jet\n", name, text);
    return EXIT_USAGE;
}

int hot_spot_read(const char *name, const char *text, BhrHotSpot *out) {
    const BhrStatus status = bhr_hot_spot_init(out, sizeof *out);
    return status < 0 ? report_failure("begin a hot spot", status)
                      : read_items(name, text, text, HOT_SPOT_FIELDS, COUNT_OF(HOT_SPOT_FIELDS), out);
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
