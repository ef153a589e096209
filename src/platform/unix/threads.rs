// SPDX-License-Identifier: MIT OR Apache-2.0
//! Threads of Linux: their ends and their priorities.

use std::cell::Cell;
use std::ffi::c_void;
use std::ptr::without_provenance_mut;
use std::sync::OnceLock;

/// The work at the ends of threads.
struct Ends {
    /// A key of the system's for values of threads, whose handler runs at a thread's end. The keys' handlers run in
    /// the order in which the keys were made, so it is made before the library that has others is loaded; and once
    /// more in a second round if the handler sets the value again. So `before` runs in its first turn, before the
    /// library's handlers, and `after` in its second, after them.
    key: libc::pthread_key_t,
    before: fn(),
    after: fn(),
}

/// `None`: the system has no key left.
static ENDS: OnceLock<Option<Ends>> = OnceLock::new();

const GUARDED: usize = 1;
const ENDING: usize = 2;

thread_local!(static IS_GUARDED: Cell<bool> = const { Cell::new(false) });

pub fn around_thread_end(before: fn(), after: fn()) {
    if IS_GUARDED.try_with(|guarded| guarded.replace(true)).unwrap_or(true) {
        return;
    }
    let ends = ENDS.get_or_init(|| {
        let mut key = 0;
        // SAFETY: the handler lives as long as the process, as the library is never unmapped.
        (unsafe { libc::pthread_key_create(&mut key, Some(on_end)) } == 0).then_some(Ends { key, before, after })
    });
    if let Some(Ends { key, .. }) = ends {
        set(*key, GUARDED);
    }
}

fn set(key: libc::pthread_key_t, value: usize) -> bool {
    // SAFETY: the key exists; the value is a number, and no memory.
    unsafe { libc::pthread_setspecific(key, without_provenance_mut(value)) == 0 }
}

unsafe extern "C" fn on_end(value: *mut c_void) {
    let Some(Some(Ends { key, before, after })) = ENDS.get() else { return };
    if value.addr() == ENDING {
        after();
    } else if set(*key, ENDING) {
        before();
    }
}

/// On Linux a thread has a priority of its own, which it may lower.
pub fn lower_priority(steps: i32) {
    const NICEST: i32 = 19;
    // SAFETY: plain system calls on this thread.
    unsafe {
        let thread = libc::syscall(libc::SYS_gettid) as libc::id_t;
        let own = libc::getpriority(libc::PRIO_PROCESS, thread);
        libc::setpriority(libc::PRIO_PROCESS, thread, (own + steps).min(NICEST));
    }
}
