/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// colour_legend.h -- the bars of colour_bar.h beneath a picture of ImGui's: colours, numbers, units, and the meaning of
// grey. Draws only; knows no scene and no context.
#ifndef PANEL_COLOUR_LEGEND_H
#define PANEL_COLOUR_LEGEND_H

#include "../colour_bar.h"

#include <imgui.h>

// A bar without marks says that there are no false colours. `a` is the kept setting's, where the picture is parted, and
// `b` the edited one's. Two that differ stand beside each other, with their names, or in a narrow room one beneath the
// other.
struct ColourLegend {
    ColourBar a{}, b{};
    bool      parted = false;

    // The height that it takes of the foot of this room: 0 where it has nothing to say, or could not be read.
    float height(ImVec2 room) const;
    // Into a rectangle of that height and the room's width.
    void draw(ImVec2 corner, ImVec2 size) const;
    // The titles shown, for tests that drive the panel.
    const char *title_of_a() const { return parted && a.count > 0 ? a.title : "none"; }
    const char *title_of_b() const { return b.count > 0 ? b.title : "none"; }

private:
    bool differs() const { return parted && a.title != b.title; }
};

#endif
