// SPDX-License-Identifier: MIT OR Apache-2.0
//! Textures on a device, which counts their bytes while they exist.

use super::wgpu_device::Device;
use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The format and the dimension with which a kernel declares a texture.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct TextureKind {
    pub format: wgpu::TextureFormat,
    pub dimension: wgpu::TextureViewDimension,
}

/// The texture that is copied to a window. Its 8-bit values are display codes already: no transfer function is applied.
pub const SCREEN: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba8Unorm, dimension: wgpu::TextureViewDimension::D2 };

/// A texture and its view, whose bytes [`Device::bytes`] counts until it is dropped.
pub struct Texture {
    pub view: wgpu::TextureView,
    raw: wgpu::Texture,
    bytes: u64,
    total: Arc<AtomicU64>,
}

impl Device {
    /// A texture that kernels write and read. `size` is columns and rows; `layers` is 1 unless `dimension` is an array.
    /// Errors: as [`Device::scoped`].
    pub fn texture(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        dimension: wgpu::TextureViewDimension,
        size: [u32; 2],
        layers: u32,
    ) -> Result<Texture> {
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        self.any_texture(label, format, dimension, size, [layers, 1], usage)
    }

    /// The texture that a window is filled from: `host_fills` it ([`Device::write_rows`]), or kernels do. Errors: as
    /// [`Device::scoped`].
    pub fn screen(&self, size: [u32; 2], host_fills: bool) -> Result<Texture> {
        let TextureKind { format, dimension } = SCREEN;
        match host_fills {
            true => self.table("screen", format, size),
            false => self.texture("screen", format, dimension, size, 1),
        }
    }

    /// A texture that the host fills ([`Device::write_rows`]) and kernels read. Errors: as [`Device::scoped`].
    pub fn table(&self, label: &str, format: wgpu::TextureFormat, size: [u32; 2]) -> Result<Texture> {
        self.table_of_levels(label, format, size, 1)
    }

    /// A texture that the host fills, with `levels`, each of half the columns and rows of the one before, rounded down,
    /// but at least one ([`Device::write_part`]). Errors: as [`Device::scoped`].
    pub fn table_of_levels(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        levels: u32,
    ) -> Result<Texture> {
        let usage = wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING;
        self.any_texture(label, format, wgpu::TextureViewDimension::D2, size, [1, levels], usage)
    }

    /// A block of texels that the host fills ([`Self::write_level`]) and kernels read, with `levels`, of which each has
    /// half the sides of the one before, rounded down, but 1 at least. Errors: as [`Device::scoped`].
    pub fn block(&self, label: &str, kind: TextureKind, sides: [u32; 3], levels: u32) -> Result<Texture> {
        let [width, height, layers] = sides;
        let usage = wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING;
        self.any_texture(label, kind.format, kind.dimension, [width, height], [layers, levels], usage)
    }

    /// `layers`: of an array, or the third side of a block. Errors: as [`Device::scoped`].
    pub(in crate::gpu) fn any_texture(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        dimension: wgpu::TextureViewDimension,
        [width, height]: [u32; 2],
        [layers, levels]: [u32; 2],
        usage: wgpu::TextureUsages,
    ) -> Result<Texture> {
        let solid = dimension == wgpu::TextureViewDimension::D3;
        // Kept bind groups hold textures that this one may replace, and both together need not fit in memory.
        self.bindings.clear();
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers };
        let (raw, view) = self.scoped(label, |device| {
            let raw = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size,
                mip_level_count: levels,
                sample_count: 1,
                dimension: if solid { wgpu::TextureDimension::D3 } else { wgpu::TextureDimension::D2 },
                format,
                usage,
                view_formats: &[],
            });
            let view = wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() };
            (raw.clone(), raw.create_view(&view))
        })?;
        let (block_width, block_height) = format.block_dimensions();
        let texels = |level: u32| {
            let [width, height] = [(width, block_width), (height, block_height)]
                .map(|(side, block)| u64::from((side >> level).max(1).div_ceil(block)));
            width * height * u64::from(if solid { (layers >> level).max(1) } else { layers })
        };
        let bytes = texel_bytes(format) * (0..levels).map(texels).sum::<u64>();
        let total = self.byte_count();
        total.fetch_add(bytes, Ordering::Relaxed);
        Ok(Texture { view, raw, bytes, total })
    }

    /// Writes whole rows from `first_row` on, before the next submission runs. Errors: INTERNAL when `data` is not a
    /// whole number of rows; as [`Device::scoped`].
    pub fn write_rows(&self, texture: &Texture, first_row: u32, data: &[u8]) -> Result<()> {
        self.write_part(texture, 0, [0, first_row], texture.raw.width(), data)
    }

    /// Writes a whole level of a block, whose sides are `sides`, layer by layer, row by row, before the next submission
    /// runs. Errors: INTERNAL when `data` is of another size; as [`Device::scoped`].
    pub fn write_level(&self, texture: &Texture, level: u32, sides: [u32; 3], data: &[u8]) -> Result<()> {
        let row_bytes = sides[0] as usize * texel_bytes(texture.raw.format()) as usize;
        let rows = sides[1] as usize * sides[2] as usize;
        if row_bytes == 0 || data.len() != rows * row_bytes {
            let size = data.len();
            return Err(Error::internal(format!("{size} bytes are not {rows} rows of {row_bytes} bytes")));
        }
        self.write_block((&texture.raw, level), sides, row_bytes, data)
    }

    /// Writes a rectangle of `width` columns of a level, whose first texel is `first` (column, row); the length of
    /// `data` decides its rows, which are of blocks in formats that have them. Errors: as [`Self::write_rows`].
    pub fn write_part(&self, texture: &Texture, level: u32, first: [u32; 2], width: u32, data: &[u8]) -> Result<()> {
        let format = texture.raw.format();
        let row_bytes = width.div_ceil(format.block_dimensions().0) * texel_bytes(format) as u32;
        if row_bytes == 0 || !data.len().is_multiple_of(row_bytes as usize) {
            let size = data.len();
            return Err(Error::internal(format!("{size} bytes are not a whole number of rows of {row_bytes} bytes")));
        }
        self.write_texels((&texture.raw, level), first, width, row_bytes as usize, data)
    }
}

/// Bytes of a texel, or of a block.
fn texel_bytes(format: wgpu::TextureFormat) -> u64 {
    // None only for formats without one texel size (combined depth and stencil, planar), which bhr does not make.
    format.block_copy_size(None).unwrap_or(0).into()
}

impl Texture {
    /// The texture itself, which then lives longer than its count of bytes; for commands under way.
    pub fn clone_raw(&self) -> wgpu::Texture {
        self.raw.clone()
    }

    /// Columns and rows, in texels.
    pub fn size(&self) -> [u32; 2] {
        [self.raw.width(), self.raw.height()]
    }
}

impl Drop for Texture {
    fn drop(&mut self) {
        self.total.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}
