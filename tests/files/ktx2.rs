// SPDX-License-Identifier: MIT OR Apache-2.0
//! KTX2 files: small valid ones of all texels that are read, with what they hold, and small ones that claim much.

use crate::hostile::Bomb;
use crate::seeds::Seed;
use half::f16;
use ktx2::{ColorPrimaries, Format, Header, Index, LevelIndex, SupercompressionScheme, TransferFunction};

/// A file of one picture.
#[derive(Clone)]
pub struct File {
    pub format: Format,
    pub size: [u32; 2],
    /// Each level's bytes.
    pub levels: Vec<Vec<u8>>,
    pub compressed: bool,
    pub primaries: Option<ColorPrimaries>,
    pub orientation: &'static str,
}

impl File {
    fn of(format: Format, size: [u32; 2], pixels: Vec<u8>) -> Self {
        Self { format, size, levels: vec![pixels], compressed: false, primaries: None, orientation: "rd" }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let (basic, type_size) =
            ktx2::dfd::Basic::from_format_with(self.format, false, None::<TransferFunction>, self.primaries, None)
                .unwrap();
        let basic = ktx2::dfd::Block::Basic(basic).to_vec();
        let described = [&(basic.len() as u32 + 4).to_le_bytes()[..], &basic].concat();
        let text = [b"KTXorientation\0", self.orientation.as_bytes(), b"\0"].concat();
        let mut pairs = [&(text.len() as u32).to_le_bytes()[..], &text].concat();
        pairs.resize(pairs.len().next_multiple_of(4), 0);
        let stored = |level: &Vec<u8>| match self.compressed {
            true => ruzstd::encoding::compress_to_vec(level.as_slice(), ruzstd::encoding::CompressionLevel::Fastest),
            false => level.clone(),
        };
        let levels = self.levels.iter().map(stored).collect::<Vec<_>>();
        let described_at = Header::LENGTH + levels.len() * LevelIndex::LENGTH;
        let pairs_at = described_at + described.len();
        let header = Header {
            format: Some(self.format),
            type_size,
            pixel_width: self.size[0],
            pixel_height: self.size[1],
            pixel_depth: 0,
            layer_count: 0,
            face_count: 1,
            level_count: levels.len() as u32,
            supercompression_scheme: self.compressed.then_some(SupercompressionScheme::Zstandard),
            index: Index {
                dfd_byte_offset: described_at as u32,
                dfd_byte_length: described.len() as u32,
                kvd_byte_offset: pairs_at as u32,
                kvd_byte_length: pairs.len() as u32,
                sgd_byte_offset: 0,
                sgd_byte_length: 0,
            },
        };
        let mut bytes = header.as_bytes().to_vec();
        let mut at = (pairs_at + pairs.len()) as u64;
        for (level, raw) in levels.iter().zip(&self.levels) {
            let index = LevelIndex {
                byte_offset: at,
                byte_length: level.len() as u64,
                uncompressed_byte_length: raw.len() as u64,
            };
            bytes.extend(index.as_bytes());
            at += level.len() as u64;
        }
        [bytes, described, pairs, levels.concat()].concat()
    }
}

/// The light of the pictures below: 6 x 5 texels that differ by column, row and channel, all of them halves.
pub fn light(x: usize, y: usize) -> [f32; 3] {
    [0.25 * x as f32, 0.5 + y as f32, 0.125 * (x * y) as f32]
}

const SIZE: [usize; 2] = [6, 5];

fn texels(of: &dyn Fn([f32; 3]) -> Vec<u8>) -> Vec<u8> {
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| light(x, y))).flat_map(of).collect()
}

/// Blocks of one mode, whose ends are both `end` of 1024 in every channel.
fn blocks(count: usize, end: u128) -> Vec<u8> {
    let ends = (0..6).map(|i| end << (5 + 10 * i)).sum::<u128>();
    (0b00011 | ends).to_le_bytes().repeat(count)
}

/// Files that hold [`light`], by the names of their texels.
pub fn pictures() -> Vec<(&'static str, File)> {
    let halves = |with: &'static [f32]| {
        move |light: [f32; 3]| {
            light.iter().chain(with).flat_map(|v| f16::from_f32(*v).to_le_bytes()).collect::<Vec<_>>()
        }
    };
    let floats = |with: &'static [f32]| {
        move |light: [f32; 3]| light.iter().chain(with).flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()
    };
    // The light is in multiples of 1 / 32 below 16: exact with the exponent 19.
    let shared = |light: [f32; 3]| {
        let [r, g, b] = light.map(|v| (v * 32.0) as u32);
        (r | g << 9 | b << 18 | 19 << 27).to_le_bytes().to_vec()
    };
    let size = SIZE.map(|side| side as u32);
    let of = |format: Format, pixels: Vec<u8>| File::of(format, size, pixels);
    let compressed = File { compressed: true, ..of(Format::R32G32B32_SFLOAT, texels(&floats(&[]))) };
    let mut rows = texels(&halves(&[]));
    let turned = rows.chunks_mut(6 * SIZE[0]).rev().flat_map(|row| row.to_vec()).collect::<Vec<_>>();
    let turned = File { orientation: "ru", ..of(Format::R16G16B16_SFLOAT, turned) };
    vec![
        ("halves", of(Format::R16G16B16_SFLOAT, texels(&halves(&[])))),
        ("halves with alpha", of(Format::R16G16B16A16_SFLOAT, texels(&halves(&[1.0])))),
        ("floats", of(Format::R32G32B32_SFLOAT, texels(&floats(&[])))),
        ("floats with alpha", of(Format::R32G32B32A32_SFLOAT, texels(&floats(&[1.0])))),
        ("shared exponents", of(Format::E5B9G9R9_UFLOAT_PACK32, texels(&shared))),
        ("compressed", compressed),
        ("bottom up", turned),
    ]
}

/// Blocks with all levels, or the first.
pub fn map(size: [u32; 2], levels: usize, compressed: bool) -> File {
    let count = |level: usize| size.map(|side| (side >> level).max(1).div_ceil(4) as usize);
    let levels = (0..levels).map(|level| blocks(count(level)[0] * count(level)[1], 400 + level as u128));
    File { levels: levels.collect(), compressed, ..File::of(Format::BC6H_UFLOAT_BLOCK, size, Vec::new()) }
}

/// Files of 8-bit codes, which count up from 0.
pub fn codes() -> Vec<(&'static str, File)> {
    let codes = (0..90_u8).collect::<Vec<_>>();
    let wide = File { primaries: Some(ColorPrimaries::BT2020), ..File::of(Format::R8G8B8_SRGB, [6, 5], codes.clone()) };
    vec![
        ("codes", File::of(Format::R8G8B8_SRGB, [6, 5], codes.clone())),
        ("codes with alpha", File::of(Format::R8G8B8A8_SRGB, [4, 5], codes[..80].to_vec())),
        ("blue codes", File::of(Format::B8G8R8A8_SRGB, [4, 5], codes[..80].to_vec())),
        ("wide codes", wide),
    ]
}

/// The end of the block in this column and row of [`numbered`].
pub fn number(column: usize, row: usize) -> u128 {
    300 + 10 * column as u128 + 100 * row as u128
}

/// Blocks that have each a light of their own.
pub fn numbered(size: [u32; 2], orientation: &'static str) -> File {
    let [across, down] = size.map(|side| side.div_ceil(4) as usize);
    let all = (0..down).flat_map(|row| (0..across).flat_map(move |column| blocks(1, number(column, row))));
    File { orientation, ..File::of(Format::BC6H_UFLOAT_BLOCK, size, all.collect()) }
}

pub fn seeds() -> Vec<Seed> {
    let mut files = pictures();
    files.extend(codes());
    files.extend([
        ("turned blocks", numbered([10, 7], "ru")),
        ("blocks", map([32, 16], 1, false)),
        ("blocks of all levels", map([32, 16], 6, false)),
        ("compressed blocks", map([32, 16], 6, true)),
        ("cut blocks", map([30, 17], 1, false)),
        ("signed blocks", File { format: Format::BC6H_SFLOAT_BLOCK, ..map([8, 8], 1, false) }),
    ]);
    files.into_iter().map(|(name, file)| Seed { name: format!("{name}.ktx2"), bytes: file.bytes() }).collect()
}

/// A number of a header in the place of another.
fn with(mut bytes: Vec<u8>, at: usize, number: u32) -> Vec<u8> {
    bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
    bytes
}

pub fn bombs() -> Vec<Bomb> {
    let small = || File::of(Format::R32G32B32A32_SFLOAT, [2, 2], vec![0; 64]);
    let large = |size: [u32; 2], format: Format| {
        let mut bytes = File { format, ..small() }.bytes();
        bytes = with(with(bytes, 20, size[0]), 24, size[1]);
        bytes
    };
    // A compressed level may claim any size.
    let claims = |size: [u32; 2], each: u64| {
        let mut bytes = File { compressed: true, ..small() }.bytes();
        bytes = with(with(bytes, 20, size[0]), 24, size[1]);
        bytes[96..104].copy_from_slice(&(u64::from(size[0]) * u64::from(size[1]) * each).to_le_bytes());
        bytes
    };
    let mut no_frame = claims([2, 2], 16);
    let last = no_frame.len() - 8;
    no_frame[last - 8..].fill(0xff);
    let wide_window = {
        let file = File { compressed: true, ..small() }.bytes();
        let begin = file.windows(4).position(|word| word == [0x28, 0xb5, 0x2f, 0xfd]).unwrap();
        // A frame of a gigabyte's window: a head without a size, and a window of 2^30.
        let mut bytes = file[..begin + 4].to_vec();
        bytes.extend([0x00, 20 << 3]);
        bytes.resize(file.len(), 0);
        bytes
    };
    let bomb = |name: &str, bytes: Vec<u8>, words: &'static [&'static str]| Bomb {
        name: format!("{name}.ktx2"),
        bytes,
        words,
    };
    vec![
        bomb("large texels", large([1 << 20, 1 << 20], Format::R32G32B32A32_SFLOAT), &["its level 0 claims 64 bytes"]),
        bomb("a long side", large([1 << 21, 1], Format::R32G32B32A32_SFLOAT), &["a side has 1 to 1048576"]),
        bomb("no rows", with(small().bytes(), 24, 0), &["a side has 1 to 1048576"]),
        bomb("no columns", with(small().bytes(), 20, 0), &["zero pixel width"]),
        bomb("nothing in much", claims([16384, 16384], 16), &["whole buffer", "of memory"]),
        bomb("more than is read", claims([1 << 15, 1 << 15], 16), &["at most 4294967296"]),
        bomb("no frame", no_frame, &["BadMagicNumber"]),
        bomb("a wide window", wide_window, &["indow"]),
        bomb("many levels", with(small().bytes(), 40, 4_000_000_000), &["of at most 32 levels"]),
        bomb("six faces", with(small().bytes(), 36, 6), &["6 faces"]),
        bomb("layers", with(small().bytes(), 32, 7), &["7 layers"]),
        bomb("a long description", with(small().bytes(), 52, 0x7fff_ffff), &["takes 2147483647 bytes"]),
        bomb("many pairs", with(small().bytes(), 60, 0x7fff_ffff), &["takes 2147483647 bytes"]),
        bomb("a description elsewhere", with(small().bytes(), 48, 0xffff_fff0), &["whole buffer"]),
        bomb("Basis", with(small().bytes(), 12, 0), &["Basis Universal"]),
        bomb("other texels", with(small().bytes(), 12, 145), &["Vulkan's format 145,"]),
        bomb("another compression", with(small().bytes(), 44, 3), &["ZLIB"]),
        bomb("leftwards", File { orientation: "ld", ..small() }.bytes(), &["its orientation is ld"]),
        bomb("other primaries", File { primaries: Some(ColorPrimaries::CIEXYZ), ..small() }.bytes(), &["CIEXYZ"]),
    ]
}
