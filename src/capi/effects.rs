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

/// Sets the effects that colour the light: BHR_EFFECT_* bits; unknown bits are ignored. Default BHR_EFFECT_ALL. Lensing
/// itself cannot be switched off. The redshift g = g_gravity g_doppler is split at the local static observers (ZAMO) of
/// emitter and camera. LIGHT_DELAY shows only where matter is not the same all around: in a turbulent disk, in the
/// structure of volumes and in hot spots, from inside a spin-0 horizon too; without it, all matter is seen as it is at
/// the t that bhr_set_time gives. Errors: INVALID_ARGUMENT for NULL.
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

/// The effects as they are set. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL.
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

/// Sets the scene's time in scene lengths, finite; it turns disk, volumes and spots. Default 0. It is the chart's t
/// at the camera, which ends at the horizon; for a camera at or inside a spin-0 horizon it is the rain
/// (Painleve-Gullstrand) time T = t + H(r), r in M, with H = 2 sqrt(2 r) + 2 ln((sqrt(r) - sqrt(2)) / (sqrt(r) +
/// sqrt(2))), which a clock that falls from rest at infinity shows. bhr_camera_advance tells how both go by. Errors:
/// INVALID_ARGUMENT.
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

/// The time as it is set, scene lengths. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL.
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
