// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a camera's projection takes positions of the frame to directions, in the camera's own axes (right, up,
//! forward). Knows neither hole nor observer. Mirrored by `shaders/camera/projection.wgsl`.

use super::{Camera, Projection, Region};
use crate::error::{Error, Result};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A projection onto a frame. Every position has a point, which continues the projection outside the frame;
/// `has_look_direction` says where the projection shows something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    /// The formula (`Projection::formula`): FRUSTUM is a PERSPECTIVE about another centre.
    pub projection: Projection,
    /// Size of the full frame in pixels.
    pub width: f64,
    pub height: f64,
    /// Halves of the perspective image plane's sides at distance 1; else 1.
    pub plane: DVec2,
    /// The middle of the frame on that plane, right and up of straight ahead; else 0.
    pub centre: DVec2,
    /// Angle of a pixel in the middle of the frame (of a cube's faces as if one filled its side), radians.
    pub pixel_angle: f64,
}

impl Mapping {
    /// Errors: INVALID_STATE for a cube whose frame is not six times as wide as high.
    pub fn new(camera: &Camera, region: &Region) -> Result<Self> {
        let projection = camera.projection.formula();
        if projection == Projection::Cube && u64::from(region.full_width) != 6 * u64::from(region.full_height) {
            return Err(Error::state(format!(
                "frame is {} x {}; the projection CUBE shows six faces side by side, so its width must be 6 times \
                 its height, {}",
                region.full_width,
                region.full_height,
                6 * u64::from(region.full_height)
            )));
        }
        let (width, height) = (f64::from(region.full_width), f64::from(region.full_height));
        let tan = (0.5 * camera.fov_y).tan();
        let borders = camera.frustum;
        let (plane, middle) = match camera.projection {
            Projection::Perspective => (DVec2::new(tan * width / height, tan), DVec2::ZERO),
            Projection::Frustum => (
                0.5 * DVec2::new(borders.right - borders.left, borders.up - borders.down),
                0.5 * DVec2::new(borders.right + borders.left, borders.up + borders.down),
            ),
            _ => (DVec2::ONE, DVec2::ZERO),
        };
        // The jitter moves what was in the middle to the right and down.
        let shift = plane * camera.jitter * DVec2::new(-2.0 / width, 2.0 / height);
        let centre = if projection == Projection::Perspective { middle + shift } else { DVec2::ZERO };
        let pixel_angle = match projection {
            Projection::Perspective | Projection::Frustum => 2.0 * plane.y / height,
            Projection::Fisheye => camera.fov_y / width.min(height),
            Projection::Equirect => PI / height,
            Projection::Cube => FRAC_PI_2 / height,
        };
        Ok(Self { projection, width, height, plane, centre, pixel_angle })
    }

    /// Whether something is seen at (x, y): all but what lies outside a fisheye's circle.
    pub fn has_look_direction(&self, x: f64, y: f64) -> bool {
        let radius = 0.5 * self.width.min(self.height);
        self.projection != Projection::Fisheye || self.offset(x, y).length_squared() <= radius * radius
    }

    /// Whether no border between two faces of a cube lies between positions of a row.
    pub fn same_face(&self, x0: f64, x1: f64) -> bool {
        self.projection != Projection::Cube || self.face(x0) == self.face(x1)
    }

    /// A point (right, up, forward) in the direction seen at (x, y) of the full frame, (0, 0) being its top-left
    /// corner; PERSPECTIVE: right and up of `centre` in units of `plane`. Outside the frame the image plane, the angles
    /// or the nearest face continue.
    pub fn point(&self, x: f64, y: f64) -> DVec3 {
        match self.projection {
            Projection::Perspective | Projection::Frustum => {
                DVec3::new(2.0 * x / self.width - 1.0, 1.0 - 2.0 * y / self.height, 1.0)
            }
            Projection::Fisheye => {
                let (from_centre, radius) = (self.offset(x, y), self.offset(x, y).length());
                let (sin, cos) = (self.pixel_angle * radius).sin_cos();
                (from_centre * self.across(sin, radius)).extend(cos)
            }
            Projection::Equirect => {
                let [(sin_lon, cos_lon), (sin_lat, cos_lat)] = self.longitude_and_latitude(x, y).map(f64::sin_cos);
                DVec3::new(cos_lat * sin_lon, sin_lat, cos_lat * cos_lon)
            }
            Projection::Cube => {
                let face = self.face(x);
                let right = 2.0 * (x - face * self.height) / self.height - 1.0;
                turned_to_face(face as u8, DVec3::new(right, 1.0 - 2.0 * y / self.height, 1.0))
            }
        }
    }

    /// The position whose `point` lies in the direction of `p`; `None`: behind a perspective's image plane. Opposite a
    /// fisheye's centre it is one of the many.
    pub fn position(&self, p: DVec3) -> Option<DVec2> {
        let size = DVec2::new(self.width, self.height);
        let on_plane = |p: DVec3| DVec2::new(0.5 + 0.5 * p.x / p.z, 0.5 - 0.5 * p.y / p.z);
        match self.projection {
            Projection::Perspective | Projection::Frustum => (p.z > 0.0).then(|| on_plane(p) * size),
            Projection::Fisheye => {
                let side = p.truncate();
                let radius = side.length().atan2(p.z) / self.pixel_angle;
                let from_centre = side.normalize_or(DVec2::X) * radius;
                Some(0.5 * size + DVec2::new(from_centre.x, -from_centre.y))
            }
            Projection::Equirect => {
                let (longitude, latitude) = (p.x.atan2(p.z), p.y.atan2(p.x.hypot(p.z)));
                Some(DVec2::new(0.5 + longitude / TAU, 0.5 - latitude / PI) * size)
            }
            Projection::Cube => {
                let most = p.abs().max_element();
                let face = match p {
                    p if p.z.abs() == most => 4 + u8::from(p.z < 0.0),
                    p if p.x.abs() == most => u8::from(p.x < 0.0),
                    p => 2 + u8::from(p.y < 0.0),
                };
                let at = on_plane(turned_from_face(face, p)) * self.height;
                Some(DVec2::new(f64::from(face) * self.height + at.x, at.y))
            }
        }
    }

    /// Changes of `point` to the next pixel right and down, to first order.
    pub fn changes(&self, x: f64, y: f64) -> [DVec3; 2] {
        match self.projection {
            Projection::Perspective | Projection::Frustum => {
                [DVec3::X * (2.0 / self.width), DVec3::Y * (-2.0 / self.height)]
            }
            Projection::Fisheye => {
                let from_centre = self.offset(x, y);
                let radius = from_centre.length();
                let outward = if radius > 0.0 { from_centre / radius } else { DVec2::X };
                let (sin, cos) = (self.pixel_angle * radius).sin_cos();
                [DVec2::X, DVec2::NEG_Y].map(|step| {
                    let along = outward.dot(step);
                    let across = (step - outward * along) * self.across(sin, radius);
                    (outward * (self.pixel_angle * along * cos) + across).extend(-self.pixel_angle * along * sin)
                })
            }
            Projection::Equirect => {
                let [(sin_lon, cos_lon), (sin_lat, cos_lat)] = self.longitude_and_latitude(x, y).map(f64::sin_cos);
                [
                    DVec3::new(cos_lon, 0.0, -sin_lon) * (cos_lat * TAU / self.width),
                    DVec3::new(sin_lat * sin_lon, -cos_lat, sin_lat * cos_lon) * (PI / self.height),
                ]
            }
            Projection::Cube => {
                let (face, step) = (self.face(x) as u8, 2.0 / self.height);
                [DVec3::X * step, DVec3::NEG_Y * step].map(|change| turned_to_face(face, change))
            }
        }
    }

    /// The distance from the centre, pixels, to the right and up.
    fn offset(&self, x: f64, y: f64) -> DVec2 {
        DVec2::new(x - 0.5 * self.width, 0.5 * self.height - y)
    }

    /// sin(angle) / radius of a fisheye, which stretches across the radius.
    fn across(&self, sin: f64, radius: f64) -> f64 {
        if radius > 0.0 { sin / radius } else { self.pixel_angle }
    }

    /// Longitude from forward to the right, and latitude, radians; beyond the poles latitudes go on.
    fn longitude_and_latitude(&self, x: f64, y: f64) -> [f64; 2] {
        [TAU * (x / self.width - 0.5), FRAC_PI_2 * (1.0 - 2.0 * y / self.height)]
    }

    /// Number of a cube's face, 0 .. 5. By the middle of the pixel, so that f32 rounds none to another face.
    fn face(&self, x: f64) -> f64 {
        ((x.floor() + 0.5) / self.height).floor().clamp(0.0, 5.0)
    }
}

/// A point that a 90 degree camera sees, of the camera that looks along a face's middle: right left up down front
/// back. Its right = forward x up as everywhere; up is up, on the up face backward, on the down face forward.
pub(crate) fn turned_to_face(face: u8, p: DVec3) -> DVec3 {
    match face {
        0 => DVec3::new(p.z, p.y, -p.x),
        1 => DVec3::new(-p.z, p.y, p.x),
        2 => DVec3::new(p.x, p.z, -p.y),
        3 => DVec3::new(p.x, -p.z, p.y),
        4 => p,
        _ => DVec3::new(-p.x, p.y, -p.z),
    }
}

/// The reverse of `turned_to_face`.
fn turned_from_face(face: u8, p: DVec3) -> DVec3 {
    match face {
        0 => DVec3::new(-p.z, p.y, p.x),
        1 => DVec3::new(p.z, p.y, -p.x),
        2 => DVec3::new(p.x, -p.z, p.y),
        3 => DVec3::new(p.x, p.z, -p.y),
        4 => p,
        _ => DVec3::new(-p.x, p.y, -p.z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mapping(projection: Projection, [full_width, full_height]: [u32; 2], fov_y: f64) -> Mapping {
        let camera = Camera { projection, fov_y, ..Camera::default() };
        Mapping::new(&camera, &Region { full_width, full_height, x: 0, y: 0 }).unwrap()
    }

    fn mappings() -> [Mapping; 5] {
        [
            mapping(Projection::Perspective, [300, 200], 1.0),
            mapping(Projection::Fisheye, [300, 200], PI),
            mapping(Projection::Fisheye, [150, 200], TAU),
            mapping(Projection::Equirect, [300, 200], 1.0),
            mapping(Projection::Cube, [600, 100], 1.0),
        ]
    }

    #[test]
    fn changes_are_the_derivatives_of_points() {
        for m in mappings() {
            // Inside, outside, at the centre, beside the borders of faces.
            for (x, y) in [(0.3, 0.2), (150.0, 100.0), (99.8, 31.0), (100.2, 70.0), (-3.2, 208.0), (290.0, -0.7)] {
                let h = 1e-4;
                let central = |dx: f64, dy: f64| (m.point(x + dx, y + dy) - m.point(x - dx, y - dy)) / (2.0 * h);
                for (change, truth) in m.changes(x, y).into_iter().zip([central(h, 0.0), central(0.0, h)]) {
                    assert!(change.abs_diff_eq(truth, 1e-9), "{m:?} ({x}, {y}): {change} {truth}");
                }
            }
        }
    }

    #[test]
    fn every_position_has_a_finite_point() {
        for m in mappings() {
            for x in [-1e9, -1.0, 0.0, 75.0, 150.0, 299.5, 600.0, 1e9] {
                for y in [-1e9, -0.5, 0.0, 50.0, 100.0, 200.0, 1e9] {
                    let [dx, dy] = m.changes(x, y);
                    assert!(m.point(x, y).is_finite() && dx.is_finite() && dy.is_finite(), "{m:?} ({x}, {y})");
                    assert!(m.point(x, y).length() > 0.9, "{m:?} ({x}, {y})");
                }
            }
        }
    }

    #[test]
    fn directions_are_those_of_the_header() {
        let near = |a: DVec3, b: DVec3| assert!(a.normalize().abs_diff_eq(b.normalize(), 1e-12), "{a} {b}");
        let dome = mapping(Projection::Fisheye, [300, 200], PI);
        near(dome.point(150.0, 100.0), DVec3::Z);
        near(dome.point(250.0, 100.0), DVec3::X);
        near(dome.point(150.0, 0.0), DVec3::Y);
        near(dome.point(150.0, 150.0), DVec3::new(0.0, -1.0, 1.0));
        assert!(
            dome.has_look_direction(249.9, 100.0)
                && !dome.has_look_direction(250.1, 100.0)
                && !dome.has_look_direction(1.0, 1.0)
        );
        let all = mapping(Projection::Equirect, [300, 200], 1.0);
        near(all.point(150.0, 100.0), DVec3::Z);
        near(all.point(225.0, 100.0), DVec3::X);
        near(all.point(0.0, 100.0), DVec3::NEG_Z);
        near(all.point(40.0, 0.0), DVec3::Y);
        near(all.point(150.0, -50.0), DVec3::new(0.0, 1.0, -1.0));
        let cube = mapping(Projection::Cube, [600, 100], 1.0);
        let [right, up, forward] = [DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [
            (right, -forward, up),
            (-right, forward, up),
            (up, right, -forward),
            (-up, right, forward),
            (forward, right, up),
            (-forward, -right, up),
        ];
        for ((ahead, to_right, above), i) in faces.into_iter().zip(0..) {
            let x = 100.0 * f64::from(i) + 50.0;
            near(cube.point(x, 50.0), ahead);
            near(cube.point(x + 49.0, 50.0), ahead + 0.98 * to_right);
            near(cube.point(x, 1.0), ahead + 0.98 * above);
            // No mirror image: right = forward x up, with right x up = -forward as in camera axes.
            assert!(to_right.cross(above).dot(ahead) == right.cross(up).dot(forward));
            assert_eq!(cube.same_face(x, x + 50.0), i == 5);
            assert!(cube.same_face(x - 50.0, x + 49.999));
        }
        assert!(cube.same_face(-1.0, 0.0));
    }

    #[test]
    fn positions_are_where_points_are_seen() {
        for m in mappings() {
            for (x, y) in [(0.3, 0.2), (150.5, 100.4), (99.8, 31.0), (100.2, 70.0), (290.0, 0.7), (12.0, 49.0)] {
                if !m.has_look_direction(x, y) || (m.projection == Projection::Cube && y > m.height) {
                    continue;
                }
                let back = m.position(m.point(x, y) * 3.0).unwrap();
                assert!(back.abs_diff_eq(DVec2::new(x, y), 1e-9), "{m:?}: {x} {y} {back}");
            }
        }
        assert_eq!(mapping(Projection::Perspective, [300, 200], 1.0).position(DVec3::NEG_Z), None);
    }

    #[test]
    fn a_cube_wants_six_faces() {
        let camera = Camera { projection: Projection::Cube, ..Camera::default() };
        for (full_width, full_height) in [(600, 101), (1, 1), (601, 100), (1 << 20, 174_763)] {
            let error = Mapping::new(&camera, &Region { full_width, full_height, x: 0, y: 0 }).unwrap_err();
            assert!(error.message.contains(&(6 * full_height).to_string()), "{error}");
        }
    }
}
