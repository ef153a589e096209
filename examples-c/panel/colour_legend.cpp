// SPDX-License-Identifier: MIT OR Apache-2.0
// colour_legend.cpp -- see colour_legend.h.
#include "colour_legend.h"

#include "draw.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace {

// In heights of the text:
constexpr float ROW = 3.6F;       // a bar with all of its text
constexpr float LEAST_ROOM = 29.0F; // for a bar, across, for the longest title, the meaning of grey and the margins
constexpr float MARGIN = 1.0F;    // at both ends of a bar
constexpr float EDGE = 0.25F;     // above the title
constexpr float LINE = 1.25F;     // the title's
constexpr float THICK = 0.65F;    // the colours
constexpr float TICK = 0.25F;
constexpr float APART = 0.4F;     // between numbers

constexpr float LEAST_PICTURE = 2.0F; // above the legend, in heights of that

void draw_title(ImDrawList *list, const ColourBar &bar, const std::string &name, ImVec2 at, float width) {
    const float em = ImGui::GetFontSize();
    list->AddText(at, colour::text, (name + bar.title).c_str());
    if (bar.no_value != nullptr) {
        const float left = at.x + width - ImGui::CalcTextSize(bar.no_value).x, side = std::floor(0.7F * em);
        const ImVec2 low(std::floor(left - side - 0.4F * em), std::floor(at.y + 0.25F * em));
        list->AddRectFilled(low, {low.x + side, low.y + side},
                            IM_COL32(COLOUR_BAR_GREY, COLOUR_BAR_GREY, COLOUR_BAR_GREY, 255));
        list->AddText({left, at.y}, colour::text, bar.no_value);
    }
}

// Numbers that would touch the one before are left out.
void draw_marks(ImDrawList *list, const ColourBar &bar, ImVec2 at, float width) {
    const float em = ImGui::GetFontSize(), tick = bar.steps == 0 ? std::ceil(TICK * em) : 0.0F;
    float       free = at.x - em;
    for (uint32_t i = 0; i < bar.count; i++) {
        const float x = std::floor(at.x + static_cast<float>(colour_bar_place(&bar, i)) * (width - 1.0F));
        const float text = ImGui::CalcTextSize(bar.marks[i].text).x, left = std::floor(x - 0.5F * text);
        if (left < free) {
            continue;
        }
        list->AddRectFilled({x, at.y}, {x + 1.0F, at.y + tick}, colour::text);
        list->AddText({left, at.y + TICK * em}, colour::text, bar.marks[i].text);
        free = left + text + APART * em;
    }
}

// `name`: "", or whose bar it is.
void draw_bar(const ColourBar &bar, const std::string &name, ImVec2 corner, float room) {
    if (bar.count == 0) {
        return;
    }
    ImDrawList  *list = ImGui::GetWindowDrawList();
    const float  em = ImGui::GetFontSize(), width = std::floor(room - 2.0F * MARGIN * em);
    const float  left = std::floor(corner.x + MARGIN * em), top = std::floor(corner.y + (EDGE + LINE) * em);
    const float  bottom = top + std::floor(THICK * em);
    draw_title(list, bar, name, {left, std::floor(corner.y + EDGE * em)}, width);
    for (float x = 0.0F; x < width; x += 1.0F) {
        unsigned char rgb[3];
        colour_bar_at(&bar, static_cast<double>((x + 0.5F) / width), rgb);
        list->AddRectFilled({left + x, top}, {left + x + 1.0F, bottom}, IM_COL32(rgb[0], rgb[1], rgb[2], 255));
    }
    draw_marks(list, bar, {left, bottom}, width);
}

bool is_narrow(float room) {
    return room < 2.0F * LEAST_ROOM * ImGui::GetFontSize();
}

} // namespace

float ColourLegend::height(ImVec2 room) const {
    const float em = ImGui::GetFontSize();
    if ((b.count == 0 && !(parted && a.count > 0)) || room.x < LEAST_ROOM * em) {
        return 0.0F;
    }
    const float rows = differs() && is_narrow(room.x) ? 2.0F : 1.0F, height = std::ceil(rows * ROW * em);
    return room.y >= (1.0F + LEAST_PICTURE) * height ? height : 0.0F;
}

void ColourLegend::draw(ImVec2 corner, ImVec2 size) const {
    if (!differs()) {
        draw_bar(b, "", corner, size.x);
    } else if (is_narrow(size.x)) {
        draw_bar(a, "A: ", corner, size.x);
        draw_bar(b, "B: ", {corner.x, corner.y + 0.5F * size.y}, size.x);
    } else {
        draw_bar(a, "A: ", corner, 0.5F * size.x);
        draw_bar(b, "B: ", {corner.x + std::floor(0.5F * size.x), corner.y}, 0.5F * size.x);
    }
}
