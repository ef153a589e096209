//! The GPU tracer.
use crate::error::{Error, Result};
use crate::renderer::{AdapterInfo, FrameRequest, FrameStats, Progress, TileSink};
use crate::scene::{Hit, Ray, Scene};

/// An adapter that a device can be opened on.
pub struct Adapter {
    pub info: AdapterInfo,
}
pub fn adapters(_validation: bool) -> Vec<Adapter> {
    Vec::new()
}
pub struct GpuTracer {
    adapter: AdapterInfo,
}
impl GpuTracer {
    pub fn new(adapter: Adapter) -> Result<Self> {
        Ok(Self { adapter: adapter.info })
    }
    pub fn adapter(&self) -> &AdapterInfo {
        &self.adapter
    }
    pub fn render(
        &mut self,
        _scene: &Scene,
        _request: &FrameRequest,
        _sink: &mut TileSink<'_>,
        _progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        Err(Error::unsupported("skeleton"))
    }
    pub fn trace_rays(&mut self, _scene: &Scene, _rays: &[Ray], _hits: &mut [Hit]) -> Result<()> {
        Err(Error::unsupported("skeleton"))
    }
}
