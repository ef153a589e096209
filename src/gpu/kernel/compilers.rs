// SPDX-License-Identifier: MIT OR Apache-2.0
//! The threads that make pipelines: some at once for a frame that waits for them, and few of low priority for frames
//! that may come. They end with their owner. Knows no scene.

use super::cache::PipelineCache;
use super::key::KernelKey;
use super::stage::Compiled;
use crate::deferred::hold;
use crate::error::Result;
use crate::gpu::device::process_end;
use crate::gpu::device::wgpu_device::Device;
use crate::platform::lower_priority;
use crate::thread_scope;
use crate::thread_state::begin_own_thread;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// Threads that make pipelines in the background at most, and at most for a frame that waits. More in the background
/// make the same number in the same time, and each, so also the one that is needed first, takes longer (H200: 8 at
/// once take twice as long as one).
const MOST_IN_BACKGROUND: usize = 5;
const MOST_AT_ONCE: usize = 12;

/// The threads that may make a device's pipelines beside its user's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threads {
    None,
    /// One, where pipelines are made one at a time: further ones would hold kernels that a frame waits for, and wait.
    One,
    Many,
}

impl Threads {
    /// How many threads make `missing` kernels for a frame that waits and makes some itself.
    fn at_once(self, missing: usize, cores: usize) -> usize {
        match self {
            Self::None => 0,
            Self::One => missing.min(1),
            Self::Many => missing.min(cores).min(MOST_AT_ONCE),
        }
    }

    /// How many make kernels in the background: half of the cores are left to the host, where there are several.
    fn in_background(self, cores: usize) -> usize {
        match self {
            Self::None => 0,
            Self::One => 1,
            Self::Many => cores.div_ceil(2).min(MOST_IN_BACKGROUND),
        }
    }
}

/// Their owner's drop ends the threads, after the pipeline that each is making.
pub struct Compilers {
    threads: Threads,
    queue: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    queue: Mutex<Queue>,
    /// No frame waits any more, or nothing is left to be made.
    free: Condvar,
}

#[derive(Default)]
struct Queue {
    keys: VecDeque<KernelKey>,
    /// Threads that take from the queue. One that finds it empty ends.
    running: usize,
    /// Frames that wait for pipelines. Meanwhile nothing is begun for frames that may come: it would take the cores,
    /// and the locks of the driver.
    waiting: usize,
    started: Vec<JoinHandle<()>>,
}

impl Queue {
    /// Keeps a thread, to wait for its end.
    fn keep(&mut self, thread: JoinHandle<()>) {
        self.started.retain(|thread| !thread.is_finished());
        self.started.push(thread);
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until no frame waits, and takes the next kernel to make in the background; `None` when nothing is left,
    /// and then the thread that asks counts as ended.
    fn next(&self) -> Option<KernelKey> {
        let mut queue = self.lock();
        while queue.waiting > 0 && !queue.keys.is_empty() {
            queue = self.free.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
        let key = queue.keys.pop_front();
        if key.is_none() {
            queue.running = queue.running.saturating_sub(1);
        }
        key
    }
}

/// Pipelines that a frame waits for, and those of them that nobody has begun.
#[must_use]
pub struct CompileBatch {
    keys: Vec<KernelKey>,
    left: Arc<Mutex<VecDeque<KernelKey>>>,
    shared: Arc<Shared>,
}

impl Drop for CompileBatch {
    /// A frame that failed before wants nothing more.
    fn drop(&mut self) {
        self.left.lock().unwrap_or_else(PoisonError::into_inner).clear();
        self.shared.lock().waiting -= 1;
        self.shared.free.notify_all();
    }
}

impl CompileBatch {
    /// The entry points, for the log.
    pub fn names(&self) -> String {
        self.keys.iter().map(|key| key.kind.entry_point()).collect::<Vec<_>>().join(", ")
    }

    /// Takes part in making them until all are there. Errors: the first one's.
    pub fn finish(self, cache: &PipelineCache, device: &Device) -> Result<()> {
        while compile_next(&self.left, cache, device) {}
        self.keys.iter().copied().try_for_each(|key| cache.get(device, key).map(drop))
    }
}

/// Makes one of those that are `left`, as well as it can be. Whether there was one.
fn compile_next(left: &Mutex<VecDeque<KernelKey>>, cache: &PipelineCache, device: &Device) -> bool {
    let key = left.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
    if let Some(key) = key {
        compile(cache, |cache| cache.get(device, key));
    }
    key.is_some()
}

/// Makes a pipeline; a failure is left for the frame that needs it.
fn compile(cache: &PipelineCache, compile_it: impl FnOnce(&PipelineCache) -> Result<Compiled>) {
    // A host's callback hears of it once those who wait for the pipeline have it.
    let _holding = hold();
    // Before this thread is the one that makes the pipeline, for which others wait.
    let _inside = process_end::enter();
    // Unwind safe: the store settles a pipeline whose making panics.
    if !matches!(catch_unwind(AssertUnwindSafe(|| compile_it(cache))), Ok(Ok(_))) {
        log::debug!("a pipeline could not be made; the frame that needs it will tell why");
    }
}

fn cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

impl Compilers {
    pub fn new(threads: Threads) -> Self {
        Self { threads, queue: Arc::default() }
    }

    /// Begins to make `missing` on several threads. What fails is tried again by [`CompileBatch::finish`].
    pub fn compile_now(
        &self,
        cache: &Arc<PipelineCache>,
        device: &Arc<Device>,
        missing: Vec<KernelKey>,
    ) -> CompileBatch {
        let helpers = self.threads.at_once(missing.len(), cores());
        // Kernels that take longest come last in the list, and are begun first.
        let left = Arc::new(Mutex::new(missing.iter().rev().copied().collect::<VecDeque<_>>()));
        let scope = thread_scope::of_caller();
        let mut queue = self.queue.lock();
        queue.waiting += 1;
        for _ in 0..helpers {
            let (left, cache, device, scope) = (left.clone(), cache.clone(), device.clone(), scope.clone());
            // A machine that has no more threads makes do with fewer.
            let work = move || {
                begin_own_thread();
                process_end::own_thread();
                let _scope = scope();
                while compile_next(&left, &cache, &device) {}
            };
            let Ok(thread) = thread::Builder::new().name("bhr-kernels".into()).spawn(work) else { break };
            queue.keep(thread);
        }
        CompileBatch { keys: missing, left, shared: self.queue.clone() }
    }

    /// Does `work` on a thread of low priority.
    pub fn run_in_background(&self, work: impl FnOnce() + Send + 'static) {
        if self.threads == Threads::None {
            return;
        }
        let scope = thread_scope::of_caller();
        let work = move || {
            begin_own_thread();
            process_end::own_thread();
            let _scope = scope();
            lower_priority(NICER);
            if catch_unwind(AssertUnwindSafe(work)).is_err() {
                log::debug!("work ahead of a frame panicked; the frame will do it again");
            }
        };
        if let Ok(thread) = thread::Builder::new().name("bhr-ahead".into()).spawn(work) {
            self.queue.lock().keep(thread);
        }
    }

    /// Makes those of `keys` that are not there, and keeps those that are, in the background, in place of what waits
    /// since an earlier call.
    pub fn compile_later(&self, cache: &Arc<PipelineCache>, device: &Arc<Device>, keys: Vec<KernelKey>) {
        let most = self.threads.in_background(cores());
        if most == 0 {
            return;
        }
        let mut queue = self.queue.lock();
        queue.keys = keys.into();
        while queue.running < most.min(queue.keys.len()) {
            let (shared, cache, device) = (self.queue.clone(), cache.clone(), device.clone());
            let scope = thread_scope::of_caller();
            let work = move || {
                begin_own_thread();
                process_end::own_thread();
                let _scope = scope();
                compile_in_background(&shared, &cache, &device);
            };
            let Ok(thread) = thread::Builder::new().name("bhr-kernels".into()).spawn(work) else { return };
            queue.running += 1;
            queue.keep(thread);
        }
    }

    /// Waits until the queue is empty and its threads have ended.
    pub fn settle(&self) {
        let started = std::mem::take(&mut self.queue.lock().started);
        for thread in started {
            // A compiling thread catches its panics itself.
            let _ = thread.join();
        }
    }
}

impl Drop for Compilers {
    fn drop(&mut self) {
        self.queue.lock().keys.clear();
        self.queue.free.notify_all();
        self.settle();
    }
}

/// Compiling threads have a third of the usual share, and no less, as a frame may come to wait for the pipeline that
/// such a thread is making. Where threads have no priority of their own, their small number has to do.
const NICER: i32 = 5;

fn compile_in_background(shared: &Shared, cache: &PipelineCache, device: &Device) {
    lower_priority(NICER);
    while let Some(key) = shared.next() {
        compile(cache, |cache| cache.get_ahead(device, key));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_pipelines_are_made_one_at_a_time_one_thread_makes_them_beside_their_users() {
        for cores in [1, 2, 16, 128] {
            assert_eq!([Threads::None.at_once(9, cores), Threads::None.in_background(cores)], [0, 0]);
            assert_eq!([Threads::One.at_once(9, cores), Threads::One.in_background(cores)], [1, 1]);
        }
        assert_eq!([Threads::One.at_once(0, 16), Threads::Many.at_once(0, 16)], [0, 0]);
        assert_eq!(
            [Threads::Many.at_once(9, 2), Threads::Many.at_once(9, 16), Threads::Many.at_once(99, 128)],
            [2, 9, 12]
        );
        assert_eq!([1, 2, 3, 128].map(|cores| Threads::Many.in_background(cores)), [1, 1, 2, 5]);
    }
}
