// SPDX-License-Identifier: MIT OR Apache-2.0
//! The lens tables against integration: records of random observers, their footprints, and scan lines without a seam,
//! on both tracers. Truth is `physics::trace` in f64 with small steps; it knows nothing of tables. Where a tracer
//! integrates every ray itself, it is held to the same bars. The GPU is whatever adapter comes first; without one the
//! tests fail.

mod errors;
mod footprints;
mod observers;
mod records;
mod seams;
mod truth;

use crate::frames::Lent;
use std::f64::consts::PI;

/// A pixel of a 3840 x 2160 frame, 60 degrees high, rad.
const PIXEL_4K: f64 = PI / 3.0 / 2160.0;

const TRACERS: [&str; 2] = ["cpu", "gpu"];
const GPU: usize = 1;

fn both() -> [Lent; 2] {
    crate::frames::both().map(|(_, renderer)| renderer)
}

fn fail_if_any(failures: Vec<String>) {
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}
