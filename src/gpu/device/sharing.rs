// SPDX-License-Identifier: MIT OR Apache-2.0
//! The device's face for making targets that it shares with hosts, and semaphores: through Vulkan, or not at all. Knows
//! no frames.

use super::adapter::Adapter;
use super::external::{
    HostVulkan, ReleaseGuard, Requirements, SemaphoreKind, SemaphoreOrigin, Sharing, TargetOrigin, TargetShape,
    shares_nothing,
};
use super::semaphores::GpuSemaphore;
use super::target::GpuTarget;
use super::vulkan_host;
use super::wgpu_device::Device;
use crate::error::Result;
use std::sync::Arc;

impl Device {
    fn parts(&self) -> Result<&Arc<super::vulkan::parts::VulkanParts>> {
        self.vulkan.as_ref().map_or_else(|| shares_nothing(self.backend()), Ok)
    }

    /// The handles that the device shares.
    pub fn sharing(&self) -> Sharing {
        self.parts().map(|parts| parts.sharing()).unwrap_or_default()
    }

    /// A target. Errors: UNSUPPORTED for what the device cannot make or share; INVALID_ARGUMENT for memory that does
    /// not fit; OUT_OF_MEMORY; DEVICE_LOST.
    pub fn target(&self, shape: TargetShape, origin: TargetOrigin) -> Result<GpuTarget> {
        // Kept bind groups hold targets that this one may replace.
        self.bindings.clear();
        self.vulkan_target(self.parts()?, shape, origin)
    }

    /// A new descriptor of a target's memory, the caller's. Errors: INVALID_STATE for a target that was not made for
    /// export; DEVICE_LOST.
    pub fn export_target(&self, target: &GpuTarget) -> Result<i32> {
        self.check()?;
        self.export_vulkan(self.parts()?, target)
    }

    /// A semaphore. Errors: UNSUPPORTED; OUT_OF_MEMORY; INVALID_ARGUMENT for a descriptor that is no semaphore.
    pub fn semaphore(&self, kind: SemaphoreKind, origin: SemaphoreOrigin) -> Result<GpuSemaphore> {
        self.check()?;
        GpuSemaphore::new(self.parts()?.clone(), kind, origin)
    }
}

/// The requirements of instances (without a physical device), or of devices. Errors: INVALID_ARGUMENT; UNSUPPORTED.
pub fn vulkan_requirements(host: Option<&HostVulkan>) -> Result<Requirements> {
    match host {
        Some(host) => vulkan_host::of_device(host),
        None => vulkan_host::of_instance(),
    }
}

/// An adapter on which a device is the host's. Errors: INVALID_ARGUMENT; UNSUPPORTED.
pub fn host_adapter(host: HostVulkan, release: &Arc<ReleaseGuard>) -> Result<Adapter> {
    vulkan_host::adapter(host, release)
}
