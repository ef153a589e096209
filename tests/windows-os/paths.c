/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* paths.c -- files as Windows names, holds and refuses them. To be run in an empty folder; its first argument is a
 * backend, as every program's with this harness, and is not used. */
#include "../c/check.h"

#include <stdio.h>
#include <string.h>
#include <wchar.h>
#include <windows.h>

enum { SIDE = 16 };

static int is_there(const wchar_t *path) { return GetFileAttributesW(path) != INVALID_FILE_ATTRIBUTES; }

/* The files of this folder, so that none is left over beside those that were meant. */
static int count_files(void) {
    WIN32_FIND_DATAW found;
    HANDLE           list = FindFirstFileW(L"*", &found);
    int              count = 0;
    if (list == INVALID_HANDLE_VALUE) return -1;
    do count += !(found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY);
    while (FindNextFileW(list, &found));
    FindClose(list);
    return count;
}

static void check_same(const BhrImage *image, const char *path) {
    BhrImage loaded;
    BHR_INIT(loaded);
    if (!CHECK_OK(bhr_image_load(path, &loaded))) return;
    CHECK(loaded.byte_size == image->byte_size && memcmp(image->pixels, loaded.pixels, SIDE * SIDE * 4) == 0,
          "%s holds other pixels", path);
    CHECK_OK(bhr_image_release(&loaded));
}

int main(int argc, char **argv) {
    static unsigned char pixels[SIDE * SIDE * 4];
    static unsigned char others[sizeof pixels];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, pixels, sizeof pixels);
    BhrImage             other = image_of(BHR_FORMAT_RGBA8_SRGB, SIDE, SIDE, others, sizeof others);
    check_begin(argc, argv);
    for (size_t i = 0; i < sizeof pixels; i++) {
        pixels[i] = i % 4 == 3 ? 255 : (unsigned char)(i * 7);
        others[i] = i % 4 == 3 ? 255 : (unsigned char)(i * 5);
    }
    CHECK(count_files() == 0, "the folder is not empty");

    /* Names beyond the code page: an umlaut, Chinese, and a character of two UTF-16 units. */
    const char *names[] = {"pl\xc3\xa4in.png", "\xe9\xbb\x91\xe6\xb4\x9e.png", "\xf0\x9f\x95\xb3.png"};
    const wchar_t *wide[] = {L"pl\u00e4in.png", L"\u9ed1\u6d1e.png", L"\U0001f573.png"};
    for (size_t i = 0; i < COUNT_OF(names); i++) {
        CHECK_OK(bhr_image_save(&image, names[i]));
        CHECK(is_there(wide[i]), "name %lu has become another", (unsigned long)i);
        CHECK_OK(bhr_image_save(&image, names[i])); /* over the one that is there */
        check_same(&image, names[i]);
    }
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "UTF-8", bhr_image_save(&image, "bad\xff.png"));
    CHECK_FAILS(BHR_ERROR_IO, "", bhr_image_save(&image, "a<b>.png"));
    CHECK_FAILS(BHR_ERROR_IO, "", bhr_image_save(&image, "absent\\hole.png"));
    BhrImage absent;
    BHR_INIT(absent);
    CHECK_FAILS(BHR_ERROR_IO, "absent.png", bhr_image_load("absent.png", &absent));

    CHECK(CreateDirectoryW(L"folder", NULL), "no folder");
    CHECK_OK(bhr_image_save(&image, "folder\\back.png"));
    CHECK_OK(bhr_image_save(&image, "folder/../folder/slash.png"));
    CHECK(is_there(L"folder\\back.png") && is_there(L"folder\\slash.png"), "slashes are no matter");

    /* A file that another program holds, for itself alone and as most programs do. */
    for (int shared = 0; shared < 2; shared++) {
        const char    *name = shared ? "shared.png" : "held.png";
        const wchar_t *same = shared ? L"shared.png" : L"held.png";
        CHECK_OK(bhr_image_save(&image, name));
        HANDLE held = CreateFileW(same, GENERIC_READ, shared ? FILE_SHARE_READ : 0, NULL, OPEN_EXISTING, 0, NULL);
        CHECK(held != INVALID_HANDLE_VALUE, "%s cannot be opened", name);
        CHECK_FAILS(BHR_ERROR_IO, name, bhr_image_save(&other, name));
        CloseHandle(held);
        check_same(&image, name); /* as it was */
        CHECK_OK(bhr_image_save(&other, name));
        check_same(&other, name);
    }
    /* A program that looks at it and lets others read, write and delete: Windows 10 replaces it, Wine does not. */
    HANDLE seen = CreateFileW(L"shared.png", GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                              OPEN_EXISTING, 0, NULL);
    CHECK(seen != INVALID_HANDLE_VALUE, "shared.png cannot be opened");
    BhrStatus status = bhr_image_save(&image, "shared.png");
    CHECK(status == BHR_OK || status == BHR_ERROR_IO, "%s", bhr_status_name(status));
    CloseHandle(seen);
    check_same(status == BHR_OK ? &image : &other, "shared.png");

    CHECK_OK(bhr_image_save(&image, "fixed.png"));
    CHECK(SetFileAttributesW(L"fixed.png", FILE_ATTRIBUTE_READONLY), "no read-only file");
    CHECK_FAILS(BHR_ERROR_IO, "fixed.png", bhr_image_save(&other, "fixed.png"));
    check_same(&image, "fixed.png");
    CHECK(SetFileAttributesW(L"fixed.png", FILE_ATTRIBUTE_NORMAL), "it stays read-only");
    CHECK(count_files() == 6, "%d files are there, six were made", count_files());

    /* A path beyond MAX_PATH, which is 260: four folders with names of 100 characters, made by their extended path. */
    wchar_t here[1000], deep[2000];
    char    path[600] = "";
    DWORD   length = GetCurrentDirectoryW(COUNT_OF(here), here);
    CHECK(length > 0 && length < COUNT_OF(here), "the folder's own path has %lu characters", (unsigned long)length);
    wcscpy(deep, L"\\\\?\\");
    wcscat(deep, here);
    for (int i = 0; i < 4; i++) {
        wcscat(deep, L"\\");
        for (int c = 0; c < 100; c++) wcscat(deep, L"d");
        CHECK(CreateDirectoryW(deep, NULL), "folder %d cannot be made: error %lu", i, GetLastError());
        memset(path + strlen(path), 'd', 100); /* the rest is zero */
        strcat(path, "\\");
    }
    strcat(path, "long.png");
    wcscat(deep, L"\\long.png");
    CHECK_OK(bhr_image_save(&image, path));
    CHECK(is_there(deep), "the file is elsewhere");
    check_same(&image, path);
    CHECK_OK(bhr_image_save(&image, path)); /* over the one that is there */
    return check_end();
}
