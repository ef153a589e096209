// SPDX-License-Identifier: MIT OR Apache-2.0
//! The threads that the CPU tracer works on, which are its own. Knows no scene.

use crate::allocate::{self, THREAD_ROOM};
use crate::error::{Error, ErrorKind, Result};
use crate::parallel::{ThreadPool, ThreadPoolBuilder};
use crate::thread_state::begin_own_thread;

pub(super) struct Pool(ThreadPool);

impl Pool {
    /// So many threads. Errors: OUT_OF_MEMORY when the system gives none.
    pub fn new(count: usize) -> Result<Self> {
        allocate::check_room(count * THREAD_ROOM, "the threads of the CPU tracer")?;
        let pool = ThreadPoolBuilder::new()
            .num_threads(count)
            .thread_name(|i| format!("bhr-cpu-{i}"))
            .start_handler(|_| begin_own_thread())
            .build()
            .map_err(|e| Error::new(ErrorKind::OutOfMemory, format!("could not start {count} threads: {e}")))?;
        // Once all of them run, they have what threads take at their start, which is not ours to refuse.
        pool.broadcast(|_| ());
        Ok(Self(pool))
    }

    /// Does `work` there, which may go on in parallel.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.0.install(work)
    }
}
