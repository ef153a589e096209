// SPDX-License-Identifier: MIT OR Apache-2.0
//! Graded pictures: both tracers make them alike, from kernels of their own and from those that serve every film, with
//! glare and without, and the parts of a frame are as the whole. The formulas are tested in src/film.

use crate::frames::{both, gpu, picture};
use bhr::image::PixelFormat;
use bhr::scene::{Film, Filmic, Grade, Region, Scene, ToneMap};

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
