// SPDX-License-Identifier: MIT OR Apache-2.0
//! The coordinate grid of the sky axes: lines of constant width on the screen, laid over the sky. The same in both
//! tracers (`shaders/sky/grid.wgsl`). Knows no cameras and no holes.
//!
//! There is a line of right ascension every 15 degrees (an hour), from declination +-75 degrees to the poles every 90,
//! and a line of declination every 15. The distance of a pixel from a line follows from the coordinate's distance to
//! the line and the length of its gradient by pixel. Where the lens squeezes lines together until they would run into
//! each other they fade into an even tint.

use glam::DVec3;
use std::f64::consts::PI;

/// Spacing of the lines, rad.
pub(crate) const GRID_SPACING: f64 = PI / 12.0;
/// Spacing of the lines of right ascension beyond GRID_CAP, rad; GRID_CAP is the sine of a declination with a line of
/// its own.
pub(crate) const GRID_CAP_SPACING: f64 = PI / 2.0;
pub(crate) const GRID_CAP: f64 = 0.965_925_826_289_068_3;
/// Width of a line, pixels.
pub(crate) const GRID_WIDTH: f64 = 1.3;
/// Distances between lines, pixels, from which on they are lines, and below which they are a tint.
pub(crate) const GRID_OPEN: f64 = 10.0;
pub(crate) const GRID_DENSE: f64 = 5.0;
/// Coverage of that tint: the coverage of lines at GRID_DENSE, and no more where they are denser.
pub(crate) const GRID_TINT: f64 = GRID_WIDTH / GRID_DENSE;
/// A pixel that sees more of the sky than this (sr), or of whose patch nothing is known, is a tint.
pub(crate) const GRID_WHOLE_SKY: f64 = 100.0;
/// Linear Rec. 709 radiance of the lines, and of the equator and right ascension 0.
pub(crate) const GRID_COLOUR: [f64; 3] = [0.05, 0.16, 0.26];
pub(crate) const GRID_ORIGIN_COLOUR: [f64; 3] = [0.42, 0.17, 0.03];

/// Coverage of a family of lines, and how much of it is of the line where the coordinate is 0.
#[derive(Clone, Copy)]
struct GridLines {
    coverage: f64,
    origin: f64,
}

/// Lines wherever a coordinate is a multiple of `spacing`. `change`: of the coordinate by pixel.
fn grid_lines(coordinate: f64, change: f64, spacing: f64) -> GridLines {
    let number = (coordinate / spacing).round();
    let gap = spacing / change.max(1e-12);
    let distance = (coordinate / spacing - number).abs() * gap;
    // A box of a pixel over the line: its integral across the line is GRID_WIDTH.
    let sharp = (0.5 * GRID_WIDTH + 0.5 - distance).clamp(0.0, 1.0);
    let open = ((gap - GRID_DENSE) / (GRID_OPEN - GRID_DENSE)).clamp(0.0, 1.0);
    let tint = (GRID_WIDTH / gap).min(GRID_TINT);
    GridLines { coverage: tint + (sharp - tint) * open, origin: if number == 0.0 { open } else { 0.0 } }
}

/// `light` of the sky under the grid. `d`: unit direction in sky axes; `dx`, `dy`: its derivatives by pixel.
pub fn under_grid(light: [f64; 3], d: DVec3, dx: DVec3, dy: DVec3) -> [f64; 3] {
    let unknown = GridLines { coverage: GRID_TINT, origin: 0.0 };
    let stretch2 = dx.length_squared() + dy.length_squared();
    // The condition is positive so that it is false for NaN.
    let families = if stretch2 < GRID_WHOLE_SKY {
        // cos(declination), with the poles kept off.
        let rho = d.x.hypot(d.y).max(1e-6);
        let east = DVec3::new(-d.y, d.x, 0.0) / (rho * rho);
        let change = |gradient: DVec3| dx.dot(gradient).hypot(dy.dot(gradient));
        let spacing = if d.z.abs() < GRID_CAP { GRID_SPACING } else { GRID_CAP_SPACING };
        [
            grid_lines(d.y.atan2(d.x), change(east), spacing),
            grid_lines(d.z.atan2(rho), change(DVec3::Z / rho), GRID_SPACING),
        ]
    } else {
        [unknown; 2]
    };
    families.iter().fold(light, |light, lines| {
        std::array::from_fn(|c| {
            let colour = GRID_COLOUR[c] + (GRID_ORIGIN_COLOUR[c] - GRID_COLOUR[c]) * lines.origin;
            light[c] + (colour - light[c]) * lines.coverage
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn towards(ra: f64, dec: f64) -> DVec3 {
        let (ra, dec) = (ra.to_radians(), dec.to_radians());
        DVec3::new(dec.cos() * ra.cos(), dec.cos() * ra.sin(), dec.sin())
    }

    /// Square pixels of `scale` rad, north up.
    fn over_black(d: DVec3, scale: f64) -> [f64; 3] {
        let east = DVec3::new(-d.y, d.x, 0.0).normalize();
        under_grid([0.0; 3], d, east * -scale, d.cross(east) * -scale)
    }

    /// The light along a path, in units of a line's, times pixels: the width of the line that it crosses.
    fn width(path: impl Fn(f64) -> DVec3, scale: f64) -> f64 {
        const STEPS: i32 = 4000;
        let reach = 5.0;
        let sample =
            |i: i32| over_black(path(scale * reach * f64::from(i) / f64::from(STEPS)), scale)[1] / GRID_COLOUR[1];
        (-STEPS..=STEPS).map(sample).sum::<f64>() * reach / f64::from(STEPS)
    }

    #[test]
    fn lines_are_as_wide_everywhere_and_at_any_scale() {
        for scale in [1e-5, 1e-3, 4e-3] {
            for dec in [0.0_f64, 20.0, -50.0, 70.0] {
                let step = |t: f64| t.to_degrees() / (dec + 3.1).to_radians().cos();
                let meridian = width(|t| towards(15.0 + step(t), dec + 3.1), scale);
                let parallel = width(|t| towards(22.0, 30.0_f64.copysign(dec) + t.to_degrees()), scale);
                assert!((meridian - GRID_WIDTH).abs() < 0.02, "{scale} {dec}: {meridian}");
                assert!((parallel - GRID_WIDTH).abs() < 0.02, "{scale} {dec}: {parallel}");
            }
        }
    }

    #[test]
    fn lines_are_where_they_belong() {
        let scale = 1e-3;
        for hour in 0..24 {
            let ra = 15.0 * f64::from(hour);
            let on = over_black(towards(ra, 7.0), scale);
            assert_eq!(on, if hour == 0 { GRID_ORIGIN_COLOUR } else { GRID_COLOUR }, "hour {hour}");
            assert_eq!(over_black(towards(ra + 7.0, 7.0), scale), [0.0; 3]);
            // Near the poles every sixth goes on.
            let cap = over_black(towards(ra, 80.0), scale);
            assert_eq!(cap != [0.0; 3], hour % 6 == 0, "hour {hour} near the pole");
        }
        for dec in [-75.0, -30.0, 15.0, 60.0] {
            assert_eq!(over_black(towards(7.0, dec), scale), GRID_COLOUR, "declination {dec}");
        }
        assert_eq!(over_black(towards(7.0, 0.0), scale), GRID_ORIGIN_COLOUR);
    }

    #[test]
    fn dense_lines_become_a_tint_and_nothing_is_odd() {
        let tint = under_grid([0.0; 3], DVec3::X, DVec3::splat(1e30), DVec3::splat(1e30));
        let wanted = GRID_COLOUR.map(|c| c * (1.0 - (1.0 - GRID_TINT) * (1.0 - GRID_TINT)));
        assert!((0..3).all(|c| (tint[c] - wanted[c]).abs() < 1e-12), "{tint:?}");
        // The tint is the coverage of both families.
        let dense = under_grid([0.0; 3], towards(7.0, 50.0), DVec3::Y * 1.0, DVec3::Z * 1.0);
        assert!((0..3).all(|c| (dense[c] - wanted[c]).abs() < 1e-12), "{dense:?}");
        let light = [1e9, 0.0, 3.0];
        for d in [DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::NEG_X] {
            for dx in [DVec3::ZERO, DVec3::X, DVec3::NAN, DVec3::Y * 1e-300, DVec3::splat(f64::INFINITY)] {
                let seen = under_grid(light, d, dx, DVec3::Y * 1e-3);
                assert!(seen.iter().all(|v| (0.0..=1e9).contains(v)), "{d} {dx}: {seen:?}");
            }
        }
    }
}
