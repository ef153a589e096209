// SPDX-License-Identifier: MIT OR Apache-2.0
//! BHR_EFFECT_*, the relativistic effects that colour the light, and the scene's time.

use super::call::on_context;
use super::context::BhrContext;
use super::pointer::{Out, check_finite};
use super::status::BhrStatus;
use crate::error::{Error, out_of_range};
use crate::scene::{EffectStrengths, Effects, Scene};

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

/// The effects that may be weakened.
const GRADED: u32 = Effects::DOPPLER_SHIFT | Effects::GRAVITY_SHIFT | Effects::BEAMING;

/// The strength of each of them, by its bit.
fn strengths(set: &mut EffectStrengths) -> [(u32, &mut f64); 3] {
    [
        (Effects::DOPPLER_SHIFT, &mut set.doppler_shift),
        (Effects::GRAVITY_SHIFT, &mut set.gravity_shift),
        (Effects::BEAMING, &mut set.beaming),
    ]
}

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

/// Sets how strongly effects show: strength, 0 (not at all) .. 1 (default: as physics has it), for those of
/// BHR_EFFECT_DOPPLER_SHIFT, GRAVITY_SHIFT and BEAMING whose bits are in effects; others stay as they are. The
/// effect's factor counts to the power of the strength, for colours its part of the ratio of frequencies g, for BEAMING
/// all of g: at 0.5 light shifts by half as much in log frequency. What bhr_set_effects switches off does not show;
/// bhr_set_preset sets all strengths to 1. Like effects, they change light alone, not g as views, rays and crossings
/// tell it. docs/physics.md.
/// Errors: INVALID_ARGUMENT for no bit, LIGHT_DELAY or an unknown bit, or a strength beyond its range. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_effect_strength(context: *mut BhrContext, effects: u32, strength: f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_effect_strength", context, |state| {
            if effects == 0 || effects & !GRADED != 0 {
                return Err(Error::argument(format!(
                    "effects is {effects:#x}; it must be bits of DOPPLER_SHIFT, GRAVITY_SHIFT and BEAMING, at least one"
                )));
            }
            if !(0.0..=1.0).contains(&strength) {
                return Err(out_of_range("strength", strength, 0.0, 1.0));
            }
            let set = &mut state.renderer.scene.effect_strengths;
            for (bit, own) in strengths(set) {
                if effects & bit != 0 {
                    *own = strength;
                }
            }
            Ok(())
        })
    }
}

/// Reads the strength of the effect whose bit is given, as it is set, whether or not it is switched on.
/// Errors: INVALID_ARGUMENT for other bits than those of bhr_set_effect_strength, or several. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_effect_strength(
    context: *const BhrContext,
    effect: u32,
    out_strength: *mut f64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_strength);
        on_context("bhr_get_effect_strength", context, |state| {
            out.required("out_strength")?;
            let mut set = state.renderer.scene.effect_strengths;
            let found = strengths(&mut set).into_iter().find(|(bit, _)| *bit == effect);
            let Some((_, strength)) = found else {
                return Err(Error::argument(format!(
                    "effect is {effect:#x}; it must be one of DOPPLER_SHIFT, GRAVITY_SHIFT and BEAMING"
                )));
            };
            out.set(*strength);
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

/// Sets how long the shutter is open, as scene lengths: from half of it before the scene's time to half of it after.
/// 0 .. 1e300; default 0, one moment. While it is open a pixel's samples (BhrQuality.samples_per_pixel) are moments,
/// evenly over the time, at which disk, volumes and spots are seen through the pixel's middle, so that they blur as
/// they move; one sample sees the middle. Camera and hole are as at the scene's time. More than 1000 M acts as 1000 M.
/// docs/motion-blur.md.
/// Errors: INVALID_ARGUMENT for a value out of range. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_shutter(context: *mut BhrContext, shutter: f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_shutter", context, |state| {
            state.renderer.scene.shutter = Scene::check_shutter(shutter)?;
            Ok(())
        })
    }
}

/// Reads how long the shutter is open as it is set, scene lengths. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_shutter(context: *const BhrContext, out_shutter: *mut f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let shutter = Out::cleared(out_shutter);
        on_context("bhr_get_shutter", context, |state| {
            shutter.required("out_shutter")?;
            shutter.set(state.renderer.scene.shutter);
            Ok(())
        })
    }
}
