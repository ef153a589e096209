//! Writing image files: the kind of file that goes with a path and a format.

use super::support::{about, on_own_thread};
use super::{png, pnm, replace};
use crate::error::{Error, Result};
use crate::image::memory::{ImageRef, PixelFormat};
use std::io::BufWriter;
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
    match (extension.as_str(), format.is_8bit()) {
        ("png", true) => Ok(FileKind::Png),
        ("ppm", true) => Ok(FileKind::Ppm),
        ("exr", false) => Ok(FileKind::Exr),
        _ => Err(Error::unsupported(format!(
            "path {} has extension \"{extension}\"; {format:?} is saved to {}",
            path.display(),
            if format.is_8bit() { ".png or .ppm" } else { ".exr" }
        ))),
    }
}

/// Writes `image`: 8-bit formats to `.png` or `.ppm` (which drops alpha), float formats to `.exr` (32-bit; `R32F` as
/// grey), alpha as it is. The file appears whole, and on the disk, or not at all. A file that is replaced keeps its
/// mode, and its owner where the process may set it; where `path` is a symbolic link, its target is written. Errors:
/// UNSUPPORTED for another extension, and for EXR without the cargo feature; IO; OUT_OF_MEMORY.
pub fn save(image: &ImageRef<'_>, path: &Path) -> Result<()> {
    let kind = kind_for(path, image.format())?;
    let write = || {
        replace::with(path, |file| {
            let mut file = BufWriter::new(file);
            encode(image, kind, &mut file)?;
            file.into_inner().map_err(super::support::io_error)
        })
    };
    on_own_thread(write).map_err(|error| about("write", path, &error))
}

fn encode(image: &ImageRef<'_>, kind: FileKind, file: &mut BufWriter<std::fs::File>) -> Result<()> {
    match kind {
        FileKind::Png => png::write(image, file),
        FileKind::Ppm => pnm::write(image, file),
        #[cfg(feature = "exr")]
        FileKind::Exr => super::exr::write(image, file),
        #[cfg(not(feature = "exr"))]
        FileKind::Exr => Err(Error::unsupported(super::support::WITHOUT_EXR)),
    }
}
