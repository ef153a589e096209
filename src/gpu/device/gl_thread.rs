// SPDX-License-Identifier: MIT OR Apache-2.0
//! A thread for the calls into GL. wgpu makes its GL context current on whichever thread calls it, and leaves
//! none current there. On a thread of the host's that takes the host's own context away (EGL), or fails because the
//! host has one (GLX beside EGL: libglvnd), and then wgpu panics, in destructors too, where the second panic ends the
//! process. So whatever wgpu's GL is asked for, and whatever it made is dropped, happens here. Knows no scenes.
//!
//! On its own thread wgpu panics as well, when another library of the process terminates the EGL display. A panic that
//! unwinds from there drops what wgpu has made, which panics again. So where the process's panic hook is the library's
//! own (the C API's), it calls [`park`]: nothing unwinds, and the thread stands still for good.

use super::driver_lock;
use super::gl_guard::ContextGuard;
use super::process_end;
use crate::error::{Error, ErrorKind, Result, panic_text};
use crate::platform::{SYSTEM, System};
use crate::thread_scope;
use crate::thread_state::begin_own_thread;
use crate::tracer::Progress;
use parking_lot::Mutex;
use std::cell::RefCell;
use std::mem::transmute;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};

thread_local! {
    /// On a thread for GL that is at work: who waits for it, and how old the display was when the work began.
    static CALLER: RefCell<Option<(mpsc::Sender<Report>, DisplayAge)>> = const { RefCell::new(None) };
}

/// How often a thread for GL was parked by what had not parked another one before: the ends of the EGL display, as far
/// as this library can tell. All contexts of the process are on that display, and have gone with it when one has.
/// EGL's handles are addresses, so that a context that is opened later may have the handle of one that has gone, and
/// would be used, or destroyed, in its place: nothing from before is used any more. (Windows' contexts share nothing,
/// and are not counted.)
static ENDS: AtomicU64 = AtomicU64::new(0);

/// The time of an EGL display's life at which a context was opened.
#[derive(Clone, Copy)]
pub(in crate::gpu) struct DisplayAge(u64);

impl DisplayAge {
    pub fn now() -> Self {
        Self(ENDS.load(Ordering::SeqCst))
    }

    /// Notes an end of the display of this age, unless another thread has.
    fn end(self) {
        if SYSTEM != System::Windows {
            let _ = ENDS.compare_exchange(self.0, self.0 + 1, Ordering::SeqCst, Ordering::SeqCst);
        }
    }

    /// Whether the display has ended since, as far as a thread for GL has found.
    pub fn is_over(self) -> bool {
        self.0 != Self::now().0
    }
}

type Work<'a> = Box<dyn FnOnce() + Send + 'a>;

/// A message from a thread for GL to its caller.
enum Report {
    /// Its work has got so far, and goes on once it is told whether to.
    Progress(f64),
    /// Its work is done, and it no longer uses what it was lent.
    Done,
    /// The thread stands still for good, and will never again use what it was lent; why.
    Parked(String),
}

/// On a thread for GL that is at work: hands `text` to the caller that waits, and does not return. The thread and all
/// that it has are lost. On any other thread it does nothing. For panic hooks, which run before anything unwinds, and
/// for where a GL context turns out to be gone.
///
/// While it stands still in a hook, the standard library holds the lock of hooks for reading: other panics are as
/// ever, but setting another hook would wait for ever. So this is for a hook that is never replaced.
pub fn park(text: &str) {
    let caller = CALLER.try_with(|caller| caller.try_borrow_mut().ok()?.take()).ok().flatten();
    let Some((caller, age)) = caller else { return };
    age.end();
    driver_lock::abandon();
    process_end::abandon();
    let _ = caller.send(Report::Parked(text.to_owned()));
    loop {
        thread::park();
    }
}

/// A thread for the calls into one GL context. Ends with its last clone.
pub struct GlThread {
    /// Locked over each call. `None` once the thread is parked, and while this is being dropped.
    channel: Mutex<Option<mpsc::Sender<Work<'static>>>>,
    /// `None` only while it is being dropped.
    handle: Option<JoinHandle<()>>,
    /// Ends after the thread, when nothing uses the context's objects any more.
    guard: Mutex<Option<ContextGuard>>,
}

impl GlThread {
    /// Errors: OUT_OF_MEMORY when the system gives no thread.
    pub fn start() -> Result<Arc<Self>> {
        let (channel, work) = mpsc::channel::<Work<'static>>();
        let run = move || {
            begin_own_thread();
            process_end::own_thread();
            work.into_iter().for_each(|work| work());
        };
        let handle = thread::Builder::new().name("bhr-gl".into()).spawn(run);
        let handle =
            handle.map_err(|error| Error::new(ErrorKind::OutOfMemory, format!("no thread for GL: {error}")))?;
        Ok(Arc::new(Self { channel: Mutex::new(Some(channel)), handle: Some(handle), guard: Mutex::new(None) }))
    }

    /// Guards the objects of the adapter's context, which this thread is for, for as long as there is the thread.
    pub(super) fn guard_context(&self, adapter: &wgpu::Adapter) {
        *self.guard.lock() = ContextGuard::of(adapter);
    }

    /// Runs `work` on the thread and waits for it. Errors: INTERNAL when it panics; once the thread is parked,
    /// DEVICE_LOST, and `work` is leaked, as what it has of wgpu's may be dropped nowhere else.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T> {
        self.run_with_progress(|_| work(), &mut |_| true)
    }

    /// Runs `work` on the thread and waits for it, while `progress` runs on the caller's. Errors: as [`Self::run`].
    pub fn run_with_progress<T: Send>(
        &self,
        work: impl FnOnce(&mut Progress<'_>) -> T + Send,
        progress: &mut Progress<'_>,
    ) -> Result<T> {
        if self.handle.as_ref().is_some_and(|handle| handle.thread().id() == thread::current().id()) {
            // From inside a call.
            return Ok(work(progress));
        }
        let mut channel = self.channel.lock();
        let Some(sender) = channel.as_ref() else {
            std::mem::forget(work);
            return Err(Error::new(ErrorKind::DeviceLost, "the thread for GL has stopped"));
        };
        let scope = thread_scope::of_caller();
        let (tell, reports) = mpsc::channel();
        let (answer, answers) = mpsc::channel();
        let mut done = None;
        let slot = &mut done;
        let job = move || {
            CALLER.with(|caller| *caller.borrow_mut() = Some((tell.clone(), DisplayAge::now())));
            {
                let _scope = scope();
                let mut ask = |part: f64| tell.send(Report::Progress(part)).is_ok() && answers.recv().unwrap_or(false);
                // Unwind safe: `GlTracer` is not used again after a panic.
                *slot = Some(catch_unwind(AssertUnwindSafe(|| work(&mut ask))));
            }
            CALLER.with(|caller| caller.borrow_mut().take());
            // The last thing that it does: the rest has nothing that was lent.
            let _ = tell.send(Report::Done);
        };
        let job: Work<'_> = Box::new(job);
        // SAFETY: only the lifetime changes. What the work was lent outlives its use: from here on this function is
        // left, also by unwinding out of `progress`, only after `BorrowGuard` has seen that the work is done, that the
        // thread stands still, or that the work was never taken. Threads that the work starts for itself, and lends
        // something to in turn, it waits for before it asks wgpu for anything, which is what parks it.
        let job = unsafe { transmute::<Work<'_>, Work<'static>>(job) };
        if let Err(unsent) = sender.send(job) {
            std::mem::forget(unsent);
            return Err(Error::internal("the thread for GL has ended"));
        }
        let mut guard =
            BorrowGuard { channel: &mut channel, reports, answer: Some(answer), parked: None, ended: false };
        guard.wait(progress);
        let parked = guard.parked.take();
        drop(guard);
        if let Some(panic) = parked {
            return Err(Error::internal(format!("GL stopped: {panic}")));
        }
        match done {
            Some(Ok(done)) => Ok(done),
            Some(Err(panic)) => {
                let error = Error::internal(format!("GL panicked: {}", panic_text(&*panic)));
                // Dropping an unknown payload may panic again.
                std::mem::forget(panic);
                Err(error)
            }
            None => Err(Error::internal("the thread for GL did nothing")),
        }
    }
}

/// Until it is dropped, the thread may use what its caller lent it.
struct BorrowGuard<'a> {
    /// The way to the thread, which is given up when it is parked.
    channel: &'a mut Option<mpsc::Sender<Work<'static>>>,
    reports: mpsc::Receiver<Report>,
    /// `None` when the caller's progress function has panicked: the work is to stop.
    answer: Option<mpsc::Sender<bool>>,
    parked: Option<String>,
    ended: bool,
}

impl BorrowGuard<'_> {
    fn wait(&mut self, progress: &mut Progress<'_>) {
        while !self.ended {
            match self.reports.recv() {
                Ok(Report::Progress(part)) => {
                    if let Some(answer) = &self.answer {
                        let _ = answer.send(progress(part));
                    }
                }
                Ok(Report::Parked(panic)) => {
                    *self.channel = None;
                    self.parked = Some(panic);
                    self.ended = true;
                }
                // Nobody who could say more is left.
                Ok(Report::Done) | Err(mpsc::RecvError) => self.ended = true,
            }
        }
    }
}

impl Drop for BorrowGuard<'_> {
    fn drop(&mut self) {
        self.answer = None;
        self.wait(&mut |_| false);
    }
}

impl Drop for GlThread {
    fn drop(&mut self) {
        let parked = self.channel.get_mut().take().is_none();
        let Some(handle) = self.handle.take() else { return };
        // The thread ends by itself when it has nothing left to do.
        if !parked && handle.thread().id() != thread::current().id() {
            let _ = handle.join();
        }
    }
}

pub(in crate::gpu) const CONTEXT_GONE: &str =
    "its GL context is gone: the EGL display was terminated, or the driver failed";

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::resume_unwind;
    use std::sync::atomic::AtomicBool;
    use std::thread::current;
    use std::time::Duration;

    #[test]
    fn work_runs_on_one_thread_of_its_own_and_progress_here() {
        let thread = GlThread::start().unwrap();
        let name = || current().name().map(str::to_owned);
        assert_eq!(thread.run(name).unwrap().as_deref(), Some("bhr-gl"));
        let (here, there) = (current().id(), thread.run(|| current().id()).unwrap());
        let mut heard = Vec::new();
        let work = |progress: &mut Progress<'_>| (current().id(), progress(0.5), progress(0.75));
        let mut progress = |part: f64| {
            heard.push((current().id(), part));
            part < 0.6
        };
        assert_eq!(thread.run_with_progress(work, &mut progress).unwrap(), (there, true, false));
        assert_eq!(heard, [(here, 0.5), (here, 0.75)]);
        // Work that asks for more of it gets it at once: an adapter may go inside a call.
        assert_eq!(thread.run(|| thread.run(|| current().id())).unwrap().unwrap(), there);
    }

    /// Panics that unwind, as in a process whose panic hook is not the library's. (The hook does not see these.)
    #[test]
    fn a_panic_that_unwinds_is_an_error_and_the_thread_goes_on() {
        let thread = GlThread::start().unwrap();
        let error = thread.run(|| resume_unwind(Box::new("deliberate"))).map(|never: ()| never).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Internal);
        assert!(error.message.contains("deliberate"), "{error}");
        assert_eq!(thread.run(|| 7).unwrap(), 7);
    }

    #[test]
    fn work_has_stopped_when_a_progress_function_that_panics_unwinds() {
        let thread = GlThread::start().unwrap();
        let (mut answers, stopped) = (Vec::new(), AtomicBool::new(false));
        let work = |progress: &mut Progress<'_>| {
            answers.extend([progress(0.25), progress(0.5)]);
            thread::sleep(Duration::from_millis(20));
            stopped.store(true, Ordering::Relaxed);
        };
        let mut progress = |_| resume_unwind(Box::new("deliberate"));
        let unwound = catch_unwind(AssertUnwindSafe(|| thread.run_with_progress(work, &mut progress)));
        assert!(unwound.is_err() && stopped.load(Ordering::Relaxed));
        assert_eq!(answers, [false, false]);
        assert_eq!(thread.run(|| 7).unwrap(), 7);
    }

    #[test]
    fn the_thread_has_ended_when_its_last_clone_is_dropped() {
        struct SetOnDrop(Arc<AtomicBool>);
        impl Drop for SetOnDrop {
            fn drop(&mut self) {
                self.0.store(true, Ordering::Relaxed);
            }
        }
        thread_local!(static ENDING: RefCell<Option<SetOnDrop>> = const { RefCell::new(None) });
        let (thread, ended) = (GlThread::start().unwrap(), Arc::new(AtomicBool::new(false)));
        let clone = thread.clone();
        let ending = SetOnDrop(ended.clone());
        thread.run(|| ENDING.with(|place| *place.borrow_mut() = Some(ending))).unwrap();
        drop(thread);
        assert!(!ended.load(Ordering::Relaxed));
        drop(clone);
        assert!(ended.load(Ordering::Relaxed));
    }
}
