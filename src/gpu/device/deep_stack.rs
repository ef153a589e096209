// SPDX-License-Identifier: MIT OR Apache-2.0
//! Stack for the compilers of Direct3D 12's kernels, DXC and FXC, which call themselves deeply: Windows' programs begin
//! with 1 MiB, and threads may have less. A pipeline is made on a thread of bhr's where the caller has little left.
//! (On Linux a whole call changes its stack: `on_enough_stack`.) Knows no kernel.

use super::wgpu_device::Device;
use super::{driver_lock, process_end};
use crate::error::{Error, Result};
use crate::platform::stack_left;
use crate::thread_scope;
use crate::thread_state::begin_own_thread;
use crate::tracer::Backend;
use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};
use std::thread;

/// A caller with so much left makes its pipelines itself: threads of bhr's have 2 MiB.
const ENOUGH: usize = 1 << 20;

impl Device {
    /// Does `work`, which makes a pipeline, where there is stack enough for the compiler, and waits for it. Errors:
    /// those of `work`.
    pub(in crate::gpu) fn with_deep_stack<T: Send>(&self, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
        // A thread that holds the lock would wait for one that waits for the lock.
        let moves = self.backend() == Backend::D3d12 && !driver_lock::is_held();
        on_thread_with_stack(stack_left().filter(|_| moves), work)
    }
}

/// Does `work` here where so much stack is enough, or is not known; else on a thread of its own, if the system has one.
fn on_thread_with_stack<T: Send>(left: Option<usize>, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    if left.is_none_or(|left| left >= ENOUGH) {
        return work();
    }
    // Where no thread begins, the work is still there.
    let work = Mutex::new(Some(work));
    let take = || work.lock().unwrap_or_else(PoisonError::into_inner).take();
    let scope = thread_scope::of_caller();
    let done = thread::scope(|threads| {
        let run = || {
            begin_own_thread();
            process_end::own_thread();
            let _scope = scope();
            take().map(|work| work())
        };
        let begun = thread::Builder::new().name("bhr-kernels".into()).spawn_scoped(threads, run);
        begun.ok().and_then(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)))
    });
    done.or_else(|| take().map(|work| work())).unwrap_or_else(|| Err(Error::internal("a kernel's thread did nothing")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use thread::current;

    #[test]
    fn a_caller_with_little_stack_has_its_pipelines_made_by_a_thread_of_bhrs() {
        let made_on = |left| on_thread_with_stack(left, || Ok((current().id(), current().name().map(String::from))));
        let here = current().id();
        for left in [None, Some(ENOUGH), Some(2 * ENOUGH)] {
            assert_eq!(made_on(left).unwrap().0, here, "{left:?}");
        }
        for left in [0, 256 << 10, ENOUGH - 1] {
            let (thread, name) = made_on(Some(left)).unwrap();
            assert!(thread != here && name.as_deref() == Some("bhr-kernels"), "{left}");
        }
        let mut lent = 1;
        let work = || {
            lent += 1;
            Ok(())
        };
        on_thread_with_stack(Some(0), work).unwrap();
        assert_eq!(lent, 2);
    }

    #[test]
    fn errors_and_panics_of_the_work_are_the_callers() {
        let fails = || Err::<(), _>(Error::unsupported("deliberate"));
        assert_eq!(on_thread_with_stack(Some(0), fails).unwrap_err().message, "deliberate");
        let panics = || resume_unwind(Box::new("deliberate"));
        let caught = catch_unwind(AssertUnwindSafe(|| on_thread_with_stack::<()>(Some(0), panics)));
        assert_eq!(caught.unwrap_err().downcast_ref(), Some(&"deliberate"));
    }
}
