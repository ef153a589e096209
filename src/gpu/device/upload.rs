// SPDX-License-Identifier: MIT OR Apache-2.0
//! Brings bytes from the host to the device before its next submission runs: into buffers that the host fills, and from
//! there by commands that go before it. Knows nothing of what the bytes mean.
//!
//! Not by wgpu's `Queue::write_buffer` and `write_texture`: they hold wgpu's snatch lock while they ask for its
//! trackers, and a poll that frees the memory of a lost device holds the trackers while it asks for the snatch lock
//! (wgpu-core 30.0.1, `Device::release_gpu_resources`), so that both threads would wait for ever.

use super::wgpu_device::Device;
use crate::deferred::hold;
use crate::error::{Error, Result};
use std::sync::PoisonError;

/// Bytes that are put into one buffer, about.
const BAND_BYTES: usize = 16 << 20;

impl Device {
    /// Writes `data` into `buffer` at `offset` (both multiples of 4) before the next submission runs. Errors: as
    /// [`Device::scoped`].
    pub fn write(&self, buffer: &wgpu::Buffer, offset: u64, data: &[u8]) -> Result<()> {
        let filled = self.filled(data, data.len(), data.len())?;
        self.upload("writing a buffer", |encoder| {
            encoder.copy_buffer_to_buffer(&filled, 0, buffer, offset, data.len() as u64);
        })
    }

    /// Writes rows of `row_bytes`, one at least, into a part of a level of `texture` of so many rows and `width`
    /// columns, which begins at `first`, before the next submission runs. Rows are of blocks where the texture's format
    /// has blocks. Errors: as [`Device::scoped`].
    pub(in crate::gpu) fn write_texels(
        &self,
        (texture, mip_level): (&wgpu::Texture, u32),
        first: [u32; 2],
        width: u32,
        row_bytes: usize,
        data: &[u8],
    ) -> Result<()> {
        let pitch = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let (block_width, block_height) = texture.format().block_dimensions();
        let band_rows = (BAND_BYTES / pitch).max(1);
        let tops = (first[1]..).step_by(band_rows * block_height as usize);
        for (band, y) in data.chunks(band_rows * row_bytes).zip(tops) {
            let filled = self.filled(band, row_bytes, pitch)?;
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch as u32), rows_per_image: None };
            let from = wgpu::TexelCopyBufferInfo { buffer: &filled, layout };
            let to = wgpu::TexelCopyTextureInfo {
                texture,
                mip_level,
                origin: wgpu::Origin3d { x: first[0], y, z: 0 },
                aspect: wgpu::TextureAspect::All,
            };
            // Blocks are copied whole, also where the level ends within them.
            let height = (band.len() / row_bytes) as u32 * block_height;
            let width = width.next_multiple_of(block_width);
            let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
            self.upload("writing a texture", |encoder| encoder.copy_buffer_to_texture(from, to, size))?;
        }
        Ok(())
    }

    /// Writes a whole level of a block, layer by layer, row by row, before the next submission runs. Errors: as
    /// [`Self::write_texels`].
    pub(in crate::gpu) fn write_block(
        &self,
        (texture, mip_level): (&wgpu::Texture, u32),
        [width, height, layers]: [u32; 3],
        row_bytes: usize,
        data: &[u8],
    ) -> Result<()> {
        let pitch = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let filled = self.filled(data, row_bytes, pitch)?;
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch as u32), rows_per_image: Some(height) };
        let from = wgpu::TexelCopyBufferInfo { buffer: &filled, layout };
        let (origin, aspect) = (wgpu::Origin3d::ZERO, wgpu::TextureAspect::All);
        let to = wgpu::TexelCopyTextureInfo { texture, mip_level, origin, aspect };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers };
        self.upload("writing a block", |encoder| encoder.copy_buffer_to_texture(from, to, size))
    }

    /// A buffer that holds the rows of `data` `pitch` bytes apart, to copy from.
    fn filled(&self, data: &[u8], row_bytes: usize, pitch: usize) -> Result<wgpu::Buffer> {
        let rows = data.chunks(row_bytes.max(1));
        let descriptor = wgpu::BufferDescriptor {
            label: Some("upload"),
            size: (rows.len() * pitch) as u64,
            usage: wgpu::BufferUsages::MAP_WRITE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: true,
        };
        let buffer = self.scoped("an upload", |device| device.create_buffer(&descriptor))?;
        let failed = |error| self.explain(Error::internal(format!("mapping an upload: {error}")));
        let mut view = buffer.get_mapped_range_mut(..).map_err(failed)?;
        self.while_it_exists(&buffer, || {
            for (row, begin) in rows.zip((0..).step_by(pitch.max(1))) {
                view.slice(begin..begin + row.len()).copy_from_slice(row);
            }
            Ok(())
        })?;
        drop(view);
        self.scoped("an upload", |_| buffer.unmap())?;
        Ok(buffer)
    }

    fn upload(&self, what: &str, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<()> {
        // Messages wait until the uploads are free.
        let _holding = hold();
        let mut uploads = self.uploads.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let encoder = match uploads.take() {
            Some(encoder) => encoder,
            None => self.encoder("uploads")?,
        };
        let encoder = uploads.insert(encoder);
        self.scoped(what, |_| record(encoder))
    }
}
