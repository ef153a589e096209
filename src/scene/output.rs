// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a host can have of a frame beside its picture: distances, directions, places, of the one ray through each
//! pixel's centre. Mirrored by shaders/shade/outputs.wgsl. Knows records, and not how they were made.

use super::observer::Lens;
use super::occluder::{distance, place};
use super::record::Record;
use super::{Scene, View, VolumeResolution};
use crate::emit::{Needs, PlaneLight};
use crate::error::Result;
use crate::image::PixelFormat;
use crate::physics::trace::Fate;
use glam::{DMat3, DVec3};

/// Outputs of one frame at most.
pub const MOST_OUTPUTS: usize = 8;
/// Crossings of a ray that outputs may be asked of (BhrQuality.max_disk_order).
pub const MOST_CROSSINGS: u32 = 16;
/// Numbers that an output has at most.
pub const OUTPUT_WORDS: usize = 4;

/// An output of a frame (`BHR_OUTPUT_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// The picture, as frames are without outputs.
    Light,
    /// A view that takes rays of its own: a frame of its own.
    View(View),
    /// Numbers from the ray through the pixel's centre.
    Ray(RayOutput),
}

/// Numbers from a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RayOutput {
    pub kind: RayOutputKind,
    /// The crossing, among those that the ray has within the disk's radii; for POSITION and DISK.
    pub index: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum RayOutputKind {
    Depth = 0,
    Sky = 1,
    Transmission = 2,
    Position = 3,
    Disk = 4,
    Redshift = 5,
    Order = 6,
    Deflection = 7,
}

impl From<RayOutputKind> for Output {
    fn from(kind: RayOutputKind) -> Self {
        Self::Ray(RayOutput { kind, index: 0 })
    }
}

impl Output {
    /// A view's values.
    pub fn of_view(view: View) -> Self {
        match view {
            View::Light => Self::Light,
            View::Redshift => RayOutputKind::Redshift.into(),
            View::Order => RayOutputKind::Order.into(),
            View::Deflection => RayOutputKind::Deflection.into(),
            View::Steps | View::Metric | View::OpticalDepth | View::Intensity => Self::View(view),
        }
    }

    /// The format of its pixels; `None`: any that the scene's view goes into.
    pub fn format(self) -> Option<PixelFormat> {
        match self {
            Self::Light => None,
            Self::View(_) => Some(PixelFormat::R32F),
            Self::Ray(output) if output.words() == 1 => Some(PixelFormat::R32F),
            Self::Ray(_) => Some(PixelFormat::Rgba32F),
        }
    }
}

impl Output {
    /// The names of its values in files of layers; of the picture, those of its channels.
    pub fn channels(self) -> Vec<String> {
        let of = |layer: &str, names: &[&str]| names.iter().map(|name| format!("{layer}.{name}")).collect();
        match self {
            Self::Light => ["R", "G", "B", "A"].map(String::from).into(),
            Self::View(view) => of(&view.name().to_lowercase(), &["Y"]),
            Self::Ray(RayOutput { kind, index }) => {
                let layer = |name: &str| if index == 0 { name.into() } else { format!("{name}{index}") };
                match kind {
                    RayOutputKind::Depth => of("depth", &["Z"]),
                    RayOutputKind::Sky => of("sky", &["x", "y", "z", "g"]),
                    RayOutputKind::Transmission => of("transmission", &["Y"]),
                    RayOutputKind::Position => of(&layer("position"), &["x", "y", "z", "order"]),
                    RayOutputKind::Disk => of(&layer("disk"), &["radius", "azimuth", "g", "delay"]),
                    RayOutputKind::Redshift => of("redshift", &["Y"]),
                    RayOutputKind::Order => of("order", &["Y"]),
                    RayOutputKind::Deflection => of("deflection", &["Y"]),
                }
            }
        }
    }
}

impl RayOutput {
    /// Numbers of a pixel.
    pub fn words(self) -> usize {
        match self.kind {
            RayOutputKind::Sky | RayOutputKind::Position | RayOutputKind::Disk => OUTPUT_WORDS,
            _ => 1,
        }
    }

    /// How many crossings of a ray it asks for, from the first on.
    pub fn crossings(self) -> u32 {
        use RayOutputKind::{Deflection, Depth, Disk, Order, Position, Redshift, Sky, Transmission};
        match self.kind {
            Sky | Deflection => 0,
            Depth | Redshift | Order => 1,
            Position | Disk => self.index.saturating_add(1),
            Transmission => u32::MAX,
        }
    }

    /// The facts about rays that it asks for.
    fn needs(self) -> Needs {
        use RayOutputKind::{Deflection, Depth, Disk, Position, Sky};
        Needs {
            places: matches!(self.kind, Depth | Position | Disk),
            delays: self.kind == Disk,
            beyond: matches!(self.kind, Sky | Deflection) || self.index > 0,
            ..Needs::default()
        }
    }
}

impl Scene {
    /// The scene whose records `outputs` are made from: one ray a pixel, which goes on behind what hides the rest where
    /// an output asks for that.
    pub fn for_outputs(&self, outputs: &[RayOutput]) -> Self {
        let mut scene = Self { view: View::Light, occluder: None, ..self.clone() };
        scene.quality.samples_per_pixel = 1;
        scene.quality.refines = false;
        scene.quality.volume_resolution = VolumeResolution::Full;
        scene.film = scene.film.of_parts();
        scene.also_needs = outputs.iter().fold(Needs::default(), |needs, output| needs.and(output.needs()));
        scene
    }
}

/// The part of a scene that outputs need beside records.
pub struct RayValues<'a> {
    lens: &'a Lens,
    plane: PlaneLight,
    mass: f64,
    chart_to_scene: DMat3,
}

impl<'a> RayValues<'a> {
    /// Errors: OUT_OF_MEMORY.
    pub fn new(scene: &Scene, lens: &'a Lens) -> Result<Self> {
        let plane = PlaneLight::new(&scene.emitters())?;
        Ok(Self { lens, plane, mass: scene.hole.mass, chart_to_scene: scene.hole.scene_to_chart().transpose() })
    }

    /// The numbers of `output` of the record at (x, y) of the full frame; as many count as [`RayOutput::words`].
    pub fn values(&self, output: RayOutput, here: &Record, x: f64, y: f64) -> [f64; OUTPUT_WORDS] {
        let single = |value: f64| [value, 0.0, 0.0, 0.0];
        let seen = self.lens.mapping.has_look_direction(x, y);
        let (first, escaped) = (here.crossings.first(), here.fate == Fate::Escaped);
        let sky = |seen: f64| if escaped { seen } else { f64::NAN };
        match output.kind {
            RayOutputKind::Sky if seen && escaped => {
                (self.chart_to_scene * here.direction).extend(here.sky_redshift).to_array()
            }
            RayOutputKind::Sky => [0.0; OUTPUT_WORDS],
            RayOutputKind::Transmission if seen && escaped => single(self.transmission(here)),
            RayOutputKind::Transmission => single(0.0),
            _ if !seen => [f64::NAN; OUTPUT_WORDS],
            RayOutputKind::Depth => single(self.depth(here, x, y)),
            RayOutputKind::Position => match here.crossings.get(output.index as usize) {
                Some(crossing) => {
                    let place = self.mass * (self.chart_to_scene * place(crossing));
                    place.extend(f64::from(crossing.order)).to_array()
                }
                None => DVec3::NAN.extend(without_crossing(here.fate)).to_array(),
            },
            RayOutputKind::Disk => match here.crossings.get(output.index as usize) {
                Some(crossing) => {
                    let delay = self.mass * (crossing.place.delay + self.lens.delay_offset);
                    [self.mass / crossing.u, crossing.place.azimuth, crossing.g, delay]
                }
                None => [f64::NAN; OUTPUT_WORDS],
            },
            RayOutputKind::Redshift => single(first.map_or(sky(here.sky_redshift), |crossing| crossing.g)),
            RayOutputKind::Order => {
                single(first.map_or(without_crossing(here.fate), |crossing| f64::from(crossing.order)))
            }
            RayOutputKind::Deflection => {
                let look = self.lens.placed(self.lens.look_direction(x, y));
                single(sky(look.cross(here.direction).length().atan2(look.dot(here.direction))))
            }
        }
    }

    /// The share of the sky's light that disk and matter with depth let pass.
    fn transmission(&self, here: &Record) -> f64 {
        let through = here.media.iter().map(|medium| medium.through).product::<f64>();
        through * here.crossings.iter().map(|crossing| 1.0 - self.plane.opacity(crossing)).product::<f64>()
    }

    /// The distance to the first crossing if it is the direct image's, in a straight line. The light of higher orders,
    /// and that of captured rays, passes the hole: the distance to the point of the line of sight that is nearest to
    /// it.
    fn depth(&self, here: &Record, x: f64, y: f64) -> f64 {
        let place = &self.lens.place;
        match here.crossings.first() {
            Some(crossing) if crossing.order == 0 => self.mass * distance(crossing, place.e_r * place.r),
            None if here.fate == Fate::Escaped => f64::INFINITY,
            _ => self.mass * self.lens.closest_approach(x, y),
        }
    }
}

/// The number that stands for an order where there is no crossing: -1 the sky, -2 captured.
fn without_crossing(fate: Fate) -> f64 {
    match fate {
        Fate::Escaped => -1.0,
        Fate::Captured => -2.0,
        Fate::Unresolved | Fate::Hidden => f64::NAN,
    }
}
