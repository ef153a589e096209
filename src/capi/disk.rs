//! BhrDisk: the accretion disk.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, check_flags};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::Disk;

/// BhrDisk.flags: the matter orbits towards -ph.
pub const BHR_DISK_RETROGRADE: u32 = 1u32;

/// A geometrically thin disk in the equatorial plane, on circular geodesics, with the Page-Thorne flux. Radii in
/// units of M.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrDisk {
    /// sizeof(BhrDisk).
    pub struct_size: u32,
    /// BHR_DISK_* bits. Default 0: prograde.
    pub flags: u32,
    /// In M, 0 .. 1e6. 0 (default): the ISCO. Matter inside the ISCO does not shine.
    pub inner_radius: f64,
    /// In M, greater than inner_radius, to 1e6. Default 20.
    pub outer_radius: f64,
    /// Kelvin at the hottest radius of the profile, 500 .. 1e9. Default 6500.
    pub temperature: f64,
    /// 0 .. 1. Default 1.
    pub opacity: f64,
    /// 0 .. 1e6. Default 1: the hottest ring at rest has luminance 1.
    pub brightness: f64,
    /// Contrast of the structure that orbits with the matter, from 0, smooth (default), to 1. It makes the disk lighter
    /// and darker by turns, and bhr_set_time carries it along. A pattern lives for 120 M, and every 60 M a new one
    /// begins: two at a time fade in and out.
    pub turbulence: f64,
    /// Selects the turbulence: the same seed always gives the same pattern. Any number. Default 0.
    pub seed: u64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrDisk {
    const NAME: &'static str = "BhrDisk";
    const SIZES: &'static [usize] = &[64];
    fn defaults() -> Self {
        Disk::default().into()
    }
}

impl From<Disk> for BhrDisk {
    fn from(disk: Disk) -> Self {
        Self {
            struct_size: 0,
            flags: if disk.retrograde { BHR_DISK_RETROGRADE } else { 0 },
            inner_radius: disk.inner_radius,
            outer_radius: disk.outer_radius,
            temperature: disk.temperature,
            opacity: disk.opacity,
            brightness: disk.brightness,
            turbulence: disk.turbulence,
            seed: disk.seed,
        }
    }
}

impl TryFrom<BhrDisk> for Disk {
    type Error = Error;

    fn try_from(given: BhrDisk) -> Result<Self> {
        let flags = check_flags(given.flags, BHR_DISK_RETROGRADE, "disk flags")?;
        let disk = Self {
            retrograde: flags & BHR_DISK_RETROGRADE != 0,
            inner_radius: given.inner_radius,
            outer_radius: given.outer_radius,
            temperature: given.temperature,
            opacity: given.opacity,
            brightness: given.brightness,
            turbulence: given.turbulence,
            seed: given.seed,
        };
        disk.check()?;
        Ok(disk)
    }
}

/// Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
/// for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_disk_init(disk: *mut BhrDisk, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_disk_init", || unsafe { versioned::init(disk, "disk", struct_size) })
}

/// Sets the disk; NULL: no disk. A new context has the default one. Errors: INVALID_ARGUMENT for a number outside
/// its range or an unknown flag.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_disk(context: *mut BhrContext, disk: *const BhrDisk) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_disk", context, |state| {
            state.renderer.scene.disk = match disk.is_null() {
                true => None,
                false => Some(versioned::read(disk, "disk")?.try_into()?),
            };
            Ok(())
        })
    }
}

/// Reads the disk as it is set. *out_present becomes 1 with a disk; without one it becomes 0, and disk gets the
/// defaults. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_disk(
    context: *const BhrContext,
    disk: *mut BhrDisk,
    out_present: *mut i32,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let disk = OutStruct::cleared(disk, "disk");
        let present = Out::cleared(out_present);
        on_context("bhr_get_disk", context, |state| {
            present.required("out_present")?;
            let set = state.renderer.scene.disk;
            disk.set(&set.unwrap_or_default().into())?;
            present.set(set.is_some().into());
            Ok(())
        })
    }
}
