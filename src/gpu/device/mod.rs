// SPDX-License-Identifier: MIT OR Apache-2.0
//! Adapters, devices, and what lies on them: buffers, textures, timers, and the ways to and from the host. Knows no
//! kernel and no scene.
//!
//! A file that builds on what wgpu or another crate has on some systems only stands here with its stand-in, NAME.rs and
//! NAME_absent.rs: who uses it asks for no system.

pub(in crate::gpu) mod bindings;
pub(in crate::gpu) mod counted;
#[doc(hidden)]
pub mod driver_lock;
pub(in crate::gpu) mod external;
pub(in crate::gpu) mod faults;
pub(in crate::gpu) mod hlsl_compiler;
#[cfg_attr(not(all(unix, not(target_vendor = "apple"), not(target_os = "android"))), path = "wayland_absent.rs")]
pub(in crate::gpu) mod wayland;
pub(in crate::gpu) mod instance;
#[cfg_attr(target_arch = "wasm32", path = "interfaces_absent.rs")]
pub(in crate::gpu) mod interfaces;
pub(in crate::gpu) mod loader;
pub(crate) mod process_end;
pub(in crate::gpu) mod native;
#[cfg_attr(target_arch = "wasm32", path = "specialise_absent.rs")]
pub(in crate::gpu) mod specialise;
#[cfg_attr(
    not(all(feature = "gl", unix, not(target_vendor = "apple"), not(target_os = "android"))),
    path = "gl_guard_absent.rs"
)]
pub(in crate::gpu) mod gl_guard;
pub(in crate::gpu) mod target;
pub(in crate::gpu) mod gl_thread;
#[cfg_attr(not(shares_memory), path = "vulkan_absent.rs")]
pub(in crate::gpu) mod vulkan;
pub(in crate::gpu) mod adapter;
pub(in crate::gpu) mod semaphores;
pub(in crate::gpu) mod turns;
#[cfg_attr(not(shares_memory), path = "vulkan_host_absent.rs")]
pub(in crate::gpu) mod vulkan_host;
#[cfg_attr(target_arch = "wasm32", path = "refusals_absent.rs")]
pub(in crate::gpu) mod refusals;
pub(in crate::gpu) mod wgpu_device;
pub(in crate::gpu) mod deep_stack;
pub(in crate::gpu) mod buffer;
pub(in crate::gpu) mod handover;
pub(in crate::gpu) mod pipeline;
pub(in crate::gpu) mod sharing;
pub(in crate::gpu) mod texture;
pub(in crate::gpu) mod upload;
#[cfg_attr(not(shares_memory), path = "vulkan_memory_absent.rs")]
pub(in crate::gpu) mod vulkan_memory;
pub(in crate::gpu) mod readback;
pub(in crate::gpu) mod timer;
