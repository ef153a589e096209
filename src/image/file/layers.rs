// SPDX-License-Identifier: MIT OR Apache-2.0
//! Float images as the named channels of one OpenEXR part, as every program reads them: scan lines from the top down,
//! ZIP, Rec. 709, and attributes that say how it was made. Blocks are deflated by zlib-rs, which takes a third of the
//! time of exr's own deflate and makes them no larger. Knows no scenes.

use super::colour::Primaries;
use super::layer::{Attribute, Effort, Layer};
use super::ordered::Ordered;
use super::support::{io_error, probe};
use crate::error::{Error, Result};
use crate::image::memory::{ImageRef, PixelFormat};
use ::exr::block;
use ::exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use ::exr::block::writer::ChunksWriter;
use ::exr::block::{BlockIndex, UncompressedBlock};
use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{
    AttributeValue, ChannelDescription, Chromaticities, IntegerBounds, LineOrder, SampleType, Text,
};
use ::exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use std::io::{Seek, Write};
use zlib_rs::{DeflateConfig, ReturnCode};

/// One channel of the file: its name, and where its values are.
struct Channel<'a> {
    name: &'a str,
    image: &'a ImageRef<'a>,
    /// Its number in the image's pixels.
    index: usize,
}

impl Channel<'_> {
    fn sample_type(&self) -> SampleType {
        if self.image.format() == PixelFormat::Rgba16F { SampleType::F16 } else { SampleType::F32 }
    }
}

/// Writes images of one size. Errors: INVALID_ARGUMENT for two channels of one name; IO;
/// OUT_OF_MEMORY.
pub(super) fn write(
    layers: &[Layer<'_>],
    attributes: &[(String, Attribute)],
    effort: Effort,
    file: impl Write + Seek,
) -> Result<()> {
    let named = |layer: &'_ Layer<'_>| layer.channels.len();
    let mut channels = Vec::with_capacity(layers.iter().map(named).sum());
    for Layer { channels: names, image } in layers {
        channels.extend(names.iter().zip(0..).map(|(name, index)| Channel { name, image, index }));
    }
    write_channels(channels, attributes, effort, file)
}

/// Writes an image as R, G, B, and A where it has alpha; a single value becomes grey. Errors: IO; OUT_OF_MEMORY.
pub(super) fn write_image(image: &ImageRef<'_>, file: impl Write + Seek) -> Result<()> {
    let channels: &[(&str, usize)] = match image.format() {
        PixelFormat::R32F => &[("R", 0), ("G", 0), ("B", 0)],
        _ => &[("R", 0), ("G", 1), ("B", 2), ("A", 3)],
    };
    write_channels(
        channels.iter().map(|(name, index)| Channel { name, image, index: *index }).collect(),
        &[],
        Effort::default(),
        file,
    )
}

/// Writes channels of images of one size. Errors: as [`write`].
fn write_channels(
    mut channels: Vec<Channel<'_>>,
    attributes: &[(String, Attribute)],
    effort: Effort,
    file: impl Write + Seek,
) -> Result<()> {
    // Files list channels sorted by name, byte by byte.
    channels.sort_by_key(|channel| channel.name);
    if let Some([twice, _]) = channels.array_windows().find(|[a, b]| a.name == b.name) {
        return Err(Error::argument(format!("two outputs would both be the channel {}", twice.name)));
    }
    let Some(first) = channels.first() else { return Ok(()) };
    let size = Vec2(first.image.width() as usize, first.image.height() as usize);
    let list = channels.iter().map(|c| ChannelDescription::new(c.name, c.sample_type(), false));
    let other = attributes.iter().map(|(name, value)| {
        let value = match value {
            Attribute::Number(number) => AttributeValue::F64(*number),
            Attribute::Text(words) => AttributeValue::Text(text(words)),
        };
        (text(name), value)
    });
    let own = LayerAttributes { software_name: Some(Text::from("bhr")), other: other.collect(), ..Default::default() };
    let [red, green, blue, white] = Primaries::REC709.0.map(|[x, y]| Vec2(x as f32, y as f32));
    let mut shared = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    shared.chromaticities = Some(Chromaticities { red, green, blue, white });
    let header = Header::new(Text::from("image"), size, list.collect())
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(own)
        .with_shared_attributes(shared);
    // The encoder holds a block's values, their bytes in another order, and what they are packed to.
    let line = size.0 as u64 * channels.iter().map(|c| c.image.format().channel_bytes() as u64).sum::<u64>();
    probe(4 * Compression::ZIP16.scan_lines_per_block() as u64 * line)?;
    let written = block::write(Ordered::new(file), std::iter::once(header).collect(), true, |meta, chunks| {
        for (index, block) in meta.collect_ordered_block_data(|index| lines(&channels, index)) {
            // The format's bytes are little-endian: elsewhere the crate turns them round.
            let chunk = if cfg!(target_endian = "little") {
                packed(block, effort)
            } else {
                block.compress_to_chunk(&meta.headers)?
            };
            chunks.write_chunk(index, chunk)?;
        }
        Ok(())
    });
    written.map_err(io_error)
}

/// A block as ZIP has it (OpenEXR, "Technical Introduction": Data Compression): the low bytes of all values, then the
/// high ones (of floats, even bytes and odd ones), as differences from the one before, deflated; where that is no
/// shorter, as it is.
fn packed(UncompressedBlock { index, data }: UncompressedBlock, effort: Effort) -> Chunk {
    // The last value of an odd number of bytes, which no format of values has, would be lost.
    let pairs = data.chunks_exact(2);
    let mut apart = vec![0_u8; data.len()];
    let (low, high) = apart.split_at_mut(data.len() / 2);
    for ((low, high), pair) in low.iter_mut().zip(high).zip(pairs) {
        (*low, *high) = (pair[0], pair[1]);
    }
    // 128 is no difference; the first byte is itself.
    let differences = apart.array_windows().map(|[before, this]| this.wrapping_sub(*before).wrapping_add(128));
    let apart = apart.iter().take(1).copied().chain(differences).collect::<Vec<u8>>();
    let mut space = vec![0; zlib_rs::compress_bound(apart.len())];
    let config = DeflateConfig::new(effort.0);
    let (deflated, done) = zlib_rs::compress_slice(&mut space, &apart, config);
    let count = deflated.len();
    let shorter = done == ReturnCode::Ok && count < data.len();
    space.truncate(count);
    let compressed_pixels_le = if shorter { space } else { data };
    // The data window begins at 0, and sides of images are within 2^20.
    let y_coordinate = i32::try_from(index.pixel_position.y()).unwrap_or_default();
    let block = CompressedScanLineBlock { y_coordinate, compressed_pixels_le };
    Chunk { layer_index: index.layer, compressed_block: CompressedBlock::ScanLine(block) }
}

/// The bytes that the format's texts may have; others become question marks.
fn text(words: &str) -> Text {
    let known = words.bytes().map(|byte| if byte.is_ascii() && byte > 0 { byte } else { b'?' });
    Text::from_bytes_unchecked(known.collect())
}

/// The values of scan lines: row by row, in each row channel by channel.
fn lines(channels: &[Channel<'_>], at: BlockIndex) -> Vec<u8> {
    let BlockIndex { pixel_position: Vec2(left, top), pixel_size: Vec2(width, height), .. } = at;
    let line = width * channels.iter().map(|channel| channel.image.format().channel_bytes()).sum::<usize>();
    let mut values = vec![0; line * height];
    let mut rest = &mut values[..];
    for y in top..top + height {
        for Channel { image, index, .. } in channels {
            let (pixel, value) = (image.format().bytes_per_pixel(), image.format().channel_bytes());
            let row = &image.row(y as u32)[left * pixel..(left + width) * pixel];
            let (to, after) = rest.split_at_mut(width * value);
            rest = after;
            match (value, pixel) {
                (2, 8) => gather::<2, 8>(row, *index, to),
                (4, 16) => gather::<4, 16>(row, *index, to),
                // One value a pixel.
                _ => to.copy_from_slice(row),
            }
        }
    }
    values
}

/// The values of one channel, of V bytes, of pixels of P bytes.
fn gather<const V: usize, const P: usize>(row: &[u8], index: usize, to: &mut [u8]) {
    let (pixels, _) = row.as_chunks::<P>();
    let (values, _) = to.as_chunks_mut::<V>();
    for (value, pixel) in values.iter_mut().zip(pixels) {
        value.copy_from_slice(&pixel[index * V..][..V]);
    }
}
