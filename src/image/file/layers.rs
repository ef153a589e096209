// SPDX-License-Identifier: MIT OR Apache-2.0
//! Float images as the named channels of one OpenEXR part, as every program reads them: scan lines from the top down,
//! ZIP, Rec. 709, and attributes that say how it was made. Knows no scenes.

use super::colour::Primaries;
use super::layer::{Attribute, Layer};
use super::support::{io_error, probe};
use crate::error::{Error, Result};
use crate::image::memory::{ImageRef, PixelFormat};
use ::exr::block;
use ::exr::block::BlockIndex;
use ::exr::block::writer::ChunksWriter;
use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{
    AttributeValue, ChannelDescription, Chromaticities, IntegerBounds, LineOrder, SampleType, Text,
};
use ::exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use std::io::{Seek, Write};

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
pub(super) fn write(layers: &[Layer<'_>], attributes: &[(String, Attribute)], file: impl Write + Seek) -> Result<()> {
    let named = |layer: &'_ Layer<'_>| layer.channels.len();
    let mut channels = Vec::with_capacity(layers.iter().map(named).sum());
    for Layer { channels: names, image } in layers {
        channels.extend(names.iter().zip(0..).map(|(name, index)| Channel { name, image, index }));
    }
    write_channels(channels, attributes, file)
}

/// Writes an image as R, G, B, and A where it has alpha; a single value becomes grey. Errors: IO; OUT_OF_MEMORY.
pub(super) fn write_image(image: &ImageRef<'_>, file: impl Write + Seek) -> Result<()> {
    let channels: &[(&str, usize)] = match image.format() {
        PixelFormat::R32F => &[("R", 0), ("G", 0), ("B", 0)],
        _ => &[("R", 0), ("G", 1), ("B", 2), ("A", 3)],
    };
    write_channels(channels.iter().map(|(name, index)| Channel { name, image, index: *index }).collect(), &[], file)
}

/// Writes channels of images of one size. Errors: as [`write`].
fn write_channels(
    mut channels: Vec<Channel<'_>>,
    attributes: &[(String, Attribute)],
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
    let written = block::write(file, std::iter::once(header).collect(), true, |meta, chunks| {
        let mut compressor = chunks.sequential_blocks_compressor(&meta);
        for (index, block) in meta.collect_ordered_block_data(|index| lines(&channels, index)) {
            compressor.compress_block(index, block)?;
        }
        Ok(())
    });
    written.map_err(io_error)
}

/// The bytes that the format's texts may have; others become question marks.
fn text(words: &str) -> Text {
    let known = words.bytes().map(|byte| if byte.is_ascii() && byte > 0 { byte } else { b'?' });
    Text::from_bytes_unchecked(known.collect())
}

/// The values of scan lines: row by row, in each row channel by channel.
fn lines(channels: &[Channel<'_>], at: BlockIndex) -> Vec<u8> {
    let BlockIndex { pixel_position: Vec2(left, top), pixel_size: Vec2(width, height), .. } = at;
    let mut values = Vec::with_capacity(4 * width * height * channels.len());
    for y in top..top + height {
        for Channel { image, index, .. } in channels {
            let (pixel, value) = (image.format().bytes_per_pixel(), image.format().channel_bytes());
            let row = &image.row(y as u32)[left * pixel..(left + width) * pixel];
            for pixel in row.chunks_exact(pixel) {
                values.extend_from_slice(&pixel[index * value..(index + 1) * value]);
            }
        }
    }
    values
}
