// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random observers, and where their cameras look.

use super::truth::{Truth, around};
use crate::random::Random;
use bhr::physics::observer::Observer;
use bhr::physics::orbit::{horizon_outer, photon_orbit};
use bhr::physics::trace::Fate;
use bhr::scene::{Camera, LensTables, Motion, Scene};
use glam::DVec3;
use std::f64::consts::PI;

/// A random observer: r to 1000 M, one in three falling (to the horizon, and inside it without spin), one in three
/// without spin.
pub fn random_observer(random: &mut Random, index: usize) -> Scene {
    let mut scene = Scene::plain();
    let any_spin = random.range(-0.9999, 0.9999);
    let end = random.pick(&[-0.9999, 0.9999]);
    scene.hole.spin = if index.is_multiple_of(3) { 0.0 } else { random.pick(&[any_spin, any_spin, any_spin, end]) };
    let spin = scene.hole.spin;
    let motion = match index / 3 % 3 {
        0 => Motion::FreeFall,
        _ => random.pick(&[Motion::Static, Motion::Static, Motion::Velocity, Motion::Orbit]),
    };
    let nearest = match motion {
        Motion::FreeFall if spin == 0.0 => 1.0,
        Motion::FreeFall => horizon_outer(spin) + 0.05,
        Motion::Orbit => photon_orbit(spin).max(2.1) * 1.02,
        _ => 2.1,
    };
    let r = random.log_range(nearest, 1000.0);
    let inclination = random.range(0.0, PI);
    let (s, c) = match random.pick(&[0, 1, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3]) {
        _ if motion == Motion::Orbit && spin != 0.0 => (1.0, 0.0),
        0 => (0.0, 1.0),
        1 => (0.0, -1.0),
        2 => (1.0, 0.0),
        _ => inclination.sin_cos(),
    };
    let (sin_phi, cos_phi) = random.range(-PI, PI).sin_cos();
    let disk = scene.disk.as_mut().unwrap();
    (disk.outer_radius, disk.opacity) = (50.0, 0.5);
    disk.retrograde = random.next() < 0.5;
    disk.turbulence = random.pick(&[0.0, 1.0]);
    let forward = random.direction();
    scene.camera = Camera {
        position: DVec3::new(s * cos_phi, s * sin_phi, c) * r,
        motion,
        velocity: random.direction() * random.range(0.0, 0.9),
        ..looking(forward, random, 1.0)
    };
    scene.quality.lens_tables = LensTables::Always;
    scene
}

/// A camera that looks along `forward`, turned about it by chance.
pub fn looking(forward: DVec3, random: &mut Random, fov_y: f64) -> Camera {
    let (right, up) = around(forward);
    let (s, c) = random.range(-PI, PI).sin_cos();
    Camera { forward, up: right * s + up * c, fov_y, ..Camera::plain() }
}

/// Turns the scene's camera to `forward` (chart).
pub fn turn(scene: &mut Scene, forward: DVec3, random: &mut Random, fov_y: f64) {
    let Camera { position, motion, velocity, .. } = scene.camera;
    scene.camera = Camera { position, motion, velocity, ..looking(forward, random, fov_y) };
}

/// A random direction (chart) on the shadow's edge as the scene's camera sees it; `None` where looking at the hole
/// captures no ray.
pub fn shadow_edge(scene: &Scene, random: &mut Random) -> Option<DVec3> {
    let truth = Truth::new(scene, 1, 1);
    let observer = truth.lens.observer;
    let mut dark = Observer::moving(observer.frame, -observer.beta).aberrate(DVec3::NEG_X).0;
    let escapes = |n: DVec3| truth.sight(n).fate == Fate::Escaped;
    if escapes(dark) {
        return None;
    }
    let mut light = (0..100).map(|_| random.direction()).find(|n| escapes(*n))?;
    for _ in 0..40 {
        let middle = (dark + light).normalize();
        if escapes(middle) { light = middle } else { dark = middle }
    }
    Some(observer.frame.vector(light))
}

/// Points the camera: in half of the frames at the shadow's edge, closely; else at the hole and its surroundings, or
/// anywhere, with fields of 1 to 170 degrees.
pub fn aim(scene: &mut Scene, random: &mut Random) {
    let edge = shadow_edge(scene, random);
    let (wide, narrow) = (random.range(1.0, 170.0).to_radians(), random.log_range(1e-4, 0.1));
    // The disk is 50 M wide.
    let disk = (100.0 / scene.camera.position.length() * random.log_range(0.1, 1.0)).clamp(1.0_f64.to_radians(), 2.9);
    let anywhere = random.direction();
    let (forward, fov_y) = match (random.pick(&[0, 0, 1, 2]), edge) {
        (0, Some(edge)) => (edge, narrow),
        (1, Some(edge)) => (edge, disk),
        _ => (anywhere, wide),
    };
    turn(scene, forward, random, fov_y);
}
