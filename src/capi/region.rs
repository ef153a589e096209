// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrRegion: the part of a larger frame that an image holds.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, check_reserved};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::Region;

/// The part of a larger frame that an image holds: for tiles, dome walls and render farms. Tiles that are joined
/// have the same bytes as the frame, unless its film needs the light of the whole frame (see bhr_set_region).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrRegion {
    /// sizeof(BhrRegion).
    pub struct_size: u32,
    /// Pixels of the whole frame, 1 .. 2^20.
    pub full_width: u32,
    /// Pixels of the whole frame, 1 .. 2^20.
    pub full_height: u32,
    /// Column of the image's left pixels in the frame, < full_width.
    pub x: u32,
    /// Row of the image's top pixels in the frame, < full_height.
    pub y: u32,
    /// Reserved: 0.
    pub reserved: u32,
}

// SAFETY: repr(C), size first, no padding, integers only.
unsafe impl Versioned for BhrRegion {
    const NAME: &'static str = "BhrRegion";
    const SIZES: &'static [usize] = &[24];
    fn defaults() -> Self {
        Self { struct_size: 0, full_width: 0, full_height: 0, x: 0, y: 0, reserved: 0 }
    }
}

impl From<Region> for BhrRegion {
    fn from(set: Region) -> Self {
        Self { full_width: set.full_width, full_height: set.full_height, x: set.x, y: set.y, ..Self::defaults() }
    }
}

impl TryFrom<BhrRegion> for Region {
    type Error = Error;

    fn try_from(given: BhrRegion) -> Result<Self> {
        check_reserved(given.reserved, "region")?;
        let region = Self { full_width: given.full_width, full_height: given.full_height, x: given.x, y: given.y };
        region.check()?;
        Ok(region)
    }
}

/// Sets struct_size and clears the rest: the frame's size has no default. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_region_init(region: *mut BhrRegion, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_region_init", || unsafe { versioned::init(region, "region", struct_size) })
}

/// Sets the region; NULL: images are whole frames. Images, jobs and camera rays obey it, windows do not.
/// Rendering is INVALID_ARGUMENT for an image that reaches out of the frame (x + width > full_width), and
/// INVALID_STATE for 8- and 10-bit images of light with a film that needs the light of the whole frame: bloom
/// (see there), a beam, spikes, a streak, a flare, auto exposure, highlights or shadows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_region(context: *mut BhrContext, region: *const BhrRegion) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_region", context, |state| {
            state.region = match region.is_null() {
                true => None,
                false => Some(versioned::read(region, "region")?.try_into()?),
            };
            Ok(())
        })
    }
}

/// Reads the region as it is set. *out_present becomes 1 with a region; without one it becomes 0, and region gets the
/// values of bhr_region_init. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_region(
    context: *const BhrContext,
    region: *mut BhrRegion,
    out_present: *mut i32,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let region = OutStruct::cleared(region, "region");
        let present = Out::cleared(out_present);
        on_context("bhr_get_region", context, |state| {
            present.required("out_present")?;
            match state.region {
                Some(set) => region.set(&set.into())?,
                None => region.set_defaults()?,
            }
            present.set(state.region.is_some().into());
            Ok(())
        })
    }
}
