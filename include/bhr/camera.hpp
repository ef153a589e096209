// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/camera.hpp -- the camera of bhr.h in C++. Include bhr.hpp. */
#ifndef BHR_CAMERA_HPP
#define BHR_CAMERA_HPP

#include "scene.hpp"

namespace bhr {

/// Sixteen numbers, column by column unless MatrixFlags::row_major says otherwise.
using Matrix = std::array<double, 16>;

/// The matrices that rasterisers have: the world's to the camera, and the camera's to clip space.
struct CameraMatrices {
    Matrix view;
    Matrix projection;
};

/// BhrCamera, with the defaults of bhr_camera_init.
struct Camera : CameraFields {
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

    /// bhr_camera_through_lens: place `index` of `count` on a lens, for depth of field.
    Result<void> through_lens(double aperture, double focus, double aspect, std::uint32_t index, std::uint32_t count) {
        return change([&](BhrCamera *it) {
            return bhr_camera_through_lens(it, aperture, focus, aspect, index, count);
        });
    }

    /// bhr_camera_from_matrices.
    Result<void> from_matrices(const Matrix &view, const Matrix &matrix, MatrixFlags flags = MatrixFlags::none) {
        return change([&](BhrCamera *it) {
            return bhr_camera_from_matrices(it, view.data(), matrix.data(), static_cast<std::uint32_t>(flags));
        });
    }

    /// bhr_camera_matrices.
    Result<CameraMatrices> matrices(std::uint32_t width, std::uint32_t height, double near_z, double far_z,
                                    MatrixFlags flags = MatrixFlags::none) const {
        const BhrCamera copy = c();
        return detail::ask(CameraMatrices(), [&](CameraMatrices &made) {
            return bhr_camera_matrices(&copy, width, height, near_z, far_z, static_cast<std::uint32_t>(flags),
                                       made.view.data(), made.projection.data());
        });
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

/// BhrProjectedPoint.
struct ProjectedPoint {
    std::uint32_t struct_size = sizeof(ProjectedPoint);
    std::uint32_t found = 0;
    std::uint32_t on_screen = 0;
    std::uint32_t lost = 0;
    double x = 0.0;
    double y = 0.0;
    Ray ray = {};
    double magnification = 0.0;
    double delay = 0.0;
    double redshift = 0.0;
    double distance = 0.0;
    Vector apparent = {};
};

} // namespace bhr

#endif
