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
#[cfg(not(target_vendor = "apple"))]
use super::vulkan_host;
use super::wgpu_device::Device;
use crate::error::Result;
#[cfg(target_vendor = "apple")]
use crate::tracer::Backend;
use std::sync::Arc;

#[cfg(not(target_vendor = "apple"))]
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

#[cfg(target_vendor = "apple")]
impl Device {
    /// The handles that the device shares: none.
    pub fn sharing(&self) -> Sharing {
        Sharing::default()
    }

    /// Errors: UNSUPPORTED.
    pub fn target(&self, _: TargetShape, _: TargetOrigin) -> Result<GpuTarget> {
        shares_nothing(self.backend())
    }

    /// Errors: UNSUPPORTED.
    pub fn export_target(&self, _: &GpuTarget) -> Result<i32> {
        shares_nothing(self.backend())
    }

    /// Errors: UNSUPPORTED.
    pub fn semaphore(&self, _: SemaphoreKind, _: SemaphoreOrigin) -> Result<GpuSemaphore> {
        shares_nothing(self.backend())
    }
}

/// The requirements of instances (without a physical device), or of devices. Errors: INVALID_ARGUMENT; UNSUPPORTED.
#[cfg(not(target_vendor = "apple"))]
pub fn vulkan_requirements(host: Option<&HostVulkan>) -> Result<Requirements> {
    match host {
        Some(host) => vulkan_host::of_device(host),
        None => Ok(vulkan_host::of_instance()),
    }
}

/// An adapter on which a device is the host's. Errors: INVALID_ARGUMENT; UNSUPPORTED.
#[cfg(not(target_vendor = "apple"))]
pub fn host_adapter(host: HostVulkan, release: &Arc<ReleaseGuard>) -> Result<Adapter> {
    vulkan_host::adapter(host, release)
}

/// Errors: UNSUPPORTED.
#[cfg(target_vendor = "apple")]
pub fn vulkan_requirements(_: Option<&HostVulkan>) -> Result<Requirements> {
    shares_nothing(Backend::Metal)
}

/// Errors: UNSUPPORTED.
#[cfg(target_vendor = "apple")]
pub fn host_adapter(_: HostVulkan, _: &Arc<ReleaseGuard>) -> Result<Adapter> {
    shares_nothing(Backend::Metal)
}
