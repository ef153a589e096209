// SPDX-License-Identifier: MIT OR Apache-2.0
//! Spikes on the GPU: the passes that throw the finest grid's light along lines. What is spread, and how, is in
//! src/film/bloom/spikes.rs. Knows light, not what makes it.

use crate::error::Result;
use crate::film::bloom::{SpikeLine, Spikes};
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::resources::bloom_textures::view;
use crate::gpu::frame::resources::spike_buffers::SpikeResources;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKind;
use crate::gpu::kernel::stage::Stage;

/// The passes of all lines.
pub struct SpikeStages {
    lines: Vec<LineStages>,
    cells: [u32; 2],
    stride: u32,
}

struct LineStages {
    spread: Stage,
    rows: u32,
    add: Stage,
}

impl SpikeStages {
    /// `own`: the light of the grid's cells; `glare`: what the grid spreads before the first line.
    pub fn new(
        device: &Device,
        kernels: &Kernels,
        (spikes, resources): (&Spikes, &SpikeResources),
        [own, glare]: [&Texture; 2],
    ) -> Result<Self> {
        let lines = spikes.lines.iter().enumerate().map(|(index, line)| {
            let sheared = || resources.sheared.as_entire_binding();
            let before = index.checked_sub(1).map_or(glare, |before| resources.sum_after(before));
            let spread = [resources.line(), view(own), sheared()];
            let add = [resources.line(), view(before), sheared(), view(resources.sum_after(index))];
            Ok(LineStages {
                spread: kernels.get(KernelKind::SpreadLine)?.stage(device, &[&spread])?,
                rows: line.rows,
                add: kernels.get(KernelKind::AddLine)?.stage(device, &[&add])?,
            })
        });
        let stride = uniform_stride::<SpikeLine>(device) as u32;
        Ok(Self { lines: lines.collect::<Result<_>>()?, cells: own.size(), stride })
    }

    /// Once the grid has all its light, and what it spreads but for the lines.
    pub fn spread(&self, pass: &mut wgpu::ComputePass<'_>) {
        for (line, index) in self.lines.iter().zip(0..) {
            line.spread.run(pass, Some(index * self.stride), [line.rows, 1]);
            line.add.dispatch(pass, index * self.stride, self.cells);
        }
    }
}
