// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's own things before the camera.

use super::call::on_context;
use super::context::BhrContext;
use super::image::{self, BhrImage};
use super::status::BhrStatus;
use crate::scene::Occluder;

/// Sets the host's things before the camera, for images of LIGHT that they are seen in: an image of R32F, as large as
/// those images, that holds for each pixel the distance to the host's thing along its line of sight, in scene lengths
/// (not along the forward axis, as depth buffers have it), and infinity where there is nothing. It is copied before
/// return. NULL (default): none.
///
/// Crossings of the disk of order 0 that lie beyond the distance, as straight as BHR_OUTPUT_DEPTH measures it, are
/// left out. Where it is shorter than the way to the point of the line of sight that is nearest to the hole, the
/// ray ends there: higher orders, the hole and the sky are left out as well, and BHR_IMAGE_TRANSPARENT's alpha is
/// that of what lies before. So the picture goes over the host's, premultiplied. A thing behind the hole is hidden
/// by what bends its light; it belongs into the sky (BHR_OUTPUT_SKY). Lines of sight are straight here, and light
/// is not: things are where light shows them to about M / r of their angle from the hole.
///
/// With BHR_IMAGE_LENSED the host has drawn its things at their lensed places, by bhr_project_points at order 0, and
/// each distance is BhrProjectedPoint.distance, from the camera straight to the thing itself. Then the ray ends at the
/// thing wherever it is, behind the hole as well: beyond it nothing is left, of orders above 0 nothing at all, because
/// their crossings lie beyond the direct images of all things. A distance of 1e15 M or more is nothing, as infinity is.
///
/// Matter with depth, volumes and hot spots, counts up to where the ray's straight distance from the camera is that of
/// the thing, and where the ray does not end there also where it has come nearer again; each ray is summed by itself
/// then, whatever BhrQuality.volume_resolution says.
///
/// Glare (BhrFilm.bloom) goes over things, too. Images of a region take distances for that region. Frames in windows,
/// views and the other outputs do not regard it. While it is set, images of another size are INVALID_ARGUMENT when
/// they are rendered; UNSUPPORTED are, on GPUs, sides of more than a texture may have: 16384, or less if the adapter
/// has less. Errors: INVALID_ARGUMENT for a bad image, another format, NaN, or a distance below 0; OUT_OF_MEMORY; the
/// occluder then stays as it was. Since 0.2.0.
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
