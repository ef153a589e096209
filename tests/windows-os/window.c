/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* window.c -- frames in a plain Win32 window: shown, resized, minimised and back; then the window is destroyed before
 * its surface. As long as all goes well, the log has no errors, whatever adapters were tried and passed over.
 *
 *     window BACKEND SHOWN GO FRAME       writes what the window should show to FRAME, makes the file SHOWN once the
 *                                         window shows it, and goes on once GO is there
 */
#include "host.h"

/* A window that was destroyed, or never was. */
static void is_no_window(BhrContext *context, BhrBackend backend, HWND window) {
    BhrWindow         target = host_window(window);
    BhrSurface       *surface = NULL;
    BhrContext       *other = NULL;
    BhrContextOptions options = check_options(backend);
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "window",
                bhr_surface_create(context, &target, 48, 32, BHR_PRESENT_VSYNC, &surface));
    options.compatible_window = &target;
    CHECK_FAILS(BHR_ERROR_INVALID_ARGUMENT, "window", bhr_context_create(BHR_ABI_VERSION, &options, &other));
    CHECK(surface == NULL && other == NULL, "something was made");
}

int main(int argc, char **argv) {
    BhrBackend backend = check_begin(argc, argv);
    BhrCamera  camera;
    if (argc != 5) return 2;
    HWND window = host_open(40, 40, 480, 300);
    if (window == NULL) return check_end();

    BhrContext *context = host_context(backend);
    BHR_INIT(camera);
    CHECK_OK(bhr_camera_orbit(&camera, 25.0, 0.0, 0.15));
    CHECK_OK(bhr_set_camera(context, &camera));
    CHECK_OK(bhr_set_spin(context, 0.9));
    BhrSurface *surface = host_surface(context, window, 480, 300, BHR_PRESENT_VSYNC);
    if (surface == NULL) return check_end();

    int shown = host_frames(context, surface, 3);
    CHECK(shown == 3, "%d frames", shown);
    /* Frames of the CPU tracer are presented by another adapter or as memory, and one message says so; Vulkan and
     * Direct3D 12 present their own frames, without a message. */
    CHECK(host_detours() == (backend == BHR_BACKEND_CPU), "%ld messages about the window", (long)host_detours());
    host_save_frame(context, 480, 300, argv[4]);
    host_wait_for_onlooker(argv[2], argv[3]);

    CHECK(SetWindowPos(window, NULL, 60, 60, 320, 200, SWP_NOZORDER), "it keeps its size");
    host_pump();
    CHECK_OK(bhr_surface_resize(surface, 320, 200));
    shown = host_frames(context, surface, 2);
    CHECK(shown == 2, "%d frames after a change of size", shown);

    /* Minimised it has no area: frames are skipped or shown, and none fails. */
    ShowWindow(window, SW_MINIMIZE);
    for (int i = 0; i < 5; i++) {
        host_pump();
        BhrStatus status = bhr_render_surface(context, surface);
        CHECK(status >= 0, "minimised: %s: %s", bhr_status_name(status), bhr_error_message());
    }
    ShowWindow(window, SW_RESTORE);
    host_pump();
    CHECK_OK(bhr_surface_resize(surface, 320, 200));
    shown = host_frames(context, surface, 2);
    CHECK(shown == 2, "%d frames after it came back", shown);

    CHECK(host_errors() == 0, "%ld errors in the log, the last: %s", (long)host_errors(), host_last_error());

    /* The header wants the surface destroyed first. A host that errs is told. */
    DestroyWindow(window);
    host_pump();
    CHECK_FAILS(BHR_ERROR_SURFACE_LOST, "gone", bhr_render_surface(context, surface));
    bhr_surface_destroy(surface);
    is_no_window(context, backend, window);
    is_no_window(context, backend, (HWND)(INT_PTR)0x7654321);
    bhr_context_destroy(context);
    return check_end();
}
