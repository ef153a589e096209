//! The matter that shines or absorbs near the hole: the emitters of a scene, the facts about a ray that each needs, and
//! the light that each adds to a ray. Mirrored by `shaders/emit/`. A camera enters only as a ratio of frequencies,
//! pixels only as the change of a crossing to the next pixel; knows nothing else of either, and no tracer.
//!
//! A ray meets emitters in two ways. Those in the equatorial plane are asked at each crossing of the plane
//! ([`PlaneLight::at_crossing`]); those with depth are asked along every part of the ray between two crossings
//! ([`Emitters::along`]), and only scenes that have one pay for it: their rays are traced one by one.
//!
//! To add an emitter, follow "Where to change what" in ARCHITECTURE.md.

pub mod along;
pub mod crossing;
pub mod disk;
pub mod haze;
pub mod medium;
pub mod thin_disk;
pub mod turbulence;

pub use crossing::{Crossing, Emission, EmissionPoint, Shift};

use crate::physics::trace::Part;
use haze::Haze;
use medium::Medium;
use thin_disk::{DiskLight, ThinDisk};

/// The facts about a ray that emitters ask for, beside 1/r of each crossing and its g = nu(camera) / nu(matter).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Azimuths of crossings, and how the place of a crossing changes to the next pixel.
    pub places: bool,
    /// When the light of a crossing left.
    pub delays: bool,
    /// Every part of the ray between crossings.
    pub parts: bool,
}

/// The emitters of a scene, in units of M (`Scene::emitters`).
#[derive(Clone, Copy, Debug, Default)]
pub struct Emitters {
    /// `None`: the scene has no disk, or all of it lies inside the ISCO, where no matter orbits.
    pub disk: Option<ThinDisk>,
    pub haze: Option<Haze>,
}

impl Emitters {
    pub fn needs(&self) -> Needs {
        let turbulence = self.disk.and_then(|disk| disk.turbulence);
        Needs {
            places: turbulence.is_some(),
            delays: turbulence.is_some_and(|turbulence| turbulence.needs_delay),
            parts: self.haze.is_some(),
        }
    }

    /// The range of 1/r, outer end first, in 1/M, in which crossings of the plane are kept: all emitters of the plane
    /// lie in it, of which the disk is the only one so far. `None`: nothing shines in the plane.
    pub fn plane_u(&self) -> Option<[f64; 2]> {
        self.disk.map(|disk| disk.u)
    }

    /// 1/r of the disk's outer and inner edge, the only sharp edges that pixels are refined for. Other emitters of the
    /// plane fade out towards the ends of their range.
    pub fn disk_u(&self) -> Option<[f64; 2]> {
        self.disk.map(|disk| disk.u)
    }

    /// The interval of 1/r in which a crossing of the plane hides all that is behind it.
    pub fn opaque_u(&self) -> Option<[f64; 2]> {
        self.disk.filter(ThinDisk::is_opaque).map(|disk| disk.u)
    }

    /// Whether each crossing that is kept hides all that is behind it, so that one is enough.
    pub fn hides_all(&self) -> bool {
        self.opaque_u().is_some_and(|u| self.plane_u() == Some(u))
    }

    /// The share of a crossing at 1/r = `u` that the disk covers: all or nothing.
    pub fn covered(&self, u: f64) -> f64 {
        f64::from(u8::from(self.disk_u().is_some_and(|[outer, inner]| u >= outer && u <= inner)))
    }

    /// Adds the matter along a part of a ray to the medium between two crossings. `frequency_ratio`: nu(camera) /
    /// nu(local frame).
    pub fn along(&self, part: &Part<'_>, frequency_ratio: f64, medium: &mut Medium) {
        if let Some(haze) = &self.haze {
            haze.along(part, frequency_ratio, medium);
        }
    }
}

/// The emitters in the equatorial plane, with the tables from which their light is computed.
pub struct PlaneLight {
    disk: Option<DiskLight>,
}

impl PlaneLight {
    pub fn new(emitters: &Emitters) -> Self {
        Self { disk: emitters.disk.map(DiskLight::new) }
    }

    /// The light that a crossing adds, and its opacity. `open` is the share of light from here that reaches the camera.
    pub fn at_crossing(&self, crossing: &Crossing, shift: Shift, open: f64) -> Emission {
        match &self.disk {
            Some(disk) if crossing.share > 0.0 => disk.at_crossing(crossing, shift, open),
            _ => Emission { light: [0.0; 3], opacity: 0.0 },
        }
    }
}
