// SPDX-License-Identifier: MIT OR Apache-2.0
//! Film: linear Rec. 709 radiance to the pixels of a format. 8-bit formats get exposure, a grade, tone map, the sRGB
//! curve and a LUT or a colour map, and dithering; float formats get the radiance as it is. Views other than light get
//! false colour, or their value. In f32, so that `shaders/film/film.wgsl`, which has the same functions, agrees to one
//! step of 8 bits. Knows nothing of how light was made.

pub mod bloom;
pub(crate) mod colour_map;
pub(crate) mod false_colour;
pub(crate) mod tone_map;
mod white_balance;
pub(crate) mod grade;
pub(crate) mod filmic;
pub(crate) mod metering;
pub(crate) mod whole;
pub(crate) mod lut;
pub(crate) mod hdr;

use crate::image::{Lut, PixelFormat};
use crate::scene::{ColourMap, Film, ToneMap, View};
use arrayvec::ArrayVec;
use filmic::FilmicParams;
use grade::GradeParams;
use hdr::HdrParams;
use lut::LutParams;
use tone_map::MAX_SCENE_LIGHT;

/// The properties of a frame that film needs: the uniform `film` of the shader, 288 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct FilmParams {
    /// Factor on radiance, 2^ev.
    pub exposure: f32,
    /// A `ToneMap`.
    pub tone_map: u32,
    /// A `PixelFormat`.
    pub format: u32,
    /// A `View`; any but light: the red channel holds its value.
    pub false_colour: u32,
    /// Scaled as `false_colour` says, the view's value that becomes the first colour.
    pub view_low: f32,
    /// 1 / (last colour's scaled value - first's).
    pub view_scale: f32,
    /// 1: alpha is kept; 0: it becomes 1.
    pub transparent: u32,
    /// A `ColourMap`.
    pub colour_map: u32,
    pub grade: GradeParams,
    pub filmic: FilmicParams,
    pub lut: LutParams,
    pub hdr: HdrParams,
}

impl FilmParams {
    /// `film` has passed its check. `transparent`: keep alpha, radiance being premultiplied by it.
    pub fn new(film: &Film, view: View, format: PixelFormat, transparent: bool) -> Self {
        let (low, scale) = false_colour::ends(view);
        Self {
            exposure: film.exposure_ev.exp2() as f32,
            tone_map: film.tone_map as u32,
            format: format as i32 as u32,
            false_colour: view as u32,
            view_low: low,
            view_scale: scale,
            transparent: u32::from(transparent),
            colour_map: film.colour_map as u32,
            grade: GradeParams::new(&film.grade),
            filmic: FilmicParams::new(&film.filmic),
            lut: LutParams::default(),
            hdr: HdrParams::new(film),
        }
    }

    /// In a whole frame of this size in pixels, which a vignette goes by.
    pub fn over_frame(self, width: u32, height: u32) -> Self {
        Self { grade: self.grade.over_frame(width, height), ..self }
    }

    /// With a LUT behind the sRGB curve, if there is one (`Scene::shown_lut`).
    pub fn with_lut(self, lut: Option<&Lut>, film: &Film) -> Self {
        Self { lut: lut.map(|lut| LutParams::new(lut, film.lut_strength)).unwrap_or_default(), ..self }
    }

    /// The parameters for the sum of a frame with bloom, whose light was exposed before it spread.
    pub fn of_exposed(self) -> Self {
        Self { exposure: 1.0, ..self }
    }

    /// Light as bloom spreads it: exposed, and limited as it will be when it is developed, so that no pixel spreads
    /// more than the brightest that films tell apart, nor NaN. Alpha within [0, 1].
    #[inline(always)]
    pub fn exposed_light(&self, radiance: [f64; 4]) -> [f32; 4] {
        let [r, g, b, a] = radiance.map(|v| v as f32);
        let [r, g, b] = [r, g, b].map(|v| limited(v * self.exposure, MAX_SCENE_LIGHT));
        [r, g, b, limited(a, 1.0)]
    }

    fn pixel_format(&self) -> PixelFormat {
        PixelFormat::of_number(self.format).unwrap_or(PixelFormat::Rgba8Srgb)
    }

    fn tone_map_kind(&self) -> ToneMap {
        match self.tone_map {
            1 => ToneMap::Aces,
            2 => ToneMap::Agx,
            3 => ToneMap::Filmic,
            _ => ToneMap::None,
        }
    }

    pub(crate) fn view(&self) -> View {
        match self.false_colour {
            1 => View::Redshift,
            2 => View::Order,
            3 => View::Deflection,
            4 => View::Steps,
            5 => View::Metric,
            6 => View::OpticalDepth,
            7 => View::Intensity,
            _ => View::Light,
        }
    }

    /// The word of red, green, blue, alpha codes: the first in the lowest byte, or blue for BGRA8.
    #[inline(always)]
    fn packed_8bit(&self, [r, g, b, a]: [u32; 4]) -> u32 {
        let (low, high) = if self.format == PixelFormat::Bgra8Srgb as u32 { (b, r) } else { (r, b) };
        low | g << 8 | high << 16 | a << 24
    }
}

/// The bytes of one pixel, in memory order.
pub type PackedPixel = ArrayVec<u8, 16>;

/// One pixel of the frame: a row of one, as `develop_row`.
pub fn develop(params: &FilmParams, radiance: [f32; 4], x: u32, y: u32) -> PackedPixel {
    develop_through(params, None, radiance, x, y)
}

/// One pixel of the frame, with a LUT.
pub fn develop_through(params: &FilmParams, lut: Option<&Lut>, radiance: [f32; 4], x: u32, y: u32) -> PackedPixel {
    let mut bytes = [0; 16];
    let length = params.pixel_format().bytes_per_pixel();
    develop_row(params, lut, &[radiance.map(f64::from)], x, y, &mut bytes[..length]);
    bytes[..length].iter().copied().collect()
}

/// Pixels of the frame, side by side, into their bytes. `radiance`: linear Rec. 709, premultiplied, and alpha; for a
/// view, its value first. (`x`, `y`): the first pixel's place in the whole frame, which the dither goes by, so that
/// tiles join without a seam. `lut`: the one that the parameters were made with.
pub fn develop_row(params: &FilmParams, lut: Option<&Lut>, radiance: &[[f64; 4]], x: u32, y: u32, out: &mut [u8]) {
    use PixelFormat::{Bgra8Srgb, R32F, Rgb10A2Hlg, Rgb10A2Pq, Rgba8Srgb, Rgba16F, Rgba32F};
    match (params.pixel_format(), params.false_colour != 0, params.tone_map_kind()) {
        (Rgba16F, ..) => write_row(radiance, x, out, |v, _| develop_rgba16f(params, v)),
        (Rgba32F, ..) => write_row(radiance, x, out, |v, _| develop_rgba32f(params, v)),
        (R32F, ..) => write_row(radiance, x, out, |v, _| [v[0].to_bits()]),
        (Rgb10A2Pq, ..) => write_hdr_row(params, radiance, (x, y), out, hdr::pq_codes),
        (Rgb10A2Hlg, ..) => write_hdr_row(params, radiance, (x, y), out, hdr::hlg_codes),
        (Rgba8Srgb | Bgra8Srgb, true, _) => {
            write_row(radiance, x, out, |v, _| [params.packed_8bit(false_colour_codes(params, v[0]))]);
        }
        (Rgba8Srgb | Bgra8Srgb, false, tone_map) => {
            let row = LightRow { params, lut, radiance, x, y };
            match tone_map {
                ToneMap::None => row.write(out, tone_map::clip),
                ToneMap::Aces => row.write(out, tone_map::aces),
                ToneMap::Agx => row.write(out, tone_map::agx),
                ToneMap::Filmic => row.write(out, |scene| filmic::filmic(&params.filmic, scene)),
            }
        }
    }
}

/// Pixels of light that are to be written in 8 bits.
struct LightRow<'a> {
    params: &'a FilmParams,
    lut: Option<&'a Lut>,
    radiance: &'a [[f64; 4]],
    x: u32,
    y: u32,
}

impl LightRow<'_> {
    /// Writes light as it is or graded.
    fn write(&self, out: &mut [u8], tone_map: impl Fn([f32; 3]) -> [f32; 3]) {
        let (grade, y) = (&self.params.grade, self.y);
        if grade.graded == 0 {
            self.write_graded(out, tone_map, |scene, _| scene);
        } else {
            self.write_graded(out, tone_map, |scene, x| grade::graded(grade, scene, x, y));
        }
    }

    /// Writes light: its own colours, those that a LUT has for them, or those of a map for its luminance. `grade`: of
    /// exposed light at an x.
    fn write_graded(
        &self,
        out: &mut [u8],
        tone_map: impl Fn([f32; 3]) -> [f32; 3],
        grade: impl Fn([f32; 3], u32) -> [f32; 3],
    ) {
        let &Self { params, lut, .. } = self;
        let lut = lut.filter(|_| params.lut.side != 0);
        if params.colour_map == ColourMap::Afmhot as u32 {
            let colour = |scene| colour_map::afmhot(tone_map([colour_map::luminance(scene); 3])[0]);
            self.write_colours(out, |scene, x| colour(grade(scene, x)));
        } else if let Some(lut) = lut {
            let colour = |scene| lut::through_lut(&params.lut, lut.nodes(), tone_map(scene).map(srgb_encode));
            self.write_colours(out, |scene, x| colour(grade(scene, x)));
        } else {
            let colour = |scene| tone_map(scene).map(srgb_encode);
            self.write_colours(out, |scene, x| colour(grade(scene, x)));
        }
    }

    /// `colour`: of exposed light at an x, sRGB-encoded.
    fn write_colours(&self, out: &mut [u8], colour: impl Fn([f32; 3], u32) -> [f32; 3]) {
        let &Self { params, radiance, x, y, .. } = self;
        write_row(radiance, x, out, |v, x| [develop_8bit(params, v, x, y, |scene| colour(scene, x))]);
    }
}

/// Writes what `pixel` makes of every value and its x.
fn write_row<const WORDS: usize>(
    radiance: &[[f64; 4]],
    x: u32,
    out: &mut [u8],
    pixel: impl Fn([f32; 4], u32) -> [u32; WORDS],
) {
    for ((out, value), x) in out.chunks_exact_mut(4 * WORDS).zip(radiance).zip(x..) {
        for (bytes, word) in out.chunks_exact_mut(4).zip(pixel(value.map(|v| v as f32), x)) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
    }
}

/// A pixel of light in 8 bits. `colour`: of exposed light, sRGB-encoded. Premultiplied light is developed as it is:
/// over black, a transparent picture looks like the opaque one. Codes are what the sum of value and dither, in [0, 1),
/// is rounded down to: right on average, and black and white stay exact. Alpha is rounded without dither. No branches
/// and all in one piece, so that the compiler can develop several pixels at once.
#[inline(always)]
fn develop_8bit(params: &FilmParams, radiance: [f32; 4], x: u32, y: u32, colour: impl Fn([f32; 3]) -> [f32; 3]) -> u32 {
    let scene = [radiance[0], radiance[1], radiance[2]].map(|v| limited(v * params.exposure, MAX_SCENE_LIGHT));
    let noise = dither(x, y);
    let [r, g, b] = colour(scene).map(|v| code(v * 255.0 + noise));
    params.packed_8bit([r, g, b, code(alpha(params, radiance[3]) * 255.0 + 0.5)])
}

/// Pixels of light in ten bits. `codes`: of exposed, graded light. Rounded as `develop_8bit` does.
fn write_hdr_row(
    params: &FilmParams,
    radiance: &[[f64; 4]],
    (x, y): (u32, u32),
    out: &mut [u8],
    codes: impl Fn(&HdrParams, [f32; 3]) -> [f32; 3],
) {
    write_row(radiance, x, out, |v, x| {
        let scene = [v[0], v[1], v[2]].map(|v| limited(v * params.exposure, MAX_SCENE_LIGHT));
        let graded = if params.grade.graded == 0 { scene } else { grade::graded(&params.grade, scene, x, y) };
        let noise = dither(x, y);
        let [r, g, b] = codes(&params.hdr, graded).map(|v| code(v * 1023.0 + noise));
        [r | g << 10 | b << 20 | code(alpha(params, v[3]) * 3.0 + 0.5) << 30]
    });
}

/// Codes of a view's value, rounded without dither.
fn false_colour_codes(params: &FilmParams, value: f32) -> [u32; 4] {
    let ends = (params.view_low, params.view_scale);
    let [r, g, b] = false_colour::false_colour(params.view(), ends, value).map(|v| code(v * 255.0 + 0.5));
    [r, g, b, 255]
}

/// `v` in [0, 256) rounded down. Through i32, which vector instructions convert to.
#[inline(always)]
fn code(v: f32) -> u32 {
    v as i32 as u32
}

/// Largest finite f16.
pub(crate) const MAX_F16: f32 = 65504.0;

/// Finite: brighter light than f16 can hold becomes its largest number.
fn develop_rgba16f(params: &FilmParams, radiance: [f32; 4]) -> [u32; 2] {
    let pair = |low: f32, high: f32| {
        let bits = |v| u32::from(half::f16::from_f32(v).to_bits());
        bits(low) | bits(high) << 16
    };
    let [r, g, b, a] = radiance;
    let light = |v| limited(v, MAX_F16);
    [pair(light(r), light(g)), pair(light(b), alpha(params, a))]
}

fn develop_rgba32f(params: &FilmParams, radiance: [f32; 4]) -> [u32; 4] {
    let [r, g, b, a] = radiance;
    let light = |v| limited(v, f32::MAX).to_bits();
    [light(r), light(g), light(b), alpha(params, a).to_bits()]
}

#[inline(always)]
fn alpha(params: &FilmParams, alpha: f32) -> f32 {
    let kept = limited(alpha, 1.0);
    if params.transparent != 0 { kept } else { 1.0 }
}

/// `v` within [0, `most`]; NaN, which no tracer should give, becomes 0: no pixel spreads it.
#[inline(always)]
pub(crate) fn limited(v: f32, most: f32) -> f32 {
    if v.is_nan() { 0.0 } else { v.max(0.0).min(most) }
}

/// Linear light 0 .. 1 to the sRGB code value 0 .. 1 (IEC 61966-2-1), to 1e-4 of an 8-bit step: of the power,
/// 1.055 v^(1 / 2.4) - 0.055 = 1 - t p(t) with t = 1 - v^(1/4), p its polynomial of degree 7 in the Chebyshev points of
/// the t there are. So no logarithm is needed, and 1 gives 1 exactly.
#[inline(always)]
pub fn srgb_encode(linear: f32) -> f32 {
    let t = 1.0 - linear.sqrt().sqrt();
    let p = SRGB_POWER.iter().rev().fold(0.0, |sum, c| sum * t + c);
    if linear <= 0.0031308 { 12.92 * linear } else { 1.0 - t * p }
}

/// Coefficients of t^0 .. t^7.
const SRGB_POWER: [f32; 8] =
    [1.7583335, -0.5861359, -0.064457804, -0.028352347, 0.021440784, -0.08328923, 0.0934509, -0.05286597];

/// Interleaved gradient noise (J. Jimenez, SIGGRAPH 2014): fract(52.9829189 fract(0.06711056 x + 0.00583715 y)), here
/// in fixed point with 32 bits of fraction, so that it is the same number on every machine: 52.9829189 = 53 - 1119.4 /
/// 2^16. In [0, 1), multiples of 2^-16, so that 255 plus it is exact.
#[inline(always)]
pub fn dither(x: u32, y: u32) -> f32 {
    let ramp = x.wrapping_mul(288_237_660).wrapping_add(y.wrapping_mul(25_070_369));
    let noise = ramp.wrapping_mul(53).wrapping_sub((ramp >> 16).wrapping_mul(1119));
    (noise >> 16) as f32 / 65536.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params(tone_map: ToneMap, format: PixelFormat) -> FilmParams {
        FilmParams::new(&Film { tone_map, ..Film::plain() }, View::Light, format, false)
    }

    /// IEC 61966-2-1, decoding, in f64.
    fn srgb_decode(code: f64) -> f64 {
        if code <= 0.04045 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
    }

    #[test]
    fn srgb_curve_is_exact_at_every_code() {
        for code in 0..=255_u32 {
            let linear = srgb_decode(f64::from(code) / 255.0) as f32;
            assert!((srgb_encode(linear) * 255.0 - code as f32).abs() < 1e-3, "{code}");
        }
        for i in 1..=20_000 {
            let linear = 1.0 - 0.9968692 * f64::from(i) / 20_001.0;
            let exact = 1.055 * linear.powf(1.0 / 2.4) - 0.055;
            assert!((f64::from(srgb_encode(linear as f32)) - exact).abs() * 255.0 < 2e-4, "{linear}");
        }
        assert_eq!(srgb_encode(0.0), 0.0);
        assert_eq!(srgb_encode(1.0), 1.0);
        assert_eq!((srgb_encode(1.0) * 255.0 + 65535.0 / 65536.0) as u32, 255);
    }

    #[test]
    fn black_and_white_take_no_dither_in_any_tone_map() {
        for kind in [ToneMap::None, ToneMap::Aces, ToneMap::Agx, ToneMap::Filmic] {
            let params = params(kind, PixelFormat::Rgba8Srgb);
            for i in 0..4096 {
                let (x, y) = (i % 64, i / 64);
                assert_eq!(develop(&params, [0.0; 4], x, y).as_slice(), [0, 0, 0, 255]);
                assert_eq!(develop(&params, [1e9; 4], x, y).as_slice(), [255; 4]);
            }
        }
        assert_eq!(develop(&params(ToneMap::None, PixelFormat::Rgba8Srgb), [1.0; 4], 0, 0).as_slice(), [255; 4]);
    }

    #[test]
    fn dither_is_unbiased_and_at_most_one_step() {
        let params = params(ToneMap::None, PixelFormat::Rgba8Srgb);
        for value in [0.001, 0.02, 0.2, 0.77] {
            let wanted = f64::from(srgb_encode(value)) * 255.0;
            let mut sum = 0.0;
            for i in 0..128 * 128 {
                let code = f64::from(develop(&params, [value; 4], i % 128, 1000 + i / 128)[0]);
                assert!((code - wanted).abs() < 1.0, "{code} for {wanted}");
                sum += code;
            }
            let mean = sum / (128.0 * 128.0);
            assert!((mean - wanted).abs() < 0.01, "mean {mean} for {wanted}");
        }
    }

    /// A gradient so slow that without dithering its steps would be bands of 64 columns: the mean of any 8 x 8 pixels
    /// follows it, and no row has a step's code for long.
    #[test]
    fn slow_gradients_show_no_bands() {
        let params = params(ToneMap::None, PixelFormat::Rgba8Srgb);
        let level = |x: u32| 40.0 + f64::from(x) / 64.0;
        let code = |x: u32, y: u32| {
            let light = srgb_decode(level(x) / 255.0) as f32;
            f64::from(develop(&params, [light; 4], x, y)[0])
        };
        let mut longest = 0;
        for y in 0..64 {
            let row = (0..1024).map(|x| code(x, y)).collect::<Vec<_>>();
            longest = row.chunk_by(|a, b| a == b).map(<[f64]>::len).fold(longest, usize::max);
        }
        assert!(longest < 24, "{longest} equal pixels in a row");
        for (x, y) in (0..1016).step_by(4).flat_map(|x| (0..56).step_by(8).map(move |y| (x, y))) {
            let mean = (0..64).map(|i| code(x + i % 8, y + i / 8) - level(x + i % 8)).sum::<f64>() / 64.0;
            assert!(mean.abs() < 0.1, "({x}, {y}): {mean} of a step off");
        }
    }

    #[test]
    fn dither_is_jimenez_noise() {
        for (x, y) in [(0_u32, 0_u32), (1, 0), (0, 1), (17, 5), (1919, 1079)] {
            let ramp = (0.06711056 * f64::from(x) + 0.00583715 * f64::from(y)).fract();
            let difference = f64::from(dither(x, y)) - (52.9829189 * ramp).fract();
            // On a circle: 0 and 1 are the same phase.
            assert!((difference - difference.round()).abs() < 1e-3, "({x}, {y}): {difference}");
        }
    }

    #[test]
    fn exposure_is_in_stops_and_for_8_bit_only() {
        let film = Film { tone_map: ToneMap::None, exposure_ev: -1.0, ..Film::plain() };
        let darker = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false);
        let plain = params(ToneMap::None, PixelFormat::Rgba8Srgb);
        assert_eq!(develop(&darker, [0.5, 0.25, 0.125, 1.0], 3, 4), develop(&plain, [0.25, 0.125, 0.0625, 1.0], 3, 4));
        let float = FilmParams::new(&film, View::Light, PixelFormat::Rgba32F, false);
        let bytes = develop(&float, [0.5, 7.0, 1e30, 0.25], 0, 0);
        let values: Vec<f32> = bytes.chunks(4).map(|c| f32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
        assert_eq!(values, [0.5, 7.0, 1e30, 1.0]);
    }

    #[test]
    fn formats_order_and_limit_their_channels() {
        let plain = |format| params(ToneMap::None, format);
        assert_eq!(develop(&plain(PixelFormat::Rgba8Srgb), [1.0, 0.0, 0.0, 0.0], 0, 0).as_slice(), [255, 0, 0, 255]);
        assert_eq!(develop(&plain(PixelFormat::Bgra8Srgb), [1.0, 0.0, 0.0, 0.0], 0, 0).as_slice(), [0, 0, 255, 255]);
        let half = develop(&plain(PixelFormat::Rgba16F), [1.0, 1e9, f32::INFINITY, 0.0], 0, 0);
        assert_eq!(half.as_slice(), [0x00, 0x3c, 0xff, 0x7b, 0xff, 0x7b, 0x00, 0x3c]);
        let value = develop(&plain(PixelFormat::R32F), [-2.0, 0.0, 0.0, 0.0], 0, 0);
        assert_eq!(value.as_slice(), (-2.0_f32).to_le_bytes());
        for format in [PixelFormat::Rgba8Srgb, PixelFormat::Rgba16F, PixelFormat::Rgba32F, PixelFormat::R32F] {
            assert_eq!(develop(&plain(format), [0.0; 4], 0, 0).len(), format.bytes_per_pixel());
        }
    }

    #[test]
    fn nan_and_negative_light_is_black() {
        for kind in [ToneMap::None, ToneMap::Aces, ToneMap::Agx, ToneMap::Filmic] {
            let pixel = develop(&params(kind, PixelFormat::Rgba8Srgb), [f32::NAN, -1.0, 0.0, f32::NAN], 9, 9);
            assert_eq!(pixel.as_slice(), [0, 0, 0, 255]);
        }
        let pixel = develop(&params(ToneMap::None, PixelFormat::Rgba32F), [f32::NAN, f32::INFINITY, -1.0, 0.0], 9, 9);
        assert_eq!(pixel[..4], 0.0_f32.to_le_bytes());
        assert_eq!(pixel[4..8], f32::MAX.to_le_bytes());
        assert_eq!(pixel[8..12], 0.0_f32.to_le_bytes());
    }

    #[test]
    fn a_colour_map_shows_the_luminance_alone() {
        for tone_map in [ToneMap::None, ToneMap::Aces, ToneMap::Agx, ToneMap::Filmic] {
            let film = Film { tone_map, colour_map: ColourMap::Afmhot, ..Film::plain() };
            let params = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false);
            let at = |rgb: [f32; 3]| develop(&params, [rgb[0], rgb[1], rgb[2], 1.0], 7, 9);
            assert_eq!(at([0.0; 3]).as_slice(), [0, 0, 0, 255]);
            assert_eq!(at([1e9; 3]).as_slice(), [255; 4]);
            let grey = colour_map::luminance([0.3, 0.1, 0.7]);
            let (mixed, grey) = (at([0.3, 0.1, 0.7]), at([grey; 3]));
            assert!((0..3).all(|c| mixed[c].abs_diff(grey[c]) <= 1), "{tone_map:?}: {mixed:?} {grey:?}");
        }
        // Without a tone map the share is the luminance itself: red by 0.4 is 2 * 0.2126 * 0.4 of red.
        let film = Film { tone_map: ToneMap::None, colour_map: ColourMap::Afmhot, ..Film::plain() };
        let params = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false);
        let red = develop(&params, [0.4, 0.0, 0.0, 1.0], 0, 0);
        assert!((i32::from(red[0]) - 43).abs() <= 1 && red[1] == 0 && red[2] == 0, "{red:?}");
    }

    #[test]
    fn transparent_pictures_keep_alpha_and_look_alike_over_black() {
        let film = Film::plain();
        let opaque = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, false);
        let clear = FilmParams::new(&film, View::Light, PixelFormat::Rgba8Srgb, true);
        let radiance = [0.3, 0.2, 0.1, 0.5];
        assert_eq!(develop(&clear, radiance, 5, 6)[..3], develop(&opaque, radiance, 5, 6)[..3]);
        assert_eq!(develop(&clear, radiance, 5, 6)[3], 128);
        assert_eq!(develop(&opaque, radiance, 5, 6)[3], 255);
    }

    #[test]
    fn views_are_false_colour_without_film() {
        let film = Film { exposure_ev: 5.0, ..Film::plain() };
        let redshift = FilmParams::new(&film, View::Redshift, PixelFormat::Rgba8Srgb, true);
        let at = |value: f32| develop(&redshift, [value, 0.0, 0.0, 0.0], 1, 2);
        assert_eq!(at(f32::NAN).as_slice(), [128, 128, 128, 255]);
        assert_eq!(at(7.0), at(3.0));
        assert!(at(0.0)[0] > at(0.0)[2] + 100 && at(3.0)[2] > at(3.0)[0] + 100, "{:?} {:?}", at(0.0), at(3.0));
    }
}
