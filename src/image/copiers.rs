// SPDX-License-Identifier: MIT OR Apache-2.0
//! Threads that share the copying of large pieces of memory: one core brings about 12 GB/s out of a GPU's staging
//! memory, a PCIe 5 bus carries 50. Knows no images and touches no memory itself.

use crate::allocate::{self, THREAD_ROOM};
use crate::parallel::prelude::*;
use crate::parallel::{ThreadPool, ThreadPoolBuilder};
use crate::thread_state::begin_own_thread;
use std::ops::Range;
use std::sync::OnceLock;

/// The bytes from which on it is worth waking other threads, which takes some 10 us.
const SHARED_FROM: usize = 1 << 20;
/// The most threads: more copy no faster (H200, 16 cores: 1 thread 13 GB/s, 2: 25, 4: 47, 8: 57 to 96).
const MOST_THREADS: usize = 8;
/// The parts for each thread, so that one that comes late holds up little.
const PARTS_A_THREAD: usize = 2;

/// A pool of threads that starts with the first large piece, and ends with this value.
pub struct Copiers {
    threads: usize,
    /// The pool; `None` inside if the system gave no threads.
    pool: OnceLock<Option<ThreadPool>>,
}

impl Default for Copiers {
    /// Copiers for this process: half of the cores it may use, at most 8; the other cores are the host's.
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        Self::new((cores / 2).min(MOST_THREADS))
    }
}

impl Copiers {
    /// Makes copiers of so many threads; with fewer than two, the caller's thread copies alone.
    pub fn new(threads: usize) -> Self {
        Self { threads, pool: OnceLock::new() }
    }

    /// Calls `copy` with ranges that make up 0 .. `rows`, each row in one of them, and returns when all is done: on
    /// several threads if the rows are of `bytes` that are worth it.
    pub fn share(&self, rows: u32, bytes: usize, copy: impl Fn(Range<u32>) + Sync) {
        let pool = if bytes < SHARED_FROM || self.threads < 2 { None } else { self.pool() };
        let Some(pool) = pool else { return copy(0..rows) };
        let parts = self.threads * PARTS_A_THREAD;
        let begin = |part: usize| (u64::from(rows) * part as u64 / parts as u64) as u32;
        pool.install(|| (0..parts).into_par_iter().with_max_len(1).for_each(|i| copy(begin(i)..begin(i + 1))));
    }

    fn pool(&self) -> Option<&ThreadPool> {
        let build = || {
            let room = allocate::check_room(self.threads * THREAD_ROOM, "threads to copy frames with");
            room.inspect_err(|error| log::warn!("{error}")).ok()?;
            let builder = ThreadPoolBuilder::new().num_threads(self.threads);
            let built = builder.thread_name(|i| format!("bhr-copy-{i}")).start_handler(|_| begin_own_thread()).build();
            let pool = built.inspect_err(|error| log::warn!("no threads to copy frames with: {error}")).ok()?;
            // Once all threads run, they have the memory that a thread takes at its start, which bhr cannot refuse.
            pool.broadcast(|_| ());
            Some(pool)
        };
        self.pool.get_or_init(build).as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn every_row_is_copied_once_whatever_the_threads() {
        for (threads, rows, bytes) in
            [(0, 5, SHARED_FROM), (1, 7, SHARED_FROM), (3, 1000, SHARED_FROM), (8, 3, 9 << 20), (3, 9, 1)]
        {
            let copiers = Copiers::new(threads);
            let counts = (0..rows).map(|_| AtomicU32::new(0)).collect::<Vec<_>>();
            copiers.share(rows, bytes, |part| {
                for row in part {
                    counts[row as usize].fetch_add(1, Ordering::Relaxed);
                }
            });
            assert!(counts.iter().all(|count| count.load(Ordering::Relaxed) == 1), "{threads} threads, {rows} rows");
            assert_eq!(copiers.pool.get().is_some(), threads > 1 && bytes >= SHARED_FROM);
        }
    }
}
