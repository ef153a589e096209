// SPDX-License-Identifier: MIT OR Apache-2.0
//! Adapters, devices, and what lies on them: buffers, textures, timers, and the ways to and from the host. Knows no
//! kernel and no scene.

pub(in crate::gpu) mod adapter;
pub(in crate::gpu) mod bindings;
pub(in crate::gpu) mod buffer;
#[doc(hidden)]
pub mod driver_lock;
pub(in crate::gpu) mod external;
pub(in crate::gpu) mod faults;
pub(in crate::gpu) mod gl_guard;
pub(in crate::gpu) mod gl_thread;
pub(in crate::gpu) mod handover;
pub(in crate::gpu) mod loader;
pub(in crate::gpu) mod pipeline;
pub(crate) mod process_end;
pub(in crate::gpu) mod readback;
pub(in crate::gpu) mod semaphores;
pub(in crate::gpu) mod sharing;
pub(in crate::gpu) mod specialise;
pub(in crate::gpu) mod texture;
pub(in crate::gpu) mod timer;
pub(in crate::gpu) mod turns;
pub(in crate::gpu) mod upload;
#[cfg(not(target_vendor = "apple"))]
pub(in crate::gpu) mod vulkan;
pub(in crate::gpu) mod wgpu_device;
