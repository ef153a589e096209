//! The kernels of a frame with what they bind, from records to pixels, and the order in which a tile goes through
//! them. Knows no submissions.

use super::bloom::BloomStages;
use super::buffers::{FrameBuffers, Written};
use super::refine::Refining;
use super::setup::{FrameTarget, Setup};
use super::steps::Step;
use super::submission::PIXELS;
use super::tables::Tables;
use crate::error::{Error, Result};
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::{Compiled, Kernels, Stage};
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::variant::Source;
use crate::gpu::lens::records::{Making, RecordStages, Shared};
use std::slice;

/// Workgroups that share the deferred pixels: enough for a large GPU's few thousand, and on a software driver, where
/// each costs its share of a loop's body however little there is to do, few.
const REST_GROUPS: u32 = 512;
const REST_GROUPS_SOFTWARE: u32 = 16;

/// A kernel that takes records: over all pixels, and over those that it deferred.
pub struct Taking {
    all: Stage,
    rest: Option<Stage>,
    /// Workgroups over the deferred pixels, however many they are.
    rest_groups: u32,
}

/// The kernels that shade a sample: of all pixels, and then more rays of those that were listed for their edges.
struct Shades {
    taking: Taking,
    refining: Option<Refining>,
}

/// The stages that turn ray records into packed pixels.
enum Shading {
    /// The stage for the only sample.
    Only(Shades),
    Samples {
        /// The stages for even and for odd samples.
        shade: Box<[Shades; 2]>,
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
    pub put: Put,
    /// In frames with bloom: what follows shading, which then puts light.
    pub glare: Option<GlareStages>,
}

/// The stages that spread light and turn it into pixels.
pub struct GlareStages {
    pub bloom: BloomStages,
    pub develop: Stage,
    pub put: Put,
}

/// Group 2 of a kernel that puts pixels, or light.
pub enum Put {
    /// In the same place in every submission.
    Here(wgpu::BindGroup),
    /// In the submission's staging buffer: the group's layout, and the film.
    Staged(wgpu::BindGroupLayout, wgpu::Buffer),
}

impl Taking {
    /// `take` makes the stage that takes the records of a source.
    pub fn new(
        kernels: &Kernels,
        making: &Making,
        software: bool,
        take: impl Fn(&Kernels, Source) -> Result<Stage>,
    ) -> Result<Self> {
        Ok(Self {
            all: take(kernels, making.source)?,
            rest: making.rest().map(|source| take(kernels, source)).transpose()?,
            rest_groups: if software { REST_GROUPS_SOFTWARE } else { REST_GROUPS },
        })
    }

    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, tile: [u32; 2]) {
        self.all.dispatch(pass, offset, tile);
        if let Some(rest) = &self.rest {
            rest.run(pass, Some(offset), [self.rest_groups, 1]);
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
        let looks = &setup.looks;
        let (fixed, sized) =
            self.fixed.as_ref().zip(self.sized.as_ref()).ok_or_else(|| Error::internal("a frame without buffers"))?;
        let pass = fixed.pass();
        let frame = fixed.frame.buffer.as_entire_binding();
        let step_sum = fixed.step_sum.as_entire_binding();
        let shared = Shared { frame: frame.clone(), pass: pass.clone(), step_sum };
        let made = self.makers.stages(device, kernels, &setup.making, &shared)?;
        let records = self.makers.group(setup.making.source)?;
        let [light, cells, milky_way, map] = tables.textures().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let [even, odd] = sized.radiance.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let shared = [frame, pass.clone(), light, cells, milky_way, map];
        let shades = |kernels: &Kernels, target: &[wgpu::BindingResource<'_>]| {
            let take = |kernels: &Kernels, source| {
                let compiled = match looks.several_samples {
                    true => kernels.get(KernelKey::shade_sample(source, looks.look))?,
                    false => kernels.get(KernelKey::shade_only(source, looks.look, looks.film))?,
                };
                let groups: [&[_]; 3] = [&shared, &records, target];
                compiled.stage(device, if looks.several_samples { &groups } else { &groups[..2] })
            };
            let making = &setup.making;
            let refine = |kernels: &Kernels| {
                let film = (!looks.several_samples).then_some(looks.film);
                let (source, groups) = (making.rest().unwrap_or(making.source), [&shared[..], &records, target]);
                let groups = if film.is_some() { &groups[..2] } else { &groups };
                Refining::new(device, kernels, (source, making.variant), (looks.look, film), groups, software)
            };
            let refining = if looks.look.refines { Some(refine(kernels)?) } else { None };
            Ok::<_, Error>(Shades { taking: Taking::new(kernels, making, software, take)?, refining })
        };
        let puts = match looks.several_samples {
            true => kernels.get(KernelKey::Develop(looks.film, None))?,
            false => kernels.get(KernelKey::shade_only(setup.making.source, looks.look, looks.film))?,
        };
        let shading = if looks.several_samples {
            let develop =
                |from: wgpu::BindingResource<'_>| puts.stage(device, &[slice::from_ref(&pass), slice::from_ref(&from)]);
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
        let edges = self.edges.group(device, &kernels.edge_list()?)?;
        let group = |puts: &Compiled, film: &Written, pixels| {
            device.bind(puts.target()?, &[film.buffer.as_entire_binding(), pixels])
        };
        let put_pixels = |puts: &Compiled, film: &Written| match target {
            FrameTarget::Screen(texture) => {
                group(puts, film, wgpu::BindingResource::TextureView(&texture.view)).map(Put::Here)
            }
            FrameTarget::Host if looks.rows => Ok(Put::Staged(puts.target()?.clone(), (*film.buffer).clone())),
            FrameTarget::Host => group(puts, film, sized.packed.as_entire_binding()).map(Put::Here),
        };
        let (put, glare) = match (&setup.bloom, looks.developed) {
            (Some(bloom), Some(look)) => {
                let develops = kernels.get(KernelKey::Develop(look, Some(bloom.factor)))?;
                let glare = GlareStages {
                    bloom: self.bloom.stages(device, kernels, bloom)?,
                    develop: develops.stage(device, &[slice::from_ref(&pass), &self.bloom.group(bloom)?])?,
                    put: put_pixels(&develops, &fixed.film_of_exposed)?,
                };
                (Put::Here(group(&puts, &fixed.film, self.bloom.light()?)?), Some(glare))
            }
            _ => (put_pixels(&puts, &fixed.film)?, None),
        };
        Ok(Stages { records: made, shading, edges, put, glare })
    }
}

impl Shades {
    /// `offsets`: of the sample's two `PassUniform`s.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offsets: [u32; 2], tile: [u32; 2]) {
        self.taking.dispatch(pass, offsets[0], tile);
        if let Some(refining) = &self.refining {
            refining.dispatch(pass, offsets);
        }
    }
}

impl Stages {
    /// Shades samples of a tile; the last one is followed by the sum's development, or, with bloom, by giving it to
    /// the light.
    pub fn shade(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        step: &Step,
        samples: u32,
        begins: bool,
        stride: u32,
        put: Option<&wgpu::BindGroup>,
    ) {
        let tile = [step.shades.width, step.shades.height];
        pass.set_bind_group(3, &self.edges, &[]);
        for (sample, slot) in step.samples.clone().zip((1..).step_by(2)) {
            let offset = slot * stride;
            self.records.encode(pass, begins && slot == 1, offset, tile);
            match &self.shading {
                Shading::Only(shades) => {
                    pass.set_bind_group(2, put, &[]);
                    shades.dispatch(pass, [offset, offset + stride], tile);
                }
                Shading::Samples { shade, .. } => {
                    shade[sample as usize % 2].dispatch(pass, [offset, offset + stride], tile);
                }
            }
        }
        if let (Shading::Samples { develop, .. }, true) = (&self.shading, step.samples.end == samples) {
            pass.set_bind_group(2, put, &[]);
            develop[(samples as usize - 1) % 2].dispatch(pass, stride, tile);
        }
    }
}

impl Put {
    /// `staging`: the submission's.
    pub fn group(&self, device: &Device, staging: &wgpu::Buffer) -> Result<wgpu::BindGroup> {
        match self {
            Self::Here(group) => Ok(group.clone()),
            Self::Staged(layout, film) => {
                let pixels = wgpu::BufferBinding { buffer: staging, offset: PIXELS, size: None };
                device.bind(layout, &[film.as_entire_binding(), wgpu::BindingResource::Buffer(pixels)])
            }
        }
    }
}
