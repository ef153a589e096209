// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light through matter with depth: the haze, whose light and optical depth along radial rays are integrals over the
//! proper length, and both tracers against each other with the disk within it.

use crate::frames::{both, cpu, floats, gpu, picture};
use bhr::emit::haze::Haze;
use bhr::image::PixelFormat;
use bhr::scene::{Camera, Disk, Projection, Scene, Sky};
use glam::DVec3;

const HAZE: Haze = Haze { radius: 6.0, brightness: 0.05, absorption: 0.08 };

fn outside(distance: f64, elevation: f64) -> Camera {
    let elevation = elevation.to_radians();
    let position = DVec3::new(distance * elevation.cos(), 0.0, distance * elevation.sin());
    Camera { position, forward: -position, up: DVec3::Z, fov_y: 50_f64.to_radians(), ..Camera::plain() }
}

/// Along a radial ray outwards from a static observer at r0 about a hole without spin, light has frequency 1 / sqrt(1 -
/// 2/r) times its energy, and nu d lambda is the proper length dr / sqrt(1 - 2/r).
fn radial(haze: &Haze, r0: f64) -> (f64, f64) {
    let (mut light, mut depth) = (0.0, 0.0);
    let n = 200_000;
    let h = 12.0 * haze.radius / f64::from(n);
    for i in 0..n {
        let r = r0 + h * (f64::from(i) + 0.5);
        let lapse = |r: f64| (1.0 - 2.0 / r).sqrt();
        let density = (-0.5 * (r / haze.radius).powi(2)).exp() * h / lapse(r);
        light += haze.brightness * density * (lapse(r) / lapse(r0)).powi(3) * f64::exp(-depth);
        depth += haze.absorption * density;
    }
    (light, depth)
}

#[test]
fn radial_light_and_depth_are_integrals_over_proper_length() {
    for (name, mut renderer) in both() {
        let tolerance = if name == "cpu" { 2e-5 } else { 1e-4 };
        for absorption in [0.0, 0.08, 0.5] {
            let haze = Haze { absorption, ..HAZE };
            let r0 = 8.0;
            let position = DVec3::new(0.0, r0, 0.0);
            renderer.scene = Scene { disk: None, sky: Sky::black(), haze: Some(haze), ..Scene::plain() };
            renderer.scene.camera =
                Camera { position, forward: position, fov_y: 1e-3, up: DVec3::Z, ..Camera::plain() };
            let pixel = floats(&picture(&mut renderer, PixelFormat::Rgba32F, [1, 1], None, true));
            let (light, depth) = radial(&haze, r0);
            let light = light * renderer.scene.film.exposure_ev.exp2();
            assert!((f64::from(pixel[1]) / light - 1.0).abs() < tolerance, "{name}: {pixel:?}, {light}");
            let alpha = -f64::exp_m1(-depth);
            assert!((f64::from(pixel[3]) - alpha).abs() < tolerance, "{name}: {pixel:?}, {alpha}");
        }
    }
}

/// From far outside and without the hole's doing, straight chords through the gaussian: I = j sqrt(2 pi) R e^(-b^2 / 2
/// R^2).
#[test]
fn far_from_the_hole_rays_are_chords() {
    let haze = Haze { radius: 2e4, brightness: 1e-5, absorption: 0.0 };
    for (name, mut renderer) in both() {
        renderer.scene = Scene { disk: None, sky: Sky::black(), haze: Some(haze), ..Scene::plain() };
        renderer.scene.camera = Camera { fov_y: 0.2, ..outside(4e5, 20.0) };
        let pixels = floats(&picture(&mut renderer, PixelFormat::Rgba32F, [8, 8], None, false));
        for row in 0..8 {
            let tangent = (f64::from(row) - 3.5) / 4.0 * 0.1_f64.tan();
            // The column beside the middle is half a pixel off.
            let tangent = tangent.hypot(0.1_f64.tan() / 8.0);
            let b = 4e5 * tangent / tangent.hypot(1.0);
            let expected = haze.brightness
                * std::f64::consts::TAU.sqrt()
                * haze.radius
                * (-0.5 * (b / haze.radius).powi(2)).exp()
                * renderer.scene.film.exposure_ev.exp2();
            let seen = f64::from(pixels[(row as usize * 8 + 4) * 4 + 1]);
            assert!((seen / expected - 1.0).abs() < 2e-3, "{name}, row {row}: {seen} {expected}");
        }
    }
}

/// The disk in front of, within and behind the haze, with and without spin, edges and higher orders refined: the
/// tracers agree.
#[test]
fn the_tracers_agree_on_a_disk_in_haze() {
    let (mut cpu, mut gpu) = (cpu(), gpu());
    for (spin, opacity, distance, elevation) in [(0.0, 1.0, 20.0, 12.0), (0.9, 0.6, 9.0, 25.0)] {
        let mut scene = Scene { haze: Some(HAZE), camera: outside(distance, elevation), ..Scene::plain() };
        scene.hole.spin = spin;
        scene.disk = Some(Disk { opacity, turbulence: 0.5, ..Disk::plain() });
        let [a, b] = [&mut cpu, &mut gpu].map(|renderer| {
            renderer.scene = scene.clone();
            picture(renderer, PixelFormat::Rgba8Srgb, [128, 72], None, false)
        });
        let far = a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > 2).count();
        assert!(far <= a.len() / 500, "spin {spin}: {far} of {}", a.len());
        // The haze does something.
        scene.haze = None;
        cpu.scene = scene.clone();
        let bare = picture(&mut cpu, PixelFormat::Rgba8Srgb, [128, 72], None, false);
        assert!(bare.iter().zip(&a).filter(|(a, b)| a.abs_diff(**b) > 8).count() > a.len() / 4);
    }
}

/// Whatever the projection and wherever the observer, light stays finite and alpha within its range.
#[test]
fn haze_is_finite_everywhere() {
    for (name, mut renderer) in both() {
        for (spin, distance) in [(0.998, 1.6), (0.0, 2.5), (0.5, 4.0), (-0.9, 1e5)] {
            for absorption in [0.0, 1e3] {
                renderer.scene = Scene { disk: None, ..Scene::plain() };
                renderer.scene.haze = Some(Haze { absorption, ..HAZE });
                renderer.scene.hole.spin = spin;
                renderer.scene.camera = outside(distance, 40.0);
                renderer.scene.camera.projection = Projection::Equirect;
                let pixels = floats(&picture(&mut renderer, PixelFormat::Rgba32F, [32, 16], None, true));
                let good = |p: &[f32]| p.iter().all(|v| v.is_finite()) && p[0] >= 0.0 && (0.0..=1.0).contains(&p[3]);
                let bad = pixels.as_chunks::<4>().0.iter().find(|p| !good(&p[..]));
                assert!(bad.is_none(), "{name}, spin {spin}, r {distance}, absorption {absorption}: {bad:?}");
            }
        }
    }
}
