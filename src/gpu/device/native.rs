// SPDX-License-Identifier: MIT OR Apache-2.0
//! What drivers have of Vulkan, Metal and Direct3D 12: asked once for each, interface by interface, so that a search
//! for one asks no other driver, and a panic in one leaves the others. Knows nothing of what bhr needs of adapters.

use super::hlsl_compiler::HlslCompiler;
use super::instance::{self, DriverAdapters};
use super::{driver_lock, loader, process_end};
use crate::attempt;
use crate::platform::{SYSTEM, System};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A search, whose result is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Question {
    /// One interface.
    pub backend: wgpu::Backends,
    pub validation: bool,
    /// Direct3D 12 without DXC.
    pub by_fxc: bool,
}

/// The interfaces that a search may ask for, in the order of their adapters among equals.
pub(super) const INTERFACES: [wgpu::Backends; 3] =
    [wgpu::Backends::VULKAN, wgpu::Backends::METAL, wgpu::Backends::DX12];

/// The results of the first searches. Kept for the life of the process: opening a context then takes 2 ms instead of 14
/// (lavapipe), drivers are not loaded and unloaded under the host. This lock is held for a few instructions; who holds
/// [`driver_lock`] may take it, but not the other way round.
static FOUND: Mutex<Vec<Found>> = Mutex::new(Vec::new());

/// The result of a search.
struct Found {
    question: Question,
    /// Whether the instance makes surfaces of Wayland, where there is one.
    wayland: bool,
    adapters: Vec<DriverAdapters>,
}

fn found() -> MutexGuard<'static, Vec<Found>> {
    FOUND.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Asked anew where nothing was found, and where the environment has got a Wayland display since.
pub(super) fn native(question: Question) -> Vec<DriverAdapters> {
    if !wgpu::Instance::enabled_backend_features().contains(question.backend) {
        return Vec::new();
    }
    let wayland = instance::may_try_wayland();
    let kept = || {
        let all = found();
        let kept = all.iter().find(|kept| kept.question == question && (kept.wayland || !wayland))?;
        kept.adapters.iter().any(|one| !one.list.is_empty()).then(|| kept.adapters.clone())
    };
    kept().unwrap_or_else(|| {
        // A second thread waits for what the first one finds.
        let _driver = driver_lock::lock();
        kept().unwrap_or_else(|| {
            let adapters = ask_drivers(question, wayland);
            let mut all = found();
            let before = all.iter().position(|kept| kept.question == question).map(|at| all.swap_remove(at));
            all.push(Found { question, wayland, adapters: adapters.clone() });
            drop(all);
            drop(before);
            adapters
        })
    })
}

/// Makes the next search ask the drivers anew.
pub(super) fn forget() {
    let forgotten = std::mem::take(&mut *found());
    let _driver = driver_lock::lock();
    drop(forgotten);
}

/// Asks the drivers of one interface.
pub(super) fn ask_drivers(question: Question, wayland: bool) -> Vec<DriverAdapters> {
    let backend = question.backend;
    // Without VALIDATION_INDIRECT_CALL, which would compile pipelines for indirect dispatches, and bhr makes none;
    // without DEBUG, whose shaders say that they were WGSL, which older layers take for an error.
    let flags = if question.validation { wgpu::InstanceFlags::VALIDATION } else { wgpu::InstanceFlags::empty() };
    process_end::watch();
    let _driver = driver_lock::lock();
    let _attempt = attempt::begin();
    if let Some(why) = loader::obstacle(backend) {
        // Many a Windows has no Vulkan; what is no loader was installed by mistake.
        let level = if SYSTEM == System::Windows { log::Level::Info } else { log::Level::Warn };
        log::log!(level, "no adapter of {backend:?}: {why}");
        return Vec::new();
    }
    let mut compilers = Vec::new();
    if backend == wgpu::Backends::DX12 {
        compilers = HlslCompiler::all();
        compilers.retain(|hlsl| match hlsl {
            HlslCompiler::Dxc(_) => !question.by_fxc,
            HlslCompiler::Fxc => loader::has_fxc(),
        });
    }
    let found = instance::ask(backend, flags, wayland, compilers);
    process_end::watch();
    if found.iter().all(|one| one.list.is_empty()) {
        log::info!("no adapter of {backend:?}: no loader, no driver, or no device behind it");
    }
    if backend == wgpu::Backends::DX12 {
        for one in &found {
            log::info!("Direct3D 12: kernels of {} adapters are compiled by {:?}", one.list.len(), one.hlsl);
        }
    }
    found
}
