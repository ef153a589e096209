// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bloom on the GPU: the passes that spread a frame's light over its grids. What goes where, and why, is in
//! src/film/bloom.rs. Knows light, not what makes it.

use super::ghosts::GhostStages;
use super::spikes::SpikeStages;
use crate::error::{Error, Result};
use crate::film::bloom::Bloom;
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::kernel_list::gather_key;
use crate::gpu::frame::resources::bloom_textures::{
    BeamResources, BeamUniform, BloomBuffers, BloomResources, LevelUniform, view,
};
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKind;
use crate::gpu::kernel::stage::Stage;
use crate::tracer::Tile;

/// The passes of a frame's bloom.
pub struct BloomStages {
    /// From the finest grid on.
    gather: Vec<Stage>,
    /// To each grid but the last from the one above it.
    upsample: Vec<Stage>,
    sizes: Vec<[u32; 2]>,
    stride: u32,
    beam: Option<BeamStages>,
    ghosts: Option<GhostStages>,
    spikes: Option<SpikeStages>,
}

/// The passes that spread a grid's light by the beam.
struct BeamStages {
    level: usize,
    /// Along rows, and along columns.
    passes: [Stage; 2],
    stride: u32,
}

impl BloomBuffers {
    pub fn stages(&self, device: &Device, kernels: &Kernels, bloom: &Bloom) -> Result<BloomStages> {
        let resources = self.resources()?;
        let count = bloom.levels.len();
        let below = std::iter::once(&resources.light).chain(&resources.gathered);
        let gather = below.zip(&resources.gathered).take(count).enumerate().map(|(index, (finer, cells))| {
            let kernel = kernels.get(gather_key(bloom, index))?;
            kernel.stage(device, &[&[resources.level(), view(finer), resources.smooth(), view(cells)]])
        });
        let gather = gather.collect::<Result<Vec<_>>>()?;
        let mut upsample = Vec::new();
        for index in 0..count.saturating_sub(1) {
            // The last grid spreads what it gathered.
            let above =
                if index + 2 == count { resources.gathered.get(index + 1) } else { resources.spread.get(index + 1) };
            let all = resources.gathered.get(index).zip(above).zip(resources.spread.get(index));
            let ((finer, coarser), spread) = all.ok_or_else(|| Error::internal("bloom without its grids"))?;
            let group = [resources.level(), view(finer), view(coarser), resources.smooth(), view(spread)];
            upsample.push(kernels.get(KernelKind::Upsample)?.stage(device, &[&group])?);
        }
        let sizes = bloom.levels.iter().map(|level| level.size).collect();
        let beam = bloom.beam.as_ref().zip(resources.beam.as_ref());
        let beam = beam.map(|(beam, made)| resources.beam_stages(device, kernels, beam.level, made)).transpose()?;
        let ghosts = bloom.ghosts.as_ref().zip(resources.ghosts.as_ref()).map(|(ghosts, made)| {
            let source = resources.gathered.get(ghosts.source);
            let source = source.ok_or_else(|| Error::internal("ghosts without a grid"))?;
            let grids = [source, resources.glare_before_ghosts(bloom)?];
            GhostStages::new(device, kernels, made, grids, resources.smooth())
        });
        let ghosts = ghosts.transpose()?;
        let spikes = bloom.spikes.as_ref().zip(resources.spikes.as_ref()).map(|made| {
            let own = resources.gathered.first().ok_or_else(|| Error::internal("spikes without a grid"))?;
            SpikeStages::new(device, kernels, made, [own, resources.glare_before_spikes(bloom)?])
        });
        let spikes = spikes.transpose()?;
        let stride = uniform_stride::<LevelUniform>(device) as u32;
        Ok(BloomStages { gather, upsample, sizes, stride, beam, ghosts, spikes })
    }
}

impl BloomResources {
    fn beam_stages(
        &self,
        device: &Device,
        kernels: &Kernels,
        level: usize,
        made: &BeamResources,
    ) -> Result<BeamStages> {
        let spread = if level < self.spread.len() { self.spread.get(level) } else { self.gathered.get(level) };
        let cells = spread.ok_or_else(|| Error::internal("a beam without its grid"))?;
        let kernel = kernels.get(KernelKind::Beam)?;
        let uniform = || {
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: made.passes.buffer(),
                offset: 0,
                size: std::num::NonZeroU64::new(size_of::<BeamUniform>() as u64),
            })
        };
        let stage = |from: &Texture, to: &Texture| kernel.stage(device, &[&[uniform(), view(from), view(to)]]);
        let passes = [stage(cells, &made.rows)?, stage(&made.rows, cells)?];
        Ok(BeamStages { level, passes, stride: uniform_stride::<BeamUniform>(device) as u32 })
    }
}

impl BloomStages {
    /// Gathers cells of the finest grid.
    pub fn gather(&self, pass: &mut wgpu::ComputePass<'_>, cells: Tile) {
        if let Some(base) = self.gather.first() {
            base.dispatch(pass, 0, [cells.width, cells.height]);
        }
    }

    /// Once all of the finest grid is there.
    pub fn spread(&self, pass: &mut wgpu::ComputePass<'_>) {
        for ((stage, size), index) in self.gather.iter().zip(&self.sizes).zip(0..).skip(1) {
            stage.dispatch(pass, index * self.stride, *size);
        }
        self.spread_beam(pass, self.upsample.len());
        for (index, (stage, size)) in self.upsample.iter().zip(&self.sizes).enumerate().rev() {
            stage.dispatch(pass, (index as u32 + 1) * self.stride, *size);
            self.spread_beam(pass, index);
        }
        self.ghosts.iter().for_each(|ghosts| ghosts.draw(pass));
        self.spikes.iter().for_each(|spikes| spikes.spread(pass));
    }

    /// Spreads the light of a grid, which has all of it, if it is the beam's.
    fn spread_beam(&self, pass: &mut wgpu::ComputePass<'_>, index: usize) {
        let beam = self.beam.as_ref().filter(|beam| beam.level == index);
        if let Some((beam, size)) = beam.zip(self.sizes.get(index)) {
            for (stage, place) in beam.passes.iter().zip(0..) {
                stage.dispatch(pass, place * beam.stride, *size);
            }
        }
    }
}
