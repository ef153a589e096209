/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* quiet.c -- the library and the drivers under it print nothing while a context is made, whatever the environment says
 * of displays: descriptors 1 and 2 of a process of its own for each case are read to their end. In the first case it
 * also renders a frame. (Mesa's device-select layer made libwayland print where XDG_RUNTIME_DIR was not set.) */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct Case {
    const char *display, *wayland, *folder; /* NULL: not set */
} Case;

static void set(const char *name, const char *value) {
    if (value != NULL) {
        setenv(name, value, 1);
    } else {
        unsetenv(name);
    }
}

/* In the child: the status that it ends with. */
static int live(BhrBackend backend, const Case *one, int renders) {
    static unsigned char pixels[16 * 16 * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, 16, 16, pixels, sizeof pixels);
    BhrContextOptions    options = check_options(backend);
    BhrContext          *context = NULL;
    set("DISPLAY", one->display);
    set("WAYLAND_DISPLAY", one->wayland);
    set("XDG_RUNTIME_DIR", one->folder);
    unsetenv("WAYLAND_SOCKET");
    if (bhr_context_create(BHR_ABI_VERSION, &options, &context) != BHR_OK) {
        return 2;
    }
    if (renders && bhr_render_image(context, &image) != BHR_OK) {
        return 3;
    }
    bhr_context_destroy(context);
    return 0;
}

/* All that was printed, cut to the buffer, and how the child ended. */
static int child(BhrBackend backend, const Case *one, int renders, char *said, size_t size) {
    int    ends[2], status = 0;
    size_t used = 0;
    if (pipe(ends) != 0) {
        return -1;
    }
    fflush(NULL);
    const pid_t process = fork();
    if (process == 0) {
        dup2(ends[1], STDOUT_FILENO);
        dup2(ends[1], STDERR_FILENO);
        close(ends[0]);
        close(ends[1]);
        _exit(live(backend, one, renders));
    }
    close(ends[1]);
    for (;;) {
        char          more[512];
        const ssize_t count = read(ends[0], more, sizeof more);
        if (count <= 0 && !(count < 0 && errno == EINTR)) {
            break;
        }
        for (ssize_t i = 0; i < count && used + 1 < size; i++) {
            said[used++] = more[i];
        }
    }
    said[used] = '\0';
    close(ends[0]);
    if (process < 0 || waitpid(process, &status, 0) < 0) {
        return -1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int main(int argc, char **argv) {
    /* No server is behind these names. */
    static const char *const displays[] = {NULL, ":4242"}, *const waylands[] = {NULL, "bhr-no-display"};
    static const char *const folders[] = {NULL, "/tmp", "relative"}; /* the last one in one case alone */
    const BhrBackend         backend = check_begin(argc, argv);
    int                      renders = 1;
    for (size_t i = 0; i <= 8; i++) {
        if (!check_runs_all() && i < 8 && (i == 1 || i == 2 || i == 4 || i == 7)) {
            continue; /* every pair of the three variables' values is among the others */
        }
        const Case one = {displays[i & 1], waylands[i >> 1 & 1], folders[i >> 2]};
        char       said[2048];
        const int  status = child(backend, &one, renders, said, sizeof said);
        CHECK(status == 0, "DISPLAY=%s WAYLAND_DISPLAY=%s XDG_RUNTIME_DIR=%s: the process ended with %d",
              one.display ? one.display : "(unset)", one.wayland ? one.wayland : "(unset)",
              one.folder ? one.folder : "(unset)", status);
        CHECK(said[0] == '\0', "DISPLAY=%s WAYLAND_DISPLAY=%s XDG_RUNTIME_DIR=%s: printed: %s",
              one.display ? one.display : "(unset)", one.wayland ? one.wayland : "(unset)",
              one.folder ? one.folder : "(unset)", said);
        renders = 0;
    }
    return check_end();
}
