// SPDX-License-Identifier: MIT OR Apache-2.0
//! KTX2 files: one picture and its levels, as textures of GPUs. Khronos, "KTX File Format Specification", version 2.0.
//! Knows no skies.

use super::colour::Matrix;
use super::ktx2_header::{Contents, FILTERED, Texels};
use super::loaded::{Loaded, Pixels, srgb_to_linear};
use super::support::{MAX_LOAD_BYTES, io_error, pixel_count, reserve, zeros};
use crate::error::Result;
use crate::image::bc6h::{Blocks, SIDE, decode};
use crate::image::memory::PixelFormat;
use crate::image::rgb9e5::unpack;
use half::f16;
use ktx2::{Format, Header, Index, LevelIndex};
use std::io::{BufRead, Read, Seek, Write};

/// The first bytes of a file.
pub(super) const MAGIC: [u8; 8] = [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb];
/// Levels of blocks begin at multiples of this.
const ALIGNMENT: u64 = 16;

/// The description of texels of BC6H, unsigned, linear, of Rec. 709, in the words of the specification's "Data Format
/// Descriptor": its length; a basic block of version 2 and 40 bytes; model 133, primaries 1, curve 1; blocks of 4 x 4
/// texels and 16 bytes; one sample of 128 bits that are floats, from 0 to 1.0.
const DESCRIPTION: [[u8; 4]; 11] = [
    44_u32.to_le_bytes(),
    [0; 4],
    [2, 0, 40, 0],
    [133, 1, 1, 0],
    [3, 3, 0, 0],
    [16, 0, 0, 0],
    [0; 4],
    [0, 0, 127, 0x80],
    [0; 4],
    [0; 4],
    1.0_f32.to_le_bytes(),
];

/// A picture in blocks of BC6H, unsigned: linear light of Rec. 709, the top row first.
pub struct BlockFile {
    /// The levels that the file has, the largest first: at least one, each of half the columns and rows of the one
    /// before, rounded down, but one at least.
    pub levels: Vec<Blocks>,
    /// Whether each level's rows are filtered as those of sky maps are.
    pub filtered: bool,
}

/// The largest level. Errors: as of [`Contents::read`]; OUT_OF_MEMORY.
pub(super) fn read(mut file: impl BufRead + Seek) -> Result<Loaded> {
    let contents = Contents::read(&mut file)?;
    let place = contents.levels[0];
    let ([width, height], texels) = (place.size, contents.texels);
    let codes_stay = matches!(texels, Texels::Srgb8 { .. }) && contents.matrix.is_none();
    let format = if codes_stay { PixelFormat::Rgba8Srgb } else { PixelFormat::Rgba32F };
    let count = pixel_count(width.into(), height.into(), format)?;
    let mut data = contents.open(place, &mut file)?;
    let turned = |y: usize| if contents.bottom_up { height as usize - 1 - y } else { y };
    let columns = width as usize;
    let pixels = match texels {
        Texels::Srgb8 { channels, blue_first } if codes_stay => {
            let mut row = zeros::<u8>(columns * channels)?;
            let mut bytes = zeros::<u8>(4 * count)?;
            for y in 0..height as usize {
                data.read_exact(&mut row).map_err(io_error)?;
                let out = bytes[turned(y) * 4 * columns..].as_chunks_mut().0;
                for (out, texel) in out.iter_mut().zip(row.chunks_exact(channels)) {
                    let order = if blue_first { [2, 1, 0] } else { [0, 1, 2] };
                    let [r, g, b] = order.map(|c| texel[c]);
                    *out = [r, g, b, texel.get(3).copied().unwrap_or(255)];
                }
            }
            Pixels::Bytes(bytes)
        }
        Texels::Bc6h { signed } => {
            let mut row = zeros::<[u8; 16]>(Blocks::count(place.size)[0])?;
            let mut floats = zeros::<f32>(4 * count)?;
            for top in (0..height as usize).step_by(SIDE as usize) {
                data.read_exact(row.as_flattened_mut()).map_err(io_error)?;
                for (block, left) in row.iter().zip((0..).step_by(SIDE as usize)) {
                    for (light, i) in decode(block, signed).into_iter().zip(0..) {
                        let (x, y) = (left + i % SIDE as usize, top + i / SIDE as usize);
                        if x < columns && y < height as usize {
                            let light = light.map(|v| v.max(0.0));
                            put(&mut floats[4 * (turned(y) * columns + x)..], light, 1.0, contents.matrix);
                        }
                    }
                }
            }
            Pixels::Floats(floats)
        }
        _ => {
            let mut row = zeros::<u8>(columns * texels.bytes())?;
            let mut floats = zeros::<f32>(4 * count)?;
            for y in 0..height as usize {
                data.read_exact(&mut row).map_err(io_error)?;
                let out = floats[4 * turned(y) * columns..].chunks_exact_mut(4);
                for (out, texel) in out.zip(row.chunks_exact(texels.bytes())) {
                    let ([r, g, b], alpha) = light_of(texels, texel);
                    put(out, [r, g, b], alpha, contents.matrix);
                }
            }
            Pixels::Floats(floats)
        }
    };
    Ok(Loaded { format, width, height, pixels })
}

fn put(out: &mut [f32], light: [f32; 3], alpha: f32, matrix: Option<Matrix>) {
    let [r, g, b] = matrix.map_or(light, |matrix| matrix.of(light));
    out.iter_mut().zip([r, g, b, alpha]).for_each(|(out, v)| *out = v);
}

/// Light and alpha of a texel that is no block.
fn light_of(texels: Texels, bytes: &[u8]) -> ([f32; 3], f32) {
    let channel = |c: usize| match texels {
        Texels::Srgb8 { .. } => bytes.get(c).map(|code| f32::from(*code) / 255.0),
        Texels::Half { .. } => bytes.as_chunks::<2>().0.get(c).map(|half| f16::from_le_bytes(*half).to_f32()),
        _ => bytes.as_chunks::<4>().0.get(c).map(|float| f32::from_le_bytes(*float)),
    };
    let colours = |order: [usize; 3]| order.map(|c| channel(c).unwrap_or(0.0));
    let alpha = || channel(3).unwrap_or(1.0);
    match texels {
        Texels::Srgb8 { blue_first: true, .. } => (colours([2, 1, 0]).map(srgb_to_linear), alpha()),
        Texels::Srgb8 { .. } => (colours([0, 1, 2]).map(srgb_to_linear), alpha()),
        Texels::Shared => {
            let texel = bytes.first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes));
            (unpack(texel), 1.0)
        }
        _ => (colours([0, 1, 2]), alpha()),
    }
}

/// `None`: the file's light is not that of [`BlockFile`]. Errors: as of [`read`].
pub(super) fn read_blocks(mut file: impl BufRead + Seek) -> Result<Option<BlockFile>> {
    let contents = Contents::read(&mut file)?;
    let is_ours = contents.texels == Texels::Bc6h { signed: false };
    if !is_ours || contents.matrix.is_some() || contents.bottom_up {
        return Ok(None);
    }
    let total = contents.levels.iter().map(|place| contents.texels.level_bytes(place.size)).sum::<u64>();
    if total > MAX_LOAD_BYTES {
        return Err(io_error(format!("its levels have {total} bytes; at most {MAX_LOAD_BYTES} are read")));
    }
    let mut levels = reserve(contents.levels.len())?;
    for place in &contents.levels {
        let [across, down] = Blocks::count(place.size);
        let mut blocks = zeros::<[u8; 16]>(across * down)?;
        contents.open(*place, &mut file)?.read_exact(blocks.as_flattened_mut()).map_err(io_error)?;
        levels.push(Blocks { size: place.size, blocks });
    }
    Ok(Some(BlockFile { levels, filtered: contents.filtered }))
}

/// Writes a file of these levels, the smallest first, as the specification wants. Errors: IO.
pub(super) fn write(levels: &[Blocks], filtered: bool, out: &mut impl Write) -> Result<()> {
    let format = Format::BC6H_UFLOAT_BLOCK;
    let mut pairs = Vec::new();
    pair(&mut pairs, "KTXorientation", "rd");
    pair(&mut pairs, "KTXwriter", concat!("bhr ", env!("CARGO_PKG_VERSION")));
    if filtered {
        pair(&mut pairs, FILTERED, "1");
    }
    let described_at = Header::LENGTH + levels.len() * LevelIndex::LENGTH;
    let pairs_at = described_at + DESCRIPTION.as_flattened().len();
    let mut places = vec![(0, 0); levels.len()];
    let mut end = (pairs_at + pairs.len()) as u64;
    for (place, level) in places.iter_mut().zip(levels).rev() {
        let bytes = level.blocks.as_flattened().len() as u64;
        *place = (end.next_multiple_of(ALIGNMENT), bytes);
        end = place.0 + bytes;
    }
    let [pixel_width, pixel_height] = levels.first().map_or([0, 0], |level| level.size);
    let header = Header {
        format: Some(format),
        type_size: 1,
        pixel_width,
        pixel_height,
        pixel_depth: 0,
        layer_count: 0,
        face_count: 1,
        level_count: levels.len() as u32,
        supercompression_scheme: None,
        index: Index {
            dfd_byte_offset: described_at as u32,
            dfd_byte_length: DESCRIPTION.as_flattened().len() as u32,
            kvd_byte_offset: pairs_at as u32,
            kvd_byte_length: pairs.len() as u32,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let mut written = 0;
    let mut put = |bytes: &[u8]| {
        written += bytes.len() as u64;
        out.write_all(bytes).map_err(io_error).map(|()| written)
    };
    put(&header.as_bytes())?;
    for (byte_offset, byte_length) in &places {
        let (byte_offset, byte_length) = (*byte_offset, *byte_length);
        put(&LevelIndex { byte_offset, byte_length, uncompressed_byte_length: byte_length }.as_bytes())?;
    }
    put(DESCRIPTION.as_flattened())?;
    let mut at = put(&pairs)?;
    for ((offset, _), level) in places.iter().zip(levels).rev() {
        // Less than an alignment.
        put(&[0; ALIGNMENT as usize][..(offset - at) as usize])?;
        at = put(level.blocks.as_flattened())?;
    }
    Ok(())
}

/// Appends a key and a text to a list of them, which is to be in the order of the keys.
fn pair(list: &mut Vec<u8>, key: &str, value: &str) {
    let length = key.len() + value.len() + 2;
    list.extend_from_slice(&(length as u32).to_le_bytes());
    for text in [key, value] {
        list.extend_from_slice(text.as_bytes());
        list.push(0);
    }
    list.resize(list.len().next_multiple_of(4), 0);
}
