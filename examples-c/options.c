/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* options.c -- see options.h. */
#include "options.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- values ---- */

/* strtod alone would skip leading blanks. */
const char *option_read_double(const char *text, double *out) {
    char *end;
    if (isspace((unsigned char)text[0])) {
        return NULL;
    }
    errno = 0;
    double value = strtod(text, &end);
    /* Underflow sets ERANGE too, but gives a usable number. */
    if (end == text || (errno == ERANGE && (value > 1.0 || value < -1.0))) {
        return NULL;
    }
    *out = value;
    return end;
}

/* Reads a whole number up to `most`, digits only: strtoull alone would take "-1" for a large number. Returns
 * the end of the number, or NULL. */
static const char *read_whole(const char *text, uint64_t most, uint64_t *out) {
    char *end;
    if (!isdigit((unsigned char)text[0])) {
        return NULL;
    }
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    if (errno == ERANGE || value > most) {
        return NULL;
    }
    *out = value;
    return end;
}

int option_read_uint64(const char *text, uint64_t *out) {
    uint64_t    value;
    const char *end = read_whole(text, UINT64_MAX, &value);
    if (end == NULL || *end != '\0') {
        return 0;
    }
    *out = value;
    return 1;
}

static const char *read_uint(const char *text, uint32_t *out) {
    uint64_t value;
    text = read_whole(text, UINT32_MAX, &value);
    if (text != NULL) {
        *out = (uint32_t)value;
    }
    return text;
}

/* How many numbers a value has that is numbers with commas between them; 0: it is none. */
static int number_count(OptionKind kind) {
    switch (kind) {
    case OPTION_DOUBLE:
        return 1;
    case OPTION_PAIR:
        return 2;
    case OPTION_VECTOR:
        return 3;
    case OPTION_FOUR:
        return 4;
    default:
        return 0;
    }
}

/* Reads `count` numbers, four at most, with commas between them. */
static int read_numbers(const char *text, int count, double *out) {
    double value[4];
    for (int i = 0; i < count; i++) {
        text = option_read_double(text, &value[i]);
        if (text == NULL || *text != (i + 1 < count ? ',' : '\0')) {
            return 0;
        }
        text++;
    }
    memcpy(out, value, (size_t)count * sizeof *value);
    return 1;
}

static int read_size(const char *text, uint32_t out[2]) {
    uint32_t value[2];
    text = read_uint(text, &value[0]);
    if (text == NULL || *text != 'x') {
        return 0;
    }
    text = read_uint(text + 1, &value[1]);
    if (text == NULL || *text != '\0') {
        return 0;
    }
    memcpy(out, value, sizeof value);
    return 1;
}

static const Choice *find_choice(const Choice *choices, const char *text, size_t length) {
    for (; choices->name != NULL; choices++) {
        if (strlen(choices->name) == length && strncmp(text, choices->name, length) == 0) {
            return choices;
        }
    }
    return NULL;
}

static int read_bits(const char *text, const Choice *choices, uint32_t *out) {
    uint32_t bits = 0;
    while (strcmp(text, "none") != 0) {
        const size_t  length = strcspn(text, ",");
        const Choice *choice = find_choice(choices, text, length);
        if (choice == NULL) {
            return 0;
        }
        bits |= (uint32_t)choice->value;
        if (text[length] == '\0') {
            break;
        }
        text += length + 1;
    }
    *out = bits;
    return 1;
}

static int add_text(TextList *texts, const char *text) {
    if (texts->count == MOST_TEXTS) {
        return 0;
    }
    texts->list[texts->count++] = text;
    return 1;
}

/* 1 when all of `text` is a value of the option's kind; only then is the target written. */
static int read_value(const Option *option, const char *text) {
    const char   *end;
    const Choice *choice;
    double        number;
    uint32_t      whole;
    switch (option->kind) {
    case OPTION_DEGREES:
        end = option_read_double(text, &number);
        if (end == NULL || *end != '\0') {
            return 0;
        }
        *(double *)option->target = number * PI / 180.0;
        return 1;
    case OPTION_UINT:
        end = read_uint(text, &whole);
        if (end == NULL || *end != '\0') {
            return 0;
        }
        *(uint32_t *)option->target = whole;
        return 1;
    case OPTION_UINT64:
        return option_read_uint64(text, option->target);
    case OPTION_DOUBLE:
    case OPTION_PAIR:
    case OPTION_VECTOR:
    case OPTION_FOUR:
        return read_numbers(text, number_count(option->kind), option->target);
    case OPTION_SIZE:
        return read_size(text, option->target);
    case OPTION_CHOICE:
        choice = find_choice(option->choices, text, strlen(text));
        if (choice == NULL) {
            return 0;
        }
        *(int32_t *)option->target = choice->value;
        return 1;
    case OPTION_BITS:
        return read_bits(text, option->choices, option->target);
    case OPTION_TEXT:
        *(const char **)option->target = text;
        return text[0] != '\0';
    case OPTION_TEXTS:
        return text[0] != '\0' && add_text(option->target, text);
    case OPTION_FLAG:
    case OPTION_UNFLAG:
    case OPTION_BIT:
        break;
    }
    return 0;
}

/* Applies an option that takes no value; 0 if it takes one. */
static int read_no_value(const Option *option) {
    switch (option->kind) {
    case OPTION_FLAG:
        *(int *)option->target = 1;
        return 1;
    case OPTION_UNFLAG:
        *(int *)option->target = 0;
        return 1;
    case OPTION_BIT:
        *(uint32_t *)option->target |= (uint32_t)option->choices[0].value;
        return 1;
    default:
        return 0;
    }
}

/* ---- help ---- */

static int takes_no_value(const Option *option) {
    return option->kind == OPTION_FLAG || option->kind == OPTION_UNFLAG || option->kind == OPTION_BIT;
}

static void print_value_name(FILE *out, const Option *option) {
    if (takes_no_value(option)) {
        return;
    }
    if (option->kind != OPTION_CHOICE && option->kind != OPTION_BITS) {
        fprintf(out, " %s", option->value);
        return;
    }
    const char between = option->kind == OPTION_BITS ? ',' : '|';
    for (const Choice *choice = option->choices; choice->name != NULL; choice++) {
        fprintf(out, "%c%s", choice == option->choices ? ' ' : between, choice->name);
    }
    if (option->kind == OPTION_BITS) {
        fputs(" or none", out);
    }
}

static void print_bits(FILE *out, const Choice *choices, uint32_t bits) {
    const char *between = "";
    for (; choices->name != NULL; choices++) {
        if (bits & (uint32_t)choices->value) {
            fprintf(out, "%s%s", between, choices->name);
            between = ",";
        }
    }
    fputs(between[0] == '\0' ? "none" : "", out);
}

static void print_default(FILE *out, const Option *option) {
    const double   *numbers = option->target;
    const uint32_t *whole = option->target;
    switch (option->kind) {
    case OPTION_DOUBLE:
    case OPTION_PAIR:
    case OPTION_VECTOR:
    case OPTION_FOUR:
        for (int i = 0; i < number_count(option->kind); i++) {
            if (numbers[i] == numbers[i]) {
                fprintf(out, "%s%.10g", i == 0 ? "; default " : ",", numbers[i]);
            }
        }
        return;
    case OPTION_DEGREES:
        fprintf(out, "; default %.10g", numbers[0] * 180.0 / PI);
        return;
    case OPTION_UINT:
        if (*whole != UINT32_MAX) {
            fprintf(out, "; default %u", (unsigned)*whole);
        }
        return;
    case OPTION_UINT64:
        fprintf(out, "; default %llu", (unsigned long long)*(const uint64_t *)option->target);
        return;
    case OPTION_SIZE:
        if (*whole != UINT32_MAX) {
            fprintf(out, "; default %ux%u", (unsigned)whole[0], (unsigned)whole[1]);
        }
        return;
    case OPTION_CHOICE:
        for (const Choice *choice = option->choices; choice->name != NULL; choice++) {
            if (choice->value == *(const int32_t *)option->target) {
                fprintf(out, "; default %s", choice->name);
            }
        }
        return;
    case OPTION_BITS:
        fputs("; default ", out);
        print_bits(out, option->choices, *whole);
        return;
    case OPTION_TEXT:
        if (*(const char *const *)option->target != NULL) {
            fprintf(out, "; default %s", *(const char *const *)option->target);
        }
        return;
    case OPTION_TEXTS:
    case OPTION_FLAG:
    case OPTION_UNFLAG:
    case OPTION_BIT:
        return;
    }
}

void options_print_help(FILE *out, const char *words) {
    size_t column = 120;
    while (*words != '\0') {
        const size_t length = strcspn(words, " ");
        if (column + 1 + length > 120) {
            fputs("\n       ", out);
            column = 7;
        }
        fprintf(out, " %.*s", (int)length, words);
        column += 1 + length;
        words += length + strspn(words + length, " ");
    }
}

void options_print(FILE *out, const Option *options, size_t count) {
    for (size_t i = 0; i < count; i++) {
        fprintf(out, "  %s", options[i].name);
        print_value_name(out, &options[i]);
        options_print_help(out, options[i].help);
        if (options[i].range != NULL) {
            fprintf(out, "; %s", options[i].range);
        }
        print_default(out, &options[i]);
        fputc('\n', out);
    }
}

/* ---- the command line ---- */

static const Option *find_option(const Option *options, size_t count, const char *argument, size_t length) {
    for (size_t i = 0; i < count; i++) {
        if (strlen(options[i].name) == length && strncmp(options[i].name, argument, length) == 0) {
            return &options[i];
        }
    }
    return NULL;
}

int options_parse(const Option *options, size_t count, int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        const char   *value = strchr(argv[i], '=');
        size_t        length = value != NULL ? (size_t)(value - argv[i]) : strlen(argv[i]);
        const Option *option = find_option(options, count, argv[i], length);
        if (option == NULL) {
            fprintf(stderr, "%s: unknown option '%s'; --help lists them\n", argv[0], argv[i]);
            return EXIT_USAGE;
        }
        if (takes_no_value(option)) {
            if (value != NULL) {
                fprintf(stderr, "%s: %s takes no value\n", argv[0], option->name);
                return EXIT_USAGE;
            }
            read_no_value(option);
            continue;
        }
        if (value != NULL) {
            value++;
        } else if (i + 1 < argc) {
            value = argv[++i];
        } else {
            fprintf(stderr, "%s: %s needs a value:", argv[0], option->name);
            print_value_name(stderr, option);
            fputc('\n', stderr);
            return EXIT_USAGE;
        }
        if (option->kind == OPTION_TEXTS && ((const TextList *)option->target)->count == MOST_TEXTS) {
            fprintf(stderr, "%s: %s is given more than %u times\n", argv[0], option->name, MOST_TEXTS);
            return EXIT_USAGE;
        }
        if (!read_value(option, value)) {
            fprintf(stderr, "%s: '%s' is no value for %s, which takes", argv[0], value, option->name);
            print_value_name(stderr, option);
            fputc('\n', stderr);
            return EXIT_USAGE;
        }
    }
    return 0;
}
