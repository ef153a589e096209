// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where the pixels of a frame that has begun go. Plain numbers.

use crate::error::Result;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::setup::FrameTarget;
use crate::gpu::frame::plan::target_rows::FrameRows;
use crate::tracer::Tile;

/// The place that finished tiles go to.
pub enum Delivery {
    /// There are none.
    Nowhere,
    /// To the host.
    Host,
    /// Where kernels write them, into an image.
    Image,
    /// Where kernels write them, into the rows of a buffer.
    Rows(FrameRows),
    /// Into a texture, by a copy.
    Copied(wgpu::Texture),
}

impl Delivery {
    pub fn of(target: FrameTarget<'_>) -> Self {
        match target {
            FrameTarget::Nowhere => Self::Nowhere,
            FrameTarget::Host => Self::Host,
            FrameTarget::Image(..) => Self::Image,
            FrameTarget::Buffer(_, rows) => Self::Rows(rows),
            FrameTarget::Copied(texture) => Self::Copied(texture.clone()),
        }
    }

    /// Whether tiles need a buffer of their own, from which they are copied.
    pub fn is_packed(&self) -> bool {
        matches!(self, Self::Host | Self::Copied(_))
    }

    /// The most rows of a tile. Errors: UNSUPPORTED for rows that no kernel reaches.
    pub fn most_rows(&self, device: &Device) -> Result<u32> {
        match self {
            Self::Rows(rows) => rows.most_rows(device),
            _ => Ok(u32::MAX),
        }
    }

    /// Bytes from row to row of a packed tile.
    pub fn pitch(&self, tile: Tile, pixel_bytes: usize) -> u32 {
        let row = tile.width * pixel_bytes as u32;
        match self {
            Self::Copied(_) => row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT),
            _ => row,
        }
    }
}
