// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bloom in pictures, on both tracers: no light lost, no tile seen, nothing changed where none was asked for. Its
//! shape is tested in src/film/bloom.rs. The GPU is whatever adapter comes first; without one the tests fail.

use crate::frames::{both, new_gpu, plain};
use crate::random::runs_all;
use bhr::error::ErrorKind;
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{Camera, ColourMap, Optics, Region, Scene, ToneMap, View};

type Change = fn(&mut Scene);

fn try_picture(
    renderer: &mut Renderer,
    format: PixelFormat,
    size: [u32; 2],
    region: Option<Region>,
    transparent: bool,
) -> bhr::error::Result<Vec<u8>> {
    let mut pixels = vec![0; (size[0] * size[1]) as usize * format.bytes_per_pixel()];
    let mut image = ImageMut::new(Layout::packed(format, size[0], size[1]), &mut pixels).unwrap();
    renderer.render(&mut image, transparent, region, &mut |_| true).map(|()| pixels)
}

fn picture(renderer: &mut Renderer, format: PixelFormat, size: [u32; 2]) -> Vec<u8> {
    try_picture(renderer, format, size, None, false).unwrap()
}

fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> + '_ {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()))
}

const SCENES: [(&str, Change); 10] = [
    ("default", |_| ()),
    ("three stops more, spin 0.9, AgX", |s| {
        (s.hole.spin, s.film.exposure_ev, s.film.tone_map) = (0.9, 3.0, ToneMap::Agx);
    }),
    ("stars alone, bright", |s| {
        (s.disk, s.film.exposure_ev) = (None, 8.0);
    }),
    ("a beam", |s| s.film.beam_fwhm = 0.1),
    ("a beam of a few pixels, in one colour map", |s| {
        (s.film.beam_fwhm, s.film.tone_map, s.film.colour_map) = (0.025, ToneMap::None, ColourMap::Afmhot);
    }),
    ("spikes", |s| s.film.optics = Optics { spikes: 1.0, spike_blades: 5, spike_angle: 0.3, ..Optics::default() }),
    ("spikes and a streak, metered, spin 0.9", |s| {
        (s.hole.spin, s.film.auto_exposure.strength, s.film.highlights) = (0.9, 1.0, 0.5);
        s.film.optics = Optics { spikes: 0.5, streak: 1.0, streak_tint: 0.7, ..Optics::default() };
    }),
    ("a flare, stars alone", |s| {
        (s.disk, s.film.exposure_ev) = (None, 8.0);
        s.film.optics = Optics { flare: 1.0, flare_ghosts: 8, spike_blades: 3, spike_angle: 0.3, ..Optics::default() };
    }),
    ("a flare, a streak and a beam", |s| {
        (s.film.exposure_ev, s.film.beam_fwhm) = (2.0, 0.05);
        s.film.optics = Optics { flare: 1.0, streak: 0.5, ..Optics::default() };
    }),
    ("several samples, turbulent, translucent", |s| {
        s.quality.samples_per_pixel = 3;
        s.disk.iter_mut().for_each(|d| (d.turbulence, d.opacity) = (1.0, 0.6));
    }),
];

#[test]
fn gpu_and_cpu_pictures_agree() {
    for (i, size) in [[192, 108], [401, 223]].into_iter().enumerate() {
        for (j, (name, set)) in SCENES.into_iter().enumerate() {
            // Everyday each scene in one size.
            if !runs_all() && (i + j) % 2 == 1 {
                continue;
            }
            let [cpu, gpu] = both().map(|(_, mut renderer)| {
                set(&mut renderer.scene);
                renderer.scene.film.bloom = 1.0;
                picture(&mut renderer, PixelFormat::Rgba8Srgb, size)
            });
            let pixels = cpu.chunks_exact(4).zip(gpu.chunks_exact(4));
            let differ = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
            println!("{name}, {size:?}: {differ} pixels differ by more than one step");
            assert!(differ as f64 <= 1e-3 * f64::from(size[0] * size[1]), "{name}, {size:?}: {differ} pixels differ");
        }
    }
}

/// A cell of the widest frames gathers from 528 x 528 pixels, of which almost all lie beyond a frame of one row.
#[test]
#[ignore = "in tests/run all; everyday: very long frames have bloom"]
fn the_widest_frames_have_their_light() {
    let size = [1 << 20, 1];
    let pictures = both().map(|(_, mut renderer)| {
        (renderer.scene.disk, renderer.scene.film.bloom) = (None, 1.0);
        renderer.scene.film.exposure_ev = 4.0;
        picture(&mut renderer, PixelFormat::Rgba8Srgb, size)
    });
    let sums = pictures.map(|pixels| pixels.iter().map(|v| u64::from(*v)).sum::<u64>() as f64);
    assert!((sums[0] / sums[1] - 1.0).abs() < 0.01, "{sums:?}");
}

/// A frame whose light is kept, against one that is traced twice, tile by tile; then again after other frames.
#[test]
#[ignore = "in tests/run all; everyday: no light is lost on its way to pixels, and both tracers agree"]
fn bytes_do_not_depend_on_how_they_are_made() {
    for (tracer, mut renderer) in both() {
        // Everyday half of the scenes: a kernel takes lavapipe a second.
        for (name, set) in SCENES.into_iter().step_by(if runs_all() { 1 } else { 2 }) {
            for size in [[181, 97], [1, 1], [3, 50]] {
                let mut show = |keep: Option<bool>, mapped: Option<bool>, size| {
                    renderer.scene = Scene::plain();
                    renderer.scene.quality.mapped_pixels = mapped;
                    set(&mut renderer.scene);
                    (renderer.scene.film.bloom, renderer.scene.quality.keep_light) = (0.8, keep);
                    picture(&mut renderer, PixelFormat::Bgra8Srgb, size)
                };
                let kept = show(Some(true), None, size);
                let twice = show(Some(false), None, size);
                assert!(kept == twice, "{tracer}, {name}, {size:?}: kept and made twice");
                // Put by kernels into the host's memory, where they can.
                assert!(kept == show(Some(true), Some(true), size), "{tracer}, {name}, {size:?}: by rows");
                assert!(kept == show(Some(false), Some(true), size), "{tracer}, {name}, {size:?}: twice, by rows");
                show(None, None, [64, 200]);
                assert!(kept == show(None, None, size), "{tracer}, {name}, {size:?}: again");
            }
        }
    }
}

/// OpenGL, of which Mesa's software driver stands for all.
#[test]
#[ignore = "in tests/run all; everyday: both tracers agree about glare, and pictures by OpenGL do without it"]
fn gl_and_cpu_pictures_agree() {
    // Everyday those that have the most in them: what bloom is made of, Vulkan's pictures test in every scene.
    for (name, set) in SCENES.into_iter().enumerate().filter(|(i, _)| runs_all() || [1, 4, 5].contains(i)).map(|s| s.1)
    {
        let [cpu, gl] = [Backend::Cpu, Backend::Gl].map(|backend| {
            let mut renderer = plain(RendererOptions { backend: Some(backend), ..Default::default() });
            set(&mut renderer.scene);
            renderer.scene.film.bloom = 1.0;
            picture(&mut renderer, PixelFormat::Rgba8Srgb, [96, 54])
        });
        let differ = cpu.iter().zip(&gl).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        assert!(differ < 10, "{name}: {differ} bytes differ by more than one step");
    }
}

#[test]
fn float_formats_and_views_know_no_bloom() {
    let size = [96, 54];
    for (tracer, mut renderer) in both() {
        for (format, view) in [
            (PixelFormat::Rgba32F, View::Light),
            (PixelFormat::Rgba16F, View::Light),
            (PixelFormat::R32F, View::Redshift),
            (PixelFormat::Rgba8Srgb, View::Order),
        ] {
            renderer.scene.view = view;
            (renderer.scene.film.bloom, renderer.scene.film.exposure_ev) = (0.0, 0.0);
            let without = picture(&mut renderer, format, size);
            renderer.scene.film.bloom = 1.0;
            assert!(without == picture(&mut renderer, format, size), "{tracer}: {format} of {view:?}");
            if format != PixelFormat::Rgba8Srgb {
                (renderer.scene.film.exposure_ev, renderer.scene.film.tone_map) = (5.0, ToneMap::Agx);
                assert!(without == picture(&mut renderer, format, size), "{tracer}: {format} of {view:?}, exposed");
            }
            let region = Region { full_width: 100, full_height: 60, x: 2, y: 3 };
            try_picture(&mut renderer, format, size, Some(region), false).unwrap();
        }
    }
}

#[test]
fn a_region_has_no_bloom() {
    let size = [96, 54];
    let whole = Region { full_width: size[0], full_height: size[1], x: 0, y: 0 };
    for (tracer, mut renderer) in both() {
        renderer.scene.film.bloom = 0.25;
        for region in [whole, Region { full_width: 200, full_height: 200, x: 7, y: 9 }] {
            let error = try_picture(&mut renderer, PixelFormat::Rgba8Srgb, size, Some(region), false).unwrap_err();
            assert_eq!(error.kind, ErrorKind::InvalidState, "{tracer}");
            assert!(error.message.contains("bloom is 0.25") && error.message.contains("region"), "{error}");
        }
        renderer.scene.film.bloom = 0.0;
        try_picture(&mut renderer, PixelFormat::Rgba8Srgb, size, Some(whole), false).unwrap();
    }
}

/// The pictures are so dark that 8-bit codes are linear in light (below 0.0031), and codes are right on average, thanks
/// to the dither.
#[test]
fn no_light_is_lost_on_its_way_to_pixels() {
    let size = [640, 360];
    for (tracer, mut renderer) in both() {
        renderer.scene.film.tone_map = ToneMap::None;
        // The brightest star would leave the disk too dark.
        renderer.scene.sky.flags = 0;
        let radiance = picture(&mut renderer, PixelFormat::Rgba32F, size);
        let brightest = floats(&radiance).enumerate().filter(|(i, _)| i % 4 != 3).fold(0.0_f32, |a, (_, v)| a.max(v));
        renderer.scene.film.exposure_ev = f64::from(0.003 / brightest).log2();
        let [without, with] = [0.0, 1.0].map(|bloom| {
            renderer.scene.film.bloom = bloom;
            let pixels = picture(&mut renderer, PixelFormat::Rgba8Srgb, size);
            let codes = pixels.chunks_exact(4).flat_map(|p| &p[..3]);
            codes.map(|code| f64::from(*code)).sum::<f64>()
        });
        println!("{tracer}: {without} without bloom, {with} with it");
        assert!(without > 1e5, "{tracer}: too dark a picture");
        assert!((with / without - 1.0).abs() < 1e-3, "{tracer}: {without} became {with}");
    }
}

/// Whatever was rendered before: grids of another size round otherwise.
#[test]
#[ignore = "in tests/run all; everyday: tiles and repetitions have the same bytes"]
fn bytes_do_not_depend_on_larger_frames_before() {
    for (tracer, mut renderer) in both() {
        (renderer.scene.film.bloom, renderer.scene.film.exposure_ev) = (1.0, 1.0);
        let mut at = |size| try_picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false).unwrap();
        let before = at([320, 180]);
        at([1500, 900]);
        assert!(at([320, 180]) == before, "{tracer}");
    }
}

/// Frames whose one side is beyond every device's textures.
#[test]
fn very_long_frames_have_bloom() {
    for (tracer, mut renderer) in both() {
        renderer.scene.film.bloom = 1.0;
        for size in [[40_000, 1], [1, 40_000]] {
            let pixels = try_picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false);
            assert!(pixels.is_ok_and(|p| p.iter().any(|code| *code > 0)), "{tracer} {size:?}");
        }
    }
}

/// Glare is added light; coverage stays what it was.
#[test]
fn transparent_pictures_keep_their_alpha() {
    let size = [192, 108];
    for (tracer, mut renderer) in both() {
        let [without, with] = [0.0, 1.0].map(|bloom| {
            renderer.scene.film.bloom = bloom;
            try_picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, true).unwrap()
        });
        let alpha = |pixels: &[u8]| pixels.chunks_exact(4).map(|p| p[3]).collect::<Vec<_>>();
        // Light that spreads is kept in f16, alpha with it: a fraction may round to the next code.
        assert!(alpha(&without).iter().zip(alpha(&with)).all(|(a, b)| a.abs_diff(b) <= 1), "{tracer}");
        let open = without.chunks_exact(4).zip(with.chunks_exact(4)).filter(|(a, _)| a[3] == 0);
        let glowing = open.clone().filter(|(_, b)| b[0] > 2).count();
        assert!(open.clone().all(|(a, b)| a[0] <= b[0]) && glowing > 500, "{tracer}: glare on {glowing} open pixels");
    }
}

/// Inside a wide disk's picture, and from infinitely bright light, no pixel is spoiled.
#[test]
fn the_brightest_light_stays_in_bounds() {
    for (tracer, mut renderer) in both() {
        renderer.scene.film.bloom = 1.0;
        renderer.scene.disk.iter_mut().for_each(|d| d.brightness = 1e6);
        for exposure in [-20.0, 20.0] {
            renderer.scene.film.exposure_ev = exposure;
            let pixels = picture(&mut renderer, PixelFormat::Rgba8Srgb, [160, 90]);
            let bright = pixels.chunks_exact(4).filter(|p| p[0] > 250).count();
            let expected = if exposure > 0.0 { 160 * 90..=160 * 90 } else { 0..=160 * 90 };
            assert!(expected.contains(&bright), "{tracer}, {exposure} stops: {bright} bright pixels");
            assert!(pixels.chunks_exact(4).all(|p| p[3] == 255));
        }
        renderer.scene.camera = Camera::plain();
    }
}

#[test]
#[ignore = "in tests/run all; everyday: large frames in tests/c"]
fn a_4k_frame_takes_at_most_400_mb() {
    // Everyday the hole whose tables are the larger ones.
    let spins = [0.9, 0.0];
    for spin in spins.into_iter().take(if runs_all() { 2 } else { 1 }) {
        let mut renderer = new_gpu();
        (renderer.scene.hole.spin, renderer.scene.film.bloom) = (spin, 0.5);
        picture(&mut renderer, PixelFormat::Rgba8Srgb, [3840, 2160]);
        let bytes = renderer.stats().device_bytes;
        println!("spin {spin}: {} MB of device memory", bytes / 1_000_000);
        assert!(bytes < 400_000_000, "spin {spin}: {bytes} bytes");
    }
}
