// SPDX-License-Identifier: MIT OR Apache-2.0
//! Semaphores that a device and a host share: made, exported, imported, waited for. One must be dropped before its
//! device, and after the last submission that uses it (`Device::submit_handed` keeps it so long).

use super::failed;
use super::parts::VulkanParts;
use crate::error::{Error, Result};
use crate::gpu::device::external::{OPAQUE_FD, SemaphoreKind, SemaphoreOrigin};
use crate::gpu::device::process_end;
use ash::vk;
use ash::vk::Handle;
use std::collections::BTreeSet;
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A VkSemaphore of a device.
pub struct GpuSemaphore {
    raw: vk::Semaphore,
    kind: SemaphoreKind,
    /// Whether bhr made it, and is to destroy it.
    owned: bool,
    /// The handle that it was made to be exported by.
    exports: u32,
    parts: Arc<VulkanParts>,
    values: Mutex<Values>,
}

/// So many values may run before it is asked which were reached.
const MOST_RUNNING: usize = 64;

/// The values that a timeline is to have.
#[derive(Default)]
struct Values {
    /// Values of frames that are not submitted yet, at most as many as a context has jobs.
    pending: BTreeSet<u64>,
    /// Values that went to the queue and are not known to be reached.
    running: BTreeSet<u64>,
    /// The largest one that went to the queue.
    submitted: u64,
}

impl Values {
    /// The largest value that the timeline has or will have, as far as frames go.
    fn asked(&self) -> u64 {
        self.pending.last().map_or(self.submitted, |pending| self.submitted.max(*pending))
    }
}

impl GpuSemaphore {
    /// Errors: UNSUPPORTED; OUT_OF_MEMORY; INVALID_ARGUMENT for a descriptor that is no semaphore.
    pub(in crate::gpu) fn new(parts: Arc<VulkanParts>, kind: SemaphoreKind, origin: SemaphoreOrigin) -> Result<Self> {
        let vk_kind = vk_kind(kind);
        let handle = match origin {
            SemaphoreOrigin::New(handle) => handle,
            SemaphoreOrigin::Descriptor(_) => OPAQUE_FD,
            SemaphoreOrigin::Host(_) => 0,
        };
        if handle != 0 && (handle != OPAQUE_FD || !parts.shares_semaphores(vk_kind)) {
            let name = if kind == SemaphoreKind::Timeline { "TIMELINE" } else { "BINARY" };
            return Err(Error::unsupported(format!(
                "semaphores of kind {name} are not shared by handle_type {handle} here: bhr_interop_info lists those \
                 that are"
            )));
        }
        let (raw, owned) = match origin {
            SemaphoreOrigin::Host(raw) => (vk::Semaphore::from_raw(raw), false),
            SemaphoreOrigin::New(_) | SemaphoreOrigin::Descriptor(_) => {
                let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk_kind);
                let mut export = vk::ExportSemaphoreCreateInfo::default()
                    .handle_types(vk::ExternalSemaphoreHandleTypeFlags::OPAQUE_FD);
                let create = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
                let exported = matches!(origin, SemaphoreOrigin::New(OPAQUE_FD));
                let create = if exported { create.push_next(&mut export) } else { create };
                // SAFETY: the device lives, and the structs are of version 1.2, which it has.
                let made = unsafe { parts.device.create_semaphore(&create, None) };
                (made.map_err(|error| failed("vkCreateSemaphore", error))?, true)
            }
        };
        // From here on it is destroyed when it is dropped.
        let exports = if matches!(origin, SemaphoreOrigin::New(_)) { handle } else { 0 };
        let made = Self { raw, kind, owned, exports, parts, values: Mutex::default() };
        if let SemaphoreOrigin::Descriptor(fd) = origin {
            made.import(fd)?;
        }
        Ok(made)
    }

    fn import(&self, fd: i32) -> Result<()> {
        let copy = super::descriptor::CopiedDescriptor::new(fd)?;
        super::descriptor::check_kind(fd, self.parts.own_semaphore(), "semaphore")?;
        let fns = self.parts.semaphore_fd.as_ref().ok_or_else(|| Error::internal("no semaphores by descriptor"))?;
        let import = vk::ImportSemaphoreFdInfoKHR::default()
            .semaphore(self.raw)
            .handle_type(vk::ExternalSemaphoreHandleTypeFlags::OPAQUE_FD)
            .fd(copy.number());
        // SAFETY: the semaphore was made just now and nobody uses it; the descriptor is bhr's own copy.
        unsafe { fns.import_semaphore_fd(&import) }.map_err(|error| {
            let error = failed("vkImportSemaphoreFdKHR", error);
            Error::argument(format!("handle fd {fd} is no semaphore of this driver: {error}"))
        })?;
        // The driver has taken it over.
        copy.taken();
        Ok(())
    }

    /// A new descriptor of it, the caller's. Errors: INVALID_STATE for one that was not made to be exported.
    pub fn export(&self) -> Result<i32> {
        let fns = self.parts.semaphore_fd.as_ref().filter(|_| self.exports == OPAQUE_FD);
        let fns = fns.ok_or_else(|| Error::state("the semaphore was not made for export: its handle_type was 0"))?;
        let ask = vk::SemaphoreGetFdInfoKHR::default()
            .semaphore(self.raw)
            .handle_type(vk::ExternalSemaphoreHandleTypeFlags::OPAQUE_FD);
        // SAFETY: the semaphore lives, and was made for this handle.
        unsafe { fns.get_semaphore_fd(&ask) }.map_err(|error| failed("vkGetSemaphoreFdKHR", error))
    }

    pub fn kind(&self) -> SemaphoreKind {
        self.kind
    }

    /// The VkSemaphore.
    pub fn handle(&self) -> u64 {
        self.raw.as_raw()
    }

    fn values(&self) -> MutexGuard<'_, Values> {
        self.values.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The value of a timeline now.
    fn counter(&self) -> Result<u64> {
        // SAFETY: a timeline of a device that lives.
        unsafe { self.parts.device.get_semaphore_counter_value(self.raw) }
            .map_err(|error| failed("vkGetSemaphoreCounterValue", error))
    }

    /// Notes that a timeline is to be signalled. Errors: as [`Self::check_value`].
    pub fn ask(&self, value: u64) -> Result<()> {
        let mut values = self.values();
        self.check_growth(value, values.asked())?;
        values.pending.insert(value);
        Ok(())
    }

    /// The frame that was to signal it failed, and nothing of it went to the queue.
    pub fn withdraw(&self, value: u64) {
        self.values().pending.remove(&value);
    }

    /// Errors: INVALID_ARGUMENT for a value that does not grow, or grows more than the device has it.
    pub fn check_value(&self, value: u64) -> Result<()> {
        self.check_growth(value, self.values().asked())
    }

    fn check_growth(&self, value: u64, asked: u64) -> Result<()> {
        let last = self.counter()?.max(asked);
        if value <= last {
            return Err(Error::argument(format!(
                "the signal's value is {value}; the timeline is, or will be, at {last} already, and values grow"
            )));
        }
        if value - last > self.parts.timeline_step {
            let most = self.parts.timeline_step;
            return Err(Error::argument(format!("the signal's value is {value}, more than {most} above {last}")));
        }
        Ok(())
    }

    /// Whether a signal may go to the queue: it is not one that a frame which was asked for later has overtaken.
    fn may_submit(&self, value: u64) -> bool {
        value > self.values().submitted
    }

    /// A signal went to the queue.
    pub(in crate::gpu) fn has_submitted(&self, value: u64) {
        let mut values = self.values();
        values.pending.remove(&value);
        values.submitted = values.submitted.max(value);
        if self.kind != SemaphoreKind::Timeline {
            return;
        }
        values.running.insert(value);
        if values.running.len() > MOST_RUNNING {
            // Where the driver does not tell, the oldest is the likeliest to be reached.
            let reached = self.counter().ok().or(values.running.first().copied()).unwrap_or(0);
            values.running.retain(|value| *value > reached);
        }
    }

    /// Waits on the CPU until a timeline has a value; false: not within `time`. Errors: UNSUPPORTED for a binary one;
    /// DEVICE_LOST.
    pub fn wait(&self, value: u64, time: Duration) -> Result<bool> {
        self.timeline()?;
        let (semaphores, values) = ([self.raw], [value]);
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        let nanoseconds = time.as_nanos().try_into().unwrap_or(u64::MAX);
        let _inside = process_end::enter();
        // SAFETY: a timeline of a device that lives.
        match unsafe { self.parts.device.wait_semaphores(&info, nanoseconds) } {
            Ok(()) => Ok(true),
            Err(vk::Result::TIMEOUT) => Ok(false),
            Err(error) => Err(failed("vkWaitSemaphores", error)),
        }
    }

    /// Signals a timeline on the CPU. Errors: UNSUPPORTED for a binary one; as [`Self::ask`].
    pub fn signal(&self, value: u64) -> Result<()> {
        self.timeline()?;
        let values = self.values();
        let now = self.counter()?;
        let next = values.pending.iter().chain(&values.running).copied().filter(|value| *value > now).min();
        if let Some(pending) = next.filter(|next| value >= *next) {
            return Err(Error::argument(format!(
                "value is {value}; a frame that is under way will signal {pending}, and values grow"
            )));
        }
        if value <= now {
            return Err(Error::argument(format!("value is {value}; the timeline is at {now} already")));
        }
        if value - now > self.parts.timeline_step {
            let most = self.parts.timeline_step;
            return Err(Error::argument(format!("value is {value}, more than {most} above {now}")));
        }
        let info = vk::SemaphoreSignalInfo::default().semaphore(self.raw).value(value);
        // SAFETY: a timeline of a device that lives, below what is pending and above what it has.
        unsafe { self.parts.device.signal_semaphore(&info) }.map_err(|error| failed("vkSignalSemaphore", error))
    }

    fn timeline(&self) -> Result<()> {
        match self.kind {
            SemaphoreKind::Timeline => Ok(()),
            SemaphoreKind::Binary => Err(Error::unsupported("a BINARY semaphore has no value: only the GPU waits")),
        }
    }
}

fn vk_kind(kind: SemaphoreKind) -> vk::SemaphoreType {
    match kind {
        SemaphoreKind::Timeline => vk::SemaphoreType::TIMELINE,
        SemaphoreKind::Binary => vk::SemaphoreType::BINARY,
    }
}

impl Drop for GpuSemaphore {
    fn drop(&mut self) {
        if self.owned {
            // SAFETY: bhr made it, its device lives, and no submission uses it any more, by this file's promise.
            unsafe { self.parts.device.destroy_semaphore(self.raw, None) };
        }
    }
}

/// Vulkan's queue, where there are semaphores to add to its next submission or to take from it.
fn hal_queue(queue: &wgpu::Queue, semaphores: usize) -> Option<impl Deref<Target = wgpu::hal::vulkan::Queue>> {
    if semaphores == 0 {
        return None;
    }
    // SAFETY: this file adds semaphores that live until the submission has run, and removes them; no more is done.
    unsafe { queue.as_hal::<wgpu::hal::api::Vulkan>() }
}

/// Has the next submission wait for `waits` and signal `signals`, each with the value of a timeline.
pub(in crate::gpu) fn stage<'a>(
    queue: &wgpu::Queue,
    waits: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
    signals: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
) {
    let Some(hal) = hal_queue(queue, waits.len() + signals.len()) else { return };
    for (semaphore, value) in waits {
        hal.add_wait_semaphore(semaphore.raw, value, vk::PipelineStageFlags::ALL_COMMANDS);
    }
    for (semaphore, value) in signals {
        // A timeline that has gone further already must not go back.
        if value.is_none_or(|value| semaphore.may_submit(value)) {
            hal.add_signal_semaphore(semaphore.raw, value);
        }
    }
}

/// After a submission that was refused: what it did not take must not go with the next one.
pub(in crate::gpu) fn unstage<'a>(
    queue: &wgpu::Queue,
    waits: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
    signals: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
) {
    let Some(hal) = hal_queue(queue, waits.len() + signals.len()) else { return };
    for (semaphore, _) in waits {
        hal.remove_wait_semaphore(semaphore.raw);
    }
    for (semaphore, _) in signals {
        hal.remove_signal_semaphore(semaphore.raw);
    }
}
