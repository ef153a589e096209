// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pipelines are there before a frame needs them: frames list all that they run, `prepare` leaves nothing to wait for,
//! and what is a host's likely next change is made in the background.

use crate::frames::plain;
use crate::random::runs_all;
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{LensTables, Method, Motion, Projection, Scene, ToneMap, View, Volume, VolumeResolution};

const SIZE: [u32; 2] = [96, 64];

fn renderer() -> Renderer {
    let mut renderer = plain(RendererOptions { backend: Some(Backend::Vulkan), ..Default::default() });
    renderer.scene.quality.lens_tables = LensTables::Always;
    renderer
}

fn render(renderer: &mut Renderer, format: PixelFormat) -> Vec<u8> {
    let layout = Layout::packed(format, SIZE[0], SIZE[1]);
    let mut pixels = vec![0; SIZE[0] as usize * SIZE[1] as usize * format.bytes_per_pixel()];
    renderer.render(&mut ImageMut::new(layout, &mut pixels).unwrap(), false, None, &mut |_| true).unwrap();
    pixels
}

/// How many pipelines a window's frame would find missing.
fn missing_in_window(renderer: &Renderer, size: [u32; 2]) -> usize {
    renderer.missing_in_window(size).unwrap().expect("a GPU")
}

/// How many pipelines were missing when frames began, and how many more while they were bound.
fn missing(renderer: &Renderer) -> [u64; 2] {
    let waits = renderer.settled_waits().expect("a GPU");
    [waits.waits, waits.late]
}

type Change = fn(&mut Scene);

/// One of each kind of change that a host can make.
const CHANGES: [Change; 16] = [
    |_| (),
    |scene| scene.hole.spin = 0.9,
    |scene| scene.disk.as_mut().unwrap().turbulence = 1.0,
    |scene| scene.film.bloom = 0.3,
    |scene| scene.quality.samples_per_pixel = 3,
    |scene| scene.film.bloom = 0.0,
    |scene| scene.quality.lens_tables = LensTables::Never,
    |scene| scene.quality.method = Method::Rk4,
    |scene| scene.hole.spin = 0.0,
    |scene| scene.quality.samples_per_pixel = 1,
    |scene| scene.camera.projection = Projection::Fisheye,
    |scene| scene.camera.motion = Motion::FreeFall,
    |scene| scene.view = View::Redshift,
    |scene| scene.disk = None,
    |scene| {
        scene.view = View::Light;
        scene.volumes.push(Volume::default());
    },
    |scene| scene.quality.volume_resolution = VolumeResolution::Half,
];

#[test]
fn frames_list_every_kernel_that_they_run() {
    let mut renderer = renderer();
    // Opening the device makes one by itself.
    let at_first = missing(&renderer)[1];
    // Everyday changes come some at a time: a frame that lists too few kernels for one of them does so for all.
    let everyday = [7, 11, 15];
    let mut frames = 0;
    for (index, change) in CHANGES.iter().enumerate() {
        change(&mut renderer.scene);
        if !runs_all() && !everyday.contains(&index) {
            continue;
        }
        frames += 1;
        // Both ways in `tests/run all`, else in turn: a kernel takes lavapipe a second.
        for mapped in [false, true].into_iter().filter(|mapped| runs_all() || *mapped == (frames % 2 == 0)) {
            renderer.scene.quality.mapped_pixels = Some(mapped);
            render(&mut renderer, PixelFormat::Rgba8Srgb);
            assert_eq!(missing(&renderer)[1], at_first, "change {index}, mapped {mapped}");
        }
    }
}

#[test]
fn after_prepare_frames_wait_for_no_pipeline() {
    let mut renderer = renderer();
    // Hardware makes the default scene's pipelines by itself, and those of its neighbours unless told not to.
    renderer.scene.quality.anticipates = Some(false);
    for (index, change) in CHANGES.iter().enumerate().filter(|(index, _)| [1, 3, 4, 7].contains(index)) {
        change(&mut renderer.scene);
        // Everyday two changes at a time.
        if !runs_all() && [1, 4].contains(&index) {
            continue;
        }
        assert!(missing_in_window(&renderer, SIZE) > 0, "change {index}");
        renderer.prepare(PixelFormat::Rgba8Srgb, SIZE, false, None, &mut |_| true).unwrap();
        assert_eq!(missing_in_window(&renderer, SIZE), 0, "change {index}");
        let before = missing(&renderer);
        render(&mut renderer, PixelFormat::Rgba8Srgb);
        assert_eq!(missing(&renderer), before, "change {index}");
    }
}

/// Small frames trace their rays, large ones look them up: which kernels they run depends on the size that a window's
/// frame is traced at.
#[test]
fn windows_are_prepared_at_the_scale_of_their_quality() {
    const WINDOW: [u32; 2] = [320, 180];
    let mut renderer = renderer();
    renderer.scene.quality.lens_tables = LensTables::Auto;
    renderer.scene.quality.render_scale = 0.1;
    renderer.prepare_window(WINDOW, &mut |_| true).unwrap();
    assert_eq!(missing_in_window(&renderer, WINDOW), 0);
    renderer.scene.quality.render_scale = 1.0;
    assert!(missing_in_window(&renderer, WINDOW) > 0, "the scale does not matter, so nothing was tested");
    // An image is not scaled, a window of its size is.
    renderer.scene.quality.render_scale = 0.1;
    renderer.scene.camera.motion = Motion::FreeFall;
    renderer.prepare(PixelFormat::Rgba8Srgb, WINDOW, false, None, &mut |_| true).unwrap();
    assert_eq!(missing_in_window(&renderer, WINDOW), 0);
    // A cube is as large as the window holds it.
    renderer.scene.camera.projection = Projection::Cube;
    renderer.prepare_window(WINDOW, &mut |_| true).unwrap();
    assert_eq!(missing_in_window(&renderer, WINDOW), 0);
}

#[test]
fn what_a_host_changes_next_is_made_in_the_background() {
    // One renderer each for formats, for films, and for scenes, as a software driver keeps few kernels. Everyday one
    // that goes to another format and back, with another film.
    next_frames(&[
        (|scene| scene.film.tone_map = ToneMap::Agx, PixelFormat::Rgba16F),
        (|_| (), PixelFormat::Rgba8Srgb),
        (|scene| scene.film.grade.saturation = 0.5, PixelFormat::Rgba8Srgb),
    ]);
    if !runs_all() {
        return;
    }
    let formats = [PixelFormat::Bgra8Srgb, PixelFormat::Rgba16F, PixelFormat::Rgba32F];
    next_frames(&formats.map(|format| -> (Change, _) { (|_| (), format) }));
    next_frames(&[(|_| (), PixelFormat::Rgba16F), (|_| (), PixelFormat::Rgba8Srgb)]);
    let scenes: [Change; 3] = [CHANGES[1], CHANGES[3], |scene| scene.view = View::Order];
    next_frames(&scenes.map(|change| (change, PixelFormat::Rgba8Srgb)));
}

/// Demands that frames after these changes to a first frame in RGBA8 wait for no pipeline.
fn next_frames(changes: &[(Change, PixelFormat)]) {
    let mut renderer = renderer();
    // These are the settings for hardware.
    let quality = &mut renderer.scene.quality;
    (quality.anticipates, quality.shares_kernels) = (Some(true), Some(true));
    render(&mut renderer, PixelFormat::Rgba8Srgb);
    let before = missing(&renderer);
    for (change, format) in changes {
        change(&mut renderer.scene);
        render(&mut renderer, *format);
        assert_eq!(missing(&renderer), before, "{format:?}");
    }
}

/// By how many steps of the format the values of pixels differ at most; for 32-bit floats, by how many of 16-bit ones'
/// at that size, 2^-10 of it.
fn steps_apart(format: PixelFormat, own: &[u8], any: &[u8]) -> f64 {
    let pairs = |size: usize| own.chunks_exact(size).zip(any.chunks_exact(size));
    let half = |bytes: &[u8]| f64::from(u16::from_le_bytes([bytes[0], bytes[1]]));
    let float = |bytes: &[u8]| f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    let apart = |a: f64, b: f64| match a == b || (a.is_nan() && b.is_nan()) {
        true => 0.0,
        false if a.is_finite() && b.is_finite() => (a - b).abs(),
        false => f64::INFINITY,
    };
    match format {
        PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb => {
            pairs(1).map(|(a, b)| apart(a[0].into(), b[0].into())).fold(0.0, f64::max)
        }
        PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => {
            let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
            let channel = |word: u32, low: u32| f64::from(word >> low & 1023);
            let apart = |a: u32, b: u32| [0, 10, 20, 30].map(|low| (channel(a, low) - channel(b, low)).abs());
            pairs(4).flat_map(|(a, b)| apart(word(a), word(b))).fold(0.0, f64::max)
        }
        PixelFormat::Rgba16F => pairs(2).map(|(a, b)| apart(half(a), half(b))).fold(0.0, f64::max),
        PixelFormat::Rgba32F | PixelFormat::R32F => {
            let relative = |a: f64, b: f64| 1024.0 * apart(a, b) / (a.abs().max(b.abs()) + 1e-4).min(f64::MAX);
            pairs(4).map(|(a, b)| relative(float(a), float(b))).fold(0.0, f64::max)
        }
    }
}

/// On hardware one kernel serves all films and projections but the usual ones; on software drivers each has its own.
/// Their pixels are the same, but for what a driver's compiler rounds otherwise in another kernel: NVIDIA's joins
/// multiplications with additions where it likes.
#[test]
#[ignore = "in tests/run all; everyday: each film's and projection's own kernel, which software drivers take"]
fn a_kernel_for_any_film_and_projection_puts_the_same_pixels() {
    let mut renderer = renderer();
    let exactly = renderer.adapter().software;
    let mut compared = 0;
    let mut compare = |scene: Change, format| {
        scene(&mut renderer.scene);
        compared += 1;
        // Every second one everyday: a pair of kernels takes lavapipe two seconds.
        if !runs_all() && compared % 2 == 0 {
            return;
        }
        let [own, any] = [false, true].map(|any| {
            renderer.scene.quality.shares_kernels = Some(any);
            render(&mut renderer, format)
        });
        let scene = &renderer.scene;
        let (steps, differ) = (steps_apart(format, &own, &any), own.iter().zip(&any).filter(|(a, b)| a != b).count());
        let name = format!("{format:?}, {:?}, {:?}", scene.film.tone_map, scene.view);
        println!("{name}, {:?}: {differ} bytes differ, by {steps} steps", scene.camera.projection);
        // Floats of 32 bits differ in their last bits wherever a compiler rounds otherwise.
        let few =
            differ * 500 <= own.len() || (matches!(format, PixelFormat::Rgba32F | PixelFormat::R32F) && steps < 1.0);
        let good = if exactly { differ == 0 } else { steps <= 8.0 && few };
        assert!(good, "{name}, {:?}: {differ} bytes differ, by {steps} steps", scene.camera.projection);
    };
    compare(|scene| scene.film.tone_map = ToneMap::Agx, PixelFormat::Bgra8Srgb);
    compare(|scene| scene.film.tone_map = ToneMap::Filmic, PixelFormat::Rgba8Srgb);
    compare(|scene| scene.film.grade.contrast = 1.5, PixelFormat::Rgba8Srgb);
    compare(|scene| scene.film.tone_map = ToneMap::None, PixelFormat::Rgba8Srgb);
    for mapped in [
        |scene: &mut Scene| scene.quality.mapped_pixels = Some(false),
        |scene: &mut Scene| {
            scene.quality.mapped_pixels = Some(true);
        },
    ] {
        compare(mapped, PixelFormat::Rgba16F);
        compare(mapped, PixelFormat::Rgba32F);
    }
    compare(|scene| scene.camera.projection = Projection::Fisheye, PixelFormat::Rgba8Srgb);
    compare(|scene| scene.camera.projection = Projection::Equirect, PixelFormat::Rgba16F);
    compare(|scene| scene.hole.spin = 0.5, PixelFormat::Rgba8Srgb);
    compare(|scene| scene.quality.lens_tables = LensTables::Never, PixelFormat::Rgba8Srgb);
    compare(|scene| scene.film.bloom = 0.3, PixelFormat::Rgba8Srgb);
    compare(|scene| scene.view = View::Redshift, PixelFormat::Rgba8Srgb);
    compare(|scene| scene.view = View::Order, PixelFormat::R32F);
    compare(|scene| scene.quality.mapped_pixels = Some(false), PixelFormat::R32F);
    compare(|scene| scene.camera.projection = Projection::Perspective, PixelFormat::R32F);
}
