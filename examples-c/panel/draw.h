/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// draw.h -- what the panel draws with besides Dear ImGui's widgets: an OpenGL texture, a diagram to scale, line plots,
// colours. Knows nothing of bhr.
#ifndef PANEL_DRAW_H
#define PANEL_DRAW_H

#include "vec.h"

#include <cstddef>
#include <cstdint>
#include <imgui.h>
#include <string>
#include <vector>

namespace colour {
constexpr ImU32 text = IM_COL32(222, 222, 222, 255), dim = IM_COL32(140, 144, 152, 255);
constexpr ImU32 axis = IM_COL32(255, 255, 255, 28), frame = IM_COL32(255, 255, 255, 60);
constexpr ImU32 back = IM_COL32(13, 14, 18, 255), hole = IM_COL32(0, 0, 0, 255);
constexpr ImU32 horizon = IM_COL32(235, 235, 235, 255), ergosphere = IM_COL32(150, 120, 255, 255);
constexpr ImU32 photon = IM_COL32(255, 210, 80, 255), isco = IM_COL32(90, 200, 120, 255);
constexpr ImU32 disk = IM_COL32(190, 95, 40, 110), ray = IM_COL32(110, 200, 255, 255);
constexpr ImU32 crossing = IM_COL32(255, 110, 90, 255), error = IM_COL32(255, 96, 84, 255);
} // namespace colour

// RGBA8 pixels as OpenGL holds them. Only while the OpenGL context it was used with is current.
class Texture {
public:
    Texture() = default;
    ~Texture();
    Texture(const Texture &) = delete;
    Texture &operator=(const Texture &) = delete;

    // Packed rows, the top one first. smooth: interpolated where it is drawn in another size.
    void upload(const void *pixels, uint32_t width, uint32_t height, bool smooth);

    bool        empty() const { return width_ == 0; }
    uint32_t    width() const { return width_; }
    uint32_t    height() const { return height_; }
    ImTextureID id() const { return reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(name_)); }

private:
    unsigned name_ = 0;
    uint32_t width_ = 0, height_ = 0;
};

// A part of a plane, drawn to scale into a rectangle of the current ImGui window and cut at its border. Takes the
// rectangle's place in ImGui's layout; `hovered` then says whether the mouse is in it.
class Diagram {
public:
    Diagram(const char *id, ImVec2 size, double left, double right, double bottom, double top);
    ~Diagram();
    Diagram(const Diagram &) = delete;
    Diagram &operator=(const Diagram &) = delete;

    ImVec2 at(double x, double y) const;
    // The place under the mouse.
    void   mouse(double &x, double &y) const;
    bool   hovered() const { return hovered_; }
    ImVec2 low() const { return low_; }
    ImVec2 high() const { return high_; }

    void grid(double step, ImU32 numbers = colour::dim) const; // lines every `step`, with their values
    void circle(double radius, ImU32 color, float thickness) const;   // about (0, 0)
    void disc(double radius, ImU32 color) const;                      // filled
    void ring(double inner, double outer, ImU32 color) const;         // filled between two circles
    void line(double x0, double y0, double x1, double y1, ImU32 color, float thickness) const;
    void dot(double x, double y, ImU32 color, float pixels) const;
    void curve(const std::vector<ImVec2> &screen_points, ImU32 color, float thickness) const;
    void label(ImVec2 screen, ImU32 color, const char *text) const;

private:
    float pixels(double world) const;

    ImDrawList *list_;
    ImVec2      low_, high_; // on the screen: top-left and bottom-right
    double      left_, right_, bottom_, top_;
    bool        hovered_;
};

// A step of 1, 2 or 5 times a power of ten that divides `range` into about `count` parts.
double round_step(double range, int count);

struct Series {
    const char  *name;
    const float *values;
    ImU32        color;
};

// Values from left to right, each series of the same count, NaN left out, above a common axis that begins at 0; its top
// is written with `format`. marker: an index to mark, or < 0.
void line_plot(const char *id, ImVec2 size, const std::vector<Series> &series, size_t count, const char *format,
               int marker);

// The colour of a number in -1 .. 1: blue, white at 0, red.
ImU32 diverging(double value);

// Words of a legend in colours of their own; all but the first go on the line of the one before where they fit.
void legend(const char *text, ImU32 color, bool first = false);

#endif
