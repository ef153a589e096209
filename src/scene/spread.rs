// SPDX-License-Identifier: MIT OR Apache-2.0
//! Work on many things of which each is done by itself, on threads of the call's own.

use crate::allocate::{THREAD_ROOM, check_room};
use crate::thread_state::begin_own_thread;
use parking_lot::Mutex;

/// How work is spread.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Things that a thread takes at a time.
    pub at_a_time: usize,
    /// The fewest things that another thread is worth.
    pub a_thread: usize,
    /// The threads' names begin with it.
    pub name: &'static str,
}

impl Spread {
    /// Does `work` for each of `given`, whose result is the one of `found` in its place, on as many threads as the
    /// machine has cores.
    pub fn over<A: Sync, B: Send>(&self, given: &[A], found: &mut [B], work: impl Fn(&A, &mut B) + Sync) {
        // Threads of their own: in a pool, one that waits could come to wait for itself.
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        let threads = cores.min(given.len() / self.a_thread);
        let parts = Mutex::new(given.chunks(self.at_a_time).zip(found.chunks_mut(self.at_a_time)));
        let work = || {
            loop {
                let Some((given, found)) = parts.lock().next() else { return };
                for (given, found) in given.iter().zip(found) {
                    work(given, found);
                }
            }
        };
        let own = || {
            begin_own_thread();
            work();
        };
        std::thread::scope(|scope| {
            for i in 1..threads {
                let thread = std::thread::Builder::new().name(format!("{}-{i}", self.name));
                // Without memory for a thread, or without a thread, there are fewer: this one is enough.
                let room = check_room(THREAD_ROOM, "a thread that shares work");
                if room.is_err() || thread.spawn_scoped(scope, own).is_err() {
                    break;
                }
            }
            work();
        });
    }
}
