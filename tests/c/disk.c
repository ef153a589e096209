/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* disk.c -- saving onto a disk that fails: errors of write, fsync, close and rename reach the host, and the old file
 * stays. Stands between the library and the C library: its own write, fsync, close and rename are the ones that the
 * dynamic linker finds first. Linux. Works in the folder named by its second argument, which must exist and be
 * empty. */
#define _GNU_SOURCE

#include "check.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#define SIZE 64u

enum Step { NONE, WRITE, FSYNC, CLOSE, RENAME, FSYNC_FOLDER };

static enum Step failing;
static int       failing_errno;
static unsigned  fsyncs_of_files, fsyncs_of_folders, renames_after_fsync;
static int       saving;

/* Whether a file of the library's is being written: temporary ones are open for writing only. */
static int is_ours(int fd) {
    const int flags = (int)syscall(SYS_fcntl, fd, F_GETFL);
    return saving && fd > 2 && (flags & O_ACCMODE) == O_WRONLY;
}

static int fails(enum Step step) {
    if (failing == step) {
        errno = failing_errno;
    }
    return failing == step;
}

ssize_t write(int fd, const void *bytes, size_t count) {
    return is_ours(fd) && fails(WRITE) ? -1 : syscall(SYS_write, fd, bytes, count);
}

int fsync(int fd) {
    const int ours = is_ours(fd);
    fsyncs_of_files += (unsigned)ours;
    fsyncs_of_folders += saving && !ours;
    return saving && fails(ours ? FSYNC : FSYNC_FOLDER) ? -1 : (int)syscall(SYS_fsync, fd);
}

int close(int fd) {
    /* The descriptor is closed whatever close returns. */
    const int ours = is_ours(fd), closed = (int)syscall(SYS_close, fd);
    return ours && fails(CLOSE) ? -1 : closed;
}

int rename(const char *from, const char *to) {
    renames_after_fsync += saving && fsyncs_of_files > 0;
    return saving && fails(RENAME) ? -1 : (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}

static unsigned files_in(const char *folder) {
    unsigned       count = 0;
    DIR           *open = opendir(folder);
    struct dirent *entry;
    while (open != NULL && (entry = readdir(open)) != NULL) {
        count += entry->d_name[0] != '.' || strlen(entry->d_name) > 2;
    }
    if (open != NULL) {
        closedir(open);
    }
    return count;
}

static BhrStatus save(const BhrImage *image, const char *path, enum Step step, int error) {
    failing = step;
    failing_errno = error;
    saving = 1;
    const BhrStatus status = bhr_image_save(image, path);
    saving = 0;
    failing = NONE;
    return status;
}

int main(int argc, char **argv) {
    static unsigned char pixels[SIZE * SIZE * 16];
    static const struct {
        const char *name;
        BhrFormat   format;
    } files[] = {{"a.png", BHR_FORMAT_RGBA8_SRGB}, {"a.ppm", BHR_FORMAT_BGRA8_SRGB}, {"a.exr", BHR_FORMAT_RGBA32F}};
    static const struct {
        enum Step   step;
        int         error;
        const char *words;
    } faults[] = {
        {WRITE, ENOSPC, "No space left"},
        {WRITE, EDQUOT, "uota"},
        {FSYNC, EIO, "nput/output"},
        {FSYNC, ENOSPC, "No space left"},
        {CLOSE, EDQUOT, "uota"},
        {CLOSE, EIO, "nput/output"},
        {RENAME, EACCES, "ermission"},
    };
    (void)check_begin(argc, argv);
    if (argc < 3) {
        fprintf(stderr, "usage: %s BACKEND FOLDER\n", argv[0]);
        return 2;
    }
    char path[1024];
    for (size_t i = 0; i < COUNT_OF(files); i++) {
        const BhrImage image = image_of(files[i].format, SIZE, SIZE, pixels, sizeof pixels);
        snprintf(path, sizeof path, "%s/%s", argv[2], files[i].name);
        for (size_t j = 0; j < COUNT_OF(faults); j++) {
            const unsigned before = files_in(argv[2]);
            check_mark_message();
            check_fails(save(&image, path, faults[j].step, faults[j].error), BHR_ERROR_IO, faults[j].words, __FILE__,
                        __LINE__, files[i].name);
            CHECK(files_in(argv[2]) == before, "%s, fault %u: a file was left", files[i].name, (unsigned)j);
            CHECK(access(path, F_OK) != 0, "%s, fault %u: there is a file", files[i].name, (unsigned)j);
        }
        fsyncs_of_files = fsyncs_of_folders = renames_after_fsync = 0;
        CHECK_OK(save(&image, path, NONE, 0));
        CHECK(fsyncs_of_files == 1 && renames_after_fsync == 1 && fsyncs_of_folders == 1,
              "%s: %u fsyncs of the file, %u renames after it, %u fsyncs of the folder", files[i].name, fsyncs_of_files,
              renames_after_fsync, fsyncs_of_folders);
        /* File systems that know no fsync have nothing to tell. */
        CHECK_OK(save(&image, path, FSYNC, EINVAL));
        /* The file is in its place already. */
        fsyncs_of_folders = 0;
        CHECK_OK(save(&image, path, FSYNC_FOLDER, EIO));
        CHECK(fsyncs_of_folders == 1, "%s: the folder was not synced", files[i].name);
        CHECK(unlink(path) == 0, "cannot remove %s", path);
    }
    return check_end();
}
