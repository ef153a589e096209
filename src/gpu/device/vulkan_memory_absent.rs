// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `vulkan_memory` on Apple's systems: no device has Vulkan's parts.

use super::external::{TargetOrigin, TargetShape};
use super::target::GpuTarget;
use super::vulkan::parts::VulkanParts;
use super::wgpu_device::Device;
use crate::error::Result;

impl Device {
    pub(in crate::gpu) fn vulkan_target(
        &self,
        parts: &VulkanParts,
        _: TargetShape,
        _: TargetOrigin,
    ) -> Result<GpuTarget> {
        match *parts {}
    }

    pub(in crate::gpu) fn export_vulkan(&self, parts: &VulkanParts, _: &GpuTarget) -> Result<i32> {
        match *parts {}
    }
}
