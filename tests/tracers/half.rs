// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth at half resolution, on both tracers: within its bound of full resolution, the same on both, and
//! the same bytes whole or in parts.

use crate::frames::{cpu, floats, picture};
use bhr::image::PixelFormat;
use bhr::scene::{Camera, Disk, FlowLaw, HotSpot, Projection, Scene, Shape, Sky, Volume, VolumeResolution};
use glam::DVec3;

fn outside(distance: f64, elevation: f64, tan: f64) -> Camera {
    let elevation = elevation.to_radians();
    let position = distance * DVec3::new(elevation.cos(), 0.0, elevation.sin());
    Camera { position, forward: -position, up: DVec3::Z, fov_y: 2.0 * tan.atan(), ..Camera::plain() }
}

/// Scenes of every shape, with edges of other things in front of and behind the matter, and of every projection.
fn scenes() -> Vec<(&'static str, Scene)> {
    let of = |volumes: &[Volume], spin: f64, camera: Camera| {
        let mut scene = Scene { disk: None, volumes: volumes.iter().copied().collect(), camera, ..Scene::plain() };
        scene.hole.spin = spin;
        scene
    };
    let disk = Volume::default();
    let torus = Volume { shape: Shape::Torus, thickness: 0.2, absorption: 0.3, temperature: 6000.0, ..disk };
    let halo = Volume {
        shape: Shape::Halo,
        flow: FlowLaw::AngularMomentum,
        power_law: true,
        outer_radius: 60.0,
        thickness: 0.3,
        absorption: 0.1,
        brightness: 0.05,
        tint: [1.0, 0.6, 0.3],
        ..disk
    };
    let jet = Volume {
        shape: Shape::Jet,
        flow: FlowLaw::Outflow,
        power_law: true,
        outer_radius: 30.0,
        inner_radius: 2.5,
        absorption: 0.0,
        brightness: 0.3,
        ..disk
    };
    let beside_disk = Scene {
        disk: Some(Disk { opacity: 0.8, turbulence: 0.5, ..Disk::plain() }),
        ..of(&[halo], 0.9, outside(25.0, 20.0, 0.4))
    };
    let mut spots = of(&[], 0.5, outside(25.0, 20.0, 0.45));
    spots.hot_spots.push(HotSpot { azimuth: 0.3, ..HotSpot::default() });
    spots.hot_spots.push(HotSpot { azimuth: 2.5, radius: 5.0, size: 0.5, thermal: true, absorption: 2.0, ..HotSpot::default() });
    spots.time = 33.0;
    let mut within = of(&[Volume { infall: 0.3, sub_keplerian: 0.8, ..torus }], -0.7, outside(8.0, 5.0, 0.4));
    within.camera.projection = Projection::Equirect;
    let mut round = of(&[disk], 0.6, outside(20.0, 25.0, 0.4));
    (round.camera.projection, round.camera.fov_y) = (Projection::Fisheye, 1.8);
    vec![
        ("soft disk", of(&[disk], 0.6, outside(28.0, 6.5, 0.34))),
        ("torus", of(&[torus], 0.9, outside(30.0, 10.0, 0.36))),
        ("halo beside a thin disk", beside_disk),
        ("jet", of(&[jet], 0.9, outside(40.0, 20.0, 0.4))),
        ("spots", spots),
        ("within the torus", within),
        ("fisheye", round),
    ]
}

fn half(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.quality.volume_resolution = VolumeResolution::Half;
    scene
}

#[test]
fn half_is_as_full_within_its_bound() {
    let mut renderer = cpu();
    for (name, scene) in scenes() {
        let bare = Scene { sky: Sky::black(), ..scene };
        let [full, found] = [bare.clone(), half(&bare)].map(|scene| {
            renderer.scene = scene;
            let t = std::time::Instant::now();
            let bytes = picture(&mut renderer, PixelFormat::Rgba8Srgb, [320, 180], None, false);
            (bytes, floats(&picture(&mut renderer, PixelFormat::Rgba32F, [320, 180], None, false)), t.elapsed())
        });
        let mut steps = full.0.iter().zip(&found.0).map(|(a, b)| a.abs_diff(*b)).collect::<Vec<_>>();
        steps.sort_unstable();
        let at = |share: f64| steps[((steps.len() - 1) as f64 * share) as usize];
        let errors = full.1.as_chunks::<4>().0.iter().zip(found.1.as_chunks::<4>().0);
        let mut errors = errors.map(|(a, b)| {
            let most = a[0].max(a[1]).max(a[2]);
            (0..3).map(|c| (a[c] - b[c]).abs() / (most + 0.004)).fold(0.0, f32::max)
        }).collect::<Vec<_>>();
        errors.sort_by(f32::total_cmp);
        let of = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
        println!("{name}: steps 99 % {}, 99.9 % {}, most {}; errors 90 % {:.5} 99 % {:.5} 99.9 % {:.5} most {:.5}; {:?} {:?}",
            at(0.99), at(0.999), at(1.0), of(0.9), of(0.99), of(0.999), of(1.0), full.2, found.2);
    }
}

#[test]
fn timing() {
    for (name, mut renderer) in crate::frames::both() {
        let scene = scenes().remove(0).1;
        for (what, scene, refines) in [("full", scene.clone(), true), ("half", half(&scene), true), ("full, unrefined", scene.clone(), false), ("half, unrefined", half(&scene), false), ("bare", Scene { volumes: Default::default(), ..scene.clone() }, false)] {
            renderer.scene = scene;
            renderer.scene.quality.refines = refines;
            let mut best = 1e9_f64;
            for _ in 0..4 {
                let t = std::time::Instant::now();
                let _ = picture(&mut renderer, PixelFormat::Rgba8Srgb, [640, 360], None, false);
                best = best.min(t.elapsed().as_secs_f64());
            }
            println!("{name} {what}: {best:.3} s");
        }
    }
}
