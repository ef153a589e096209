// SPDX-License-Identifier: MIT OR Apache-2.0
//! How stars are drawn, the same in both tracers (`shaders/sky/stars.wgsl`): as points with a fixed footprint in
//! pixels, so that they neither alias nor sparkle, and with the brightness that the lens's magnification gives them.

use super::index::{STAR_LEVELS, StarIndex, cell_of, level_for, margin};
use crate::physics::blackbody::BlackbodyTable;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A pixel's patch of sky counts as at least a share of the square of its length (`least_patch`). On a critical curve
/// of the lens the patch that the derivatives span has no area and its stars would be infinitely bright; within one
/// pixel that area really varies from 0 to about length^2 / (pixels around the curve), which is this share for an
/// ordinary frame. Images of higher order are as narrow far from any critical curve, but only cameras with a narrow
/// field of view see them, whose pixels are small: no less than an f32 can tell.
const LEAST_PATCH: (f64, f64) = (1e-5, 1e-3);
/// The least solid angle, which keeps the division finite for cameras of no field of view at all.
pub(crate) const TINY_AREA: f64 = 1e-30;
/// The brightest sum: finite in f32, whatever the host multiplies it by.
pub(crate) const MAX_STAR_LIGHT: f64 = 1e9;

/// The radius of a star's footprint, pixels: as small as one may be whose sums vary little.
pub(crate) const STAR_RADIUS: f64 = 1.6;
/// The height of the footprint's bump, whose integral is 1: 4 / (pi STAR_RADIUS^2).
pub(crate) const STAR_PEAK: f64 = 0.497_359_197_2;
/// Fourier coefficients, of cos x + cos y, cos x cos y and cos 2 x + cos 2 y, of what the bump sums to over all pixels,
/// less 1, x and y being the turns of the star's place.
pub(crate) const STAR_RIPPLE: [f64; 3] = [-0.015_910_5, 0.001_207_0, 0.000_548_6];

/// The share of a star's light that a pixel at (x, y) from it gets: the bump (1 - r^2 / STAR_RADIUS^2)^3, which is
/// round, so that a bright star does not fill the corners of a square, over what it sums to at these places between
/// pixels. So its shares sum to 1 within 3e-3, and a star's light does not depend on where between the pixels it lies.
pub(crate) fn footprint(x: f64, y: f64) -> f64 {
    let bump = (1.0 - (x * x + y * y) / (STAR_RADIUS * STAR_RADIUS)).max(0.0);
    let (cx, cy) = ((TAU * x).cos(), (TAU * y).cos());
    let [first, mixed, second] = STAR_RIPPLE;
    let sum = 1.0 + first * (cx + cy) + mixed * cx * cy + 2.0 * second * (cx * cx + cy * cy - 1.0);
    STAR_PEAK * bump * bump * bump / sum
}

/// The patch of sky that belongs to a pixel: `d` unit direction at its centre, `dx` and `dy` its derivatives by pixel.
struct Patch {
    d: DVec3,
    /// e . across / area = pixels along x to a star that is e away; e . down / area, along y.
    across: DVec3,
    down: DVec3,
    /// Signed solid angle of a pixel.
    area: f64,
    /// 1 / solid angle, bounded.
    magnification: f64,
}

impl Patch {
    fn new(d: DVec3, dx: DVec3, dy: DVec3, least_patch: f64) -> Self {
        let area = dx.cross(dy).dot(d);
        // The sum of the squares of both singular values: that of the larger one wherever the least patch matters.
        let stretch2 = dx.length_squared() + dy.length_squared();
        let magnification = 1.0 / area.abs().max(least_patch * stretch2).max(TINY_AREA);
        Self { d, across: dy.cross(d), down: d.cross(dx), area, magnification }
    }

    /// Radiance per flux of a star in direction `s`. Solves [dx dy] (px, py) = s - d in the tangent plane by triple
    /// products; a star outside the footprint is found out before anything is divided.
    fn spread(&self, s: DVec3) -> f64 {
        let e = s - self.d;
        let p = DVec2::new(e.dot(self.across), e.dot(self.down));
        let size = self.area.abs();
        if p.abs().max_element() < STAR_RADIUS * size {
            footprint(p.x / size, p.y / size) * self.magnification
        } else {
            0.0
        }
    }
}

/// The least share of a pixel's patch, for pixels of this angle (radians).
pub fn least_patch(pixel_angle: f64) -> f64 {
    pixel_angle.clamp(LEAST_PATCH.0, LEAST_PATCH.1)
}

/// Distance of the farther corners of the square about the footprint.
fn footprint_radius(dx: DVec3, dy: DVec3) -> f64 {
    STAR_RADIUS * (dx.length_squared() + dy.length_squared() + 2.0 * dx.dot(dy).abs()).sqrt()
}

impl StarIndex {
    /// Linear Rec. 709 radiance of the stars in a pixel, for stars_brightness 1. `d`: unit direction in sky axes;
    /// `dx`, `dy`: its derivatives by pixel; `g_colour`, `g_beaming` as for `BlackbodyTable::shifted_blackbody`;
    /// `least_patch`: see there. Where the pixel is wider than the index reaches, or its derivatives are not finite
    /// (at the edge of the shadow), the mean light of all stars. Finite for any input.
    pub fn star_light(
        &self,
        d: DVec3,
        [dx, dy]: [DVec3; 2],
        g_colour: f64,
        g_beaming: f64,
        least_patch: f64,
    ) -> [f64; 3] {
        let radius = footprint_radius(dx, dy);
        let mut light = [0.0; 3];
        let mut add = |share: f64, rgb: [f64; 3]| (0..3).for_each(|c| light[c] += share * rgb[c]);
        // Beyond the coarsest level, and for NaN, nothing is left of its stars.
        let found = level_for(radius);
        let level = found.unwrap_or(STAR_LEVELS - 1);
        let listed = found.map_or(&[][..], |level| self.cell_stars(cell_of(d, level)));
        let fade = if found.is_some() { fade(level, radius) } else { 0.0 };
        let [mean, next] = [0, 1].map(|step| &self.mean_sky[(level + step) as usize]);
        let patch = Patch::new(d, dx, dy, least_patch);
        for &star in listed {
            let spread = patch.spread(DVec3::new(star[0].into(), star[1].into(), star[2].into()));
            if spread > 0.0 {
                let [flux, temperature, log_reference] = self.kind_of(star);
                let share = if flux >= f64::from(next.flux_limit) { 1.0 } else { fade };
                let table = BlackbodyTable::shared();
                let rgb = table.shifted_blackbody(temperature, log_reference, g_colour, g_beaming);
                add(share * spread * flux, rgb);
            }
        }
        for (share, mean) in [(fade, mean), (1.0 - fade, next)] {
            if share > 0.0 && !mean.is_dark() {
                add(share * self.mean_sky_density(d), mean.light(g_colour, g_beaming));
            }
        }
        light.map(|v| v.min(MAX_STAR_LIGHT))
    }
}

/// The share that is left, at this footprint, of the stars that the next level leaves out: they go over into the mean
/// sky as the footprint grows through the second half of the level's margin.
pub(crate) fn fade(level: u32, radius: f64) -> f64 {
    1.0 - smoothstep(0.5 * margin(level), margin(level), radius)
}

fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::blackbody::LUMINANCE;
    use crate::sky::StarField;
    use crate::sky::catalogue::Star;
    use crate::sky::index::STAR_REFERENCE_RADIANCE;

    /// The least patch of wide fields of view.
    const LEAST: f64 = LEAST_PATCH.1;

    fn luminance(rgb: [f64; 3]) -> f64 {
        (0..3).map(|c| LUMINANCE[c] * rgb[c]).sum()
    }

    /// A perspective camera's pixel: `x`, `y` in pixels from the centre of a frame that looks along `forward`.
    fn pixel(forward: DVec3, scale: f64, x: f64, y: f64) -> (DVec3, DVec3, DVec3) {
        let right = forward.any_orthonormal_vector();
        let up = right.cross(forward);
        let look = |x: f64, y: f64| forward + right * (x * scale) - up * (y * scale);
        let v = look(x, y);
        let d = v.normalize();
        let tangent = |t: DVec3| (t - d * d.dot(t)) / v.length();
        (d, tangent(right * scale), tangent(up * -scale))
    }

    /// Sum of radiance x solid angle over the pixels of a small frame.
    fn collected(index: &StarIndex, forward: DVec3, scale: f64, shift: (f64, f64), squeeze: f64) -> f64 {
        let mut sum = 0.0;
        for i in -12..=12 {
            for j in -12..=12 {
                let (d, dx, dy) = pixel(forward, scale, f64::from(i) + shift.0, f64::from(j) * squeeze + shift.1);
                let dy = dy * squeeze;
                sum += luminance(index.star_light(d, [dx, dy], 1.0, 1.0, LEAST)) * dx.cross(dy).length();
            }
        }
        sum
    }

    fn single(direction: DVec3, magnitude: f64) -> StarIndex {
        StarIndex::new([Star { direction, magnitude, colour: 0.6 }].into_iter()).expect("an index")
    }

    #[test]
    fn a_stars_light_does_not_depend_on_its_place_between_pixels() {
        let scale = 2.0 * 30.0_f64.to_radians().tan() / 720.0;
        let flux = STAR_REFERENCE_RADIANCE * scale * scale;
        // Places inside a cube's side, on an edge, and in a corner.
        for place in [DVec3::new(1.0, 0.3, -0.2), DVec3::new(1.0, 1.0, 0.1), DVec3::splat(-1.0)] {
            let place = place.normalize();
            let index = single(place, 0.0);
            for shift in [(0.0, 0.0), (0.5, 0.5), (0.13, -0.37), (-0.49, 0.21)] {
                for squeeze in [1.0, 0.2] {
                    let sum = collected(&index, place, scale, shift, squeeze);
                    assert!((sum / flux - 1.0).abs() < 3e-3, "{place} {shift:?} {squeeze}: {}", sum / flux);
                }
            }
        }
    }

    /// Bright stars look round: a pixel across the corner is much darker than those beside it, at every place between
    /// pixels, and light falls with the distance alone.
    #[test]
    fn a_star_is_round_and_its_shares_sum_to_1() {
        assert!(footprint(1.0, 1.0) < 0.05 * footprint(1.0, 0.0));
        let mut random = 0;
        for _ in 0..2000 {
            random += 2;
            let [x, y] = [random, random + 1].map(|k| f64::from(crate::random::mix(k)) / 4_294_967_296.0 - 0.5);
            let pixels = (-2..=2).flat_map(|i| (-2..=2).map(move |j| (x + f64::from(i), y + f64::from(j))));
            let sum = pixels.clone().map(|(x, y)| footprint(x, y)).sum::<f64>();
            assert!((sum - 1.0).abs() < 3e-3, "{x} {y}: {sum}");
            let bump = |x: f64, y: f64| (1.0 - (x * x + y * y) / (STAR_RADIUS * STAR_RADIUS)).max(0.0).powi(3);
            let scale = footprint(x, y) / bump(x, y);
            for (x, y) in pixels {
                let wanted = scale * bump(x, y);
                assert!((footprint(x, y) - wanted).abs() < 1e-12, "{x} {y}");
            }
        }
    }

    #[test]
    fn a_star_over_the_reference_pixel_has_the_reference_radiance() {
        let scale = 2.0 * 30.0_f64.to_radians().tan() / 720.0;
        let (d, dx, dy) = pixel(DVec3::Y, scale, 0.0, 0.0);
        let peak = luminance(single(d, 0.0).star_light(d, [dx, dy], 1.0, 1.0, LEAST));
        assert!((peak / (STAR_REFERENCE_RADIANCE * footprint(0.0, 0.0)) - 1.0).abs() < 1e-4, "{peak}");
        let magnified = luminance(single(d, 0.0).star_light(d, [dx * 0.5, dy], 1.0, 1.0, LEAST));
        assert!((magnified / peak - 2.0).abs() < 1e-4);
    }

    #[test]
    fn index_and_plain_search_draw_the_same() {
        let index = StarField::catalogue().expect("an index");
        let table = BlackbodyTable::shared();
        // Footprints of the levels that hold all stars, before any of them fades.
        for (i, scale) in [2e-4, 1e-3, 1.6e-3, 1.75e-3].into_iter().enumerate() {
            for star in index.stars.iter().step_by(2 * (997 + i)) {
                let forward = DVec3::new(star[0].into(), star[1].into(), star[2].into()).normalize();
                let (d, dx, dy) = pixel(forward, scale, 0.3, -0.6);
                let patch = Patch::new(d, dx, dy, LEAST);
                let mut wanted = [0.0; 3];
                for pair in index.stars.chunks(2) {
                    let s = DVec3::new(pair[0][0].into(), pair[0][1].into(), pair[0][2].into());
                    if s.dot(d) > 0.0 {
                        let rgb = table.shifted_blackbody(pair[1][0].into(), pair[1][1].into(), 0.8, 0.8);
                        let weight = patch.spread(s) * f64::from(pair[0][3]);
                        (0..3).for_each(|c| wanted[c] += weight * rgb[c]);
                    }
                }
                let got = index.star_light(d, [dx, dy], 0.8, 0.8, LEAST);
                assert!(luminance(wanted) > 0.0);
                for c in 0..3 {
                    assert!((got[c] - wanted[c]).abs() <= 1e-9 * wanted[c], "{scale} {d}: {got:?} {wanted:?}");
                }
            }
        }
    }

    #[test]
    fn wide_pixels_blend_into_the_mean() {
        let index = StarField::catalogue().expect("an index");
        let mean = index.mean_sky[STAR_LEVELS as usize].radiance * index.mean_sky_density(DVec3::Z);
        let (d, dx, dy) = pixel(DVec3::Z, 0.1, 0.0, 0.0);
        assert!((luminance(index.star_light(d, [dx, dy], 1.0, 1.0, LEAST)) / mean - 1.0).abs() < 1e-3);
        let mut before: Option<f64> = None;
        for i in 0..4000 {
            let (d, dx, dy) = pixel(DVec3::Z, 0.01 + 1e-5 * f64::from(i), 0.0, 0.0);
            let now = luminance(index.star_light(d, [dx, dy], 1.0, 1.0, LEAST));
            if let Some(before) = before {
                assert!((now - before).abs() < 0.01 * (mean + before), "seam at {i}: {before} {now}, mean {mean}");
            }
            before = Some(now);
        }
    }

    #[test]
    fn anything_gives_finite_light() {
        let index = StarField::catalogue().expect("an index");
        let star = &index.stars[0];
        let d = DVec3::new(star[0].into(), star[1].into(), star[2].into());
        let t = d.any_orthonormal_vector();
        let u = d.cross(t);
        let tangents = [DVec3::ZERO, t * 1e-3, u * 1e-3, t * 1e-20, u * 1e300, t * f64::INFINITY, DVec3::NAN];
        for dx in tangents {
            for dy in tangents {
                for g in [0.0, 1.0, 1e-3, 1e6, f64::INFINITY, f64::NAN] {
                    let light = index.star_light(d, [dx, dy], g, g, LEAST);
                    assert!(light.iter().all(|v| v.is_finite() && *v >= 0.0), "{dx} {dy} {g}: {light:?}");
                }
            }
        }
    }

    /// On a critical curve dx and dy are parallel: the star keeps a finite brightness, that of the least patch.
    #[test]
    fn caustics_are_bounded() {
        let d = DVec3::X;
        let index = single(d, 0.0);
        let flux = f64::from(index.stars[0][3]);
        for squeeze in [1e-2, 1e-4, 1e-8] {
            let peak = luminance(index.star_light(d, [DVec3::Y * 1e-3, DVec3::Z * 1e-3 * squeeze], 1.0, 1.0, LEAST));
            let bound = flux / (1e-6 * LEAST);
            assert!(peak > 0.0 && peak < bound, "{squeeze}: {peak} over {bound}");
        }
    }
}
