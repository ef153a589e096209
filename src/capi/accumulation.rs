// SPDX-License-Identifier: MIT OR Apache-2.0
//! Accumulated frames: the mean of the light of several, for motion blur and depth of field.

use super::call::on_context;
use super::context::BhrContext;
use super::image::{self, BHR_IMAGE_TRANSPARENT, BhrImage};
use super::progress::Report;
use super::status::BhrStatus;
use crate::error::Error;

/// Begins to add the light of frames up: for motion blur (the host moves time, camera and bodies between them), depth
/// of field (the camera moves across a lens), or finer pixels. width and height in pixels, flags 0 or
/// BHR_IMAGE_TRANSPARENT, as the image will have it. Frames that were added before are forgotten. Takes 32 bytes a
/// pixel until bhr_end_accumulation, which takes some more; other calls render meanwhile as ever.
/// Errors: INVALID_ARGUMENT for a size that no image has, or an unknown flag; OUT_OF_MEMORY. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_begin_accumulation(
    context: *mut BhrContext,
    width: u32,
    height: u32,
    flags: u32,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_begin_accumulation", context, |state| {
            if flags & !BHR_IMAGE_TRANSPARENT != 0 {
                return Err(Error::argument(format!("flags is {flags:#x}; it must be 0 or BHR_IMAGE_TRANSPARENT (1)")));
            }
            state.renderer.begin_accumulation([width, height], flags & BHR_IMAGE_TRANSPARENT != 0)
        })
    }
}

/// Renders a whole frame of the scene as it is now, and adds its light times weight, 0.000001 .. 1000000: always 1 for
/// a shutter that opens and shuts at once. The view must be LIGHT; the film does not matter yet. Up to 65536 frames.
/// After an error nothing is added.
/// Errors: INVALID_STATE without bhr_begin_accumulation, with a region set, or after too many frames; INVALID_ARGUMENT
/// for a weight out of range or another view; those of bhr_render_image. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_accumulate(context: *mut BhrContext, weight: f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_accumulate", context, |state| {
            if state.region.is_some() {
                return Err(Error::state("a region is set, and accumulated frames are whole; set no region"));
            }
            let mut report = Report::new(state.progress);
            state.renderer.accumulate(weight, &mut |fraction| report.tell(fraction))
        })
    }
}

/// Develops the weighted mean of the frames that were added, by the film as it is now, into an image of the size and
/// the BHR_IMAGE_TRANSPARENT that they were begun with, on the processor; then forgets them. Auto exposure does not
/// adapt: the mean gets its own exposure. target NULL: forgets the frames, if there are any. After an error they are
/// kept. bhr_frame_stats then has the auto_ev and the cpu_ns of this call.
/// Errors: INVALID_STATE where no frame was added; INVALID_ARGUMENT for another size or transparency, or R32F;
/// OUT_OF_MEMORY. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_end_accumulation(context: *mut BhrContext, target: *const BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_end_accumulation", context, |state| {
            if target.is_null() {
                state.renderer.drop_accumulation();
                return Ok(());
            }
            let mut target = image::read(target, "target")?;
            state.renderer.end_accumulation(&mut target.pixels, target.transparent)
        })
    }
}
