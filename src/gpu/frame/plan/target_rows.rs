// SPDX-License-Identifier: MIT OR Apache-2.0
//! The places of a tile's pixels in the buffer that kernels write them to: the packed pixels of one tile, or the rows
//! of a whole frame. Plain numbers.

use crate::error::{Error, ErrorKind, Result};
use crate::gpu::device::target::GpuTarget;
use crate::gpu::device::wgpu_device::Device;
use crate::tracer::Tile;

/// The rows of a whole frame in a buffer on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRows {
    /// Bytes from row to row, a multiple of 4.
    pub row_stride: u64,
    /// Bytes of a pixel.
    pub pixel_bytes: u64,
    /// Bytes of the buffer.
    pub size: u64,
}

/// The part of a buffer that a kernel binds, and where in it a tile's pixels are, in words of 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TilePlace {
    /// Bytes; `None`: up to the buffer's end.
    pub offset: u64,
    pub size: Option<u64>,
    pub first: u32,
    pub row: u32,
}

impl FrameRows {
    /// The rows of a target's buffer.
    pub fn of(target: &GpuTarget, buffer: &wgpu::Buffer) -> Self {
        let shape = &target.shape;
        let pixel_bytes = shape.format.bytes_per_pixel() as u64;
        Self { row_stride: shape.row_stride, pixel_bytes, size: buffer.size() }
    }

    /// The most columns and rows of a tile that a binding of `largest` bytes holds. Errors: UNSUPPORTED when it does
    /// not hold a row.
    pub fn most_rows(&self, device: &Device) -> Result<u32> {
        let limits = device.limits();
        let largest = limits.max_storage_buffer_binding_size;
        let room = largest.saturating_sub(limits.min_storage_buffer_offset_alignment.into());
        let rows = (room / self.row_stride.max(1)).min(u32::MAX.into()) as u32;
        if rows == 0 {
            let row_stride = self.row_stride;
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("row_stride is {row_stride} bytes; a kernel of this adapter reaches {largest} bytes at once"),
            ));
        }
        Ok(rows)
    }

    /// The place of a tile. A buffer that can be bound whole is, so that all tiles bind the same.
    pub fn place(&self, device: &Device, tile: Tile) -> TilePlace {
        let limits = device.limits();
        self.place_within(
            limits.max_storage_buffer_binding_size,
            limits.min_storage_buffer_offset_alignment.into(),
            tile,
        )
    }

    fn place_within(&self, largest: u64, alignment: u64, tile: Tile) -> TilePlace {
        let begin = u64::from(tile.y) * self.row_stride;
        let row = (self.row_stride / 4) as u32;
        let column = u64::from(tile.x) * self.pixel_bytes;
        if self.size <= largest {
            return TilePlace { offset: 0, size: None, first: ((begin + column) / 4) as u32, row };
        }
        let offset = begin - begin % alignment;
        let end = begin + u64::from(tile.height) * self.row_stride;
        let size = end.min(self.size) - offset;
        TilePlace { offset, size: Some(size), first: ((begin - offset + column) / 4) as u32, row }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_buffer_is_bound_in_parts_that_hold_the_tile() {
        let rows = FrameRows { row_stride: 1004, pixel_bytes: 8, size: 1004 * 99 + 800 };
        let tile = Tile { x: 10, y: 37, width: 90, height: 20 };
        let whole = rows.place_within(rows.size, 256, tile);
        assert_eq!(whole, TilePlace { offset: 0, size: None, first: (37 * 1004 + 80) / 4, row: 251 });
        let part = rows.place_within(1004 * 20 + 256, 256, tile);
        assert_eq!(part.offset % 256, 0);
        assert_eq!(part.offset + u64::from(part.first) * 4, 37 * 1004 + 80);
        assert!(part.size.unwrap() <= 1004 * 20 + 256);
        assert_eq!(part.offset + part.size.unwrap(), 57 * 1004);
        // The last rows end with the buffer.
        let last = rows.place_within(1004 * 20 + 256, 256, Tile { y: 80, ..tile });
        assert_eq!(last.offset + last.size.unwrap(), rows.size);
    }
}
