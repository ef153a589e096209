/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// metric_map.h -- g_tt over a plane through the hole, as colours with a scale, the horizon and the static limit in it.
#ifndef PANEL_METRIC_MAP_H
#define PANEL_METRIC_MAP_H

#include "draw.h"
#include "inspector.h"

class MetricMap {
public:
    // version: changes with the hole.
    void draw(const Inspector &inspector, uint64_t version);

private:
    void fill(const Inspector &inspector);
    Vec3 place(double across, double up, double mass) const;
    void choose_plane();
    void follow_mouse(const Diagram &diagram, const Inspector &inspector);
    void draw_outlines(const Diagram &diagram, const Inspector &inspector) const;
    void draw_scale(ImVec2 at, float height) const;

    Texture  texture_, scale_;
    bool     meridional_ = true; // the plane that holds the axis, else the equatorial one
    double   extent_ = 4.0;      // from the middle to the border, in M
    uint64_t version_ = UINT64_MAX;
    bool     stale_ = true;
};

#endif
