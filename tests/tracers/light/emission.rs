// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light of the disk by the angle to its normal: pixel by pixel against the angle that follows from the ray's
//! angular momentum, and as distant disks show it.

use super::{both, camera, hits, light, luminance, neighbours, view, whole};
use crate::random::runs_all;
use bhr::physics::limb_darkening::limb_darkening;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Disk, DiskReference, EmissionLaw, LensTables, Method, Motion, Ray, View};
use glam::DVec3;

const SIZE: [u32; 2] = [120, 80];

/// Luminance with limb darkening over that without, pixel by pixel; `None` where the latter is dark.
fn ratios(renderer: &mut Renderer) -> Vec<Option<f64>> {
    let [without, with] = [EmissionLaw::Isotropic, EmissionLaw::LimbDarkened].map(|law| {
        renderer.scene.disk.as_mut().unwrap().emission_law = law;
        light(renderer, SIZE, whole(SIZE)).into_iter().map(luminance).collect::<Vec<_>>()
    });
    without.into_iter().zip(with).map(|(without, with)| (without > 1e-5).then(|| with / without)).collect()
}

/// Whether all pixels about `k` show the same image as it does.
fn inside(orders: &[f64], k: usize) -> bool {
    let alike = |k: usize| neighbours(k, SIZE).filter(|near| near.iter().all(|n| orders[*n] == orders[k]));
    alike(k).is_some_and(|near| near.iter().all(|n| alike(*n).is_some()))
}

/// Without spin a ray's angular momentum about the hole, r x p, is constant in size and direction: p_theta in the plane
/// is its part along the plane, and the matter there sees p_theta / r of its frequency go along the normal.
#[test]
fn each_pixel_is_as_bright_as_its_angle_in_the_matters_frame_says() {
    let moving = Camera { motion: Motion::Velocity, velocity: DVec3::new(-0.3, 0.5, 0.2), ..camera(20.0, 70.0, 40.0) };
    let cameras = [camera(25.0, 15.0, 45.0), camera(25.0, 80.0, 45.0), camera(60.0, 89.0, 45.0), moving];
    let ways = [
        (LensTables::Always, Method::Auto),
        (LensTables::Never, Method::Auto),
        (LensTables::Never, Method::Rk4),
        (LensTables::Never, Method::Adaptive),
    ];
    for (tracer, mut renderer) in both() {
        // Cameras innermost: a software driver keeps few kernels.
        for (tables, method) in ways {
            for (number, seen_from) in cameras.into_iter().enumerate() {
                // Everyday the one that moves, in one way.
                if !runs_all() && (number < 3 || tables == LensTables::Never) {
                    continue;
                }
                renderer.scene.camera = seen_from;
                renderer.scene.disk = Some(Disk::plain());
                renderer.scene.quality.refines = false;
                (renderer.scene.quality.lens_tables, renderer.scene.quality.method) = (tables, method);
                let orders = view(&mut renderer, View::Order, SIZE, whole(SIZE));
                let ratios = ratios(&mut renderer);
                let hits = hits(&mut renderer, SIZE, whole(SIZE));
                let mut rays = vec![Ray::default(); hits.len()];
                renderer.scene.camera_rays(SIZE[0], SIZE[1], None, &mut |i, ray| rays[i] = ray).unwrap();
                let (mut judged, mut worst) = (0, 0.0_f64);
                for (k, ratio) in ratios.into_iter().enumerate() {
                    let (Some(ratio), true) = (ratio, orders[k] == 0.0 && inside(&orders, k)) else { continue };
                    let (crossing, ray) = (hits[k].crossings[0], rays[k]);
                    // The static observer's momentum is the look direction but for its sign, r times what is across.
                    let turning = ray.position.cross(ray.direction);
                    let along_plane = turning.x.hypot(turning.y);
                    let mu = along_plane / crossing.radius * crossing.redshift / ray.frequency_ratio;
                    assert!(mu > 0.0 && mu < 1.0 + 1e-6, "{tracer}: {mu}");
                    worst = worst.max((ratio / limb_darkening(mu) - 1.0).abs());
                    judged += 1;
                }
                println!("{tracer}: camera {number}, {tables:?}, {method:?}: {judged} pixels, {worst:.1e}");
                assert!(judged > 60, "{tracer}: camera {number}: {judged} pixels");
                // Traced records of GPUs hold the angle to 5e-4.
                assert!(worst < 2e-3, "{tracer}: camera {number}, {tables:?}, {method:?}: {worst}");
            }
        }
    }
}

/// Far from the hole matter is slow and light goes straight: the ratio is that of the table at the inclination.
#[test]
fn a_distant_disk_is_as_bright_as_the_table_says() {
    let expected =
        [(0.0, 1.26938), (60.0, 0.86637), (75.0, limb_darkening(0.258_819)), (89.0, limb_darkening(0.017_45))];
    for spin in [0.0, 0.9] {
        for (tracer, mut renderer) in both() {
            let mut brightness = Vec::new();
            for (inclination, expected) in expected {
                renderer.scene.hole.spin = spin;
                renderer.scene.camera = camera(1e6, inclination, 45_000.0);
                renderer.scene.disk = Some(Disk {
                    inner_radius: 5_000.0,
                    outer_radius: 20_000.0,
                    reference: DiskReference::Median,
                    ..Disk::plain()
                });
                let seen = ratios(&mut renderer).into_iter().flatten().collect::<Vec<_>>();
                let mean = seen.iter().sum::<f64>() / seen.len() as f64;
                println!("{tracer}: spin {spin}, {inclination} degrees: {mean:.5} of {expected:.5}, {}", seen.len());
                assert!(seen.len() > 50, "{tracer}: spin {spin}, {inclination} degrees: {}", seen.len());
                assert!((mean / expected - 1.0).abs() < 0.01, "{tracer}: spin {spin}, {inclination}: {mean}");
                brightness.push(mean);
            }
            // Towards the edge-on view it goes to 0.414.
            assert!(brightness[3] < 0.45 && brightness[3] > 0.414, "{tracer}: {brightness:?}");
        }
    }
}

/// With spin rays of the tables are as bright as those that are traced, and the GPU's as the CPU's.
#[test]
#[ignore = "in tests/run all; everyday: views and pictures of both tracers agree with spin"]
fn with_spin_all_ways_to_find_rays_agree() {
    for spin in [0.9, -0.998] {
        let mut all = Vec::new();
        for (tracer, mut renderer) in both() {
            for (tables, method) in [(LensTables::Always, Method::Auto), (LensTables::Never, Method::Adaptive)] {
                renderer.scene.hole.spin = spin;
                renderer.scene.camera = camera(25.0, 75.0, 45.0);
                renderer.scene.disk = Some(Disk { opacity: 0.7, ..Disk::plain() });
                renderer.scene.quality.refines = false;
                (renderer.scene.quality.lens_tables, renderer.scene.quality.method) = (tables, method);
                let orders = view(&mut renderer, View::Order, SIZE, whole(SIZE));
                all.push((tracer, tables, ratios(&mut renderer), orders));
            }
        }
        let (_, _, first, orders) = &all[0];
        for (tracer, tables, ratios, _) in &all[1..] {
            let mut judged = 0;
            for k in (0..first.len()).filter(|&k| orders[k] == 0.0 && inside(orders, k)) {
                let (Some(expected), Some(found)) = (first[k], ratios[k]) else { continue };
                assert!((found / expected - 1.0).abs() < 2e-3, "{tracer}, {tables:?}, {k}: {found}, {expected}");
                assert!(found > 0.4 && found < 1.27, "{tracer}, {tables:?}, {k}: {found}");
                judged += 1;
            }
            println!("spin {spin}: {tracer}, {tables:?}: {judged} pixels");
            assert!(judged > 1000, "spin {spin}: {judged} pixels");
        }
    }
}
