// SPDX-License-Identifier: MIT OR Apache-2.0
//! Targets that a device shares with hosts, and those of them that a frame reads. Knows no device, no frames, and not
//! how targets are made.

use super::bindings::BindGroupCache;
use super::counted::Counted;
use super::external::{MemoryInfo, TargetShape};
use crate::error::{Error, Result};
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
#[cfg_attr(not(shares_memory), expect(dead_code, reason = "nothing is shared with hosts there"))]
pub struct GpuTarget {
    pub resource: TargetResource,
    pub shape: TargetShape,
    pub memory: MemoryInfo,
    /// The VkImage or VkBuffer, and the VkDeviceMemory: to be used only while the resource is known to exist.
    pub(in crate::gpu) raw: u64,
    pub(in crate::gpu) raw_memory: u64,
    /// Whether frames hand it over to another device.
    pub(in crate::gpu) leaves: bool,
    bytes: Counted,
    /// The groups that may bind it.
    bindings: Arc<BindGroupCache>,
    /// The host has ended it; a submission may still read it.
    ended: AtomicBool,
}

impl GpuTarget {
    /// `bytes`: of its memory, as the device counts them.
    #[cfg_attr(not(shares_memory), expect(dead_code, reason = "nothing is shared with hosts there"))]
    pub(in crate::gpu) fn new(
        (bytes, bindings): (Counted, Arc<BindGroupCache>),
        resource: TargetResource,
        shape: TargetShape,
        memory: MemoryInfo,
        [raw, raw_memory]: [u64; 2],
        leaves: bool,
    ) -> Self {
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

/// A target that a frame reads: an image by way of a buffer of bhr's, a buffer in that way or as it is.
#[cfg_attr(not(shares_memory), expect(dead_code, reason = "nothing is shared with hosts there"))]
pub struct TargetRead {
    pub target: Arc<GpuTarget>,
    /// The buffer that it is copied into.
    pub staged: Option<Arc<GpuTarget>>,
}
