//! Image files: PNG, OpenEXR and PPM through the `image` crate. A file appears whole or not at all; a broken one is
//! an error, and what it claims to hold is checked before memory is taken for it.

use super::memory::{ImageRef, MAX_SIDE, PixelFormat};
use crate::error::{Error, ErrorKind, Result};
use half::f16;
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::codecs::pnm::{PnmEncoder, PnmSubtype, SampleEncoding};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader, Limits};
use std::borrow::Cow;
use std::ffi::OsString;
use std::fmt::Display;
use std::fs::{self, File, OpenOptions};
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Most bytes of pixels that a file may hold: a 16384 x 16384 RGBA32F image.
const MAX_LOAD_BYTES: u64 = 4 << 30;

fn io_error(doing: &str, path: &Path, why: impl Display) -> Error {
    Error::new(ErrorKind::Io, format!("cannot {doing} {}: {why}", path.display()))
}

#[derive(Clone, Copy)]
enum FileKind {
    Png,
    Ppm,
    Exr,
}

/// Errors: UNSUPPORTED, with the extension to use instead.
fn kind_for(path: &Path, format: PixelFormat) -> Result<FileKind> {
    use PixelFormat::*;
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let eight_bit = matches!(format, Rgba8Srgb | Bgra8Srgb);
    match (extension.as_str(), eight_bit) {
        ("png", true) => Ok(FileKind::Png),
        ("ppm", true) => Ok(FileKind::Ppm),
        ("exr", false) => Ok(FileKind::Exr),
        _ => Err(Error::unsupported(format!(
            "path {} has extension \"{extension}\"; {format:?} is saved to {}",
            path.display(),
            if eight_bit { ".png or .ppm" } else { ".exr" }
        ))),
    }
}

/// Writes `image`: 8-bit formats to `.png` or `.ppm` (which drops alpha), float formats to `.exr` (32-bit; `R32F`
/// as grey), alpha as it is. Errors: UNSUPPORTED for another extension; IO; OUT_OF_MEMORY.
pub fn save(image: &ImageRef<'_>, path: &Path) -> Result<()> {
    let kind = kind_for(path, image.format())?;
    let (bytes, color) = encoder_input(image, kind)?;
    let (width, height) = (image.width(), image.height());
    write_whole(path, |file| {
        match kind {
            FileKind::Png => PngEncoder::new(file).write_image(&bytes, width, height, color),
            FileKind::Ppm => PnmEncoder::new(file)
                .with_subtype(PnmSubtype::Pixmap(SampleEncoding::Binary))
                .write_image(&bytes, width, height, color),
            FileKind::Exr => OpenExrEncoder::new(file).write_image(&bytes, width, height, color),
        }
        .map_err(|error| io_error("write", path, error))
    })
}

/// The pixels as the encoder of `kind` takes them, packed.
fn encoder_input<'a>(image: &ImageRef<'a>, kind: FileKind) -> Result<(Cow<'a, [u8]>, ExtendedColorType)> {
    let (color, bytes_per_pixel) = match (kind, image.format()) {
        (FileKind::Png, _) => (ExtendedColorType::Rgba8, 4),
        (FileKind::Ppm, _) => (ExtendedColorType::Rgb8, 3),
        (FileKind::Exr, PixelFormat::R32F) => (ExtendedColorType::Rgb32F, 12),
        (FileKind::Exr, _) => (ExtendedColorType::Rgba32F, 16),
    };
    if let (ExtendedColorType::Rgba8, PixelFormat::Rgba8Srgb) | (ExtendedColorType::Rgba32F, PixelFormat::Rgba32F) =
        (color, image.format())
        && let Some(bytes) = image.packed()
    {
        return Ok((bytes.into(), color));
    }
    let mut bytes = reserve(u64::from(image.width()) * u64::from(image.height()) * bytes_per_pixel)?;
    for y in 0..image.height() {
        let row = image.row(y);
        match (image.format(), kind) {
            (PixelFormat::Bgra8Srgb, FileKind::Png) => {
                bytes.extend(row.as_chunks::<4>().0.iter().flat_map(|[b, g, r, a]| [*r, *g, *b, *a]));
            }
            (PixelFormat::Bgra8Srgb, _) => {
                bytes.extend(row.as_chunks::<4>().0.iter().flat_map(|[b, g, r, _]| [*r, *g, *b]));
            }
            (PixelFormat::Rgba8Srgb, FileKind::Ppm) => {
                bytes.extend(row.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]));
            }
            (PixelFormat::Rgba16F, _) => {
                bytes.extend(
                    row.as_chunks::<2>().0.iter().flat_map(|half| f16::from_ne_bytes(*half).to_f32().to_ne_bytes()),
                );
            }
            (PixelFormat::R32F, _) => {
                bytes.extend(row.as_chunks::<4>().0.iter().flat_map(|value| [*value; 3]).flatten());
            }
            (PixelFormat::Rgba8Srgb | PixelFormat::Rgba32F, _) => bytes.extend_from_slice(row),
        }
    }
    Ok((bytes.into(), color))
}

/// Room for `bytes` bytes. Errors: OUT_OF_MEMORY.
fn reserve(bytes: u64) -> Result<Vec<u8>> {
    let mut room = Vec::new();
    usize::try_from(bytes)
        .ok()
        .and_then(|bytes| room.try_reserve_exact(bytes).ok())
        .map(|()| room)
        .ok_or_else(|| Error::new(ErrorKind::OutOfMemory, format!("no {bytes} bytes of memory for an image file")))
}

/// Lets `fill` write a temporary file beside `path`, then puts it in the place of `path`.
fn write_whole(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> Result<()>) -> Result<()> {
    refuse_as_target(path)?;
    let (temporary, file) = create_beside(path)?;
    let mut writer = BufWriter::new(file);
    let written = fill(&mut writer)
        .and_then(|()| writer.flush().map_err(|error| io_error("write", path, error)))
        .and_then(|()| fs::rename(&temporary, path).map_err(|error| io_error("write", path, error)));
    if written.is_err() {
        // The error that is told is the first one.
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Renaming would replace what opening for writing refuses.
fn refuse_as_target(path: &Path) -> Result<()> {
    let Ok(there) = fs::metadata(path) else {
        return Ok(());
    };
    let why = match (there.is_dir(), there.is_file(), there.permissions().readonly()) {
        (true, _, _) => "it is a directory",
        (_, false, _) => "it is no regular file",
        (_, _, true) => "it is read-only",
        _ => return Ok(()),
    };
    Err(io_error("write", path, why))
}

fn create_beside(path: &Path) -> Result<(PathBuf, File)> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = path.file_name().ok_or_else(|| io_error("write", path, "it names no file"))?;
    let mut temporary = OsString::from(name);
    temporary.push(format!(".{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
    let temporary = path.with_file_name(temporary);
    match OpenOptions::new().write(true).create_new(true).open(&temporary) {
        Ok(file) => Ok((temporary, file)),
        Err(error) => Err(io_error("write", path, error)),
    }
}

/// Packed pixels of a loaded file, aligned to their channel.
#[derive(Debug)]
pub enum Pixels {
    Bytes(Vec<u8>),
    Floats(Vec<f32>),
}

impl Pixels {
    pub fn as_bytes(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Floats(floats) => bytemuck::cast_slice(floats),
        }
    }

    pub fn as_mut_ptr(&mut self) -> *mut u8 {
        match self {
            Self::Bytes(bytes) => bytes.as_mut_ptr(),
            Self::Floats(floats) => floats.as_mut_ptr().cast(),
        }
    }
}

/// A file's pixels: `Rgba8Srgb` with `Bytes`, or `Rgba32F` with `Floats`.
#[derive(Debug)]
pub struct Loaded {
    pub format: PixelFormat,
    pub width: u32,
    pub height: u32,
    pub pixels: Pixels,
}

/// Reads a PNG, EXR or PNM file: 8-bit files as `Rgba8Srgb`, others as linear `Rgba32F` (16-bit files carry the
/// sRGB curve, which is undone). Errors: IO for a file that is not there, not readable, broken, of another kind, or
/// more than 4 GiB when decoded; OUT_OF_MEMORY.
pub fn load(path: &Path) -> Result<Loaded> {
    let decoded = decode(path)?;
    let (width, height) = (decoded.width(), decoded.height());
    let bytes_per_channel = decoded.color().bytes_per_pixel() / decoded.color().channel_count();
    if bytes_per_channel == 1 {
        let pixels = Pixels::Bytes(decoded.into_rgba8().into_raw());
        return Ok(Loaded { format: PixelFormat::Rgba8Srgb, width, height, pixels });
    }
    let mut floats = decoded.into_rgba32f().into_raw();
    if bytes_per_channel == 2 {
        for [r, g, b, _] in floats.as_chunks_mut::<4>().0 {
            for channel in [r, g, b] {
                *channel = srgb_to_linear(*channel);
            }
        }
    }
    Ok(Loaded { format: PixelFormat::Rgba32F, width, height, pixels: Pixels::Floats(floats) })
}

fn decode(path: &Path) -> Result<DynamicImage> {
    let error = |why: &dyn Display| io_error("read", path, why);
    if !fs::metadata(path).map_err(|e| error(&e))?.is_file() {
        return Err(error(&"it is no regular file"));
    }
    let file = File::open(path).map_err(|e| error(&e))?;
    let mut reader = ImageReader::new(BufReader::new(file)).with_guessed_format().map_err(|e| error(&e))?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::OpenExr | ImageFormat::Pnm)) {
        return Err(error(&"it is no PNG, EXR or PNM file"));
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_LOAD_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|e| error(&e))?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE || decoder.total_bytes() > MAX_LOAD_BYTES {
        return Err(error(&format!("it claims {width} x {height} pixels {:?}", decoder.color_type())));
    }
    // Running out of memory inside the decoder would end the process. It and the conversion hold up to three copies.
    drop(reserve(2 * decoder.total_bytes() + 16 * u64::from(width) * u64::from(height))?);
    DynamicImage::from_decoder(decoder).map_err(|e| error(&e))
}

/// The inverse of the sRGB curve, IEC 61966-2-1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{ImageMut, Layout};

    /// A folder of this test's own, removed at its end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("bhr-file-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn file(&self, name: &str) -> PathBuf {
            self.0.join(name)
        }

        fn names(&self) -> Vec<OsString> {
            fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().file_name()).collect()
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    /// A block for a 3 x 2 image whose row `y`, at any stride, repeats `rows[y]`.
    fn block<T: bytemuck::Pod>(layout: Layout, rows: [&[T]; 2]) -> Vec<u32> {
        let mut words = vec![0xabab_abab_u32; 64];
        let mut image = ImageMut::new(layout, bytemuck::cast_slice_mut(&mut words)).unwrap();
        for (y, row) in (0..).zip(rows) {
            let bytes: &[u8] = bytemuck::cast_slice(row);
            image.write_tile(0, y, 3, 1, bytes, bytes.len()).unwrap();
        }
        words
    }

    fn save_block(layout: Layout, words: &[u32], path: &Path) -> Result<()> {
        save(&ImageRef::new(layout, bytemuck::cast_slice(words)).unwrap(), path)
    }

    fn layout(format: PixelFormat, row_stride: i64) -> Layout {
        Layout { format, width: 3, height: 2, row_stride }
    }

    const TOP: [u8; 12] = [1, 2, 3, 255, 5, 6, 7, 255, 9, 10, 11, 128];
    const BOTTOM: [u8; 12] = [13, 14, 15, 255, 17, 18, 19, 255, 21, 22, 23, 0];

    #[test]
    fn eight_bit_files_keep_every_byte_whatever_the_stride() {
        let folder = Folder::new("png");
        for stride in [0, 12, 17, -12, -19] {
            let l = layout(PixelFormat::Rgba8Srgb, stride);
            save_block(l, &block(l, [&TOP[..], &BOTTOM]), &folder.file("a.PNG")).unwrap();
            let loaded = load(&folder.file("a.PNG")).unwrap();
            assert_eq!((loaded.format, loaded.width, loaded.height), (PixelFormat::Rgba8Srgb, 3, 2));
            assert_eq!(loaded.pixels.as_bytes(), [TOP, BOTTOM].concat());
        }
        assert_eq!(folder.names(), ["a.PNG"]);
    }

    #[test]
    fn blue_and_red_change_places_and_ppm_drops_alpha() {
        let folder = Folder::new("ppm");
        let l = layout(PixelFormat::Bgra8Srgb, -12);
        let words = block(l, [&TOP[..], &BOTTOM]);
        for (name, alpha) in [("a.png", 128), ("a.ppm", 255)] {
            save_block(l, &words, &folder.file(name)).unwrap();
            let loaded = load(&folder.file(name)).unwrap();
            assert_eq!(loaded.pixels.as_bytes()[8..12], [11, 10, 9, alpha], "{name}");
        }
    }

    #[test]
    fn float_files_keep_every_value() {
        let folder = Folder::new("exr");
        let top: Vec<f32> = (0..12).map(|i| i as f32 * 0.25 - 1.0).collect();
        let bottom: Vec<f32> = (0..12).map(|i| 1e4 + i as f32 * 8.0).collect();
        let wanted = [top.clone(), bottom.clone()].concat();
        let l = layout(PixelFormat::Rgba32F, -52);
        save_block(l, &block(l, [&top, &bottom]), &folder.file("a.exr")).unwrap();
        let loaded = load(&folder.file("a.exr")).unwrap();
        assert_eq!(loaded.format, PixelFormat::Rgba32F);
        assert_eq!(bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes()), wanted);

        let half = |row: &[f32]| row.iter().map(|value| f16::from_f32(*value)).collect::<Vec<_>>();
        let l = layout(PixelFormat::Rgba16F, 26);
        save_block(l, &block(l, [&half(&top), &half(&bottom)]), &folder.file("b.exr")).unwrap();
        let loaded = load(&folder.file("b.exr")).unwrap();
        assert_eq!(bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes()), wanted);

        let l = layout(PixelFormat::R32F, 0);
        save_block(l, &block(l, [&top[..3], &bottom[..3]]), &folder.file("c.exr")).unwrap();
        let loaded = load(&folder.file("c.exr")).unwrap();
        assert_eq!(bytemuck::cast_slice::<u8, f32>(loaded.pixels.as_bytes())[..4], [-1.0, -1.0, -1.0, 1.0]);
    }

    #[test]
    fn sixteen_bit_files_become_linear() {
        let folder = Folder::new("ppm16");
        // Maximum 65535, one pixel: white, the curve's 0.5, black.
        fs::write(folder.file("a.ppm"), b"P6 1 1 65535\n\xff\xff\x80\x00\x00\x00").unwrap();
        let loaded = load(&folder.file("a.ppm")).unwrap();
        let pixel: Vec<f32> = bytemuck::cast_slice(loaded.pixels.as_bytes()).to_vec();
        // 0.21404 is the linear value of the sRGB code 0.5.
        assert!((pixel[1] - 0.21404).abs() < 2e-5 && [pixel[0], pixel[2], pixel[3]] == [1.0, 0.0, 1.0], "{pixel:?}");
    }

    #[test]
    fn formats_go_to_the_files_that_hold_them() {
        let folder = Folder::new("kinds");
        for (format, name, instead) in [
            (PixelFormat::Rgba8Srgb, "a.exr", ".png or .ppm"),
            (PixelFormat::Rgba8Srgb, "a.jpg", ".png or .ppm"),
            (PixelFormat::Rgba8Srgb, "png", ".png or .ppm"),
            (PixelFormat::Rgba32F, "a.png", ".exr"),
            (PixelFormat::R32F, "a.ppm", ".exr"),
        ] {
            let error = save_block(layout(format, 0), &[0; 64], &folder.file(name)).unwrap_err();
            assert_eq!(error.kind, ErrorKind::Unsupported);
            assert!(error.message.contains(instead) && error.message.contains(name), "{error}");
        }
        assert!(folder.names().is_empty());
    }

    #[test]
    fn a_failed_save_or_load_names_the_path_and_leaves_nothing() {
        let folder = Folder::new("fail");
        let l = layout(PixelFormat::Rgba8Srgb, 0);
        fs::create_dir(folder.file("d.png")).unwrap();
        fs::write(folder.file("r.png"), "precious").unwrap();
        let mut permissions = fs::metadata(folder.file("r.png")).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(folder.file("r.png"), permissions).unwrap();
        for name in ["missing/a.png", "d.png", "r.png"] {
            let error = save_block(l, &[0; 64], &folder.file(name)).unwrap_err();
            assert_eq!(error.kind, ErrorKind::Io);
            assert!(error.message.contains(name), "{error}");
        }
        assert_eq!(fs::read(folder.file("r.png")).unwrap(), b"precious");
        assert_eq!(folder.names().len(), 2);
        fs::write(folder.file("text.png"), "no picture at all").unwrap();
        for name in ["missing.png", "d.png", "text.png"] {
            let error = load(&folder.file(name)).unwrap_err();
            assert_eq!(error.kind, ErrorKind::Io);
            assert!(error.message.contains(name), "{error}");
        }
    }

    #[test]
    fn a_file_that_claims_to_be_huge_is_refused_before_memory_is_taken() {
        let folder = Folder::new("huge");
        fs::write(folder.file("a.ppm"), "P6 1000000 1000000 255\n").unwrap();
        let error = load(&folder.file("a.ppm")).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Io);
    }

    /// Every byte of a small file of each kind changed, and every length cut: an image or an IO error, never a panic.
    #[test]
    fn broken_files_are_errors() {
        let folder = Folder::new("broken");
        let eight = layout(PixelFormat::Rgba8Srgb, 0);
        let float = layout(PixelFormat::Rgba32F, 0);
        for (l, name) in [(eight, "a.png"), (eight, "a.ppm"), (float, "a.exr")] {
            let path = folder.file(name);
            save_block(l, &[0x3f3f_3f3f; 64], &path).unwrap();
            let whole = fs::read(&path).unwrap();
            let check = |bytes: &[u8]| {
                fs::write(&path, bytes).unwrap();
                if let Err(error) = load(&path) {
                    assert!(matches!(error.kind, ErrorKind::Io | ErrorKind::OutOfMemory), "{error}");
                    return false;
                }
                true
            };
            assert!(check(&whole));
            for length in 0..whole.len() {
                assert!(!check(&whole[..length]) || name == "a.png", "{name} cut to {length} bytes was read");
            }
            for index in 0..whole.len() {
                for change in [0x01, 0x80, 0xff] {
                    let mut bytes = whole.clone();
                    bytes[index] ^= change;
                    check(&bytes);
                }
            }
        }
    }
}
