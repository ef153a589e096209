// SPDX-License-Identifier: MIT OR Apache-2.0
//! One wgpu device: opened with the least it needs, and with every way it can fail turned into an [`Error`]. All calls
//! into wgpu that can fail go through [`Device::scoped`], [`Device::submit`] or [`Device::wait`]. Knows nothing of
//! scenes.

use super::adapter::{Adapter, device_descriptor};
use super::gl_thread::{CONTEXT_GONE, DisplayAge, park};
use super::hlsl_compiler::HlslCompiler;
use super::turns::{HostTurn, QueueTurns};
use super::vulkan::parts::{self, VulkanParts};
use super::vulkan_host;
use super::{driver_lock, process_end, refusals};
use crate::deferred::hold;
use crate::error::{Error, ErrorKind, Result, panic_text};
use crate::platform::Instant;
use crate::tracer::Backend;
use std::future::poll_fn;
use std::mem::ManuallyDrop;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Poll, Waker};
use std::time::Duration;

/// A submission that takes longer than this has hung. Drivers give up after 2 to 10 s; a debugger or a busy software
/// driver may need more.
const HANG_AFTER: Duration = Duration::from_secs(60);

/// `HANG_AFTER` in milliseconds, which tests make shorter.
static HANGS_AFTER: AtomicU64 = AtomicU64::new(HANG_AFTER.as_millis() as u64);

pub(super) fn hangs_after() -> Duration {
    Duration::from_millis(HANGS_AFTER.load(Ordering::Relaxed))
}

/// For tests: from now on a submission that takes longer than this has hung.
#[doc(hidden)]
pub fn set_hangs_after(time: Duration) {
    HANGS_AFTER.store(time.as_millis() as u64, Ordering::Relaxed);
}

/// How long to wait in one piece before looking whether the device was lost meanwhile.
const WAIT_SLICE: Duration = Duration::from_secs(1);

/// How wgpu 30 panics in a wait whose time is over, if the submission ends just then and another thread tends to it
/// first: it asserts by an older look at the fence (gfx-rs/wgpu, pull request 9958, which mends it). All submissions
/// have run then, and the other thread has called back whom they concern.
const QUEUE_EMPTIED: &str = "If the queue is empty, the current submission index";

/// An open device with its queue. One thread at a time should use it; its buffers and pipelines may outlive it, but
/// then the driver's device ends with the last of them, outside [`driver_lock`]: who keeps them keeps the device too,
/// and lets it go last.
pub struct Device {
    /// Until it is being dropped.
    raw: ManuallyDrop<wgpu::Device>,
    /// `None` only while it is being dropped.
    queue: Option<wgpu::Queue>,
    backend: Backend,
    /// The compiler of Direct3D 12's kernels; `None` for other interfaces.
    hlsl: Option<HlslCompiler>,
    /// How old the EGL display was when an adapter of GL was found; `None` for other interfaces.
    gl_age: Option<DisplayAge>,
    /// Whether a pipeline was made.
    compiled: AtomicBool,
    limits: wgpu::Limits,
    health: Arc<Health>,
    bytes: Arc<AtomicU64>,
    pub(in crate::gpu) shaders: super::specialise::Shaders,
    pub(in crate::gpu) bindings: Arc<super::bindings::BindGroupCache>,
    pub(in crate::gpu) uploads: Uploads,
    /// The failures that tests ask for.
    pub faults: super::faults::Faults,
    /// The turns that threads take with the queue.
    pub(in crate::gpu) turns: QueueTurns,
    /// Whether the device is a host's own.
    is_hosts: bool,
    pub(in crate::gpu) vulkan: Option<Arc<VulkanParts>>,
}

/// Opens the adapter's device, or takes the host's. Errors: a text.
fn opened(
    adapter: &Adapter,
    raw: &wgpu::Adapter,
    descriptor: &wgpu::DeviceDescriptor<'_>,
) -> Result<(wgpu::Device, wgpu::Queue), String> {
    if let Some(host) = adapter.host() {
        let _turn = host.lock.as_deref().map(HostTurn::new);
        return vulkan_host::open(raw, host, descriptor);
    } else if adapter.info.backend == Backend::Vulkan
        && let Some(opened) = parts::open(raw, descriptor)
    {
        return opened;
    }
    pollster::block_on(raw.request_device(descriptor)).map_err(|error| error.to_string())
}

/// Commands that fill buffers and textures, and go before those of the next submission.
#[derive(Default)]
pub(in crate::gpu) struct Uploads {
    pub(in crate::gpu) commands: Mutex<Option<wgpu::CommandEncoder>>,
    /// How many submissions failed that uploads went before.
    lost: AtomicU64,
}

impl Uploads {
    /// Takes the commands that are to be submitted first.
    pub fn take(&self) -> Option<wgpu::CommandEncoder> {
        self.commands.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// A number that changes when a submission fails and what was written for it is lost: whoever writes something
    /// once writes it again when the number is another.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    /// A submission failed that uploads went before.
    pub(super) fn lose(&self) {
        self.lost.fetch_add(1, Ordering::Relaxed);
    }
}

/// The state of a device as wgpu's callbacks, which come from any thread, tell it.
#[derive(Default)]
struct Health {
    lost: Mutex<Option<String>>,
    /// The first error that came outside every scope and that no call has returned yet.
    stray: Mutex<Option<Error>>,
    /// Tasks that await the loss.
    waiting: Mutex<Vec<Waker>>,
    hung: AtomicBool,
}

impl Device {
    /// Opens a device with timestamps, mappable storage buffers and BC textures if the adapter has them, and the device
    /// is not the host's, and no other feature.
    ///
    /// A GL device is for threads without a GL context: wgpu leaves none current on the thread of a call, and where
    /// another interface's is current (GLX beside EGL) it panics, when the device is dropped too. `GlTracer`
    /// keeps one on a thread of its own.
    ///
    /// Errors: `OutOfMemory`, or `NoAdapter` with the driver's reason, also when the driver panics.
    pub fn open(adapter: &Adapter) -> Result<Self> {
        let raw = adapter.raw()?;
        let descriptor = device_descriptor(raw, adapter.host().is_some());
        let limits = descriptor.required_limits.clone();
        let driver = driver_lock::lock();
        let opened = catch_unwind(AssertUnwindSafe(|| opened(adapter, raw, &descriptor)));
        drop(driver);
        let refused = |why: &dyn std::fmt::Display| {
            Error::new(ErrorKind::NoAdapter, format!("{} gives no device: {why}", adapter.info.name))
        };
        let opened = opened.map_err(|panic| refused(&panic_text(&*panic)))?.map_err(|error| refused(&error))?;
        Ok(Self::of(adapter, limits, opened))
    }

    /// A device that was opened on an adapter, with these limits.
    pub(in crate::gpu) fn of(
        adapter: &Adapter,
        limits: wgpu::Limits,
        (raw, queue): (wgpu::Device, wgpu::Queue),
    ) -> Self {
        let health = Arc::new(Health::default());
        let of_errors = health.clone();
        raw.on_uncaptured_error(Arc::new(move |error| of_errors.stray(error)));
        let of_loss = health.clone();
        raw.set_device_lost_callback(move |reason, message| of_loss.lose(&format!("{reason:?} {message}")));
        let vulkan = VulkanParts::of(&raw).map(Arc::new);
        Self {
            vulkan,
            turns: QueueTurns::new(adapter.host().and_then(|host| host.lock.clone())),
            is_hosts: adapter.host().is_some(),
            raw: ManuallyDrop::new(raw),
            queue: Some(queue),
            backend: adapter.info.backend,
            hlsl: adapter.hlsl().cloned(),
            gl_age: adapter.gl_age(),
            compiled: AtomicBool::new(false),
            limits,
            health,
            bytes: Arc::default(),
            shaders: Default::default(),
            bindings: Default::default(),
            uploads: Default::default(),
            faults: Default::default(),
        }
    }

    /// Tells of the device's loss without asking wgpu for anything.
    pub fn loss(&self) -> Loss {
        Loss(self.health.clone())
    }

    /// On the thread of a GL device: whether its context can still be made current. Where it cannot, wgpu panics in
    /// every call, and in every drop of what it made.
    pub(in crate::gpu) fn answers(&self) -> bool {
        catch_unwind(AssertUnwindSafe(|| self.raw.poll(wgpu::PollType::Poll))).is_ok()
    }

    /// The limits the device was opened with.
    pub fn limits(&self) -> &wgpu::Limits {
        &self.limits
    }

    pub(in crate::gpu) fn backend(&self) -> Backend {
        self.backend
    }

    /// Whether its pipelines, and those of all devices like it, are made one at a time, whoever asks for them.
    pub(in crate::gpu) fn compiles_alone(&self) -> bool {
        self.hlsl.as_ref().is_some_and(HlslCompiler::works_alone)
    }

    /// Whether the device is a host's own.
    pub fn is_hosts(&self) -> bool {
        self.is_hosts
    }

    /// Whether the device can time its passes.
    pub fn has_timestamps(&self) -> bool {
        self.raw.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Whether kernels can write buffers that the host maps.
    pub fn maps_storage(&self) -> bool {
        self.raw.features().contains(wgpu::Features::MAPPABLE_PRIMARY_BUFFERS)
    }

    /// Whether textures may be in blocks of BC6H. Not by OpenGL, to which wgpu hands rows of blocks as long as uploads
    /// have them, with their padding, and which takes only those without.
    pub fn has_blocks(&self) -> bool {
        self.backend != Backend::Gl && self.raw.features().contains(wgpu::Features::TEXTURE_COMPRESSION_BC)
    }

    /// Nanoseconds per tick of a timestamp.
    pub(in crate::gpu) fn timestamp_period(&self) -> f64 {
        self.queue.as_ref().map_or(0.0, |queue| f64::from(queue.get_timestamp_period()))
    }

    /// Bytes of the buffers that exist.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    pub(in crate::gpu) fn byte_count(&self) -> Arc<AtomicU64> {
        self.bytes.clone()
    }

    /// Errors: `DeviceLost` once the device is gone; an error that came outside every other call.
    pub fn check(&self) -> Result<()> {
        self.check_known_loss()?;
        let stray = lock(&self.health.stray).take();
        stray.map_or(Ok(()), |error| Err(self.explain(error)))
    }

    fn check_known_loss(&self) -> Result<()> {
        self.leave_what_is_gone();
        self.health.check()
    }

    /// Where the EGL display has ended, on the thread for GL, this does not return: nothing may be dropped on the way
    /// out.
    fn leave_what_is_gone(&self) {
        if self.gl_age.is_some_and(DisplayAge::is_over) {
            self.health.lose(CONTEXT_GONE);
            park(CONTEXT_GONE);
        }
    }

    /// After a failure, whose cause may be a loss that was not told yet: wgpu tells it once all that was submitted has
    /// ended, and the poll of another thread may be about to. Submits nothing, as another thread may be making a
    /// window's images (`Swapchain::configure`). Errors: `DeviceLost`.
    pub(in crate::gpu) fn check_loss_anew(&self) -> Result<()> {
        self.check_known_loss()?;
        let all = wgpu::PollType::Wait { submission_index: None, timeout: Some(WAIT_SLICE) };
        let _ = self.poll(all)?;
        self.check_known_loss()?;
        if !self.refuses()? {
            self.learn_loss()?;
        }
        self.check_known_loss()
    }

    /// Whether the device refuses what cannot be.
    fn refuses(&self) -> Result<bool> {
        self.catching_panics(|| refusals::are_told(&self.raw))
    }

    /// Runs `work`, which may ask wgpu for anything but waiting, and returns what wgpu had against it. `what` begins
    /// the message.
    ///
    /// Errors: `DeviceLost`; `OutOfMemory`; `Internal` for whatever wgpu's validation or the driver rejects.
    pub fn scoped<T>(&self, what: &str, work: impl FnOnce(&wgpu::Device) -> T) -> Result<T> {
        self.check()?;
        self.faults.check(what)?;
        match self.in_error_scopes(work) {
            (_, Some(error)) => Err(self.explain(from_wgpu(what, &error))),
            (done, None) => self.check().map(|()| done),
        }
    }

    /// [`Self::scoped`] for threads beside the one that uses the device: leaves the errors that come outside every
    /// call to that one, and does not ask the device anew whether it is lost.
    pub(in crate::gpu) fn scoped_off_thread<T>(&self, what: &str, work: impl FnOnce(&wgpu::Device) -> T) -> Result<T> {
        self.check_known_loss()?;
        match self.in_error_scopes(work) {
            (_, Some(error)) => Err(from_wgpu(what, &error)),
            (done, None) => Ok(done),
        }
    }

    /// Runs `work`, and what wgpu had against it.
    fn in_error_scopes<T>(&self, work: impl FnOnce(&wgpu::Device) -> T) -> (T, Option<wgpu::Error>) {
        driver_lock::guard();
        let _holding = hold();
        let _inside = process_end::enter();
        refusals::of(&self.raw, work)
    }

    /// [`Self::scoped`] for calls about windows, some of which panic. What goes wrong in them is `SurfaceLost`, if the
    /// device is not gone: not the device's fault, but the window's.
    pub(in crate::gpu) fn guarded<T>(&self, what: &str, work: impl FnOnce(&wgpu::Device) -> T) -> Result<T> {
        let done = self.scoped(what, |device| catch_unwind(AssertUnwindSafe(|| work(device))));
        let message = match done {
            Ok(Ok(done)) => return Ok(done),
            Ok(Err(panic)) => format!("{what}: {}", panic_text(&*panic)),
            Err(error) if error.kind == ErrorKind::Internal => error.message,
            Err(error) => return Err(error),
        };
        Err(self.explain(Error::new(ErrorKind::SurfaceLost, message)))
    }

    /// A group of `layout` with `resources` in the order of its bindings: the one made before, if it is still kept.
    /// Errors: as [`Device::scoped`].
    pub(in crate::gpu) fn bind(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> Result<wgpu::BindGroup> {
        if let Some(group) = self.bindings.find(layout, resources) {
            return Ok(group);
        }
        let entries = resources
            .iter()
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect::<Vec<_>>();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        let group = self.scoped("binding buffers", |d| d.create_bind_group(&descriptor))?;
        self.bindings.keep(layout, resources, &group);
        Ok(group)
    }

    /// Begins recording. Mistakes in what is recorded are reported by [`Self::submit`].
    pub fn encoder(&self, label: &str) -> Result<wgpu::CommandEncoder> {
        self.scoped(label, |device| {
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
        })
    }

    /// Starts what was written since the last submission, and then what `encoder` has recorded. Errors: as
    /// [`Self::scoped`].
    pub fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<wgpu::SubmissionIndex> {
        self.submit_handed([encoder], &[], &[])
    }

    /// Waits until `submission` has run and the callbacks of its buffers were called.
    ///
    /// Errors: `DeviceLost`, also when the device hangs for 60 s.
    pub fn wait(&self, submission: &wgpu::SubmissionIndex) -> Result<()> {
        self.faults.check("waiting for work")?;
        let deadline = Instant::now() + hangs_after();
        loop {
            let wait = wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: Some(WAIT_SLICE) };
            match self.poll(wait)? {
                Ok(_) => return self.check(),
                Err(wgpu::PollError::WrongSubmissionIndex(..)) => {
                    self.learn_loss()?;
                }
                Err(wgpu::PollError::Timeout) if Instant::now() >= deadline => {
                    self.lose_hung();
                }
                Err(wgpu::PollError::Timeout) => {}
            }
            self.check()?;
        }
    }

    /// A submission takes too long: the device is lost, and nobody waits for it any more.
    pub(super) fn lose_hung(&self) {
        self.health.hung.store(true, Ordering::Relaxed);
        self.health.lose(&format!("it did not finish within {} s", hangs_after().as_secs()));
    }

    /// After a submission was dropped silently, which wgpu does only when its device is gone. Errors: `DeviceLost` if
    /// the driver panics.
    fn learn_loss(&self) -> Result<()> {
        // Calls the callback that tells why.
        let _ = self.poll(wgpu::PollType::Poll)?;
        self.health.lose("it no longer takes work");
        Ok(())
    }

    /// An error that may come from the device's loss: the loss, if so.
    pub(in crate::gpu) fn explain(&self, error: Error) -> Error {
        self.check_loss_anew().err().unwrap_or(error)
    }

    /// Whether `submission` has run. Errors: `DeviceLost`.
    pub fn is_done(&self, submission: &wgpu::SubmissionIndex) -> Result<bool> {
        let look = wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: Some(Duration::ZERO) };
        let looked = self.poll(look)?;
        if let Err(wgpu::PollError::WrongSubmissionIndex(..)) = looked {
            self.learn_loss()?;
        }
        self.check()?;
        Ok(looked.is_ok())
    }

    /// [`Self::submit`], then [`Self::wait`].
    pub fn submit_and_wait(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        let submission = self.submit(encoder)?;
        self.wait(&submission)
    }

    /// Errors: `DeviceLost`.
    fn poll(&self, how: wgpu::PollType) -> Result<Result<wgpu::PollStatus, wgpu::PollError>> {
        self.catching_panics(|| match catch_unwind(AssertUnwindSafe(|| self.raw.poll(how))) {
            Err(panic) if panic_text(&*panic).starts_with(QUEUE_EMPTIED) => Ok(wgpu::PollStatus::QueueEmpty),
            Err(panic) => resume_unwind(panic),
            Ok(polled) => polled,
        })
    }

    /// wgpu panics in some calls when the driver reports that the device is lost. Errors: `DeviceLost`.
    fn catching_panics<T>(&self, call: impl FnOnce() -> T) -> Result<T> {
        self.leave_what_is_gone();
        driver_lock::guard();
        let _holding = hold();
        let _inside = process_end::enter();
        catch_unwind(AssertUnwindSafe(call)).map_err(|panic| {
            self.health.lose(panic_text(&*panic));
            lost(panic_text(&*panic))
        })
    }

    pub(in crate::gpu) fn queue(&self) -> Result<&wgpu::Queue> {
        self.queue.as_ref().ok_or_else(|| Error::internal("the device is being closed"))
    }
}

impl Device {
    /// Makes a pipeline: the first one of a device while no other thread starts or ends a driver, and each where the
    /// compiler has none to make for another thread.
    pub(in crate::gpu) fn compiling<T>(&self, compile: impl FnOnce() -> T) -> T {
        let first = || !self.compiled.load(Ordering::Acquire);
        // Threads that waited for the first pipeline make theirs side by side.
        let driver = first().then(driver_lock::lock).filter(|_| first());
        let turn = self.hlsl.as_ref().and_then(HlslCompiler::turn);
        let made = compile();
        drop(turn);
        self.compiled.store(true, Ordering::Release);
        if driver.is_some() {
            // By now the driver has loaded what it makes pipelines with.
            process_end::watch();
        }
        drop(driver);
        made
    }

    /// Waits until nothing runs on it any more, so that dropping it does not, or until that is known to be in vain.
    fn drain(&self) {
        let deadline = Instant::now() + hangs_after();
        let all = || self.poll(wgpu::PollType::Wait { submission_index: None, timeout: Some(WAIT_SLICE) });
        while !self.health.hung.load(Ordering::Relaxed) && matches!(all(), Ok(Err(wgpu::PollError::Timeout))) {
            self.health.hung.store(Instant::now() >= deadline, Ordering::Relaxed);
        }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        self.drain();
        let queue = self.queue.take();
        let driver = driver_lock::lock();
        let close = || {
            self.bindings.clear();
            drop(self.uploads.take());
            if self.health.hung.load(Ordering::Relaxed) {
                // Dropping it would wait for the work that never ends, which uses its semaphores.
                std::mem::forget(queue);
                self.turns.abandon();
            } else {
                self.turns.settle();
                let _turn = self.turns.take();
                drop(queue);
            }
            // SAFETY: it is taken here alone, once, and not used any more.
            drop(unsafe { ManuallyDrop::take(&mut self.raw) });
        };
        if catch_unwind(AssertUnwindSafe(close)).is_err() {
            log::error!("closing the GPU device panicked");
        }
        drop(driver);
    }
}

/// Whether a device is lost, as far as is known: for any thread, also after the device's end.
#[derive(Clone)]
pub struct Loss(Arc<Health>);

impl Loss {
    /// Errors: `DeviceLost`.
    pub fn check(&self) -> Result<()> {
        self.0.check()
    }

    /// The error, once the device is lost.
    pub async fn told(self) -> Error {
        poll_fn(|context| match self.check() {
            Err(error) => Poll::Ready(error),
            Ok(()) => {
                lock(&self.0.waiting).push(context.waker().clone());
                Poll::Pending
            }
        })
        .await
    }

    pub(in crate::gpu) fn lose(&self, reason: &str) {
        self.0.lose(reason);
    }
}

impl Health {
    fn check(&self) -> Result<()> {
        lock(&self.lost).as_deref().map_or(Ok(()), |reason| Err(lost(reason)))
    }

    /// Keeps the first reason.
    fn lose(&self, reason: &str) {
        let mut lost = lock(&self.lost);
        let first = lost.is_none();
        lost.get_or_insert_with(|| reason.trim().to_owned());
        drop(lost);
        for one in std::mem::take(&mut *lock(&self.waiting)) {
            one.wake();
        }
        if first {
            log::debug!("GPU device lost: {reason}");
        }
    }

    fn stray(&self, error: wgpu::Error) {
        let error = from_wgpu("the GPU device reports", &error);
        log::error!("{error}");
        lock(&self.stray).get_or_insert(error);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn lost(reason: &str) -> Error {
    Error::new(ErrorKind::DeviceLost, format!("the GPU device was lost: {reason}"))
}

fn from_wgpu(what: &str, error: &wgpu::Error) -> Error {
    let kind = match error {
        wgpu::Error::OutOfMemory { .. } => ErrorKind::OutOfMemory,
        wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => ErrorKind::Internal,
    };
    Error::new(kind, format!("{what}: {error}"))
}
