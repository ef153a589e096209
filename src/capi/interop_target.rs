// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrTarget: pictures on the GPU that host and bhr both reach. One `Target`, shared with its context, which may go
//! first.

use super::call::{keep, on_context};
use super::context::BhrContext;
use super::entry::{anywhere, destroy, give_back, outside_callbacks};
use super::image::{BHR_FORMAT_RGBA8_SRGB, BHR_IMAGE_TRANSPARENT, BhrFormat, format};
use super::interop_info::{BHR_HANDLE_HOST_POINTER, BHR_HANDLE_OPAQUE_FD, BhrHandleType};
use super::log::{self, Sink};
use super::message::LastMessage;
use super::pointer::{Out, check_flags, check_reserved, is_null, unknown};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::gpu::{MemoryInfo, NOT_RUN, TargetOrigin, TargetShape};
use crate::image::MAX_SIDE;
use crate::interop::Target;
use crate::platform::close_descriptor;
use crate::thread_state::Call;
use bytemuck::Zeroable;
use std::ffi::c_void;
use std::ptr::null_mut;
use std::sync::Arc;

/// A picture on the GPU that both sides reach. It belongs to its context; end it with bhr_target_destroy, before or
/// after the context. Frames into one target take turns.
pub struct BhrTarget {
    pub(super) target: Arc<Target>,
    sink: Option<Arc<Sink>>,
    /// The context's.
    message: Arc<LastMessage>,
}

/// The substance of a target.
pub type BhrTargetKind = i32;
/// A 2-D image, tiled as the driver likes: for sampling and drawing.
pub const BHR_TARGET_IMAGE: BhrTargetKind = 0;
/// Rows in linear memory: for CUDA, tensors, video encoders.
pub const BHR_TARGET_BUFFER: BhrTargetKind = 1;

/// BhrTargetOptions.flags, of wrapped images: frames are made in a buffer of bhr's and copied into the image on the
/// GPU, so that it needs TRANSFER_DST usage instead of STORAGE: any tiling, images of swapchains, BGRA8_SRGB.
pub const BHR_TARGET_COPY: u32 = 0x100u32;

/// A target. Its first row is the picture's top one. Fill in with bhr_target_options_init first. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrTargetOptions {
    /// sizeof(BhrTargetOptions).
    pub struct_size: u32,
    /// Default IMAGE.
    pub kind: BhrTargetKind,
    /// BHR_FORMAT_*. Default RGBA8_SRGB: an image is VK_FORMAT_R8G8B8A8_UNORM and holds sRGB codes, and the host may
    /// view it as _SRGB, because images are made with MUTABLE_FORMAT. Images of BGRA8_SRGB are filled by a copy on
    /// the GPU.
    pub format: BhrFormat,
    /// Pixels, 1 .. 2^20.
    pub width: u32,
    /// Pixels, 1 .. 2^20.
    pub height: u32,
    /// BHR_IMAGE_TRANSPARENT, for LIGHT; BHR_TARGET_COPY, for wrapped images. Default 0.
    pub flags: u32,
    /// The one kind of handle that the target's memory is passed by; 0 (default): none, for hosts on the same
    /// VkDevice (bhr_target_vulkan).
    pub handle_type: BhrHandleType,
    /// VkImageLayout that frames leave an image in; 0 (default): VK_IMAGE_LAYOUT_GENERAL (1), as OpenGL and CUDA
    /// want it.
    pub layout: i32,
    /// BUFFER: bytes from row to row, a multiple of 4; 0 (default): packed. Bytes between rows are not written.
    pub row_stride: u64,
}

// SAFETY: repr(C), size first, no padding, integers only.
unsafe impl Versioned for BhrTargetOptions {
    const NAME: &'static str = "BhrTargetOptions";
    const SIZES: &'static [usize] = &[40];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            kind: BHR_TARGET_IMAGE,
            format: BHR_FORMAT_RGBA8_SRGB,
            width: 0,
            height: 0,
            flags: 0,
            handle_type: 0,
            layout: 0,
            row_stride: 0,
        }
    }
}

/// VK_IMAGE_LAYOUT_GENERAL.
const LAYOUT_GENERAL: i32 = 1;

impl BhrTargetOptions {
    /// The target, and whether it is transparent. Errors: INVALID_ARGUMENT.
    fn check(&self, wrapped: bool) -> Result<(TargetShape, bool)> {
        let image = match self.kind {
            BHR_TARGET_IMAGE => true,
            BHR_TARGET_BUFFER => false,
            kind => return unknown(kind, "options kind", "BHR_TARGET_IMAGE (0) and BHR_TARGET_BUFFER (1)"),
        };
        let format = format(self.format)?;
        for (name, side) in [("width", self.width), ("height", self.height)] {
            if side == 0 || side > MAX_SIDE {
                return Err(Error::argument(format!("options {name} is {side}; it must lie in [1, {MAX_SIDE}]")));
            }
        }
        let copies = if wrapped { BHR_TARGET_COPY } else { 0 };
        let flags = check_flags(self.flags, BHR_IMAGE_TRANSPARENT | copies, "options flags")?;
        let known = NOT_RUN | BHR_HANDLE_OPAQUE_FD | BHR_HANDLE_HOST_POINTER;
        if self.handle_type & !known != 0 || self.handle_type.count_ones() > 1 {
            return Err(Error::argument(format!(
                "options handle_type is {:#x}; it must be 0 or one BHR_HANDLE_* bit",
                self.handle_type
            )));
        }
        let packed = u64::from(self.width) * format.bytes_per_pixel() as u64;
        let row_stride = match (image, self.row_stride) {
            (_, 0) => packed,
            (true, stride) => {
                return Err(Error::argument(format!(
                    "options row_stride is {stride}; an IMAGE has none: it must be 0"
                )));
            }
            (false, stride) if stride < packed || !stride.is_multiple_of(4) || stride > u32::MAX.into() => {
                return Err(Error::argument(format!(
                    "options row_stride is {stride}; it must hold {packed} bytes and be a multiple of 4 below 2^32"
                )));
            }
            (false, stride) => stride,
        };
        let layout = if self.layout == 0 { LAYOUT_GENERAL } else { self.layout };
        let size = [self.width, self.height];
        let shape = TargetShape { image, format, size, row_stride, layout, handle: self.handle_type };
        Ok((shape, flags & BHR_IMAGE_TRANSPARENT != 0))
    }
}

/// Fills in the defaults. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_options_init(options: *mut BhrTargetOptions, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_target_options_init", || unsafe { versioned::init(options, "options", struct_size) })
}

/// The numbers with which the other side imports a target. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrTargetInfo {
    /// sizeof(BhrTargetInfo), set by the caller.
    pub struct_size: u32,
    /// BHR_TARGET_*.
    pub kind: BhrTargetKind,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// VkFormat of an image; 0 of a buffer.
    pub vk_format: u32,
    /// VkImageUsageFlags or VkBufferUsageFlags: a VkImage that imports the memory must be created with the same.
    pub vk_usage: u32,
    /// VkImageCreateFlags: the same.
    pub vk_flags: u32,
    /// VkImageTiling: the same.
    pub vk_tiling: u32,
    /// VkImageLayout after a frame.
    pub layout: i32,
    /// 1: the memory is a dedicated allocation and must be imported as one (VkMemoryDedicatedAllocateInfo,
    /// CUDA_EXTERNAL_MEMORY_DEDICATED, GL_DEDICATED_MEMORY_OBJECT_EXT).
    pub dedicated: u32,
    /// Index of the memory type in the device's list; the importer needs the same one.
    pub memory_type: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// Bytes of the whole allocation: allocationSize, and the size for CUDA and glImportMemoryFdEXT.
    pub allocation_size: u64,
    /// Bytes from its begin to the target's.
    pub offset: u64,
    /// Bytes from row to row of a buffer.
    pub row_stride: u64,
}

// SAFETY: repr(C), size first, no padding, integers only.
unsafe impl Versioned for BhrTargetInfo {
    const NAME: &'static str = "BhrTargetInfo";
    const SIZES: &'static [usize] = &[72];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            kind: 0,
            width: 0,
            height: 0,
            vk_format: 0,
            vk_usage: 0,
            vk_flags: 0,
            vk_tiling: 0,
            layout: 0,
            dedicated: 0,
            memory_type: 0,
            reserved: 0,
            allocation_size: 0,
            offset: 0,
            row_stride: 0,
        }
    }
}

/// A handle on its way. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrHandle {
    /// One BHR_HANDLE_* bit.
    pub r#type: BhrHandleType,
    /// OPAQUE_FD: the file descriptor; else -1.
    pub fd: i32,
    /// HOST_POINTER: the address; else NULL.
    pub handle: *mut c_void,
}

// SAFETY: integers and a nullable pointer.
unsafe impl Zeroable for BhrHandle {}

/// The handle by which nothing is passed.
pub(super) const NO_HANDLE: BhrHandle = BhrHandle { r#type: 0, fd: -1, handle: null_mut() };

/// A handle that the host hands in.
///
/// # Safety
/// `handle` is NULL or points to a BhrHandle.
pub(super) unsafe fn read_handle(handle: *const BhrHandle) -> Result<BhrHandle> {
    if handle.is_null() {
        return Err(is_null("handle"));
    }
    // SAFETY: not NULL, hence valid by this function's contract.
    let handle = unsafe { handle.read_unaligned() };
    if handle.r#type == BHR_HANDLE_OPAQUE_FD && handle.fd < 0 {
        return Err(Error::argument(format!("handle fd is {}; it must be an open file descriptor", handle.fd)));
    }
    Ok(handle)
}

/// A call on a target alone: refused inside callbacks, with its context's log callback listening.
///
/// # Safety
/// `target` is NULL or was made by this file and is not destroyed.
unsafe fn on_target(function: &str, target: *const BhrTarget, body: impl FnOnce(&Target) -> Result<()>) -> BhrStatus {
    // SAFETY: this function's contract.
    let Some(target) = (unsafe { target.as_ref() }) else {
        return outside_callbacks::<()>(function, || Err(is_null("target")));
    };
    let _scope = log::Scope::enter(target.sink.clone());
    keep(outside_callbacks(function, || body(&target.target)), Some(&target.message))
}

/// Makes a target on a context, whose options are read within.
///
/// # Safety
/// All pointers are NULL or valid; `origin` is called within.
pub(super) unsafe fn make(
    function: &str,
    context: *mut BhrContext,
    options: *const BhrTargetOptions,
    out_target: *mut *mut BhrTarget,
    wrapped: bool,
    origin: impl FnOnce(&super::state::State, &mut TargetShape, u32) -> Result<TargetOrigin>,
) -> BhrStatus {
    // SAFETY: this function's contract.
    unsafe {
        let out = Out::cleared(out_target);
        // Not NULL in the closure: `on_context` has refused that.
        let shared = || context.as_ref().map(|context| (context.sink(), context.message.clone()));
        on_context(function, context, |state| {
            out.required("out_target")?;
            let options = versioned::read(options, "options")?;
            let (mut shape, transparent) = options.check(wrapped)?;
            let origin = origin(state, &mut shape, options.flags)?;
            let target = state.renderer.create_target(shape, transparent, origin)?;
            let (sink, message) = shared().ok_or_else(|| is_null("context"))?;
            out.set(Box::into_raw(Box::new(BhrTarget { target, sink, message })));
            Ok(())
        })
    }
}

/// Makes a target in memory of bhr's. End *out_target with bhr_target_destroy.
/// Errors: INVALID_ARGUMENT also for a layout that an image cannot be left in; UNSUPPORTED for what the device
/// cannot make or share (format, kind, handle_type or side, which the message says), and always on the CPU tracer,
/// OpenGL, Metal and Direct3D 12. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_create(
    context: *mut BhrContext,
    options: *const BhrTargetOptions,
    out_target: *mut *mut BhrTarget,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { make("bhr_target_create", context, options, out_target, false, |_, _, _| Ok(TargetOrigin::New)) }
}

/// Makes a target in memory of the host's. options describe the target (its handle_type is 0 or the handle's),
/// memory what is behind handle: allocation_size, offset, memory_type, dedicated, and for images vk_usage, vk_flags
/// and vk_tiling, with which the host created its VkImage: 2-D, one mip level, one layer, one sample, of the
/// target's size and format. An image needs STORAGE usage where bhr can store to its format, else TRANSFER_DST.
/// OPAQUE_FD: the descriptor is bhr's after OK, and the host's after an error. HOST_POINTER: memory_type and
/// dedicated do not count.
/// Errors: those of bhr_target_create; INVALID_ARGUMENT also for a descriptor that is not open or is no memory, and
/// for memory that is too small, ill placed, or of a type that the target cannot have. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_import(
    context: *mut BhrContext,
    options: *const BhrTargetOptions,
    memory: *const BhrTargetInfo,
    handle: *const BhrHandle,
    out_target: *mut *mut BhrTarget,
) -> BhrStatus {
    let _call = Call::enter();
    let mut taken = None;
    // SAFETY: NULL or valid, by the header's conventions.
    let status = unsafe {
        make("bhr_target_import", context, options, out_target, false, |_, shape, _| {
            let memory = versioned::read(memory, "memory")?;
            check_reserved(memory.reserved, "memory")?;
            let handle = read_handle(handle)?;
            if shape.handle != 0 && shape.handle != handle.r#type {
                return Err(Error::argument(format!(
                    "handle type is {}, options handle_type {}; they must be the same, or the latter 0",
                    handle.r#type, shape.handle
                )));
            }
            shape.handle = handle.r#type;
            let info = MemoryInfo {
                vk_format: 0,
                vk_usage: memory.vk_usage,
                vk_flags: memory.vk_flags,
                vk_tiling: memory.vk_tiling,
                dedicated: memory.dedicated != 0,
                memory_type: memory.memory_type,
                allocation_size: memory.allocation_size,
                offset: memory.offset,
            };
            match handle.r#type {
                BHR_HANDLE_HOST_POINTER if handle.handle.is_null() => Err(is_null("handle handle")),
                BHR_HANDLE_HOST_POINTER => Ok(TargetOrigin::Pointer(handle.handle, info)),
                BHR_HANDLE_OPAQUE_FD => {
                    taken = Some(handle.fd);
                    Ok(TargetOrigin::Descriptor(handle.fd, info))
                }
                other if other & NOT_RUN != 0 && other.count_ones() == 1 => Err(Error::unsupported(format!(
                    "handle type {other} is not built in; bhr_interop_info lists those that are"
                ))),
                other => Err(Error::argument(format!("handle type is {other:#x}; it must be one BHR_HANDLE_* bit"))),
            }
        })
    };
    if let Some(fd) = taken.filter(|_| status >= super::status::BHR_OK) {
        // The host has given it away.
        close_descriptor(fd);
    }
    status
}

/// Sets struct_size and clears the rest. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_info_init(info: *mut BhrTargetInfo, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_target_info_init", || unsafe { versioned::init(info, "info", struct_size) })
}

/// Fills in info. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_info(target: *const BhrTarget, info: *mut BhrTargetInfo) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = OutStruct::cleared(info, "info");
        on_target("bhr_target_info", target, |target| {
            let (shape, memory) = (target.shape(), target.memory());
            let [width, height] = shape.size;
            out.set(&BhrTargetInfo {
                kind: if shape.image { BHR_TARGET_IMAGE } else { BHR_TARGET_BUFFER },
                width,
                height,
                vk_format: memory.vk_format,
                vk_usage: memory.vk_usage,
                vk_flags: memory.vk_flags,
                vk_tiling: memory.vk_tiling,
                layout: if shape.image { shape.layout } else { 0 },
                dedicated: u32::from(memory.dedicated),
                memory_type: memory.memory_type,
                allocation_size: memory.allocation_size,
                offset: memory.offset,
                row_stride: if shape.image { 0 } else { shape.row_stride },
                ..BhrTargetInfo::defaults()
            })
        })
    }
}

/// Gives a new handle of the target's memory, which is the host's: to be imported by what takes it over, or closed.
/// The memory lives until both sides have let go of it.
/// Errors: INVALID_STATE for a target that was not made for export; SURFACE_LOST. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_export(target: *mut BhrTarget, out_handle: *mut BhrHandle) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_handle);
        out.set(NO_HANDLE);
        on_target("bhr_target_export", target, |target| {
            out.required("out_handle")?;
            out.set(BhrHandle { r#type: BHR_HANDLE_OPAQUE_FD, fd: target.export()?, ..NO_HANDLE });
            Ok(())
        })
    }
}

/// Gives the VkImage or the VkBuffer of a target, and 0 for the other, to a host on the same VkDevice. They live as
/// long as the target does. NULL: not wanted.
/// Errors: SURFACE_LOST. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_vulkan(
    target: *const BhrTarget,
    out_image: *mut u64,
    out_buffer: *mut u64,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let (image, buffer) = (Out::cleared(out_image), Out::cleared(out_buffer));
        on_target("bhr_target_vulkan", target, |target| {
            let raw = target.vulkan()?;
            image.set(raw[0]);
            buffer.set(raw[1]);
            Ok(())
        })
    }
}

/// Ends a target and returns at once; its memory goes when the GPU has done with it. NULL is a no-op; its context
/// may be gone. No other thread may use the target any more. From inside a callback it does nothing:
/// bhr_error_message then says so. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_target_destroy(target: *mut BhrTarget) {
    const NAME: &str = "bhr_target_destroy";
    let end = |owned: Box<BhrTarget>| {
        let BhrTarget { target, sink, .. } = *owned;
        let _scope = log::Scope::enter(sink);
        give_back(NAME, target, |target| target.end("it was destroyed"));
    };
    // SAFETY: this file made it with Box::into_raw, and the host destroys it once.
    unsafe { destroy(NAME, target, end) }
}
