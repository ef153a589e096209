//! Finds the adapters that wgpu can compute on, and puts them in order. Opens no device and knows nothing of tracing.

use crate::error::{Error, Result};
use crate::renderer::{AdapterInfo, Backend};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The interfaces that a search looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Every interface of this platform. Its order is what an adapter index counts.
    All,
    /// As `All`, but GL is left alone when another interface has an adapter: starting it takes as long as all the rest.
    Auto,
    /// This interface alone. `Backend::Cpu` finds nothing: the CPU tracer is no adapter of wgpu.
    Only(Backend),
}

/// An adapter that a device can be opened on.
pub struct Adapter {
    pub info: AdapterInfo,
    handle: Handle,
}

impl Adapter {
    pub(super) fn raw(&self) -> Result<&wgpu::Adapter> {
        self.handle.raw.as_ref().ok_or_else(|| Error::internal("the adapter is being dropped"))
    }
}

/// Drops a GL adapter where it may touch GL contexts.
struct Handle {
    /// `None` only while it is being dropped.
    raw: Option<wgpu::Adapter>,
    gl: bool,
}

impl Drop for Handle {
    fn drop(&mut self) {
        if self.gl {
            let raw = self.raw.take();
            let _ = on_own_thread(move || drop(raw));
        }
    }
}

/// Every adapter of `search` that has what the tracer needs, best first: discrete GPUs, integrated ones, virtual and
/// unknown ones, software. Among equals GL is last; the driver's order decides the rest, so one machine has one order.
/// Hardware that several interfaces reach is listed once for each.
///
/// `validation`: adapters whose devices the driver's validation layers watch, if they are installed.
///
/// Never fails: without a loader or a driver the list is empty, and the log (info) says what was passed over and why.
pub fn adapters(search: Search, validation: bool) -> Vec<Adapter> {
    let mut found = match search {
        Search::All | Search::Auto => native(native_interfaces(), validation),
        Search::Only(Backend::Gl | Backend::Cpu) => Vec::new(),
        Search::Only(backend) => native(wgpu_backends(backend), validation),
    };
    if matches!(search, Search::All | Search::Only(Backend::Gl)) || (search == Search::Auto && found.is_empty()) {
        found.append(&mut gl(validation));
    }
    let mut usable = found.into_iter().filter_map(usable).collect::<Vec<_>>();
    usable.sort_by_key(|(rank, _)| *rank);
    usable.into_iter().map(|(_, adapter)| adapter).collect()
}

/// Makes the next search start the drivers anew. For recovery after a device was lost: an upgraded driver is not seen
/// through the connection to the old one. Adapters and devices in use keep theirs.
pub fn forget_drivers() {
    *connections() = [const { None }; 2];
}

/// The limits a device is opened with where the adapter has no better ones: OpenGL ES 3.1 hardware meets them.
pub(super) fn required_limits() -> wgpu::Limits {
    wgpu::Limits::downlevel_defaults()
}

/// The wgpu instances for Vulkan, Metal and D3D12, without and with validation. Kept for the life of the process: a
/// context is then opened in 5 ms instead of 14 (lavapipe), and drivers are not loaded and unloaded under the host.
static CONNECTIONS: Mutex<[Option<wgpu::Instance>; 2]> = Mutex::new([const { None }; 2]);

fn connections() -> MutexGuard<'static, [Option<wgpu::Instance>; 2]> {
    CONNECTIONS.lock().unwrap_or_else(PoisonError::into_inner)
}

fn connection(validation: bool) -> wgpu::Instance {
    let [plain, validated] = &mut *connections();
    let slot = if validation { validated } else { plain };
    slot.get_or_insert_with(|| connect(native_interfaces(), validation)).clone()
}

fn native_interfaces() -> wgpu::Backends {
    wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12
}

fn native(interfaces: wgpu::Backends, validation: bool) -> Vec<wgpu::Adapter> {
    guarded("Vulkan, Metal or D3D12", || pollster::block_on(connection(validation).enumerate_adapters(interfaces)))
}

/// GL, connected anew for each search, since all adapters of one wgpu GL instance share one GL context, which two threads
/// cannot use at once.
fn gl(validation: bool) -> Vec<wgpu::Adapter> {
    on_own_thread(move || {
        guarded("GL", || {
            let instance = connect(wgpu::Backends::GL, validation);
            pollster::block_on(instance.enumerate_adapters(wgpu::Backends::GL))
        })
    })
    .unwrap_or_else(|error| {
        log::info!("GL adapters passed over: {error}");
        Vec::new()
    })
}

/// Keeps wgpu's GL off the calling thread: it leaves its thread without a current GL context, and the host may have one.
fn on_own_thread<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T> {
    let thread = std::thread::Builder::new().name("bhr-gl".into()).spawn(work);
    let thread = thread.map_err(|error| Error::internal(format!("no thread for GL: {error}")))?;
    thread.join().map_err(|_| Error::internal("GL panicked"))
}

fn connect(backends: wgpu::Backends, validation: bool) -> wgpu::Instance {
    // Without VALIDATION_INDIRECT_CALL, which would compile pipelines for indirect dispatches, and bhr makes none.
    let flags = if validation {
        wgpu::InstanceFlags::DEBUG | wgpu::InstanceFlags::VALIDATION
    } else {
        wgpu::InstanceFlags::empty()
    };
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

/// Runs a search in a driver; one that panics has found nothing.
fn guarded(interface: &str, search: impl FnOnce() -> Vec<wgpu::Adapter>) -> Vec<wgpu::Adapter> {
    match catch_unwind(AssertUnwindSafe(search)) {
        Ok(found) => {
            if found.is_empty() {
                log::info!("no adapter of {interface}: no loader, no driver, or no device behind it");
            }
            found
        }
        Err(_) => {
            log::warn!("adapters of {interface} passed over: the search for them panicked");
            Vec::new()
        }
    }
}

/// Lower is better.
type Rank = (u8, bool);

/// The adapter with its rank; `None`, with the reason in the log, when it cannot run the tracer.
fn usable(raw: wgpu::Adapter) -> Option<(Rank, Adapter)> {
    let found = raw.get_info();
    let pass_over = |reason: String| {
        log::info!("adapter {} ({:?}) passed over: {reason}", found.name, found.backend);
        None
    };
    let Some(backend) = backend(found.backend) else {
        return pass_over("bhr does not use this interface".into());
    };
    if !raw.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS) {
        return pass_over("it has no compute shaders".into());
    }
    let mut lacking = None;
    required_limits().check_limits_with_fail_fn(&raw.limits(), true, |name, needed, offered| {
        lacking = Some(format!("its {name} is {offered}, bhr needs {needed}"));
    });
    if let Some(reason) = lacking {
        return pass_over(reason);
    }
    let driver = [found.driver.as_str(), found.driver_info.as_str()];
    let info = AdapterInfo {
        backend,
        discrete: found.device_type == wgpu::DeviceType::DiscreteGpu,
        software: found.device_type == wgpu::DeviceType::Cpu,
        vendor_id: found.vendor,
        device_id: found.device,
        driver: driver.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" "),
        name: found.name,
    };
    Some((
        rank(found.device_type, backend),
        Adapter { info, handle: Handle { raw: Some(raw), gl: backend == Backend::Gl } },
    ))
}

fn rank(kind: wgpu::DeviceType, backend: Backend) -> Rank {
    let class = match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu | wgpu::DeviceType::Other => 2,
        wgpu::DeviceType::Cpu => 3,
    };
    (class, backend == Backend::Gl)
}

fn backend(of: wgpu::Backend) -> Option<Backend> {
    match of {
        wgpu::Backend::Vulkan => Some(Backend::Vulkan),
        wgpu::Backend::Metal => Some(Backend::Metal),
        wgpu::Backend::Dx12 => Some(Backend::D3d12),
        wgpu::Backend::Gl => Some(Backend::Gl),
        wgpu::Backend::Noop | wgpu::Backend::BrowserWebGpu => None,
    }
}

fn wgpu_backends(of: Backend) -> wgpu::Backends {
    match of {
        Backend::Cpu => wgpu::Backends::empty(),
        Backend::Vulkan => wgpu::Backends::VULKAN,
        Backend::Metal => wgpu::Backends::METAL,
        Backend::D3d12 => wgpu::Backends::DX12,
        Backend::Gl => wgpu::Backends::GL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::DeviceType;

    #[test]
    fn ranks_hardware_before_software_and_gl_last_in_its_class() {
        let order = [
            (DeviceType::DiscreteGpu, Backend::Vulkan),
            (DeviceType::DiscreteGpu, Backend::Gl),
            (DeviceType::IntegratedGpu, Backend::D3d12),
            (DeviceType::IntegratedGpu, Backend::Gl),
            (DeviceType::VirtualGpu, Backend::Vulkan),
            (DeviceType::Other, Backend::Gl),
            (DeviceType::Cpu, Backend::Vulkan),
            (DeviceType::Cpu, Backend::Gl),
        ];
        let ranks = order.map(|(kind, backend)| rank(kind, backend));
        assert!(ranks.is_sorted_by(|a, b| a < b), "{ranks:?}");
    }

    #[test]
    fn a_search_that_panics_finds_nothing() {
        assert!(guarded("test", || panic!("a driver's bug")).is_empty());
    }
}
