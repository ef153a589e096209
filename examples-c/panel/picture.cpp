// SPDX-License-Identifier: MIT OR Apache-2.0
// picture.cpp -- see picture.h.
#include "picture.h"

#include <cmath>

namespace {

constexpr float CLICK_PIXELS = 4.0F; // the mouse may move so far in a click
constexpr float WIPE_PIXELS = 7.0F;  // so near to the line the mouse takes hold of it

void cross(ImDrawList *list, ImVec2 at, float size) {
    constexpr float gap = 4.0F;
    const ImVec2    ends[4] = {{1.0F, 0.0F}, {-1.0F, 0.0F}, {0.0F, 1.0F}, {0.0F, -1.0F}};
    for (const ImVec2 &end : ends) {
        list->AddLine({at.x + gap * end.x, at.y + gap * end.y}, {at.x + size * end.x, at.y + size * end.y}, colour::ray,
                      1.5F);
    }
}

} // namespace

Pixels Picture::take(Pixels &&pixels) {
    const BhrImage &image = pixels.image;
    const bool      as_large = image.width == width_ && image.height == height_;
    texture_.upload(image.pixels, image.width, image.height, !as_large);
    std::swap(pixels_, pixels);
    return std::move(pixels);
}

bool Picture::on_wipe() const {
    const float line = corner_.x + wipe_ * ImGui::GetItemRectSize().x;
    return std::abs(ImGui::GetIO().MousePos.x - line) <= WIPE_PIXELS;
}

// The other picture with its name and the line's handle. corner_ and `end` are the picture's.
void Picture::draw_wipe(const Texture &other, ImVec2 end) const {
    ImDrawList  *list = ImGui::GetWindowDrawList();
    const float  line = std::floor(corner_.x + wipe_ * (end.x - corner_.x)), em = ImGui::GetFontSize();
    const ImVec2 middle(line, 0.5F * (corner_.y + end.y));
    list->AddImage(other.id(), corner_, {line, end.y}, {0.0F, 0.0F}, {wipe_, 1.0F});
    list->AddLine({line, corner_.y}, {line, end.y}, IM_COL32(0, 0, 0, 160), 3.0F);
    list->AddLine({line, corner_.y}, {line, end.y}, colour::text, 1.0F);
    list->AddCircleFilled(middle, 0.6F * em, IM_COL32(20, 22, 28, 230));
    list->AddCircle(middle, 0.6F * em, colour::text, 0, 1.5F);
    for (const float side : {-1.0F, 1.0F}) {
        list->AddTriangleFilled({middle.x + side * 0.45F * em, middle.y},
                                {middle.x + side * 0.15F * em, middle.y - 0.22F * em},
                                {middle.x + side * 0.15F * em, middle.y + 0.22F * em}, colour::text);
        const char  *name = side < 0.0F ? "A" : "B";
        const ImVec2 size = ImGui::CalcTextSize(name);
        const ImVec2 at(line + (side < 0.0F ? -size.x - 0.9F * em : 0.9F * em), corner_.y + 0.5F * em);
        list->AddRectFilled({at.x - 0.3F * em, at.y - 0.1F * em},
                            {at.x + size.x + 0.3F * em, at.y + size.y + 0.1F * em}, IM_COL32(20, 22, 28, 200), 3.0F);
        list->AddText(at, colour::text, name);
    }
}

Picture::Input Picture::draw(double pixel_ratio, bool bare, const std::string &news, const std::string &error,
                             const Texture *other, float foot) {
    Input        input;
    ImVec2       room = ImGui::GetContentRegionAvail();
    room = {std::max(room.x, 1.0F), std::max(room.y - foot, 1.0F)};
    corner_ = ImGui::GetCursorScreenPos();
    width_ = static_cast<uint32_t>(std::max(1L, std::lround(static_cast<double>(room.x) * pixel_ratio)));
    height_ = static_cast<uint32_t>(std::max(1L, std::lround(static_cast<double>(room.y) * pixel_ratio)));
    const ImVec2 end(corner_.x + room.x, corner_.y + room.y);

    ImGui::InvisibleButton("picture", room);
    const ImGuiIO &io = ImGui::GetIO();
    const bool     moved = io.MouseDragMaxDistanceSqr[0] > CLICK_PIXELS * CLICK_PIXELS;
    if (ImGui::IsItemActivated()) {
        wiping_ = other != nullptr && on_wipe();
    }
    if (other != nullptr && (wiping_ || (ImGui::IsItemHovered() && on_wipe()))) {
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    }
    if (wiping_) {
        if (ImGui::IsItemActive()) {
            wipe_ = std::clamp((io.MousePos.x - corner_.x) / room.x, 0.0F, 1.0F);
        }
    } else if (ImGui::IsItemActive() && moved) {
        input.drag_x = io.MouseDelta.x;
        input.drag_y = io.MouseDelta.y;
    }
    if (ImGui::IsItemHovered()) {
        input.wheel = io.MouseWheel;
    }
    if (ImGui::IsItemDeactivated() && ImGui::IsItemHovered() && !moved && !wiping_) {
        // A mouse at whole coordinates means the pixel there, not its corner.
        x_ = (static_cast<double>(io.MousePos.x - corner_.x) * pixel_ratio + 0.5) / width_;
        y_ = (static_cast<double>(io.MousePos.y - corner_.y) * pixel_ratio + 0.5) / height_;
        input.clicked = true;
    }

    wiping_ = wiping_ && !ImGui::IsItemDeactivated();

    ImDrawList *list = ImGui::GetWindowDrawList();
    if (!texture_.empty()) {
        list->AddImage(texture_.id(), corner_, end);
    }
    if (other != nullptr) {
        draw_wipe(*other, end);
    }
    if (!bare) {
        cross(list,
              {corner_.x + static_cast<float>((column() + 0.5) / pixel_ratio),
               corner_.y + static_cast<float>((row() + 0.5) / pixel_ratio)},
              12.0F);
        list->AddText({corner_.x + 8.0F, corner_.y + 5.0F}, colour::dim, news.c_str());
    }
    if (!error.empty()) {
        const float  wrap = std::max(room.x - 24.0F, 20.0F);
        const ImVec2 size = ImGui::CalcTextSize(error.c_str(), nullptr, false, wrap);
        const ImVec2 low(corner_.x + 12.0F, end.y - size.y - 16.0F);
        list->AddRectFilled({low.x - 6.0F, low.y - 5.0F}, {low.x + size.x + 6.0F, low.y + size.y + 5.0F},
                            IM_COL32(30, 6, 6, 220), 4.0F);
        list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), low, colour::error, error.c_str(), nullptr, wrap);
    }
    return input;
}
