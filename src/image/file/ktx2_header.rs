// SPDX-License-Identifier: MIT OR Apache-2.0
//! The beginning of a KTX2 file, checked before anything is taken by its word: which texels it has, where its levels
//! lie, what their light means. Khronos, "KTX File Format Specification", version 2.0. Reads no texels.

use super::colour::Matrix;
use super::support::{io_error, zeros};
use crate::error::{Error, Result};
use crate::image::bc6h::Blocks;
use crate::image::memory::MAX_SIDE;
use crate::image::primaries::Primaries;
use ktx2::{
    ColorPrimaries, Format, Header, KeyValueDataIterator, LevelIndex, SupercompressionScheme, TransferFunction,
};
use std::io::{Read, Seek, SeekFrom};

/// The key that says, with any value, that rows are filtered as those of sky maps are.
pub(super) const FILTERED: &str = "bhrFiltered";
/// Longest description of texels, and longest list of keys and values, that are read.
const MAX_SECTION: u32 = 64 << 10;
/// Most levels that are read; a side of 2^20 has only 21.
const MAX_LEVELS: u32 = 32;
/// Offsets of primaries and curve in the description of texels, from its total size on, and its least length.
const PRIMARIES_AT: usize = 13;
const CURVE_AT: usize = 14;
const BASIC_BYTES: u32 = 28;

/// How texels are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Texels {
    /// Codes of the sRGB curve, of so many channels; `blue_first`: the order is B, G, R.
    Srgb8 {
        channels: usize,
        blue_first: bool,
    },
    /// Half floats, of so many channels.
    Half {
        channels: usize,
    },
    /// Floats, of so many channels.
    Float {
        channels: usize,
    },
    /// RGB9E5.
    Shared,
    Bc6h {
        signed: bool,
    },
}

impl Texels {
    /// `None`: texels that are not read.
    fn of(format: Format) -> Option<Self> {
        Some(match format {
            Format::R8G8B8_SRGB => Self::Srgb8 { channels: 3, blue_first: false },
            Format::R8G8B8A8_SRGB => Self::Srgb8 { channels: 4, blue_first: false },
            Format::B8G8R8A8_SRGB => Self::Srgb8 { channels: 4, blue_first: true },
            Format::R16G16B16_SFLOAT => Self::Half { channels: 3 },
            Format::R16G16B16A16_SFLOAT => Self::Half { channels: 4 },
            Format::R32G32B32_SFLOAT => Self::Float { channels: 3 },
            Format::R32G32B32A32_SFLOAT => Self::Float { channels: 4 },
            Format::E5B9G9R9_UFLOAT_PACK32 => Self::Shared,
            Format::BC6H_UFLOAT_BLOCK => Self::Bc6h { signed: false },
            Format::BC6H_SFLOAT_BLOCK => Self::Bc6h { signed: true },
            _ => return None,
        })
    }

    /// Bytes of a texel, or of a block.
    pub fn bytes(self) -> usize {
        match self {
            Self::Srgb8 { channels, .. } => channels,
            Self::Half { channels } => 2 * channels,
            Self::Float { channels } => 4 * channels,
            Self::Shared => 4,
            Self::Bc6h { .. } => 16,
        }
    }

    /// Bytes of a level of this size.
    pub fn level_bytes(self, [width, height]: [u32; 2]) -> u64 {
        let [across, down] = match self {
            Self::Bc6h { .. } => Blocks::count([width, height]).map(|count| count as u64),
            _ => [width, height].map(u64::from),
        };
        across * down * self.bytes() as u64
    }
}

/// Where a level lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub size: [u32; 2],
    offset: u64,
    /// Its bytes in the file.
    bytes: u64,
}

/// The statements of a file's beginning.
#[derive(Debug)]
pub(super) struct Contents {
    pub texels: Texels,
    /// The levels, the largest first: at least one.
    pub levels: Vec<Place>,
    /// Whether levels are compressed by Zstandard.
    compressed: bool,
    /// Whether the first row is the lowest.
    pub bottom_up: bool,
    /// Whether rows are filtered as those of sky maps are.
    pub filtered: bool,
    /// Converts to Rec. 709; `None` where the file's light is that already.
    pub matrix: Option<Matrix>,
}

/// The largest window of a compressed level: that of zstd to its level 19.
const MAX_WINDOW: u64 = 8 << 20;
/// The most that a decoder takes beside its output: its window is a ring buffer that is copied as it doubles.
const DECODER_BYTES: u64 = 4 * MAX_WINDOW;

impl Contents {
    /// Errors: IO for a file that is broken, or has another picture than one in two dimensions; UNSUPPORTED for texels,
    /// compressions and primaries that are not read.
    pub fn read(file: &mut (impl Read + Seek)) -> Result<Self> {
        let end = file.seek(SeekFrom::End(0)).map_err(io_error)?;
        file.seek(SeekFrom::Start(0)).map_err(io_error)?;
        let mut head = [0; Header::LENGTH];
        file.read_exact(&mut head).map_err(io_error)?;
        let header = Header::from_bytes(&head).map_err(|error| io_error(format!("its header has {error}")))?;
        let size = size_of(&header)?;
        let texels = texels_of(&header)?;
        let compressed = match header.supercompression_scheme {
            None => false,
            Some(SupercompressionScheme::Zstandard) => true,
            Some(other) => {
                return Err(Error::unsupported(format!(
                    "its levels are compressed by the scheme {other:?}; none and Zstandard are read"
                )));
            }
        };
        let mut levels = Vec::with_capacity(MAX_LEVELS as usize);
        for number in 0..header.level_count.clamp(1, MAX_LEVELS) {
            let mut index = [0; LevelIndex::LENGTH];
            file.read_exact(&mut index).map_err(io_error)?;
            let index = LevelIndex::from_bytes(&index);
            let size = size.map(|side| (side >> number).max(1));
            let place = Place { size, offset: index.byte_offset, bytes: index.byte_length };
            let wanted = texels.level_bytes(size);
            let stored = if compressed { index.uncompressed_byte_length } else { place.bytes };
            let ends = place.offset.checked_add(place.bytes).is_some_and(|last| last <= end);
            if !ends || stored != wanted {
                return Err(io_error(format!(
                    "its level {number} claims {stored} bytes, {} of them from {} on, of a file of {end}; {} x {} \
                     texels have {wanted}",
                    place.bytes, place.offset, size[0], size[1]
                )));
            }
            levels.push(place);
            if size == [1, 1] {
                break;
            }
        }
        let index = header.index;
        let described = section(file, index.dfd_byte_offset, index.dfd_byte_length)?;
        let pairs = section(file, index.kvd_byte_offset, index.kvd_byte_length)?;
        let matrix = matrix_of(&described)?;
        check_curve(&described, texels)?;
        let mut contents = Self { texels, levels, compressed, bottom_up: false, filtered: false, matrix };
        for (key, value) in KeyValueDataIterator::new(&pairs) {
            match key {
                "KTXorientation" => contents.bottom_up = is_bottom_up(value)?,
                FILTERED => contents.filtered = true,
                _ => {}
            }
        }
        Ok(contents)
    }

    /// A level's bytes, uncompressed. Errors: IO; OUT_OF_MEMORY.
    pub fn open<'a>(&self, place: Place, file: &'a mut (impl Read + Seek)) -> Result<Box<dyn Read + 'a>> {
        file.seek(SeekFrom::Start(place.offset)).map_err(io_error)?;
        let bytes = file.take(place.bytes);
        if !self.compressed {
            return Ok(Box::new(bytes));
        }
        super::support::probe(DECODER_BYTES)?;
        let decoder = ruzstd::decoding::StreamingDecoder::new_with_max_window_size(bytes, MAX_WINDOW);
        Ok(Box::new(decoder.map_err(io_error)?))
    }
}

fn size_of(header: &Header) -> Result<[u32; 2]> {
    let Header { pixel_width: width, pixel_height: height, pixel_depth, layer_count, face_count, level_count, .. } =
        *header;
    if face_count != 1 {
        return Err(io_error(format!("it has {face_count} faces, as cube maps have; one picture is read")));
    }
    if pixel_depth > 1 || layer_count > 1 {
        return Err(io_error(format!("it has {pixel_depth} slices and {layer_count} layers; one picture is read")));
    }
    if height == 0 || width > MAX_SIDE || height > MAX_SIDE || level_count > MAX_LEVELS {
        return Err(io_error(format!(
            "it claims {width} x {height} texels in {level_count} levels; a side has 1 to {MAX_SIDE}, of at most \
             {MAX_LEVELS} levels"
        )));
    }
    Ok([width, height])
}

fn texels_of(header: &Header) -> Result<Texels> {
    let Some(format) = header.format else {
        return Err(Error::unsupported("its texels are for a transcoder (Basis Universal), which are not read"));
    };
    Texels::of(format).ok_or_else(|| {
        Error::unsupported(format!(
            "its texels have Vulkan's format {}, which is not read: BC6H, RGB9E5, floats, halves and 8-bit sRGB are",
            format.value()
        ))
    })
}

/// Part of a file. Errors: IO; OUT_OF_MEMORY.
fn section(file: &mut (impl Read + Seek), offset: u32, length: u32) -> Result<Vec<u8>> {
    if length > MAX_SECTION {
        return Err(io_error(format!("its description takes {length} bytes; at most {MAX_SECTION} are read")));
    }
    let mut bytes = zeros(length as usize)?;
    file.seek(SeekFrom::Start(offset.into())).map_err(io_error)?;
    file.read_exact(&mut bytes).map_err(io_error)?;
    Ok(bytes)
}

/// A byte of a description of texels; 0 where that is no basic one of Khronos's.
fn word(described: &[u8], at: usize) -> u8 {
    let is_basic = described.len() as u32 >= BASIC_BYTES && described.get(4..8) == Some(&[0; 4]);
    described.get(at).filter(|_| is_basic).copied().unwrap_or(0)
}

/// Errors: UNSUPPORTED for numbers that are not linear light. 8-bit texels are sRGB by their format.
fn check_curve(described: &[u8], texels: Texels) -> Result<()> {
    match (texels, TransferFunction::new(word(described, CURVE_AT))) {
        (Texels::Srgb8 { .. }, _) | (_, None | Some(TransferFunction::Linear)) => Ok(()),
        (_, Some(other)) => Err(Error::unsupported(format!(
            "its light is coded by the curve {other:?}; such texels are read as linear"
        ))),
    }
}

/// The matrix of the primaries in a description of texels; none where they are not given. Errors: UNSUPPORTED.
fn matrix_of(described: &[u8]) -> Result<Option<Matrix>> {
    let Some(given) = ColorPrimaries::new(word(described, PRIMARIES_AT)) else { return Ok(None) };
    let primaries = match given {
        ColorPrimaries::BT709 => return Ok(None),
        ColorPrimaries::BT2020 => Primaries::REC2020,
        ColorPrimaries::DISPLAYP3 => Primaries::P3_D65,
        ColorPrimaries::ACESCC => Primaries::AP1,
        other => {
            return Err(Error::unsupported(format!(
                "its primaries are {other:?}; those of Rec. 709, Rec. 2020, Display P3 and ACEScg are read"
            )));
        }
    };
    Ok(primaries.to_rec709().ok().flatten().map(Matrix::new))
}

/// Whether rows go upwards. Errors: IO for columns that go to the left.
fn is_bottom_up(value: &[u8]) -> Result<bool> {
    match value {
        [b'r', b'd', ..] => Ok(false),
        [b'r', b'u', ..] => Ok(true),
        other => Err(io_error(format!(
            "its orientation is {:.8}; pictures are read whose columns go to the right, rd and ru",
            String::from_utf8_lossy(other)
        ))),
    }
}
