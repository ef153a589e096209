/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// inspector.h -- questions about single rays and about space-time at a place, answered at once. Asks a context of its
// own, on the CPU tracer: one that is busy with frames on a GPU would let the program wait for them. Draws nothing.
#ifndef PANEL_INSPECTOR_H
#define PANEL_INSPECTOR_H

#include "handles.h"
#include "vec.h"

#include <vector>

struct PathPoint {
    Vec3   place; // in the hole's chart, scene lengths
    double time;  // <= 0: backward
};

// One ray of the picture, followed to its end.
struct RayReport {
    Result                 result;
    BhrRay                 ray{};
    BhrHit                 hit{};
    double                 deflection = 0.0; // between look direction and sky direction, radians; NaN unless it escaped
    std::vector<PathPoint> path;
};

class Inspector {
public:
    Result create();

    // Takes over hole, camera, disk and quality of another context.
    Result follow(const BhrContext *context);

    RayReport inspect(uint32_t width, uint32_t height, double x, double y) const;
    // g_tt at a place in the hole's chart; NaN where there is none.
    double g_tt(const Vec3 &place) const;

    const BhrHoleInfo &numbers() const { return numbers_; }
    double             mass() const { return mass_; }
    double             spin() const { return spin_; }
    bool               has_disk() const { return has_disk_; }
    // The disk's radii, scene lengths: BhrDisk's with 0 replaced by the ISCO of its matter, or by the horizon.
    double disk_inner() const;
    double disk_outer() const { return disk_.outer_radius * mass_; }
    bool   plunges() const { return (disk_.flags & BHR_DISK_PLUNGES) != 0; }
    bool   retrograde() const { return (disk_.flags & BHR_DISK_RETROGRADE) != 0; }

private:
    Context     context_;
    Chart       chart_;
    BhrHoleInfo numbers_{};
    BhrDisk     disk_{};
    bool        has_disk_ = false;
    double      mass_ = 1.0, spin_ = 0.0;
};

#endif
