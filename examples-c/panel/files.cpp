// SPDX-License-Identifier: MIT OR Apache-2.0
// files.cpp -- see files.h.
#include "files.h"

#include "draw.h"

#include <imgui.h>

namespace {

// A button that is grey, and does nothing, where there is nothing to do.
bool button(const char *name, bool useful) {
    ImGui::SameLine();
    ImGui::BeginDisabled(!useful);
    const bool pressed = ImGui::Button(name);
    ImGui::EndDisabled();
    return pressed;
}

} // namespace

void FilesRow::say(const Result &result, const std::string &done) {
    refused_ = !result.ok();
    said_ = refused_ ? result.message : done;
    count_++;
}

void FilesRow::key(char key, Scene &scene, History &history) {
    if (key == 'z' && history.can_undo()) {
        say(history.undo(scene), "undone");
    } else if (key == 'y' && history.can_redo()) {
        say(history.redo(scene), "done again");
    }
}

void FilesRow::draw(Scene &scene, History &history) {
    ImGui::SetNextItemWidth(7.5F * ImGui::GetFontSize());
    ImGui::InputText("##path", path_, sizeof path_);
    if (button("save", path_[0] != '\0')) {
        say(scene.save_file(path_), std::string("saved ") + path_);
    }
    if (button("load", path_[0] != '\0')) {
        say(scene.load_file(path_), std::string("loaded ") + path_);
    }
    if (button("undo", history.can_undo())) {
        key('z', scene, history);
    }
    if (button("redo", history.can_redo())) {
        key('y', scene, history);
    }
    if (refused_) { // what went well shows
        ImGui::PushStyleColor(ImGuiCol_Text, colour::error);
        ImGui::TextWrapped("%s", said_.c_str());
        ImGui::PopStyleColor();
    }
}
