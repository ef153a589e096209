// SPDX-License-Identifier: MIT OR Apache-2.0
//! OpenEXR by the `exr` crate, block by block: what a header claims is checked before a block is read, one block at a
//! time is held, and only those are unpacked that reach the picture.

use super::colour::Matrix;
use super::exr_channels::{Chosen, choose};
use super::loaded::{Loaded, Pixels};
use super::support::{io_error, pixel_count, probe, zeros};
use crate::error::{Error, ErrorKind, Result};
use crate::image::memory::{MAX_SIDE, PixelFormat};
use crate::image::primaries::Primaries;
use ::exr::block::chunk::CompressedBlock;
use ::exr::block::reader::ChunksReader;
use ::exr::block::{self, BlockIndex, UncompressedBlock};
use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::attribute::{Chromaticities, SampleType};
use ::exr::meta::header::Header;
use half::f16;
use std::cell::Cell;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;

/// The longest headers of all parts together, bytes.
const MAX_HEADER_BYTES: u64 = 8 << 20;
/// Bytes of memory that one byte of header may take: attributes of a few bytes become values of some hundred, in
/// tables that grow by doubling.
const HEADER_GROWTH: u64 = 64;
/// Bytes of headers that are read at a time.
const HEADER_STEP: usize = 64 << 10;
/// Most channels of a part.
const MAX_CHANNELS: usize = 4096;
/// Largest block (tile, or 1 to 256 scan lines) when it is unpacked, bytes.
const MAX_BLOCK_BYTES: u64 = 256 << 20;
/// Largest block of the part that is read, bytes; or `MAX_UNPACKED_TIMES` the picture's bytes as they are handed out,
/// if those are more, as a file may be one tile.
const MAX_SMALL_BLOCK_BYTES: u64 = 64 << 20;
/// At most `MAX_UNPACKED_BYTES` are unpacked for a picture, or `MAX_UNPACKED_TIMES` its bytes as they are handed out,
/// if those are more. All channels of a block are packed together, so that those that are not used are unpacked as
/// well: a file of a thousandth of their size may hold them, and 0.16 GiB a second of ZIP were measured, with
/// assertions, on a busy machine. The numbers leave room for 32 float channels at 3840 x 2160, and 16 at any size.
const MAX_UNPACKED_BYTES: u64 = 1 << 30;
const MAX_UNPACKED_TIMES: u64 = 4;
/// Blocks that the decoder may hold at a time: the packed one, the unpacked one, and up to four that it makes on the
/// way.
pub(super) const BLOCKS_AT_A_TIME: u64 = 6;

/// Errors: IO; UNSUPPORTED for a compression that is not read; OUT_OF_MEMORY.
pub(super) fn read(file: impl Read + Seek) -> Result<Loaded> {
    let in_headers = Cell::new(true);
    let reader = block::read(HeaderLimiter::new(file, &in_headers), false).map_err(header_error)?;
    in_headers.set(false);
    check(reader.headers())?;
    let chosen = choose(reader.headers())?;
    let part = chosen.part;
    let header = &reader.headers()[part];
    if let Compression::DWAA(_) | Compression::DWAB(_) | Compression::HTJ2K32 | Compression::HTJ2K256 =
        header.compression
    {
        let kind = header.compression;
        return Err(Error::unsupported(format!("its {kind} is not read; ZIP, PIZ, PXR24, B44, RLE and none are")));
    }
    // Blocks of other parts are read, and not unpacked.
    let largest = reader.headers().iter().map(block_bytes).max().unwrap_or(0);
    let matrix = to_rec709(header);
    let mut picture = Picture::new(&chosen, header)?;
    probe(BLOCKS_AT_A_TIME * block_bytes(header) + largest)?;

    let mut chunks = reader.all_chunks(false).map_err(io_error)?;
    while picture.missing > 0 {
        let Some(chunk) = chunks.next() else {
            return Err(io_error(format!("{} of its blocks are missing", picture.missing)));
        };
        let chunk = chunk.map_err(io_error)?;
        if chunk.layer_index == part && picture.needs(&chunks.meta_data().headers[part], &chunk.compressed_block)? {
            let block = UncompressedBlock::decompress_chunk(chunk, chunks.meta_data(), false).map_err(io_error)?;
            picture.put(&block)?;
        }
    }
    if let Some(matrix) = matrix {
        for [r, g, b, _] in picture.pixels.as_chunks_mut::<4>().0 {
            [*r, *g, *b] = matrix.of([*r, *g, *b]);
        }
    }
    Ok(Loaded {
        format: PixelFormat::Rgba32F,
        width: picture.size[0] as u32,
        height: picture.size[1] as u32,
        pixels: Pixels::Floats(picture.pixels),
    })
}

pub(super) fn header_error(error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::Io(io) if io.kind() == io::ErrorKind::OutOfMemory => {
            Error::new(ErrorKind::OutOfMemory, "there is no memory for its headers")
        }
        // The decoder refuses them while it reads headers, by several messages.
        error if error.to_string().contains("sampling") => io_error(
            "it has channels with one value for several pixels, as the chroma RY and BY beside luminance; save it with \
             R, G and B",
        ),
        error => io_error(error),
    }
}

/// From the file's primaries, where it names others than those of Rec. 709. Numbers that are no primaries' are passed
/// over: programs write zeros.
fn to_rec709(header: &Header) -> Option<Matrix> {
    primaries(header)?.to_rec709().ok().flatten().map(Matrix::new)
}

/// The primaries that a file names.
pub(super) fn primaries(header: &Header) -> Option<Primaries> {
    let Chromaticities { red, green, blue, white } = header.shared_attributes.chromaticities?;
    Some(Primaries([red, green, blue, white].map(|Vec2(x, y)| [f64::from(x), f64::from(y)])))
}

/// A file whose headers come first. Reading them fails past `MAX_HEADER_BYTES`, and where there is no memory for
/// more.
pub(super) struct HeaderLimiter<'a, F> {
    file: F,
    in_headers: &'a Cell<bool>,
    /// Bytes of headers that were read, and that memory was found for.
    taken: u64,
    probed: u64,
}

impl<'a, F> HeaderLimiter<'a, F> {
    /// A file whose headers are read while `in_headers` is true.
    pub(super) fn new(file: F, in_headers: &'a Cell<bool>) -> Self {
        Self { file, in_headers, taken: 0, probed: 0 }
    }
}

impl<F: Read> Read for HeaderLimiter<'_, F> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if !self.in_headers.get() {
            return self.file.read(into);
        }
        if self.taken >= MAX_HEADER_BYTES {
            return Err(io::Error::other(format!("its headers are longer than {MAX_HEADER_BYTES} bytes")));
        }
        let room = into.len().min(HEADER_STEP);
        if self.taken + room as u64 > self.probed {
            self.probed = 2 * self.taken + HEADER_STEP as u64;
            probe(HEADER_GROWTH * self.probed).map_err(|_| io::ErrorKind::OutOfMemory)?;
        }
        let read = self.file.read(&mut into[..room])?;
        self.taken += read as u64;
        Ok(read)
    }
}

impl<F: Seek> Seek for HeaderLimiter<'_, F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Bytes of a whole block. Buffers have this size even where the picture is smaller than a tile. Saturates.
pub(super) fn block_bytes(header: &Header) -> u64 {
    let Vec2(width, height) = header.max_block_pixel_size();
    let pixels = (width as u64).saturating_mul(height as u64);
    pixels.saturating_mul(header.channels.bytes_per_pixel as u64)
}

/// Errors: IO where a part exceeds a limit.
pub(super) fn check(parts: &[Header]) -> Result<()> {
    for (i, part) in parts.iter().enumerate() {
        let Vec2(width, height) = part.layer_size;
        if width == 0 || height == 0 || width > MAX_SIDE as usize || height > MAX_SIDE as usize {
            let claim = format!("the data window of its part {i} is {width} x {height} pixels");
            return Err(io_error(format!("{claim}; a side may have 1 to {MAX_SIDE}")));
        }
        let channels = part.channels.list.len();
        if channels > MAX_CHANNELS {
            return Err(io_error(format!("its part {i} has {channels} channels; at most {MAX_CHANNELS} are read")));
        }
        let bytes = block_bytes(part);
        if bytes > MAX_BLOCK_BYTES {
            return Err(io_error(format!(
                "a block of its part {i} has {bytes} bytes; at most {MAX_BLOCK_BYTES} are unpacked at a time"
            )));
        }
    }
    Ok(())
}

/// The picture as its blocks come in.
struct Picture {
    part: usize,
    /// Width and height of the display window.
    size: [usize; 2],
    /// The place of the data window's first pixel in the display window.
    offset: [i64; 2],
    pixels: Vec<f32>,
    /// The picture has no channel A: alpha is 1 where the data window reaches.
    opaque: bool,
    /// For each channel of the part: its type, and the places in RGBA that it goes to.
    channels: Vec<(SampleType, [bool; 4])>,
    /// Pixels in a block.
    block: Vec2<usize>,
    /// Columns and rows of blocks that reach the picture.
    columns: Range<usize>,
    rows: Range<usize>,
    seen: Vec<u8>,
    /// The number of these blocks that have not come yet.
    missing: usize,
}

/// The blocks, of `block` pixels in a data window of `data` pixels, that reach the `shown` ones, and how many pixels
/// they have, along one side.
fn reaching(shown: Range<i64>, data: usize, block: usize) -> (Range<usize>, usize) {
    let shown = shown.start.clamp(0, data as i64) as usize..shown.end.clamp(0, data as i64) as usize;
    if shown.is_empty() {
        return (0..0, 0);
    }
    let blocks = shown.start / block..shown.end.div_ceil(block);
    let pixels = (blocks.end * block).min(data) - blocks.start * block;
    (blocks, pixels)
}

impl Picture {
    /// Errors: IO for a size past the limits; OUT_OF_MEMORY.
    fn new(chosen: &Chosen, header: &Header) -> Result<Self> {
        let display = header.shared_attributes.display_window;
        let Vec2(width, height) = display.size;
        let count = pixel_count(width as u64, height as u64, PixelFormat::Rgba32F)?;
        pixel_count(header.layer_size.0 as u64, header.layer_size.1 as u64, PixelFormat::Rgba32F)?;
        let position = header.own_attributes.layer_position;
        let offset = [
            i64::from(position.0) - i64::from(display.position.0),
            i64::from(position.1) - i64::from(display.position.1),
        ];
        let [red, green, blue] = chosen.rgb.map(Some);
        let of_rgba = [red, green, blue, chosen.alpha];
        let block = header.max_block_pixel_size();
        let (columns, reached_width) = reaching(-offset[0]..width as i64 - offset[0], header.layer_size.0, block.0);
        let (rows, reached_height) = reaching(-offset[1]..height as i64 - offset[1], header.layer_size.1, block.1);
        let picture = count as u64 * PixelFormat::Rgba32F.bytes_per_pixel() as u64;
        let at_a_time = block_bytes(header);
        let most = (MAX_UNPACKED_TIMES * picture).max(MAX_SMALL_BLOCK_BYTES);
        if at_a_time > most {
            return Err(io_error(format!(
                "a block of its part {} has {at_a_time} bytes; at most {most} are unpacked at a time for {width} x \
                 {height} pixels",
                chosen.part
            )));
        }
        // At most 2^28 pixels of 4096 channels.
        let unpacked = reached_width as u64 * reached_height as u64 * header.channels.bytes_per_pixel as u64;
        let most = (MAX_UNPACKED_TIMES * picture).max(MAX_UNPACKED_BYTES);
        if unpacked > most {
            return Err(io_error(format!(
                "the channels of its part {} have {unpacked} bytes; at most {most} are unpacked for {width} x \
                 {height} pixels",
                chosen.part
            )));
        }
        let blocks = columns.len() * rows.len();
        let channels = header.channels.list.iter().enumerate();
        Ok(Self {
            part: chosen.part,
            size: [width, height],
            offset,
            pixels: zeros(4 * count)?,
            opaque: chosen.alpha.is_none(),
            channels: channels.map(|(i, c)| (c.sample_type, of_rgba.map(|of| of == Some(i)))).collect(),
            block,
            columns,
            rows,
            seen: zeros(blocks)?,
            missing: blocks,
        })
    }

    /// Whether a block of its part reaches it; not if it lies past the end of the data window. Errors: IO for scan
    /// lines that begin a block or more above it.
    fn needs(&self, header: &Header, block: &CompressedBlock) -> Result<bool> {
        let at = header.get_block_data_indices(block).map_err(io_error)?;
        let Vec2(column, row) = at.tile_index;
        Ok(at.is_largest_resolution_level() && self.columns.contains(&column) && self.rows.contains(&row))
    }

    /// Takes a block that it needs. Errors: IO for one that was put before.
    fn put(&mut self, block: &UncompressedBlock) -> Result<()> {
        let BlockIndex { pixel_position: Vec2(left, top), pixel_size: Vec2(width, height), .. } = block.index;
        let (column, row) = (left / self.block.0, top / self.block.1);
        let index = row.checked_sub(self.rows.start).zip(column.checked_sub(self.columns.start));
        let index = index.map(|(row, column)| row * self.columns.len() + column);
        match index.and_then(|index| self.seen.get_mut(index)) {
            Some(seen) if *seen == 0 => *seen = 1,
            _ => return Err(io_error(format!("its part {} has block {column}, {row} twice", self.part))),
        }
        self.missing -= 1;
        // Columns of the block that are displayed.
        let first = left as i64 + self.offset[0];
        let from = (-first).clamp(0, width as i64) as usize;
        let to = (self.size[0] as i64 - first).clamp(from as i64, width as i64) as usize;
        let mut rest = block.data.as_slice();
        for y in 0..height {
            let row = usize::try_from((top + y) as i64 + self.offset[1]).ok().filter(|row| *row < self.size[1]);
            // The displayed part of the row, among the picture's floats.
            let shown = match row {
                Some(row) if from < to => {
                    let start = row * self.size[0] + (first + from as i64) as usize;
                    4 * start..4 * (start + to - from)
                }
                _ => 0..0,
            };
            if self.opaque {
                self.pixels[shown.clone()].iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = 1.0);
            }
            for (kind, of_rgba) in &self.channels {
                let bytes = kind.bytes_per_sample();
                let Some((line, after)) = rest.split_at_checked(width * bytes) else {
                    return Err(io_error("a block is shorter than its pixels"));
                };
                rest = after;
                for (c, _) in of_rgba.iter().enumerate().filter(|(_, is_there)| **is_there) {
                    put_line(*kind, &line[from * bytes..to * bytes], &mut self.pixels[shown.clone()], c);
                }
            }
        }
        Ok(())
    }
}

/// A channel's samples, in this machine's byte order, as number `c` of each pixel.
fn put_line(kind: SampleType, line: &[u8], out: &mut [f32], c: usize) {
    let out = out.iter_mut().skip(c).step_by(4);
    match kind {
        SampleType::F16 => {
            out.zip(line.as_chunks().0).for_each(|(out, half)| *out = f16::from_ne_bytes(*half).to_f32());
        }
        SampleType::F32 => out.zip(line.as_chunks().0).for_each(|(out, value)| *out = f32::from_ne_bytes(*value)),
        SampleType::U32 => {
            out.zip(line.as_chunks().0).for_each(|(out, value)| *out = u32::from_ne_bytes(*value) as f32);
        }
    }
}
