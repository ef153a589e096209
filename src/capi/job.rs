// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrJob: frames in the background. One `Job` with what its waits need of the context, which may be gone by then.

use super::call::{break_if_internal, keep, on_context};
use super::context::BhrContext;
use super::entry::{self, SuccessStatus, destroy, finish, outside_callbacks_always};
use super::gate::Gate;
use super::image::{self, BhrImage};
use super::log::{self, Sink};
use super::message::{LastMessage, copy_last};
use super::panic::guarded_always;
use super::pointer::{Out, is_null};
use super::progress::{Callback, Report};
use super::state::State;
use super::status::{BHR_NOT_READY, BHR_OK, BhrStatus};
use crate::error::Result;
use crate::gpu::process_end;
use crate::job::Job;
use crate::thread_state::Call;
use crate::tracer::Backend;
use std::ffi::c_char;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A frame that is rendered in the background. End it with bhr_job_destroy, before or after its context.
pub struct BhrJob {
    pub(super) job: Job,
    progress: Option<Callback>,
    /// Closed when the context ends.
    progress_gate: Arc<Gate>,
    /// The log callback of the context.
    sink: Option<Arc<Sink>>,
    /// The message of the last call that failed on this job.
    message: LastMessage,
    /// The context's.
    broken: Arc<AtomicBool>,
    /// Whether its frame is for the host's memory only, so that the job's end cancels it and waits for it.
    writes_memory: bool,
    /// Whether a driver renders it.
    uses_driver: bool,
}

/// The job of a frame for a target on the GPU.
pub(super) fn of_target(job: Job, context: &BhrContext, progress: Option<Callback>) -> BhrJob {
    BhrJob {
        job,
        progress,
        progress_gate: context.progress_gate.clone(),
        sink: context.sink(),
        message: LastMessage::new(),
        broken: context.broken.clone(),
        writes_memory: false,
        uses_driver: true,
    }
}

impl BhrJob {
    /// Calls the progress callback, unless the context is gone; false means that the job is to be cancelled.
    fn tell(&self, report: &mut Report, fraction: f64) -> bool {
        self.progress_gate.enter().is_none_or(|_open| report.tell(fraction))
    }

    fn wait(&self, timeout_ns: u64, out: &Out<f64>) -> Result<SuccessStatus> {
        let timeout = (timeout_ns != u64::MAX).then(|| Duration::from_nanos(timeout_ns));
        let mut report = Report::new(self.progress);
        let outcome = self.job.wait(timeout, &mut |fraction| self.tell(&mut report, fraction));
        match outcome {
            None => {
                out.set(self.job.fraction());
                Ok(SuccessStatus(BHR_NOT_READY))
            }
            Some(Ok(_)) => {
                self.tell(&mut report, 1.0);
                out.set(1.0);
                Ok(SuccessStatus(BHR_OK))
            }
            Some(Err(error)) => Err(error),
        }
    }
}

/// A call on a job: refused inside callbacks, with its context's log callback listening.
///
/// # Safety
/// `job` is NULL or came from `bhr_render_image_async` and is not destroyed.
pub(super) unsafe fn on_job<T: entry::Success>(
    function: &str,
    job: *const BhrJob,
    body: impl FnOnce(&BhrJob) -> Result<T>,
) -> BhrStatus {
    // SAFETY: this function's contract.
    let Some(job) = (unsafe { job.as_ref() }) else {
        return outside_callbacks_always::<()>(function, || Err(is_null("job")));
    };
    let _scope = log::Scope::enter(job.sink.clone());
    let status = outside_callbacks_always(function, || {
        let result = body(job);
        break_if_internal(&result, &job.broken);
        result
    });
    keep(status, Some(&job.message))
}

/// A job that writes into the host's memory, for the host to destroy.
pub(super) fn new_job(context: &BhrContext, job: Job, state: &State) -> *mut BhrJob {
    let uses_driver = state.renderer.adapter().backend != Backend::Cpu;
    Box::into_raw(Box::new(BhrJob { writes_memory: true, uses_driver, ..of_target(job, context, state.progress) }))
}

/// Begins a job, which renders an image in the background, and returns at once. The scene and the region are taken
/// as they are now; later setters neither change the job nor wait for it. Jobs of a context are made in their order;
/// other calls that render wait for the job that is being traced. At most 64 jobs of a context may be unfinished.
/// target itself is copied; target->pixels is written until the job is done or destroyed, and must stay valid, and
/// be used by nobody else, so long. End *out_job with bhr_job_destroy. docs/jobs.md.
/// Errors: those of bhr_render_image, some of which come from bhr_job_wait instead; INVALID_STATE for too many jobs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_image_async(
    context: *mut BhrContext,
    target: *const BhrImage,
    out_job: *mut *mut BhrJob,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions; the target's block is the host's until the job is done.
    unsafe {
        let out = Out::cleared(out_job);
        on_context("bhr_render_image_async", context, |state| {
            out.required("out_job")?;
            let target = image::read(target, "target")?;
            let job = state.renderer.render_in_background(target.pixels, target.transparent, state.region)?;
            // `on_context` has refused NULL.
            let context = context.as_ref().ok_or_else(|| is_null("context"))?;
            out.set(new_job(context, job, state));
            Ok(())
        })
    }
}

/// Waits until the job is done, at most timeout_ns nanoseconds: 0 polls, UINT64_MAX waits without limit. NOT_READY:
/// it is still running. OK: the image is complete. *out_fraction, unless NULL, becomes the part that is done, 0 ..
/// 1, by tiles, of which a small frame is one (docs/jobs.md), and 0 after a failure. Meanwhile the progress callback
/// that the context had when the job was begun is called, on this thread.
/// Errors: the job's failure, with its message, each time, which says so if pixels were written: CANCELLED after
/// bhr_job_cancel or by the progress callback, others as bhr_render_image.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_wait(job: *mut BhrJob, timeout_ns: u64, out_fraction: *mut f64) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_fraction);
        on_job("bhr_job_wait", job, |job| job.wait(timeout_ns, &out))
    }
}

/// Copies the message of the last call that failed on this job, whichever thread it was on, into buffer, as
/// bhr_context_error_message does: after a bhr_job_wait that told of a failure, why the job failed. Returns its
/// length, 0 for NULL. It waits for no other call. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_error_message(job: *const BhrJob, buffer: *mut c_char, size: usize) -> usize {
    // SAFETY: NULL or alive, and size writable bytes, by the header's conventions.
    unsafe { copy_last(job.as_ref().map(|job| &job.message), buffer, size) }
}

/// Asks a job to stop, and does not wait: bhr_job_wait then returns CANCELLED, or OK when the job was done before.
/// NULL is a no-op. Allowed inside callbacks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_cancel(job: *mut BhrJob) {
    // SAFETY: NULL or alive, by the header's conventions.
    if let Some(job) = unsafe { job.as_ref() } {
        cancel("bhr_job_cancel", job);
    }
}

/// A job that is cancelled before its turn may be the last one that holds a tracer: that of a device which was
/// lost.
fn cancel(function: &str, job: &BhrJob) {
    if process_end::is_over() {
        return;
    }
    let _call = Call::enter();
    if job.uses_driver && process_end::is_here() {
        return;
    }
    let cancelled = guarded_always(|| {
        job.job.cancel();
        Ok(())
    });
    finish(function, cancelled);
}

/// Cancels a job, waits until it has stopped (a fraction of a frame at most) and frees it; target->pixels is the
/// host's again. Frames for targets (bhr_render_target) go on, but write no image any more. NULL is a no-op. No
/// other thread may use the job any more. From inside a callback it does nothing: bhr_error_message then says so.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_destroy(job: *mut BhrJob) {
    const NAME: &str = "bhr_job_destroy";
    let end = |job: Box<BhrJob>| {
        if job.uses_driver && process_end::is_here() {
            // Its thread is held up, and writes nothing while the process ends within the time that `keep` states.
            return process_end::keep(job);
        }
        if !job.writes_memory {
            job.job.leave_images();
            return;
        }
        cancel(NAME, &job);
        // Nobody is left to hear of the job's own failure.
        let _ = job.job.wait(None, &mut |_| true);
    };
    // SAFETY: bhr_render_image_async made it with Box::into_raw, and the host destroys it once.
    unsafe { destroy(NAME, job, end) }
}
