//! Textures on a device: counted while they exist, like buffers.

use super::device::Device;
use crate::error::Result;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A texture view whose bytes [`Device::bytes`] counts until it is dropped.
pub struct Texture {
    pub view: wgpu::TextureView,
    bytes: u64,
    total: Arc<AtomicU64>,
}

impl Device {
    /// A 2-D texture, of `layers` layers if `dimension` is an array, that kernels write and read.
    /// Errors: as [`Device::scoped`].
    pub fn texture(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        dimension: wgpu::TextureViewDimension,
        [width, height]: [u32; 2],
        layers: u32,
    ) -> Result<Texture> {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers };
        let view = self.scoped(label, |device| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() })
        })?;
        let texel = u64::from(format.block_copy_size(None).unwrap_or(16));
        let bytes = texel * u64::from(width) * u64::from(height) * u64::from(layers);
        let total = self.byte_count();
        total.fetch_add(bytes, Ordering::Relaxed);
        Ok(Texture { view, bytes, total })
    }
}

impl Drop for Texture {
    fn drop(&mut self) {
        self.total.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}
