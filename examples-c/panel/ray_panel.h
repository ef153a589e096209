/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// ray_panel.h -- one ray in numbers, and its curve about the hole from the side and from above, to scale. Draws what
// the inspector found; traces nothing itself.
#ifndef PANEL_RAY_PANEL_H
#define PANEL_RAY_PANEL_H

#include "inspector.h"

#include <string>

const char *fate_name(BhrFate fate);

class RayPanel {
public:
    void draw_numbers(const RayReport &report, const Inspector &inspector, uint32_t column, uint32_t row) const;
    void draw_side(const RayReport &report, const Inspector &inspector);
    void draw_top(const RayReport &report, const Inspector &inspector);

private:
    void draw_view(const char *axes, bool side, const RayReport &report, const Inspector &inspector);
    void zoom(bool hovered);

    double extent_ = 16.0; // of both views, in M
};

#endif
