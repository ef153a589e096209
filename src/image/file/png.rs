// SPDX-License-Identifier: MIT OR Apache-2.0
//! PNG by the `png` crate, row by row: no second copy of the picture, neither read nor written.

use super::loaded::{Loaded, Pixels, linear_codes};
use super::support::{io_error, pixel_count, probe, zeros};
use crate::error::Result;
use crate::image::memory::{ImageRef, PixelFormat};
use ::png::{
    BitDepth, ColorType, Compression, Decoder, Encoder, InterlaceInfo, Limits, Transformations, expand_interlaced_row,
};
use std::io::{BufRead, Seek, SeekFrom, Write};

/// The bytes that the decoder may hold besides two rows: its own default.
const MAX_CHUNK_BYTES: usize = 64 << 20;

/// Errors: IO; OUT_OF_MEMORY.
pub(super) fn read(mut file: impl BufRead + Seek) -> Result<Loaded> {
    let length = file.seek(SeekFrom::End(0)).and_then(|length| file.rewind().map(|()| length)).map_err(io_error)?;
    let mut decoder = Decoder::new_with_limits(file, Limits { bytes: MAX_CHUNK_BYTES });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(io_error)?;
    let (width, height) = header.size();
    let (format, pixel_bytes) = match header.bit_depth {
        BitDepth::Sixteen => (PixelFormat::Rgba32F, 16),
        _ => (PixelFormat::Rgba8Srgb, 4),
    };
    let count = pixel_count(width.into(), height.into(), format)?;
    let (mut pixels, codes) = match format {
        PixelFormat::Rgba32F => (Pixels::Floats(zeros(4 * count)?), linear_codes()?),
        _ => (Pixels::Bytes(zeros(4 * count)?), Vec::new()),
    };
    let row_bytes = width as usize * pixel_bytes;
    let mut wide = zeros::<u32>(row_bytes / 4)?;
    let wide: &mut [u8] = bytemuck::cast_slice_mut(&mut wide);
    // The decoder holds rows, filtered and unfiltered, of at most 8 bytes a pixel, and chunks in a vector that
    // doubles as they come in.
    probe(64 * u64::from(width) + 2 * length.min(MAX_CHUNK_BYTES as u64))?;

    let mut reader = decoder.read_info().map_err(io_error)?;
    let (color, _) = reader.output_color_type();
    let bytes = pixels.as_mut_bytes();
    let mut rows = bytes.chunks_exact_mut(row_bytes);
    if reader.info().interlaced {
        while let Some(row) = reader.next_interlaced_row().map_err(io_error)? {
            let wide = widen(row.data(), color, &codes, wide);
            if let InterlaceInfo::Adam7(place) = row.interlace() {
                expand_interlaced_row(bytes, row_bytes, wide, place, 8 * pixel_bytes as u8);
            }
        }
    } else {
        while let Some(row) = reader.next_row().map_err(io_error)? {
            if let Some(out) = rows.next() {
                widen(row.data(), color, &codes, out);
            }
        }
    }
    Ok(Loaded { format, width, height, pixels })
}

/// Turns a row's samples into RGBA: bytes, or with `codes` from 16-bit codes into floats. Returns the part of `out`
/// that was written.
fn widen<'a>(row: &[u8], color: ColorType, codes: &[f32], out: &'a mut [u8]) -> &'a [u8] {
    if codes.is_empty() {
        let written = row.len() / color.samples() * 4;
        let pixels = out.as_chunks_mut::<4>().0.iter_mut();
        match color {
            ColorType::Grayscale => pixels.zip(row).for_each(|(out, l)| *out = [*l, *l, *l, 255]),
            ColorType::GrayscaleAlpha => {
                pixels.zip(row.as_chunks().0).for_each(|(out, [l, a])| *out = [*l, *l, *l, *a]);
            }
            ColorType::Rgb => pixels.zip(row.as_chunks().0).for_each(|(out, [r, g, b])| *out = [*r, *g, *b, 255]),
            ColorType::Rgba => pixels.zip(row.as_chunks().0).for_each(|(out, rgba)| *out = *rgba),
            // The decoder has expanded the samples.
            ColorType::Indexed => {}
        }
        return &out[..written.min(out.len())];
    }
    let samples = row.as_chunks::<2>().0;
    let light = |code: [u8; 2]| codes[usize::from(u16::from_be_bytes(code))];
    let alpha = |code: [u8; 2]| f32::from(u16::from_be_bytes(code)) / 65535.0;
    let written = samples.len() / color.samples() * 16;
    let pixels = out.as_chunks_mut::<16>().0.iter_mut();
    let pack = |rgba: [f32; 4]| bytemuck::cast::<[f32; 4], [u8; 16]>(rgba);
    match color {
        ColorType::Grayscale => pixels.zip(samples).for_each(|(out, l)| {
            let l = light(*l);
            *out = pack([l, l, l, 1.0]);
        }),
        ColorType::GrayscaleAlpha => pixels.zip(samples.as_chunks().0).for_each(|(out, [l, a])| {
            let l = light(*l);
            *out = pack([l, l, l, alpha(*a)]);
        }),
        ColorType::Rgb => pixels
            .zip(samples.as_chunks().0)
            .for_each(|(out, [r, g, b])| *out = pack([light(*r), light(*g), light(*b), 1.0])),
        ColorType::Rgba => pixels
            .zip(samples.as_chunks().0)
            .for_each(|(out, [r, g, b, a])| *out = pack([light(*r), light(*g), light(*b), alpha(*a)])),
        ColorType::Indexed => {}
    }
    &out[..written.min(out.len())]
}

/// Writes an 8-bit image, alpha as it is. Errors: IO; OUT_OF_MEMORY.
pub(super) fn write(image: &ImageRef<'_>, file: impl Write) -> Result<()> {
    let mut row = zeros::<u8>(4 * image.width() as usize)?;
    // The encoder holds the rows that filters compare, and one chunk.
    probe(16 * u64::from(image.width()) + (1 << 20))?;
    let mut encoder = Encoder::new(file, image.width(), image.height());
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().map_err(io_error)?;
    let mut stream = writer.stream_writer().map_err(io_error)?;
    for y in 0..image.height() {
        let given = image.row(y);
        if image.format() == PixelFormat::Bgra8Srgb {
            for (out, [b, g, r, a]) in row.as_chunks_mut().0.iter_mut().zip(given.as_chunks().0) {
                *out = [*r, *g, *b, *a];
            }
            stream.write_all(&row).map_err(io_error)?;
        } else {
            stream.write_all(given).map_err(io_error)?;
        }
    }
    stream.finish().map_err(io_error)?;
    writer.finish().map_err(io_error)
}
