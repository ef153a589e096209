// SPDX-License-Identifier: MIT OR Apache-2.0
//! The formats of pixels: their numbers in the C API, and their bytes. Knows no memory.

/// Bytes in memory order (`BHR_FORMAT_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum PixelFormat {
    Rgba8Srgb = 1,
    Bgra8Srgb = 2,
    /// Linear, Rec. 709 primaries.
    Rgba16F = 3,
    /// Linear, Rec. 709 primaries.
    Rgba32F = 4,
    /// One value: views other than light.
    R32F = 5,
    /// Ten bits of red, green, blue, two of alpha, from the lowest bit on: PQ, Rec. 2020 primaries.
    Rgb10A2Pq = 6,
    /// HLG in the bits of `Rgb10A2Pq`.
    Rgb10A2Hlg = 7,
}

/// The name in `BHR_FORMAT_*`.
impl std::fmt::Display for PixelFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Rgba8Srgb => "RGBA8_SRGB",
            Self::Bgra8Srgb => "BGRA8_SRGB",
            Self::Rgba16F => "RGBA16F",
            Self::Rgba32F => "RGBA32F",
            Self::R32F => "R32F",
            Self::Rgb10A2Pq => "RGB10A2_PQ",
            Self::Rgb10A2Hlg => "RGB10A2_HLG",
        })
    }
}

impl PixelFormat {
    pub fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Rgba8Srgb | Self::Bgra8Srgb | Self::R32F | Self::Rgb10A2Pq | Self::Rgb10A2Hlg => 4,
            Self::Rgba16F => 8,
            Self::Rgba32F => 16,
        }
    }

    /// The format whose value in `BHR_FORMAT_*` this is.
    pub fn of_number(number: u32) -> Option<Self> {
        use PixelFormat::{Bgra8Srgb, R32F, Rgb10A2Hlg, Rgb10A2Pq, Rgba8Srgb, Rgba16F, Rgba32F};
        let all = [Rgba8Srgb, Bgra8Srgb, Rgba16F, Rgba32F, R32F, Rgb10A2Pq, Rgb10A2Hlg];
        all.into_iter().find(|format| *format as i32 as u32 == number)
    }

    /// Codes, which film makes of light and of views' values; the others hold numbers as they are.
    pub fn is_developed(self) -> bool {
        match self {
            Self::Rgba8Srgb | Self::Bgra8Srgb | Self::Rgb10A2Pq | Self::Rgb10A2Hlg => true,
            Self::Rgba16F | Self::Rgba32F | Self::R32F => false,
        }
    }

    /// Codes of high dynamic range, which show light and no views.
    pub fn is_hdr(self) -> bool {
        matches!(self, Self::Rgb10A2Pq | Self::Rgb10A2Hlg)
    }

    /// Bytes of one channel, or of what holds several; pixels and rows are aligned to it.
    pub fn channel_bytes(self) -> usize {
        match self {
            Self::Rgba8Srgb | Self::Bgra8Srgb => 1,
            Self::Rgba16F => 2,
            Self::Rgba32F | Self::R32F | Self::Rgb10A2Pq | Self::Rgb10A2Hlg => 4,
        }
    }
}
