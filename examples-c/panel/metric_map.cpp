// SPDX-License-Identifier: MIT OR Apache-2.0
// metric_map.cpp -- see metric_map.h.
#include "metric_map.h"

#include <cmath>
#include <cstdio>

namespace {

constexpr uint32_t SIDE = 160;          // places asked for, across and up
constexpr double   BRIGHTEST = 1.0;     // |g_tt| of the full colours: -1 is flat space, 0 the static limit
constexpr float    SCALE_EMS = 3.2F;    // width of the colour scale with its numbers

ImVec2 operator+(ImVec2 a, ImVec2 b) {
    return {a.x + b.x, a.y + b.y};
}

} // namespace

Vec3 MetricMap::place(double across, double up, double mass) const {
    return meridional_ ? Vec3{across * mass, 0.0, up * mass} : Vec3{across * mass, up * mass, 0.0};
}

void MetricMap::fill(const Inspector &inspector) {
    std::vector<ImU32> pixels(size_t{SIDE} * SIDE);
    for (uint32_t row = 0; row < SIDE; row++) {
        for (uint32_t column = 0; column < SIDE; column++) {
            const double across = extent_ * ((2.0 * column + 1.0) / SIDE - 1.0);
            const double up = extent_ * (1.0 - (2.0 * row + 1.0) / SIDE);
            const double value = inspector.g_tt(place(across, up, inspector.mass()));
            pixels[size_t{row} * SIDE + column] = diverging(value / BRIGHTEST);
        }
    }
    texture_.upload(pixels.data(), SIDE, SIDE, true);
    if (scale_.empty()) {
        std::vector<ImU32> ramp(256);
        for (size_t i = 0; i < ramp.size(); i++) {
            ramp[i] = diverging(1.0 - 2.0 * static_cast<double>(i) / 255.0);
        }
        scale_.upload(ramp.data(), 1, 256, true);
    }
}

// The horizon, and where g_tt = 0: r = M + sqrt(M^2 - a^2 cos^2 theta).
void MetricMap::draw_outlines(const Diagram &diagram, const Inspector &inspector) const {
    diagram.circle(inspector.numbers().horizon_radius / inspector.mass(), colour::hole, 2.0F);
    std::vector<ImVec2> limit;
    for (int i = 0; i <= 360; i++) {
        const double angle = i * DEGREE, c = meridional_ ? inspector.spin() * std::cos(angle) : 0.0;
        const double r = 1.0 + std::sqrt(1.0 - c * c);
        limit.push_back(diagram.at(r * std::sin(angle), r * std::cos(angle)));
    }
    diagram.curve(limit, IM_COL32(110, 60, 220, 255), 2.0F);
}

// The colours with their values, at a place of the screen.
void MetricMap::draw_scale(ImVec2 at, float height) const {
    const float width = 0.8F * ImGui::GetFontSize();
    ImDrawList *list = ImGui::GetWindowDrawList();
    list->AddImage(scale_.id(), at, at + ImVec2(width, height));
    for (const double value : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        char text[16];
        std::snprintf(text, sizeof text, value == 0.0 ? "0" : "%+.1f", value * BRIGHTEST);
        const float y = static_cast<float>(0.5 - 0.5 * value) * (height - ImGui::GetFontSize());
        list->AddText(at + ImVec2(width + 3.0F, y), colour::text, text);
    }
}

void MetricMap::choose_plane() {
    int plane = meridional_ ? 0 : 1;
    ImGui::AlignTextToFramePadding();
    stale_ |= ImGui::RadioButton("x-z plane", &plane, 0);
    ImGui::SameLine();
    stale_ |= ImGui::RadioButton("x-y plane", &plane, 1);
    meridional_ = plane == 0;
}

// The wheel zooms, and a tip says the value under the mouse.
void MetricMap::follow_mouse(const Diagram &diagram, const Inspector &inspector) {
    double across = 0.0, up = 0.0;
    diagram.mouse(across, up);
    ImGui::SetTooltip("x = %.3f M, %s = %.3f M\ng_tt = %.6f", across, meridional_ ? "z" : "y", up,
                      inspector.g_tt(place(across, up, inspector.mass())));
    const float wheel = ImGui::GetIO().MouseWheel;
    if (wheel != 0.0F) {
        extent_ = std::clamp(extent_ * std::pow(0.85, static_cast<double>(wheel)), 1.5, 100.0);
        stale_ = true;
    }
}

void MetricMap::draw(const Inspector &inspector, uint64_t version) {
    choose_plane();
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float  side = std::min(room.x - SCALE_EMS * ImGui::GetFontSize(),
                                 room.y - 2.2F * ImGui::GetTextLineHeightWithSpacing());
    if (side < 8.0F) {
        return;
    }
    if (stale_ || version != version_) {
        fill(inspector);
        version_ = version;
        stale_ = false;
    }
    {
        const Diagram diagram("g_tt", {side, side}, -extent_, extent_, -extent_, extent_);
        ImGui::GetWindowDrawList()->AddImage(texture_.id(), diagram.low(), diagram.high());
        diagram.grid(round_step(2.0 * extent_, 4), IM_COL32(20, 24, 40, 255));
        draw_outlines(diagram, inspector);
        if (diagram.hovered()) {
            follow_mouse(diagram, inspector);
        }
    }
    const ImVec2 end = ImGui::GetItemRectMax();
    draw_scale({end.x + 0.5F * ImGui::GetFontSize(), end.y - side}, side);
    legend("horizon (black)", colour::text, true);
    legend("static limit (g_tt = 0)", colour::ergosphere);
}
