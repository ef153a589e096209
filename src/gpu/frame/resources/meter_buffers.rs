// SPDX-License-Identifier: MIT OR Apache-2.0
//! The buffers of metering: how a frame is measured, the counts of its light, and the exposure that they gave, which
//! stays for the next frame of its size. What is counted, and why, is in src/film/metering.rs. Knows no kernels.

use super::cached_uniform::CachedUniform;
use crate::error::{Error, Result};
use crate::film::metering::{BLOCK_STOPS, METER_BINS, MeterParams};
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::{METER_BLOCKS, TextureKind};
use bytemuck::{Pod, Zeroable};
use wgpu::BufferUsages as Usage;

/// `Exposure` of metering/exposure.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct ExposureState {
    stops: f32,
    measured: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 2] {
    use crate::gpu::kernel::layout::layout;
    let params = layout!(MeterParams as "MeterParams": cells, blocks, side, own, above, strength, percentile, aim,
        least, most, adaptation, highlights, shadows, per_pixel);
    [params, layout!(ExposureState as "Exposure": stops, measured)]
}

/// The buffers that metered frames of one size share.
#[derive(Default)]
pub struct MeterBuffers {
    resources: Option<MeterResources>,
}

pub struct MeterResources {
    /// The size of the finest grid, in cells.
    cells: [u32; 2],
    params: CachedUniform,
    /// Counts of each block by stop, of the frame by bin.
    pub counts: Buffer,
    pub histogram: Buffer,
    /// An [`ExposureState`].
    pub exposure: Buffer,
    /// The counts of blocks, smoothed.
    pub smoothed: Texture,
}

impl MeterResources {
    fn new(device: &Device, meter: &MeterParams) -> Result<Self> {
        let blocks = u64::from(meter.blocks[0]) * u64::from(meter.blocks[1]);
        let storage = |label: &str, bytes: u64, usage| device.buffer(label, bytes, Usage::STORAGE | usage);
        let TextureKind { format, dimension } = METER_BLOCKS;
        Ok(Self {
            cells: meter.cells,
            params: CachedUniform::new(device, "metering", size_of::<MeterParams>() as u64)?,
            counts: storage("counts of blocks", 8 * BLOCK_STOPS as u64 * blocks, Usage::empty())?,
            histogram: storage("histogram of light", 4 * METER_BINS as u64, Usage::empty())?,
            exposure: storage("exposure", size_of::<ExposureState>() as u64, Usage::COPY_SRC)?,
            smoothed: device.texture("smoothed blocks", format, dimension, meter.blocks, BLOCK_STOPS as u32)?,
        })
    }

    pub fn params(&self) -> wgpu::BindingResource<'_> {
        self.params.buffer.as_entire_binding()
    }
}

impl MeterBuffers {
    pub fn resources(&self) -> Result<&MeterResources> {
        self.resources.as_ref().ok_or_else(|| Error::internal("a metered frame without buffers"))
    }

    /// Makes room, and writes how a frame is measured. Errors: as [`Device::buffer`].
    pub fn prepare(&mut self, device: &Device, meter: &MeterParams) -> Result<()> {
        if self.resources.as_ref().is_none_or(|resources| resources.cells != meter.cells) {
            self.resources = None;
        }
        let resources = match &mut self.resources {
            Some(resources) => resources,
            none => none.insert(MeterResources::new(device, meter)?),
        };
        resources.params.write(device, bytemuck::bytes_of(meter))
    }

    /// After a submission that failed, nobody knows what the buffers hold.
    pub fn forget(&mut self) {
        self.resources = None;
    }

    /// The part of group 1 of development before the sampler that ends it.
    pub fn group(&self) -> Result<[wgpu::BindingResource<'_>; 3]> {
        let resources = self.resources()?;
        let smoothed = wgpu::BindingResource::TextureView(&resources.smoothed.view);
        Ok([resources.params(), resources.exposure.as_entire_binding(), smoothed])
    }
}
