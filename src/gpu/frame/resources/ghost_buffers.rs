// SPDX-License-Identifier: MIT OR Apache-2.0
//! The memory of a lens flare: its numbers, the ghosts as they are drawn, and the finest grid's light with them. What
//! goes where, and why, is in src/film/bloom/ghosts.rs. Knows no kernels.

use super::cached_uniform::CachedUniform;
use crate::error::Result;
use crate::film::bloom::{GhostNumbers, Ghosts};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::{LIGHT, TextureKind};

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 2] {
    use crate::film::bloom::Ghost;
    use crate::gpu::kernel::layout::layout;
    let ghost = layout!(Ghost as "Ghost": shares, apothems, magnification, softness, reach, reserved);
    let numbers = layout!(GhostNumbers as "GhostNumbers": ghosts, normals, tail_x = tails + 0, tail_y = tails + 16,
        middle, target_cells, source_cells, step, count, fine, above, reserved);
    [ghost, numbers]
}

pub struct GhostResources {
    numbers: CachedUniform,
    /// The light that reaches ghosts.
    pub reflected: Texture,
    /// The light of all ghosts.
    pub drawn: Texture,
    /// The light that the finest grid spreads, with theirs.
    pub sum: Texture,
}

impl GhostResources {
    /// Room for ghosts that are added to a grid of `cells`.
    pub fn new(device: &Device, ghosts: &Ghosts, cells: [u32; 2]) -> Result<Self> {
        let TextureKind { format, dimension } = LIGHT;
        let texture = |label: &str, size: [u32; 2]| device.texture(label, format, dimension, size, 1);
        Ok(Self {
            numbers: CachedUniform::new(device, "ghosts of a lens", size_of::<GhostNumbers>() as u64)?,
            reflected: texture("reflected light", ghosts.numbers.source_cells)?,
            drawn: texture("light of ghosts", ghosts.numbers.target_cells)?,
            sum: texture("light with ghosts", cells)?,
        })
    }

    /// Before a submission that draws them.
    pub fn write(&mut self, device: &Device, ghosts: &Ghosts) -> Result<()> {
        self.numbers.write(device, bytemuck::bytes_of(&ghosts.numbers))
    }

    pub fn forget(&mut self) {
        self.numbers.forget();
    }

    pub fn numbers(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.numbers.buffer(),
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<GhostNumbers>() as u64),
        })
    }
}
