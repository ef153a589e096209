// SPDX-License-Identifier: MIT OR Apache-2.0
// draw.cpp -- see draw.h.
#include "draw.h"

#include <GLFW/glfw3.h>
#include <cstdio>

#ifndef GL_CLAMP_TO_EDGE // OpenGL 1.2; Windows' header stops at 1.1
#define GL_CLAMP_TO_EDGE 0x812F
#endif

// ---- texture ----

Texture::~Texture() {
    if (name_ != 0) {
        glDeleteTextures(1, &name_);
    }
}

void Texture::upload(const void *pixels, uint32_t width, uint32_t height, bool smooth) {
    if (name_ == 0) {
        glGenTextures(1, &name_);
    }
    glBindTexture(GL_TEXTURE_2D, name_);
    // No mipmaps exist: the default filter, which wants them, would show nothing.
    const GLint filter = smooth ? GL_LINEAR : GL_NEAREST;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    const auto columns = static_cast<GLsizei>(width), rows = static_cast<GLsizei>(height);
    if (width == width_ && height == height_) {
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, columns, rows, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
        return;
    }
    // Not an sRGB format: ImGui's shader and window pass bytes through as they are.
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, columns, rows, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    width_ = width;
    height_ = height;
}

// ---- diagram ----

Diagram::Diagram(const char *id, ImVec2 size, double left, double right, double bottom, double top)
    : list_(ImGui::GetWindowDrawList()), low_(ImGui::GetCursorScreenPos()), high_(low_.x + size.x, low_.y + size.y),
      left_(left), right_(right), bottom_(bottom), top_(top) {
    ImGui::InvisibleButton(id, size);
    hovered_ = ImGui::IsItemHovered();
    list_->AddRectFilled(low_, high_, colour::back);
    list_->PushClipRect(low_, high_, true);
}

Diagram::~Diagram() {
    list_->PopClipRect();
    list_->AddRect(low_, high_, colour::frame);
}

ImVec2 Diagram::at(double x, double y) const {
    return {low_.x + static_cast<float>((x - left_) / (right_ - left_)) * (high_.x - low_.x),
            low_.y + static_cast<float>((top_ - y) / (top_ - bottom_)) * (high_.y - low_.y)};
}

void Diagram::mouse(double &x, double &y) const {
    const ImVec2 mouse = ImGui::GetMousePos();
    x = left_ + (right_ - left_) * static_cast<double>((mouse.x - low_.x) / (high_.x - low_.x));
    y = top_ - (top_ - bottom_) * static_cast<double>((mouse.y - low_.y) / (high_.y - low_.y));
}

float Diagram::pixels(double world) const {
    return static_cast<float>(world / (right_ - left_)) * (high_.x - low_.x);
}

void Diagram::grid(double step, ImU32 numbers) const {
    char text[32];
    for (double x = std::ceil(left_ / step) * step; x <= right_; x += step) {
        line(x, bottom_, x, top_, colour::axis, 1.0F);
        std::snprintf(text, sizeof text, "%g", std::abs(x) < 1e-9 * step ? 0.0 : x);
        const float left = at(x, 0.0).x + 2.0F;
        if (left + ImGui::CalcTextSize(text).x <= high_.x) { // half a number would be another one
            label({left, high_.y - ImGui::GetFontSize() - 1.0F}, numbers, text);
        }
    }
    for (double y = std::ceil(bottom_ / step) * step; y <= top_; y += step) {
        line(left_, y, right_, y, colour::axis, 1.0F);
    }
}

// Enough corners that no edge shows, however far the view is zoomed in; drawn by hand because ImGui chooses too few
// for circles that are much larger than the window.
static std::vector<ImVec2> circle_points(const Diagram &diagram, double radius, bool backward = false) {
    constexpr int       corners = 256;
    std::vector<ImVec2> points;
    for (int i = 0; i < corners; i++) {
        const double angle = (backward ? -i : i) * 360.0 * DEGREE / corners;
        points.push_back(diagram.at(radius * std::cos(angle), radius * std::sin(angle)));
    }
    return points;
}

void Diagram::circle(double radius, ImU32 color, float thickness) const {
    const std::vector<ImVec2> points = circle_points(*this, radius);
    list_->AddPolyline(points.data(), static_cast<int>(points.size()), color, ImDrawFlags_Closed, thickness);
}

void Diagram::disc(double radius, ImU32 color) const {
    const std::vector<ImVec2> points = circle_points(*this, radius);
    list_->AddConvexPolyFilled(points.data(), static_cast<int>(points.size()), color);
}

void Diagram::ring(double inner, double outer, ImU32 color) const {
    // Without antialiasing: the seams between the quadrangles of a translucent colour would show.
    const ImDrawListFlags flags = list_->Flags;
    list_->Flags &= ~ImDrawListFlags_AntiAliasedFill;
    const std::vector<ImVec2> in = circle_points(*this, inner), out = circle_points(*this, outer);
    for (size_t i = 0; i < in.size(); i++) {
        const size_t next = (i + 1) % in.size();
        list_->AddQuadFilled(in[i], in[next], out[next], out[i], color);
    }
    list_->Flags = flags;
}

void Diagram::line(double x0, double y0, double x1, double y1, ImU32 color, float thickness) const {
    list_->AddLine(at(x0, y0), at(x1, y1), color, thickness);
}

void Diagram::dot(double x, double y, ImU32 color, float size) const {
    list_->AddCircleFilled(at(x, y), size, color);
}

void Diagram::curve(const std::vector<ImVec2> &screen_points, ImU32 color, float thickness) const {
    const auto count = static_cast<int>(screen_points.size());
    list_->AddPolyline(screen_points.data(), count, color, ImDrawFlags_None, thickness);
}

void Diagram::label(ImVec2 screen, ImU32 color, const char *text) const {
    list_->AddText(screen, color, text);
}

double round_step(double range, int count) {
    const double rough = range / count, power = std::pow(10.0, std::floor(std::log10(rough)));
    const double mantissa = rough / power;
    return power * (mantissa < 1.5 ? 1.0 : mantissa < 3.5 ? 2.0 : mantissa < 7.5 ? 5.0 : 10.0);
}

// ---- plots ----

void line_plot(const char *id, ImVec2 size, const std::vector<Series> &series, size_t count, const char *format,
               int marker) {
    float highest = 0.0F;
    for (const Series &one : series) {
        for (size_t i = 0; i < count; i++) {
            highest = std::isfinite(one.values[i]) ? std::max(highest, one.values[i]) : highest;
        }
    }
    const double  step = round_step(highest > 0.0F ? 1.05 * static_cast<double>(highest) : 1.0, 3);
    const double  top = step * std::ceil(std::max(1.05 * static_cast<double>(highest), step) / step);
    const double  last = count > 1 ? static_cast<double>(count - 1) : 1.0;
    const Diagram plot(id, size, 0.0, last, 0.0, top);
    char          text[32];
    for (double y = step; y < 1.001 * top; y += step) {
        plot.line(0.0, y, last, y, colour::axis, 1.0F);
        std::snprintf(text, sizeof text, format, y);
        plot.label({plot.low().x + 3.0F, plot.at(0.0, y).y + 1.0F}, colour::dim, text);
    }
    if (marker >= 0) {
        plot.line(marker, 0.0, marker, top, colour::crossing, 1.0F);
    }
    for (const Series &one : series) {
        std::vector<ImVec2> points;
        for (size_t i = 0; i <= count; i++) {
            if (i < count && std::isfinite(one.values[i])) {
                points.push_back(plot.at(static_cast<double>(i), static_cast<double>(one.values[i])));
            } else {
                plot.curve(points, one.color, 1.5F);
                points.clear();
            }
        }
    }
}

ImU32 diverging(double value) {
    if (!std::isfinite(value)) {
        return colour::hole;
    }
    // Cool to warm through white, even in lightness (Moreland 2009).
    constexpr double cold[3] = {38.0, 92.0, 190.0}, middle[3] = {240.0, 240.0, 238.0}, warm[3] = {190.0, 32.0, 40.0};
    const double    *end = value < 0.0 ? cold : warm;
    const double     share = std::min(std::abs(value), 1.0);
    int              channel[3];
    for (int i = 0; i < 3; i++) {
        channel[i] = static_cast<int>(std::lround(middle[i] + share * (end[i] - middle[i])));
    }
    return IM_COL32(channel[0], channel[1], channel[2], 255);
}

void legend(const char *text, ImU32 color, bool first) {
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    const float space = ImGui::GetStyle().ItemSpacing.x;
    if (!first && ImGui::GetItemRectMax().x + space + ImGui::CalcTextSize(text).x < right) {
        ImGui::SameLine();
    }
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TextUnformatted(text);
    ImGui::PopStyleColor();
}
