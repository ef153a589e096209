// SPDX-License-Identifier: MIT OR Apache-2.0
//! Float images as the named channels of one OpenEXR part, as every program reads them: scan lines from the top down,
//! ZIP, their primaries, and attributes that say how it was made. Blocks are deflated by `deflate`, which takes a
//! fraction of the time of exr's own deflate. Knows no scenes.

use super::deflate::Deflater;
use super::layer::{Attribute, Channels, Effort, Layer, Values};
use super::ordered::Ordered;
use super::support::{io_error, probe};
use crate::error::{Error, Result};
use crate::image::ColourSpace;
use crate::image::memory::{ImageRef, PixelFormat};
use ::exr::block;
use ::exr::block::BlockIndex;
use ::exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
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
    values: Source<'a>,
}

#[derive(Clone, Copy)]
enum Source<'a> {
    /// The value of this number in each of the image's pixels.
    Image(&'a ImageRef<'a>, usize),
    /// Values of their own, in rows of so many.
    Values(&'a Values, usize),
}

impl Source<'_> {
    fn sample_type(self) -> SampleType {
        match self {
            Self::Image(image, _) if image.format() == PixelFormat::Rgba16F => SampleType::F16,
            Self::Values(Values::Halves(_), _) => SampleType::F16,
            Self::Image(..) | Self::Values(Values::Floats(_), _) => SampleType::F32,
        }
    }

    /// The bytes from one value to the next, and the number of the value among those.
    fn pixel(self) -> (usize, usize) {
        match self {
            Self::Image(image, index) => (image.format().bytes_per_pixel(), index),
            Self::Values(..) => (self.sample_type().bytes_per_sample(), 0),
        }
    }

    /// The pixels of a row.
    fn row(&self, y: usize) -> &[u8] {
        match self {
            Self::Image(image, _) => image.row(y as u32),
            Self::Values(Values::Halves(halves), width) => bytemuck::cast_slice(&halves[y * width..(y + 1) * width]),
            Self::Values(Values::Floats(floats), width) => bytemuck::cast_slice(&floats[y * width..(y + 1) * width]),
        }
    }
}

/// Writes images of one size. Errors: INVALID_ARGUMENT for two channels of one name; IO;
/// OUT_OF_MEMORY.
pub(super) fn write(
    layers: &[Layer<'_>],
    about: (&[(String, Attribute)], ColourSpace),
    effort: Effort,
    file: impl Write + Seek,
) -> Result<()> {
    let named = |layer: &'_ Layer<'_>| layer.channels.len();
    let mut channels = Vec::with_capacity(layers.iter().map(named).sum());
    for Layer { channels: names, image } in layers {
        let named = names.iter().zip(0..);
        channels.extend(named.map(|(name, index)| Channel { name, values: Source::Image(image, index) }));
    }
    let Some(Layer { image, .. }) = layers.first() else { return Ok(()) };
    let size = Vec2(image.width() as usize, image.height() as usize);
    write_channels(size, channels, about, effort, file)
}

/// Writes an image as R, G, B, and A where it has alpha; a single value becomes grey. Errors: IO; OUT_OF_MEMORY.
pub(super) fn write_image(image: &ImageRef<'_>, space: ColourSpace, file: impl Write + Seek) -> Result<()> {
    let channels: &[(&str, usize)] = match image.format() {
        PixelFormat::R32F => &[("R", 0), ("G", 0), ("B", 0)],
        _ => &[("R", 0), ("G", 1), ("B", 2), ("A", 3)],
    };
    let channels = channels.iter().map(|(name, index)| Channel { name, values: Source::Image(image, *index) });
    let size = Vec2(image.width() as usize, image.height() as usize);
    write_channels(size, channels.collect(), (&[], space), Effort::default(), file)
}

/// Writes channels as they were read. Errors: as [`write`]; INVALID_ARGUMENT for a channel with another number of
/// values than the picture has pixels.
pub(super) fn write_values(channels: &Channels, effort: Effort, file: impl Write + Seek) -> Result<()> {
    let size = Vec2(channels.width as usize, channels.height as usize);
    for (name, values) in &channels.list {
        let count = match values {
            Values::Halves(halves) => halves.len(),
            Values::Floats(floats) => floats.len(),
        };
        if count != size.area() {
            return Err(Error::argument(format!("channel {name} has {count} values for {} pixels", size.area())));
        }
    }
    let list = channels.list.iter().map(|(name, values)| Channel { name, values: Source::Values(values, size.0) });
    write_channels(size, list.collect(), (&channels.attributes, channels.space), effort, file)
}

/// Writes channels of images of one size. Errors: as [`write`].
fn write_channels(
    size: Vec2<usize>,
    mut channels: Vec<Channel<'_>>,
    (attributes, space): (&[(String, Attribute)], ColourSpace),
    effort: Effort,
    file: impl Write + Seek,
) -> Result<()> {
    // Files list channels sorted by name, byte by byte.
    channels.sort_by_key(|channel| channel.name);
    if let Some([twice, _]) = channels.array_windows().find(|[a, b]| a.name == b.name) {
        return Err(Error::argument(format!("two outputs would both be the channel {}", twice.name)));
    }
    let list = channels.iter().map(|c| ChannelDescription::new(c.name, c.values.sample_type(), false));
    let other = attributes.iter().map(|(name, value)| {
        let value = match value {
            Attribute::Number(number) => AttributeValue::F64(*number),
            Attribute::Text(words) => AttributeValue::Text(text(words)),
        };
        (text(name), value)
    });
    let own = LayerAttributes { software_name: Some(Text::from("bhr")), other: other.collect(), ..Default::default() };
    let [red, green, blue, white] = space.primaries().0.map(|[x, y]| Vec2(x as f32, y as f32));
    let mut shared = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    shared.chromaticities = Some(Chromaticities { red, green, blue, white });
    let header = Header::new(Text::from("image"), size, list.collect())
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(own)
        .with_shared_attributes(shared);
    // The encoder holds a block's values, their bytes in another order, and what they are packed to.
    let line = size.0 as u64 * channels.iter().map(|c| c.values.sample_type().bytes_per_sample() as u64).sum::<u64>();
    probe(4 * Compression::ZIP16.scan_lines_per_block() as u64 * line)?;
    let written = block::write(Ordered::new(file), std::iter::once(header).collect(), true, |meta, chunks| {
        let mut space = Space { apart: Vec::new(), differences: Vec::new(), deflater: Deflater::new(effort) };
        for (index, at) in meta.enumerate_ordered_header_block_indices() {
            chunks.write_chunk(index, space.packed(&channels, at))?;
        }
        Ok(())
    });
    written.map_err(io_error)
}

/// The memory for one block after the other.
struct Space {
    apart: Vec<u8>,
    differences: Vec<u8>,
    deflater: Deflater,
}

impl Space {
    /// A block as ZIP has it (OpenEXR, "Technical Introduction": Data Compression): the even bytes of all values, then
    /// the odd ones (of halves the low and the high ones), as differences from the one before, deflated; where that is
    /// no shorter, the values as they are.
    fn packed(&mut self, channels: &[Channel<'_>], at: BlockIndex) -> Chunk {
        let Self { apart, differences, deflater } = self;
        split(channels, at, apart);
        differences.resize(apart.len(), 0);
        // 128 is no difference; the first byte is itself.
        if let ([first, rest @ ..], [before, ..]) = (&mut differences[..], &apart[..]) {
            *first = *before;
            for (to, [before, this]) in rest.iter_mut().zip(apart.array_windows()) {
                *to = this.wrapping_sub(*before).wrapping_add(128);
            }
        }
        let packed = deflater.stream(differences).filter(|packed| packed.len() < apart.len());
        let compressed_pixels_le = packed.map_or_else(|| joined(apart), <[u8]>::to_vec);
        // The data window begins at 0, and sides of images are within 2^20.
        let y_coordinate = i32::try_from(at.pixel_position.y()).unwrap_or_default();
        let block = CompressedScanLineBlock { y_coordinate, compressed_pixels_le };
        Chunk { layer_index: at.layer, compressed_block: CompressedBlock::ScanLine(block) }
    }
}

/// The values whose even and odd bytes `apart` has.
fn joined(apart: &[u8]) -> Vec<u8> {
    let (even, odd) = apart.split_at(apart.len() / 2);
    even.iter().zip(odd).flat_map(|(even, odd)| [*even, *odd]).collect()
}

/// The bytes that the format's texts may have; others become question marks.
fn text(words: &str) -> Text {
    let known = words.bytes().map(|byte| if byte.is_ascii() && byte > 0 { byte } else { b'?' });
    Text::from_bytes_unchecked(known.collect())
}

/// The even bytes of the values of scan lines, then the odd ones: row by row, in each row channel by channel, little
/// ends first.
fn split(channels: &[Channel<'_>], at: BlockIndex, apart: &mut Vec<u8>) {
    let BlockIndex { pixel_position: Vec2(left, top), pixel_size: Vec2(width, height), .. } = at;
    let line = width * channels.iter().map(|c| c.values.sample_type().bytes_per_sample()).sum::<usize>();
    apart.resize(line * height, 0);
    let (mut even, mut odd) = apart.split_at_mut(line * height / 2);
    for y in top..top + height {
        for Channel { values, .. } in channels {
            let ((pixel, index), value) = (values.pixel(), values.sample_type().bytes_per_sample());
            let row = &values.row(y)[left * pixel..(left + width) * pixel];
            let half = width * value / 2;
            let (to_even, after_even) = even.split_at_mut(half);
            let (to_odd, after_odd) = odd.split_at_mut(half);
            (even, odd) = (after_even, after_odd);
            match (value, pixel) {
                (2, 8) => gather_halves(row, index, to_even, to_odd),
                (2, _) => gather::<2, 2>(row, 0, to_even, to_odd),
                (4, 16) => gather::<4, 16>(row, index, to_even, to_odd),
                // One value a pixel.
                _ => gather::<4, 4>(row, 0, to_even, to_odd),
            }
        }
    }
}

/// [`gather`] of halves in pixels of four, eight at a time.
fn gather_halves(row: &[u8], index: usize, even: &mut [u8], odd: &mut [u8]) {
    let (pixels, rest) = row.as_chunks::<64>();
    let ((evens, last_even), (odds, last_odd)) = (even.as_chunks_mut::<8>(), odd.as_chunks_mut::<8>());
    for ((pixels, evens), odds) in pixels.iter().zip(evens).zip(odds) {
        let (mut low, mut high) = (0, 0);
        for (pixel, place) in pixels.as_chunks::<8>().0.iter().zip(0..) {
            let value = u64::from_le_bytes(*pixel) >> (16 * index);
            let value = if cfg!(target_endian = "little") { value } else { u64::from((value as u16).swap_bytes()) };
            low |= (value & 0xff) << (8 * place);
            high |= (value >> 8 & 0xff) << (8 * place);
        }
        (*evens, *odds) = (low.to_le_bytes(), high.to_le_bytes());
    }
    gather::<2, 8>(rest, index, last_even, last_odd);
}

/// The even and the odd bytes of one channel's values, of V bytes, of pixels of P bytes.
fn gather<const V: usize, const P: usize>(row: &[u8], index: usize, even: &mut [u8], odd: &mut [u8]) {
    let (pixels, _) = row.as_chunks::<P>();
    for ((pixel, even), odd) in pixels.iter().zip(even.chunks_exact_mut(V / 2)).zip(odd.chunks_exact_mut(V / 2)) {
        for byte in 0..V / 2 {
            // The format's values begin with their low bytes, whatever the processor's do.
            let place = |of: usize| index * V + if cfg!(target_endian = "little") { of } else { V - 1 - of };
            (even[byte], odd[byte]) = (pixel[place(2 * byte)], pixel[place(2 * byte + 1)]);
        }
    }
}
