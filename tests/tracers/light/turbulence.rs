// SPDX-License-Identifier: MIT OR Apache-2.0
//! The disk's turbulence as pictures show it: mean, motion, steadiness of its statistics, and the time at which it is
//! seen.

use super::{both, camera, cpu, hits, light, luminance, whole};
use crate::frames::Lent;
use crate::random::runs_all;
use bhr::emit::EmissionPoint;
use bhr::emit::streaks::Streaks;
use bhr::renderer::Renderer;
use bhr::scene::{Disk, Effects, Region, Sky};

const SIZE: [u32; 2] = [160, 160];
/// M across the frame of `face_on`.
const WIDTH: f64 = 44.0;

fn turbulent(turbulence: f64, retrograde: bool) -> Option<Disk> {
    Some(Disk { turbulence, retrograde, seed: 11, ..Disk::plain() })
}

/// Seen from the axis, each ring at one time: without delay.
fn face_on(retrograde: bool) -> Lent {
    let mut renderer = cpu();
    renderer.scene.sky = Sky::black();
    renderer.scene.camera = camera(2000.0, 0.0, WIDTH);
    renderer.scene.disk = turbulent(1.0, retrograde);
    renderer.scene.effects = Effects(Effects::ALL & !Effects::LIGHT_DELAY);
    renderer
}

fn luminances(renderer: &mut Renderer) -> Vec<f64> {
    light(renderer, SIZE, whole(SIZE)).into_iter().map(luminance).collect()
}

/// The factor of turbulence on each pixel at a time; NaN off the disk.
fn pattern(renderer: &mut Renderer, time: f64, smooth: &[f64]) -> Vec<f64> {
    renderer.scene.time = time;
    luminances(renderer).into_iter().zip(smooth).map(|(v, s)| if *s > 1e-3 { v / s } else { f64::NAN }).collect()
}

fn smooth(renderer: &mut Renderer) -> Vec<f64> {
    let disk = renderer.scene.disk;
    renderer.scene.disk = turbulent(0.0, disk.unwrap().retrograde);
    let smooth = luminances(renderer);
    renderer.scene.disk = disk;
    smooth
}

/// Place of a pixel's centre in units of the frame's M, from the hole, right and up.
fn place(k: usize) -> [f64; 2] {
    let at = |k: usize, n: u32| ((k as f64 + 0.5) / f64::from(n) - 0.5) * WIDTH;
    [at(k % SIZE[0] as usize, SIZE[0]), -at(k / SIZE[0] as usize, SIZE[1])]
}

/// The pattern at such a place, bilinear; NaN next to where there is none.
fn sampled(pattern: &[f64], [x, y]: [f64; 2]) -> f64 {
    let column = (x / WIDTH + 0.5) * f64::from(SIZE[0]) - 0.5;
    let row = (0.5 - y / WIDTH) * f64::from(SIZE[1]) - 0.5;
    let [i, j] = [column, row].map(f64::floor);
    let value = |i: f64, j: f64| {
        let inside = i >= 0.0 && j >= 0.0 && i < f64::from(SIZE[0]) && j < f64::from(SIZE[1]);
        if inside { pattern[j as usize * SIZE[0] as usize + i as usize] } else { f64::NAN }
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let along = |j: f64| mix(value(i, j), value(i + 1.0, j), column - i);
    mix(along(j), along(j + 1.0), row - j)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.filter(|v| v.is_finite()).fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    assert!(count > 1000.0, "{count} values");
    sum / count
}

/// The mean is that of the light of whole frames, over many generations.
#[test]
fn brightness_is_kept_on_average() {
    let mut renderer = face_on(false);
    let total = |renderer: &mut Renderer| luminances(renderer).iter().sum::<f64>();
    let smooth: f64 = smooth(&mut renderer).iter().sum();
    let frames: Vec<f64> = (0..if runs_all() { 60 } else { 24 })
        .map(|i| {
            renderer.scene.time = 61.0 * f64::from(i);
            total(&mut renderer) / smooth
        })
        .collect();
    let average = frames.iter().sum::<f64>() / frames.len() as f64;
    let spread = (frames.iter().map(|f| (f - average).powi(2)).sum::<f64>() / frames.len() as f64).sqrt();
    println!("mean {average:.4}, frame by frame +-{spread:.4}");
    assert!((average - 1.0).abs() < 4.0 * spread / (frames.len() as f64).sqrt(), "{average} +- {spread}");
    assert!((average - 1.0).abs() < 0.03 && spread < 0.2 && spread > 1e-3, "{average} +- {spread}");
}

/// A frame turned, ring by ring, by k Omega dt is most like the one dt later where k is 1, or -1 for a disk that goes
/// the other way. Omega = r^(-3/2); r of a ring that is seen at b from the axis, far away, is b - 1 to first order.
#[test]
fn pattern_goes_round_with_the_orbits() {
    for retrograde in [false, true] {
        let mut renderer = face_on(retrograde);
        let smooth = smooth(&mut renderer);
        let dt = 12.0;
        let [first, then] = [54.0, 54.0 + dt].map(|time| pattern(&mut renderer, time, &smooth));
        // Counter-clockwise about the spin is counter-clockwise in the picture: the observer looks down on the north
        // pole.
        let likeness = |k: f64| {
            let pairs = (0..first.len()).filter_map(|n| {
                let [x, y] = place(n);
                let b = x.hypot(y);
                let (sin, cos) = (k * dt * (b - 1.0).max(1.0).powf(-1.5)).sin_cos();
                let later = sampled(&then, [x * cos - y * sin, x * sin + y * cos]);
                (b > 8.5 && b < 19.0 && later.is_finite() && first[n].is_finite()).then_some([first[n], later])
            });
            correlation(&pairs.collect::<Vec<_>>())
        };
        let all: Vec<(f64, f64)> = (-8..=8).map(|k| 0.25 * f64::from(k)).map(|k| (k, likeness(k))).collect();
        println!("retrograde {retrograde}: {all:.2?}");
        let best = all.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        let wanted = if retrograde { -1.0 } else { 1.0 };
        assert_eq!(best.0, wanted, "retrograde {retrograde}: {all:?}");
        assert!(best.1 > 0.7 && likeness(0.0) < best.1 - 0.1, "retrograde {retrograde}: {all:?}");
    }
}

fn correlation(pairs: &[[f64; 2]]) -> f64 {
    assert!(pairs.len() > 1000, "{}", pairs.len());
    let n = pairs.len() as f64;
    let [a, b] = [0, 1].map(|i| pairs.iter().map(|p| p[i]).sum::<f64>() / n);
    let sum = |f: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(f).sum::<f64>();
    let product = sum(&|p| (p[0] - a) * (p[1] - b));
    product / (sum(&|p| (p[0] - a).powi(2)) * sum(&|p| (p[1] - b).powi(2))).sqrt()
}

/// Variance, and power of the change along the radius (which differential rotation would raise without end), over two
/// generations: the same at the beginning, after 1e3 M and after 1e6 M.
#[test]
#[ignore = "in tests/run all; everyday: the same of the pattern itself, in the library's unit tests"]
fn statistics_do_not_age() {
    let mut renderer = face_on(false);
    let smooth = smooth(&mut renderer);
    let statistics = |renderer: &mut Renderer, begin: f64| {
        let frames: Vec<[f64; 2]> = (0..40)
            .map(|i| {
                let p = pattern(renderer, begin + 60.7 * f64::from(i), &smooth);
                let average = mean(p.iter().copied());
                let variance = mean(p.iter().map(|v| (v - average).powi(2)));
                let radial = mean((0..p.len()).map(|n| {
                    let [x, y] = place(n);
                    let scale = 1.0 + 0.3 / x.hypot(y);
                    (sampled(&p, [x * scale, y * scale]) - sampled(&p, [x / scale, y / scale])).powi(2)
                }));
                [variance, radial]
            })
            .collect();
        [0, 1].map(|i| frames.iter().map(|f| f[i]).sum::<f64>() / frames.len() as f64)
    };
    let early = statistics(&mut renderer, 0.0);
    // Everyday after the longer time alone.
    for begin in [1e6, 1e3].into_iter().take(if runs_all() { 2 } else { 1 }) {
        let late = statistics(&mut renderer, begin);
        println!("variance, radial power: {early:.4?} at 0, {late:.4?} at {begin}");
        for (a, b) in early.iter().zip(late) {
            assert!(*a > 1e-3 && (b / a - 1.0).abs() < 0.25, "{early:?} at 0, {late:?} at {begin}");
        }
    }
}

/// Parts of a frame so large that pixels are far narrower than streaks, before and behind the hole and at its sides:
/// each pixel shows the pattern as it was when its light left, by the delay that the tracer states for its ray. Without
/// the effect, all of it is of the scene's time.
#[test]
#[ignore = "in tests/run all; everyday: delays are those of rays, and light left when advanced time says"]
fn pattern_is_seen_at_its_retarded_time() {
    let size = [24, 16];
    let time = 12345.6;
    let parts = [[1900, 1250], [1930, 700], [900, 1060], [2800, 1000]].map(|at| at.map(|v| 16 * v));
    for (spin, delayed) in [(0.0, true), (0.9, true), (0.0, false)] {
        for (tracer, mut renderer) in both() {
            renderer.scene.hole.spin = spin;
            renderer.scene.camera = camera(60.0, 70.0, 44.0);
            renderer.scene.time = time;
            renderer.scene.effects = Effects(if delayed { Effects::ALL } else { Effects::ALL & !Effects::LIGHT_DELAY });
            let (mut judged, mut delays) = (0, Vec::new());
            for [x, y] in parts {
                let region = Region { full_width: 16 * 3840, full_height: 16 * 2160, x, y };
                let [smooth, seen] = [0.0, 1.0].map(|turbulence| {
                    renderer.scene.disk = turbulent(turbulence, false);
                    light(&mut renderer, size, region)
                });
                for ((hit, smooth), seen) in hits(&mut renderer, size, region).iter().zip(smooth).zip(seen) {
                    let crossing = hit.crossings[0];
                    if luminance(smooth) < 1e-3 || hit.crossing_count == 0 || crossing.radius > 20.0 {
                        continue;
                    }
                    let mut then = renderer.scene.clone();
                    then.effects = Effects(0);
                    then.time = if delayed { time - crossing.delay } else { time };
                    let streaks = Streaks::shared().unwrap();
                    let still = EmissionPoint { ln_r: 0.0, azimuth: 0.0, delay: 0.0 };
                    let at = EmissionPoint { ln_r: crossing.radius.ln(), azimuth: crossing.azimuth, delay: 0.0 };
                    let expected =
                        then.emitters().disk.unwrap().turbulence.unwrap().brightness(streaks, at, [still; 2]);
                    let found = luminance(seen) / luminance(smooth);
                    assert!(
                        (found - expected).abs() < 4e-3 * expected.max(1.0),
                        "{tracer}: spin {spin}, {crossing:?}: {found}, not {expected}"
                    );
                    judged += 1;
                    delays.push(crossing.delay);
                }
            }
            let [least, most] =
                [delays.iter().copied().fold(f64::MAX, f64::min), delays.iter().copied().fold(0.0, f64::max)];
            println!("{tracer}: spin {spin}: {judged} pixels, delays {least:.1} to {most:.1} M");
            assert!(judged > 1000 && most - least > 10.0, "{tracer}: {judged} pixels, {least} to {most}");
        }
    }
}

/// One seed gives the same bytes, in a renderer of its own too; another one another pattern.
#[test]
fn seeds_repeat() {
    let mut renderer = face_on(false);
    let smooth = smooth(&mut renderer);
    let first = pattern(&mut renderer, 100.0, &smooth);
    renderer.scene.disk.as_mut().unwrap().seed = 12;
    let other = pattern(&mut renderer, 100.0, &smooth);
    let again = pattern(&mut face_on(false), 100.0, &smooth);
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
    assert!(same(&first, &again) && !same(&first, &other));
    let pairs = first.iter().zip(&other).filter(|(a, b)| a.is_finite() && b.is_finite()).map(|(a, b)| [*a, *b]);
    let likeness = correlation(&pairs.collect::<Vec<_>>());
    assert!(likeness.abs() < 0.3, "{likeness}");
}
