// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lens flare on the GPU: the passes that draw ghosts, and add them to what the finest grid spreads. Where they lie,
//! and why, is in src/film/bloom/ghosts.rs. Knows light, not what makes it.

use crate::error::Result;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::resources::bloom_textures::view;
use crate::gpu::frame::resources::ghost_buffers::GhostResources;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKind;
use crate::gpu::kernel::stage::Stage;

/// Cells of a workgroup that draws ghosts: bloom/ghosts.wgsl.
const DRAWN_CELLS: [u32; 2] = [8, 4];

pub struct GhostStages {
    reflect: Stage,
    draw: Stage,
    add: Stage,
    /// Sizes of the grids: the one whose light is reflected, the one on which ghosts are drawn, and the finest.
    sizes: [[u32; 2]; 3],
}

impl GhostStages {
    /// `source`: the grid whose light is reflected; `glare`: what the finest grid spreads without them.
    pub fn new(
        device: &Device,
        kernels: &Kernels,
        resources: &GhostResources,
        [source, glare]: [&Texture; 2],
        smooth: wgpu::BindingResource<'_>,
    ) -> Result<Self> {
        let (reflected, drawn) = (|| view(&resources.reflected), || view(&resources.drawn));
        let reflect = [resources.numbers(), view(source), reflected()];
        let draw = [resources.numbers(), reflected(), drawn()];
        let add = [resources.numbers(), view(glare), drawn(), smooth, view(&resources.sum)];
        Ok(Self {
            reflect: kernels.get(KernelKind::ReflectLight)?.stage(device, &[&reflect])?,
            draw: kernels.get(KernelKind::DrawGhosts)?.stage(device, &[&draw])?,
            add: kernels.get(KernelKind::AddGhosts)?.stage(device, &[&add])?,
            sizes: [resources.reflected.size(), resources.drawn.size(), resources.sum.size()],
        })
    }

    /// Once all grids have their light, and the finest has what it spreads without ghosts.
    pub fn draw(&self, pass: &mut wgpu::ComputePass<'_>) {
        let [source, drawn, finest] = self.sizes;
        self.reflect.dispatch(pass, 0, source);
        self.draw.run(pass, Some(0), [0, 1].map(|side| drawn[side].div_ceil(DRAWN_CELLS[side])));
        self.add.dispatch(pass, 0, finest);
    }
}
