// SPDX-License-Identifier: MIT OR Apache-2.0
//! PBM, PGM and PPM by the `image` crate; PPM is written too.

use super::loaded::{Loaded, Pixels, linear_codes};
use super::support::{io_error, pixel_count, probe, reserve, zeros};
use crate::error::Result;
use crate::image::memory::{ImageRef, PixelFormat};
use ::image::codecs::pnm::{PnmDecoder, PnmEncoder, PnmSubtype, SampleEncoding};
use ::image::{ColorType, ExtendedColorType, ImageDecoder, ImageEncoder};
use std::cell::Cell;
use std::io::{self, BufRead, Read, Seek, SeekFrom, Write};

/// Longest header, bytes, with comments. The decoder keeps each word, however long it is.
const MAX_HEADER_BYTES: u64 = 64 << 10;

/// Errors: IO; OUT_OF_MEMORY.
pub(super) fn read(mut file: impl BufRead + Seek) -> Result<Loaded> {
    // The header is read twice. The first time only as many bytes as it may have are there, so the second time it is
    // no longer than that.
    PnmDecoder::new(Read::take(&mut file, MAX_HEADER_BYTES)).map_err(io_error)?;
    let header = file.stream_position().map_err(io_error)?;
    let raster = file.seek(SeekFrom::End(0)).map_err(io_error)? - header;
    file.seek(SeekFrom::Start(0)).map_err(io_error)?;
    let ends = Cell::new(0);
    let decoder = PnmDecoder::new(EndCounter { file, ends: &ends }).map_err(io_error)?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let format = match color {
        ColorType::L8 | ColorType::Rgb8 => PixelFormat::Rgba8Srgb,
        ColorType::L16 | ColorType::Rgb16 => PixelFormat::Rgba32F,
        _ => return Err(io_error(format!("its pixels are {color:?}, which is not read"))),
    };
    let count = pixel_count(width.into(), height.into(), format)?;
    let decoded_bytes = count * usize::from(color.bytes_per_pixel());
    let samples = count as u64 * u64::from(color.channel_count());
    let needed = match decoder.subtype() {
        PnmSubtype::Bitmap(SampleEncoding::Binary) => u64::from(width.div_ceil(8)) * u64::from(height),
        PnmSubtype::Bitmap(SampleEncoding::Ascii) => samples,
        // Each sample is at least a digit, and a separator stands between two.
        PnmSubtype::Graymap(SampleEncoding::Ascii) | PnmSubtype::Pixmap(SampleEncoding::Ascii) => 2 * samples - 1,
        _ => decoded_bytes as u64,
    };
    if raster < needed {
        let claim = format!("it claims {width} x {height} pixels, which take at least {needed} bytes");
        return Err(io_error(format!("{claim}; {raster} bytes follow")));
    }
    // The decoder reads into a vector that grows, and expands bits into another one.
    probe(4 * decoded_bytes as u64)?;
    let mut decoded = zeros::<u32>(decoded_bytes.div_ceil(4))?;
    let decoded = &mut bytemuck::cast_slice_mut::<u32, u8>(&mut decoded)[..decoded_bytes];
    decoder.read_image(decoded).map_err(io_error)?;
    // The end of the file may end the last number; numbers that are missing altogether the decoder takes for zeros.
    if ends.get() > 1 {
        return Err(io_error("it ends before its pixels do"));
    }

    let pixels = if format == PixelFormat::Rgba8Srgb {
        let mut bytes = reserve::<u8>(4 * count)?;
        match color {
            ColorType::L8 => bytes.extend(decoded.iter().flat_map(|l| [*l, *l, *l, 255])),
            _ => bytes.extend(decoded.as_chunks().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255])),
        }
        Pixels::Bytes(bytes)
    } else {
        let codes = linear_codes()?;
        let light = |code: u16| codes[usize::from(code)];
        let samples: &[u16] = bytemuck::cast_slice(decoded);
        let mut floats = reserve::<f32>(4 * count)?;
        match color {
            ColorType::L16 => floats.extend(samples.iter().flat_map(|l| [light(*l), light(*l), light(*l), 1.0])),
            _ => {
                let rgb = samples.as_chunks().0.iter();
                floats.extend(rgb.flat_map(|[r, g, b]| [light(*r), light(*g), light(*b), 1.0]));
            }
        }
        Pixels::Floats(floats)
    };
    Ok(Loaded { format, width, height, pixels })
}

/// A file that counts how often it was read at its end.
struct EndCounter<'a, F> {
    file: F,
    ends: &'a Cell<u32>,
}

impl<F: Read> Read for EndCounter<'_, F> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(into)?;
        if read == 0 && !into.is_empty() {
            self.ends.set(self.ends.get().saturating_add(1));
        }
        Ok(read)
    }
}

/// Writes an 8-bit image as PPM, without alpha. Errors: IO; OUT_OF_MEMORY.
pub(super) fn write(image: &ImageRef<'_>, file: impl Write) -> Result<()> {
    let mut rgb = reserve::<u8>(3 * image.width() as usize * image.height() as usize)?;
    for y in 0..image.height() {
        let pixels = image.row(y).as_chunks::<4>().0.iter();
        match image.format() {
            PixelFormat::Bgra8Srgb => rgb.extend(pixels.flat_map(|[b, g, r, _]| [*r, *g, *b])),
            _ => rgb.extend(pixels.flat_map(|[r, g, b, _]| [*r, *g, *b])),
        }
    }
    PnmEncoder::new(file)
        .with_subtype(PnmSubtype::Pixmap(SampleEncoding::Binary))
        .write_image(&rgb, image.width(), image.height(), ExtendedColorType::Rgb8)
        .map_err(io_error)
}
