// SPDX-License-Identifier: MIT OR Apache-2.0
//! Finds the adapters that wgpu can compute on, and puts them in order. Opens no device and knows nothing of tracing.

use super::external::{AdapterIds, HostDevice};
use super::gl_thread::{DisplayAge, GlThread};
use super::hlsl_compiler::HlslCompiler;
use super::instance::DriverAdapters;
use super::native::{self, INTERFACES, Question};
use super::{driver_lock, loader};
use crate::error::{Error, Result};
use crate::platform::{SYSTEM, System};
use crate::tracer::{AdapterInfo, Backend};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// The interfaces that a search looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Every interface of this platform. Its order is what an adapter index counts.
    All,
    /// Every interface but GL: those that can present.
    Native,
    /// Hardware of every interface, then the software adapters of all but GL. GL is looked at only where no interface
    /// that goes before it has hardware: starting it takes as long as all the rest.
    Auto,
    /// Hardware behind that of [`Search::Auto`], for when none of that opens: GL's, and Direct3D 12's by FXC.
    Fallback,
    /// This interface alone: no other driver is asked. `Backend::Cpu` finds nothing, as the CPU tracer is no adapter of
    /// wgpu's.
    Only(Backend),
}

/// An adapter that a device can be opened on.
pub struct Adapter {
    pub info: AdapterInfo,
    handle: Handle,
    /// The compiler of Direct3D 12's kernels; `None` for other interfaces.
    hlsl: Option<HlslCompiler>,
    /// The host's device, on which alone the adapter may be used.
    host: Option<HostDevice>,
}

impl Adapter {
    pub(in crate::gpu) fn raw(&self) -> Result<&wgpu::Adapter> {
        self.handle.raw.as_ref().ok_or_else(|| Error::internal("the adapter is being dropped"))
    }

    /// An adapter of an instance of its own, a host's or a page's, which no list keeps. Errors: UNSUPPORTED with the
    /// reason when it cannot run the tracer.
    #[cfg_attr(not(shares_memory), allow(dead_code, reason = "hosts' devices are Vulkan's"))]
    pub(in crate::gpu) fn of_host(
        raw: wgpu::Adapter,
        instance: wgpu::Instance,
        host: Option<HostDevice>,
    ) -> Result<Self> {
        match checked(raw, Some(instance), None, &HlslCompiler::Fxc) {
            Ok(found) => Ok(Self { host, ..found.adapter }),
            Err(reason) => Err(Error::unsupported(format!("the device cannot be used: {reason}"))),
        }
    }

    pub(in crate::gpu) fn hlsl(&self) -> Option<&HlslCompiler> {
        self.hlsl.as_ref()
    }

    pub(in crate::gpu) fn host(&self) -> Option<&HostDevice> {
        self.host.as_ref()
    }

    /// By what other interfaces know it. Zeros where that is not known.
    pub fn ids(&self) -> AdapterIds {
        if self.info.backend == Backend::Vulkan {
            return self.raw().ok().and_then(super::vulkan::parts::ids).unwrap_or_default();
        }
        AdapterIds::default()
    }

    /// The instance that makes surfaces for windows; `None` for GL, whose instances are tied to a display.
    pub(in crate::gpu) fn instance(&self) -> Option<&wgpu::Instance> {
        self.handle.instance.as_ref()
    }

    /// Where an adapter of GL may be used; `None` for the other interfaces.
    pub(in crate::gpu) fn gl_thread(&self) -> Option<Arc<GlThread>> {
        self.handle.gl.as_ref().map(|(thread, _)| thread.clone())
    }

    /// Whether what one cannot present to the other cannot either: an adapter of another instance may be able to, as
    /// instances that were made while the environment had no Wayland display make no surfaces of it. A host's device is
    /// not tried in bhr's own instance.
    pub fn is_same(&self, other: &Self) -> bool {
        self.info == other.info && (self.instance() == other.instance() || other.host.is_some())
    }

    /// How old the EGL display was when an adapter of GL was found; `None` for the other interfaces.
    pub(in crate::gpu) fn gl_age(&self) -> Option<DisplayAge> {
        self.handle.gl.as_ref().map(|(_, age)| *age)
    }
}

/// An adapter, which is dropped where it may touch GL contexts, and while no other thread starts or ends a driver: it
/// may be the last to hold its instance.
struct Handle {
    /// `None` only while it is being dropped.
    raw: Option<wgpu::Adapter>,
    /// The instance that makes surfaces for windows; `None` for GL.
    instance: Option<wgpu::Instance>,
    /// Adapters of GL have a thread on which alone they may be used, and the display's age when they were found.
    gl: Option<(Arc<GlThread>, DisplayAge)>,
}

impl Drop for Handle {
    fn drop(&mut self) {
        let (raw, instance) = (self.raw.take(), self.instance.take());
        if self.gl.as_ref().is_some_and(|(_, age)| age.is_over()) {
            // Its context has gone with its display, and its handles may be those of another one.
            std::mem::forget((raw, instance));
            return;
        }
        let end = move || {
            let _driver = driver_lock::lock();
            drop(raw);
            drop(instance);
        };
        let Some((thread, _)) = &self.gl else { return end() };
        if let Err(error) = thread.run(end) {
            log::warn!("a GL adapter that cannot be closed stays behind: {error}");
        }
    }
}

/// Every adapter of `search` that has what the tracer needs, best first: discrete GPUs, integrated ones, virtual and
/// unknown ones, software. Among equals Direct3D 12 comes after Vulkan, and GL is last. Direct3D 12 whose kernels FXC
/// compiles is behind all others, its GPUs behind GPUs and its software behind software: FXC was never seen to compile
/// one. The driver's order decides the rest, so one machine has one order.
/// Hardware that several interfaces reach is listed once for each.
///
/// `validation`: adapters whose devices the driver's validation layers watch, if they are installed. GL has none: what
/// wgpu would switch on instead is EGL's one debug callback, which is the host's.
///
/// Never fails: without a loader or a driver the list is empty, and the log (info) says what was passed over and why.
pub fn adapters(search: Search, validation: bool) -> Vec<Adapter> {
    let of = |backend, by_fxc| {
        let all = native::native(Question { backend, validation, by_fxc }).into_iter();
        all.flat_map(|DriverAdapters { instance, list, hlsl }| {
            list.into_iter().filter_map(move |raw| usable(raw, instance.clone(), None, &hlsl))
        })
        .collect::<Vec<_>>()
    };
    let native = || INTERFACES.into_iter().flat_map(|backend| of(backend, false)).collect::<Vec<_>>();
    let mut list = match search {
        Search::All => [native(), gl().unwrap_or_default()].into_iter().flatten().collect(),
        Search::Native => native(),
        Search::Auto => match native() {
            list if list.iter().any(|found| is_enough(&found.rank)) => list,
            list => [list, gl_hardware()].into_iter().flatten().collect(),
        },
        // A page asks for its adapter, and awaits the answer (src/gpu/page.rs).
        Search::Only(Backend::Cpu | Backend::WebGpu) => Vec::new(),
        Search::Only(Backend::Gl) => gl().unwrap_or_default(),
        Search::Only(Backend::Vulkan) => of(wgpu::Backends::VULKAN, false),
        Search::Only(Backend::Metal) => of(wgpu::Backends::METAL, false),
        Search::Only(Backend::D3d12) => of(wgpu::Backends::DX12, false),
        Search::Fallback => {
            let mut by_fxc = of(wgpu::Backends::DX12, true);
            by_fxc.retain(|found| !found.adapter.info.software);
            [gl_hardware(), by_fxc].into_iter().flatten().collect()
        }
    };
    list.sort_by_key(|found| found.rank);
    list.into_iter().map(|found| found.adapter).collect()
}

/// Errors: UNSUPPORTED for GL without the feature `gl`.
pub fn check_built(backend: Option<Backend>) -> Result<()> {
    if backend == Some(Backend::Gl) && !cfg!(feature = "gl") {
        return Err(Error::unsupported("this library was built without OpenGL (cargo feature `gl`)"));
    }
    Ok(())
}

/// Why a search for this backend alone has found nothing, and what is to be installed where that can be named.
pub fn absence(backend: Backend) -> &'static str {
    match backend {
        Backend::Vulkan => loader::absence(),
        Backend::Gl if SYSTEM == System::FreeDesktop => {
            "no OpenGL ES 3.1 with compute shaders through EGL; Debian and Ubuntu: libegl1 and libgl1-mesa-dri, or the \
             GPU's own driver"
        }
        Backend::Gl => "no OpenGL ES 3.1 with compute shaders",
        Backend::Metal if !SYSTEM.is_apples() => "Metal is there on macOS and iOS only",
        Backend::D3d12 if SYSTEM != System::Windows => "Direct3D 12 is there on Windows only",
        Backend::WebGpu => "WebGPU is there in pages only",
        Backend::Metal | Backend::D3d12 | Backend::Cpu => "the system lists no device",
    }
}

/// Makes the next search ask the drivers anew. For recovery after a device was lost, since an upgraded driver is not
/// seen through the old one's adapters; devices in use keep theirs. That GL had no hardware stays known: each search
/// costs Mesa half a megabyte that it never frees.
pub fn forget_drivers() {
    native::forget();
}

/// The limits a device is opened with where the adapter has no better ones: OpenGL ES 3.1 hardware meets them.
pub(in crate::gpu) fn required_limits() -> wgpu::Limits {
    wgpu::Limits::downlevel_defaults()
}

/// A device has timestamps, mappable storage buffers and BC textures if the adapter has them, and no other feature. The
/// host's own devices do without BC, because hosts written for earlier versions do not enable it.
pub(in crate::gpu) fn device_descriptor(adapter: &wgpu::Adapter, is_hosts: bool) -> wgpu::DeviceDescriptor<'static> {
    let offered = adapter.limits();
    let limits = wgpu::Limits {
        max_buffer_size: offered.max_buffer_size.min(MAX_BUFFER_SIZE),
        max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size.min(MAX_BUFFER_SIZE),
        max_texture_dimension_2d: offered.max_texture_dimension_2d.min(MAX_TEXTURE_SIDE),
        max_texture_dimension_3d: offered.max_texture_dimension_3d.min(MAX_BLOCK_SIDE),
        max_storage_buffers_per_shader_stage: offered.max_storage_buffers_per_shader_stage.min(MOST_BOUND),
        max_storage_textures_per_shader_stage: offered.max_storage_textures_per_shader_stage.min(MOST_BOUND),
        ..required_limits()
    };
    let of_any = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::MAPPABLE_PRIMARY_BUFFERS;
    let wanted = if is_hosts { of_any } else { of_any | wgpu::Features::TEXTURE_COMPRESSION_BC };
    wgpu::DeviceDescriptor {
        label: Some("bhr"),
        required_features: adapter.features() & wanted,
        required_limits: limits,
        memory_hints: wgpu::MemoryHints::Manual { suballocated_device_memory_block_size: MEMORY_BLOCK },
        ..Default::default()
    }
}

/// Largest buffer and storage binding asked for: what a tile of the largest frames needs, not what the adapter could.
const MAX_BUFFER_SIZE: u64 = 256 << 20;

/// Largest side of a texture asked for: that of a window.
const MAX_TEXTURE_SIDE: u32 = 16384;
/// Largest side of a texture with three sides: the rows of structure of matter with depth.
const MAX_BLOCK_SIDE: u32 = crate::emit::grid::MOST_ROWS as u32;

/// Storage buffers, and textures, of a kernel: a target for each output of a frame, and what records take.
const MOST_BOUND: u32 = crate::scene::MOST_OUTPUTS as u32 + 4;

/// wgpu takes device memory from the driver in blocks of this many bytes: the first, and the largest.
const MEMORY_BLOCK: std::ops::Range<u64> = (1 << 20)..(32 << 20);

/// Asked anew each time, since all adapters of one wgpu GL instance share one GL context, which two threads cannot use
/// at once. None without the feature `gl`; `None` when the search itself failed.
fn gl() -> Option<Vec<RankedAdapter>> {
    let question = Question { backend: wgpu::Backends::GL, validation: false, by_fxc: false };
    if !cfg!(feature = "gl") || loader::obstacle(question.backend).is_some() {
        return Some(Vec::new());
    }
    let search = || -> Result<Vec<RankedAdapter>> {
        // wgpu makes the contexts of adapters when it searches for them.
        let (thread, age) = (GlThread::start()?, DisplayAge::now());
        thread.run(|| {
            // Adapters that are not wanted are dropped here.
            let _driver = driver_lock::lock();
            let asked = native::ask_drivers(question, false).into_iter().next();
            let Some(DriverAdapters { instance, list, hlsl }) = asked else { return Vec::new() };
            keep_display(instance);
            // All adapters of an instance share its context.
            if let Some(first) = list.first() {
                thread.guard_context(first);
            }
            list.into_iter().filter_map(|raw| usable(raw, None, Some((thread.clone(), age)), &hlsl)).collect()
        })
    };
    search().inspect_err(|error| log::info!("adapters of GL passed over: {error}")).ok()
}

/// The adapters of [`gl`] that are hardware.
fn gl_hardware() -> Vec<RankedAdapter> {
    if NO_GL_HARDWARE.load(Ordering::Relaxed) {
        return Vec::new();
    }
    let Some(mut list) = gl() else { return Vec::new() };
    list.retain(|found| !found.adapter.info.software);
    NO_GL_HARDWARE.store(list.is_empty(), Ordering::Relaxed);
    list
}

/// The result of the last search by [`gl_hardware`].
static NO_GL_HARDWARE: AtomicBool = AtomicBool::new(false);

/// With its last instance on an EGL display wgpu terminates the display, which is one for the whole process: with it go
/// the contexts of a host that uses it too. So the first instance stays.
fn keep_display(instance: Option<wgpu::Instance>) {
    static KEPT: OnceLock<wgpu::Instance> = OnceLock::new();
    if let Some(instance) = instance.filter(|_| SYSTEM != System::Windows) {
        KEPT.get_or_init(|| instance);
    }
}

/// An adapter that can run the tracer, and its place in the list: lower is better.
struct RankedAdapter {
    rank: Rank,
    adapter: Adapter,
}

/// Lower is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    software: bool,
    /// FXC compiles its kernels.
    by_fxc: bool,
    /// The kind of hardware.
    class: u8,
    interface: u8,
}

/// `None`, with the reason in the log, when it cannot run the tracer.
fn usable(
    raw: wgpu::Adapter,
    instance: Option<wgpu::Instance>,
    gl: Option<(Arc<GlThread>, DisplayAge)>,
    hlsl: &HlslCompiler,
) -> Option<RankedAdapter> {
    let found = raw.get_info();
    checked(raw, instance, gl, hlsl)
        .map(|mut usable| {
            if usable.adapter.info.backend == Backend::D3d12 {
                usable.adapter.info.driver += &format!("; kernels compiled by {hlsl}");
            }
            usable
        })
        .inspect_err(|reason| log::info!("adapter {} ({}) passed over: {reason}", found.name, found.backend))
        .ok()
}

/// Errors: the reason why it cannot run the tracer.
fn checked(
    raw: wgpu::Adapter,
    instance: Option<wgpu::Instance>,
    gl: Option<(Arc<GlThread>, DisplayAge)>,
    hlsl: &HlslCompiler,
) -> Result<RankedAdapter, String> {
    let found = raw.get_info();
    let Some(backend) = backend(found.backend) else {
        return Err("bhr does not use this interface".into());
    };
    if !raw.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS) {
        return Err("it has no compute shaders".into());
    }
    let mut lacking = None;
    required_limits().check_limits_with_fail_fn(&raw.limits(), true, |name, needed, offered| {
        lacking = Some(format!("its {name} is {offered}, bhr needs {needed}"));
    });
    if let Some(reason) = lacking {
        return Err(reason);
    }
    let driver = [found.driver.as_str(), found.driver_info.as_str()];
    let kind =
        if backend == Backend::Gl && is_software(&found.name) { wgpu::DeviceType::Cpu } else { found.device_type };
    let info = AdapterInfo {
        backend,
        discrete: kind == wgpu::DeviceType::DiscreteGpu,
        software: kind == wgpu::DeviceType::Cpu,
        vendor_id: found.vendor,
        device_id: found.device,
        driver: driver.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" "),
        name: found.name,
    };
    let handle = Handle { raw: Some(raw), instance, gl };
    let compiler = (backend == Backend::D3d12).then(|| hlsl.clone());
    Ok(RankedAdapter { rank: rank(kind, backend, hlsl), adapter: Adapter { info, handle, hlsl: compiler, host: None } })
}

/// Whether a renderer's name in GL, which tells no kinds apart, is that of a software one. (wgpu knows the first two.)
fn is_software(renderer: &str) -> bool {
    let name = renderer.to_lowercase();
    ["llvmpipe", "swiftshader", "softpipe", "swrast", "software", "gdi generic", "basic render"]
        .iter()
        .any(|known| name.contains(known))
}

fn rank(kind: wgpu::DeviceType, backend: Backend, hlsl: &HlslCompiler) -> Rank {
    let class = match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu | wgpu::DeviceType::Other => 2,
        wgpu::DeviceType::Cpu => 3,
    };
    let interface = match backend {
        Backend::D3d12 => 1,
        Backend::Gl => 2,
        _ => 0,
    };
    let by_fxc = backend == Backend::D3d12 && *hlsl == HlslCompiler::Fxc;
    Rank { software: kind == wgpu::DeviceType::Cpu, by_fxc, class, interface }
}

/// Whether AUTO looks no further, as GL's adapters are none better.
fn is_enough(rank: &Rank) -> bool {
    !rank.software && !rank.by_fxc
}

fn backend(of: wgpu::Backend) -> Option<Backend> {
    match of {
        wgpu::Backend::Vulkan => Some(Backend::Vulkan),
        wgpu::Backend::Metal => Some(Backend::Metal),
        wgpu::Backend::Dx12 => Some(Backend::D3d12),
        wgpu::Backend::Gl => Some(Backend::Gl),
        wgpu::Backend::BrowserWebGpu => Some(Backend::WebGpu),
        wgpu::Backend::Noop => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::DeviceType;

    #[test]
    fn ranks_hardware_before_software_gl_last_in_its_class_and_fxc_behind_all() {
        let dxc = HlslCompiler::Dxc("dxcompiler.dll".into());
        let order = [
            (DeviceType::DiscreteGpu, Backend::Vulkan, &dxc),
            (DeviceType::DiscreteGpu, Backend::D3d12, &dxc),
            (DeviceType::DiscreteGpu, Backend::Gl, &dxc),
            (DeviceType::IntegratedGpu, Backend::Metal, &HlslCompiler::Fxc),
            (DeviceType::IntegratedGpu, Backend::D3d12, &dxc),
            (DeviceType::IntegratedGpu, Backend::Gl, &HlslCompiler::Fxc),
            (DeviceType::VirtualGpu, Backend::Vulkan, &HlslCompiler::Fxc),
            (DeviceType::Other, Backend::Gl, &dxc),
            (DeviceType::DiscreteGpu, Backend::D3d12, &HlslCompiler::Fxc),
            (DeviceType::IntegratedGpu, Backend::D3d12, &HlslCompiler::Fxc),
            (DeviceType::Cpu, Backend::Vulkan, &dxc),
            (DeviceType::Cpu, Backend::D3d12, &dxc),
            (DeviceType::Cpu, Backend::Gl, &HlslCompiler::Fxc),
            (DeviceType::Cpu, Backend::D3d12, &HlslCompiler::Fxc),
        ];
        let ranks = order.map(|(kind, backend, hlsl)| rank(kind, backend, hlsl));
        assert!(ranks.is_sorted_by(|a, b| a < b), "{ranks:?}");
    }

    #[test]
    fn auto_looks_at_gl_unless_an_interface_before_it_has_hardware() {
        let dxc = HlslCompiler::Dxc("dxcompiler.dll".into());
        let enough = |kind, backend, hlsl| is_enough(&rank(kind, backend, hlsl));
        for (backend, hlsl) in
            [(Backend::Vulkan, &HlslCompiler::Fxc), (Backend::Metal, &HlslCompiler::Fxc), (Backend::D3d12, &dxc)]
        {
            assert!(enough(DeviceType::IntegratedGpu, backend, hlsl), "{backend}");
            assert!(!enough(DeviceType::Cpu, backend, hlsl), "{backend}");
        }
        assert!(!enough(DeviceType::DiscreteGpu, Backend::D3d12, &HlslCompiler::Fxc));
    }

    #[test]
    fn knows_software_by_its_name_in_gl() {
        for name in [
            "llvmpipe (LLVM 15.0.6, 256 bits)",
            "softpipe",
            "zink Vulkan 1.3(llvmpipe (LLVM 15.0.6, 256 bits) (MESA_LLVMPIPE))",
            "D3D12 (Microsoft Basic Render Driver)",
            "Apple Software Renderer",
            "Software Rasterizer",
            "Google SwiftShader",
        ] {
            assert!(is_software(name), "{name}");
        }
        for name in
            ["NVIDIA H200/PCIe/SSE2", "Mesa Intel(R) UHD Graphics 620 (KBL GT2)", "AMD Radeon RX 6800 (radeonsi)"]
        {
            assert!(!is_software(name), "{name}");
        }
    }
}
