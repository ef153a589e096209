// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that are made to do harm: small ones that claim to be large, and valid ones with faults put in.

use crate::random::Random;
use crate::seeds::{self, Seed};

/// A file, and words: its error must contain one of them.
pub struct Bomb {
    pub name: String,
    pub bytes: Vec<u8>,
    pub words: &'static [&'static str],
}

pub fn bombs() -> Vec<Bomb> {
    let mut bombs = Vec::new();
    let mut add = |name: &str, bytes: Vec<u8>, words: &'static [&'static str]| {
        bombs.push(Bomb { name: name.into(), bytes, words });
    };
    // The sizes are within 4 GiB when they are decoded, and past it when they are handed out.
    let small_codes = seeds::png_header(65536, 65536, 8, 0, false);
    add("a grey picture of 4 GiB.png", small_codes, &["at most 4294967296"]);
    add("bits.png", seeds::png_header(65536, 65536, 1, 0, false), &["at most 4294967296"]);
    add("interlaced.png", seeds::png_header(40000, 40000, 8, 3, true), &["at most 4294967296"]);
    add("16 bits.png", seeds::png_header(20000, 20000, 16, 0, false), &["at most 4294967296"]);
    add("a long side.png", seeds::png_header(0x7fff_ffff, 1, 8, 0, false), &["at most 1048576"]);
    for (name, header) in [("P4", "P4 65536 65536\n"), ("P5", "P5 65536 65536 255\n"), ("P6", "P6 20000 20000 999\n")] {
        add(&format!("{name}.pnm"), header.into(), &["at most 4294967296"]);
    }
    add("a long side.pnm", "P6 2000000000 2 255\n".into(), &["at most 1048576"]);
    // The claim is within the limits, but no pixels follow it.
    add("nothing.pnm", "P6 16384 16384 255\n".into(), &["0 bytes follow"]);
    add("nothing in digits.pnm", "P3 4096 4096 255\n".into(), &["0 bytes follow"]);
    let few = ["P2 64 64 255\n", &" ".repeat(1 << 14), "1 2 3"].concat();
    add("few digits.pnm", few.into(), &["ends before"]);
    let nothing = [seeds::png_header(16384, 16384, 16, 6, false), seeds::chunk(b"IDAT", &[0x78, 1])].concat();
    add("nothing.png", nothing, &["end of file", "of memory", "more data"]);
    // Light of 16 bytes a pixel becomes of codes that are not sRGB's.
    let linear = [seeds::png_header(20000, 20000, 8, 0, false), seeds::chunk(b"gAMA", &100_000_u32.to_be_bytes())];
    let linear = [linear.concat(), seeds::chunk(b"IDAT", &[0x78, 1])].concat();
    add("linear codes.png", linear, &["at most 4294967296"]);
    let profile = [seeds::png_header(1, 1, 8, 0, false), seeds::chunk(b"iCCP", &[0; 70_000])].concat();
    let profile = [profile, seeds::chunk(b"IDAT", &[0x78, 1])].concat();
    add("a profile that is too long to be read.png", profile, &["its ICC profile"]);
    let (mut bytes, mut info) = (Vec::new(), png::Info::with_size(1, 1));
    info.icc_profile = Some(vec![0; 60 << 20].into());
    let encoder = png::Encoder::with_info(&mut bytes, info).unwrap();
    encoder.write_header().unwrap().write_image_data(&[0]).unwrap();
    add("a profile that is small in its file.png", bytes, &["its ICC profile"]);
    // These headers never end.
    let words = ["P6 ".as_bytes(), &vec![b'1'; 1 << 17]].concat();
    add("a word without end.pnm", words, &["parsing"]);
    let line = ["P7\nWIDTH ".as_bytes(), &vec![b'1'; 1 << 17]].concat();
    add("a line without end.pnm", line, &["its WIDTH"]);
    let pam =
        |size: u32, most: u32| format!("P7\nWIDTH {size}\nHEIGHT {size}\nDEPTH 4\nMAXVAL {most}\nENDHDR\n").into();
    add("wide.pam.pnm", pam(20000, 256), &["at most 4294967296"]);
    add("nothing.pam.pnm", pam(16384, 255), &["fill whole buffer"]);
    let comment = ["P6 #".as_bytes(), &vec![b'x'; 1 << 17]].concat();
    add("a comment without end.pnm", comment, &["end"]);
    #[cfg(feature = "exr")]
    exr_bombs(&mut add);
    bombs.extend(crate::ktx2::bombs());
    bombs
}

/// The bytes of an attribute in an EXR header.
#[cfg(feature = "exr")]
fn attribute(name: &str, kind: &str, value: &[u8]) -> Vec<u8> {
    [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &(value.len() as u32).to_le_bytes(), value].concat()
}

#[cfg(feature = "exr")]
fn ints(values: &[i32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// An EXR header with half channels `channels`, without alpha where they are 3, and a first block of no bytes. `tiles`:
/// their sides, for a tiled file.
#[cfg(feature = "exr")]
fn exr_header(display: [i32; 2], data: [i32; 2], compression: u8, channels: usize, tiles: Option<[i32; 2]>) -> Vec<u8> {
    let window = |[width, height]: [i32; 2]| ints(&[0, 0, width - 1, height - 1]);
    let mut names = ["A", "B", "G", "R"].map(String::from)[4 - channels.min(4)..].to_vec();
    names.extend((4..channels).map(|i| format!("Z{i:05}")));
    let mut list = Vec::new();
    for name in &names {
        list.extend([name.as_bytes(), b"\0", &ints(&[1, 0, 1, 1])].concat());
    }
    list.push(0);
    let version = if tiles.is_some() { 0x202 } else { 2 };
    let mut bytes = ints(&[0x0131_2f76, version]);
    bytes.extend(attribute("channels", "chlist", &list));
    bytes.extend(attribute("compression", "compression", &[compression]));
    bytes.extend(attribute("dataWindow", "box2i", &window(data)));
    bytes.extend(attribute("displayWindow", "box2i", &window(display)));
    bytes.extend(attribute("lineOrder", "lineOrder", &[0]));
    bytes.extend(attribute("pixelAspectRatio", "float", &1.0_f32.to_le_bytes()));
    bytes.extend(attribute("screenWindowCenter", "v2f", &[0; 8]));
    bytes.extend(attribute("screenWindowWidth", "float", &1.0_f32.to_le_bytes()));
    if let Some([width, height]) = tiles {
        bytes.extend(attribute("tiles", "tiledesc", &[&ints(&[width, height])[..], &[0]].concat()));
    }
    bytes.push(0);
    // The offset of one block, and that block: y, and its number of bytes.
    bytes.extend((bytes.len() as u64 + 8).to_le_bytes());
    bytes.extend(ints(&[0, 9]));
    bytes.extend([0; 9]);
    bytes
}

#[cfg(feature = "exr")]
fn exr_bombs(add: &mut impl FnMut(&str, Vec<u8>, &'static [&'static str])) {
    let codes = [(0, "none"), (1, "rle"), (2, "zip1"), (3, "zip16"), (4, "piz"), (5, "pxr24"), (6, "b44"), (7, "b44a")];
    for (code, name) in codes {
        // The display window alone is harmless.
        let bytes = exr_header([1, 1], [1 << 29, 16], code, 4, None);
        add(&format!("a data window, {name}.exr"), bytes, &["1 to 1048576"]);
        let bytes = exr_header([1, 1], [1 << 20, 1 << 20], code, 4, None);
        add(&format!("a square data window, {name}.exr"), bytes, &["at most 4294967296", "at most 268435456"]);
        let bytes = exr_header([16, 16], [16, 16], code, 4, Some([0x7fff_ffff, 0x7fff_ffff]));
        add(&format!("a tile, {name}.exr"), bytes, &["at most 268435456", "tile"]);
        let bytes = exr_header([16, 16], [16, 16], code, 4, Some([1 << 16, 1 << 16]));
        add(&format!("a tile of 32 GiB, {name}.exr"), bytes, &["at most 268435456"]);
        // The sizes are just within the limits; no data follow, and there may be no memory for them.
        let bytes = exr_header([64, 64], [1 << 12, 1 << 13], code, 4, Some([1 << 12, 1 << 13]));
        add(&format!("a tile of 256 MiB, {name}.exr"), bytes, &["at most 67108864 are unpacked at a time"]);
        let bytes = exr_header([1 << 12, 1 << 12], [1 << 12, 1 << 13], code, 4, Some([1 << 12, 1 << 13]));
        let words = &["of memory", "missing bytes"];
        add(&format!("a tile of 256 MiB of a picture as large, {name}.exr"), bytes, words);
    }
    add("a display window.exr", exr_header([1 << 20, 1 << 20], [16, 16], 3, 4, None), &["at most 4294967296"]);
    add("channels.exr", exr_header([16, 16], [16, 16], 3, 5000, None), &["at most 4096"]);
    // The picture takes 192 MiB; each channel of its blocks 24 MiB.
    let unused = exr_header([4096, 3072], [4096, 3072], 3, 44, None);
    add("unused channels.exr", unused, &["1107296256 bytes; at most 1073741824"]);
    // 1 GiB, of 44 channels: 4 times that may be unpacked, and no data follow.
    add("used by size.exr", exr_header([8192, 8192], [8192, 8192], 3, 33, None), &["at most 4294967296 are unpacked"]);
    add("just used by size.exr", exr_header([8192, 8192], [8192, 8192], 3, 32, None), &["missing bytes"]);
    // Only the blocks that the few scan lines shown reach are unpacked.
    add("a window of many channels.exr", exr_header([4096, 16], [4096, 16384], 3, 512, None), &["missing bytes"]);
    for (code, name) in [(8, "dwaa"), (9, "dwab")] {
        add(&format!("{name}.exr"), exr_header([16, 16], [16, 16], code, 4, None), &["compression is not read"]);
    }
    let mut header = exr_header([16, 16], [16, 16], 3, 4, None);
    let long = attribute("owner", "string", &vec![b'x'; 9 << 20]);
    header.splice(8..8, long);
    add("a long attribute.exr", header, &["longer than 8388608"]);
    let mut header = exr_header([16, 16], [16, 16], 3, 4, None);
    header.splice(8..8, attribute("preview", "preview", &ints(&[0x7fff_ffff, 0x3fff_ffff])));
    add("a preview.exr", header, &["missing bytes"]);
}

/// A valid file of some 300 bytes, one white pixel without alpha in a display window of 1 GiB as it is handed out.
#[cfg(feature = "exr")]
pub fn exr_pixel() -> Vec<u8> {
    let mut bytes = exr_header([8192, 8192], [1, 1], 0, 3, None);
    // The block's size, and its bytes.
    bytes.truncate(bytes.len() - 13);
    bytes.extend(ints(&[6]));
    bytes.extend([0, 0x3c, 0, 0x3c, 0, 0x3c]);
    bytes
}

/// Numbers that programs trip over.
const ODD: [u32; 14] =
    [0, 1, 2, 7, 0x7f, 0x80, 0xff, 0xffff, 0x1_0000, 0x2000_0000, 0x7fff_ffff, 0x8000_0000, 0xffff_fff0, 0xffff_ffff];

/// A seed with faults: bytes and bits changed, numbers put in, parts cut out, doubled or taken from another seed.
pub fn faulty(seeds: &[Seed], random: &mut Random) -> Vec<u8> {
    let mut below = |n: usize| ((random.next() * n as f64) as usize).min(n.saturating_sub(1));
    let mut bytes = seeds[below(seeds.len())].bytes.clone();
    for _ in 0..1 + below(4) {
        if bytes.is_empty() {
            break;
        }
        // Every second fault is near the beginning, where headers are.
        let reach = if below(2) == 0 { bytes.len() } else { bytes.len().min(400) };
        let at = below(reach);
        match below(8) {
            0 => bytes[at] ^= 1 << below(8),
            1 => bytes[at] = below(256) as u8,
            2 | 3 => {
                let odd = ODD[below(ODD.len())];
                let four = if below(2) == 0 { odd.to_le_bytes() } else { odd.to_be_bytes() };
                let room = four.len().min(bytes.len() - at);
                bytes[at..at + room].copy_from_slice(&four[..room]);
            }
            4 => bytes.truncate(at),
            5 => {
                let end = at + below(bytes.len() - at).min(64);
                bytes.drain(at..end);
            }
            6 => {
                let end = at + below(bytes.len() - at).min(64);
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
            _ => {
                let other = &seeds[below(seeds.len())].bytes;
                let from = below(other.len());
                let count = below(64).min(other.len() - from).min(bytes.len() - at);
                bytes[at..at + count].copy_from_slice(&other[from..from + count]);
            }
        }
    }
    // PNM files have numbers in digits.
    if bytes.starts_with(b"P") && below(3) == 0 {
        let odd = ODD[below(ODD.len())].to_string();
        let at = below(bytes.len().min(40));
        bytes.splice(at..at, odd.into_bytes());
    }
    if bytes.starts_with(b"\x89PNG") && below(8) > 0 {
        seeds::reseal(&mut bytes);
    }
    bytes
}
