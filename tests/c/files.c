/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* files.c -- saving and loading: round trips that keep every bit, files that cannot be read or written, files that
 * lie. Works in the folder named by its second argument, which must exist and be empty. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define WIDTH 31u
#define HEIGHT 17u

static const char *folder;

/* A path in the test's folder; the last four stay valid. */
static const char *path_of(const char *name) {
    static char     paths[4][1024];
    static unsigned next;
    char           *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void write_file(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    CHECK(file != NULL && fwrite(bytes, 1, size, file) == size && fclose(file) == 0, "cannot write %s", path);
}

static uint64_t file_size(const char *path) {
    struct stat about;
    return stat(path, &about) == 0 ? (uint64_t)about.st_size : 0;
}

static void render(BhrContext *context, BhrFormat format, void *pixels) {
    const BhrImage image = image_of(format, WIDTH, HEIGHT, pixels, WIDTH * HEIGHT * bytes_per_pixel(format));
    CHECK_OK(bhr_render_image(context, &image));
}

/* Saves `pixels`, loads them again and compares with `expected`, packed, of `loaded_format`. */
static void round_trip(const char *name, BhrFormat format, void *pixels, BhrFormat loaded_format,
                       const void *expected) {
    const char    *path = path_of(name);
    const size_t   row = WIDTH * bytes_per_pixel(loaded_format);
    const BhrImage image = image_of(format, WIDTH, HEIGHT, pixels, WIDTH * HEIGHT * bytes_per_pixel(format));
    BhrImage       loaded;
    CHECK_OK(bhr_image_save(&image, path));
    CHECK_OK(bhr_image_init(&loaded, sizeof loaded));
    if (!CHECK_OK(bhr_image_load(path, &loaded))) {
        return;
    }
    CHECK(loaded.format == loaded_format && loaded.width == WIDTH && loaded.height == HEIGHT,
          "%s came back in format %d, %u x %u", name, (int)loaded.format, (unsigned)loaded.width,
          (unsigned)loaded.height);
    const int64_t stride = loaded.row_stride != 0 ? loaded.row_stride : (int64_t)row;
    int           equal = 1;
    for (uint32_t y = 0; y < HEIGHT; y++) {
        equal &= memcmp((const char *)loaded.pixels + y * stride, (const char *)expected + y * row, row) == 0;
    }
    CHECK(equal, "%s came back with other pixels", name);
    CHECK_OK(bhr_image_release(&loaded));
    CHECK(loaded.pixels == NULL, "a released image still has pixels");
}

static void round_trips(BhrContext *context) {
    static unsigned char rgba[WIDTH * HEIGHT * 4], bgra[WIDTH * HEIGHT * 4];
    static float         light[WIDTH * HEIGHT * 4];
    render(context, BHR_FORMAT_RGBA8_SRGB, rgba);
    render(context, BHR_FORMAT_BGRA8_SRGB, bgra);
    render(context, BHR_FORMAT_RGBA32F, light);
    round_trip("rgba.png", BHR_FORMAT_RGBA8_SRGB, rgba, BHR_FORMAT_RGBA8_SRGB, rgba);
    round_trip("bgra.png", BHR_FORMAT_BGRA8_SRGB, bgra, BHR_FORMAT_RGBA8_SRGB, rgba);
    round_trip("rgba.ppm", BHR_FORMAT_RGBA8_SRGB, rgba, BHR_FORMAT_RGBA8_SRGB, rgba); /* alpha is 1 anyway */
    round_trip("light.exr", BHR_FORMAT_RGBA32F, light, BHR_FORMAT_RGBA32F, light);

    /* Bottom-up with padding saves the same picture. */
    enum { STRIDE = WIDTH * 4 + 5 };
    static unsigned char padded[HEIGHT * STRIDE];
    for (uint32_t y = 0; y < HEIGHT; y++) {
        memcpy(padded + (HEIGHT - 1 - y) * STRIDE, rgba + y * WIDTH * 4, WIDTH * 4);
    }
    BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, padded + (HEIGHT - 1) * STRIDE, sizeof padded);
    BhrImage loaded;
    image.row_stride = -STRIDE;
    CHECK_OK(bhr_image_save(&image, path_of("bottom-up.png")));
    CHECK_OK(bhr_image_init(&loaded, sizeof loaded));
    if (CHECK_OK(bhr_image_load(path_of("bottom-up.png"), &loaded))) {
        CHECK(memcmp(loaded.pixels, rgba, sizeof rgba) == 0, "a bottom-up image is saved upside down");
        CHECK_OK(bhr_image_release(&loaded));
    }
    image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, padded, sizeof padded);
    image.row_stride = STRIDE;
    image.flags = BHR_IMAGE_BOTTOM_UP;
    CHECK_OK(bhr_image_save(&image, path_of("flag.png")));
    loaded.flags = BHR_IMAGE_BOTTOM_UP; /* an output: what a file gives lies top-down, and says so */
    if (CHECK_OK(bhr_image_load(path_of("flag.png"), &loaded))) {
        CHECK(memcmp(loaded.pixels, rgba, sizeof rgba) == 0, "an image with the flag is saved upside down");
        CHECK(loaded.flags == 0, "a loaded image has flags %u", (unsigned)loaded.flags);
        CHECK_OK(bhr_image_release(&loaded));
    }
}

/* Light of an 8-bit code, IEC 61966-2-1. */
static double light_of(unsigned char code) {
    const double share = code / 255.0;
    return share <= 0.04045 ? share / 12.92 : pow((share + 0.055) / 1.055, 2.4);
}

/* A transparent frame over grey is the same picture by its own premultiplied pixels and by its PNG file, whose colours
 * are straight; its EXR file has premultiplied ones, as that format's readers expect. */
static void transparent(BhrContext *context) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    static float         light[WIDTH * HEIGHT * 4];
    BhrImage             frame = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels), file;
    BhrImage             floats = image_of(BHR_FORMAT_RGBA32F, WIDTH, HEIGHT, light, sizeof light);
    unsigned             covered = 0;
    double               worst = 0.0, without = 0.0;
    frame.flags = floats.flags = BHR_IMAGE_TRANSPARENT;
    CHECK_OK(bhr_render_image(context, &frame));
    CHECK_OK(bhr_render_image(context, &floats));
    CHECK_OK(bhr_image_save(&frame, path_of("transparent.png")));
    CHECK_OK(bhr_image_save(&floats, path_of("transparent.exr")));
    CHECK_OK(bhr_image_init(&file, sizeof file));
    if (CHECK_OK(bhr_image_load(path_of("transparent.png"), &file))) {
        const unsigned char *straight = file.pixels;
        for (size_t i = 0; i < WIDTH * HEIGHT * 4; i++) {
            const double alpha = pixels[i | 3] / 255.0, over = light_of(pixels[i]) + (1.0 - alpha) * 0.2;
            /* Glare beyond alpha is more than a straight colour can be. */
            if ((i & 3) == 3 || light_of(pixels[i]) > alpha) {
                continue;
            }
            covered += alpha > 0.1 && alpha < 0.9;
            worst = fmax(worst, fabs(light_of(straight[i]) * alpha + (1.0 - alpha) * 0.2 - over));
            without = fmax(without, fabs(light_of(pixels[i]) * alpha + (1.0 - alpha) * 0.2 - over));
        }
        CHECK(covered > 50 && without > 0.02, "the frame has %u values that are partly transparent, %g", covered,
              without);
        /* Half a step of a code is at most 0.0046 of light. */
        CHECK(worst < 0.0047, "over grey the file differs by %g of white", worst);
        CHECK_OK(bhr_image_release(&file));
    }
    if (CHECK_OK(bhr_image_load(path_of("transparent.exr"), &file))) {
        CHECK(memcmp(file.pixels, light, sizeof light) == 0, "the EXR file has other pixels");
        CHECK_OK(bhr_image_release(&file));
    }
}

/* An older file keeps its mode; of a link the target is written; what a killed process left does not matter; names are
 * as long as names can be. */
static void places(void) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    struct stat          about;
    char                 name[256], left[64];
    CHECK(mkdir(path_of("places"), 0777) == 0, "cannot make a folder");

    write_file(path_of("places/mode.png"), "old", 3);
    CHECK(chmod(path_of("places/mode.png"), 0640) == 0, "cannot change a mode");
    CHECK_OK(bhr_image_save(&image, path_of("places/mode.png")));
    CHECK(stat(path_of("places/mode.png"), &about) == 0 && (about.st_mode & 07777) == 0640 && about.st_size > 3,
          "the mode is %o, of %u bytes", (unsigned)about.st_mode & 07777, (unsigned)about.st_size);

    CHECK(symlink("places/mode.png", path_of("link.png")) == 0, "cannot make a link");
    CHECK(symlink("places/new.png", path_of("dangling.png")) == 0, "cannot make a link");
    write_file(path_of("places/mode.png"), "old", 3);
    CHECK_OK(bhr_image_save(&image, path_of("link.png")));
    CHECK_OK(bhr_image_save(&image, path_of("dangling.png")));
    CHECK(lstat(path_of("link.png"), &about) == 0 && S_ISLNK(about.st_mode), "the link was replaced");
    CHECK(lstat(path_of("dangling.png"), &about) == 0 && S_ISLNK(about.st_mode), "the dangling link was replaced");
    CHECK(file_size(path_of("places/mode.png")) > 3, "the link's target was not written");
    CHECK(file_size(path_of("places/new.png")) > 3, "the dangling link's target was not written");
    CHECK(symlink("loop.png", path_of("loop.png")) == 0, "cannot make a link");
    CHECK_FAILS(BHR_ERROR_IO, "symbolic link", bhr_image_save(&image, path_of("loop.png")));

    /* The names that this process takes, and those that earlier versions took. */
    for (unsigned i = 0; i < 200; i++) {
        snprintf(left, sizeof left, "places/.bhr-%ld-%u.tmp", (long)getpid(), i);
        write_file(path_of(left), "left", 4);
        snprintf(left, sizeof left, "places/mode.png.%ld-%u.tmp", (long)getpid(), i);
        write_file(path_of(left), "left", 4);
    }
    CHECK_OK(bhr_image_save(&image, path_of("places/mode.png")));

    memset(name, 'x', 251);
    memcpy(name + 251, ".png", 5);
    CHECK_OK(bhr_image_save(&image, path_of(name)));
    CHECK(file_size(path_of(name)) > 0, "there is no file of the longest name");
}

static void unwritable(void) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    CHECK_FAILS(BHR_ERROR_IO, "absent", bhr_image_save(&image, path_of("absent/frame.png")));
    CHECK(mkdir(path_of("folder.png"), 0777) == 0, "cannot make a folder");
    CHECK_FAILS(BHR_ERROR_IO, "folder.png", bhr_image_save(&image, path_of("folder.png")));
    CHECK(symlink("/dev/null", path_of("device.png")) == 0, "cannot make a link");
    CHECK_FAILS(BHR_ERROR_IO, "no regular file", bhr_image_save(&image, path_of("device.png")));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "path", bhr_image_save(&image, NULL));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "image", bhr_image_save(NULL, path_of("null.png")));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "path", bhr_image_save(&image, ""));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "xyz", bhr_image_save(&image, path_of("frame.xyz")));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "extension", bhr_image_save(&image, path_of("frame")));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "exr", bhr_image_save(&image, path_of("eight-bit.exr")));
    CHECK_FAILS(BHR_ERROR_UNSUPPORTED, "extension", bhr_image_save(&image, "\xff\xfe"));
    image.byte_size--;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "byte_size", bhr_image_save(&image, path_of("short.png")));
    CHECK(file_size(path_of("short.png")) == 0, "a refused image left a file");
}

#define NOBODY 65534

/* Runs `part` in a child of another user, where this one is root, in the folder `place` (which others may enter, and
 * those above it perhaps not); whether all its checks passed. */
static int passes_as_nobody(const char *place, void (*part)(const BhrImage *), const BhrImage *image) {
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        CHECK(chdir(path_of(place)) == 0, "cannot go to %s", place);
        if (geteuid() == 0) {
            CHECK(setgid(NOBODY) == 0 && setuid(NOBODY) == 0, "cannot become another user");
        }
        part(image);
        const int status = check_end();
        fflush(stdout);
        _exit(status);
    }
    int status = 1;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

/* A file of this user's own that only its group may write, in a folder where it could be replaced. */
static void not_my_file(const BhrImage *image) {
    const int file = open("not-mine.png", O_CREAT | O_EXCL | O_WRONLY, 0600);
    CHECK(file >= 0 && write(file, "old", 3) == 3 && close(file) == 0, "cannot make a file");
    CHECK(chmod("not-mine.png", 0464) == 0, "cannot change a mode");
    CHECK_FAILS(BHR_ERROR_IO, "ermission", bhr_image_save(image, "not-mine.png"));
    CHECK(file_size("not-mine.png") == 3, "a file that its user may not write was replaced");
}

static void roots_file(const BhrImage *image) {
    CHECK_FAILS(BHR_ERROR_IO, "ermission", bhr_image_save(image, "roots.png"));
}

static void leave_links(const BhrImage *image) {
    (void)image;
    CHECK(symlink("../target.png", "there.png") == 0, "cannot make a link");
    CHECK(symlink("../nothing.png", "dangling.png") == 0, "cannot make a link");
}

/* A file that all may write becomes this user's own. */
static void open_file(const BhrImage *image) {
    CHECK_OK(bhr_image_save(image, "open.png"));
}

/* A file that a program may not open for writing it may not replace either. Where it is not root, a program has no
 * files of another user. */
static void other_users(void) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    const BhrImage       image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    CHECK(mkdir(path_of("shared"), 0777) == 0 && chmod(path_of("shared"), 0777) == 0, "cannot make a folder");
    CHECK(passes_as_nobody("shared", not_my_file, &image), "a part of the test failed");
    if (geteuid() != 0) {
        return;
    }
    write_file(path_of("shared/roots.png"), "old", 3);
    CHECK(passes_as_nobody("shared", roots_file, &image), "a part of the test failed");
    CHECK(file_size(path_of("shared/roots.png")) == 3, "root's file was replaced");
    write_file(path_of("shared/open.png"), "old", 3);
    CHECK(chmod(path_of("shared/open.png"), 0676) == 0, "cannot change a mode");
    CHECK(passes_as_nobody("shared", open_file, &image), "a part of the test failed");
    struct stat about;
    CHECK(stat(path_of("shared/open.png"), &about) == 0, "the file is gone");
    CHECK(about.st_gid == NOBODY && (about.st_mode & 07777) == 0606,
          "another group has the old group's rights: the mode is %o", (unsigned)about.st_mode & 07777);

    /* Links in the way of root, whether the system protects them or not. */
    CHECK(mkdir(path_of("sticky"), 0777) == 0 && chmod(path_of("sticky"), 01777) == 0, "cannot make a folder");
    write_file(path_of("target.png"), "old", 3);
    CHECK(passes_as_nobody("sticky", leave_links, &image), "a part of the test failed");
    CHECK_FAILS(BHR_ERROR_IO, "another user", bhr_image_save(&image, path_of("sticky/there.png")));
    CHECK_FAILS(BHR_ERROR_IO, "another user", bhr_image_save(&image, path_of("sticky/dangling.png")));
    CHECK(file_size(path_of("target.png")) == 3, "another user's link was followed");
    CHECK(access(path_of("nothing.png"), F_OK) != 0, "another user's dangling link was followed");
    CHECK(symlink("../target.png", path_of("sticky/own.png")) == 0, "cannot make a link");
    CHECK_OK(bhr_image_save(&image, path_of("sticky/own.png")));
    CHECK(file_size(path_of("target.png")) > 3, "the user's own link was not followed");
}

static void check_unreadable(const char *path, BhrStatus expected, const char *words, int line) {
    BhrImage image;
    memset(&image, 0, sizeof image);
    image.struct_size = sizeof image;
    image.pixels = &image; /* must become NULL */
    check_mark_message();
    check_fails(bhr_image_load(path, &image), expected, words, __FILE__, line, "bhr_image_load");
    CHECK(image.pixels == NULL && image.width == 0 && image.height == 0 && image.byte_size == 0,
          "line %d: a failed load left pixels behind", line);
}

/* Appends an attribute of an EXR header. */
static size_t attribute(unsigned char *to, const char *name, const char *type, const void *value, uint32_t size) {
    unsigned char *at = to;
    memcpy(at, name, strlen(name) + 1);
    at += strlen(name) + 1;
    memcpy(at, type, strlen(type) + 1);
    at += strlen(type) + 1;
    for (unsigned i = 0; i < 4; i++) {
        *at++ = (unsigned char)(size >> 8 * i);
    }
    memcpy(at, value, size);
    return (size_t)(at - to) + size;
}

/* Small files that claim to be large: what they claim is refused before memory is taken for it. */
static void bombs(void) {
    /* A display window of 1 x 1, and a data window of 2^29 x 16 half floats R, G and B: 48 GiB in one block. */
    static const unsigned char start[] = {0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0};
    static const unsigned char channels[] = {'B', 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0,
                                             'G', 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0,
                                             'R', 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0};
    static const unsigned char data[] = {0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0x1f, 15, 0, 0, 0};
    static const unsigned char zeros[16] = {0}, one[] = {0, 0, 0x80, 0x3f};
    static const unsigned char compressions[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    for (size_t i = 0; i < COUNT_OF(compressions); i++) {
        unsigned char file[512];
        size_t        size = sizeof start;
        memcpy(file, start, sizeof start);
        size += attribute(file + size, "channels", "chlist", channels, sizeof channels);
        size += attribute(file + size, "compression", "compression", &compressions[i], 1);
        size += attribute(file + size, "dataWindow", "box2i", data, sizeof data);
        size += attribute(file + size, "displayWindow", "box2i", zeros, 16);
        size += attribute(file + size, "lineOrder", "lineOrder", zeros, 1);
        size += attribute(file + size, "pixelAspectRatio", "float", one, 4);
        size += attribute(file + size, "screenWindowCenter", "v2f", zeros, 8);
        size += attribute(file + size, "screenWindowWidth", "float", one, 4);
        file[size++] = 0;
        memset(file + size, 0, 24); /* the offset of a block, and that block: y, its size, its bytes */
        file[size] = (unsigned char)((size + 8) & 0xff);
        file[size + 1] = (unsigned char)((size + 8) >> 8);
        file[size + 12] = 8;
        write_file(path_of("bomb.exr"), file, size + 24);
        check_unreadable(path_of("bomb.exr"), BHR_ERROR_IO, "1048576", __LINE__);
    }
    /* 65536 x 65536 of 8 grey bits are 4 GiB, which are read; as RGBA they are 16 GiB, which are not. */
    static const unsigned char png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0,
                                        1, 0, 0, 0, 1, 0, 0, 8, 0, 0, 0, 0, 0x49, 0xef, 0x6f, 0x3f};
    write_file(path_of("bomb.png"), png, sizeof png);
    check_unreadable(path_of("bomb.png"), BHR_ERROR_IO, "4294967296", __LINE__);
    static const char pgm[] = "P5 65536 65536 255\n";
    write_file(path_of("bomb.pgm"), pgm, sizeof pgm - 1);
    check_unreadable(path_of("bomb.pgm"), BHR_ERROR_IO, "4294967296", __LINE__);
}

static void unreadable(void) {
    static const char text[] = "This is no picture, whatever its name says.\n";
    check_unreadable(path_of("absent.png"), BHR_ERROR_IO, "absent.png", __LINE__);
    check_unreadable(folder, BHR_ERROR_IO, "", __LINE__);
    check_unreadable(path_of("folder.png"), BHR_ERROR_IO, "folder.png", __LINE__);
    write_file(path_of("text.png"), text, sizeof text);
    check_unreadable(path_of("text.png"), BHR_ERROR_IO, "text.png", __LINE__);
    write_file(path_of("text.exr"), text, sizeof text);
    check_unreadable(path_of("text.exr"), BHR_ERROR_IO, "text.exr", __LINE__);
    write_file(path_of("empty.png"), text, 0);
    check_unreadable(path_of("empty.png"), BHR_ERROR_IO, "empty.png", __LINE__);

    /* The saved files, cut in half. */
    static const char *const whole[] = {"rgba.png", "light.exr", "rgba.ppm"};
    static const char *const cut[] = {"cut.png", "cut.exr", "cut.ppm"};
    static char              bytes[1 << 16];
    for (size_t i = 0; i < COUNT_OF(whole); i++) {
        const uint64_t size = file_size(path_of(whole[i]));
        FILE          *file = fopen(path_of(whole[i]), "rb");
        if (!CHECK(file != NULL && size <= sizeof bytes && fread(bytes, 1, size, file) == size, "cannot read %s",
                   whole[i])) {
            continue;
        }
        fclose(file);
        write_file(path_of(cut[i]), bytes, (size_t)size / 2);
        check_unreadable(path_of(cut[i]), BHR_ERROR_IO, cut[i], __LINE__);
    }

    /* Headers that promise more than memory holds. */
    static const char ppm[] = "P6 2000000000 2000000000 255\n";
    write_file(path_of("bomb.ppm"), ppm, sizeof ppm - 1);
    BhrImage image;
    CHECK_OK(bhr_image_init(&image, sizeof image));
    const BhrStatus status = bhr_image_load(path_of("bomb.ppm"), &image);
    CHECK(status == BHR_ERROR_IO || status == BHR_ERROR_OUT_OF_MEMORY, "an impossible size gives %s",
          bhr_status_name(status));

    bombs();

    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "path", bhr_image_load(NULL, &image));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "path", bhr_image_load("", &image));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "image", bhr_image_load(path_of("rgba.png"), NULL));
    image.struct_size = 4;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "struct_size", bhr_image_load(path_of("rgba.png"), &image));
}

static void release(void) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "pixels|image", bhr_image_release(&image));
    CHECK(image.pixels == pixels, "a refused release took the host's pixels away");
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "image", bhr_image_release(NULL));

    BhrImage loaded, copy;
    CHECK_OK(bhr_image_init(&loaded, sizeof loaded));
    CHECK_OK(bhr_image_load(path_of("rgba.png"), &loaded));
    copy = loaded;
    CHECK_OK(bhr_image_release(&loaded));
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "pixels|image", bhr_image_release(&copy)); /* a second time */
}

int main(int argc, char **argv) {
    const BhrBackend backend = check_begin(argc, argv);
    if (argc < 3) {
        fprintf(stderr, "usage: %s BACKEND FOLDER\n", argv[0]);
        return 2;
    }
    folder = argv[2];
    other_users(); /* first: children have none of a context's threads */
    BhrContext *context = check_context(backend);
    round_trips(context);
    transparent(context);
    places();
    unwritable();
    unreadable();
    release();
    bhr_context_destroy(context);
    return check_end();
}
