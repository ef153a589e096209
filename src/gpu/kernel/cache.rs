// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pipelines of a device's kernels that are there or being made, each by one thread while others wait for it. Knows
//! what each kernel binds ([`KernelKey`]), not what with.

use super::key::KernelKey;
use super::slots::Slot;
use super::stage::Compiled;
use crate::deferred::hold;
use crate::error::Result;
use crate::gpu::device::pipeline::{Kernel, Loops, ProvenFinite};
use crate::gpu::device::wgpu_device::Device;
use std::collections::HashMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// SAFETY of the promise: `every_loop_ends_for_a_reason` of tests/shaders.rs holds every loop of every shader against a
/// list that says why it ends, and fails for one that is not on it.
const LOOPS: Loops = Loops::Proven(unsafe { ProvenFinite::promise() });

/// The pipelines that are there or being made; shared with the threads that make them.
pub(in crate::gpu) struct PipelineCache {
    state: Mutex<State>,
    /// Pipelines that are kept.
    pub(in crate::gpu) most: usize,
    /// A pipeline is there, or could not be made.
    settled: Condvar,
}

#[derive(Default)]
struct State {
    entries: HashMap<KernelKey, CacheEntry>,
    /// The keys of `entries` whose pipelines are there: first those that no frame has asked for yet, in the order in
    /// which they were made; then the others, in the order in which they were last used.
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
    /// For so many pipelines at `most`.
    pub(in crate::gpu) fn new(most: usize) -> Self {
        Self { state: Mutex::default(), most, settled: Condvar::new() }
    }

    /// How many of the pipelines that are there a frame has asked for.
    pub(in crate::gpu) fn asked_for(&self) -> usize {
        let state = self.lock();
        state.used.len() - state.ahead
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The kernel's pipeline, made now unless it is there; waits for a thread that is making it. Errors: as
    /// [`Device::compute_pipeline`].
    pub(in crate::gpu) fn get(&self, device: &Device, key: KernelKey) -> Result<Compiled> {
        self.get_for(device, key, false)
    }

    /// The kernel's pipeline for frames that may come: takes the place of no pipeline that a frame has used.
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
        device.with_deep_stack(|| {
            // Messages wait until those who wait for the pipeline have it.
            let _holding = hold();
            let guard = CompileGuard { cache: self, key, ahead, compiled: None };
            guard.settle(self.compile(device, key))
        })
    }

    /// Whether the kernel's pipeline is there.
    pub(in crate::gpu) fn has(&self, key: KernelKey) -> bool {
        matches!(self.lock().entries.get(&key), Some(CacheEntry::Compiled(_)))
    }

    fn compile(&self, device: &Device, key: KernelKey) -> Result<Compiled> {
        let kind = key.kind;
        let layouts = kind.groups().iter().map(|slots| self.layout(device, slots)).collect::<Result<Vec<_>>>()?;
        let pipeline = device.compute_pipeline(&Kernel {
            label: kind.entry_point(),
            source: &[&kind.wgsl()?],
            loops: LOOPS,
            entry_point: kind.entry_point(),
            constants: &key.constants(),
            zero_workgroup_memory: false,
            groups: &layouts.iter().collect::<Vec<_>>(),
        })?;
        Ok(Compiled { pipeline, layouts, group: kind.workgroup() })
    }

    pub(in crate::gpu) fn layout(&self, device: &Device, slots: &[Slot]) -> Result<wgpu::BindGroupLayout> {
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
