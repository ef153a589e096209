// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tables of a spin-0 lens on the device: built by compute passes when the observer's radius has changed, read by
//! lens/schwarzschild_record.wgsl. Knows observers and kernels, no scene.

use crate::error::{Error, Result};
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::choices::Choice;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::gpu::kernel::sizes::{SCHWARZSCHILD_INTERVALS, SCHWARZSCHILD_OCTAVES, SCHWARZSCHILD_PER_OCTAVE};
use crate::gpu::kernel::slots::{LENS_COLUMNS, LENS_ROWS, TextureKind};
use crate::gpu::kernel::stage::Stage;
use crate::gpu::kernel::variant::LENS_GROUP;
use crate::physics::observer::{LocalFrame, Observer};
use crate::physics::shadow::shadow;
use crate::recent::Recent;
use bytemuck::{Pod, Zeroable};
use wgpu::BufferUsages as Usage;

/// Nodes beyond the last place that is looked up.
const MARGIN: f64 = 4.0;
/// Observers further in have no captured ray that meets a disk.
const INNER_BRANCH_FROM: f64 = 6.0;
const BRANCHES: u32 = 2;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(in crate::gpu) struct SchwarzschildUniform {
    critical: [f32; 4],
    separatrix: f32,
    slope: f32,
    nodes: [u32; 2],
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(SchwarzschildUniform as "SchwarzschildLens": critical, separatrix, slope,
        outer_nodes = nodes + 0, inner_nodes = nodes + 4)
}

impl SchwarzschildUniform {
    pub(in crate::gpu) fn new(frame: &LocalFrame) -> Self {
        let u = 1.0 / frame.r;
        let psi = shadow(&Observer::at_rest(*frame)).radius;
        let half = (0.5 * psi).tan();
        let w = half.min(1.0 / half);
        // e0 = 2 (1/3 - u) / (1 + sqrt(2 u + 1/3))^2
        let q = (2.0 * u + 1.0 / 3.0).sqrt();
        let separatrix = 2.0 * (1.0 / 3.0 - u) / ((1.0 + q) * (1.0 + q));
        let slope = if frame.rain { 1.0 } else { (1.0 - 2.0 * u).max(0.0).sqrt() };
        let nodes =
            |t_hat: f64| (SCHWARZSCHILD_PER_OCTAVE * (t_hat.log2() + SCHWARZSCHILD_OCTAVES) + MARGIN).ceil() as u32;
        let inner = if frame.r > INNER_BRANCH_FROM { nodes(half / w) } else { 0 };
        Self {
            critical: [half as f32, psi.sin() as f32, psi.cos() as f32, w as f32],
            separatrix: separatrix as f32,
            slope: slope as f32,
            nodes: [nodes(1.0 / (half * w)), inner],
        }
    }
}

/// Everything that decides the tables' content.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SchwarzschildKey {
    r: f64,
    rain: bool,
    delay: bool,
}

/// The tables, of several observers by turns; made when first needed.
#[derive(Default)]
pub struct SchwarzschildTables {
    kept: Recent<SchwarzschildKey, SchwarzschildResources>,
}

struct SchwarzschildResources {
    nodes: u32,
    delay: bool,
    uniform: Buffer,
    ends: Texture,
    swept: Texture,
    u: Texture,
    delays: Texture,
}

/// The passes that fill tables.
pub struct SchwarzschildStages {
    find_ends: Stage,
    fill_columns: Stage,
    groups: [u32; 2],
}

impl SchwarzschildTables {
    /// Brings the tables up to the observer; the stages to run before they are read, `None` if they are as needed
    /// already. `frame_uniform` holds the observer.
    pub fn update(
        &mut self,
        device: &Device,
        kernels: &Kernels,
        frame: &LocalFrame,
        delay: bool,
        frame_uniform: wgpu::BindingResource<'_>,
    ) -> Result<Option<SchwarzschildStages>> {
        // Tables with delays do not serve frames without: another kernel fills them, which may round otherwise.
        let key = SchwarzschildKey { r: frame.r, rain: frame.rain, delay };
        if self.kept.find(&key) {
            return Ok(None);
        }
        let uniform = SchwarzschildUniform::new(frame);
        let nodes = uniform.nodes[0].max(uniform.nodes[1]);
        // Frees the old tables before making new ones, unless they are large enough.
        let serves = |m: &SchwarzschildResources| m.nodes >= nodes && (m.delay || !delay);
        let resources = match self.kept.make_room(&key).filter(serves) {
            Some(resources) => resources,
            None => SchwarzschildResources::new(device, nodes, delay)?,
        };
        device.write(&resources.uniform, 0, bytemuck::bytes_of(&uniform))?;
        let view = |texture: &Texture| texture.view.clone();
        let (ends, swept, u, delays) =
            (view(&resources.ends), view(&resources.swept), view(&resources.u), view(&resources.delays));
        let texture = wgpu::BindingResource::TextureView;
        let lens = resources.uniform.as_entire_binding();
        let find_ends = kernels
            .get(KernelKind::SchwarzschildEnds)?
            .stage(device, &[&[frame_uniform.clone(), lens.clone(), texture(&ends)]])?;
        let fill_columns = kernels
            .get(KernelKey::new(KernelKind::SchwarzschildColumns, &[&[(Choice::DELAY, delay.into())]]))?
            .stage(device, &[&[frame_uniform, lens, texture(&ends), texture(&swept), texture(&u), texture(&delays)]])?;
        self.kept.put(key, resources);
        Ok(Some(SchwarzschildStages { find_ends, fill_columns, groups: [nodes.div_ceil(LENS_GROUP), BRANCHES] }))
    }

    /// After a submission that failed, nobody knows what the tables hold.
    pub fn forget(&mut self) {
        self.kept.clear();
    }

    /// Group 1 of a shading kernel, after the media.
    pub fn group(&self) -> Result<Vec<wgpu::BindingResource<'_>>> {
        let resources = self.kept.first().ok_or_else(|| Error::internal("a lens without tables"))?;
        let tables =
            [&resources.swept, &resources.u, &resources.delays].map(|t| wgpu::BindingResource::TextureView(&t.view));
        Ok([resources.uniform.as_entire_binding()].into_iter().chain(tables).collect())
    }
}

impl SchwarzschildResources {
    fn new(device: &Device, nodes: u32, delay: bool) -> Result<Self> {
        let texture = |kind: TextureKind, label: &str, size: [u32; 2]| {
            device.texture(label, kind.format, kind.dimension, size, BRANCHES)
        };
        let row = |label| device.texture(label, LENS_ROWS.format, LENS_ROWS.dimension, [nodes, BRANCHES], 1);
        let columns = [nodes, SCHWARZSCHILD_INTERVALS];
        Ok(Self {
            nodes,
            delay,
            uniform: device.buffer(
                "lens",
                size_of::<SchwarzschildUniform>() as u64,
                Usage::UNIFORM | Usage::COPY_DST,
            )?,
            ends: row("lens ends")?,
            swept: row("lens swept")?,
            u: texture(LENS_COLUMNS, "lens u", columns)?,
            delays: texture(LENS_COLUMNS, "lens delay", if delay { columns } else { [1, 1] })?,
        })
    }
}

impl SchwarzschildStages {
    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.find_ends.run(pass, None, self.groups);
        self.fill_columns.run(pass, None, self.groups);
    }
}
