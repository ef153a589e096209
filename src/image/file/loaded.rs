// SPDX-License-Identifier: MIT OR Apache-2.0
//! A file's pixels in memory, which every kind of file becomes when it is read.

use super::support::reserve;
use crate::error::Result;
use crate::image::memory::PixelFormat;

/// Packed pixels of a loaded file, aligned to their channel.
#[derive(Debug)]
pub enum Pixels {
    Bytes(Vec<u8>),
    Floats(Vec<f32>),
}

impl Pixels {
    pub fn as_bytes(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Floats(floats) => bytemuck::cast_slice(floats),
        }
    }

    pub(super) fn as_mut_bytes(&mut self) -> &mut [u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Floats(floats) => bytemuck::cast_slice_mut(floats),
        }
    }

    pub fn as_mut_ptr(&mut self) -> *mut u8 {
        self.as_mut_bytes().as_mut_ptr()
    }
}

/// A file's pixels: `Rgba8Srgb` with `Bytes`, or `Rgba32F` with `Floats`.
#[derive(Debug)]
pub struct Loaded {
    pub format: PixelFormat,
    pub width: u32,
    pub height: u32,
    pub pixels: Pixels,
}

/// The inverse of the sRGB curve, IEC 61966-2-1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB curve, IEC 61966-2-1, by its formula: `film` has a quicker one, to a part of a step.
pub(super) fn linear_to_srgb(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// The light of every 16-bit code. Errors: OUT_OF_MEMORY.
pub(super) fn linear_codes() -> Result<Vec<f32>> {
    let mut codes = reserve(1 << 16)?;
    codes.extend((0..=u16::MAX).map(|code| srgb_to_linear(f32::from(code) / 65535.0)));
    Ok(codes)
}
