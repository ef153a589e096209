// SPDX-License-Identifier: MIT OR Apache-2.0
//! The distances of the host's things as a texture: made anew when the host gives others, and filled for each frame
//! from a target that the host shares. Knows no frames.

use crate::error::{Error, Result};
use crate::gpu::device::external::{TargetOrigin, TargetShape};
use crate::gpu::device::handover::TargetRead;
use crate::gpu::device::sharing::{GpuTarget, TargetResource};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::OCCLUDER;
use crate::image::PixelFormat;
use crate::scene::{Distances, Scene};
use std::sync::{Arc, Weak};

/// The copies of a target's distances into the texture.
pub struct Fetch {
    /// Into a buffer, by commands below wgpu.
    pub read: TargetRead,
    texture: wgpu::Texture,
}

impl Fetch {
    /// The copy from the buffer.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let TargetResource::Buffer(buffer) = &self.read.staged.resource else { return };
        let bytes_per_row = u32::try_from(self.read.staged.shape.row_stride).ok();
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
        let from = wgpu::TexelCopyBufferInfo { buffer, layout };
        encoder.copy_buffer_to_texture(from, self.texture.as_image_copy(), self.texture.size());
    }
}

pub struct OccluderTexture {
    /// One texel until a scene has an occluder.
    texture: Texture,
    /// The distances that it holds.
    held: Option<Weak<Vec<f32>>>,
    /// Between a target of the host's and the texture.
    staged: Option<Arc<GpuTarget>>,
}

impl OccluderTexture {
    pub fn new(device: &Device) -> Result<Self> {
        Ok(Self { texture: device.table("no occluder", OCCLUDER.format, [1, 1])?, held: None, staged: None })
    }

    /// Brings the texture up to the scene's occluder. Errors: UNSUPPORTED for one with a longer side than the device's
    /// textures have; as [`Device::scoped`].
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        let Some(occluder) = &scene.occluder else { return Ok(()) };
        // The weak pointer keeps the address from being given to others.
        if let Distances::Copied(distances) = &occluder.distances
            && self.held.as_ref().is_some_and(|held| std::ptr::eq(held.as_ptr(), Arc::as_ptr(distances)))
        {
            return Ok(());
        }
        let (size, limit) = ([occluder.width, occluder.height], device.limits().max_texture_dimension_2d);
        if size.iter().any(|side| *side > limit) {
            let [width, height] = size;
            let message = format!("the occluder is {width} x {height}; textures of this device have {limit} at most");
            return Err(Error::unsupported(message));
        }
        if self.texture.size() != size {
            self.texture = device.table("occluder", OCCLUDER.format, size)?;
        }
        self.held = None;
        match &occluder.distances {
            Distances::Copied(distances) => {
                self.staged = None;
                device.write_rows(&self.texture, 0, bytemuck::cast_slice(distances.as_slice()))?;
                self.held = Some(Arc::downgrade(distances));
            }
            Distances::OnDevice(_) => self.stage(device, size)?,
        }
        Ok(())
    }

    /// Makes room for what a target holds, in rows that a copy into a texture takes.
    fn stage(&mut self, device: &Device, size: [u32; 2]) -> Result<()> {
        if self.staged.as_ref().is_some_and(|staged| staged.shape.size == size) {
            return Ok(());
        }
        self.staged = None;
        let row_stride = u64::from((4 * size[0]).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
        let shape = TargetShape { image: false, format: PixelFormat::R32F, size, row_stride, layout: 0, handle: 0 };
        self.staged = Some(Arc::new(device.target(shape, TargetOrigin::New)?));
        Ok(())
    }

    /// The copies that a frame of the scene begins with; `None`: the texture is as it must be. Errors: INTERNAL.
    pub fn fetch(&self, scene: &Scene) -> Result<Option<Fetch>> {
        let Some(Distances::OnDevice(given)) = scene.occluder.as_ref().map(|occluder| &occluder.distances) else {
            return Ok(None);
        };
        let target = given.0.clone().downcast::<GpuTarget>();
        let target = target.map_err(|_| Error::internal("an occluder that is no target"))?;
        let staged = self.staged.clone().ok_or_else(|| Error::internal("an occluder without its buffer"))?;
        Ok(Some(Fetch { read: TargetRead { target, staged }, texture: self.texture.clone_raw() }))
    }

    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.texture.view)
    }
}
