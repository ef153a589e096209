// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's surroundings as the sky's map, from a target.

use super::call::on_context;
use super::camera::{BHR_PROJECTION_CUBE, BHR_PROJECTION_EQUIRECT, BhrProjection};
use super::context::BhrContext;
use super::interop_target::BhrTarget;
use super::pointer::unknown;
use super::status::BhrStatus;
use crate::error::Result;
use crate::renderer::Renderer;

/// bhr_set_sky_map with a picture on the GPU: target is an equirectangular one of RGBA16F or RGBA32F, made, imported or
/// wrapped, as wide as high at least, of 16384 x 8192 texels at most, laid out as bhr_set_sky_map has it, that frames
/// with BHR_SKY_MAP read anew each time. bhr makes coarser levels on the GPU: pictures are those with the map from host
/// memory, within one step of 255. NULL: none; each of the functions replaces what another has set. When a frame reads
/// the target, in which layout and of which queue family, and how long it must stay, is as with
/// bhr_set_occluder_target, but that a frame which is queued, and not submitted yet, fails as well when the target is
/// destroyed, where one with an occluder's still reads it. It cannot be a frame's target as well. Windows show it, too.
/// Memory on the device: 11 bytes a texel; for an image or host memory, which are copied before they are read, 8 more
/// of RGBA16F, 16 of RGBA32F. A buffer may have any row_stride. Any thread, not inside callbacks. Errors:
/// INVALID_ARGUMENT for a NULL context, another format or shape, or a target of another context; UNSUPPORTED for an
/// image without TRANSFER_SRC usage, and for a map that is larger than the device's textures (it takes one and a half
/// times its rows); SURFACE_LOST; DEVICE_LOST; the map then stays as it was. Since 0.2.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_target(context: *mut BhrContext, target: *mut BhrTarget) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { on_context("bhr_set_sky_target", context, |state| set(&mut state.renderer, target, false)) }
}

/// bhr_set_sky_target of a picture in another layout: EQUIRECT is bhr_set_sky_target, CUBE six faces side by side, 6
/// times as wide as high, as a picture with BHR_PROJECTION_CUBE of a camera that looks along +x of the sky axes (right
/// ascension 0) with +z (the north pole) up: the faces' middles are -y, +y, +z, -z, +x, -x; up is +z, on the third face
/// -x, on the fourth +x. Frames make an equirectangular map of it, four faces wide and two high, with four places in
/// each texel, between texels of the cube and across its edges; detail finer than at the faces' middles is lost. At
/// most 2730 texels a side. Errors: those of bhr_set_sky_target; INVALID_ARGUMENT for another layout or shape;
/// UNSUPPORTED for rows so far apart that a kernel's six bindings, of 128 MiB at least, do not hold them. Since 0.2.0.
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
            set(&mut state.renderer, target, cube)
        })
    }
}

/// # Safety
/// `target` is NULL or alive.
unsafe fn set(renderer: &mut Renderer, target: *const BhrTarget, cube: bool) -> Result<()> {
    // SAFETY: this function's contract.
    match unsafe { target.as_ref() } {
        Some(target) => renderer.set_sky_target(&target.target, cube),
        None => {
            (renderer.scene.sky_map, renderer.scene.sky_picture) = (None, None);
            Ok(())
        }
    }
}
