// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `interfaces` in pages: nothing of wgpu's is below WebGPU there, and no other thread destroys a
//! buffer.

use crate::tracer::Backend;
use std::ffi::c_void;
use std::ptr::NonNull;

/// Runs `work`.
pub(in crate::gpu) fn while_it_exists<T>(_: Backend, _: &wgpu::Buffer, work: impl FnOnce() -> T) -> Option<T> {
    Some(work())
}

/// There is no Metal.
pub(in crate::gpu) fn of_layer(_: NonNull<c_void>) -> Option<wgpu::SurfaceTargetUnsafe> {
    None
}
