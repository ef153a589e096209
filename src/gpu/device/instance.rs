// SPDX-License-Identifier: MIT OR Apache-2.0
//! Makes wgpu's instances and asks them for their adapters. Knows nothing of devices, nor of what bhr needs of them.

use super::hlsl_compiler::HlslCompiler;
use super::wayland;
pub(super) use super::wayland::may_try_wayland;

/// An instance, and the adapters it has.
#[derive(Clone)]
pub(super) struct DriverAdapters {
    pub instance: Option<wgpu::Instance>,
    pub list: Vec<wgpu::Adapter>,
    /// The compiler of those of Direct3D 12.
    pub hlsl: HlslCompiler,
}

impl DriverAdapters {
    pub const NONE: Self = Self { instance: None, list: Vec::new(), hlsl: HlslCompiler::Fxc };

    pub fn has_d3d12(&self) -> bool {
        self.list.iter().any(|adapter| adapter.get_info().backend == wgpu::Backend::Dx12)
    }
}

/// The adapters of these interfaces. A driver may panic here. `wayland`: whether surfaces of Wayland can be made, too
/// ([`may_try_wayland`]).
pub(super) fn ask(backends: wgpu::Backends, flags: wgpu::InstanceFlags, wayland: bool) -> DriverAdapters {
    if backends.contains(wgpu::Backends::VULKAN)
        && !wayland
        && let Some((instance, list)) = wayland::vulkan_without_wayland(flags)
    {
        return DriverAdapters { instance, list, hlsl: HlslCompiler::Fxc };
    }
    let mut found = DriverAdapters::NONE;
    for hlsl in HlslCompiler::all() {
        // Drivers that do not take what DXC makes have no adapters with it, nor have any with a DXC that does not load.
        found = with_compiler(backends, flags, hlsl);
        if !backends.contains(wgpu::Backends::DX12) || found.has_d3d12() {
            break;
        }
    }
    found
}

fn with_compiler(backends: wgpu::Backends, flags: wgpu::InstanceFlags, hlsl: HlslCompiler) -> DriverAdapters {
    let mut descriptor =
        wgpu::InstanceDescriptor { backends, flags, ..wgpu::InstanceDescriptor::new_without_display_handle() };
    descriptor.backend_options.dx12.shader_compiler = hlsl.for_wgpu();
    let instance = wgpu::Instance::new(descriptor);
    let list = pollster::block_on(instance.enumerate_adapters(backends));
    DriverAdapters { instance: Some(instance), list, hlsl }
}
