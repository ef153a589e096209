// SPDX-License-Identifier: MIT OR Apache-2.0
//! PNG by the `png` crate, row by row: no second copy of the picture, neither read nor written.

use super::colour::Codes;
use super::layer::Alpha;
use super::loaded::{Loaded, Pixels, linear_to_srgb, srgb_to_linear};
use super::png_colours::{MAX_GROWTH, Profile, colours, find_profile};
use super::support::{io_error, pixel_count, probe, reserve, zeros};
use crate::error::Result;
use crate::image::memory::{ImageRef, PixelFormat};
use ::png::{
    BitDepth, ColorType, Compression, Decoder, Encoder, InterlaceInfo, Limits, Transformations, expand_interlaced_row,
};
use std::io::{BufRead, Seek, SeekFrom, Write};

/// The bytes that the decoder may hold besides two rows: its own default.
const MAX_CHUNK_BYTES: usize = 64 << 20;

/// Errors: IO; UNSUPPORTED for colours that are not read; OUT_OF_MEMORY.
pub(super) fn read(mut file: impl BufRead + Seek) -> Result<Loaded> {
    let length = file.seek(SeekFrom::End(0)).map_err(io_error)?;
    let profile = find_profile(&mut file)?;
    let mut decoder = Decoder::new_with_limits(file, Limits { bytes: MAX_CHUNK_BYTES });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let unpacked = match profile {
        Profile::Packed(bytes) => bytes * MAX_GROWTH,
        Profile::Absent | Profile::TooLong => {
            decoder.set_ignore_iccp_chunk(true);
            0
        }
    };
    let header = decoder.read_header_info().map_err(io_error)?;
    let (width, height) = header.size();
    let is_wide = header.bit_depth == BitDepth::Sixteen;
    let least = if is_wide { PixelFormat::Rgba32F } else { PixelFormat::Rgba8Srgb };
    pixel_count(width.into(), height.into(), least)?;
    // The decoder holds rows, filtered and unfiltered, of at most 8 bytes a pixel, chunks in a vector that doubles as
    // they come in, and a profile in another one.
    let held = 64 * u64::from(width) + 2 * length.min(MAX_CHUNK_BYTES as u64);
    probe(held + 2 * unpacked.min(MAX_CHUNK_BYTES as u64))?;
    let mut reader = decoder.read_info().map_err(io_error)?;

    let colours = colours(reader.info(), profile)?;
    let (format, pixel_bytes, codes) = match is_wide || !colours.is_srgb() {
        true => (PixelFormat::Rgba32F, 16, Some(colours.codes()?)),
        false => (PixelFormat::Rgba8Srgb, 4, None),
    };
    let count = pixel_count(width.into(), height.into(), format)?;
    let mut pixels = match format {
        PixelFormat::Rgba32F => Pixels::Floats(zeros(4 * count)?),
        _ => Pixels::Bytes(zeros(4 * count)?),
    };
    let row_bytes = width as usize * pixel_bytes;
    let (mut wide, mut doubled) = (zeros::<u32>(row_bytes / 4)?, reserve::<u8>(8 * width as usize)?);
    let wide: &mut [u8] = bytemuck::cast_slice_mut(&mut wide);
    probe(held)?;

    let (color, _) = reader.output_color_type();
    let mut put = |row: &[u8], out: &mut [u8]| match &codes {
        None => expand(row, color, out),
        Some(codes) if is_wide => develop(row, color, codes, out),
        Some(codes) => {
            // 8-bit codes are as bright as 16-bit ones that have them in both halves.
            doubled.clear();
            doubled.extend(row.iter().flat_map(|code| [*code, *code]));
            develop(&doubled, color, codes, out)
        }
    };
    let bytes = pixels.as_mut_bytes();
    let mut rows = bytes.chunks_exact_mut(row_bytes);
    if reader.info().interlaced {
        while let Some(row) = reader.next_interlaced_row().map_err(io_error)? {
            let written = put(row.data(), wide);
            if let InterlaceInfo::Adam7(place) = row.interlace() {
                expand_interlaced_row(bytes, row_bytes, &wide[..written], place, 8 * pixel_bytes as u8);
            }
        }
    } else {
        while let Some(row) = reader.next_row().map_err(io_error)? {
            if let Some(out) = rows.next() {
                put(row.data(), out);
            }
        }
    }
    Ok(Loaded { format, width, height, pixels })
}

/// Turns a row's 8-bit samples into RGBA. Returns the number of bytes that were written.
fn expand(row: &[u8], color: ColorType, out: &mut [u8]) -> usize {
    let written = row.len() / color.samples() * 4;
    let written = written.min(out.len());
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
    written
}

/// Turns a row's 16-bit samples into RGBA of floats, as `codes` have their light. Returns the number of bytes that were
/// written.
fn develop(row: &[u8], color: ColorType, codes: &Codes, out: &mut [u8]) -> usize {
    let samples = row.as_chunks::<2>().0;
    let code = |sample: &[u8; 2]| u16::from_be_bytes(*sample);
    let pack = |rgb: [&[u8; 2]; 3], alpha: Option<&[u8; 2]>| {
        let [r, g, b] = codes.light(rgb.map(code));
        let alpha = alpha.map_or(1.0, |alpha| f32::from(code(alpha)) / 65535.0);
        bytemuck::cast::<[f32; 4], [u8; 16]>([r, g, b, alpha])
    };
    let written = (samples.len() / color.samples() * 16).min(out.len());
    let pixels = out.as_chunks_mut::<16>().0.iter_mut();
    match color {
        ColorType::Grayscale => pixels.zip(samples).for_each(|(out, l)| *out = pack([l, l, l], None)),
        ColorType::GrayscaleAlpha => {
            pixels.zip(samples.as_chunks().0).for_each(|(out, [l, a])| *out = pack([l, l, l], Some(a)));
        }
        ColorType::Rgb => {
            pixels.zip(samples.as_chunks().0).for_each(|(out, [r, g, b])| *out = pack([r, g, b], None));
        }
        ColorType::Rgba => {
            pixels.zip(samples.as_chunks().0).for_each(|(out, [r, g, b, a])| *out = pack([r, g, b], Some(a)));
        }
        ColorType::Indexed => {}
    }
    written
}

/// Writes an 8-bit image. PNG's colours are those that a pixel has without its alpha: `alpha` says whether the image
/// has such ones, or premultiplied ones. Errors: IO; OUT_OF_MEMORY.
pub(super) fn write(image: &ImageRef<'_>, alpha: Alpha, file: impl Write) -> Result<()> {
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
        row.copy_from_slice(image.row(y));
        let pixels = row.as_chunks_mut::<4>().0;
        if image.format() == PixelFormat::Bgra8Srgb {
            pixels.iter_mut().for_each(|pixel| pixel.swap(0, 2));
        }
        if alpha == Alpha::Premultiplied {
            pixels.iter_mut().for_each(divide);
        }
        stream.write_all(&row).map_err(io_error)?;
    }
    stream.finish().map_err(io_error)?;
    writer.finish().map_err(io_error)
}

/// Writes an image of high dynamic range in 16 bits, with the chunk cICP (PNG, third edition, 11.3.2.6) that says what
/// its codes mean; without alpha, so that premultiplied light is that over black. Errors: as `write`.
pub(super) fn write_hdr(image: &ImageRef<'_>, file: impl Write) -> Result<()> {
    let mut row = zeros::<u8>(6 * image.width() as usize)?;
    probe(16 * u64::from(image.width()) + (1 << 20))?;
    let mut encoder = Encoder::new(file, image.width(), image.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Sixteen);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().map_err(io_error)?;
    // ITU-T H.273: primaries of Rec. 2020, the curve, no matrix, full range.
    let curve = if image.format() == PixelFormat::Rgb10A2Hlg { 18 } else { 16 };
    writer.write_chunk(::png::chunk::ChunkType(*b"cICP"), &[9, curve, 0, 1]).map_err(io_error)?;
    let mut stream = writer.stream_writer().map_err(io_error)?;
    for y in 0..image.height() {
        for (out, pixel) in row.as_chunks_mut::<6>().0.iter_mut().zip(image.row(y).as_chunks::<4>().0) {
            let word = u32::from_ne_bytes(*pixel);
            for (out, low) in out.as_chunks_mut::<2>().0.iter_mut().zip([0, 10, 20]) {
                // 10 bits, and their first 6 again: so 1023 becomes 65535.
                let code = word >> low & 1023;
                *out = ((code << 6 | code >> 4) as u16).to_be_bytes();
            }
        }
        stream.write_all(&row).map_err(io_error)?;
    }
    stream.finish().map_err(io_error)?;
    writer.finish().map_err(io_error)
}

/// Divides a pixel's light by its alpha, as light of sRGB codes: so the picture over a background in linear light is
/// that of the premultiplied one. Light beyond white is cut; where alpha is 0, only light that glares is lost.
fn divide(pixel: &mut [u8; 4]) {
    let [r, g, b, alpha] = *pixel;
    if alpha == 255 {
        return;
    }
    let straight = |code: u8| {
        let light = srgb_to_linear(f32::from(code) / 255.0) / (f32::from(alpha) / 255.0);
        (linear_to_srgb(light.min(1.0)) * 255.0).round() as u8
    };
    *pixel = if alpha == 0 { [0; 4] } else { [straight(r), straight(g), straight(b), alpha] };
}
