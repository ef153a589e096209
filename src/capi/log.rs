// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrLogLevel, BhrLogFn, and the way from the `log` crate to the hosts' callbacks. The process-wide logger is
//! installed here, when the first context with a callback is made, and only if the process has none. Nothing is
//! ever printed. What comes up under a lock of the process is told when that is released (`deferred`).

use super::callback::{InsideCallback, in_log_callback};
use super::gate::Gate;
use crate::attempt;
use crate::deferred::{self, Outcome};
use crate::error::Result;
use crate::thread_scope::{self, ThreadScope};
use log::{Level, LevelFilter, Log, Metadata, Record};
use std::cell::{Cell, RefCell};
use std::ffi::{CStr, CString, c_char, c_void};
use std::mem::ManuallyDrop;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// How much a log callback is told: messages of this level and of the more severe ones.
pub type BhrLogLevel = i32;
/// No messages.
pub const BHR_LOG_OFF: BhrLogLevel = 0;
/// Every failed call, but for cancels, and errors of the graphics stack.
pub const BHR_LOG_ERROR: BhrLogLevel = 1;
/// Also trouble that failed no call, such as an adapter passed over. The default.
pub const BHR_LOG_WARN: BhrLogLevel = 2;
/// Also cancels, why an adapter was chosen, and errors of the graphics stack about others.
pub const BHR_LOG_INFO: BhrLogLevel = 3;
/// Also what the graphics stack (wgpu) reports about itself.
pub const BHR_LOG_DEBUG: BhrLogLevel = 4;
/// Everything: slow.
pub const BHR_LOG_TRACE: BhrLogLevel = 5;

/// Gets bhr's messages and those of the graphics stack under it, one per call, without a line end. message lives for
/// the call only. A message that arises inside a bhr_ call on a context goes to that context's callback, on
/// whichever thread the call runs, or on a thread of the library that works for that context; one from another
/// thread goes to every context's callback: it may therefore run on several threads at once. It may wait for other
/// threads' calls on other contexts, not for calls on its own.
pub type BhrLogFn = Option<unsafe extern "C" fn(user: *mut c_void, level: BhrLogLevel, message: *const c_char)>;

/// A non-null [`BhrLogFn`].
pub(super) type LogFn = unsafe extern "C" fn(*mut c_void, BhrLogLevel, *const c_char);

/// The host's `user` pointer: never read here, only handed back.
#[derive(Clone, Copy)]
pub(super) struct User(pub *mut c_void);

// SAFETY: bhr never looks behind the pointer; the header tells the host on which threads its callbacks run.
unsafe impl Send for User {}
// SAFETY: as above.
unsafe impl Sync for User {}

/// Errors: INVALID_ARGUMENT for a level that the header does not list.
pub(super) fn level_filter(level: BhrLogLevel) -> Result<LevelFilter> {
    Ok(match level {
        BHR_LOG_OFF => LevelFilter::Off,
        BHR_LOG_ERROR => LevelFilter::Error,
        BHR_LOG_WARN => LevelFilter::Warn,
        BHR_LOG_INFO => LevelFilter::Info,
        BHR_LOG_DEBUG => LevelFilter::Debug,
        BHR_LOG_TRACE => LevelFilter::Trace,
        _ => return super::pointer::unknown(level, "options log_level", "BHR_LOG_OFF (0) to BHR_LOG_TRACE (5)"),
    })
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic leaves nothing under these locks half done.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One context's log callback.
pub(super) struct Sink {
    level: LevelFilter,
    function: LogFn,
    user: User,
    gate: Gate,
}

impl Sink {
    fn deliver(&self, level: Level, message: &CStr) {
        if level > self.level {
            return;
        }
        let Some(_open) = self.gate.enter() else { return };
        // SAFETY: the host gave this function with this pointer, and the gate is open: the context still lives.
        let call = || unsafe { (self.function)(self.user.0, level as BhrLogLevel, message.as_ptr()) };
        InsideCallback::log().run(call);
    }
}

/// A [`Sink`] that the process-wide logger knows of; dropping it ends the callbacks.
pub(super) struct Registered(Arc<Sink>);

impl Registered {
    pub(super) fn new(level: LevelFilter, function: LogFn, user: *mut c_void) -> Self {
        let sink = Arc::new(Sink { level, function, user: User(user), gate: Gate::default() });
        change_sinks(|sinks| sinks.push(sink.clone()));
        Self(sink)
    }

    pub(super) fn sink(&self) -> Arc<Sink> {
        self.0.clone()
    }

    /// Ends the callbacks.
    pub(super) fn end(&self) {
        change_sinks(|sinks| sinks.retain(|sink| !Arc::ptr_eq(sink, &self.0)));
        self.0.gate.close();
    }
}

impl Drop for Registered {
    fn drop(&mut self) {
        self.end();
    }
}

static SINKS: Mutex<Vec<Arc<Sink>>> = Mutex::new(Vec::new());

fn change_sinks(change: impl FnOnce(&mut Vec<Arc<Sink>>)) {
    static OURS: OnceLock<bool> = OnceLock::new();
    let ours = *OURS.get_or_init(|| {
        thread_scope::install(scope_of_caller);
        ::log::set_logger(&HostLogger).is_ok()
    });
    let mut sinks = lock(&SINKS);
    change(&mut sinks);
    if ours {
        ::log::set_max_level(sinks.iter().map(|sink| sink.level).max().unwrap_or(LevelFilter::Off));
    }
}

thread_local! {
    /// The log callback of the call that this thread is in; `Some(None)` when its context has none. The value is not
    /// dropped with its thread, which has left every scope by then: a destructor would take memory in each thread.
    static CURRENT: RefCell<ManuallyDrop<Option<Option<Arc<Sink>>>>> = const { RefCell::new(ManuallyDrop::new(None)) };
    /// Messages that found no room to wait in, since the note about them was ordered.
    static OMITTED: Cell<u64> = const { Cell::new(0) };
}

/// While a `Scope` lives, this thread's messages go to one context's callback, if it has one, and to no other.
pub(super) struct Scope {
    before: Option<Option<Arc<Sink>>>,
}

impl Scope {
    pub(super) fn enter(sink: Option<Arc<Sink>>) -> Self {
        Self { before: change_current(Some(sink)) }
    }
}

impl Drop for Scope {
    fn drop(&mut self) {
        change_current(self.before.take());
    }
}

/// The scope that this thread is in, for a thread that works for it.
fn scope_of_caller() -> ThreadScope {
    let sink = CURRENT.try_with(|current| (*current.borrow()).clone()).ok();
    let sink = sink.and_then(ManuallyDrop::into_inner);
    Arc::new(move || Box::new(Scope { before: change_current(sink.clone()) }))
}

/// The callback that was in force before this scope began.
fn change_current(sink: Option<Option<Arc<Sink>>>) -> Option<Option<Arc<Sink>>> {
    // No thread-local left: the thread is ending, and nothing can be logged from it any more.
    let replaced = CURRENT.try_with(|current| current.replace(ManuallyDrop::new(sink)));
    replaced.map_or(None, ManuallyDrop::into_inner)
}

struct HostLogger;

impl Log for HostLogger {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() <= ::log::max_level() && !in_log_callback()
    }

    fn log(&self, record: &Record<'_>) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let level = host_level(record);
        let sinks = match CURRENT.try_with(|current| (**current.borrow()).clone()).unwrap_or(None) {
            Some(own) => own.into_iter().collect(),
            None => lock(&SINKS).clone(),
        };
        if sinks.iter().all(|sink| level > sink.level) {
            return;
        }
        let message = text(record);
        if tell(sinks.clone(), level, message) == Outcome::NoRoom {
            omit(sinks, level);
        }
    }

    fn flush(&self) {}
}

/// Tells `sinks` now, or when this thread holds no lock of the process any more.
fn tell(sinks: Vec<Arc<Sink>>, level: Level, message: CString) -> Outcome {
    let bytes = message.as_bytes().len() + size_of_val(sinks.as_slice()) + size_of::<CString>();
    deferred::run(bytes, move || {
        for sink in sinks {
            sink.deliver(level, &message);
        }
    })
}

/// A message for which there is no room: after those that had room, `sinks` hear how many were left out.
fn omit(sinks: Vec<Arc<Sink>>, level: Level) {
    if OMITTED.try_with(|omitted| omitted.replace(omitted.get() + 1)) != Ok(0) {
        return;
    }
    deferred::run(0, move || {
        let omitted = OMITTED.try_with(Cell::take).unwrap_or(0);
        let note = c_string(format!("{omitted} more messages of one call into the graphics stack were left out"));
        for sink in sinks {
            sink.deliver(level, &note);
        }
    });
}

fn is_own(record: &Record<'_>) -> bool {
    record.target() == "bhr" || record.target().starts_with("bhr::")
}

/// The graphics stack logs every buffer and pipeline as info. To a host that is detail, so its messages below warnings
/// count one level less. Errors of an attempt after which another follows are no more than the reason for that.
fn host_level(record: &Record<'_>) -> Level {
    match record.level() {
        Level::Error if !is_own(record) && attempt::is_under_way() => Level::Info,
        Level::Info if !is_own(record) => Level::Debug,
        Level::Debug if !is_own(record) => Level::Trace,
        level => level,
    }
}

fn text(record: &Record<'_>) -> CString {
    let text =
        if is_own(record) { record.args().to_string() } else { format!("{}: {}", record.target(), record.args()) };
    c_string(text)
}

/// `text` as a C string; a NUL inside becomes a space.
fn c_string(text: String) -> CString {
    CString::new(text).unwrap_or_else(|error| {
        let text = String::from_utf8_lossy(&error.into_vec()).replace('\0', " ");
        CString::new(text).unwrap_or_default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    type Heard = Mutex<Vec<(BhrLogLevel, String)>>;

    unsafe extern "C" fn hear(user: *mut c_void, level: BhrLogLevel, message: *const c_char) {
        // SAFETY: the tests pass a `Heard` that outlives the sink, and the logger a C string.
        let (heard, message) = unsafe { (&*user.cast::<Heard>(), CStr::from_ptr(message)) };
        heard.lock().unwrap().push((level, message.to_str().unwrap().to_owned()));
    }

    fn listen(heard: &Heard, level: LevelFilter) -> Registered {
        Registered::new(level, hear, (&raw const *heard).cast_mut().cast())
    }

    fn said(heard: &Heard, text: &str) -> Vec<BhrLogLevel> {
        heard.lock().unwrap().iter().filter(|(_, message)| message.contains(text)).map(|(level, _)| *level).collect()
    }

    #[test]
    fn messages_go_to_the_current_context_else_to_all() {
        let (one, two) = (Heard::default(), Heard::default());
        let first = listen(&one, LevelFilter::Debug);
        let second = listen(&two, LevelFilter::Warn);
        {
            let _scope = Scope::enter(Some(first.sink()));
            ::log::warn!("inside the first");
        }
        {
            let _scope = Scope::enter(None);
            ::log::warn!("inside a silent one");
        }
        ::log::warn!("from outside");
        ::log::info!("only detail");
        ::log::info!(target: "wgpu_core::device", "chatter");
        assert_eq!((said(&one, "inside the first").len(), said(&two, "inside the first").len()), (1, 0));
        assert_eq!((said(&one, "a silent one").len(), said(&two, "a silent one").len()), (0, 0));
        assert_eq!((said(&one, "from outside").len(), said(&two, "from outside").len()), (1, 1));
        assert_eq!((said(&one, "only detail"), said(&two, "only detail").len()), (vec![BHR_LOG_INFO], 0));
        assert_eq!(said(&one, "wgpu_core::device: chatter"), [BHR_LOG_DEBUG]);
        ::log::error!(target: "wgpu_hal", "in earnest");
        {
            let _attempt = attempt::begin();
            ::log::error!(target: "wgpu_hal", "as a try");
            ::log::error!("about a try");
        }
        ::log::error!(target: "wgpu_hal", "after the try");
        assert_eq!([said(&one, "in earnest"), said(&one, "after the try")], [[BHR_LOG_ERROR], [BHR_LOG_ERROR]]);
        assert_eq!([said(&one, "as a try"), said(&one, "about a try")], [[BHR_LOG_INFO], [BHR_LOG_ERROR]]);
        drop(first);
        ::log::warn!("after the first has gone");
        assert_eq!((said(&one, "has gone").len(), said(&two, "has gone").len()), (0, 1));
        drop(second);
    }

    #[test]
    fn what_is_logged_under_a_lock_of_the_process_is_heard_afterwards_up_to_a_bound() {
        let heard = Heard::default();
        let registered = listen(&heard, LevelFilter::Info);
        let scope = Scope::enter(Some(registered.sink()));
        let alone = crate::gpu::driver_lock::lock();
        ::log::warn!("under the lock");
        assert_eq!(said(&heard, "under the lock").len(), 0);
        drop(alone);
        assert_eq!(said(&heard, "under the lock"), [BHR_LOG_WARN]);
        let alone = crate::gpu::driver_lock::lock();
        for _ in 0..20 {
            ::log::info!("long {}", "!".repeat(1 << 20));
        }
        // Deferred messages stay with the callbacks that they were meant for, whatever the thread does next.
        drop(scope);
        drop(alone);
        assert_eq!(said(&heard, "long").len(), 15);
        assert_eq!(said(&heard, "5 more messages"), [BHR_LOG_INFO]);
        let _scope = Scope::enter(Some(registered.sink()));
        let alone = crate::gpu::driver_lock::lock();
        ::log::warn!("once more");
        drop(alone);
        assert_eq!((said(&heard, "once more").len(), said(&heard, "more messages").len()), (1, 1));
    }

    #[test]
    fn closing_waits_for_a_callback_that_runs() {
        unsafe extern "C" fn slow(user: *mut c_void, _: BhrLogLevel, message: *const c_char) {
            // SAFETY: as in `hear`.
            let (state, message) = unsafe { (&*user.cast::<Mutex<&str>>(), CStr::from_ptr(message)) };
            if message == c"slow" {
                *state.lock().unwrap() = "begun";
                std::thread::sleep(Duration::from_millis(100));
                *state.lock().unwrap() = "done";
            }
        }
        let state = Mutex::new("");
        let registered = Registered::new(LevelFilter::Error, slow, (&raw const state).cast_mut().cast());
        let sink = registered.sink();
        std::thread::scope(|scope| {
            scope.spawn(|| sink.deliver(Level::Error, c"slow"));
            // Another test's message may be the one that runs: this one's has to have begun.
            while *state.lock().unwrap() != "begun" {
                std::thread::yield_now();
            }
            drop(registered);
            assert_eq!(*state.lock().unwrap(), "done");
        });
        sink.deliver(Level::Error, c"slow");
        assert_eq!(sink.gate.running(), 0);
    }

    #[test]
    fn a_nul_inside_a_message_becomes_a_space() {
        assert_eq!(c_string("a\0b".into()).as_c_str(), c"a b");
    }
}
