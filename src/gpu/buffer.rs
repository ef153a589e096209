//! Buffers on a device: checked against its limits before wgpu is asked, and counted while they exist.

use super::device::Device;
use crate::error::{Error, ErrorKind, Result};
use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A [`wgpu::Buffer`] that [`Device::bytes`] counts until it is dropped. (Bind groups that hold it keep its memory longer.)
pub struct Buffer {
    raw: wgpu::Buffer,
    total: Arc<AtomicU64>,
}

impl Device {
    /// A buffer of `size` bytes, rounded up to a multiple of 4, filled with zeros.
    ///
    /// Errors: `Unsupported` when `usage` does not allow the size on this adapter, the message naming both; `Internal` for
    /// size 0; `OutOfMemory`; `DeviceLost`.
    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> Result<Buffer> {
        self.check_size(label, size, usage)?;
        self.bindings.clear();
        let size = size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        let raw = self.scoped(label, |device| device.create_buffer(&descriptor))?;
        let total = self.byte_count();
        total.fetch_add(size, Ordering::Relaxed);
        Ok(Buffer { raw, total })
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

impl Drop for Buffer {
    fn drop(&mut self) {
        self.total.fetch_sub(self.raw.size(), Ordering::Relaxed);
    }
}
