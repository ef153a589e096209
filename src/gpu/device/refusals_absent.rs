// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `refusals` in pages, which hear of errors later, and by the device's own callback
//! (`Device::check`): no call waits for them.

/// Runs `work`.
pub(super) fn of<T>(device: &wgpu::Device, work: impl FnOnce(&wgpu::Device) -> T) -> (T, Option<wgpu::Error>) {
    (work(device), None)
}

/// The browser tells when a device is lost.
pub(super) fn are_told(_: &wgpu::Device) -> bool {
    true
}
