// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pipelines of a device's kernels: made at first use, or before by threads of their own, several at a time. Knows
//! what each kernel binds ([`KernelKey`]), not what with.

use super::compilers::{CompileBatch, Compilers};
use super::key::KernelKey;
use super::slots::{Slot, edge_slots};
use super::variant::GROUP;
use crate::deferred::hold;
use crate::error::{Error, Result};
use crate::gpu::device::pipeline::{Kernel, Loops, ProvenFinite};
use crate::gpu::device::wgpu_device::Device;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// A pipeline and the layouts of its groups.
#[derive(Clone)]
pub struct Compiled {
    pipeline: wgpu::ComputePipeline,
    layouts: Vec<wgpu::BindGroupLayout>,
    /// Threads of a workgroup that goes over pixels.
    group: [u32; 2],
}

/// A pipeline with what it binds; its group 0 has one `UniformPart`.
pub struct Stage {
    pipeline: wgpu::ComputePipeline,
    groups: Vec<wgpu::BindGroup>,
    group: [u32; 2],
}

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

/// The pipelines that are there or being made; shared with the threads that make them.
pub(in crate::gpu) struct PipelineCache {
    state: Mutex<State>,
    /// Pipelines that are kept.
    most: usize,
    /// A pipeline is there, or could not be made.
    settled: Condvar,
}

#[derive(Default)]
struct State {
    entries: HashMap<KernelKey, CacheEntry>,
    /// Those of `entries` that are there: first those that no frame has asked for yet, the one made last being the last
    /// of them; then the others, the one used last being the last.
    used: Vec<KernelKey>,
    /// How many no frame has asked for yet.
    ahead: usize,
    /// Kernels that bind the same share the layout, so that they can share groups.
    layouts: HashMap<Vec<Slot>, wgpu::BindGroupLayout>,
}

enum CacheEntry {
    /// By a thread that will say so when it is done.
    Compiling,
    Compiled(Compiled),
}

impl State {
    /// A frame asks for a pipeline that is there, or one that may come (`ahead`).
    fn note_use(&mut self, key: KernelKey, ahead: bool) {
        let Some(place) = self.used.iter().position(|used| *used == key) else { return };
        let was_ahead = place < self.ahead;
        if ahead && !was_ahead {
            return;
        }
        self.used.remove(place);
        self.ahead -= usize::from(was_ahead);
        let place = if ahead { self.ahead } else { self.used.len() };
        self.used.insert(place, key);
        self.ahead += usize::from(ahead);
    }
}

impl PipelineCache {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The kernel's pipeline, made now unless it is there; waits for a thread that is making it. Errors: as
    /// [`Device::compute_pipeline`].
    pub(in crate::gpu) fn get(&self, device: &Device, key: KernelKey) -> Result<Compiled> {
        self.get_for(device, key, false)
    }

    /// The same for frames that may come: takes the place of no pipeline that a frame has used.
    pub(in crate::gpu) fn get_ahead(&self, device: &Device, key: KernelKey) -> Result<Compiled> {
        self.get_for(device, key, true)
    }

    fn get_for(&self, device: &Device, key: KernelKey, ahead: bool) -> Result<Compiled> {
        let mut state = self.lock();
        loop {
            match state.entries.get(&key) {
                Some(CacheEntry::Compiled(compiled)) => {
                    let compiled = compiled.clone();
                    state.note_use(key, ahead);
                    return Ok(compiled);
                }
                Some(CacheEntry::Compiling) => {
                    state = self.settled.wait(state).unwrap_or_else(PoisonError::into_inner);
                }
                None => break,
            }
        }
        state.entries.insert(key, CacheEntry::Compiling);
        drop(state);
        // Messages wait until those who wait for the pipeline have it.
        let _holding = hold();
        let guard = CompileGuard { cache: self, key, ahead, compiled: None };
        guard.settle(self.compile(device, key))
    }

    /// Whether the kernel's pipeline is there.
    pub(in crate::gpu) fn has(&self, key: KernelKey) -> bool {
        matches!(self.lock().entries.get(&key), Some(CacheEntry::Compiled(_)))
    }

    fn compile(&self, device: &Device, key: KernelKey) -> Result<Compiled> {
        let layouts = key.groups().iter().map(|slots| self.layout(device, slots)).collect::<Result<Vec<_>>>()?;
        let pipeline = device.compute_pipeline(&Kernel {
            label: key.entry_point(),
            source: &[&key.wgsl()?],
            loops: LOOPS,
            entry_point: key.entry_point(),
            constants: &key.constants(),
            zero_workgroup_memory: false,
            groups: &layouts.iter().collect::<Vec<_>>(),
        })?;
        Ok(Compiled { pipeline, layouts, group: key.workgroup() })
    }

    fn layout(&self, device: &Device, slots: &[Slot]) -> Result<wgpu::BindGroupLayout> {
        // Messages wait until the lock is released.
        let _holding = hold();
        let mut state = self.lock();
        if let Some(layout) = state.layouts.get(slots) {
            return Ok(layout.clone());
        }
        let entries = slots
            .iter()
            .zip(0..)
            .map(|(slot, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: slot.binding_type(),
                count: None,
            })
            .collect::<Vec<_>>();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        let layout = device.scoped_off_thread("laying out bindings", |d| d.create_bind_group_layout(&descriptor))?;
        state.layouts.insert(slots.into(), layout.clone());
        Ok(layout)
    }
}

/// A promise to tell those who wait for a pipeline what became of it, kept even if making it panics.
struct CompileGuard<'a> {
    cache: &'a PipelineCache,
    key: KernelKey,
    /// No frame has asked for it yet.
    ahead: bool,
    compiled: Option<Compiled>,
}

impl CompileGuard<'_> {
    fn settle(mut self, result: Result<Compiled>) -> Result<Compiled> {
        result.inspect(|compiled| self.compiled = Some(compiled.clone()))
    }
}

impl Drop for CompileGuard<'_> {
    fn drop(&mut self) {
        let mut state = self.cache.lock();
        match self.compiled.take() {
            Some(compiled) => {
                state.entries.insert(self.key, CacheEntry::Compiled(compiled));
                let place = if self.ahead { state.ahead } else { state.used.len() };
                state.used.insert(place, self.key);
                state.ahead += usize::from(self.ahead);
                // The oldest go first.
                let too_many = state.used.len().saturating_sub(self.cache.most);
                let old = state.used.drain(..too_many).collect::<Vec<_>>();
                state.ahead = state.ahead.saturating_sub(too_many);
                old.iter().for_each(|key| drop(state.entries.remove(key)));
            }
            None => drop(state.entries.remove(&self.key)),
        }
        drop(state);
        self.cache.settled.notify_all();
    }
}

impl Kernels {
    /// `threads`: whether the device may be used from several.
    pub fn new(device: Arc<Device>, threads: bool, software: bool) -> Self {
        let most = if software { MOST_KERNELS_SOFTWARE } else { MOST_KERNELS };
        let cache = Arc::new(PipelineCache { state: Mutex::default(), most, settled: Condvar::new() });
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
    pub fn get(&self, key: KernelKey) -> Result<Compiled> {
        if !self.cache.has(key) {
            self.late.fetch_add(1, Ordering::Relaxed);
        }
        self.cache.get(&self.device, key).map_err(|error| self.device.explain(error))
    }

    /// Those of `keys` whose pipelines are not there.
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
        let asked_for = {
            let state = self.cache.lock();
            state.used.len() - state.ahead
        };
        // The less likely ones would take the places of the more likely ones.
        keys.truncate(self.cache.most.saturating_sub(asked_for));
        self.compilers.compile_later(&self.cache, &self.device, keys);
    }

    /// The layout of group 3 of kernels that shade.
    pub fn edge_list(&self) -> Result<wgpu::BindGroupLayout> {
        self.cache.layout(&self.device, &edge_slots())
    }
}

/// SAFETY of the promise: `every_loop_ends_for_a_reason` of tests/shaders.rs holds every loop of every shader against a
/// list that says why it ends, and fails for one that is not on it.
const LOOPS: Loops = Loops::Proven(unsafe { ProvenFinite::promise() });

impl Compiled {
    /// The layout of group 2.
    pub fn target(&self) -> Result<&wgpu::BindGroupLayout> {
        self.layouts.get(2).ok_or_else(|| Error::internal("a kernel without a target"))
    }

    /// The pipeline with `groups`, the first of its groups: of each the resources in the order of its slots.
    pub fn stage(&self, device: &Device, groups: &[&[wgpu::BindingResource<'_>]]) -> Result<Stage> {
        let groups = groups.iter().zip(&self.layouts).map(|(resources, layout)| device.bind(layout, resources));
        let groups = groups.collect::<Result<Vec<_>>>()?;
        Ok(Stage { pipeline: self.pipeline.clone(), groups, group: self.group })
    }
}

impl Stage {
    /// Binds the stage and runs `groups` workgroups. `offset`: of the `UniformPart` of group 0; `None` if it has none.
    pub fn run(&self, pass: &mut wgpu::ComputePass<'_>, offset: Option<u32>, groups: [u32; 2]) {
        pass.set_pipeline(&self.pipeline);
        for (group, index) in self.groups.iter().zip(0..) {
            pass.set_bind_group(index, group, if index == 0 { offset.as_slice() } else { &[] });
        }
        pass.dispatch_workgroups(groups[0], groups[1], 1);
    }

    /// One thread for each pixel of a rectangle.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, size: [u32; 2]) {
        self.run(pass, Some(offset), groups_over(size, self.group));
    }
}

fn groups_over(size: [u32; 2], group: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|i| size[i].div_ceil(group[i]))
}

/// Workgroups over a rectangle of pixels.
pub fn pixel_groups(size: [u32; 2]) -> [u32; 2] {
    groups_over(size, GROUP)
}

/// Workgroups that share a list of a tile's pixels: enough for a large GPU's few thousand, and on a software driver,
/// where each costs its share of a loop's body however little there is to do, few.
const LIST_GROUPS: u32 = 2048;
const LIST_GROUPS_SOFTWARE: u32 = 16;

/// The workgroups that go over a list of pixels of a tile. `summed`: where matter is summed along their rays, the
/// pixels of the tile for each workgroup of a software driver.
///
/// Mesa's lavapipe leaves every loop of a thread once all of them together have taken 65535 turns
/// (LP_MAX_TGSI_LOOP_ITERATIONS of its lp_limits.h), and a ray through matter takes thousands. With 16 workgroups the
/// pixels at a list's end came out black.
pub fn list_groups(tile: [u32; 2], software: bool, summed: Option<u32>) -> u32 {
    match (software, summed) {
        (false, _) => LIST_GROUPS,
        (true, None) => LIST_GROUPS_SOFTWARE,
        (true, Some(pixels)) => (tile[0] * tile[1] / pixels).clamp(LIST_GROUPS_SOFTWARE, 1 << 15),
    }
}

/// Errors: INTERNAL if a count of workgroups exceeds what the device takes.
pub fn check_groups(device: &Device, groups: [u32; 2]) -> Result<()> {
    let limit = device.limits().max_compute_workgroups_per_dimension;
    if groups.iter().any(|&g| g > limit) {
        return Err(Error::internal(format!(
            "a dispatch of {groups:?} workgroups exceeds the device's limit of {limit}"
        )));
    }
    Ok(())
}
