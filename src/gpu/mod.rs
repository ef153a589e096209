//! The GPU tracer: wgpu compute, f32. Owns the device, the pipelines and the readback. Mirrors the CPU tracer in what
//! a frame shows; knows no host memory (tiles go to a sink) and nothing of C.

mod adapter;
mod bindings;
mod bloom;
mod buffer;
mod compilers;
mod constants;
mod device;
#[doc(hidden)]
pub mod driver_lock;
mod export;
mod fragments;
mod frame;
mod frame_buffers;
mod frame_kernels;
mod gl_thread;
mod kernel_key;
mod kernels;
#[cfg(test)]
mod layout;
mod lens_kerr;
mod lens_schwarzschild;
mod loader;
mod pipeline;
mod preprocess;
mod present;
mod rays;
mod readback;
mod records;
mod refine;
mod sky_maps;
mod slots;
mod specialise;
mod stages;
mod steps;
mod submission;
mod swapchain;
mod tables;
mod texture;
mod tiles;
mod timer;
mod uniforms;
mod upload;
mod wgsl;

pub use adapter::{Adapter, Search, adapters, check_built, forget_drivers};
pub use buffer::Buffer;
pub use device::{Device, Loss};
#[doc(hidden)]
pub use fragments::join_wgsl;
pub use frame::{BegunFrame, FrameTarget, Recording};
#[cfg(test)]
pub(crate) use gl_thread::GlThread;
pub use gl_thread::GlTracer;
pub(crate) use gl_thread::park;
pub use kernels::KernelWaits;
pub use pipeline::{Kernel, Loops, ProvenFinite};
#[doc(hidden)]
pub use present::Presenter;
pub use readback::{Arrived, Copied, Readback};
pub use submission::Submitted;
pub use swapchain::{Acquired, Swapchain};
pub use texture::Texture;
pub use timer::{GpuTimer, read_time};
#[doc(hidden)]
pub use wgsl::shader_sources;

use crate::error::{Error, ErrorKind, Result};
use crate::physics::trace::Settings;
use crate::renderer::Backend;
use crate::scene::{Method, Projection, Scene};
use kernel_key::{KernelKey, Variant};
use kernels::Kernels;
use std::collections::HashSet;
use std::sync::Arc;
use tables::Tables;

/// f32 rounds at 6e-8; a step's error estimate cannot be trusted below a few times that.
const SMALLEST_TOLERANCE: f64 = 3e-7;
/// Nystrom step in sigma for given rays: truncation stays below rounding.
const RAY_STEP: f64 = 0.2;

/// Traces on one device.
pub struct GpuTracer {
    kernels: Kernels,
    /// The kernels of each kind of frame whose followers were anticipated.
    anticipated: HashSet<Vec<KernelKey>>,
    /// Made when light is first shaded.
    tables: Option<Tables>,
    buffers: frame_buffers::FrameBuffers,
    ray_buffers: rays::RayBuffers,
    /// Goes after all that was made with it.
    device: Arc<Device>,
    adapter: Arc<Adapter>,
}

impl GpuTracer {
    /// Opens a device, on GL for threads without a GL context ([`Device::open`]). The first frame's pipelines are
    /// being made from now on, its sky follows with it. Errors: as `Device::open`.
    pub fn new(adapter: Adapter) -> Result<Self> {
        let device = Arc::new(Device::open(&adapter)?);
        // All of a GL device shares one context, which two threads cannot use at once.
        let kernels = Kernels::new(device.clone(), adapter.info.backend != Backend::Gl, adapter.info.software);
        // Some GL drivers promise compute shaders and then translate none (seen on the H200): better known now. And a
        // device's first pipeline is made alone (`driver_lock`): the smallest, so that the large ones are made side by
        // side.
        kernels.get(KernelKey::Count).map_err(|error| Error::new(ErrorKind::NoAdapter, error.message))?;
        let mut tracer = Self {
            adapter: Arc::new(adapter),
            device,
            kernels,
            anticipated: HashSet::new(),
            tables: None,
            buffers: Default::default(),
            ray_buffers: Default::default(),
        };
        tracer.expect_first_frame();
        Ok(tracer)
    }

    /// For tests: waits until the pipelines that are made in the background are there, and tells how often frames
    /// found some missing.
    pub fn settled_waits(&self) -> KernelWaits {
        self.kernels.settle();
        self.kernels.waits()
    }

    pub fn adapter(&self) -> &Arc<Adapter> {
        &self.adapter
    }

    pub fn device(&self) -> Arc<Device> {
        self.device.clone()
    }
}

/// Distance of two uniforms of a buffer of which dispatches choose one.
fn uniform_stride<T>(device: &Device) -> u64 {
    let alignment = u64::from(device.limits().min_uniform_buffer_offset_alignment);
    (size_of::<T>() as u64).next_multiple_of(alignment)
}

/// Settings of the f64 tracer brought to what f32 can do.
fn for_f32(settings: Settings) -> Settings {
    Settings { tolerance: settings.tolerance.max(SMALLEST_TOLERANCE), ..settings }
}

fn ray_settings(scene: &Scene) -> Settings {
    let mut settings = for_f32(scene.quality.ray_settings(scene.hole.spin));
    if scene.quality.method == Method::Auto {
        settings.step = RAY_STEP;
    }
    settings
}

/// What the tracing kernels of a scene are compiled with; pixels add what their shading needs.
fn variant(scene: &Scene, settings: &Settings, inside_horizon: bool) -> Variant {
    let spinning = scene.hole.spin != 0.0;
    Variant {
        method: settings.method.into(),
        spinning,
        delay: settings.delay,
        step_limit: spinning || settings.delay || inside_horizon,
        azimuth: false,
        projection: Some(Projection::Perspective),
    }
}
