// SPDX-License-Identifier: MIT OR Apache-2.0
//! A list of pixels of a tile on the device, which kernels write and others go over: numbers that are cleared before
//! each tile, then the pixels. Knows no kernel and nothing of what the pixels are listed for.

use crate::error::{Error, Result};
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::wgpu_device::Device;
use wgpu::BufferUsages as Usage;

/// The list's buffer grows with tiles, and never shrinks.
pub struct PixelList {
    label: &'static str,
    /// Bytes before the pixels.
    head: u64,
    /// Bytes for each pixel of a tile.
    bytes_per_pixel: u64,
    buffer: Option<Buffer>,
}

impl PixelList {
    pub const fn new(label: &'static str, head: u64, bytes_per_pixel: u64) -> Self {
        Self { label, head, bytes_per_pixel, buffer: None }
    }

    /// Makes room for the pixels of a tile.
    pub fn prepare(&mut self, device: &Device, tile: [u32; 2]) -> Result<()> {
        let size = self.head + u64::from(tile[0]) * u64::from(tile[1]) * self.bytes_per_pixel;
        if self.buffer.as_ref().is_none_or(|buffer| buffer.size() < size) {
            // The old one goes first: both together need not fit.
            self.buffer = None;
            self.buffer = Some(device.buffer(self.label, size, Usage::STORAGE | Usage::COPY_DST)?);
        }
        Ok(())
    }

    /// Empties it.
    pub fn reset(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(buffer) = &self.buffer {
            encoder.clear_buffer(buffer, 0, Some(self.head));
        }
    }

    /// Errors: INTERNAL before [`Self::prepare`].
    pub fn resource(&self) -> Result<wgpu::BindingResource<'_>> {
        let buffer = self.buffer.as_ref();
        let buffer = buffer.ok_or_else(|| Error::internal(format!("a list of {} without a buffer", self.label)))?;
        Ok(buffer.as_entire_binding())
    }
}
