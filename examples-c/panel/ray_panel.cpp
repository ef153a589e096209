// SPDX-License-Identifier: MIT OR Apache-2.0
// ray_panel.cpp -- see ray_panel.h.
#include "ray_panel.h"

#include "draw.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace {

// A row of the table of numbers.
void row(const char *name, const char *format, double value, const char *absent = "-") {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "%s", name);
    ImGui::TableNextColumn();
    if (std::isnan(value)) {
        ImGui::TextUnformatted(absent);
    } else {
        ImGui::Text(format, value);
    }
}

void draw_crossings(const BhrHit &hit, double mass) {
    if (hit.crossing_count == 0) {
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "does not cross the equatorial plane");
        return;
    }
    if (!ImGui::BeginTable("crossings", 5, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp)) {
        return;
    }
    for (const char *heading : {"#", "r / M", "azimuth", "g", "delay / M"}) {
        ImGui::TableSetupColumn(heading);
    }
    ImGui::TableHeadersRow();
    for (uint32_t i = 0; i < hit.crossing_count; i++) {
        const BhrCrossing &crossing = hit.crossings[i];
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::crossing), "%u", i);
        ImGui::TableNextColumn();
        ImGui::Text("%.4f", crossing.radius / mass);
        ImGui::TableNextColumn();
        ImGui::Text("%.2f\xC2\xB0", crossing.azimuth / DEGREE);
        ImGui::TableNextColumn();
        if (std::isnan(crossing.redshift)) {
            ImGui::TextUnformatted("- (in ISCO)");
        } else {
            ImGui::Text("%.5f", crossing.redshift);
        }
        ImGui::TableNextColumn();
        ImGui::Text("%.3f", crossing.delay / mass);
    }
    ImGui::EndTable();
}

// How a place of the chart is drawn: from the side by its distance from the axis and its height, from above by x, y.
using Projection = std::function<ImVec2(const Vec3 &place)>;

void draw_ray(const Diagram &diagram, const RayReport &report, const Projection &projection) {
    std::vector<ImVec2> points;
    points.reserve(report.path.size());
    for (const PathPoint &point : report.path) {
        points.push_back(projection(point.place));
    }
    diagram.curve(points, colour::ray, 1.8F);
    for (uint32_t i = 0; i < report.hit.crossing_count; i++) {
        const BhrCrossing &crossing = report.hit.crossings[i];
        const ImVec2       at = projection(
            {crossing.radius * std::cos(crossing.azimuth), crossing.radius * std::sin(crossing.azimuth), 0.0});
        char text[16];
        std::snprintf(text, sizeof text, "%u", i);
        ImGui::GetWindowDrawList()->AddCircleFilled(at, 3.5F, colour::crossing);
        diagram.label({at.x + 5.0F, at.y - ImGui::GetFontSize() - 1.0F}, colour::crossing, text);
    }
    if (!points.empty()) { // the observer
        ImGui::GetWindowDrawList()->AddCircleFilled(points.front(), 4.0F, colour::text);
    }
}

// r and theta of the static limit: r = M + sqrt(M^2 - a^2 cos^2 theta), in M.
void draw_ergosphere(const Diagram &diagram, double spin) {
    std::vector<ImVec2> points;
    for (int i = 0; i <= 180; i++) {
        const double theta = i * DEGREE, c = spin * std::cos(theta), r = 1.0 + std::sqrt(1.0 - c * c);
        points.push_back(diagram.at(r * std::sin(theta), r * std::cos(theta)));
    }
    diagram.curve(points, colour::ergosphere, 1.5F);
}

void draw_legend(const Inspector &inspector) {
    legend("horizon", colour::horizon, true);
    legend("ergosphere", colour::ergosphere);
    legend(inspector.spin() == 0.0 ? "photon sphere" : "photon orbits", colour::photon);
    legend("ISCO", colour::isco);
    legend("disk", IM_COL32(225, 130, 70, 255));
    legend("ray", colour::ray);
    legend("crossings", colour::crossing);
}

// Orbits of both senses, in M; one where they agree.
template <class Draw> void for_each_orbit(double prograde, double retrograde, double mass, Draw draw) {
    draw(prograde / mass);
    if (retrograde != prograde) {
        draw(retrograde / mass);
    }
}

// Circular orbits lie in the equatorial plane: from the side they are dots. Without spin the photons' is one of a
// sphere of them.
void draw_hole_from_side(const Diagram &diagram, const Inspector &inspector) {
    const BhrHoleInfo &numbers = inspector.numbers();
    const double       mass = inspector.mass();
    diagram.line(0.0, -1e4, 0.0, 1e4, colour::frame, 1.0F);
    if (inspector.has_disk()) {
        diagram.line(inspector.disk_inner() / mass, 0.0, inspector.disk_outer() / mass, 0.0, colour::disk, 5.0F);
    }
    diagram.disc(numbers.horizon_radius / mass, colour::hole);
    diagram.circle(numbers.horizon_radius / mass, colour::horizon, 1.5F);
    if (inspector.spin() != 0.0) {
        draw_ergosphere(diagram, inspector.spin());
    } else {
        diagram.circle(numbers.photon_orbit_prograde / mass, colour::photon, 1.2F);
    }
    for_each_orbit(numbers.photon_orbit_prograde, numbers.photon_orbit_retrograde, mass,
                   [&](double r) { diagram.dot(r, 0.0, colour::photon, 3.0F); });
    for_each_orbit(numbers.isco_prograde, numbers.isco_retrograde, mass,
                   [&](double r) { diagram.dot(r, 0.0, colour::isco, 3.0F); });
}

void draw_hole_from_above(const Diagram &diagram, const Inspector &inspector) {
    const BhrHoleInfo &numbers = inspector.numbers();
    const double       mass = inspector.mass();
    if (inspector.has_disk()) {
        diagram.ring(inspector.disk_inner() / mass, inspector.disk_outer() / mass, colour::disk);
    }
    diagram.disc(numbers.horizon_radius / mass, colour::hole);
    diagram.circle(numbers.horizon_radius / mass, colour::horizon, 1.5F);
    if (inspector.spin() != 0.0) {
        diagram.circle(numbers.ergosphere_equatorial_radius / mass, colour::ergosphere, 1.5F);
    }
    for_each_orbit(numbers.photon_orbit_prograde, numbers.photon_orbit_retrograde, mass,
                   [&](double r) { diagram.circle(r, colour::photon, 1.2F); });
    for_each_orbit(numbers.isco_prograde, numbers.isco_retrograde, mass,
                   [&](double r) { diagram.circle(r, colour::isco, 1.2F); });
}

} // namespace

const char *fate_name(BhrFate fate) {
    switch (fate) {
    case BHR_FATE_CAPTURED:
        return "captured";
    case BHR_FATE_ESCAPED:
        return "escaped";
    case BHR_FATE_UNRESOLVED:
        return "unresolved: out of steps";
    default:
        return "invalid";
    }
}

void RayPanel::draw_numbers(const RayReport &report, const Inspector &inspector, uint32_t column, uint32_t line) const {
    if (!report.result.ok()) {
        ImGui::PushStyleColor(ImGuiCol_Text, colour::error);
        ImGui::TextWrapped("%s", report.result.message.c_str());
        ImGui::PopStyleColor();
        return;
    }
    const BhrHit &hit = report.hit;
    const double  mass = inspector.mass();
    if (ImGui::BeginTable("ray", 2, ImGuiTableFlags_SizingFixedFit)) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "pixel");
        ImGui::TableNextColumn();
        ImGui::Text("%u, %u:  %s", column, line, fate_name(hit.fate));
        row("deflection", "%.4f\xC2\xB0", report.deflection / DEGREE);
        row("swept angle", "%.4f\xC2\xB0", hit.swept_angle / DEGREE, "-  (spin 0 only)");
        row("sky redshift", "%.6f", hit.sky_redshift);
        row("steps", "%.0f", hit.steps);
        row("travel time", "%.2f M", report.path.empty() ? NAN : -report.path.back().time / mass);
        ImGui::EndTable();
    }
    draw_crossings(hit, mass);
}

void RayPanel::zoom(bool hovered) {
    const float wheel = ImGui::GetIO().MouseWheel;
    if (hovered && wheel != 0.0F) {
        extent_ = std::clamp(extent_ * std::pow(0.85, static_cast<double>(wheel)), 2.0, 1000.0);
    }
}

void RayPanel::draw_side(const RayReport &report, const Inspector &inspector) {
    draw_view("rho, z / M", true, report, inspector);
}

void RayPanel::draw_top(const RayReport &report, const Inspector &inspector) {
    draw_view("x, y / M", false, report, inspector);
}

// From the side the axis stands near the left border: a distance from it has no sign.
void RayPanel::draw_view(const char *axes, bool side, const RayReport &report, const Inspector &inspector) {
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float  legend_height = 2.2F * ImGui::GetTextLineHeightWithSpacing();
    const ImVec2 size(room.x, std::min(room.x, room.y - legend_height));
    if (size.x < 8.0F || size.y < 8.0F) {
        return;
    }
    const double left = side ? -0.03 * extent_ : -extent_, right = side ? 0.97 * extent_ : extent_;
    const double up = 0.5 * (right - left) * static_cast<double>(size.y / size.x), mass = inspector.mass();
    bool         hovered = false;
    {
        const Diagram diagram(axes, size, left, right, -up, up);
        diagram.grid(round_step(right - left, 6));
        if (side) {
            draw_hole_from_side(diagram, inspector);
        } else {
            draw_hole_from_above(diagram, inspector);
        }
        const Projection projection = [&](const Vec3 &place) {
            const double across = side ? std::hypot(place.x, place.y) : place.x, height = side ? place.z : place.y;
            return diagram.at(across / mass, height / mass);
        };
        draw_ray(diagram, report, projection);
        diagram.label({diagram.low().x + 5.0F, diagram.low().y + 2.0F}, colour::dim, axes);
        hovered = diagram.hovered();
    }
    zoom(hovered);
    draw_legend(inspector);
}
