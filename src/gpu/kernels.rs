//! The shaders, joined from their parts, and their pipelines, made at first use. Knows what each kernel binds, not what with.

use super::{Device, Kernel, Loops, ProvenFinite};
use crate::error::{Error, Result};
use crate::film::FilmParams;
use crate::physics::integrator::Method;
use crate::scene::Projection;
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
    format: u32,
    tone_map: u32,
    /// Number of the view; 0: light.
    false_colour: u32,
    target: PixelTarget,
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

    /// The WGSL that takes radiance: film, and where its pixels go.
    fn parts(self) -> [&'static str; 3] {
        let target = match self.target {
            PixelTarget::Screen => include_str!("../../shaders/screen.wgsl"),
            PixelTarget::Packed => include_str!("../../shaders/packed.wgsl"),
            PixelTarget::Rows => include_str!("../../shaders/packed_rows.wgsl"),
            PixelTarget::Light => {
                concat!(include_str!("../../shaders/f16.wgsl"), "\n", include_str!("../../shaders/light.wgsl"))
            }
        };
        [include_str!("../../shaders/film.wgsl"), include_str!("../../shaders/false_colour.wgsl"), target]
    }

    /// The group of `parts`.
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

const MATH: &str = include_str!("../../shaders/math.wgsl");
const FATE: &str = include_str!("../../shaders/fate.wgsl");
const GEODESIC: &str = include_str!("../../shaders/geodesic.wgsl");
const NYSTROM: &str = include_str!("../../shaders/nystrom.wgsl");
const CAMERA: &str = include_str!("../../shaders/camera.wgsl");
const LENS_AXIS: &str = include_str!("../../shaders/lens_axis.wgsl");
const KERR: &str = include_str!("../../shaders/lens_kerr.wgsl");
const SCHWARZSCHILD: &str = include_str!("../../shaders/lens_schwarzschild.wgsl");
const INTEGRATION: [&str; 3] =
    [NYSTROM, include_str!("../../shaders/integrator.wgsl"), include_str!("../../shaders/trace.wgsl")];
const PASS: &str = include_str!("../../shaders/pass.wgsl");
const FRAME: &str =
    concat!(include_str!("../../shaders/deciding.wgsl"), "\n", include_str!("../../shaders/frame.wgsl"));
const PROJECTION: &str = include_str!("../../shaders/projection.wgsl");
const TRACED_LAYOUT: &str = include_str!("../../shaders/traced_layout.wgsl");
const TRACED_FOOTPRINTS: &str = include_str!("../../shaders/traced_footprints.wgsl");
const INTEGRATED: &str = include_str!("../../shaders/samples_integrated.wgsl");
const RECORD: &str = include_str!("../../shaders/record.wgsl");
const EDGES: &str = include_str!("../../shaders/edges.wgsl");
const SHADE_RECORD: &str = include_str!("../../shaders/shade_record.wgsl");
const SHADE_ONLY: &str = include_str!("../../shaders/shade_only.wgsl");
const SHADE_SAMPLE: &str = include_str!("../../shaders/shade_sample.wgsl");

fn join(parts: &[&[&str]]) -> String {
    parts.concat().join("\n")
}

fn rays_source() -> String {
    join(&[&[MATH, FATE, GEODESIC], &INTEGRATION, &[include_str!("../../shaders/rays.wgsl")]])
}

fn pixels_source() -> String {
    let pixels = [PASS, TRACED_LAYOUT, FRAME, PROJECTION, CAMERA, include_str!("../../shaders/pixels.wgsl")];
    join(&[&[MATH, FATE, GEODESIC], &INTEGRATION, &pixels])
}

fn count_source() -> String {
    join(&[&[PASS, TRACED_LAYOUT, include_str!("../../shaders/count.wgsl")]])
}

impl Source {
    /// The WGSL that makes records, without what shading needs as well.
    fn parts(self) -> Vec<&'static str> {
        match self {
            Self::Traced => vec![TRACED_LAYOUT, TRACED_FOOTPRINTS, include_str!("../../shaders/traced.wgsl")],
            Self::Schwarzschild { .. } => {
                let record = include_str!("../../shaders/lens_schwarzschild_record.wgsl");
                vec![GEODESIC, CAMERA, LENS_AXIS, SCHWARZSCHILD, record]
            }
            Self::Kerr { rest, .. } => {
                let record = include_str!("../../shaders/lens_kerr_record.wgsl");
                let mut parts = vec![GEODESIC, CAMERA, LENS_AXIS, KERR, record];
                if rest {
                    parts.extend(INTEGRATION);
                    parts.push(include_str!("../../shaders/lens_kerr_rest.wgsl"));
                } else {
                    parts.push(include_str!("../../shaders/lens_kerr_pixel.wgsl"));
                }
                parts
            }
        }
    }

    /// The WGSL that makes records of refine.wgsl's samples.
    fn sample_parts(self) -> Vec<&'static str> {
        match self {
            Self::Traced => {
                let samples = [INTEGRATED, include_str!("../../shaders/samples_traced.wgsl")];
                [&[GEODESIC, CAMERA, TRACED_LAYOUT, TRACED_FOOTPRINTS], &INTEGRATION[..], &samples].concat()
            }
            Self::Schwarzschild { .. } => self.parts(),
            Self::Kerr { .. } => {
                let record = include_str!("../../shaders/lens_kerr_record.wgsl");
                let samples = [INTEGRATED, include_str!("../../shaders/samples_kerr.wgsl")];
                [&[GEODESIC, CAMERA, LENS_AXIS, KERR, record], &INTEGRATION[..], &samples].concat()
            }
        }
    }

    /// What goes over the pixels: the entry point, and its WGSL.
    fn driver(self, target: Option<PixelTarget>) -> (&'static str, &'static str) {
        match (self, target) {
            (Self::Kerr { rest: true, .. }, _) => ("each_deferred", include_str!("../../shaders/each_deferred.wgsl")),
            (_, Some(PixelTarget::Rows)) => ("each_pixel", include_str!("../../shaders/each_pixel_rows.wgsl")),
            _ => ("each_pixel", include_str!("../../shaders/each_pixel.wgsl")),
        }
    }

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

/// The kernels that fill a spin-0 lens: `kernel` on top of the rays of the nodes.
fn schwarzschild_build_source(kernel: &str) -> String {
    let curve = include_str!("../../shaders/lens_schwarzschild_curve.wgsl");
    join(&[&[MATH, GEODESIC, NYSTROM, FRAME, CAMERA, LENS_AXIS, SCHWARZSCHILD, curve, kernel]])
}

fn kerr_nodes_source() -> String {
    // Nodes keep their crossings by themselves.
    const ON_CROSSING: &str = "fn on_crossing(c: Constants, crossing: PlaneCrossing) {}";
    let parts = [FRAME, CAMERA, LENS_AXIS, KERR, ON_CROSSING, include_str!("../../shaders/lens_kerr_nodes.wgsl")];
    join(&[&[MATH, FATE, GEODESIC], &INTEGRATION, &parts])
}

fn kerr_flags_source() -> String {
    join(&[&[MATH, FRAME, LENS_AXIS, KERR, include_str!("../../shaders/lens_kerr_flags.wgsl")]])
}

fn schwarzschild_ends_source() -> String {
    schwarzschild_build_source(include_str!("../../shaders/lens_schwarzschild_ends.wgsl"))
}

fn schwarzschild_columns_source() -> String {
    schwarzschild_build_source(include_str!("../../shaders/lens_schwarzschild_columns.wgsl"))
}

/// `parts`: what makes the records.
fn shade_source(parts: &[&str], rest: &[&str]) -> String {
    let shade = [
        include_str!("../../shaders/blackbody.wgsl"),
        include_str!("../../shaders/stars.wgsl"),
        include_str!("../../shaders/sky_map.wgsl"),
        include_str!("../../shaders/sky_grid.wgsl"),
        include_str!("../../shaders/disk.wgsl"),
        include_str!("../../shaders/turbulence.wgsl"),
        include_str!("../../shaders/shade.wgsl"),
    ];
    let constants = sky::StarIndex::wgsl_constants();
    join(&[&[constants.as_str(), MATH, FATE, PASS, RECORD, FRAME, PROJECTION], parts, &shade, rest])
}

fn shade_sample_source(source: Source) -> String {
    let (_, driver) = source.driver(None);
    shade_source(&source.parts(), &[driver, EDGES, SHADE_RECORD, SHADE_SAMPLE])
}

fn shade_only_source(source: Source, film: FilmLook) -> String {
    let [develop, colour, put] = film.parts();
    let (_, driver) = source.driver(Some(film.target));
    let rest = [driver, develop, colour, put, EDGES, SHADE_RECORD, SHADE_ONLY];
    shade_source(&source.parts(), &rest)
}

/// `film`: of pixels with one sample.
fn refine_source(source: Source, film: Option<FilmLook>) -> String {
    let mut rest = vec![EDGES, include_str!("../../shaders/refine.wgsl")];
    match film {
        Some(film) => rest.extend(film.parts().into_iter().chain([SHADE_ONLY])),
        None => rest.push(SHADE_SAMPLE),
    }
    shade_source(&source.sample_parts(), &rest)
}

fn export_source(source: Source) -> String {
    let (_, driver) = source.driver(None);
    let parts = [MATH, FATE, PASS, RECORD, FRAME, PROJECTION, driver, include_str!("../../shaders/export.wgsl")];
    join(&[&parts, &source.parts()])
}

fn develop_source(film: FilmLook, glare: bool) -> String {
    let driver = match film.target {
        PixelTarget::Screen | PixelTarget::Packed | PixelTarget::Light => include_str!("../../shaders/develop.wgsl"),
        PixelTarget::Rows => include_str!("../../shaders/develop_rows.wgsl"),
    };
    let light: &[&str] = match glare {
        true => &[BLOOM, include_str!("../../shaders/glare.wgsl")],
        false => &[include_str!("../../shaders/summed.wgsl")],
    };
    join(&[&[PASS], light, &film.parts(), &[driver]])
}

const BLOOM: &str = include_str!("../../shaders/bloom.wgsl");

/// A kernel of bloom.
fn bloom_source(kernel: &str) -> String {
    join(&[&[BLOOM, include_str!("../../shaders/f16.wgsl"), kernel]])
}

fn gather_source() -> String {
    bloom_source(include_str!("../../shaders/bloom_gather.wgsl"))
}

fn gather_base_source() -> String {
    bloom_source(include_str!("../../shaders/bloom_base.wgsl"))
}

fn give_back_source() -> String {
    bloom_source(include_str!("../../shaders/bloom_return.wgsl"))
}

/// Every shader of this tracer, joined from its parts as the device gets it: name and WGSL.
pub fn shader_sources() -> Vec<(&'static str, String)> {
    let film = |target| FilmLook { format: 1, tone_map: 1, false_colour: 0, target };
    let kerr = |rest| Source::Kerr { delay: true, pattern: true, moving: true, rest };
    let sources = [
        ["shade sample, traced", "shade only, traced", "export, traced"],
        ["shade sample, spin-0 lens", "shade only, spin-0 lens", "export, spin-0 lens"],
        ["shade sample, Kerr lens", "shade only, Kerr lens", "export, Kerr lens"],
        ["shade sample, Kerr rest", "shade only, Kerr rest", "export, Kerr rest"],
    ]
    .into_iter()
    .zip([Source::Traced, Source::Schwarzschild { delay: true, moving: true }, kerr(false), kerr(true)]);
    let of_sources = sources.flat_map(|([sample, only, export], source)| {
        [
            (sample, shade_sample_source(source)),
            (only, shade_only_source(source, film(PixelTarget::Packed))),
            (export, export_source(source)),
        ]
    });
    let others = [
        ("rays", rays_source()),
        ("pixels", pixels_source()),
        ("count", count_source()),
        ("present", super::present::present_source()),
        ("develop", develop_source(film(PixelTarget::Packed), false)),
        ("develop for a window", develop_source(film(PixelTarget::Screen), false)),
        ("develop by rows", develop_source(film(PixelTarget::Rows), false)),
        ("develop for bloom", develop_source(FilmLook::of_light(), false)),
        ("develop with glare", develop_source(film(PixelTarget::Packed), true)),
        ("develop with glare for a window", develop_source(film(PixelTarget::Screen), true)),
        ("develop with glare by rows", develop_source(film(PixelTarget::Rows), true)),
        ("bloom, gather", gather_source()),
        ("bloom, gather pixels", gather_base_source()),
        ("bloom, give back", give_back_source()),
        ("shade only for bloom", shade_only_source(kerr(false), FilmLook::of_light())),
        ("refine, traced", refine_source(Source::Traced, Some(film(PixelTarget::Packed)))),
        (
            "refine, spin-0 lens",
            refine_source(Source::Schwarzschild { delay: true, moving: true }, Some(film(PixelTarget::Packed))),
        ),
        ("refine, Kerr lens", refine_source(kerr(true), Some(film(PixelTarget::Packed)))),
        ("refine for a window", refine_source(kerr(true), Some(film(PixelTarget::Screen)))),
        ("refine one of several samples", refine_source(kerr(true), None)),
        ("shade only for a window", shade_only_source(kerr(false), film(PixelTarget::Screen))),
        ("shade only by rows", shade_only_source(kerr(false), film(PixelTarget::Rows))),
        ("spin-0 lens, ends", schwarzschild_ends_source()),
        ("spin-0 lens, columns", schwarzschild_columns_source()),
        ("Kerr lens, nodes", kerr_nodes_source()),
        ("Kerr lens, flags", kerr_flags_source()),
    ];
    others.into_iter().chain(of_sources).collect()
}

/// What a binding is.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Slot {
    Uniform,
    /// A uniform of which each dispatch chooses a part.
    UniformPart,
    Read,
    Write,
    Texture(TextureKind),
    /// A texture that a sampler filters.
    Filtered(TextureKind),
    Sampler,
    TextureWrite(TextureKind),
}

/// A texture as a kernel declares it.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
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

/// Light that bloom spreads, of frames and of grids: exposed_light, finer, coarser and glare of the shaders.
pub const LIGHT: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba16Float, dimension: wgpu::TextureViewDimension::D2 };

/// What a window is filled from: 8-bit codes, whatever curve they follow.
pub const SCREEN: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba8Unorm, dimension: wgpu::TextureViewDimension::D2 };

/// Tables of a lens: a row for each branch; and columns, a layer for each branch.
pub const LENS_ROWS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 };
pub const LENS_COLUMNS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2Array };
/// Flags of a lens's cells.
pub const LENS_FLAGS: TextureKind =
    TextureKind { format: wgpu::TextureFormat::R32Uint, dimension: wgpu::TextureViewDimension::D2 };
/// Threads of a workgroup of the kernels that build spin-0 lenses.
pub const LENS_GROUP: u32 = 32;

/// `light_tables`, `star_cells`, `milky_way` and `sky_map` of shade.wgsl.
const TABLES: [TextureKind; 4] = [
    TextureKind { format: wgpu::TextureFormat::Rgba32Float, dimension: wgpu::TextureViewDimension::D2 },
    TextureKind { format: wgpu::TextureFormat::R32Uint, dimension: wgpu::TextureViewDimension::D2 },
    SKY_MAP,
    SKY_MAP,
];

/// Pyramids of sky_map.wgsl.
pub const SKY_MAP: TextureKind =
    TextureKind { format: wgpu::TextureFormat::Rgb9e5Ufloat, dimension: wgpu::TextureViewDimension::D2 };

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
            Self::Filtered(of) => wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: of.dimension,
                multisampled: false,
            },
            Self::Sampler => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
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
            Self::Schwarzschild { .. } => {
                let [swept, u, delay] = [LENS_ROWS, LENS_COLUMNS, LENS_COLUMNS].map(Slot::Texture);
                vec![Slot::Uniform, swept, u, delay]
            }
            Self::Kerr { .. } => {
                let [curve, sky, crossings, flags] =
                    [LENS_ROWS, LENS_ROWS, LENS_COLUMNS, LENS_FLAGS].map(Slot::Texture);
                vec![Slot::Uniform, curve, sky, crossings, flags, Slot::Write]
            }
        }
    }
}

/// Group 0 of shade.wgsl.
fn shade_slots() -> Vec<Slot> {
    let [light, cells, milky_way, map] = TABLES.map(Slot::Texture);
    vec![Slot::Uniform, Slot::UniformPart, light, cells, milky_way, map]
}

/// Group 2 of shade_sample.wgsl.
fn sum_slots() -> Vec<Slot> {
    vec![Slot::Texture(RADIANCE), Slot::TextureWrite(RADIANCE)]
}

/// Group 3 of edges.wgsl.
fn edge_slots() -> Vec<Slot> {
    vec![Slot::Write]
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

    /// Group 3, the list of pixels with edges, is for the caller to set.
    pub fn shade_sample(&mut self, device: &Device, source: Source, look: Look) -> Result<Compiled> {
        let groups = [shade_slots(), source.slots(), sum_slots(), edge_slots()];
        let (entry_point, _) = source.driver(None);
        self.get(device, Name::ShadeSample(source, look), &groups, entry_point, || shade_sample_source(source))
    }

    /// Groups 2, which puts the pixels, and 3, the list of those with edges, are for the caller to set.
    pub fn shade_only(&mut self, device: &Device, source: Source, look: Look, film: FilmLook) -> Result<Compiled> {
        let film = film.over(source);
        let groups = [shade_slots(), source.slots(), film.slots(), edge_slots()];
        let wgsl = || shade_only_source(source, film);
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
        let wgsl = || refine_source(refined.source, film);
        self.get(device, Name::Refine(refined, look, film), &groups, "refine", wgsl)
    }

    /// `glare`: with bloom, pixels along a cell's side. Group 2, which puts the pixels, is for the caller to set.
    pub fn develop(&mut self, device: &Device, film: FilmLook, glare: Option<u32>) -> Result<Compiled> {
        let light = match glare {
            Some(_) => vec![Slot::Texture(LIGHT), Slot::Filtered(LIGHT), Slot::Sampler, Slot::Uniform],
            None => vec![Slot::Texture(RADIANCE)],
        };
        let groups = [vec![Slot::UniformPart], light, film.slots()];
        self.get(device, Name::Develop(film, glare), &groups, "develop_tile", || develop_source(film, glare.is_some()))
    }

    /// For cells of `step` x `step` pixels, or of finer cells.
    pub fn gather(&mut self, device: &Device, step: u32, grid: bool) -> Result<Compiled> {
        let slots = vec![Slot::UniformPart, Slot::Texture(LIGHT), Slot::TextureWrite(LIGHT)];
        self.get(device, Name::Gather(step, grid), &[slots], "gather", gather_source)
    }

    /// For cells of 2 x 2 pixels.
    pub fn gather_base(&mut self, device: &Device) -> Result<Compiled> {
        let slots = vec![Slot::UniformPart, Slot::Filtered(LIGHT), Slot::Sampler, Slot::TextureWrite(LIGHT)];
        self.get(device, Name::GatherBase, &[slots], "gather", gather_base_source)
    }

    pub fn give_back(&mut self, device: &Device) -> Result<Compiled> {
        let [finer, coarser] = [Slot::Texture(LIGHT), Slot::Filtered(LIGHT)];
        let slots = vec![Slot::UniformPart, finer, coarser, Slot::Sampler, Slot::TextureWrite(LIGHT)];
        self.get(device, Name::GiveBack, &[slots], "give_back", give_back_source)
    }

    pub fn export(&mut self, device: &Device, source: Source, look: Look) -> Result<Compiled> {
        let groups = [vec![Slot::Uniform, Slot::UniformPart], source.slots(), vec![Slot::Write]];
        let (entry_point, _) = source.driver(None);
        let name = Name::Export(source, look.footprints, look.projection);
        self.get(device, name, &groups, entry_point, || export_source(source))
    }

    pub fn find_schwarzschild_ends(&mut self, device: &Device) -> Result<Compiled> {
        let slots = vec![Slot::Uniform, Slot::Uniform, Slot::TextureWrite(LENS_ROWS)];
        self.get(device, Name::SchwarzschildEnds, &[slots], "find_ends", schwarzschild_ends_source)
    }

    pub fn fill_schwarzschild_columns(&mut self, device: &Device, delay: bool) -> Result<Compiled> {
        let [swept, u, delays] = [LENS_ROWS, LENS_COLUMNS, LENS_COLUMNS].map(Slot::TextureWrite);
        let slots = vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), swept, u, delays];
        let name = Name::SchwarzschildColumns { delay };
        self.get(device, name, &[slots], "fill_columns", schwarzschild_columns_source)
    }

    pub fn trace_kerr_nodes(&mut self, device: &Device, delay: bool, pattern: bool) -> Result<Compiled> {
        let [sky, crossings] = [LENS_ROWS, LENS_COLUMNS].map(Slot::TextureWrite);
        let slots = vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), sky, crossings];
        self.get(device, Name::KerrNodes { delay, pattern }, &[slots], "trace_nodes", kerr_nodes_source)
    }

    pub fn flag_kerr_cells(&mut self, device: &Device, pattern: bool) -> Result<Compiled> {
        let [curve, sky, crossings] = [LENS_ROWS, LENS_ROWS, LENS_COLUMNS].map(Slot::Texture);
        let flags = Slot::TextureWrite(LENS_FLAGS);
        let slots = vec![Slot::Uniform, Slot::Uniform, curve, sky, crossings, flags];
        self.get(device, Name::KerrFlags { pattern }, &[slots], "flag_cells", kerr_flags_source)
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
/// loops counted over constants (of a pipeline or of all), over the samples of a pixel (64 at most), over the words of a pixel (4 at most), over the pixels of a tile, over the crossings of a record (the host keeps `max_crossings` and `orders` at 16 or less), or over deferred pixels or those of a list of edges, of which
/// there are fewer than 2^31; that of `map_light` over the taps of a pixel, at most 7, and two levels; loops over the bits of a word, which loses a bit in every turn; and the two of `star_light`, of
/// which every turn uses up a star of the cell's list, at most 255, or a mean sky, of which there are two, or ends the loop.
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
