// SPDX-License-Identifier: MIT OR Apache-2.0
//! The distances of the host's things as a texture, made anew when the host gives others. Knows no frames.

use crate::error::{Error, Result};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::OCCLUDER;
use crate::scene::Scene;
use std::sync::{Arc, Weak};

pub struct OccluderTexture {
    /// One texel until a scene has an occluder.
    texture: Texture,
    /// The distances that it holds.
    held: Option<Weak<Vec<f32>>>,
}

impl OccluderTexture {
    pub fn new(device: &Device) -> Result<Self> {
        Ok(Self { texture: device.table("no occluder", OCCLUDER.format, [1, 1])?, held: None })
    }

    /// Brings the texture up to the scene's occluder. Errors: UNSUPPORTED for one with a longer side than the device's
    /// textures have; as [`Device::scoped`].
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        let Some(occluder) = &scene.occluder else { return Ok(()) };
        // The weak pointer keeps the address from being given to others.
        if self.held.as_ref().is_some_and(|held| std::ptr::eq(held.as_ptr(), Arc::as_ptr(&occluder.distances))) {
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
        device.write_rows(&self.texture, 0, bytemuck::cast_slice(occluder.distances.as_slice()))?;
        self.held = Some(Arc::downgrade(&occluder.distances));
        Ok(())
    }

    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.texture.view)
    }
}
