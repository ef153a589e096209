//! The light of a sky map in a pixel, filtered over the pixel's patch of sky, and what frequency shifts make of it.
//! Both tracers filter alike: `shaders/sky/map.wgsl` has the functions under the same names. Knows no cameras and no
//! holes.
//!
//! The patch is taken for an ellipse, whose axes are the singular values of the pixel's derivatives. Trilinear taps,
//! each about as wide as the minor axis, stand along the major one: a tap blurs by its own width already, so they are
//! spread over sqrt(major^2 - minor^2), which gives the variance of the whole (P. Heckbert 1989, "Fundamentals of
//! Texture Mapping and Image Warping", on elliptical filters). A tap's weight is the length of that line that lies
//! nearer to it than to its neighbours, so the sum changes without steps from pixel to pixel. Longer ellipses than
//! MAX_SPREAD allows are taken for wider ones.

use super::map::{Level, SkyMap, unpack};
use crate::physics::blackbody::BlackbodyTable;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Longest line that taps stand on, in minor axes; so there are at most 7, the outer ones at half weight and more.
pub(crate) const MAX_SPREAD: f64 = 6.0;
/// Solid angle, sr. A pixel that sees more of the sky than this, or of whose patch nothing is known, gets the mean of
/// all.
pub(crate) const WHOLE_SKY: f64 = 100.0;
/// The least change of direction by pixel, rad. It keeps divisions finite for cameras of no field of view at all.
pub(crate) const TINY_AXIS: f64 = 1e-12;
/// Brightest light: finite in f32, whatever the host multiplies it by.
pub(crate) const MAX_MAP_LIGHT: f64 = 1e9;

// Colours are taken for temperatures from 2500 K to 25000 K: those of the reddest and the bluest stars.
/// ln(blue / red) of such blackbodies, linear Rec. 709.
pub(crate) const COOLEST_RATIO: f64 = -2.696;
pub(crate) const HOTTEST_RATIO: f64 = 0.973;
/// Coefficients of 1000 K / T in powers of ln(blue / red), between those: least squares, at most 0.15 % off.
const INVERSE_TEMPERATURE: [f64; 6] =
    [0.152_906_4, -0.102_254_5, -0.005_097_082, -0.005_358_591, -0.003_424_309, -0.000_596_459_5];
/// The least blue and red that have a colour; the colour of darker light is not looked at.
pub(crate) const TINY_LIGHT: f64 = 1e-9;

/// A line of taps.
struct Taps {
    level: f64,
    /// The step from each tap to the next; 0 along with a `spread` of 0.
    step: DVec3,
    /// Length of the line, in steps.
    spread: f64,
}

impl SkyMap {
    /// Linear Rec. 709 radiance of the map in a pixel at rest. `d`: unit direction in sky axes; `dx`, `dy`: its
    /// derivatives by pixel.
    pub fn light(&self, d: DVec3, dx: DVec3, dy: DVec3) -> [f64; 3] {
        let taps = self.taps(d, dx, dy);
        let reach = 0.5 * taps.spread + 0.5;
        // The neighbours that get any weight.
        let most = reach.ceil() as i32 - 1;
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for i in -most..=most {
            let i = f64::from(i);
            let weight = (reach - i.abs()).min(1.0);
            let rgb = self.trilinear(d + taps.step * i, taps.level);
            (0..3).for_each(|c| sum[c] += weight * rgb[c]);
            total += weight;
        }
        sum.map(|v| v / total)
    }

    fn taps(&self, d: DVec3, dx: DVec3, dy: DVec3) -> Taps {
        let last = self.levels().len() as f64 - 1.0;
        let stretch2 = dx.length_squared() + dy.length_squared();
        // The condition is positive so that it is false for NaN.
        let known = stretch2 < WHOLE_SKY;
        if !known {
            return Taps { level: last, step: DVec3::ZERO, spread: 0.0 };
        }
        // Singular values of (dx, dy) from those of its square: s1^2 + s2^2 and s1^2 - s2^2.
        let p = d.any_orthonormal_vector();
        let q = d.cross(p);
        let (ax, ay, bx, by) = (dx.dot(p), dx.dot(q), dy.dot(p), dy.dot(q));
        let cross = ax * ay + bx * by;
        let half_difference = 0.5 * (ax * ax + bx * bx - ay * ay - by * by);
        let half_split = half_difference.hypot(cross);
        let major = (0.5 * stretch2 + half_split).sqrt().max(TINY_AXIS);
        let minor = ((ax * by - ay * bx).abs() / major).max(major / (1.0 + MAX_SPREAD * MAX_SPREAD).sqrt());
        let ratio = major / minor;
        // The direction of the major axis, by the half-angle formula that does not cancel; any direction for a circle,
        // which has no spread.
        let (x, y) = match half_difference >= 0.0 {
            true => (half_split + half_difference, cross),
            false => (cross, half_split - half_difference),
        };
        let axis = (p * x + q * y).normalize_or_zero();
        Taps {
            level: (minor / self.texel_angle()).log2().clamp(0.0, last),
            step: axis * minor,
            spread: (ratio * ratio - 1.0).max(0.0).sqrt(),
        }
    }

    /// The smaller side of a texel of the finest level at the equator, rad.
    fn texel_angle(&self) -> f64 {
        let [width, height] = self.levels().first().map_or([1, 1], |level| level.size);
        (PI / f64::from(height)).min(TAU / f64::from(width))
    }

    /// The light of the map towards a direction, not 0 and of any length, interpolated between levels and texels.
    fn trilinear(&self, towards: DVec3, level: f64) -> [f64; 3] {
        let u = 0.5 - towards.y.atan2(towards.x) / TAU;
        let v = 0.5 - towards.z.atan2(towards.x.hypot(towards.y)) / PI;
        let finer = level as usize;
        let share = level - finer as f64;
        let levels = self.levels();
        if share == 0.0 {
            return levels.get(finer).map_or([0.0; 3], |level| level.bilinear(u, v));
        }
        let [low, high] = [finer, finer + 1]
            .map(|i| levels.get(i.min(levels.len() - 1)).map_or([0.0; 3], |level| level.bilinear(u, v)));
        std::array::from_fn(|c| low[c] + (high[c] - low[c]) * share)
    }
}

impl Level {
    /// Around the sky in u; at the poles the outermost rows, which are constant, go on.
    fn bilinear(&self, u: f64, v: f64) -> [f64; 3] {
        let [width, height] = self.size.map(f64::from);
        let (x, y) = (u * width - 0.5, v * height - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (sx, sy) = (x - left, y - top);
        let column = |x: f64| if x < 0.0 { self.size[0] - 1 } else { x as u32 % self.size[0] };
        let row = |y: f64| self.row((y.max(0.0) as u32).min(self.size[1] - 1));
        let texel =
            |x: f64, y: f64| row(y).get(column(x) as usize).map_or([0.0; 3], |texel| unpack(*texel).map(f64::from));
        let [a, b, c, d] =
            [(left, top), (left + 1.0, top), (left, top + 1.0), (left + 1.0, top + 1.0)].map(|(x, y)| texel(x, y));
        std::array::from_fn(|i| {
            let (above, below) = (a[i] + (b[i] - a[i]) * sx, c[i] + (d[i] - c[i]) * sx);
            above + (below - above) * sy
        })
    }
}

/// Light of a map under a shift; shifts as for `BlackbodyTable::shifted_blackbody`. What a picture says of light is
/// three numbers, not its spectrum; so it is taken for light that shifts as a blackbody of its blue-to-red ratio does,
/// of 2500 K to 25000 K: each channel is multiplied by what that blackbody's is. Exact for the light of stars and
/// dust; unshifted light stays as it is.
pub fn shifted_map_light(rgb: [f64; 3], g_colour: f64, g_beaming: f64) -> [f64; 3] {
    let ratio = rgb[2].max(TINY_LIGHT) / rgb[0].max(TINY_LIGHT);
    let temperature = colour_temperature(ratio.ln());
    let table = BlackbodyTable::shared();
    let log_reference = table.ln_luminance(temperature);
    let rest = table.shifted_blackbody(temperature, log_reference, 1.0, 1.0);
    let seen = table.shifted_blackbody(temperature, log_reference, g_colour, g_beaming);
    std::array::from_fn(|c| (rgb[c] * (seen[c] / rest[c])).min(MAX_MAP_LIGHT))
}

/// Temperature, K, of the blackbody of this ln(blue / red).
pub(crate) fn colour_temperature(ln_ratio: f64) -> f64 {
    let x = ln_ratio.clamp(COOLEST_RATIO, HOTTEST_RATIO);
    1000.0 / INVERSE_TEMPERATURE.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;

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
                    assert!(
                        (0..3).all(|c| (rgb[c] - f64::from(value[c])).abs() < 1e-12),
                        "{d} {long} {short}: {rgb:?}"
                    );
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
        assert!(contrast(&stripes(true)) < 0.25, "{}", contrast(&stripes(true)));
        assert!(contrast(&stripes(false)) > 0.5, "{}", contrast(&stripes(false)));
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

    #[test]
    fn colour_temperature_is_that_of_blackbodies() {
        let table = BlackbodyTable::shared();
        for i in 0..=400 {
            let temperature = 1.0 / (1.0 / 25000.0 + (1.0 / 2500.0 - 1.0 / 25000.0) * f64::from(i) / 400.0);
            let [r, _, b] = table.shade(temperature, temperature);
            let found = colour_temperature((b / r).ln());
            assert!((found / temperature - 1.0).abs() < 3e-3, "{found} for {temperature}");
        }
        assert!((colour_temperature(f64::INFINITY) / 25000.0 - 1.0).abs() < 3e-3);
        assert!((colour_temperature(-1e9) / 2500.0 - 1.0).abs() < 3e-3);
    }

    /// Blackbody light shifts as a blackbody; g = 1 changes nothing, of any colour; nothing is negative or infinite.
    #[test]
    fn shifted_light_is_that_of_blackbodies() {
        let table = BlackbodyTable::shared();
        for temperature in [2600.0, 4000.0, 6500.0, 12000.0, 24000.0] {
            let log_reference = table.ln_luminance(temperature);
            let rest = table.shifted_blackbody(temperature, log_reference, 1.0, 1.0);
            for (g, beaming) in [(0.6, 0.6), (0.9, 0.9), (1.0, 1.0), (1.5, 1.5), (2.0, 1.0), (1.0, 1.3)] {
                let wanted = table.shifted_blackbody(temperature, log_reference, g, beaming);
                let found = shifted_map_light(rest, g, beaming);
                for c in 0..3 {
                    let slack = 0.02 * wanted[c] + 1e-3 * wanted[1];
                    assert!((found[c] - wanted[c]).abs() < slack, "{temperature} K, g {g}: {found:?} {wanted:?}");
                }
            }
        }
        for rgb in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [65408.0, 1e-7, 3.0], [0.2, 0.3, 0.4]]
        {
            let same = shifted_map_light(rgb, 1.0, 1.0);
            assert!((0..3).all(|c| (same[c] - rgb[c]).abs() <= 1e-12 * rgb[c]), "{rgb:?}: {same:?}");
            for g in [0.0, 1e-6, 0.03, 5.0, 1e6, f64::INFINITY, f64::NAN] {
                let light = shifted_map_light(rgb, g, g);
                assert!(light.iter().all(|v| (0.0..=MAX_MAP_LIGHT).contains(v)), "{rgb:?} g {g}: {light:?}");
            }
        }
    }
}
