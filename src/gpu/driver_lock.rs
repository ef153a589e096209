//! The one lock of a process under which drivers are started and ended. NVIDIA's Vulkan driver hangs or crashes where
//! threads do at once what begins or ends its use, even on instances and devices of their own: making instances
//! (gfx-rs/wgpu #5930, kvark/blade #336), devices and their first pipelines (gfx-rs/wgpu #10234; on an H200 with
//! 580.159.04 in 1 of 8 runs of four threads), and ending them (gfx-rs/wgpu #8365). Knows no wgpu.
//!
//! So the lock is held while an instance is made or dropped, adapters are listed, a device is opened, until it has its
//! first pipeline, and while the device is dropped. Who holds it waits for no other thread and calls no host: messages
//! wait (`deferred`).

use crate::deferred::{Holding, hold};
use parking_lot::{ReentrantMutex, ReentrantMutexGuard, const_reentrant_mutex};

/// Reentrant, as what is dropped under it may be the last to hold something that is dropped under it too.
static DRIVER: ReentrantMutex<()> = const_reentrant_mutex(());

/// While it lives, no other thread starts or ends a driver.
pub struct Alone {
    // Released before what waits for that is done.
    _lock: ReentrantMutexGuard<'static, ()>,
    _holding: Holding,
}

pub fn lock() -> Alone {
    let holding = hold();
    Alone { _lock: DRIVER.lock(), _holding: holding }
}

/// Whether this thread holds it: for tests.
pub fn is_held() -> bool {
    DRIVER.is_owned_by_current_thread()
}
