/* files.c -- saving and loading: round trips that keep every bit, files that cannot be read or written, files that
 * lie. Works in the folder named by its second argument, which must exist and be empty. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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

static void unwritable(void) {
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, WIDTH, HEIGHT, pixels, sizeof pixels);
    CHECK_FAILS(BHR_ERROR_IO, "absent", bhr_image_save(&image, path_of("absent/frame.png")));
    CHECK(mkdir(path_of("folder.png"), 0777) == 0, "cannot make a folder");
    CHECK_FAILS(BHR_ERROR_IO, "folder.png", bhr_image_save(&image, path_of("folder.png")));
    /* A disk that is full only when the bytes arrive. */
    if (access("/dev/full", W_OK) == 0 && symlink("/dev/full", path_of("full.png")) == 0) {
        CHECK_FAILS(BHR_ERROR_IO, "full.png", bhr_image_save(&image, path_of("full.png")));
    }
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
    BhrContext *context = check_context(check_begin(argc, argv));
    if (argc < 3) {
        fprintf(stderr, "usage: %s BACKEND FOLDER\n", argv[0]);
        return 2;
    }
    folder = argv[2];
    round_trips(context);
    unwritable();
    unreadable();
    release();
    bhr_context_destroy(context);
    return check_end();
}
