// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reading image files: the kind of a file, told by its first bytes, and the image that every kind becomes.

use super::ktx2::{self, BlockFile};
#[cfg(feature = "exr")]
use super::layer::Channels;
use super::loaded::Loaded;
use super::support::{about, io_error, on_own_thread};
use super::{pam, png, pnm};
use crate::error::Result;
use crate::platform::open_without_waiting;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

/// Reads a PNG, EXR, PNM or KTX2 file: 8-bit files of sRGB as `Rgba8Srgb`, others as linear `Rgba32F` in Rec. 709, by
/// the curve and the primaries that a file has, or those of sRGB (PNG, PNM) and Rec. 709 (EXR). EXR files: the largest
/// level of the channels that `exr_channels` chooses, cut to the display window; 0 where the data window does not
/// reach. Errors: IO for a file that is not there, not readable, broken, of another kind, or past a limit, which is
/// named: 2^20 pixels a side, 4 GiB as it is handed out, and for EXR 8 MiB of headers, 4096 channels, 64 to 256 MiB a
/// block, and 1 GiB to unpack, or four times the picture's bytes; UNSUPPORTED for EXR without the cargo feature, and
/// for its compressions DWA and HTJ2K, and for colours of a PNG that are not known; OUT_OF_MEMORY.
pub fn load(path: &Path) -> Result<Loaded> {
    let read = || on_own_thread(|| decode(open(path)?));
    read().map_err(|error| about("read", path, &error))
}

/// Reads all channels of an EXR file of one part in scan lines, as bhr writes them, and its attributes. Errors: as of
/// [`load`]; UNSUPPORTED for EXR files of other kinds.
#[cfg(feature = "exr")]
pub fn load_channels(path: &Path) -> Result<Channels> {
    let read = || on_own_thread(|| super::exr_values::read(open(path)?));
    read().map_err(|error| about("read", path, &error))
}

/// The blocks of a KTX2 file whose light is that of Rec. 709 in BC6H, unsigned, the top row first. `None`: it is
/// another file, which [`load`] may read. Errors: as of [`load`].
pub fn load_blocks(path: &Path) -> Result<Option<BlockFile>> {
    let read = || {
        let mut file = open(path)?;
        if magic(&mut file)? == ktx2::MAGIC { ktx2::read_blocks(file) } else { Ok(None) }
    };
    on_own_thread(read).map_err(|error| about("read", path, &error))
}

/// A file of text in UTF-8, of at most so many bytes. Errors: IO; OUT_OF_MEMORY.
pub fn load_text(path: &Path, most: usize) -> Result<String> {
    let read = || {
        let mut bytes = Vec::new();
        open(path)?.take(most as u64 + 1).read_to_end(&mut bytes).map_err(io_error)?;
        if bytes.len() > most {
            return Err(io_error(format!("it has more than {most} bytes")));
        }
        String::from_utf8(bytes).map_err(|error| io_error(format!("it is not UTF-8: {}", error.utf8_error())))
    };
    on_own_thread(read).map_err(|error| about("read", path, &error))
}

/// A PNG in memory, as `load` reads it. Errors: IO; OUT_OF_MEMORY.
pub fn decode_png(bytes: &[u8]) -> Result<Loaded> {
    png::read(Cursor::new(bytes))
}

fn open(path: &Path) -> Result<BufReader<File>> {
    // The kind is looked at before the file is opened, which devices may take for a command; and then whether it is
    // still so.
    refuse_as_source(&fs::metadata(path).map_err(io_error)?)?;
    let mut options = OpenOptions::new();
    open_without_waiting(options.read(true));
    let file = options.open(path).map_err(io_error)?;
    refuse_as_source(&file.metadata().map_err(io_error)?)?;
    Ok(BufReader::new(file))
}

fn refuse_as_source(there: &Metadata) -> Result<()> {
    if there.is_file() { Ok(()) } else { Err(io_error("it is no regular file")) }
}

/// The first bytes of a file, 0 past its end; it is read from its beginning afterwards.
fn magic(file: &mut (impl BufRead + Seek)) -> Result<[u8; 8]> {
    let mut bytes = Vec::with_capacity(8);
    file.by_ref().take(8).read_to_end(&mut bytes).map_err(io_error)?;
    file.seek(SeekFrom::Start(0)).map_err(io_error)?;
    Ok(std::array::from_fn(|i| bytes.get(i).copied().unwrap_or(0)))
}

fn decode(mut file: impl BufRead + Seek) -> Result<Loaded> {
    match magic(&mut file)? {
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'] => png::read(file),
        #[cfg(feature = "exr")]
        [0x76, 0x2f, 0x31, 0x01, ..] => super::exr::read(file),
        #[cfg(not(feature = "exr"))]
        [0x76, 0x2f, 0x31, 0x01, ..] => Err(crate::error::Error::unsupported(super::support::WITHOUT_EXR)),
        [b'P', b'1'..=b'6', ..] => pnm::read(file),
        [b'P', b'7', ..] => pam::read(file),
        ktx2::MAGIC => ktx2::read(file),
        _ => Err(io_error("it is no PNG, EXR, PNM or KTX2 file")),
    }
}
