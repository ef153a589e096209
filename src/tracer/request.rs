// SPDX-License-Identifier: MIT OR Apache-2.0
//! Requests for a tracer: a frame, whose tiles go to a sink as they are finished. Knows no target.

use crate::error::Result;
use crate::image::PixelFormat;
use crate::scene::Region;

/// A part of the target, in its own pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

/// A request for a frame: a width x height image, part of the frame that `region` describes.
#[derive(Clone, Copy, Debug)]
pub struct FrameRequest {
    pub width: u32,
    pub height: u32,
    pub region: Region,
    pub format: PixelFormat,
    /// Premultiplied alpha = 1 - the sky's share, sky left out.
    pub transparent: bool,
}

impl FrameRequest {
    /// Whether the image is the full frame.
    pub fn is_whole(&self) -> bool {
        let Region { full_width, full_height, x, y } = self.region;
        [full_width, full_height, x, y] == [self.width, self.height, 0, 0]
    }
}

/// Takes a finished tile: packed pixels, rows `bytes_per_row` apart. Runs on a thread of the tracer's, if that has one.
pub type TileSink<'a> = dyn FnMut(Tile, &[u8], usize) -> Result<()> + Send + 'a;

/// Takes a finished tile of one of several outputs, which its index tells; else as [`TileSink`].
pub type OutputSink<'a> = dyn FnMut(usize, Tile, &[u8], usize) -> Result<()> + Send + 'a;

/// Hears how much of the frame is done, 0 .. 1; false cancels. Runs on the thread that asked for the frame.
pub type Progress<'a> = dyn FnMut(f64) -> bool + 'a;
