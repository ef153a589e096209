// SPDX-License-Identifier: MIT OR Apache-2.0
//! The list on the device of the pixels that edges run through. Knows no kernels.

use crate::error::Result;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::tiles::MAX_BATCH;
use crate::gpu::lens::pixel_list::PixelList;

/// `Edges` of records/edges.wgsl: bytes before the pixels, three counts for each sample of a submission.
const HEAD: u64 = 12 * MAX_BATCH as u64;

/// The list; it grows and stays.
pub struct EdgeList(PixelList);

impl Default for EdgeList {
    fn default() -> Self {
        Self(PixelList::new("edges", HEAD, Self::BYTES_PER_PIXEL))
    }
}

impl EdgeList {
    /// Bytes of a tile's pixel on the device. A pixel may be listed twice: at first as an edge of the disk and then as
    /// the critical curve's.
    pub const BYTES_PER_PIXEL: u64 = 2 * 4;

    /// Makes room for the pixels of a tile.
    pub fn prepare(&mut self, device: &Device, tile: [u32; 2]) -> Result<()> {
        self.0.prepare(device, tile)
    }

    /// Empties it.
    pub fn reset(&self, encoder: &mut wgpu::CommandEncoder) {
        self.0.reset(encoder);
    }

    /// The list as group 3 of the kernels that write and read it.
    pub fn group(&self, device: &Device, layout: &wgpu::BindGroupLayout) -> Result<wgpu::BindGroup> {
        device.bind(layout, &[self.0.resource()?])
    }
}
