// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stack for work that may need more than its thread has left. Drivers and codecs take up to 200 KiB, more than some
//! hosts give a thread (musl: 128 KiB) or a fiber. The stack of such a thread is changed for the length of the work:
//! the thread stays the same, and with it all that belongs to one, such as GL contexts, locks and thread-locals.
//!
//! Only on Linux, where threads can be asked for the bounds of their stacks.

use parking_lot::Mutex;
use std::cell::Cell;
use std::ptr::{null_mut, with_exposed_provenance_mut};

/// A call that has so much left runs where it is: twice what was found to be needed, and more.
const ENOUGH: usize = 512 << 10;
/// The size of the stacks that bhr gives: that of its threads.
const SIZE: usize = 2 << 20;
/// The pages at a stack's low end that nobody may touch.
const GUARD: usize = 64 << 10;
/// More than the frames that change a stack take, but for the work that they carry, with what the ABI keeps free.
const MARGIN: usize = 1 << 10;
/// No ABI asks for more.
const ALIGNMENT: usize = 64;

#[derive(Clone, Copy)]
struct Bounds {
    low: usize,
    high: usize,
}

impl Bounds {
    fn contains(self, address: usize) -> bool {
        (self.low..self.high).contains(&address)
    }
}

/// A stack of bhr's that this thread has changed to.
#[derive(Clone, Copy)]
struct Change {
    bounds: Bounds,
    /// Below it, the stack from which the thread came is free.
    left: usize,
}

thread_local! {
    /// The bounds of the thread's own stack, once they were asked for; `Some(None)` where the system does not know.
    static OWN: Cell<Option<Option<Bounds>>> = const { Cell::new(None) };
    static CHANGE: Cell<Option<Change>> = const { Cell::new(None) };
}

/// Does `work` on this thread where it has stack enough for anything that bhr does. `work` must not unwind. An
/// error gives it back: there is no memory for a stack.
pub fn on_enough_stack<T, F: FnOnce() -> T>(work: F) -> Result<T, F> {
    if has_enough() {
        return Ok(work());
    }
    match Stack::take() {
        Some(stack) => Ok(stack.run(work)),
        None => Err(work),
    }
}

/// Runs code of the host's on the host's stack, where the thread has changed to one of bhr's: garbage collectors
/// and interpreters compare addresses with the bounds of their threads' stacks. `code` must not unwind.
pub fn on_host_stack<T>(code: impl FnOnce() -> T) -> T {
    match CHANGE.get().filter(|change| change.bounds.contains(here())) {
        None => code(),
        Some(Change { left, .. }) => {
            let low = with_exposed_provenance_mut::<u8>(left - ALIGNMENT);
            // SAFETY: this stack grows down from `left`, below which the host's is free; how far, is the host's to
            // see to, as in all its code. `code` does not unwind.
            unsafe { psm::on_stack(low, ALIGNMENT, code) }
        }
    }
}

fn here() -> usize {
    psm::stack_pointer().expose_provenance()
}

/// Whether this much is left. Not known on fibers, whose stacks the system knows nothing of.
fn has_enough() -> bool {
    let here = here();
    let own = OWN.get().unwrap_or_else(|| match own_bounds() {
        // The next call asks again.
        Err(libc::ENOMEM) => None,
        asked => {
            OWN.set(Some(asked.ok()));
            asked.ok()
        }
    });
    let changed = CHANGE.get().map(|change| change.bounds);
    let on = [own, changed].into_iter().flatten().find(|bounds| bounds.contains(here));
    on.is_some_and(|bounds| here - bounds.low >= ENOUGH)
}

/// The bounds of this thread's own stack, as it may grow at most. Errors: the system's number.
fn own_bounds() -> Result<Bounds, i32> {
    // SAFETY: an all-zero attribute object is overwritten, read and ended.
    unsafe {
        let mut attributes = std::mem::zeroed::<libc::pthread_attr_t>();
        let mut failed = libc::pthread_getattr_np(libc::pthread_self(), &mut attributes);
        if failed != 0 {
            return Err(failed);
        }
        let (mut low, mut size) = (null_mut(), 0);
        failed = libc::pthread_attr_getstack(&attributes, &mut low, &mut size);
        libc::pthread_attr_destroy(&mut attributes);
        if failed == 0 { Ok(Bounds { low: low.addr(), high: low.addr().saturating_add(size) }) } else { Err(failed) }
    }
}

/// Memory for a stack; its bounds without the guard.
struct Stack(Bounds);

/// The last stack that was given back: threads with little stack make many calls.
static SPARE: Mutex<Option<Stack>> = Mutex::new(None);

impl Stack {
    fn take() -> Option<Self> {
        SPARE.lock().take().or_else(Self::map)
    }

    fn map() -> Option<Self> {
        let flags = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_NORESERVE | libc::MAP_STACK;
        // SAFETY: new pages that nobody else has, the first of which become the guard.
        unsafe {
            let all = libc::mmap(null_mut(), GUARD + SIZE, libc::PROT_READ | libc::PROT_WRITE, flags, -1, 0);
            if all == libc::MAP_FAILED {
                return None;
            }
            let low = all.expose_provenance() + GUARD;
            let stack = Self(Bounds { low, high: low + SIZE });
            // A stack without its guard is dropped again.
            (libc::mprotect(all, GUARD, libc::PROT_NONE) == 0).then_some(stack)
        }
    }

    /// Does `work` on this stack. It must not unwind.
    fn run<T, F: FnOnce() -> T>(self, work: F) -> T {
        // The frame below this one has room for the work and its result.
        let margin = MARGIN + 2 * (size_of::<F>() + size_of::<T>());
        let left = (here() - margin) & !(ALIGNMENT - 1);
        let before = CHANGE.replace(Some(Change { bounds: self.0, left }));
        // SAFETY: the stack is aligned to pages, and nobody else's; `work` does not unwind.
        let result = unsafe { psm::on_stack(with_exposed_provenance_mut(self.0.low), SIZE, work) };
        CHANGE.set(before);
        let spare = SPARE.lock().replace(self);
        // Another one that was there is unmapped when the lock is released.
        drop(spare);
        result
    }
}

impl Drop for Stack {
    fn drop(&mut self) {
        // SAFETY: pages of `map`, which nobody uses any more.
        unsafe { libc::munmap(with_exposed_provenance_mut(self.0.low - GUARD), GUARD + SIZE) };
    }
}
