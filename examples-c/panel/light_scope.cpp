// SPDX-License-Identifier: MIT OR Apache-2.0
// light_scope.cpp -- see light_scope.h.
#include "light_scope.h"

#include "widgets.h"

#include <cmath>
#include <cstdio>

namespace {

constexpr double MOST_PIXELS = 300000.0; // to count in a picture: so much takes a millisecond

int luma_of(const unsigned char *pixel) {
    return (2126 * pixel[0] + 7152 * pixel[1] + 722 * pixel[2] + 5000) / 10000;
}

// The mark, with its number, where `at` is on the screen; a line down or across.
void mark_bright(const Diagram &diagram, ImVec2 from, ImVec2 to, ImVec2 text) {
    ImGui::GetWindowDrawList()->AddLine(from, to, colour::photon, 1.0F);
    char number[8];
    std::snprintf(number, sizeof number, "%d", LightCounts::BRIGHT);
    diagram.label(text, colour::photon, number);
}

} // namespace

double LightCounts::bright() const {
    uint64_t above = 0;
    for (size_t value = BRIGHT + 1; value < luma.size(); value++) {
        above += luma[value];
    }
    return pixels > 0 ? static_cast<double>(above) / pixels : 0.0;
}

LightCounts count_light(const Pixels &picture) {
    LightCounts    counts;
    const uint32_t width = picture.image.width, height = picture.image.height;
    const auto     step = static_cast<uint32_t>(
        std::max(1.0, std::ceil(std::sqrt(static_cast<double>(width) * height / MOST_PIXELS))));
    counts.waveform.resize(size_t{3} * LightCounts::COLUMNS * LightCounts::LEVELS);
    for (uint32_t y = step / 2; y < height; y += step) {
        for (uint32_t x = step / 2; x < width; x += step, counts.pixels++) {
            const unsigned char *pixel = picture.bytes.data() + size_t{4} * (size_t{y} * width + x);
            counts.red[pixel[0]]++;
            counts.green[pixel[1]]++;
            counts.blue[pixel[2]]++;
            counts.luma[static_cast<size_t>(luma_of(pixel))]++;
            const size_t column = size_t{x} * LightCounts::COLUMNS / width;
            counts.columns[column]++;
            for (size_t i = 0; i < 3; i++) {
                const size_t row = LightCounts::LEVELS - 1 - size_t{pixel[i]} * LightCounts::LEVELS / 256;
                counts.waveform[3 * (row * LightCounts::COLUMNS + column) + i]++;
            }
        }
    }
    return counts;
}

// A place of the waveform is as bright as the root of the share that its level has of its column; a tenth is full.
void LightScope::count(const Pixels &picture) {
    counts_ = count_light(picture);
    std::vector<unsigned char> colours(counts_.waveform.size() / 3 * 4, 255);
    for (size_t i = 0; i < counts_.waveform.size(); i++) {
        const double full = std::max(0.1 * counts_.columns[i / 3 % LightCounts::COLUMNS], 1.0);
        const double share = std::sqrt(std::min(counts_.waveform[i] / full, 1.0));
        colours[i / 3 * 4 + i % 3] = static_cast<unsigned char>(std::lround(255.0 * share));
    }
    waveform_.upload(colours.data(), LightCounts::COLUMNS, LightCounts::LEVELS, true);
}

void LightScope::draw_histogram(ImVec2 size) const {
    const Diagram diagram("histogram", size, 0.0, 256.0, 0.0, 1.04);
    // Black sky, and white where there is much of it, would leave the rest no height: they are cut off.
    uint32_t highest = 1;
    for (size_t value = 16; value < 240; value++) {
        for (const auto *list : {&counts_.luma, &counts_.red, &counts_.green, &counts_.blue}) {
            highest = std::max(highest, (*list)[value]);
        }
    }
    const auto height = [&](uint32_t count) { return std::min(1.0, std::sqrt(static_cast<double>(count) / highest)); };
    for (int stop = 32; stop < 256; stop += 32) {
        diagram.line(stop, 0.0, stop, 1.04, colour::axis, 1.0F);
    }
    for (size_t value = 0; value < counts_.luma.size(); value++) {
        const ImVec2 low = diagram.at(static_cast<double>(value), 0.0);
        const ImVec2 high = diagram.at(static_cast<double>(value) + 1.0, height(counts_.luma[value]));
        ImGui::GetWindowDrawList()->AddRectFilled({low.x, high.y}, {high.x, low.y}, IM_COL32(150, 150, 150, 110));
    }
    const struct {
        const std::array<uint32_t, 256> *list;
        ImU32                            color;
    } channels[] = {{&counts_.red, IM_COL32(255, 80, 70, 230)},
                    {&counts_.green, IM_COL32(90, 220, 100, 230)},
                    {&counts_.blue, IM_COL32(90, 140, 255, 230)}};
    for (const auto &channel : channels) {
        std::vector<ImVec2> points;
        for (size_t value = 0; value < 256; value++) {
            points.push_back(diagram.at(static_cast<double>(value) + 0.5, height((*channel.list)[value])));
        }
        diagram.curve(points, channel.color, 1.2F);
    }
    const double mark = LightCounts::BRIGHT + 1.0;
    const ImVec2 top = diagram.at(mark, 1.04);
    const float  width = ImGui::CalcTextSize("235 ").x;
    mark_bright(diagram, top, diagram.at(mark, 0.0), {top.x - width, top.y + 1.0F});
}

void LightScope::draw_waveform(ImVec2 size) const {
    const Diagram diagram("waveform", size, 0.0, 1.0, 0.0, 256.0);
    if (!waveform_.empty()) {
        ImGui::GetWindowDrawList()->AddImage(waveform_.id(), diagram.low(), diagram.high());
    }
    for (int level = 64; level < 256; level += 64) {
        diagram.line(0.0, level, 1.0, level, colour::axis, 1.0F);
    }
    const double mark = LightCounts::BRIGHT + 1.0;
    const ImVec2 left = diagram.at(0.0, mark);
    mark_bright(diagram, left, diagram.at(1.0, mark), {left.x + 3.0F, left.y + 1.0F});
}

void LightScope::draw(const Pixels &picture, uint32_t number, double auto_ev, const BhrFilm &film) {
    if (number != number_ && picture.image.width > 0) {
        count(picture);
        number_ = number;
    }
    const float  em = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x;
    const ImVec4 dim = ImGui::ColorConvertU32ToFloat4(colour::dim);
    draw_histogram({width, 4.4F * em});
    tell("a histogram of the picture's 8-bit values, as sRGB encodes them, 0 at the left, 255 at the right: grey the "
         "luma Y' = 0.2126 R' + 0.7152 G' + 0.0722 B' (Rec. 709), lines red, green and blue; heights are square roots "
         "of counts\n\nThe mark is at 235.");
    draw_waveform({width, 5.6F * em});
    tell("a waveform of the picture's 8-bit values, as sRGB encodes them: over each column of the picture the values "
         "of its pixels, 0 below, 255 above, in red, green and blue; where they agree it is white\n\n"
         "The mark is at 235.");
    ImGui::TextColored(dim, "above %d:", LightCounts::BRIGHT);
    ImGui::SameLine(0.0F, 0.4F * em);
    ImGui::Text("%.1f %%", 100.0 * counts_.bright());
    tell("the share of pixels whose luma is above 235 of 255");
    ImGui::SameLine(0.0F, em);
    if (film.auto_exposure > 0.0) {
        ImGui::TextColored(dim, "auto");
        ImGui::SameLine(0.0F, 0.4F * em);
        ImGui::Text("%+.2f", auto_ev);
        ImGui::SameLine(0.0F, 0.4F * em);
        ImGui::TextColored(dim, "in all");
        ImGui::SameLine(0.0F, 0.4F * em);
        ImGui::Text("%+.2f EV", film.exposure_ev + auto_ev);
    } else {
        ImGui::TextColored(dim, "auto exposure is off");
    }
    tell("the stops that auto exposure added to this picture, and with the exposure that is set\n\n"
         "BhrFrameStats.auto_ev in bhr.h; docs/colour-and-film.md");
    ImGui::Separator();
}
