//! Brings bytes from the device to the host through two staging buffers, so that one piece is copied out while the next is
//! being made. Knows nothing of pixels.

use super::buffer::Buffer;
use super::device::Device;
use crate::error::{Error, Result};
use std::sync::mpsc;

/// Two staging buffers, used by turns, that grow to the largest piece they were asked for.
#[derive(Default)]
pub struct Readback {
    slots: [Option<Buffer>; 2],
    /// Copies recorded so far; the parity names the next slot.
    copies: u64,
}

/// A recorded copy, to be read after its submission. Copies may be dropped unread.
#[must_use]
#[derive(Debug)]
pub struct Copied {
    number: u64,
    size: u64,
}

impl Readback {
    pub fn new() -> Self {
        Self::default()
    }

    /// Records the copy of the first `size` bytes (a multiple of 4) of `source`, whose usage has `COPY_SRC`. It overwrites
    /// the copy before the last one, which must have been read by now if ever.
    ///
    /// Errors: as [`Device::buffer`].
    pub fn copy(
        &mut self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        source: &wgpu::Buffer,
        size: u64,
    ) -> Result<Copied> {
        let number = self.copies;
        let slot = slot_of(&mut self.slots, number);
        let staging = match slot {
            Some(buffer) if buffer.size() >= size => buffer,
            _ => {
                *slot = None; // Frees the old one first.
                slot.insert(device.buffer(
                    "readback",
                    size,
                    wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                )?)
            }
        };
        encoder.copy_buffer_to_buffer(source, 0, staging, 0, size);
        self.copies += 1;
        Ok(Copied { number, size })
    }

    /// Waits for `submission`, which `copied` was recorded in, and hands its bytes to `take`.
    ///
    /// Errors: those of `take` and of [`Device::wait`]; `Internal` when `copied` was overwritten or not submitted.
    pub fn read<T>(
        &mut self,
        device: &Device,
        copied: Copied,
        submission: &wgpu::SubmissionIndex,
        take: impl FnOnce(&[u8]) -> Result<T>,
    ) -> Result<T> {
        if self.copies > copied.number + 2 {
            return Err(Error::internal("a readback was overwritten before it was read"));
        }
        let Some(staging) = slot_of(&mut self.slots, copied.number) else {
            return Err(Error::internal("a readback has no staging buffer"));
        };
        let mapping = Mapping::request(device, staging, copied.size)?;
        device.wait(submission)?;
        mapping.read(take)
    }
}

fn slot_of(slots: &mut [Option<Buffer>; 2], number: u64) -> &mut Option<Buffer> {
    let [even, odd] = slots;
    if number.is_multiple_of(2) { even } else { odd }
}

/// A buffer on its way to be read; unmapped at the end, whatever happens.
struct Mapping<'a> {
    buffer: &'a wgpu::Buffer,
    size: u64,
    outcome: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl<'a> Mapping<'a> {
    fn request(device: &Device, buffer: &'a wgpu::Buffer, size: u64) -> Result<Self> {
        let (sender, outcome) = mpsc::sync_channel(1);
        let mapping = Self { buffer, size, outcome };
        device.scoped("mapping a buffer", |_| {
            buffer.map_async(wgpu::MapMode::Read, 0..size, move |result| {
                // Nobody listens any more when the wait failed.
                let _ = sender.try_send(result);
            });
        })?;
        Ok(mapping)
    }

    /// Once the copy into the buffer is done.
    fn read<T>(self, take: impl FnOnce(&[u8]) -> Result<T>) -> Result<T> {
        let failed = |why: &dyn std::fmt::Display| Error::internal(format!("mapping a buffer: {why}"));
        match self.outcome.try_recv() {
            Ok(Ok(())) => take(&self.buffer.get_mapped_range(0..self.size).map_err(|error| failed(&error))?),
            Ok(Err(error)) => Err(failed(&error)),
            Err(error) => Err(failed(&error)),
        }
    }
}

impl Drop for Mapping<'_> {
    fn drop(&mut self) {
        self.buffer.unmap();
    }
}
