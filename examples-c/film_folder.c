/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* film_folder.c -- see film_folder.h. Lists a folder, and brings a file to the disk, for which C99 has no functions. */
#ifndef _WIN32
#define _POSIX_C_SOURCE 200112L /* opendir, fsync, fileno */
#endif

#include "film_folder.h"

#include "common.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#else
#include <dirent.h>
#include <unistd.h>
#endif

/* ---- paths and lists ---- */

/* FOLDER/NAME, to be given back by free(); NULL after a message. */
static char *path_of(const char *folder, const char *name) {
    const size_t size = strlen(folder) + strlen(name) + 2;
    char        *path = malloc(size);
    if (path == NULL) {
        fprintf(stderr, "film: no memory for the name of a file\n");
        return NULL;
    }
    snprintf(path, size, "%s/%s", folder, name);
    return path;
}

#ifdef _WIN32

typedef struct Listing {
    HANDLE           handle;
    WIN32_FIND_DATAA found;
    int              is_first;
} Listing;

static int list_begin(Listing *listing, const char *folder) {
    char *pattern = path_of(folder, "*");
    listing->handle = pattern != NULL ? FindFirstFileA(pattern, &listing->found) : INVALID_HANDLE_VALUE;
    listing->is_first = 1;
    free(pattern);
    errno = ENOENT;
    return listing->handle != INVALID_HANDLE_VALUE;
}

static const char *list_next(Listing *listing) {
    const int there = listing->is_first || FindNextFileA(listing->handle, &listing->found);
    listing->is_first = 0;
    return there ? listing->found.cFileName : NULL;
}

static void list_end(Listing *listing) {
    FindClose(listing->handle);
}

#else

typedef struct Listing {
    DIR *folder;
} Listing;

static int list_begin(Listing *listing, const char *folder) {
    listing->folder = opendir(folder);
    return listing->folder != NULL;
}

static const char *list_next(Listing *listing) {
    const struct dirent *entry = readdir(listing->folder);
    return entry != NULL ? entry->d_name : NULL;
}

static void list_end(Listing *listing) {
    closedir(listing->folder);
}

#endif

/* ---- files ---- */

/* On the disk before it gets its name, so that it is there whole or not at all. 1, or 0 with errno. */
static int write_text(const char *path, const char *part, const char *text) {
    FILE *file = fopen(part, "wb");
    if (file == NULL) {
        return 0;
    }
    int written = fputs(text, file) >= 0 && fflush(file) == 0;
#ifndef _WIN32
    written = written && fsync(fileno(file)) == 0;
#endif
    int error = errno;
    if (fclose(file) != 0 && written) {
        written = 0;
        error = errno;
    }
    if (written && rename(part, path) != 0) {
        remove(path); /* Windows renames to no name that is taken */
        written = rename(part, path) == 0;
        error = errno;
    }
    if (!written) {
        remove(part);
        errno = error;
    }
    return written;
}

/* ---- film.txt ---- */

/* How many pictures a film has, and of which format. */
typedef struct Pictures {
    unsigned count;
    char     ending[4];
} Pictures;

/* 0 for a text that is no film.txt. The first line of each name is the film's: its scene comes last. */
static int read_pictures(const char *text, Pictures *pictures) {
    const char *frames = strstr(text, "\nframes = "), *format = strstr(text, "\nformat = ");
    return strncmp(text, FILM_FOLDER_TITLE, strlen(FILM_FOLDER_TITLE)) == 0 && frames != NULL && format != NULL &&
           sscanf(frames, "\nframes = %u", &pictures->count) == 1 &&
           sscanf(format, "\nformat = %3s", pictures->ending) == 1;
}

/* Says where two texts first differ: the two lines, the long ones from a little before the difference on. */
static void print_difference(const char *folder, const char *old, const char *film) {
    const int   most = 60;
    size_t      begin = 0, at = 0;
    const char *cut = "";
    for (; old[at] != '\0' && old[at] == film[at]; at++) {
        begin = old[at] == '\n' ? at + 1 : begin;
    }
    if (at > begin + 40) {
        begin = at - 20;
        cut = "...";
    }
    const int there = (int)strcspn(old + begin, "\r\n"), here = (int)strcspn(film + begin, "\r\n");
    fprintf(stderr, "film: %s holds another film: its film.txt says '%s%.*s' where this one has '%s%.*s'.\n"
                    "--output names another folder; without --continue the other film's pictures are removed\n",
            folder, cut, there < most ? there : most, old + begin, cut, here < most ? here : most, film + begin);
}

/* ---- pictures ---- */

void film_folder_name(char name[FRAME_NAME], uint32_t number, const char *ending) {
    snprintf(name, FRAME_NAME, "frame-%05u.%.3s", (unsigned)(number % 100000u), ending);
}

int film_folder_has(const char *folder, uint32_t number, const char *ending) {
    char name[FRAME_NAME];
    film_folder_name(name, number, ending);
    char *path = path_of(folder, name);
    FILE *file = path != NULL ? fopen(path, "rb") : NULL;
    if (file != NULL) {
        fclose(file);
    }
    free(path);
    return file != NULL;
}

/* Whether a file is named as a film's pictures are, and is none of these. `pictures`: NULL for none. */
static int is_foreign(const char *name, const Pictures *pictures) {
    static const char shape[] = "frame-00000.";
    const size_t      length = sizeof shape - 1;
    for (size_t i = 0; i < length; i++) {
        if (shape[i] == '0' ? !isdigit((unsigned char)name[i]) : name[i] != shape[i]) {
            return 0; /* also where the name ends sooner */
        }
    }
    if (strcmp(name + length, "png") != 0 && strcmp(name + length, "exr") != 0) {
        return 0;
    }
    return pictures == NULL || strtoul(name + strlen("frame-"), NULL, 10) >= pictures->count ||
           strcmp(name + length, pictures->ending) != 0;
}

/* 1 if there are no pictures but these; else 0 after a message. */
static int has_none_but(const char *folder, const Pictures *pictures) {
    Listing listing;
    if (!list_begin(&listing, folder)) {
        fprintf(stderr, "film: cannot read the folder %s: %s\n", folder, strerror(errno));
        return 0;
    }
    const char *name;
    while ((name = list_next(&listing)) != NULL && !is_foreign(name, pictures)) {
    }
    if (name != NULL) {
        fprintf(stderr,
                "film: %s/%s is there, and no film.txt says of which film; --output names another folder\n",
                folder, name);
    }
    list_end(&listing);
    return name == NULL;
}

/* 1, or 0 after a message. */
static int remove_pictures(const char *folder, const Pictures *pictures, const char *whose) {
    char     name[FRAME_NAME];
    unsigned removed = 0;
    for (unsigned i = 0; i < pictures->count && i < 100000u; i++) {
        film_folder_name(name, i, pictures->ending);
        char *path = path_of(folder, name);
        if (path == NULL) {
            return 0;
        }
        const int gone = remove(path) == 0;
        if (!gone && errno != ENOENT) {
            fprintf(stderr, "film: cannot remove %s, of %s film: %s\n", path, whose, strerror(errno));
            free(path);
            return 0;
        }
        free(path);
        removed += gone ? 1u : 0u;
    }
    if (removed > 0) {
        fprintf(stderr, "film: %s held %s film: its %u pictures are removed\n", folder, whose, removed);
    }
    return 1;
}

/* ---- the folder ---- */

/* `path` of film.txt, and `old`, what it says; NULL: there is none. */
static int make_ready(const char *folder, const char *path, const char *part, const char *old, const char *film,
                      int go_on) {
    Pictures pictures;
    if (old != NULL && !read_pictures(old, &pictures)) {
        fprintf(stderr, "film: %s is not of this program; --output names another folder\n", path);
        return 0;
    }
    const int is_same = old != NULL && strcmp(old, film) == 0;
    if (old != NULL && !is_same && go_on) {
        print_difference(folder, old, film);
        return 0;
    }
    if (!has_none_but(folder, old != NULL ? &pictures : NULL)) {
        return 0;
    }
    if (old != NULL && !go_on && !remove_pictures(folder, &pictures, is_same ? "this" : "another")) {
        return 0;
    }
    if (!is_same && !write_text(path, part, film)) {
        fprintf(stderr, "film: cannot write %s: %s\n", path, strerror(errno));
        return 0;
    }
    return 1;
}

int film_folder_open(const char *folder, const char *film, int go_on) {
    if (!make_folder(folder) && errno != EEXIST) {
        fprintf(stderr, "cannot make the folder %s: %s\n", folder, strerror(errno));
        return 0;
    }
    char *path = path_of(folder, "film.txt"), *part = path_of(folder, "film.txt.part");
    int   ready = path != NULL && part != NULL;
    if (ready) {
        char     *old = read_text(path);
        const int error = errno;
        ready = old != NULL || error == ENOENT;
        if (ready) {
            ready = make_ready(folder, path, part, old, film, go_on);
        } else {
            fprintf(stderr, "film: cannot read %s: %s\n", path, strerror(error));
        }
        free(old);
    }
    free(path);
    free(part);
    return ready;
}
