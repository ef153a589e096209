// SPDX-License-Identifier: MIT OR Apache-2.0
//! The hole: mass, spin, axis, and numbers about it.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::pointer::{Out, read_vector};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::scene::Hole;
use crate::scene::query::HoleInfo;

/// Sets the mass M in scene lengths, finite and above 0. Default 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_mass(context: *mut BhrContext, mass: f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_mass", context, |state| {
            state.renderer.scene.hole.mass = Hole::check_mass(mass)?;
            Ok(())
        })
    }
}

/// Sets the spin a / M, -1 .. 1; below 0 the hole turns towards -ph. Default 0. Beyond +-0.9999 frames
/// and bhr_transfer_rays are UNSUPPORTED; single rays, points, world lines and camera moves go on to +-1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_spin(context: *mut BhrContext, spin: f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_spin", context, |state| {
            state.renderer.scene.hole.spin = Hole::check_spin(spin)?;
            Ok(())
        })
    }
}

/// Sets the spin axis, which is also the disk's normal: scene axes, any non-zero length. Default +z.
/// cbindgen:ptrs-as-arrays=[[axis;3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_axis(context: *mut BhrContext, axis: *const f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_axis", context, |state| {
            state.renderer.scene.hole.axis = Hole::check_axis(read_vector(axis, "axis")?)?;
            Ok(())
        })
    }
}

/// Reads the mass, the spin and the axis (a unit vector) as they are set.
/// cbindgen:ptrs-as-arrays=[[out_axis;3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_hole(
    context: *const BhrContext,
    out_mass: *mut f64,
    out_spin: *mut f64,
    out_axis: *mut f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let (mass, spin) = (Out::cleared(out_mass), Out::cleared(out_spin));
        let axis = Out::cleared(out_axis.cast::<[f64; 3]>());
        on_context("bhr_get_hole", context, |state| {
            mass.required("out_mass")?;
            spin.required("out_spin")?;
            axis.required("out_axis")?;
            let hole = &state.renderer.scene.hole;
            mass.set(hole.mass);
            spin.set(hole.spin);
            axis.set(hole.axis.to_array());
            Ok(())
        })
    }
}

/// Numbers about the hole and the camera's observer. Lengths are in scene units; what is not defined is NaN.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrHoleInfo {
    /// sizeof(BhrHoleInfo), set by the caller.
    pub struct_size: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// r+ = M + sqrt(M^2 - a^2).
    pub horizon_radius: f64,
    /// 2 M, at every spin.
    pub ergosphere_equatorial_radius: f64,
    /// Equatorial circular photon orbit towards +ph.
    pub photon_orbit_prograde: f64,
    /// Equatorial circular photon orbit towards -ph.
    pub photon_orbit_retrograde: f64,
    /// Innermost stable circular orbit of matter towards +ph.
    pub isco_prograde: f64,
    /// Innermost stable circular orbit of matter towards -ph.
    pub isco_retrograde: f64,
    /// Spin 0: 3 sqrt(3) M; NaN with spin.
    pub critical_impact_parameter: f64,
    /// Spin 0: angular radius of the shadow as the camera's observer sees it, radians; NaN with spin.
    pub shadow_angular_radius: f64,
    /// Boyer-Lindquist r of the camera.
    pub camera_radius: f64,
    /// d tau / d t, the rate of the clock of the camera's observer; t is the time of BhrCamera.chart.
    pub camera_time_rate: f64,
    /// r- = M - sqrt(M^2 - a^2), down to which the inside of a spinning hole is known; 0 without spin. @since 0.2.0
    pub inner_horizon_radius: f64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrHoleInfo {
    const NAME: &'static str = "BhrHoleInfo";
    const SIZES: &'static [usize] = &[88, 96];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            reserved: 0,
            horizon_radius: 0.0,
            ergosphere_equatorial_radius: 0.0,
            photon_orbit_prograde: 0.0,
            photon_orbit_retrograde: 0.0,
            isco_prograde: 0.0,
            isco_retrograde: 0.0,
            critical_impact_parameter: 0.0,
            shadow_angular_radius: 0.0,
            camera_radius: 0.0,
            camera_time_rate: 0.0,
            inner_horizon_radius: 0.0,
        }
    }
}

impl From<HoleInfo> for BhrHoleInfo {
    fn from(info: HoleInfo) -> Self {
        Self {
            struct_size: 0,
            reserved: 0,
            horizon_radius: info.horizon_radius,
            ergosphere_equatorial_radius: info.ergosphere_equatorial_radius,
            photon_orbit_prograde: info.photon_orbit_prograde,
            photon_orbit_retrograde: info.photon_orbit_retrograde,
            isco_prograde: info.isco_prograde,
            isco_retrograde: info.isco_retrograde,
            critical_impact_parameter: info.critical_impact_parameter,
            shadow_angular_radius: info.shadow_angular_radius,
            camera_radius: info.camera_radius,
            camera_time_rate: info.camera_time_rate,
            inner_horizon_radius: info.inner_horizon_radius,
        }
    }
}

/// Sets struct_size, which calls that fill the struct read, and clears the rest. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_hole_info_init(info: *mut BhrHoleInfo, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_hole_info_init", || unsafe { versioned::init(info, "info", struct_size) })
}

/// Fills in info for hole and camera as they are set; where its motion is not possible, the camera's are NaN.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_hole_info(context: *const BhrContext, info: *mut BhrHoleInfo) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let info = OutStruct::cleared(info, "info");
        on_context("bhr_hole_info", context, |state| info.set(&state.renderer.scene.hole_info()?.into()))
    }
}

/// Fills in the metric at a place in scene axes: out_metric[4 a + b] = g_ab in Boyer-Lindquist (t, r, th, ph) of
/// signature - + + +, inside horizons too.
/// Errors: INVALID_ARGUMENT at the centre and on a horizon.
/// cbindgen:ptrs-as-arrays=[[position;3], [out_metric;16]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_metric_at(
    context: *const BhrContext,
    position: *const f64,
    out_metric: *mut f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let metric = Out::cleared(out_metric.cast::<[f64; 16]>());
        on_context("bhr_metric_at", context, |state| {
            metric.required("out_metric")?;
            metric.set(state.renderer.scene.metric_at(read_vector(position, "position")?)?);
            Ok(())
        })
    }
}

/// Fills in the Christoffel symbols at a place in scene axes: out_gamma[16 a + 4 b + c] = Gamma^a_bc in
/// Boyer-Lindquist (t, r, th, ph), inside horizons too.
/// Errors: INVALID_ARGUMENT at the centre, on a horizon and on the axis.
/// cbindgen:ptrs-as-arrays=[[position;3], [out_gamma;64]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_christoffel_at(
    context: *const BhrContext,
    position: *const f64,
    out_gamma: *mut f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let gamma = Out::cleared(out_gamma.cast::<[f64; 64]>());
        on_context("bhr_christoffel_at", context, |state| {
            gamma.required("out_gamma")?;
            gamma.set(state.renderer.scene.christoffel_at(read_vector(position, "position")?)?);
            Ok(())
        })
    }
}
