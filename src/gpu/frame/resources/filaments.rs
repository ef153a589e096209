// SPDX-License-Identifier: MIT OR Apache-2.0
//! The filaments of matter with depth as a texture, from which its structure is made; when a scene first shows them.

use crate::emit::filaments::{FILAMENT_LAST, FILAMENT_SIDES, Filaments};
use crate::error::Result;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::FILAMENTS;

pub struct FilamentTexture {
    /// One texel until a scene shows them.
    texture: Texture,
    made: bool,
    /// Linear between texels and levels; beyond a side the other one follows.
    repeating: wgpu::Sampler,
}

impl FilamentTexture {
    pub fn new(device: &Device) -> Result<Self> {
        let (filter, address) = (wgpu::FilterMode::Linear, wgpu::AddressMode::Repeat);
        let sampler = wgpu::SamplerDescriptor {
            address_mode_u: address,
            address_mode_v: address,
            address_mode_w: address,
            mag_filter: filter,
            min_filter: filter,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        };
        Ok(Self {
            texture: device.block("no filaments", FILAMENTS, [1; 3], 1)?,
            made: false,
            repeating: device.scoped("filaments", |device| device.create_sampler(&sampler))?,
        })
    }

    /// Makes the texture, unless it is there. Errors: as [`Device::scoped`]; it is then made when it is needed next.
    pub fn make(&mut self, device: &Device) -> Result<()> {
        if self.made {
            return Ok(());
        }
        let sides = FILAMENT_SIDES.map(|side| side as u32);
        let texture = device.block("filaments", FILAMENTS, sides, FILAMENT_LAST as u32 + 1)?;
        for (level, number) in Filaments::shared()?.levels().zip(0..) {
            let (sides, texels) = level?;
            device.write_level(&texture, number, sides, bytemuck::cast_slice(&texels))?;
        }
        (self.texture, self.made) = (texture, true);
        Ok(())
    }

    /// The texture and its sampler.
    pub fn resources(&self) -> [wgpu::BindingResource<'_>; 2] {
        [wgpu::BindingResource::TextureView(&self.texture.view), wgpu::BindingResource::Sampler(&self.repeating)]
    }
}
