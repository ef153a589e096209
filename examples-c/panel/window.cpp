// SPDX-License-Identifier: MIT OR Apache-2.0
// window.cpp -- see window.h.
#include "window.h"

#include "draw.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fstream>

namespace {

constexpr float TEXT_SIZE = 14.0F;
constexpr int   USUAL_SIZE[2] = {1600, 1000};
constexpr int   FRAME[2] = {16, 48}; // room that a window's frame and title take, about

std::string glfw_failure(const char *what) {
    const char *reason = nullptr;
    glfwGetError(&reason);
    return std::string("cannot ") + what + ": " + (reason != nullptr ? reason : "GLFW does not say why");
}

// Makes the usual size no larger than the first screen has room for beside its bars.
void fit_to_screen(int size[2]) {
    int          x = 0, y = 0, room[2] = {0, 0};
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    if (monitor != nullptr) {
        glfwGetMonitorWorkarea(monitor, &x, &y, &room[0], &room[1]);
    }
    for (int i = 0; i < 2; i++) {
        const int most = room[i] - FRAME[i];
        size[i] = most > 0 ? std::min(USUAL_SIZE[i], most) : USUAL_SIZE[i];
    }
}

// A font that most systems have, for ImGui's own is made for 13 pixels only.
void load_font(float size) {
    constexpr const char *usual_places[] = {
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",          // Debian
        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",        // Fedora
        "/usr/share/fonts/TTF/DejaVuSans.ttf",                      // Arch
        "/System/Library/Fonts/Supplemental/Verdana.ttf",           // macOS
        "C:\\Windows\\Fonts\\segoeui.ttf"};
    ImFontAtlas *atlas = ImGui::GetIO().Fonts;
    for (const char *place : usual_places) {
        // ImGui treats a file that is not there as a bug of the program's.
        if (std::ifstream(place).good() && atlas->AddFontFromFileTTF(place, size) != nullptr) {
            return;
        }
    }
    ImFontConfig config;
    config.SizePixels = size;
    atlas->AddFontDefault(&config);
}

void choose_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle &style = ImGui::GetStyle();
    style.WindowPadding = {8.0F, 6.0F};
    style.FramePadding = {5.0F, 1.5F};
    style.ItemSpacing = {6.0F, 2.0F};
    style.CellPadding = {4.0F, 1.0F};
    style.FrameRounding = 3.0F;
    style.GrabRounding = 3.0F;
    style.ScrollbarSize = 10.0F;
    style.WindowBorderSize = 1.0F;
    style.Colors[ImGuiCol_WindowBg] = {0.075F, 0.08F, 0.095F, 1.0F};
    style.Colors[ImGuiCol_TitleBg] = style.Colors[ImGuiCol_TitleBgActive] = {0.11F, 0.14F, 0.20F, 1.0F};
    style.Colors[ImGuiCol_Header] = {0.13F, 0.19F, 0.30F, 1.0F};
    style.Colors[ImGuiCol_FrameBg] = {0.14F, 0.16F, 0.20F, 1.0F};
    style.Colors[ImGuiCol_SliderGrab] = {0.33F, 0.55F, 0.86F, 1.0F};
    style.Colors[ImGuiCol_CheckMark] = {0.45F, 0.70F, 1.0F, 1.0F};
    style.Colors[ImGuiCol_Border] = {1.0F, 1.0F, 1.0F, 0.09F};
    style.ScaleAllSizes(scale);
    style.WindowMinSize = {1.0F, 1.0F}; // the picture follows a window of any size
}

} // namespace

void Window::on_input(GLFWwindow *window) {
    static_cast<Window *>(glfwGetWindowUserPointer(window))->input_ = true;
}

std::string Window::open(uint32_t width, uint32_t height, const char *title) {
    glfw_ = glfwInit() == GLFW_TRUE;
    if (!glfw_) {
        return glfw_failure("start GLFW (is there a display?)");
    }
    // The oldest version that every system with a core profile has.
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 2);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    // A size that was asked for means the same to the eye on displays of any density; the screen's is in its own units.
    int size[2] = {static_cast<int>(width), static_cast<int>(height)};
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, width != 0 ? GLFW_TRUE : GLFW_FALSE);
    if (width == 0) {
        fit_to_screen(size);
    }
    window_ = glfwCreateWindow(size[0], size[1], title, nullptr, nullptr);
    if (window_ == nullptr) {
        return glfw_failure("open a window with OpenGL 3.2");
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    start_imgui();
    return "";
}

void Window::start_imgui() {
    glfwSetWindowUserPointer(window_, this);
    // Set before ImGui's own callbacks, which go on to these.
    glfwSetCursorPosCallback(window_, [](GLFWwindow *window, double, double) { on_input(window); });
    glfwSetCursorEnterCallback(window_, [](GLFWwindow *window, int) { on_input(window); });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow *window, int, int, int) { on_input(window); });
    glfwSetScrollCallback(window_, [](GLFWwindow *window, double, double) { on_input(window); });
    glfwSetKeyCallback(window_, [](GLFWwindow *window, int key, int scancode, int action, int mods) {
        on_input(window);
        const char *name = glfwGetKeyName(key, scancode);
        if (name != nullptr && mods == GLFW_MOD_CONTROL && action != GLFW_RELEASE && !ImGui::GetIO().WantTextInput) {
            static_cast<Window *>(glfwGetWindowUserPointer(window))->shortcut_ = name[0];
        }
        // Not by ImGui, which sees only keys that are down when a frame begins. In a text field Escape leaves it.
        if (key == GLFW_KEY_ESCAPE && action == GLFW_PRESS && !ImGui::GetIO().WantTextInput) {
            glfwSetWindowShouldClose(window, GLFW_TRUE);
        }
    });
    glfwSetCharCallback(window_, [](GLFWwindow *window, unsigned) { on_input(window); });
    glfwSetWindowFocusCallback(window_, [](GLFWwindow *window, int) { on_input(window); });
    glfwSetFramebufferSizeCallback(window_, [](GLFWwindow *window, int, int) { on_input(window); });
    glfwSetWindowRefreshCallback(window_, on_input);

    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; // the arrangement is the program's, and no file is left behind
    float scale = 1.0F;
    glfwGetWindowContentScale(window_, &scale, nullptr);
    // Where a screen unit is several pixels (macOS) it is ImGui that scales, else the program does.
    scale = std::max(1.0F, scale / static_cast<float>(pixel_ratio()));
    choose_style(scale);
    load_font(TEXT_SIZE * scale);
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 150");
    imgui_ = true;
}

Window::~Window() {
    if (imgui_) {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
    if (window_ != nullptr) {
        glfwDestroyWindow(window_);
    }
    if (glfw_) {
        glfwTerminate();
    }
}

bool Window::closed() const {
    return glfwWindowShouldClose(window_) != 0;
}

char Window::shortcut() {
    const char pressed = shortcut_;
    shortcut_ = '\0';
    return pressed;
}

bool Window::wait(double seconds) {
    glfwWaitEventsTimeout(seconds);
    const bool input = input_;
    input_ = false;
    return input;
}

double Window::pixel_ratio() const {
    int width = 0, pixels = 0;
    glfwGetWindowSize(window_, &width, nullptr);
    glfwGetFramebufferSize(window_, &pixels, nullptr);
    return width > 0 && pixels > 0 ? static_cast<double>(pixels) / width : 1.0;
}

bool Window::begin_frame() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (width == 0 || height == 0) {
        return false;
    }
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    return true;
}

// The window's pixels as they were drawn just now. OpenGL's first row is the lowest one.
static void copy_window(int width, int height, Pixels &copy) {
    const size_t row = size_t{4} * static_cast<size_t>(width);
    copy.bytes.resize(row * static_cast<size_t>(height));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, copy.bytes.data());
    for (size_t i = 3; i < copy.bytes.size(); i += 4) {
        copy.bytes[i] = 255; // a window's alpha means nothing
    }
    copy.image = with_defaults(bhr_image_init);
    copy.image.width = static_cast<uint32_t>(width);
    copy.image.height = static_cast<uint32_t>(height);
    copy.image.flags = BHR_IMAGE_BOTTOM_UP;
    copy.image.pixels = copy.bytes.data();
    copy.image.byte_size = copy.bytes.size();
}

void Window::end_frame(Pixels *copy) {
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    glViewport(0, 0, width, height);
    glClearColor(0.03F, 0.03F, 0.04F, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (copy != nullptr) {
        copy_window(width, height, *copy);
    }
    glfwSwapBuffers(window_);
}
