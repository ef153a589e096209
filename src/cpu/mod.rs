// SPDX-License-Identifier: MIT OR Apache-2.0
//! The CPU tracer: f64, on a rayon pool of its own. The fallback where no driver exists, and the reference that the
//! GPU tracer is held against. Calls `physics`; knows no pixel memory and nothing of C.

#[cfg_attr(target_arch = "wasm32", path = "pool_absent.rs")]
mod pool;
mod rays;
mod record;
pub(crate) mod shade;
mod tables;
mod half;
mod lens;
mod record_source;
pub(crate) mod refine;
mod frame;
mod delivery;
mod render;
mod outputs;

use crate::allocate;
use crate::error::{Error, Result};
use crate::scene::{Hit, Ray, Scene, Transfer};
use crate::sky::StarIndex;
use crate::tracer::{AdapterInfo, Backend};
use pool::Pool;
use std::sync::Arc;
use tables::LensCache;

/// Most threads a pool may have, whatever the host asks for.
pub const MAX_THREADS: u32 = 1024;

pub struct CpuTracer {
    adapter: AdapterInfo,
    pool: Pool,
    lenses: Box<LensCache>,
    /// Lens tables for frames of outputs, which need more of each ray.
    output_lenses: Box<LensCache>,
    /// The tables of the last frame, kept from frame to frame.
    stars: Option<Arc<StarIndex>>,
    /// That of the last frame that was metered.
    exposure: delivery::Exposure,
}

/// The adapter as which the CPU tracer is listed.
pub fn adapter_info() -> AdapterInfo {
    AdapterInfo {
        backend: Backend::Cpu,
        discrete: false,
        software: true,
        vendor_id: 0,
        device_id: 0,
        name: "bhr CPU tracer (double precision)".into(),
        driver: format!("bhr {}", env!("CARGO_PKG_VERSION")),
    }
}

impl CpuTracer {
    /// `threads` 0: one per core this process may use. Errors: INVALID_ARGUMENT for too many, OUT_OF_MEMORY when the
    /// system gives no threads.
    pub fn new(threads: u32) -> Result<Self> {
        if threads > MAX_THREADS {
            return Err(Error::argument(format!("cpu_threads is {threads}; the limit is {MAX_THREADS}")));
        }
        let count = match threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()).min(MAX_THREADS as usize),
            n => n as usize,
        };
        Ok(Self {
            adapter: adapter_info(),
            pool: Pool::new(count)?,
            lenses: Box::default(),
            output_lenses: Box::default(),
            stars: None,
            exposure: Default::default(),
        })
    }

    pub fn adapter(&self) -> &AdapterInfo {
        &self.adapter
    }

    /// Errors: OUT_OF_MEMORY.
    pub fn trace_rays(&mut self, scene: &Scene, rays: &[Ray], hits: &mut [Hit]) -> Result<()> {
        allocate::check_room(0, "tracing rays")?;
        self.pool.install(|| rays::trace_rays(scene, rays, hits));
        Ok(())
    }

    /// Errors: OUT_OF_MEMORY.
    pub fn transfer_rays(&mut self, scene: &Scene, rays: &[Ray], found: &mut [Transfer]) -> Result<()> {
        allocate::check_room(0, "summing the matter along rays")?;
        self.pool.install(|| rays::transfer_rays(scene, rays, found))
    }
}
