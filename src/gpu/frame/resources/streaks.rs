// SPDX-License-Identifier: MIT OR Apache-2.0
//! The streaks of the disk's turbulence as a texture, made when a scene first shows them.

use crate::emit::streaks::{STREAK_COLUMNS, STREAK_LAST, STREAK_ROWS, Streaks};
use crate::error::Result;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::STREAKS;
use crate::scene::Scene;

pub struct StreakTexture {
    /// One texel until a scene shows them.
    texture: Texture,
    made: bool,
    /// Linear between texels, one level at a time; beyond a side the other one follows.
    repeating: wgpu::Sampler,
}

impl StreakTexture {
    pub fn new(device: &Device) -> Result<Self> {
        let (filter, address) = (wgpu::FilterMode::Linear, wgpu::AddressMode::Repeat);
        let sampler = wgpu::SamplerDescriptor {
            address_mode_u: address,
            address_mode_v: address,
            mag_filter: filter,
            min_filter: filter,
            ..Default::default()
        };
        Ok(Self {
            texture: device.table("no streaks", STREAKS.format, [1, 1])?,
            made: false,
            repeating: device.scoped("streaks", |device| device.create_sampler(&sampler))?,
        })
    }

    /// Makes the texture if the scene is the first to show it. Errors: as [`Device::scoped`]; it is then made when it
    /// is needed next.
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        if self.made || !scene.emitters().needs().places {
            return Ok(());
        }
        let size = [STREAK_COLUMNS as u32, STREAK_ROWS as u32];
        let texture = device.table_of_levels("streaks", STREAKS.format, size, STREAK_LAST as u32 + 1)?;
        for (level, number) in Streaks::shared()?.levels().zip(0..) {
            let ([columns, _], texels) = level?;
            let words = texels.iter().map(|pair| pair.map(half::f16::to_bits)).collect::<Vec<_>>();
            device.write_part(&texture, number, [0, 0], columns, bytemuck::cast_slice(&words))?;
        }
        (self.texture, self.made) = (texture, true);
        Ok(())
    }

    /// The texture and its sampler.
    pub fn resources(&self) -> [wgpu::BindingResource<'_>; 2] {
        [wgpu::BindingResource::TextureView(&self.texture.view), wgpu::BindingResource::Sampler(&self.repeating)]
    }
}
