//! BhrJob: rendering in the background. This version has none: arguments are checked, then the answer is UNSUPPORTED.

use super::context::BhrContext;
use super::entry::{on_context, outside_callbacks};
use super::image::{self, BhrImage};
use super::pointer::{Out, is_null};
use super::status::BhrStatus;
use crate::error::{Error, Result};

/// A frame that is being rendered in the background.
pub struct BhrJob {
    _none: (),
}

const NO_JOBS: &str = "this version has no jobs; bhr_render_image renders on the calling thread";

/// A call on a job. None exists, so past the argument checks there is one answer.
pub(super) fn on_job(function: &str, job: *const BhrJob, check: impl FnOnce() -> Result<()>) -> BhrStatus {
    outside_callbacks(function, || {
        if job.is_null() {
            return Err(is_null("job"));
        }
        check()?;
        Err(Error::unsupported(NO_JOBS))
    })
}

/// Begins to render an image and returns at once. The scene is taken as it is now. target->pixels is written until
/// the job is done or destroyed. Errors: INVALID_ARGUMENT as bhr_render_image; UNSUPPORTED otherwise in this
/// version.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_image_async(
    context: *mut BhrContext,
    target: *const BhrImage,
    out_job: *mut *mut BhrJob,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_job);
        on_context("bhr_render_image_async", context, |_state| {
            out.required("out_job")?;
            image::read(target, "target")?;
            Err(Error::unsupported(NO_JOBS))
        })
    }
}

/// Waits until the job is done, at most timeout_ns nanoseconds; 0 polls. *out_fraction, unless NULL, becomes the
/// part that is done, 0 .. 1. A job's failure is returned, with its message, here; NOT_READY while it runs. Errors:
/// INVALID_ARGUMENT for NULL; UNSUPPORTED otherwise in this version.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_wait(job: *mut BhrJob, timeout_ns: u64, out_fraction: *mut f64) -> BhrStatus {
    let _ = timeout_ns;
    // SAFETY: NULL or valid, by the header's conventions.
    let _out = unsafe { Out::cleared(out_fraction) };
    on_job("bhr_job_wait", job, || Ok(()))
}

/// Asks a job to stop. NULL is a no-op.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_cancel(job: *mut BhrJob) {
    let _ = job;
}

/// Cancels a job, waits for it and frees it: the target is the host's again. NULL is a no-op.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_destroy(job: *mut BhrJob) {
    let _ = job;
}
