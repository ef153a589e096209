// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's surroundings as the sky's map, from a target.

use super::call::on_context;
use super::camera::{BHR_PROJECTION_CUBE, BHR_PROJECTION_EQUIRECT, BhrProjection};
use super::context::BhrContext;
use super::interop_target::BhrTarget;
use super::pointer::unknown;
use super::state::State;
use super::status::BhrStatus;
use crate::error::Result;

/// bhr_set_sky_map with a picture on the GPU: target is an equirectangular one of RGBA16F or RGBA32F, made, imported
/// or wrapped, as wide as high at least, of 16384 x 8192 texels at most, laid out as bhr_set_sky_map has it, that
/// frames with BHR_SKY_MAP, in windows too, read anew each time. NULL: none; each of the functions replaces what
/// another has set. When and how it is read, and how long it must stay, is as with bhr_set_occluder_target
/// (docs/gpu.md). It cannot be a frame's target as well. A buffer may have any row_stride.
/// Errors: INVALID_ARGUMENT for another format or shape, or a target of another context; UNSUPPORTED for an image
/// without TRANSFER_SRC usage, and for a map that is larger than the device's textures (it takes one and a half
/// times its rows); SURFACE_LOST; the map then stays as it was. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_target(context: *mut BhrContext, target: *mut BhrTarget) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { on_context("bhr_set_sky_target", context, |state| set(state, target, false)) }
}

/// bhr_set_sky_target of a picture in another layout: EQUIRECT is bhr_set_sky_target, CUBE six faces side by side, 6
/// times as wide as high, at most 2730 texels a side, as a picture with BHR_PROJECTION_CUBE of a camera that looks
/// along +x of the sky axes (right ascension 0) with +z (the north pole) up. docs/gpu.md.
/// Errors: those of bhr_set_sky_target; INVALID_ARGUMENT for another layout; UNSUPPORTED for rows so far apart that
/// a kernel's six bindings, of 128 MiB at least, do not hold them. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_target_as(
    context: *mut BhrContext,
    target: *mut BhrTarget,
    layout: BhrProjection,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_sky_target_as", context, |state| {
            let cube = match layout {
                BHR_PROJECTION_EQUIRECT => false,
                BHR_PROJECTION_CUBE => true,
                _ => return unknown(layout, "layout", "BHR_PROJECTION_EQUIRECT (2) or BHR_PROJECTION_CUBE (3)"),
            };
            set(state, target, cube)
        })
    }
}

/// # Safety
/// `target` is NULL or alive.
unsafe fn set(state: &mut State, target: *const BhrTarget, cube: bool) -> Result<()> {
    // SAFETY: this function's contract.
    match unsafe { target.as_ref() } {
        Some(target) => state.renderer.set_sky_target(&target.target, cube)?,
        None => (state.renderer.scene.sky_map, state.renderer.scene.sky_picture) = (None, None),
    }
    state.files.map = None;
    Ok(())
}
