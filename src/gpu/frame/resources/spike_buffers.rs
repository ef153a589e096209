// SPDX-License-Identifier: MIT OR Apache-2.0
//! The memory of light that is thrown along lines: the lines, the light of one as it is spread, and the sums of the
//! finest grid. What goes where, and why, is in src/film/bloom/spikes.rs. Knows no kernels.

use super::cached_uniform::CachedUniform;
use crate::error::{Error, Result};
use crate::film::bloom::{SpikeLine, Spikes};
use crate::gpu::device::buffer::{Buffer, uniform_stride};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::{LIGHT, TextureKind};
use wgpu::BufferUsages as Usage;

/// Bytes of the light that a line gives an element.
const ELEMENT_BYTES: u64 = 16;

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    use crate::gpu::kernel::layout::layout;
    layout!(SpikeLine as "SpikeLine": weights, decays, tail_x = tails + 0, tail_y = tails + 16, along, across, slope,
        steep, step, elements, first_row, rows, next_along, next_across, share, above)
}

pub struct SpikeResources {
    /// A `SpikeLine` for each, `uniform_stride` apart.
    lines: CachedUniform,
    /// The light of a line.
    pub sheared: Buffer,
    bytes: u64,
    /// The light that the grid spreads after a line, by turns.
    sums: [Texture; 2],
}

impl SpikeResources {
    /// Room for the lines over a grid of `cells`.
    pub fn new(device: &Device, spikes: &Spikes, cells: [u32; 2]) -> Result<Self> {
        let TextureKind { format, dimension } = LIGHT;
        let sum = || device.texture("light with spikes", format, dimension, cells, 1);
        let bytes = ELEMENT_BYTES * spikes.memory();
        let lines = spikes.lines.len() as u64 * uniform_stride::<SpikeLine>(device);
        Ok(Self {
            lines: CachedUniform::new(device, "lines of spikes", lines)?,
            sheared: device.buffer("light of a line", bytes, Usage::STORAGE)?,
            bytes,
            sums: [sum()?, sum()?],
        })
    }

    /// Whether this is what `new` would make. Grids of the same size are for the caller to see to.
    pub fn serves(&self, device: &Device, spikes: &Spikes) -> bool {
        let lines = spikes.lines.len() as u64 * uniform_stride::<SpikeLine>(device);
        self.bytes == ELEMENT_BYTES * spikes.memory() && self.lines.buffer().size() == lines
    }

    /// Before a submission that spreads light.
    pub fn write(&mut self, device: &Device, spikes: &Spikes) -> Result<()> {
        let stride = uniform_stride::<SpikeLine>(device) as usize;
        let mut bytes = vec![0; spikes.lines.len() * stride];
        for (slot, line) in bytes.chunks_exact_mut(stride).zip(&spikes.lines) {
            slot[..size_of::<SpikeLine>()].copy_from_slice(bytemuck::bytes_of(line));
        }
        self.lines.write(device, &bytes)
    }

    pub fn forget(&mut self) {
        self.lines.forget();
    }

    /// A line, which each dispatch chooses.
    pub fn line(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.lines.buffer(),
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<SpikeLine>() as u64),
        })
    }

    /// The light that the grid spreads after line `index`.
    pub fn sum_after(&self, index: usize) -> &Texture {
        let [even, odd] = &self.sums;
        if index.is_multiple_of(2) { even } else { odd }
    }

    /// The light that the grid spreads after all lines.
    pub fn sum(&self, spikes: &Spikes) -> Result<&Texture> {
        let last = spikes.lines.len().checked_sub(1).ok_or_else(|| Error::internal("spikes without a line"))?;
        Ok(self.sum_after(last))
    }
}
