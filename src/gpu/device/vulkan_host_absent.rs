// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `vulkan_host` on Apple's systems, where hosts have no devices that bhr can use.

use super::adapter::Adapter;
use super::external::{HostDevice, HostVulkan, ReleaseGuard, Requirements, shares_nothing};
use crate::error::Result;
use crate::tracer::Backend;
use std::sync::Arc;

/// Errors: UNSUPPORTED.
pub(in crate::gpu) fn of_instance() -> Result<Requirements> {
    shares_nothing(Backend::Metal)
}

/// Errors: UNSUPPORTED.
pub(in crate::gpu) fn of_device(_: &HostVulkan) -> Result<Requirements> {
    shares_nothing(Backend::Metal)
}

/// Errors: UNSUPPORTED.
pub(in crate::gpu) fn adapter(_: HostVulkan, _: &Arc<ReleaseGuard>) -> Result<Adapter> {
    shares_nothing(Backend::Metal)
}

/// Errors: a text.
pub(in crate::gpu) fn open(
    _: &wgpu::Adapter,
    _: &HostDevice,
    _: &wgpu::DeviceDescriptor<'_>,
) -> Result<(wgpu::Device, wgpu::Queue), String> {
    Err("there is no Vulkan".into())
}
