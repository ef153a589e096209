// SPDX-License-Identifier: MIT OR Apache-2.0
//! The end of the process while threads of this library are within a driver. exit() runs the exit handlers of drivers,
//! which unload parts of them: on an H100 (NVIDIA 580.159.04) a thread that was making a pipeline then ran into memory
//! that was no longer there, and a process that would have ended well crashed. A host that ends by exit(), or by
//! returning from main, need not have destroyed its contexts, and has no hand in these threads; so an exit handler
//! waits until they have come out of the driver, and holds them up while the process ends. Knows no wgpu.
//!
//! They are held up for [`PAUSE`] only, or for [`KEPT_PAUSE`] where something of theirs was to be destroyed: after that
//! the process still lives because somebody waits, perhaps for them. Threads of the host are never held up. What they
//! do with a driver in exit() is for the host to see to.
//!
//! Exit handlers and destructors that the host registered earlier run after those of the drivers. A call into a driver
//! may crash by then, so on that thread contexts refuse their calls, and what they have of the driver is left as it is.

use crate::platform::{self, Instant};
use std::cell::Cell;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

/// How long the end of the process waits at most for the calls into drivers that have begun: once, however many things
/// are destroyed.
const LONGEST: Duration = Duration::from_secs(10);
/// How long threads are held up: handlers and destructors take less, unless they wait for something.
const PAUSE: Duration = Duration::from_secs(2);
/// How long threads are held up after something was to be destroyed, counted from the last such thing: what the host
/// lent it may be gone.
const KEPT_PAUSE: Duration = Duration::from_secs(10);

/// The number of this library's threads within a driver, and [`CLOSED`].
static STATE: AtomicUsize = AtomicUsize::new(0);
/// The bit of `STATE` that says that none of them may enter.
const CLOSED: usize = 1 << (usize::BITS - 1);
/// The thread that ends the process, as [`this_thread`]; 0 while there is none.
static ENDING: AtomicUsize = AtomicUsize::new(0);
/// When they may enter again, once `STATE` is closed.
static OPENS: Mutex<Option<Instant>> = Mutex::new(None);
static CHANGED: Condvar = Condvar::new();

thread_local! {
    /// Whether this thread is one of this library's.
    static OWN: Cell<bool> = const { Cell::new(false) };
    /// How many [`Inside`] this thread has.
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// A number that no other thread has while this one lives. `None` at its end.
fn this_thread() -> Option<usize> {
    DEPTH.try_with(|depth| std::ptr::from_ref(depth).addr()).ok()
}

fn opens() -> MutexGuard<'static, Option<Instant>> {
    OPENS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// To be called first by each thread of this library's that calls drivers.
pub fn own_thread() {
    OWN.set(true);
}

/// While it lives, its thread may call a driver.
pub struct Inside {
    counts: bool,
    /// Keeps the value on its thread, whose depth it counts.
    _thread: std::marker::PhantomData<*const ()>,
}

/// To be called around calls into a driver, before a lock is taken that others need. On a thread of this library's it
/// does not return while the process ends.
pub fn enter() -> Inside {
    let own = OWN.try_with(Cell::get).unwrap_or(false);
    let outermost = own && DEPTH.try_with(|depth| depth.replace(depth.get() + 1) == 0).unwrap_or(false);
    while outermost && STATE.fetch_add(1, Ordering::SeqCst) & CLOSED != 0 {
        leave();
        stand_still();
    }
    Inside { counts: outermost, _thread: std::marker::PhantomData }
}

fn leave() {
    if STATE.fetch_sub(1, Ordering::SeqCst) & CLOSED != 0 {
        // With the lock, so that who waits either sees the change or hears of it.
        drop(opens());
        CHANGED.notify_all();
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        if OWN.try_with(Cell::get).unwrap_or(false) {
            let _ = DEPTH.try_with(|depth| depth.set(depth.get() - 1));
        }
        if self.counts {
            leave();
        }
    }
}

fn stand_still() {
    let mut opens = opens();
    while STATE.load(Ordering::SeqCst) & CLOSED != 0 {
        let left = opens.map_or(Duration::ZERO, |opens| opens.saturating_duration_since(Instant::now()));
        if left.is_zero() {
            STATE.fetch_and(!CLOSED, Ordering::SeqCst);
            return;
        }
        opens = CHANGED.wait_timeout(opens, left).unwrap_or_else(PoisonError::into_inner).0;
    }
}

/// Whether the system has ended all other threads already, as Windows does: nothing is waited for, given back or
/// locked any more.
pub fn is_over() -> bool {
    platform::other_threads_are_gone()
}

/// Whether this is the thread that ends the process, and a driver was loaded: it must not call one any more. Where the
/// end [is over](is_over), no other thread is left, and without a driver the same holds.
pub fn is_here() -> bool {
    if is_over() {
        return true;
    }
    let ending = ENDING.load(Ordering::SeqCst);
    ending != 0 && this_thread() == Some(ending)
}

/// Keeps what belongs to a driver as it is until the process is gone, reachable for leak checkers. For
/// [`KEPT_PAUSE`] none of the library's threads uses it, nor what the host has lent it; held up for good, they could
/// keep a thread of the host's that the host waits for.
pub fn keep<T: 'static>(owned: T) {
    static KEPT: Mutex<Vec<usize>> = Mutex::new(Vec::new());
    if is_over() {
        return std::mem::forget(owned);
    }
    shut(longest(), KEPT_PAUSE);
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).push(std::ptr::from_mut(Box::leak(Box::new(owned))).addr());
}

/// When the end of the process waits no longer; it begins with the first call.
fn longest() -> Instant {
    static END: OnceLock<Instant> = OnceLock::new();
    *END.get_or_init(|| Instant::now() + LONGEST)
}

/// This thread stands still for good, within a driver or not: nobody is to wait for it.
pub fn abandon() {
    if OWN.try_with(Cell::get).unwrap_or(false) && DEPTH.try_with(|depth| depth.replace(0)).unwrap_or(0) > 0 {
        leave();
    }
}

/// The process ends on this thread.
fn close(deadline: Instant) {
    ENDING.store(this_thread().unwrap_or(0), Ordering::SeqCst);
    shut(deadline, PAUSE);
}

/// Holds the library's threads up, for so long after those within a driver have left it or `deadline` has come.
fn shut(deadline: Instant, pause: Duration) {
    let mut opens = opens();
    let began = Instant::now().max(deadline);
    *opens = (*opens).max(Some(began + pause));
    STATE.fetch_or(CLOSED, Ordering::SeqCst);
    // Where one of the library's threads ends the process, in a callback, it does not wait for itself.
    let own = usize::from(DEPTH.try_with(Cell::get).unwrap_or(0) > 0);
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        if STATE.load(Ordering::SeqCst) & !CLOSED <= own || left.is_zero() {
            break;
        }
        opens = CHANGED.wait_timeout(opens, left).unwrap_or_else(PoisonError::into_inner).0;
    }
    *opens = Some(Instant::now() + pause);
    CHANGED.notify_all();
}

/// To be called before a driver is loaded, once it is, and when a device has its first pipeline, as drivers load their
/// compilers late: exit handlers run in the opposite order of their registration, and one of these is to run before
/// each of the drivers'.
pub fn watch() {
    /// Registrations at most: a process has few drivers, but may open many devices.
    const MOST: u32 = 64;
    static COUNT: AtomicU32 = AtomicU32::new(0);
    PROCESS.get_or_init(platform::process_id);
    if COUNT.fetch_add(1, Ordering::Relaxed) < MOST {
        platform::at_exit(at_exit);
    }
}

/// The process whose threads are counted: a forked one has none of them.
static PROCESS: OnceLock<u32> = OnceLock::new();

extern "C" fn at_exit() {
    let of_this_process = PROCESS.get() == Some(&platform::process_id());
    // Several handlers are registered; the first one that runs does it all.
    if of_this_process && ENDING.load(Ordering::SeqCst) == 0 {
        close(longest());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    fn own(work: impl FnOnce() + Send + 'static) -> std::thread::JoinHandle<()> {
        std::thread::spawn(|| {
            own_thread();
            work();
        })
    }

    /// One test, as there is one gate.
    #[test]
    fn the_end_waits_for_those_within_and_holds_others_up_for_a_while() {
        let (entered, has_entered) = mpsc::channel();
        let (leaves, may_leave) = mpsc::channel::<()>();
        let within = own(move || {
            let inside = enter();
            entered.send(()).unwrap();
            may_leave.recv().unwrap();
            // Further calls within one are let in: it has to get on.
            drop(enter());
            drop(inside);
        });
        has_entered.recv().unwrap();
        let _hosts = enter();
        let begun = Instant::now();
        close(begun + Duration::from_millis(50));
        assert!(begun.elapsed() >= Duration::from_millis(50) && is_here(), "it did not wait");
        assert!(!std::thread::spawn(is_here).join().unwrap());

        leaves.send(()).unwrap();
        within.join().unwrap();
        close(Instant::now() + Duration::from_secs(60));
        let closed = Instant::now();
        // A thread of the host's is let in at once, one of the library's after the pause.
        std::thread::spawn(|| drop(enter())).join().unwrap();
        assert!(STATE.load(Ordering::SeqCst) & CLOSED != 0);
        own(|| drop(enter())).join().unwrap();
        // Threads of other tests may be within by now.
        assert!(closed.elapsed() >= PAUSE && STATE.load(Ordering::SeqCst) & CLOSED == 0);
        ENDING.store(0, Ordering::SeqCst);
    }
}
