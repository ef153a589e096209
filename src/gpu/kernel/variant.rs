// SPDX-License-Identifier: MIT OR Apache-2.0
//! The variants that kernels are compiled in: how rays are traced, light is shaded, and pixels are written. Plain data,
//! each field with the constant of WGSL that it is the value of (choices.rs).

use super::choices::{Choice, FROM_UNIFORM, Values, Variant};
use crate::image::PixelFormat;
use crate::physics::integrator::Method;
use crate::scene::{ColourMap, MOST_OUTPUTS, Projection, RayOutput, Scene, ToneMap, View};

/// Threads of a workgroup of the kernels that go over pixels.
pub const GROUP: [u32; 2] = [8, 16];
/// Threads of a workgroup of the kernels that trace pixels or blocks: rays beside each other pass more alike matter
/// than rays below each other, and 32 that run together take 2 % less time as 16 x 2 than as 8 x 4 (H100).
pub const TRACE_GROUP: [u32; 2] = [16, 8];
/// Threads of a workgroup of the kernels that write pixels row by row.
pub(in crate::gpu) const ROWS_GROUP: [u32; 2] = [32, 4];
/// Threads of a workgroup of the kernels that build spin-0 lenses.
pub const LENS_GROUP: u32 = 32;

/// A type of choices.
trait Made: Copy {
    fn make(self, choice: Choice, values: &mut Values);
}

macro_rules! made {
    ($($ty:ty: $value:expr;)*) => {$(
        impl Made for $ty {
            fn make(self, choice: Choice, values: &mut Values) {
                let value: fn($ty) -> u32 = $value;
                values.make(choice, value(self));
            }
        }
    )*};
}

made! {
    u32: |value| value;
    bool: |on| on.into();
    MethodCode: |method| method.0;
    Option<Projection>: |projection| projection.map_or(FROM_UNIFORM, |projection| projection as u32);
    Option<PixelKind>: |pixels| pixels.map_or(FROM_UNIFORM, |pixels| pixels as u32);
    Option<ToneMap>: |tone_map| tone_map.map_or(FROM_UNIFORM, |tone_map| tone_map as u32);
    Option<bool>: |on| on.map_or(FROM_UNIFORM, u32::from);
    Option<ColourMap>: |colour_map| colour_map.map_or(FROM_UNIFORM, |colour_map| colour_map as u32);
}

impl Made for Option<MatterVariant> {
    fn make(self, choice: Choice, values: &mut Values) {
        values.make(choice, self.is_some().into());
        self.unwrap_or_default().make(values);
    }
}

/// A struct of choices: before each field its constant; after a semicolon, fields that choose other WGSL.
macro_rules! variant {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($(#[$doc:meta])* $constant:ident $vis:vis $field:ident: $ty:ty,)*
            $(; $($(#[$others:meta])* $v:vis $other:ident: $t:ty,)*)?
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub struct $name {
            $($(#[$doc])* $vis $field: $ty,)*
            $($($(#[$others])* $v $other: $t,)*)?
        }

        impl Variant for $name {
            fn make(&self, values: &mut Values) {
                $(self.$field.make(Choice::$constant, values);)*
            }
        }
    };
}

variant! {
    /// Everything that decides how the tracing kernels are compiled.
    pub struct TraceVariant {
        METHOD pub method: MethodCode,
        SPINNING pub spinning: bool,
        DELAY pub delay: bool,
        STEP_LIMIT pub step_limit: bool,
        /// Doran's chart: observers in the rain frame of a spinning hole.
        RAIN pub rain: bool,
        /// Whether pixels keep where on the disk a crossing is; given rays always do.
        AZIMUTH pub azimuth: bool,
        /// The matter with depth that is asked along the parts of a pixel's ray. `None`: there is none, or it is not
        /// asked.
        PARTS pub matter: Option<MatterVariant>,
        /// The projection of pixels; given rays have none. `None`: any, which the kernel asks while it runs.
        PROJECTION pub projection: Option<Projection>,
    }
}

variant! {
    /// The matter with depth that tracing kernels are compiled for.
    #[derive(Default)]
    pub struct MatterVariant {
        /// Bits of `SHAPE_*` and `MOTION_*`.
        SHAPES pub shapes: u32,
        MOTIONS pub motions: u32,
        /// Some of it is a blackbody, and some has a power law.
        THERMAL pub thermal: bool,
        POWER_LAW pub power_law: bool,
        /// No effect on light is switched off.
        ALL_EFFECTS pub all_effects: bool,
        /// The view shows what there is, not light.
        SHOWS_DEPTH pub shows_depth: bool,
        /// Some of it has structure.
        STRUCTURE pub structure: bool,
        /// A volume with structure is all the matter that there is, in a picture with all effects.
        ALONE pub alone: bool,
        /// The host has things before it.
        OCCLUDED pub occluded: bool,
    }
}

/// `SHAPE_SPOT` of emit/shape.wgsl, for which volumes have no shape.
pub const SHAPE_SPOT: u32 = 4;
/// That of spots in free fall.
pub const SHAPE_FREE_SPOT: u32 = 5;

/// `MOTION_*` of emit/flow.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum MotionCode {
    Keplerian = 0,
    AngularMomentum = 1,
    Rigid = 2,
    Outflow = 3,
    /// That of a body in free fall: of spots alone.
    Free = 4,
}

variant! {
    /// Everything that decides how shading is compiled.
    pub struct ShadeVariant {
        /// Light, not another view.
        SHOWS_LIGHT pub light: bool,
        SHOWS_STARS pub stars: bool,
        SHOWS_MILKY_WAY pub milky_way: bool,
        SHOWS_MAP pub map: bool,
        SHOWS_GRID pub grid: bool,
        /// A sampler filters maps.
        MAP_SAMPLER pub map_sampler: bool,
        /// No effect on light is switched off.
        ALL_EFFECTS pub all_effects: bool,
        /// Something shines in the equatorial plane.
        PLANE pub plane: bool,
        /// Each crossing hides what is behind it.
        OPAQUE pub opaque: bool,
        /// Whether crossings need their footprint.
        FOOTPRINTS pub footprints: bool,
        /// Emitters with depth lie between crossings.
        VOLUMES pub volumes: bool,
        /// `None`: any, which the kernel asks while it runs.
        PROJECTION pub projection: Option<Projection>,
        /// Whether pixels with edges get more rays; values of views are not to be averaged.
        REFINES pub refines: bool,
        /// The disk is turbulent.
        TURBULENT pub turbulent: bool,
        /// The host has things before the camera.
        OCCLUDED pub occluded: bool,
    }
}

variant! {
    /// Everything that decides how development is compiled.
    pub struct FilmVariant {
        /// `None`: any, which the kernel asks while it runs.
        PIXELS pub(in crate::gpu) pixels: Option<PixelKind>,
        /// Pixels show a view other than light in false colour.
        FALSE_COLOUR pub(in crate::gpu) false_colour: bool,
        /// `None`: any, which the kernel asks while it runs.
        TONE_MAP pub(in crate::gpu) tone_map: Option<ToneMap>,
        /// `None`: any, which the kernel asks while it runs.
        COLOUR_MAP pub(in crate::gpu) colour_map: Option<ColourMap>,
        /// Whether light is graded. `None`: the kernel asks while it runs.
        GRADE pub(in crate::gpu) grade: Option<bool>,
        /// Whether developed colours go through a LUT.
        LUT pub(in crate::gpu) lut: bool,
        ;
        pub(in crate::gpu) target: PixelTarget,
    }
}

/// Pixel formats that one kernel serves: `PIXELS` of film/film.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelKind {
    /// RGBA8 and BGRA8.
    EightBit,
    /// RGBA16F and RGBA32F.
    Float,
    R32F,
    /// RGB10A2_PQ and RGB10A2_HLG.
    Hdr,
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

/// The light that film/develop.wgsl develops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DevelopedLight {
    /// A sum of samples.
    Summed,
    /// Light that has spread over a grid.
    Glare,
    /// Light that has spread over a grid, and has been measured.
    Metered,
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

    /// Threads of a workgroup of the kernels that write pixels there.
    pub(in crate::gpu) fn group(self) -> [u32; 2] {
        match self {
            Self::Image(_) | Self::Packed | Self::Light => GROUP,
            Self::Rows => ROWS_GROUP,
        }
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
            PixelFormat::Bgra8Srgb | PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => return None,
        })
    }
}

/// The sources of a level of a sky target: texels of half floats, of floats, or the level before.
pub const SKY_SOURCE_HALF: u32 = 0;
pub const SKY_SOURCE_FLOAT: u32 = 1;
pub const SKY_SOURCE_LEVEL: u32 = 2;

impl FilmVariant {
    /// For the film of `scene` in pixels of `format`.
    pub fn new(scene: &Scene, format: PixelFormat, target: PixelTarget) -> Self {
        let Scene { film, view, .. } = scene;
        let pixels = match format {
            PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb => PixelKind::EightBit,
            PixelFormat::Rgba16F | PixelFormat::Rgba32F => PixelKind::Float,
            PixelFormat::R32F => PixelKind::R32F,
            PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => PixelKind::Hdr,
        };
        let (tone_map, colour_map, grade) = (Some(film.tone_map), Some(film.colour_map), Some(film.grade.is_on()));
        let (false_colour, lut) = (*view != View::Light, scene.shown_lut().is_some());
        Self { pixels: Some(pixels), false_colour, tone_map, colour_map, grade, lut, target }
    }

    /// The variant that serves every tone map, colour map and grade, and, but in images, which have one kind of pixels,
    /// every format. Light with a LUT has kernels of its own, so that other films pay nothing for it.
    pub fn of_any(self) -> Self {
        let pixels = self.pixels.filter(|_| self.target.is_image());
        Self { pixels, tone_map: None, colour_map: None, grade: None, ..self }
    }

    /// Whether hosts begin with such pixels, which have kernels of their own (`GpuTracer::set_up`): light in 8 bits by
    /// ACES without a grade, the default.
    pub fn is_usual(self) -> bool {
        let plain = self.colour_map == Some(ColourMap::None) && self.grade == Some(false) && !self.false_colour;
        let plain = plain && !self.lut;
        self.pixels == Some(PixelKind::EightBit) && self.tone_map == Some(ToneMap::Aces) && plain
    }

    /// For light that bloom is to spread.
    pub fn of_light() -> Self {
        let (tone_map, colour_map, grade) = (Some(ToneMap::None), Some(ColourMap::None), Some(false));
        let (pixels, target) = (Some(PixelKind::Float), PixelTarget::Light);
        Self { pixels, false_colour: false, tone_map, colour_map, grade, lut: false, target }
    }

    /// For kernels that go over what `source` makes: deferred pixels lie scattered.
    pub(in crate::gpu) fn over(self, source: RecordSource) -> Self {
        if source.maker == RecordMaker::KerrDeferred { self.scattered() } else { self }
    }

    /// For kernels over pixels that make no rows.
    pub(in crate::gpu) fn scattered(self) -> Self {
        match self.target {
            PixelTarget::Rows => Self { target: PixelTarget::Packed, ..self },
            PixelTarget::Image(_) | PixelTarget::Packed | PixelTarget::Light => self,
        }
    }
}

/// The fragment of shaders/ that makes the ray records which a kernel reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RecordMaker {
    /// traced/record.wgsl
    Traced,
    /// lens/schwarzschild_record.wgsl
    Schwarzschild,
    /// lens/kerr_pixel.wgsl
    Kerr,
    /// lens/kerr_deferred.wgsl: of the pixels that lens/kerr_pixel.wgsl defers.
    KerrDeferred,
}

variant! {
    /// The source of the ray records that a kernel reads.
    pub struct RecordSource {
        DELAY pub delay: bool,
        /// Whether crossings keep where and when their light left.
        PATTERN pub pattern: bool,
        /// The camera moves against the local frame.
        MOVING pub moving: bool,
        /// Doran's chart: observers in the rain frame of a spinning hole.
        RAIN pub rain: bool,
        ;
        pub maker: RecordMaker,
    }
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
