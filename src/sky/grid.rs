// SPDX-License-Identifier: MIT OR Apache-2.0
//! The coordinate grid of the sky axes: lines of constant width on the screen, laid over the sky. The same in both
//! tracers (`shaders/sky/grid.wgsl`). Knows no cameras and no holes.
//!
//! There is a line of right ascension every 15 degrees (an hour), from declination +-75 degrees to the poles every 90,
//! and a line of declination every 15. The distance of a pixel from a line follows from the coordinate's distance to
//! the line and the length of its gradient by pixel. Where the lens squeezes lines together, they fade out before they
//! run into each other: first those between the multiples of 45 degrees, then those between the multiples of 90, then
//! these, so that each line that is seen is a line. A faint tint takes their place, which tells the sky from a shadow.

use glam::DVec3;
use std::f64::consts::PI;

/// Spacing of the lines, rad.
pub(crate) const GRID_SPACING: f64 = PI / 12.0;
/// Spacings, in GRID_SPACING, of the lines that last the longer where all are squeezed together: each a multiple of the
/// one before. The last one alone is that of the lines of right ascension beyond GRID_CAP.
pub(crate) const GRID_RANKS: [f64; 3] = [1.0, 3.0, 6.0];
/// The sine of a declination with a line of its own.
pub(crate) const GRID_CAP: f64 = 0.965_925_826_289_068_3;
/// Width of a line, pixels.
pub(crate) const GRID_WIDTH: f64 = 1.3;
/// Distances between lines of a rank, pixels, from which on they are all there, and below which they are gone.
pub(crate) const GRID_OPEN: f64 = 10.0;
pub(crate) const GRID_DENSE: f64 = 5.0;
/// Coverage of the tint where the lines of the first rank are gone, for each family. Lines stand out from it, and it
/// from black.
pub(crate) const GRID_TINT: f64 = 0.07;
/// A pixel that sees more of the sky than this (sr), or of whose patch nothing is known, is a tint.
pub(crate) const GRID_WHOLE_SKY: f64 = 100.0;
/// Linear Rec. 709 radiance of the lines, and of the equator and right ascension 0.
pub(crate) const GRID_COLOUR: [f64; 3] = [0.05, 0.16, 0.26];
pub(crate) const GRID_ORIGIN_COLOUR: [f64; 3] = [0.42, 0.17, 0.03];

/// Coverage of a family: of its tint, of the line that covers most of the pixel, and whether that is the line where the
/// coordinate is 0.
#[derive(Clone, Copy)]
struct GridLines {
    tint: f64,
    coverage: f64,
    is_origin: bool,
}

/// Lines of one rank, without a tint, wherever a coordinate is a multiple of `spacing`. `change`: of the coordinate by
/// pixel.
fn grid_rank(coordinate: f64, change: f64, spacing: f64) -> GridLines {
    let number = (coordinate / spacing).round();
    let gap = spacing / change.max(1e-12);
    let distance = (coordinate / spacing - number).abs() * gap;
    // A box of a pixel over the line: its integral across the line is GRID_WIDTH.
    let sharp = (0.5 * GRID_WIDTH + 0.5 - distance).clamp(0.0, 1.0);
    let open = ((gap - GRID_DENSE) / (GRID_OPEN - GRID_DENSE)).clamp(0.0, 1.0);
    GridLines { tint: GRID_TINT * (1.0 - open), coverage: sharp * open, is_origin: number == 0.0 }
}

/// All lines of a coordinate; `sparse`: those of the last rank alone. A line of a higher rank is one of each lower rank
/// as well, so that the one which covers most is that of the highest rank.
fn grid_lines(coordinate: f64, change: f64, sparse: bool) -> GridLines {
    let [first, second, third] = GRID_RANKS.map(|rank| grid_rank(coordinate, change, rank * GRID_SPACING));
    if sparse {
        return third;
    }
    let better =
        |a: GridLines, b: GridLines| if b.coverage >= a.coverage { GridLines { tint: a.tint, ..b } } else { a };
    better(better(first, second), third)
}

/// `light` of the sky under the grid. `d`: unit direction in sky axes; `dx`, `dy`: its derivatives by pixel.
pub fn under_grid(light: [f64; 3], d: DVec3, dx: DVec3, dy: DVec3) -> [f64; 3] {
    let unknown = GridLines { tint: GRID_TINT, coverage: 0.0, is_origin: false };
    let stretch2 = dx.length_squared() + dy.length_squared();
    // The condition is positive so that it is false for NaN.
    let families = if stretch2 < GRID_WHOLE_SKY {
        // cos(declination), with the poles kept off.
        let rho = d.x.hypot(d.y).max(1e-6);
        let east = DVec3::new(-d.y, d.x, 0.0) / (rho * rho);
        let change = |gradient: DVec3| dx.dot(gradient).hypot(dy.dot(gradient));
        [
            grid_lines(d.y.atan2(d.x), change(east), d.z.abs() >= GRID_CAP),
            grid_lines(d.z.atan2(rho), change(DVec3::Z / rho), false),
        ]
    } else {
        [unknown; 2]
    };
    families.iter().fold(light, |light, lines| {
        let colour = if lines.is_origin { GRID_ORIGIN_COLOUR } else { GRID_COLOUR };
        std::array::from_fn(|c| {
            let tinted = light[c] + (GRID_COLOUR[c] - light[c]) * lines.tint;
            tinted + (colour[c] - tinted) * lines.coverage
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

    /// Where the sky is squeezed, lines are seen one by one or not at all, and those that go first are the least ones.
    #[test]
    fn squeezed_lines_thin_out_and_stay_lines() {
        let light = |ra: f64, gap: f64| {
            let d = towards(ra, 0.5);
            let east = DVec3::new(-d.y, d.x, 0.0).normalize();
            // Lines of right ascension lie `gap` pixels apart; the parallels are far away.
            under_grid([0.0; 3], d, east * (GRID_SPACING / gap), DVec3::Z * 1e-4)
        };
        let faint = GRID_COLOUR[2] * GRID_TINT;
        for (gap, seen) in [(10.0, 1), (3.4, 3), (4.9, 3), (1.6668, 6), (0.7, 0)] {
            for hour in 1..24 {
                let on = light(15.0 * f64::from(hour), gap)[2];
                let whole = seen > 0 && hour % seen == 0;
                assert!(if whole { on > 0.9 * GRID_COLOUR[2] } else { on < 1.1 * faint }, "{gap} {hour}: {on}");
            }
            // There is a gap between two lines that are seen.
            let between = light(7.5 * f64::from(seen.max(1)), gap)[2];
            assert!(between < 1.1 * faint, "{gap}: {between}");
        }
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
