// SPDX-License-Identifier: MIT OR Apache-2.0
//! A buffer of uniforms that is written only where it changes.

use crate::error::Result;
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::wgpu_device::Device;
use wgpu::BufferUsages as Usage;

/// A buffer of uniforms, and the bytes that were last written to it, so that the same bytes are not written again.
pub struct CachedUniform {
    pub buffer: Buffer,
    bytes: Vec<u8>,
}

impl CachedUniform {
    pub fn new(device: &Device, label: &str, size: u64) -> Result<Self> {
        Ok(Self { buffer: device.buffer(label, size, Usage::UNIFORM | Usage::COPY_DST)?, bytes: Vec::new() })
    }

    /// A uniform's bytes in a storage buffer, for kernels that have as many uniforms as devices allow.
    pub fn in_storage(device: &Device, label: &str, size: u64) -> Result<Self> {
        Ok(Self { buffer: device.buffer(label, size, Usage::STORAGE | Usage::COPY_DST)?, bytes: Vec::new() })
    }

    /// Before the next submission runs, unless it is there already. Errors: as [`Device::write`].
    pub fn write(&mut self, device: &Device, bytes: &[u8]) -> Result<()> {
        if self.bytes != bytes {
            self.bytes.clear();
            device.write(&self.buffer, 0, bytes)?;
            self.bytes.extend_from_slice(bytes);
        }
        Ok(())
    }

    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// After a submission that failed, nobody knows what the buffer holds.
    pub fn forget(&mut self) {
        self.bytes.clear();
    }
}
