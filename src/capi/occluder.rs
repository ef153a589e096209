// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's own things before the camera.

use super::call::on_context;
use super::context::BhrContext;
use super::image::{self, BhrImage};
use super::status::BhrStatus;
use crate::scene::Occluder;

/// Sets the host's things before the camera, for images of LIGHT that they are seen in: an image of R32F, as large
/// as those images, with each pixel's distance to the host's thing along its line of sight, in scene lengths (not
/// along the forward axis, as depth buffers have it), and infinity where there is nothing. NULL (default): none.
/// docs/compositing.md says what things hide.
///
/// With BHR_IMAGE_LENSED the things are drawn at their lensed places, and each distance is
/// BhrProjectedPoint.distance at order 0; 1e15 M or more is nothing.
///
/// With a region the distances are that region's. Windows, views and other outputs do not regard it. While it is
/// set, rendering images of another size is INVALID_ARGUMENT, and on GPUs UNSUPPORTED for sides beyond a texture's
/// (16384, or less).
/// Errors: INVALID_ARGUMENT for another format, NaN, or a distance below 0; the occluder then stays as it was.
/// @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_occluder(context: *mut BhrContext, distances: *const BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_occluder", context, |state| {
            state.renderer.set_occluder(match distances.is_null() {
                true => None,
                false => {
                    let given = image::read_with(distances, "distances", image::BHR_IMAGE_LENSED)?;
                    Some(Occluder { lensed: given.lensed, ..Occluder::new(&given.pixels.as_image_ref())? })
                }
            });
            Ok(())
        })
    }
}
