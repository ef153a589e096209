// SPDX-License-Identifier: MIT OR Apache-2.0
//! Writing image files: the kind of file that goes with a path and a format.

use super::layer::{Alpha, Attribute, Effort, Layer};
use super::support::{about, on_own_thread};
use super::{ktx2, png, pnm, replace};
use crate::error::{Error, Result};
use crate::image::ColourSpace;
use crate::image::bc6h::Blocks;
use crate::image::memory::{ImageRef, PixelFormat};
use std::io::{BufWriter, Write};
use std::path::Path;

#[derive(Clone, Copy)]
enum FileKind {
    Png,
    Ppm,
    Exr,
}

/// Errors: UNSUPPORTED, with the extension to use instead.
fn kind_for(path: &Path, format: PixelFormat) -> Result<FileKind> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let kinds = kinds_of(format);
    let fits = kinds.iter().find(|(known, _)| *known == extension);
    fits.map(|(_, kind)| *kind).ok_or_else(|| {
        let known = kinds.iter().map(|(known, _)| format!(".{known}")).collect::<Vec<_>>();
        let known = if known.is_empty() { "no file".into() } else { known.join(" or ") };
        let path = path.display();
        Error::unsupported(format!("path {path} has extension \"{extension}\"; {format} is saved to {known}"))
    })
}

/// The extensions that pixels of a format are saved under.
fn kinds_of(format: PixelFormat) -> &'static [(&'static str, FileKind)] {
    match format {
        PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb => &[("png", FileKind::Png), ("ppm", FileKind::Ppm)],
        PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => &[("png", FileKind::Png)],
        PixelFormat::Rgba16F | PixelFormat::Rgba32F | PixelFormat::R32F => &[("exr", FileKind::Exr)],
    }
}

/// Writes `image`: 8-bit formats to `.png` (premultiplied colours are divided by alpha) or `.ppm` (which has no alpha;
/// premultiplied colours are those over black), those of high dynamic range to `.png` without alpha, float formats to
/// `.exr`, where premultiplied is what all colours are (`R32F` as grey) and light is in `space`. The file appears
/// whole, and on the disk, or not at all. A file that is replaced keeps its mode, and its owner where the process may
/// set it; where `path` is a symbolic link, its target is written. Errors: UNSUPPORTED for another extension, and for
/// EXR without the cargo feature; IO; OUT_OF_MEMORY.
pub fn save(image: &ImageRef<'_>, alpha: Alpha, space: ColourSpace, path: &Path) -> Result<()> {
    let kind = kind_for(path, image.format())?;
    let write = || {
        replace::with(path, |file| {
            let mut file = BufWriter::new(file);
            encode(image, (alpha, space), kind, &mut file)?;
            file.into_inner().map_err(super::support::io_error)
        })
    };
    on_own_thread(write).map_err(|error| about("write", path, &error))
}

/// Writes text to a file, which appears as in [`save`]. Errors: IO; OUT_OF_MEMORY.
pub fn save_text(text: &str, path: &Path) -> Result<()> {
    let write = || {
        replace::with(path, |mut file| {
            file.write_all(text.as_bytes()).map_err(super::support::io_error)?;
            Ok(file)
        })
    };
    on_own_thread(write).map_err(|error| about("write", path, &error))
}

/// Writes float images of one size to one `.exr` file, each channel by its name, with attributes and the primaries of
/// their light. It appears as in [`save`]. Errors: UNSUPPORTED for another extension or a format of integers, and
/// without the cargo feature; INVALID_ARGUMENT for two channels of one name; IO; OUT_OF_MEMORY.
pub fn save_layers(
    layers: &[Layer<'_>],
    (attributes, space): (&[(String, Attribute)], ColourSpace),
    effort: Effort,
    path: &Path,
) -> Result<()> {
    for layer in layers {
        let format = layer.image.format();
        // Formats of integers go into no .exr file, though a picture of one alone has files of other kinds.
        let Some((_, FileKind::Exr)) = kinds_of(format).first() else {
            return Err(Error::unsupported(format!("{format} is no format of layers; they are floats, in .exr")));
        };
        kind_for(path, format)?;
    }
    let write = || {
        replace::with(path, |file| {
            let mut file = BufWriter::new(file);
            encode_layers(layers, (attributes, space), effort, &mut file)?;
            file.into_inner().map_err(super::support::io_error)
        })
    };
    on_own_thread(write).map_err(|error| about("write", path, &error))
}

/// Writes a picture and its levels, each of half the columns and rows of the one before, rounded down, to a KTX2 file
/// as [`super::load_blocks`] reads it, which appears as in [`save`]. `filtered`: that of [`super::BlockFile`]. Errors:
/// IO; OUT_OF_MEMORY.
pub fn save_blocks(levels: &[Blocks], filtered: bool, path: &Path) -> Result<()> {
    let write = || {
        replace::with(path, |out| {
            let mut out = BufWriter::new(out);
            ktx2::write(levels, filtered, &mut out)?;
            out.into_inner().map_err(super::support::io_error)
        })
    };
    on_own_thread(write).map_err(|error| about("write", path, &error))
}

/// Writes channels as [`super::load_channels`] reads them to one `.exr` file, which appears as in [`save`]. Errors:
/// INVALID_ARGUMENT for two channels of one name, or one with another number of values than there are pixels; IO;
/// OUT_OF_MEMORY.
#[cfg(feature = "exr")]
pub fn save_channels(channels: &super::layer::Channels, effort: Effort, path: &Path) -> Result<()> {
    let write = || {
        replace::with(path, |file| {
            let mut file = BufWriter::new(file);
            super::layers::write_values(channels, effort, &mut file)?;
            file.into_inner().map_err(super::support::io_error)
        })
    };
    on_own_thread(write).map_err(|error| about("write", path, &error))
}

#[cfg(feature = "exr")]
fn encode_layers(
    layers: &[Layer<'_>],
    (attributes, space): (&[(String, Attribute)], ColourSpace),
    effort: Effort,
    file: &mut BufWriter<std::fs::File>,
) -> Result<()> {
    super::layers::write(layers, (attributes, space), effort, file)
}

#[cfg(not(feature = "exr"))]
fn encode_layers(
    _: &[Layer<'_>],
    _: (&[(String, Attribute)], ColourSpace),
    _: Effort,
    _: &mut BufWriter<std::fs::File>,
) -> Result<()> {
    Err(Error::unsupported(super::support::WITHOUT_EXR))
}

fn encode(
    image: &ImageRef<'_>,
    (alpha, space): (Alpha, ColourSpace),
    kind: FileKind,
    file: &mut BufWriter<std::fs::File>,
) -> Result<()> {
    match kind {
        FileKind::Png if image.format().is_hdr() => png::write_hdr(image, file),
        FileKind::Png => png::write(image, alpha, file),
        FileKind::Ppm => pnm::write(image, file),
        #[cfg(feature = "exr")]
        FileKind::Exr => super::layers::write_image(image, space, file),
        #[cfg(not(feature = "exr"))]
        FileKind::Exr => {
            let _ = space;
            Err(Error::unsupported(super::support::WITHOUT_EXR))
        }
    }
}
