//! The GPU tracer.
use crate::error::{Error, Result};
use crate::renderer::{AdapterInfo, FrameRequest, FrameStats, Progress, TileSink};
use crate::scene::{Hit, Ray, Scene};

mod adapter;
mod buffer;
mod device;
mod pipeline;
mod readback;
mod timer;

pub use adapter::{Adapter, Search, adapters, forget_drivers};
pub use buffer::Buffer;
pub use device::Device;
pub use pipeline::{Kernel, Loops, ProvenFinite};
pub use readback::{Copied, Readback};
pub use timer::GpuTimer;

pub struct GpuTracer {
    adapter: AdapterInfo,
}
impl GpuTracer {
    pub fn new(adapter: Adapter) -> Result<Self> { Ok(Self { adapter: adapter.info }) }
    pub fn adapter(&self) -> &AdapterInfo { &self.adapter }
    pub fn render(&mut self, _scene: &Scene, _request: &FrameRequest, _sink: &mut TileSink<'_>, _progress: &mut Progress<'_>) -> Result<FrameStats> { Err(Error::unsupported("skeleton")) }
    pub fn trace_rays(&mut self, _scene: &Scene, _rays: &[Ray], _hits: &mut [Hit]) -> Result<()> { Err(Error::unsupported("skeleton")) }
}

/// Every shader of this tracer, joined from its parts as the device gets it: name and WGSL. For `tests/shaders.rs`.
#[doc(hidden)]
pub fn shader_sources() -> Vec<(&'static str, String)> {
    Vec::new()
}
