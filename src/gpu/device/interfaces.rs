// SPDX-License-Identifier: MIT OR Apache-2.0
//! The types of wgpu's that are there only on the systems of their interfaces.

use crate::tracer::Backend;
use std::ffi::c_void;
use std::ptr::NonNull;

/// Runs `work` while `buffer` is kept from being destroyed. `None`: it was destroyed already, or is another
/// interface's.
pub(in crate::gpu) fn while_it_exists<T>(
    backend: Backend,
    buffer: &wgpu::Buffer,
    work: impl FnOnce() -> T,
) -> Option<T> {
    match backend {
        #[cfg(shares_memory)]
        Backend::Vulkan => held::<wgpu::hal::api::Vulkan, _>(buffer, work),
        #[cfg(all(feature = "gl", shares_memory))]
        Backend::Gl => held::<wgpu::hal::api::Gles, _>(buffer, work),
        #[cfg(target_vendor = "apple")]
        Backend::Metal => held::<wgpu::hal::api::Metal, _>(buffer, work),
        #[cfg(windows)]
        Backend::D3d12 => held::<wgpu::hal::api::Dx12, _>(buffer, work),
        _ => None,
    }
}

fn held<A: wgpu::hal::Api, T>(buffer: &wgpu::Buffer, work: impl FnOnce() -> T) -> Option<T> {
    // SAFETY: nothing is done with the interface's own buffer but knowing that it is there.
    let _exists = unsafe { buffer.as_hal::<A>() }?;
    Some(work())
}

/// A `CAMetalLayer *` as wgpu makes surfaces of it; `None` where there is no Metal.
pub(in crate::gpu) fn of_layer(layer: NonNull<c_void>) -> Option<wgpu::SurfaceTargetUnsafe> {
    #[cfg(target_vendor = "apple")]
    return Some(wgpu::SurfaceTargetUnsafe::CoreAnimationLayer(layer.as_ptr()));
    #[cfg(not(target_vendor = "apple"))]
    {
        let _ = layer;
        None
    }
}
