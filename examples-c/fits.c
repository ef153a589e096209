/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* fits.c -- see fits.h. */
#include "fits.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define CARD 80u
#define HISTORY_TEXT 72u
#define BLOCK 2880u

typedef struct Writer {
    FILE  *file;
    size_t bytes;
} Writer;

static void put(Writer *writer, const void *bytes, size_t count) {
    fwrite(bytes, 1, count, writer->file); /* ferror says at the end whether it went wrong */
    writer->bytes += count;
}

static void fill_block(Writer *writer, char byte) {
    while (writer->bytes % BLOCK != 0) {
        put(writer, &byte, 1);
    }
}

/* `line`: 80 characters of it at most, the rest becomes blank. */
static void put_card(Writer *writer, const char *line) {
    char         card[CARD];
    const size_t length = strlen(line);
    memset(card, ' ', sizeof card);
    memcpy(card, line, length < CARD ? length : CARD);
    put(writer, card, sizeof card);
}

static void put_number(Writer *writer, const char *name, const char *value, const char *comment) {
    char line[CARD + 1];
    snprintf(line, sizeof line, "%-8.8s= %20s / %s", name, value, comment);
    put_card(writer, line);
}

static void put_whole(Writer *writer, const char *name, long value, const char *comment) {
    char text[24];
    snprintf(text, sizeof text, "%ld", value);
    put_number(writer, name, text, comment);
}

/* A quotation mark inside a text is written twice. */
static void put_text(Writer *writer, const FitsCard *card) {
    char   line[CARD + 1], value[68 + 1];
    size_t length = 0;
    for (const char *from = card->text; *from != '\0' && length + 2 < sizeof value; from++) {
        value[length++] = *from;
        if (*from == '\'') {
            value[length++] = '\'';
        }
    }
    value[length] = '\0';
    int used = snprintf(line, sizeof line, "%-8.8s= '%-8s'", card->name, value);
    if (used < 30) {
        used += snprintf(line + used, sizeof line - (size_t)used, "%*s", 30 - used, "");
    }
    snprintf(line + used, sizeof line - (size_t)used, " / %s", card->comment);
    put_card(writer, line);
}

static void put_history(Writer *writer, const char *text) {
    char line[CARD + 1];
    for (size_t length = strlen(text); length > 0;) {
        const size_t part = length < HISTORY_TEXT ? length : HISTORY_TEXT;
        snprintf(line, sizeof line, "HISTORY %.*s", (int)part, text);
        put_card(writer, line);
        text += part;
        length -= part;
    }
}

static void put_header(Writer *writer, uint32_t width, uint32_t height, const FitsCard *cards, size_t count) {
    put_number(writer, "SIMPLE", "T", "the FITS standard 4.0");
    put_whole(writer, "BITPIX", -64, "doubles, the most significant byte first");
    put_whole(writer, "NAXIS", 2, "");
    put_whole(writer, "NAXIS1", (long)width, "");
    put_whole(writer, "NAXIS2", (long)height, "the first row is the bottom one");
    for (size_t i = 0; i < count; i++) {
        char value[32];
        switch (cards[i].kind) {
        case FITS_NUMBER:
            snprintf(value, sizeof value, "%.13E", cards[i].number);
            put_number(writer, cards[i].name, value, cards[i].comment);
            break;
        case FITS_TEXT: put_text(writer, &cards[i]); break;
        case FITS_HISTORY: put_history(writer, cards[i].text); break;
        }
    }
    put_card(writer, "END");
    fill_block(writer, ' ');
}

static void put_double(Writer *writer, double value) {
    uint64_t      bits;
    unsigned char bytes[8];
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 8; i++) {
        bytes[i] = (unsigned char)(bits >> (56 - 8 * i));
    }
    put(writer, bytes, sizeof bytes);
}

int fits_write(const char *path, const double *pixels, uint32_t width, uint32_t height, const FitsCard *cards,
               size_t count) {
    Writer writer = {fopen(path, "wb"), 0};
    if (writer.file == NULL) {
        fprintf(stderr, "cannot write %s: %s\n", path, strerror(errno));
        return 0;
    }
    put_header(&writer, width, height, cards, count);
    for (uint32_t row = height; row-- > 0;) {
        for (uint32_t column = 0; column < width; column++) {
            put_double(&writer, pixels[(size_t)row * width + column]);
        }
    }
    fill_block(&writer, '\0');
    const int failed = ferror(writer.file) != 0;
    if (fclose(writer.file) != 0 || failed) {
        fprintf(stderr, "cannot write %s: %s\n", path, errno != 0 ? strerror(errno) : "the disk may be full");
        remove(path);
        return 0;
    }
    return 1;
}
