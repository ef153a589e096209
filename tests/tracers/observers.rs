// SPDX-License-Identifier: MIT OR Apache-2.0
//! The view of falling and fast observers, against integrals and formulas that share nothing with the tracers: the sky
//! from inside the horizon, the shadow's size, aberration and Doppler shift at 0.999 c.

use crate::frames::{both, floats, picture};
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::record::Record;
use bhr::scene::{Camera, Fate, Hit, LensTables, Motion, Projection, Ray, Scene, Sky, View};
use glam::DVec3;
use std::f64::consts::PI;

const CRITICAL: f64 = 5.196_152_422_706_632;

/// Radii of the falling observer, M; all but the first inside the horizon.
const RADII: [f64; 6] = [2.5, 1.5, 0.5, 0.1, 0.01, 1e-6];

/// An observer who falls from rest at infinity, and sees all directions.
fn falling(r: f64) -> Camera {
    let position = DVec3::new(0.48, -0.6, 0.64) * r;
    let projection = Projection::Equirect;
    Camera { projection, position, forward: DVec3::new(-0.3, 0.8, 0.1), motion: Motion::FreeFall, ..Camera::plain() }
}

/// Look directions of a frame in the camera's own axes: those of the same camera at rest, outside.
fn looks(camera: &Camera, [width, height]: [u32; 2]) -> Vec<DVec3> {
    let at_rest = Camera { motion: Motion::Static, position: camera.position.normalize() * 30.0, ..*camera };
    rays(&Scene { camera: at_rest, ..Scene::plain() }, [width, height]).into_iter().map(|ray| ray.direction).collect()
}

fn rays(scene: &Scene, [width, height]: [u32; 2]) -> Vec<Ray> {
    let mut rays = Vec::new();
    scene.camera_rays(width, height, None, &mut |_, ray| rays.push(ray)).unwrap();
    rays
}

fn hits(renderer: &mut Renderer, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::default(); rays.len()];
    renderer.trace_rays(rays, &mut hits).unwrap();
    hits
}

/// E of light that the falling observer at `r` sees from `n`, its frequency there being 1: 1 + sqrt(2 / r) n_r (rain
/// coordinates).
fn energy(r: f64, n_r: f64) -> f64 {
    1.0 + (2.0 / r).sqrt() * n_r
}

/// The orbit's angle from infinity to 1 / r for impact parameter b: integral of b du / sqrt(1 - b^2 u^2 (1 - 2 u))
/// from 0 (Darwin 1959), by Simpson's rule in t, u = sinh(t) / 3.
fn swept(r: f64, b: f64) -> f64 {
    const INTERVALS: usize = 4000;
    let step = (3.0 / r).asinh() / INTERVALS as f64;
    let slope = |i: usize| {
        let t = step * i as f64;
        let u = t.sinh() / 3.0;
        b * t.cosh() / 3.0 / (1.0 - b * b * u * u * (1.0 - 2.0 * u)).sqrt()
    };
    let weight = |i: usize| {
        if i == 0 || i == INTERVALS {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    (0..=INTERVALS).map(|i| weight(i) * slope(i)).sum::<f64>() * step / 3.0
}

/// The image that an observer who falls sees at look direction `n`.
struct Seen {
    /// The impact parameter as a share of the critical one; infinite where no light comes from.
    share: f64,
    redshift: f64,
    direction: DVec3,
    swept: f64,
    /// Change of the sky direction by a change of the look towards or away from the hole, at least 1.
    stretch: f64,
    /// The stretch of the redshift, relative: (1 + |dE / d(psi)|) / E.
    shift_stretch: f64,
}

/// Where the ray leads outward (n_r > -sqrt(2 / r)): it has no turning point then if it escapes.
fn seen(position: DVec3, n: DVec3) -> Option<Seen> {
    let (r, e_r) = (position.length(), position.normalize());
    let n_r = n.dot(e_r);
    if n_r <= -(2.0 / r).sqrt() {
        return None;
    }
    let across = n - e_r * n_r;
    let energy = energy(r, n_r);
    let b = r * across.length() / energy;
    let share = if energy > 0.0 { b / CRITICAL } else { f64::INFINITY };
    let swept = if share < 1.0 { swept(r, b) } else { f64::NAN };
    let direction = e_r * swept.cos() + across.normalize_or_zero() * swept.sin();
    // d(psi) of 1e-5.
    let near = |step: f64| {
        let (sin, cos) = step.sin_cos();
        let (n_r, n_across) = (n_r * cos - across.length() * sin, across.length() * cos + n_r * sin);
        self::swept(r, r * n_across / self::energy(r, n_r))
    };
    let stretch = ((near(1e-5) - near(-1e-5)) / 2e-5).abs().max(1.0);
    let shift_stretch = (1.0 + (2.0 / r).sqrt()) / energy;
    Some(Seen { share, redshift: 1.0 / energy, direction, swept, stretch, shift_stretch })
}

#[test]
fn the_sky_of_a_fall_is_an_independent_integrals() {
    for (tracer, mut renderer) in both() {
        for r in RADII {
            renderer.scene = Scene { camera: falling(r), ..Scene::plain() };
            let size = [24, 12];
            let looks = looks(&renderer.scene.camera, size);
            let given = rays(&renderer.scene, size);
            let found = hits(&mut renderer, &given);
            let (mut escaped, mut captured, mut worst) = (0, 0, [0.0_f64; 3]);
            for (n, hit) in looks.into_iter().zip(found) {
                let Some(truth) = seen(renderer.scene.camera.position, n) else { continue };
                if truth.share > 1.001 {
                    assert_eq!(hit.fate, Fate::Captured, "{tracer}: r {r}, {n}, share {}", truth.share);
                    captured += 1;
                } else if truth.share < 0.98 {
                    assert_eq!(hit.fate, Fate::Escaped, "{tracer}: r {r}, {n}, share {}", truth.share);
                    let errors = [
                        hit.sky_direction.distance(truth.direction) / truth.stretch,
                        (hit.sky_redshift / truth.redshift - 1.0) / truth.shift_stretch,
                        (hit.swept_angle - truth.swept) / truth.stretch,
                    ];
                    (0..3).for_each(|i| worst[i] = worst[i].max(errors[i].abs()));
                    escaped += 1;
                }
            }
            println!(
                "{tracer}: r {r}: {escaped} escaped, {captured} captured, direction {:.1e}, redshift {:.1e}, \
                 angle {:.1e}",
                worst[0], worst[1], worst[2]
            );
            assert!(escaped > 80 && captured > 10, "{tracer}: r {r}: {escaped} {captured}");
            let bar = if tracer == "cpu" { 1e-10 } else { 2e-6 };
            assert!(worst.iter().all(|error| *error < bar), "{tracer}: r {r}: {worst:?}");
        }
    }
}

/// Pixels show that sky as well: traced, and where there are tables for such observers looked up.
#[test]
#[ignore = "in tests/run all; everyday: rays of a fall, and a fall has no seam"]
fn pictures_of_a_fall_show_that_sky() {
    let size = [64, 32];
    let mut renderers = both();
    for r in RADII {
        // The integrals take longer than the frames that are held to them.
        let camera = falling(r);
        let truths = looks(&camera, size).into_iter().map(|n| (n, seen(camera.position, n))).collect::<Vec<_>>();
        for (tracer, renderer) in &mut renderers {
            for tables in [LensTables::Always, LensTables::Never] {
                renderer.scene = Scene { camera, disk: None, ..Scene::plain() };
                renderer.scene.quality.lens_tables = tables;
                let records = renderer.ray_records(size[0], size[1]).unwrap();
                let (mut escaped, mut worst) = (0, [0.0_f64; 2]);
                for ((n, truth), record) in truths.iter().zip(records) {
                    let Some(truth) = truth else { continue };
                    if truth.share > 1.001 || truth.share < 0.98 {
                        let sky = record.fate == bhr::physics::trace::Fate::Escaped;
                        assert_eq!(sky, truth.share < 1.0, "{tracer}: r {r}, {n}, share {}", truth.share);
                    }
                    if truth.share < 0.98 {
                        worst[0] = worst[0].max(record.direction.distance(truth.direction) / truth.stretch);
                        worst[1] =
                            worst[1].max((record.sky_redshift / truth.redshift - 1.0).abs() / truth.shift_stretch);
                        escaped += 1;
                    }
                }
                println!(
                    "{tracer}: r {r}, {tables:?}: {escaped} escaped, direction {:.1e}, redshift {:.1e}",
                    worst[0], worst[1]
                );
                assert!(escaped > 500 && worst.iter().all(|error| *error < 2e-6), "{tracer}: r {r}: {worst:?}");
            }
        }
    }
}

/// Change of sky direction by change of look, at least 1.
fn stretch(record: &Record, size: [u32; 2]) -> f64 {
    // Rows are evenly apart.
    (record.footprint[1].length() / (PI / f64::from(size[1]))).clamp(1.0, 1e6)
}

/// The angle from straight inward at which r sin(psi) = b_c (1 - sqrt(2 / r) cos(psi)), by bisection.
fn shadow_radius(r: f64) -> f64 {
    let beyond = |psi: f64| r * psi.sin() - CRITICAL * (1.0 - (2.0 / r).sqrt() * psi.cos());
    // Inside, E <= 0 up to arccos(sqrt(r / 2)).
    let mut range = [if r < 2.0 { (r / 2.0).sqrt().acos() } else { 0.0 }, 0.9 * PI];
    let outside = beyond(range[1]) < 0.0;
    assert!(outside);
    if beyond(range[0]) < 0.0 {
        range[0] = (0..1000).map(|i| range[0] + 1e-3 * f64::from(i)).find(|psi| beyond(*psi) > 0.0).unwrap();
    }
    for _ in 0..100 {
        let middle = 0.5 * (range[0] + range[1]);
        range[usize::from(beyond(middle) < 0.0)] = middle;
    }
    range[0]
}

#[test]
fn the_shadow_of_a_fall_has_the_closed_forms_size() {
    for (tracer, mut renderer) in both() {
        for r in RADII {
            let theory = shadow_radius(r);
            renderer.scene = Scene { camera: falling(r), disk: None, sky: Sky::black(), ..Scene::plain() };
            let told = renderer.scene.hole_info().unwrap().shadow_angular_radius;
            assert!((told - theory).abs() < 1e-9, "r {r}: {told}, {theory}");
            // The edge by single rays: the last that is captured.
            let inward = -renderer.scene.camera.position.normalize();
            let side = inward.any_orthonormal_vector();
            let mut range = [0.0, PI];
            for _ in 0..40 {
                let middle: f64 = 0.5 * (range[0] + range[1]);
                renderer.scene.camera.forward = inward * middle.cos() + side * middle.sin();
                renderer.scene.camera.up = inward.cross(side);
                let ray = renderer.scene.camera_ray(3, 3, None, 1.5, 1.5).unwrap();
                let fate = hits(&mut renderer, &[ray])[0].fate;
                range[usize::from(fate == Fate::Escaped)] = middle;
            }
            let error = range[0] - theory;
            let bar = if tracer == "cpu" { 1e-10 } else { 1e-6 };
            // The edge by the solid angle of a picture's dark pixels: 2 pi (1 - cos psi).
            renderer.scene.camera = falling(r);
            // Each pixel by its centre's ray alone.
            renderer.scene.quality.refines = false;
            let size = [360, 180];
            let pixels = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, true);
            let mut dark = 0.0;
            for (row, line) in (0..).zip(pixels.chunks_exact(size[0] as usize * 4)) {
                let latitude = (0.5 - (f64::from(row) + 0.5) / f64::from(size[1])) * PI;
                let solid_angle = latitude.cos() * (PI / f64::from(size[1])).powi(2);
                dark += solid_angle * line.chunks_exact(4).filter(|pixel| pixel[3] == 255).count() as f64;
            }
            let share = dark / (2.0 * PI * (1.0 - theory.cos())) - 1.0;
            println!(
                "{tracer}: r {r}: {:.3} degrees, off by {error:.1e}; solid angle {share:+.1e}",
                theory.to_degrees()
            );
            assert!(error.abs() < bar, "{tracer}: r {r}: {} is off by {error:e}", theory);
            assert!(share.abs() < 2e-3, "{tracer}: r {r}: solid angle off by {share:e}");
        }
    }
}

/// Aberration and Doppler shift from the angles to the velocity (Einstein 1905): cos' = (cos + beta) / (1 + beta cos)
/// of what the observer at rest sees at cos, and nu' / nu = gamma (1 + beta cos).
#[test]
fn a_fast_camera_sees_what_one_at_rest_does_aberrated() {
    let size = [48, 24];
    let speed = 0.999_f64;
    let gamma = 1.0 / ((1.0 - speed) * (1.0 + speed)).sqrt();
    for (tracer, mut renderer) in both() {
        for (spin, tables) in
            [(0.0, LensTables::Always), (0.0, LensTables::Never), (0.9, LensTables::Always), (0.9, LensTables::Never)]
        {
            for towards in [DVec3::new(0.6, 0.8, 0.0), DVec3::new(-2.0, 3.0, 6.0) / 7.0] {
                // On a coordinate axis, where the local frame's vectors are those of the scene.
                let camera = Camera {
                    projection: Projection::Equirect,
                    position: DVec3::new(0.0, -15.0, 0.0),
                    forward: DVec3::new(0.4, 1.0, 0.3),
                    motion: Motion::Velocity,
                    velocity: towards * speed,
                    ..Camera::plain()
                };
                renderer.scene = Scene { camera, disk: None, ..Scene::plain() };
                renderer.scene.hole.spin = spin;
                renderer.scene.quality.lens_tables = tables;
                let moving = rays(&renderer.scene, size);
                // Seen from rest.
                let mut given = Vec::new();
                for (n, ray) in looks(&camera, size).into_iter().zip(&moving) {
                    let cos = n.dot(towards);
                    let cos_at_rest = (cos - speed) / (1.0 - speed * cos);
                    let side = (n - towards * cos).normalize();
                    let at_rest = towards * cos_at_rest + side * (1.0 - cos_at_rest * cos_at_rest).max(0.0).sqrt();
                    let ratio = gamma * (1.0 + speed * cos_at_rest);
                    assert!(ray.direction.distance(at_rest) < 1e-7, "{n}: {} {at_rest}", ray.direction);
                    assert!((ray.frequency_ratio / ratio - 1.0).abs() < 1e-9, "{n}: {} {ratio}", ray.frequency_ratio);
                    given.push(Ray { direction: at_rest, frequency_ratio: 1.0, ..*ray });
                }
                let truth = hits(&mut renderer, &given);
                let records = renderer.ray_records(size[0], size[1]).unwrap();
                renderer.scene.view = View::Redshift;
                let shifts = floats(&picture(&mut renderer, PixelFormat::R32F, size, None, false));
                let (mut seen, mut other, mut worst) = (0, 0, [0.0_f64; 2]);
                for (((hit, record), shift), ray) in truth.iter().zip(&records).zip(shifts).zip(&moving) {
                    let escaped = record.fate == bhr::physics::trace::Fate::Escaped;
                    if escaped != (hit.fate == Fate::Escaped) {
                        other += 1;
                        continue;
                    }
                    if escaped {
                        let g = ray.frequency_ratio * hit.sky_redshift;
                        let stretch = stretch(record, size).max(gamma);
                        worst[0] = worst[0].max(record.direction.distance(hit.sky_direction) / stretch);
                        worst[1] = worst[1].max((f64::from(shift) / g - 1.0).abs());
                        seen += 1;
                    } else {
                        assert!(shift.is_nan());
                    }
                }
                println!(
                    "{tracer}, spin {spin}, {tables:?}: {seen} of the sky, {other} differ; direction by stretch \
                     {:.1e}, g {:.1e}",
                    worst[0], worst[1]
                );
                assert!(seen > 900 && other == 0, "{tracer}, spin {spin}, {tables:?}: {seen} seen, {other} differ");
                assert!(worst[0] < 5e-6 && worst[1] < 2e-4, "{tracer}, spin {spin}, {tables:?}: {worst:?}");
            }
        }
    }
}
