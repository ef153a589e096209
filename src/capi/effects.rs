// SPDX-License-Identifier: MIT OR Apache-2.0
//! BHR_EFFECT_*, the relativistic effects that colour the light, and the scene's time.

use super::call::on_context;
use super::context::BhrContext;
use super::pointer::{Out, check_finite};
use super::status::BhrStatus;
use crate::scene::Effects;

/// The frequency shift by motion colours the light.
pub const BHR_EFFECT_DOPPLER_SHIFT: u32 = 1u32;
/// The gravitational redshift colours the light.
pub const BHR_EFFECT_GRAVITY_SHIFT: u32 = 2u32;
/// The intensity follows g^3 (I_nu), g^4 (bolometric).
pub const BHR_EFFECT_BEAMING: u32 = 4u32;
/// Moving matter is seen at its retarded time.
pub const BHR_EFFECT_LIGHT_DELAY: u32 = 8u32;
/// All effects, as a new context has them.
pub const BHR_EFFECT_ALL: u32 = 0xffff_ffffu32;

const _: () = assert!(
    BHR_EFFECT_DOPPLER_SHIFT == Effects::DOPPLER_SHIFT
        && BHR_EFFECT_GRAVITY_SHIFT == Effects::GRAVITY_SHIFT
        && BHR_EFFECT_BEAMING == Effects::BEAMING
        && BHR_EFFECT_LIGHT_DELAY == Effects::LIGHT_DELAY
        && BHR_EFFECT_ALL == Effects::ALL
);

/// Sets the effects that colour the light: BHR_EFFECT_* bits; unknown bits are ignored. Default BHR_EFFECT_ALL.
/// Lensing itself cannot be switched off. LIGHT_DELAY shows where matter is not the same all around (turbulence,
/// structure, hot spots); without it all matter is seen as it is at the time of bhr_set_time. docs/physics.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_effects(context: *mut BhrContext, effects: u32) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_effects", context, |state| {
            state.renderer.scene.effects = Effects(effects);
            Ok(())
        })
    }
}

/// Reads the effects as they are set. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_effects(context: *const BhrContext, out_effects: *mut u32) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let effects = Out::cleared(out_effects);
        on_context("bhr_get_effects", context, |state| {
            effects.required("out_effects")?;
            effects.set(state.renderer.scene.effects.0);
            Ok(())
        })
    }
}

/// Sets the scene's time in scene lengths; it turns disk, volumes and spots. Default 0. It is the time of the camera's
/// chart at the camera: t, or in chart RAIN, and in STATIC for a camera at or inside a spin-0 horizon, rain time.
/// bhr_camera_advance tells how both go by (docs/cameras.md).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_time(context: *mut BhrContext, time: f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_time", context, |state| {
            state.renderer.scene.time = check_finite(time, "time")?;
            Ok(())
        })
    }
}

/// Reads the time as it is set, scene lengths. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_time(context: *const BhrContext, out_time: *mut f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let time = Out::cleared(out_time);
        on_context("bhr_get_time", context, |state| {
            time.required("out_time")?;
            time.set(state.renderer.scene.time);
            Ok(())
        })
    }
}
