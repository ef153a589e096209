//! The shaders, joined from their parts, and their pipelines, made at first use. Knows what each kernel binds, not what with.

use super::{Device, Kernel, Loops, ProvenFinite};
use crate::error::{Error, Result};
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
    pub turbulent: bool,
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
    Shade(Look),
    Develop,
}

/// The pipelines of one device.
#[derive(Default)]
pub struct Kernels {
    made: HashMap<Name, Compiled>,
}

/// A pipeline and the layout of its group 0.
#[derive(Clone)]
pub struct Compiled {
    pub pipeline: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

const MATH: &str = include_str!("../../shaders/math.wgsl");
const TRACE_PARTS: [&str; 4] = [
    MATH,
    include_str!("../../shaders/geodesic.wgsl"),
    include_str!("../../shaders/integrator.wgsl"),
    include_str!("../../shaders/trace.wgsl"),
];
const PASS: &str = include_str!("../../shaders/pass.wgsl");
const RECORD_PART: &str = include_str!("../../shaders/record.wgsl");
const FRAME: &str = include_str!("../../shaders/frame.wgsl");

fn rays_source() -> String {
    [TRACE_PARTS.as_slice(), &[include_str!("../../shaders/rays.wgsl")]].concat().join("\n")
}

fn pixels_source() -> String {
    let rest = [
        PASS,
        RECORD_PART,
        FRAME,
        include_str!("../../shaders/camera.wgsl"),
        include_str!("../../shaders/pixels.wgsl"),
    ];
    [TRACE_PARTS.as_slice(), &rest].concat().join("\n")
}

fn count_source() -> String {
    [PASS, RECORD_PART, include_str!("../../shaders/count.wgsl")].join("\n")
}

fn shade_source() -> String {
    [
        sky::StarIndex::shared().wgsl_constants().as_str(),
        MATH,
        PASS,
        RECORD_PART,
        FRAME,
        include_str!("../../shaders/blackbody.wgsl"),
        include_str!("../../shaders/stars.wgsl"),
        include_str!("../../shaders/disk.wgsl"),
        include_str!("../../shaders/turbulence.wgsl"),
        include_str!("../../shaders/shade.wgsl"),
    ]
    .join("\n")
}

fn develop_source() -> String {
    [PASS, include_str!("../../shaders/film.wgsl"), include_str!("../../shaders/develop.wgsl")].join("\n")
}

/// Every shader of this tracer, joined from its parts as the device gets it: name and WGSL.
pub fn shader_sources() -> Vec<(&'static str, String)> {
    vec![
        ("rays", rays_source()),
        ("pixels", pixels_source()),
        ("count", count_source()),
        ("shade", shade_source()),
        ("develop", develop_source()),
    ]
}

/// What a binding of group 0 is.
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

/// `record_sky`, `record_meta` and `record_disk` of record.wgsl.
pub const RECORD: [TextureKind; 3] = [
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::Rgba32Uint, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2Array },
];

/// Radiance of shade.wgsl and develop.wgsl.
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

impl Kernels {
    pub fn pixels(&mut self, device: &Device, variant: Variant) -> Result<Compiled> {
        let [sky, meta, disk] = RECORD.map(Slot::TextureWrite);
        let slots = [Slot::Uniform, Slot::UniformPart, sky, meta, disk];
        self.get(device, Name::Pixels(variant), &slots, "trace_pixels", pixels_source)
    }

    pub fn count(&mut self, device: &Device) -> Result<Compiled> {
        let slots = [Slot::UniformPart, Slot::Texture(RECORD[1]), Slot::Write];
        self.get(device, Name::Count, &slots, "count_steps", count_source)
    }

    pub fn rays(&mut self, device: &Device, variant: Variant) -> Result<Compiled> {
        let slots = [Slot::Uniform, Slot::Read, Slot::Write];
        self.get(device, Name::Rays(variant), &slots, "trace_rays", rays_source)
    }

    pub fn shade(&mut self, device: &Device, look: Look) -> Result<Compiled> {
        let [sky, meta, disk] = RECORD.map(Slot::Texture);
        let [light, cells] = TABLES.map(Slot::Texture);
        let slots = [
            Slot::Uniform,
            Slot::UniformPart,
            sky,
            meta,
            disk,
            light,
            cells,
            Slot::Texture(RADIANCE),
            Slot::TextureWrite(RADIANCE),
        ];
        self.get(device, Name::Shade(look), &slots, "shade", shade_source)
    }

    pub fn develop(&mut self, device: &Device) -> Result<Compiled> {
        let slots = [Slot::Uniform, Slot::UniformPart, Slot::Texture(RADIANCE), Slot::Write];
        self.get(device, Name::Develop, &slots, "develop_tile", develop_source)
    }

    fn get(
        &mut self,
        device: &Device,
        name: Name,
        slots: &[Slot],
        entry_point: &str,
        source: impl FnOnce() -> String,
    ) -> Result<Compiled> {
        if let Some(compiled) = self.made.get(&name) {
            return Ok(compiled.clone());
        }
        let layout = layout(device, entry_point, slots)?;
        let constants = constants(name);
        let source = source();
        let pipeline = device.compute_pipeline(&Kernel {
            label: entry_point,
            source: &[&source],
            loops: LOOPS,
            entry_point,
            constants: &constants,
            zero_workgroup_memory: false,
            groups: &[&layout],
        })?;
        let compiled = Compiled { pipeline, layout };
        self.made.insert(name, compiled.clone());
        Ok(compiled)
    }
}

/// SAFETY of the promise: every loop in shaders/ is one of: the inner loop of `trace`, which adds 1 to `steps` in every turn before
/// it can `continue` and ends at `max_steps` <= 100000; its outer loop, which ends unless the inner one has taken a step;
/// loops counted over constants or over the pixels of a tile; one over the bits of a word, which loses a bit in every turn; and the search of `star_light`, of which
/// every turn uses up a star of the cell's list, as long as the host's own table says, or a part of the mean sky.
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

/// Values of the `override` constants that the kernel's source declares.
fn constants(name: Name) -> Vec<(&'static str, f64)> {
    match name {
        Name::Pixels(variant) => [trace_constants(variant), vec![("AZIMUTH", flag(variant.azimuth))]].concat(),
        Name::Rays(variant) => trace_constants(variant),
        Name::Shade(look) => vec![
            ("SHOWS_LIGHT", flag(look.light)),
            ("SHOWS_STARS", flag(look.stars)),
            ("ALL_EFFECTS", flag(look.all_effects)),
            ("TURBULENT", flag(look.turbulent)),
        ],
        Name::Count | Name::Develop => Vec::new(),
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
    /// Group 0 with `resources` in the order of its slots.
    pub fn bind(&self, device: &Device, resources: &[wgpu::BindingResource<'_>]) -> Result<wgpu::BindGroup> {
        let entries = resources
            .iter()
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect::<Vec<_>>();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &self.layout, entries: &entries };
        device.scoped("binding buffers", |d| d.create_bind_group(&descriptor))
    }
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
