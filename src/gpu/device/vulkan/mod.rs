// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Vulkan below wgpu: devices opened with the extensions that share memory and semaphores, devices of hosts,
//! semaphores, and barriers. vulkan_host.rs and vulkan_memory.rs, beside this folder, have the rest of the unsafe code
//! for them. Knows no frames.

pub(in crate::gpu) mod descriptor;
pub(in crate::gpu) mod parts;
pub(in crate::gpu) mod barrier;
pub(in crate::gpu) mod semaphore;

use crate::error::{Error, ErrorKind};
use ash::vk;

/// The error for what a call of Vulkan's returned.
pub(in crate::gpu) fn failed(call: &str, result: vk::Result) -> Error {
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
