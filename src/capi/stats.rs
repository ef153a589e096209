// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrFrameStats: numbers about the last finished frame.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::anywhere;
use super::job::{self, BhrJob};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::Error;
use crate::tracer::FrameStats;

/// Numbers about the last finished frame; all 0 before the first. Times in nanoseconds.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrFrameStats {
    /// sizeof(BhrFrameStats), set by the caller.
    pub struct_size: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// Counts the finished frames of a context from 1: images, jobs, windows, and each call that accumulates or ends.
    pub frame_index: u64,
    /// Pixels times samples.
    pub rays: u64,
    /// Integration steps of all rays; rays that were looked up take none.
    pub steps: u64,
    /// From the call's beginning to its end; for a job, from its request until it was done.
    pub cpu_ns: u64,
    /// Time on the GPU; 0 where the adapter has no timestamps, or traces on the CPU.
    pub gpu_ns: u64,
    /// Time to copy pixels into the host's memory, without the wait for the GPU.
    pub readback_ns: u64,
    /// Device memory that the context holds.
    pub device_bytes: u64,
    /// Lens tables made for this frame: 0 where those of an earlier one served, or none were needed. @since 0.2.0
    pub lens_tables: u64,
    /// Stops that auto exposure (BhrFilm.auto_exposure) added to the film's exposure_ev; 0 without it. @since 0.2.0
    pub auto_ev: f64,
}

// SAFETY: repr(C), size first, no padding, numbers only.
unsafe impl Versioned for BhrFrameStats {
    const NAME: &'static str = "BhrFrameStats";
    const SIZES: &'static [usize] = &[64, 80];
    fn defaults() -> Self {
        FrameStats::default().into()
    }
}

impl From<FrameStats> for BhrFrameStats {
    fn from(stats: FrameStats) -> Self {
        Self {
            struct_size: 0,
            reserved: 0,
            frame_index: stats.frame_index,
            rays: stats.rays,
            steps: stats.steps,
            cpu_ns: stats.cpu_ns,
            gpu_ns: stats.gpu_ns,
            readback_ns: stats.readback_ns,
            device_bytes: stats.device_bytes,
            lens_tables: stats.lens_tables,
            auto_ev: stats.auto_ev,
        }
    }
}

/// Sets struct_size, which calls that fill the struct read, and clears the rest. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_frame_stats_init(stats: *mut BhrFrameStats, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_frame_stats_init", || unsafe { versioned::init(stats, "stats", struct_size) })
}

/// Numbers about the context's last finished frame.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_frame_stats(context: *const BhrContext, stats: *mut BhrFrameStats) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let stats = OutStruct::cleared(stats, "stats");
        on_context("bhr_frame_stats", context, |state| stats.set(&state.renderer.stats().into()))
    }
}

/// Numbers about the frame of a job that is done.
/// Errors: INVALID_STATE for a job that is not done, or that failed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_job_stats(job: *const BhrJob, stats: *mut BhrFrameStats) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let stats = OutStruct::cleared(stats, "stats");
        job::on_job("bhr_job_stats", job, |job| match job.job.outcome() {
            Some(Ok(numbers)) => stats.set(&numbers.into()),
            Some(Err(_)) => Err(Error::state("the job failed; bhr_job_wait says why")),
            None => Err(Error::state("the job is not done; wait for it first")),
        })
    }
}
