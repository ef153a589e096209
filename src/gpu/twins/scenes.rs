// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes that twins see through the uniform `frame`, as the GPU tracer writes it: items name one by its number.

use super::inputs::{Inputs, Random};
use super::run::Table;
use super::sky;
use crate::gpu::frame::plan::f32_settings::for_f32;
use crate::gpu::frame::uniforms::frame::FrameUniform;
use crate::physics::metric::chart;
use crate::physics::orbit::{horizon_outer, innermost_radius};
use crate::scene::observer::Lens;
use crate::scene::{Camera, Chart, EffectStrengths, Effects, Frustum, Motion, Projection, Region, Scene, Sky};
use crate::scene::{DiskReference, EmissionLaw};
use glam::{DQuat, DVec3};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Names the scene of an item, by its word 0. For fragments that require `frame`.
pub const FRAME: &str = "#import shared/frame\nvar<private> frame: Frame;\n";
/// For fragments that bind `frame` themselves.
pub const FRAMES: &str = "
#import shared/frame
@group(1) @binding(15) var<storage, read> frames: array<Frame>;
fn enter_scene() { frame = frames[word(0u)]; }
";

pub struct View {
    pub scene: Scene,
    pub lens: Lens,
    pub uniform: FrameUniform,
}

/// The kinds of scenes, of which there are so many each, one kind after the other.
#[derive(Clone, Copy)]
pub enum Kind {
    /// A spinning hole, and observers that move in every way.
    Spinning,
    /// Spin 0, static, orbiting or moving observers.
    Static,
    /// Spin 0, falling observers outside the photon sphere and inside the horizon.
    Rain,
    /// A spinning hole, and falling and moving observers within r = 3 M, inside the horizon too.
    SpinningRain,
}

pub const EACH: u32 = 16;

impl Kind {
    /// Whether rays of it spin, and by which clock: the pipeline constants.
    pub fn constants(self) -> [(&'static str, f64); 4] {
        let flag = |on: bool| f64::from(u8::from(on));
        [
            ("SPINNING", flag(matches!(self, Self::Spinning | Self::SpinningRain))),
            ("DELAY", 1.0),
            ("RAIN", flag(matches!(self, Self::SpinningRain))),
            ("PROJECTION", f64::from(crate::gpu::kernel::choices::FROM_UNIFORM)),
        ]
    }

    /// Pushes the number of one of its scenes.
    pub fn push(self, i: &mut Inputs) -> &'static View {
        let number = self as u32 * EACH + i.random.below(EACH);
        i.push_word(number);
        &views()[number as usize]
    }
}

/// The scene of an item.
pub fn view(i: &Inputs) -> &'static View {
    &views()[i.word(0) as usize]
}

pub fn views() -> &'static [View] {
    static VIEWS: OnceLock<Vec<View>> = OnceLock::new();
    VIEWS.get_or_init(|| {
        let kinds = [Kind::Spinning, Kind::Static, Kind::Rain, Kind::SpinningRain];
        kinds.into_iter().flat_map(|kind| (0..EACH).map(move |number| made(kind, number))).collect()
    })
}

fn made(kind: Kind, number: u32) -> View {
    let mut random = Random(1000 * kind as u64 + u64::from(number));
    let mut scene = Scene::plain();
    let (mut r, mut theta) = (random.log(4.5, 200.0), random.even(0.1, PI - 0.1));
    scene.camera.motion = [Motion::Static, Motion::Velocity, Motion::FreeFall][number as usize % 3];
    match kind {
        Kind::Spinning => {
            scene.hole.spin = random.even(-0.998, 0.998);
            // Far from the hole tracers have these in the other chart.
            scene.camera.chart = if number % 4 == 2 { Chart::Rain } else { Chart::Static };
        }
        Kind::Static => scene.camera.motion = [Motion::Static, Motion::Velocity, Motion::Orbit][number as usize % 3],
        Kind::Rain => {
            scene.camera.motion = Motion::FreeFall;
            r = if number.is_multiple_of(2) { random.even(1.0, 2.9) } else { r };
        }
        Kind::SpinningRain => {
            scene.hole.spin = random.even(-0.998, 0.998);
            scene.camera.motion = [Motion::FreeFall, Motion::Velocity][number as usize % 2];
            scene.camera.chart = Chart::Rain;
            r = random.even(1.05 * innermost_radius(scene.hole.spin).max(0.1), 2.9);
        }
    }
    if number % 8 == 7 {
        theta = 0.5 * PI;
    }
    scene.hole.mass = random.log(0.1, 10.0);
    let mut place = chart(r, theta, random.even(0.0, 6.0));
    if number % 8 == 7 {
        place.z = 0.0;
    }
    scene.camera = Camera {
        projection: [
            if number.is_multiple_of(3) { Projection::Frustum } else { Projection::Perspective },
            Projection::Fisheye,
            Projection::Equirect,
            Projection::Cube,
        ][(number / 4) as usize % 4],
        position: place * scene.hole.mass,
        forward: random.direction() - place.normalize() * 1.5,
        up: random.direction(),
        fov_y: random.even(0.3, 1.5),
        velocity: random.direction() * random.even(0.0, 0.9),
        motion: scene.camera.motion,
        chart: scene.camera.chart,
        frustum: Frustum { left: -0.9, right: random.even(-0.5, 0.8), down: 0.1, up: random.even(0.2, 1.4) },
        jitter: 0.5 * random.direction().truncate(),
        ..Camera::plain()
    };
    if number == 13 || number == 19 {
        // Swifter than `Observer::SWIFT`.
        scene.camera.velocity = scene.camera.velocity.normalize() * (1.0 - 1e-9);
    }
    let disk = scene.disk.as_mut().expect("the default scene has a disk");
    disk.retrograde = number.is_multiple_of(5);
    disk.opacity = [1.0, 0.5, 0.7][number as usize % 3];
    disk.brightness = random.log(0.1, 10.0);
    disk.temperature = random.log(1000.0, 50_000.0);
    disk.turbulence = random.even(0.2, 1.0);
    disk.reference = [DiskReference::Hottest, DiskReference::Median][number as usize / 2 % 2];
    disk.edge_softness = if number % 4 == 1 { random.even(0.05, 0.9) } else { 0.0 };
    disk.emission_law = [EmissionLaw::Isotropic, EmissionLaw::LimbDarkened][number as usize / 3 % 2];
    // Matter plunges as far in as f32 knows the distance from the horizon well.
    disk.plunges = number % 6 == 4;
    disk.inner_radius = if disk.plunges { 1.3 * horizon_outer(scene.hole.spin) } else { 0.0 };
    disk.seed = random.bits();
    scene.time = random.even(0.0, 1e4);
    scene.sky.orientation = DQuat::from_xyzw(random.share(), random.share(), random.share(), 1.0).normalize();
    scene.sky.flags = Sky::STARS | Sky::GRID | Sky::MAP;
    scene.sky.stars_brightness = random.log(0.5, 2.0);
    scene.sky.map_brightness = random.log(0.1, 2.0);
    scene.sky_map = Some(sky::stored_map().clone());
    // Physics, some effects off, some weakened.
    if number % 3 == 1 {
        scene.effects = Effects(random.bits() as u32 & Effects::ALL);
    }
    if number % 3 == 2 {
        let mut strength = || random.even(0.0, 1.0);
        scene.effect_strengths =
            EffectStrengths { doppler_shift: strength(), gravity_shift: strength(), beaming: strength() };
    }
    let height = 90;
    let full_width = if scene.camera.projection == Projection::Cube { 6 * height } else { 160 };
    let region = Region { full_width, full_height: height, x: 0, y: 0 };
    let lens = scene.lens(&region).unwrap_or_else(|error| panic!("scene {number}: {error}"));
    let mut uniform =
        FrameUniform::new(&scene, &scene.emitters(), &lens, &for_f32(scene.pixel_settings()), 4).expect("a uniform");
    let size = sky::map().levels()[0].size;
    (uniform.milky_way_size, uniform.map_size) = (size, size);
    View { scene, lens, uniform }
}

pub fn tables() -> Vec<Table> {
    let bytes = views().iter().flat_map(|view| bytemuck::bytes_of(&view.uniform).to_vec()).collect();
    vec![Table { name: "frames", bytes }]
}

/// Pushes a place of the frame, pixels, within it and a little beside.
pub fn push_place(i: &mut Inputs, view: &View) {
    let mapping = &view.lens.mapping;
    i.even(-1.0, mapping.width + 1.0);
    i.even(-1.0, mapping.height + 1.0);
}

/// A look direction in the local frame that light can come from.
pub fn push_look(i: &mut Inputs, view: &View) -> DVec3 {
    let frame = &view.lens.observer.frame;
    loop {
        let n = i.random.direction();
        if frame.momenta().energy(n) > 0.02 && frame.start(n).is_some() {
            return i.vector(n);
        }
    }
}
