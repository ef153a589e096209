// SPDX-License-Identifier: MIT OR Apache-2.0
//! The one lock of a process under which drivers are started and ended. NVIDIA's Vulkan driver hangs or crashes where
//! threads do at once what begins or ends its use, even on instances and devices of their own: making instances
//! (gfx-rs/wgpu #5930, kvark/blade #336), devices and their first pipelines (gfx-rs/wgpu #10234; on an H200 with
//! 580.159.04 in 1 of 8 runs of four threads), and ending them (gfx-rs/wgpu #8365). Knows no wgpu.
//!
//! A thread that ends runs the driver's thread-exit handlers, which take locks of the driver's; vkDestroyDevice takes
//! them too and waits for the driver's own threads, which end the same way. On the H200 that hung one of eight to
//! thirteen runs of tests/gpu_device for ever (backtrace: vkDestroyDevice in pthread_join, two ending threads in
//! handlers of libEGL_nvidia and libnvidia-eglcore).
//!
//! So the lock is held while an instance is made or dropped, adapters are listed, a device is opened, until it has its
//! first pipeline, and while the device is dropped; on Linux also while a thread that has used a driver runs the
//! handlers of its end. Who holds it calls no host (messages wait: `deferred`), and waits for
//! no other thread but one that it has just started and that takes no lock (`gl_guard`).

use crate::deferred::{Holding, hold};
use crate::platform::around_thread_end;
use parking_lot::{ReentrantMutex, ReentrantMutexGuard, const_reentrant_mutex};

/// Reentrant, as what is dropped under it may be the last to hold something that is dropped under it too.
static DRIVER: ReentrantMutex<()> = const_reentrant_mutex(());

/// While it lives, no other thread starts or ends a driver.
pub struct DriverLock {
    // Released before what waits for that is done.
    _lock: ReentrantMutexGuard<'static, ()>,
    _holding: Holding,
}

pub fn lock() -> DriverLock {
    guard();
    let holding = hold();
    DriverLock { _lock: DRIVER.lock(), _holding: holding }
}

/// Releases it for a thread that will never run again.
pub fn abandon() {
    while DRIVER.is_owned_by_current_thread() {
        // SAFETY: this thread owns it, and none of the guards that count on that is used any more.
        unsafe { DRIVER.force_unlock() };
    }
}

/// Whether this thread holds it: for tests.
pub fn is_held() -> bool {
    DRIVER.is_owned_by_current_thread()
}

/// To be called by each thread before it uses a driver. At the end of the thread the lock is held from before the
/// driver's handlers until after them, where the system tells of that.
pub fn guard() {
    around_thread_end(
        || std::mem::forget(DRIVER.lock()),
        // SAFETY: this thread holds it since the other function.
        || unsafe { DRIVER.force_unlock() },
    );
}

// Other systems do not tell of the ends of threads.
#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::ffi::c_void;
    use std::ptr::without_provenance_mut;
    use std::sync::atomic::{AtomicU32, Ordering};

    static SEEN: AtomicU32 = AtomicU32::new(0);

    /// In the place of a driver's handler: counts the ends of threads that hold the lock, and of those that do not.
    unsafe extern "C" fn at_end(_: *mut c_void) {
        SEEN.fetch_add(if is_held() { 1 } else { 1 << 16 }, Ordering::Relaxed);
    }

    #[test]
    fn a_thread_that_used_a_driver_ends_alone() {
        guard();
        let mut of_driver = 0;
        // SAFETY: the handler lives as long as the test.
        assert_eq!(unsafe { libc::pthread_key_create(&mut of_driver, Some(at_end)) }, 0);
        for (uses, seen) in [(true, 1), (true, 2), (false, 2 + (1 << 16))] {
            let thread = std::thread::spawn(move || {
                if uses {
                    guard();
                }
                // SAFETY: the key exists; the value is a number, and no memory.
                assert_eq!(unsafe { libc::pthread_setspecific(of_driver, without_provenance_mut(1)) }, 0);
                assert!(!is_held());
            });
            thread.join().unwrap();
            assert_eq!(SEEN.load(Ordering::Relaxed), seen);
            // The lock is free again: another thread gets it.
            std::thread::spawn(|| drop(lock())).join().unwrap();
        }
    }
}
