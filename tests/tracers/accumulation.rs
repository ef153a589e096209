// SPDX-License-Identifier: MIT OR Apache-2.0
//! Accumulated frames: the mean of several frames' light, developed as one frame is. The GPU is whatever adapter comes
//! first; without one the tests fail.

use crate::frames::{both, picture};
use crate::random::runs_all;
use bhr::error::{ErrorKind, Result};
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::Renderer;
use bhr::scene::{
    AutoExposure, Body, Chart, Disk, Effects, Film, HotSpot, Region, Scene, ThinLens, View, Volume, VolumeResolution,
};
use glam::DVec3;

type Change = fn(&mut Scene);

const SIZE: [u32; 2] = [160, 90];

fn end(renderer: &mut Renderer, format: PixelFormat, [width, height]: [u32; 2], transparent: bool) -> Result<Vec<u8>> {
    let mut pixels = vec![0; (width * height) as usize * format.bytes_per_pixel()];
    let mut image = ImageMut::new(Layout::packed(format, width, height), &mut pixels).unwrap();
    renderer.end_accumulation(&mut image, transparent).map(|()| pixels)
}

/// The mean of frames whose times go evenly over a span.
fn blurred(renderer: &mut Renderer, samples: u32, span: f64, format: PixelFormat) -> Vec<u8> {
    let begin = renderer.scene.time;
    renderer.begin_accumulation(SIZE, false).unwrap();
    for sample in 0..samples {
        renderer.scene.time = begin + span * (f64::from(sample) + 0.5) / f64::from(samples);
        renderer.accumulate(1.0, &mut |_| true).unwrap();
    }
    renderer.scene.time = begin;
    end(renderer, format, SIZE, false).unwrap()
}

/// One frame, or the same one several times and with any weight, is the frame as it is rendered at once.
#[test]
#[ignore = "in tests/run all; everyday: light is the weighted mean, and sixteen moments are enough"]
fn equal_frames_are_the_frame() {
    let films: [(&str, Change); 4] = [
        ("glare", |_| ()),
        ("no glare", |s| s.film.bloom = 0.0),
        ("metered", |s| {
            s.film.auto_exposure = AutoExposure { strength: 1.0, ..AutoExposure::default() };
            (s.film.highlights, s.film.grade.vignette) = (0.5, 0.7);
        }),
        ("a beam", |s| (s.film.bloom, s.film.beam_fwhm) = (0.0, 0.1)),
    ];
    for (tracer, mut renderer) in both() {
        for (name, set) in films {
            renderer.scene.film = Film::default();
            set(&mut renderer.scene);
            for transparent in [false, true] {
                let at_once = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, transparent);
                let at_once_ev = renderer.stats().auto_ev;
                renderer.begin_accumulation(SIZE, transparent).unwrap();
                for weight in [1.0, 0.25, 3.0] {
                    renderer.accumulate(weight, &mut |_| true).unwrap();
                }
                let added = end(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, transparent).unwrap();
                let off = at_once.iter().zip(&added).filter(|(a, b)| a.abs_diff(**b) > 1).count();
                assert!(off * 1000 <= added.len(), "{tracer}, {name}, {transparent}: {off} bytes differ");
                assert!((renderer.stats().auto_ev - at_once_ev).abs() < 0.02, "{tracer}, {name}");
            }
        }
        renderer.begin_accumulation(SIZE, false).unwrap();
        renderer.accumulate(0.3, &mut |_| true).unwrap();
        let floats = end(&mut renderer, PixelFormat::Rgba16F, SIZE, false).unwrap();
        let at_once = picture(&mut renderer, PixelFormat::Rgba16F, SIZE, None, false);
        let codes = |bytes: &[u8]| bytes.as_chunks::<2>().0.iter().map(|b| u16::from_le_bytes(*b)).collect::<Vec<_>>();
        let off = codes(&floats).into_iter().zip(codes(&at_once)).filter(|(a, b)| a.abs_diff(*b) > 1).count();
        assert_eq!(off, 0, "{tracer}: halves differ");
    }
}

/// A lens that has the hole in focus blurs its picture little; one that has nearer things in focus blurs it as much as
/// that circle of confusion does, however many places it is seen from.
#[test]
fn a_lens_blurs_what_is_not_in_focus() {
    let floats =
        |bytes: &[u8]| bytes.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect::<Vec<_>>();
    for (tracer, mut renderer) in both() {
        (renderer.scene.sky.flags, renderer.scene.film.bloom) = (0, 0.0);
        let camera = renderer.scene.camera;
        let pinhole = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, false));
        let mut through = |focus: f64, places: u32| {
            let lens = ThinLens { aperture: 1.0, focus, aspect: 16.0 / 9.0 };
            renderer.begin_accumulation(SIZE, false).unwrap();
            for index in 0..places {
                renderer.scene.camera = camera.through_lens(&lens, index, places).unwrap();
                renderer.accumulate(1.0, &mut |_| true).unwrap();
            }
            floats(&end(&mut renderer, PixelFormat::Rgba32F, SIZE, false).unwrap())
        };
        let rms = |a: &[f64], b: &[f64]| {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            (squares / a.len() as f64).sqrt()
        };
        let [sharp, soft] = [camera.position.length(), 6.0].map(|focus| through(focus, 32));
        let again = through(6.0, 64);
        let [off, blurred, noise] = [rms(&sharp, &pinhole), rms(&soft, &pinhole), rms(&soft, &again)];
        println!("{tracer}: in focus {off:.5}, out of focus {blurred:.5}, more places {noise:.5}");
        assert!(off < 0.35 * blurred && blurred > 0.02, "{tracer}: {off} {blurred}");
        assert!(noise < 0.15 * blurred, "{tracer}: {noise} {blurred}");
    }
}

/// The light of a mean is the mean of the lights, by their weights.
#[test]
fn light_is_the_weighted_mean() {
    let floats =
        |bytes: &[u8]| bytes.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect::<Vec<_>>();
    for (tracer, mut renderer) in both() {
        renderer.scene.disk = Some(Disk { turbulence: 1.0, ..Disk::default() });
        let light = |renderer: &mut Renderer, time: f64| {
            renderer.scene.time = time;
            floats(&picture(renderer, PixelFormat::Rgba32F, SIZE, None, false))
        };
        let (one, other) = (light(&mut renderer, 0.0), light(&mut renderer, 40.0));
        renderer.begin_accumulation(SIZE, false).unwrap();
        for (time, weight) in [(0.0, 3.0), (40.0, 1.0)] {
            renderer.scene.time = time;
            renderer.accumulate(weight, &mut |_| true).unwrap();
        }
        let mean = floats(&end(&mut renderer, PixelFormat::Rgba32F, SIZE, false).unwrap());
        for ((mean, one), other) in mean.iter().zip(&one).zip(&other) {
            let wanted = 0.75 * one + 0.25 * other;
            assert!((mean - wanted).abs() <= 1e-5 * wanted.max(1e-6), "{tracer}: {mean}, not {wanted}");
        }
        assert!(one != other, "{tracer}: the disk does not turn");
    }
}

const SPAN: f64 = 16.0;

/// A scene whose matter moves: its name, the change that sets it up, and the largest allowed error, as a share of the
/// change that the motion makes.
type Moving = (&'static str, Change, f64);

const MOVING: [Moving; 8] = [
    ("thin disk", |s| s.disk = Some(Disk { turbulence: 1.0, ..Disk::default() }), 1e-4),
    ("thin disk, spin 0.9", |s| s.hole.spin = 0.9, 1e-4),
    (
        "hot spot",
        |s| {
            s.disk = None;
            s.hot_spots.push(HotSpot { radius: 7.0, azimuth: 1.0, brightness: 30.0, ..HotSpot::default() });
        },
        1e-4,
    ),
    ("hot spot, light without delay", |s| s.effects.0 &= !Effects::LIGHT_DELAY, 1e-4),
    (
        "falling spot, light without delay",
        |s| {
            s.hot_spots.clear();
            s.hot_spots.push(falling());
        },
        0.03,
    ),
    ("falling spot", |s| s.effects.0 |= Effects::LIGHT_DELAY, 0.03),
    (
        "soft disk",
        |s| {
            s.hot_spots.clear();
            s.hole.spin = 0.0;
            s.volumes.push(Volume { turbulence: 1.0, ..Volume::default() });
        },
        0.5,
    ),
    (
        "soft disk, light without delay, half resolution",
        |s| {
            s.effects.0 &= !Effects::LIGHT_DELAY;
            s.quality.volume_resolution = VolumeResolution::Half;
        },
        0.7,
    ),
];

/// One of the plane and one of matter with depth.
const EVERYDAY: [&str; 2] = ["thin disk, spin 0.9", "falling spot, light without delay"];

/// A spot that falls past the hole.
fn falling() -> HotSpot {
    let (position, velocity) = (DVec3::new(9.0, 0.0, 0.0), DVec3::new(-0.1, 0.35, 0.0));
    let body = Body { chart: Chart::Static, position, velocity, time: 0.0 };
    HotSpot { size: 0.6, brightness: 30.0, free: Some(body.falling()), ..HotSpot::default() }
}

fn light_of(renderer: &mut Renderer) -> Vec<f64> {
    let bytes = picture(renderer, PixelFormat::Rgba32F, SIZE, None, false);
    bytes.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect()
}

/// A frame whose samples see matter at the moments of a shutter is the mean of as many frames, but for the filaments of
/// volumes, which are born and fade as at the frame's time; on both tracers alike.
#[test]
fn samples_of_a_frame_see_the_moments_of_a_shutter() {
    let rms = |a: &[f64], b: &[f64]| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        (squares / a.len() as f64).sqrt()
    };
    let seen = both().map(|(tracer, mut renderer)| {
        renderer.scene.sky.flags = 0;
        MOVING.map(|(name, set, most)| {
            set(&mut renderer.scene);
            if !runs_all() && !EVERYDAY.contains(&name) {
                return Vec::new();
            }
            let mean = blurred(&mut renderer, 4, SPAN, PixelFormat::Rgba32F);
            let mean: Vec<f64> = mean.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect();
            renderer.scene.time = 0.5 * SPAN;
            let sharp = light_of(&mut renderer);
            (renderer.scene.shutter, renderer.scene.quality.samples_per_pixel) = (SPAN, 4);
            let soft = light_of(&mut renderer);
            (renderer.scene.shutter, renderer.scene.quality.samples_per_pixel) = (0.0, 1);
            renderer.scene.time = 0.0;
            let [moved, off] = [&sharp, &soft].map(|pixels| rms(pixels, &mean));
            println!("{tracer}, {name}: {moved:.5} without a shutter, {off:.6} with it");
            assert!(moved > 0.001 && off < most * moved, "{tracer}, {name}: {moved} {off}");
            soft
        })
    });
    let [cpu, gpu] = &seen;
    for ((name, ..), (cpu, gpu)) in MOVING.iter().zip(cpu.iter().zip(gpu)) {
        let off = cpu.iter().zip(gpu).filter(|(a, b)| (*a - *b).abs() > 0.02 * a.max(0.01)).count();
        assert!(off * 100 <= cpu.len(), "{name}: {off} of {} numbers differ", cpu.len());
    }
}

/// Views show the frame's time alone, and parts of a frame the moments of the whole.
#[test]
fn a_shutter_leaves_views_alone_and_parts_together() {
    for (tracer, mut renderer) in both() {
        renderer.scene.disk = Some(Disk { turbulence: 1.0, ..Disk::default() });
        renderer.scene.hot_spots.push(HotSpot { radius: 7.0, azimuth: 1.0, brightness: 30.0, ..HotSpot::default() });
        renderer.scene.film.bloom = 0.0;
        renderer.scene.quality.samples_per_pixel = 3;
        for view in [View::Redshift, View::Intensity] {
            renderer.scene.view = view;
            let [closed, open] = [0.0, SPAN].map(|shutter| {
                renderer.scene.shutter = shutter;
                picture(&mut renderer, PixelFormat::R32F, SIZE, None, false)
            });
            assert!(closed == open, "{tracer}: {view:?} is another");
        }
        renderer.scene.view = View::Light;
        let [width, height] = SIZE;
        let whole = picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, false);
        let half = [width / 2, height / 2];
        let region = Region { full_width: width, full_height: height, x: half[0], y: half[1] };
        let part = picture(&mut renderer, PixelFormat::Rgba32F, half, Some(region), false);
        let row = 16 * half[0] as usize;
        for (y, part) in part.chunks_exact(row).enumerate() {
            let begin = 16 * ((half[1] as usize + y) * width as usize + half[0] as usize);
            assert!(part == &whole[begin..begin + row], "{tracer}: row {y} of a part is another");
        }
    }
}

/// Sixteen moments of a turning disk are as smooth as 256 (everyday 64), to a step of 8 bits.
#[test]
fn sixteen_moments_are_enough() {
    let (_, mut renderer) = both().into_iter().next_back().expect("a tracer");
    renderer.scene.disk = Some(Disk { turbulence: 1.0, ..Disk::default() });
    let fine = if runs_all() { 256 } else { 64 };
    let [few, many, one] = [16, fine, 1].map(|samples| blurred(&mut renderer, samples, 12.0, PixelFormat::Rgba8Srgb));
    let rms = |a: &[u8], b: &[u8]| {
        let squares = a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum::<f64>();
        (squares / a.len() as f64).sqrt()
    };
    println!("rms: 16 against {fine} {:.3}, 1 against {fine} {:.3}", rms(&few, &many), rms(&one, &many));
    assert!(rms(&few, &many) < 1.0, "rms {}", rms(&few, &many));
    assert!(rms(&one, &many) > 2.0 * rms(&few, &many), "nothing moves");
}

/// Whatever goes wrong, the frames that were added are there afterwards.
#[test]
fn mistakes_change_nothing() {
    for (tracer, mut renderer) in both() {
        let kind = |result: Result<()>| result.expect_err(tracer).kind;
        assert_eq!(kind(renderer.accumulate(1.0, &mut |_| true)), ErrorKind::InvalidState);
        assert_eq!(kind(end(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, false).map(|_| ())), ErrorKind::InvalidState);
        assert_eq!(kind(renderer.begin_accumulation([0, 9], false)), ErrorKind::InvalidArgument);
        renderer.begin_accumulation(SIZE, false).unwrap();
        assert_eq!(kind(end(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, false).map(|_| ())), ErrorKind::InvalidState);
        renderer.accumulate(1.0, &mut |_| true).unwrap();
        for weight in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e7] {
            assert_eq!(kind(renderer.accumulate(weight, &mut |_| true)), ErrorKind::InvalidArgument, "{weight}");
        }
        // Frames of many samples ask several times whether they are to go on, on fast devices as well, which take some
        // twenty samples at a time.
        renderer.scene.quality.samples_per_pixel = 64;
        let mut calls = 0;
        let cancelled = renderer.accumulate(1.0, &mut |_| {
            calls += 1;
            calls < 2
        });
        assert_eq!(kind(cancelled), ErrorKind::Cancelled);
        renderer.scene.quality.samples_per_pixel = 1;
        for (format, size, transparent) in [
            (PixelFormat::R32F, SIZE, false),
            (PixelFormat::Rgba8Srgb, [SIZE[0], SIZE[1] + 1], false),
            (PixelFormat::Rgba8Srgb, SIZE, true),
        ] {
            let wrong = end(&mut renderer, format, size, transparent).map(|_| ());
            assert_eq!(kind(wrong), ErrorKind::InvalidArgument, "{format} {size:?}");
        }
        let kept = end(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, false).unwrap();
        let at_once = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        let off = kept.iter().zip(&at_once).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        assert!(off * 1000 <= kept.len(), "{tracer}: {off} bytes differ after mistakes");
        renderer.begin_accumulation(SIZE, false).unwrap();
        renderer.drop_accumulation();
        assert_eq!(kind(renderer.accumulate(1.0, &mut |_| true)), ErrorKind::InvalidState);
    }
}
