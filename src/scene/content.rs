// SPDX-License-Identifier: MIT OR Apache-2.0
//! The scene itself: everything that a frame depends on but its size.

use super::camera::Camera;
use super::film::Film;
use super::hole::Hole;
use super::quality::Quality;
use super::sky::Sky;
use crate::emit::Emitters;
use crate::emit::disk::Disk;
use crate::emit::haze::Haze;
use crate::emit::thin_disk::ThinDisk;
use crate::emit::turbulence::{Turbulence, When};
use crate::physics::geodesic::{Clock, rain_offset};
use crate::physics::observer::LocalFrame;
use crate::sky::{SkyMap, StarIndex};
use std::sync::Arc;

/// The relativistic effects that colour the light: the bits of `BHR_EFFECT_*`. Unknown bits are ignored. The redshift g
/// = g_gravity g_doppler is split at the local static observer (ZAMO) of emitter and camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects(pub u32);

impl Effects {
    /// Frequency shift by motion colours the light.
    pub const DOPPLER_SHIFT: u32 = 1;
    /// Gravitational redshift colours the light.
    pub const GRAVITY_SHIFT: u32 = 2;
    /// Intensity follows g^3 (I_nu), g^4 (bolometric).
    pub const BEAMING: u32 = 4;
    /// The moving disk is seen at its retarded time.
    pub const LIGHT_DELAY: u32 = 8;
    pub const ALL: u32 = u32::MAX;

    /// The bits that change the colour or brightness of light, without unknown ones.
    pub fn light(self) -> u32 {
        self.0 & (Self::DOPPLER_SHIFT | Self::GRAVITY_SHIFT | Self::BEAMING)
    }

    /// Whether light is shown as it arrives, no effect left out.
    pub fn all_light(self) -> bool {
        self.light() == Self(Self::ALL).light()
    }

    pub fn has(self, bit: u32) -> bool {
        self.0 & bit != 0
    }
}

/// The quantity that a pixel shows (`BHR_VIEW_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum View {
    Light = 0,
    /// g of the first crossing within the disk's radii, else the sky's.
    Redshift = 1,
    /// Order of the first crossing within the disk's radii; -1 sky; -2 captured.
    Order = 2,
    /// Angle between look direction and sky direction; NaN captured.
    Deflection = 3,
    /// Integration steps of the pixel's ray; 0 where it was looked up.
    Steps = 4,
    /// -g_tt at the first crossing of the equatorial plane; NaN without one.
    Metric = 5,
}

/// Everything a frame depends on, but its size.
#[derive(Clone, Debug)]
pub struct Scene {
    pub hole: Hole,
    pub camera: Camera,
    /// `None`: no disk.
    pub disk: Option<Disk>,
    pub sky: Sky,
    /// The picture of `Sky::MAP`; `None`: it shows nothing.
    pub sky_map: Option<Arc<SkyMap>>,
    pub film: Film,
    pub effects: Effects,
    /// Scene time, in scene lengths; turns the disk. It is t, but for a camera at or inside a spin-0 horizon rain time
    /// T = t + H (`physics::geodesic::rain_offset`), which goes on where t ends.
    pub time: f64,
    pub quality: Quality,
    pub view: View,
    /// A haze about the hole: for tests.
    #[doc(hidden)]
    pub haze: Option<Haze>,
    /// Stars instead of the sky's: for tests.
    #[doc(hidden)]
    pub given_stars: Option<Arc<StarIndex>>,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            hole: Hole::default(),
            camera: Camera::default(),
            disk: Some(Disk::default()),
            sky: Sky::default(),
            sky_map: None,
            film: Film::default(),
            effects: Effects(Effects::ALL),
            time: 0.0,
            quality: Quality::default(),
            view: View::Light,
            haze: None,
            given_stars: None,
        }
    }
}

impl Scene {
    /// The matter that shines and absorbs near the hole, as the scene's view shows it.
    pub fn emitters(&self) -> Emitters {
        let light = self.view == View::Light;
        let disk = self.disk.and_then(|disk| ThinDisk::new(&disk, self.hole.spin)).map(|disk| ThinDisk {
            turbulence: Turbulence::new(&disk.disk, disk.u, disk.matter_spin, &self.when()).filter(|_| light),
            ..disk
        });
        Emitters { disk, haze: self.haze.filter(|_| light) }
    }

    /// When the frame shows its emitters.
    fn when(&self) -> When {
        let delayed = self.effects.has(Effects::LIGHT_DELAY);
        let observer = self.observer().ok().map(|o| o.frame).filter(|_| delayed);
        let reference_delay = observer.map_or(0.0, |observer| observer.r);
        // A tiny mass can make the time infinite.
        let time = (self.time / self.hole.mass).clamp(f64::MIN, f64::MAX) - reference_delay
            + observer.map_or(0.0, |observer| clock_advance(&observer));
        When { time, reference_delay, delayed }
    }
}

/// The clock of the observer's delays less the scene's time there: H where that is still t.
fn clock_advance(observer: &LocalFrame) -> f64 {
    let outside = observer.clock() == Clock::Rain && observer.r > 2.0;
    if outside { rain_offset(1.0 / observer.r, (observer.r - 2.0) / observer.r) } else { 0.0 }
}
