// SPDX-License-Identifier: MIT OR Apache-2.0
//! Calls on a context: one at a time, with its log callback listening.

use super::entry::{Success, finish, refuse_at_the_end, refuse_in_callback};
use super::log::{self, Sink};
use super::message::LastMessage;
use super::panic::guarded;
use super::pointer::is_null;
use super::state::State;
use super::status::{BHR_OK, BhrStatus};
use crate::error::{Error, ErrorKind, Result};
use crate::thread_state::Call;
use parking_lot::{Mutex, MutexGuard};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A context, as calls on it need it: `BhrContext`, whose file uses this one.
pub(super) trait Locked {
    fn state(&self) -> &Mutex<State>;
    /// A call, or a job, failed internally.
    fn broken(&self) -> &AtomicBool;
    /// The message of the last call that failed.
    fn message(&self) -> &Arc<LastMessage>;
    /// The callback that hears the log of calls.
    fn log_sink(&self) -> Option<Arc<Sink>>;
}

/// A call on a context: refused inside callbacks, one at a time, with the context's log callback listening. `body`
/// gets what the lock protects. After a failure of kind `Internal`, a caught panic above all, the context refuses
/// everything but its end.
///
/// # Safety
/// `context` is NULL or came from `bhr_context_create` and is not destroyed.
pub(super) unsafe fn on_context<T: Success>(
    function: &str,
    context: *const impl Locked,
    body: impl FnOnce(&mut State) -> Result<T>,
) -> BhrStatus {
    let _call = Call::enter();
    // SAFETY: NULL or alive, by this function's contract.
    let context = unsafe { context.as_ref() };
    if let Err(error) = refuse_in_callback() {
        return keep(finish::<()>(function, Err(error)), context.map(|context| &**context.message()));
    }
    let Some(context) = context else {
        return finish::<()>(function, Err(is_null("context")));
    };
    let _scope = log::Scope::enter(context.log_sink());
    if let Err(error) = refuse_at_the_end() {
        return keep(finish::<()>(function, Err(error)), Some(context.message()));
    }
    let mut state = context.state().lock();
    let result = if context.broken().load(Ordering::Relaxed) {
        Err(Error::internal("this context failed internally before; only bhr_context_destroy is valid"))
    } else {
        guarded(|| body(&mut state))
    };
    break_if_internal(&result, context.broken());
    // bhr_context_destroy waits for the lock alone: after it the context may be gone.
    let message = context.message().clone();
    // Threads that wait for the lock go first: one that calls again and again would otherwise keep them out.
    MutexGuard::unlock_fair(state);
    keep(finish(function, result), Some(&message))
}

/// Keeps the message of a call that has just failed with the object it was on, too. Passes `status` on.
pub(super) fn keep(status: BhrStatus, message: Option<&LastMessage>) -> BhrStatus {
    if let Some(message) = message.filter(|_| status < BHR_OK) {
        message.keep_of_thread();
    }
    status
}

/// After a failure of kind `Internal` its context is not to be trusted.
pub(super) fn break_if_internal<T>(result: &Result<T>, broken: &AtomicBool) {
    if result.as_ref().is_err_and(|error| error.kind == ErrorKind::Internal) {
        broken.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capi::callback::InsideCallback;
    use crate::capi::context::BhrContext;
    use crate::capi::context::tests::cpu_context;
    use crate::capi::entry::{anywhere, outside_callbacks};
    use crate::capi::message::tests::message;
    use crate::capi::status::*;

    #[test]
    fn a_panic_becomes_internal_and_breaks_the_context() {
        let context = cpu_context();
        // SAFETY: the context lives.
        let call = |body: fn(&mut State) -> Result<()>| unsafe { on_context("bhr_test", context.get(), body) };
        assert_eq!(call(|_| Ok(())), BHR_OK);
        assert_eq!(call(|_| Err(Error::argument("harmless"))), BHR_ERROR_INVALID_ARGUMENT);
        assert_eq!(message(), "bhr_test: harmless");
        assert_eq!(call(|_| Ok(())), BHR_OK);
        assert_eq!(call(|_| panic!("deliberate")), BHR_ERROR_INTERNAL);
        assert!(message().contains("call.rs") && message().contains("deliberate"), "{}", message());
        assert_eq!(call(|_| Ok(())), BHR_ERROR_INTERNAL);
    }

    #[test]
    fn calls_inside_callbacks_are_refused() {
        let context = cpu_context();
        let inside = InsideCallback::progress();
        // SAFETY: the context lives.
        let status = unsafe { on_context("bhr_test", context.get(), |_| Ok(())) };
        assert_eq!(status, BHR_ERROR_INVALID_STATE);
        assert_eq!(outside_callbacks("bhr_test", || Ok(())), BHR_ERROR_INVALID_STATE);
        assert_eq!(anywhere("bhr_test", || Ok(())), BHR_OK);
        drop(inside);
        // SAFETY: the context lives.
        assert_eq!(unsafe { on_context("bhr_test", context.get(), |_| Ok(())) }, BHR_OK);
    }

    #[test]
    fn a_null_context_is_named() {
        // SAFETY: NULL is allowed.
        assert_eq!(
            unsafe { on_context("bhr_test", std::ptr::null::<BhrContext>(), |_| Ok(())) },
            BHR_ERROR_INVALID_ARGUMENT
        );
        assert_eq!(message(), "bhr_test: context is NULL");
    }
}
