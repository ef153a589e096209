// SPDX-License-Identifier: MIT OR Apache-2.0
// sections.cpp -- see sections.h.
#include "sections.h"

namespace {

// Once all of the window's content has been given to ImGui. A bar takes room at the right of the content.
void report(SectionReports &reports, const std::string &name) {
    const float right = ImGui::GetWindowWidth() - ImGui::GetWindowContentRegionMax().x;
    const bool  bar = right - ImGui::GetWindowContentRegionMin().x > 0.5F * ImGui::GetStyle().ScrollbarSize;
    reports.push_back({name, ImGui::GetWindowPos(), ImGui::GetWindowSize(),
                       {ImGui::GetScrollMaxX(), ImGui::GetScrollMaxY()}, bar});
}

} // namespace

FixedWindow::FixedWindow(SectionReports &reports, const char *title, const Place &place, bool bare)
    : reports_(reports), name_(title) {
    ImGui::SetNextWindowPos(place.at);
    ImGui::SetNextWindowSize(place.size);
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                             ImGuiWindowFlags_NoBringToFrontOnFocus;
    if (bare) {
        flags |= ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoScrollWithMouse;
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0.0F, 0.0F});
        ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0F);
    }
    ImGui::Begin(title, nullptr, flags);
    if (bare) {
        ImGui::PopStyleVar(2);
        name_.clear();
    }
}

FixedWindow::~FixedWindow() {
    if (!name_.empty()) {
        report(reports_, name_);
    }
    ImGui::End();
}

Part::Part(SectionReports &reports, const char *name, ImVec2 size) : reports_(reports), name_(name) {
    ImGui::BeginChild(name, size);
}

Part::~Part() {
    report(reports_, name_);
    ImGui::EndChild();
}
