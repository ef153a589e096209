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
    let asks_d3d12 = backends.intersects(wgpu::Backends::DX12 & wgpu::Instance::enabled_backend_features());
    with_compiler(backends, flags, if asks_d3d12 { compiler(flags) } else { HlslCompiler::Fxc })
}

/// The compiler that Direct3D 12's drivers take: they have no adapters with a DXC that does not load, nor where they do
/// not take what it makes. Found out by themselves, so that no other driver is loaded twice.
fn compiler(flags: wgpu::InstanceFlags) -> HlslCompiler {
    let serves = |hlsl: &HlslCompiler| {
        let found = *hlsl == HlslCompiler::Fxc || with_compiler(wgpu::Backends::DX12, flags, hlsl.clone()).has_d3d12();
        if !found {
            log::info!("Direct3D 12 has no adapter with {hlsl:?}");
        }
        found
    };
    HlslCompiler::all().into_iter().find(serves).unwrap_or(HlslCompiler::Fxc)
}

fn with_compiler(backends: wgpu::Backends, flags: wgpu::InstanceFlags, hlsl: HlslCompiler) -> DriverAdapters {
    let mut descriptor =
        wgpu::InstanceDescriptor { backends, flags, ..wgpu::InstanceDescriptor::new_without_display_handle() };
    descriptor.backend_options.dx12.shader_compiler = hlsl.for_wgpu();
    let instance = wgpu::Instance::new(descriptor);
    let list = pollster::block_on(instance.enumerate_adapters(backends));
    DriverAdapters { instance: Some(instance), list, hlsl }
}
