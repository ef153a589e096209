// SPDX-License-Identifier: MIT OR Apache-2.0
//! The second look at pixels that edges run through: their list on the device, and the kernels that go over it
//! (records/edges.wgsl, refine/refine.wgsl). Knows kernels and their groups, no records and no light.

use super::tiles::MAX_BATCH;
use crate::error::{Error, Result};
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::{Kernels, Stage};
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::variant::{FilmVariant, RecordSource, RefineVariant, ShadeVariant, TraceVariant};
use wgpu::BufferUsages as Usage;

/// `Edges` of records/edges.wgsl: bytes before the pixels, two counts for each sample of a submission.
const HEAD: u64 = 8 * MAX_BATCH as u64;

/// Workgroups that share the list: as `DEFERRED_GROUPS` of stages.rs. Lavapipe ends all loops of a thread early once
/// they have gone round 65535 times (LP_MAX_TGSI_LOOP_ITERATIONS of Mesa 22.3), and rays through matter with depth need
/// thousands: there each group takes fewer pixels.
const GROUPS: u32 = 2048;
const GROUPS_SOFTWARE: u32 = 16;

/// The list; it grows and stays.
#[derive(Default)]
pub struct EdgeList {
    buffer: Option<Buffer>,
}

impl EdgeList {
    /// Bytes of a tile's pixel on the device. A pixel may be listed twice: at first as an edge of the disk and then as
    /// the critical curve's.
    pub const BYTES_PER_PIXEL: u64 = 2 * 4;

    /// Makes room for the pixels of a tile.
    pub fn prepare(&mut self, device: &Device, tile: [u32; 2]) -> Result<()> {
        let size = HEAD + u64::from(tile[0]) * u64::from(tile[1]) * Self::BYTES_PER_PIXEL;
        if self.buffer.as_ref().is_none_or(|b| b.size() < size) {
            self.buffer = None;
            self.buffer = Some(device.buffer("edges", size, Usage::STORAGE | Usage::COPY_DST)?);
        }
        Ok(())
    }

    /// Empties it.
    pub fn reset(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(buffer) = &self.buffer {
            encoder.clear_buffer(buffer, 0, Some(HEAD));
        }
    }

    /// As group 3 of the kernels that write and read it.
    pub fn group(&self, device: &Device, layout: &wgpu::BindGroupLayout) -> Result<wgpu::BindGroup> {
        let buffer = self.buffer.as_ref().ok_or_else(|| Error::internal("a list of edges without a buffer"))?;
        device.bind(layout, &[buffer.as_entire_binding()])
    }
}

/// The kernel over the list.
pub struct RefineStage {
    stage: Stage,
    groups: u32,
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
        let groups = match (software, variant.matter) {
            (true, None) => GROUPS_SOFTWARE,
            _ => GROUPS,
        };
        Ok(Self { stage, groups })
    }

    /// After the pixels of a tile have been shaded; group 3 is set, and 2, if that is for the caller. `offsets`: of
    /// the `PassUniform`s with `EDGE_SAMPLES` and with `CURVE_SAMPLES`: some of the disk's edges turn out to need the
    /// critical curve's samples.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offsets: [u32; 2]) {
        for offset in offsets {
            self.stage.run(pass, Some(offset), [self.groups, 1]);
        }
    }
}
