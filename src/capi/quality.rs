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

/// How light is followed. Frames by different methods differ by less than these errors:
///
/// | method                     | rays are                                | look direction | radius, redshift |
/// |----------------------------|-----------------------------------------|----------------|------------------|
/// | ADAPTIVE, double precision | integrated with error control           | 1e-8 rad       | 1e-8, relative   |
/// | ADAPTIVE, single precision | integrated with error control           | 2e-6 rad       | 2e-6             |
/// | RK4 with the default step  | integrated in fixed steps, fourth order | 2e-5 rad       | 2e-5             |
/// | AUTO                       | looked up in tables where that pays     | 5e-6 rad       | 1e-5             |
///
/// An error of the look direction is how far the ray of a sky direction is off; each error is divided by (1 +
/// conditioning), as rays near the edge of the shadow magnify every rounding. The CPU tracer works in double precision,
/// GPUs in single.
///
/// AUTO, the fastest, makes tables of the lens that the hole is for the camera's observer. They are made anew when the
/// observer moves, but not when the view turns or zooms, and they serve under these conditions:
///
/// |                              | spin 0                       | with spin                                    |
/// |------------------------------|------------------------------|----------------------------------------------|
/// | samples in a frame, at least | 4096                         | 500000 on a GPU, 140000 on the CPU           |
/// | nearest observer             | 2.0005 M; in FREE_FALL 0.9 M | 1.03 retrograde photon orbits (3.1 to 4.1 M) |
/// | farthest observer            | 1e6 M                        | 1e5 M                                        |
/// | max_disk_order, at most      | 15                           | 15; beyond 1e4 M 11                          |
/// | ... of a turbulent disk      | 15                           | 3; beyond 1e4 M 2                            |
///
/// Elsewhere AUTO integrates every ray in fixed steps of fifth order, as it always does for bhr_trace_rays,
/// BHR_VIEW_METRIC, disks with BHR_DISK_PLUNGES, and scenes with volumes or hot spots.
pub type BhrMethod = i32;
/// Looked up in tables where that pays, else integrated. The fastest.
pub const BHR_METHOD_AUTO: BhrMethod = 0;
/// Every ray integrated by fixed-step fourth-order Runge-Kutta.
pub const BHR_METHOD_RK4: BhrMethod = 1;
/// Every ray integrated by embedded Runge-Kutta with error control.
pub const BHR_METHOD_ADAPTIVE: BhrMethod = 2;

/// The rays that matter with depth, volumes and hot spots, is summed along. Since 0.2.0.
pub type BhrVolumeResolution = i32;
/// Those of all pixels. Since 0.2.0.
pub const BHR_VOLUME_RESOLUTION_FULL: BhrVolumeResolution = 0;
/// One ray of each block of 2 x 2 pixels, counted from the frame's top-left corner: a pixel's matter is found from the
/// twelve blocks about it by cubic interpolation. The pixel's own ray is summed instead where one of their rays had
/// another fate than the pixel's or met other images of the disk; and where linear interpolation, which is one order
/// less exact than what is shown, may be off by more than 1/64 (1/16 in scenes with turbulent matter) of the light (of
/// its brightest colour), of the share of light from behind that passes, or of the view's value. Light below 0.004 of
/// white counts as 0.004, a share below 0.05 as 0.05, an optical depth below 0.001 as 0.001. The rest of a pixel, and
/// the rays of pixels that an edge runs through, are as with FULL. What is narrower than a block, as a thin image or
/// fine turbulence, may lie between the rays and be missed: in a turbulent picture of 320 x 180 nine of ten pixels were
/// within 1/30 of those with FULL, all but 0.1 % within 1/6.
/// The same scene gives the same bytes, whole or in parts; both tracers do so. BhrFrameStats counts the steps of the
/// pixels' rays only. Since 0.2.0.
pub const BHR_VOLUME_RESOLUTION_HALF: BhrVolumeResolution = 1;

/// How exactly to trace.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrQuality {
    /// sizeof(BhrQuality).
    pub struct_size: u32,
    /// BHR_METHOD_*. Default AUTO.
    pub method: BhrMethod,
    /// Samples of each pixel, 1 (default) .. 256. More than one are drawn from, and so weighted by, a quadratic
    /// B-spline 3 pixels wide about the pixel's centre. (CUBE: they lie evenly in the pixel, because another part of
    /// the sky begins across a face's border.) Views other than BHR_VIEW_LIGHT take one. Where an edge of the disk, a
    /// steep change or the edge of the shadow runs through the pixel, each sample is the mean of 4 or 32 rays over a
    /// pixel's area; BhrFrameStats does not count those.
    pub samples_per_pixel: u32,
    /// Steps of an integrated ray, 16 .. 100000. Default 2000. A ray that needs more is BHR_FATE_UNRESOLVED.
    pub max_steps: u32,
    /// RK4: the step in sigma = S tau (Mino time scaled to the ray), 1e-3 .. 0.5; 0 means the default, 0.1.
    pub step: f64,
    /// ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0 means the default, 1e-10. Single-precision tracers use their
    /// own.
    pub tolerance: f64,
    /// Images of the disk to follow, 0 (the direct one only) .. 15. Default 3.
    pub max_disk_order: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// Windows: traced size / window size, 0.1 .. 1. Default 1.
    pub render_scale: f64,
    /// BHR_VOLUME_RESOLUTION_*. Default FULL. No effect without volumes and hot spots. Since 0.2.0.
    pub volume_resolution: BhrVolumeResolution,
    /// Reserved: 0. Since 0.2.0.
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
            keep_light: None,
            map_sampler: None,
        };
        quality.check()?;
        Ok(quality)
    }
}

/// Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
/// for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_quality_init(quality: *mut BhrQuality, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_quality_init", || unsafe { versioned::init(quality, "quality", struct_size) })
}

/// Sets the quality. Errors: INVALID_ARGUMENT for NULL, a number outside its range, an unknown method or
/// an unknown resolution.
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

/// The quality as it is set. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_quality(context: *const BhrContext, quality: *mut BhrQuality) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let quality = OutStruct::cleared(quality, "quality");
        on_context("bhr_get_quality", context, |state| quality.set(&state.renderer.scene.quality.into()))
    }
}
