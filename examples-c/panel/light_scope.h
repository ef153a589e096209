/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// light_scope.h -- how bright the picture is: a histogram and a waveform of its 8-bit values, as they are encoded in
// sRGB, with a mark at 235, and the exposure that made it. Knows no scene but its film.
#ifndef PANEL_LIGHT_SCOPE_H
#define PANEL_LIGHT_SCOPE_H

#include "draw.h"
#include "frames.h"

#include <array>

// The picture's values, counted. Luma is Y' = 0.2126 R' + 0.7152 G' + 0.0722 B' (Rec. 709) of encoded values.
struct LightCounts {
    static constexpr int      BRIGHT = 235; // above it film has little left to tell parts apart with
    static constexpr uint32_t COLUMNS = 256, LEVELS = 128; // of the waveform

    std::array<uint32_t, 256> red{}, green{}, blue{}, luma{};
    std::array<uint32_t, COLUMNS> columns{}; // pixels of each column of the waveform
    std::vector<uint32_t>     waveform; // red, green and blue of each place; rows of COLUMNS, the brightest first
    uint32_t                  pixels = 0;

    // The share of pixels whose luma is above BRIGHT.
    double bright() const;
};

// Counts an RGBA8_SRGB picture with packed rows; large ones by every second pixel, or third, each way.
LightCounts count_light(const Pixels &picture);

class LightScope {
public:
    // number: another one for each picture; auto_ev: what auto exposure added in it.
    void draw(const Pixels &picture, uint32_t number, double auto_ev, const BhrFilm &film);

    const LightCounts &counts() const { return counts_; }
    uint32_t           number() const { return number_; } // of the picture that was counted

private:
    void count(const Pixels &picture);
    void draw_histogram(ImVec2 size) const;
    void draw_waveform(ImVec2 size) const;

    LightCounts counts_;
    Texture     waveform_;
    uint32_t    number_ = 0;
};

#endif
