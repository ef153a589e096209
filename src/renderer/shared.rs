// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames of a renderer that stay on the GPU: its targets and semaphores, and renderers on a host's device. Knows
//! nothing of C.

use super::{Renderer, RendererOptions};
use crate::error::{Error, Result};
use crate::gpu::{
    self, AdapterIds, Device, HostVulkan, ReleaseGuard, SemaphoreKind, SemaphoreOrigin, Sharing, TargetOrigin,
    TargetShape, shares_nothing,
};
use crate::interop::{Semaphore, Target, Use, ask_signals, frame_sync};
use crate::job::{Job, JobRequest, JobTarget, Worker};
use crate::scene::Region;
use crate::tracers::{RunsOn, Tracer};
use std::sync::Arc;

/// Semaphores that a frame waits for, and that it signals.
pub struct HostSync<'a> {
    pub waits: &'a [Use<'a>],
    pub signals: &'a [Use<'a>],
}

/// The thread on which a frame for a target is submitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submits {
    Now,
    InBackground,
}

impl Renderer {
    /// A renderer on a device of the host's. `release` is let go of when bhr uses that no more. Errors:
    /// INVALID_ARGUMENT for a device that is not as it must be; UNSUPPORTED for one that cannot serve; NO_ADAPTER.
    pub fn on_host(options: RendererOptions, host: HostVulkan, release: &Arc<ReleaseGuard>) -> Result<Self> {
        let tracer = Tracer::on_gpu(gpu::host_adapter(host, release)?)?;
        release.made();
        Ok(Self::on(tracer, options))
    }

    fn gpu(&self) -> Result<&Arc<Device>> {
        match &self.runs_on {
            RunsOn::Gpu(_, device) => Ok(device),
            RunsOn::Cpu | RunsOn::Gl(_) => shares_nothing(self.adapter.backend),
        }
    }

    /// The handles that the device shares, and by what others know its adapter. Errors: DEVICE_LOST.
    pub fn sharing(&self) -> Result<(Sharing, AdapterIds)> {
        self.check_device()?;
        Ok(match &self.runs_on {
            RunsOn::Gpu(adapter, device) => (device.sharing(), adapter.ids()),
            RunsOn::Cpu | RunsOn::Gl(_) => Default::default(),
        })
    }

    /// A target for frames of this renderer. Errors: UNSUPPORTED; as `Device::target`.
    pub fn create_target(
        &mut self,
        shape: TargetShape,
        transparent: bool,
        origin: TargetOrigin,
    ) -> Result<Arc<Target>> {
        self.check_device()?;
        let target = Arc::new(Target::new(self.gpu()?.clone(), shape, transparent, origin)?);
        self.targets.retain(|target| target.strong_count() > 0);
        self.targets.push(Arc::downgrade(&target));
        Ok(target)
    }

    /// Errors: INVALID_STATE for a renderer that is not on a device of the host's.
    pub fn check_is_hosts(&self) -> Result<()> {
        match self.gpu() {
            Ok(device) if device.is_hosts() => Ok(()),
            _ => Err(Error::state("the context is not on a device of the host's (bhr_context_create_vulkan)")),
        }
    }

    /// A semaphore for frames of this renderer. Errors: UNSUPPORTED; as `Device::semaphore`.
    pub fn create_semaphore(&mut self, kind: SemaphoreKind, origin: SemaphoreOrigin) -> Result<Arc<Semaphore>> {
        self.check_device()?;
        let semaphore = Arc::new(Semaphore::new(self.gpu()?.clone(), kind, origin)?);
        self.semaphores.retain(|semaphore| semaphore.strong_count() > 0);
        self.semaphores.push(Arc::downgrade(&semaphore));
        Ok(semaphore)
    }

    /// Renders the scene as it is now into `target`, after the waits of `sync`, and signals. The job ends when the GPU
    /// has made the frame.
    ///
    /// Errors: as `render` and `render_in_background`; INVALID_ARGUMENT for a target or a semaphore of another
    /// renderer, or a signal whose value does not grow; SURFACE_LOST.
    pub fn render_target(
        &mut self,
        target: &Arc<Target>,
        region: Option<Region>,
        sync: &HostSync<'_>,
        submits: Submits,
    ) -> Result<Job> {
        self.check_device()?;
        let device = self.gpu()?.clone();
        let shape = *target.shape();
        let shared = target.on(&device)?;
        let sync = frame_sync(&device, sync.waits, sync.signals, submits == Submits::Now)?;
        let request = self.request(shape.format, shape.size, target.transparent, region)?;
        self.scene.check_one_eye("a frame for a target on the GPU")?;
        self.scene.lens(&request.region)?;
        let asks = (submits == Submits::InBackground).then(|| sync.clone());
        let scene = self.behind(&request.region, shape.size)?.into_owned();
        let job_request =
            JobRequest::new(scene, JobTarget::Shared(request, shared, sync), self.tracer.clone(), self.stats.clone());
        let worker = match &self.worker {
            Some(worker) => worker,
            None => self.worker.insert(Worker::new()?),
        };
        match asks {
            None => worker.submit_now(job_request),
            Some(sync) => {
                worker.check_room()?;
                ask_signals(&sync)?;
                worker.enqueue(job_request).inspect_err(|_| sync.withdraw())
            }
        }
    }

    /// Ends targets and semaphores, for a reason.
    pub(super) fn end_shared(&mut self, reason: &'static str) {
        for target in self.targets.drain(..).filter_map(|target| target.upgrade()) {
            target.end(reason);
        }
        for semaphore in self.semaphores.drain(..).filter_map(|semaphore| semaphore.upgrade()) {
            semaphore.end(reason);
        }
    }
}
