// SPDX-License-Identifier: MIT OR Apache-2.0
//! Depth of field: a camera at the places of a thin lens. A lens brings the light that comes from a point at the
//! distance in focus to one point of the picture, wherever on the lens it arrives (R. L. Cook, T. Porter, L. Carpenter
//! 1984, "Distributed ray tracing", SIGGRAPH): pictures from pinholes all over the lens, sheared so that what is in
//! focus stays in place, are added up. Knows neither tracers nor accumulations.

use super::camera::Frustum;
use super::{Camera, Projection};
use crate::error::{Error, Number, Result, out_of_range};
use glam::DVec2;
use std::f64::consts::TAU;

/// A round thin lens, and the shape of the frame before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Its diameter, scene lengths, at least 0.
    pub aperture: f64,
    /// The distance along the line of sight of the plane that is in focus, scene lengths, above 0.
    pub focus: f64,
    /// The frame's width over its height, above 0; `Projection::Frustum` does not need it.
    pub aspect: f64,
}

impl ThinLens {
    /// The most places on a lens: as many frames as an accumulation takes.
    pub const MOST_PLACES: u32 = 65536;

    fn check(&self) -> Result<()> {
        let positive = [("focus", self.focus), ("aspect", self.aspect)];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::argument(format!(
                    "{name} is {}; it must be finite and greater than 0",
                    Number(value)
                )));
            }
        }
        if !(self.aperture >= 0.0 && self.aperture.is_finite()) {
            return Err(Error::argument(format!(
                "aperture is {}; it must be finite and not less than 0",
                Number(self.aperture)
            )));
        }
        Ok(())
    }
}

/// Place `index` of `count` in the unit disk, the middle of one alone. Each lies on a ring of its own, all of equal
/// area, so that the mean of r^2 is the disk's; the rings follow each other by steps near the golden ratio, and the
/// angles by the radical inverse in base 2 (van der Corput 1935), so that places in a row lie far from each other.
fn place(index: u32, count: u32) -> DVec2 {
    if count < 2 {
        return DVec2::ZERO;
    }
    let ring = u64::from(index) * u64::from(stride(count)) % u64::from(count);
    let radius = ((ring as f64 + 0.5) / f64::from(count)).sqrt();
    radius * DVec2::from_angle(TAU * f64::from(index.reverse_bits()) / 4_294_967_296.0)
}

/// The first number, from 0.618 `count` rounded to a whole number upwards, that has no divisor in common with `count`.
fn stride(count: u32) -> u32 {
    let mut stride = ((f64::from(count) * 0.618_033_988_75).round() as u32).max(1);
    while divisor(stride, count) != 1 {
        stride += 1;
    }
    stride
}

/// The greatest common divisor of two numbers, by Euclid's algorithm.
fn divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { divisor(b, a % b) }
}

impl Camera {
    /// The camera at place `index` of `count` on a lens about it, with the frustum from there: what lies in the plane
    /// in focus stays where it is in the picture. All places count alike.
    ///
    /// Errors: INVALID_ARGUMENT for another projection than PERSPECTIVE and FRUSTUM, numbers of the lens out of range,
    /// an `index` that is not below `count`, a `count` of 0 or above `MOST_PLACES`, and a camera that `check` refuses.
    pub fn through_lens(&self, lens: &ThinLens, index: u32, count: u32) -> Result<Self> {
        lens.check()?;
        if count == 0 || count > ThinLens::MOST_PLACES {
            return Err(out_of_range("count", f64::from(count), 1.0, f64::from(ThinLens::MOST_PLACES)));
        }
        if index >= count {
            return Err(Error::argument(format!("index is {index}; it must be less than count, {count}")));
        }
        let tan = (0.5 * self.fov_y).tan();
        let Frustum { left, right, down, up } = match self.projection {
            Projection::Perspective => {
                let across = tan * lens.aspect;
                Frustum { left: -across, right: across, down: -tan, up: tan }
            }
            Projection::Frustum => self.frustum,
            other => {
                return Err(Error::argument(format!(
                    "camera projection is {}; a lens has PERSPECTIVE (0) or FRUSTUM (4)",
                    other as i32
                )));
            }
        };
        self.check()?;
        let axes = self.axes()?;
        let offset = 0.5 * lens.aperture * place(index, count);
        let shift = offset / lens.focus;
        let frustum = Frustum { left: left - shift.x, right: right - shift.x, down: down - shift.y, up: up - shift.y };
        let position = self.position + axes.x_axis * offset.x + axes.y_axis * offset.y;
        let moved = Self { projection: Projection::Frustum, position, frustum, ..*self };
        moved.check()?;
        Ok(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const LENS: ThinLens = ThinLens { aperture: 0.8, focus: 12.0, aspect: 1.6 };

    /// Where a point is seen, as a share of the frame's sides.
    fn seen(camera: &Camera, aspect: f64, point: DVec3) -> DVec2 {
        let axes = camera.axes().unwrap();
        let local = axes.transpose() * (point - camera.position);
        let at = DVec2::new(local.x, local.y) / local.z;
        let tan = (0.5 * camera.fov_y).tan();
        let Frustum { left, right, down, up } = match camera.projection {
            Projection::Frustum => camera.frustum,
            _ => Frustum { left: -tan * aspect, right: tan * aspect, down: -tan, up: tan },
        };
        DVec2::new((at.x - left) / (right - left), (at.y - down) / (up - down))
    }

    /// Points in focus stay; others move over a disk of the diameter that a thin lens gives them,
    /// aperture |1 / distance - 1 / focus| on the plane at distance 1.
    #[test]
    fn points_in_focus_stay_and_others_move_over_the_circle_of_confusion() {
        let camera = Camera { up: DVec3::new(0.2, 0.1, 0.9), ..Camera::default() };
        let axes = camera.axes().unwrap();
        let at = |distance: f64| camera.position + axes * DVec3::new(0.2 * distance, -0.1 * distance, distance);
        let height = 2.0 * (0.5 * camera.fov_y).tan();
        for distance in [12.0, 5.0, 26.0, 1e6] {
            let wanted = 0.5 * LENS.aperture * (1.0 / distance - 1.0 / LENS.focus).abs();
            let middle = seen(&camera, LENS.aspect, at(distance));
            let away = (0..64).map(|index| {
                let moved = camera.through_lens(&LENS, index, 64).unwrap();
                let off = seen(&moved, LENS.aspect, at(distance)) - middle;
                (off * DVec2::new(height * LENS.aspect, height)).length()
            });
            let most = away.fold(0.0, f64::max);
            assert!(most <= wanted + 1e-12 && most > 0.98 * wanted - 1e-12, "{distance}: {most}, not {wanted}");
        }
    }

    /// Places fill the disk evenly: the mean of r^2 is the disk's, the middle nearly, and both for the first half, too.
    #[test]
    fn places_fill_the_lens_evenly() {
        assert_eq!(place(0, 1), DVec2::ZERO);
        for count in [3_u32, 5, 9, 16, 17, 33, 50, 64, 100, 1000, 65_536] {
            let n = f64::from(count);
            for taken in [count, count.div_ceil(2)] {
                let places = || (0..taken).map(|index| place(index, count));
                let mean = places().sum::<DVec2>().length() / f64::from(taken);
                let square = places().map(|p| p.length_squared()).sum::<f64>() / f64::from(taken);
                let slack = 1.0 / n.sqrt();
                let (most_off, most_away) = if taken == count { (1e-9, 0.55 * slack) } else { (slack, slack) };
                assert!(mean < most_away && (square - 0.5).abs() < most_off, "{count} {taken}: {mean} {square}");
            }
        }
    }

    #[test]
    fn bad_lenses_are_refused() {
        let camera = Camera::default();
        let refused = |lens: ThinLens, index, count| camera.through_lens(&lens, index, count).unwrap_err().to_string();
        assert!(refused(ThinLens { aperture: -1.0, ..LENS }, 0, 1).contains("aperture is -1"));
        assert!(refused(ThinLens { focus: 0.0, ..LENS }, 0, 1).contains("focus is 0"));
        assert!(refused(ThinLens { aspect: f64::NAN, ..LENS }, 0, 1).contains("aspect is NaN"));
        assert!(refused(LENS, 4, 4).contains("index is 4") && refused(LENS, 0, 0).contains("count is 0"));
        assert!(refused(LENS, 0, 65_537).contains("65536"));
        let dome = Camera { projection: Projection::Fisheye, ..camera };
        assert!(dome.through_lens(&LENS, 0, 1).unwrap_err().to_string().contains("projection is 1"));
        // A lens of no size is a pinhole.
        let pinhole = camera.through_lens(&ThinLens { aperture: 0.0, ..LENS }, 3, 8).unwrap();
        assert!(pinhole.position == camera.position && pinhole.frustum.right > 0.0);
    }
}
