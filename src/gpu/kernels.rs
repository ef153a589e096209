//! The shaders, joined from their parts, and their pipelines, made at first use. Knows what each kernel binds, not what with.

use super::{Device, Kernel, Loops, ProvenFinite};
use crate::error::{Error, Result};
use crate::film::FilmParams;
use crate::physics::integrator::Method;
use crate::sky;
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
}

/// Everything that decides how shading is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Look {
    /// Light, not another view.
    pub light: bool,
    pub stars: bool,
    /// No effect on light is switched off.
    pub all_effects: bool,
    /// Whether crossings need their footprint.
    pub footprints: bool,
}

/// Everything that decides how development is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FilmLook {
    format: u32,
    tone_map: u32,
    false_colour: bool,
}

impl From<&FilmParams> for FilmLook {
    fn from(film: &FilmParams) -> Self {
        Self { format: film.format, tone_map: film.tone_map, false_colour: film.false_colour != 0 }
    }
}

/// Who makes the ray records that a kernel reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Source {
    /// traced.wgsl
    Traced,
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
    Develop(FilmLook),
    Export(Source, bool),
}

/// The pipelines of one device.
#[derive(Default)]
pub struct Kernels {
    made: HashMap<Name, Compiled>,
}

/// A pipeline and the layouts of its groups.
#[derive(Clone)]
pub struct Compiled {
    pipeline: wgpu::ComputePipeline,
    layouts: Vec<wgpu::BindGroupLayout>,
}

/// A pipeline with what it binds; its group 0 has one `UniformPart`.
pub struct Stage {
    pipeline: wgpu::ComputePipeline,
    groups: Vec<wgpu::BindGroup>,
}

/// Threads of a workgroup of the kernels that go over pixels.
const GROUP: [u32; 2] = [16, 8];

const MATH: &str = include_str!("../../shaders/math.wgsl");
const FATE: &str = include_str!("../../shaders/fate.wgsl");
const TRACE_PARTS: [&str; 5] = [
    MATH,
    FATE,
    include_str!("../../shaders/geodesic.wgsl"),
    include_str!("../../shaders/integrator.wgsl"),
    include_str!("../../shaders/trace.wgsl"),
];
const PASS: &str = include_str!("../../shaders/pass.wgsl");
const FRAME: &str = include_str!("../../shaders/frame.wgsl");
const TRACED_LAYOUT: &str = include_str!("../../shaders/traced_layout.wgsl");
const RECORD: &str = include_str!("../../shaders/record.wgsl");
const FILM_PARTS: [&str; 2] = [include_str!("../../shaders/film.wgsl"), include_str!("../../shaders/packed.wgsl")];

fn join(parts: &[&[&str]]) -> String {
    parts.concat().join("\n")
}

fn rays_source() -> String {
    join(&[&TRACE_PARTS, &[include_str!("../../shaders/rays.wgsl")]])
}

fn pixels_source() -> String {
    let camera = include_str!("../../shaders/camera.wgsl");
    join(&[&TRACE_PARTS, &[PASS, TRACED_LAYOUT, FRAME, camera, include_str!("../../shaders/pixels.wgsl")]])
}

fn count_source() -> String {
    join(&[&[PASS, TRACED_LAYOUT, include_str!("../../shaders/count.wgsl")]])
}

impl Source {
    /// The WGSL that makes records, without what shading needs as well.
    fn parts(self) -> Vec<&'static str> {
        match self {
            Self::Traced => vec![TRACED_LAYOUT, include_str!("../../shaders/traced.wgsl")],
        }
    }
}

fn shade_source(source: Source, rest: &[&str]) -> String {
    let shade = [
        include_str!("../../shaders/blackbody.wgsl"),
        include_str!("../../shaders/stars.wgsl"),
        include_str!("../../shaders/disk.wgsl"),
        include_str!("../../shaders/turbulence.wgsl"),
        include_str!("../../shaders/shade.wgsl"),
    ];
    let constants = sky::StarIndex::shared().wgsl_constants();
    join(&[&[constants.as_str(), MATH, FATE, PASS, RECORD, FRAME], &source.parts(), &shade, rest])
}

fn shade_sample_source(source: Source) -> String {
    shade_source(source, &[include_str!("../../shaders/shade_sample.wgsl")])
}

fn shade_only_source(source: Source) -> String {
    let [film, packed] = FILM_PARTS;
    shade_source(source, &[film, packed, include_str!("../../shaders/shade_only.wgsl")])
}

fn export_source(source: Source) -> String {
    join(&[&[MATH, FATE, PASS, RECORD, FRAME], &source.parts(), &[include_str!("../../shaders/export.wgsl")]])
}

fn develop_source() -> String {
    join(&[&[PASS], &FILM_PARTS, &[include_str!("../../shaders/develop.wgsl")]])
}

/// Every shader of this tracer, joined from its parts as the device gets it: name and WGSL.
pub fn shader_sources() -> Vec<(&'static str, String)> {
    vec![
        ("rays", rays_source()),
        ("pixels", pixels_source()),
        ("count", count_source()),
        ("shade sample, traced", shade_sample_source(Source::Traced)),
        ("shade only, traced", shade_only_source(Source::Traced)),
        ("export, traced", export_source(Source::Traced)),
        ("develop", develop_source()),
    ]
}

/// What a binding is.
#[derive(Clone, Copy)]
enum Slot {
    Uniform,
    /// A uniform of which each dispatch chooses a part.
    UniformPart,
    Read,
    Write,
    Texture(TextureKind),
    TextureWrite(TextureKind),
}

/// A texture as a kernel declares it.
#[derive(Clone, Copy)]
pub struct TextureKind {
    pub format: wgpu::TextureFormat,
    pub dimension: wgpu::TextureViewDimension,
}

/// `record_sky`, `record_meta` and `record_disk` of traced_layout.wgsl.
pub const TRACED: [TextureKind; 3] = [
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::Rgba32Uint, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2Array },
];

/// Radiance of shade_sample.wgsl and develop.wgsl.
pub const RADIANCE: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 };

/// `light_tables` and `star_cells` of shade.wgsl.
const TABLES: [TextureKind; 2] = [
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::R32Uint, dimension: wgpu::TextureViewDimension::D2 },
];

impl Slot {
    fn binding_type(self) -> wgpu::BindingType {
        let buffer =
            |ty, has_dynamic_offset| wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None };
        match self {
            Self::Uniform => buffer(wgpu::BufferBindingType::Uniform, false),
            Self::UniformPart => buffer(wgpu::BufferBindingType::Uniform, true),
            Self::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }, false),
            Self::Write => buffer(wgpu::BufferBindingType::Storage { read_only: false }, false),
            Self::Texture(of) => wgpu::BindingType::Texture {
                sample_type: match of.format {
                    wgpu::TextureFormat::Rgba32Uint | wgpu::TextureFormat::R32Uint => wgpu::TextureSampleType::Uint,
                    _ => wgpu::TextureSampleType::Float { filterable: false },
                },
                view_dimension: of.dimension,
                multisampled: false,
            },
            Self::TextureWrite(of) => wgpu::BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: of.format,
                view_dimension: of.dimension,
            },
        }
    }
}

impl Source {
    /// Group 1.
    fn slots(self) -> Vec<Slot> {
        match self {
            Self::Traced => TRACED.map(Slot::Texture).into(),
        }
    }
}

/// Bindings 0 .. 3 of shade.wgsl, then `rest`.
fn shade_slots(rest: [Slot; 2]) -> Vec<Slot> {
    let [light, cells] = TABLES.map(Slot::Texture);
    [[Slot::Uniform, Slot::UniformPart, light, cells].as_slice(), &rest].concat()
}

impl Kernels {
    pub fn pixels(&mut self, device: &Device, variant: Variant) -> Result<Compiled> {
        let [sky, meta, disk] = TRACED.map(Slot::TextureWrite);
        let slots = vec![Slot::Uniform, Slot::UniformPart, sky, meta, disk];
        self.get(device, Name::Pixels(variant), &[slots], "trace_pixels", pixels_source)
    }

    pub fn count(&mut self, device: &Device) -> Result<Compiled> {
        let slots = vec![Slot::UniformPart, Slot::Texture(TRACED[1]), Slot::Write];
        self.get(device, Name::Count, &[slots], "count_steps", count_source)
    }

    pub fn rays(&mut self, device: &Device, variant: Variant) -> Result<Compiled> {
        let slots = vec![Slot::Uniform, Slot::Read, Slot::Write];
        self.get(device, Name::Rays(variant), &[slots], "trace_rays", rays_source)
    }

    pub fn shade_sample(&mut self, device: &Device, source: Source, look: Look) -> Result<Compiled> {
        let groups = [shade_slots([Slot::Texture(RADIANCE), Slot::TextureWrite(RADIANCE)]), source.slots()];
        self.get(device, Name::ShadeSample(source, look), &groups, "shade_sample", || shade_sample_source(source))
    }

    pub fn shade_only(&mut self, device: &Device, source: Source, look: Look, film: FilmLook) -> Result<Compiled> {
        let groups = [shade_slots([Slot::Uniform, Slot::Write]), source.slots()];
        self.get(device, Name::ShadeOnly(source, look, film), &groups, "shade_only", || shade_only_source(source))
    }

    pub fn develop(&mut self, device: &Device, film: FilmLook) -> Result<Compiled> {
        let slots = vec![Slot::Uniform, Slot::UniformPart, Slot::Texture(RADIANCE), Slot::Write];
        self.get(device, Name::Develop(film), &[slots], "develop_tile", develop_source)
    }

    pub fn export(&mut self, device: &Device, source: Source, footprints: bool) -> Result<Compiled> {
        let groups = [vec![Slot::Uniform, Slot::UniformPart, Slot::Write], source.slots()];
        self.get(device, Name::Export(source, footprints), &groups, "export_records", || export_source(source))
    }

    fn get(
        &mut self,
        device: &Device,
        name: Name,
        groups: &[Vec<Slot>],
        entry_point: &str,
        source: impl FnOnce() -> String,
    ) -> Result<Compiled> {
        if let Some(compiled) = self.made.get(&name) {
            return Ok(compiled.clone());
        }
        let layouts = groups.iter().map(|slots| layout(device, entry_point, slots)).collect::<Result<Vec<_>>>()?;
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
        let compiled = Compiled { pipeline, layouts };
        self.made.insert(name, compiled.clone());
        Ok(compiled)
    }
}

/// SAFETY of the promise: every loop in shaders/ is one of: the inner loop of `trace`, which adds 1 to `steps` in every turn before
/// it can `continue` and ends at `max_steps` <= 100000; its outer loop, which ends unless the inner one has taken a step;
/// loops counted over constants or over the pixels of a tile; one over the bits of a word, which loses a bit in every turn; and the two of `star_light`, of which
/// every turn uses up a star of the cell's list, at most 255, or a mean sky, of which there are two, or ends the loop.
const LOOPS: Loops = Loops::Proven(unsafe { ProvenFinite::promise() });

fn flag(on: bool) -> f64 {
    f64::from(u8::from(on))
}

fn trace_constants(variant: Variant) -> Vec<(&'static str, f64)> {
    vec![
        ("METHOD", f64::from(variant.method.0)),
        ("SPINNING", flag(variant.spinning)),
        ("DELAY", flag(variant.delay)),
        ("STEP_LIMIT", flag(variant.step_limit)),
    ]
}

fn look_constants(look: Look) -> Vec<(&'static str, f64)> {
    vec![
        ("SHOWS_LIGHT", flag(look.light)),
        ("SHOWS_STARS", flag(look.stars)),
        ("ALL_EFFECTS", flag(look.all_effects)),
        ("FOOTPRINTS", flag(look.footprints)),
    ]
}

fn film_constants(film: FilmLook) -> Vec<(&'static str, f64)> {
    vec![("FORMAT", film.format.into()), ("TONE_MAP", film.tone_map.into()), ("FALSE_COLOUR", flag(film.false_colour))]
}

/// Values of the `override` constants that the kernel's source declares.
fn constants(name: Name) -> Vec<(&'static str, f64)> {
    match name {
        Name::Pixels(variant) => [trace_constants(variant), vec![("AZIMUTH", flag(variant.azimuth))]].concat(),
        Name::Rays(variant) => trace_constants(variant),
        Name::ShadeSample(_, look) => look_constants(look),
        Name::ShadeOnly(_, look, film) => [look_constants(look), film_constants(film)].concat(),
        Name::Develop(film) => film_constants(film),
        Name::Export(_, footprints) => vec![("FOOTPRINTS", flag(footprints))],
        Name::Count => Vec::new(),
    }
}

fn layout(device: &Device, label: &str, slots: &[Slot]) -> Result<wgpu::BindGroupLayout> {
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
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
    device.scoped(label, |d| d.create_bind_group_layout(&descriptor))
}

impl Compiled {
    /// The pipeline with `groups`: of each the resources in the order of its slots.
    pub fn stage(&self, device: &Device, groups: &[&[wgpu::BindingResource<'_>]]) -> Result<Stage> {
        let bind = |(resources, layout): (&&[wgpu::BindingResource<'_>], &wgpu::BindGroupLayout)| {
            let entries = resources
                .iter()
                .zip(0..)
                .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
                .collect::<Vec<_>>();
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
            device.scoped("binding buffers", |d| d.create_bind_group(&descriptor))
        };
        let groups = groups.iter().zip(&self.layouts).map(bind).collect::<Result<Vec<_>>>()?;
        Ok(Stage { pipeline: self.pipeline.clone(), groups })
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
        self.run(pass, Some(offset), pixel_groups(size));
    }
}

/// Workgroups over a rectangle of pixels.
pub fn pixel_groups([width, height]: [u32; 2]) -> [u32; 2] {
    [width.div_ceil(GROUP[0]), height.div_ceil(GROUP[1])]
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
