// SPDX-License-Identifier: MIT OR Apache-2.0
//! The description of an adapter, as programs that use bhr get it. Plain values: src/tracers.rs lists the adapters of a
//! machine, src/gpu/device/adapter.rs finds the GPUs.

/// The interface through which a tracer reaches its adapter: a graphics API, or none for the CPU (`BHR_BACKEND_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Backend {
    Cpu = 1,
    Vulkan = 2,
    Metal = 3,
    D3d12 = 4,
    Gl = 5,
    /// A page's, which hosts in C have not.
    WebGpu = 6,
}

/// The part of the C constant's name after `BHR_BACKEND_`.
impl std::fmt::Display for Backend {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Cpu => "CPU",
            Self::Vulkan => "VULKAN",
            Self::Metal => "METAL",
            Self::D3d12 => "D3D12",
            Self::Gl => "GL",
            Self::WebGpu => "WEBGPU",
        })
    }
}

/// The adapter that a tracer runs on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterInfo {
    pub backend: Backend,
    /// Whether it is a GPU with memory of its own.
    pub discrete: bool,
    /// Whether no hardware is behind it: a software driver, or the CPU tracer.
    pub software: bool,
    /// PCI ids of vendor and device; 0 for the CPU tracer.
    pub vendor_id: u32,
    pub device_id: u32,
    pub name: String,
    /// Name and version of the driver, and who compiles for Direct3D 12; empty where it is not known.
    pub driver: String,
}
