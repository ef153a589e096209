// SPDX-License-Identifier: MIT OR Apache-2.0
//! A GPU tracer on GL: every call, and the end, on the one thread that its context may be current on
//! (device/gl_thread.rs). Knows no scenes.

use super::device::adapter::Adapter;
use super::device::gl_thread::{CONTEXT_GONE, DisplayAge, GlThread};
use super::device::wgpu_device::Loss;
use super::frame::tracer::GpuTracer;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::record::Record;
use crate::scene::{Hit, Ray, RayOutput, Scene};
use crate::tracer::{AdapterInfo, FrameRequest, FrameStats, OutputSink, Progress, TileSink};
use std::sync::Arc;

/// A [`GpuTracer`] on a GL adapter, whose calls run on the adapter's thread. Any thread may call and drop it, whatever
/// GL context is current there.
pub struct GlTracer {
    info: AdapterInfo,
    loss: Loss,
    /// `None` only while it is being dropped.
    tracer: Option<GpuTracer>,
    thread: Arc<GlThread>,
    age: DisplayAge,
}

impl GlTracer {
    /// Errors: as [`GpuTracer::new`]; NO_ADAPTER when the driver panics.
    pub fn open(adapter: Adapter) -> Result<Self> {
        let (info, age) = (adapter.info.clone(), adapter.gl_age().unwrap_or(DisplayAge::now()));
        let thread = adapter.gl_thread().ok_or_else(|| Error::internal("an adapter of GL without its thread"))?;
        let opened = thread.run(move || GpuTracer::new(adapter));
        let tracer = opened.map_err(|panic| Error::new(ErrorKind::NoAdapter, panic.message))??;
        Ok(Self { info, loss: tracer.device.loss(), tracer: Some(tracer), thread, age })
    }

    pub fn info(&self) -> &AdapterInfo {
        &self.info
    }

    /// Tells of the device's loss, also while the tracer is at work.
    pub fn loss(&self) -> &Loss {
        &self.loss
    }

    /// Renders a frame ([`GpuTracer::render`]); `progress` runs on this thread, `sink` on the other.
    pub fn render(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        self.call_with_progress(progress, |tracer, progress| tracer.render(scene, request, sink, progress))
    }

    /// Renders outputs ([`GpuTracer::render_outputs`]); `progress` runs on this thread, `sink` on the other.
    pub fn render_outputs(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        outputs: &[RayOutput],
        sink: &mut OutputSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        self.call_with_progress(progress, |tracer, progress| {
            tracer.render_outputs(scene, request, outputs, sink, progress)
        })
    }

    /// Makes what a frame needs ([`GpuTracer::prepare`]); `progress` runs on this thread.
    pub fn prepare(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        window: Option<&FrameRequest>,
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        self.call_with_progress(progress, |tracer, progress| tracer.prepare(scene, request, window, progress))
    }

    fn call<T: Send>(&mut self, work: impl FnOnce(&mut GpuTracer) -> Result<T> + Send) -> Result<T> {
        self.call_with_progress(&mut |_| true, |tracer, _| work(tracer))
    }

    /// Errors: those of `work`; DEVICE_LOST when the GL context is gone, or the thread is parked.
    fn call_with_progress<T: Send>(
        &mut self,
        progress: &mut Progress<'_>,
        work: impl FnOnce(&mut GpuTracer, &mut Progress<'_>) -> Result<T> + Send,
    ) -> Result<T> {
        if self.age.is_over() {
            self.loss.lose(CONTEXT_GONE);
        }
        self.loss.check()?;
        let tracer = self.tracer.as_mut().ok_or_else(|| Error::internal("a tracer that is being dropped"))?;
        let checked = |progress: &mut Progress<'_>| {
            tracer.check_gl_context()?;
            work(tracer, progress)
        };
        let panic = match self.thread.run_with_progress(checked, progress) {
            Ok(done) => return done,
            Err(panic) => panic,
        };
        // wgpu panics where it cannot make its context current.
        if let Ok(checked) = self.thread.run(|| tracer.check_gl_context()) {
            return checked.and(Err(panic));
        }
        self.loss.lose(&format!("{CONTEXT_GONE} ({})", panic.message));
        self.loss.check().and(Err(panic))
    }

    /// Traces rays that the host gives ([`GpuTracer::trace_rays`]).
    pub fn trace_rays(&mut self, scene: &Scene, rays: &[Ray], hits: &mut [Hit]) -> Result<()> {
        self.call(|tracer| tracer.trace_rays(scene, rays, hits))
    }

    /// The ray records of a frame's pixels ([`GpuTracer::ray_records`]).
    pub fn ray_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        self.call(|tracer| tracer.ray_records(scene, request))
    }

    /// Destroys the device, as a driver may at any time: for tests.
    pub fn lose_device(&mut self) -> Result<()> {
        self.call(|tracer| tracer.device.scoped("destroying the device", |raw| raw.destroy()))
    }
}

impl Drop for GlTracer {
    fn drop(&mut self) {
        let Some(tracer) = self.tracer.take() else { return };
        if self.age.is_over() {
            log::warn!("a GL device that cannot be closed stays behind: its context is gone");
            std::mem::forget(tracer);
            return;
        }
        let end = move || match tracer.device.answers() {
            true => drop(tracer),
            false => {
                log::warn!("a GL device that cannot be closed stays behind: its context is gone");
                std::mem::forget(tracer);
            }
        };
        if let Err(error) = self.thread.run(end) {
            log::warn!("a GL device that cannot be closed stays behind: {error}");
        }
    }
}

impl GpuTracer {
    /// On the thread for GL. Errors: DEVICE_LOST when the context cannot be made current any more, in which case
    /// nothing of wgpu's may be asked or dropped.
    fn check_gl_context(&self) -> Result<()> {
        if !self.device.answers() {
            self.device.loss().lose(CONTEXT_GONE);
        }
        self.device.loss().check()
    }
}
