//! Tracing with GL, on a thread of its own. wgpu makes its GL context current on whichever thread calls it, and leaves
//! none current there. On a thread of the host's that takes the host's own context away (EGL), or fails because the
//! host has one (GLX beside EGL: libglvnd), and then wgpu panics, in destructors too, where the second panic ends the
//! process. So whatever wgpu's GL is asked for, and whatever it made is dropped, happens here. Knows no scenes.

use super::device::{Loss, panic_text};
use super::{Adapter, GpuTracer};
use crate::error::{Error, ErrorKind, Result};
use crate::renderer::{AdapterInfo, FrameRequest, FrameStats, Progress, TileSink};
use crate::scene::record::Record;
use crate::scene::{Hit, Ray, Scene};
use crate::thread_scope;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, mpsc};
use std::thread::JoinHandle;

/// A thread for the calls into one GL context. Ends with its last clone.
pub(super) struct GlThread {
    /// Of one thread. `None` only while it is being dropped.
    pool: Option<rayon::ThreadPool>,
    handle: Option<JoinHandle<()>>,
}

impl GlThread {
    /// Errors: OUT_OF_MEMORY when the system gives no thread.
    pub fn start() -> Result<Arc<Self>> {
        let mut handle = None;
        let spawn = |thread: rayon::ThreadBuilder| {
            handle = Some(std::thread::Builder::new().name("bhr-gl".into()).spawn(|| thread.run())?);
            Ok(())
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).spawn_handler(spawn).build();
        let pool = pool.map_err(|error| Error::new(ErrorKind::OutOfMemory, format!("no thread for GL: {error}")))?;
        Ok(Arc::new(Self { pool: Some(pool), handle }))
    }

    /// Runs `work` on the thread and waits for it. Errors: INTERNAL when it panics.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T> {
        self.run_beside(work, || {})
    }

    /// Runs `work` on the thread, `meanwhile` on this one, and waits for both. Errors: INTERNAL when `work` panics.
    fn run_beside<T: Send>(&self, work: impl FnOnce() -> T + Send, meanwhile: impl FnOnce()) -> Result<T> {
        let pool = self.pool.as_ref().ok_or_else(|| Error::internal("the thread for GL is ending"))?;
        let scope = thread_scope::of_caller();
        let mut done = None;
        pool.in_place_scope(|thread| {
            thread.spawn(|_| {
                let _scope = scope();
                // Unwind safe: `GlTracer` is not used again after a panic.
                done = Some(catch_unwind(AssertUnwindSafe(work)));
            });
            meanwhile();
        });
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

impl Drop for GlThread {
    fn drop(&mut self) {
        // It ends when it has nothing left to do.
        self.pool = None;
        if let Some(handle) = self.handle.take()
            && handle.thread().id() != std::thread::current().id()
        {
            let _ = handle.join();
        }
    }
}

/// A [`GpuTracer`] on a GL adapter, whose calls run on the adapter's thread. Any thread may call and drop it, whatever
/// GL context is current there.
pub struct GlTracer {
    info: AdapterInfo,
    loss: Loss,
    /// `None` only while it is being dropped.
    tracer: Option<GpuTracer>,
    thread: Arc<GlThread>,
}

impl GlTracer {
    /// Errors: as [`GpuTracer::new`]; NO_ADAPTER when the driver panics.
    pub fn open(adapter: Adapter) -> Result<Self> {
        let info = adapter.info.clone();
        let thread = adapter.gl_thread().ok_or_else(|| Error::internal("an adapter of GL without its thread"))?;
        let opened = thread.run(move || GpuTracer::new(adapter));
        let tracer = opened.map_err(|panic| Error::new(ErrorKind::NoAdapter, panic.message))??;
        Ok(Self { info, loss: tracer.device.loss(), tracer: Some(tracer), thread })
    }

    pub fn info(&self) -> &AdapterInfo {
        &self.info
    }

    /// What tells of the device's loss, also while the tracer is at work.
    pub fn loss(&self) -> &Loss {
        &self.loss
    }

    /// As [`GpuTracer::render`]; `progress` runs on this thread, `sink` on the other.
    pub fn render(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        self.call_with_progress(progress, |tracer, progress| tracer.render(scene, request, sink, progress))
    }

    /// As [`GpuTracer::prepare`]; `progress` runs on this thread.
    pub fn prepare(&mut self, scene: &Scene, request: &FrameRequest, progress: &mut Progress<'_>) -> Result<()> {
        self.call_with_progress(progress, |tracer, progress| tracer.prepare(scene, request, progress))
    }

    fn call_with_progress<T: Send>(
        &mut self,
        progress: &mut Progress<'_>,
        work: impl FnOnce(&mut GpuTracer, &mut Progress<'_>) -> Result<T> + Send,
    ) -> Result<T> {
        let (ask, asked) = mpsc::channel();
        let (answer, answered) = mpsc::channel();
        let work = move |tracer: &mut GpuTracer| {
            let mut progress = |fraction: f64| ask.send(fraction).is_ok() && answered.recv().unwrap_or(false);
            work(tracer, &mut progress)
        };
        self.call_beside(work, move || {
            // Ends when the work has ended, which drops the other end.
            for fraction in asked {
                let _ = answer.send(progress(fraction));
            }
        })
    }

    /// As [`GpuTracer::trace_rays`].
    pub fn trace_rays(&mut self, scene: &Scene, rays: &[Ray], hits: &mut [Hit]) -> Result<()> {
        self.call(|tracer| tracer.trace_rays(scene, rays, hits))
    }

    /// As [`GpuTracer::ray_records`].
    pub fn ray_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        self.call(|tracer| tracer.ray_records(scene, request))
    }

    /// Destroys the device, as a driver may at any time: for tests.
    pub fn lose_device(&mut self) -> Result<()> {
        self.call(|tracer| tracer.device.scoped("destroying the device", |raw| raw.destroy()))
    }

    fn call<T: Send>(&mut self, work: impl FnOnce(&mut GpuTracer) -> Result<T> + Send) -> Result<T> {
        self.call_beside(work, || {})
    }

    /// Errors: those of `work`; DEVICE_LOST when the GL context is gone.
    fn call_beside<T: Send>(
        &mut self,
        work: impl FnOnce(&mut GpuTracer) -> Result<T> + Send,
        meanwhile: impl FnOnce(),
    ) -> Result<T> {
        self.loss.check()?;
        let tracer = self.tracer.as_mut().ok_or_else(|| Error::internal("a tracer that is being dropped"))?;
        let checked = |tracer: &mut GpuTracer| {
            tracer.check_gl_context()?;
            work(tracer)
        };
        match self.thread.run_beside(|| checked(tracer), meanwhile) {
            Ok(done) => done,
            // wgpu panics where it cannot make its context current.
            Err(panic) => self.thread.run(|| tracer.check_gl_context())?.and(Err(panic)),
        }
    }
}

impl Drop for GlTracer {
    fn drop(&mut self) {
        let Some(tracer) = self.tracer.take() else { return };
        let end = move || match tracer.device.answers() {
            true => drop(tracer),
            false => {
                log::warn!("a GL device that cannot be closed stays behind: its context is gone");
                std::mem::forget(tracer);
            }
        };
        if let Err(error) = self.thread.run(end) {
            log::error!("closing the GL device: {error}");
        }
    }
}

impl GpuTracer {
    /// On the thread for GL. Errors: DEVICE_LOST when the context cannot be made current any more, in which case
    /// nothing of wgpu's may be asked or dropped.
    fn check_gl_context(&self) -> Result<()> {
        if !self.device.answers() {
            self.device.loss().lose("its GL context is gone: the EGL display was terminated, or the driver failed");
        }
        self.device.loss().check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::current;

    #[test]
    fn work_runs_on_one_thread_of_its_own_and_what_goes_beside_it_here() {
        let thread = GlThread::start().unwrap();
        let name = || current().name().map(str::to_owned);
        assert_eq!(thread.run(name).unwrap().as_deref(), Some("bhr-gl"));
        let (here, there) = (current().id(), thread.run(|| current().id()).unwrap());
        let mut beside = None;
        let again = thread.run_beside(|| current().id(), || beside = Some(current().id())).unwrap();
        assert_eq!((again, beside), (there, Some(here)));
        // Work that asks for more of it gets it at once: an adapter may go inside a call.
        assert_eq!(thread.run(|| thread.run(|| current().id())).unwrap().unwrap(), there);
    }

    #[test]
    fn a_panic_is_an_error_and_the_thread_goes_on() {
        let thread = GlThread::start().unwrap();
        let error = thread.run(|| panic!("deliberate")).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Internal);
        assert!(error.message.contains("deliberate"), "{error}");
        assert_eq!(thread.run(|| 7).unwrap(), 7);
        // The other way round nothing is left at work.
        let unwound = catch_unwind(AssertUnwindSafe(|| thread.run_beside(|| 7, || panic!("deliberate"))));
        assert!(unwound.is_err());
        assert_eq!(thread.run(|| 7).unwrap(), 7);
    }

    #[test]
    fn the_thread_has_ended_when_its_last_clone_is_dropped() {
        struct Ending(Arc<AtomicBool>);
        impl Drop for Ending {
            fn drop(&mut self) {
                self.0.store(true, Ordering::Relaxed);
            }
        }
        thread_local!(static ENDING: RefCell<Option<Ending>> = const { RefCell::new(None) });
        let (thread, ended) = (GlThread::start().unwrap(), Arc::new(AtomicBool::new(false)));
        let clone = thread.clone();
        let ending = Ending(ended.clone());
        thread.run(|| ENDING.with(|place| *place.borrow_mut() = Some(ending))).unwrap();
        drop(thread);
        assert!(!ended.load(Ordering::Relaxed));
        drop(clone);
        assert!(ended.load(Ordering::Relaxed));
    }
}
