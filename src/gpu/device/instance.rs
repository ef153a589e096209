// SPDX-License-Identifier: MIT OR Apache-2.0
//! Makes wgpu's instances and asks them for their adapters. Knows nothing of devices, nor of what bhr needs of them.

use super::wayland;
pub(super) use super::wayland::{DriverAdapters, may_try_wayland};

/// The adapters of these interfaces. A driver may panic here. `wayland`: whether surfaces of Wayland can be made, too
/// ([`may_try_wayland`]).
pub(super) fn ask(backends: wgpu::Backends, flags: wgpu::InstanceFlags, wayland: bool) -> DriverAdapters {
    if backends.contains(wgpu::Backends::VULKAN)
        && !wayland
        && let Some(found) = wayland::vulkan_without_wayland(flags)
    {
        return found;
    }
    let descriptor =
        wgpu::InstanceDescriptor { backends, flags, ..wgpu::InstanceDescriptor::new_without_display_handle() };
    let instance = wgpu::Instance::new(descriptor);
    let list = pollster::block_on(instance.enumerate_adapters(backends));
    (Some(instance), list)
}
