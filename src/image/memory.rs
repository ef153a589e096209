//! (helper A) Images in the host's memory.
use crate::error::Result;
use std::marker::PhantomData;

/// Bytes in memory order; row 0 at the top (`BHR_FORMAT_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum PixelFormat {
    Rgba8Srgb = 1,
    Bgra8Srgb = 2,
    Rgba16F = 3,
    Rgba32F = 4,
    R32F = 5,
}

impl PixelFormat {
    pub fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Rgba16F => 8,
            Self::Rgba32F => 16,
            _ => 4,
        }
    }
}

pub struct ImageRef<'a>(PhantomData<&'a [u8]>);
pub struct ImageMut<'a> {
    _memory: PhantomData<&'a mut [u8]>,
}
impl ImageMut<'_> {
    pub fn width(&self) -> u32 {
        0
    }
    pub fn height(&self) -> u32 {
        0
    }
    pub fn format(&self) -> PixelFormat {
        PixelFormat::Rgba8Srgb
    }
    pub fn write_tile(
        &mut self,
        _x: u32,
        _y: u32,
        _width: u32,
        _height: u32,
        _pixels: &[u8],
        _bytes_per_row: usize,
    ) -> Result<()> {
        Ok(())
    }
}
