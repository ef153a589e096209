/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* scene_files.c -- see scene_files.h. */
#include "scene_files.h"

#include "common.h"

#include <errno.h>
#include <string.h>

/* Whether there is such a file that can be read. */
static int has(const char *folder, const char *name, char *path) {
    if (snprintf(path, MOST_PATH, "%s/%s.toml", folder, name) >= MOST_PATH) {
        errno = ENAMETOOLONG;
        return 0;
    }
    FILE *file = fopen(path, "r");
    if (file != NULL) {
        fclose(file);
    }
    return file != NULL;
}

int scene_file_path(const char *folder, const char *name, char *path) {
    static const char *const PLACES[] = {"scenes", "../share/bhr/scenes"};
    char                     own[MOST_PATH], place[MOST_PATH + 32];
    if (folder != NULL) {
        const int found = has(folder, name, path);
        if (!found) {
            fprintf(stderr, "cannot read the scene %s/%s.toml: %s\n", folder, name, strerror(errno));
        }
        return found;
    }
    program_folder(own, sizeof own);
    for (size_t i = 0; i < COUNT_OF(PLACES); i++) {
        snprintf(place, sizeof place, "%s/%s", own, PLACES[i]);
        if (has(place, name, path)) {
            return 1;
        }
    }
    fprintf(stderr, "the scene %s.toml was found neither in %s/%s nor in %s/%s; an option (--help) can name another\n",
            name, own, PLACES[0], own, PLACES[1]);
    return 0;
}

int scene_file_about(const char *path, char *about) {
    char  line[256];
    FILE *file = fopen(path, "r");
    about[0] = '\0';
    if (file == NULL) {
        fprintf(stderr, "cannot read %s: %s\n", path, strerror(errno));
        return 0;
    }
    while (fgets(line, sizeof line, file) != NULL && strncmp(line, "# ", 2) == 0) {
        const size_t length = strlen(about);
        line[strcspn(line, "\r\n")] = '\0';
        if (strstr(line, "SPDX-License-Identifier") == NULL) {
            snprintf(about + length, MOST_ABOUT - length, "%s%s", length > 0 ? " " : "", line + 2);
        }
    }
    fclose(file);
    return 1;
}
