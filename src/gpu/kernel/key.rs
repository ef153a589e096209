//! Every kernel of the tracer by what decides how it is compiled: its entry point, WGSL, constants and bindings. Knows
//! neither devices nor pipelines; two equal keys are the same kernel.

use super::slots::{
    LENS_COLUMNS, LENS_FLAGS, LENS_ROWS, LIGHT, RADIANCE, SCREEN, Slot, TRACED, edge_slots, shade_slots, sum_slots,
};
use super::wgsl;
use crate::error::Result;
use crate::image::PixelFormat;
use crate::physics::integrator::Method;
use crate::scene::{Film, Projection, ToneMap, View};

/// Everything that decides how the tracing kernels are compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    pub method: MethodCode,
    pub spinning: bool,
    pub delay: bool,
    pub step_limit: bool,
    /// Whether pixels keep where on the disk a crossing is; given rays always do.
    pub azimuth: bool,
    /// The projection of pixels; given rays have none. `None`: any, which the kernel asks while it runs.
    pub projection: Option<Projection>,
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
    /// `None`: any, which the kernel asks while it runs.
    pub projection: Option<Projection>,
    /// Whether pixels with edges get more rays; values of views are not to be averaged.
    pub refines: bool,
}

/// Everything that decides how development is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FilmLook {
    /// `None`: any, which the kernel asks while it runs.
    pub(in crate::gpu) pixels: Option<PixelKind>,
    /// Pixels show a view other than light in false colour.
    pub(in crate::gpu) false_colour: bool,
    /// `None`: any, which the kernel asks while it runs. `ToneMap::None` where it does not matter.
    pub(in crate::gpu) tone_map: Option<ToneMap>,
    pub(in crate::gpu) target: PixelTarget,
}

/// Pixel formats that one kernel serves: `PIXELS` of film/film.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelKind {
    /// RGBA8 and BGRA8.
    EightBit,
    /// RGBA16F and RGBA32F.
    Float,
    R32F,
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

/// The value of a constant whose choice the kernel asks the uniform for while it runs.
pub(in crate::gpu) const FROM_UNIFORM: u32 = u32::MAX;

impl FilmLook {
    /// For `film` in pixels of `format`.
    pub fn new(film: &Film, view: View, format: PixelFormat, target: PixelTarget) -> Self {
        let pixels = match format {
            PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb => PixelKind::EightBit,
            PixelFormat::Rgba16F | PixelFormat::Rgba32F => PixelKind::Float,
            PixelFormat::R32F => PixelKind::R32F,
        };
        let shows_light = view == View::Light;
        let tone_map = if shows_light && pixels == PixelKind::EightBit { film.tone_map } else { ToneMap::None };
        Self { pixels: Some(pixels), false_colour: !shows_light, tone_map: Some(tone_map), target }
    }

    /// The same for every tone map, and, but in windows, which have one kind of pixels, for every format. Views other
    /// than light have no tone map.
    pub fn of_any(self) -> Self {
        let pixels = self.pixels.filter(|_| self.target == PixelTarget::Screen);
        Self { pixels, tone_map: self.false_colour.then_some(ToneMap::None), ..self }
    }

    /// Whether hosts begin with such pixels, which have kernels of their own (`GpuTracer::set_up`): light in 8 bits by
    /// ACES, the default.
    pub fn is_usual(self) -> bool {
        self.pixels == Some(PixelKind::EightBit) && self.tone_map == Some(ToneMap::Aces)
    }

    /// Of light that bloom is to spread.
    pub fn of_light() -> Self {
        let (tone_map, target) = (Some(ToneMap::None), PixelTarget::Light);
        Self { pixels: Some(PixelKind::Float), false_colour: false, tone_map, target }
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

    /// The group of film/film.wgsl and what puts the pixels.
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

/// The maker of the ray records that a kernel reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Source {
    /// traced/record.wgsl
    Traced,
    /// lens/schwarzschild_record.wgsl
    Schwarzschild { delay: bool, moving: bool },
    /// lens/kerr_pixel.wgsl, and of the pixels it defers lens/kerr_rest.wgsl
    Kerr { delay: bool, pattern: bool, moving: bool, rest: bool },
}

/// How refine/refine.wgsl finds its samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Refined {
    /// Of the pixels' own records.
    pub source: Source,
    /// How rays are traced that no table holds.
    pub variant: Variant,
}

/// `METHOD_*` of geodesic/integrator.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MethodCode(pub(in crate::gpu) u32);

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
pub enum KernelKey {
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
    Export(Source, bool, Option<Projection>),
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

/// Threads of a workgroup of the kernels that go over pixels.
pub const GROUP: [u32; 2] = [8, 16];
/// The same of those that put them row by row.
pub(in crate::gpu) const ROWS_GROUP: [u32; 2] = [32, 4];
/// Threads of a workgroup of the kernels that build spin-0 lenses.
pub const LENS_GROUP: u32 = 32;

impl KernelKey {
    /// Group 3, the list of pixels with edges, is for the caller to set.
    pub fn shade_sample(source: Source, look: Look) -> Self {
        Self::ShadeSample(source, look)
    }

    /// Groups 2, which puts the pixels, and 3, the list of those with edges, are for the caller to set.
    pub fn shade_only(source: Source, look: Look, film: FilmLook) -> Self {
        Self::ShadeOnly(source, look, film.over(source))
    }

    /// Groups 2 and 3 as `shade_only`, or, without `film`, `shade_sample`.
    pub fn refine(refined: Refined, look: Look, film: Option<FilmLook>) -> Self {
        // The disk may cover but a part of a sample's cell.
        Self::Refine(refined, Look { opaque: false, ..look }, film.map(FilmLook::scattered))
    }

    pub fn export(source: Source, look: Look) -> Self {
        Self::Export(source, look.footprints, look.projection)
    }

    pub fn entry_point(self) -> &'static str {
        match self {
            Self::Pixels(_) => "trace_pixels",
            Self::Rays(_) => "trace_rays",
            Self::Count => "count_steps",
            Self::ShadeSample(source, _) | Self::Export(source, ..) => source.driver(None).0,
            Self::ShadeOnly(source, _, film) => source.driver(Some(film.target)).0,
            Self::Refine(..) => "refine",
            Self::Develop(..) => "develop_tile",
            Self::Gather(..) | Self::GatherBase => "gather",
            Self::GiveBack => "give_back",
            Self::SchwarzschildEnds => "find_ends",
            Self::SchwarzschildColumns { .. } => "fill_columns",
            Self::KerrNodes { .. } => "trace_nodes",
            Self::KerrFlags { .. } => "flag_cells",
        }
    }

    /// The WGSL that declares the entry point. Errors: as [`wgsl::kernel`].
    pub fn wgsl(self) -> Result<String> {
        match self {
            Self::Pixels(_) => wgsl::kernel("traced/pixels"),
            Self::Rays(_) => wgsl::kernel("geodesic/rays"),
            Self::Count => wgsl::kernel("traced/count"),
            Self::ShadeSample(source, _) => wgsl::shade_sample(source),
            Self::ShadeOnly(source, _, film) => wgsl::shade_only(source, film),
            Self::Refine(refined, _, film) => wgsl::refine(refined.source, film),
            Self::Develop(film, glare) => wgsl::develop(film, glare.is_some()),
            Self::Gather(..) => wgsl::kernel("bloom/gather"),
            Self::GatherBase => wgsl::kernel("bloom/base"),
            Self::GiveBack => wgsl::kernel("bloom/return"),
            Self::Export(source, ..) => wgsl::export(source),
            Self::SchwarzschildEnds => wgsl::kernel("lens/schwarzschild_ends"),
            Self::SchwarzschildColumns { .. } => wgsl::kernel("lens/schwarzschild_columns"),
            Self::KerrNodes { .. } => wgsl::kernel("lens/kerr_nodes"),
            Self::KerrFlags { .. } => wgsl::kernel("lens/kerr_flags"),
        }
    }

    /// The kernel's groups of bindings, those for the caller to set among them.
    pub fn groups(self) -> Vec<Vec<Slot>> {
        let [sky, meta, disk] = TRACED.map(Slot::TextureWrite);
        let [rows, columns] = [LENS_ROWS, LENS_COLUMNS].map(Slot::TextureWrite);
        match self {
            Self::Pixels(_) => vec![vec![Slot::Uniform, Slot::UniformPart, sky, meta, disk]],
            Self::Count => vec![vec![Slot::UniformPart, Slot::Texture(TRACED[1]), Slot::Write]],
            Self::Rays(_) => vec![vec![Slot::Uniform, Slot::Read, Slot::Write]],
            Self::ShadeSample(source, _) => vec![shade_slots(), source.slots(), sum_slots(), edge_slots()],
            Self::ShadeOnly(source, _, film) => vec![shade_slots(), source.slots(), film.slots(), edge_slots()],
            Self::Refine(refined, _, film) => {
                let target = film.map_or_else(sum_slots, FilmLook::slots);
                vec![shade_slots(), refined.source.slots(), target, edge_slots()]
            }
            Self::Develop(film, glare) => {
                let light = match glare {
                    Some(_) => vec![Slot::Texture(LIGHT), Slot::Filtered(LIGHT), Slot::Sampler, Slot::Uniform],
                    None => vec![Slot::Texture(RADIANCE)],
                };
                vec![vec![Slot::UniformPart], light, film.slots()]
            }
            Self::Gather(..) => vec![vec![Slot::UniformPart, Slot::Texture(LIGHT), Slot::TextureWrite(LIGHT)]],
            Self::GatherBase => {
                vec![vec![Slot::UniformPart, Slot::Filtered(LIGHT), Slot::Sampler, Slot::TextureWrite(LIGHT)]]
            }
            Self::GiveBack => {
                let [finer, coarser] = [Slot::Texture(LIGHT), Slot::Filtered(LIGHT)];
                vec![vec![Slot::UniformPart, finer, coarser, Slot::Sampler, Slot::TextureWrite(LIGHT)]]
            }
            Self::Export(source, ..) => {
                vec![vec![Slot::Uniform, Slot::UniformPart], source.slots(), vec![Slot::Write]]
            }
            Self::SchwarzschildEnds => vec![vec![Slot::Uniform, Slot::Uniform, rows]],
            Self::SchwarzschildColumns { .. } => {
                vec![vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), rows, columns, columns]]
            }
            Self::KerrNodes { .. } => {
                vec![vec![Slot::Uniform, Slot::Uniform, Slot::Texture(LENS_ROWS), rows, columns]]
            }
            Self::KerrFlags { .. } => {
                let [curve, sky, crossings] = [LENS_ROWS, LENS_ROWS, LENS_COLUMNS].map(Slot::Texture);
                vec![vec![Slot::Uniform, Slot::Uniform, curve, sky, crossings, Slot::TextureWrite(LENS_FLAGS)]]
            }
        }
    }

    /// Threads of a workgroup, for kernels that go over pixels.
    pub fn workgroup(self) -> [u32; 2] {
        match self {
            Self::ShadeOnly(_, _, film) | Self::Develop(film, _) => film.group(),
            _ => GROUP,
        }
    }

    /// Values of the `override` constants that the kernel's source declares.
    pub fn constants(self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Pixels(variant) => {
                let pixels = vec![("AZIMUTH", flag(variant.azimuth)), projection_constant(variant.projection)];
                [trace_constants(variant), pixels].concat()
            }
            Self::Rays(variant) => trace_constants(variant),
            Self::ShadeSample(source, look) => [source.constants(), look_constants(look)].concat(),
            Self::ShadeOnly(source, look, film) => {
                [source.constants(), look_constants(look), film_constants(film)].concat()
            }
            Self::Refine(refined, look, film) => {
                let traced = match refined.source {
                    Source::Traced => trace_constants(refined.variant),
                    _ => refined.source.constants(),
                };
                let film = film.map_or_else(Vec::new, film_constants);
                [traced, look_constants(look), film, vec![("WHOLE_PLANE", 1.0)]].concat()
            }
            Self::Develop(film, None) => film_constants(film),
            Self::Develop(film, Some(step)) => [film_constants(film), vec![("STEP", step.into())]].concat(),
            Self::Gather(step, grid) => vec![("STEP", step.into()), ("GRID", flag(grid))],
            Self::GatherBase | Self::GiveBack => Vec::new(),
            Self::Export(source, footprints, projection) => {
                let export = vec![("FOOTPRINTS", flag(footprints)), projection_constant(projection)];
                [source.constants(), export].concat()
            }
            Self::SchwarzschildEnds => vec![("SPINNING", 0.0), ("DELAY", 0.0)],
            Self::SchwarzschildColumns { delay } => vec![("SPINNING", 0.0), ("DELAY", flag(delay))],
            Self::KerrNodes { delay, pattern } => vec![("DELAY", flag(delay)), ("PATTERN", flag(pattern))],
            Self::KerrFlags { pattern } => vec![("PATTERN", flag(pattern))],
            Self::Count => Vec::new(),
        }
    }
}

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

fn projection_constant(projection: Option<Projection>) -> (&'static str, f64) {
    ("PROJECTION", projection.map_or(FROM_UNIFORM, |projection| projection as u32).into())
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
    vec![
        ("PIXELS", film.pixels.map_or(FROM_UNIFORM, |pixels| pixels as u32).into()),
        ("FALSE_COLOUR", flag(film.false_colour)),
        ("TONE_MAP", film.tone_map.map_or(FROM_UNIFORM, |tone_map| tone_map as u32).into()),
    ]
}
