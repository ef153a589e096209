// SPDX-License-Identifier: MIT OR Apache-2.0
//! Tests of cameras and rays in the chart RAIN: what is told in both charts is the same, and a fall is smooth.

use super::host_rays::trace_ray;
use super::trace::SKY_STEP;
use super::{Camera, Chart, Disk, Fate, Motion, Projection, Ray, Region, Scene, Transport};
use crate::physics::geodesic::{RAIN_CLOCK_RADIUS, turned};
use crate::physics::metric::chart;
use crate::physics::observer::{LocalFrame, Observer};
use crate::physics::orbit::{horizon_inner, horizon_outer};
use crate::physics::rain::offsets;
use crate::physics::trace::{self, RayTrace, trace_look};
use crate::random::mix;
use glam::DVec3;

const SIZE: [u32; 2] = [64, 48];
const REGION: Region = Region { full_width: SIZE[0], full_height: SIZE[1], x: 0, y: 0 };

fn scene(spin: f64, camera: Camera) -> Scene {
    let mut scene = Scene { camera, ..Scene::plain() };
    scene.hole.spin = spin;
    scene.hole.mass = 2.0;
    scene.hole.axis = DVec3::new(0.2, -0.3, 1.0);
    scene.disk = Some(Disk::default());
    scene
}

/// A camera at Boyer-Lindquist (r, theta) and the azimuth `azimuth` of its chart, M = 2.
fn camera(scene: &Scene, chart_: Chart, motion: Motion, place: [f64; 3]) -> Camera {
    let to_scene = scene.hole.scene_to_chart().transpose();
    let position = to_scene * chart(place[0], place[1], place[2]) * scene.hole.mass;
    Camera {
        projection: Projection::Perspective,
        position,
        forward: -position + DVec3::new(0.3, 0.1, -0.2),
        fov_y: 1.7,
        velocity: to_scene * chart(1.0, 1.1, 0.4) * 0.6,
        motion,
        chart: chart_,
        ..Camera::plain()
    }
}

/// Traces the ray through the pixel position as tracers do; and g of the sky.
fn traced(scene: &Scene, x: f64, y: f64) -> (RayTrace, f64) {
    let lens = scene.lens(&REGION).unwrap();
    let (n, ratio) = lens.observer.aberrate(lens.look_direction(x, y));
    let (c, traced) = trace_look(&lens.observer.frame, n, &scene.quality.ray_settings(scene.hole.spin));
    let g = c.map_or(f64::NAN, |c| ratio * c.nu_local / c.energy);
    (traced, g)
}

/// Numbers from 0 to 1, the same on every machine.
struct Random(u32);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 += 1;
        f64::from(mix(self.0)) / 4294967296.0
    }
}

/// A host's ray of a camera in the chart RAIN, which begins in the rain frame, is that of the tracers, who may have the
/// camera in the other chart: sky, g, and crossings in azimuth and time.
#[test]
fn rays_of_rain_cameras_are_those_of_tracers() {
    let mut random = Random(5);
    let mut worst = [0.0_f64; 3];
    let (mut skies, mut crossings) = (0, 0);
    for spin in [0.0, 0.5, -0.9, 0.998] {
        for motion in [Motion::FreeFall, Motion::Velocity, Motion::Static, Motion::Orbit] {
            for r in [1.7, 2.6, RAIN_CLOCK_RADIUS + 0.01, 6.0, 30.0] {
                let circles = motion == Motion::Orbit;
                let theta = if circles { std::f64::consts::FRAC_PI_2 } else { 1.2 };
                let mut scene = scene(spin, Camera::plain());
                scene.camera = camera(&scene, Chart::Rain, motion, [r, theta, 0.7]);
                let rests = matches!(motion, Motion::Static | Motion::Orbit);
                let photon = crate::physics::orbit::photon_orbit(spin);
                if rests && (r <= horizon_outer(spin) * 1.05 || (circles && r <= photon * 1.05)) {
                    continue;
                }
                for _ in 0..12 {
                    let (x, y) = (random.next() * 64.0, random.next() * 48.0);
                    let ray = scene.camera_ray(SIZE[0], SIZE[1], None, x, y).unwrap();
                    let hit = trace_ray(&scene, &scene.quality.ray_settings(spin), &ray);
                    let (seen, g) = traced(&scene, x, y);
                    let fate = if seen.fate == trace::Fate::Escaped { Fate::Escaped } else { Fate::Captured };
                    assert_eq!(hit.fate, fate, "{spin} {motion:?} {r} {x} {y}");
                    let constants = scene.start(&ray).unwrap().1;
                    let margin = constants.map_or(1.0, |(c, s)| c.critical_margin(&s).min(1.0));
                    if fate == Fate::Escaped {
                        let direction = scene.hole.scene_to_chart().transpose() * seen.direction;
                        worst[0] = worst[0].max((hit.sky_direction - direction).length() * margin);
                        worst[1] = worst[1].max((hit.sky_redshift / g - 1.0).abs());
                        skies += 1;
                    }
                    for (found, expected) in hit.crossings.iter().zip(&seen.crossings).take(1) {
                        let turn = crate::physics::geodesic::wrap_angle(found.azimuth - expected.azimuth).abs();
                        let apart = turn + (found.radius * expected.u / 2.0 - 1.0).abs();
                        // The delay of the tracers is by their own clock.
                        let lens = scene.lens(&REGION).unwrap();
                        let delay = 2.0 * (expected.delay + lens.delay_offset);
                        let late = (found.delay - delay).abs() / found.delay.abs().max(1.0);
                        let near = 1.0 - horizon_outer(spin) * expected.u;
                        worst[2] = worst[2].max((apart + late) * margin * near);
                        assert!(
                            (apart + late) * margin * near < 1e-8,
                            "{spin} {motion:?} {r}: {found:?} {expected:?} {delay}"
                        );
                        crossings += 1;
                    }
                }
            }
        }
    }
    println!("{skies} skies {:.1e}, g {:.1e}; {crossings} crossings {:.1e}", worst[0], worst[1], worst[2]);
    assert!(skies > 300 && crossings > 200 && worst[0] < 1e-9 && worst[1] < 1e-11, "{skies} {crossings} {worst:?}");
}

/// The step of pixels that show the sky alone leaves directions within a small part of a pixel: the error is counted
/// against how much the direction changes with the look, in units of looks.
#[test]
fn steps_of_pixels_of_the_sky_are_short_enough() {
    let mut random = Random(77);
    let mut errors = Vec::new();
    for spin in [0.5, -0.9, 0.998] {
        for part in [0.02, 0.3, 0.6, 1.0] {
            let r = horizon_inner(spin) + part * (2.95 - horizon_inner(spin));
            let mut scene = Scene { disk: None, ..scene(spin, Camera::plain()) };
            scene.camera = camera(&scene, Chart::Rain, Motion::FreeFall, [r, 1.2, 0.7]);
            let frame = scene.lens(&REGION).unwrap().observer.frame;
            let (coarse, exact) = (scene.pixel_settings(), scene.quality.ray_settings(spin));
            assert_eq!(coarse.step, SKY_STEP, "{spin} {r}");
            for _ in 0..100 {
                let n = chart(1.0, 3.1 * random.next(), 6.2 * random.next());
                let (across, down) = n.any_orthonormal_pair();
                let [right, below] = [across, down].map(|side| (n + side * 1e-5).normalize());
                let rays = [(n, &coarse), (n, &exact), (right, &exact), (below, &exact)].map(|(n, settings)| {
                    let seen = trace_look(&frame, n, settings).1;
                    (seen.fate == trace::Fate::Escaped).then_some(seen.direction)
                });
                if let [Some(found), Some(sky), Some(right), Some(below)] = rays {
                    let change = (right - sky).length().max((below - sky).length()) / 1e-5;
                    errors.push((found - sky).length() / (1.0 + change));
                }
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let [middle, most, worst] = [0.5, 0.99, 1.0].map(|part| errors[((errors.len() - 1) as f64 * part) as usize]);
    println!("{} skies at step {SKY_STEP}: {middle:.1e}, 99 % {most:.1e}, {worst:.1e}", errors.len());
    assert!(errors.len() > 400 && middle < 1e-6 && most < 1e-4 && worst < 2e-4);
}

/// Boosts made one after the other are the boost and the turn that `carried_by` says.
#[test]
fn boosts_add_up_to_a_boost_and_a_turn() {
    let mut random = Random(400);
    let mut vector = |length: f64| chart(length, 3.1 * random.next(), 6.2 * random.next());
    let place = LocalFrame::rain(0.9, DVec3::new(4.0, 3.0, 2.0)).unwrap();
    for (fast, slow) in [(0.5, 0.3), (0.9, 0.8), (0.999, 0.7), (0.2, 0.999)] {
        let carrier = Observer::moving(place.to_static(), vector(fast));
        let own = Observer::moving(place, vector(slow));
        let (sum, turn) = own.carried_by(&carrier);
        for _ in 0..20 {
            let n = vector(1.0);
            let (there, first) = own.aberrate(n);
            let (expected, second) = carrier.aberrate(there);
            let (found, ratio) = sum.aberrate(turn * n);
            let off = (found - expected).length();
            assert!(off < 1e-10 && (ratio / (first * second) - 1.0).abs() < 1e-10, "{fast} {slow}: {off:e}");
        }
    }
}

/// A camera of any velocity sees at r = 3 M, where tracers change charts, on both sides the same.
#[test]
fn moving_cameras_do_not_turn_where_tracers_change_charts() {
    for spin in [0.9, -0.6, 0.0] {
        let seen = [1e-9, -1e-9].map(|step| {
            let mut scene = scene(spin, Camera::plain());
            scene.camera = camera(&scene, Chart::Rain, Motion::Velocity, [RAIN_CLOCK_RADIUS + step, 1.2, 0.7]);
            let lens = scene.lens(&REGION).unwrap();
            [(3.0, 5.0), (60.0, 11.0), (20.0, 40.0), (33.0, 2.0)]
                .map(|(x, y)| (traced(&scene, x, y), lens.closest_approach(x, y)))
        });
        for (((a, g), near), ((b, h), other)) in seen[0].iter().zip(&seen[1]) {
            assert_eq!(a.fate, b.fate);
            assert!((near - other).abs() < 1e-7, "{spin}: {near} {other}");
            assert!((a.direction - b.direction).length() < 1e-6, "{spin}: {a:?} {b:?}");
            assert!(a.fate != trace::Fate::Escaped || (g / h - 1.0).abs() < 1e-7, "{spin}: {g} {h}");
        }
    }
}

/// Far and near, a camera in the one chart sees what the camera in the other at the same place sees.
#[test]
fn both_charts_show_the_same() {
    for (spin, r) in [(0.9, 2.0), (0.9, 9.0), (-0.7, 2.5), (0.0, 2.5), (0.0, 12.0)] {
        for motion in [Motion::FreeFall, Motion::Static] {
            let mut rain = scene(spin, Camera::plain());
            rain.camera = camera(&rain, Chart::Rain, motion, [r, 1.1, 0.7]);
            let offset = if spin == 0.0 { 0.0 } else { offsets(spin, 1.0 / r).azimuth };
            let to_chart = rain.hole.scene_to_chart();
            let turn = |v: DVec3| to_chart.transpose() * turned(to_chart * v, -offset);
            let mut other = rain.clone();
            other.camera = Camera {
                chart: Chart::Static,
                position: turn(rain.camera.position),
                forward: turn(rain.camera.forward),
                up: turn(rain.camera.up),
                ..rain.camera
            };
            for (x, y) in [(3.0, 5.0), (60.0, 11.0), (20.0, 40.0), (33.0, 2.0)] {
                let [(a, g), (b, h)] = [&rain, &other].map(|scene| traced(scene, x, y));
                let off = (a.direction - b.direction).length();
                assert_eq!(a.fate, b.fate);
                if a.fate == trace::Fate::Escaped {
                    assert!(off < 1e-9 && (g / h - 1.0).abs() < 1e-10, "{spin} {r} {motion:?}: {a:?} {b:?}");
                }
            }
        }
    }
}

/// Cameras inside, of any velocity, see the sky where light comes from, and rays end.
#[test]
fn cameras_inside_see_the_sky() {
    let mut random = Random(9_000);
    let mut skies = 0;
    for _ in 0..400 {
        let spin = 2.0 * random.next() - 1.0;
        let (outer, inner) = (horizon_outer(spin), horizon_inner(spin));
        let r = inner + (outer - inner) * (0.02 + 0.98 * random.next());
        let mut scene = scene(0.998 * spin, Camera::plain());
        let velocity = chart(0.95 * random.next(), 3.0 * random.next(), 6.0 * random.next());
        scene.camera = camera(&scene, Chart::Rain, Motion::Velocity, [r, 3.1 * random.next(), 5.0]);
        scene.camera.velocity = velocity;
        if r <= horizon_inner(scene.hole.spin) * 1.001 {
            continue;
        }
        let (seen, g) = traced(&scene, 64.0 * random.next(), 48.0 * random.next());
        assert!(seen.fate != trace::Fate::Unresolved, "{spin} {r}");
        if seen.fate == trace::Fate::Escaped {
            assert!((seen.direction.length() - 1.0).abs() < 1e-12 && g > 0.0 && g.is_finite(), "{spin} {r}");
            skies += 1;
        }
    }
    assert!(skies > 100, "{skies}");
}

#[test]
fn motions_and_places_are_checked() {
    let inside = |motion, r| {
        let mut scene = scene(0.9, Camera::plain());
        scene.camera = camera(&scene, Chart::Rain, motion, [r, 1.0, 0.0]);
        scene.observer().map(|_| ()).map_err(|error| error.message)
    };
    assert!(inside(Motion::FreeFall, 1.0).is_ok() && inside(Motion::Velocity, 0.6).is_ok());
    assert!(inside(Motion::Static, 1.2).unwrap_err().contains("1.4358"));
    assert!(inside(Motion::Orbit, 1.2).unwrap_err().contains("ORBIT"));
    assert!(inside(Motion::FreeFall, 0.5).unwrap_err().contains("r-"));
    let mut scene = scene(0.9, Camera::plain());
    scene.camera = camera(&scene, Chart::Static, Motion::FreeFall, [1.2, 1.0, 0.0]);
    assert!(scene.observer().unwrap_err().message.contains("BHR_CHART_RAIN"));
    assert!(scene.projector(4, 4, None, 0).is_err());
    scene.camera.chart = Chart::Rain;
    assert!(scene.projector(4, 4, None, 0).is_ok());
    let ray = Ray { position: scene.camera.position, direction: DVec3::X, frequency_ratio: 1.0 };
    assert!(scene.start(&ray).is_some());
    scene.camera.chart = Chart::Static;
    assert!(scene.start(&ray).is_none());
}

/// A fall in the chart RAIN goes through the horizon to the inner one, in even steps of its own time.
#[test]
fn falls_go_through_the_horizon() {
    let mut scene = scene(0.9, Camera::plain());
    scene.camera = camera(&scene, Chart::Rain, Motion::FreeFall, [8.0, 1.2, 0.7]);
    let (mut time, mut frames) = (0.0, 0);
    let begin = scene.camera;
    let error = loop {
        match scene.advance_camera(&scene.camera, 0.2) {
            Ok((next, passed)) => {
                assert!((passed - 0.2).abs() < 1e-9, "{passed}");
                // Doran's azimuth and the polar angle stay, and so do axes.
                assert!(next.position.normalize().abs_diff_eq(begin.position.normalize(), 1e-12));
                assert!(next.forward.abs_diff_eq(begin.forward, 1e-9));
                (scene.camera, time, frames) = (next, time + passed, frames + 1);
            }
            Err(error) => break error.message,
        }
    };
    let r = scene.camera.position.length() / scene.hole.mass;
    assert!(error.contains("inner horizon") && r < 0.75 && frames > 50, "{error} {r} {frames}");
    let (back, _) = scene.advance_camera(&scene.camera, -time).unwrap();
    assert!(back.position.abs_diff_eq(begin.position, 1e-8), "{back:?}");
    scene.camera = Camera { chart: Chart::Static, ..begin };
    let error = scene.advance_camera(&scene.camera, 100.0).unwrap_err().message;
    assert!(error.contains("BHR_CHART_STATIC does not reach"), "{error}");
}

/// Axes on a circular orbit: against the triad they turn back by 1 - sqrt(1 - 3 / r) of a turn in each revolution
/// without spin (de Sitter 1916), whichever way they are advanced.
#[test]
fn parallel_axes_precess_as_de_sitters() {
    for (motion, chart_) in
        [(Motion::Orbit, Chart::Static), (Motion::Velocity, Chart::Static), (Motion::Velocity, Chart::Rain)]
    {
        let mut scene = scene(0.0, Camera::plain());
        scene.hole.axis = DVec3::Z;
        let (r, mass) = (10.0_f64, scene.hole.mass);
        let mut camera = camera(&scene, chart_, motion, [r, std::f64::consts::FRAC_PI_2, 0.0]);
        (camera.forward, camera.up, camera.transport) = (DVec3::NEG_X, DVec3::Z, Transport::Parallel);
        let beta = 1.0 / (r - 2.0).sqrt();
        // The static observer moves outwards at sqrt(2 / r) against the rain observer.
        let (speed, gamma) = ((2.0 / r).sqrt(), 1.0 / (1.0 - 2.0 / r).sqrt());
        camera.velocity = if chart_ == Chart::Static { DVec3::Y * beta } else { DVec3::new(speed, beta / gamma, 0.0) };
        let period = std::f64::consts::TAU * r * (r - 3.0).sqrt() * mass;
        let (after, _) = scene.advance_camera(&camera, period).unwrap();
        assert!(after.position.abs_diff_eq(camera.position, 1e-6), "{motion:?} {chart_:?}: {}", after.position);
        let expected = std::f64::consts::TAU * (1.0 - (1.0 - 3.0 / r).sqrt());
        let found = (-after.forward).y.atan2((-after.forward).x).rem_euclid(std::f64::consts::TAU);
        let turn = std::f64::consts::TAU - found;
        let near = (found - expected).abs().min((turn - expected).abs());
        println!("{motion:?} {chart_:?}: {found} {expected}");
        assert!(near < 1e-6, "{motion:?} {chart_:?}: {found} {turn} {expected}");
        assert!(after.up.abs_diff_eq(DVec3::Z, 1e-9));
    }
}
