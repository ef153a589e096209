// SPDX-License-Identifier: MIT OR Apache-2.0
//! The variants that kernels are compiled in: how rays are traced, light is shaded, and pixels are written. Plain data.

use crate::image::PixelFormat;
use crate::physics::integrator::Method;
use crate::scene::{ColourMap, Film, MOST_OUTPUTS, Projection, RayOutput, ToneMap, View};

/// Threads of a workgroup of the kernels that go over pixels.
pub const GROUP: [u32; 2] = [8, 16];
/// Threads of a workgroup of the kernels that write pixels row by row.
pub(in crate::gpu) const ROWS_GROUP: [u32; 2] = [32, 4];
/// Threads of a workgroup of the kernels that build spin-0 lenses.
pub const LENS_GROUP: u32 = 32;

/// Everything that decides how the tracing kernels are compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TraceVariant {
    pub method: MethodCode,
    pub spinning: bool,
    pub delay: bool,
    pub step_limit: bool,
    /// Whether pixels keep where on the disk a crossing is; given rays always do.
    pub azimuth: bool,
    /// The matter with depth that is asked along the parts of a pixel's ray. `None`: there is none, or it is not asked.
    pub matter: Option<MatterVariant>,
    /// The projection of pixels; given rays have none. `None`: any, which the kernel asks while it runs.
    pub projection: Option<Projection>,
}

/// The matter with depth that tracing kernels are compiled for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MatterVariant {
    /// Bits of `SHAPE_*` and `MOTION_*`.
    pub shapes: u32,
    pub motions: u32,
    /// Some of it is a blackbody, and some has a power law.
    pub thermal: bool,
    pub power_law: bool,
    /// No effect on light is switched off.
    pub all_effects: bool,
    /// The view shows what there is, not light.
    pub shows_depth: bool,
    /// Some of it has structure.
    pub structure: bool,
    /// A volume with structure is all the matter that there is, in a picture with all effects.
    pub alone: bool,
    /// The host has things before it.
    pub occluded: bool,
}

/// `SHAPE_SPOT` of emit/shape.wgsl, for which volumes have no shape.
pub const SHAPE_SPOT: u32 = 4;

/// `MOTION_*` of emit/flow.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum MotionCode {
    Keplerian = 0,
    AngularMomentum = 1,
    Rigid = 2,
    Outflow = 3,
}

/// Everything that decides how shading is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShadeVariant {
    /// Light, not another view.
    pub light: bool,
    pub stars: bool,
    pub milky_way: bool,
    pub map: bool,
    pub grid: bool,
    /// A sampler filters maps.
    pub map_sampler: bool,
    /// No effect on light is switched off.
    pub all_effects: bool,
    /// Something shines in the equatorial plane.
    pub plane: bool,
    /// Each crossing hides what is behind it.
    pub opaque: bool,
    /// Whether crossings need their footprint.
    pub footprints: bool,
    /// Emitters with depth lie between crossings.
    pub volumes: bool,
    /// `None`: any, which the kernel asks while it runs.
    pub projection: Option<Projection>,
    /// Whether pixels with edges get more rays; values of views are not to be averaged.
    pub refines: bool,
    /// The disk is turbulent.
    pub turbulent: bool,
    /// The host has things before the camera.
    pub occluded: bool,
}

/// Everything that decides how development is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FilmVariant {
    /// `None`: any, which the kernel asks while it runs.
    pub(in crate::gpu) pixels: Option<PixelKind>,
    /// Pixels show a view other than light in false colour.
    pub(in crate::gpu) false_colour: bool,
    /// `None`: any, which the kernel asks while it runs. `ToneMap::None` where it does not matter.
    pub(in crate::gpu) tone_map: Option<ToneMap>,
    /// `None`: any, which the kernel asks while it runs. `ColourMap::None` where it does not matter.
    pub(in crate::gpu) colour_map: Option<ColourMap>,
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

/// Where the last kernel of a frame writes pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelTarget {
    /// Into an image on the device: a window's texture, or one that the host shares.
    Image(StoredFormat),
    /// Into a buffer, packed, or the rows of a whole frame, each thread its pixel.
    Packed,
    /// Into a buffer by workgroups, row by row: faster where the buffer is in the host's memory.
    Rows,
    /// Not pixels yet: exposed light, for bloom to spread.
    Light,
}

/// Formats of images that kernels write.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StoredFormat {
    Rgba8,
    Rgba16F,
    Rgba32F,
    R32F,
}

impl PixelTarget {
    /// A window's texture.
    pub const SCREEN: Self = Self::Image(StoredFormat::Rgba8);

    pub fn is_image(self) -> bool {
        matches!(self, Self::Image(_))
    }
}

impl StoredFormat {
    /// `None` for formats that not every device stores to.
    pub fn of(format: PixelFormat) -> Option<Self> {
        Some(match format {
            PixelFormat::Rgba8Srgb => Self::Rgba8,
            PixelFormat::Rgba16F => Self::Rgba16F,
            PixelFormat::Rgba32F => Self::Rgba32F,
            PixelFormat::R32F => Self::R32F,
            PixelFormat::Bgra8Srgb => return None,
        })
    }
}

/// The sources of a level of a sky target: texels of half floats, of floats, or the level before.
pub const SKY_SOURCE_HALF: u32 = 0;
pub const SKY_SOURCE_FLOAT: u32 = 1;
pub const SKY_SOURCE_LEVEL: u32 = 2;

/// The value of a constant whose choice the kernel asks the uniform for while it runs.
pub(in crate::gpu) const FROM_UNIFORM: u32 = u32::MAX;

impl FilmVariant {
    /// For `film` in pixels of `format`.
    pub fn new(film: &Film, view: View, format: PixelFormat, target: PixelTarget) -> Self {
        let pixels = match format {
            PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb => PixelKind::EightBit,
            PixelFormat::Rgba16F | PixelFormat::Rgba32F => PixelKind::Float,
            PixelFormat::R32F => PixelKind::R32F,
        };
        let shows_light = view == View::Light;
        let (tone_map, colour_map) = match shows_light && format.is_developed() {
            true => (film.tone_map, film.colour_map),
            false => (ToneMap::None, ColourMap::None),
        };
        let (tone_map, colour_map) = (Some(tone_map), Some(colour_map));
        Self { pixels: Some(pixels), false_colour: !shows_light, tone_map, colour_map, target }
    }

    /// The variant that serves every tone map and colour map, and, but in images, which have one kind of pixels, every
    /// format. Views other than light have no tone map.
    pub fn of_any(self) -> Self {
        let pixels = self.pixels.filter(|_| self.target.is_image());
        let tone_map = self.false_colour.then_some(ToneMap::None);
        Self { pixels, tone_map, colour_map: self.false_colour.then_some(ColourMap::None), ..self }
    }

    /// Whether hosts begin with such pixels, which have kernels of their own (`GpuTracer::set_up`): light in 8 bits by
    /// ACES, the default.
    pub fn is_usual(self) -> bool {
        let plain = self.colour_map == Some(ColourMap::None);
        self.pixels == Some(PixelKind::EightBit) && self.tone_map == Some(ToneMap::Aces) && plain
    }

    /// For light that bloom is to spread.
    pub fn of_light() -> Self {
        let (tone_map, colour_map) = (Some(ToneMap::None), Some(ColourMap::None));
        Self { pixels: Some(PixelKind::Float), false_colour: false, tone_map, colour_map, target: PixelTarget::Light }
    }

    /// For kernels that go over what `source` makes: deferred pixels lie scattered.
    pub(in crate::gpu) fn over(self, source: RecordSource) -> Self {
        match source {
            RecordSource::Kerr { deferred: true, .. } => self.scattered(),
            _ => self,
        }
    }

    /// For kernels over pixels that make no rows.
    pub(in crate::gpu) fn scattered(self) -> Self {
        match self.target {
            PixelTarget::Rows => Self { target: PixelTarget::Packed, ..self },
            PixelTarget::Image(_) | PixelTarget::Packed | PixelTarget::Light => self,
        }
    }

    /// Threads of a workgroup of the kernels that write pixels.
    pub(in crate::gpu) fn group(self) -> [u32; 2] {
        match self.target {
            PixelTarget::Image(_) | PixelTarget::Packed | PixelTarget::Light => GROUP,
            PixelTarget::Rows => ROWS_GROUP,
        }
    }
}

/// The maker of the ray records that a kernel reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RecordSource {
    /// traced/record.wgsl
    Traced,
    /// lens/schwarzschild_record.wgsl
    Schwarzschild { delay: bool, moving: bool },
    /// lens/kerr_pixel.wgsl, and of the pixels it defers lens/kerr_deferred.wgsl
    Kerr { delay: bool, pattern: bool, moving: bool, deferred: bool },
}

/// The place on the device that an output of frames is written into: one number a pixel, or four.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutputPlace {
    /// The rows of a buffer.
    Number,
    Numbers,
    /// The rows of a buffer, all of which begin at multiples of 16 bytes.
    AlignedNumbers,
    /// An image of R32F or RGBA32F.
    NumberImage,
    NumbersImage,
}

/// A frame's outputs in their order with their places, for which a kernel of their own is made; none: all go into one
/// buffer, packed, for the host, and the kernel learns from its uniform which they are.
pub type OutputPlaces = [Option<(RayOutput, OutputPlace)>; MOST_OUTPUTS];

/// How refine/refine.wgsl finds its samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RefineVariant {
    /// The source of the pixels' own records.
    pub source: RecordSource,
    /// How rays are traced that no table holds.
    pub variant: TraceVariant,
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
