//! The adapters that tracers run on, as hosts hear of them. Finds none.

/// The interfaces a tracer may run on (`BHR_BACKEND_*`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Backend {
    Cpu = 1,
    Vulkan = 2,
    Metal = 3,
    D3d12 = 4,
    Gl = 5,
}

/// As in `BHR_BACKEND_*`.
impl std::fmt::Display for Backend {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Cpu => "CPU",
            Self::Vulkan => "VULKAN",
            Self::Metal => "METAL",
            Self::D3d12 => "D3D12",
            Self::Gl => "GL",
        })
    }
}

/// The adapter that a tracer runs on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterInfo {
    pub backend: Backend,
    /// A GPU with memory of its own.
    pub discrete: bool,
    /// No hardware behind it: a software driver, or the CPU tracer.
    pub software: bool,
    pub vendor_id: u32,
    pub device_id: u32,
    pub name: String,
    pub driver: String,
}
