// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrQuality: how exactly to trace.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{check_reserved, unknown};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::scene::{LensTables, Method, Quality, VolumeResolution};

/// The way in which light is followed. Frames by different methods differ by less than their errors, which
/// docs/quality.md states: 2e-6 to 2e-5 of look directions and radii on GPUs, which work in single precision, 1e-8
/// by the CPU tracer's ADAPTIVE.
pub type BhrMethod = i32;
/// The fastest: rays are looked up in tables where that pays, else integrated.
pub const BHR_METHOD_AUTO: BhrMethod = 0;
/// Every ray integrated by fixed-step fourth-order Runge-Kutta.
pub const BHR_METHOD_RK4: BhrMethod = 1;
/// Every ray integrated by embedded Runge-Kutta with error control.
pub const BHR_METHOD_ADAPTIVE: BhrMethod = 2;

/// The rays along which volumes and hot spots are summed. @since 0.2.0
pub type BhrVolumeResolution = i32;
/// The rays of all pixels.
pub const BHR_VOLUME_RESOLUTION_FULL: BhrVolumeResolution = 0;
/// One ray of each block of 2 x 2 pixels, and those of pixels that interpolation would get wrong. Faster; fine
/// turbulence and thin images may be missed. docs/quality.md states errors.
pub const BHR_VOLUME_RESOLUTION_HALF: BhrVolumeResolution = 1;

/// How exactly to trace.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrQuality {
    /// sizeof(BhrQuality).
    pub struct_size: u32,
    /// BHR_METHOD_*. Default AUTO.
    pub method: BhrMethod,
    /// Samples of each pixel, 1 .. 256. Default 1. More than one are weighted by a B-spline 3 pixels wide; in a
    /// CUBE they lie evenly in the pixel; while a shutter is open they are moments, all through the pixel's middle.
    /// Views other than BHR_VIEW_LIGHT take one. Pixels that an edge runs through get more rays in any case.
    pub samples_per_pixel: u32,
    /// Steps of an integrated ray, 16 .. 100000. Default 2000. A ray that needs more is BHR_FATE_UNRESOLVED.
    pub max_steps: u32,
    /// RK4: the step, 1e-3 .. 0.5, in Mino time scaled to the ray (docs/numerics.md); 0 means the default, 0.1.
    pub step: f64,
    /// ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0: the default, 1e-10. Single-precision tracers use their
    /// own.
    pub tolerance: f64,
    /// Images of the disk to follow, 0 .. 15; 0: the direct one only. Default 3.
    pub max_disk_order: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// Windows: traced size / window size, 0.1 .. 1. Default 1.
    pub render_scale: f64,
    /// BHR_VOLUME_RESOLUTION_*. Default FULL. No effect without volumes and hot spots. @since 0.2.0
    pub volume_resolution: BhrVolumeResolution,
    /// Reserved: 0. @since 0.2.0
    pub reserved2: u32,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrQuality {
    const NAME: &'static str = "BhrQuality";
    const SIZES: &'static [usize] = &[48, 56];
    fn defaults() -> Self {
        Quality::default().into()
    }
}

impl From<Quality> for BhrQuality {
    fn from(quality: Quality) -> Self {
        Self {
            struct_size: 0,
            method: quality.method as BhrMethod,
            samples_per_pixel: quality.samples_per_pixel,
            max_steps: quality.max_steps,
            step: quality.step,
            tolerance: quality.tolerance,
            max_disk_order: quality.max_disk_order,
            reserved: 0,
            render_scale: quality.render_scale,
            volume_resolution: quality.volume_resolution as BhrVolumeResolution,
            reserved2: 0,
        }
    }
}

impl TryFrom<BhrQuality> for Quality {
    type Error = Error;

    fn try_from(given: BhrQuality) -> Result<Self> {
        let method = match given.method {
            BHR_METHOD_AUTO => Method::Auto,
            BHR_METHOD_RK4 => Method::Rk4,
            BHR_METHOD_ADAPTIVE => Method::Adaptive,
            value => return unknown(value, "quality method", "BHR_METHOD_AUTO (0), _RK4 (1), _ADAPTIVE (2)"),
        };
        let volume_resolution = match given.volume_resolution {
            BHR_VOLUME_RESOLUTION_FULL => VolumeResolution::Full,
            BHR_VOLUME_RESOLUTION_HALF => VolumeResolution::Half,
            value => {
                let known = "BHR_VOLUME_RESOLUTION_FULL (0), _HALF (1)";
                return unknown(value, "quality volume_resolution", known);
            }
        };
        check_reserved(given.reserved, "quality")?;
        if given.reserved2 != 0 {
            return Err(Error::argument(format!("quality reserved2 is {}; it must be 0", given.reserved2)));
        }
        let quality = Self {
            method,
            samples_per_pixel: given.samples_per_pixel,
            max_steps: given.max_steps,
            step: given.step,
            tolerance: given.tolerance,
            max_disk_order: given.max_disk_order,
            render_scale: given.render_scale,
            volume_resolution,
            lens_tables: LensTables::Auto,
            mapped_pixels: None,
            shares_kernels: None,
            anticipates: None,
            refines: true,
            edges_later: false,
            keep_light: None,
            map_sampler: None,
        };
        quality.check()?;
        Ok(quality)
    }
}

/// Fills in the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_quality_init(quality: *mut BhrQuality, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_quality_init", || unsafe { versioned::init(quality, "quality", struct_size) })
}

/// Sets the quality.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_quality(context: *mut BhrContext, quality: *const BhrQuality) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_quality", context, |state| {
            state.renderer.scene.quality = versioned::read(quality, "quality")?.try_into()?;
            Ok(())
        })
    }
}

/// Reads the quality as it is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_quality(context: *const BhrContext, quality: *mut BhrQuality) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let quality = OutStruct::cleared(quality, "quality");
        on_context("bhr_get_quality", context, |state| quality.set(&state.renderer.scene.quality.into()))
    }
}
