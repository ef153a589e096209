/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* host.c -- see host.h. */
#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static LRESULT CALLBACK on_message(HWND window, UINT message, WPARAM w, LPARAM l) {
    return DefWindowProcW(window, message, w, l);
}

HWND host_open(int x, int y, int width, int height) {
    static int is_registered;
    HINSTANCE  program = GetModuleHandleW(NULL);
    if (!is_registered) {
        WNDCLASSW class = {0};
        class.lpfnWndProc = on_message;
        class.hInstance = program;
        class.lpszClassName = L"bhr";
        is_registered = RegisterClassW(&class) != 0;
    }
    HWND window =
        CreateWindowW(L"bhr", L"bhr", WS_POPUP | WS_VISIBLE, x, y, width, height, NULL, NULL, program, NULL);
    CHECK(window != NULL, "no window: error %lu", GetLastError());
    host_pump();
    return window;
}

BhrWindow host_window(HWND window) {
    BhrWindow target;
    BHR_INIT(target);
    target.kind = BHR_WINDOW_WIN32;
    target.handle = window;
    return target;
}

BhrSurface *host_surface(BhrContext *context, HWND window, uint32_t width, uint32_t height, BhrPresentMode mode) {
    BhrWindow   target = host_window(window);
    BhrSurface *surface = NULL;
    CHECK_OK(bhr_surface_create(context, &target, width, height, mode, &surface));
    return surface;
}

void host_pump(void) {
    MSG message;
    while (PeekMessageW(&message, NULL, 0, 0, PM_REMOVE)) {
        TranslateMessage(&message);
        DispatchMessageW(&message);
    }
}

int host_frames(BhrContext *context, BhrSurface *surface, int count) {
    double end = seconds_now() + 60;
    int    shown = 0;
    while (shown < count && seconds_now() < end) {
        host_pump();
        BhrStatus status = bhr_render_surface(context, surface);
        if (!CHECK(status >= 0, "%s: %s", bhr_status_name(status), bhr_error_message())) return shown;
        shown += status != BHR_FRAME_SKIPPED;
        if (status == BHR_FRAME_SKIPPED) Sleep(10);
    }
    return shown;
}

static volatile LONG errors, detours;
static char          last_error[200];

static void hear(void *user, BhrLogLevel level, const char *message) {
    (void)user;
    if (strstr(message, "frames of this window are") != NULL) InterlockedIncrement(&detours);
    if (level != BHR_LOG_ERROR) return;
    InterlockedIncrement(&errors);
    snprintf(last_error, sizeof last_error, "%s", message);
}

BhrContext *host_context(BhrBackend backend) {
    BhrContextOptions options = check_options(backend);
    options.log_level = BHR_LOG_INFO;
    options.log_fn = hear;
    return check_context_with(&options);
}

LONG        host_errors(void) { return errors; }
const char *host_last_error(void) { return last_error; }
LONG        host_detours(void) { return detours; }

void host_save_frame(BhrContext *context, uint32_t width, uint32_t height, const char *path) {
    size_t         bytes = (size_t)width * height * 4;
    unsigned char *pixels = malloc(bytes);
    if (!CHECK(pixels != NULL, "no memory")) return;
    BhrImage image = image_of(BHR_FORMAT_RGBA8_SRGB, width, height, pixels, bytes);
    CHECK_OK(bhr_render_image(context, &image));
    FILE *file = fopen(path, "wb");
    if (CHECK(file != NULL, "%s cannot be made", path)) {
        CHECK(fwrite(pixels, 1, bytes, file) == bytes, "%s was not written", path);
        fclose(file);
    }
    free(pixels);
}

static int is_file(const char *path) { return GetFileAttributesA(path) != INVALID_FILE_ATTRIBUTES; }

void host_wait_for_onlooker(const char *shown, const char *go) {
    FILE *mark = fopen(shown, "w");
    if (CHECK(mark != NULL, "%s cannot be made", shown)) fclose(mark);
    for (int i = 0; i < 600 && !is_file(go); i++) {
        host_pump();
        Sleep(50);
    }
    CHECK(is_file(go), "nobody has looked at the window");
}
