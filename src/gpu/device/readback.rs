// SPDX-License-Identifier: MIT OR Apache-2.0
//! Brings bytes from the device to the host through staging buffers that are used again and again, so that one piece
//! is copied out while the next are being made. Knows nothing of pixels.

use super::buffer::Buffer;
use super::process_end;
use super::wgpu_device::Device;
use crate::deferred::hold;
use crate::error::{Error, Result};
use crate::platform::receive_within;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

/// How long the callback of a buffer whose copy is done may take: another thread has been chosen to call it, which
/// need not be running.
const CALLBACK_AFTER: Duration = Duration::from_secs(30);

/// Staging buffers kept for the next pieces: as many as there are pieces under way at most times.
const KEPT: usize = 5;

/// Staging buffers that grow to the largest piece they were asked for. Clones share them.
#[derive(Clone)]
pub struct Readback {
    free: Arc<Mutex<Vec<Buffer>>>,
    usage: wgpu::BufferUsages,
}

/// A staging buffer that commands are to fill. It goes back to its [`Readback`] when it is dropped, and may outlive it.
pub struct Staging {
    /// `None` only while it is being dropped.
    buffer: Option<Buffer>,
    home: Readback,
}

/// A piece on its way to the host, to be read after its submission. Pieces may be dropped unread.
#[must_use]
pub struct PendingReadback {
    staging: Staging,
    size: u64,
    /// Once its mapping is requested: what comes of that.
    mapped: Option<mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>>,
}

impl Default for Readback {
    fn default() -> Self {
        Self { free: Arc::default(), usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ }
    }
}

impl Readback {
    pub fn new() -> Self {
        Self::default()
    }

    /// A readback through staging buffers that kernels can write and queries can be resolved to, for devices that map
    /// storage.
    pub fn of_kernels() -> Self {
        let more = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::QUERY_RESOLVE;
        let plain = Self::default();
        Self { usage: plain.usage | more, ..plain }
    }

    /// A staging buffer of at least `size` bytes. Errors: as [`Device::buffer`].
    pub fn staging(&self, device: &Device, size: u64) -> Result<Staging> {
        let buffer = match self.take(size) {
            Some(buffer) => buffer,
            None => device.buffer("readback", size, self.usage)?,
        };
        Ok(Staging { buffer: Some(buffer), home: self.clone() })
    }

    /// Records the copy of the first `size` bytes (a multiple of 4) of `source`, whose usage has `COPY_SRC`.
    ///
    /// Errors: as [`Device::buffer`].
    pub fn copy(
        &self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        source: &wgpu::Buffer,
        size: u64,
    ) -> Result<PendingReadback> {
        let staging = self.staging(device, size)?;
        encoder.copy_buffer_to_buffer(source, 0, staging.buffer()?, 0, size);
        Ok(staging.filled(size))
    }

    /// A free buffer that holds `size` bytes. When all are smaller, one goes to make room for a larger one.
    fn take(&self, size: u64) -> Option<Buffer> {
        // Messages about buffers that go wait until the lock is released.
        let _holding = hold();
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        match free.iter().position(|buffer| buffer.size() >= size) {
            Some(found) => Some(free.swap_remove(found)),
            None => {
                free.pop();
                None
            }
        }
    }

    fn give_back(&self, buffer: Buffer) {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        if free.len() < KEPT {
            free.push(buffer);
        }
    }
}

impl Staging {
    pub fn buffer(&self) -> Result<&Buffer> {
        self.buffer.as_ref().ok_or_else(|| Error::internal("a readback has no staging buffer"))
    }

    /// Once the commands that fill its first `size` bytes are recorded.
    pub fn filled(self, size: u64) -> PendingReadback {
        PendingReadback { staging: self, size, mapped: None }
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        if let Some(buffer) = self.buffer.take() {
            self.home.give_back(buffer);
        }
    }
}

impl PendingReadback {
    /// Asks for the piece, after its submission, so that waiting for that is all that is left to do. Errors: as
    /// [`Device::scoped`].
    pub fn request(&mut self, device: &Device) -> Result<()> {
        let (sender, outcome) = mpsc::sync_channel(1);
        let buffer = self.staging.buffer()?;
        let (mapped, size) = (&mut self.mapped, self.size);
        let _holding = hold();
        let _inside = process_end::enter();
        // wgpu may submit what it has left to.
        let _turn = device.turns.take();
        device.scoped("mapping a buffer", |_| {
            *mapped = Some(outcome);
            buffer.map_async(wgpu::MapMode::Read, 0..size, move |result| {
                // Nobody listens any more when the wait failed.
                let _ = sender.try_send(result);
            });
        })
    }

    /// Waits for `submission`, which fills the piece, and hands its bytes to `take`, as [`MappedReadback::part`] does.
    ///
    /// Errors: as [`Self::wait`] and [`MappedReadback::part`].
    pub fn read<T>(
        self,
        device: &Device,
        submission: &wgpu::SubmissionIndex,
        take: impl FnOnce(&[u8]) -> Result<T>,
    ) -> Result<T> {
        let size = self.size;
        self.wait(device, submission)?.part(0..size, take)
    }

    /// Waits for `submission`, which fills the piece. Errors: those of [`Device::wait`]; `Internal` when it was not
    /// submitted.
    pub fn wait<'a>(mut self, device: &'a Device, submission: &wgpu::SubmissionIndex) -> Result<MappedReadback<'a>> {
        if self.mapped.is_none() {
            self.request(device)?;
        }
        device.wait(submission)?;
        let failed = |why: &dyn std::fmt::Display| device.explain(Error::internal(format!("mapping a buffer: {why}")));
        // Another thread's poll may have taken this buffer's callback, and be about to call it.
        let outcome = self.mapped.as_ref().map(|mapped| receive_within(mapped, CALLBACK_AFTER));
        match outcome.unwrap_or(Err(mpsc::RecvTimeoutError::Disconnected)) {
            Ok(Ok(())) => {
                let view = self.staging.buffer()?.get_mapped_range(0..self.size).map_err(|error| failed(&error))?;
                Ok(MappedReadback { view, copied: self, device })
            }
            Ok(Err(error)) => Err(failed(&error)),
            Err(error) => Err(failed(&error)),
        }
    }
}

/// A piece that the host can read.
pub struct MappedReadback<'a> {
    /// Goes before the mapping does. To be touched in [`Self::part`] only.
    view: wgpu::BufferView,
    copied: PendingReadback,
    device: &'a Device,
}

impl MappedReadback<'_> {
    /// Hands the bytes of `range`, from the piece's begin, to `take`, as `Device::while_it_exists` does. Large pieces
    /// are better taken in parts.
    ///
    /// Errors: those of `take`; `DeviceLost`; `Internal` for bytes that the piece has not.
    pub fn part<T>(&self, range: Range<u64>, take: impl FnOnce(&[u8]) -> Result<T>) -> Result<T> {
        let buffer = self.copied.staging.buffer()?;
        // Once the process ends, nobody reads the driver's memory, nor writes the host's.
        let _inside = process_end::enter();
        let take = || {
            let part = self.view.get(range.start as usize..range.end as usize);
            take(part.ok_or_else(|| Error::internal("a part of a readback that it has not"))?)
        };
        self.device.while_it_exists(buffer, take)
    }
}

impl Drop for PendingReadback {
    fn drop(&mut self) {
        if let (Some(_), Ok(buffer)) = (&self.mapped, self.staging.buffer()) {
            let _inside = process_end::enter();
            buffer.unmap();
        }
    }
}
