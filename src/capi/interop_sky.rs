// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's surroundings as the sky's map, from a target.

use super::call::on_context;
use super::context::BhrContext;
use super::interop_target::BhrTarget;
use super::status::BhrStatus;

/// bhr_set_sky_map with a picture on the GPU: target is an equirectangular one of RGBA16F or RGBA32F, made, imported or
/// wrapped, as wide as high at least, of 256 MiB at most (8192 x 4096 of RGBA16F), laid out as bhr_set_sky_map has
/// it, that frames with BHR_SKY_MAP read anew each time, without a way through host memory. bhr makes its coarser
/// levels on the GPU, and pictures are those with the same map from host memory to within rounding, one step of 255.
/// NULL: none; each of the two functions replaces what the other has set. A cube is no such target; its faces go into
/// an equirect by a pass of the host's.
///
/// When a frame reads the target, in which layout and of which queue family, and how long it must stay, is as with
/// bhr_set_occluder_target, but that a frame which is queued, and not submitted yet, fails as well when the target is
/// destroyed, where one with an occluder's still reads it. It cannot be a frame's target as well. The map is shown in
/// windows, too, and its pixels are taken as bhr_set_sky_map takes numbers. Memory on the device: 19 bytes a texel of
/// RGBA16F, 27 of RGBA32F. Any thread, not inside callbacks. Errors: INVALID_ARGUMENT for a NULL context, another
/// format or shape, or a target of another context; UNSUPPORTED for an image without TRANSFER_SRC usage, one that is
/// larger than the device's textures (a map takes one and a half times its rows), or one that its kernels do not reach
/// (4096 x 2048 of RGBA32F they do anywhere); SURFACE_LOST; DEVICE_LOST; the map then stays as it was. (Backends that
/// share nothing have no targets.) Since 0.2.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_sky_target(context: *mut BhrContext, target: *mut BhrTarget) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_sky_target", context, |state| match target.as_ref() {
            Some(target) => state.renderer.set_sky_target(&target.target),
            None => {
                let scene = &mut state.renderer.scene;
                (scene.sky_map, scene.sky_picture) = (None, None);
                Ok(())
            }
        })
    }
}
