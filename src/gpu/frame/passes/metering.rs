// SPDX-License-Identifier: MIT OR Apache-2.0
//! Metering on the GPU: the passes that measure a frame's light once it has spread. What is measured, and why, is in
//! src/film/metering.rs. Knows light, not what makes it.

use crate::error::Result;
use crate::film::bloom::Bloom;
use crate::film::metering::MeterParams;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::resources::bloom_textures::BloomBuffers;
use crate::gpu::frame::resources::meter_buffers::MeterBuffers;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKind;
use crate::gpu::kernel::stage::Stage;

/// The passes of a metered frame.
pub struct MeterStages {
    measure: Stage,
    expose: Stage,
    /// `None`: no light is changed by its surroundings.
    smooth: Option<Stage>,
    blocks: [u32; 2],
    /// The exposure; its first bytes are the stops that are added.
    pub exposure: wgpu::Buffer,
}

impl MeterStages {
    pub fn new(
        device: &Device,
        kernels: &Kernels,
        meter: &MeterParams,
        (buffers, bloom_buffers, bloom): (&MeterBuffers, &BloomBuffers, &Bloom),
    ) -> Result<Self> {
        let resources = buffers.resources()?;
        let [cells, glare] = bloom_buffers.cells(bloom)?;
        let (counts, histogram) = (resources.counts.as_entire_binding(), resources.histogram.as_entire_binding());
        let measure = [resources.params(), cells, glare, counts.clone(), histogram.clone()];
        let expose = [resources.params(), histogram, resources.exposure.as_entire_binding()];
        let smoothed = wgpu::BindingResource::TextureView(&resources.smoothed.view);
        let smooth = [resources.params(), counts, smoothed];
        let stage = |kind: KernelKind, group: &[wgpu::BindingResource<'_>]| kernels.get(kind)?.stage(device, &[group]);
        Ok(Self {
            measure: stage(KernelKind::Measure, &measure)?,
            expose: stage(KernelKind::Expose, &expose)?,
            smooth: meter.is_local().then(|| stage(KernelKind::Smooth, &smooth)).transpose()?,
            blocks: meter.blocks,
            exposure: (*resources.exposure).clone(),
        })
    }

    /// Once all light has spread.
    pub fn measure(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.measure.run(pass, None, self.blocks);
        self.expose.run(pass, None, [1, 1]);
        if let Some(smooth) = &self.smooth {
            smooth.run(pass, None, self.blocks);
        }
    }
}
