// SPDX-License-Identifier: MIT OR Apache-2.0
//! The nodes of the film's LUT as a texture, made anew when it is another one.

use crate::error::Result;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::LUT;
use crate::image::Lut;
use crate::scene::Scene;
use std::sync::{Arc, Weak};

pub struct LutTexture {
    /// Together with what it was made from.
    made: Option<(Weak<Lut>, Texture)>,
    /// One texel, bound in the place of a LUT that is not shown.
    nothing: Texture,
}

impl LutTexture {
    pub fn new(device: &Device) -> Result<Self> {
        Ok(Self { made: None, nothing: device.block("no LUT", LUT, [1; 3], 1)? })
    }

    /// Brings the texture up to the scene: that of a LUT which is not shown stays as long as the scene has it. Errors:
    /// as [`Device::scoped`]; it is then made when it is needed next.
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        let made_from = self.made.as_ref().map(|(lut, _)| lut.as_ptr());
        if made_from.is_some() && made_from != scene.film_lut.as_ref().map(Arc::as_ptr) {
            self.made = None;
            device.bindings.clear();
        }
        if let (Some(lut), None) = (scene.shown_lut(), &self.made) {
            let sides = [lut.side(); 3];
            let texture = device.block("LUT", LUT, sides, 1)?;
            device.write_level(&texture, 0, sides, bytemuck::cast_slice(lut.nodes()))?;
            self.made = Some((Arc::downgrade(lut), texture));
        }
        Ok(())
    }

    /// `film_lut` of film/lut.wgsl.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.made.as_ref().map_or(&self.nothing, |(_, texture)| texture).view
    }
}
