// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `wayland` on systems that have none.

/// An instance, and the adapters it has.
pub(super) type InstanceAndAdapters = (Option<wgpu::Instance>, Vec<wgpu::Adapter>);

/// True: there is no host's connection that could be disturbed.
pub(super) fn may_try_wayland() -> bool {
    true
}

/// `None`: instances are made in the usual way.
pub(super) fn vulkan_without_wayland(_: wgpu::InstanceFlags) -> Option<InstanceAndAdapters> {
    None
}
