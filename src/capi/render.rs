// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rendering into the host's memory, and the progress callback that goes with it.

use super::call::on_context;
use super::context::BhrContext;
use super::image::{self, BHR_IMAGE_TRANSPARENT, BhrImage};
use super::log::User;
use super::progress::{Callback, Report};
use super::status::BhrStatus;
use crate::error::{Error, ErrorKind};
use std::ffi::c_void;

/// Is told how much of a frame is done: fraction grows from 0 to 1. It returns 0 to cancel, anything else to go on;
/// at 1 the frame is complete and the answer is ignored. It runs inside a bhr_ call only, on the calling thread.
pub type BhrProgressFn = Option<unsafe extern "C" fn(user: *mut c_void, fraction: f64) -> i32>;

/// Sets the callback that bhr_render_image, bhr_accumulate and bhr_prepare report to, and, inside bhr_job_wait, the
/// jobs that are begun from now on. fn NULL: none (default).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_progress(
    context: *mut BhrContext,
    r#fn: BhrProgressFn,
    user: *mut c_void,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_progress", context, |state| {
            state.progress = r#fn.map(|function| Callback { function, user: User(user) });
            Ok(())
        })
    }
}

/// Renders the scene as it is now into the host's memory and returns when it is there. Until the first pixels are
/// written an error leaves the target alone; after that the message says so, and what is not yet rendered is
/// untouched.
/// Errors: INVALID_ARGUMENT also for a format that does not go with the view, or an image that reaches out of the
/// region's frame; INVALID_STATE where the camera's motion is not possible, for a CUBE whose frame is not 6 times
/// as wide as high, or for bloom, a beam, spikes, a streak, a flare, auto_exposure, highlights or shadows with a
/// region set; UNSUPPORTED inside a spinning hole's horizon in chart STATIC, and at r- (1 + 1e-6); CANCELLED by
/// the progress callback.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_image(context: *mut BhrContext, target: *const BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_render_image", context, |state| {
            let mut target = image::read(target, "target")?;
            let mut report = Report::new(state.progress);
            if !report.tell(0.0) {
                return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the frame at its begin"));
            }
            let frame = state
                .renderer
                .render(&mut target.pixels, target.transparent, state.region, &mut |fraction| report.tell(fraction));
            if frame.is_ok() {
                report.finish();
            }
            frame
        })
    }
}

/// The size of the windows that bhr_prepare prepares for when it has no target.
const WINDOW: [u32; 2] = [1920, 1080];

/// Makes everything that frames of the present scene need, so that the next frame is no slower than later ones: GPU
/// programs, tables and the sky. target is an image as bhr_render_image would be given it; its pixels and byte_size
/// are not looked at, and may be 0. For RGBA8_SRGB without BHR_IMAGE_TRANSPARENT, frames in windows of that size are
/// prepared too; NULL: only frames in windows of 1920 x 1080, whatever region is set. The progress callback may
/// cancel it. The call waits for a job that is being rendered, and bhr_frame_stats does not count it. docs/jobs.md
/// says what is made when.
/// Errors: those of bhr_render_image. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_prepare(context: *mut BhrContext, target: *const BhrImage) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_prepare", context, |state| {
            let mut report = Report::new(state.progress);
            let mut progress = |fraction| report.tell(fraction);
            if target.is_null() {
                return state.renderer.prepare_window(WINDOW, &mut progress);
            }
            let (layout, flags) = image::read_layout(target, "target")?;
            let (size, transparent) = ([layout.width, layout.height], flags & BHR_IMAGE_TRANSPARENT != 0);
            state.renderer.prepare(layout.format, size, transparent, state.region, &mut progress)
        })
    }
}
