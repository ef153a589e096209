// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light that a file's codes stand for: curves from code to light, and matrices from a file's primaries to those of
//! Rec. 709. Knows no kind of file.

use super::loaded::{linear_codes, srgb_to_linear};
use super::support::reserve;
use crate::error::Result;
use glam::DMat3;

/// Luminance of diffuse white in pictures of absolute luminance, cd/m^2: ITU-R BT.2408, section 2.
const REFERENCE_WHITE: f64 = 203.0;
/// The scene light of HLG that BT.2408 gives diffuse white, a signal of 0.75: ITU-R BT.2100, table 5.
const HLG_WHITE: f64 = 0.264_96;
/// The brightest light of a code: the largest half float.
const MAX_LIGHT: f64 = 65504.0;
/// Codes of curves that have a table: those of 16 bits.
const CODES: usize = 1 << 16;

/// From codes of 0 .. 1 to light.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Curve {
    /// IEC 61966-2-1.
    Srgb,
    /// Light is the code to this power.
    Power(f64),
    /// The camera's curve of ITU-R BT.709 and BT.2020, inverted.
    Rec709,
    /// SMPTE ST 2084, where 1 becomes the light of diffuse white.
    Pq,
    /// Hybrid log-gamma's light of the scene, where 1 becomes that of diffuse white.
    Hlg,
    /// SMPTE ST 428-1, of digital cinema.
    Cinema,
    /// The formula of ICC profiles: (a x + b)^g + e from d on, c x + f below; in the order g a b c d e f.
    Parametric([f64; 7]),
    /// Light at equal steps of the code, at least two, and straight between them.
    Table(Vec<f32>),
}

impl Curve {
    /// `code` may lie outside 0 .. 1 where a file's range leaves room there; light is not negative.
    fn light(&self, code: f64) -> f64 {
        let code = code.max(0.0);
        let light = match self {
            Self::Srgb => f64::from(srgb_to_linear(code as f32)),
            Self::Power(exponent) => code.powf(*exponent),
            // alpha and beta of BT.2020 with twelve bits, which BT.709 rounds.
            Self::Rec709 if code < 4.5 * 0.018_053_968_510_807 => code / 4.5,
            Self::Rec709 => ((code + 0.099_296_826_809_44) / 1.099_296_826_809_44).powf(1.0 / 0.45),
            Self::Pq => {
                let (m1, m2) = (2610.0 / 16384.0, 2523.0 / 4096.0 * 128.0);
                let (c1, c2, c3) = (3424.0 / 4096.0, 2413.0 / 4096.0 * 32.0, 2392.0 / 4096.0 * 32.0);
                let root = code.min(1.0).powf(1.0 / m2);
                ((root - c1).max(0.0) / (c2 - c3 * root)).powf(1.0 / m1) * 10_000.0 / REFERENCE_WHITE
            }
            Self::Hlg => {
                let (a, b, c) = (0.178_832_77, 0.284_668_92, 0.559_910_73);
                let scene = if code <= 0.5 { code * code / 3.0 } else { (((code - c) / a).exp() + b) / 12.0 };
                scene / HLG_WHITE
            }
            Self::Cinema => 52.37 / 48.0 * code.powf(2.6),
            Self::Parametric([g, a, b, c, d, e, f]) => {
                if code >= *d {
                    (a * code + b).max(0.0).powf(*g) + e
                } else {
                    c * code + f
                }
            }
            Self::Table(steps) => {
                let place = code.min(1.0) * (steps.len() - 1) as f64;
                let low = (place as usize).min(steps.len() - 2);
                let (from, to) = (f64::from(steps[low]), f64::from(steps[low + 1]));
                from + (to - from) * (place - low as f64)
            }
        };
        light.max(0.0)
    }

    /// Whether every 8-bit code means the light that the sRGB curve gives it, to half a step to the next code.
    fn is_srgb(&self) -> bool {
        let srgb = |code: f64| f64::from(srgb_to_linear((code / 255.0) as f32));
        *self == Self::Srgb
            || (0..=255).map(f64::from).all(|code| {
                let light = self.light(code / 255.0);
                srgb(code - 0.5) <= light && light <= srgb(code + 0.5)
            })
    }
}

/// The numbers of a picture that lie between black and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Range {
    Full,
    /// 16 to 235 of 255 steps, and as much of codes of this many bits: ITU-R BT.709, section 5.
    Video {
        bits: u32,
    },
}

/// From a file's codes to linear light in Rec. 709.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Colours {
    /// One for red, green and blue, or one for each; alpha has none.
    pub curves: Vec<Curve>,
    pub range: Range,
    /// Light of the file's primaries to light of Rec. 709; `None` where both are the same.
    pub matrix: Option<DMat3>,
}

impl Colours {
    pub fn of_curve(curve: Curve) -> Self {
        Self { curves: vec![curve], range: Range::Full, matrix: None }
    }

    pub fn srgb() -> Self {
        Self::of_curve(Curve::Srgb)
    }

    /// Whether 8-bit pixels mean in sRGB what they mean here, so that they may stay as they are.
    pub fn is_srgb(&self) -> bool {
        self.range == Range::Full && self.matrix.is_none() && self.curves.iter().all(Curve::is_srgb)
    }

    /// Errors: OUT_OF_MEMORY.
    pub fn codes(&self) -> Result<Codes> {
        let mut tables = Vec::with_capacity(self.curves.len());
        for curve in &self.curves {
            tables.push(match (curve, self.range) {
                (Curve::Srgb, Range::Full) => linear_codes()?,
                (curve, range) => table(curve, range)?,
            });
        }
        Ok(Codes { tables, matrix: self.matrix.map(Matrix::new) })
    }
}

fn table(curve: &Curve, range: Range) -> Result<Vec<f32>> {
    let mut light = reserve(CODES)?;
    light.extend((0..CODES).map(|code| {
        let share = code as f64 / (CODES - 1) as f64;
        let code = match range {
            Range::Full => share,
            Range::Video { bits } => {
                let steps = f64::from((1_u32 << bits) - 1) / f64::from(1_u32 << (bits - 8));
                (share * steps - 16.0) / 219.0
            }
        };
        let light = curve.light(code);
        // Not a number: a formula of a profile's.
        if light > 0.0 { light.min(MAX_LIGHT) as f32 } else { 0.0 }
    }));
    Ok(light)
}

/// The light of 16-bit codes, by tables.
pub(super) struct Codes {
    tables: Vec<Vec<f32>>,
    matrix: Option<Matrix>,
}

impl Codes {
    /// Linear light in Rec. 709.
    pub fn light(&self, code: [u16; 3]) -> [f32; 3] {
        let last = self.tables.len() - 1;
        let light = [0, 1, 2].map(|c| self.tables[last.min(c)][usize::from(code[c])]);
        self.matrix.map_or(light, |matrix| matrix.of(light))
    }
}

/// Light of other primaries in those of Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Matrix([[f32; 3]; 3]);

impl Matrix {
    pub fn new(columns: DMat3) -> Self {
        Self(columns.transpose().to_cols_array_2d().map(|row| row.map(|number| number as f32)))
    }

    /// Colours that Rec. 709 does not reach have negative components there, which become 0.
    pub fn of(self, [r, g, b]: [f32; 3]) -> [f32; 3] {
        self.0.map(|row| {
            let light = row[0] * r + row[1] * g + row[2] * b;
            // Values that are no numbers stay so.
            if light < 0.0 { 0.0 } else { light }
        })
    }
}
