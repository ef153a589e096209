//! The CPU tracer: f64, rayon.
use crate::error::{Error, Result};
use crate::renderer::{AdapterInfo, Backend, FrameRequest, FrameStats, Progress, TileSink};
use crate::scene::{Hit, Ray, Scene};

pub struct CpuTracer {
    adapter: AdapterInfo,
}
pub fn adapter_info() -> AdapterInfo {
    AdapterInfo {
        backend: Backend::Cpu,
        discrete: false,
        software: true,
        vendor_id: 0,
        device_id: 0,
        name: "bhr CPU tracer".into(),
        driver: String::new(),
    }
}
impl CpuTracer {
    pub fn new(_threads: u32) -> Result<Self> {
        Ok(Self { adapter: adapter_info() })
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
pub fn trace_path(_scene: &Scene, _ray: &Ray, _capacity: usize) -> Result<Vec<[f64; 4]>> {
    Err(Error::unsupported("skeleton"))
}
