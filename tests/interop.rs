// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames for targets on the GPU whose semaphores never come, and whose device is lost: the context that it happens to
//! is lost, no other, and it ends. Through the C API, with hooks that the header does not have. Needs a Vulkan adapter
//! (Mesa's software driver will do).
#![cfg(target_os = "linux")]

use bhr::capi::adapter::*;
use bhr::capi::context::*;
use bhr::capi::interop_render::*;
use bhr::capi::interop_semaphore::*;
use bhr::capi::interop_target::*;
use bhr::capi::job::*;
use bhr::capi::status::*;
use bhr::capi::version::*;
use std::ptr::{null, null_mut};
use std::time::{Duration, Instant};

/// A context with a target and a timeline. The calls on them are safe: all three live as long as this does.
struct Shared {
    context: *mut BhrContext,
    target: *mut BhrTarget,
    timeline: *mut BhrSemaphore,
}

impl Shared {
    fn new() -> Self {
        let (mut context, mut target, mut timeline) = (null_mut(), null_mut(), null_mut());
        // SAFETY: everything lives here.
        unsafe {
            let mut options = std::mem::zeroed::<BhrContextOptions>();
            assert_eq!(bhr_context_options_init(&mut options, size_of_val(&options)), BHR_OK);
            options.backend = BHR_BACKEND_VULKAN;
            assert_eq!(bhr_context_create(BHR_ABI_VERSION, &options, &mut context), BHR_OK);
            let mut shape = std::mem::zeroed::<BhrTargetOptions>();
            assert_eq!(bhr_target_options_init(&mut shape, size_of_val(&shape)), BHR_OK);
            shape.kind = BHR_TARGET_BUFFER;
            (shape.width, shape.height) = (64, 36);
            assert_eq!(bhr_target_create(context, &shape, &mut target), BHR_OK);
            let kind = BHR_SEMAPHORE_TIMELINE;
            assert_eq!(bhr_semaphore_create(context, kind, 0, &mut timeline), BHR_OK);
        }
        Self { context, target, timeline }
    }

    /// A frame that waits for one value, if that is not 0, and signals another.
    fn frame(&self, wait: u64, signal: u64, job: &mut *mut BhrJob) -> BhrStatus {
        let waits = BhrSemaphoreValue { semaphore: self.timeline, value: wait };
        let signals = BhrSemaphoreValue { semaphore: self.timeline, value: signal };
        let sync = BhrSync {
            struct_size: size_of::<BhrSync>() as u32,
            wait_count: u32::from(wait > 0),
            signal_count: 1,
            reserved: 0,
            waits: &waits,
            signals: &signals,
        };
        // SAFETY: see `Shared`.
        unsafe { bhr_render_target(self.context, self.target, &sync, job) }
    }

    fn works(&self, value: u64) {
        assert_eq!(self.frame(0, value, &mut null_mut()), BHR_OK);
        // SAFETY: see `Shared`.
        unsafe { assert_eq!(bhr_semaphore_wait(self.timeline, value, u64::MAX), BHR_OK) };
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // SAFETY: they are ended once; the context first, as its end is what may wait.
        unsafe {
            bhr_context_destroy(self.context);
            bhr_target_destroy(self.target);
            bhr_semaphore_destroy(self.timeline);
        }
    }
}

/// One test, because both change what holds for the process.
#[test]
fn what_never_comes_loses_its_own_context_only() {
    let other = Shared::new();
    other.works(1);

    // A device that is lost under a frame that waits.
    let lost = Shared::new();
    lost.works(1);
    let mut job = null_mut();
    // SAFETY: see `Shared`; the job lives until it is destroyed.
    unsafe {
        assert_eq!(lose_device(lost.context), BHR_OK);
        assert_eq!(lost.frame(0, 5, &mut job), BHR_ERROR_DEVICE_LOST);
        assert!(job.is_null());
        assert!(bhr_semaphore_wait(lost.timeline, 5, u64::MAX) < BHR_OK);
        assert_eq!(bhr_context_recover(lost.context), BHR_OK);
        assert_eq!(lost.frame(0, 6, &mut job), BHR_ERROR_SURFACE_LOST);
    }
    drop(lost);

    // A wait that nobody signals.
    hangs_after(Duration::from_secs(2));
    let stuck = Shared::new();
    stuck.works(1);
    let began = Instant::now();
    // SAFETY: see `Shared`; the job lives until it is destroyed.
    unsafe {
        assert_eq!(stuck.frame(10, 11, &mut job), BHR_OK);
        assert!(began.elapsed() < Duration::from_secs(2), "the call waited for {:?}", began.elapsed());
        other.works(2);
        assert_eq!(bhr_job_wait(job, u64::MAX, null_mut()), BHR_ERROR_DEVICE_LOST);
        bhr_job_destroy(job);
        assert_eq!(stuck.frame(0, 12, &mut null_mut()), BHR_ERROR_DEVICE_LOST);
        assert_eq!(bhr_semaphore_wait(stuck.timeline, 12, u64::MAX), BHR_ERROR_DEVICE_LOST);
        assert_eq!(bhr_semaphore_signal(stuck.timeline, 10), BHR_ERROR_DEVICE_LOST);
    }
    other.works(3);
    drop(stuck);
    assert!(began.elapsed() < Duration::from_secs(30), "it ended after {:?}", began.elapsed());

    // The same with a frame behind it, which some drivers would wait for in the call.
    let stuck = Shared::new();
    stuck.works(1);
    assert_eq!(stuck.frame(10, 11, &mut null_mut()), BHR_OK);
    let second = stuck.frame(0, 12, &mut null_mut());
    assert!([BHR_OK, BHR_ERROR_DEVICE_LOST].contains(&second), "{second}");
    drop(stuck);
    hangs_after(Duration::from_secs(60));
    other.works(4);
    // SAFETY: NULL is allowed.
    unsafe { assert_eq!(bhr_render_target(null_mut(), null_mut(), null(), null_mut()), BHR_ERROR_INVALID_ARGUMENT) };
}
