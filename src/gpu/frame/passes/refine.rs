// SPDX-License-Identifier: MIT OR Apache-2.0
//! The second look at pixels that edges run through: the kernels that go over their list (records/edges.wgsl,
//! refine/refine.wgsl). Knows kernels and their groups, no records and no light.

use crate::error::Result;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::stage::{Stage, list_groups};
use crate::gpu::kernel::variant::{FilmVariant, RecordMaker, RecordSource, ShadeVariant, TraceVariant};

/// Pixels of a tile for each workgroup of a software driver where rays take many steps (`list_groups`): edges run
/// through 1 or 2 % of them, and a workgroup takes two or more at a time.
const PIXELS_PER_GROUP: u32 = 512;

/// The kernel over the list.
pub struct RefineStage {
    stage: Stage,
    software: bool,
    /// `PIXELS_PER_GROUP` where rays are integrated step by step, or matter is summed along them.
    stepped: Option<u32>,
}

impl RefineStage {
    /// `shared`: groups 0 and 1, and without `film` 2, as those of the kernels that shaded the pixels.
    pub fn new(
        device: &Device,
        kernels: &Kernels,
        (source, variant): (RecordSource, TraceVariant),
        (shade, film): (ShadeVariant, Option<FilmVariant>),
        shared: &[&[wgpu::BindingResource<'_>]],
        software: bool,
    ) -> Result<Self> {
        let stage = kernels.get(KernelKey::refine((source, variant), shade, film))?.stage(device, shared)?;
        let stepped = variant.matter.is_some() || source.maker == RecordMaker::Traced;
        Ok(Self { stage, software, stepped: stepped.then_some(PIXELS_PER_GROUP) })
    }

    /// After the pixels of `tile` have been shaded; group 3 is set, and 2, if that is for the caller. `offset`: of the
    /// sample's `PassUniform`.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, tile: [u32; 2]) {
        let groups = list_groups(tile, self.software, self.stepped);
        // Both lists, and then the pixels of the disk's edges that turned out to need the critical curve's samples.
        self.stage.run(pass, Some(offset), [groups, 2]);
        self.stage.run(pass, Some(offset), [groups, 1]);
    }
}
