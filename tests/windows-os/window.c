/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* window.c -- frames in a plain Win32 window: shown, resized, minimised and back; then the window is destroyed before
 * its surface. As long as all goes well, the log has no errors, whatever adapters were tried and passed over.
 *
 *     window BACKEND SHOWN GO FRAME       writes what the window should show to FRAME, makes the file SHOWN once the
 *                                         window shows it, and goes on once GO is there
 */
#include "../c/check.h"

#include <stdio.h>
#include <windows.h>

static LRESULT CALLBACK on_message(HWND window, UINT message, WPARAM w, LPARAM l) {
    return DefWindowProcW(window, message, w, l);
}

static void pump(void) {
    MSG message;
    while (PeekMessageW(&message, NULL, 0, 0, PM_REMOVE)) {
        TranslateMessage(&message);
        DispatchMessageW(&message);
    }
}

/* Renders until so many frames are in the window, or the time is over. How many there were. */
static int frames(BhrContext *context, BhrSurface *surface, int count) {
    double end = seconds_now() + 60;
    int    shown = 0;
    while (shown < count && seconds_now() < end) {
        pump();
        BhrStatus status = bhr_render_surface(context, surface);
        if (!CHECK(status >= 0, "%s: %s", bhr_status_name(status), bhr_error_message())) return shown;
        shown += status != BHR_FRAME_SKIPPED;
        if (status == BHR_FRAME_SKIPPED) Sleep(10);
    }
    return shown;
}

/* Messages of level ERROR, and the last of them. */
static volatile LONG errors;
static char          last_error[200];

static void hear(void *user, BhrLogLevel level, const char *message) {
    (void)user;
    if (level != BHR_LOG_ERROR) return;
    InterlockedIncrement(&errors);
    snprintf(last_error, sizeof last_error, "%s", message);
}

static int is_file(const char *path) { return GetFileAttributesA(path) != INVALID_FILE_ATTRIBUTES; }

int main(int argc, char **argv) {
    BhrContextOptions options = check_options(check_begin(argc, argv));
    BhrContext       *context = NULL;
    BhrSurface       *surface = NULL;
    BhrCamera         camera;
    BhrWindow         target;
    WNDCLASSW         class = {0};
    if (argc != 5) return 2;
    class.lpfnWndProc = on_message;
    class.hInstance = GetModuleHandleW(NULL);
    class.lpszClassName = L"bhr";
    RegisterClassW(&class);
    /* Without a frame, so that all of it is bhr's. */
    HWND window = CreateWindowW(L"bhr", L"bhr", WS_POPUP | WS_VISIBLE, 40, 40, 480, 300, NULL, NULL, class.hInstance,
                                NULL);
    if (!CHECK(window != NULL, "no window: error %lu", GetLastError())) return check_end();
    pump();

    options.log_level = BHR_LOG_ERROR;
    options.log_fn = hear;
    if (!CHECK_OK(bhr_context_create(BHR_ABI_VERSION, &options, &context))) return check_end();
    BHR_INIT(camera);
    CHECK_OK(bhr_camera_orbit(&camera, 25.0, 0.0, 0.15));
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_spin(context, 0.9));
    BHR_INIT(target);
    target.kind = BHR_WINDOW_WIN32;
    target.handle = window;
    target.aux = class.hInstance;
    if (!CHECK_OK(bhr_surface_create(context, &target, 480, 300, BHR_PRESENT_VSYNC, &surface))) return check_end();

    int shown = frames(context, surface, 3);
    CHECK(shown == 3, "%d frames", shown);
    /* This frame in memory, too: the script compares the screen with it. */
    static unsigned char pixels[480 * 300 * 4];
    BhrImage             image = image_of(BHR_FORMAT_RGBA8_SRGB, 480, 300, pixels, sizeof pixels);
    CHECK_OK(bhr_render_image(context, &image));
    FILE *frame = fopen(argv[4], "wb");
    if (CHECK(frame != NULL, "%s cannot be made", argv[4])) {
        CHECK(fwrite(pixels, 1, sizeof pixels, frame) == sizeof pixels, "%s was not written", argv[4]);
        fclose(frame);
    }
    FILE *mark = fopen(argv[2], "w");
    if (CHECK(mark != NULL, "%s cannot be made", argv[2])) fclose(mark);
    for (int i = 0; i < 600 && !is_file(argv[3]); i++) {
        pump();
        Sleep(50);
    }
    CHECK(is_file(argv[3]), "nobody has looked at the window");

    CHECK(SetWindowPos(window, NULL, 60, 60, 320, 200, SWP_NOZORDER), "it keeps its size");
    pump();
    CHECK_OK(bhr_surface_resize(surface, 320, 200));
    shown = frames(context, surface, 2);
    CHECK(shown == 2, "%d frames after a change of size", shown);

    /* Minimised it has no area: frames are skipped or shown, and none fails. */
    ShowWindow(window, SW_MINIMIZE);
    for (int i = 0; i < 5; i++) {
        pump();
        BhrStatus status = bhr_render_surface(context, surface);
        CHECK(status >= 0, "minimised: %s: %s", bhr_status_name(status), bhr_error_message());
    }
    ShowWindow(window, SW_RESTORE);
    pump();
    CHECK_OK(bhr_surface_resize(surface, 320, 200));
    shown = frames(context, surface, 2);
    CHECK(shown == 2, "%d frames after it came back", shown);

    CHECK(errors == 0, "%ld errors in the log, the last: %s", (long)errors, last_error);

    /* The header wants the surface destroyed first. A host that errs gets a status, or frames that nobody sees. */
    DestroyWindow(window);
    pump();
    BhrStatus status = bhr_render_surface(context, surface);
    CHECK(status == BHR_ERROR_SURFACE_LOST || status >= 0, "%s", bhr_status_name(status));
    printf("without its window: %s\n", bhr_status_name(status));
    bhr_surface_destroy(surface);
    bhr_context_destroy(context);
    return check_end();
}
