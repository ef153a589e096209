// SPDX-License-Identifier: MIT OR Apache-2.0
// panel.cpp -- a black hole inside another program: frames come through asynchronous jobs into the program's own
// memory and are shown as an OpenGL texture, among panels that set and measure everything. For C++ hosts that have a
// picture to fill and no window to give away. This file: command line, context, exit status.
//
//   panel/handles.h    bhr's handles as C++ objects           panel/settings     hole, camera, disk ..: the widgets
//   panel/frames       jobs and the memory they write to      panel/picture      the picture, and the mouse on it
//   panel/scene        the scene, through bhr's setters       panel/ray_panel    a ray in numbers, and drawn to scale
//   panel/inspector    rays and the metric, asked at once     panel/metric_map   g_tt over a plane
//   panel/app          the loop                               panel/steps_plot   integration steps
//   panel/window       GLFW, OpenGL, Dear ImGui               panel/performance  how fast frames come
//   panel/files        scene files, undo and redo             panel/history      the texts for that
//   panel/sections     windows that scroll                    panel/widgets      a value's widget, message and tip
//   panel/light_scope  histogram and waveform                 panel/comparison   two settings, and a line between them
//   panel/colour_legend  the bar beneath false colours
#include "options.h"
#include "panel/app.h"

#include <cstdio>
#include <cstdlib>

namespace {

int show(int32_t backend, const AppOptions &options) {
    BhrContextOptions wanted = with_defaults(bhr_context_options_init);
    wanted.backend = backend;
    if (options.verbose != 0) {
        wanted.log_level = BHR_LOG_INFO;
        wanted.log_fn = log_to_stderr;
    }
    BhrContext     *made = nullptr;
    const BhrStatus status = bhr_context_create(BHR_ABI_VERSION, &wanted, &made);
    if (status < 0) {
        return report_failure("create a context", status);
    }
    const Context     context(made); // ends after the app, which has frames under way on it
    App               app(context.get(), options);
    const std::string problem = app.start();
    if (!problem.empty()) {
        std::fprintf(stderr, "cannot start: %s\n", problem.c_str());
        return EXIT_FAILURE;
    }
    return app.run();
}

} // namespace

int main(int argc, char **argv) {
    AppOptions options;
    int32_t    backend = BHR_BACKEND_AUTO;
    int        help = 0;
    const Option table[] = {
        {"--size", OPTION_SIZE, options.size, "WxH", "of the window; 0x0: what the screen has room for", nullptr,
         nullptr},
        {"--backend", OPTION_CHOICE, &backend, nullptr, "what traces the light", BACKENDS, nullptr},
        {"--preset", OPTION_CHOICE, &options.preset, nullptr, "the look that it begins with", PRESETS, nullptr},
        {"--matter", OPTION_CHOICE, &options.matter, nullptr,
         "of presets: a thin disk, a volume, or the volume where it is fast", PRESET_MATTERS, nullptr},
        {"--paused", OPTION_FLAG, &options.paused, nullptr, "begins with the scene's time at rest", nullptr, nullptr},
        {"--bare", OPTION_FLAG, &options.bare, nullptr, "nothing but the picture, at the window's size",
         nullptr, nullptr},
        {"--frames", OPTION_UINT, &options.frames, "N", "ends after N pictures, the same ones each time; 0: never",
         nullptr, nullptr},
        {"--hold", OPTION_DOUBLE, &options.hold, "SECONDS", "ends after so long, or so long after --frames; -1: never",
         nullptr, nullptr},
        {"--screenshot", OPTION_TEXT, &options.screenshot, "FILE", "at the end saves the window's content",
         nullptr, nullptr},
        {"--picture", OPTION_TEXT, &options.picture, "FILE", "at the end saves the last picture", nullptr, nullptr},
        {"--verbose", OPTION_FLAG, &options.verbose, nullptr, "tells what happens: stdout; bhr's log: stderr",
         nullptr, nullptr},
        {"--help", OPTION_FLAG, &help, nullptr, "this text", nullptr, nullptr},
    };
    const int result = options_parse(table, COUNT_OF(table), argc, argv);
    if (result != 0) {
        return result;
    }
    if (help != 0) {
        std::puts("Usage: panel [options]\n"
                  "A black hole to look at, set and measure. Drag: about the hole; wheel: nearer;\n"
                  "click: the pixel's ray; Ctrl and a click on a slider: type a number; Ctrl-Z, Ctrl-Y:\n"
                  "undo and redo; Escape: end.\n");
        options_print(stdout, table, COUNT_OF(table));
        return EXIT_SUCCESS;
    }
    const uint32_t *size = options.size;
    if ((size[0] == 0) != (size[1] == 0) || size[0] > 16384 || size[1] > 16384) {
        std::fprintf(stderr, "%s: --size takes sides of 1 to 16384, or 0x0\n", argv[0]);
        return EXIT_USAGE;
    }
    say_at_once();
    return show(backend, options);
}
