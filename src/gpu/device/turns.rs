// SPDX-License-Identifier: MIT OR Apache-2.0
//! The turns with a queue: bhr's threads take them one at a time, and on a host's device they take the host's lock too.
//! And the semaphores that submissions use, and targets that they read, which are kept until those have run.

use super::external::QueueLock;
use super::semaphores::SemaphoreUse;
use super::target::GpuTarget;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The turns that threads take with a queue, and the semaphores and targets that are in use.
pub struct QueueTurns {
    turn: Mutex<()>,
    host: Option<Arc<QueueLock>>,
    in_use: Mutex<VecDeque<InUse>>,
}

/// The semaphores of a submission that may not have run, and the targets that it reads: the commands that take those
/// over, copy out of them and give them back are raw ones, of which wgpu knows nothing.
pub struct InUse {
    pub submission: wgpu::SubmissionIndex,
    pub waits: Vec<SemaphoreUse>,
    pub _signals: Vec<SemaphoreUse>,
    pub read: Vec<Arc<GpuTarget>>,
}

/// While it lives, no other thread touches the queue.
pub struct Turn<'a> {
    // The host's lock is released before bhr's.
    _host: Option<HostTurn<'a>>,
    _turn: MutexGuard<'a, ()>,
}

/// While it lives, the host's lock is held.
pub struct HostTurn<'a>(&'a QueueLock);

impl<'a> HostTurn<'a> {
    pub fn new(lock: &'a QueueLock) -> Self {
        (lock.lock)();
        Self(lock)
    }
}

impl Drop for HostTurn<'_> {
    fn drop(&mut self) {
        (self.0.unlock)();
    }
}

impl QueueTurns {
    pub fn new(host: Option<Arc<QueueLock>>) -> Self {
        Self { turn: Mutex::default(), host, in_use: Mutex::default() }
    }

    /// To be taken around every call that reaches the queue: submissions, presents, and what makes wgpu submit.
    pub fn take(&self) -> Turn<'_> {
        let turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        Turn { _host: self.host.as_deref().map(HostTurn::new), _turn: turn }
    }

    pub fn in_use(&self) -> MutexGuard<'_, VecDeque<InUse>> {
        self.in_use.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets go of all semaphores and targets: nothing is under way.
    pub fn settle(&self) {
        let all = std::mem::take(&mut *self.in_use());
        drop(all);
    }

    /// Keeps all semaphores and targets for ever: the work that uses them never ends.
    pub fn abandon(&self) {
        std::mem::forget(std::mem::take(&mut *self.in_use()));
    }
}
