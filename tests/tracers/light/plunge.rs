// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light of matter that falls from the ISCO to the horizon: against the closed forms of spin 0, where the disk
//! begins and what it leaves as it was, and both tracers against each other.

use super::orbit::{luminance as blackbody_luminance, u_at};
use super::{both, camera, hits, light, luminance, neighbours, view, whole};
use crate::random::runs_all;
use bhr::physics::disk_flux::page_thorne_maximum;
use bhr::physics::orbit::{horizon_outer, isco};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Disk, DiskReference, LensTables, Method, Motion, Ray, View};
use std::f64::consts::PI;

const SIZE: [u32; 2] = [120, 80];

fn plunging() -> Disk {
    Disk { plunges: true, ..Disk::plain() }
}

/// The rays through the pixels' centres.
fn rays(renderer: &Renderer) -> Vec<Ray> {
    let mut rays = vec![Ray::default(); (SIZE[0] * SIZE[1]) as usize];
    renderer.scene.camera_rays(SIZE[0], SIZE[1], None, &mut |i, ray| rays[i] = ray).unwrap();
    rays
}

/// Whether all pixels about `k`, and those about them, show the same image as it does.
fn inside(orders: &[f64], k: usize) -> bool {
    let alike = |k: usize| neighbours(k, SIZE).filter(|near| near.iter().all(|n| orders[*n] == orders[k]));
    alike(k).is_some_and(|near| near.iter().all(|n| alike(*n).is_some()))
}

/// 1/r and g of the crossing of that order, of matter that falls from the ISCO without spin, as a static observer sees
/// it; and whether the light has passed its least distance from the hole on its way from there. (Cunningham 1975, with
/// spin 0.)
fn closed_form(ray: &Ray, order: u32) -> Option<(f64, f64, bool)> {
    let r_observer = ray.position.length();
    let outwards = ray.position / r_observer;
    let lapse = (1.0 - 2.0 / r_observer).sqrt();
    // The light's momentum is the look direction but for its sign, and its energy at infinity the lapse.
    let turning = ray.position.cross(-ray.direction) / lapse;
    let b = turning.length();
    let across = (ray.direction - outwards * outwards.dot(ray.direction)).normalize();
    // N_z = cos(theta) cos(phi) + T_z sin(phi) is 0.
    let first = outwards.z.abs().atan2(-across.z * outwards.z.signum());
    let angle = first + f64::from(order) * PI;
    let u = u_at(r_observer, b, angle)?;
    let later = u_at(r_observer, b, angle + 1e-4);
    let comes_out = later.is_none_or(|later| later > u);
    let d = 1.0 - 2.0 * u;
    let radial = (1.0 - b * b * u * u * d).max(0.0).sqrt() / d * if comes_out { 1.0 } else { -1.0 };
    let (t, ph) = (8.0_f64.sqrt() / 3.0 / d, 12.0_f64.sqrt() * u * u);
    let fall = (6.0 * u - 1.0).max(0.0).powf(1.5) / 3.0;
    let nu = t - turning.z * ph + radial * fall;
    Some((u, 1.0 / (nu * lapse), comes_out))
}

#[test]
fn g_and_light_are_those_of_the_closed_form_without_spin() {
    // A disk that begins outside the photon sphere also shows light that has turned there.
    let scenes = [(20.0, 0, 13.0, 0.0), (75.0, 0, 13.0, 0.0), (60.0, 1, 11.0, 3.2)];
    for (i, (inclination, order, width, inner_radius)) in scenes.into_iter().enumerate() {
        for (j, (tracer, mut renderer)) in both().into_iter().enumerate() {
            for (k, method) in [Method::Auto, Method::Adaptive].into_iter().enumerate() {
                // Everyday each tracer finds the rays of a scene in one way, the other one in the other way.
                if !runs_all() && (i + j + k) % 2 == 1 {
                    continue;
                }
                renderer.scene.camera = camera(30.0, inclination, width);
                // The first image leaves a part of the second one free.
                renderer.scene.disk = Some(Disk { inner_radius, outer_radius: 5.9, ..plunging() });
                renderer.scene.quality.method = method;
                renderer.scene.quality.refines = false;
                let orders = view(&mut renderer, View::Order, SIZE, whole(SIZE));
                let shifts = view(&mut renderer, View::Redshift, SIZE, whole(SIZE));
                let light = light(&mut renderer, SIZE, whole(SIZE));
                let hits = hits(&mut renderer, SIZE, whole(SIZE));
                // The hottest ring is not part of this disk, but the flux is still half of that ring's, everywhere, and
                // that ring has the stated temperature.
                let temperature = renderer.scene.disk.unwrap().temperature * 0.5_f64.powf(0.25);
                let reference = renderer.scene.disk.unwrap().temperature;
                let (mut out, mut back, mut deepest) = (0, 0, f64::INFINITY);
                let rays = rays(&renderer);
                for (k, ray) in rays.iter().enumerate().filter(|(k, _)| orders[*k] == f64::from(order)) {
                    let Some((u, g, comes_out)) = closed_form(ray, order) else { continue };
                    let r = 1.0 / u;
                    let hit = hits[k].crossings[order as usize];
                    if !inside(&orders, k) || r < 2.05 {
                        continue;
                    }
                    // Light that has wound about the hole knows its place less well.
                    let slack = if order > 0 { 3e-3 } else { 3e-4 };
                    assert!((hit.radius / r - 1.0).abs() < slack, "{tracer}: r {} of {r}", hit.radius);
                    assert!((hit.redshift / g - 1.0).abs() < slack, "{tracer}, r {r}: g {} of {g}", hit.redshift);
                    assert!((shifts[k] / g - 1.0).abs() < slack, "{tracer}, r {r}: the view's g {} of {g}", shifts[k]);
                    let seen = g * temperature;
                    if seen > 600.0 {
                        let expected = blackbody_luminance(seen, reference);
                        let found = luminance(light[k]);
                        let error = (found / expected - 1.0).abs();
                        assert!(error < 0.02 + 10.0 * slack, "{tracer}, r {r}: {found} of {expected}");
                    }
                    if comes_out {
                        out += 1
                    } else {
                        back += 1
                    }
                    deepest = f64::min(deepest, r);
                }
                println!("{tracer}: {inclination} degrees, order {order}, {method:?}: {out} + {back}, to {deepest:.2}");
                assert!(
                    out + back > if order > 0 { 30 } else { 1000 },
                    "{tracer}: {inclination} degrees: {out} + {back} pixels"
                );
                assert!(inner_radius > 0.0 || deepest < 2.4, "{tracer}: {deepest}");
                assert!(inclination < 70.0 || back > 10, "{tracer}: {inclination} degrees: {back} pixels");
            }
        }
    }
}

/// With spin the views of both tracers show what single rays do, and both agree, for either sense of motion.
#[test]
#[ignore = "in tests/run all; everyday: g without spin, and both tracers agree about plunging disks"]
fn tracers_agree_with_spin_about_g_down_to_the_horizon() {
    for (spin, retrograde) in [(0.9, false), (0.9, true), (-0.998, false)] {
        let fall = Camera { motion: Motion::FreeFall, ..camera(12.0, 65.0, 9.0) };
        for seen_from in [camera(30.0, 40.0, 9.0), fall] {
            let mut all = Vec::new();
            for (tracer, mut renderer) in both() {
                renderer.scene.hole.spin = spin;
                renderer.scene.camera = seen_from;
                renderer.scene.disk = Some(Disk { retrograde, ..plunging() });
                let orders = view(&mut renderer, View::Order, SIZE, whole(SIZE));
                let shifts = view(&mut renderer, View::Redshift, SIZE, whole(SIZE));
                let hits = hits(&mut renderer, SIZE, whole(SIZE));
                all.push((tracer, orders, shifts, hits));
            }
            let isco = isco(if retrograde { -spin } else { spin });
            let (_, orders, shifts, exact) = &all[0];
            for (tracer, _, found, hits) in &all {
                let (mut judged, mut deepest) = (0, f64::INFINITY);
                for k in (0..found.len()).filter(|k| orders[*k] == 0.0 && inside(orders, *k)) {
                    let (radius, g) = (exact[k].crossings[0].radius, exact[k].crossings[0].redshift);
                    if radius > isco || radius < 1.1 * horizon_outer(spin) {
                        continue;
                    }
                    for value in [found[k], shifts[k], hits[k].crossings[0].redshift] {
                        assert!((value / g - 1.0).abs() < 1e-3, "{tracer}: spin {spin}, r {radius}: {value} of {g}");
                    }
                    judged += 1;
                    deepest = f64::min(deepest, radius);
                }
                println!("{tracer}: spin {spin}, retrograde {retrograde}: {judged} pixels, down to {deepest:.3}");
                assert!(judged > 30 && deepest < 1.3 * horizon_outer(spin), "{tracer}: {judged} pixels, {deepest}");
            }
        }
    }
}

/// Outside the hottest ring the light is the same with plunging matter and without, whichever ring has the stated
/// temperature; inside the ISCO there is light only with it, and never within `inner_radius`.
#[test]
fn plunging_matter_adds_light_inside_the_hottest_ring_only() {
    for reference in [DiskReference::Hottest, DiskReference::Median] {
        for (tracer, mut renderer) in both() {
            let spin = 0.5;
            renderer.scene.hole.spin = spin;
            renderer.scene.camera = camera(30.0, 30.0, 30.0);
            // Rays are found in the same way with and without plunging matter, which no table serves.
            renderer.scene.quality.lens_tables = LensTables::Never;
            renderer.scene.quality.refines = false;
            let disk = Disk { reference, edge_softness: 0.3, turbulence: 0.8, ..Disk::plain() };
            let [without, with, limited] = [(false, 0.0), (true, 0.0), (true, 3.0)].map(|(plunges, inner_radius)| {
                renderer.scene.disk = Some(Disk { plunges, inner_radius, ..disk });
                light(&mut renderer, SIZE, whole(SIZE)).into_iter().map(luminance).collect::<Vec<_>>()
            });
            let hits = hits(&mut renderer, SIZE, whole(SIZE));
            let (hottest, isco) = (page_thorne_maximum(spin).0, isco(spin));
            let mut counts = [0; 3];
            for (k, hit) in hits.iter().enumerate().filter(|(_, hit)| hit.crossing_count > 0) {
                let r = hit.crossings[0].radius;
                if r > hottest * 1.01 && r < 20.0 {
                    assert!((with[k] - without[k]).abs() <= 1e-5 * without[k], "{tracer}, r {r}");
                    counts[0] += 1;
                } else if r < isco * 0.99 && r > 1.15 * horizon_outer(spin) && hit.crossing_count == 1 {
                    assert!(without[k] == 0.0 && with[k] > 0.0, "{tracer}, r {r}: {} {}", without[k], with[k]);
                    assert_eq!(limited[k] > 0.0, r > 3.0, "{tracer}, r {r}");
                    counts[if r > 3.0 { 1 } else { 2 }] += 1;
                }
            }
            println!("{tracer}, {reference:?}: {counts:?} pixels");
            assert!(counts[0] > 1000 && counts[1] > 10 && counts[2] > 10, "{tracer}: {counts:?}");
        }
    }
}

/// A disk of nothing but plunging matter, and a limit that leaves none of it.
#[test]
fn a_disk_may_lie_inside_the_isco() {
    for (tracer, mut renderer) in both() {
        renderer.scene.camera = camera(20.0, 50.0, 14.0);
        let mut lit = |disk: Disk| {
            renderer.scene.disk = Some(disk);
            light(&mut renderer, SIZE, whole(SIZE)).into_iter().filter(|rgb| luminance(*rgb) > 0.0).count()
        };
        let median = Disk { reference: DiskReference::Median, ..plunging() };
        assert!(lit(Disk { outer_radius: 5.0, ..median }) > 100, "{tracer}");
        assert_eq!(lit(Disk { outer_radius: 5.0, plunges: false, ..median }), 0, "{tracer}");
        assert_eq!(lit(Disk { outer_radius: 1.9, ..median }), 0, "{tracer}: all of it is inside the horizon");
        let [with, without] = [true, false].map(|plunges| lit(Disk { inner_radius: 8.0, plunges, ..median }));
        assert!(with == without && with > 100, "{tracer}: {with} {without}");
    }
}
