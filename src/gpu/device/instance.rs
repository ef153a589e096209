// SPDX-License-Identifier: MIT OR Apache-2.0
//! Makes wgpu's instances and asks them for their adapters. Knows nothing of devices, nor of what bhr needs of them.

use super::hlsl_compiler::HlslCompiler;
use super::wayland;
pub(super) use super::wayland::may_try_wayland;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// An instance, and the adapters it has.
#[derive(Clone)]
pub(super) struct DriverAdapters {
    pub instance: Option<wgpu::Instance>,
    pub list: Vec<wgpu::Adapter>,
    /// The compiler of those of Direct3D 12.
    pub hlsl: HlslCompiler,
}

/// The adapters of one interface: those of an instance, or of one for each compiler of Direct3D 12's kernels that
/// serves. `wayland`: whether surfaces of Wayland can be made, too ([`may_try_wayland`]). `compilers`: of Direct3D 12,
/// the best first. A driver that panics has no adapters.
pub(super) fn ask(
    backend: wgpu::Backends,
    flags: wgpu::InstanceFlags,
    wayland: bool,
    compilers: Vec<HlslCompiler>,
) -> Vec<DriverAdapters> {
    let caught = |search: &dyn Fn() -> DriverAdapters| {
        let found = catch_unwind(AssertUnwindSafe(search));
        found.inspect_err(|_| log::warn!("the search for adapters of {backend:?} panicked")).ok()
    };
    if backend != wgpu::Backends::DX12 {
        return caught(&|| {
            (backend == wgpu::Backends::VULKAN && !wayland)
                .then(|| wayland::vulkan_without_wayland(flags))
                .flatten()
                .map(|(instance, list)| DriverAdapters { instance, list, hlsl: HlslCompiler::Fxc })
                .unwrap_or_else(|| with_compiler(backend, flags, HlslCompiler::Fxc))
        })
        .into_iter()
        .collect();
    }
    let mut instances = Vec::new();
    let found = by_compilers(
        compilers,
        |hlsl| {
            let found = caught(&|| with_compiler(backend, flags, hlsl.clone()))?;
            instances.push((hlsl.clone(), found.instance));
            Some(found.list)
        },
        |adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu,
    );
    let instance = |of: &HlslCompiler| instances.iter().find(|(hlsl, _)| hlsl == of)?.1.clone();
    found.into_iter().map(|(hlsl, list)| DriverAdapters { instance: instance(&hlsl), list, hlsl }).collect()
}

/// The compilers that Direct3D 12's drivers take, with their adapters: they have none with a DXC that does not load,
/// nor where they do not take what it makes, as GPUs that are limited to shader model 5.1. So the first that has
/// hardware is the last that is asked; software counts of the best that has any.
fn by_compilers<T>(
    compilers: Vec<HlslCompiler>,
    mut ask: impl FnMut(&HlslCompiler) -> Option<Vec<T>>,
    is_software: impl Fn(&T) -> bool,
) -> Vec<(HlslCompiler, Vec<T>)> {
    let mut all = Vec::new();
    for hlsl in compilers {
        let mut list = ask(&hlsl).unwrap_or_default();
        if !all.is_empty() {
            list.retain(|adapter| !is_software(adapter));
        }
        if list.is_empty() {
            log::info!("Direct3D 12 has no adapter {}with {hlsl:?}", if all.is_empty() { "" } else { "of hardware " });
            continue;
        }
        let is_last = list.iter().any(|adapter| !is_software(adapter));
        all.push((hlsl, list));
        if is_last {
            break;
        }
    }
    all
}

fn with_compiler(backends: wgpu::Backends, flags: wgpu::InstanceFlags, hlsl: HlslCompiler) -> DriverAdapters {
    let mut descriptor =
        wgpu::InstanceDescriptor { backends, flags, ..wgpu::InstanceDescriptor::new_without_display_handle() };
    descriptor.backend_options.dx12.shader_compiler = hlsl.for_wgpu();
    let instance = wgpu::Instance::new(descriptor);
    let list = pollster::block_on(instance.enumerate_adapters(backends));
    DriverAdapters { instance: Some(instance), list, hlsl }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The adapters by name that are asked for with each compiler: the number of those asked, and what serves.
    fn search(answers: &[Option<&[&'static str]>]) -> (usize, Vec<(String, Vec<&'static str>)>) {
        let mut compilers = vec![HlslCompiler::Dxc("lib".into()), HlslCompiler::Dxc("host".into())];
        compilers.truncate(answers.len() - 1);
        compilers.push(HlslCompiler::Fxc);
        let mut asked = 0;
        let ask = |_: &HlslCompiler| {
            asked += 1;
            answers[asked - 1].map(<[_]>::to_vec)
        };
        let found = by_compilers(compilers, ask, |name| *name == "WARP");
        (asked, found.into_iter().map(|(hlsl, list)| (hlsl.to_string(), list)).collect())
    }

    #[test]
    fn fxc_is_asked_where_dxc_has_no_hardware() {
        let one = |hlsl: &str, list: &[&'static str]| (hlsl.to_owned(), list.to_vec());
        // DXC serves.
        let answers = [Some(&["GPU", "WARP"][..]), Some(&["GPU", "WARP"])];
        assert_eq!(search(&answers), (1, vec![one("DXC", &["GPU", "WARP"])]));
        // A GPU of shader model 5.1, and software that takes what DXC makes.
        let answers = [Some(&["WARP"][..]), Some(&["GPU", "WARP"])];
        assert_eq!(search(&answers), (2, vec![one("DXC", &["WARP"]), one("FXC", &["GPU"])]));
        // No GPU.
        assert_eq!(search(&[Some(&["WARP"][..]), Some(&["WARP"])]), (2, vec![one("DXC", &["WARP"])]));
        // The first DXC panics, or does not load.
        for first in [None, Some(&[][..])] {
            assert_eq!(search(&[first, Some(&["GPU"]), None]), (2, vec![one("DXC", &["GPU"])]));
            assert_eq!(search(&[first, None, Some(&["GPU", "WARP"])]), (3, vec![one("FXC", &["GPU", "WARP"])]));
        }
        assert_eq!(search(&[Some(&[][..])]), (1, vec![]));
    }
}
