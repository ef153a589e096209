// SPDX-License-Identifier: MIT OR Apache-2.0
//! Several eyes: how often the tables of their lenses are made when they are shown by turns, and stereo pictures all
//! round, whose columns are each seen from another place.

use crate::frames::{both, differing, picture, tiled};
use crate::random::runs_all;
use bhr::image::PixelFormat;
use bhr::image::{ImageMut, memory::Layout};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Eye, LensTables, Projection, Region, Scene, Sky};
use glam::DVec3;
use std::f64::consts::TAU;

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

/// Everyday each tracer with one kind of tables: what is kept is chosen by one rule.
#[test]
fn tables_of_two_eyes_are_not_made_anew() {
    for (i, (tracer, mut renderer)) in both().into_iter().enumerate() {
        for (j, spin) in [0.0, 0.9].into_iter().enumerate() {
            if !runs_all() && i != j {
                continue;
            }
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
#[ignore = "in tests/run all; everyday: tables of two eyes"]
fn tables_of_many_eyes_take_bounded_memory() {
    let [_, (_, mut renderer)] = both();
    renderer.scene.quality.lens_tables = LensTables::Always;
    renderer.scene.hole.spin = 0.9;
    let mut bytes = |eyes: &[f64]| {
        made(&mut renderer, eyes);
        renderer.stats().device_bytes
    };
    let four = [0.0, 1.0, 2.0, 3.0];
    // Everyday as many as show that one more than four is not kept, by more than the slack.
    let (rounds, eyes) = if runs_all() { (3, 9) } else { (2, 6) };
    bytes(&[0.0]);
    bytes(&four.repeat(rounds));
    let held = bytes(&four);
    let many = (0..eyes).map(f64::from).collect::<Vec<_>>();
    assert!(bytes(&many.repeat(rounds)) <= held + held / 10, "{held}");
}

/// Near the hole, which is to the left of the middle.
fn all_round(eye: Eye, eye_distance: f64) -> Camera {
    Camera {
        projection: Projection::Equirect,
        position: DVec3::new(11.0, 3.0, 2.5),
        forward: DVec3::new(-0.7, 0.7, -0.1),
        eye,
        eye_distance,
        ..Camera::plain()
    }
}

const SIZE: [u32; 2] = [144, 72];

fn shown(renderer: &mut Renderer, camera: Camera, region: Option<Region>) -> Vec<u8> {
    renderer.scene.camera = camera;
    let size = if region.is_some() { [1, SIZE[1]] } else { SIZE };
    picture(renderer, PixelFormat::Rgba8Srgb, size, region, false)
}

/// Columns of a stereo picture against columns of ordinary ones from exactly where the eye is.
#[test]
#[ignore = "in tests/run all; everyday: eyes are beside the place (scene::eyes), jobs show what images show"]
fn columns_are_seen_from_their_eyes() {
    let mut pictures = Vec::new();
    for (tracer, mut renderer) in both() {
        // The grid is smooth, and its lines are of constant width.
        renderer.scene.sky.flags = Sky::GRID;
        renderer.scene.hole.spin = 0.6;
        for (eye, distance) in [(Eye::Left, 2.0), (Eye::Right, 0.15)] {
            let stereo = all_round(eye, distance);
            let whole = shown(&mut renderer, stereo, None);
            let mut wrong = 0;
            for x in (0..SIZE[0]).step_by(9) {
                let longitude = TAU * ((f64::from(x) + 0.5) / f64::from(SIZE[0]) - 0.5);
                let region = Region { full_width: SIZE[0], full_height: SIZE[1], x, y: 0 };
                let column = shown(&mut renderer, stereo.eye_towards(longitude).unwrap(), Some(region));
                let ours = whole.chunks_exact(4).skip(x as usize).step_by(SIZE[0] as usize).flatten().copied();
                let ours = ours.collect::<Vec<_>>();
                // A tenth of a pixel may be a step or two of an edge.
                let far = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 40;
                wrong += ours.iter().zip(&column).filter(|pair| far(*pair)).count();
                // Rays are those of the pixels, which are seen from the middle of their strip.
                renderer.scene.camera = stereo.strips(&region, 1).unwrap()[0].camera;
                let ray = { &renderer.scene }.camera_ray(1, SIZE[1], Some(region), 0.5, 9.0).unwrap();
                renderer.scene.camera = stereo;
                let own = renderer.scene.camera_ray(1, SIZE[1], Some(region), 0.5, 9.0).unwrap();
                assert!(own.position.abs_diff_eq(ray.position, 1e-12) && own.direction == ray.direction);
            }
            println!("{tracer}, {eye:?}: {wrong} values differ");
            assert!(wrong <= 8, "{tracer}, {eye:?}: {wrong} values differ");
            renderer.scene.camera = stereo;
            let tiles = tiled(&mut renderer, PixelFormat::Rgba8Srgb, SIZE);
            assert_eq!(differing(&tiles, &whole), 0, "{tracer}, {eye:?}: tiles");
            let mono = shown(&mut renderer, all_round(Eye::Middle, distance), None);
            assert!(mono == shown(&mut renderer, all_round(eye, 0.0), None) && differing(&mono, &whole) > 50);
            pictures.push(whole);
        }
    }
    for (cpu, gpu) in pictures.iter().zip(&pictures[2..]) {
        let wrong = differing(cpu, gpu);
        assert!(wrong <= 60, "{wrong} pixels of the tracers differ");
    }
}

/// A job of a stereo picture is made strip by strip, too; and glare has no frame to come from.
#[test]
fn jobs_show_what_images_show() {
    for (tracer, mut renderer) in both() {
        renderer.scene.camera = all_round(Eye::Left, 1.0);
        renderer.prepare(PixelFormat::Rgba8Srgb, SIZE, false, None, &mut |_| true).unwrap();
        let whole = shown(&mut renderer, all_round(Eye::Left, 1.0), None);
        let mut pixels = vec![0; whole.len()];
        let layout = Layout::packed(PixelFormat::Rgba8Srgb, SIZE[0], SIZE[1]);
        // SAFETY: the pixels outlive the job, which is waited for.
        let target = unsafe { ImageMut::from_raw(layout, pixels.as_mut_ptr(), pixels.len() as u64) }.unwrap();
        let job = renderer.render_in_background(target, false, None).unwrap();
        job.wait(None, &mut |_| true).expect("an end").unwrap();
        drop(job);
        assert!(pixels == whole, "{tracer}: a job's picture");
        renderer.scene.film.bloom = 0.3;
        renderer.scene.film.glare_is_optional = false;
        let mut image = ImageMut::new(layout, &mut pixels).unwrap();
        let error = renderer.render(&mut image, false, None, &mut |_| true).unwrap_err();
        assert!(error.message.contains("an eye is set"), "{error}");
    }
}
