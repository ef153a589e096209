// SPDX-License-Identifier: MIT OR Apache-2.0
//! Several samples a pixel, on the disk's outer edge, on both tracers: they converge, the edge is as sharp as the
//! filter, and fine structure does not alias. How samples are placed is tested in src/scene/frame.rs.

use crate::frames::both;
use crate::random::runs_all;
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Effects};
use glam::DVec3;

const SIZE: [u32; 2] = [160, 90];

/// A disk of nearly even light, alone, seen from above: its edge is an ellipse, turned against the pixels.
fn show_disk(renderer: &mut Renderer) {
    let scene = &mut renderer.scene;
    scene.sky.flags = 0;
    scene.effects = Effects(0);
    let position = DVec3::new(20.0, 0.0, 60.0);
    let up = DVec3::new(0.3, 1.0, 0.1);
    scene.camera = Camera { position, forward: -position, up, fov_y: 0.9, ..Camera::plain() };
}

/// Luminance, row by row.
fn light(renderer: &mut Renderer, samples: u32) -> Vec<f64> {
    renderer.scene.quality.samples_per_pixel = samples;
    let mut pixels = vec![0; (SIZE[0] * SIZE[1] * 16) as usize];
    let mut image = ImageMut::new(Layout::packed(PixelFormat::Rgba32F, SIZE[0], SIZE[1]), &mut pixels).unwrap();
    renderer.render(&mut image, false, None, &mut |_| true).unwrap();
    let value = |p: &[u8], c: usize| f64::from(f32::from_le_bytes(p[4 * c..4 * c + 4].try_into().unwrap()));
    pixels.chunks_exact(16).map(|p| 0.2126 * value(p, 0) + 0.7152 * value(p, 1) + 0.0722 * value(p, 2)).collect()
}

/// Pixels at the disk's outer edge: of those within two of them some are dark and some are not.
fn edge(light: &[f64]) -> Vec<usize> {
    let [width, height] = SIZE.map(|side| side as usize);
    let inside = (2..height - 2).flat_map(|y| (2..width - 2).map(move |x| (x, y)));
    let near = |x: usize, y: usize| (0..25).map(move |i| light[(y + i / 5 - 2) * width + x + i % 5 - 2]);
    let at_edge = |&(x, y): &(usize, usize)| {
        let (low, high) = near(x, y).fold((f64::MAX, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
        low == 0.0 && high > 0.01 && (x as f64 - 80.0).hypot(y as f64 - 45.0) > 25.0
    };
    inside.filter(at_edge).map(|(x, y)| y * width + x).collect()
}

#[test]
fn more_samples_come_nearer() {
    // Everyday on the GPU: both tracers' samples are compared by `gpu_and_cpu_pictures_agree` and in frames with more.
    let [cpu, gpu] = both();
    for (tracer, mut renderer) in runs_all().then_some(cpu).into_iter().chain([gpu]) {
        show_disk(&mut renderer);
        let best = light(&mut renderer, 256);
        let edge = edge(&best);
        assert!(edge.len() > 200, "{tracer}: {} pixels at the edge", edge.len());
        let bright = edge.iter().map(|i| best[*i]).fold(0.0, f64::max);
        let error = |frame: &[f64]| {
            let squares = edge.iter().map(|i| (frame[*i] - best[*i]).powi(2)).sum::<f64>();
            (squares / edge.len() as f64).sqrt() / bright
        };
        let errors = [4, 16, 64].map(|samples| error(&light(&mut renderer, samples)));
        println!("{tracer}: {errors:.4?} of the edge's light, of {} pixels", edge.len());
        assert!(errors[1] < 0.5 * errors[0] && errors[2] < 0.7 * errors[1], "{tracer}: {errors:?}");
        assert!(errors[0] < 0.08 && errors[1] < 0.03 && errors[2] < 0.012, "{tracer}: {errors:?}");
    }
}

/// Along rows and columns, where the edge crosses them: half of its light comes and goes within the filter's width.
#[test]
fn edges_are_as_sharp_as_the_filter() {
    for (tracer, mut renderer) in both() {
        show_disk(&mut renderer);
        // The filter alone.
        renderer.scene.quality.refines = false;
        let frame = light(&mut renderer, 64);
        let width = SIZE[0] as usize;
        // Through the middle column, from the top down: the first light, and where it is full.
        let column = (0..45).map(|y| frame[y * width + 80]).collect::<Vec<_>>();
        let first = column.iter().position(|v| *v > 0.0).unwrap();
        let full = column[first + 3];
        let partly = column[first..first + 3].iter().filter(|v| **v < 0.95 * full).count();
        println!("{tracer}: {:?} of {full}", &column[first..first + 4]);
        assert!((1..=3).contains(&partly), "{tracer}: {partly} pixels are partly lit");
        assert!(column[first + 2] > 0.85 * full, "{tracer}: a soft edge: {:?}", &column[first..first + 4]);
        assert!(column[first] < 0.6 * full, "{tracer}: a hard edge: {:?}", &column[first..first + 4]);
    }
}
