// SPDX-License-Identifier: MIT OR Apache-2.0
//! The handles and functions of a device's Vulkan, the extensions that bhr adds to wgpu's, and what the device shares.

use super::descriptor::FileKind;
use crate::gpu::device::external::{AdapterIds, HOST_POINTER, OPAQUE_FD, Sharing};
use ash::{ext, khr, vk};
use std::ffi::CStr;
use std::sync::OnceLock;
use wgpu::hal::api::Vulkan;
use wgpu::hal::vulkan::CreateDeviceCallback;

/// The extensions that bhr has on, where a device has them, beside wgpu's.
pub(in crate::gpu) const WANTED: [&CStr; 3] =
    [khr::external_semaphore_fd::NAME, ext::queue_family_foreign::NAME, ext::external_memory_host::NAME];

/// How images of bhr's are made that others import: kernels write them or a copy fills them, and hosts sample, copy, or
/// view them in another format.
pub(in crate::gpu) const IMAGE_FLAGS: vk::ImageCreateFlags = vk::ImageCreateFlags::MUTABLE_FORMAT;
/// How buffers of bhr's are made.
pub(in crate::gpu) const BUFFER_USAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::from_raw(
    vk::BufferUsageFlags::STORAGE_BUFFER.as_raw()
        | vk::BufferUsageFlags::TRANSFER_SRC.as_raw()
        | vk::BufferUsageFlags::TRANSFER_DST.as_raw(),
);

/// The Vulkan of a wgpu device: valid as long as that is.
pub struct VulkanParts {
    pub(in crate::gpu) instance: ash::Instance,
    pub(in crate::gpu) device: ash::Device,
    pub(in crate::gpu) physical: vk::PhysicalDevice,
    pub(in crate::gpu) family: u32,
    pub(in crate::gpu) memory_fd: Option<khr::external_memory_fd::Device>,
    pub(in crate::gpu) semaphore_fd: Option<khr::external_semaphore_fd::Device>,
    pub(in crate::gpu) host_memory: Option<ext::external_memory_host::Device>,
    /// The most that a timeline may grow at once.
    pub(in crate::gpu) timeline_step: u64,
    /// The alignment of a pointer of the host's.
    pub(in crate::gpu) pointer_alignment: u64,
    pub(in crate::gpu) largest_image: u32,
    /// Mesa's llvmpipe, whose imports read a header from the descriptor, and wait for ever where there is none.
    pub(in crate::gpu) llvmpipe: bool,
    /// The kinds of file that the driver passes memory and semaphores as, once that was asked.
    own_files: [OnceLock<Option<FileKind>>; 2],
}

impl VulkanParts {
    /// `None`: another interface, or a version before 1.2, which has no timelines for certain.
    pub fn of(device: &wgpu::Device) -> Option<Self> {
        // SAFETY: nothing is destroyed; what is cloned are handles and pointers of functions.
        let (raw, instance, physical, family, extensions, version) = unsafe {
            let hal = device.as_hal::<Vulkan>()?;
            let shared = hal.shared_instance();
            (
                hal.raw_device().clone(),
                shared.raw_instance().clone(),
                hal.raw_physical_device(),
                hal.queue_family_index(),
                hal.enabled_device_extensions().to_vec(),
                shared.instance_api_version(),
            )
        };
        // SAFETY: the physical device is the instance's.
        let of_device = unsafe { instance.get_physical_device_properties(physical) };
        if version.min(of_device.api_version) < vk::API_VERSION_1_2 {
            return None;
        }
        let mut host = vk::PhysicalDeviceExternalMemoryHostPropertiesEXT::default();
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut timeline = vk::PhysicalDeviceTimelineSemaphoreProperties::default();
        let mut all = vk::PhysicalDeviceProperties2::default()
            .push_next(&mut host)
            .push_next(&mut driver)
            .push_next(&mut timeline);
        // SAFETY: version 1.2 has the call, and each struct is one that it knows or passes over.
        unsafe { instance.get_physical_device_properties2(physical, &mut all) };
        let has = |name: &CStr| extensions.contains(&name);
        let memory_fd = has(khr::external_memory_fd::NAME);
        let semaphore_fd = has(khr::external_semaphore_fd::NAME);
        let host_memory = has(ext::external_memory_host::NAME);
        Some(Self {
            memory_fd: memory_fd.then(|| khr::external_memory_fd::Device::new(&instance, &raw)),
            semaphore_fd: semaphore_fd.then(|| khr::external_semaphore_fd::Device::new(&instance, &raw)),
            host_memory: host_memory.then(|| ext::external_memory_host::Device::new(&instance, &raw)),
            timeline_step: timeline.max_timeline_semaphore_value_difference,
            pointer_alignment: host.min_imported_host_pointer_alignment,
            largest_image: of_device.limits.max_image_dimension2_d,
            llvmpipe: driver.driver_id == vk::DriverId::MESA_LLVMPIPE,
            own_files: [const { OnceLock::new() }; 2],
            instance,
            device: raw,
            physical,
            family,
        })
    }

    /// Whether vkQueueSubmit waits where it should not (`Device::wait_for_waits`).
    pub fn blocks_in_submit(&self) -> bool {
        self.llvmpipe
    }

    /// The handles that targets and semaphores can be passed by.
    pub fn sharing(&self) -> Sharing {
        let format = vk::Format::R8G8B8A8_UNORM;
        let image =
            self.image_sharing(format, image_usage(true), IMAGE_FLAGS, vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD);
        let buffer = self.buffer_sharing(vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD);
        let from_host = self.buffer_sharing(vk::ExternalMemoryHandleTypeFlags::HOST_ALLOCATION_EXT);
        let exports = vk::ExternalMemoryFeatureFlags::EXPORTABLE;
        let imports = vk::ExternalMemoryFeatureFlags::IMPORTABLE;
        let fd = |set: bool| if set && self.memory_fd.is_some() { OPAQUE_FD } else { 0 };
        let pointer = self.host_memory.is_some() && from_host.contains(imports);
        Sharing {
            export_images: fd(image.contains(exports)),
            export_buffers: fd(buffer.contains(exports)),
            import_images: fd(image.contains(imports)),
            import_buffers: fd(buffer.contains(imports)) | if pointer { HOST_POINTER } else { 0 },
            semaphores: [vk::SemaphoreType::TIMELINE, vk::SemaphoreType::BINARY]
                .map(|kind| if self.shares_semaphores(kind) { OPAQUE_FD } else { 0 }),
        }
    }

    /// Whether images of a kind can be exported and imported by a handle.
    pub(in crate::gpu) fn image_sharing(
        &self,
        format: vk::Format,
        usage: vk::ImageUsageFlags,
        flags: vk::ImageCreateFlags,
        handle: vk::ExternalMemoryHandleTypeFlags,
    ) -> vk::ExternalMemoryFeatureFlags {
        let mut outside = vk::PhysicalDeviceExternalImageFormatInfo::default().handle_type(handle);
        let ask = vk::PhysicalDeviceImageFormatInfo2::default()
            .format(format)
            .ty(vk::ImageType::TYPE_2D)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage)
            .flags(flags);
        let ask = if handle.is_empty() { ask } else { ask.push_next(&mut outside) };
        let mut shared = vk::ExternalImageFormatProperties::default();
        let mut answer = vk::ImageFormatProperties2::default().push_next(&mut shared);
        // SAFETY: version 1.2 has the call.
        let known =
            unsafe { self.instance.get_physical_device_image_format_properties2(self.physical, &ask, &mut answer) };
        match known {
            Ok(()) => shared.external_memory_properties.external_memory_features,
            Err(_) => vk::ExternalMemoryFeatureFlags::empty(),
        }
    }

    /// Whether the device makes images of a kind at all.
    pub(in crate::gpu) fn has_images(
        &self,
        format: vk::Format,
        usage: vk::ImageUsageFlags,
        flags: vk::ImageCreateFlags,
    ) -> bool {
        let (kind, tiling) = (vk::ImageType::TYPE_2D, vk::ImageTiling::OPTIMAL);
        // SAFETY: plain values.
        unsafe {
            self.instance.get_physical_device_image_format_properties(self.physical, format, kind, tiling, usage, flags)
        }
        .is_ok()
    }

    pub(in crate::gpu) fn buffer_sharing(
        &self,
        handle: vk::ExternalMemoryHandleTypeFlags,
    ) -> vk::ExternalMemoryFeatureFlags {
        let ask = vk::PhysicalDeviceExternalBufferInfo::default().usage(BUFFER_USAGE).handle_type(handle);
        let mut answer = vk::ExternalBufferProperties::default();
        // SAFETY: version 1.2 has the call.
        unsafe { self.instance.get_physical_device_external_buffer_properties(self.physical, &ask, &mut answer) };
        answer.external_memory_properties.external_memory_features
    }

    pub(in crate::gpu) fn shares_semaphores(&self, kind: vk::SemaphoreType) -> bool {
        let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(kind);
        let ask = vk::PhysicalDeviceExternalSemaphoreInfo::default()
            .handle_type(vk::ExternalSemaphoreHandleTypeFlags::OPAQUE_FD)
            .push_next(&mut kind);
        let mut answer = vk::ExternalSemaphoreProperties::default();
        // SAFETY: version 1.2 has the call.
        unsafe { self.instance.get_physical_device_external_semaphore_properties(self.physical, &ask, &mut answer) };
        let both = vk::ExternalSemaphoreFeatureFlags::EXPORTABLE | vk::ExternalSemaphoreFeatureFlags::IMPORTABLE;
        self.semaphore_fd.is_some() && answer.external_semaphore_features.contains(both)
    }

    /// The kind of file that the driver passes memory as; `None` where it passes none.
    pub(in crate::gpu) fn own_memory(&self) -> Option<FileKind> {
        *self.own_files[0].get_or_init(|| {
            let fns = self.memory_fd.as_ref()?;
            let handle = vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD;
            let mut export = vk::ExportMemoryAllocateInfo::default().handle_types(handle);
            let kind = self.memory_type(u32::MAX, vk::MemoryPropertyFlags::DEVICE_LOCAL)?;
            let allocate = vk::MemoryAllocateInfo::default().allocation_size(4096).memory_type_index(kind);
            // SAFETY: the memory is made, passed and freed here; nobody uses it.
            unsafe {
                let memory = self.device.allocate_memory(&allocate.push_next(&mut export), None).ok()?;
                let fd = fns.get_memory_fd(&vk::MemoryGetFdInfoKHR::default().memory(memory).handle_type(handle));
                self.device.free_memory(memory, None);
                FileKind::of_own(fd.ok()?)
            }
        })
    }

    /// The kind of file that the driver passes semaphores as; `None` where it passes none.
    pub(in crate::gpu) fn own_semaphore(&self) -> Option<FileKind> {
        *self.own_files[1].get_or_init(|| {
            let fns = self.semaphore_fd.as_ref()?;
            let handle = vk::ExternalSemaphoreHandleTypeFlags::OPAQUE_FD;
            let mut export = vk::ExportSemaphoreCreateInfo::default().handle_types(handle);
            let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
            let make = vk::SemaphoreCreateInfo::default().push_next(&mut export).push_next(&mut kind);
            // SAFETY: the semaphore is made, passed and destroyed here; nobody uses it.
            unsafe {
                let made = self.device.create_semaphore(&make, None).ok()?;
                let ask = vk::SemaphoreGetFdInfoKHR::default().semaphore(made).handle_type(handle);
                let fd = fns.get_semaphore_fd(&ask);
                self.device.destroy_semaphore(made, None);
                FileKind::of_own(fd.ok()?)
            }
        })
    }

    /// Bytes of the heap that a memory type lies in; 0 for a type that there is not.
    pub(in crate::gpu) fn heap_size(&self, memory_type: u32) -> u64 {
        // SAFETY: plain values.
        let all = unsafe { self.instance.get_physical_device_memory_properties(self.physical) };
        let kind = all.memory_types_as_slice().get(memory_type as usize);
        kind.and_then(|kind| all.memory_heaps_as_slice().get(kind.heap_index as usize)).map_or(0, |heap| heap.size)
    }

    /// The first memory type among `bits` that has `flags`.
    pub(in crate::gpu) fn memory_type(&self, bits: u32, flags: vk::MemoryPropertyFlags) -> Option<u32> {
        // SAFETY: plain values.
        let types = unsafe { self.instance.get_physical_device_memory_properties(self.physical) };
        let fits = |i: &u32| {
            bits >> i & 1 == 1
                && types.memory_types.get(*i as usize).is_some_and(|kind| kind.property_flags.contains(flags))
        };
        (0..types.memory_type_count).find(fits)
    }
}

/// How images are used: by copies and samplers, and by kernels where the format can be stored to.
pub(in crate::gpu) fn image_usage(stored: bool) -> vk::ImageUsageFlags {
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST;
    if stored { usage | vk::ImageUsageFlags::STORAGE } else { usage }
}

/// By what other interfaces know the adapter; `None` for other interfaces than Vulkan.
pub(in crate::gpu) fn ids(adapter: &wgpu::Adapter) -> Option<AdapterIds> {
    // SAFETY: nothing is destroyed.
    let hal = unsafe { adapter.as_hal::<Vulkan>() }?;
    let (shared, physical) = (hal.shared_instance(), hal.raw_physical_device());
    let instance = shared.raw_instance();
    // SAFETY: the physical device is the instance's.
    let version = unsafe { instance.get_physical_device_properties(physical) }.api_version;
    if shared.instance_api_version().min(version) < vk::API_VERSION_1_1 {
        return Some(AdapterIds::default());
    }
    let mut id = vk::PhysicalDeviceIDProperties::default();
    let mut drm = vk::PhysicalDeviceDrmPropertiesEXT::default();
    let has_drm = hal.physical_device_capabilities().supports_extension(ext::physical_device_drm::NAME);
    let all = vk::PhysicalDeviceProperties2::default().push_next(&mut id);
    let mut all = if has_drm { all.push_next(&mut drm) } else { all };
    // SAFETY: version 1.1 has the call, and the structs are those of extensions that the device has.
    unsafe { instance.get_physical_device_properties2(physical, &mut all) };
    Some(AdapterIds {
        device: id.device_uuid,
        driver: id.driver_uuid,
        luid: (id.device_luid_valid == vk::TRUE).then_some(id.device_luid),
        drm: (has_drm && drm.has_render == vk::TRUE).then_some([drm.render_major, drm.render_minor]),
    })
}

/// The outcome of opening a device.
type Opened = Result<(wgpu::Device, wgpu::Queue), String>;

/// On Vulkan: opens a device as wgpu would, with the extensions of [`WANTED`] that the adapter has. `None`: another
/// interface.
pub(in crate::gpu) fn open(adapter: &wgpu::Adapter, descriptor: &wgpu::DeviceDescriptor<'_>) -> Option<Opened> {
    let open = {
        // SAFETY: nothing is destroyed.
        let hal = unsafe { adapter.as_hal::<Vulkan>() }?;
        let capabilities = hal.physical_device_capabilities();
        let wanted = WANTED.into_iter().filter(|name| capabilities.supports_extension(name)).collect::<Vec<_>>();
        let add: Box<CreateDeviceCallback<'_>> = Box::new(move |args| {
            args.extensions.extend(wanted.iter().filter(|name| !args.extensions.contains(*name)).collect::<Vec<_>>());
        });
        let (features, limits) = (descriptor.required_features, &descriptor.required_limits);
        // SAFETY: features and limits are the adapter's own, and the callback adds extensions that the device has.
        unsafe { hal.open_with_callback(features, limits, &descriptor.memory_hints, Some(add)) }
    };
    let wrapped = open.map_err(|error| error.to_string()).and_then(|open| {
        // SAFETY: the device was opened on this adapter, with what the descriptor says.
        unsafe { adapter.create_device_from_hal(open, descriptor) }.map_err(|error| error.to_string())
    });
    Some(wrapped)
}
