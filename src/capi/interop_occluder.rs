// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's own things before the camera, from a target.

use super::call::on_context;
use super::context::BhrContext;
use super::image::BHR_IMAGE_LENSED;
use super::interop_target::BhrTarget;
use super::status::BhrStatus;
use crate::error::Error;

/// bhr_set_occluder with distances on the GPU: target is one of R32F, made, imported or wrapped, that holds them as
/// bhr_set_occluder describes it, and that frames of LIGHT read anew each time, without a way through host memory.
/// NULL: none; each of the two functions replaces what the other has set. flags: 0, or BHR_IMAGE_LENSED for things at
/// their lensed places.
///
/// A frame reads the target first of all, after every wait of its BhrSync, and has read it when its signals are given:
/// it needs no semaphores of its own. Frames without a BhrSync (bhr_render_image and others for host memory) and
/// bhr_prepare read what is there when they begin, so that the host first waits until it has drawn. An image is then in
/// the target's layout (BhrTargetOptions.layout), and is left in it; what other devices have written into a target for
/// OPAQUE_FD is released to VK_QUEUE_FAMILY_EXTERNAL before, images with that layout, and acquired again after, if what
/// it holds is to be kept. A plain depth buffer is no such distance: the host's shader divides its forward distance by
/// the cosine of the angle to the forward axis.
///
/// Numbers on the GPU cannot be checked: NaN hides nothing, and what is below 0 everything. The target must stay as
/// long as it is set: after bhr_target_destroy or bhr_context_recover frames are SURFACE_LOST, until another occluder
/// or NULL is set. It cannot be a frame's target as well. It has the size of the frames' images; a frame of another
/// size is INVALID_ARGUMENT. A buffer may have any row_stride. Otherwise as bhr_set_occluder. Any thread, not inside
/// callbacks. Errors: INVALID_ARGUMENT for a NULL context, another format, other flags, or a target of another context;
/// UNSUPPORTED for a side that is longer than the device's textures have (16384, or less), and for an image without
/// TRANSFER_SRC usage; SURFACE_LOST; DEVICE_LOST; the occluder then stays as it was. Since 0.2.0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_occluder_target(
    context: *mut BhrContext,
    target: *mut BhrTarget,
    flags: u32,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_occluder_target", context, |state| match target.as_ref() {
            _ if flags & !BHR_IMAGE_LENSED != 0 => {
                Err(Error::argument(format!("flags {flags:#x}: BHR_IMAGE_LENSED alone is known here")))
            }
            Some(target) => state.renderer.set_occluder_target(&target.target, flags & BHR_IMAGE_LENSED != 0),
            None => {
                state.renderer.set_occluder(None);
                Ok(())
            }
        })
    }
}
