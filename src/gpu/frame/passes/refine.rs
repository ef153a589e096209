// SPDX-License-Identifier: MIT OR Apache-2.0
//! The second look at pixels that edges run through: their list on the device, and the kernels that go over it
//! (records/edges.wgsl, refine/refine.wgsl). Knows kernels and their groups, no records and no light.

use crate::error::Result;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::tiles::MAX_BATCH;
use crate::gpu::kernel::kernels::{Kernels, Stage, list_groups};
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::variant::{FilmVariant, RecordSource, RefineVariant, ShadeVariant, TraceVariant};
use crate::gpu::lens::pixel_list::PixelList;

/// `Edges` of records/edges.wgsl: bytes before the pixels, two counts for each sample of a submission.
const HEAD: u64 = 8 * MAX_BATCH as u64;

/// Pixels of a tile for each workgroup of a software driver where matter is summed (`list_groups`): edges run through
/// 1 or 2 % of them, and a workgroup takes two or more at a time.
const PIXELS_PER_GROUP: u32 = 512;

/// The list; it grows and stays.
pub struct EdgeList(PixelList);

impl Default for EdgeList {
    fn default() -> Self {
        Self(PixelList::new("edges", HEAD, Self::BYTES_PER_PIXEL))
    }
}

impl EdgeList {
    /// Bytes of a tile's pixel on the device. A pixel may be listed twice: at first as an edge of the disk and then as
    /// the critical curve's.
    pub const BYTES_PER_PIXEL: u64 = 2 * 4;

    /// Makes room for the pixels of a tile.
    pub fn prepare(&mut self, device: &Device, tile: [u32; 2]) -> Result<()> {
        self.0.prepare(device, tile)
    }

    /// Empties it.
    pub fn reset(&self, encoder: &mut wgpu::CommandEncoder) {
        self.0.reset(encoder);
    }

    /// As group 3 of the kernels that write and read it.
    pub fn group(&self, device: &Device, layout: &wgpu::BindGroupLayout) -> Result<wgpu::BindGroup> {
        device.bind(layout, &[self.0.resource()?])
    }
}

/// The kernel over the list.
pub struct RefineStage {
    stage: Stage,
    software: bool,
    /// `PIXELS_PER_GROUP` where matter is summed along the rays.
    summed: Option<u32>,
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
        let stage =
            kernels.get(KernelKey::refine(RefineVariant { source, variant }, shade, film))?.stage(device, shared)?;
        Ok(Self { stage, software, summed: variant.matter.map(|_| PIXELS_PER_GROUP) })
    }

    /// After the pixels of `tile` have been shaded; group 3 is set, and 2, if that is for the caller. `offsets`: of
    /// the `PassUniform`s with `EDGE_SAMPLES` and with `CURVE_SAMPLES`: some of the disk's edges turn out to need the
    /// critical curve's samples.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offsets: [u32; 2], tile: [u32; 2]) {
        for offset in offsets {
            self.stage.run(pass, Some(offset), [list_groups(tile, self.software, self.summed), 1]);
        }
    }
}
