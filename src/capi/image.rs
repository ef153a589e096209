// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrImage: pixels in the host's memory, and image files. The pixels that bhr_image_load hands out are kept here
//! until they are released.

use super::entry::anywhere;
use super::pointer::{check_flags, check_reserved, is_null, unknown};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned, pointers_before_u64};
use crate::error::{Error, Result};
use crate::image::{self, Alpha, ColourSpace, ImageMut, Layout, Loaded, PixelFormat};
use crate::platform::path_of_bytes;
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_void};
use std::mem::offset_of;
use std::path::PathBuf;
use std::ptr::null_mut;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// BhrImage.flags: the sky is left out, and alpha is 1 - the sky's share, premultiplied. Without this flag alpha is
/// 1. Bloom adds light and leaves alpha as it is.
pub const BHR_IMAGE_TRANSPARENT: u32 = 1u32;

/// BhrImage.flags: the picture's bottom row comes first in memory, as OpenGL has it. pixels is then the lowest
/// address of the block, as without the flag, and row_stride, 0 or more, is the distance to the next row up.
/// @since 0.2.0
pub const BHR_IMAGE_BOTTOM_UP: u32 = 2u32;

/// BhrImage.flags: for bhr_set_occluder, and flags of bhr_set_occluder_target: the host has drawn the things where
/// bent light shows them (BhrProjectedPoint.apparent). Without it they lie on straight lines of sight. @since 0.2.0
pub const BHR_IMAGE_LENSED: u32 = 4u32;

/// A pixel's bytes in memory order. A radiance of 1 is the luminance at rest of the ring that BhrDisk.reference
/// names, if the disk's brightness is 1.
pub type BhrFormat = i32;
/// 4 bytes: red, green, blue with the sRGB curve, alpha.
pub const BHR_FORMAT_RGBA8_SRGB: BhrFormat = 1;
/// 4 bytes: blue, green, red with the sRGB curve, alpha.
pub const BHR_FORMAT_BGRA8_SRGB: BhrFormat = 2;
/// 4 half floats: linear radiance, Rec. 709 primaries; alpha.
pub const BHR_FORMAT_RGBA16F: BhrFormat = 3;
/// 4 floats: linear radiance, Rec. 709 primaries; alpha.
pub const BHR_FORMAT_RGBA32F: BhrFormat = 4;
/// 1 float: the value of a view or an output, or the distance of an occluder.
pub const BHR_FORMAT_R32F: BhrFormat = 5;
/// A uint32_t: from the lowest bit on 10 bits of red, green and blue, and 2 of alpha, as in R10G10B10A2 of DXGI and
/// A2B10G10R10 of Vulkan. High dynamic range by the curve PQ (SMPTE ST 2084), as in HDR10, primaries of Rec. 2020,
/// full range. Light has the film but its tone map, LUT and colour map; BhrFilm.paper_white and peak say how bright
/// it is. @since 0.2.0
pub const BHR_FORMAT_RGB10A2_PQ: BhrFormat = 6;
/// The bits of RGB10A2_PQ by the curve HLG (ITU-R BT.2100), for a display whose peak is that of the film. @since 0.2.0
pub const BHR_FORMAT_RGB10A2_HLG: BhrFormat = 7;

/// The primaries of linear light in RGBA16F and RGBA32F. @since 0.2.0
pub type BhrColourSpace = i32;
/// Rec. 709, white D65.
pub const BHR_COLOUR_SPACE_REC709: BhrColourSpace = 0;
/// DCI-P3, white D65 (SMPTE EG 432-1).
pub const BHR_COLOUR_SPACE_P3_D65: BhrColourSpace = 1;
/// Rec. 2020, white D65.
pub const BHR_COLOUR_SPACE_REC2020: BhrColourSpace = 2;
/// ACEScg: AP1, the white of ACES (Academy S-2014-004).
pub const BHR_COLOUR_SPACE_ACESCG: BhrColourSpace = 3;

fn colour_space_of(value: BhrColourSpace) -> Result<ColourSpace> {
    Ok(match value {
        BHR_COLOUR_SPACE_REC709 => ColourSpace::Rec709,
        BHR_COLOUR_SPACE_P3_D65 => ColourSpace::P3D65,
        BHR_COLOUR_SPACE_REC2020 => ColourSpace::Rec2020,
        BHR_COLOUR_SPACE_ACESCG => ColourSpace::AcesCg,
        _ => return unknown(value, "colour space", "BHR_COLOUR_SPACE_REC709 (0) to BHR_COLOUR_SPACE_ACESCG (3)"),
    })
}

/// Pixels in memory. Bytes between rows are neither read nor written. Several images may share a block, side by side
/// or interleaved; different contexts may then render them at the same time. Rows from the bottom up are best asked
/// for by BHR_IMAGE_BOTTOM_UP. A negative row_stride with pixels at the last row of the block means the same; if
/// pixels is left at the block's beginning, rows are written in front of it, and no check can find that.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrImage {
    /// sizeof(BhrImage).
    pub struct_size: u32,
    /// BHR_FORMAT_*. Default RGBA8_SRGB.
    pub format: BhrFormat,
    /// Pixels, 1 .. 2^20.
    pub width: u32,
    /// Pixels, 1 .. 2^20.
    pub height: u32,
    /// The top-left pixel; with BHR_IMAGE_BOTTOM_UP the bottom-left one. Aligned to its channel: 1, 2 or 4 bytes.
    pub pixels: *mut c_void,
    /// Bytes to the next row down, with BHR_IMAGE_BOTTOM_UP to the next row up; a multiple of the channel's size, of
    /// which |row_stride| must hold a row. 0 (default): packed. < 0: the next row down lies lower in memory, and
    /// pixels is the block's last row; not together with BHR_IMAGE_BOTTOM_UP.
    pub row_stride: i64,
    /// Size of the host's block in bytes. The block begins at pixels, or, where row_stride < 0, (height - 1)
    /// |row_stride| bytes before it. At least (height - 1) |row_stride| + width times the bytes of a pixel.
    pub byte_size: u64,
    /// BHR_IMAGE_* bits. Default 0. BHR_IMAGE_TRANSPARENT matters to images that are rendered or saved only;
    /// BHR_IMAGE_LENSED is for bhr_set_occluder only, and elsewhere INVALID_ARGUMENT.
    pub flags: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// BHR_COLOUR_SPACE_*. Default REC709. Others matter to bhr_image_convert and bhr_image_save only; elsewhere they
    /// are INVALID_ARGUMENT. @since 0.2.0
    pub colour_space: BhrColourSpace,
    /// Reserved: 0. @since 0.2.0
    pub reserved2: u32,
}

// SAFETY: repr(C), size first, no padding but behind the pointer, integers and a nullable pointer.
unsafe impl Versioned for BhrImage {
    const NAME: &'static str = "BhrImage";
    const SIZES: &'static [usize] = &[40 + pointers_before_u64(1), 48 + pointers_before_u64(1)];
    fn defaults() -> Self {
        Self { format: BHR_FORMAT_RGBA8_SRGB, ..Self::empty() }
    }
}

impl BhrImage {
    fn empty() -> Self {
        Self {
            struct_size: 0,
            format: 0,
            width: 0,
            height: 0,
            pixels: null_mut(),
            row_stride: 0,
            byte_size: 0,
            flags: 0,
            reserved: 0,
            colour_space: BHR_COLOUR_SPACE_REC709,
            reserved2: 0,
        }
    }
}

pub(super) fn format(value: BhrFormat) -> Result<PixelFormat> {
    Ok(match value {
        BHR_FORMAT_RGBA8_SRGB => PixelFormat::Rgba8Srgb,
        BHR_FORMAT_BGRA8_SRGB => PixelFormat::Bgra8Srgb,
        BHR_FORMAT_RGBA16F => PixelFormat::Rgba16F,
        BHR_FORMAT_RGBA32F => PixelFormat::Rgba32F,
        BHR_FORMAT_R32F => PixelFormat::R32F,
        BHR_FORMAT_RGB10A2_PQ => PixelFormat::Rgb10A2Pq,
        BHR_FORMAT_RGB10A2_HLG => PixelFormat::Rgb10A2Hlg,
        _ => return unknown(value, "image format", "BHR_FORMAT_RGBA8_SRGB (1) to BHR_FORMAT_RGB10A2_HLG (7)"),
    })
}

/// The host's image, checked.
pub(super) struct HostImage<'a> {
    pub pixels: ImageMut<'a>,
    pub transparent: bool,
    pub lensed: bool,
}

/// The image's layout and flags, without its block. Errors: INVALID_ARGUMENT for NULL or a field that breaks the
/// rules of `BhrImage`, `pixels` and `byte_size` aside.
///
/// # Safety
/// `image` is NULL or points to a BhrImage.
pub(super) unsafe fn read_layout(image: *const BhrImage, name: &str) -> Result<(Layout, u32)> {
    // SAFETY: this function's contract.
    let given = unsafe { versioned::read(image, name) }?;
    layout(&given, name, 0)
}

/// The layout and the flags, `also` among them.
fn layout(given: &BhrImage, name: &str, also: u32) -> Result<(Layout, u32)> {
    check_reserved(given.reserved, name)?;
    check_reserved(given.reserved2, name)?;
    if given.colour_space != BHR_COLOUR_SPACE_REC709 {
        return Err(Error::argument(format!(
            "{name} colour_space is {}; it must be BHR_COLOUR_SPACE_REC709 (0): bhr_image_convert makes others",
            given.colour_space
        )));
    }
    let known = BHR_IMAGE_TRANSPARENT | BHR_IMAGE_BOTTOM_UP | also;
    let flags = check_flags(given.flags, known, &format!("{name} flags"))?;
    let layout = Layout {
        format: format(given.format)?,
        width: given.width,
        height: given.height,
        row_stride: given.row_stride,
    };
    match flags & BHR_IMAGE_BOTTOM_UP {
        0 => layout.check()?,
        _ => layout.check_bottom_up()?,
    };
    Ok((layout, flags))
}

/// Errors: INVALID_ARGUMENT for NULL or a field that breaks the rules of `BhrImage`.
///
/// # Safety
/// `image` is NULL or points to a BhrImage whose block is the host's during `'a`.
pub(super) unsafe fn read<'a>(image: *const BhrImage, name: &str) -> Result<HostImage<'a>> {
    // SAFETY: this function's contract.
    unsafe { read_with(image, name, 0) }
}

/// [`read`] of an image that may have the flags `also` as well.
///
/// # Safety
/// As [`read`].
pub(super) unsafe fn read_with<'a>(image: *const BhrImage, name: &str, also: u32) -> Result<HostImage<'a>> {
    // SAFETY: this function's contract.
    unsafe { pixels_of(&versioned::read(image, name)?, name, also) }
}

/// An image that may hold its light in any colour space, and which.
///
/// # Safety
/// As [`read`].
unsafe fn read_in_space<'a>(image: *const BhrImage, name: &str) -> Result<(HostImage<'a>, ColourSpace)> {
    // SAFETY: this function's contract.
    let given = unsafe { versioned::read(image, name) }?;
    let space = colour_space_of(given.colour_space)?;
    // SAFETY: as above.
    let read = unsafe { pixels_of(&BhrImage { colour_space: BHR_COLOUR_SPACE_REC709, ..given }, name, 0) }?;
    if space != ColourSpace::Rec709 {
        ColourSpace::check_format(read.pixels.format())?;
    }
    Ok((read, space))
}

/// The pixels that a struct describes.
///
/// # Safety
/// The struct's block is the host's during `'a`.
unsafe fn pixels_of<'a>(given: &BhrImage, name: &str, also: u32) -> Result<HostImage<'a>> {
    let (layout, flags) = layout(given, name, also)?;
    // SAFETY: the block of byte_size bytes is the host's, by this function's contract.
    let pixels = unsafe {
        match flags & BHR_IMAGE_BOTTOM_UP {
            0 => ImageMut::from_raw(layout, given.pixels.cast(), given.byte_size),
            _ => ImageMut::from_raw_bottom_up(layout, given.pixels.cast(), given.byte_size),
        }
    }?;
    let [transparent, lensed] = [BHR_IMAGE_TRANSPARENT, BHR_IMAGE_LENSED].map(|flag| flags & flag != 0);
    Ok(HostImage { pixels, transparent, lensed })
}

/// Fills in the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_image_init(image: *mut BhrImage, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_image_init", || unsafe { versioned::init(image, "image", struct_size) })
}

/// A path as the platform has it: any bytes on Unix, UTF-8 elsewhere.
///
/// # Safety
/// `path` is NULL or a C string.
pub(super) unsafe fn path_of(path: *const c_char) -> Result<PathBuf> {
    if path.is_null() {
        return Err(is_null("path"));
    }
    // SAFETY: this function's contract.
    let bytes = unsafe { CStr::from_ptr(path) }.to_bytes();
    if bytes.is_empty() {
        return Err(Error::argument("path is empty"));
    }
    path_of_bytes(bytes).ok_or_else(|| Error::argument("path is not UTF-8"))
}

/// Converts the linear light of an image of RGBA16F or RGBA32F in place, from its colour_space to another, which
/// becomes its colour_space; white stays white (Bradford's adaptation), alpha stays. All light of bhr lies within
/// REC709, and so within P3_D65, REC2020 and ACESCG: nothing becomes negative there.
/// Errors: INVALID_ARGUMENT also for other formats, and for a struct_size without colour_space. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_image_convert(image: *mut BhrImage, colour_space: BhrColourSpace) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_image_convert", || unsafe {
        let to = colour_space_of(colour_space)?;
        let (mut given, from) = read_in_space(image, "image")?;
        let told = versioned::read(image, "image")?;
        if (told.struct_size as usize) < offset_of!(BhrImage, reserved2) {
            return Err(Error::argument(format!(
                "image struct_size is {}, of a header whose BhrImage has no colour_space to say what its light is then",
                told.struct_size
            )));
        }
        from.convert(&mut given.pixels, to)?;
        versioned::write(image, "image", &BhrImage { colour_space, ..told })
    })
}

/// Writes an image to a file: 8-bit formats to .png or .ppm (without alpha), RGB10A2 to .png of 16 bits without
/// alpha, float formats to .exr, which says what its primaries are; R32F becomes grey. Alpha is written as it is. A
/// .png's colours are not premultiplied: with BHR_IMAGE_TRANSPARENT in the flags they are divided by alpha. The file
/// appears whole or not at all; one that is replaced keeps its mode and, where possible, its owner, and a symbolic
/// link's target is written (docs/files.md).
/// Errors: UNSUPPORTED for another extension, one that does not go with the format, or .exr in a library that was
/// built without EXR; IO, with the path in the message, also for an older file that this process may not write, for
/// another user's symbolic link in a sticky folder that all may write, and for a full disk or a quota.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_image_save(image: *const BhrImage, path: *const c_char) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_image_save", || unsafe {
        let (given, space) = read_in_space(image, "image")?;
        let alpha = if given.transparent { Alpha::Premultiplied } else { Alpha::AsInFile };
        image::save(&given.pixels.as_image_ref(), alpha, space, &path_of(path)?)
    })
}

/// Reads a PNG, EXR, PNM or KTX2 file. The caller sets image->struct_size; the rest is filled in: packed rows from
/// the top down, RGBA8_SRGB for 8-bit files in sRGB, else RGBA32F, which is linear light in Rec. 709, converted from
/// the colours that the file states. The pixels are the library's: give them back with bhr_image_release, once.
/// docs/files.md says how files are read, and which bounds they have.
/// Errors: UNSUPPORTED for EXR of the compressions DWA and HTJ2K, for colours of a PNG that are not known, for texels,
/// primaries, curves or compressions of a KTX2 file that docs/files.md does not name, or in a library built without
/// EXR; IO for a file that is not there, not readable, broken, of more than 2^20 pixels a side, or of more than 4 GiB
/// of pixels in memory. Memory is taken after the file's claims are checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_image_load(path: *const c_char, image: *mut BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = OutStruct::cleared(image, "image");
        anywhere("bhr_image_load", || {
            let path = path_of(path)?;
            out.set(&BhrImage::empty())?;
            let mut loaded = image::load(&path)?;
            out.set(&describe(&mut loaded))?;
            keep(loaded);
            Ok(())
        })
    }
}

fn describe(loaded: &mut Loaded) -> BhrImage {
    let row = loaded.width as usize * loaded.format.bytes_per_pixel();
    BhrImage {
        format: loaded.format as BhrFormat,
        width: loaded.width,
        height: loaded.height,
        row_stride: row as i64,
        byte_size: row as u64 * u64::from(loaded.height),
        pixels: loaded.pixels.as_mut_ptr().cast(),
        ..BhrImage::empty()
    }
}

/// The pixels that hosts hold, by their address: it tells the library's pixels from the host's.
static KEPT: Mutex<BTreeMap<usize, Loaded>> = Mutex::new(BTreeMap::new());

fn kept() -> MutexGuard<'static, BTreeMap<usize, Loaded>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

fn keep(mut loaded: Loaded) {
    kept().insert(loaded.pixels.as_mut_ptr().addr(), loaded);
}

/// Gives back the pixels of bhr_image_load and sets image->pixels to NULL and byte_size to 0.
/// Errors: INVALID_ARGUMENT for pixels that are NULL, the host's, or were given back before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_image_release(image: *mut BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    anywhere("bhr_image_release", || unsafe {
        let given = versioned::read(image, "image")?;
        // The lock ends before the pixels do.
        let Some(loaded) = kept().remove(&given.pixels.addr()) else {
            return Err(Error::argument(format!(
                "image pixels {:p} are not held for bhr_image_load: the host's own, or released before",
                given.pixels
            )));
        };
        drop(loaded);
        versioned::write(image, "image", &BhrImage { pixels: null_mut(), byte_size: 0, ..given })
    })
}
