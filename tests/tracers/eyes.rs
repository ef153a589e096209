// SPDX-License-Identifier: MIT OR Apache-2.0
//! Several eyes by turns: how often the tables of their lenses are made.

use crate::frames::{both, picture};
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, LensTables, Scene};
use glam::DVec3;

/// An eye beside the place between the eyes.
fn eye(beside: f64) -> Camera {
    let position = DVec3::new(18.0, beside, 4.0);
    Camera { position, forward: DVec3::new(-18.0, 0.0, -4.0), ..Camera::plain() }
}

/// The tables that each of some frames makes, and its bytes.
fn made(renderer: &mut Renderer, eyes: &[f64]) -> Vec<(u64, Vec<u8>)> {
    let frame = |beside: &f64| {
        renderer.scene.camera = eye(*beside);
        let pixels = picture(renderer, PixelFormat::Rgba8Srgb, [64, 40], None, false);
        (renderer.stats().lens_tables, pixels)
    };
    eyes.iter().map(frame).collect()
}

#[test]
fn tables_of_two_eyes_are_not_made_anew() {
    for (tracer, mut renderer) in both() {
        for spin in [0.0, 0.9] {
            renderer.scene = Scene::plain();
            renderer.scene.hole.spin = spin;
            renderer.scene.quality.lens_tables = LensTables::Always;
            let frames = made(&mut renderer, &[-0.5, 0.3, -0.5, 0.3, -0.5, 0.3, -0.5]);
            let counts = frames.iter().map(|(count, _)| *count).collect::<Vec<_>>();
            // The first comes back once, and is kept from then on.
            assert_eq!(counts, [1, 1, 1, 0, 0, 0, 0], "{tracer}, spin {spin}");
            for pair in [[0, 2], [0, 4], [0, 6], [1, 3], [1, 5]] {
                assert!(frames[pair[0]].1 == frames[pair[1]].1, "{tracer}, spin {spin}: frames {pair:?}");
            }
            assert!(frames[0].1 != frames[1].1);
            // A head that moves, then rests.
            let moving = made(&mut renderer, &[1.0, 1.8, 1.1, 1.9, 1.2, 2.0, 1.2, 2.0, 1.2, 2.0]);
            let counts = moving.iter().map(|(count, _)| *count).collect::<Vec<_>>();
            assert_eq!(counts[..6], [1; 6], "{tracer}, spin {spin}");
            assert_eq!(counts[8..], [0; 2], "{tracer}, spin {spin}: {counts:?}");
            renderer.scene.quality.lens_tables = LensTables::Never;
            assert_eq!(made(&mut renderer, &[0.3])[0].0, 0);
        }
    }
}

/// Memory has bounds: of many eyes by turns the tables of four are kept.
#[test]
fn tables_of_many_eyes_take_bounded_memory() {
    let [_, (_, mut renderer)] = both();
    renderer.scene.quality.lens_tables = LensTables::Always;
    renderer.scene.hole.spin = 0.9;
    let mut bytes = |eyes: &[f64]| {
        made(&mut renderer, eyes);
        renderer.stats().device_bytes
    };
    let four = [0.0, 1.0, 2.0, 3.0];
    bytes(&[0.0]);
    bytes(&four.repeat(3));
    let held = bytes(&four);
    let many = (0..9).map(f64::from).collect::<Vec<_>>();
    assert!(bytes(&many.repeat(3)) <= held + held / 10, "{held}");
}
