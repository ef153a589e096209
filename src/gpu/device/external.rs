// SPDX-License-Identifier: MIT OR Apache-2.0
//! Memory and semaphores that a device shares with hosts: what they are and which kinds a device has, in the words of
//! `BhrTargetOptions`. The folder `vulkan` makes them; no other interface does. Knows no frames.

use super::adapter::Adapter;
use super::wgpu_device::Device;
use crate::deferred;
use crate::error::{Error, Result};
use crate::image::PixelFormat;
use crate::tracer::Backend;
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Bits of handles: `BHR_HANDLE_*`.
pub const OPAQUE_FD: u32 = 1;
pub const HOST_POINTER: u32 = 64;
/// The handles that no machine has run yet: dma-buf, Win32, D3D12, D3D11, Apple's.
pub const NOT_RUN: u32 = 2 | 4 | 8 | 16 | 32;

/// The handles that a device shares, as bits: `BhrInteropInfo`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sharing {
    pub export_images: u32,
    pub export_buffers: u32,
    pub import_images: u32,
    pub import_buffers: u32,
    /// Of timelines, and of binary ones.
    pub semaphores: [u32; 2],
}

/// By what other interfaces know the adapter. Zeros: not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AdapterIds {
    pub device: [u8; 16],
    pub driver: [u8; 16],
    pub luid: Option<[u8; 8]>,
    /// The DRM render node's numbers.
    pub drm: Option<[i64; 2]>,
}

/// A target as a host asks for it.
#[derive(Clone, Copy, Debug)]
pub struct TargetShape {
    /// An image, else rows in a buffer.
    pub image: bool,
    pub format: PixelFormat,
    pub size: [u32; 2],
    /// Bytes from row to row of a buffer.
    pub row_stride: u64,
    /// VkImageLayout that frames leave an image in.
    pub layout: i32,
    /// The handle that its memory is passed by; 0: none.
    pub handle: u32,
}

impl TargetShape {
    /// Bytes from the first pixel of a buffer to the last.
    pub fn bytes(&self) -> u64 {
        let [width, height] = self.size.map(u64::from);
        self.row_stride * (height - 1) + width * self.format.bytes_per_pixel() as u64
    }
}

/// Tells a host that bhr has done with something of its.
pub type Release = Box<dyn FnOnce() + Send + Sync>;

/// Calls a host's release when the last holder lets it go, if what it is for was made.
#[derive(Default)]
pub struct ReleaseGuard {
    release: Mutex<Option<Release>>,
    made: AtomicBool,
}

impl ReleaseGuard {
    pub fn new(release: Option<Release>) -> Arc<Self> {
        Arc::new(Self { release: Mutex::new(release), made: AtomicBool::new(false) })
    }

    /// From now on the host is to be told.
    pub fn made(&self) {
        self.made.store(true, Ordering::Relaxed);
    }
}

impl Drop for ReleaseGuard {
    fn drop(&mut self) {
        let release = self.release.get_mut().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(release) = release.filter(|_| self.made.load(Ordering::Relaxed)) {
            // The host's code runs under no lock.
            let _ = deferred::run(0, release);
        }
    }
}

/// A host's lock around its queue.
pub struct QueueLock {
    pub lock: Box<dyn Fn() + Send + Sync>,
    pub unlock: Box<dyn Fn() + Send + Sync>,
}

/// A Vulkan device of a host's, as it says; `device` 0: none yet.
pub struct HostVulkan {
    pub api_version: u32,
    pub get_instance_proc_addr: *const c_void,
    pub instance: usize,
    pub physical_device: usize,
    pub device: usize,
    pub queue_family: u32,
    pub queue_index: u32,
    pub instance_extensions: Vec<CString>,
    pub device_extensions: Vec<CString>,
    pub lock: Option<Arc<QueueLock>>,
}

/// The needs of bhr on a physical device, or, without one, of an instance. Static: they are kept for the process.
#[derive(Clone, Copy)]
pub struct Requirements {
    pub api_version: u32,
    pub instance_extensions: &'static [*const c_char],
    pub device_extensions: &'static [*const c_char],
    /// A VkPhysicalDeviceFeatures2, or NULL.
    pub features: *const c_void,
}

/// The host's device, checked.
pub(in crate::gpu) struct HostDevice {
    pub(in crate::gpu) device: u64,
    pub(in crate::gpu) queue_family: u32,
    pub(in crate::gpu) queue_index: u32,
    pub(in crate::gpu) extensions: Vec<&'static CStr>,
    pub(in crate::gpu) lock: Option<Arc<QueueLock>>,
    pub(in crate::gpu) release: Arc<ReleaseGuard>,
}

/// Where the memory of a target comes from.
pub enum TargetOrigin {
    New,
    /// Memory of the host's: a file descriptor, which stays the caller's.
    Descriptor(i32, MemoryInfo),
    /// The host's own pixels.
    Pointer(*mut c_void, MemoryInfo),
    /// A VkImage of the host's, on its own device.
    Image {
        image: u64,
        usage: u32,
        copy: bool,
        release: Arc<ReleaseGuard>,
    },
}

/// The memory behind a target, as another device must import it: the fields of `BhrTargetInfo`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryInfo {
    pub vk_format: u32,
    pub vk_usage: u32,
    pub vk_flags: u32,
    pub vk_tiling: u32,
    pub dedicated: bool,
    pub memory_type: u32,
    pub allocation_size: u64,
    pub offset: u64,
}

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
        let bytes = device.counted(memory.allocation_size);
        Self { resource, shape, memory, raw, raw_memory, leaves, bytes }
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

/// Kinds of semaphores, in the order of `BHR_SEMAPHORE_*`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SemaphoreKind {
    Timeline,
    Binary,
}

/// Where a semaphore comes from.
#[derive(Clone, Copy, Debug)]
pub enum SemaphoreOrigin {
    /// To be exported by this handle; 0: by none.
    New(u32),
    /// A file descriptor, which stays the caller's.
    Descriptor(i32),
    /// A VkSemaphore of the host's, on its own device.
    Host(u64),
}

#[cfg(not(target_vendor = "apple"))]
pub use super::vulkan::semaphore::GpuSemaphore;

/// No interface here has semaphores.
#[cfg(target_vendor = "apple")]
pub enum GpuSemaphore {}

/// None is ever made.
#[cfg(target_vendor = "apple")]
impl GpuSemaphore {
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

    pub fn wait(&self, _: u64, _: std::time::Duration) -> Result<bool> {
        match *self {}
    }

    pub fn signal(&self, _: u64) -> Result<()> {
        match *self {}
    }
}

/// A semaphore, and the value that a timeline is to have; none for binary ones.
#[derive(Clone)]
pub struct SemaphoreUse {
    pub semaphore: Arc<GpuSemaphore>,
    pub value: Option<u64>,
}

/// The semaphores that a frame waits for before it writes its target, and those that it signals when it has.
#[derive(Clone, Default)]
pub struct FrameSync {
    pub waits: Vec<SemaphoreUse>,
    pub signals: Vec<SemaphoreUse>,
}

/// The part of a frame's handover that goes with one submission.
#[derive(Default)]
pub struct Handover<'a> {
    /// A target that this submission is the first of its frame to write.
    pub(in crate::gpu) takes: Option<&'a GpuTarget>,
    /// A target that it is the last to write.
    pub(in crate::gpu) gives: Option<&'a GpuTarget>,
    pub(in crate::gpu) waits: &'a [SemaphoreUse],
    pub(in crate::gpu) signals: &'a [SemaphoreUse],
}

/// Why nothing is shared. Errors: UNSUPPORTED.
pub fn shares_nothing<T>(backend: Backend) -> Result<T> {
    Err(Error::unsupported(format!(
        "frames that stay on the GPU need a device of Vulkan 1.2, and this context is on {backend}; use bhr_render_image"
    )))
}

impl Device {
    /// Lets go of bind groups that were kept, and of what they bind.
    pub fn bindings_forgotten(&self) {
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

/// What instances must have (without a physical device), or devices. Errors: INVALID_ARGUMENT; UNSUPPORTED.
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
