// SPDX-License-Identifier: MIT OR Apache-2.0
//! The kernels of a frame with what they bind, from records to pixels, and the order in which a tile goes through
//! them. Knows no submissions.

use super::bloom::BloomStages;
use super::metering::MeterStages;
use super::refine::RefineStage;
use crate::error::{Error, Result};
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::setup::{FrameTarget, Setup};
use crate::gpu::frame::plan::steps::Step;
use crate::gpu::frame::plan::target_rows::{FrameRows, TilePlace};
use crate::gpu::frame::resources::cached_uniform::CachedUniform;
use crate::gpu::frame::resources::frame_buffers::FrameBuffers;
use crate::gpu::frame::resources::staging_layout::PIXELS;
use crate::gpu::frame::resources::tables::Tables;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::stage::{Compiled, Stage};
use crate::gpu::kernel::variant::RecordSource;
use crate::gpu::lens::records::{RecordSetup, RecordStages};
use crate::gpu::lens::traced::{Shared, structure_group};
use crate::tracer::Tile;
use std::slice;

/// Workgroups that share the deferred pixels: enough for a large GPU's few thousand, and on a software driver, where
/// each costs its share of a loop's body however little there is to do, few.
const DEFERRED_GROUPS: u32 = 512;
const DEFERRED_GROUPS_SOFTWARE: u32 = 16;

/// A kernel that takes records: over all pixels, and over those that it deferred.
pub struct RecordConsumer {
    all: Stage,
    deferred: Option<Stage>,
    /// Workgroups over the deferred pixels, however many they are.
    deferred_groups: u32,
}

/// The kernels that shade a sample: of all pixels, and then more rays of those that were listed for their edges.
struct ShadeStages {
    consumer: RecordConsumer,
    refining: Option<RefineStage>,
}

/// The stages that turn ray records into packed pixels.
enum Shading {
    /// There is no picture.
    Nothing,
    /// The stage for the only sample.
    Only(ShadeStages),
    Samples {
        /// The stages for even and for odd samples.
        shade: Box<[ShadeStages; 2]>,
        /// After an even and after an odd last sample.
        develop: [Stage; 2],
    },
}

/// The kernels of a frame, from its records to its pixels.
pub struct Stages {
    records: RecordStages,
    shading: Shading,
    /// Group 3 of the kernels that shade: the list of pixels with edges.
    edges: wgpu::BindGroup,
    /// `None`: there is no picture.
    pub output: Option<PixelOutput>,
    /// In frames with bloom: what follows shading, which then writes light.
    pub glare: Option<GlareStages>,
}

/// The stages that spread light and turn it into pixels.
pub struct GlareStages {
    pub bloom: BloomStages,
    /// `None`: the frame is not metered.
    pub meter: Option<MeterStages>,
    pub develop: Stage,
    pub output: PixelOutput,
}

/// Group 2 of a kernel that writes pixels, or light.
pub enum PixelOutput {
    /// In the same place in every submission.
    Fixed(wgpu::BindGroup),
    /// In the submission's staging buffer.
    Staged(Writes),
    /// In the rows of a buffer that holds the whole frame.
    Rows(Writes, wgpu::Buffer, FrameRows),
}

/// Group 2 of a kernel that writes pixels, but for where they go.
pub struct Writes {
    layout: wgpu::BindGroupLayout,
    film: wgpu::Buffer,
    lut: wgpu::TextureView,
}

impl Writes {
    fn group(&self, device: &Device, pixels: wgpu::BindingResource<'_>) -> Result<wgpu::BindGroup> {
        let lut = wgpu::BindingResource::TextureView(&self.lut);
        device.bind(&self.layout, &[self.film.as_entire_binding(), pixels, lut])
    }
}

impl RecordConsumer {
    /// `take` makes the stage that takes the records of a source.
    pub fn new(
        kernels: &Kernels,
        record_setup: &RecordSetup,
        software: bool,
        take: impl Fn(&Kernels, RecordSource) -> Result<Stage>,
    ) -> Result<Self> {
        Ok(Self {
            all: take(kernels, record_setup.source)?,
            deferred: record_setup.deferred_source().map(|source| take(kernels, source)).transpose()?,
            deferred_groups: if software { DEFERRED_GROUPS_SOFTWARE } else { DEFERRED_GROUPS },
        })
    }

    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, tile: [u32; 2]) {
        self.all.dispatch(pass, offset, tile);
        if let Some(deferred) = &self.deferred {
            deferred.run(pass, Some(offset), [self.deferred_groups, 1]);
        }
    }
}

impl FrameBuffers {
    pub fn stages(
        &mut self,
        device: &Device,
        kernels: &Kernels,
        tables: &Tables,
        setup: &Setup,
        target: FrameTarget<'_>,
        software: bool,
    ) -> Result<Stages> {
        let variants = &setup.variants;
        let (fixed, sized) =
            self.fixed.as_ref().zip(self.sized.as_ref()).ok_or_else(|| Error::internal("a frame without buffers"))?;
        let pass = fixed.pass();
        let frame = fixed.frame.buffer.as_entire_binding();
        let step_sum = fixed.step_sum.as_entire_binding();
        let [light_tables, ..] = tables.resources();
        let structure = structure_group(fixed.clouds.buffer(), tables.structure());
        let occluder = tables.occluder().resource();
        let shared = Shared { frame, pass, step_sum, light_tables, structure, occluder, software };
        let made = self.record_store.stages(device, kernels, &setup.record_setup, &shared)?;
        let edges = self.edges.group(device, &kernels.edge_list()?)?;
        if let FrameTarget::Nowhere = target {
            return Ok(Stages { records: made, shading: Shading::Nothing, edges, output: None, glare: None });
        }
        let Shared { frame, pass, structure, .. } = shared;
        let records = self.record_store.group(setup.record_setup.source)?;
        let [even, odd] = sized.radiance.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let [streaks, repeating] = tables.streaks().resources();
        let mut shared = vec![frame, pass.clone()];
        shared.extend(tables.resources().into_iter().chain([streaks, repeating, tables.occluder().resource()]));
        let shades = |kernels: &Kernels, target: &[wgpu::BindingResource<'_>]| {
            let take = |kernels: &Kernels, source| {
                let compiled = match variants.several_samples {
                    true => kernels.get(KernelKey::shade_sample(source, variants.shade))?,
                    false => kernels.get(KernelKey::shade_only(source, variants.shade, variants.film))?,
                };
                let groups: [&[_]; 3] = [&shared, &records, target];
                compiled.stage(device, if variants.several_samples { &groups } else { &groups[..2] })
            };
            let record_setup = &setup.record_setup;
            let refine = |kernels: &Kernels| {
                let film = (!variants.several_samples).then_some(variants.film);
                let source = record_setup.sample_source();
                let shared = [&shared[..], &structure].concat();
                let samples = self.record_store.sample_group(source)?;
                let groups = [&shared[..], &samples, target];
                let groups = if film.is_some() { &groups[..2] } else { &groups };
                RefineStage::new(
                    device,
                    kernels,
                    (source, record_setup.variant),
                    (variants.shade, film),
                    groups,
                    software,
                )
            };
            let refining = if variants.refines { Some(refine(kernels)?) } else { None };
            Ok::<_, Error>(ShadeStages {
                consumer: RecordConsumer::new(kernels, record_setup, software, take)?,
                refining,
            })
        };
        let writer = match variants.several_samples {
            true => kernels.get(KernelKey::develop(variants.film))?,
            false => kernels.get(KernelKey::shade_only(setup.record_setup.source, variants.shade, variants.film))?,
        };
        let shading = if variants.several_samples {
            let develop = |from: wgpu::BindingResource<'_>| {
                writer.stage(device, &[slice::from_ref(&pass), slice::from_ref(&from)])
            };
            Shading::Samples {
                shade: Box::new([
                    shades(kernels, &[odd.clone(), even.clone()])?,
                    shades(kernels, &[even.clone(), odd.clone()])?,
                ]),
                develop: [develop(even)?, develop(odd)?],
            }
        } else {
            Shading::Only(shades(kernels, &[])?)
        };
        let pixel_output = |writer: &Compiled, film: &CachedUniform| {
            let (layout, film) = (writer.target()?.clone(), (*film.buffer).clone());
            let writes = Writes { layout, film, lut: tables.lut().clone() };
            Ok(match target {
                FrameTarget::Image(view, _) => {
                    PixelOutput::Fixed(writes.group(device, wgpu::BindingResource::TextureView(view))?)
                }
                FrameTarget::Buffer(buffer, rows) => PixelOutput::Rows(writes, buffer.clone(), rows),
                FrameTarget::Nowhere => return Err(Error::internal("pixels of a frame without a picture")),
                FrameTarget::Host if variants.rows => PixelOutput::Staged(writes),
                FrameTarget::Copied(_) | FrameTarget::Host => {
                    PixelOutput::Fixed(writes.group(device, sized.packed.as_entire_binding())?)
                }
            })
        };
        let (output, glare) = match (&setup.bloom, variants.developed) {
            (Some(bloom), Some(developed)) => {
                let develops = kernels.get(setup.develop_key(developed, bloom))?;
                let mut light = Vec::from(self.bloom.group(bloom)?);
                let made = (&self.meter, &self.bloom, bloom);
                let meter = setup.meter.as_ref().map(|meter| MeterStages::new(device, kernels, meter, made));
                if setup.meter.is_some() {
                    light.extend(self.meter.group()?);
                    light.push(self.bloom.resources()?.smooth());
                }
                let glare = GlareStages {
                    bloom: self.bloom.stages(device, kernels, bloom)?,
                    meter: meter.transpose()?,
                    develop: develops.stage(device, &[slice::from_ref(&pass), &light])?,
                    output: pixel_output(&develops, &fixed.film_of_exposed)?,
                };
                let film = fixed.film.buffer.as_entire_binding();
                let light = device.bind(writer.target()?, &[film, self.bloom.light()?])?;
                (PixelOutput::Fixed(light), Some(glare))
            }
            _ => (pixel_output(&writer, &fixed.film)?, None),
        };
        Ok(Stages { records: made, shading, edges, output: Some(output), glare })
    }
}

impl ShadeStages {
    /// `offset`: of the sample's `PassUniform`.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, tile: [u32; 2]) {
        self.consumer.dispatch(pass, offset, tile);
        if let Some(refining) = &self.refining {
            refining.dispatch(pass, offset, tile);
        }
    }
}

impl Stages {
    /// Whether the tables of a lens are made for the frame.
    pub(in crate::gpu) fn make_tables(&self) -> bool {
        self.records.make_tables()
    }

    /// Shades samples of a tile; the last one is followed by the sum's development, or, with bloom, by giving it to
    /// the light.
    pub fn shade(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        step: &Step,
        samples: u32,
        begins: bool,
        stride: u32,
        output: Option<&wgpu::BindGroup>,
    ) {
        let tile = [step.shades.width, step.shades.height];
        pass.set_bind_group(3, &self.edges, &[]);
        for (sample, slot) in step.samples.clone().zip(1..) {
            let offset = slot * stride;
            self.records.encode(pass, begins && slot == 1, offset, tile);
            match &self.shading {
                Shading::Nothing => {}
                Shading::Only(shades) => {
                    pass.set_bind_group(2, output, &[]);
                    shades.dispatch(pass, offset, tile);
                }
                Shading::Samples { shade, .. } => {
                    shade[sample as usize % 2].dispatch(pass, offset, tile);
                }
            }
        }
        if let (Shading::Samples { develop, .. }, true) = (&self.shading, step.samples.end == samples) {
            pass.set_bind_group(2, output, &[]);
            develop[(samples as usize - 1) % 2].dispatch(pass, stride, tile);
        }
    }
}

impl PixelOutput {
    /// `staging`: the submission's; `tile`: the one that becomes pixels.
    pub fn group(&self, device: &Device, staging: &wgpu::Buffer, tile: Tile) -> Result<wgpu::BindGroup> {
        match self {
            Self::Fixed(group) => Ok(group.clone()),
            Self::Rows(writes, buffer, rows) => {
                let TilePlace { offset, size, .. } = rows.place(device, tile);
                let size = size.and_then(std::num::NonZeroU64::new);
                let pixels = wgpu::BufferBinding { buffer, offset, size };
                writes.group(device, wgpu::BindingResource::Buffer(pixels))
            }
            Self::Staged(writes) => {
                let pixels = wgpu::BufferBinding { buffer: staging, offset: PIXELS, size: None };
                writes.group(device, wgpu::BindingResource::Buffer(pixels))
            }
        }
    }
}
