// SPDX-License-Identifier: MIT OR Apache-2.0
//! The whole panic policy: a panic inside a call becomes an error of that call, and is not printed.

use super::callback::{CALLS, Depth, count};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu;
use crate::thread_state::on_enough_stack;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::{Mutex, Once, OnceLock, PoisonError};

/// Runs `body`, with as much stack as anything in bhr needs; a panic becomes an `Internal` error that says where.
/// Errors: those of `body`; OUT_OF_MEMORY where there is no memory for a stack, and `body` did not run.
pub(super) fn guarded<T>(body: impl FnOnce() -> Result<T>) -> Result<T> {
    // Without a message, for which there may be no memory either: `finish` says that none is left.
    let refused = |_| Err(Error::new(ErrorKind::OutOfMemory, String::new()));
    on_enough_stack(|| caught(body)).unwrap_or_else(refused)
}

/// [`guarded`] for work that must be done: where there is no memory for a stack, on what this one has left.
pub(super) fn guarded_always<T>(body: impl FnOnce() -> Result<T>) -> Result<T> {
    on_enough_stack(|| caught(body)).unwrap_or_else(|work| work())
}

fn caught<T>(body: impl FnOnce() -> Result<T>) -> Result<T> {
    static HOOK: Once = Once::new();
    if !std::thread::panicking() {
        HOOK.call_once(silence_panics);
    }
    let _call = Depth::enter(&CALLS);
    // This is unwind safe: whoever could see what the panic left half done is refused from then on.
    catch_unwind(AssertUnwindSafe(|| apart(body))).unwrap_or_else(|payload| {
        // Dropping an unknown payload may panic again.
        std::mem::forget(payload);
        let place = last_panic().take().unwrap_or_else(|| "an unknown place".into());
        Err(Error::internal(format!("a bug in bhr was caught: panic at {place}")))
    })
}

/// Keeps the compiler, which does not know that a `Call` changes how floating point rounds, from counting earlier.
#[inline(never)]
fn apart<T>(body: impl FnOnce() -> T) -> T {
    body()
}

static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

fn last_panic() -> std::sync::MutexGuard<'static, Option<String>> {
    LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner)
}

type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Sync + Send>;

/// The panic hook that was installed before this one.
static BEFORE: OnceLock<Hook> = OnceLock::new();

/// Rust's default hook prints. Panics inside a call, and on the tracers' threads (named "bhr.."), are noted
/// instead; any other panic in the process goes where it went before.
fn silence_panics() {
    // The closure does not capture the old hook: a closure that holds nothing takes no memory.
    BEFORE.get_or_init(std::panic::take_hook);
    std::panic::set_hook(Box::new(|info| {
        let ours = count(&CALLS) > 0 || std::thread::current().name().is_some_and(|name| name.starts_with("bhr"));
        match BEFORE.get() {
            Some(before) if !ours => before(info),
            _ => {
                let text = describe(info);
                // A thread for GL must not unwind: this call does not return there, and does nothing on other threads.
                gpu::park(&text);
                *last_panic() = Some(text);
            }
        }
    }));
}

fn describe(info: &PanicHookInfo<'_>) -> String {
    let payload = info.payload();
    let text = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    let place = info.location().map_or_else(|| "an unknown place".into(), ToString::to_string);
    format!("{place}: {}", text.unwrap_or("no message"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    /// Stands for an object of wgpu's that panics again when a panic unwinds through it.
    struct PanicsWhenDropped;

    impl Drop for PanicsWhenDropped {
        fn drop(&mut self) {
            panic!("a second panic");
        }
    }

    /// In a process of its own, which leaves the test harness out at its end: that replaces the hook, and would wait.
    #[test]
    fn a_panic_on_a_thread_for_gl_unwinds_nothing_and_releases_the_driver_lock() {
        const ALONE: &str = "BHR_TEST_ALONE";
        if std::env::var_os(ALONE).is_none() {
            let name = "capi::panic::tests::a_panic_on_a_thread_for_gl_unwinds_nothing_and_releases_the_driver_lock";
            let mut alone = std::process::Command::new(std::env::current_exe().unwrap());
            let ended = alone.args(["--exact", name, "--nocapture"]).env(ALONE, "1").output().unwrap();
            let said = String::from_utf8_lossy(&ended.stderr);
            assert!(ended.status.code() == Some(7), "{}: {said}", ended.status);
            return;
        }
        // Installs the hook.
        guarded(|| Ok(())).unwrap();
        let thread = gpu::GlThread::start().unwrap();
        let work = || {
            let _alone = gpu::driver_lock::lock();
            let _dropped = PanicsWhenDropped;
            panic!("deliberate");
        };
        let error = thread.run(work).map(|never: ()| never).unwrap_err();
        assert!(error.message.contains("panic.rs") && error.message.contains("deliberate"), "{error}");
        drop(gpu::driver_lock::lock());
        // The thread is asked in vain, and what it was to do is not dropped here; its owner does not wait for it.
        let dropped = PanicsWhenDropped;
        assert_eq!(thread.run(move || drop(dropped)).unwrap_err().kind, ErrorKind::DeviceLost);
        drop(thread);
        std::process::exit(7);
    }
}
