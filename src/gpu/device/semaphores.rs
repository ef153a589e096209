// SPDX-License-Identifier: MIT OR Apache-2.0
//! Semaphores as frames use them. The folder `vulkan` makes them; no other interface does.

use std::sync::Arc;

pub use super::vulkan::semaphore::GpuSemaphore;

/// A semaphore, and the value that a timeline is to have; none for binary ones.
#[derive(Clone)]
pub struct SemaphoreUse {
    pub semaphore: Arc<GpuSemaphore>,
    pub value: Option<u64>,
}

/// The semaphores that a frame waits for before it writes its target, and those that it signals when it has.
#[derive(Clone, Default)]
pub struct FrameSync {
    pub waits: Vec<SemaphoreUse>,
    pub signals: Vec<SemaphoreUse>,
}

impl FrameSync {
    /// The timelines that it signals, and their values.
    pub fn timelines(&self) -> impl Iterator<Item = (&Arc<GpuSemaphore>, u64)> {
        self.signals.iter().filter_map(|signal| signal.value.map(|value| (&signal.semaphore, value)))
    }

    /// The frame is not made, and its signals are not given: their values may be asked for again.
    pub fn withdraw(&self) {
        self.timelines().for_each(|(semaphore, value)| semaphore.withdraw(value));
    }
}
