//! PNM by the `image` crate: PBM, PGM, PPM and PAM are read, PPM is written.

use super::load::{Loaded, Pixels, linear_codes};
use super::{io_error, pixel_count, probe, reserve, zeros};
use crate::error::Result;
use crate::image::memory::{ImageRef, PixelFormat};
use ::image::codecs::pnm::{PnmDecoder, PnmEncoder, PnmSubtype, SampleEncoding};
use ::image::{ColorType, ExtendedColorType, ImageDecoder, ImageEncoder};
use std::io::{BufRead, Read, Seek, SeekFrom, Write};

/// Longest header, bytes, with comments. The decoder keeps each word, and in PAM each line, however long it is.
const MAX_HEADER_BYTES: u64 = 64 << 10;

/// Errors: IO; OUT_OF_MEMORY.
pub(super) fn read(mut file: impl BufRead + Seek) -> Result<Loaded> {
    // A first time only as far as a header may reach; what is read without an error then is no longer the second time.
    PnmDecoder::new(Read::take(&mut file, MAX_HEADER_BYTES)).map_err(io_error)?;
    file.seek(SeekFrom::Start(0)).map_err(io_error)?;
    let decoder = PnmDecoder::new(file).map_err(io_error)?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let format = match color {
        ColorType::L8 | ColorType::Rgb8 => PixelFormat::Rgba8Srgb,
        ColorType::L16 | ColorType::Rgb16 => PixelFormat::Rgba32F,
        _ => return Err(io_error(format!("its pixels are {color:?}, which is not read"))),
    };
    let count = pixel_count(width.into(), height.into(), format)?;
    let decoded_bytes = count * usize::from(color.bytes_per_pixel());
    // What the decoder reads, in a vector that grows, and one that it expands bits into.
    probe(4 * decoded_bytes as u64)?;
    let mut decoded = zeros::<u32>(decoded_bytes.div_ceil(4))?;
    let decoded = &mut bytemuck::cast_slice_mut::<u32, u8>(&mut decoded)[..decoded_bytes];
    decoder.read_image(decoded).map_err(io_error)?;

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
