// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matter that shines or absorbs near the hole: the emitters of a scene, the facts about a ray that each needs, and
//! the light that each adds to a ray. Mirrored by `shaders/emit/`. A camera enters only as a ratio of frequencies,
//! pixels only as the change of a crossing to the next pixel; knows nothing else of either, and no tracer.
//!
//! A ray meets emitters in two ways. Those in the equatorial plane are asked at each crossing of the plane
//! ([`PlaneLight::at_crossing`]); those with depth are asked along every part of the ray between two crossings
//! ([`Emitters::along`]), and only scenes that have one pay for it: their rays are traced one by one.
//!
//! To add an emitter, follow "Where to change what" in ARCHITECTURE.md.

pub mod bands;
pub mod moment;
pub mod crossing;
pub mod disk;
mod lattice;
pub mod volume;
pub mod effects;
pub mod filaments;
pub mod glow;
pub mod hot_spot;
pub mod shape;
pub mod streaks;
pub mod grid;
pub mod clouds;
pub mod baking;
pub mod medium;
pub mod turbulence;
pub mod half;
pub mod free_spot;
pub mod matter;
pub mod baked;
pub mod layers;
pub mod thin_disk;
pub mod volumes;
pub mod along;

pub use crossing::{Crossing, Emission, EmissionPoint, Shift};

use crate::error::Result;
use crate::physics::trace::Part;
use disk::EmissionLaw;
use medium::Medium;
use thin_disk::{DiskLight, ThinDisk};
use volumes::{Seen, Volumes};

/// The facts about a ray that emitters ask for, beside 1/r of each crossing and its g = nu(camera) / nu(matter).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Azimuths of crossings, and how the place of a crossing changes to the next pixel.
    pub places: bool,
    /// When the light of a crossing left.
    pub delays: bool,
    /// The angle at which the ray crosses the plane.
    pub angles: bool,
    /// Every part of the ray between crossings.
    pub parts: bool,
    /// Whether the ray moves inwards or outwards at crossings: its frequency is not known without that to matter which
    /// does so itself.
    pub headings: bool,
    /// The rest of a ray behind matter that hides it.
    pub beyond: bool,
    /// That rest of the rays that meet the host's things, which may hide that matter.
    pub beyond_things: bool,
}

impl Needs {
    /// All that either asks for.
    pub fn and(self, other: Self) -> Self {
        Self {
            places: self.places || other.places,
            delays: self.delays || other.delays,
            angles: self.angles || other.angles,
            parts: self.parts || other.parts,
            headings: self.headings || other.headings,
            beyond: self.beyond || other.beyond,
            beyond_things: self.beyond_things || other.beyond_things,
        }
    }
}

/// The emitters of a scene, in units of M (`Scene::emitters`).
#[derive(Clone, Debug, Default)]
pub struct Emitters {
    /// `None`: the scene has no disk, or all of it lies where no matter shines.
    pub disk: Option<ThinDisk>,
    pub volumes: Volumes,
    /// The facts that somebody beside the emitters asks for.
    pub also: Needs,
}

impl Emitters {
    pub fn needs(&self) -> Needs {
        let turbulence = self.disk.and_then(|disk| disk.turbulence);
        let own = Needs {
            places: turbulence.is_some(),
            delays: turbulence.is_some_and(|turbulence| turbulence.needs_delay) || self.volumes.needs_delay(),
            angles: self.disk.is_some_and(|disk| disk.disk.emission_law != EmissionLaw::Isotropic),
            parts: !self.volumes.is_empty(),
            headings: self.disk.is_some_and(|disk| disk.least_profile.is_some()),
            beyond: false,
            beyond_things: false,
        };
        own.and(self.also)
    }

    /// The range of 1/r, outer end first, in 1/M, in which crossings of the plane are kept: all emitters of the plane
    /// lie in it, of which the disk is the only one so far. `None`: nothing shines in the plane.
    pub fn plane_u(&self) -> Option<[f64; 2]> {
        self.disk.map(|disk| disk.u)
    }

    /// 1/r of the disk's outer and inner edge, the only edges that pixels are refined for. Other emitters of the
    /// plane fade out towards the ends of their range.
    pub fn disk_u(&self) -> Option<[f64; 2]> {
        self.disk.map(|disk| disk.u)
    }

    /// The change of 1/r over which the disk fades out at either of these edges (`ThinDisk::fading_u`).
    pub fn fading_u(&self) -> [f64; 2] {
        self.disk.map_or([0.0; 2], |disk| disk.fading_u())
    }

    /// The interval of 1/r in which a crossing of the plane hides all that is behind it, if nobody asks for that and
    /// none of the host's things hides the crossing.
    pub fn opaque_u(&self) -> Option<[f64; 2]> {
        self.disk.filter(|_| !self.also.beyond).and_then(|disk| disk.opaque_u())
    }

    /// Whether each crossing that is kept hides all that is behind it, so that one is enough.
    pub fn hides_all(&self) -> bool {
        !self.also.beyond_things && self.opaque_u().is_some_and(|u| self.plane_u() == Some(u))
    }

    /// The share of a crossing at 1/r = `u` that the disk covers: all or nothing.
    pub fn covered(&self, u: f64) -> f64 {
        f64::from(u8::from(self.disk_u().is_some_and(|[outer, inner]| u >= outer && u <= inner)))
    }

    /// Adds the matter along a part of a ray to the medium between two crossings.
    pub fn along(&self, part: &Part<'_>, seen: &Seen, medium: &mut Medium) {
        self.volumes.along(part, seen, medium);
    }

    /// The range of 1/r, outer end first, in which matter with depth is. `None`: there is none.
    pub fn depth_u(&self) -> Option<[f64; 2]> {
        self.volumes.reach_u()
    }
}

/// The emitters in the equatorial plane, with the tables from which their light is computed.
pub struct PlaneLight {
    disk: Option<DiskLight>,
}

impl PlaneLight {
    /// Errors: OUT_OF_MEMORY.
    pub fn new(emitters: &Emitters) -> Result<Self> {
        Ok(Self { disk: emitters.disk.map(DiskLight::new).transpose()? })
    }

    /// The light that a crossing adds, without structure, and its opacity. `mu` is |cosine| of the ray's angle to the
    /// normal of the plane, as the matter sees it; `open` is the share of light from here that reaches the camera.
    pub fn at_crossing(&self, crossing: &Crossing, shift: Shift, mu: f64, open: f64) -> Emission {
        match &self.disk {
            Some(disk) if crossing.share > 0.0 => disk.at_crossing(crossing, shift, mu, open),
            _ => Emission { light: [0.0; 3], opacity: 0.0 },
        }
    }

    /// The factor by which the emitters' structure changes the light of a crossing, seen `moment` after the frame's
    /// time, M.
    pub fn structure(&self, crossing: &Crossing, moment: f64) -> f64 {
        self.disk.as_ref().map_or(1.0, |disk| disk.structure(crossing, moment))
    }

    /// The share of the light from behind that a crossing hides.
    pub fn opacity(&self, crossing: &Crossing) -> f64 {
        self.disk.as_ref().map_or(0.0, |disk| disk.opacity(crossing))
    }
}
