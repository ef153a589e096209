//! The shape of every entry point: refuse calls from inside callbacks, run one closure under the panic guard (with
//! a context: under its lock), and turn the result into a status, this thread's message and a log line. The whole
//! panic policy is here.

use super::context::{BhrContext, State};
use super::log;
use super::pointer::is_null;
use super::status::{self, BHR_OK, BhrStatus};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu;
use parking_lot::MutexGuard;
use std::cell::{Cell, RefCell};
use std::ffi::c_char;
use std::io::Write;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, OnceLock, PoisonError};
use std::thread::LocalKey;

/// The room for a message: two paths of the longest kind fit into it.
const MESSAGE_BYTES: usize = 10_000;

thread_local! {
    /// The message, which ends with a NUL. It is stored in place, so that saying that there is no memory needs none,
    /// and a pointer that a host kept too long shows a later message, not freed memory. (It needs no destructor either,
    /// which would take memory as well.)
    static MESSAGE: RefCell<[u8; MESSAGE_BYTES]> = const { RefCell::new([0; MESSAGE_BYTES]) };
    static CALLS: Cell<u32> = const { Cell::new(0) };
    static CALLBACKS: Cell<u32> = const { Cell::new(0) };
    static LOG_CALLBACKS: Cell<u32> = const { Cell::new(0) };
}

/// The value of a body that succeeds.
pub(super) trait Success {
    fn status(self) -> BhrStatus;
}

impl Success for () {
    fn status(self) -> BhrStatus {
        BHR_OK
    }
}

/// The status of a success, >= 0: with news, or without.
pub(super) struct News(pub BhrStatus);

impl Success for News {
    fn status(self) -> BhrStatus {
        self.0
    }
}

/// A call that touches nothing shared: allowed inside callbacks.
pub(super) fn anywhere(function: &str, body: impl FnOnce() -> Result<()>) -> BhrStatus {
    finish(function, guarded(body))
}

/// A call without a context that reaches drivers or shared state: refused inside callbacks.
pub(super) fn outside_callbacks<T: Success>(function: &str, body: impl FnOnce() -> Result<T>) -> BhrStatus {
    finish(function, refuse_in_callback().and_then(|()| guarded(body)))
}

/// A call on a context: refused inside callbacks, one at a time, with the context's log callback listening. `body`
/// gets what the lock protects. After a failure of kind `Internal`, a caught panic above all, the context refuses
/// everything but its end.
///
/// # Safety
/// `context` is NULL or came from `bhr_context_create` and is not destroyed.
pub(super) unsafe fn on_context<T: Success>(
    function: &str,
    context: *const BhrContext,
    body: impl FnOnce(&mut State) -> Result<T>,
) -> BhrStatus {
    if let Err(error) = refuse_in_callback() {
        return finish::<()>(function, Err(error));
    }
    // SAFETY: NULL or alive, by this function's contract.
    let Some(context) = (unsafe { context.as_ref() }) else {
        return finish::<()>(function, Err(is_null("context")));
    };
    let _scope = log::Scope::enter(context.sink());
    let mut state = context.state.lock();
    let result = if context.broken.load(Ordering::Relaxed) {
        Err(Error::internal("this context failed internally before; only bhr_context_destroy is valid"))
    } else {
        guarded(|| body(&mut state))
    };
    break_if_internal(&result, &context.broken);
    // Threads that wait for the lock go first: one that calls again and again would otherwise keep them out.
    MutexGuard::unlock_fair(state);
    finish(function, result)
}

/// After a failure of kind `Internal` its context is not to be trusted.
pub(super) fn break_if_internal<T>(result: &Result<T>, broken: &AtomicBool) {
    if result.as_ref().is_err_and(|error| error.kind == ErrorKind::Internal) {
        broken.store(true, Ordering::Relaxed);
    }
}

/// Runs `body`; a panic becomes an `Internal` error that says where.
pub(super) fn guarded<T>(body: impl FnOnce() -> Result<T>) -> Result<T> {
    static HOOK: Once = Once::new();
    if !std::thread::panicking() {
        HOOK.call_once(silence_panics);
    }
    let _call = Depth::enter(&CALLS);
    // This is unwind safe: whoever could see what the panic left half done is refused from then on.
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| {
        // Dropping an unknown payload may panic again.
        std::mem::forget(payload);
        let place = last_panic().take().unwrap_or_else(|| "an unknown place".into());
        Err(Error::internal(format!("a bug in bhr was caught: panic at {place}")))
    })
}

/// Keeps the message and logs it. The status of `result`.
pub(super) fn finish<T: Success>(function: &str, result: Result<T>) -> BhrStatus {
    let error = match result {
        Ok(success) => return success.status(),
        Err(error) => error,
    };
    // `allocate` leaves the message empty where there is no memory for one.
    let message = if error.message.is_empty() { "no memory is left" } else { &error.message };
    ::log::error!(target: "bhr", "{function}: {message}");
    keep_message(format_args!("{function}: {message}"));
    status::of(error.kind)
}

fn keep_message(message: std::fmt::Arguments<'_>) {
    // A thread that is ending has no place for a message any more.
    let _ = MESSAGE.try_with(|kept| {
        let mut kept = kept.borrow_mut();
        let mut rest = &mut kept[..MESSAGE_BYTES - 1];
        // The part that does not fit is left out.
        let _ = rest.write_fmt(message);
        let written = MESSAGE_BYTES - 1 - rest.len();
        let text = &mut kept[..written];
        text.iter_mut().filter(|byte| **byte == 0).for_each(|byte| *byte = b' ');
        // The message is not cut inside a character.
        let length = std::str::from_utf8(text).map_or_else(|cut| cut.valid_up_to(), str::len);
        kept[length] = 0;
    });
}

/// This thread's message; never NULL.
pub(super) fn last_message() -> *const c_char {
    MESSAGE.try_with(|kept| kept.as_ptr().cast_const().cast()).unwrap_or(c"".as_ptr())
}

fn refuse_in_callback() -> Result<()> {
    if in_callback() {
        return Err(Error::state("called from inside a log or progress callback; return from it first"));
    }
    Ok(())
}

pub(super) fn in_callback() -> bool {
    count(&CALLBACKS) > 0
}

pub(super) fn in_log_callback() -> bool {
    count(&LOG_CALLBACKS) > 0
}

fn count(counter: &'static LocalKey<Cell<u32>>) -> u32 {
    counter.try_with(Cell::get).unwrap_or(0)
}

/// Adds one to a counter of this thread for as long as it lives.
struct Depth(&'static LocalKey<Cell<u32>>);

impl Depth {
    fn enter(counter: &'static LocalKey<Cell<u32>>) -> Self {
        let _ = counter.try_with(|n| n.set(n.get() + 1));
        Self(counter)
    }
}

impl Drop for Depth {
    fn drop(&mut self) {
        let _ = self.0.try_with(|n| n.set(n.get().saturating_sub(1)));
    }
}

/// This thread is inside a callback of the host's for as long as this value lives.
pub(super) struct Callback {
    _any: Depth,
    _log: Option<Depth>,
}

impl Callback {
    pub(super) fn log() -> Self {
        Self { _any: Depth::enter(&CALLBACKS), _log: Some(Depth::enter(&LOG_CALLBACKS)) }
    }

    pub(super) fn progress() -> Self {
        Self { _any: Depth::enter(&CALLBACKS), _log: None }
    }
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
    use crate::capi::context::tests::cpu_context;
    use crate::capi::status::*;
    use std::ffi::CStr;

    fn message() -> String {
        // SAFETY: a C string of this thread's.
        unsafe { CStr::from_ptr(last_message()) }.to_str().unwrap().to_owned()
    }

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
        assert!(message().contains("entry.rs") && message().contains("deliberate"), "{}", message());
        assert_eq!(call(|_| Ok(())), BHR_ERROR_INTERNAL);
    }

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
            let name = "capi::entry::tests::a_panic_on_a_thread_for_gl_unwinds_nothing_and_releases_the_driver_lock";
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
        assert!(error.message.contains("entry.rs") && error.message.contains("deliberate"), "{error}");
        drop(gpu::driver_lock::lock());
        // It is asked in vain, and what it was to do is not dropped here; its owner does not wait for it.
        let dropped = PanicsWhenDropped;
        assert_eq!(thread.run(move || drop(dropped)).unwrap_err().kind, ErrorKind::DeviceLost);
        drop(thread);
        std::process::exit(7);
    }

    #[test]
    fn calls_inside_callbacks_are_refused() {
        let context = cpu_context();
        let inside = Callback::progress();
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
    fn a_message_stays_where_it_is() {
        keep_message(format_args!("first"));
        let place = last_message();
        for length in [0, 100, MESSAGE_BYTES - 1, MESSAGE_BYTES, 1_000_000] {
            keep_message(format_args!("{}", "\u{e9}".repeat(length / 2)));
            assert_eq!(last_message(), place);
            assert_eq!(message().len(), (length / 2 * 2).min(MESSAGE_BYTES - 2));
        }
    }

    #[test]
    fn a_null_context_is_named() {
        // SAFETY: NULL is allowed.
        assert_eq!(unsafe { on_context("bhr_test", std::ptr::null(), |_| Ok(())) }, BHR_ERROR_INVALID_ARGUMENT);
        assert_eq!(message(), "bhr_test: context is NULL");
    }
}
