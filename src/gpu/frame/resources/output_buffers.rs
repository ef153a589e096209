// SPDX-License-Identifier: MIT OR Apache-2.0
//! The buffers of outputs of a frame, with a picture beside them or without. Knows no kernels.

use super::cached_uniform::CachedUniform;
use super::frame_buffers::{FrameBuffers, Size};
use crate::error::Result;
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::setup::Setup;
use crate::gpu::frame::uniforms::outputs::OutputsUniform;

/// The buffers of outputs; they grow and stay.
#[derive(Default)]
pub struct OutputBuffers {
    pub(in crate::gpu) frame: FrameBuffers,
    pub(in crate::gpu) uniform: Option<CachedUniform>,
    /// A tile's numbers for the host, of outputs beside a picture.
    pub(in crate::gpu) packed: Option<Buffer>,
}

impl OutputBuffers {
    pub fn prepare(&mut self, device: &Device, size: Size, setup: &Setup, software: bool) -> Result<()> {
        self.frame.prepare(device, size, setup, software)?;
        self.uniform(device).map(drop)
    }

    /// Makes room for so many bytes of a tile's numbers.
    pub(in crate::gpu) fn make_room(&mut self, device: &Device, bytes: u64) -> Result<()> {
        if self.packed.as_ref().is_none_or(|packed| packed.size() < bytes) {
            // The old one goes first: both together need not fit.
            self.packed = None;
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            self.packed = Some(device.buffer("numbers of outputs", bytes, usage)?);
        }
        Ok(())
    }

    /// The uniform of the outputs.
    pub(in crate::gpu) fn uniform(&mut self, device: &Device) -> Result<&mut CachedUniform> {
        match &mut self.uniform {
            Some(held) => Ok(held),
            empty => Ok(empty.insert(CachedUniform::new(device, "outputs", size_of::<OutputsUniform>() as u64)?)),
        }
    }

    /// After a submission that failed, nobody knows what the buffers hold.
    pub fn forget(&mut self) {
        self.frame.forget();
        if let Some(uniform) = &mut self.uniform {
            uniform.forget();
        }
    }
}
