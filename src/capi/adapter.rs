// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrAdapterInfo and BhrBackend: what bhr can run on.

use super::entry::{anywhere, outside_callbacks};
use super::message::copy_text;
use super::pointer::{Out, unknown};
use super::status::BhrStatus;
use super::versioned::{self, OutStruct, Versioned};
use crate::error::{Error, Result};
use crate::tracer::{AdapterInfo, Backend};
use crate::tracers;
use std::ffi::c_char;

/// BhrAdapterInfo.flags: a GPU with memory of its own.
pub const BHR_ADAPTER_DISCRETE: u32 = 1u32;
/// BhrAdapterInfo.flags: a software driver, or the CPU tracer.
pub const BHR_ADAPTER_SOFTWARE: u32 = 2u32;

/// The interface to an adapter. AUTO takes the best GPU that Vulkan, Metal or, with DXC, Direct3D 12 reaches; else one
/// that only OpenGL reaches, or Direct3D 12 with FXC; else a software driver for Vulkan (Mesa's lavapipe) or Direct3D
/// 12; else the CPU tracer. It never takes software OpenGL.
pub type BhrBackend = i32;
/// The best one there is, in the order above.
pub const BHR_BACKEND_AUTO: BhrBackend = 0;
/// The built-in double-precision CPU tracer: needs no driver.
pub const BHR_BACKEND_CPU: BhrBackend = 1;
/// Vulkan.
pub const BHR_BACKEND_VULKAN: BhrBackend = 2;
/// Metal.
pub const BHR_BACKEND_METAL: BhrBackend = 3;
/// Direct3D 12, never tried on Windows itself; its compiler: docs/platforms.md.
pub const BHR_BACKEND_D3D12: BhrBackend = 4;
/// OpenGL or OpenGL ES, by EGL or WGL. A host that ends EGL's display: docs/adapters.md.
pub const BHR_BACKEND_GL: BhrBackend = 5;

const TEXT: usize = 256;

/// One adapter.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrAdapterInfo {
    /// sizeof(BhrAdapterInfo), set by the caller.
    pub struct_size: u32,
    /// BHR_BACKEND_*, never AUTO.
    pub backend: BhrBackend,
    /// BHR_ADAPTER_* bits.
    pub flags: u32,
    /// PCI id of the vendor; 0 for the CPU tracer.
    pub vendor_id: u32,
    /// PCI id of the device; 0 for the CPU tracer.
    pub device_id: u32,
    /// Reserved: 0.
    pub reserved: u32,
    /// UTF-8, cut where it is longer.
    pub name: [c_char; 256],
    /// Name and version of the driver, UTF-8; "" where it is not known. D3D12: and who compiles kernels, DXC or FXC.
    pub driver: [c_char; 256],
}

// SAFETY: repr(C), size first, no padding, integers only.
unsafe impl Versioned for BhrAdapterInfo {
    const NAME: &'static str = "BhrAdapterInfo";
    const SIZES: &'static [usize] = &[536];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            backend: BHR_BACKEND_AUTO,
            flags: 0,
            vendor_id: 0,
            device_id: 0,
            reserved: 0,
            name: [0; TEXT],
            driver: [0; TEXT],
        }
    }
}

impl From<&AdapterInfo> for BhrAdapterInfo {
    fn from(info: &AdapterInfo) -> Self {
        let flag = |set: bool, bit: u32| if set { bit } else { 0 };
        Self {
            backend: info.backend as BhrBackend,
            flags: flag(info.discrete, BHR_ADAPTER_DISCRETE) | flag(info.software, BHR_ADAPTER_SOFTWARE),
            vendor_id: info.vendor_id,
            device_id: info.device_id,
            name: fixed_text(&info.name),
            driver: fixed_text(&info.driver),
            ..Self::defaults()
        }
    }
}

/// `text` up to its first NUL, cut at a character so that a terminator fits.
fn fixed_text(text: &str) -> [c_char; TEXT] {
    let mut fixed = [0; TEXT];
    let text = text.split('\0').next().unwrap_or_default();
    // SAFETY: it has TEXT bytes.
    unsafe { copy_text(text.as_bytes(), fixed.as_mut_ptr(), TEXT) };
    fixed
}

/// The backend that a constant stands for; `None` for AUTO. Errors: INVALID_ARGUMENT for a backend that the header does
/// not list.
pub(super) fn backend(value: BhrBackend) -> Result<Option<Backend>> {
    Ok(Some(match value {
        BHR_BACKEND_AUTO => return Ok(None),
        BHR_BACKEND_CPU => Backend::Cpu,
        BHR_BACKEND_VULKAN => Backend::Vulkan,
        BHR_BACKEND_METAL => Backend::Metal,
        BHR_BACKEND_D3D12 => Backend::D3d12,
        BHR_BACKEND_GL => Backend::Gl,
        _ => return unknown(value, "options backend", "BHR_BACKEND_AUTO (0) to BHR_BACKEND_GL (5)"),
    }))
}

/// Sets struct_size, which calls that fill the struct read, and clears the rest. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_adapter_info_init(info: *mut BhrAdapterInfo, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_adapter_info_init", || unsafe { versioned::init(info, "info", struct_size) })
}

/// Counts the adapters of this machine: at least 1, because the CPU tracer is always there, and always last.
/// Adapters other than GL are looked for once in a process; bhr_context_recover looks again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_adapter_count(out_count: *mut u32) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    let out = unsafe { Out::cleared(out_count) };
    outside_callbacks("bhr_adapter_count", || {
        out.required("out_count")?;
        out.set(tracers::adapters().len() as u32);
        Ok(())
    })
}

/// Fills in info for the adapter at index, below bhr_adapter_count: GPUs come first, then software drivers, the CPU
/// tracer last. BHR_BACKEND_AUTO need not take the first one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_adapter_info(index: u32, info: *mut BhrAdapterInfo) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    let info = unsafe { OutStruct::cleared(info, "info") };
    outside_callbacks("bhr_adapter_info", || {
        let adapters = tracers::adapters();
        let adapter = adapters.get(index as usize).ok_or_else(|| {
            Error::argument(format!("index is {index}; this machine has {} adapters", adapters.len()))
        })?;
        info.set(&adapter.into())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_cut_at_a_character_and_terminated() {
        let fixed = fixed_text(&"\u{e9}".repeat(200));
        assert_eq!(fixed[253] as u8, 0xa9);
        assert_eq!(fixed[254..], [0, 0]);
        assert_eq!(fixed_text("ab\0cd")[..3], [b'a' as c_char, b'b' as c_char, 0]);
    }
}
