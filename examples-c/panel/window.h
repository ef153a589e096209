/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// window.h -- the program's window: GLFW, OpenGL and Dear ImGui from their start to their end. Knows nothing of bhr but
// how an image in memory is described.
#ifndef PANEL_WINDOW_H
#define PANEL_WINDOW_H

#include "frames.h"

#include <imgui.h>
#include <string>

struct GLFWwindow;

class Window {
public:
    Window() = default;
    ~Window();
    Window(const Window &) = delete;
    Window &operator=(const Window &) = delete;

    // A size of 0 is what the screen has room for of the usual one. Returns "", or why there is no window.
    std::string open(uint32_t width, uint32_t height, const char *title);

    // By its frame or the Escape key.
    bool closed() const;
    // The key that was pressed with Ctrl since it was last asked for, such as 'z', by the keyboard's layout and outside
    // of text fields; '\0': none.
    char shortcut();
    // Sleeps until there is input, at most so long. True when there was some.
    bool wait(double seconds);
    // False while the window has no pixels, minimised: then nothing may be drawn.
    bool begin_frame();
    // Draws what ImGui was told since begin_frame, copies it into `copy` unless NULL, and shows it.
    void end_frame(Pixels *copy);
    // Pixels per unit of ImGui's coordinates.
    double pixel_ratio() const;

private:
    static void on_input(GLFWwindow *window);
    void        start_imgui();

    GLFWwindow *window_ = nullptr;
    bool        glfw_ = false, imgui_ = false;
    bool        input_ = false; // since wait last asked
    char        shortcut_ = '\0';
};

#endif
