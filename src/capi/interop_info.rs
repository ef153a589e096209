// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrInteropInfo: what a context's device can share with hosts, and the adapter that a host's device is.

use super::call::on_context;
use super::context::BhrContext;
use super::entry::{anywhere, outside_callbacks};
use super::pointer::Out;
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, ErrorKind, Result};
use crate::tracers;

/// A kind of handle that memory or a semaphore is passed by; the constants are bits.
pub type BhrHandleType = u32;
/// Linux, Android: a file descriptor of the driver's, for the same driver only: Vulkan, CUDA, OpenGL. Any format.
pub const BHR_HANDLE_OPAQUE_FD: BhrHandleType = 1u32;
/// Linux: a dma-buf, for EGL, GBM, Wayland, VA-API. Not built in yet: in no bits of BhrInteropInfo.
pub const BHR_HANDLE_DMA_BUF: BhrHandleType = 2u32;
/// Windows: an NT handle of Vulkan's. Not built in yet.
pub const BHR_HANDLE_OPAQUE_WIN32: BhrHandleType = 4u32;
/// Windows: an NT handle of a D3D12 resource or fence. Not built in yet.
pub const BHR_HANDLE_D3D12: BhrHandleType = 8u32;
/// Windows: an NT handle of a D3D11 texture. Not built in yet.
pub const BHR_HANDLE_D3D11_TEXTURE: BhrHandleType = 16u32;
/// macOS, iOS: an IOSurfaceRef as memory, an MTLSharedEvent as semaphore. Not built in yet.
pub const BHR_HANDLE_APPLE: BhrHandleType = 32u32;
/// The host's own pixels, for bhr_target_import of buffers: BhrHandle.handle is their address. Address and
/// allocation_size are multiples of the device's minImportedHostPointerAlignment (4096 or 65536). They stay the
/// host's, must stay mapped until the target is destroyed and its frames are done, and are read after the frame's
/// job or signal. docs/gpu.md.
pub const BHR_HANDLE_HOST_POINTER: BhrHandleType = 64u32;

/// The ways in which a context's device can share. All bits 0: the CPU tracer, OpenGL, Metal, Direct3D 12, or a
/// driver without the extensions; use bhr_render_image. @since 0.2.0
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrInteropInfo {
    /// sizeof(BhrInteropInfo), set by the caller.
    pub struct_size: u32,
    /// BHR_HANDLE_* bits that bhr_target_create gives for images.
    pub export_images: u32,
    /// BHR_HANDLE_* bits that bhr_target_create gives for buffers.
    pub export_buffers: u32,
    /// BHR_HANDLE_* bits that bhr_target_import takes for images.
    pub import_images: u32,
    /// BHR_HANDLE_* bits that bhr_target_import takes for buffers.
    pub import_buffers: u32,
    /// By BhrSemaphoreKind: BHR_HANDLE_* bits that semaphores are exported and imported by.
    pub semaphores: [u32; 2],
    /// 1: luid is known, which it is on Windows.
    pub luid_valid: u32,
    /// Vulkan's deviceUUID, GL_DEVICE_UUID_EXT, what cuDeviceGetUuid gives. 0: not known.
    pub device_uuid: [u8; 16],
    /// Vulkan's driverUUID, GL_DRIVER_UUID_EXT. OPAQUE handles go between equal pairs of both UUIDs only.
    pub driver_uuid: [u8; 16],
    /// The adapter's LUID, as DXGI and cuDeviceGetLuid give it.
    pub luid: [u8; 8],
    /// Linux: major number of the DRM render node, /dev/dri/renderD*; -1: not known.
    pub drm_major: i64,
    /// Its minor number; -1: not known.
    pub drm_minor: i64,
}

// SAFETY: repr(C), size first, no padding, integers only.
unsafe impl Versioned for BhrInteropInfo {
    const NAME: &'static str = "BhrInteropInfo";
    const SIZES: &'static [usize] = &[88];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            export_images: 0,
            export_buffers: 0,
            import_images: 0,
            import_buffers: 0,
            semaphores: [0; 2],
            luid_valid: 0,
            device_uuid: [0; 16],
            driver_uuid: [0; 16],
            luid: [0; 8],
            drm_major: -1,
            drm_minor: -1,
        }
    }
}

/// Sets struct_size and clears the rest. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_interop_info_init(info: *mut BhrInteropInfo, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_interop_info_init", || unsafe { versioned::init(info, "info", struct_size) })
}

/// Fills in info for the context's device. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_interop_info(context: *const BhrContext, info: *mut BhrInteropInfo) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = OutStruct::cleared(info, "info");
        on_context("bhr_interop_info", context, |state| {
            let (sharing, ids) = state.renderer.sharing()?;
            let [drm_major, drm_minor] = ids.drm.unwrap_or([-1, -1]);
            out.set(&BhrInteropInfo {
                export_images: sharing.export_images,
                export_buffers: sharing.export_buffers,
                import_images: sharing.import_images,
                import_buffers: sharing.import_buffers,
                semaphores: sharing.semaphores,
                luid_valid: u32::from(ids.luid.is_some()),
                device_uuid: ids.device,
                driver_uuid: ids.driver,
                luid: ids.luid.unwrap_or_default(),
                drm_major,
                drm_minor,
                ..BhrInteropInfo::defaults()
            })
        })
    }
}

/// Bytes of an id of the host's; `None` for NULL.
///
/// # Safety
/// `pointer` is NULL or points to N readable bytes.
unsafe fn read_id<const N: usize>(pointer: *const u8) -> Option<[u8; N]> {
    // SAFETY: this function's contract.
    (!pointer.is_null()).then(|| unsafe { pointer.cast::<[u8; N]>().read_unaligned() })
}

/// Finds the adapter to make a context on so that it can share with the host's device, for
/// BhrContextOptions.adapter_index (bhr_context_options_init sets the others). uuid is a deviceUUID of 16 bytes or
/// NULL, luid a LUID of 8 bytes or NULL; one of them at least is given, and both count that are. *out_index is -1
/// after an error.
/// Errors: NO_ADAPTER when bhr has none through Vulkan on that device. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_adapter_find(uuid: *const u8, luid: *const u8, out_index: *mut i32) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_index);
        out.set(-1);
        outside_callbacks("bhr_adapter_find", || {
            out.required("out_index")?;
            out.set(find(read_id(uuid), read_id(luid))?);
            Ok(())
        })
    }
}

fn find(uuid: Option<[u8; 16]>, luid: Option<[u8; 8]>) -> Result<i32> {
    if uuid.is_none() && luid.is_none() {
        return Err(Error::argument("uuid and luid are NULL; one of them is needed"));
    }
    let ids = tracers::adapter_ids();
    let is_it = |ids: &crate::gpu::AdapterIds| {
        uuid.is_none_or(|uuid| ids.device == uuid) && luid.is_none_or(|luid| ids.luid == Some(luid))
    };
    // Zeros are adapters whose ids are not known.
    let found = ids.iter().position(|ids| ids.device != [0; 16] && is_it(ids));
    found.map(|index| index as i32).ok_or_else(|| {
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        let wanted = uuid.map(|uuid| format!("uuid {}", hex(&uuid)));
        let wanted = wanted.into_iter().chain(luid.map(|luid| format!("luid {}", hex(&luid))));
        let wanted = wanted.collect::<Vec<_>>().join(" and ");
        Error::new(ErrorKind::NoAdapter, format!("none of {} adapters has {wanted}", ids.len()))
    })
}
