// SPDX-License-Identifier: MIT OR Apache-2.0
//! Memory and semaphores that a device shares with hosts: what they are and which kinds a device has, in the words of
//! `BhrTargetOptions`. Plain values: `sharing` has what is made of them.

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
    /// The handles of timelines, and those of binary semaphores.
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
        self.row_stride * u64::from(self.size[1].saturating_sub(1)) + self.row_bytes()
    }

    /// Bytes of a row itself.
    pub fn row_bytes(&self) -> u64 {
        u64::from(self.size[0]) * self.format.bytes_per_pixel() as u64
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
#[cfg_attr(not(shares_memory), expect(dead_code, reason = "hosts' devices are Vulkan's"))]
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

/// Why nothing is shared. Errors: UNSUPPORTED.
pub fn shares_nothing<T>(backend: Backend) -> Result<T> {
    Err(Error::unsupported(format!(
        "frames that stay on the GPU need a device of Vulkan 1.2, this context is on {backend}; use bhr_render_image"
    )))
}
