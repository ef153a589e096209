// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `vulkan` on Apple's systems, where wgpu has none: no device has its parts, and there are no
//! semaphores.

pub(in crate::gpu) mod parts {
    use crate::gpu::device::external::{AdapterIds, Sharing};

    /// There are none.
    pub enum VulkanParts {}

    impl VulkanParts {
        pub fn of(_: &wgpu::Device) -> Option<Self> {
            None
        }

        pub fn blocks_in_submit(&self) -> bool {
            match *self {}
        }

        pub fn sharing(&self) -> Sharing {
            match *self {}
        }
    }

    pub(in crate::gpu) fn ids(_: &wgpu::Adapter) -> Option<AdapterIds> {
        None
    }

    /// `None`: another interface.
    pub(in crate::gpu) fn open(
        _: &wgpu::Adapter,
        _: &wgpu::DeviceDescriptor<'_>,
    ) -> Option<Result<(wgpu::Device, wgpu::Queue), String>> {
        None
    }
}

pub(in crate::gpu) mod barrier {
    use super::parts::VulkanParts;
    use crate::gpu::device::target::{GpuTarget, TargetRead};

    pub(in crate::gpu) fn take(parts: &VulkanParts, _: &mut wgpu::CommandEncoder, _: &GpuTarget) {
        match *parts {}
    }

    pub(in crate::gpu) fn give(parts: &VulkanParts, _: &mut wgpu::CommandEncoder, _: &GpuTarget) {
        match *parts {}
    }

    pub(in crate::gpu) fn read(parts: &VulkanParts, _: &mut wgpu::CommandEncoder, _: &TargetRead) {
        match *parts {}
    }

    pub(in crate::gpu) fn has_read(parts: &VulkanParts, _: &mut wgpu::CommandEncoder, _: &GpuTarget) {
        match *parts {}
    }
}

pub(in crate::gpu) mod semaphore {
    use super::parts::VulkanParts;
    use crate::error::Result;
    use crate::gpu::device::external::{SemaphoreKind, SemaphoreOrigin};
    use std::sync::Arc;
    use std::time::Duration;

    /// There is none.
    pub enum GpuSemaphore {}

    impl GpuSemaphore {
        pub(in crate::gpu) fn new(parts: Arc<VulkanParts>, _: SemaphoreKind, _: SemaphoreOrigin) -> Result<Self> {
            match *parts {}
        }

        pub fn export(&self) -> Result<i32> {
            match *self {}
        }

        pub fn handle(&self) -> u64 {
            match *self {}
        }

        pub fn check_value(&self, _: u64) -> Result<()> {
            match *self {}
        }

        pub fn ask(&self, _: u64) -> Result<()> {
            match *self {}
        }

        pub fn withdraw(&self, _: u64) {
            match *self {}
        }

        pub(in crate::gpu) fn has_submitted(&self, _: u64) {
            match *self {}
        }

        pub fn wait(&self, _: u64, _: Duration) -> Result<bool> {
            match *self {}
        }

        pub fn signal(&self, _: u64) -> Result<()> {
            match *self {}
        }
    }

    pub(in crate::gpu) fn stage<'a>(
        _: &wgpu::Queue,
        _: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
        _: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
    ) {
    }

    pub(in crate::gpu) fn unstage<'a>(
        _: &wgpu::Queue,
        _: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
        _: impl ExactSizeIterator<Item = (&'a GpuSemaphore, Option<u64>)>,
    ) {
    }
}
