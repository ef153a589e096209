// SPDX-License-Identifier: MIT OR Apache-2.0
//! Vulkan devices of hosts: what they must have, the checks without which wgpu would fail badly, and their way into
//! wgpu. wgpu takes for granted what a device of its own would have, and finds out by a missing function, which ends
//! the process; so everything that can be asked is asked first.

use super::adapter::{Adapter, device_descriptor};
use super::driver_lock;
use super::external::{AdapterIds, HostDevice, HostVulkan, ReleaseGuard, Requirements};
use super::vulkan::failed;
use super::vulkan::parts::{WANTED, ids};
use crate::error::{Error, Result};
use ash::vk::Handle;
use ash::{khr, vk};
use std::ffi::{CStr, c_char, c_void};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::hal;
use wgpu::hal::api::Vulkan;
use wgpu::hal::vulkan::PhysicalDeviceFeatures;

/// Extensions of instances that wgpu looks for by their names. Without the first it asks for no features, whatever the
/// version; the second is what VK_KHR_swapchain, which it wants of devices, rests on.
const OF_INSTANCE: [&CStr; 8] = [
    khr::get_physical_device_properties2::NAME,
    khr::surface::NAME,
    khr::xlib_surface::NAME,
    khr::xcb_surface::NAME,
    khr::wayland_surface::NAME,
    khr::android_surface::NAME,
    khr::win32_surface::NAME,
    khr::get_surface_capabilities2::NAME,
];
/// The number of extensions, the first of `OF_INSTANCE`, that must be there.
const NEEDED_OF_INSTANCE: usize = 2;

/// Functions that are called before wgpu has looked at anything.
const OF_LOADER: [&CStr; 6] = [
    c"vkEnumeratePhysicalDevices",
    c"vkGetPhysicalDeviceProperties",
    c"vkGetPhysicalDeviceProperties2",
    c"vkGetPhysicalDeviceQueueFamilyProperties",
    c"vkEnumerateDeviceExtensionProperties",
    c"vkGetDeviceProcAddr",
];
/// Functions of version 1.2 that wgpu calls.
const OF_DEVICE: [&CStr; 3] = [c"vkGetSemaphoreCounterValue", c"vkWaitSemaphores", c"vkSignalSemaphore"];

/// The requirements of a physical device with these ids and this version.
struct Asked(AdapterIds, u32, Requirements);

// SAFETY: nobody writes what the pointers lead to.
unsafe impl Send for Asked {}

/// The requirements of each physical device that was asked for.
static ASKED: Mutex<Vec<Asked>> = Mutex::new(Vec::new());

fn instance_extensions() -> &'static [*const c_char] {
    struct List([*const c_char; NEEDED_OF_INSTANCE]);
    // SAFETY: nobody writes what the pointers lead to.
    unsafe impl Sync for List {}
    static LIST: List = List([OF_INSTANCE[0].as_ptr(), OF_INSTANCE[1].as_ptr()]);
    &LIST.0
}

/// The requirements of instances. Errors: none, where there is Vulkan.
pub(in crate::gpu) fn of_instance() -> Result<Requirements> {
    let instance_extensions = instance_extensions();
    Ok(Requirements {
        api_version: vk::API_VERSION_1_3,
        instance_extensions,
        device_extensions: &[],
        features: std::ptr::null(),
    })
}

/// The host's function that finds functions. Errors: INVALID_ARGUMENT for NULL, or one that does not know what every
/// loader of version 1.1 has.
fn loader(find: *const c_void, instance: vk::Instance) -> Result<ash::StaticFn> {
    if find.is_null() {
        return Err(Error::argument("get_instance_proc_addr is NULL"));
    }
    // SAFETY: not NULL, hence vkGetInstanceProcAddr by the header.
    let find = unsafe { std::mem::transmute::<*const c_void, vk::PFN_vkGetInstanceProcAddr>(find) };
    for name in OF_LOADER {
        // SAFETY: an instance of the host's, and a name.
        if unsafe { find(instance, name.as_ptr()) }.is_none() {
            let name = name.to_string_lossy();
            return Err(Error::argument(format!("get_instance_proc_addr finds no {name} for this instance")));
        }
    }
    Ok(ash::StaticFn { get_instance_proc_addr: find })
}

/// The host's instance and physical device for wgpu, and their version. Errors: INVALID_ARGUMENT; UNSUPPORTED.
fn exposed(
    host: &HostVulkan,
    release: Arc<ReleaseGuard>,
) -> Result<(hal::vulkan::Instance, hal::ExposedAdapter<Vulkan>, u32)> {
    let (instance, physical) = (vk::Instance::from_raw(host.instance as u64), host.physical_device as u64);
    if host.instance == 0 || host.physical_device == 0 {
        return Err(Error::argument("instance or physical_device is NULL"));
    }
    let loader = loader(host.get_instance_proc_addr, instance)?;
    // SAFETY: the instance is alive, by the header.
    let raw = unsafe { ash::Instance::load(&loader, instance) };
    // SAFETY: as above; the function is there.
    let list = unsafe { raw.enumerate_physical_devices() };
    let list = list.map_err(|error| failed("vkEnumeratePhysicalDevices", error))?;
    let physical = list.into_iter().find(|one| one.as_raw() == physical);
    let physical = physical.ok_or_else(|| Error::argument("physical_device is none of instance's"))?;
    // SAFETY: it is the instance's.
    let of_device = unsafe { raw.get_physical_device_properties(physical) }.api_version;
    let version = |version: u32| format!("{}.{}", vk::api_version_major(version), vk::api_version_minor(version));
    if of_device < vk::API_VERSION_1_2 {
        return Err(Error::unsupported(format!("the device is of Vulkan {}; 1.2 is needed", version(of_device))));
    }
    let needed = of_device.min(vk::API_VERSION_1_3);
    let needed = vk::make_api_version(0, vk::api_version_major(needed), vk::api_version_minor(needed), 0);
    if host.api_version < needed {
        return Err(Error::argument(format!(
            "api_version is {} ({:#x}); an instance for this device must be made with {}",
            version(host.api_version),
            host.api_version,
            version(needed)
        )));
    }
    let has = |name: &CStr| host.instance_extensions.iter().any(|given| given.as_c_str() == name);
    if let Some(missing) = OF_INSTANCE.iter().take(NEEDED_OF_INSTANCE).find(|name| !has(name)) {
        let name = missing.to_string_lossy();
        return Err(Error::argument(format!("instance_extensions has no {name}, which must be enabled")));
    }
    let known = OF_INSTANCE.into_iter().filter(|name| has(name)).collect();
    let instance = {
        // SAFETY: the function finds what the loader has (above).
        let entry = unsafe { ash::Entry::from_static_fn(loader) };
        let flags = wgpu::InstanceFlags::empty();
        let ends: hal::DropCallback = Box::new(move || drop(release));
        // SAFETY: the instance lives until the callback runs, by the header, has these extensions and is of this
        // version.
        unsafe {
            hal::vulkan::Instance::from_raw(
                entry,
                raw,
                host.api_version,
                0,
                None,
                known,
                flags,
                Default::default(),
                false,
                Some(ends),
            )
        }
    };
    let instance = instance.map_err(|error| Error::unsupported(format!("the instance cannot be used: {error}")))?;
    let exposed = instance.expose_adapter(physical).ok_or_else(|| {
        Error::unsupported("the physical device cannot be used: its first queue family has no GRAPHICS")
    })?;
    Ok((instance, exposed, of_device))
}

/// The names of all device extensions that wgpu has on, and of bhr's.
fn device_extensions(adapter: &hal::vulkan::Adapter, features: wgpu::Features) -> (Vec<&'static CStr>, usize) {
    let mut list = adapter.required_device_extensions(features);
    let needed = list.len();
    let capabilities = adapter.physical_device_capabilities();
    let more = WANTED.into_iter().filter(|name| capabilities.supports_extension(name));
    let more = more.filter(|name| !list.contains(name)).collect::<Vec<_>>();
    list.extend(more);
    (list, needed)
}

/// The requirements of a physical device. Errors: INVALID_ARGUMENT; UNSUPPORTED with the reason.
pub(in crate::gpu) fn of_device(host: &HostVulkan) -> Result<Requirements> {
    let _driver = driver_lock::lock();
    let (instance, exposed, version) = exposed(host, Arc::default())?;
    // SAFETY: the adapter is the instance's.
    let (instance, raw) = unsafe {
        let instance = wgpu::Instance::from_hal::<Vulkan>(instance);
        let raw = instance.create_adapter_from_hal(exposed);
        (instance, raw)
    };
    let adapter = Adapter::of_host(raw.clone(), instance, None)?;
    let found = ids(&raw).unwrap_or_default();
    let mut asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(Asked(.., known)) = asked.iter().find(|Asked(ids, of, _)| (*ids, *of) == (found, version)) {
        return Ok(*known);
    }
    let wanted = device_descriptor(adapter.raw()?, true).required_features;
    // SAFETY: nothing is destroyed.
    let hal = unsafe { raw.as_hal::<Vulkan>() }.ok_or_else(|| Error::internal("an adapter of another interface"))?;
    let (list, _) = device_extensions(&hal, wanted);
    let features = Box::leak(Box::new(hal.physical_device_features(&list, wanted)));
    let list = list.into_iter().map(CStr::as_ptr).collect::<Vec<_>>();
    let requirements = Requirements {
        api_version: version.min(vk::API_VERSION_1_3),
        instance_extensions: instance_extensions(),
        device_extensions: Box::leak(list.into_boxed_slice()),
        features: chain(features),
    };
    asked.push(Asked(found, version, requirements));
    Ok(requirements)
}

/// A VkPhysicalDeviceFeatures2 of what wgpu would enable.
fn chain(features: &'static mut PhysicalDeviceFeatures) -> *const c_void {
    let create = features.add_to_device_create(vk::DeviceCreateInfo::default());
    // SAFETY: it points to the features that were leaked, or is NULL.
    let core = unsafe { create.p_enabled_features.as_ref() }.copied().unwrap_or_default();
    let first = vk::PhysicalDeviceFeatures2 { p_next: create.p_next.cast_mut(), features: core, ..Default::default() };
    (&raw const *Box::leak(Box::new(first))).cast()
}

/// An adapter for the host's device, on which `Device::open` then takes that. Errors: INVALID_ARGUMENT for what is not
/// as it must be; UNSUPPORTED.
pub(in crate::gpu) fn adapter(host: HostVulkan, release: &Arc<ReleaseGuard>) -> Result<Adapter> {
    if host.device == 0 {
        return Err(Error::argument("device is NULL"));
    }
    let _driver = driver_lock::lock();
    let (instance, exposed, _) = exposed(&host, release.clone())?;
    // SAFETY: the adapter is the instance's.
    let (instance, raw) = unsafe {
        let instance = wgpu::Instance::from_hal::<Vulkan>(instance);
        let raw = instance.create_adapter_from_hal(exposed);
        (instance, raw)
    };
    let wanted = device_descriptor(&raw, true).required_features;
    let (extensions, shared) = {
        // SAFETY: nothing is destroyed.
        let hal = unsafe { raw.as_hal::<Vulkan>() };
        let hal = hal.ok_or_else(|| Error::internal("an adapter of another interface"))?;
        let (list, needed) = device_extensions(&hal, wanted);
        let has = |name: &CStr| host.device_extensions.iter().any(|given| given.as_c_str() == name);
        if let Some(missing) = list.iter().take(needed).find(|name| !has(name)) {
            let name = missing.to_string_lossy();
            return Err(Error::argument(format!("device_extensions has no {name}, which must be enabled")));
        }
        check_queue(&hal, &host)?;
        (list.into_iter().filter(|name| has(name)).collect(), hal.shared_instance().raw_instance().clone())
    };
    let device = vk::Device::from_raw(host.device as u64);
    for name in OF_DEVICE {
        // SAFETY: the device is alive, by the header.
        if unsafe { shared.get_device_proc_addr(device, name.as_ptr()) }.is_none() {
            let name = name.to_string_lossy();
            return Err(Error::argument(format!("the device has no {name}: was its instance made with api_version?")));
        }
    }
    let HostVulkan { queue_family, queue_index, lock, .. } = host;
    let device = HostDevice {
        device: host.device as u64,
        queue_family,
        queue_index,
        extensions,
        lock,
        release: release.clone(),
    };
    Adapter::of_host(raw, instance, Some(device))
}

/// Errors: INVALID_ARGUMENT for a queue that is not there or cannot serve.
fn check_queue(adapter: &hal::vulkan::Adapter, host: &HostVulkan) -> Result<()> {
    let instance = adapter.shared_instance().raw_instance();
    // SAFETY: the physical device is the instance's.
    let families = unsafe { instance.get_physical_device_queue_family_properties(adapter.raw_physical_device()) };
    let (family, index) = (host.queue_family, host.queue_index);
    let count = families.len();
    let found = families.get(family as usize);
    let found = found.ok_or_else(|| {
        Error::argument(format!("queue_family is {family}; the physical device has {count} families"))
    })?;
    if index >= found.queue_count {
        let count = found.queue_count;
        return Err(Error::argument(format!("queue_index is {index}; family {family} has {count} queues")));
    }
    let needed = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    if !found.queue_flags.contains(needed) {
        let flags = found.queue_flags;
        return Err(Error::argument(format!("queue_family {family} has {flags:?}; it needs GRAPHICS and COMPUTE")));
    }
    Ok(())
}

/// wgpu's device on the host's. Errors: a text.
pub(in crate::gpu) fn open(
    adapter: &wgpu::Adapter,
    host: &HostDevice,
    descriptor: &wgpu::DeviceDescriptor<'_>,
) -> Result<(wgpu::Device, wgpu::Queue), String> {
    let open = {
        // SAFETY: nothing is destroyed.
        let hal = unsafe { adapter.as_hal::<Vulkan>() }.ok_or("an adapter of another interface")?;
        let device = vk::Device::from_raw(host.device);
        // SAFETY: the device is alive, and this finds its functions.
        let raw = unsafe { ash::Device::load(hal.shared_instance().raw_instance().fp_v1_0(), device) };
        let release = host.release.clone();
        let ends: hal::DropCallback = Box::new(move || drop(release));
        // SAFETY: the device lives until the callback runs, and has these extensions; that it has the features is the
        // host's promise. The queue is there (`check_queue`).
        unsafe {
            hal.device_from_raw(
                raw,
                Some(ends),
                &host.extensions,
                descriptor.required_features,
                &descriptor.required_limits,
                &descriptor.memory_hints,
                host.queue_family,
                host.queue_index,
            )
        }
    };
    let open = open.map_err(|error| error.to_string())?;
    // SAFETY: the device was opened on this adapter, with what the descriptor says.
    unsafe { adapter.create_device_from_hal(open, descriptor) }.map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_two_extensions_of_instances_are_the_needed_ones() {
        let needed = instance_extensions();
        assert_eq!(needed.len(), NEEDED_OF_INSTANCE);
        for (pointer, name) in needed.iter().zip(OF_INSTANCE) {
            // SAFETY: names of ash's.
            assert_eq!(unsafe { CStr::from_ptr(*pointer) }, name);
        }
    }
}
