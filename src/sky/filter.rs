// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light of a sky map in a pixel, filtered over the pixel's patch of sky. Both tracers filter alike:
//! `shaders/sky/map.wgsl` has the functions under the same names. Knows no cameras and no holes.
//!
//! The patch is taken for an ellipse, whose axes are the singular values of the pixel's derivatives. A row of trilinear
//! taps stands over it along the major axis. A pixel is to be the mean over its patch of the map as it is magnified,
//! that is, interpolated between texels. The taps are taken from such texels that each blurs by the variance of this
//! mean along the minor axis, and are spread so that their sum has it along the major one (P. Heckbert 1989,
//! "Fundamentals of Texture Mapping and Image Warping", on elliptical filters). The outermost taps come in by their
//! weight, so the sum changes without steps from pixel to pixel. Where a map is magnified, or a patch is round, one tap
//! does.
//!
//! Beside a shadow's edge a pixel sees a line about the sky, whose other dimension the lens has squeezed to nothing:
//! the taps stand on a great circle, and there are more of them the longer it is, so that no tap is wider than WIDE_TAP
//! before there are MOST_SPREAD of them. Shorter lines that are too narrow for MAX_SPREAD are taken for wider ones.

use super::map::{Level, SkyMap};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// The greatest length of a row in texels that its taps are taken from: of rows that are shorter than MAX_SPREAD
/// WIDE_TAP, and of longer ones. So there are at most 8 and 148 taps in a row.
pub(crate) const MAX_SPREAD: f64 = 10.4;
pub(crate) const MOST_SPREAD: f64 = 222.0;
/// The texels that a tap on a long thin line is taken from, rad: some 1.3 degrees; a thin line over as little of the
/// Milky Way tells its light to a few percent.
pub(crate) const WIDE_TAP: f64 = 0.023;
/// rad^2, of the sum of the squares of both axes. A pixel that sees more, or of whose patch nothing is known, gets the
/// mean of all; one that sees more than a turn of a great circle sees a turn of it.
pub(crate) const WHOLE_SKY: f64 = 1e12;
/// The least change of direction by pixel, rad. It keeps divisions finite for cameras of no field of view at all.
pub(crate) const TINY_AXIS: f64 = 1e-12;
/// The distance of neighbouring taps, in texels that they are taken from, at which another pair of them begins to come
/// in.
pub(crate) const TAP_SPACING: f64 = 1.5;
/// A row that is no longer than this, in texels that its taps are taken from, has one tap. A patch whose minor axis is
/// no longer than this, in the finest texels, takes taps from those alone. The square of this length is subtracted from
/// that of longer rows and axes, so that nothing jumps at the limit: a row begins with two taps in one place.
pub(crate) const SHORT_ROW: f64 = 0.3;
/// Taps stand on a straight line of the map where a great circle bends away from it by at most an eighth of this, in
/// texels that they are taken from.
pub(crate) const STRAIGHT: f64 = 0.26;

/// The patch of a pixel, and what taps it asks for.
struct Patch {
    /// The direction of its major axis, a unit vector at right angles to the pixel's; 0 for a patch that is round.
    axis: DVec3,
    /// The ellipse's axes, rad.
    major: f64,
    minor: f64,
    /// The least texel that taps are taken from so that there are not too many of them, rad.
    least: f64,
}

/// Taps in a row, all at one distance from the next.
struct Row {
    count: u32,
    /// How many pairs of taps stand about the middle. If this is not a whole number, its fraction is the weight of the
    /// outermost pair.
    reach: f64,
    /// rad.
    step: f64,
}

/// Sums over taps, of four texels side by side, which the compiler makes vectors of.
#[derive(Default)]
struct Sum {
    red: [f32; 4],
    green: [f32; 4],
    blue: [f32; 4],
}

impl Patch {
    /// `None`: the mean of all.
    fn new(d: DVec3, dx: DVec3, dy: DVec3) -> Option<Self> {
        let (xx, yy, xy) = (dx.length_squared(), dy.length_squared(), dx.dot(dy));
        // The condition is positive so that it is false for NaN.
        let known = xx + yy < WHOLE_SKY;
        if !known {
            return None;
        }
        // The singular values of (dx, dy), from s1^2 + s2^2, s1^2 - s2^2 and s1 s2.
        let half_difference = 0.5 * (xx - yy);
        let half_split = (half_difference * half_difference + xy * xy).sqrt();
        let stretch = (0.5 * (xx + yy) + half_split).sqrt().max(TINY_AXIS);
        let squeezed = dx.cross(dy).dot(d).abs() / stretch;
        // The pixel's direction that becomes the major axis, by the half-angle formula that does not cancel.
        let (x, y) = match half_difference >= 0.0 {
            true => (half_split + half_difference, xy),
            false => (xy, half_split - half_difference),
        };
        let axis = (dx * x + dy * y) / ((x * x + y * y).sqrt() * stretch).max(TINY_AXIS * TINY_AXIS * TINY_AXIS);
        let major = stretch.min(TAU);
        let spread = (major * (1.0 / WIDE_TAP)).clamp(MAX_SPREAD, MOST_SPREAD);
        Some(Self { axis, major, minor: squeezed.min(major), least: major / spread })
    }
}

impl SkyMap {
    /// Linear Rec. 709 radiance of the map in a pixel at rest. `d`: unit direction in sky axes; `dx`, `dy`: its
    /// derivatives by pixel, at right angles to it.
    pub fn light(&self, d: DVec3, dx: DVec3, dy: DVec3) -> [f64; 3] {
        let Some(patch) = Patch::new(d, dx, dy) else { return self.mean() };
        let texel = self.texel_angle();
        // Variances are those of boxes of a width. A tap has three times that of its texels, one for the mean over each
        // and two for the interpolation, as the magnified map has of its own.
        let short = SHORT_ROW * texel;
        let minor2 = (patch.minor * patch.minor - short * short).max(0.0);
        let tap = (texel * texel + minor2 / 3.0).sqrt().max(patch.least);
        let level = level_of(tap / texel).min(self.levels().len() as f64 - 1.0);
        let place = map_place(d);
        let row = Row::new((patch.major * patch.major + 3.0 * (texel * texel - tap * tap)).max(0.0).sqrt(), tap);
        let mut sum = Sum::default();
        if row.count == 1 {
            self.trilinear(&mut sum, place, level, 1.0);
            return sum.light(1.0);
        }
        let rho2 = d.x * d.x + d.y * d.y;
        let length = f64::from(row.count) * row.step;
        let is_straight = length * length * (d.z.abs() + length) < STRAIGHT * tap * rho2.sqrt();
        // The change of the place along the line, by tap. Only of straight lines, which keep off the poles.
        let step = if is_straight { straight_step(d, patch.axis) * row.step } else { DVec2::ZERO };
        // For lines that are not straight: cosine and sine of a step, and of the way to the tap.
        let turn = DVec2::from_angle(row.step);
        let mut way = DVec2::from_angle(row.number(0) * row.step);
        let mut total = 0.0;
        for i in (0..row.count).map(|i| row.number(i)) {
            let weight = row.weight(i);
            let place = match is_straight {
                true => place + step * i,
                false => map_place(d * way.x + patch.axis * way.y),
            };
            self.trilinear(&mut sum, place, level, weight as f32);
            total += weight;
            way = way.rotate(turn);
        }
        sum.light(total)
    }

    /// The mean of the map over the sky.
    fn mean(&self) -> [f64; 3] {
        let mut sum = Sum::default();
        self.trilinear(&mut sum, DVec2::ZERO, self.levels().len() as f64 - 1.0, 1.0);
        sum.light(1.0)
    }

    /// The smaller side of a texel of the finest level at the equator, rad.
    fn texel_angle(&self) -> f64 {
        let [width, height] = self.levels().first().map_or([1, 1], |level| level.size);
        (PI / f64::from(height)).min(TAU / f64::from(width))
    }

    /// Adds the light of the map at a place, interpolated between levels and texels.
    fn trilinear(&self, sum: &mut Sum, place: DVec2, level: f64, weight: f32) {
        let finer = level as usize;
        let share = (level - finer as f64) as f32;
        if let Some(level) = self.levels().get(finer) {
            level.bilinear(sum, place, weight * (1.0 - share));
        }
        if share > 0.0
            && let Some(level) = self.levels().get(finer + 1)
        {
            level.bilinear(sum, place, weight * share);
        }
    }
}

impl Sum {
    fn light(&self, weight: f64) -> [f64; 3] {
        [self.red, self.green, self.blue].map(|[a, b, c, d]| f64::from(a + b + c + d) / weight)
    }
}

impl Row {
    /// With the variance of a line of `length`, of taps that are taken from texels of `tap`; both rad.
    fn new(length: f64, tap: f64) -> Self {
        let short = SHORT_ROW * tap;
        if length <= short {
            return Self { count: 1, reach: 1.0, step: 0.0 };
        }
        let length = (length * length - short * short).sqrt();
        let reach = (0.5 / TAP_SPACING * length / tap).max(1.0);
        let pairs = reach.floor();
        let (outer, rest) = (pairs + 0.5, reach - pairs);
        // The variance of the pairs at 1/2, 3/2, 5/2 ..., of which the outermost has the weight `rest`.
        let variance = (pairs * (4.0 * pairs * pairs - 1.0) / 12.0 + rest * outer * outer) / reach;
        Self { count: 2 * reach.ceil() as u32, reach, step: length / (12.0 * variance).sqrt() }
    }

    /// The place of tap `index`, in steps from the middle.
    fn number(&self, index: u32) -> f64 {
        f64::from(index) - 0.5 * f64::from(self.count - 1)
    }

    fn weight(&self, number: f64) -> f64 {
        (self.reach + 0.5 - number.abs()).min(1.0)
    }
}

/// The level of texels that are `ratio` times as wide as the finest, between levels straight from one ratio to its
/// double: the exponent of the ratio, and its mantissa. At least 0; `ratio` > 0.
pub(crate) fn level_of(ratio: f64) -> f64 {
    let bits = (ratio as f32).max(1.0).to_bits();
    f64::from(bits - 1.0_f32.to_bits()) / f64::from(1 << 23)
}

/// (u, v) of a map, from a vector of any length but 0.
fn map_place(towards: DVec3) -> DVec2 {
    let rho = (towards.x * towards.x + towards.y * towards.y).sqrt();
    let [longitude, latitude] = arctan2([towards.y, towards.z], [towards.x, rho]);
    DVec2::new(0.5 - longitude / TAU, 0.5 - latitude / PI)
}

/// The change of the place of a direction off the poles, for a step of 1 rad along a unit vector at right angles to it.
fn straight_step(d: DVec3, axis: DVec3) -> DVec2 {
    let rho2 = d.x * d.x + d.y * d.y;
    DVec2::new((axis.x * d.y - axis.y * d.x) / (TAU * rho2), axis.z / (-PI * rho2.sqrt()))
}

/// Two atan2(y, x) at once, to 3e-7, a thousandth of a texel of the largest map: `arctan2` of shaders/shared/math.wgsl,
/// without branches, so that the compiler makes vectors of it. 0 at (0, 0).
fn arctan2(y: [f64; 2], x: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|i| {
        let (ax, ay) = (x[i].abs(), y[i].abs());
        let ratio = ax.min(ay) / ax.max(ay).max(f64::MIN_POSITIVE);
        let beyond = ratio > 0.414_213_562_373_1;
        let t = if beyond { (ratio - 1.0) / (ratio + 1.0) } else { ratio };
        let t2 = t * t;
        let series =
            -3.333_294_915_39e-1 + t2 * (1.997_771_064_78e-1 + t2 * (-1.387_768_560_32e-1 + t2 * 8.053_744_495_38e-2));
        let angle = t + t * t2 * series + if beyond { FRAC_PI_4 } else { 0.0 };
        let angle = if ay > ax { FRAC_PI_2 - angle } else { angle };
        let angle = if x[i] < 0.0 { PI - angle } else { angle };
        if y[i] < 0.0 { -angle } else { angle }
    })
}

impl Level {
    /// Around the sky in u; at the poles the outermost rows, which are constant, go on.
    fn bilinear(&self, sum: &mut Sum, place: DVec2, weight: f32) {
        // Straight lines of taps go at most a small part of a turn beyond the seam, but at the poles, where rows are
        // constant.
        let u = if place.x < 0.0 { place.x + 1.0 } else { place.x };
        let u = if u >= 1.0 { u - 1.0 } else { u };
        let [width, height] = self.size;
        // One texel on, so that casts, which cut, round down.
        let (x, y) = (u * f64::from(width) + 0.5, place.y * f64::from(height) + 0.5);
        let (right, below) = (x as u32, y as u32);
        let (sx, sy) = ((x - f64::from(right)) as f32, (y - f64::from(below)) as f32);
        let columns = [if right == 0 { width } else { right.min(width) } - 1, if right >= width { 0 } else { right }];
        let rows = [below.clamp(1, height) - 1, below.min(height - 1)].map(|row| self.row(row));
        let texel = |row: usize, column: usize| rows[row].get(columns[column] as usize).copied().unwrap_or(0);
        let texels = [texel(0, 0), texel(0, 1), texel(1, 0), texel(1, 1)];
        let (above, under) = (weight * (1.0 - sy), weight * sy);
        let weights = [above * (1.0 - sx), above * sx, under * (1.0 - sx), under * sx];
        // RGB9E5 as `unpack` reads it, of four texels at once.
        for i in 0..4 {
            let share = weights[i] * f32::from_bits(((texels[i] >> 27) + 103) << 23);
            let channel = |shift: u32| ((texels[i] >> shift) & 511) as i32 as f32;
            sum.red[i] += share * channel(0);
            sum.green[i] += share * channel(9);
            sum.blue[i] += share * channel(18);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn flat(value: [f32; 3]) -> SkyMap {
        SkyMap::of_rows([64, 32], &|_, out| out.fill(value)).unwrap()
    }

    fn towards(ra: f64, dec: f64) -> DVec3 {
        let (ra, dec) = (ra.to_radians(), dec.to_radians());
        DVec3::new(dec.cos() * ra.cos(), dec.cos() * ra.sin(), dec.sin())
    }

    /// A patch at `d`: `long` and `short` rad, turned by `angle` in its tangent plane.
    fn patch(d: DVec3, long: f64, short: f64, angle: f64) -> (DVec3, DVec3) {
        let p = d.any_orthonormal_vector();
        let q = d.cross(p);
        let (sin, cos) = angle.sin_cos();
        ((p * cos + q * sin) * long, (q * cos - p * sin) * short)
    }

    /// The documented places: x of width and y of height from right ascension and declination.
    #[test]
    fn directions_find_their_texels() {
        let size = [360, 180];
        let map = SkyMap::of_rows(size, &|y, out| {
            (0..).zip(out).for_each(|(x, out)| *out = [x as f32, y as f32, 1.0]);
        })
        .unwrap();
        for (ra, dec) in [(0.5, 0.5), (90.5, -10.5), (-90.5, 44.5), (179.5, -0.5), (-170.5, 20.5), (45.5, -30.5)] {
            let (x, y): (f64, f64) = (360.0 * (0.5 - ra / 360.0) - 0.5, 180.0 * (0.5 - dec / 180.0) - 0.5);
            let rgb = map.light(towards(ra, dec), DVec3::ZERO, DVec3::ZERO);
            // RGB9E5 rounds to a 512th of the largest; rows away from the equator are means along longitude.
            let slack = x.max(y) / 400.0 + 0.01;
            assert!((rgb[0] - x).abs() < slack && (rgb[1] - y).abs() < slack, "{ra} {dec}: {rgb:?}, wanted {x} {y}");
        }
        // +y of the sky axes is at a quarter of the width, the north pole at the top.
        assert!((map.light(DVec3::Y, DVec3::ZERO, DVec3::ZERO)[0] - 89.5).abs() < 1.0);
        assert!(map.light(DVec3::Z, DVec3::ZERO, DVec3::ZERO)[1] < 0.5);
    }

    #[test]
    fn flat_maps_are_flat_whatever_the_patch() {
        let value = [0.5, 0.25, 1.0];
        let map = flat(value);
        for d in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z, DVec3::splat(0.57735), towards(180.0, 3.0)] {
            for long in [0.0, 1e-9, 1e-3, 0.1, 1.0, 1e3, 1e30, f64::NAN] {
                for short in [0.0, 1e-5, 1e-2, 0.1, 1e30] {
                    let (dx, dy) = patch(d, long, short, 0.7);
                    let rgb = map.light(d, dx, dy);
                    assert!((0..3).all(|c| (rgb[c] - f64::from(value[c])).abs() < 1e-6), "{d} {long} {short}: {rgb:?}");
                }
            }
        }
    }

    /// A map of noise changes little from one direction or patch to the next, everywhere: no seam, no pole, no step
    /// between levels or counts of taps.
    #[test]
    fn light_is_continuous() {
        let map = SkyMap::of_rows([256, 128], &|y, out| {
            (0..).zip(out).for_each(|(x, out)| {
                *out = [0, 1, 2].map(|c| (crate::random::mix(x + 1000 * y + 77_777_777 * c) >> 16) as f32 / 65536.0);
            });
        })
        .unwrap();
        let texel = PI / 128.0;
        let largest = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max);
        let mut worst = 0.0_f64;
        // Through the poles and across the seam, in steps of a hundredth of a texel.
        let pole_to_pole = |t: f64| DVec3::new(0.3 * t.cos(), t.cos(), t.sin()).normalize();
        let around = |t: f64| towards(180.0 + 3.0 * t.sin(), 40.0 * t.cos());
        let near_pole = |t: f64| DVec3::new(0.01 * t.cos(), 0.01 * t.sin(), -1.0).normalize();
        for path in [&pole_to_pole as &dyn Fn(f64) -> DVec3, &around, &near_pole] {
            let mut before = None;
            for i in 0..25_600 {
                let t = TAU * f64::from(i) / 25_600.0;
                let d = path(t);
                let (dx, dy) = patch(d, texel, 0.3 * texel, 0.4);
                let now = map.light(d, dx, dy);
                worst = before.map_or(worst, |before| worst.max(largest(before, now)));
                before = Some(now);
            }
        }
        assert!(worst < 0.03, "by direction: {worst}");
        let mut worst = 0.0_f64;
        let d = towards(30.0, 50.0);
        for angle in [0.0, 0.3, 1.2] {
            let mut before = None;
            for i in 0..6000 {
                let long = texel * 0.3 * 1.002_f64.powi(i);
                let (dx, dy) = patch(d, long, 0.6 * texel, angle);
                let now = map.light(d, dx, dy);
                worst = before.map_or(worst, |before| worst.max(largest(before, now)));
                before = Some(now);
            }
        }
        assert!(worst < 0.01, "by patch: {worst}");
    }

    /// Stripes narrower than a long patch blur along it and stay sharp across it.
    #[test]
    fn long_patches_blur_along_themselves_only() {
        let stripes = |across: bool| {
            SkyMap::of_rows([512, 256], &move |y, out| {
                (0..).zip(out).for_each(|(x, out)| {
                    let i = if across { x } else { y };
                    *out = [f32::from(u8::from(i / 2 % 2 == 0)); 3];
                });
            })
            .unwrap()
        };
        let texel = PI / 256.0;
        let contrast = |map: &SkyMap| {
            let values = (0..64).map(|i| {
                let d = towards(10.0 + 0.11 * f64::from(i), 0.3 + 0.11 * f64::from(i));
                // Stripes along right ascension.
                map.light(d, DVec3::new(-d.y, d.x, 0.0).normalize() * (6.0 * texel), DVec3::Z * (0.5 * texel))[0]
            });
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        // A patch six texels long holds a whole period of four, half of it light, and two texels more, of which 1/4 to
        // 7/4 are light, as the map goes evenly from one texel to the next: 2.25 / 6 to 3.75 / 6 in all.
        assert!((contrast(&stripes(true)) - 0.25).abs() < 0.05, "{}", contrast(&stripes(true)));
        assert!(contrast(&stripes(false)) > 0.5, "{}", contrast(&stripes(false)));
    }

    /// However long and thin a patch is: the mean over the arc of a great circle that it covers, also where the circle
    /// goes through the poles and over the seam, or more than once around.
    #[test]
    fn long_thin_patches_see_their_arc() {
        // A lumpy band, some 20 degrees wide, over a faint ground: a Milky Way.
        let place = |count: u32, i: u32| (f64::from(i) + 0.5) / f64::from(count);
        let band = towards(192.9, 27.1);
        let map = SkyMap::of_rows([1024, 512], &|y, out| {
            for (x, out) in (0..).zip(out) {
                let d = towards(360.0 * (0.5 - place(1024, x)), 180.0 * (0.5 - place(512, y)));
                let lumps = (15.0 * d.x).sin() * (14.0 * d.y).sin() * (16.0 * d.z).cos();
                let light = (-(d.dot(band) / 0.17).powi(2)).exp() * (1.0 + 0.6 * lumps) + 0.02;
                *out = [light as f32; 3];
            }
        })
        .unwrap();
        let mut drawn = 0;
        let mut share = || {
            drawn += 1;
            f64::from(crate::random::mix(drawn)) / 4_294_967_296.0
        };
        let mut worst = 0.0_f64;
        for length in [0.2, 0.5, 1.0, 2.0, 3.0, 4.5, 6.0, 20.0, 500.0] {
            for _ in 0..60 {
                let d = DVec3::from_array([0; 3].map(|_| share() - 0.5)).normalize();
                let (dx, dy) = patch(d, length, 1e-4, 6.3 * share());
                let axis = dx.normalize();
                let seen = length.min(TAU);
                let dense = (0..4000).map(|i| {
                    let (sin, cos) = (seen * ((f64::from(i) + 0.5) / 4000.0 - 0.5)).sin_cos();
                    map.light(d * cos + axis * sin, DVec3::ZERO, DVec3::ZERO)[0]
                });
                let wanted = dense.sum::<f64>() / 4000.0;
                // The patch, given by another pair of changes: a sample's cell may be split between the two in any way.
                let (sin, cos) = (6.3 * share()).sin_cos();
                let found = map.light(d, dx * cos - dy * sin, dx * sin + dy * cos)[0];
                worst = worst.max((found - wanted).abs() / (wanted + 0.05));
                assert!((found - wanted).abs() < 0.06 * (wanted + 0.05), "{length} rad at {d}: {found}, not {wanted}");
            }
        }
        println!("worst: {worst}");
    }

    /// Lines of taps that are straight in the map, and those that are not, and the middle of either, agree.
    #[test]
    fn straight_lines_are_where_the_circles_are() {
        let places = [towards(20.0, 10.0), towards(179.99, -35.0), towards(-100.0, 70.0)];
        let mut straight = 0;
        for d in places {
            for (long, angle) in [(0.01, 0.3), (0.03, 1.9), (0.06, 4.0)] {
                let axis = patch(d, 1.0, 1.0, angle).0;
                let rho2 = d.x * d.x + d.y * d.y;
                let width = long / 6.0;
                if long * long * (d.z.abs() + long) < STRAIGHT * width * rho2.sqrt() {
                    let step = straight_step(d, axis);
                    for s in [-0.5 * long, 0.5 * long] {
                        let (sin, cos) = s.sin_cos();
                        let (found, wanted) = (map_place(d) + step * s, map_place(d * cos + axis * sin));
                        let off = (found - wanted) * DVec2::new(TAU * rho2.sqrt(), PI);
                        let turn = off.x - (off.x / (TAU * rho2.sqrt())).round() * TAU * rho2.sqrt();
                        assert!(turn.hypot(off.y) < 0.05 * width, "{d} {long}: off by {off} of {width}");
                    }
                    straight += 1;
                }
            }
        }
        assert!(straight > 4, "{straight}");
    }

    /// Unknown and huge patches see the mean of the map.
    #[test]
    fn unknown_patches_see_the_mean() {
        let map = SkyMap::of_rows([64, 32], &|y, out| out.fill([if y < 16 { 1.0 } else { 0.0 }; 3])).unwrap();
        for patch in [DVec3::splat(1e30), DVec3::splat(f64::NAN), DVec3::splat(f64::INFINITY), DVec3::Y * 20.0] {
            let rgb = map.light(DVec3::X, patch, patch);
            assert!((rgb[0] - 0.5).abs() < 2e-3, "{patch}: {rgb:?}");
        }
    }
}
