// SPDX-License-Identifier: MIT OR Apache-2.0
//! The memory of targets: made and exported, imported from the host, or a VkImage of the host's own. wgpu owns what is
//! made here and frees it after its last use on the GPU.

use super::external::{HOST_POINTER, MemoryInfo, NOT_RUN, OPAQUE_FD, ReleaseGuard, TargetOrigin, TargetShape};
use super::target::{GpuTarget, TargetResource};
use super::vulkan::descriptor::{CopiedDescriptor, check_descriptor, check_kind};
use super::vulkan::failed;
use super::vulkan::parts::{BUFFER_USAGE, IMAGE_FLAGS, VulkanParts, image_usage};
use super::wgpu_device::Device;
use crate::error::{Error, Result};
use crate::image::PixelFormat;
use ash::vk;
use ash::vk::Handle;
use std::ffi::c_void;
use std::sync::Arc;
use wgpu::hal;
use wgpu::hal::api::Vulkan;

/// The largest VkImageLayout that is one of version 1.0.
const LAST_LAYOUT: i32 = 8;
/// VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, and VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL with ATTACHMENT_OPTIMAL after it.
const OTHER_LAYOUTS: [i32; 3] = [1_000_001_002, 1_000_314_000, 1_000_314_001];

fn vk_format(format: PixelFormat) -> vk::Format {
    match format {
        PixelFormat::Rgba8Srgb => vk::Format::R8G8B8A8_UNORM,
        PixelFormat::Bgra8Srgb => vk::Format::B8G8R8A8_UNORM,
        PixelFormat::Rgba16F => vk::Format::R16G16B16A16_SFLOAT,
        PixelFormat::Rgba32F => vk::Format::R32G32B32A32_SFLOAT,
        PixelFormat::R32F => vk::Format::R32_SFLOAT,
        PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => vk::Format::A2B10G10R10_UNORM_PACK32,
    }
}

/// Format, and whether kernels can store to it.
fn wgpu_format(format: PixelFormat) -> (wgpu::TextureFormat, bool) {
    match format {
        PixelFormat::Rgba8Srgb => (wgpu::TextureFormat::Rgba8Unorm, true),
        PixelFormat::Bgra8Srgb => (wgpu::TextureFormat::Bgra8Unorm, false),
        PixelFormat::Rgba16F => (wgpu::TextureFormat::Rgba16Float, true),
        PixelFormat::Rgba32F => (wgpu::TextureFormat::Rgba32Float, true),
        PixelFormat::R32F => (wgpu::TextureFormat::R32Float, true),
        PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => (wgpu::TextureFormat::Rgb10a2Unorm, false),
    }
}

/// A VkBuffer or VkImage with its memory, destroyed unless they are passed on.
struct Made<'a> {
    parts: &'a VulkanParts,
    buffer: vk::Buffer,
    image: vk::Image,
    memory: vk::DeviceMemory,
    needs: vk::MemoryRequirements,
}

impl<'a> Made<'a> {
    fn buffer(parts: &'a VulkanParts, bytes: u64, handle: vk::ExternalMemoryHandleTypeFlags) -> Result<Self> {
        let mut external = vk::ExternalMemoryBufferCreateInfo::default().handle_types(handle);
        let create = vk::BufferCreateInfo::default().size(bytes).usage(BUFFER_USAGE);
        let create = if handle.is_empty() { create } else { create.push_next(&mut external) };
        // SAFETY: the device lives, and has the extension behind `handle` (`check_handle`).
        let buffer = unsafe { parts.device.create_buffer(&create, None) }.map_err(|e| failed("vkCreateBuffer", e))?;
        // SAFETY: it was made just now.
        let needs = unsafe { parts.device.get_buffer_memory_requirements(buffer) };
        Ok(Self { parts, buffer, image: vk::Image::null(), memory: vk::DeviceMemory::null(), needs })
    }

    fn image(
        parts: &'a VulkanParts,
        shape: &TargetShape,
        [usage, flags]: [u32; 2],
        handle: vk::ExternalMemoryHandleTypeFlags,
    ) -> Result<Self> {
        let [width, height] = shape.size;
        let mut external = vk::ExternalMemoryImageCreateInfo::default().handle_types(handle);
        let create = vk::ImageCreateInfo::default()
            .flags(vk::ImageCreateFlags::from_raw(flags))
            .image_type(vk::ImageType::TYPE_2D)
            .format(vk_format(shape.format))
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(vk::ImageUsageFlags::from_raw(usage));
        let create = if handle.is_empty() { create } else { create.push_next(&mut external) };
        // SAFETY: the device lives, and makes such images (`check_image`).
        let image = unsafe { parts.device.create_image(&create, None) }.map_err(|e| failed("vkCreateImage", e))?;
        // SAFETY: it was made just now.
        let needs = unsafe { parts.device.get_image_memory_requirements(image) };
        Ok(Self { parts, buffer: vk::Buffer::null(), image, memory: vk::DeviceMemory::null(), needs })
    }

    /// Memory of its own, alone in its allocation. The type's index.
    fn allocate(&mut self, exported: bool) -> Result<u32> {
        let kind = self
            .parts
            .memory_type(self.needs.memory_type_bits, vk::MemoryPropertyFlags::DEVICE_LOCAL)
            .or_else(|| self.parts.memory_type(self.needs.memory_type_bits, vk::MemoryPropertyFlags::empty()));
        let kind = kind.ok_or_else(|| Error::unsupported("the device has no memory for such a target"))?;
        let mut export =
            vk::ExportMemoryAllocateInfo::default().handle_types(vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD);
        let mut dedicated = vk::MemoryDedicatedAllocateInfo::default().buffer(self.buffer).image(self.image);
        let allocate = vk::MemoryAllocateInfo::default()
            .allocation_size(self.needs.size)
            .memory_type_index(kind)
            .push_next(&mut dedicated);
        let allocate = if exported { allocate.push_next(&mut export) } else { allocate };
        // SAFETY: sizes and type are what the device asked for.
        let memory = unsafe { self.parts.device.allocate_memory(&allocate, None) };
        self.memory = memory.map_err(|error| failed("vkAllocateMemory", error))?;
        self.bind(0)?;
        Ok(kind)
    }

    fn bind(&self, offset: u64) -> Result<()> {
        let device = &self.parts.device;
        // SAFETY: the memory is of a type and size that it may be bound to, from this offset on (`check_memory`).
        let bound = unsafe {
            match self.image == vk::Image::null() {
                true => device.bind_buffer_memory(self.buffer, self.memory, offset),
                false => device.bind_image_memory(self.image, self.memory, offset),
            }
        };
        bound.map_err(|error| failed("binding memory", error))
    }

    /// Errors: INVALID_ARGUMENT for memory that cannot be behind it.
    fn check_memory(&self, info: &MemoryInfo) -> Result<()> {
        let room = info.allocation_size.checked_sub(info.offset).is_some_and(|room| room >= self.needs.size);
        if !room {
            return Err(Error::argument(format!(
                "memory allocation_size is {} with offset {}; the target needs {} bytes from there on",
                info.allocation_size, info.offset, self.needs.size
            )));
        }
        if !info.offset.is_multiple_of(self.needs.alignment) {
            let (offset, alignment) = (info.offset, self.needs.alignment);
            return Err(Error::argument(format!("memory offset is {offset}; it must be a multiple of {alignment}")));
        }
        if info.memory_type >= 32 || self.needs.memory_type_bits >> info.memory_type & 1 == 0 {
            let (kind, bits) = (info.memory_type, self.needs.memory_type_bits);
            return Err(Error::argument(format!(
                "memory memory_type is {kind}; a target can be in the types {bits:#x} (a bit for each)"
            )));
        }
        // Drivers are not asked for more than there is.
        let most = self.parts.heap_size(info.memory_type);
        if info.allocation_size > most {
            return Err(Error::argument(format!(
                "memory allocation_size is {}; memory_type {} has {most} bytes in all",
                info.allocation_size, info.memory_type
            )));
        }
        Ok(())
    }

    fn import(&mut self, fd: i32, info: &MemoryInfo) -> Result<()> {
        self.check_memory(info)?;
        check_descriptor(fd, info.allocation_size, self.parts.llvmpipe)?;
        check_kind(fd, self.parts.own_memory(), "memory")?;
        let copy = CopiedDescriptor::new(fd)?;
        let handle = vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD;
        let mut import = vk::ImportMemoryFdInfoKHR::default().handle_type(handle).fd(copy.number());
        let mut dedicated = vk::MemoryDedicatedAllocateInfo::default().buffer(self.buffer).image(self.image);
        let allocate = vk::MemoryAllocateInfo::default()
            .allocation_size(info.allocation_size)
            .memory_type_index(info.memory_type)
            .push_next(&mut import);
        let allocate = if info.dedicated { allocate.push_next(&mut dedicated) } else { allocate };
        // SAFETY: the descriptor is bhr's own copy; that it is memory of this driver and of this size is what the
        // driver checks, and else the host's promise.
        let memory = unsafe { self.parts.device.allocate_memory(&allocate, None) }.map_err(|error| {
            let error = failed("vkAllocateMemory", error);
            Error::new(error.kind, format!("handle fd {fd} is not taken as memory: {error}"))
        })?;
        // The driver has taken it over.
        copy.taken();
        self.memory = memory;
        self.bind(info.offset)
    }

    /// The host's own pixels. The type's index.
    fn import_pointer(&mut self, pointer: *mut c_void, info: &MemoryInfo) -> Result<u32> {
        let parts = self.parts;
        let fns = parts.host_memory.as_ref().ok_or_else(|| Error::internal("no import of host pointers"))?;
        let alignment = parts.pointer_alignment.max(1);
        if !(pointer.addr() as u64).is_multiple_of(alignment) || !info.allocation_size.is_multiple_of(alignment) {
            return Err(Error::argument(format!(
                "handle is {pointer:p} with memory allocation_size {}; both must be multiples of {alignment}",
                info.allocation_size
            )));
        }
        let handle = vk::ExternalMemoryHandleTypeFlags::HOST_ALLOCATION_EXT;
        let mut fits = vk::MemoryHostPointerPropertiesEXT::default();
        let device = parts.device.handle();
        // SAFETY: the pixels are the host's, and mapped, by the header.
        unsafe { (fns.fp().get_memory_host_pointer_properties_ext)(device, handle, pointer, &mut fits) }
            .result()
            .map_err(|error| failed("vkGetMemoryHostPointerPropertiesEXT", error))?;
        let bits = self.needs.memory_type_bits & fits.memory_type_bits;
        let kind = parts.memory_type(bits, vk::MemoryPropertyFlags::HOST_COHERENT);
        let kind = kind.ok_or_else(|| Error::unsupported("the device does not reach this memory coherently"))?;
        self.check_memory(&MemoryInfo { memory_type: kind, ..*info })?;
        let mut import = vk::ImportMemoryHostPointerInfoEXT::default().handle_type(handle).host_pointer(pointer);
        let allocate = vk::MemoryAllocateInfo::default()
            .allocation_size(info.allocation_size)
            .memory_type_index(kind)
            .push_next(&mut import);
        // SAFETY: the block is the host's until the target is destroyed and its frames are done, by the header.
        let memory = unsafe { parts.device.allocate_memory(&allocate, None) };
        self.memory = memory.map_err(|error| failed("vkAllocateMemory", error))?;
        self.bind(info.offset)?;
        Ok(kind)
    }

    /// Forgets them: another owns them now.
    fn pass_on(mut self) -> (u64, vk::DeviceMemory) {
        let raw = if self.image == vk::Image::null() { self.buffer.as_raw() } else { self.image.as_raw() };
        let memory = self.memory;
        (self.buffer, self.image, self.memory) = Default::default();
        (raw, memory)
    }
}

impl Drop for Made<'_> {
    fn drop(&mut self) {
        // SAFETY: they were made here and nobody has used them; null handles are passed over.
        unsafe {
            self.parts.device.destroy_buffer(self.buffer, None);
            self.parts.device.destroy_image(self.image, None);
            self.parts.device.free_memory(self.memory, None);
        }
    }
}

impl VulkanParts {
    /// Errors: UNSUPPORTED for a handle by which such targets are not passed here.
    fn check_handle(&self, shape: &TargetShape, imported: bool) -> Result<()> {
        let sharing = self.sharing();
        let (bits, name) = match (imported, shape.image) {
            (false, true) => (sharing.export_images, "export_images"),
            (false, false) => (sharing.export_buffers, "export_buffers"),
            (true, true) => (sharing.import_images, "import_images"),
            (true, false) => (sharing.import_buffers, "import_buffers"),
        };
        let handle = shape.handle;
        if handle & NOT_RUN != 0 {
            return Err(Error::unsupported(format!(
                "handle_type {handle} is not built in: {name} of bhr_interop_info is {bits:#x}"
            )));
        }
        if handle & !bits != 0 {
            return Err(Error::unsupported(format!(
                "handle_type {handle} is not shared by this device: {name} of bhr_interop_info is {bits:#x}"
            )));
        }
        Ok(())
    }

    /// Errors: UNSUPPORTED for an image that the device does not make, INVALID_ARGUMENT for a layout.
    fn check_image(&self, shape: &TargetShape, [usage, flags]: [u32; 2]) -> Result<()> {
        let [width, height] = shape.size;
        let most = self.largest_image;
        if width.max(height) > most {
            return Err(Error::unsupported(format!("target is {width} x {height}; images here have {most} at most")));
        }
        let layout = shape.layout;
        if !(1..=LAST_LAYOUT).contains(&layout) && !OTHER_LAYOUTS.contains(&layout) {
            return Err(Error::argument(format!("options layout is {layout}, which frames cannot leave an image in")));
        }
        let (usage, flags) = (vk::ImageUsageFlags::from_raw(usage), vk::ImageCreateFlags::from_raw(flags));
        if !self.has_images(vk_format(shape.format), usage, flags) {
            let format = shape.format;
            return Err(Error::unsupported(format!("the device makes no images of format {format} for this use")));
        }
        Ok(())
    }
}

impl Device {
    /// A target of this device, which counts its memory.
    fn new_target(
        &self,
        resource: TargetResource,
        shape: TargetShape,
        memory: MemoryInfo,
        raw: [u64; 2],
        leaves: bool,
    ) -> GpuTarget {
        let counted = self.counted(memory.allocation_size);
        GpuTarget::new((counted, self.bindings.clone()), resource, shape, memory, raw, leaves)
    }

    /// A target. Errors: UNSUPPORTED for what the device cannot make or share; INVALID_ARGUMENT for memory that does
    /// not fit; OUT_OF_MEMORY; DEVICE_LOST.
    pub(in crate::gpu) fn vulkan_target(
        &self,
        parts: &VulkanParts,
        shape: TargetShape,
        origin: TargetOrigin,
    ) -> Result<GpuTarget> {
        self.check()?;
        match origin {
            TargetOrigin::Image { image, usage, copy, release } => {
                self.host_image(parts, shape, (image, usage, copy), release)
            }
            origin if shape.image => self.own_image(parts, shape, origin),
            origin => self.own_buffer(parts, shape, origin),
        }
    }

    fn own_buffer(&self, parts: &VulkanParts, shape: TargetShape, origin: TargetOrigin) -> Result<GpuTarget> {
        parts.check_handle(&shape, !matches!(origin, TargetOrigin::New))?;
        let bytes = shape.bytes().next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
        let handle = match shape.handle {
            0 => vk::ExternalMemoryHandleTypeFlags::empty(),
            HOST_POINTER => vk::ExternalMemoryHandleTypeFlags::HOST_ALLOCATION_EXT,
            _ => vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD,
        };
        let mut made = Made::buffer(parts, bytes, handle)?;
        let vk_usage = BUFFER_USAGE.as_raw();
        let own = MemoryInfo { vk_usage, dedicated: true, allocation_size: made.needs.size, ..Default::default() };
        let info = match origin {
            TargetOrigin::Descriptor(fd, info) => {
                made.import(fd, &info)?;
                MemoryInfo { vk_usage, ..info }
            }
            TargetOrigin::Pointer(pointer, info) => {
                MemoryInfo { vk_usage, memory_type: made.import_pointer(pointer, &info)?, ..info }
            }
            _ => MemoryInfo { memory_type: made.allocate(shape.handle == OPAQUE_FD)?, ..own },
        };
        let (raw, memory) = made.pass_on();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let buffer = self.scoped("a target", |device| {
            // SAFETY: buffer and memory are bhr's, bound to each other from this offset on; wgpu frees both.
            unsafe {
                let buffer = vk::Buffer::from_raw(raw);
                let hal = hal::vulkan::Buffer::from_raw_managed(buffer, memory, info.offset, bytes);
                let descriptor =
                    wgpu::BufferDescriptor { label: Some("target"), size: bytes, usage, mapped_at_creation: false };
                device.create_buffer_from_hal::<Vulkan>(hal, &descriptor)
            }
        })?;
        let raw = [raw, memory.as_raw()];
        let leaves = shape.handle == OPAQUE_FD;
        Ok(self.new_target(TargetResource::Buffer(buffer), shape, info, raw, leaves))
    }

    fn own_image(&self, parts: &VulkanParts, shape: TargetShape, origin: TargetOrigin) -> Result<GpuTarget> {
        parts.check_handle(&shape, !matches!(origin, TargetOrigin::New))?;
        let format = vk_format(shape.format);
        let stored = wgpu_format(shape.format).1 && parts.has_images(format, image_usage(true), IMAGE_FLAGS);
        let (mut usage, mut flags) = (image_usage(stored).as_raw(), IMAGE_FLAGS.as_raw());
        let handle = match shape.handle {
            0 => vk::ExternalMemoryHandleTypeFlags::empty(),
            _ => vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD,
        };
        if let TargetOrigin::Descriptor(_, info) = &origin {
            (usage, flags) = (info.vk_usage, info.vk_flags);
            if info.vk_tiling != vk::ImageTiling::OPTIMAL.as_raw() as u32 {
                return Err(Error::unsupported(format!(
                    "memory vk_tiling is {}; known is OPTIMAL (0)",
                    info.vk_tiling
                )));
            }
            if flags & !IMAGE_FLAGS.as_raw() != 0 {
                return Err(Error::unsupported(format!(
                    "memory vk_flags is {flags:#x}; known is MUTABLE_FORMAT ({:#x})",
                    IMAGE_FLAGS.as_raw()
                )));
            }
        }
        parts.check_image(&shape, [usage, flags])?;
        if shape.handle != 0 {
            let (usage, flags) = (vk::ImageUsageFlags::from_raw(usage), vk::ImageCreateFlags::from_raw(flags));
            let shared = parts.image_sharing(format, usage, flags, handle);
            let (wanted, name) = match origin {
                TargetOrigin::New => (vk::ExternalMemoryFeatureFlags::EXPORTABLE, "exports"),
                _ => (vk::ExternalMemoryFeatureFlags::IMPORTABLE, "imports"),
            };
            if !shared.contains(wanted) {
                let format = shape.format;
                return Err(Error::unsupported(format!("the device {name} no images of format {format} for this use")));
            }
        }
        let written = written_by(shape.format, usage)?;
        let mut made = Made::image(parts, &shape, [usage, flags], handle)?;
        let own = MemoryInfo {
            vk_format: format.as_raw() as u32,
            vk_usage: usage,
            vk_flags: flags,
            vk_tiling: vk::ImageTiling::OPTIMAL.as_raw() as u32,
            dedicated: true,
            memory_type: 0,
            allocation_size: made.needs.size,
            offset: 0,
        };
        let info = match origin {
            TargetOrigin::Descriptor(fd, info) => {
                made.import(fd, &info)?;
                MemoryInfo { vk_format: own.vk_format, ..info }
            }
            TargetOrigin::Pointer(..) => {
                return Err(Error::unsupported("pointers of the host's are for BUFFER targets"));
            }
            _ => MemoryInfo { memory_type: made.allocate(shape.handle == OPAQUE_FD)?, ..own },
        };
        let (raw, memory) = made.pass_on();
        let resource = self.wrapped(raw, &shape, written, None, hal::vulkan::TextureMemory::Dedicated(memory))?;
        let leaves = shape.handle == OPAQUE_FD;
        Ok(self.new_target(resource, shape, info, [raw, memory.as_raw()], leaves))
    }

    fn host_image(
        &self,
        parts: &VulkanParts,
        shape: TargetShape,
        (raw, usage, copy): (u64, u32, bool),
        release: Arc<ReleaseGuard>,
    ) -> Result<GpuTarget> {
        parts.check_image(&shape, [usage, 0])?;
        let written = match copy {
            true if usage & vk::ImageUsageFlags::TRANSFER_DST.as_raw() == 0 => {
                return Err(Error::argument(format!("vk_usage is {usage:#x}; BHR_TARGET_COPY needs TRANSFER_DST")));
            }
            true => false,
            false if usage & vk::ImageUsageFlags::STORAGE.as_raw() == 0 => {
                return Err(Error::argument(format!(
                    "vk_usage is {usage:#x}; without BHR_TARGET_COPY an image needs STORAGE"
                )));
            }
            false => match wgpu_format(shape.format) {
                (_, true) => true,
                (_, false) => {
                    let format = shape.format;
                    return Err(Error::unsupported(format!("images of format {format} need BHR_TARGET_COPY")));
                }
            },
        };
        let release: hal::DropCallback = Box::new(move || drop(release));
        let resource = self.wrapped(raw, &shape, written, Some(release), hal::vulkan::TextureMemory::External)?;
        let info =
            MemoryInfo { vk_format: vk_format(shape.format).as_raw() as u32, vk_usage: usage, ..Default::default() };
        Ok(self.new_target(resource, shape, info, [raw, 0], false))
    }

    /// A VkImage as wgpu's texture. `release`: it is the host's.
    fn wrapped(
        &self,
        raw: u64,
        shape: &TargetShape,
        written: bool,
        release: Option<hal::DropCallback>,
        memory: hal::vulkan::TextureMemory,
    ) -> Result<TargetResource> {
        let [width, height] = shape.size;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let (format, dimension) = (wgpu_format(shape.format).0, wgpu::TextureDimension::D2);
        let (usage, uses) = match written {
            true => (wgpu::TextureUsages::STORAGE_BINDING, wgpu::TextureUses::STORAGE_WRITE_ONLY),
            false => (wgpu::TextureUsages::COPY_DST, wgpu::TextureUses::COPY_DST),
        };
        let label = Some("target");
        let of_hal = hal::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension,
            format,
            usage: uses,
            memory_flags: hal::MemoryFlags::empty(),
            view_formats: Vec::new(),
        };
        let descriptor = wgpu::TextureDescriptor {
            label,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension,
            format,
            usage,
            view_formats: &[],
        };
        let texture = self.scoped("a target", |device| {
            // SAFETY: the image is as the descriptors say: bhr made it so, or the host says so. Without a release wgpu
            // frees image and memory; with one the host's image lives until then.
            unsafe {
                let hal = device.as_hal::<Vulkan>()?;
                let hal = hal.texture_from_raw(vk::Image::from_raw(raw), &of_hal, release, memory);
                Some(device.create_texture_from_hal::<Vulkan>(hal, &descriptor, uses))
            }
        })?;
        let texture = texture.ok_or_else(|| Error::internal("a device of another interface"))?;
        match written {
            true => {
                let view = self.scoped("a target's view", |_| texture.create_view(&Default::default()))?;
                Ok(TargetResource::Written(texture, view))
            }
            false => Ok(TargetResource::Copied(texture)),
        }
    }

    /// A new descriptor of a target's memory, the caller's. Errors: INVALID_STATE for a target that was not made for
    /// export; DEVICE_LOST.
    pub(in crate::gpu) fn export_vulkan(&self, parts: &VulkanParts, target: &GpuTarget) -> Result<i32> {
        let fns = parts.memory_fd.as_ref().filter(|_| target.shape.handle == OPAQUE_FD);
        let fns = fns.ok_or_else(|| Error::state("the target was not made for export: its handle_type was 0"))?;
        let ask = vk::MemoryGetFdInfoKHR::default()
            .memory(vk::DeviceMemory::from_raw(target.raw_memory))
            .handle_type(vk::ExternalMemoryHandleTypeFlags::OPAQUE_FD);
        // SAFETY: the memory lives, as the resource does meanwhile, and was made for this handle.
        let export = || unsafe { fns.get_memory_fd(&ask) }.map_err(|error| failed("vkGetMemoryFdKHR", error));
        let gone = || Err(self.explain(Error::internal("a target's memory is gone")));
        match &target.resource {
            TargetResource::Buffer(buffer) => self.while_it_exists(buffer, export),
            TargetResource::Written(texture, _) | TargetResource::Copied(texture) => {
                // SAFETY: nothing is done with it but knowing that it is there.
                match unsafe { texture.as_hal::<Vulkan>() } {
                    Some(_exists) => export(),
                    None => gone(),
                }
            }
        }
    }
}

/// Whether kernels write an image of such a use, or a copy fills it.
fn written_by(format: PixelFormat, usage: u32) -> Result<bool> {
    let usage = vk::ImageUsageFlags::from_raw(usage);
    if usage.contains(vk::ImageUsageFlags::STORAGE) && wgpu_format(format).1 {
        return Ok(true);
    }
    if usage.contains(vk::ImageUsageFlags::TRANSFER_DST) {
        return Ok(false);
    }
    Err(Error::unsupported(format!(
        "memory vk_usage is {:#x}; an image of {format} needs STORAGE where it can be stored to, else TRANSFER_DST",
        usage.as_raw()
    )))
}
