/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// layout.h -- where in the window each panel stands. ImGui of this age docks nothing: the arrangement is computed from
// the window's size.
#ifndef PANEL_LAYOUT_H
#define PANEL_LAYOUT_H

#include <algorithm>
#include <cmath>
#include <imgui.h>

struct Place {
    ImVec2 at, size;
};

struct Layout {
    bool  panels = false; // without them the picture fills the window
    bool  wide = false;   // all instruments side by side; else they share `instruments`, behind tabs
    Place settings, picture, instruments, side, top, metric, performance, ray, steps;
};

// room: the window; em: the size of its text.
inline Layout arrange(ImVec2 room, float em, bool bare) {
    Layout      layout;
    const float column = std::floor(23.0F * em);
    if (bare || room.x < 2.6F * column || room.y < 36.0F * em) {
        layout.picture = {{0.0F, 0.0F}, room};
        return layout;
    }
    layout.panels = true;
    layout.settings = {{0.0F, 0.0F}, {column, room.y}};
    // A third column only where the picture between the two stays the larger half of the window.
    layout.wide = room.x >= 4.6F * column && room.y >= 56.0F * em;
    if (!layout.wide) {
        const float lower = std::floor(std::max(0.34F * room.y, 16.0F * em)), upper = room.y - lower;
        layout.picture = {{column, 0.0F}, {room.x - column, upper}};
        layout.instruments = {{column, upper}, {room.x - column, lower}};
        return layout;
    }
    const float middle = room.x - 2.0F * column, right = column + middle, third = std::floor(middle / 3.0F);
    // Under the picture squares and two lines of text: what they leave is the picture's, but it stays wider than high.
    const float lower = std::floor(std::max(0.36F * room.y, std::min(third + 5.0F * em, 0.5F * room.y)));
    const float upper = room.y - lower;
    const float speed = std::floor(0.42F * room.y), numbers = std::floor(0.30F * room.y);
    layout.picture = {{column, 0.0F}, {middle, upper}};
    layout.side = {{column, upper}, {third, lower}};
    layout.top = {{column + third, upper}, {third, lower}};
    layout.metric = {{column + 2.0F * third, upper}, {middle - 2.0F * third, lower}};
    layout.performance = {{right, 0.0F}, {column, speed}};
    layout.ray = {{right, speed}, {column, numbers}};
    layout.steps = {{right, speed + numbers}, {column, room.y - speed - numbers}};
    return layout;
}

#endif
