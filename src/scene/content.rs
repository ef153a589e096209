// SPDX-License-Identifier: MIT OR Apache-2.0
//! The scene itself: everything that a frame depends on but its size.

use super::camera::Camera;
use super::chart::Chart;
use super::film::{ColourMap, Film};
use super::frame::Region;
use super::hole::Hole;
use super::occluder::Occluder;
use super::on_device::OnDevice;
use super::quality::Quality;
use super::sky::Sky;
use crate::emit::bands::When;
use crate::emit::disk::Disk;
use crate::emit::effects::{EffectStrengths, Effects};
use crate::emit::hot_spot::HotSpot;
use crate::emit::matter::Accuracy;
use crate::emit::moment::Shutter;
use crate::emit::thin_disk::ThinDisk;
use crate::emit::turbulence::Turbulence;
use crate::emit::volume::Volume;
use crate::emit::volumes::Volumes;
use crate::emit::{Emitters, Needs};
use crate::error::{Error, Result, out_of_range};
use crate::image::{Lut, PixelFormat};
use crate::physics::geodesic::Clock;
use crate::physics::observer::LocalFrame;
use crate::sky::{StarField, StarIndex, StoredMap};
use arrayvec::ArrayVec;
use std::borrow::Cow;
use std::sync::Arc;

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
    /// The optical depth of all matter with depth along the ray; NaN unless escaped.
    OpticalDepth = 6,
    /// I_nu of power laws, the camera's frequency being that at which they send 1 per M (`emit::glow`).
    Intensity = 7,
}

impl View {
    /// The part of the C constant's name after `BHR_VIEW_`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "LIGHT",
            Self::Redshift => "REDSHIFT",
            Self::Order => "ORDER",
            Self::Deflection => "DEFLECTION",
            Self::Steps => "STEPS",
            Self::Metric => "METRIC",
            Self::OpticalDepth => "OPTICAL_DEPTH",
            Self::Intensity => "INTENSITY",
        }
    }

    /// Whether it shows matter with depth, and not the thin disk.
    pub fn shows_depth_only(self) -> bool {
        matches!(self, Self::OpticalDepth | Self::Intensity)
    }
}

/// The longest shutter that may be set, scene lengths.
const MOST_SHUTTER: f64 = 1e300;

/// Everything a frame depends on, but its size.
#[derive(Clone, Debug)]
pub struct Scene {
    pub hole: Hole,
    pub camera: Camera,
    /// `None`: no disk.
    pub disk: Option<Disk>,
    /// Matter with depth, and hot spots.
    pub volumes: ArrayVec<Volume, { Volume::MOST }>,
    pub hot_spots: ArrayVec<HotSpot, { HotSpot::MOST }>,
    /// The volume that the last preset set, if it did and the host has not set others since.
    pub preset_volume: Option<Volume>,
    pub sky: Sky,
    /// The picture of `Sky::MAP`; `None`: it shows nothing.
    pub sky_map: Option<Arc<StoredMap>>,
    /// A picture on the tracer's device that takes the place of `sky_map`.
    pub sky_picture: Option<SkyPicture>,
    pub film: Film,
    /// Colours that take the places of developed ones: see `crate::film::lut`. `None`: these stay.
    pub film_lut: Option<Arc<Lut>>,
    pub effects: Effects,
    /// How strongly those show that are on. Default all of them as physics has them.
    pub effect_strengths: EffectStrengths,
    /// Scene time, in scene lengths; turns the disk. It is t, but for a camera at or inside a spin-0 horizon rain time
    /// T = t + H (`physics::geodesic::rain_offset`), which goes on where t ends.
    pub time: f64,
    /// How long the shutter is open, in scene lengths, half of it before `time`: each sample of a pixel sees matter at
    /// a moment of its own.
    pub shutter: f64,
    pub quality: Quality,
    pub view: View,
    /// The facts about rays that outputs ask for beside those that the emitters need (`Scene::for_outputs`).
    pub also_needs: Needs,
    /// The host's things before the camera, in a frame that is their size; LIGHT only. `None`: none.
    pub occluder: Option<Occluder>,
    /// Stars instead of the sky's: for tests.
    #[doc(hidden)]
    pub given_stars: Option<Arc<StarIndex>>,
}

/// A picture of the sky on the tracer's device: equirectangular, or the six faces of a cube side by side, as
/// `Projection::Cube` has them, of a camera that looks along +x of the sky axes, +z being up.
#[derive(Clone, Debug)]
pub struct SkyPicture {
    pub size: [u32; 2],
    pub cube: bool,
    pub format: PixelFormat,
    pub place: OnDevice,
}

impl SkyPicture {
    /// Columns and rows of the equirectangular map that is made from it: a cube's has as many on the equator as its
    /// four faces there.
    pub fn map_size(size: [u32; 2], cube: bool) -> [u32; 2] {
        if cube { [4, 2].map(|times: u32| times.saturating_mul(size[1])) } else { size }
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            hole: Hole::default(),
            camera: Camera::default(),
            disk: Some(Disk::default()),
            volumes: ArrayVec::new(),
            hot_spots: ArrayVec::new(),
            preset_volume: None,
            sky: Sky::default(),
            sky_map: None,
            sky_picture: None,
            film: Film::default(),
            film_lut: None,
            effects: Effects(Effects::ALL),
            effect_strengths: EffectStrengths::default(),
            time: 0.0,
            shutter: 0.0,
            quality: Quality::default(),
            view: View::Light,
            also_needs: Needs::default(),
            occluder: None,
            given_stars: None,
        }
    }
}

impl Scene {
    /// The longest time, M, that the shutter is open: some 70 orbits at the inner edge about a fast hole.
    pub const LONGEST_SHUTTER: f64 = 1000.0;

    /// How long the shutter may be open, scene lengths. Errors: INVALID_ARGUMENT.
    pub fn check_shutter(shutter: f64) -> Result<f64> {
        match (0.0..=MOST_SHUTTER).contains(&shutter) {
            true => Ok(shutter),
            false => Err(out_of_range("shutter", shutter, 0.0, MOST_SHUTTER)),
        }
    }

    /// The matter that shines and absorbs near the hole, as the scene's view shows it.
    pub fn emitters(&self) -> Emitters {
        let light = self.view == View::Light;
        let depth = self.view.shows_depth_only();
        let disk =
            self.disk.filter(|_| !depth).and_then(|disk| ThinDisk::new(&disk, self.hole.spin)).map(|disk| ThinDisk {
                turbulence: Turbulence::new(&disk.disk, disk.u, disk.matter_spin, &self.when()).filter(|_| light),
                ..disk
            });
        let mut also = self.also_needs;
        if light && self.occluder.is_some() {
            (also.places, also.beyond_things) = (true, true);
        }
        Emitters { disk, volumes: self.shown_volumes(), also }
    }

    /// Sets the host's volumes. One that a preset set is the preset's no more unless it is among them: one like it that
    /// comes later is the host's.
    pub fn set_volumes(&mut self, volumes: ArrayVec<Volume, { Volume::MOST }>) {
        self.preset_volume = self.preset_volume.filter(|own| volumes.contains(own));
        self.volumes = volumes;
    }

    /// Sets the host's hot spots. Errors: as `Hole::check_falling` for one in free fall.
    pub fn set_hot_spots(&mut self, spots: ArrayVec<HotSpot, { HotSpot::MOST }>) -> Result<()> {
        for (index, spot) in spots.iter().enumerate() {
            let Some(body) = &spot.free else { continue };
            let named = |error: Error| Error::new(error.kind, format!("hot_spots[{index}]: {}", error.message));
            self.hole.check_falling(body).map_err(named)?;
        }
        self.hot_spots = spots;
        Ok(())
    }

    /// The part of [`Self::emitters`] that has depth.
    pub fn shown_volumes(&self) -> Volumes {
        let light = self.view == View::Light;
        if !(light || self.view.shows_depth_only()) || (self.volumes.is_empty() && self.hot_spots.is_empty()) {
            return Volumes::default();
        }
        self.volumes_at(self.when(), if light { Accuracy::PICTURE } else { Accuracy::VIEW })
    }

    /// The LUT that pixels of 8 bits go through. Colour maps and views have colours of their own, which mean something.
    pub fn shown_lut(&self) -> Option<&Arc<Lut>> {
        let developed = self.view == View::Light && self.film.colour_map == ColourMap::None;
        self.film_lut.as_ref().filter(|_| developed && self.film.lut_strength > 0.0)
    }

    /// How strongly effects show: the strengths of those that are on.
    pub fn shown_effects(&self) -> EffectStrengths {
        self.effects.shown(self.effect_strengths)
    }

    /// The matter with depth as it is at a time.
    fn volumes_at(&self, when: When, accuracy: Accuracy) -> Volumes {
        // A spot that is told to fall from where the hole, as it is now, has no such place is nowhere.
        let in_chart = |spot: &HotSpot| match &spot.free {
            Some(body) => Some(HotSpot { free: Some(self.hole.falling_in_chart(body).ok()?), ..*spot }),
            None => Some(*spot),
        };
        let spots: ArrayVec<_, { HotSpot::MOST }> = self.hot_spots.iter().filter_map(in_chart).collect();
        Volumes::new(&self.volumes, &spots, self.hole.spin, self.shown_effects(), when, accuracy)
    }

    /// The matter with depth as an observer at `r` sees it who is at rest, or falls inside the horizon, and whose clock
    /// shows the scene's time: host's rays begin at such.
    pub fn volumes_now(&self, r: f64) -> Volumes {
        let delayed = self.effects.has(Effects::LIGHT_DELAY);
        let reference_delay = if delayed { r } else { 0.0 };
        let time = (self.time / self.hole.mass).clamp(f64::MIN, f64::MAX) - reference_delay;
        self.volumes_at(When { time, reference_delay, delayed, shutter: 0.0 }, Accuracy::EXACT)
    }

    /// The stars that a tracer is to hold: those of the sky, but none are made while none are shown. Errors: as
    /// `StarField::index`.
    pub fn stars(&self) -> Result<Arc<StarIndex>> {
        if let Some(stars) = &self.given_stars {
            return Ok(stars.clone());
        }
        match self.shown_field() {
            Some(field) => field.index(),
            None => self.field_of_sky().index_if_made().map_or_else(StarField::catalogue, Ok),
        }
    }

    fn field_of_sky(&self) -> StarField {
        self.sky.star_field().unwrap_or(StarField::Catalogue)
    }

    /// The field whose stars show; `None`: none do.
    pub fn shown_field(&self) -> Option<StarField> {
        (self.shows_stars() && self.view == View::Light).then(|| self.field_of_sky())
    }

    /// The scene of a frame's image of this size, with the host's things before it where the view is LIGHT. Errors:
    /// INVALID_ARGUMENT for those of another size.
    pub fn behind(&self, occluder: Option<&Occluder>, size: [u32; 2], region: &Region) -> Result<Cow<'_, Self>> {
        let Some(occluder) = occluder.filter(|_| self.view == View::Light) else { return Ok(Cow::Borrowed(self)) };
        self.check_one_eye("an occluder")?;
        let given = [occluder.width, occluder.height];
        if given != size {
            let ([w, h], [width, height]) = (given, size);
            return Err(Error::argument(format!("the occluder is {w} x {h}; the image is {width} x {height}")));
        }
        let occluder = Occluder { origin: [region.x, region.y], ..occluder.clone() };
        Ok(Cow::Owned(Self { occluder: Some(occluder), ..self.clone() }))
    }

    /// When the frame shows its emitters.
    fn when(&self) -> When {
        let delayed = self.effects.has(Effects::LIGHT_DELAY);
        let observer = self.observer().ok().map(|o| o.frame).filter(|_| delayed);
        let chart = self.camera.chart;
        let reference_delay = observer.map_or(0.0, |observer| observer.r);
        // A tiny mass can make the time infinite.
        let time = (self.time / self.hole.mass).clamp(f64::MIN, f64::MAX) - reference_delay
            + observer.map_or(0.0, |observer| clock_advance(&observer, chart));
        When { time, reference_delay, delayed, shutter: self.open_shutter().0 }
    }

    /// The shutter in M, at most `LONGEST_SHUTTER`: a tiny mass would make it endless.
    pub fn open_shutter(&self) -> Shutter {
        Shutter((self.shutter / self.hole.mass).min(Self::LONGEST_SHUTTER))
    }
}

/// The clock of an observer's delays less the time that the scene has in `chart` there, M: rain time less t, where one
/// is by the first and the other by the second.
pub(super) fn clock_advance(observer: &LocalFrame, chart: Chart) -> f64 {
    match (chart, observer.clock()) {
        (Chart::Static, Clock::Rain) if observer.r > 2.0 => observer.rain_time_offset(),
        (Chart::Rain, Clock::Coordinate) => -observer.rain_time_offset(),
        _ => 0.0,
    }
}
