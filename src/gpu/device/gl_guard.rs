// SPDX-License-Identifier: MIT OR Apache-2.0
//! A second EGL context that shares the objects of wgpu's, current on a thread of its own for as long as they are used.
//! Touches nothing of wgpu's but the handles it reads.
//!
//! Between its calls into GL wgpu has no context current. If another library of the process then calls eglTerminate,
//! wgpu's context ends at once, and its buffers are freed, even those that are mapped: wgpu goes on writing into these.
//! A context that is current on some thread outlives eglTerminate (EGL 1.5, section 3.2), and buffers live as long as
//! any context of their share group.

use crate::gpu::device::driver_lock;
use crate::thread_state::begin_own_thread;
use khronos_egl::{self as egl, DynamicInstance, EGL1_4};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};

/// Ends with its value.
pub struct ContextGuard {
    /// The thread waits until it is dropped.
    end: Option<mpsc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl ContextGuard {
    /// Guards the objects of the adapter's context, for a caller that holds the driver lock. Where that cannot be
    /// done, which the log tells, all is well as long as nobody ends the display.
    pub fn of(adapter: &wgpu::Adapter) -> Option<Self> {
        // SAFETY: nothing is destroyed through it.
        let hal = unsafe { adapter.as_hal::<wgpu::hal::api::Gles>() }?;
        let context = hal.adapter_context();
        // Addresses, because pointers do not go to threads.
        let (display, shared) =
            (context.raw_display()?.as_ptr().expose_provenance(), context.raw_context().expose_provenance());
        drop(hal);
        let (tell, told) = mpsc::channel();
        let (end, ended) = mpsc::channel::<()>();
        let run = move || {
            begin_own_thread();
            hold(display, shared, &tell, &ended);
        };
        let thread = thread::Builder::new().name("bhr-gl-guard".into()).spawn(run).ok()?;
        if let Ok(Err(error)) = told.recv() {
            log::info!("GL goes without a guard against the end of its display: {error}");
        }
        Some(Self { end: Some(end), thread: Some(thread) })
    }
}

impl Drop for ContextGuard {
    fn drop(&mut self) {
        drop(self.end.take());
        // The guard's thread ends under the driver lock: waiting for it with the lock held would never end.
        if let Some(thread) = self.thread.take().filter(|_| !driver_lock::is_held()) {
            let _ = thread.join();
        }
    }
}

/// The caller of `of` holds the driver lock until it is told; this thread ends later, under the lock.
fn hold(display: usize, shared: usize, tell: &mpsc::Sender<Result<(), String>>, ended: &mpsc::Receiver<()>) {
    driver_lock::guard();
    // SAFETY: the library that wgpu has loaded, by the same name, as sound as any of the system's.
    let egl = unsafe { DynamicInstance::<EGL1_4>::load_required() }.map_err(|error| error.to_string());
    let made = egl
        .as_ref()
        .map_err(Clone::clone)
        .and_then(|egl| make_current(egl, display, shared).map_err(|error| error.to_string()));
    let _ = tell.send(made);
    // An error: the sender is gone.
    let _ = ended.recv();
    let _driver = driver_lock::lock();
    if let Ok(egl) = egl {
        let _ = egl.release_thread();
    }
}

/// Makes a context of the same configuration, interface and version that shares `shared`'s objects, current on this
/// thread. It is destroyed at once, which takes place when it is no longer current: a handle that is kept until
/// then might by then be another context's.
fn make_current(egl: &DynamicInstance<EGL1_4>, display: usize, shared: usize) -> Result<(), egl::Error> {
    let pointer = |address: usize| std::ptr::with_exposed_provenance_mut(address);
    // SAFETY: handles of EGL's, which checks them.
    let (display, shared) =
        unsafe { (egl::Display::from_ptr(pointer(display)), egl::Context::from_ptr(pointer(shared))) };
    let of_shared = |attribute: egl::Int| egl.query_context(display, shared, attribute);
    egl.bind_api(of_shared(egl::CONTEXT_CLIENT_TYPE)? as egl::Enum)?;
    let same_config = [egl::CONFIG_ID, of_shared(egl::CONFIG_ID)?, egl::NONE];
    let config = egl.choose_first_config(display, &same_config)?.ok_or(egl::Error::BadConfig)?;
    let same_version = [egl::CONTEXT_CLIENT_VERSION, of_shared(egl::CONTEXT_CLIENT_VERSION)?, egl::NONE];
    let context = egl.create_context(display, config, Some(shared), &same_version)?;
    let made = egl.make_current(display, None, None, Some(context));
    let _ = egl.destroy_context(display, context);
    made
}
