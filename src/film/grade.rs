// SPDX-License-Identifier: MIT OR Apache-2.0
//! The grade: changes exposed light, glare and beam included, before the tone map. In this order: a lens' fall-off,
//! white balance, contrast, saturation. In f32, as `shaders/film/grade.wgsl`, which has the same function. Knows
//! nothing of pixels and formats. Black stays black.
//!
//! Fall-off: natural vignetting, cos^4 of the angle from the axis (e.g. W. J. Smith, Modern Optical Engineering,
//! "cosine-to-the-fourth law"), whose tangent grows from the middle of the frame to 1 in its corners, whatever the
//! frame's field and resolution: cos^4 = (1 + r^2)^-2, r the share of the way to a corner. Contrast: a power of light
//! about middle grey, 0.18 (v / 0.18)^c for each component. Saturation: as the ASC CDL has it (ASC Color Decision List
//! Transfer Functions and Interchange Syntax, v1.2, 2009), Y + s (v - Y) with the luminance Y of Rec. 709, and nothing
//! below 0.

use super::colour_map::luminance;
use super::tone_map::MAX_SCENE_LIGHT;
use super::white_balance;
use crate::scene::Grade;

/// The light that contrast keeps.
const MIDDLE_GREY: f64 = 0.18;
/// Less is taken as this before a power or logarithm, which drivers need not have at 0.
pub(crate) const LEAST_BASE: f32 = 1e-30;

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
        }
    }

    /// In a whole frame of this size in pixels.
    pub fn over_frame(self, width: u32, height: u32) -> Self {
        let [x, y] = [width, height].map(|side| 0.5 * f64::from(side));
        Self { vignette_centre: [x as f32, y as f32], vignette_scale: (1.0 / (x * x + y * y)) as f32, ..self }
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
    contrasted.map(|v| (grey + grade.saturation * (v - grey)).clamp(0.0, MAX_SCENE_LIGHT))
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

    #[test]
    fn a_grade_that_is_off_changes_no_bit_and_others_keep_black() {
        let off = params(Grade::default());
        assert_eq!(off.grade.graded, 0);
        let grade = Grade { white_balance: 2000.0, tint: 1.0, contrast: 0.25, saturation: 4.0, vignette: 1.0 };
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
