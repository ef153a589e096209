// SPDX-License-Identifier: MIT OR Apache-2.0
//! The disk's light summed over a picture, against the integral over the isoradials; and pixel by pixel, against the
//! rule of light.

use super::orbit::{isoradial, luminance as blackbody_luminance, redshift, swept_to_plane, temperature, u_at};
use super::{both, camera, hits, light, luminance, neighbours, view, whole};
use crate::random::runs_all;
use bhr::physics::blackbody::{into_gamut, linear_rgb, radiance_xyz};
use bhr::physics::disk_flux::{page_thorne, page_thorne_maximum};
use bhr::scene::{Camera, Disk, DiskReference, Scene, Sky, View};
use std::f64::consts::TAU;

const R_OBSERVER: f64 = 1000.0;
/// The default disk's.
const RADII: [f64; 2] = [6.0, 20.0];
const TEMPERATURE: f64 = 6500.0;

/// Integral of luminance over solid angle of the image of this order: of the direct one, or of what of the secondary
/// one the opaque disk does not hide.
fn expected(inclination_degrees: f64, order: u32) -> f64 {
    let i = inclination_degrees.to_radians();
    // b = r sin(psi) / sqrt(1 - 2/r).
    let sine = |b: f64| b * (1.0 - 2.0 / R_OBSERVER).sqrt() / R_OBSERVER;
    let cosine = |b: f64| (1.0 - sine(b).powi(2)).sqrt();
    const SPOKES: u32 = 240;
    let mut sum = 0.0;
    for k in 0..SPOKES {
        let alpha = TAU * (f64::from(k) + 0.5) / f64::from(SPOKES);
        let edges = |order| RADII.map(|r| isoradial(R_OBSERVER, i, alpha, order, r));
        let [inner, outer] = edges(order);
        let parts = match order {
            0 => vec![[inner, outer]],
            _ => {
                let [hides, hides_to] = edges(0);
                vec![[inner, outer.min(hides)], [inner.max(hides_to), outer]]
            }
        };
        for [from, to] in parts.into_iter().filter(|[from, to]| to > from) {
            let angle = swept_to_plane(i, alpha, order);
            let seen = |b: f64| {
                let Some(u) = u_at(R_OBSERVER, b, angle) else { return 0.0 };
                let g = redshift(R_OBSERVER, i, alpha, b, u);
                blackbody_luminance(g * TEMPERATURE * temperature(1.0 / u), TEMPERATURE)
            };
            // d Omega = d alpha d(-cos psi); Simpson's rule.
            const INTERVALS: u32 = 40;
            let [first, last] = [cosine(from), cosine(to)];
            let step = (first - last) / f64::from(INTERVALS);
            for n in 0..=INTERVALS {
                let cos = first - step * f64::from(n);
                let b = (1.0 - cos * cos).sqrt() * R_OBSERVER / (1.0 - 2.0 / R_OBSERVER).sqrt();
                let weight = if n == 0 || n == INTERVALS { 1.0 } else { f64::from(2 + 2 * (n % 2)) };
                sum += weight * step / 3.0 * seen(b) * TAU / f64::from(SPOKES);
            }
        }
    }
    sum
}

/// The sum over the pixels of one order of a square frame `width` M wide.
fn measured(renderer: &mut bhr::renderer::Renderer, inclination: f64, width: f64, order: u32) -> f64 {
    let size = [900, 900];
    renderer.scene.camera = camera(R_OBSERVER, inclination, width);
    renderer.scene.quality.max_disk_order = order;
    let light = light(renderer, size, whole(size));
    let orders = view(renderer, View::Order, size, whole(size));
    let pixel = width / R_OBSERVER / f64::from(size[1]);
    let tangent = |k: usize| (k as f64 + 0.5 - f64::from(size[0]) / 2.0) * pixel;
    let pixels = light.iter().zip(orders).enumerate().filter(|(_, (_, seen))| *seen == f64::from(order));
    let solid_angle = |k: usize| {
        let (x, y) = (tangent(k % size[0] as usize), tangent(k / size[0] as usize));
        pixel * pixel / (1.0 + x * x + y * y).powf(1.5)
    };
    pixels.map(|(k, (rgb, _))| luminance(*rgb) * solid_angle(k)).sum()
}

/// Within 1 %, direct and secondary images at three inclinations.
#[test]
fn summed_light_is_the_integral_over_the_isoradials() {
    for (inclination, order, width) in
        [(20.0, 0, 50.0), (60.0, 0, 50.0), (80.0, 0, 50.0), (20.0, 1, 16.0), (60.0, 1, 16.0), (80.0, 1, 50.0)]
    {
        let expected = expected(inclination, order);
        for (i, (tracer, mut renderer)) in both().into_iter().enumerate() {
            // Everyday each tracer sums half of the images.
            if !runs_all() && (order as usize + usize::from(inclination == 60.0) + i) % 2 == 1 {
                continue;
            }
            let found = measured(&mut renderer, inclination, width, order);
            println!(
                "{tracer}: {inclination} degrees, order {order}: {found:.6e} of {expected:.6e}, {:.5}",
                found / expected
            );
            assert!((found / expected - 1.0).abs() < 0.01, "{tracer}: {inclination} degrees, order {order}");
        }
    }
}

/// In every pixel of the opaque disk's first two images: light = B(g T(r)) over the luminance of the hottest ring at
/// rest, g being what the REDSHIFT view shows and r what the tracer says of that pixel's ray: I_nu / nu^3 is the same
/// at the disk and at the observer.
#[test]
fn light_of_a_pixel_is_the_blackbody_under_its_redshift() {
    let size = [160, 120];
    let disks = [
        (0.0, Disk::plain()),
        (0.9, Disk { temperature: 12000.0, brightness: 3.0, ..Disk::plain() }),
        (-0.7, Disk { temperature: 4000.0, retrograde: true, outer_radius: 30.0, ..Disk::plain() }),
    ];
    for (spin, disk) in disks {
        let matter_spin = if disk.retrograde { -spin } else { spin };
        let f_max = page_thorne_maximum(matter_spin).1;
        for (tracer, mut renderer) in both() {
            renderer.scene.hole.spin = spin;
            renderer.scene.disk = Some(disk);
            renderer.scene.camera = camera(25.0, 75.0, 40.0);
            // The light is that of the pixel's own ray.
            renderer.scene.quality.refines = false;
            let light = light(&mut renderer, size, whole(size));
            let shifts = view(&mut renderer, View::Redshift, size, whole(size));
            let orders = view(&mut renderer, View::Order, size, whole(size));
            let hits = hits(&mut renderer, size, whole(size));
            let mut judged = 0;
            for (k, hit) in hits.iter().enumerate() {
                // Edges, whose pixels show some of what is beside them, are another matter.
                let alike = |k: usize| neighbours(k, size).filter(|near| near.iter().all(|n| orders[*n] == orders[k]));
                let inside = alike(k).is_some_and(|near| near.iter().all(|n| alike(*n).is_some()));
                if !inside || !(0.0..=1.0).contains(&orders[k]) {
                    continue;
                }
                let r = hit.crossings[orders[k] as usize].radius;
                let seen = shifts[k] * disk.temperature * (page_thorne(matter_spin, r) / f_max).powf(0.25);
                if seen < 600.0 {
                    continue;
                }
                let y = radiance_xyz(seen)[1];
                let scale = disk.brightness * y / radiance_xyz(disk.temperature)[1];
                let expected = into_gamut(linear_rgb(seen).map(|v| v / y)).map(|v| v * scale);
                // The mean over a pixel of the secondary image, which is narrow, need not be the light of its middle.
                let bar = if orders[k] == 0.0 { 1e-3 } else { 1e-2 };
                for (found, expected) in light[k].iter().zip(expected) {
                    let error = (found - expected).abs() / scale;
                    assert!(error < bar, "{tracer}: spin {spin}, pixel {k}: {:?}, not {expected:?}", light[k]);
                }
                judged += 1;
            }
            println!("{tracer}: spin {spin}: {judged} pixels");
            assert!(judged > 2000, "{tracer}: spin {spin}: {judged} pixels");
        }
    }
}

/// Median luminances of the disk's pixels for spins from -0.998 to 0.998, as the default scene's camera sees it from
/// r = 30, 10 degrees above its plane.
fn swept_medians(disk: Disk) -> [f64; 9] {
    let size = if runs_all() { [192, 108] } else { [128, 72] };
    let mut renderer = crate::frames::cpu();
    let fov_y = Scene::default().camera.fov_y;
    renderer.scene.camera = Camera { fov_y, ..camera(30.0, 80.0, 30.0) };
    renderer.scene.disk = Some(disk);
    renderer.scene.sky = Sky::black();
    [-0.998, -0.9, -0.7, -0.4, 0.0, 0.4, 0.7, 0.9, 0.998].map(|spin| {
        renderer.scene.hole.spin = spin;
        let orders = view(&mut renderer, View::Order, size, whole(size));
        let light = light(&mut renderer, size, whole(size));
        let of_disk = light.into_iter().zip(orders).filter(|(_, order)| *order >= 0.0);
        let mut of_disk: Vec<f64> = of_disk.map(|(rgb, _)| luminance(rgb)).collect();
        of_disk.sort_unstable_by(f64::total_cmp);
        // A twentieth of the frame.
        assert!(of_disk.len() as u32 * 20 > size[0] * size[1], "spin {spin}: {} pixels", of_disk.len());
        of_disk[of_disk.len() / 2]
    })
}

/// A disk whose temperature is told at the ring that halves its area keeps its look when the spin changes, and one
/// whose hottest ring has the same temperature does not.
#[test]
#[ignore = "in tests/run all; everyday: profiles of the disk in the library's unit tests"]
fn a_sweep_of_the_spin_leaves_the_disks_luminance_nearly_as_it_is() {
    let change = |disk: Disk| {
        let medians = swept_medians(disk);
        let (low, high) = medians.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), m| (low.min(*m), high.max(*m)));
        println!("by a factor of {:.3}: {medians:.4?}", high / low);
        assert!(low > 0.0);
        high / low
    };
    let disk = Scene::default().disk.unwrap();
    for edge_softness in [disk.edge_softness, 0.0, 0.6] {
        assert!(change(Disk { edge_softness, ..disk }) < 1.5);
    }
    assert!(change(Disk { outer_radius: 20.0, temperature: 6500.0, edge_softness: 0.1, ..disk }) < 1.5);
    assert!(change(Disk { edge_softness: 0.0, reference: DiskReference::Hottest, ..disk }) > 3.0);
}
