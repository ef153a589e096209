// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rendering into targets, with the semaphores that a frame waits for and signals.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::interop_semaphore::BhrSemaphore;
use super::interop_target::BhrTarget;
use super::job::{self, BhrJob};
use super::output::{BhrOutput, read_shared};
use super::pointer::{Out, check_reserved, is_null};
use super::status::BhrStatus;
use super::versioned::{self, POINTER, Versioned};
use crate::error::{Error, Result};
use crate::interop::Semaphore;
use crate::job::Job;
use crate::renderer::{HostSync, Renderer, Submits};
use crate::scene::Region;
use std::ptr::null;

/// A semaphore and a value of it. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrSemaphoreValue {
    /// One of the context that renders.
    pub semaphore: *mut BhrSemaphore,
    /// TIMELINE: the value to wait for, or to signal. BINARY: ignored.
    pub value: u64,
}

/// The semaphores that a frame waits for before it reads the targets of occluder and sky and writes its own, and
/// those that it signals when it has done both. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrSync {
    /// sizeof(BhrSync).
    pub struct_size: u32,
    /// Entries of waits, 0 .. 8.
    pub wait_count: u32,
    /// Entries of signals, 0 .. 8.
    pub signal_count: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// All of them are waited for; NULL where wait_count is 0.
    pub waits: *const BhrSemaphoreValue,
    /// All of them are signalled; NULL where signal_count is 0.
    pub signals: *const BhrSemaphoreValue,
}

// SAFETY: repr(C), size first, no padding, integers and nullable pointers.
unsafe impl Versioned for BhrSync {
    const NAME: &'static str = "BhrSync";
    const SIZES: &'static [usize] = &[16 + 2 * POINTER];
    fn defaults() -> Self {
        Self { struct_size: 0, wait_count: 0, signal_count: 0, reserved: 0, waits: null(), signals: null() }
    }
}

const MOST_SEMAPHORES: u32 = 8;

/// A list of the host's.
///
/// # Safety
/// `list` is NULL or has `count` entries, whose semaphores are NULL or alive during `'a`.
unsafe fn read_uses<'a>(list: *const BhrSemaphoreValue, count: u32, name: &str) -> Result<Vec<(&'a Semaphore, u64)>> {
    if count > MOST_SEMAPHORES {
        return Err(Error::argument(format!("sync {name}_count is {count}; it must lie in [0, {MOST_SEMAPHORES}]")));
    }
    if count > 0 && list.is_null() {
        return Err(Error::argument(format!("sync {name}s is NULL and {name}_count {count}")));
    }
    (0..count as usize)
        .map(|i| {
            // SAFETY: this function's contract.
            let one = unsafe { list.add(i).read_unaligned() };
            // SAFETY: as above.
            let semaphore = unsafe { one.semaphore.as_ref() };
            let semaphore = semaphore.ok_or_else(|| is_null(&format!("sync {name}s[{i}] semaphore")))?;
            Ok((&*semaphore.semaphore, one.value))
        })
        .collect()
}

/// Renders with the semaphores of `sync`, and makes the job.
///
/// # Safety
/// All pointers are NULL or valid.
unsafe fn render(
    function: &str,
    context: *mut BhrContext,
    sync: *const BhrSync,
    out_job: *mut *mut BhrJob,
    body: impl FnOnce(&mut Renderer, Option<Region>, &HostSync<'_>) -> Result<Job>,
) -> BhrStatus {
    // SAFETY: this function's contract.
    unsafe {
        let out = Out::cleared(out_job);
        on_context(function, context, |state| {
            let given = if sync.is_null() { BhrSync::defaults() } else { versioned::read(sync, "sync")? };
            check_reserved(given.reserved, "sync")?;
            let waits = read_uses(given.waits, given.wait_count, "wait")?;
            let signals = read_uses(given.signals, given.signal_count, "signal")?;
            let sync = HostSync { waits: &waits, signals: &signals };
            let job = body(&mut state.renderer, state.region, &sync)?;
            if out_job.is_null() {
                return Ok(());
            }
            let context = context.as_ref().ok_or_else(|| is_null("context"))?;
            out.set(Box::into_raw(Box::new(job::of_target(job, context, state.progress))));
            Ok(())
        })
    }
}

/// # Safety
/// All pointers are NULL or valid.
unsafe fn render_target(
    function: &str,
    context: *mut BhrContext,
    target: *mut BhrTarget,
    sync: *const BhrSync,
    out_job: *mut *mut BhrJob,
    submits: Submits,
) -> BhrStatus {
    // SAFETY: this function's contract.
    unsafe {
        render(function, context, sync, out_job, |renderer, region, sync| {
            let target = target.as_ref().ok_or_else(|| is_null("target"))?;
            renderer.render_target(&target.target, region, sync, submits)
        })
    }
}

/// Sets struct_size and clears the rest: nothing is waited for or signalled. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_sync_init(sync: *mut BhrSync, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_sync_init", || unsafe { versioned::init(sync, "sync", struct_size) })
}

/// Renders the scene as it is now into a target, and returns when the frame is submitted (docs/gpu.md). sync NULL:
/// no semaphores; then the host waits with the job. out_job NULL: no job; else the job ends when the GPU has made
/// the frame, with bhr_job_wait and bhr_job_stats as of images. bhr_job_cancel does not stop what is submitted, and
/// bhr_job_destroy neither cancels it nor waits for it. At most 64 frames and jobs may be unfinished. The region
/// counts. After an error no semaphore is waited for or signalled, unless steps were submitted: then all are.
/// Errors: those of bhr_render_image; INVALID_ARGUMENT for a target or semaphore of another context, a semaphore
/// that is twice in a list, and a signal whose value does not grow; INVALID_STATE for too many frames; UNSUPPORTED
/// for rows that kernels do not reach, and where BhrCamera.eye has effect; SURFACE_LOST. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_target(
    context: *mut BhrContext,
    target: *mut BhrTarget,
    sync: *const BhrSync,
    out_job: *mut *mut BhrJob,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { render_target("bhr_render_target", context, target, sync, out_job, Submits::Now) }
}

/// bhr_render_target as a job of bhr's threads, in their order, as bhr_render_image_async: the scene, the region and
/// the semaphores are taken as they are now, and the call returns at once. Only TIMELINE semaphores: a BINARY one is
/// INVALID_ARGUMENT. bhr_job_cancel stops what is not submitted, and bhr_job_destroy neither cancels nor waits.
/// Whatever becomes of the frame, its semaphores are waited for and signalled when its turn comes, unless the device
/// is lost. A host on whose own queue bhr works must not submit to that queue what waits for a frame before the
/// frame is submitted (docs/gpu.md). out_job NULL: no job.
/// Errors: those of bhr_render_target, some of which come from bhr_job_wait instead. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_target_async(
    context: *mut BhrContext,
    target: *mut BhrTarget,
    sync: *const BhrSync,
    out_job: *mut *mut BhrJob,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { render_target("bhr_render_target_async", context, target, sync, out_job, Submits::InBackground) }
}

/// Renders outputs of the scene as it is now (BhrOutput of bhr.h), each into its BhrOutput.target or its
/// BhrOutput.image, in one frame and with one set of semaphores. Otherwise as bhr_render_target; the bytes are those
/// of bhr_render_outputs. LIGHT, at most one, goes into any target that bhr_render_target takes, the others into
/// R32F or RGBA32F by their kind: a BUFFER, or an IMAGE with STORAGE usage. All places are of one size. Outputs with
/// an image need out_job, and are complete when bhr_job_wait says OK (docs/gpu.md).
/// Errors: those of bhr_render_target and of bhr_render_outputs; INVALID_ARGUMENT for an output without a place, or
/// with two, a target that is there twice, and views but REDSHIFT, ORDER and DEFLECTION (render them as LIGHT);
/// UNSUPPORTED for an output other than LIGHT in an image that a copy fills, and for more targets than a kernel of
/// the device binds. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_outputs_shared(
    context: *mut BhrContext,
    outputs: *const BhrOutput,
    output_size: usize,
    count: u32,
    sync: *const BhrSync,
    out_job: *mut *mut BhrJob,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        render("bhr_render_outputs_shared", context, sync, out_job, |renderer, region, sync| {
            let outputs = read_shared(outputs, output_size, count, !out_job.is_null())?;
            renderer.render_shared_outputs(outputs, region, sync, Submits::Now)
        })
    }
}

/// bhr_render_outputs_shared as a job of bhr's threads, with TIMELINE semaphores only, as bhr_render_target_async.
/// Errors: those of both. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_outputs_shared_async(
    context: *mut BhrContext,
    outputs: *const BhrOutput,
    output_size: usize,
    count: u32,
    sync: *const BhrSync,
    out_job: *mut *mut BhrJob,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        render("bhr_render_outputs_shared_async", context, sync, out_job, |renderer, region, sync| {
            let outputs = read_shared(outputs, output_size, count, !out_job.is_null())?;
            renderer.render_shared_outputs(outputs, region, sync, Submits::InBackground)
        })
    }
}
