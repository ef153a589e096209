// SPDX-License-Identifier: MIT OR Apache-2.0
//! The buffers of hosts' rays.

use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::readback::Readback;

/// Made when rays are first traced; they stay.
#[derive(Default)]
pub struct RayBuffers {
    pub resources: Option<[Buffer; 3]>,
    pub readback: Readback,
}
