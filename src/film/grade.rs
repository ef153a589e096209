// SPDX-License-Identifier: MIT OR Apache-2.0
//! The grade: changes exposed light, glare and beam included, before the tone map. In this order: a lens' fall-off,
//! white balance, contrast, saturation, grain. In f32, as `shaders/film/grade.wgsl`, which has the same function. Knows
//! nothing of pixels and formats. Black stays black.
//!
//! Fall-off: natural vignetting, cos^4 of the angle from the axis (e.g. W. J. Smith, Modern Optical Engineering,
//! "cosine-to-the-fourth law"), whose tangent grows from the middle of the frame to 1 in its corners, whatever the
//! frame's field and resolution: cos^4 = (1 + r^2)^-2, r the share of the way to a corner. Contrast: a power of light
//! about middle grey, 0.18 (v / 0.18)^c for each component. Saturation: as the ASC CDL has it (ASC Color Decision List
//! Transfer Functions and Interchange Syntax, v1.2, 2009), Y + s (v - Y) with the luminance Y of Rec. 709, and nothing
//! below 0. Grain: light times 1 + s n, with n of mean 0 and variance 1, so that the mean of the light stays: noise on
//! a lattice of cells a 1080th of the frame's height wide (a pixel at least), white, even, and read between the four
//! nearest cells, with weights whose squares sum to 1.

use super::colour_map::luminance;
use super::tone_map::MAX_SCENE_LIGHT;
use super::white_balance;
use crate::scene::Grade;

/// The light that contrast keeps.
const MIDDLE_GREY: f64 = 0.18;
/// Less is taken as this before a power or logarithm, which drivers need not have at 0.
pub(crate) const LEAST_BASE: f32 = 1e-30;

/// The deviation of a grain of 1.
const MOST_GRAIN: f32 = 0.25;
/// Rows of cells of grain in a frame.
const GRAIN_ROWS: f64 = 1080.0;
/// sqrt(3), the greatest noise of a cell; and the noise of one of 2^24 codes.
pub(crate) const GRAIN_REACH: f32 = 1.732_050_8;
pub(crate) const GRAIN_SCALE: f32 = 2.0 * GRAIN_REACH / 16_777_216.0;

const NEUTRAL: [[f32; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// A frame's grade: the second part of the uniform `film`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GradeParams {
    /// 1: light is graded.
    pub graded: u32,
    /// The exponent of light.
    pub contrast: f32,
    /// The factor on the power, 0.18^(1 - contrast).
    pub contrast_factor: f32,
    pub saturation: f32,
    /// Half the size of the whole frame, pixels.
    pub vignette_centre: [f32; 2],
    /// 1 / the squared distance of a corner from there.
    pub vignette_scale: f32,
    /// The share of a lens' fall-off.
    pub vignette: f32,
    /// The matrix that makes a light white, by columns.
    pub white_balance: [[f32; 4]; 3],
    /// The standard deviation of light by grain, in the light.
    pub grain: f32,
    /// Cells of grain along a side of a pixel.
    pub grain_cells: f32,
    /// That of the grain's noise.
    pub grain_seed: u32,
    pub unused: u32,
}

impl GradeParams {
    /// `grade` has passed its check. The frame's size is yet to be told.
    pub fn new(grade: &Grade) -> Self {
        let columns = white_balance::matrix(grade).map(|m| m.map(|[r, g, b]| [r as f32, g as f32, b as f32, 0.0]));
        Self {
            graded: grade.is_on().into(),
            contrast: grade.contrast as f32,
            contrast_factor: MIDDLE_GREY.powf(1.0 - grade.contrast) as f32,
            saturation: grade.saturation as f32,
            vignette_centre: [0.0; 2],
            vignette_scale: 0.0,
            vignette: grade.vignette as f32,
            white_balance: columns.unwrap_or(NEUTRAL),
            grain: MOST_GRAIN * grade.grain as f32,
            grain_cells: 1.0,
            grain_seed: seed_of(grade.grain_seed),
            unused: 0,
        }
    }

    /// In a whole frame of this size in pixels.
    pub fn over_frame(self, width: u32, height: u32) -> Self {
        let [x, y] = [width, height].map(|side| 0.5 * f64::from(side));
        Self {
            vignette_centre: [x as f32, y as f32],
            vignette_scale: (1.0 / (x * x + y * y)) as f32,
            grain_cells: (GRAIN_ROWS / f64::from(height)).min(1.0) as f32,
            ..self
        }
    }
}

/// Exposed light at a pixel of the whole frame. `scene` in [0, MAX_SCENE_LIGHT], and so what it gives.
pub fn graded(grade: &GradeParams, scene: [f32; 3], x: u32, y: u32) -> [f32; 3] {
    let [dx, dy] = [x as f32 + 0.5 - grade.vignette_centre[0], y as f32 + 0.5 - grade.vignette_centre[1]];
    let cos2 = 1.0 / (1.0 + grade.vignette_scale * (dx * dx + dy * dy));
    let lens = 1.0 + grade.vignette * (cos2 * cos2 - 1.0);
    let [r, g, b] = scene.map(|v| v * lens);
    let m = &grade.white_balance;
    let contrasted = [0, 1, 2].map(|i| {
        let balanced = (m[0][i] * r + m[1][i] * g + m[2][i] * b).max(LEAST_BASE);
        grade.contrast_factor * balanced.powf(grade.contrast)
    });
    let grey = luminance(contrasted);
    let grain = 1.0 + grade.grain * grain_noise(grade, x, y);
    contrasted.map(|v| ((grey + grade.saturation * (v - grey)) * grain).clamp(0.0, MAX_SCENE_LIGHT))
}

/// The seed of a number that the host gives.
fn seed_of(given: f64) -> u32 {
    let bits = given.to_bits();
    hash(bits as u32 ^ hash((bits >> 32) as u32))
}

/// Noise of mean 0 and variance 1 at a pixel; within +-2 sqrt(3).
pub(crate) fn grain_noise(grade: &GradeParams, x: u32, y: u32) -> f32 {
    let [px, py] = [x, y].map(|v| (v as f32 + 0.5) * grade.grain_cells);
    let [cx, cy] = [px.floor(), py.floor()];
    let [fx, fy] = [px - cx, py - cy];
    let (x, y, seed) = (cx as u32, cy as u32, grade.grain_seed);
    let [a, b, c, d] = [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(|[x, y]| grain_cell(x, y, seed));
    let row = |left: f32, right: f32| left + fx * (right - left);
    let sum = row(a, b) + fy * (row(c, d) - row(a, b));
    let squares = |f: f32| 1.0 - 2.0 * f * (1.0 - f);
    sum / (squares(fx) * squares(fy)).sqrt()
}

/// A cell's noise, even within +-sqrt(3).
pub(crate) fn grain_cell(x: u32, y: u32, seed: u32) -> f32 {
    let code = hash(x ^ hash(y ^ seed)) >> 8;
    (code as f32 + 0.5) * GRAIN_SCALE - GRAIN_REACH
}

/// A number of which each bit depends on all bits of `value` (the mixer "lowbias32" of C. Wellons, 2018).
pub(crate) fn hash(value: u32) -> u32 {
    let value = (value ^ value >> 16).wrapping_mul(0x7feb_352d);
    let value = (value ^ value >> 15).wrapping_mul(0x846c_a68b);
    value ^ value >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmParams, develop};
    use crate::image::PixelFormat;
    use crate::scene::{ColourMap, Film, ToneMap, View};

    fn params(grade: Grade) -> FilmParams {
        let film = Film { grade, ..Film::plain() };
        FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false).over_frame(1920, 1080)
    }

    fn near(a: [f32; 3], b: [f32; 3]) -> bool {
        (0..3).all(|c| (a[c] - b[c]).abs() <= 3e-6 * b[c].abs().max(1e-3))
    }

    #[test]
    fn contrast_turns_about_middle_grey() {
        for contrast in [0.25, 0.5, 1.0, 1.7, 4.0] {
            let params = params(Grade { contrast, ..Grade::default() });
            assert!(near(graded(&params.grade, [0.18; 3], 3, 4), [0.18; 3]), "{contrast}");
            let stops = |v: f32| f64::from(graded(&params.grade, [v; 3], 0, 0)[0] / 0.18).log2();
            assert!((stops(0.72) - 2.0 * contrast).abs() < 1e-5, "{contrast}");
            assert!((stops(0.045) + 2.0 * contrast).abs() < 1e-5, "{contrast}");
            assert!(graded(&params.grade, [0.0; 3], 0, 0).iter().all(|v| *v < 1e-7), "black is lifted by {contrast}");
            assert!(graded(&params.grade, [MAX_SCENE_LIGHT; 3], 0, 0).iter().all(|v| v.is_finite()));
        }
    }

    /// 0 is grey of the same luminance, 1 changes nothing, 2 doubles the distance from grey and stops at 0.
    #[test]
    fn saturation_is_that_of_the_asc_cdl() {
        let at = |saturation| graded(&params(Grade { saturation, ..Grade::default() }).grade, [0.5, 0.25, 0.125], 9, 9);
        let grey = 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 0.125;
        assert!((0..3).all(|c| (at(0.0)[c] - grey).abs() < 2e-5), "{:?}", at(0.0));
        assert!(near(at(1.0), [0.5, 0.25, 0.125]), "{:?}", at(1.0));
        let twice = [0.5, 0.25, 0.125].map(|v: f32| (2.0 * v - grey).max(0.0));
        assert!((0..3).all(|c| (at(2.0)[c] - twice[c]).abs() < 2e-5), "{:?}", at(2.0));
        assert_eq!(at(4.0)[2], 0.0);
    }

    /// 1 in the middle, 1/4 in each corner, alike at every resolution and shape of the frame.
    #[test]
    fn vignette_is_cos4_to_the_corners() {
        for [width, height] in [[1920_u32, 1080_u32], [192, 108], [50, 400]] {
            let film = Film { grade: Grade { vignette: 1.0, ..Grade::default() }, ..Film::plain() };
            let params = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false).over_frame(width, height);
            let at = |x: u32, y: u32| f64::from(graded(&params.grade, [0.5; 3], x, y)[0]) / 0.5;
            let exact = |x: u32, y: u32| {
                let [dx, dy] =
                    [f64::from(x) + 0.5 - f64::from(width) / 2.0, f64::from(y) + 0.5 - f64::from(height) / 2.0];
                let corner = f64::from(width).hypot(f64::from(height)) / 2.0;
                (dx.hypot(dy) / corner).atan().cos().powi(4)
            };
            for (x, y) in [(0, 0), (width - 1, 0), (width - 1, height - 1), (width / 2, height / 2), (7, 30)] {
                assert!((at(x, y) - exact(x, y)).abs() < 1e-5, "{width} x {height}, ({x}, {y}): {}", at(x, y));
            }
            assert!((at(width / 2, height / 2) - 1.0).abs() < 1e-2 && (at(0, 0) - 0.25).abs() < 0.02);
        }
        let half = params(Grade { vignette: 0.5, ..Grade::default() });
        assert!((graded(&half.grade, [1.0; 3], 0, 0)[0] - 0.625).abs() < 1e-3);
    }

    /// The light's mean and its deviation, at several resolutions, and another picture for another seed.
    #[test]
    fn grain_keeps_the_light_and_has_its_strength() {
        for [width, height] in [[480_u32, 270_u32], [1920, 1080], [3840, 2160], [5000, 2812]] {
            for (strength, seed) in [(0.2, 0.0), (1.0, 7.5)] {
                let grade = Grade { grain: strength, grain_seed: seed, ..Grade::default() };
                let film = Film { grade, ..Film::plain() };
                let params = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false);
                let grade = params.over_frame(width, height).grade;
                let (mut sum, mut squares, count) = (0.0, 0.0, f64::from(480 * 270));
                for (x, y) in (0..270).flat_map(|y| (0..480).map(move |x| (x, y))) {
                    let light = graded(&grade, [0.3, 0.6, 0.9], x, y);
                    assert!((light[1] / light[0] - 2.0).abs() < 1e-4, "grain has a colour");
                    let noise = f64::from(light[0]) / 0.3 - 1.0;
                    (sum, squares) = (sum + noise, squares + noise * noise);
                }
                let (mean, deviation) = (sum / count, (squares / count).sqrt());
                let wanted = 0.25 * strength;
                // Cells wider than a pixel are fewer.
                let cells = (f64::from(height) / 1080.0).max(1.0);
                assert!(mean.abs() < 4.0 * wanted * cells / count.sqrt(), "{width}, {strength}: mean {mean}");
                assert!((deviation / wanted - 1.0).abs() < 0.02, "{width}, {strength}: deviation {deviation}");
            }
        }
        let noise = |seed: f64, x: u32| {
            let grade = params(Grade { grain: 1.0, grain_seed: seed, ..Grade::default() }).grade;
            grain_noise(&grade, x, 5)
        };
        let alike = (0..1000).filter(|x| (noise(0.0, *x) - noise(1.0, *x)).abs() < 0.1).count();
        assert!(alike < 100, "{alike} of 1000 pixels have the same grain for another seed");
    }

    #[test]
    fn a_grade_that_is_off_changes_no_bit_and_others_keep_black() {
        let off = params(Grade::default());
        assert_eq!(off.grade.graded, 0);
        let grade = Grade {
            white_balance: 2000.0,
            tint: 1.0,
            contrast: 0.25,
            saturation: 4.0,
            vignette: 1.0,
            ..Grade::default()
        };
        for tone_map in [ToneMap::None, ToneMap::Aces, ToneMap::Agx, ToneMap::Filmic] {
            for colour_map in [ColourMap::None, ColourMap::Afmhot] {
                let film = Film { tone_map, colour_map, grade, ..Film::plain() };
                let on = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false).over_frame(64, 64);
                for i in 0..4096 {
                    assert_eq!(develop(&on, [0.0; 4], i % 64, i / 64).as_slice(), [0, 0, 0, 255], "{tone_map:?}");
                }
            }
        }
        let float = FilmParams::new(&Film { grade, ..Film::plain() }, View::Light, PixelFormat::Rgba32F, false);
        assert_eq!(develop(&float, [0.5; 4], 0, 0)[..4], 0.5_f32.to_le_bytes());
    }

    /// A disk of a temperature, developed: grey within a step.
    #[test]
    fn balanced_blackbodies_are_grey_pixels() {
        for temperature in [2500.0, 4500.0, 9000.0] {
            let params = params(Grade { white_balance: temperature, ..Grade::default() });
            let light = crate::physics::blackbody::linear_rgb(temperature);
            let most = light.iter().fold(0.0_f64, |a, b| a.max(*b));
            let [r, g, b] = light.map(|v| (0.3 * v / most) as f32);
            // Beyond the gamut, which film cuts off.
            if [r, g, b].iter().all(|v| *v > 0.0) {
                let pixel = develop(&params, [r, g, b, 1.0], 5, 5);
                assert!(pixel[..3].iter().all(|v| v.abs_diff(pixel[0]) <= 1), "{temperature} K: {pixel:?}");
            }
        }
    }
}
