// SPDX-License-Identifier: MIT OR Apache-2.0
//! The errors that wgpu has of a call, told when the call returns. Knows no device of bhr's.

/// Runs `work`, and what wgpu had against it.
pub(super) fn of<T>(device: &wgpu::Device, work: impl FnOnce(&wgpu::Device) -> T) -> (T, Option<wgpu::Error>) {
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let done = work(device);
    // A resource that is missing for want of memory is not valid either: the cause comes first.
    let errors = [validation, internal, memory].map(|scope| pollster::block_on(scope.pop()));
    (done, errors.into_iter().rev().flatten().next())
}

/// Whether the device refuses what cannot be, a query set without queries: one that is gone says nothing at all.
/// Reaches no driver.
pub(super) fn are_told(device: &wgpu::Device) -> bool {
    let nothing = wgpu::QuerySetDescriptor { label: None, ty: wgpu::QueryType::Occlusion, count: 0 };
    let refusal = device.push_error_scope(wgpu::ErrorFilter::Validation);
    drop(device.create_query_set(&nothing));
    pollster::block_on(refusal.pop()).is_some()
}
