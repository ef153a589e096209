// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's own things before the camera, from a target.

use super::call::on_context;
use super::context::BhrContext;
use super::image::BHR_IMAGE_LENSED;
use super::interop_target::BhrTarget;
use super::status::BhrStatus;
use crate::error::Error;

/// bhr_set_occluder with distances on the GPU: target is one of R32F, made, imported or wrapped, of the frames'
/// size, that frames of LIGHT read anew each time, after every wait of their BhrSync. NULL: none; each of the two
/// functions replaces what the other has set. flags: 0, or BHR_IMAGE_LENSED. A buffer may have any row_stride. The
/// target must stay as long as it is set, and cannot be a frame's target as well: after bhr_target_destroy or
/// bhr_context_recover frames are SURFACE_LOST, until another occluder or NULL is set. Numbers on the GPU cannot be
/// checked: NaN hides nothing, and what is below 0 everything. docs/gpu.md says in which layout it is read.
/// Errors: INVALID_ARGUMENT for another format, or a target of another context; UNSUPPORTED for sides beyond the
/// device's textures (16384, or less), and for an image without TRANSFER_SRC usage; SURFACE_LOST; the occluder then
/// stays as it was. @since 0.2.0
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
