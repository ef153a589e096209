// SPDX-License-Identifier: MIT OR Apache-2.0
//! PAM, the PNM kind with alpha, which the `image` crate reads only in versions that bring colour management along: a
//! header of words, then samples as in PGM and PPM.

use super::loaded::{Loaded, Pixels, linear_codes};
use super::support::{io_error, pixel_count, zeros};
use crate::error::Result;
use crate::image::memory::PixelFormat;
use std::io::{BufRead, Read};

/// Longest header, bytes, with comments.
const MAX_HEADER_BYTES: u64 = 64 << 10;

/// Tuple types and their depths; samples of black and white are 0 and 1.
const KINDS: [(&str, u32); 6] = [
    ("BLACKANDWHITE", 1),
    ("GRAYSCALE", 1),
    ("RGB", 3),
    ("BLACKANDWHITE_ALPHA", 2),
    ("GRAYSCALE_ALPHA", 2),
    ("RGB_ALPHA", 4),
];

#[derive(Default)]
struct Header {
    width: Option<u32>,
    height: Option<u32>,
    depth: Option<u32>,
    most: Option<u32>,
    kind: String,
}

/// Errors: IO; OUT_OF_MEMORY.
pub(super) fn read(mut file: impl BufRead) -> Result<Loaded> {
    let header = read_header(Read::take(&mut file, MAX_HEADER_BYTES))?;
    let Header { width: Some(width), height: Some(height), depth: Some(depth), most: Some(most), kind } = header else {
        return Err(io_error("its header lacks one of WIDTH, HEIGHT, DEPTH and MAXVAL"));
    };
    if !(1..=4).contains(&depth) || !(1..=65535).contains(&most) {
        return Err(io_error(format!("its DEPTH is {depth}, MAXVAL {most}; they may be 1 to 4 and 1 to 65535")));
    }
    if !kind.is_empty() && !KINDS.contains(&(kind.as_str(), depth)) {
        return Err(io_error(format!("its TUPLTYPE is {kind}, of DEPTH {depth}, which is not read")));
    }
    let format = if most > 255 { PixelFormat::Rgba32F } else { PixelFormat::Rgba8Srgb };
    let count = pixel_count(width.into(), height.into(), format)?;
    let depth = depth as usize;
    let sample_bytes = if most > 255 { 2 } else { 1 };
    let mut row = zeros::<u8>(width as usize * depth * sample_bytes)?;
    // The places of red, green, blue and alpha among the samples of a pixel.
    let place = [0, if depth > 2 { 1 } else { 0 }, if depth > 2 { 2 } else { 0 }];
    let alpha = if depth.is_multiple_of(2) { Some(depth - 1) } else { None };
    let pixels = if most > 255 {
        let codes = linear_codes()?;
        let code = |sample: &[u8; 2]| {
            let scaled = u32::from(u16::from_be_bytes(*sample)).min(most) * 65535;
            ((scaled + most / 2) / most) as u16
        };
        let mut floats = zeros::<f32>(4 * count)?;
        for out in floats.chunks_exact_mut(4 * width as usize) {
            file.read_exact(&mut row).map_err(io_error)?;
            let samples = row.as_chunks::<2>().0;
            for (out, pixel) in out.as_chunks_mut().0.iter_mut().zip(samples.chunks_exact(depth)) {
                let [r, g, b] = place.map(|c| codes[usize::from(code(&pixel[c]))]);
                *out = [r, g, b, alpha.map_or(1.0, |c| f32::from(code(&pixel[c])) / 65535.0)];
            }
        }
        Pixels::Floats(floats)
    } else {
        let code = |sample: u8| ((u32::from(sample).min(most) * 255 + most / 2) / most) as u8;
        let mut bytes = zeros::<u8>(4 * count)?;
        for out in bytes.chunks_exact_mut(4 * width as usize) {
            file.read_exact(&mut row).map_err(io_error)?;
            for (out, pixel) in out.as_chunks_mut().0.iter_mut().zip(row.chunks_exact(depth)) {
                let [r, g, b] = place.map(|c| code(pixel[c]));
                *out = [r, g, b, alpha.map_or(255, |c| code(pixel[c]))];
            }
        }
        Pixels::Bytes(bytes)
    };
    Ok(Loaded { format, width, height, pixels })
}

fn read_header(mut lines: impl BufRead) -> Result<Header> {
    let mut header = Header::default();
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        if lines.read_until(b'\n', &mut bytes).map_err(io_error)? == 0 {
            return Err(io_error(format!("its header does not end within {MAX_HEADER_BYTES} bytes")));
        }
        // Comments may be in any encoding.
        let line = String::from_utf8_lossy(&bytes);
        let mut words = line.split_ascii_whitespace();
        let (name, value) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        let number = match name {
            "P7" | "" => continue,
            "ENDHDR" => return Ok(header),
            "WIDTH" => &mut header.width,
            "HEIGHT" => &mut header.height,
            "DEPTH" => &mut header.depth,
            "MAXVAL" => &mut header.most,
            "TUPLTYPE" => {
                header.kind = value.into();
                continue;
            }
            comment if comment.starts_with('#') => continue,
            name => return Err(io_error(format!("its header has a line {name:.20}"))),
        };
        *number = Some(value.parse().map_err(|_| io_error(format!("its {name} is {value:.20}")))?);
    }
}
