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
use bhr::capi::quality::*;
use bhr::capi::status::*;
use bhr::capi::version::*;
use std::ffi::CStr;
use std::ptr::{null, null_mut};
use std::sync::{Mutex, MutexGuard, PoisonError};
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

    /// Samples of a pixel: on software drivers each is a submission of its own.
    fn set_samples(&self, samples: u32) {
        // SAFETY: see `Shared`.
        unsafe {
            let mut quality = std::mem::zeroed::<BhrQuality>();
            assert_eq!(bhr_quality_init(&mut quality, size_of_val(&quality)), BHR_OK);
            quality.samples_per_pixel = samples;
            assert_eq!(bhr_set_quality(self.context, &quality), BHR_OK);
        }
    }

    /// A call of the device's is to fail, once `passing` of its kind have not.
    fn fail(&self, what: &'static str, passing: u32) {
        // SAFETY: see `Shared`.
        assert_eq!(unsafe { fail_device(self.context, what, passing) }, BHR_OK);
    }

    /// Whether the timeline has a value, or has it within a time.
    fn reaches(&self, value: u64, seconds: u64) -> bool {
        // SAFETY: see `Shared`.
        unsafe { bhr_semaphore_wait(self.timeline, value, seconds * 1_000_000_000) == BHR_OK }
    }

    fn works(&self, value: u64) {
        assert_eq!(self.frame(0, value, &mut null_mut()), BHR_OK, "{value}: {}", message());
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

/// The time of a hang holds for the process: tests take turns.
fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

#[test]
fn what_never_comes_loses_its_own_context_only() {
    let _turn = turn();
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

    // Once more, with a frame behind it, which some drivers would wait for in the call.
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

fn message() -> String {
    // SAFETY: the message is of this thread, and is copied before its next call.
    unsafe { CStr::from_ptr(bhr_error_message()) }.to_string_lossy().into_owned()
}

#[test]
fn a_frame_of_which_nothing_was_submitted_leaves_its_signal_to_be_asked_for_again() {
    let _turn = turn();
    let shared = Shared::new();
    shared.works(1);
    let mut job = null_mut();
    for what in ["recording work", "submitting work", "frame"] {
        shared.fail(what, 0);
        assert_eq!(shared.frame(0, 2, &mut job), BHR_ERROR_OUT_OF_MEMORY, "{what}");
        assert!(job.is_null() && message().contains("as a test asked"), "{what}: {}", message());
        assert!(!shared.reaches(2, 0), "{what}: the signal of a frame that was refused was given");
    }
    // The values of other frames still count.
    assert_eq!(shared.frame(0, 1, &mut job), BHR_ERROR_INVALID_ARGUMENT);
    shared.works(2);
}

#[test]
fn a_frame_that_fails_after_its_first_submission_gives_its_signals() {
    let _turn = turn();
    let shared = Shared::new();
    shared.works(1);
    shared.set_samples(5);
    // Only the fifth sample's submission writes the target.
    for (passing, value) in [(1, 2), (3, 3), (4, 4)] {
        shared.fail("submitting work", passing);
        assert_eq!(shared.frame(0, value, &mut null_mut()), BHR_ERROR_OUT_OF_MEMORY, "{passing}: {}", message());
        assert!(shared.reaches(value, 60), "{passing}: no signal came");
    }
    shared.works(5);
    // All was submitted, with the signals, before what is left fails.
    shared.fail("mapping a buffer", 4);
    assert_eq!(shared.frame(0, 6, &mut null_mut()), BHR_ERROR_OUT_OF_MEMORY, "{}", message());
    assert!(shared.reaches(6, 60), "no signal came");
    shared.works(7);
}

#[test]
fn a_step_that_fails_while_others_are_submitted_says_why() {
    let _turn = turn();
    let shared = Shared::new();
    shared.works(1);
    // More submissions than may be unfinished, so that the call outlives the first.
    shared.set_samples(64);
    shared.fail("waiting for work", 0);
    let mut job = null_mut();
    assert_eq!(shared.frame(0, 2, &mut job), BHR_ERROR_OUT_OF_MEMORY, "{}", message());
    assert!(job.is_null() && message().contains("as a test asked"), "{}", message());
    assert!(shared.reaches(2, 60), "no signal came");
    shared.set_samples(1);
    shared.works(3);
}
