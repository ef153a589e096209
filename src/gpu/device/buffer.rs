// SPDX-License-Identifier: MIT OR Apache-2.0
//! Buffers on a device: checked against its limits before wgpu is asked, and counted while they exist.

use super::counted::Counted;
use super::interfaces::while_it_exists;
use super::wgpu_device::Device;
use crate::deferred::hold;
use crate::error::{Error, ErrorKind, Result};
use std::ops::Deref;

/// A [`wgpu::Buffer`] that [`Device::bytes`] counts until it is dropped. (Bind groups that hold it keep its memory
/// longer.)
pub struct Buffer {
    raw: wgpu::Buffer,
    _counted: Counted,
}

impl Device {
    /// Counts bytes that are not wgpu's.
    pub(in crate::gpu) fn counted(&self, bytes: u64) -> Counted {
        Counted::new(self.byte_count(), bytes)
    }

    /// A buffer of `size` bytes, rounded up to a multiple of 4, filled with zeros.
    ///
    /// Errors: `Unsupported` when `usage` does not allow the size on this adapter, the message naming both; `Internal`
    /// for size 0; `OutOfMemory`; `DeviceLost`.
    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> Result<Buffer> {
        self.check_size(label, size, usage)?;
        self.bindings.clear();
        let size = size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        let raw = self.scoped(label, |device| device.create_buffer(&descriptor))?;
        Ok(Buffer { raw, _counted: self.counted(size) })
    }

    /// Runs `work`, which touches the mapped memory of `buffer`, while that cannot be destroyed: once a device has
    /// ended, whichever thread polls it destroys all its buffers, mapped ones too (gfx-rs/wgpu #10256), and a device
    /// ends when any call of any thread finds no memory.
    ///
    /// `work` must ask wgpu for nothing and wait for no thread that does. Other threads that destroy something of the
    /// device, or present, wait meanwhile, so that it should be short: destroying takes the write side of the lock of
    /// which wgpu's guard is the read side.
    ///
    /// Errors: those of `work`; `DeviceLost`.
    pub(in crate::gpu) fn while_it_exists<T>(
        &self,
        buffer: &wgpu::Buffer,
        work: impl FnOnce() -> Result<T>,
    ) -> Result<T> {
        // The messages of `work` go to a host, whose callback may wait for a thread that asks wgpu.
        let holding = hold();
        let done = while_it_exists(self.backend(), buffer, work);
        drop(holding);
        let gone = || Err(self.explain(Error::internal("mapped memory was freed before it was used")));
        done.unwrap_or_else(gone)
    }

    fn check_size(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> Result<()> {
        if size == 0 {
            return Err(Error::internal(format!("buffer '{label}' of 0 bytes")));
        }
        let limits = self.limits();
        let bounds = [
            (wgpu::BufferUsages::all(), "buffer", limits.max_buffer_size),
            (wgpu::BufferUsages::STORAGE, "storage buffer", limits.max_storage_buffer_binding_size),
            (wgpu::BufferUsages::UNIFORM, "uniform buffer", limits.max_uniform_buffer_binding_size),
        ];
        match bounds.into_iter().find(|(of, _, limit)| usage.intersects(*of) && size > *limit) {
            None => Ok(()),
            Some((_, kind, limit)) => Err(Error::new(
                ErrorKind::Unsupported,
                format!("{kind} '{label}' needs {size} bytes; the largest on this adapter is {limit} bytes"),
            )),
        }
    }
}

impl Deref for Buffer {
    type Target = wgpu::Buffer;

    fn deref(&self) -> &wgpu::Buffer {
        &self.raw
    }
}

/// Distance of two uniforms of a buffer of which dispatches choose one.
pub(in crate::gpu) fn uniform_stride<T>(device: &Device) -> u64 {
    let alignment = u64::from(device.limits().min_uniform_buffer_offset_alignment);
    (size_of::<T>() as u64).next_multiple_of(alignment)
}
