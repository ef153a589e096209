//! The threads that make pipelines: some at once for a frame that waits for them, and few of low priority for frames that may
//! come. They end with their owner. Knows no scene.

use super::Device;
use super::kernel_key::KernelKey;
use super::kernels::Store;
use crate::error::{Error, Result};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// Threads that make pipelines in the background at most, and at most for a frame that waits.
const MOST_BEHIND: usize = 8;
const MOST_AT_ONCE: usize = 12;

/// Their owner's drop ends the threads, after the pipeline that each is making.
pub struct Compilers {
    /// Whether pipelines may be made on threads other than their user's.
    threads: bool,
    queue: Arc<Mutex<Queue>>,
}

#[derive(Default)]
struct Queue {
    keys: VecDeque<KernelKey>,
    /// That take from the queue. A thread that finds it empty ends.
    running: usize,
    started: Vec<JoinHandle<()>>,
}

fn lock(queue: &Mutex<Queue>) -> MutexGuard<'_, Queue> {
    queue.lock().unwrap_or_else(PoisonError::into_inner)
}

fn cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

impl Compilers {
    /// `threads`: whether the device may be used from several at once.
    pub fn new(threads: bool) -> Self {
        Self { threads, queue: Arc::default() }
    }

    /// Makes `missing`, and waits. Errors: the first one's.
    pub fn make_now(&self, store: &Store, device: &Device, missing: Vec<KernelKey>) -> Result<()> {
        let helpers = if self.threads { missing.len().min(cores()).min(MOST_AT_ONCE).saturating_sub(1) } else { 0 };
        let next = Mutex::new(missing.into_iter());
        let work = || -> Result<()> {
            loop {
                let key = next.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some(key) = key else { return Ok(()) };
                store.get(device, key)?;
            }
        };
        thread::scope(|scope| {
            let started = (0..helpers).map_while(|_| {
                // A machine that has no more threads makes do with fewer.
                thread::Builder::new().name("bhr-kernels".into()).spawn_scoped(scope, work).ok()
            });
            let started = started.collect::<Vec<_>>();
            let own = work();
            let panicked = |_| Err(Error::internal("making a pipeline panicked"));
            started.into_iter().map(|thread| thread.join().unwrap_or_else(panicked)).fold(own, Result::and)
        })
    }

    /// Makes those of `keys` that are not there in the background, in place of what waits since an earlier call. What fails
    /// is left for the frame that needs it, which then tells of it.
    pub fn make_later(&self, store: &Arc<Store>, device: &Arc<Device>, keys: Vec<KernelKey>) {
        if !self.threads {
            return;
        }
        let keys = keys.into_iter().filter(|key| !store.has(*key)).collect::<VecDeque<_>>();
        let mut queue = lock(&self.queue);
        queue.keys = keys;
        // Half of the cores are left to the host, where there are several.
        let most = cores().div_ceil(2).min(MOST_BEHIND);
        while queue.running < most.min(queue.keys.len()) {
            let (shared, store, device) = (self.queue.clone(), store.clone(), device.clone());
            let work = move || make_behind(&shared, &store, &device);
            let Ok(thread) = thread::Builder::new().name("bhr-kernels".into()).spawn(work) else { return };
            queue.running += 1;
            queue.started.retain(|thread| !thread.is_finished());
            queue.started.push(thread);
        }
    }

    /// Waits until the queue is empty and its threads have ended.
    pub fn settle(&self) {
        let started = std::mem::take(&mut lock(&self.queue).started);
        for thread in started {
            // It catches its panics itself.
            let _ = thread.join();
        }
    }
}

impl Drop for Compilers {
    fn drop(&mut self) {
        lock(&self.queue).keys.clear();
        self.settle();
    }
}

fn make_behind(queue: &Mutex<Queue>, store: &Store, device: &Device) {
    lower_priority();
    loop {
        let key = {
            let mut queue = lock(queue);
            let key = queue.keys.pop_front();
            if key.is_none() {
                queue.running = queue.running.saturating_sub(1);
            }
            key
        };
        let Some(key) = key else { return };
        // Unwind safe: the store settles a pipeline whose making panics.
        let made = catch_unwind(AssertUnwindSafe(|| store.get(device, key)));
        if !matches!(made, Ok(Ok(_))) {
            log::debug!("a pipeline was not made in the background; the frame that needs it will tell why");
        }
    }
}

/// On Linux a thread has a priority of its own, which it may lower; elsewhere their small number has to do. Lowered to a third of the
/// usual share and no further, as a frame may come to wait for the pipeline that such a thread is making.
fn lower_priority() {
    #[cfg(target_os = "linux")]
    {
        const NICE: i32 = 5;
        // SAFETY: plain system calls on this thread.
        unsafe {
            let thread = libc::syscall(libc::SYS_gettid) as libc::id_t;
            libc::setpriority(libc::PRIO_PROCESS, thread, NICE);
        }
    }
}
