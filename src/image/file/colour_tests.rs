// SPDX-License-Identifier: MIT OR Apache-2.0
//! The colours that PNG files say they have, with numbers from the standards, and the ones that are written for alpha.

use super::tests::Folder;
use super::*;
use crate::error::{ErrorKind, Result};
use crate::image::{ColourSpace, ImageRef, Layout, PixelFormat};
use ::png::chunk::ChunkType;
use ::png::{BitDepth, ColorType, Encoder, Info};
use std::fs::File;

type Chunks<'a> = &'a [(&'a [u8; 4], &'a [u8])];

/// A picture of one row, with these chunks before its pixels, and a profile.
fn loaded(color: ColorType, depth: BitDepth, raster: &[u8], chunks: Chunks<'_>, profile: &[u8]) -> Result<Loaded> {
    let folder = Folder::new("colours");
    let path = folder.file("a.png");
    let pixel = color.samples() * if depth == BitDepth::Sixteen { 2 } else { 1 };
    let mut info = Info::with_size((raster.len() / pixel) as u32, 1);
    (info.color_type, info.bit_depth) = (color, depth);
    info.icc_profile = (!profile.is_empty()).then(|| profile.into());
    let mut writer = Encoder::with_info(File::create(&path).unwrap(), info).unwrap().write_header().unwrap();
    for (name, data) in chunks {
        writer.write_chunk(ChunkType(**name), data).unwrap();
    }
    writer.write_image_data(raster).unwrap();
    writer.finish().unwrap();
    load(&path)
}

fn floats(loaded: &Loaded) -> &[f32] {
    assert_eq!(loaded.format, PixelFormat::Rgba32F);
    bytemuck::cast_slice(loaded.pixels.as_bytes())
}

/// Red, green and blue of a 16-bit picture of one pixel, whose codes are shares of 65535.
fn light(code: [f64; 3], chunks: Chunks<'_>, profile: &[u8]) -> Result<[f32; 3]> {
    let raster = code.map(|share| ((share * 65535.0).round() as u16).to_be_bytes());
    let loaded = loaded(ColorType::Rgb, BitDepth::Sixteen, raster.as_flattened(), chunks, profile)?;
    let [r, g, b, alpha] = *floats(&loaded) else { panic!("one pixel") };
    assert_eq!(alpha, 1.0);
    Ok([r, g, b])
}

#[track_caller]
fn near(found: [f32; 3], wanted: [f64; 3]) {
    assert!((0..3).all(|c| (f64::from(found[c]) - wanted[c]).abs() < 2e-4), "{found:?}, wanted {wanted:?}");
}

const GAMMA_1: &[u8] = &100_000_u32.to_be_bytes();

fn places(places: [f64; 8]) -> Vec<u8> {
    places.iter().flat_map(|place| ((place * 1e5).round() as u32).to_be_bytes()).collect()
}

/// White, red, green and blue of BT.2020.
const BT2020: [f64; 8] = [0.3127, 0.329, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046];

/// A code of a half is 0.2140 by the sRGB curve, 0.5 of linear light, and 0.2872 by the power 1.8; PQ's is 92.2457
/// cd/m^2, of 203 (SMPTE ST 2084), and HLG's a twelfth, of 0.26496 (ITU-R BT.2100).
#[test]
fn codes_mean_what_the_first_chunk_in_the_order_of_the_standard_says() {
    let of_half = |chunks: Chunks<'_>| light([0.5; 3], chunks, &[]).unwrap()[1];
    let gamma_1_8 = 55_556_u32.to_be_bytes();
    let gamma_2_2 = 45_455_u32.to_be_bytes();
    let srgb: (&[u8; 4], &[u8]) = (b"sRGB", &[0]);
    let gamma = (b"gAMA", GAMMA_1);
    for (chunks, wanted) in [
        (&[][..], 0.214_04),
        (&[gamma], 0.5),
        (&[(b"gAMA", &gamma_1_8[..])], 0.287_17),
        // sRGB's own curve, for which programs write this.
        (&[(b"gAMA", &gamma_2_2[..])], 0.214_04),
        (&[srgb, gamma], 0.214_04),
        (&[gamma, (b"cHRM", &places(BT2020)[..])], 0.5),
        (&[(b"cICP", &[1, 8, 0, 1]), srgb, gamma], 0.5),
        (&[(b"cICP", &[1, 13, 0, 1]), gamma], 0.214_04),
        (&[(b"cICP", &[9, 16, 0, 1]), gamma], 92.2457 / 203.0),
        (&[(b"cICP", &[1, 18, 0, 1])], 0.314_51),
        // The cameras' curve: ((0.5 + 0.0993) / 1.0993)^(1 / 0.45).
        (&[(b"cICP", &[1, 1, 0, 1])], 0.259_72),
        // A half of 16 bits is 128 of 8, and (128 - 16) / 219 of white.
        (&[(b"cICP", &[1, 8, 0, 0])], 0.511_41),
        // A gamma of 0 is broken, as a chunk that is too short; decoders pass over them.
        (&[(b"gAMA", &[0; 4])], 0.214_04),
        (&[(b"gAMA", &[0; 3])], 0.214_04),
        (&[(b"gAMA", &[0, 0, 0, 1])], 0.214_04),
        (&[(b"gAMA", &[255; 4])], 0.214_04),
        // Code points that are not read leave the word to the next chunk.
        (&[(b"cICP", &[1, 9, 0, 1]), gamma], 0.5),
        (&[(b"cICP", &[3, 13, 0, 1]), srgb, gamma], 0.214_04),
        // The first one counts, whatever the second is.
        (&[(b"cICP", &[1, 8, 0, 1]), (b"cICP", &[9, 16, 9, 1])], 0.5),
    ] {
        let found = of_half(chunks);
        assert!((found - wanted).abs() < 1e-4, "{chunks:?}: {found}, wanted {wanted}");
    }
    for (points, words) in [
        ([1, 9, 0, 1], "transfer function 9"),
        ([3, 13, 0, 1], "colour primaries 3"),
        ([9, 16, 9, 1], "cICP chunk has the matrix coefficients 9"),
        ([9, 16, 0, 7], "the range 7"),
    ] {
        let error = light([0.5; 3], &[(b"cICP", &points)], &[]).unwrap_err();
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains(words), "{error}");
    }
}

/// The matrix of ITU-R BT.2087 from BT.2020 to BT.709, and that of Display P3 (as CSS Color 4 has it).
#[test]
fn primaries_become_those_of_rec_709() {
    let bt2020 = places(BT2020);
    for chunks in [&[(b"cICP", &[9, 8, 0, 1][..])][..], &[(b"gAMA", GAMMA_1), (b"cHRM", &bt2020)]] {
        near(light([0.0, 1.0, 0.0], chunks, &[]).unwrap(), [0.0, 1.1329, 0.0]);
        near(light([0.5, 0.25, 0.25], chunks, &[]).unwrap(), [0.665_12, 0.218_85, 0.245_45]);
        near(light([0.5; 3], chunks, &[]).unwrap(), [0.5; 3]);
    }
    near(light([1.0, 0.0, 0.0], &[(b"cICP", &[12, 13, 0, 1])], &[]).unwrap(), [1.224_94, 0.0, 0.0]);
    // Rec. 709's own places, rounded, change nothing; such that are none's are passed over.
    let rounded = [0.313, 0.329, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06];
    for odd in [rounded, [0.0; 8], [0.3; 8], [0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 9.0, 9.0]] {
        let found = light([1.0, 0.5, 0.0], &[(b"gAMA", GAMMA_1), (b"cHRM", &places(odd))], &[]).unwrap();
        near(found, [1.0, 0.5, 0.0]);
    }
}

#[test]
fn eight_bit_pictures_stay_so_where_they_are_srgb() {
    let raster = [0, 128, 255];
    for chunks in
        [&[][..], &[(b"sRGB", &[1][..])], &[(b"cICP", &[1, 13, 0, 1])], &[(b"gAMA", &45_455_u32.to_be_bytes())]]
    {
        let loaded = loaded(ColorType::Rgb, BitDepth::Eight, &raster, chunks, &[]).unwrap();
        assert_eq!((loaded.format, loaded.pixels.as_bytes()), (PixelFormat::Rgba8Srgb, &[0, 128, 255, 255][..]));
    }
    let linear = loaded(ColorType::Rgb, BitDepth::Eight, &raster, &[(b"gAMA", GAMMA_1)], &[]).unwrap();
    let [r, g, b, alpha] = *floats(&linear) else { panic!("one pixel") };
    assert_eq!([r, b, alpha], [0.0, 1.0, 1.0]);
    assert!((g - 128.0 / 255.0).abs() < 1e-6, "{g}");
    // Grey with alpha, which stays as it is, and the range of video.
    let video: Chunks<'_> = &[(b"cICP", &[1, 8, 0, 0])];
    let grey = loaded(ColorType::GrayscaleAlpha, BitDepth::Eight, &[16, 51, 235, 255, 8, 0], video, &[]).unwrap();
    assert_eq!(floats(&grey), [0.0, 0.0, 0.0, 0.2, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
}

/// A profile's list of tags, each with its data.
fn profile(space: &[u8; 4], connection: &[u8; 4], tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes[16..20].copy_from_slice(space);
    bytes[20..24].copy_from_slice(connection);
    bytes[36..40].copy_from_slice(b"acsp");
    bytes.extend((tags.len() as u32).to_be_bytes());
    let mut data = Vec::new();
    for (name, tag) in tags {
        bytes.extend(*name);
        bytes.extend((132 + 12 * tags.len() as u32 + data.len() as u32).to_be_bytes());
        bytes.extend((tag.len() as u32).to_be_bytes());
        data.extend(tag);
        data.resize(data.len().next_multiple_of(4), 0);
    }
    [bytes, data].concat()
}

fn fixed(kind: &[u8; 4], numbers: &[f64]) -> Vec<u8> {
    let numbers = numbers.iter().flat_map(|number| ((number * 65536.0).round() as i32).to_be_bytes());
    kind.iter().copied().chain([0; 4]).chain(numbers).collect()
}

fn formula(kind: u8, numbers: &[f64]) -> Vec<u8> {
    let mut tag = fixed(b"para", &[0.0]);
    tag[9] = kind;
    tag.extend(&fixed(b"para", numbers)[8..]);
    tag
}

fn steps(steps: &[u16]) -> Vec<u8> {
    let mut tag = [b"curv", &[0; 4][..], &(steps.len() as u32).to_be_bytes()].concat();
    tag.extend(steps.iter().flat_map(|step| step.to_be_bytes()));
    tag
}

const SRGB_FORMULA: [f64; 5] = [2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045];

/// Red, green and blue of a display in the space of profiles, and one curve.
fn display(lights: [[f64; 3]; 3], curve: &[u8]) -> Vec<u8> {
    let [r, g, b] = lights.map(|light| fixed(b"XYZ ", &light));
    let curve = || curve.to_vec();
    let tags = [(b"rXYZ", r), (b"gXYZ", g), (b"bXYZ", b), (b"rTRC", curve()), (b"gTRC", curve()), (b"bTRC", curve())];
    profile(b"RGB ", b"XYZ ", &tags)
}

/// A zlib stream of one block that is not packed (RFC 1950 and 1951), of less than 64 KiB.
fn stored(bytes: &[u8]) -> Vec<u8> {
    let length = bytes.len() as u16;
    let (a, b) = bytes.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    let head = [&[0x78, 1, 1][..], &length.to_le_bytes(), &(!length).to_le_bytes()].concat();
    [&head[..], bytes, &(b << 16 | a).to_be_bytes()].concat()
}

/// The lights of sRGB and Display P3 in their usual profiles.
const SRGB: [[f64; 3]; 3] = [[0.43607, 0.22249, 0.01392], [0.38515, 0.71687, 0.09708], [0.14307, 0.06061, 0.7141]];
const P3: [[f64; 3]; 3] = [[0.51512, 0.2412, -0.00105], [0.29198, 0.69225, 0.04189], [0.1571, 0.06657, 0.78407]];

#[test]
fn profiles_of_three_lights_are_heeded() {
    let srgb = display(SRGB, &formula(3, &SRGB_FORMULA));
    // The older profile of sRGB has 1024 steps.
    let table = (0..1024).map(|i| (srgb_to_linear(i as f32 / 1023.0) * 65535.0).round() as u16).collect::<Vec<_>>();
    for profile in [&srgb, &display(SRGB, &steps(&table))] {
        let same = loaded(ColorType::Rgb, BitDepth::Eight, &[1, 128, 255], &[], profile).unwrap();
        assert_eq!((same.format, same.pixels.as_bytes()), (PixelFormat::Rgba8Srgb, &[1, 128, 255, 255][..]));
        near(light([0.5; 3], &[], profile).unwrap(), [0.214_04; 3]);
    }
    // A profile comes before sRGB, gAMA and cHRM, and after cICP.
    let p3 = display(P3, &formula(3, &SRGB_FORMULA));
    near(light([1.0, 0.0, 0.0], &[(b"gAMA", GAMMA_1), (b"sRGB", &[0])], &p3).unwrap(), [1.224_94, 0.0, 0.0]);
    near(light([0.5, 0.0, 0.0], &[(b"cICP", &[1, 8, 0, 1])], &p3).unwrap(), [0.5, 0.0, 0.0]);
    // Powers, linear light, the formulas' other kinds.
    for (curve, wanted) in [
        (steps(&[]), 0.5),
        (steps(&[448]), 0.297_3),
        (formula(0, &[2.0]), 0.25),
        (formula(1, &[2.0, 2.0, -0.5]), 0.25),
        (formula(2, &[2.0, 1.0, 0.0, 0.125]), 0.375),
        (formula(4, &[2.0, 1.0, 0.0, 1.0, 0.75, 0.0, 0.25]), 0.75),
    ] {
        near(light([0.5; 3], &[], &display(SRGB, &curve)).unwrap(), [wanted; 3]);
    }
    // Grey pictures have a curve only.
    let grey = profile(b"GRAY", b"XYZ ", &[(b"kTRC", steps(&[]))]);
    let half = loaded(ColorType::Grayscale, BitDepth::Eight, &[51], &[], &grey).unwrap();
    assert_eq!(floats(&half), [0.2, 0.2, 0.2, 1.0]);
}

#[test]
fn profiles_of_other_kinds_give_way_to_what_stands_beside_them() {
    let tables = profile(b"RGB ", b"Lab ", &[(b"A2B0", vec![0; 40])]);
    let grey = profile(b"GRAY", b"XYZ ", &[(b"kTRC", steps(&[]))]);
    let perceptual = profile(b"GRAY", b"Lab ", &[(b"kTRC", steps(&[]))]);
    let odd = display(SRGB, &formula(9, &[1.0; 7]));
    let dark = display([[0.0; 3]; 3], &steps(&[]));
    let huge = display([[30_000.0; 3], [-30_000.0; 3], [1.0; 3]], &steps(&[]));
    let (flat, white) = (display(SRGB, &steps(&[0])), display(SRGB, &formula(0, &[0.0])));
    let short = tables[..40].to_vec();
    for profile in [&tables, &grey, &perceptual, &odd, &dark, &huge, &flat, &white, &short, &b"acsp".to_vec()] {
        let error = light([0.5; 3], &[], profile).unwrap_err();
        assert!(
            error.kind == ErrorKind::Unsupported && error.message.contains("convert the picture to sRGB"),
            "{error}"
        );
        near(light([0.5; 3], &[(b"gAMA", GAMMA_1)], profile).unwrap(), [0.5; 3]);
        near(light([0.5; 3], &[(b"sRGB", &[0]), (b"gAMA", GAMMA_1)], profile).unwrap(), [0.214_04; 3]);
    }
    // One that is broken as a chunk is no profile: two bytes of no zlib.
    near(light([0.5; 3], &[(b"iCCP", b"name\0\0ab")], &[]).unwrap(), [0.214_04; 3]);
    // The first of several counts, a broken one too: the second is linear, whole, and longer than one may be.
    let linear = [b"icc\0\0".to_vec(), stored(&display(SRGB, &steps(&[])))].concat();
    let long = [&linear[..], &[0; 70_000]].concat();
    near(light([0.5; 3], &[(b"iCCP", &linear), (b"iCCP", b"name\0\0ab")], &[]).unwrap(), [0.5; 3]);
    for later in [&linear, &long] {
        near(light([0.5; 3], &[(b"iCCP", b"name\0\0ab"), (b"iCCP", later)], &[]).unwrap(), [0.214_04; 3]);
        near(light([0.5; 3], &[(b"iCCP", &linear), (b"iCCP", later)], &[]).unwrap(), [0.5; 3]);
    }
    // Every length of a good one.
    let whole = display(P3, &formula(3, &SRGB_FORMULA));
    for length in 1..whole.len() {
        if let Err(error) = light([0.5; 3], &[], &whole[..length]) {
            assert_eq!(error.kind, ErrorKind::Unsupported);
        }
    }
}

/// The picture over a background, in linear light, is that of the premultiplied frame.
#[test]
fn transparent_frames_are_saved_with_the_colours_of_png() {
    let folder = Folder::new("straight");
    let path = folder.file("a.png");
    // Opaque; half covered; glare without cover; black; light beyond its cover; blue and red by their names.
    let frame: [u8; 24] = [10, 20, 30, 255, 40, 100, 0, 128, 90, 80, 70, 0, 0, 0, 0, 77, 200, 100, 50, 64, 1, 2, 3, 1];
    for format in [PixelFormat::Rgba8Srgb, PixelFormat::Bgra8Srgb] {
        let image = ImageRef::new(Layout::packed(format, 6, 1), &frame).unwrap();
        save(&image, Alpha::Premultiplied, ColourSpace::Rec709, &path).unwrap();
        let saved = load(&path).unwrap();
        let saved = saved.pixels.as_bytes();
        let order = if format == PixelFormat::Rgba8Srgb { [0, 1, 2] } else { [2, 1, 0] };
        for (given, saved) in frame.chunks(4).zip(saved.chunks(4)) {
            let alpha = f32::from(given[3]) / 255.0;
            assert_eq!(saved[3], given[3]);
            for (c, from) in order.into_iter().enumerate() {
                let light = |code: u8| srgb_to_linear(f32::from(code) / 255.0);
                let (premultiplied, straight) = (light(given[from]), light(saved[c]));
                // A step of the code is at most 0.0092 of light.
                let wanted = if alpha == 0.0 { 0.0 } else { (premultiplied / alpha).min(1.0) };
                assert!((straight - wanted).abs() < 0.0047, "{given:?} {saved:?}");
                assert!(given[3] != 255 || saved[c] == given[from]);
            }
        }
        // An image of the host's own, as one that was loaded, is saved as it is.
        save(&image, Alpha::AsInFile, ColourSpace::Rec709, &path).unwrap();
        let saved = load(&path).unwrap();
        assert_eq!(saved.pixels.as_bytes()[4], frame[4 + order[0]]);
    }
}
