// SPDX-License-Identifier: MIT OR Apache-2.0
//! Contexts on a VkDevice of the host's: what it must have, and the host's own images and semaphores.

use super::callback::InsideCallback;
use super::context::{self, BhrContext, BhrContextOptions};
use super::entry::{anywhere, outside_callbacks};
use super::interop_semaphore::{self, BhrSemaphore, BhrSemaphoreKind};
use super::interop_target::{self, BHR_TARGET_COPY, BhrTarget, BhrTargetOptions};
use super::log::User;
use super::pointer::Out;
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, POINTER, Versioned};
use crate::error::{Error, Result};
use crate::gpu::{self, HostVulkan, QueueLock, Release, ReleaseGuard, SemaphoreOrigin, TargetOrigin};
use crate::thread_state::Call;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Arc;

/// vkGetInstanceProcAddr, cast to this type.
pub type BhrGetInstanceProcAddr = Option<unsafe extern "C" fn()>;
/// Locks or unlocks the host's queue for the calling thread, which may be one of bhr's. It must not call bhr.
pub type BhrQueueLockFn = Option<unsafe extern "C" fn(user: *mut c_void)>;
/// Tells the host that bhr uses one of its objects no more. It runs inside a bhr_ call or on a thread of bhr's, and
/// must not call bhr.
pub type BhrReleaseFn = Option<unsafe extern "C" fn(user: *mut c_void)>;

/// The needs of bhr on an instance and a device of the host's. All that it points to is the library's and never
/// freed. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrVulkanRequirements {
    /// sizeof(BhrVulkanRequirements), set by the caller.
    pub struct_size: u32,
    /// VkApplicationInfo.apiVersion at least: VK_API_VERSION_1_3, or the version of a device that has 1.2.
    pub api_version: u32,
    /// Names for VkInstanceCreateInfo, which must be enabled.
    pub instance_extensions: *const *const c_char,
    /// How many.
    pub instance_extension_count: u32,
    /// How many device_extensions has.
    pub device_extension_count: u32,
    /// Names for VkDeviceCreateInfo, which must be enabled (but for VK_KHR_external_semaphore_fd,
    /// VK_EXT_queue_family_foreign and VK_EXT_external_memory_host, which add to BhrInteropInfo only).
    pub device_extensions: *const *const c_char,
    /// A VkPhysicalDeviceFeatures2 with its chain: features that must be on. It may be the pNext of
    /// VkDeviceCreateInfo as it is; a host with features of its own ORs them in (where it has
    /// VkPhysicalDeviceVulkan1xFeatures, into those: Vulkan forbids both). NULL without a physical device.
    pub features: *const c_void,
}

// SAFETY: repr(C), size first, no padding, integers and nullable pointers.
unsafe impl Versioned for BhrVulkanRequirements {
    const NAME: &'static str = "BhrVulkanRequirements";
    const SIZES: &'static [usize] = &[16 + 3 * POINTER];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            api_version: 0,
            instance_extensions: null(),
            instance_extension_count: 0,
            device_extension_count: 0,
            device_extensions: null(),
            features: null(),
        }
    }
}

/// A Vulkan device of the host's. Cleared (memset) and filled in by the host. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrVulkanDevice {
    /// sizeof(BhrVulkanDevice).
    pub struct_size: u32,
    /// VkApplicationInfo.apiVersion as vkCreateInstance was told, not what the loader has.
    pub api_version: u32,
    /// vkGetInstanceProcAddr.
    pub get_instance_proc_addr: BhrGetInstanceProcAddr,
    /// VkInstance.
    pub instance: *mut c_void,
    /// VkPhysicalDevice.
    pub physical_device: *mut c_void,
    /// VkDevice.
    pub device: *mut c_void,
    /// The family of a queue with GRAPHICS and COMPUTE, which the device was created with.
    pub queue_family: u32,
    /// Its index in the family.
    pub queue_index: u32,
    /// Names of the extensions that the instance has enabled. Read during the call only.
    pub instance_extensions: *const *const c_char,
    /// Names of the extensions that the device has enabled. Read during the call only.
    pub device_extensions: *const *const c_char,
    /// How many.
    pub instance_extension_count: u32,
    /// How many.
    pub device_extension_count: u32,
    /// Called before and after all that bhr does to the queue (vkQueueSubmit, vkQueuePresentKHR, vkQueueWaitIdle),
    /// from any thread, never nested. The host takes the same lock around its own use of the queue, and around
    /// vkDeviceWaitIdle; it must not hold it while it calls bhr. NULL, both: nobody else uses the queue while a bhr_
    /// call of this context runs or a job of it is unfinished. docs/gpu.md.
    pub lock: BhrQueueLockFn,
    /// See lock.
    pub unlock: BhrQueueLockFn,
    /// Handed to lock and unlock.
    pub lock_user: *mut c_void,
    /// Called when device and instance may be destroyed. NULL: when bhr_context_destroy has returned.
    pub release: BhrReleaseFn,
    /// Handed to release.
    pub release_user: *mut c_void,
}

// SAFETY: repr(C), size first, no padding, integers and nullable pointers.
unsafe impl Versioned for BhrVulkanDevice {
    const NAME: &'static str = "BhrVulkanDevice";
    const SIZES: &'static [usize] = &[24 + 11 * POINTER];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            api_version: 0,
            get_instance_proc_addr: None,
            instance: null_mut(),
            physical_device: null_mut(),
            device: null_mut(),
            queue_family: 0,
            queue_index: 0,
            instance_extensions: null(),
            device_extensions: null(),
            instance_extension_count: 0,
            device_extension_count: 0,
            lock: None,
            unlock: None,
            lock_user: null_mut(),
            release: None,
            release_user: null_mut(),
        }
    }
}

/// A callback of the host's with its argument.
struct HostCall {
    function: unsafe extern "C" fn(*mut c_void),
    user: User,
}

impl HostCall {
    fn run(&self) {
        // SAFETY: the host gave this function with this pointer.
        InsideCallback::progress().run(|| unsafe { (self.function)(self.user.0) });
    }
}

fn release_of(function: BhrReleaseFn, user: *mut c_void) -> Arc<ReleaseGuard> {
    let call = function.map(|function| HostCall { function, user: User(user) });
    ReleaseGuard::new(call.map(|call| Box::new(move || call.run()) as Release))
}

/// More names than any device has.
const MOST_NAMES: u32 = 4096;

/// # Safety
/// `list` is NULL or has `count` entries, each NULL or a C string.
unsafe fn read_names(list: *const *const c_char, count: u32, name: &str) -> Result<Vec<CString>> {
    if count > MOST_NAMES {
        return Err(Error::argument(format!("{name}_count is {count}; it must lie in [0, {MOST_NAMES}]")));
    }
    if count > 0 && list.is_null() {
        return Err(Error::argument(format!("{name}s is NULL and {name}_count {count}")));
    }
    (0..count as usize)
        .map(|i| {
            // SAFETY: this function's contract.
            let text = unsafe { list.add(i).read_unaligned() };
            if text.is_null() {
                return Err(Error::argument(format!("{name}s[{i}] is NULL")));
            }
            // SAFETY: as above.
            Ok(unsafe { CStr::from_ptr(text) }.to_owned())
        })
        .collect()
}

fn loader(function: BhrGetInstanceProcAddr) -> *const c_void {
    function.map_or(null(), |function| function as *const c_void)
}

/// Sets struct_size and clears the rest. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_vulkan_requirements_init(
    requirements: *mut BhrVulkanRequirements,
    struct_size: usize,
) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_vulkan_requirements_init", || unsafe { versioned::init(requirements, "requirements", struct_size) })
}

/// Says what bhr needs; physical_device NULL: of an instance only, and then instance may be NULL too. instance must
/// have been made with instance_extensions and api_version. A device that was made with all features and extensions
/// that the physical device has serves as well.
/// Errors: INVALID_ARGUMENT for a function that finds no functions, or a physical device that is not the instance's;
/// UNSUPPORTED, with the reason, for a physical device that cannot serve (Vulkan before 1.2, a first queue family
/// without GRAPHICS, too low limits), and on macOS and iOS. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_vulkan_requirements(
    get_instance_proc_addr: BhrGetInstanceProcAddr,
    instance: *mut c_void,
    physical_device: *mut c_void,
    requirements: *mut BhrVulkanRequirements,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = OutStruct::cleared(requirements, "requirements");
        outside_callbacks("bhr_vulkan_requirements", || {
            out.set(&BhrVulkanRequirements::defaults())?;
            let named = gpu::vulkan_requirements(None)?;
            // SAFETY: names of the library's.
            let names = named.instance_extensions.iter().map(|name| CStr::from_ptr(*name).to_owned()).collect();
            let host = (!physical_device.is_null()).then(|| HostVulkan {
                api_version: u32::MAX,
                get_instance_proc_addr: loader(get_instance_proc_addr),
                instance: instance.addr(),
                physical_device: physical_device.addr(),
                device: 0,
                queue_family: 0,
                queue_index: 0,
                instance_extensions: names,
                device_extensions: Vec::new(),
                lock: None,
            });
            let found = gpu::vulkan_requirements(host.as_ref())?;
            out.set(&BhrVulkanRequirements {
                api_version: found.api_version,
                instance_extensions: found.instance_extensions.as_ptr(),
                instance_extension_count: found.instance_extensions.len() as u32,
                device_extension_count: found.device_extensions.len() as u32,
                device_extensions: match found.device_extensions {
                    [] => null(),
                    list => list.as_ptr(),
                },
                features: found.features,
                ..BhrVulkanRequirements::defaults()
            })
        })
    }
}

/// # Safety
/// The names are valid.
unsafe fn host_of(given: &BhrVulkanDevice) -> Result<HostVulkan> {
    let lock = match (given.lock, given.unlock) {
        (None, None) => None,
        (Some(lock), Some(unlock)) => {
            let [lock, unlock] = [lock, unlock].map(|function| HostCall { function, user: User(given.lock_user) });
            Some(Arc::new(QueueLock { lock: Box::new(move || lock.run()), unlock: Box::new(move || unlock.run()) }))
        }
        _ => return Err(Error::argument("device lock or unlock is NULL; both are needed, or none")),
    };
    // SAFETY: this function's contract.
    let [instance_extensions, device_extensions] = unsafe {
        [
            read_names(given.instance_extensions, given.instance_extension_count, "device instance_extension")?,
            read_names(given.device_extensions, given.device_extension_count, "device device_extension")?,
        ]
    };
    Ok(HostVulkan {
        api_version: given.api_version,
        get_instance_proc_addr: loader(given.get_instance_proc_addr),
        instance: given.instance.addr(),
        physical_device: given.physical_device.addr(),
        device: given.device.addr(),
        queue_family: given.queue_family,
        queue_index: given.queue_index,
        instance_extensions,
        device_extensions,
        lock,
    })
}

/// Sets struct_size and clears the rest. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_vulkan_device_init(device: *mut BhrVulkanDevice, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_vulkan_device_init", || unsafe { versioned::init(device, "device", struct_size) })
}

/// Makes a context, as bhr_context_create does, that works on a device of the host's: its frames go into the host's
/// own images. The device must have what bhr_vulkan_requirements says; a missing extension is found, and named, a
/// missing feature cannot be. Instance, device and queue must live until the release callback, or, without one,
/// until bhr_context_destroy has returned. options: backend AUTO or VULKAN, adapter_index -1, no
/// BHR_CONTEXT_VALIDATION, compatible_window NULL; NULL means all defaults. bhr_context_recover is UNSUPPORTED on
/// such a context: after DEVICE_LOST destroy it, and make the device anew. docs/gpu.md.
/// Errors: those of bhr_context_create; INVALID_ARGUMENT for what is not as it must be; UNSUPPORTED for a device
/// that cannot serve. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_context_create_vulkan(
    abi_version: u32,
    options: *const BhrContextOptions,
    device: *const BhrVulkanDevice,
    out_context: *mut *mut BhrContext,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_context);
        outside_callbacks("bhr_context_create_vulkan", || {
            out.required("out_context")?;
            let given = versioned::read(device, "device")?;
            let host = host_of(&given)?;
            let release = release_of(given.release, given.release_user);
            out.set(Box::into_raw(context::create_on_host(abi_version, options, host, &release)?));
            Ok(())
        })
    }
}

/// Makes a target of a VkImage of a host whose device the context is on. The image: 2-D, one sample, one mip level
/// and layer, of the size and format of options (RGBA8_SRGB: R8G8B8A8_UNORM; BGRA8_SRGB: B8G8R8A8_UNORM, with
/// BHR_TARGET_COPY), SHARING_MODE_EXCLUSIVE or concurrent with bhr's family. vk_usage is what it was created with:
/// STORAGE, or TRANSFER_DST for BHR_TARGET_COPY. options->kind is IMAGE and handle_type 0; frames leave the image in
/// options->layout, in bhr's queue family, and take it from any layout, without its contents. release, unless NULL,
/// is called when bhr uses the image no more; without one the image must live until bhr_context_destroy has
/// returned.
/// Errors: INVALID_STATE for a context that is not on a host's device; UNSUPPORTED for an image that the device does
/// not have so. release is not called after an error. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_wrap_vulkan(
    context: *mut BhrContext,
    options: *const BhrTargetOptions,
    vk_image: u64,
    vk_usage: u32,
    release: BhrReleaseFn,
    release_user: *mut c_void,
    out_target: *mut *mut BhrTarget,
) -> BhrStatus {
    let _call = Call::enter();
    let release = release_of(release, release_user);
    // SAFETY: NULL or valid, by the header's conventions.
    let status = unsafe {
        interop_target::make("bhr_target_wrap_vulkan", context, options, out_target, true, |state, shape, flags| {
            state.renderer.check_is_hosts()?;
            if vk_image == 0 {
                return Err(Error::argument("vk_image is VK_NULL_HANDLE"));
            }
            if !shape.image || shape.handle != 0 {
                return Err(Error::argument("options kind must be BHR_TARGET_IMAGE (0) and handle_type 0 here"));
            }
            let copy = flags & BHR_TARGET_COPY != 0;
            Ok(TargetOrigin::Image { image: vk_image, usage: vk_usage, copy, release: release.clone() })
        })
    };
    if status >= super::status::BHR_OK {
        release.made();
    }
    status
}

/// Makes a semaphore of a VkSemaphore of a host whose device the context is on, which is of this kind. It must live
/// until bhr_context_destroy has returned, or until the semaphore is destroyed and every frame that uses it has
/// ended.
/// Errors: INVALID_STATE for a context that is not on a host's device. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_semaphore_wrap_vulkan(
    context: *mut BhrContext,
    kind: BhrSemaphoreKind,
    vk_semaphore: u64,
    out_semaphore: *mut *mut BhrSemaphore,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        interop_semaphore::make("bhr_semaphore_wrap_vulkan", context, kind, out_semaphore, |state| {
            state.renderer.check_is_hosts()?;
            match vk_semaphore {
                0 => Err(Error::argument("vk_semaphore is VK_NULL_HANDLE")),
                raw => Ok(SemaphoreOrigin::Host(raw)),
            }
        })
    }
}
