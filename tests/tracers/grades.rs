// SPDX-License-Identifier: MIT OR Apache-2.0
//! Graded pictures, and those through a LUT: both tracers make them alike, from kernels of their own and from those
//! that serve every film, with glare and without, and the parts of a frame are as the whole. The formulas are tested in
//! src/film.

use crate::frames::{both, gpu, picture};
use bhr::image::{Lut, PixelFormat};
use bhr::scene::{Film, Filmic, Grade, Region, Scene, ToneMap, View};
use std::sync::Arc;

type Change = fn(&mut Scene);

const SIZE: [u32; 2] = [192, 108];

const LOOKS: [(&str, Change); 3] = [
    ("all of the grade", |s| {
        let grade = Grade {
            white_balance: 4500.0,
            tint: 0.2,
            contrast: 1.3,
            saturation: 1.2,
            vignette: 0.8,
            grain: 0.6,
            grain_seed: 1.0,
        };
        s.film = Film { tone_map: ToneMap::None, exposure_ev: -1.0, grade, ..s.film };
    }),
    ("a vignette under FILMIC", |s| {
        let grade = Grade { vignette: 1.0, ..Grade::default() };
        s.film = Film { tone_map: ToneMap::Filmic, exposure_ev: 1.0, grade, ..s.film };
    }),
    ("FILMIC with a long shoulder, glare", |s| {
        let filmic = Filmic { shoulder_strength: 10.0, toe_strength: 0.2, ..Filmic::default() };
        let grade = Grade { saturation: 0.5, ..Grade::default() };
        s.film = Film { tone_map: ToneMap::Filmic, exposure_ev: 3.0, bloom: 1.0, filmic, grade, ..s.film };
    }),
];

/// Pixels with a component that differs by more than this.
fn differing(a: &[u8], b: &[u8], steps: u8) -> usize {
    let pixels = a.chunks_exact(4).zip(b.chunks_exact(4));
    pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > steps)).count()
}

#[test]
fn gpu_and_cpu_pictures_agree() {
    for (name, set) in LOOKS {
        for shares in [false, true] {
            let [cpu, gpu] = both().map(|(_, mut renderer)| {
                set(&mut renderer.scene);
                renderer.scene.quality.shares_kernels = Some(shares);
                picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false)
            });
            let differ = differing(&cpu, &gpu, 2);
            println!("{name}: {differ} pixels differ by more than two steps");
            assert!(differ as f64 <= 1e-3 * f64::from(SIZE[0] * SIZE[1]), "{name}, {shares}: {differ} pixels differ");
        }
    }
}

/// From top to bottom, and each part where it lies.
#[test]
fn parts_of_a_graded_frame_are_as_the_whole() {
    let [width, height] = SIZE;
    let part = [width / 2, height / 2];
    for (tracer, mut renderer) in both() {
        LOOKS[0].1(&mut renderer.scene);
        let whole = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        for [x, y] in [[0, 0], [part[0], 0], [0, part[1]], part] {
            let region = Region { full_width: width, full_height: height, x, y };
            let got = picture(&mut renderer, PixelFormat::Rgba8Srgb, part, Some(region), false);
            let rows = (y..y + part[1]).map(|row| ((row * width + x) * 4) as usize);
            let wanted = rows.flat_map(|at| whole[at..at + (part[0] * 4) as usize].iter().copied());
            let differ = differing(&got, &wanted.collect::<Vec<_>>(), 1);
            assert!(differ * 1000 <= got.len() / 4, "{tracer}: {differ} pixels differ at ({x}, {y})");
        }
    }
}

/// Films with other settings of what is off have the same bytes.
#[test]
fn settings_of_other_tone_maps_change_nothing() {
    let mut renderer = gpu();
    let before = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
    let filmic = Filmic { toe_strength: 1.0, shoulder_strength: 9.0, ..Filmic::default() };
    renderer.scene.film = Film { filmic, ..renderer.scene.film };
    assert_eq!(before, picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false));
}

/// A LUT that turns colours about, lifts black and has no symmetry.
fn lut(side: u32) -> Arc<Lut> {
    let at = |i: u32| i as f32 / (side - 1) as f32;
    let indices = (0..side).flat_map(|b| (0..side).flat_map(move |g| (0..side).map(move |r| [r, g, b])));
    let colour = |[r, g, b]: [f32; 3]| [0.1 + 0.7 * g * g, 0.9 * r, 0.2 + 0.3 * b + 0.5 * r * g];
    let numbers = indices.flat_map(|index| colour(index.map(at))).collect::<Vec<_>>();
    Arc::new(Lut::new(side, numbers.into_iter()).unwrap())
}

const FILMS: [(&str, Change); 4] = [
    ("ACES", |s| s.film = Film { bloom: 0.0, ..s.film }),
    ("half of it, with glare", |s| s.film = Film { bloom: 0.7, lut_strength: 0.5, ..s.film }),
    ("AGX, several samples", |s| {
        s.quality.samples_per_pixel = 2;
        s.film = Film { bloom: 0.0, tone_map: ToneMap::Agx, ..s.film };
    }),
    ("a grade, without a disk", |s| {
        s.disk = None;
        let grade = Grade { saturation: 0.5, vignette: 1.0, ..Grade::default() };
        s.film = Film { bloom: 0.0, tone_map: ToneMap::Filmic, grade, ..s.film };
    }),
];

/// Both tracers, in kernels of their own and in those that serve every film, and in buffers that the host maps.
#[test]
fn luts_are_alike_on_both_tracers() {
    for (name, set) in FILMS {
        for (side, shares) in [(17, false), (65, true)] {
            let [cpu, gpu] = both().map(|(_, mut renderer)| {
                set(&mut renderer.scene);
                renderer.scene.film_lut = Some(lut(side));
                let quality = &mut renderer.scene.quality;
                (quality.shares_kernels, quality.mapped_pixels) = (Some(shares), Some(shares));
                picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false)
            });
            let [one, more] = [1, 2].map(|steps| differing(&cpu, &gpu, steps));
            println!("{name}, {side}: {one} pixels differ by more than one step, {more} by more than two");
            assert!(one as f64 <= 1e-3 * f64::from(SIZE[0] * SIZE[1]), "{name}, {side}: {one} pixels differ");
        }
    }
}

/// A LUT comes, becomes another one, is switched off, and goes: each time pictures are those of a renderer that has
/// shown nothing else. One that changes nothing keeps every code, but for its rounding; without one all is as before.
#[test]
fn luts_come_and_go() {
    for (tracer, mut renderer) in both() {
        let mut shown = |lut: Option<Arc<Lut>>, strength: f64| {
            renderer.scene.film_lut = lut;
            renderer.scene.film.lut_strength = strength;
            picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false)
        };
        let before = shown(None, 1.0);
        let (first, other) = (shown(Some(lut(17)), 1.0), shown(Some(lut(2)), 1.0));
        assert!(differing(&before, &first, 20) * 2 > before.len() / 4, "{tracer}: the LUT is not shown");
        assert!(differing(&first, &other, 2) > 100, "{tracer}: another LUT shows the same");
        assert!(before == shown(Some(lut(2)), 0.0), "{tracer}: a LUT of strength 0");
        assert!(first == shown(Some(lut(17)), 1.0), "{tracer}: the first LUT again");
        let numbers = [0.0_f32, 1.0].into_iter().flat_map(|b| [0.0, 1.0].map(move |g| (g, b)));
        let numbers = numbers.flat_map(|(g, b)| [0.0, g, b, 1.0, g, b]).collect::<Vec<_>>();
        let identity = Arc::new(Lut::new(2, numbers.into_iter()).unwrap());
        assert_eq!(differing(&before, &shown(Some(identity), 1.0), 1), 0, "{tracer}: a LUT that changes nothing");
        assert!(before == shown(None, 1.0), "{tracer}: a LUT that is gone");
        renderer.scene.film_lut = Some(lut(17));
        renderer.scene.view = View::Redshift;
        let view = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        renderer.scene.film_lut = None;
        assert!(view == picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false), "{tracer}: a view");
    }
}
