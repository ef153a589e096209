// SPDX-License-Identifier: MIT OR Apache-2.0
//! Small valid files of every kind that is read, made here: no corpus to carry. Knows the formats, not bhr.

use crate::random::Random;

/// A file's bytes, and what it is.
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
}

pub fn pnm() -> Vec<Seed> {
    let seed = |name: &str, header: &str, raster: &[u8]| Seed {
        name: format!("{name}.pnm"),
        bytes: [header.as_bytes(), raster].concat(),
    };
    let raster = (0..96_u8).collect::<Vec<_>>();
    let pam = |depth: u32, most: u32, kind: &str| {
        format!("P7\nWIDTH 4\nHEIGHT 3\nDEPTH {depth}\nMAXVAL {most}\nTUPLTYPE {kind}\n# a comment\nENDHDR\n")
    };
    vec![
        seed("plain bits", "P1\n# a comment\n4 3\n1 0 1 0\n0101 1 1 0 0\n", &[]),
        seed("plain grey", "P2 4 3 15\n0 1 2 3 4 5 6 7 8 9 10 15\n", &[]),
        seed("plain colour", "P3 2 2 65535\n0 1 2 65535 4 5 6 7 8 9 10 11\n", &[]),
        seed("bits", "P4 11 3\n", &raster[..6]),
        seed("grey", "P5 4 3 255\n", &raster[..12]),
        seed("grey of 16 bits", "P5 4 3 1000\n", &raster[..24]),
        seed("colour", "P6 4 3 255\n", &raster[..36]),
        seed("colour of 16 bits", "P6\n4\n3\n65535\n", &raster[..72]),
        seed("any grey", &pam(1, 255, "GRAYSCALE"), &raster[..12]),
        seed("any colour", &pam(3, 255, "RGB"), &raster[..36]),
        seed("any grey with alpha", &pam(2, 65535, "GRAYSCALE_ALPHA"), &raster[..48]),
        seed("any colour with alpha", &pam(4, 255, "RGB_ALPHA"), &raster[..48]),
        seed("any black and white", &pam(1, 1, "BLACKANDWHITE"), &[0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 1]),
    ]
}

/// A PNG chunk, sealed.
pub fn chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut bytes = [&(data.len() as u32).to_be_bytes()[..], name, data].concat();
    bytes.extend(crc(&bytes[4..]).to_be_bytes());
    bytes
}

/// ISO 3309, as in PNG's annex D.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

/// Makes every chunk's sum right again, so that what is broken inside is looked at.
pub fn reseal(png: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = png.get(at..at + 4) {
        let length = u32::from_be_bytes(length.try_into().unwrap()) as usize;
        let Some(sum) = at.checked_add(8).and_then(|data| data.checked_add(length)).filter(|sum| sum + 4 <= png.len())
        else {
            return;
        };
        let crc = crc(&png[at + 4..sum]);
        png[sum..sum + 4].copy_from_slice(&crc.to_be_bytes());
        at = sum + 4;
    }
}

/// zlib without compression.
fn stored(bytes: &[u8]) -> Vec<u8> {
    let (a, b) = bytes.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    let length = bytes.len() as u16;
    let mut out = [&[0x78, 0x01, 1][..], &length.to_le_bytes(), &(!length).to_le_bytes(), bytes].concat();
    out.extend((b << 16 | a).to_be_bytes());
    out
}

/// `depth`: bits a sample; `color`: PNG's colour type.
pub fn png_header(width: u32, height: u32, depth: u8, color: u8, interlaced: bool) -> Vec<u8> {
    let about = [depth, color, 0, 0, u8::from(interlaced)];
    let data = [&width.to_be_bytes()[..], &height.to_be_bytes(), &about].concat();
    [b"\x89PNG\r\n\x1a\n".to_vec(), chunk(b"IHDR", &data)].concat()
}

/// An ICC profile of three lights, with a curve of each kind: a formula, a power, a table.
fn profile() -> Vec<u8> {
    let numbers = |numbers: &[f64]| {
        numbers.iter().flat_map(|number| ((number * 65536.0) as i32).to_be_bytes()).collect::<Vec<_>>()
    };
    let xyz = |light: [f64; 3]| [b"XYZ \0\0\0\0".to_vec(), numbers(&light)].concat();
    let tags: [(&[u8; 4], Vec<u8>); 6] = [
        (b"rXYZ", xyz([0.51512, 0.2412, -0.00105])),
        (b"gXYZ", xyz([0.29198, 0.69225, 0.04189])),
        (b"bXYZ", xyz([0.1571, 0.06657, 0.78407])),
        (b"rTRC", [b"para\0\0\0\0\0\x03\0\0".to_vec(), numbers(&[2.4, 0.948, 0.052, 0.077, 0.04])].concat()),
        (b"gTRC", b"curv\0\0\0\0\0\0\0\x01\x02\0\0\0".to_vec()),
        (b"bTRC", b"curv\0\0\0\0\0\0\0\x03\0\0\x40\0\xff\xff\0\0".to_vec()),
    ];
    let mut bytes = vec![0; 128];
    bytes[16..24].copy_from_slice(b"RGB XYZ ");
    bytes[36..40].copy_from_slice(b"acsp");
    bytes.extend((tags.len() as u32).to_be_bytes());
    let mut at = 132 + 12 * tags.len();
    for (name, tag) in &tags {
        bytes.extend([&name[..], &(at as u32).to_be_bytes(), &(tag.len() as u32).to_be_bytes()].concat());
        at += tag.len();
    }
    tags.iter().for_each(|(_, tag)| bytes.extend(tag));
    bytes
}

pub fn png() -> Vec<Seed> {
    const SIZE: [usize; 2] = [11, 7];
    /// The passes of Adam7: the first column and row, and the steps.
    const PASSES: [[usize; 4]; 7] =
        [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];
    let mut seeds = Vec::new();
    let kinds =
        [(0, 1, &[1, 2, 4, 8, 16][..]), (2, 3, &[8, 16]), (3, 1, &[1, 2, 4, 8]), (4, 2, &[8, 16]), (6, 4, &[8, 16])];
    for (color, samples, depths) in kinds {
        for depth in depths {
            for (interlaced, transparent) in [(false, false), (true, false), (false, true)] {
                if transparent && color > 3 {
                    continue;
                }
                let mut random = Random(u64::from(color) * 100 + *depth as u64);
                let mut lines = Vec::new();
                let mut add = |width: usize, height: usize| {
                    for y in 0..height {
                        if width > 0 {
                            // Every filter in turn.
                            lines.push(y as u8 % 5);
                            lines.extend(
                                (0..(width * samples * depth).div_ceil(8)).map(|_| (random.next() * 256.0) as u8),
                            );
                        }
                    }
                };
                if interlaced {
                    for [x, y, dx, dy] in PASSES {
                        add((SIZE[0] - x).div_ceil(dx), (SIZE[1] - y).div_ceil(dy));
                    }
                } else {
                    add(SIZE[0], SIZE[1]);
                }
                let mut bytes = png_header(SIZE[0] as u32, SIZE[1] as u32, *depth as u8, color, interlaced);
                if color == 3 {
                    let palette = (0..3 * (1 << depth)).map(|i| (i * 5 % 256) as u8).collect::<Vec<_>>();
                    bytes.extend(chunk(b"PLTE", &palette));
                }
                if transparent {
                    let alpha = [0, 1, 0, 2, 0, 3];
                    bytes.extend(chunk(b"tRNS", &alpha[..[2, 0, 6, 2][color as usize]]));
                }
                bytes.extend(chunk(b"tEXt", b"Comment\0a text"));
                let (first, second) = (stored(&lines), chunk(b"IEND", &[]));
                let (first, last) = first.split_at(first.len() / 2);
                bytes.extend([chunk(b"IDAT", first), chunk(b"IDAT", last), second].concat());
                let name = format!("colour type {color}, {depth} bits, {interlaced}, {transparent}.png");
                seeds.push(Seed { name, bytes });
            }
        }
    }
    // Every chunk that says what colours mean, in pictures of 8 and of 16 bits.
    let places: [u32; 8] = [31_270, 32_900, 70_800, 29_200, 17_000, 79_700, 13_100, 4_600];
    let places = places.iter().flat_map(|place| place.to_be_bytes()).collect::<Vec<_>>();
    let colours: [(&str, Vec<u8>); 6] = [
        ("linear", [chunk(b"gAMA", &100_000_u32.to_be_bytes()), chunk(b"cHRM", &places)].concat()),
        ("sRGB", chunk(b"sRGB", &[0])),
        ("PQ", chunk(b"cICP", &[9, 16, 0, 1])),
        ("HLG of video", chunk(b"cICP", &[12, 18, 0, 0])),
        ("profile", chunk(b"iCCP", &[b"a profile\0\0", &stored(&profile())[..]].concat())),
        ("profile and gamma", {
            let other = stored(&[0; 200]);
            [chunk(b"iCCP", &[b"other\0\0", &other[..]].concat()), chunk(b"gAMA", &55_556_u32.to_be_bytes())].concat()
        }),
    ];
    let plain = |seed: &&Seed| seed.name.starts_with("colour type 2") && seed.name.ends_with("false, false.png");
    for seed in seeds.iter().filter(plain).map(|seed| seed.bytes.clone()).collect::<Vec<_>>() {
        // The header is 33 bytes long.
        let depth = seed[24];
        let with = colours.iter().map(|(name, chunks)| Seed {
            name: format!("{name}, {depth} bits.png"),
            bytes: [&seed[..33], chunks, &seed[33..]].concat(),
        });
        seeds.extend(with);
    }
    // One that is compressed in earnest, by the encoder that bhr uses.
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 32, 32);
    encoder.set_color(png::ColorType::Rgba);
    let picture = (0..32 * 32 * 4).map(|i| (i / 7) as u8).collect::<Vec<_>>();
    encoder.write_header().unwrap().write_image_data(&picture).unwrap();
    seeds.push(Seed { name: "compressed.png".into(), bytes });
    seeds
}

#[cfg(feature = "exr")]
pub use self::exr::{exr, exr_file, part};

#[cfg(feature = "exr")]
mod exr {
    use super::Seed;
    use ::exr::block::writer::ChunksWriter;
    use ::exr::compression::Compression::{self, *};
    use ::exr::math::{RoundingMode, Vec2};
    use ::exr::meta::attribute::*;
    use ::exr::meta::header::{Header, LayerAttributes};
    use ::exr::meta::{BlockDescription, attribute::LevelMode};
    use std::io::Cursor;

    /// A part of grey, or of a layer's colours, with the primaries of ACES.
    fn layer(channels: &[&str]) -> Header {
        let list = channels.iter().map(|name| ChannelDescription::new(*name, SampleType::F16, false)).collect();
        let [red, green, blue, white] =
            [Vec2(0.7347, 0.2653), Vec2(0.0, 1.0), Vec2(0.0001, -0.077), Vec2(0.32168, 0.33767)];
        let mut header = Header::new(Text::from("a"), Vec2(5, 4), list);
        header.shared_attributes.chromaticities = Some(Chromaticities { red, green, blue, white });
        header
    }

    /// A part with channels A, B, G, R of these types, in scan lines or tiles.
    pub fn part(
        name: &str,
        size: [usize; 2],
        types: [SampleType; 4],
        compression: Compression,
        tiles: Option<(usize, LevelMode)>,
    ) -> Header {
        let channels = ["A", "B", "G", "R"].iter().zip(types);
        let channels = channels.map(|(name, kind)| ChannelDescription::new(*name, kind, false)).collect();
        let (blocks, order) = match tiles {
            None => (BlockDescription::ScanLines, LineOrder::Increasing),
            Some((side, level_mode)) => {
                let tile_size = Vec2(side, side);
                let tiles = TileDescription { tile_size, level_mode, rounding_mode: RoundingMode::Up };
                (BlockDescription::Tiles(tiles), LineOrder::Unspecified)
            }
        };
        let attributes = LayerAttributes { layer_name: Some(Text::from(name)), ..Default::default() };
        Header::new(Text::from(name), Vec2(size[0], size[1]), channels)
            .with_encoding(compression, blocks, order)
            .with_attributes(attributes)
    }

    /// A file of these parts, with a smooth picture.
    pub fn exr_file(parts: Vec<Header>) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let all = parts.clone();
        ::exr::block::write(&mut file, parts.into_iter().collect(), false, |meta, chunks| {
            let mut compressor = chunks.sequential_blocks_compressor(&meta);
            for (index, block) in meta.collect_ordered_block_data(|block| {
                let mut data = Vec::new();
                let (Vec2(left, top), Vec2(width, height)) = (block.pixel_position, block.pixel_size);
                for y in top..top + height {
                    for channel in &all[block.layer].channels.list {
                        for x in left..left + width {
                            let value = ((x + y) % 64) as f32 / 64.0;
                            match channel.sample_type {
                                SampleType::F16 => data.extend(half::f16::from_f32(value).to_ne_bytes()),
                                SampleType::F32 => data.extend(value.to_ne_bytes()),
                                SampleType::U32 => data.extend((x as u32).to_ne_bytes()),
                            }
                        }
                    }
                }
                data
            }) {
                compressor.compress_block(index, block)?;
            }
            Ok(())
        })
        .unwrap();
        file.into_inner()
    }

    pub fn exr() -> Vec<Seed> {
        const SIZE: [usize; 2] = [37, 21];
        let types = [
            ("half", [SampleType::F16; 4]),
            ("float", [SampleType::F32; 4]),
            ("mixed", [SampleType::F32, SampleType::F16, SampleType::U32, SampleType::F16]),
        ];
        let blocks = [
            ("lines", None),
            ("tiles", Some((16, LevelMode::Singular))),
            ("mip maps", Some((16, LevelMode::MipMap))),
            ("rip maps", Some((16, LevelMode::RipMap))),
        ];
        let mut seeds = Vec::new();
        for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24, B44, B44A] {
            for (kind, types) in types {
                for (block, tiles) in blocks {
                    let bytes = exr_file(vec![part("a", SIZE, types, compression, tiles)]);
                    seeds.push(Seed { name: format!("{compression}, {kind}, {block}.exr"), bytes });
                }
            }
        }
        let parts = vec![
            part("a", SIZE, types[0].1, ZIP16, None),
            part("b", [5, 40], types[1].1, PIZ, blocks[2].1),
            part("c", SIZE, types[2].1, RLE, blocks[1].1),
        ];
        seeds.push(Seed { name: "three parts.exr".into(), bytes: exr_file(parts) });
        for (name, channels) in [
            ("parts of grey", &["A", "Y"][..]),
            ("parts of layers", &["AO.B", "AO.G", "AO.R", "Combined.A", "Combined.B", "Combined.G", "Combined.R"]),
        ] {
            seeds.push(Seed { name: format!("{name}.exr"), bytes: exr_file(vec![layer(channels)]) });
        }
        seeds
    }
}
