// SPDX-License-Identifier: MIT OR Apache-2.0
//! Work that is spread over a pool of threads: rayon's. Knows nothing of bhr.

pub use rayon::{ThreadPool, ThreadPoolBuilder, join, prelude};
