// SPDX-License-Identifier: MIT OR Apache-2.0
//! All channels of an OpenEXR file of one part, each as the numbers that the file has, and its attributes: for those
//! who put files of layers together. Knows no colours.

use super::exr::{BLOCKS_AT_A_TIME, HeaderLimiter, block_bytes, check, header_error};
use super::layer::{Attribute, Channels, Values};
use super::support::{io_error, pixel_count, probe, zeros};
use crate::error::{Error, Result};
use crate::image::ColourSpace;
use crate::image::memory::PixelFormat;
use ::exr::block::chunk::CompressedBlock;
use ::exr::block::reader::ChunksReader;
use ::exr::block::{self, BlockIndex, UncompressedBlock};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{AttributeValue, SampleType};
use ::exr::meta::header::Header;
use std::cell::Cell;
use std::io::{Read, Seek};

/// Errors: as those of `exr::read`, but that what is unpacked has the limit of memory only, because all of it is handed
/// out; and UNSUPPORTED for a file of several parts, whose data window is not its display window, in tiles, or with a
/// channel of whole numbers.
pub(super) fn read(file: impl Read + Seek) -> Result<Channels> {
    let in_headers = Cell::new(true);
    let reader = block::read(HeaderLimiter::new(file, &in_headers), false).map_err(header_error)?;
    in_headers.set(false);
    check(reader.headers())?;
    let [header] = reader.headers() else {
        return Err(Error::unsupported(format!("it has {} parts; files of one are read", reader.headers().len())));
    };
    let mut channels = claimed(header)?;
    probe(BLOCKS_AT_A_TIME * block_bytes(header))?;
    let types = header.channels.list.iter().map(|channel| channel.sample_type).collect::<Vec<_>>();
    let mut missing = header.chunk_count;
    let mut seen = zeros::<u8>(missing)?;
    let mut chunks = reader.all_chunks(false).map_err(io_error)?;
    while let Some(chunk) = chunks.next() {
        let chunk = chunk.map_err(io_error)?;
        if !matches!(chunk.compressed_block, CompressedBlock::ScanLine(_)) {
            return Err(Error::unsupported("it has tiles; files of scan lines are read"));
        }
        let block = UncompressedBlock::decompress_chunk(chunk, chunks.meta_data(), false).map_err(io_error)?;
        let rows = chunks.meta_data().headers.first().map_or(1, |header| header.max_block_pixel_size().y()).max(1);
        match seen.get_mut(block.index.pixel_position.y() / rows) {
            Some(seen) if *seen == 0 => *seen = 1,
            _ => return Err(io_error("it has a block of scan lines twice")),
        }
        missing -= 1;
        put(&mut channels, &block, &types)?;
    }
    if missing > 0 {
        return Err(io_error(format!("{missing} of its blocks are missing")));
    }
    Ok(channels)
}

/// Zeros for all that a header claims. Errors: UNSUPPORTED; IO past the limits; OUT_OF_MEMORY.
fn claimed(header: &Header) -> Result<Channels> {
    let display = header.shared_attributes.display_window;
    let Vec2(width, height) = header.layer_size;
    if display.size != header.layer_size || display.position != header.own_attributes.layer_position {
        return Err(Error::unsupported("its data window is not its display window"));
    }
    pixel_count(width as u64, height as u64, PixelFormat::Rgba32F)?;
    let mut list = Vec::with_capacity(header.channels.list.len());
    for channel in &header.channels.list {
        let name = channel.name.to_string();
        let values = match channel.sample_type {
            SampleType::F16 => Values::Halves(zeros(width * height)?),
            SampleType::F32 => Values::Floats(zeros(width * height)?),
            SampleType::U32 => {
                return Err(Error::unsupported(format!("its channel {name} has whole numbers; floats are read")));
            }
        };
        list.push((name, values));
    }
    let attributes = header.own_attributes.other.iter().filter_map(|(name, value)| {
        let value = match value {
            AttributeValue::F64(number) => Attribute::Number(*number),
            AttributeValue::Text(words) => Attribute::Text(words.to_string()),
            _ => return None,
        };
        Some((name.to_string(), value))
    });
    let mut attributes = attributes.collect::<Vec<_>>();
    attributes.sort_by(|(a, _), (b, _)| a.cmp(b));
    let space = super::exr::primaries(header).and_then(ColourSpace::of).unwrap_or_default();
    Ok(Channels { width: width as u32, height: height as u32, list, attributes, space })
}

/// Takes a block of scan lines, whose values are in this machine's byte order. Errors: IO for one that is not
/// within the picture.
fn put(channels: &mut Channels, block: &UncompressedBlock, types: &[SampleType]) -> Result<()> {
    let BlockIndex { pixel_position: Vec2(left, top), pixel_size: Vec2(width, height), .. } = block.index;
    let whole = channels.width as usize;
    if left != 0 || width != whole || top + height > channels.height as usize {
        return Err(io_error("a block lies outside of its picture"));
    }
    let mut rest = block.data.as_slice();
    for y in top..top + height {
        let row = y * whole..(y + 1) * whole;
        for ((_, values), kind) in channels.list.iter_mut().zip(types) {
            let Some((line, after)) = rest.split_at_checked(width * kind.bytes_per_sample()) else {
                return Err(io_error("a block is shorter than its pixels"));
            };
            rest = after;
            let to: &mut [u8] = match values {
                Values::Halves(halves) => bytemuck::cast_slice_mut(&mut halves[row.clone()]),
                Values::Floats(floats) => bytemuck::cast_slice_mut(&mut floats[row.clone()]),
            };
            to.copy_from_slice(line);
        }
    }
    Ok(())
}
