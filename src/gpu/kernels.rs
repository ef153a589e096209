//! The pipelines of the kernels, made at first use, and everything that decides how they are compiled (`wgsl`, `slots`). Knows what each
//! kernel binds, not what with.

use super::slots::{
    LENS_COLUMNS, LENS_FLAGS, LENS_ROWS, LIGHT, RADIANCE, SCREEN, Slot, TRACED, edge_slots, shade_slots, sum_slots,
};
use super::{Device, Kernel, Loops, ProvenFinite, wgsl};
use crate::error::{Error, Result};
use crate::film::FilmParams;
use crate::physics::integrator::Method;
use crate::scene::Projection;
use std::collections::HashMap;

/// Everything that decides how the tracing kernels are compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    pub method: MethodCode,
    pub spinning: bool,
    pub delay: bool,
    pub step_limit: bool,
    /// Whether pixels keep where on the disk a crossing is; given rays always do.
    pub azimuth: bool,
    /// Of pixels; given rays have none.
    pub projection: Projection,
}

/// Everything that decides how shading is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Look {
    /// Light, not another view.
    pub light: bool,
    pub stars: bool,
    pub milky_way: bool,
    pub map: bool,
    pub grid: bool,
    /// No effect on light is switched off.
    pub all_effects: bool,
    pub disk: bool,
    /// The disk hides what is behind it.
    pub opaque: bool,
    /// Whether crossings need their footprint.
    pub footprints: bool,
    pub projection: Projection,
    /// Whether pixels with edges get more rays; values of views are not to be averaged.
    pub refines: bool,
}

/// Everything that decides how development is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FilmLook {
    pub(super) format: u32,
    pub(super) tone_map: u32,
    /// Number of the view; 0: light.
    pub(super) false_colour: u32,
    pub(super) target: PixelTarget,
}

/// Where the last kernel of a frame puts pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelTarget {
    /// Into a window's texture.
    Screen,
    /// Into a buffer on the device, packed.
    Packed,
    /// Into a buffer in the host's memory, packed, row by row.
    Rows,
    /// Not pixels yet: exposed light, for bloom to spread.
    Light,
}

impl FilmLook {
    pub fn new(film: &FilmParams, target: PixelTarget) -> Self {
        Self { format: film.format, tone_map: film.tone_map, false_colour: film.false_colour, target }
    }

    /// Of light that bloom is to spread.
    pub fn of_light() -> Self {
        Self { format: 1, tone_map: 0, false_colour: 0, target: PixelTarget::Light }
    }

    /// For kernels that go over what `source` makes: deferred pixels lie scattered.
    fn over(self, source: Source) -> Self {
        match source {
            Source::Kerr { rest: true, .. } => self.scattered(),
            _ => self,
        }
    }

    /// For kernels over pixels that make no rows.
    fn scattered(self) -> Self {
        match self.target {
            PixelTarget::Rows => Self { target: PixelTarget::Packed, ..self },
            PixelTarget::Screen | PixelTarget::Packed | PixelTarget::Light => self,
        }
    }

    /// The group of film.wgsl and what puts the pixels.
    fn slots(self) -> Vec<Slot> {
        let pixels = match self.target {
            PixelTarget::Screen => Slot::TextureWrite(SCREEN),
            PixelTarget::Packed | PixelTarget::Rows => Slot::Write,
            PixelTarget::Light => Slot::TextureWrite(LIGHT),
        };
        vec![Slot::Uniform, pixels]
    }

    /// Threads of a workgroup of the kernels that put pixels.
    fn group(self) -> [u32; 2] {
        match self.target {
            PixelTarget::Screen | PixelTarget::Packed | PixelTarget::Light => GROUP,
            PixelTarget::Rows => ROWS_GROUP,
        }
    }
}

/// Who makes the ray records that a kernel reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Source {
    /// traced.wgsl
    Traced,
    /// lens_schwarzschild_record.wgsl
    Schwarzschild { delay: bool, moving: bool },
    /// lens_kerr_pixel.wgsl, and of the pixels it defers lens_kerr_rest.wgsl
    Kerr { delay: bool, pattern: bool, moving: bool, rest: bool },
}

/// How refine.wgsl finds its samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Refined {
    /// Of the pixels' own records.
    pub source: Source,
    /// How rays are traced that no table holds.
    pub variant: Variant,
}

/// `METHOD_*` of integrator.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MethodCode(u32);

impl From<Method> for MethodCode {
    fn from(method: Method) -> Self {
        Self(match method {
            Method::Nystrom => 0,
            Method::Rk4 => 1,
            Method::DormandPrince => 2,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Name {
    Pixels(Variant),
    Rays(Variant),
    Count,
    ShadeSample(Source, Look),
    ShadeOnly(Source, Look, FilmLook),
    Refine(Refined, Look, Option<FilmLook>),
    /// Of a sum of samples; or of light that has spread over a grid of cells of so many pixels' side.
    Develop(FilmLook, Option<u32>),
    /// Finer cells, or pixels, along a cell's side; whether they are cells.
    Gather(u32, bool),
    GatherBase,
    GiveBack,
    Export(Source, bool, Projection),
    SchwarzschildEnds,
    SchwarzschildColumns {
        delay: bool,
    },
    KerrNodes {
        delay: bool,
        pattern: bool,
    },
    KerrFlags {
        pattern: bool,
    },
}

/// The pipelines of one device.
#[derive(Default)]
pub struct Kernels {
    made: HashMap<Name, Compiled>,
    /// Of `made`, what was used last comes last.
    used: Vec<Name>,
    /// Kernels that bind the same share the layout, so that they can share groups.
    layouts: HashMap<Vec<Slot>, wgpu::BindGroupLayout>,
}

/// A pipeline and the layouts of its groups.
#[derive(Clone)]
pub struct Compiled {
    pipeline: wgpu::ComputePipeline,
    layouts: Vec<wgpu::BindGroupLayout>,
    /// Threads of a workgroup that goes over pixels.
    group: [u32; 2],
}

/// A pipeline with what it binds; its group 0 has one `UniformPart`.
pub struct Stage {
    pipeline: wgpu::ComputePipeline,
    groups: Vec<wgpu::BindGroup>,
    group: [u32; 2],
}

/// Pipelines that a device keeps: those of some ten kinds of frames.
const MOST_KERNELS: usize = 48;

/// Threads of a workgroup of the kernels that go over pixels.
const GROUP: [u32; 2] = [8, 16];
/// The same of those that put them row by row.
const ROWS_GROUP: [u32; 2] = [32, 4];
/// Threads of a workgroup of the kernels that build spin-0 lenses.
pub const LENS_GROUP: u32 = 32;

impl Kernels {
    pub fn pixels(&mut self, device: &Device, variant: Variant) -> Result<Compiled> {
        let [sky, meta, disk] = TRACED.map(Slot::TextureWrite);
        let slots = vec![Slot::Uniform, Slot::UniformPart, sky, meta, disk];
        self.get(device, Name::Pixels(variant), &[slots], "trace_pixels", wgsl::pixels)
    }

    pub fn count(&mut self, device: &Device) -> Result<Compiled> {
        let slots = vec![Slot::UniformPart, Slot::Texture(TRACED[1]), Slot::Write];
        self.get(device, Name::Count, &[slots], "count_steps", wgsl::count)
    }

    pub fn rays(&mut self, device: &Device, variant: Variant) -> Result<Compiled> {
        let slots = vec![Slot::Uniform, Slot::Read, Slot::Write];
        self.get(device, Name::Rays(variant), &[slots], "trace_rays", wgsl::rays)
    }

    /// Group 3, the list of pixels with edges, is for the caller to set.
    pub fn shade_sample(&mut self, device: &Device, source: Source, look: Look) -> Result<Compiled> {
        let groups = [shade_slots(), source.slots(), sum_slots(), edge_slots()];
        let (entry_point, _) = source.driver(None);
        self.get(device, Name::ShadeSample(source, look), &groups, entry_point, || wgsl::shade_sample(source))
    }

    /// Groups 2, which puts the pixels, and 3, the list of those with edges, are for the caller to set.
    pub fn shade_only(&mut self, device: &Device, source: Source, look: Look, film: FilmLook) -> Result<Compiled> {
        let film = film.over(source);
        let groups = [shade_slots(), source.slots(), film.slots(), edge_slots()];
        let wgsl = || wgsl::shade_only(source, film);
        let (entry_point, _) = source.driver(Some(film.target));
        self.get(device, Name::ShadeOnly(source, look, film), &groups, entry_point, wgsl)
    }

    /// Groups 2 and 3 as `shade_only`, or, without `film`, `shade_sample`.
    pub fn refine(
        &mut self,
        device: &Device,
        refined: Refined,
        look: Look,
        film: Option<FilmLook>,
    ) -> Result<Compiled> {
        let film = film.map(FilmLook::scattered);
        // The disk may cover but a part of a sample's cell.
        let look = Look { opaque: false, ..look };
        let target = film.map_or_else(sum_slots, FilmLook::slots);
        let groups = [shade_slots(), refined.source.slots(), target, edge_slots()];
        let wgsl = || wgsl::refine(refined.source, film);
        self.get(device, Name::Refine(refined, look, film), &groups, "refine", wgsl)
    }

    /// `glare`: with bloom, pixels along a cell's side. Group 2, which puts the pixels, is for the caller to set.
    pub fn develop(&mut self, device: &Device, film: FilmLook, glare: Option<u32>) -> Result<Compiled> {
        let light = match glare {
            Some(_) => vec![Slot::Texture(LIGHT), Slot::Filtered(LIGHT), Slot::Sampler, Slot::Uniform],
            None => vec![Slot::Texture(RADIANCE)],
        };
        let groups = [vec![Slot::UniformPart], light, film.slots()];
        self.get(device, Name::Develop(film, glare), &groups, "develop_tile", || wgsl::develop(film, glare.is_some()))
    }

    /// For cells of `step` x `step` pixels, or of finer cells.
    pub fn gather(&mut self, device: &Device, step: u32, grid: bool) -> Result<Compiled> {
        let slots = vec![Slot::UniformPart, Slot::Texture(LIGHT), Slot::TextureWrite(LIGHT)];
        self.get(device, Name::Gather(step, grid), &[slots], "gather", wgsl::gather)
    }

    /// For cells of 2 x 2 pixels.
    pub fn gather_base(&mut self, device: &Device) -> Result<Compiled> {
        let slots = vec![Slot::UniformPart, Slot::Filtered(LIGHT), Slot::Sampler, Slot::TextureWrite(LIGHT)];
        self.get(device, Name::GatherBase, &[slots], "gather", wgsl::gather_base)
    }

    pub fn give_back(&mut self, device: &Device) -> Result<Compiled> {
        let [finer, coarser] = [Slot::Texture(LIGHT), Slot::Filtered(LIGHT)];
        let slots = vec![Slot::UniformPart, finer, coarser, Slot::Sampler, Slot::TextureWrite(LIGHT)];
        self.get(device, Name::GiveBack, &[slots], "give_back", wgsl::give_back)
    }

    pub fn export(&mut self, device: &Device, source: Source, look: Look) -> Result<Compiled> {
        let groups = [vec![Slot::Uniform, Slot::UniformPart], source.slots(), vec![Slot::Write]];
        let (entry_point, _) = source.driver(None);
        let name = Name::Export(source, look.footprints, look.projection);
        self.get(device, name, &groups, entry_point, || wgsl::export(source))
    }

    pub fn find_schwarzschild_ends(&mut self, device: &Device) -> Result<Compiled> {
        let slots = vec![Slot::Uniform, Slot::Uniform, Slot::TextureWrite(LENS_ROWS)];
        self.get(device, Name::SchwarzschildEnds, &[slots], "find_ends", wgsl::schwarzschild_ends)
    }

    pub fn fill_schwarzschild_columns(&mut self, device: &Device, delay: bool) -> Result<Compiled> {
        let [swept, u, delays] = [LENS_ROWS, LENS_COLUMNS, LENS_COLUMNS].map(Slot::TextureWrite);
        let slots = vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), swept, u, delays];
        let name = Name::SchwarzschildColumns { delay };
        self.get(device, name, &[slots], "fill_columns", wgsl::schwarzschild_columns)
    }

    pub fn trace_kerr_nodes(&mut self, device: &Device, delay: bool, pattern: bool) -> Result<Compiled> {
        let [sky, crossings] = [LENS_ROWS, LENS_COLUMNS].map(Slot::TextureWrite);
        let slots = vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), sky, crossings];
        self.get(device, Name::KerrNodes { delay, pattern }, &[slots], "trace_nodes", wgsl::kerr_nodes)
    }

    pub fn flag_kerr_cells(&mut self, device: &Device, pattern: bool) -> Result<Compiled> {
        let [curve, sky, crossings] = [LENS_ROWS, LENS_ROWS, LENS_COLUMNS].map(Slot::Texture);
        let flags = Slot::TextureWrite(LENS_FLAGS);
        let slots = vec![Slot::Uniform, Slot::Uniform, curve, sky, crossings, flags];
        self.get(device, Name::KerrFlags { pattern }, &[slots], "flag_cells", wgsl::kerr_flags)
    }

    fn get(
        &mut self,
        device: &Device,
        name: Name,
        groups: &[Vec<Slot>],
        entry_point: &str,
        source: impl FnOnce() -> String,
    ) -> Result<Compiled> {
        self.used.retain(|used| *used != name);
        self.used.push(name);
        if let Some(compiled) = self.made.get(&name) {
            return Ok(compiled.clone());
        }
        // The oldest go first: on software drivers each takes megabytes of the host's memory.
        let too_many = self.used.len().saturating_sub(MOST_KERNELS);
        for old in self.used.drain(..too_many) {
            self.made.remove(&old);
        }
        let layouts = groups.iter().map(|slots| self.layout(device, slots)).collect::<Result<Vec<_>>>()?;
        let constants = constants(name);
        let source = source();
        let pipeline = device.compute_pipeline(&Kernel {
            label: entry_point,
            source: &[&source],
            loops: LOOPS,
            entry_point,
            constants: &constants,
            zero_workgroup_memory: false,
            groups: &layouts.iter().collect::<Vec<_>>(),
        })?;
        let group = match name {
            Name::ShadeOnly(_, _, film) | Name::Develop(film, _) => film.group(),
            _ => GROUP,
        };
        let compiled = Compiled { pipeline, layouts, group };
        self.made.insert(name, compiled.clone());
        Ok(compiled)
    }

    /// The layout of group 3 of kernels that shade.
    pub fn edge_list(&mut self, device: &Device) -> Result<wgpu::BindGroupLayout> {
        self.layout(device, &edge_slots())
    }

    fn layout(&mut self, device: &Device, slots: &[Slot]) -> Result<wgpu::BindGroupLayout> {
        if let Some(layout) = self.layouts.get(slots) {
            return Ok(layout.clone());
        }
        let entries = slots
            .iter()
            .zip(0..)
            .map(|(slot, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: slot.binding_type(),
                count: None,
            })
            .collect::<Vec<_>>();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        let layout = device.scoped("laying out bindings", |d| d.create_bind_group_layout(&descriptor))?;
        self.layouts.insert(slots.into(), layout.clone());
        Ok(layout)
    }
}

/// SAFETY of the promise: every loop in shaders/ is one of: the inner loop of `trace`, which adds 1 to `steps` in every turn before
/// it can `continue` and ends at `max_steps` <= 100000; its outer loop, which ends unless the inner one has taken a step;
/// loops counted over constants (of a pipeline or of all), over the samples of a pixel (32 at most), over the words of a pixel (4 at most), over the pixels of a tile, over the crossings of a record (the host keeps `max_crossings` and `orders` at 16 or less), or over deferred pixels or those of a list of edges, of which
/// there are fewer than 2^31; that of `map_light` over the taps of a pixel, at most 7, and two levels; loops over the bits of a word, which loses a bit in every turn; and the two of `star_light`, of
/// which every turn uses up a star of the cell's list, at most 255, or a mean sky, of which there are two, or ends the loop.
const LOOPS: Loops = Loops::Proven(unsafe { ProvenFinite::promise() });

fn flag(on: bool) -> f64 {
    f64::from(u8::from(on))
}

impl Source {
    /// Values of the `override` constants that the parts declare.
    fn constants(self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Traced => Vec::new(),
            Self::Schwarzschild { delay, moving } => {
                vec![("SPINNING", 0.0), ("DELAY", flag(delay)), ("MOVING", flag(moving))]
            }
            Self::Kerr { delay, pattern, moving, rest } => {
                let mut list = vec![("DELAY", flag(delay)), ("PATTERN", flag(pattern)), ("MOVING", flag(moving))];
                if rest {
                    // The rest of the constants' defaults are what AUTO takes.
                    list.push(("STEP_LIMIT", 1.0));
                }
                list
            }
        }
    }
}

fn trace_constants(variant: Variant) -> Vec<(&'static str, f64)> {
    vec![
        ("METHOD", f64::from(variant.method.0)),
        ("SPINNING", flag(variant.spinning)),
        ("DELAY", flag(variant.delay)),
        ("STEP_LIMIT", flag(variant.step_limit)),
    ]
}

fn projection_constant(projection: Projection) -> (&'static str, f64) {
    ("PROJECTION", f64::from(projection as i32))
}

fn look_constants(look: Look) -> Vec<(&'static str, f64)> {
    vec![
        ("SHOWS_LIGHT", flag(look.light)),
        ("SHOWS_STARS", flag(look.stars)),
        ("SHOWS_MILKY_WAY", flag(look.milky_way)),
        ("SHOWS_MAP", flag(look.map)),
        ("SHOWS_GRID", flag(look.grid)),
        ("ALL_EFFECTS", flag(look.all_effects)),
        ("DISK", flag(look.disk)),
        ("OPAQUE", flag(look.opaque)),
        ("FOOTPRINTS", flag(look.footprints)),
        projection_constant(look.projection),
        ("REFINES", flag(look.refines)),
    ]
}

fn film_constants(film: FilmLook) -> Vec<(&'static str, f64)> {
    vec![("FORMAT", film.format.into()), ("TONE_MAP", film.tone_map.into()), ("FALSE_COLOUR", film.false_colour.into())]
}

/// Values of the `override` constants that the kernel's source declares.
fn constants(name: Name) -> Vec<(&'static str, f64)> {
    match name {
        Name::Pixels(variant) => {
            let pixels = vec![("AZIMUTH", flag(variant.azimuth)), projection_constant(variant.projection)];
            [trace_constants(variant), pixels].concat()
        }
        Name::Rays(variant) => trace_constants(variant),
        Name::ShadeSample(source, look) => [source.constants(), look_constants(look)].concat(),
        Name::ShadeOnly(source, look, film) => {
            [source.constants(), look_constants(look), film_constants(film)].concat()
        }
        Name::Refine(refined, look, film) => {
            let traced = match refined.source {
                Source::Traced => trace_constants(refined.variant),
                _ => refined.source.constants(),
            };
            let film = film.map_or_else(Vec::new, film_constants);
            [traced, look_constants(look), film, vec![("WHOLE_PLANE", 1.0)]].concat()
        }
        Name::Develop(film, None) => film_constants(film),
        Name::Develop(film, Some(step)) => [film_constants(film), vec![("STEP", step.into())]].concat(),
        Name::Gather(step, grid) => vec![("STEP", step.into()), ("GRID", flag(grid))],
        Name::GatherBase | Name::GiveBack => Vec::new(),
        Name::Export(source, footprints, projection) => {
            let export = vec![("FOOTPRINTS", flag(footprints)), projection_constant(projection)];
            [source.constants(), export].concat()
        }
        Name::SchwarzschildEnds => vec![("SPINNING", 0.0), ("DELAY", 0.0)],
        Name::SchwarzschildColumns { delay } => vec![("SPINNING", 0.0), ("DELAY", flag(delay))],
        Name::KerrNodes { delay, pattern } => vec![("DELAY", flag(delay)), ("PATTERN", flag(pattern))],
        Name::KerrFlags { pattern } => vec![("PATTERN", flag(pattern))],
        Name::Count => Vec::new(),
    }
}

impl Compiled {
    /// The layout of group 2.
    pub fn target(&self) -> Result<&wgpu::BindGroupLayout> {
        self.layouts.get(2).ok_or_else(|| Error::internal("a kernel without a target"))
    }

    /// The pipeline with `groups`, the first of its groups: of each the resources in the order of its slots.
    pub fn stage(&self, device: &Device, groups: &[&[wgpu::BindingResource<'_>]]) -> Result<Stage> {
        let groups = groups.iter().zip(&self.layouts).map(|(resources, layout)| device.bind(layout, resources));
        let groups = groups.collect::<Result<Vec<_>>>()?;
        Ok(Stage { pipeline: self.pipeline.clone(), groups, group: self.group })
    }
}

impl Stage {
    /// Binds the stage and runs `groups` workgroups. `offset`: of the `UniformPart` of group 0; `None` if it has none.
    pub fn run(&self, pass: &mut wgpu::ComputePass<'_>, offset: Option<u32>, groups: [u32; 2]) {
        pass.set_pipeline(&self.pipeline);
        for (group, index) in self.groups.iter().zip(0..) {
            pass.set_bind_group(index, group, if index == 0 { offset.as_slice() } else { &[] });
        }
        pass.dispatch_workgroups(groups[0], groups[1], 1);
    }

    /// One thread for each pixel of a rectangle.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, size: [u32; 2]) {
        self.run(pass, Some(offset), groups_over(size, self.group));
    }
}

fn groups_over(size: [u32; 2], group: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|i| size[i].div_ceil(group[i]))
}

/// Workgroups over a rectangle of pixels.
pub fn pixel_groups(size: [u32; 2]) -> [u32; 2] {
    groups_over(size, GROUP)
}

/// Errors: INTERNAL if a count of workgroups exceeds what the device takes.
pub fn check_groups(device: &Device, groups: [u32; 2]) -> Result<()> {
    let limit = device.limits().max_compute_workgroups_per_dimension;
    if groups.iter().any(|&g| g > limit) {
        return Err(Error::internal(format!(
            "a dispatch of {groups:?} workgroups exceeds the device's limit of {limit}"
        )));
    }
    Ok(())
}
