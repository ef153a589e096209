// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/camera.hpp -- the camera of bhr.h in C++. Include bhr.hpp. */
#ifndef BHR_CAMERA_HPP
#define BHR_CAMERA_HPP

#include "scene.hpp"

namespace bhr {

/// BhrCamera, with the defaults of bhr_camera_init.
struct Camera {
    std::uint32_t struct_size;
    Projection projection;
    Vector position;
    Vector forward;
    Vector up;
    double fov_y;
    Motion motion;
    std::uint32_t reserved;
    Vector velocity;
    double tan_left;
    double tan_right;
    double tan_down;
    double tan_up;
    std::array<double, 2> jitter;

    Camera() noexcept { detail::defaults(*this, bhr_camera_init); }
    BhrCamera c() const noexcept { return detail::as_c<BhrCamera>(*this); }

    /// bhr_camera_look_at.
    Result<void> look_at(const Vector &from, const Vector &target, const Vector &upward = {0.0, 0.0, 1.0}) {
        return change([&](BhrCamera *it) {
            return bhr_camera_look_at(it, from.data(), target.data(), upward.data());
        });
    }

    /// bhr_camera_orbit; angles in radians.
    Result<void> orbit(double distance, double azimuth, double elevation) {
        return change([&](BhrCamera *it) { return bhr_camera_orbit(it, distance, azimuth, elevation); });
    }

  private:
    template <class Function> Result<void> change(Function &&function) {
        BhrCamera copy = c();
        Result<void> done = detail::call([&] { return function(&copy); });
        if (done) {
            detail::take(*this, copy);
        }
        return done;
    }
};

} // namespace bhr

#endif
