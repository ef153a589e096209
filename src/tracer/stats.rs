// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers about finished frames, and where those about the last one are kept.

use parking_lot::Mutex;
use std::sync::Arc;
use std::time::Duration;

/// Entries of `FrameStats::pass_ns`.
pub const PASSES: usize = 3;

/// Numbers about the last finished frame. Times in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// 1 for the first frame of a renderer; 0: none finished yet.
    pub frame_index: u64,
    pub rays: u64,
    pub steps: u64,
    pub cpu_ns: u64,
    /// 0: the adapter has no timestamps.
    pub gpu_ns: u64,
    /// The parts of `gpu_ns`: tracing and shading, without bloom with development; bloom; development.
    pub pass_ns: [u64; PASSES],
    pub readback_ns: u64,
    /// Device memory held by this renderer.
    pub device_bytes: u64,
    /// Lens tables made for the frame.
    pub lens_tables: u64,
    /// Stops that auto exposure added; 0 without it.
    pub auto_ev: f64,
}

impl FrameStats {
    /// Adds the numbers about a part of the same frame.
    pub fn add(&mut self, part: &Self) {
        self.rays += part.rays;
        self.steps += part.steps;
        self.gpu_ns += part.gpu_ns;
        self.pass_ns.iter_mut().zip(part.pass_ns).for_each(|(sum, part)| *sum += part);
        self.readback_ns += part.readback_ns;
        self.device_bytes = self.device_bytes.max(part.device_bytes);
        self.lens_tables += part.lens_tables;
        if part.auto_ev != 0.0 {
            self.auto_ev = part.auto_ev;
        }
    }
}

/// The numbers about a renderer's last finished frame, whoever made it.
#[derive(Clone, Default)]
pub struct StatsBoard(Arc<Mutex<FrameStats>>);

impl StatsBoard {
    /// Numbers the frame, which is finished and took this long.
    pub fn publish(&self, mut stats: FrameStats, took: Duration) -> FrameStats {
        let mut last = self.0.lock();
        stats.frame_index = last.frame_index + 1;
        stats.cpu_ns = took.as_nanos() as u64;
        *last = stats;
        stats
    }

    /// The last finished frame's.
    pub fn last(&self) -> FrameStats {
        *self.0.lock()
    }
}
