// SPDX-License-Identifier: MIT OR Apache-2.0
//! All that setters take, as plain structs in sections that have names: between a scene and its text. Knows no text.

use crate::capi::camera::{self, BhrCamera};
use crate::capi::disk::BhrDisk;
use crate::capi::field_list::{EFFECTS, VIEWS};
use crate::capi::fields::{Described, Field, Kind, bytes_of, bytes_of_mut};
use crate::capi::film::BhrFilm;
use crate::capi::pointer::check_finite;
use crate::capi::quality::BhrQuality;
use crate::capi::region::BhrRegion;
use crate::capi::sky::BhrSky;
use crate::capi::view;
use crate::capi::volume::{BhrHotSpot, BhrVolume};
use crate::error::{Error, Result};
use crate::scene::{Camera, EffectStrengths, Effects, Film, Hole, HotSpot, Region, Scene, Volume};
use arrayvec::ArrayVec;
use glam::DVec3;
use std::mem::offset_of;

/// The values of bhr_set_time, bhr_set_shutter, bhr_set_effects, bhr_set_view and bhr_set_effect_strength.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Moment {
    pub time: f64,
    pub shutter: f64,
    pub effects: u32,
    pub view: i32,
    /// In the order of the bits.
    pub effect_strengths: [f64; 3],
}

/// The values of bhr_set_mass, bhr_set_spin and bhr_set_axis.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct HoleValues {
    pub mass: f64,
    pub spin: f64,
    pub axis: [f64; 3],
}

/// A camera's place by bhr_camera_orbit.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct Orbit {
    pub distance: f64,
    pub azimuth: f64,
    pub elevation: f64,
}

/// A place that a camera looks at.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct Aim {
    pub look_at: [f64; 3],
}

/// A turn of the camera's look, from where the other values point it: to the right about its up, then up, then about
/// the look itself, clockwise. Radians.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct Turn {
    pub right: f64,
    pub up: f64,
    pub roll: f64,
}

impl Turn {
    /// Errors: as [`Camera::axes`]; angles that are no numbers.
    fn apply(&self, camera: &mut Camera) -> Result<()> {
        for (name, angle) in [("right", self.right), ("up", self.up), ("roll", self.roll)] {
            check_finite(angle, &format!("camera turn {name}"))?;
        }
        let axes = camera.axes()?;
        let (right, up, forward) = (axes.x_axis, axes.y_axis, axes.z_axis);
        let (sin, cos) = self.right.sin_cos();
        let (forward, right) = (forward * cos + right * sin, right * cos - forward * sin);
        let (sin, cos) = self.up.sin_cos();
        let (forward, up) = (forward * cos + up * sin, up * cos - forward * sin);
        let (sin, cos) = self.roll.sin_cos();
        (camera.forward, camera.up) = (forward, up * cos + right * sin);
        Ok(())
    }
}

/// A camera's way along its world line, by bhr_camera_advance.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct Path {
    pub proper_time: f64,
}

/// The pictures that a program makes of a scene: their size, and how many of them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Render {
    /// Pixels.
    pub width: u32,
    pub height: u32,
    /// Seconds; 0: one picture.
    pub duration: f64,
    pub frames_per_second: f64,
}

impl Default for Render {
    fn default() -> Self {
        Self { width: 1920, height: 1080, duration: 0.0, frames_per_second: 24.0 }
    }
}

impl Render {
    /// The rates of films that are made.
    const RATES: [f64; 2] = [1.0, 1000.0];
    /// Films of more frames than this are a slip.
    const MOST_FRAMES: f64 = 1e8;

    /// Errors: INVALID_ARGUMENT for a number out of range.
    pub fn check(&self) -> Result<()> {
        let most = Region::MAX_FRAME_SIDE;
        for (name, side) in [("width", self.width), ("height", self.height)] {
            if !(1..=most).contains(&side) {
                return Err(Error::argument(format!("render {name} is {side}; it must lie in [1, {most}]")));
            }
        }
        let [low, high] = Self::RATES;
        if !(low..=high).contains(&self.frames_per_second) {
            let rate = self.frames_per_second;
            return Err(Error::argument(format!("render frames_per_second is {rate}; it must lie in [{low}, {high}]")));
        }
        let most = Self::MOST_FRAMES / self.frames_per_second;
        if !(0.0..=most).contains(&self.duration) {
            let duration = self.duration;
            return Err(Error::argument(format!("render duration is {duration} s; it must lie in [0, {most}]")));
        }
        Ok(())
    }

    /// The number of pictures, 1 at least: frame n shows the scene at n / frames_per_second.
    pub fn frames(&self) -> u32 {
        (self.duration * self.frames_per_second).round().clamp(1.0, Self::MOST_FRAMES) as u32
    }
}

const fn field(name: &'static str, offset: usize, kind: Kind) -> Field {
    Field { name, offset, kind }
}

// SAFETY: repr(C), 48 bytes without padding, numbers only.
unsafe impl Described for Moment {
    const FIELDS: &'static [Field] = &[
        field("time", offset_of!(Moment, time), Kind::Numbers(1)),
        field("shutter", offset_of!(Moment, shutter), Kind::Numbers(1)),
        field("effects", offset_of!(Moment, effects), Kind::Bits(EFFECTS)),
        field("view", offset_of!(Moment, view), Kind::Word(VIEWS)),
        field("effect_strengths", offset_of!(Moment, effect_strengths), Kind::Numbers(3)),
    ];
}

// SAFETY: repr(C), doubles only.
unsafe impl Described for HoleValues {
    const FIELDS: &'static [Field] = &[
        field("mass", offset_of!(HoleValues, mass), Kind::Numbers(1)),
        field("spin", offset_of!(HoleValues, spin), Kind::Numbers(1)),
        field("axis", offset_of!(HoleValues, axis), Kind::Numbers(3)),
    ];
}

// SAFETY: repr(C), doubles only.
unsafe impl Described for Orbit {
    const FIELDS: &'static [Field] = &[
        field("distance", offset_of!(Orbit, distance), Kind::Numbers(1)),
        field("azimuth", offset_of!(Orbit, azimuth), Kind::Angle),
        field("elevation", offset_of!(Orbit, elevation), Kind::Angle),
    ];
}

// SAFETY: repr(C), doubles only.
unsafe impl Described for Turn {
    const FIELDS: &'static [Field] = &[
        field("right", offset_of!(Turn, right), Kind::Angle),
        field("up", offset_of!(Turn, up), Kind::Angle),
        field("roll", offset_of!(Turn, roll), Kind::Angle),
    ];
}

// SAFETY: repr(C), doubles only.
unsafe impl Described for Aim {
    const FIELDS: &'static [Field] = &[field("look_at", offset_of!(Aim, look_at), Kind::Numbers(3))];
}

// SAFETY: repr(C), doubles only.
unsafe impl Described for Path {
    const FIELDS: &'static [Field] = &[field("proper_time", offset_of!(Path, proper_time), Kind::Numbers(1))];
}

// SAFETY: repr(C), 24 bytes without padding, numbers only.
unsafe impl Described for Render {
    const FIELDS: &'static [Field] = &[
        field("width", offset_of!(Render, width), Kind::Count),
        field("height", offset_of!(Render, height), Kind::Count),
        field("duration", offset_of!(Render, duration), Kind::Numbers(1)),
        field("frames_per_second", offset_of!(Render, frames_per_second), Kind::Numbers(1)),
    ];
}

/// A camera from a moment on, until the next one's.
#[derive(Clone, Copy)]
pub struct Shot {
    /// Seconds; the first one's is minus infinity.
    pub at: f64,
    pub camera: BhrCamera,
    pub orbit: Option<Orbit>,
    pub path: Option<Path>,
    pub aim: Option<Aim>,
    pub turn: Option<Turn>,
}

impl Shot {
    pub fn of(camera: BhrCamera) -> Self {
        Self { at: f64::NEG_INFINITY, camera, orbit: None, path: None, aim: None, turn: None }
    }

    /// Whether more than the camera's own fields say where it is.
    pub fn is_derived(&self) -> bool {
        self.orbit.is_some() || self.path.is_some() || self.aim.is_some() || self.turn.is_some()
    }

    /// The camera about the scene's hole, and the scene time that has gone by on its world line. Errors: as
    /// bhr_camera_orbit, bhr_camera_advance, bhr_camera_look_at; a turn that is no number.
    fn camera(&self, scene: &Scene) -> Result<(Camera, f64)> {
        let mut given = self.camera;
        if let Some(Orbit { distance, azimuth, elevation }) = self.orbit {
            let (position, up) = camera::orbit(distance, azimuth, elevation)?;
            (given.position, given.forward, given.up) = (position.to_array(), (-position).to_array(), up.to_array());
        }
        if let Some(Aim { look_at }) = self.aim.filter(|_| self.path.is_none()) {
            // Before the check: the forward that is replaced, which nobody has stated, may lie along up.
            given.forward = (DVec3::from_array(look_at) - DVec3::from_array(given.position)).to_array();
        }
        let mut camera = Camera::try_from(given)?;
        let mut time = 0.0;
        if let Some(Path { proper_time }) = self.path {
            (camera, time) = scene.advance_camera(&camera, proper_time)?;
            if let Some(Aim { look_at }) = self.aim {
                camera.forward = DVec3::from_array(look_at) - camera.position;
            }
            // A way that is too long for numbers ends nowhere.
            camera.check()?;
        }
        if let Some(turn) = self.turn {
            turn.apply(&mut camera)?;
        }
        Ok((camera, time))
    }
}

/// Where a field stands: the struct, by the place that it has in the scene's text. Numbers count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Section {
    Moment,
    Hole,
    /// The fields of a shot's camera.
    Camera(usize),
    Orbit(usize),
    Path(usize),
    Aim(usize),
    Turn(usize),
    Disk,
    Volume(usize),
    HotSpot(usize),
    Sky,
    Film,
    Quality,
    Region,
    Render,
}

impl Section {
    /// How messages call it.
    pub fn name(self) -> String {
        match self {
            Self::Moment => "the scene".into(),
            Self::Hole => "[hole]".into(),
            Self::Camera(0) | Self::Path(0) | Self::Aim(0) => "[camera]".into(),
            Self::Camera(i) | Self::Path(i) | Self::Aim(i) => format!("the camera of [[cuts]] {i}"),
            Self::Orbit(0) => "[camera.orbit]".into(),
            Self::Orbit(i) => format!("the camera's orbit of [[cuts]] {i}"),
            Self::Turn(0) => "[camera.turn]".into(),
            Self::Turn(i) => format!("the camera's turn of [[cuts]] {i}"),
            Self::Disk => "[disk]".into(),
            Self::Volume(i) => format!("[[volumes]] {}", i + 1),
            Self::HotSpot(i) => format!("[[hot_spots]] {}", i + 1),
            Self::Sky => "[sky]".into(),
            Self::Film => "[film]".into(),
            Self::Quality => "[quality]".into(),
            Self::Region => "[region]".into(),
            Self::Render => "[render]".into(),
        }
    }

    pub fn fields(self) -> &'static [Field] {
        match self {
            Self::Moment => Moment::FIELDS,
            Self::Hole => HoleValues::FIELDS,
            Self::Camera(_) => BhrCamera::FIELDS,
            Self::Orbit(_) => Orbit::FIELDS,
            Self::Path(_) => Path::FIELDS,
            Self::Aim(_) => Aim::FIELDS,
            Self::Turn(_) => Turn::FIELDS,
            Self::Disk => BhrDisk::FIELDS,
            Self::Volume(_) => BhrVolume::FIELDS,
            Self::HotSpot(_) => BhrHotSpot::FIELDS,
            Self::Sky => BhrSky::FIELDS,
            Self::Film => BhrFilm::FIELDS,
            Self::Quality => BhrQuality::FIELDS,
            Self::Region => BhrRegion::FIELDS,
            Self::Render => Render::FIELDS,
        }
    }

    /// The shot that a camera's section belongs to.
    pub fn shot(self) -> Option<usize> {
        match self {
            Self::Camera(i) | Self::Orbit(i) | Self::Path(i) | Self::Aim(i) | Self::Turn(i) => Some(i),
            _ => None,
        }
    }
}

/// An error of a scene, and the section that it is about.
pub type Misfit = (Section, Error);

/// All that setters take, but for pictures in memory, and the pictures that are to be made.
#[derive(Clone)]
pub struct Values {
    pub moment: Moment,
    pub hole: HoleValues,
    /// One at least; each after the first begins later than the one before.
    pub shots: Vec<Shot>,
    pub disk: Option<BhrDisk>,
    pub volumes: ArrayVec<BhrVolume, { Volume::MOST }>,
    /// The one of the volumes that a preset set.
    pub of_preset: Option<usize>,
    pub hot_spots: ArrayVec<BhrHotSpot, { HotSpot::MOST }>,
    pub sky: BhrSky,
    pub film: BhrFilm,
    /// [`Film::glare_is_optional`].
    pub glare_is_optional: bool,
    /// Whether the film's `grain_seed` is the time in seconds, so that each frame of a film has a grain of its own.
    pub grain_moves: bool,
    pub quality: BhrQuality,
    pub region: Option<BhrRegion>,
    pub render: Option<Render>,
}

impl Values {
    /// The scene as it is set.
    pub fn of(scene: &Scene, region: Option<Region>) -> Self {
        let Hole { mass, spin, axis } = scene.hole;
        let own = |own: &Volume| scene.volumes.iter().position(|volume| volume == own);
        Self {
            moment: Moment {
                time: scene.time,
                shutter: scene.shutter,
                effects: scene.effects.0,
                view: view::number(scene.view),
                effect_strengths: scene.effect_strengths.to_array(),
            },
            hole: HoleValues { mass, spin, axis: axis.to_array() },
            shots: vec![Shot::of(scene.camera.into())],
            disk: scene.disk.map(Into::into),
            volumes: scene.volumes.iter().map(|volume| (*volume).into()).collect(),
            of_preset: scene.preset_volume.as_ref().and_then(own),
            hot_spots: scene.hot_spots.iter().map(|spot| (*spot).into()).collect(),
            sky: scene.sky.into(),
            film: scene.film.into(),
            glare_is_optional: scene.film.glare_is_optional,
            grain_moves: false,
            quality: scene.quality.into(),
            region: region.map(Into::into),
            render: None,
        }
    }

    /// The sections that are there, in the order of the text.
    pub fn sections(&self) -> Vec<Section> {
        let mut all = vec![Section::Moment, Section::Hole];
        for (i, shot) in self.shots.iter().enumerate() {
            all.push(Section::Camera(i));
            all.extend(shot.orbit.map(|_| Section::Orbit(i)));
            all.extend(shot.path.map(|_| Section::Path(i)));
            all.extend(shot.aim.map(|_| Section::Aim(i)));
            all.extend(shot.turn.map(|_| Section::Turn(i)));
        }
        all.extend(self.disk.map(|_| Section::Disk));
        all.extend((0..self.volumes.len()).map(Section::Volume));
        all.extend((0..self.hot_spots.len()).map(Section::HotSpot));
        all.extend([Section::Sky, Section::Film, Section::Quality]);
        all.extend(self.region.map(|_| Section::Region));
        all.extend(self.render.map(|_| Section::Render));
        all
    }

    /// The bytes of a section's struct; `None` where the scene has none.
    pub fn bytes(&self, section: Section) -> Option<&[u8]> {
        Some(match section {
            Section::Moment => bytes_of(&self.moment),
            Section::Hole => bytes_of(&self.hole),
            Section::Camera(i) => bytes_of(&self.shots.get(i)?.camera),
            Section::Orbit(i) => bytes_of(self.shots.get(i)?.orbit.as_ref()?),
            Section::Path(i) => bytes_of(self.shots.get(i)?.path.as_ref()?),
            Section::Aim(i) => bytes_of(self.shots.get(i)?.aim.as_ref()?),
            Section::Turn(i) => bytes_of(self.shots.get(i)?.turn.as_ref()?),
            Section::Disk => bytes_of(self.disk.as_ref()?),
            Section::Volume(i) => bytes_of(self.volumes.get(i)?),
            Section::HotSpot(i) => bytes_of(self.hot_spots.get(i)?),
            Section::Sky => bytes_of(&self.sky),
            Section::Film => bytes_of(&self.film),
            Section::Quality => bytes_of(&self.quality),
            Section::Region => bytes_of(self.region.as_ref()?),
            Section::Render => bytes_of(self.render.as_ref()?),
        })
    }

    /// [`Self::bytes`], to be changed.
    pub fn bytes_mut(&mut self, section: Section) -> Option<&mut [u8]> {
        Some(match section {
            Section::Moment => bytes_of_mut(&mut self.moment),
            Section::Hole => bytes_of_mut(&mut self.hole),
            Section::Camera(i) => bytes_of_mut(&mut self.shots.get_mut(i)?.camera),
            Section::Orbit(i) => bytes_of_mut(self.shots.get_mut(i)?.orbit.as_mut()?),
            Section::Path(i) => bytes_of_mut(self.shots.get_mut(i)?.path.as_mut()?),
            Section::Aim(i) => bytes_of_mut(self.shots.get_mut(i)?.aim.as_mut()?),
            Section::Turn(i) => bytes_of_mut(self.shots.get_mut(i)?.turn.as_mut()?),
            Section::Disk => bytes_of_mut(self.disk.as_mut()?),
            Section::Volume(i) => bytes_of_mut(self.volumes.get_mut(i)?),
            Section::HotSpot(i) => bytes_of_mut(self.hot_spots.get_mut(i)?),
            Section::Sky => bytes_of_mut(&mut self.sky),
            Section::Film => bytes_of_mut(&mut self.film),
            Section::Quality => bytes_of_mut(&mut self.quality),
            Section::Region => bytes_of_mut(self.region.as_mut()?),
            Section::Render => bytes_of_mut(self.render.as_mut()?),
        })
    }

    /// The number of the shot that shows at a time.
    pub fn shot_at(&self, seconds: f64) -> usize {
        self.shots.iter().rposition(|shot| shot.at <= seconds).unwrap_or(0)
    }

    /// A scene with these values, its camera that of a time; what else it has (maps, occluders) is `scene`'s. Errors:
    /// as the setters; INVALID_STATE where a camera's motion is not possible.
    pub fn set_in(&self, scene: &Scene, seconds: f64) -> Result<(Scene, Option<Region>), Misfit> {
        let mut scene = scene.clone();
        let at = |section: Section| move |error: Error| (section, error);
        let HoleValues { mass, spin, axis } = self.hole;
        let hole = Hole::check_mass(mass)
            .and_then(|mass| Ok(Hole { mass, spin: Hole::check_spin(spin)?, axis: Hole::check_axis(axis.into())? }));
        scene.hole = hole.map_err(at(Section::Hole))?;
        let shot = self.shot_at(seconds);
        let moved = self.shots.get(shot).map(|shot| shot.camera(&scene)).transpose();
        let (camera, passed) = moved.map_err(at(Section::Camera(shot)))?.unwrap_or((scene.camera, 0.0));
        scene.camera = camera;
        let Moment { time, shutter, effects, view, effect_strengths } = self.moment;
        scene.time = check_finite(time + passed, "time").map_err(at(Section::Moment))?;
        scene.shutter = Scene::check_shutter(shutter).map_err(at(Section::Moment))?;
        scene.effects = Effects(effects);
        scene.effect_strengths = EffectStrengths::checked(effect_strengths).map_err(at(Section::Moment))?;
        scene.view = view::view(view, "view").map_err(at(Section::Moment))?;
        scene.disk = self.disk.map(TryInto::try_into).transpose().map_err(at(Section::Disk))?;
        scene.volumes.clear();
        for (volume, i) in self.volumes.iter().zip(0..) {
            scene.volumes.push(Volume::try_from(*volume).map_err(at(Section::Volume(i)))?);
        }
        scene.preset_volume = self.of_preset.and_then(|own| scene.volumes.get(own).copied());
        scene.hot_spots.clear();
        for (spot, i) in self.hot_spots.iter().zip(0..) {
            let spot = HotSpot::try_from(*spot).map_err(at(Section::HotSpot(i)))?;
            spot.free.map_or(Ok(()), |body| scene.hole.check_falling(&body)).map_err(at(Section::HotSpot(i)))?;
            scene.hot_spots.push(spot);
        }
        scene.sky = self.sky.try_into().map_err(at(Section::Sky))?;
        let film = Film::try_from(self.film).map_err(at(Section::Film))?;
        scene.film = Film { glare_is_optional: self.glare_is_optional, ..film };
        scene.quality = self.quality.try_into().map_err(at(Section::Quality))?;
        let region = self.region.map(TryInto::try_into).transpose().map_err(at(Section::Region))?;
        if let Some(render) = &self.render {
            render.check().map_err(at(Section::Render))?;
        }
        Ok((scene, region))
    }
}
