// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pipelines of a device's kernels: made at first use, or before by threads of their own, several at a time.

use super::cache::PipelineCache;
use super::compilers::{CompileBatch, Compilers, Threads};
use super::key::KernelKey;
use super::slots::edge_slots;
use super::stage::Compiled;
use crate::error::Result;
use crate::gpu::device::wgpu_device::Device;
use crate::platform::Instant;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Pipelines that a device keeps, on hardware and on software drivers, where each that has run takes some 6 MiB of
/// the host's memory.
const MOST_KERNELS: usize = 160;
const MOST_KERNELS_SOFTWARE: usize = 48;

/// The pipelines of one device.
pub struct Kernels {
    /// First, so that its threads end before the device does.
    compilers: Compilers,
    cache: Arc<PipelineCache>,
    device: Arc<Device>,
    waits: AtomicU64,
    late: AtomicU64,
}

/// How often frames found pipelines missing; for tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KernelWaits {
    /// Pipelines that were not there when a frame began.
    pub waits: u64,
    /// Pipelines that a frame had not listed, and that were made one after the other.
    pub late: u64,
}

impl Kernels {
    /// `threads`: whether the device may be used from several.
    pub fn new(device: Arc<Device>, threads: bool, software: bool) -> Self {
        let most = if software { MOST_KERNELS_SOFTWARE } else { MOST_KERNELS };
        let cache = Arc::new(PipelineCache::new(most));
        let threads = match threads {
            true if device.compiles_alone() => Threads::One,
            true => Threads::Many,
            false => Threads::None,
        };
        Self { compilers: Compilers::new(threads), cache, device, waits: AtomicU64::new(0), late: AtomicU64::new(0) }
    }

    pub fn waits(&self) -> KernelWaits {
        KernelWaits { waits: self.waits.load(Ordering::Relaxed), late: self.late.load(Ordering::Relaxed) }
    }

    /// Waits until nothing is left to be made in the background; for tests.
    pub fn settle(&self) {
        self.compilers.settle();
    }

    /// The kernel's pipeline, made now unless it is there. Errors: as [`Device::compute_pipeline`].
    pub fn get(&self, key: impl Into<KernelKey>) -> Result<Compiled> {
        let key = key.into();
        if !self.cache.has(key) {
            self.late.fetch_add(1, Ordering::Relaxed);
        }
        self.cache.get(&self.device, key).map_err(|error| self.device.explain(error))
    }

    /// The kernels among `keys` whose pipelines are not there.
    pub fn missing(&self, keys: &[KernelKey]) -> Vec<KernelKey> {
        keys.iter().copied().filter(|key| !self.cache.has(*key)).collect()
    }

    /// Begins to make all of `keys` that are not there, several at a time; [`Self::finish`] ends it. `None`: none are
    /// missing.
    pub fn begin(&self, keys: &[KernelKey]) -> Option<CompileBatch> {
        let missing = self.missing(keys);
        self.waits.fetch_add(missing.len() as u64, Ordering::Relaxed);
        (!missing.is_empty()).then(|| self.compilers.compile_now(&self.cache, &self.device, missing))
    }

    /// Waits for what was begun. Errors: as [`Self::get`], the first one.
    pub fn finish(&self, batch: Option<CompileBatch>) -> Result<()> {
        let Some(batch) = batch else { return Ok(()) };
        let (started, names) = (Instant::now(), batch.names());
        let made = batch.finish(&self.cache, &self.device);
        log::debug!("a frame waited {} ms for kernels: {names}", started.elapsed().as_millis());
        made.map_err(|error| self.device.explain(error))
    }

    /// Does `work`, which makes what frames will need, in the background.
    pub fn run_in_background(&self, work: impl FnOnce() + Send + 'static) {
        self.compilers.run_in_background(work);
    }

    /// Makes those of `keys` that are not there in the background, the first ones first, instead of those that an
    /// earlier call asked for and that were not begun. Without effect where a device may be used from one thread only.
    pub fn anticipate(&self, mut keys: Vec<KernelKey>) {
        // The less likely ones would take the places of the more likely ones.
        keys.truncate(self.cache.most.saturating_sub(self.cache.asked_for()));
        self.compilers.compile_later(&self.cache, &self.device, keys);
    }

    /// The layout of group 3 of kernels that shade.
    pub fn edge_list(&self) -> Result<wgpu::BindGroupLayout> {
        self.cache.layout(&self.device, &edge_slots())
    }
}
