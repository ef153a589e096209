// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrDisk: the accretion disk.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, check_flags, unknown};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::{Disk, DiskReference, EmissionLaw};

/// BhrDisk.flags: the matter orbits towards -ph.
pub const BHR_DISK_RETROGRADE: u32 = 1u32;
/// BhrDisk.flags: matter shines on its way from the ISCO to the horizon, too, where it falls freely. Rays are
/// integrated one by one, which takes longer. docs/matter.md has the model. @since 0.2.0
pub const BHR_DISK_PLUNGES: u32 = 2u32;

/// The ring at whose radius a disk has the stated temperature and brightness. @since 0.2.0
pub type BhrDiskReference = i32;
/// The hottest ring of the profile: at spin 0 r = 9.55 M, at spin 0.998 r = 1.58 M. Where that ring moves inwards,
/// the rest of the disk darkens.
pub const BHR_DISK_AT_HOTTEST: BhrDiskReference = 0;
/// The ring that halves the disk's area, r^2 = (inner^2 + outer^2) / 2, but for the outermost quarter of a soft
/// outer edge's fading: the disk as a whole keeps its look when spin or edges change.
pub const BHR_DISK_AT_MEDIAN: BhrDiskReference = 1;

/// How the disk's light depends on the angle to its normal, in the frame of its matter. The flux is the same.
/// @since 0.2.0
pub type BhrEmissionLaw = i32;
/// The disk's surface shines alike in all directions.
pub const BHR_DISK_ISOTROPIC: BhrEmissionLaw = 0;
/// Like an atmosphere of free electrons: 1.269 times as bright along the normal, 0.414 times at grazing angles.
pub const BHR_DISK_LIMB_DARKENED: BhrEmissionLaw = 1;

/// A geometrically thin disk in the equatorial plane, on circular geodesics, with the Page-Thorne flux. Radii in
/// units of M. docs/matter.md has the model.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrDisk {
    /// sizeof(BhrDisk).
    pub struct_size: u32,
    /// Any of BHR_DISK_RETROGRADE | BHR_DISK_PLUNGES. Default 0.
    pub flags: u32,
    /// In M, 0 .. 1e6. The disk begins here, but not inside the ISCO, or with BHR_DISK_PLUNGES not inside the
    /// horizon. Default 0: at the ISCO, or at the horizon.
    pub inner_radius: f64,
    /// In M, 0 .. 1e6, greater than inner_radius. Default 17.
    pub outer_radius: f64,
    /// Kelvin at the ring that `reference` says, 500 .. 1e9. Default 3500.
    pub temperature: f64,
    /// 0 .. 1. Default 1.
    pub opacity: f64,
    /// 0 .. 1e6: the luminance of that ring at rest. Default 0.6.
    pub brightness: f64,
    /// Contrast of the structure that orbits with the matter, 0 .. 1; 0 is smooth. Default 1. Its mean is the smooth
    /// disk's light. bhr_set_time carries it along, forwards and backwards, at any time to 1e9 M and more.
    pub turbulence: f64,
    /// Selects the turbulence: the same seed always gives the same pattern. Any number. Default 0.
    pub seed: u64,
    /// BHR_DISK_AT_*. Default AT_MEDIAN; AT_HOTTEST in structs of 0.1.0's size. @since 0.2.0
    pub reference: BhrDiskReference,
    /// BHR_DISK_ISOTROPIC (default), BHR_DISK_LIMB_DARKENED. @since 0.2.0
    pub emission_law: BhrEmissionLaw,
    /// 0 .. 1, default 0.4, 0 is sharp: opacity and light fade to nothing over this share of the way from the inner
    /// edge to the outer one, at its end, and near the ISCO. A disk that inner_radius cuts off outside the hottest
    /// ring is sharp there. @since 0.2.0
    pub edge_softness: f64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrDisk {
    const NAME: &'static str = "BhrDisk";
    const SIZES: &'static [usize] = &[64, 80];
    fn defaults() -> Self {
        Disk::default().into()
    }
    fn defaults_of(size: usize) -> Self {
        // The plain disk is that of 0.1.0: edges were sharp, and the hottest ring had the stated temperature.
        if size < size_of::<Self>() { Disk::plain().into() } else { Self::defaults() }
    }
}

impl From<Disk> for BhrDisk {
    fn from(disk: Disk) -> Self {
        Self {
            struct_size: 0,
            flags: if disk.retrograde { BHR_DISK_RETROGRADE } else { 0 }
                | if disk.plunges { BHR_DISK_PLUNGES } else { 0 },
            inner_radius: disk.inner_radius,
            outer_radius: disk.outer_radius,
            temperature: disk.temperature,
            opacity: disk.opacity,
            brightness: disk.brightness,
            turbulence: disk.turbulence,
            seed: disk.seed,
            reference: disk.reference as BhrDiskReference,
            emission_law: disk.emission_law as BhrEmissionLaw,
            edge_softness: disk.edge_softness,
        }
    }
}

impl TryFrom<BhrDisk> for Disk {
    type Error = Error;

    fn try_from(given: BhrDisk) -> Result<Self> {
        let flags = check_flags(given.flags, BHR_DISK_RETROGRADE | BHR_DISK_PLUNGES, "disk flags")?;
        let reference = match given.reference {
            BHR_DISK_AT_HOTTEST => DiskReference::Hottest,
            BHR_DISK_AT_MEDIAN => DiskReference::Median,
            value => return unknown(value, "disk reference", "BHR_DISK_AT_HOTTEST (0), _MEDIAN (1)"),
        };
        let emission_law = match given.emission_law {
            BHR_DISK_ISOTROPIC => EmissionLaw::Isotropic,
            BHR_DISK_LIMB_DARKENED => EmissionLaw::LimbDarkened,
            value => {
                return unknown(value, "disk emission_law", "BHR_DISK_ISOTROPIC (0), BHR_DISK_LIMB_DARKENED (1)");
            }
        };
        let disk = Self {
            retrograde: flags & BHR_DISK_RETROGRADE != 0,
            inner_radius: given.inner_radius,
            outer_radius: given.outer_radius,
            temperature: given.temperature,
            opacity: given.opacity,
            brightness: given.brightness,
            turbulence: given.turbulence,
            seed: given.seed,
            reference,
            edge_softness: given.edge_softness,
            emission_law,
            plunges: flags & BHR_DISK_PLUNGES != 0,
        };
        disk.check()?;
        Ok(disk)
    }
}

/// Fills in the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_disk_init(disk: *mut BhrDisk, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_disk_init", || unsafe { versioned::init(disk, "disk", struct_size) })
}

/// Sets the disk; NULL: no disk. A new context has the default one.
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
/// defaults.
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
            match set {
                Some(set) => disk.set(&set.into())?,
                None => disk.set_defaults()?,
            }
            present.set(set.is_some().into());
            Ok(())
        })
    }
}
