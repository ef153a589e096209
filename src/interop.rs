// SPDX-License-Identifier: MIT OR Apache-2.0
//! Targets and semaphores of one renderer, as hosts hold them: each belongs to a device and ends with it. Knows no
//! frames and nothing of C.

use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{
    self, Device, FrameSync, GpuSemaphore, GpuTarget, SemaphoreKind, SemaphoreOrigin, SemaphoreUse, TargetOrigin,
    TargetShape,
};
use parking_lot::RwLock;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Waiting for a semaphore goes in pieces of this, between which it may end.
const WAIT_SLICE: Duration = Duration::from_millis(20);

/// A thing and its device, which goes after it.
type Kept<T> = (Arc<T>, Arc<Device>);

/// Something that a device has, until it ends.
struct OnDevice<T> {
    /// `Err`: why it ended.
    inner: RwLock<Result<Kept<T>, &'static str>>,
    name: &'static str,
}

impl<T> OnDevice<T> {
    fn new(name: &'static str, thing: T, device: Arc<Device>) -> Self {
        Self { inner: RwLock::new(Ok((Arc::new(thing), device))), name }
    }

    /// Runs `work` while it cannot end. Errors: those of `work`; SURFACE_LOST.
    fn with<R>(&self, work: impl FnOnce(&Arc<T>, &Arc<Device>) -> Result<R>) -> Result<R> {
        match &*self.inner.read() {
            Ok((thing, device)) => work(thing, device),
            Err(reason) => Err(Error::new(ErrorKind::SurfaceLost, format!("the {} was lost: {reason}", self.name))),
        }
    }

    fn end(&self, reason: &'static str) {
        let ended = {
            let mut inner = self.inner.write();
            match &*inner {
                Ok(_) => std::mem::replace(&mut *inner, Err(reason)),
                Err(_) => return,
            }
        };
        if let Ok((thing, device)) = ended {
            drop(thing);
            device.forget_reads();
            drop(device);
        }
    }
}

/// A picture on the GPU that both sides reach.
pub struct Target {
    on: OnDevice<GpuTarget>,
    pub transparent: bool,
    shape: TargetShape,
    memory: gpu::MemoryInfo,
}

impl Target {
    /// Errors: as `Device::target`.
    pub fn new(device: Arc<Device>, shape: TargetShape, transparent: bool, origin: TargetOrigin) -> Result<Self> {
        let made = device.target(shape, origin)?;
        let memory = made.memory;
        Ok(Self { on: OnDevice::new("target", made, device), transparent, shape, memory })
    }

    pub fn shape(&self) -> &TargetShape {
        &self.shape
    }

    pub fn memory(&self) -> &gpu::MemoryInfo {
        &self.memory
    }

    /// A new descriptor of its memory, the caller's. Errors: as `Device::export_target`; SURFACE_LOST.
    pub fn export(&self) -> Result<i32> {
        self.on.with(|target, device| device.export_target(target))
    }

    /// The VkImage and the VkBuffer; one of them is 0. Errors: SURFACE_LOST.
    pub fn vulkan(&self) -> Result<[u64; 2]> {
        self.on.with(|target, _| {
            let raw = target.handle();
            Ok(if self.shape.image { [raw, 0] } else { [0, raw] })
        })
    }

    /// For a frame on `device`. Errors: SURFACE_LOST; INVALID_ARGUMENT for a target of another one.
    pub fn on(&self, device: &Arc<Device>) -> Result<Arc<GpuTarget>> {
        self.on.with(|target, own| match Arc::ptr_eq(own, device) {
            true => Ok(target.clone()),
            false => Err(Error::argument("target was made by another context")),
        })
    }

    /// Ends it, for a reason: later calls are SURFACE_LOST. Its memory goes when the GPU has done with it.
    pub fn end(&self, reason: &'static str) {
        let _ = self.on.with(|target, _| {
            target.end();
            Ok(())
        });
        self.on.end(reason);
    }
}

/// A semaphore that both sides reach.
pub struct Semaphore {
    on: OnDevice<GpuSemaphore>,
    pub kind: SemaphoreKind,
    /// Whether it is a VkSemaphore of the host's.
    is_hosts: bool,
}

impl Semaphore {
    /// Errors: as `Device::semaphore`.
    pub fn new(device: Arc<Device>, kind: SemaphoreKind, origin: SemaphoreOrigin) -> Result<Self> {
        let is_hosts = matches!(origin, SemaphoreOrigin::Host(_));
        let made = device.semaphore(kind, origin)?;
        Ok(Self { on: OnDevice::new("semaphore", made, device), kind, is_hosts })
    }

    /// A new descriptor of it, the caller's. Errors: INVALID_STATE; SURFACE_LOST.
    pub fn export(&self) -> Result<i32> {
        self.on.with(|semaphore, _| semaphore.export())
    }

    /// The VkSemaphore. Errors: SURFACE_LOST.
    pub fn vulkan(&self) -> Result<u64> {
        self.on.with(|semaphore, _| Ok(semaphore.handle()))
    }

    /// Waits until a timeline has a value, at most `time` (`None`: for ever); false: not within that. Errors:
    /// UNSUPPORTED for binary ones; SURFACE_LOST; DEVICE_LOST.
    pub fn wait(&self, value: u64, time: Option<Duration>) -> Result<bool> {
        let deadline = time.and_then(|time| Instant::now().checked_add(time));
        loop {
            let left = deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
            let slice = left.map_or(WAIT_SLICE, |left| left.min(WAIT_SLICE));
            let reached = self.on.with(|semaphore, device| {
                let reached = semaphore.wait(value, slice)?;
                if !reached {
                    device.check()?;
                }
                Ok(reached)
            })?;
            if reached || left == Some(Duration::ZERO) {
                return Ok(reached);
            }
        }
    }

    /// Signals a timeline. Errors: UNSUPPORTED for binary ones; INVALID_ARGUMENT for a value that does not grow;
    /// SURFACE_LOST.
    pub fn signal(&self, value: u64) -> Result<()> {
        self.on.with(|semaphore, device| {
            device.check()?;
            semaphore.signal(value)
        })
    }

    fn on(&self, device: &Arc<Device>) -> Result<Arc<GpuSemaphore>> {
        self.on.with(|semaphore, own| match Arc::ptr_eq(own, device) {
            true => Ok(semaphore.clone()),
            false => Err(Error::argument("a semaphore of sync was made by another context")),
        })
    }

    /// Ends it, for a reason: later calls are SURFACE_LOST.
    pub fn end(&self, reason: &'static str) {
        if self.is_hosts {
            let _ = self.on.with(|semaphore, device| {
                device.forget_waits(semaphore);
                Ok(())
            });
        }
        self.on.end(reason);
    }
}

/// A semaphore and its value, as a host gives them.
pub type Use<'a> = (&'a Semaphore, u64);

/// The semaphores of a frame on `device`. `binary`: whether there may be binary ones.
///
/// Errors: INVALID_ARGUMENT for a semaphore of another device, one that is twice in a list, a binary one, or a signal
/// that is not above the wait for the same; SURFACE_LOST.
pub fn frame_sync(device: &Arc<Device>, waits: &[Use<'_>], signals: &[Use<'_>], binary: bool) -> Result<FrameSync> {
    let of = |(semaphore, value): &Use<'_>| {
        if semaphore.kind == SemaphoreKind::Binary && !binary {
            return Err(Error::argument("sync has a BINARY semaphore; jobs take TIMELINE ones only"));
        }
        let value = (semaphore.kind == SemaphoreKind::Timeline).then_some(*value);
        Ok(SemaphoreUse { semaphore: semaphore.on(device)?, value })
    };
    let all = |list: &[Use<'_>]| list.iter().map(of).collect::<Result<Vec<_>>>();
    let sync = FrameSync { waits: all(waits)?, signals: all(signals)? };
    for list in [&sync.waits, &sync.signals] {
        for (i, one) in list.iter().enumerate() {
            if list.iter().take(i).any(|other| Arc::ptr_eq(&one.semaphore, &other.semaphore)) {
                return Err(Error::argument("sync has a semaphore twice in one list"));
            }
        }
    }
    for one in &sync.waits {
        let back = sync.signals.iter().find(|signal| Arc::ptr_eq(&one.semaphore, &signal.semaphore));
        if let Some((signal, wait)) = back.and_then(|signal| signal.value).zip(one.value)
            && signal <= wait
        {
            return Err(Error::argument(format!(
                "sync waits for {wait} of a timeline and signals {signal} of the same; values grow"
            )));
        }
        if back.is_some_and(|signal| signal.value.is_none()) {
            return Err(Error::argument("sync waits for a BINARY semaphore and signals the same"));
        }
    }
    Ok(sync)
}

/// Errors: INVALID_ARGUMENT for a signal whose value does not grow.
pub fn check_signals(sync: &FrameSync) -> Result<()> {
    sync.timelines().try_for_each(|(semaphore, value)| semaphore.check_value(value))
}

/// Notes that the signals will be given, after a look at all of them. Errors: as [`check_signals`].
pub fn ask_signals(sync: &FrameSync) -> Result<()> {
    check_signals(sync)?;
    for (count, (semaphore, value)) in sync.timelines().enumerate() {
        if let Err(error) = semaphore.ask(value) {
            // Another thread asked for more of this one meanwhile.
            sync.timelines().take(count).for_each(|(semaphore, value)| semaphore.withdraw(value));
            return Err(error);
        }
    }
    Ok(())
}
