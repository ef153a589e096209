// SPDX-License-Identifier: MIT OR Apache-2.0
//! Edges and thin rings: each pixel against the mean of many rays through it, rings without gaps, and steady while the
//! camera turns by parts of a pixel. On both tracers; the GPU is whatever adapter comes first.

use crate::frames::{Lent, both};
use crate::random::runs_all;
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Effects, Region, Scene};
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

const FULL: [u32; 2] = [640, 360];
const FOV_Y: f64 = PI / 3.0;
/// How much finer the frames are that pixels are held against: 64 of their pixels, each with its own rays, for one.
const FINER: u32 = 8;

/// A disk alone, seen at g = 1: no stars, no effects on light. `inclination` in degrees.
fn scene(spin: f64, distance: f64, inclination: f64, opacity: f64) -> Scene {
    let theta = inclination.to_radians();
    let position = DVec3::new(0.0, -theta.sin(), theta.cos()) * distance;
    let mut scene = Scene::plain();
    scene.hole.spin = spin;
    scene.camera = Camera { position, forward: -position, fov_y: FOV_Y, ..Camera::plain() };
    scene.sky.stars_brightness = 0.0;
    scene.effects = Effects(0);
    scene.disk.as_mut().unwrap().opacity = opacity;
    scene
}

/// A square about the middle of a full frame, luminances row by row.
struct Window {
    side: usize,
    light: Vec<f64>,
}

fn window(renderer: &mut Renderer, side: u32) -> Window {
    finer_window(renderer, side, 1)
}

/// The window as means over `finer` x `finer` pixels of a finer frame.
fn finer_window(renderer: &mut Renderer, side: u32, finer: u32) -> Window {
    let origin = FULL.map(|full| (full - side) / 2 * finer);
    let region = Region { full_width: FULL[0] * finer, full_height: FULL[1] * finer, x: origin[0], y: origin[1] };
    let fine = side * finer;
    let mut bytes = vec![0; (fine * fine * 16) as usize];
    let mut image = ImageMut::new(Layout::packed(PixelFormat::Rgba32F, fine, fine), &mut bytes).unwrap();
    renderer.render(&mut image, false, Some(region), &mut |_| true).unwrap();
    let (side, fine, finer) = (side as usize, fine as usize, finer as usize);
    let mut light = vec![0.0; side * side];
    for (pixel, i) in bytes.chunks_exact(16).zip(0..) {
        let [r, g, b] = [0, 4, 8].map(|c| f32::from_le_bytes(pixel[c..c + 4].try_into().unwrap()));
        // Rec. 709.
        let luminance = f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b);
        assert!(luminance.is_finite());
        light[i / fine / finer * side + i % fine / finer] += luminance / (finer * finer) as f64;
    }
    Window { side, light }
}

/// The light that crossings of orders above `above` up to `most` add.
fn ring(renderer: &mut Renderer, side: u32, above: u32, most: u32) -> Window {
    finer_ring(renderer, side, above, most, 1)
}

/// The light of `ring` as means over pixels of a finer frame, as in `finer_window`.
fn finer_ring(renderer: &mut Renderer, side: u32, above: u32, most: u32, finer: u32) -> Window {
    let mut with_orders = |most| {
        renderer.scene.quality.max_disk_order = most;
        finer_window(renderer, side, finer)
    };
    let (all, less) = (with_orders(most), with_orders(above));
    Window { side: all.side, light: all.light.iter().zip(&less.light).map(|(a, b)| a - b).collect() }
}

impl Window {
    fn sum(&self) -> f64 {
        self.light.iter().sum()
    }

    fn at(&self, x: usize, y: usize) -> f64 {
        self.light[y * self.side + x]
    }

    /// The light of each of `bins` sectors about the ring's centre of light, pixels being cut into 8 x 8.
    fn profile(&self, bins: usize) -> Vec<f64> {
        let pixels = || (0..self.side).flat_map(|y| (0..self.side).map(move |x| (x, y)));
        let moment = |f: &dyn Fn(f64, f64) -> f64| {
            pixels().map(|(x, y)| f(x as f64 + 0.5, y as f64 + 0.5) * self.at(x, y)).sum::<f64>() / self.sum()
        };
        let (cx, cy) = (moment(&|x, _| x), moment(&|_, y| y));
        let mut sums = vec![0.0; bins];
        for (x, y) in pixels() {
            for part in 0..64 {
                let (dx, dy) = ((part % 8) as f64 / 8.0 + 0.0625, (part / 8) as f64 / 8.0 + 0.0625);
                let angle = (y as f64 + dy - cy).atan2(x as f64 + dx - cx).rem_euclid(TAU);
                sums[((angle / TAU * bins as f64) as usize).min(bins - 1)] += self.at(x, y) / 64.0;
            }
        }
        sums
    }
}

/// Spin, distance, side of a window that holds the rings.
const OBSERVERS: [(f64, f64, u32); 4] = [(0.0, 30.0, 132), (0.9, 30.0, 132), (0.0, 100.0, 44), (0.9, 100.0, 44)];

#[test]
fn rings_have_no_gaps_and_as_much_light_as_many_rays_find() {
    let mut tracers = both();
    // Everyday one.
    let observers = if runs_all() { &OBSERVERS[..] } else { &OBSERVERS[2..3] };
    for &(spin, distance, side) in observers {
        let truth =
            of_many_rays(&mut tracers, scene(spin, distance, 20.0, 0.3), |gpu| finer_ring(gpu, side, 0, 2, FINER))
                .sum();
        for (tracer, renderer) in &mut tracers {
            renderer.scene = scene(spin, distance, 20.0, 0.3);
            let error = ring(renderer, side, 0, 2).sum() / truth - 1.0;
            let shares = [1, 2].map(|order| {
                let mut profile = ring(renderer, side, order - 1, order).profile(36);
                profile.sort_by(f64::total_cmp);
                profile[0] / profile[profile.len() / 2]
            });
            println!("{tracer} a = {spin} r = {distance}: light {error:+.4}, least / median of n = 1, 2: {shares:.3?}");
            assert!(error.abs() < 0.02 && shares.iter().all(|share| *share > 0.5));
        }
    }
}

/// The window as the GPU shows it in a finer frame.
fn of_many_rays(tracers: &mut [(&str, Lent); 2], scene: Scene, show: impl Fn(&mut Renderer) -> Window) -> Window {
    let [_, (_, gpu)] = tracers;
    gpu.scene = scene;
    show(gpu)
}

/// The camera turned to the right by `pixels` of the frame's middle.
fn turn(camera: &Camera, pixels: f64) -> Camera {
    let up = camera.up.reject_from(camera.forward).normalize();
    let angle = -pixels * (FOV_Y / 2.0).tan() / (f64::from(FULL[1]) / 2.0);
    Camera { forward: DMat3::from_axis_angle(up, angle) * camera.forward, ..*camera }
}

#[test]
#[ignore = "in tests/run all; everyday: pixels change evenly while the camera pans"]
fn rings_are_steady_while_the_camera_turns() {
    // The observer is so far that the shadow is 3 pixels wide: all light counts, as its rings are no more than a
    // thousandth.
    let tiny = [(0.0, 1000.0, 40), (0.9, 1000.0, 40)];
    // In sixteenths of a pixel. The CPU's pictures are the GPU's (tests/tracers/pictures.rs), so that it takes fewer.
    let steps = if runs_all() { [17, 64] } else { [3, 7] };
    for ((tracer, mut renderer), steps) in both().into_iter().zip(steps) {
        for (spin, distance, side) in OBSERVERS.into_iter().chain(tiny) {
            renderer.scene = scene(spin, distance, 20.0, 0.3);
            let begin = renderer.scene.camera;
            let (mut last, mut most) = (None::<f64>, 0.0_f64);
            for step in 0..steps {
                renderer.scene.camera = turn(&begin, f64::from(step) / 16.0);
                let far = distance > 500.0;
                let seen = if far { window(&mut renderer, side) } else { ring(&mut renderer, side, 0, 3) };
                let sum = seen.sum();
                if let Some(before) = last {
                    most = most.max((sum / before - 1.0).abs());
                }
                last = Some(sum);
            }
            println!("{tracer} a = {spin} r = {distance}: frame to frame {most:.5}");
            // The CPU tracer looks these frames up at spin 0.9.
            assert!(most < 0.021);
        }
    }
}

/// Share of the pixels at edges whose light is not within 2 % of the greatest of what a finer frame has there, and the
/// worst.
fn edge_errors(seen: &Window, truth: &Window) -> (usize, f64, f64) {
    let full = truth.light.iter().copied().fold(0.0, f64::max);
    let (mut edges, mut off, mut worst) = (0, 0, 0.0_f64);
    for (x, y) in (1..seen.side - 1).flat_map(|y| (1..seen.side - 1).map(move |x| (x, y))) {
        let here = truth.at(x, y);
        let beside = [truth.at(x - 1, y), truth.at(x + 1, y), truth.at(x, y - 1), truth.at(x, y + 1)];
        if beside.iter().all(|there| (there - here).abs() < 0.05 * full) {
            continue;
        }
        edges += 1;
        let error = (seen.at(x, y) - here).abs() / full;
        off += usize::from(error > 0.02);
        worst = worst.max(error);
    }
    (edges, off as f64 / edges as f64, worst)
}

#[test]
#[ignore = "in tests/run all; everyday: rings have no gaps and as much light as many rays find"]
fn edges_of_the_disk_are_filtered_over_the_pixel() {
    let mut tracers = both();
    // Everyday what holds the disk from afar, and its inner edge from near by.
    let side = if runs_all() { 240 } else { 160 };
    for (observer, (spin, distance, _)) in OBSERVERS.into_iter().enumerate() {
        for (disk, (inclination, opacity, inner)) in [(75.0, 1.0, 0.0), (40.0, 0.6, 9.0)].into_iter().enumerate() {
            // Everyday each disk is seen at each spin and from each distance, but not at each spin from each distance.
            if !runs_all() && disk != [0, 1, 1, 0][observer] {
                continue;
            }
            let mut scene = scene(spin, distance, inclination, opacity);
            scene.disk.as_mut().unwrap().inner_radius = inner;
            // Higher orders are for the tests of rings.
            scene.quality.max_disk_order = 1;
            let truth = of_many_rays(&mut tracers, scene.clone(), |gpu| finer_window(gpu, side, FINER));
            for (tracer, renderer) in &mut tracers {
                renderer.scene = scene.clone();
                let (edges, off, worst) = edge_errors(&window(renderer, side), &truth);
                println!(
                    "{tracer} a = {spin} r = {distance} i = {inclination}: {edges} pixels, off {off:.4}, \
                     worst {worst:.3}"
                );
                // Rays of thin rings (the disk with its inner edge at 9 M has such) count as they fall.
                let limit = if inner == 0.0 { 0.01 } else { 0.042 };
                assert!(edges > 100 && off < limit);
            }
        }
    }
}
