// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bloom: that light is kept and spreads as it should.

use super::*;
use crate::random::runs_all;

type Field = Vec<[f32; 4]>;

fn bloom_of(bloom: f64, beam_fwhm: f64, frame: [u32; 2]) -> Result<Bloom> {
    Bloom::of(&Film { bloom, beam_fwhm, ..Film::plain() }, frame)
}

fn black([width, height]: [u32; 2]) -> Field {
    vec![[0.0; 4]; (width * height) as usize]
}

/// A field with its bloom, gathered in tiles of at most `tile` pixels.
fn bloomed(bloom: &Bloom, light: &Field, tile: [u32; 2]) -> Field {
    let [width, height] = bloom.frame;
    let mut accumulator = bloom.accumulator().expect("a grid");
    for y in (0..height).step_by(tile[1] as usize) {
        for x in (0..width).step_by(tile[0] as usize) {
            let (w, h) = (tile[0].min(width - x), tile[1].min(height - y));
            let row = |row: u32| ((row * width + x) as usize)..((row * width + x + w) as usize);
            accumulator.add([x, y], w, &(y..y + h).flat_map(|y| light[row(y)].to_vec()).collect::<Field>());
        }
    }
    let glare = accumulator.spread().expect("grids");
    let place = |i: usize| (i as u32 % width, i as u32 / width);
    light.iter().enumerate().map(|(i, v)| glare.over(*v, place(i).0, place(i).1)).collect()
}

fn sum(field: &Field) -> f64 {
    field.iter().map(|v| f64::from(v[0])).sum()
}

/// One bright pixel and the light that it gives the others: the field without the light that is left in the pixel.
fn point(bloom: &Bloom, [x, y]: [u32; 2]) -> Field {
    let mut light = black(bloom.frame);
    let at = (y * bloom.frame[0] + x) as usize;
    light[at] = [1e4; 4];
    let mut out = bloomed(bloom, &light, bloom.frame);
    out[at][0] -= 1e4 * bloom.direct;
    out
}

/// Mean of the light at `radius` from a pixel, and its standard deviation over it, each times r^2 / formula.
fn ring(field: &Field, width: u32, [x, y]: [u32; 2], radius: f64, formula: impl Fn(f64) -> f64) -> (f64, f64) {
    let places = field.iter().enumerate().map(|(i, v)| {
        let (dx, dy) = ((i as u32 % width) as f64 - f64::from(x), (i as u32 / width) as f64 - f64::from(y));
        (dx.hypot(dy), f64::from(v[0]))
    });
    let on = places.filter(|(r, _)| (r - radius).abs() < 0.5).map(|(r, v)| v / formula(r)).collect::<Vec<_>>();
    let mean = on.iter().sum::<f64>() / on.len() as f64;
    let variance = on.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / on.len() as f64;
    (mean, variance.sqrt() / mean)
}

#[test]
fn no_light_is_lost_or_made_wherever_it_lies() {
    for frame in [[1, 1], [2, 1], [7, 5], [64, 64], [101, 67], [333, 17], [1, 200], [640, 361]] {
        let bloom = bloom_of(1.0, 0.0, frame).expect("grids");
        let shares = f64::from(bloom.direct) + bloom.levels.iter().map(|l| f64::from(l.weight)).sum::<f64>();
        assert!((shares - 1.0).abs() < 1e-6, "{frame:?}: {shares}");
        let ends = |side: u32| [0, 1, side / 2, side.saturating_sub(3), side.saturating_sub(2), side - 1];
        for (x, y) in ends(frame[0]).into_iter().flat_map(|x| ends(frame[1]).map(move |y| (x, y))) {
            let mut light = black(frame);
            light[(y.min(frame[1] - 1) * frame[0] + x.min(frame[0] - 1)) as usize] = [1000.0; 4];
            let got = sum(&bloomed(&bloom, &light, frame));
            assert!((got - 1000.0).abs() < 0.1, "{frame:?} ({x}, {y}): {got}");
        }
    }
}

#[test]
fn an_even_frame_stays_even() {
    for frame in [[5, 3], [129, 67], [640, 361]] {
        let out = bloomed(
            &bloom_of(1.0, 0.0, frame).expect("grids"),
            &vec![[0.5, 0.25, 2.0, 0.75]; (frame[0] * frame[1]) as usize],
            frame,
        );
        for v in out {
            assert!(
                (0..3).all(|c| (v[c] / [0.5, 0.25, 2.0][c] - 1.0).abs() < 1e-5) && v[3] == 0.75,
                "{frame:?}: {v:?}"
            );
        }
    }
}

#[test]
fn light_falls_as_the_formula_says_and_alike_in_all_directions() {
    // Grids are made from a frame's height alike: the large one, which has larger rings, in `tests/run all`.
    let heights: &[u32] = if runs_all() { &[360, 1080] } else { &[360] };
    for &height in heights {
        let h = f64::from(height);
        let bloom = bloom_of(1.0, 0.0, [height, height]).expect("grids");
        let formula = |r: f64| {
            let q = r * r + (h / 180.0).powi(2);
            q.powf(-1.5) + 28.0 / (h * q)
        };
        for place in [[180, 180], [181, 183], [height / 2 + 4, height / 2 - 7]] {
            let glare = point(&bloom, place);
            let radii = [10.0, 12.0, 16.0, 20.0, 22.0, 30.0, 45.0, 60.0];
            let radii = radii.into_iter().filter(|r| *r <= h / 16.0);
            let rings = radii.map(|r| (r, ring(&glare, height, place, r, formula))).collect::<Vec<_>>();
            let mean = rings.iter().map(|(_, (mean, _))| mean).sum::<f64>() / rings.len() as f64;
            for (r, (ratio, spread)) in &rings {
                println!("{height} {place:?} r {r}: {:.3} of the formula, {:.3} around", ratio / mean, spread);
                assert!((ratio / mean - 1.0).abs() < 0.1 && *spread < 0.05, "{height} {place:?} {r}: {ratio} {spread}");
            }
            let shape = (0..=height / 3).step_by(2).map(|r| ring(&glare, height, place, r.into(), |_| 1.0).0);
            let shape = shape.skip(1).collect::<Vec<_>>();
            assert!(shape.windows(2).all(|pair| pair[1] < pair[0]), "{height} {place:?} rises");
        }
    }
}

/// The glare of a lone light has no edges: along a row its second differences change their sign where a smooth
/// bump's do.
#[test]
fn no_blocks_show() {
    let bloom = bloom_of(1.0, 0.0, [512, 512]).expect("grids");
    let glare = point(&bloom, [257, 251]);
    for y in [251_usize, 280, 330] {
        let row = glare[y * 512..(y + 1) * 512].iter().map(|v| f64::from(v[0])).collect::<Vec<_>>();
        let steps = row.windows(2).map(|p| p[1] - p[0]).collect::<Vec<_>>();
        for (x, pair) in steps.windows(2).enumerate().filter(|(x, _)| x.abs_diff(256) > 8) {
            let nearby = &steps[x.saturating_sub(8)..(x + 8).min(steps.len())];
            let largest = nearby.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            assert!((pair[1] - pair[0]).abs() < 0.45 * largest, "a crease at ({x}, {y}): {pair:?} of {largest}");
        }
    }
}

/// A spot of two pixels' width that moves by sixteenths of a pixel.
#[test]
fn glare_moves_smoothly_with_its_light() {
    let bloom = bloom_of(1.0, 0.0, [256, 256]).expect("grids");
    let frame = |shift: f64| {
        let mut light = black([256, 256]);
        for (i, v) in light.iter_mut().enumerate() {
            let (dx, dy) = ((i % 256) as f64 - 120.0 - shift, (i / 256) as f64 - 131.0);
            *v = [(100.0 * (-0.5 * (dx * dx + dy * dy)).exp()) as f32; 4];
        }
        bloomed(&bloom, &light, [256, 256])
    };
    let mut before = frame(0.0);
    for i in 1..=32 {
        let now = frame(f64::from(i) / 16.0);
        for y in [140, 150, 170] {
            for x in [121_usize, 140, 180] {
                let [a, b] = [&before, &now].map(|f| f64::from(f[y * 256 + x][0]));
                assert!((b / a - 1.0).abs() < 0.02, "step {i} at ({x}, {y}): {a} then {b}");
            }
        }
        before = now;
    }
}

#[test]
fn tiles_do_not_show() {
    let frame = [203, 77];
    let bloom = bloom_of(0.7, 0.0, frame).expect("grids");
    let light = (0..frame[0] * frame[1]).map(|i| [(i * 7919 % 1013) as f32; 4]).collect::<Field>();
    let whole = bloomed(&bloom, &light, frame);
    for tile in [[64, 9], [1, 77], [203, 1], [50, 50]] {
        for (a, b) in whole.iter().zip(bloomed(&bloom, &light, tile)) {
            assert!((a[0] - b[0]).abs() <= 1e-5 * a[0], "{tile:?}: {a:?} {b:?}");
        }
    }
}

/// A coarser finest grid, as frames of more than 2^21 cells have: the same glare, but for what is smaller than its
/// cells.
#[test]
fn the_finest_grid_is_bounded_and_glare_hardly_depends_on_it() {
    for frame in [[3840, 2160], [7680, 4320], [16384, 16384], [1 << 14, 1], [1 << 20, 1], [7, 1 << 20]] {
        let bloom = bloom_of(0.5, 0.0, frame).expect("grids");
        assert!(bloom.levels[0].cells() as u64 <= MOST_CELLS && bloom.factor.is_multiple_of(2), "{frame:?}");
        assert!(bloom.levels[0].size.iter().all(|&side| u64::from(side) <= MOST_SIDE + 2), "{frame:?}");
    }
    let bloom = bloom_of(1.0, 0.0, [7680, 4320]).expect("grids");
    assert_eq!(bloom.factor, 4);
    let light = |w: &Bloom| w.levels.iter().map(|l| l.weight).sum::<f32>();
    assert!((light(&bloom) - light(&bloom_of(1.0, 0.0, [3840, 2160]).expect("grids"))).abs() < 0.002);
}

#[test]
fn no_bloom_where_there_is_none() {
    let mut scene = Scene::plain();
    let shown = |scene: &Scene, format| Bloom::new(scene, format, [64, 64], true).expect("grids").is_some();
    assert!(!shown(&scene, PixelFormat::Rgba8Srgb));
    scene.film.bloom = 0.1;
    assert!(shown(&scene, PixelFormat::Rgba8Srgb) && shown(&scene, PixelFormat::Bgra8Srgb));
    assert!(!shown(&scene, PixelFormat::Rgba16F) && !shown(&scene, PixelFormat::Rgba32F));
    (scene.film.bloom, scene.film.beam_fwhm) = (0.0, 0.01);
    assert!(shown(&scene, PixelFormat::Rgba8Srgb) && !shown(&scene, PixelFormat::Rgba16F));
    scene.view = View::Order;
    assert!(!shown(&scene, PixelFormat::Rgba8Srgb));
}

/// Second moment of a field about a place, per axis, and its sum.
fn moments(field: &Field, width: u32, [x, y]: [u32; 2]) -> (f64, [f64; 2]) {
    let place = |i: usize| [(i as u32 % width) as f64 - f64::from(x), (i as u32 / width) as f64 - f64::from(y)];
    let total = sum(field);
    let moment = |axis: usize| {
        field.iter().enumerate().map(|(i, v)| f64::from(v[0]) * place(i)[axis].powi(2)).sum::<f64>() / total
    };
    (total, [moment(0), moment(1)])
}

/// A lone pixel becomes the Gaussian that the film states, wherever it lies among the cells: its standard deviation is
/// right to 2 %, and its profile to 3 % of the peak from 7 pixels of width on.
#[test]
fn a_beam_is_the_gaussian_that_is_stated() {
    const SIGMA: f64 = 2.354_820_045;
    for (fwhm, half) in [(1.0, 60), (2.0, 60), (3.0, 60), (4.1, 60), (7.0, 60), (13.0, 80), (29.0, 140), (90.0, 400)] {
        let frame = [2 * half + 7; 2];
        let bloom = bloom_of(0.0, fwhm / f64::from(frame[1]), frame).expect("grids");
        let sigma: f64 = fwhm / SIGMA;
        let peak = 1e4 / (std::f64::consts::TAU * sigma * sigma);
        let mut worst = 0.0_f64;
        for place in [[half, half], [half + 1, half + 3], [half - 3, half + 2]] {
            let mut light = black(frame);
            light[(place[1] * frame[0] + place[0]) as usize] = [1e4; 4];
            let out = bloomed(&bloom, &light, frame);
            let (total, moment) = moments(&out, frame[0], place);
            assert!((total / 1e4 - 1.0).abs() < 1e-4, "fwhm {fwhm}: the sum is {total}");
            for moment in moment {
                let width = moment.sqrt() * SIGMA;
                assert!((width / fwhm - 1.0).abs() < 0.02, "fwhm {fwhm} at {place:?}: {width}");
            }
            for (i, value) in out.iter().enumerate() {
                let [dx, dy] = [i as u32 % frame[0], i as u32 / frame[0]]
                    .iter()
                    .zip(place)
                    .map(|(a, b)| f64::from(*a) - f64::from(b))
                    .collect::<Vec<_>>()
                    .try_into()
                    .expect("two");
                let exact = peak * (-0.5 * (dx * dx + dy * dy) / (sigma * sigma)).exp();
                worst = worst.max((f64::from(value[0]) - exact).abs() / peak);
            }
        }
        println!("fwhm {fwhm} pixels: {worst:.4} of the peak, level {}", bloom.beam.as_ref().expect("a beam").level);
        let most = [(6.0, 0.03), (3.0, 0.3)].into_iter().find(|(from, _)| fwhm >= *from);
        assert!(most.is_none_or(|(_, most)| worst < most), "fwhm {fwhm}: {worst} of the peak off");
    }
}

#[test]
fn a_beam_keeps_even_light_and_sums_at_every_border() {
    for (bloom, beam) in [(0.0, 0.02), (0.0, 0.3), (0.0, 1.0), (0.5, 0.1), (1.0, 0.004)] {
        for frame in [[1, 1], [5, 3], [64, 64], [128, 64], [640, 352]] {
            let spread = bloom_of(bloom, beam, frame).expect("grids");
            let even = bloomed(&spread, &vec![[0.5; 4]; (frame[0] * frame[1]) as usize], frame);
            assert!(even.iter().all(|v| (v[0] - 0.5).abs() < 1e-4), "{bloom} {beam} {frame:?}");
            let mut light = black(frame);
            light[0] = [1e4; 4];
            let total = sum(&bloomed(&spread, &light, frame));
            // Cells that reach beyond the frame count as whole ones when they are mirrored.
            let most = if frame[0] < 64 {
                1.0
            } else if beam > 0.1 {
                0.02
            } else {
                1e-3
            };
            assert!((total / 1e4 - 1.0).abs() < most, "{bloom} {beam} {frame:?}: {total}");
        }
    }
}

/// Glare and a beam together are the glare, spread by the beam: wings as far out as the glare's own.
#[test]
fn a_beam_leaves_the_glare_s_wings() {
    let frame = [256, 256];
    let [wide, both] = [0.0, 0.05].map(|beam| point(&bloom_of(1.0, beam, frame).expect("grids"), [128, 128]));
    for x in [170_usize, 185] {
        let [wide, both] = [&wide, &both].map(|field| f64::from(field[128 * 256 + x][0]));
        assert!((both / wide - 1.0).abs() < 0.15, "at {x}: {both} for {wide}");
    }
}
