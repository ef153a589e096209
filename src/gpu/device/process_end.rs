// SPDX-License-Identifier: MIT OR Apache-2.0
//! The end of the process while threads are within a driver. exit() runs the exit handlers of drivers, which unload
//! parts of them: on an H100 (NVIDIA 580.159.04) a thread that was making a pipeline then ran into memory that was no
//! longer there, and a process that would have ended well crashed. A host that ends by exit(), or by returning from
//! main, need not have destroyed its contexts; so a handler of this library waits until no thread is within a driver
//! any more, and from then on keeps them out. It is registered when a driver is loaded, and handlers run in the
//! opposite order, so that it runs before the driver's. Knows no wgpu.
//!
//! Handlers and destructors that the host registered before that run after the drivers' own, when calling one may
//! crash: so nothing is given back to drivers any more, and what belongs to them stays until the process is gone.

use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long the end of the process is held up at most, for the calls into drivers that have begun.
const LONGEST: Duration = Duration::from_secs(10);

/// The number of threads within a driver, and [`CLOSED`].
static STATE: AtomicUsize = AtomicUsize::new(0);
/// The bit of `STATE` that says that no thread may enter.
const CLOSED: usize = 1 << (usize::BITS - 1);
/// The thread that ends the process, as [`this_thread`]; 0 while there is none.
static ENDING: AtomicUsize = AtomicUsize::new(0);
/// With `STATE` as what is waited for.
static CHANGES: (Mutex<()>, Condvar) = (Mutex::new(()), Condvar::new());

thread_local! {
    /// How many [`Inside`] this thread has.
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// A number that no other thread has while this one lives. `None` at its end.
fn this_thread() -> Option<usize> {
    DEPTH.try_with(|depth| std::ptr::from_ref(depth).addr()).ok()
}

/// Waits until no more than `own` threads are within a driver, or until `deadline`.
fn wait(deadline: Instant, own: usize) {
    let mut lock = CHANGES.0.lock().unwrap_or_else(PoisonError::into_inner);
    while STATE.load(Ordering::SeqCst) & !CLOSED > own {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return;
        }
        lock = CHANGES.1.wait_timeout(lock, left).unwrap_or_else(PoisonError::into_inner).0;
    }
}

/// While it lives, its thread may call a driver.
pub struct Inside {
    counts: bool,
    /// It belongs to its thread.
    _thread: std::marker::PhantomData<*const ()>,
}

/// To be called around each call into a driver. Once the process ends it does not return, but on the thread that ends
/// it, or on one of which a driver's lock is `held` that other threads need.
pub fn enter(held: impl FnOnce() -> bool) -> Inside {
    let outermost = DEPTH.try_with(|depth| depth.replace(depth.get() + 1) == 0);
    let counts = outermost.unwrap_or(false);
    if counts && STATE.fetch_add(1, Ordering::SeqCst) & CLOSED != 0 && !is_ending() && !held() {
        leave();
        stand_still();
    }
    Inside { counts, _thread: std::marker::PhantomData }
}

fn leave() {
    if STATE.fetch_sub(1, Ordering::SeqCst) & CLOSED != 0 {
        // With the lock, so that who waits either sees the change or hears of it.
        drop(CHANGES.0.lock().unwrap_or_else(PoisonError::into_inner));
        CHANGES.1.notify_all();
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        let _ = DEPTH.try_with(|depth| depth.set(depth.get() - 1));
        if self.counts {
            leave();
        }
    }
}

/// Whether the process ends: a thread must not call a driver any more, nor wait for one that would.
pub fn has_begun() -> bool {
    STATE.load(Ordering::SeqCst) & CLOSED != 0
}

/// Whether this thread ends the process.
fn is_ending() -> bool {
    this_thread() == Some(ENDING.load(Ordering::SeqCst))
}

/// Until the process is gone.
fn stand_still() {
    #[cfg(not(test))]
    loop {
        std::thread::park();
    }
    // Tests open the gate again.
    #[cfg(test)]
    while has_begun() {
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Keeps threads out, and waits until those within a driver have left it, this one aside, or until `deadline`.
fn close(deadline: Instant) {
    ENDING.store(this_thread().unwrap_or(0), Ordering::SeqCst);
    STATE.fetch_or(CLOSED, Ordering::SeqCst);
    let own = usize::from(DEPTH.try_with(Cell::get).unwrap_or(0) > 0);
    wait(deadline, own);
}

/// To be called when a driver has been loaded: the end of the process waits for it.
pub fn watch() {
    #[cfg(unix)]
    handler::register();
}

#[cfg(unix)]
mod handler {
    use super::*;
    use crate::gpu::device::driver_lock;
    use std::sync::OnceLock;
    use std::sync::atomic::AtomicU32;

    /// Registrations at most: each driver's handlers are to run after one of them, and a process has few drivers.
    const MOST: u32 = 32;

    static COUNT: AtomicU32 = AtomicU32::new(0);
    /// The process whose threads are counted: a forked one has none of them.
    static PROCESS: OnceLock<libc::pid_t> = OnceLock::new();

    pub fn register() {
        // SAFETY: plain system calls; the handler lives as long as the process, as the library is never unmapped.
        unsafe {
            PROCESS.get_or_init(|| libc::getpid());
            if COUNT.fetch_add(1, Ordering::Relaxed) < MOST {
                libc::atexit(at_exit);
            }
        }
    }

    extern "C" fn at_exit() {
        // SAFETY: a plain system call.
        let of_this_process = PROCESS.get() == Some(&unsafe { libc::getpid() });
        // Several handlers are registered; and who comes here while the process ends already would wait for itself.
        if !of_this_process || has_begun() {
            return;
        }
        let deadline = Instant::now() + LONGEST;
        close(deadline);
        // Threads that start or end a driver hold its lock meanwhile.
        driver_lock::keep(deadline.saturating_duration_since(Instant::now()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    /// One test, as there is one gate: it is closed while a thread is within a driver, and while the closing one is.
    #[test]
    fn the_end_waits_for_those_within_and_keeps_others_out() {
        let (entered, has_entered) = mpsc::channel();
        let (leaves, may_leave) = mpsc::channel::<()>();
        let within = std::thread::spawn(move || {
            let inside = enter(|| false);
            entered.send(()).unwrap();
            may_leave.recv().unwrap();
            // Further calls within one are let in: it has to get on.
            drop(enter(|| false));
            drop(inside);
        });
        has_entered.recv().unwrap();
        let _own = enter(|| false);
        let begun = Instant::now();
        close(begun + Duration::from_millis(50));
        assert!(begun.elapsed() >= Duration::from_millis(50), "it did not wait");

        let (entered, has_entered) = mpsc::channel();
        let late = std::thread::spawn({
            let entered = entered.clone();
            move || {
                drop(enter(|| false));
                entered.send("late").unwrap();
            }
        });
        std::thread::spawn(move || {
            drop(enter(|| true));
            entered.send("holder of a lock").unwrap();
        });
        assert_eq!(has_entered.recv_timeout(Duration::from_secs(10)), Ok("holder of a lock"));
        leaves.send(()).unwrap();
        within.join().unwrap();
        close(Instant::now() + Duration::from_secs(60));
        assert!(has_entered.recv_timeout(Duration::from_millis(50)).is_err(), "a thread entered");
        assert!(has_begun());
        STATE.fetch_and(!CLOSED, Ordering::SeqCst);
        assert_eq!(has_entered.recv_timeout(Duration::from_secs(60)), Ok("late"));
        late.join().unwrap();
    }
}
