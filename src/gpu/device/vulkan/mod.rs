// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Vulkan below wgpu: devices opened with the extensions that share memory and semaphores, devices of hosts,
//! memory, and semaphores. All unsafe code for them is in this folder. Knows no frames.

pub(in crate::gpu) mod barrier;
#[cfg(unix)]
mod descriptor;
pub(in crate::gpu) mod host;
pub(in crate::gpu) mod memory;
pub(in crate::gpu) mod parts;
pub(in crate::gpu) mod semaphore;

use crate::error::{Error, ErrorKind};
use ash::vk;

/// The error for what a call of Vulkan's returned.
fn failed(call: &str, result: vk::Result) -> Error {
    let kind = match result {
        vk::Result::ERROR_OUT_OF_HOST_MEMORY
        | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY
        | vk::Result::ERROR_TOO_MANY_OBJECTS => ErrorKind::OutOfMemory,
        vk::Result::ERROR_DEVICE_LOST => ErrorKind::DeviceLost,
        vk::Result::ERROR_INVALID_EXTERNAL_HANDLE => ErrorKind::InvalidArgument,
        _ => ErrorKind::Unsupported,
    };
    Error::new(kind, format!("{call} returned {result:?}"))
}
