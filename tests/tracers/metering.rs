// SPDX-License-Identifier: MIT OR Apache-2.0
//! Metered pictures: auto exposure and local tone mapping, on both tracers. What is measured, and how it changes light,
//! is tested in src/film/metering.rs. The GPU is whatever adapter comes first; without one the tests fail.

use crate::frames::{both, picture};
use crate::random::runs_all;
use bhr::error::ErrorKind;
use bhr::image::{ImageMut, ImageRef, PixelFormat, memory::Layout};
use bhr::renderer::Renderer;
use bhr::scene::{AutoExposure, Film, Region, Scene, Sky, ToneMap};
use bhr::sky::SkyMap;
use std::sync::Arc;

type Change = fn(&mut Scene);

const ON: AutoExposure =
    AutoExposure { strength: 1.0, percentile: 90.0, target: 0.5, least_ev: -20.0, most_ev: 20.0, adaptation: 1.0 };

const SCENES: [(&str, Change); 6] = [
    ("auto exposure with glare", |s| s.film.auto_exposure = ON),
    ("auto exposure without, by the median", |s| {
        let auto_exposure = AutoExposure { percentile: 50.0, target: 0.18, ..ON };
        s.film = Film { bloom: 0.0, auto_exposure, ..s.film };
    }),
    ("highlights and shadows", |s| (s.film.highlights, s.film.shadows, s.film.exposure_ev) = (0.6, 0.4, 3.0)),
    ("all of it, six stops too bright, spin 0.9", |s| {
        s.film = Film { auto_exposure: ON, highlights: 0.5, shadows: 0.5, exposure_ev: 6.0, ..s.film };
        (s.hole.spin, s.film.tone_map) = (0.9, ToneMap::Agx);
    }),
    ("a beam, shadows", |s| (s.film.beam_fwhm, s.film.shadows) = (0.05, 0.5)),
    ("the sky alone", |s| (s.disk, s.film.auto_exposure) = (None, AutoExposure { percentile: 99.0, ..ON })),
];

/// The picture, and the stops that auto exposure added.
fn metered(renderer: &mut Renderer, size: [u32; 2]) -> (Vec<u8>, f64) {
    let pixels = picture(renderer, PixelFormat::Rgba8Srgb, size, None, false);
    (pixels, renderer.stats().auto_ev)
}

#[test]
fn gpu_and_cpu_pictures_agree() {
    for (i, size) in [[192, 108], [401, 223]].into_iter().enumerate() {
        for (j, (name, set)) in SCENES.into_iter().enumerate() {
            // Everyday each scene in one size.
            if !runs_all() && (i + j) % 2 == 1 {
                continue;
            }
            let [(cpu, cpu_ev), (gpu, gpu_ev)] = both().map(|(_, mut renderer)| {
                set(&mut renderer.scene);
                metered(&mut renderer, size)
            });
            let pixels = cpu.chunks_exact(4).zip(gpu.chunks_exact(4));
            let differ = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2)).count();
            println!("{name}, {size:?}: {cpu_ev} and {gpu_ev} EV, {differ} pixels differ by more than two steps");
            assert!((cpu_ev - gpu_ev).abs() < 0.02, "{name}: {cpu_ev} EV on the CPU, {gpu_ev} on the GPU");
            assert!(differ as f64 <= 2e-3 * f64::from(size[0] * size[1]), "{name}, {size:?}: {differ} pixels differ");
        }
    }
}

/// Auto exposure makes one picture of scenes that are lit by different light, and says how much it added.
#[test]
fn exposure_does_not_depend_on_the_light() {
    for (tracer, mut renderer) in both() {
        renderer.scene.film.auto_exposure = ON;
        let (before, ev) = metered(&mut renderer, [192, 108]);
        renderer.scene.film.exposure_ev = -3.0;
        let (after, dark_ev) = metered(&mut renderer, [192, 108]);
        assert!((dark_ev - ev - 3.0).abs() < 0.01, "{tracer}: {ev} EV, and {dark_ev} three stops darker");
        let differ = before.iter().zip(&after).filter(|(a, b)| a.abs_diff(**b) > 2).count();
        assert!(differ * 500 < before.len(), "{tracer}: {differ} of {} bytes differ", before.len());
    }
}

/// Frames of one size come nearer by shares; another size begins anew, and so does a film that is metered again after
/// what is measured has changed.
#[test]
fn exposure_adapts_from_frame_to_frame() {
    for (tracer, mut renderer) in both() {
        renderer.scene.film.auto_exposure = AutoExposure { adaptation: 0.5, ..ON };
        // The renderer may have metered for another test, and would adapt from that; another size begins anew.
        metered(&mut renderer, [64, 36]);
        let (_, at_once) = metered(&mut renderer, [192, 108]);
        renderer.scene.film.exposure_ev = 4.0;
        for frame in 1..6 {
            let (_, ev) = metered(&mut renderer, [192, 108]);
            let wanted = at_once - 4.0 * (1.0 - 0.5_f64.powi(frame));
            assert!((ev - wanted).abs() < 0.02, "{tracer}, frame {frame}: {ev} EV, not {wanted}");
        }
        let (_, other) = metered(&mut renderer, [96, 54]);
        assert!((other - at_once + 4.0).abs() < 0.3, "{tracer}: {other} EV at another size");
    }
}

/// Pictures are alike whether light is kept or made twice, and by several samples.
#[test]
fn light_that_is_not_kept_is_metered_alike() {
    for (tracer, mut renderer) in both() {
        renderer.scene.film = Film { auto_exposure: ON, highlights: 0.5, shadows: 0.3, ..renderer.scene.film };
        renderer.scene.quality.samples_per_pixel = 2;
        let (kept, ev) = metered(&mut renderer, [192, 108]);
        renderer.scene.quality.keep_light = Some(false);
        let (twice, twice_ev) = metered(&mut renderer, [192, 108]);
        assert!((ev - twice_ev).abs() < 0.01, "{tracer}: {ev} EV, and {twice_ev} where light is made twice");
        let differ = kept.iter().zip(&twice).filter(|(a, b)| a.abs_diff(**b) > 2).count();
        assert!(differ * 1000 < kept.len(), "{tracer}: {differ} bytes differ");
    }
}

/// Black stays black up to the edge of the shadow, and most of what was clipped no longer is.
#[test]
fn the_shadow_has_no_halo() {
    for (tracer, mut renderer) in both() {
        let film = Film { tone_map: ToneMap::None, bloom: 0.0, exposure_ev: 2.0, ..renderer.scene.film };
        renderer.scene.film = film;
        let size = [240, 136];
        let (plain, _) = metered(&mut renderer, size);
        renderer.scene.film = Film { highlights: 0.7, shadows: 0.7, ..film };
        let (local, ev) = metered(&mut renderer, size);
        assert_eq!(ev, 0.0);
        let pixels = || plain.chunks_exact(4).zip(local.chunks_exact(4));
        let light = picture(&mut renderer, PixelFormat::Rgba32F, size, None, false);
        let dark = light.as_chunks::<16>().0.iter().map(|pixel| bytemuck::cast::<_, [f32; 4]>(*pixel)[..3] == [0.0; 3]);
        let dark = dark.zip(local.chunks_exact(4)).filter(|(is_dark, _)| *is_dark).collect::<Vec<_>>();
        let lifted = dark.iter().filter(|(_, local)| local[..3] != [0; 3]).count();
        assert!(dark.len() > 500 && lifted == 0, "{tracer}: {lifted} of {} are lifted", dark.len());
        let white = |pixel: &[u8]| pixel[..3].contains(&255);
        let (burnt, saved) = (pixels().filter(|p| white(p.0)).count(), pixels().filter(|p| white(p.1)).count());
        assert!(burnt > 100 && saved * 3 < burnt, "{tracer}: {burnt} clipped pixels became {saved}");
    }
}

/// No halo, bright or dark, lies about the disk and the shadow: a sky of even brightness stays even, beside a disk a
/// hundred times as bright and beside black.
#[test]
fn a_flat_sky_stays_flat_beside_disk_and_shadow() {
    for (tracer, mut renderer) in both() {
        let texels = [0.02_f32; 4 * 64 * 32];
        let map = ImageRef::new(Layout::packed(PixelFormat::Rgba32F, 64, 32), bytemuck::cast_slice(&texels)).unwrap();
        renderer.scene.sky_map = Some(Arc::new(SkyMap::new(&map).unwrap().into()));
        renderer.scene.sky.flags = Sky::MAP;
        // Without effects the map and the disk show their own light.
        renderer.scene.effects.0 = 0;
        let film = Film { tone_map: ToneMap::None, bloom: 0.0, exposure_ev: 2.0, ..renderer.scene.film };
        renderer.scene.film = Film { highlights: 0.7, shadows: 0.7, ..film };
        let size = [480, 270];
        let (local, _) = metered(&mut renderer, size);
        let light = picture(&mut renderer, PixelFormat::Rgba32F, size, None, false);
        let green = light.as_chunks::<16>().0.iter().map(|pixel| bytemuck::cast::<_, [f32; 4]>(*pixel)[1]);
        let is_sky = |v: f32| (v / 0.02 - 1.0).abs() < 1e-3;
        let mut codes: Vec<u8> =
            green.zip(local.chunks_exact(4)).filter(|(v, _)| is_sky(*v)).map(|(_, pixel)| pixel[1]).collect();
        codes.sort_unstable();
        let at = |share: f64| codes[(share * (codes.len() - 1) as f64) as usize];
        let told = [0.0, 0.01, 0.5, 0.99, 1.0].map(at);
        println!("{tracer}: {} pixels of sky, the darkest, 1 %, median, 99 %, the brightest: {told:?}", codes.len());
        let [darkest, dark, median, _, brightest] = told.map(i32::from);
        let is_flat = median - darkest <= 10 && median - dark <= 3 && brightest - median <= 2;
        assert!(codes.len() > 30_000 && is_flat, "{tracer}: {told:?}");
    }
}

/// Parts of a frame do not know the whole, and floats are not exposed.
#[test]
fn parts_are_refused_and_floats_are_left_alone() {
    for (tracer, mut renderer) in both() {
        renderer.scene.film.bloom = 0.0;
        let plain = picture(&mut renderer, PixelFormat::Rgba32F, [96, 54], None, false);
        let settings: [(&str, Change); 3] = [
            ("auto_exposure", |s| s.film.auto_exposure.strength = 0.5),
            ("highlights", |s| s.film.highlights = 0.5),
            ("shadows", |s| s.film.shadows = 0.5),
        ];
        for (name, set) in settings {
            renderer.scene.film = Film { bloom: 0.0, ..Film::default() };
            set(&mut renderer.scene);
            let region = Some(Region { full_width: 192, full_height: 108, x: 0, y: 0 });
            let mut pixels = vec![0; 96 * 54 * 4];
            let mut image = ImageMut::new(Layout::packed(PixelFormat::Rgba8Srgb, 96, 54), &mut pixels).unwrap();
            let error = renderer.render(&mut image, false, region, &mut |_| true).unwrap_err();
            assert_eq!(error.kind, ErrorKind::InvalidState, "{tracer}: {error}");
            assert!(error.to_string().contains(name), "{tracer}: {error}");
            let floats = picture(&mut renderer, PixelFormat::Rgba32F, [96, 54], None, false);
            assert!(floats == plain && renderer.stats().auto_ev == 0.0, "{tracer}, {name}: floats are changed");
        }
    }
}
