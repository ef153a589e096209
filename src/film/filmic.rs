// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tone map `Filmic`: J. Hable's curve of three powers ("Filmic Tonemapping with Piecewise Power Curves", 2017),
//! for each component of exposed light. Its numbers are made in f64, once a frame; the curve is in f32, as
//! `shaders/film/filmic.wgsl`, which has the same functions. Knows nothing of pixels and formats.
//!
//! A straight line of slope 1 runs from (x0, y0) to (x1, y1): x0 = toe_length^2.2 / 2, y0 = (1 - toe_strength) x0, and
//! x1 - x0 = y1 - y0 = (1 - shoulder_length) (1 - y0). Below it the toe, y0 (x / x0)^B, B = x0 / y0, meets it with the
//! same slope; above it the shoulder, top - dy ((right - x) / dx)^B, with right = W + 2 W a s, top = 1 + a s / 2, dx =
//! right - x1, dy = top - y1, B = dx / dy, a the shoulder's angle and s its strength. Everything is divided by the
//! shoulder's value at W = x0 + 1 - y0 + 2^s - 1, so that W becomes 1; brighter light is 1.

use super::grade::LEAST_BASE;
use crate::scene::Filmic;

/// The exponent of `toe_length`, which makes the scale seem even.
const LENGTH_POWER: f64 = 2.2;
/// The greatest exponent of the toe: at a strength of 1 it has none.
const STEEPEST_TOE: f64 = 1e5;
/// The least `shoulder_length`, as Hable has it: at 0 the shoulder has no exponent.
const SHORTEST_SHOULDER: f64 = 1e-5;

/// The curve's numbers: the third part of the uniform `film`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct FilmicParams {
    /// Where the toe ends, its inverse, the value there, and the toe's exponent.
    pub toe: [f32; 4],
    /// Where the line ends, its slope, its value at 0, and the light that becomes white.
    pub line: [f32; 4],
    /// 1 / dx, the shoulder's exponent, dy and top.
    pub shoulder: [f32; 4],
}

impl FilmicParams {
    /// `curve` has passed its check.
    pub fn new(curve: &Filmic) -> Self {
        let x0 = 0.5 * curve.toe_length.powf(LENGTH_POWER);
        let y0 = (1.0 - curve.toe_strength) * x0;
        let straight = (1.0 - curve.shoulder_length.max(SHORTEST_SHOULDER)) * (1.0 - y0);
        let (x1, y1) = (x0 + straight, y0 + straight);
        let white = x0 - y0 + curve.shoulder_strength.exp2();
        let bend = curve.shoulder_angle * curve.shoulder_strength;
        let (beyond, top) = (2.0 * white * bend, 1.0 + 0.5 * bend);
        let (dx, dy) = (white + beyond - x1, top - y1);
        let power = dx / dy;
        let share = 1.0 / (top - dy * (beyond / dx).powf(power));
        let toe_power = (1.0 / (1.0 - curve.toe_strength)).min(STEEPEST_TOE);
        Self {
            toe: [x0, if x0 > 0.0 { 1.0 / x0 } else { 0.0 }, share * y0, toe_power].map(|v| v as f32),
            line: [x1, share, share * (y0 - x0), white].map(|v| v as f32),
            shoulder: [1.0 / dx, power, share * dy, share * top].map(|v| v as f32),
        }
    }
}

/// Light in [0, MAX_SCENE_LIGHT] to [0, 1].
#[inline(always)]
pub fn filmic(curve: &FilmicParams, rgb: [f32; 3]) -> [f32; 3] {
    let [x0, inverse_x0, y0, toe_power] = curve.toe;
    let [x1, slope, begin, white] = curve.line;
    let [inverse_dx, power, dy, top] = curve.shoulder;
    rgb.map(|x| {
        let toe = y0 * (x * inverse_x0).clamp(LEAST_BASE, 1.0).powf(toe_power);
        let line = slope * x + begin;
        let shoulder = top - dy * (power * log_rest(((x - x1) * inverse_dx).clamp(0.0, 1.0))).exp();
        let shown = if x < x0 {
            toe
        } else if x > x1 {
            shoulder
        } else {
            line
        };
        if x >= white { 1.0 } else { shown.clamp(0.0, 1.0) }
    })
}

/// ln(1 - t). A shoulder of many stops has an exponent of thousands and a t as small, whose digits 1 - t would lose:
/// there its series serves, to 2e-7 of it.
#[inline(always)]
fn log_rest(t: f32) -> f32 {
    let series = -t * (1.0 + t * (0.5 + t * (1.0 / 3.0 + t * (0.25 + t * 0.2))));
    if t < 0.0625 { series } else { (1.0 - t).max(LEAST_BASE).ln() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::srgb_encode;
    use crate::film::tone_map::MAX_SCENE_LIGHT;

    /// Hable's own way, in f64: the axis in units of W; a segment y = exp(lnA + B ln x) through a point with a slope
    /// there; all of them divided by the last one's end.
    fn published(c: &Filmic, x: f64) -> f64 {
        let x0 = c.toe_length.powf(2.2) * 0.5;
        let y0 = (1.0 - c.toe_strength) * x0;
        let remaining = 1.0 - y0;
        let offset = (1.0 - c.shoulder_length.max(1e-5)) * remaining;
        let (x1, y1) = (x0 + offset, y0 + offset);
        let w = x0 + remaining + (c.shoulder_strength.exp2() - 1.0);
        let over_x = w * 2.0 * c.shoulder_angle * c.shoulder_strength / w;
        let over_y = 0.5 * c.shoulder_angle * c.shoulder_strength;
        let (x0, x1, slope) = (x0 / w, x1 / w, w);
        let solve = |x: f64, y: f64, m: f64| {
            let b = m * x / y;
            (y.ln() - b * x.ln(), b)
        };
        let segment = |(ln_a, b): (f64, f64), x: f64| if x > 0.0 { (ln_a + b * x.ln()).exp() } else { 0.0 };
        let shoulder = solve(1.0 + over_x - x1, 1.0 + over_y - y1, slope);
        let high = |x: f64| 1.0 + over_y - segment(shoulder, 1.0 + over_x - x);
        let x = (x / w).min(1.0);
        let y = if x < x0 {
            segment(solve(x0, y0, slope), x)
        } else if x > x1 {
            high(x)
        } else {
            y0 + slope * (x - x0)
        };
        y / high(1.0)
    }

    fn curves() -> impl Iterator<Item = Filmic> {
        let ends = [0.0, 0.3, 0.5, 0.9, 1.0];
        let strengths = [0.0, 0.5, 2.0, 5.0, 9.0, 16.0];
        (0..5 * 5 * 6 * 5 * 3).map(move |i| Filmic {
            toe_strength: ends[i % 5],
            toe_length: ends[i / 5 % 5],
            shoulder_strength: strengths[i / 25 % 6],
            shoulder_length: ends[i / 150 % 5],
            shoulder_angle: [0.0, 0.5, 1.0][i / 750],
        })
    }

    #[test]
    fn it_is_hable_s_curve() {
        let mut worst = (0.0, None);
        for c in curves() {
            let params = FilmicParams::new(&c);
            for i in 0..=400 {
                let x = 2.0_f32.powf(i as f32 * 0.08 - 16.0);
                let (ours, theirs) = (f64::from(filmic(&params, [x; 3])[0]), published(&c, x.into()));
                // A toe of strength 1 has y0 = 0, and no published form.
                let theirs = if theirs.is_nan() { 0.0 } else { theirs };
                let off = (ours - theirs).abs();
                if off > worst.0 {
                    worst = (off, Some((c, x, ours, theirs)));
                }
            }
        }
        println!("{worst:?}");
        assert!(worst.0 < 1e-6, "{worst:?}");
    }

    #[test]
    fn it_rises_without_steps_from_0_to_1_at_its_white() {
        for c in curves() {
            let params = FilmicParams::new(&c);
            let at = |x: f32| filmic(&params, [x, 0.5 * x, x]);
            assert!(at(0.0).iter().all(|v| *v < 1e-20), "{c:?}");
            let white = params.line[3];
            assert_eq!(at(white)[0], 1.0, "{c:?}");
            assert_eq!(at(white * 2.0)[0], 1.0, "{c:?}");
            let (mut before, mut last) = (0.0_f32, 0.0_f32);
            for i in 0..8000 {
                let x = 2.0_f32.powf(i as f32 * 0.004 - 16.0);
                let y = at(x)[0];
                assert!((before - 1e-6..=1.0).contains(&y), "{c:?} at {x}: {y} after {before}");
                // The steepest slope is that of the line, 1 / the end's value.
                let most = params.line[1] * (x - last) + 2e-5;
                assert!(y - before <= most, "{c:?} at {x}: {y} after {before}");
                (before, last) = (y, x);
            }
        }
    }

    #[test]
    fn the_default_curve() {
        let params = FilmicParams::new(&Filmic::default());
        let code = |v: f32| (srgb_encode(filmic(&params, [v; 3])[0]) * 255.0) as u32;
        assert!((params.line[3] - 4.0544).abs() < 1e-3, "{params:?}");
        assert_eq!(code(MAX_SCENE_LIGHT), 255);
        assert_eq!(code(0.18), 72);
        assert!((125..=129).contains(&code(0.18 * 1.35_f32.exp2())));
    }
}
