// SPDX-License-Identifier: MIT OR Apache-2.0
//! Targets that a device shares with hosts, and the device's face for making them and semaphores: through Vulkan, or
//! not at all. Knows no frames.

use super::adapter::Adapter;
use super::bindings::BindGroupCache;
use super::external::{
    HostVulkan, MemoryInfo, ReleaseGuard, Requirements, SemaphoreKind, SemaphoreOrigin, Sharing, TargetOrigin,
    TargetShape, shares_nothing,
};
use super::semaphores::GpuSemaphore;
use super::wgpu_device::Device;
use crate::error::{Error, Result};
#[cfg(target_vendor = "apple")]
use crate::tracer::Backend;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The place that frames are written to. wgpu frees it after the last use.
pub enum TargetResource {
    /// The rows of a buffer.
    Buffer(wgpu::Buffer),
    /// An image that kernels write.
    Written(wgpu::Texture, wgpu::TextureView),
    /// An image that a copy fills.
    Copied(wgpu::Texture),
}

/// A picture on the device that a host reaches too.
pub struct GpuTarget {
    pub resource: TargetResource,
    pub shape: TargetShape,
    pub memory: MemoryInfo,
    /// The VkImage or VkBuffer, and the VkDeviceMemory: to be used only while the resource is known to exist.
    pub(in crate::gpu) raw: u64,
    pub(in crate::gpu) raw_memory: u64,
    /// Whether frames hand it over to another device.
    pub(in crate::gpu) leaves: bool,
    bytes: super::buffer::Counted,
    /// The groups that may bind it.
    bindings: Arc<BindGroupCache>,
    /// The host has ended it; a submission may still read it.
    ended: AtomicBool,
}

impl GpuTarget {
    pub(in crate::gpu) fn new(
        device: &Device,
        resource: TargetResource,
        shape: TargetShape,
        memory: MemoryInfo,
        [raw, raw_memory]: [u64; 2],
        leaves: bool,
    ) -> Self {
        let (bytes, bindings) = (device.counted(memory.allocation_size), device.bindings.clone());
        Self { resource, shape, memory, raw, raw_memory, leaves, bytes, bindings, ended: AtomicBool::new(false) }
    }

    /// No frame may read it from now on.
    pub fn end(&self) {
        self.ended.store(true, Ordering::Release);
    }

    pub fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }

    /// Errors: UNSUPPORTED for an image without the use for copies out of it.
    pub fn check_is_read(&self) -> Result<()> {
        // VK_IMAGE_USAGE_TRANSFER_SRC_BIT.
        let usage = self.memory.vk_usage;
        if self.shape.image && usage & 1 == 0 {
            return Err(Error::unsupported(format!(
                "target has vk_usage {usage:#x}; an image that frames read needs TRANSFER_SRC (0x1)"
            )));
        }
        Ok(())
    }

    /// The VkImage or VkBuffer.
    pub fn handle(&self) -> u64 {
        self.raw
    }

    /// Bytes that the device counts for it.
    pub fn bytes(&self) -> u64 {
        self.bytes.bytes()
    }
}

impl Drop for GpuTarget {
    fn drop(&mut self) {
        // Groups that are kept would keep its memory, and the host's image, until another resource is made.
        self.bindings.clear();
    }
}

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
        Some(host) => super::vulkan::host::of_device(host),
        None => Ok(super::vulkan::host::of_instance()),
    }
}

/// An adapter on which a device is the host's. Errors: INVALID_ARGUMENT; UNSUPPORTED.
#[cfg(not(target_vendor = "apple"))]
pub fn host_adapter(host: HostVulkan, release: &Arc<ReleaseGuard>) -> Result<Adapter> {
    super::vulkan::host::adapter(host, release)
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
