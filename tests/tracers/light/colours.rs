// SPDX-License-Identifier: MIT OR Apache-2.0
//! The colour of a ring at rest, through pictures: against the CIE's, as linear light and through the 8-bit encoding.

use super::{both, bytes, camera, floats, light, luminance, whole};
use bhr::film::dither;
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{Disk, Effects, Film, ToneMap};

/// Temperature and chromaticity x, y of the Planckian locus, CIE 1931, 2 degrees (colour-science 0.4.7, 1 nm).
const LOCUS: [(f64, f64, f64); 3] =
    [(3000.0, 0.4369311, 0.4040740), (5800.0, 0.3259827, 0.3353191), (10000.0, 0.2806336, 0.2882878)];

/// From the axis, far away, without any effect of motion or gravity on light: the hottest ring has its own colour.
fn set_scene(renderer: &mut Renderer, temperature: f64) {
    renderer.scene.camera = camera(500.0, 0.0, 44.0);
    renderer.scene.effects = Effects(0);
    renderer.scene.disk = Some(Disk { temperature, ..Disk::plain() });
    renderer.scene.film = Film { tone_map: ToneMap::None, exposure_ev: -1.5, ..Film::plain() };
}

/// CIE XYZ of linear Rec. 709: the primaries' matrix (ITU-R BT.709).
fn xyz([r, g, b]: [f64; 3]) -> [f64; 3] {
    [
        0.412390799 * r + 0.357584339 * g + 0.180480788 * b,
        luminance([r, g, b]),
        0.019330819 * r + 0.119194780 * g + 0.950532152 * b,
    ]
}

/// CIELAB under D65 of light whose luminance is 1 where white's is.
fn lab(xyz: [f64; 3]) -> [f64; 3] {
    let white = [0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290];
    let [x, y, z] = [0, 1, 2].map(|i| {
        let t: f64 = xyz[i] / white[i];
        if t > (6.0_f64 / 29.0).powi(3) { t.cbrt() } else { t * 841.0 / 108.0 + 16.0 / 116.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// CIE 1976, of a colour of luminance 1 and the locus.
fn difference(rgb: [f64; 3], (_, x, y): (f64, f64, f64)) -> f64 {
    let expected = lab([x / y, 1.0, (1.0 - x - y) / y]);
    let found = lab(xyz(rgb));
    (0..3).map(|i| (found[i] - expected[i]).powi(2)).sum::<f64>().sqrt()
}

fn mean<const N: usize>(values: &[[f64; N]]) -> [f64; N] {
    std::array::from_fn(|i| values.iter().map(|v| v[i]).sum::<f64>() / values.len() as f64)
}

/// The brightest pixels: of the hottest ring, at its temperature to 1e-4. Its luminance is 1.
fn ring(light: &[[f64; 3]]) -> Vec<usize> {
    let most = light.iter().map(|rgb| luminance(*rgb)).fold(0.0, f64::max);
    assert!((most - 1.0).abs() < 2e-3, "the hottest ring's luminance is {most}");
    (0..light.len()).filter(|k| luminance(light[*k]) > 0.999).collect()
}

#[test]
fn rings_have_the_colours_of_the_planckian_locus() {
    let size = [200, 200];
    for locus in LOCUS {
        for (tracer, mut renderer) in both() {
            set_scene(&mut renderer, locus.0);
            let light = light(&mut renderer, size, whole(size));
            let ring = ring(&light);
            assert!(ring.len() > 100, "{tracer}: {} pixels at {} K", ring.len(), locus.0);
            for k in &ring {
                let difference = difference(light[*k], locus);
                assert!(difference < 0.2, "{tracer}: {} K: {:?}, dE {difference}", locus.0, light[*k]);
            }
            // The light after exposure, encoding, dither and rounding, decoded and averaged.
            let pixels = bytes(&mut renderer, PixelFormat::Rgba8Srgb, size, whole(size));
            let decoded: Vec<[f64; 3]> = ring
                .iter()
                .map(|k| [0, 1, 2].map(|c| decode(f64::from(pixels[4 * k + c]) / 255.0) * 1.5_f64.exp2()))
                .collect();
            let difference = difference(mean(&decoded), locus);
            println!("{tracer}: {} K: 8-bit dE {difference:.3}", locus.0);
            assert!(difference < 0.5, "{tracer}: {} K in 8 bits: dE {difference}", locus.0);
        }
    }
}

/// IEC 61966-2-1.
fn decode(code: f64) -> f64 {
    if code <= 0.04045 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

fn encode(linear: f64) -> f64 {
    if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Every code is 255 times the sRGB curve of the exposed linear light, plus the dither, rounded down. Where that lies
/// within 1e-3 of a whole number either one is right.
#[test]
fn codes_are_the_srgb_curve_of_the_light() {
    let size = [160, 90];
    for (tracer, mut renderer) in both() {
        set_scene(&mut renderer, 4500.0);
        renderer.scene.effects = Effects(Effects::ALL);
        renderer.scene.camera = camera(30.0, 70.0, 40.0);
        let linear = floats(&bytes(&mut renderer, PixelFormat::Rgba32F, size, whole(size)));
        let codes = bytes(&mut renderer, PixelFormat::Rgba8Srgb, size, whole(size));
        let mut grey = 0;
        for (k, (value, code)) in linear.iter().zip(&codes).enumerate().filter(|(k, _)| k % 4 < 3) {
            let (x, y) = ((k / 4) as u32 % size[0], (k / 4) as u32 / size[0]);
            let exact = 255.0 * encode((value * (-1.5_f64).exp2()).min(1.0)) + f64::from(dither(x, y));
            let allowed = [exact - 1e-3, exact + 1e-3].map(f64::floor);
            let near = allowed[0] <= f64::from(*code) && f64::from(*code) <= allowed[1];
            assert!(near, "{tracer}: ({x}, {y}): {value} is {code}, not {exact}");
            grey += u32::from((1..255).contains(code));
        }
        assert!(grey > 5000, "{tracer}: {grey} codes between black and white");
    }
}
