// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where a submission's staging buffer has what: ticks and pixels where queries and bindings may begin on every device;
//! between them the steps of the picture's rays and those of the outputs', and what auto exposure adds.

use crate::gpu::device::timer;
use crate::gpu::lens::records::STEP_SUM;
use crate::tracer::PASSES;

/// Compute passes of a submission at most: one of each kind, and the structure's and the outputs', which count as
/// shading.
pub const MOST_PASSES: usize = PASSES + 2;

pub const TICKS: u64 = 0;
pub const STEPS: [u64; 2] = [128, 128 + STEP_SUM];
/// The stops that auto exposure adds, an f32.
pub const AUTO_STOPS: u64 = STEPS[1] + STEP_SUM;
pub const STOPS_BYTES: u64 = size_of::<f32>() as u64;
pub const NUMBERS_END: u64 = AUTO_STOPS + STOPS_BYTES;
pub const PIXELS: u64 = 256;
const _: () = assert!(TICKS + MOST_PASSES as u64 * timer::PASS_BYTES <= STEPS[0] && NUMBERS_END <= PIXELS);
