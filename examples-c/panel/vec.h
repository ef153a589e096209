/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// vec.h -- vectors of three doubles, and the hole's chart: scene axes turned so that the spin axis is +z. Plain
// mathematics; knows no window.
#ifndef PANEL_VEC_H
#define PANEL_VEC_H

#include <algorithm>
#include <cmath>

constexpr double DEGREE = 3.14159265358979323846 / 180.0;

struct Vec3 {
    double x = 0.0, y = 0.0, z = 0.0;
};

inline Vec3 operator-(const Vec3 &a, const Vec3 &b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline double dot(const Vec3 &a, const Vec3 &b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double length(const Vec3 &a) {
    return std::sqrt(dot(a, a));
}
inline Vec3 cross(const Vec3 &a, const Vec3 &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
// Exact near 0 and pi, as acos is not.
inline double angle_between(const Vec3 &a, const Vec3 &b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

// The shortest rotation that takes +z to the unit vector `axis` (about +x for -z), as bhr.h defines the chart: with
// v = z x axis and c = axis.z it is R = c + [v]x + v v^T / (1 + c) (Rodrigues 1840).
class Chart {
public:
    Chart() = default;
    explicit Chart(const double axis[3]) {
        const double c = axis[2];
        if (c < -1.0 + 1e-12) {
            x_ = {1.0, 0.0, 0.0};
            y_ = {0.0, -1.0, 0.0};
            z_ = {0.0, 0.0, -1.0};
            return;
        }
        const double vx = -axis[1], vy = axis[0], k = 1.0 / (1.0 + c);
        x_ = {c + k * vx * vx, k * vx * vy, -vy};
        y_ = {k * vx * vy, c + k * vy * vy, vx};
        z_ = {axis[0], axis[1], axis[2]};
    }

    Vec3 from_scene(const Vec3 &p) const { return {dot(p, x_), dot(p, y_), dot(p, z_)}; }
    Vec3 to_scene(const Vec3 &p) const {
        return {p.x * x_.x + p.y * y_.x + p.z * z_.x, p.x * x_.y + p.y * y_.y + p.z * z_.y,
                p.x * x_.z + p.y * y_.z + p.z * z_.z};
    }

private:
    Vec3 x_{1.0, 0.0, 0.0}, y_{0.0, 1.0, 0.0}, z_{0.0, 0.0, 1.0}; // the chart's axes in scene axes
};

#endif
