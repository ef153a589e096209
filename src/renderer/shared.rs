// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames of a renderer that stay on the GPU: its targets and semaphores, the host's things before the camera, which
//! may lie in a target, and renderers on a host's device. Knows nothing of C.

use super::made::Place;
use super::{Renderer, RendererOptions};
use crate::error::{Error, Result};
use crate::gpu::{
    self, AdapterIds, Device, GpuTarget, HostVulkan, ReleaseGuard, SemaphoreKind, SemaphoreOrigin, Sharing,
    TargetOrigin, TargetShape, shares_nothing,
};
use crate::image::{ImageMut, PixelFormat};
use crate::interop::{Semaphore, Target, Use, ask_signals, frame_sync};
use crate::job::{Job, JobRequest, JobTarget, SharedFrame, SharedPlace, Worker};
use crate::scene::{Distances, MOST_OUTPUTS, Occluder, OnDevice, Output, Region, Scene, SkyPicture, View};
use crate::tracer::FrameRequest;
use crate::tracers::{RunsOn, Tracer};
use std::borrow::Cow;
use std::sync::{Arc, Weak};

/// Where the distances of the host's things are.
pub(super) enum HostsThings {
    Copied(Occluder),
    /// And whether they are at their lensed places.
    Target(Arc<Target>, bool),
}

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

/// The place of an output of a frame that goes to targets.
pub enum SharedOutput<'a> {
    Target(&'a Arc<Target>),
    /// And whether a picture is transparent.
    Image(ImageMut<'static>, bool),
}

impl SharedOutput<'_> {
    fn size(&self) -> [u32; 2] {
        match self {
            Self::Target(target) => target.shape().size,
            Self::Image(image, _) => [image.width(), image.height()],
        }
    }

    fn format(&self) -> PixelFormat {
        match self {
            Self::Target(target) => target.shape().format,
            Self::Image(image, _) => image.format(),
        }
    }

    fn is_transparent(&self) -> bool {
        match self {
            Self::Target(target) => target.transparent,
            Self::Image(_, transparent) => *transparent,
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Target(_) => "target",
            Self::Image(..) => "image",
        }
    }
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
        let on_device = target.on(&device)?;
        self.check_is_not_read(target, &on_device)?;
        let light = Some(SharedPlace::Target(on_device));
        let sync = frame_sync(&device, sync.waits, sync.signals, submits == Submits::Now)?;
        let request = FrameRequest::checked(&self.scene, shape.format, shape.size, target.transparent, region)?;
        self.submit_shared(SharedFrame { request, light, outputs: Vec::new(), images: Vec::new(), sync }, submits)
    }

    /// The scene with the occluder. Errors: as `Scene::behind`.
    pub(super) fn behind(&self, region: &Region, size: [u32; 2]) -> Result<Cow<'_, Scene>> {
        let on_device;
        let occluder = match &self.occluder {
            None => None,
            Some(HostsThings::Copied(occluder)) => Some(occluder),
            // Views and frames without LIGHT do not ask for it.
            Some(HostsThings::Target(..)) if self.scene.view != View::Light => None,
            Some(HostsThings::Target(target, lensed)) => {
                on_device = self.occluder_of(target, *lensed)?;
                Some(&on_device)
            }
        };
        self.scene.behind(occluder, size, region)
    }

    /// Sets the host's things; `None`: there are none.
    pub fn set_occluder(&mut self, occluder: Option<Occluder>) {
        self.occluder = occluder.map(HostsThings::Copied);
    }

    /// Sets a target whose pixels are the distances of the host's things, read by each frame when it begins. Errors:
    /// UNSUPPORTED, on tracers without targets, for an image that cannot be copied and for sides that the device's
    /// textures do not have; INVALID_ARGUMENT for another format than R32F, or a target of another renderer;
    /// SURFACE_LOST; the occluder then stays as it was.
    pub fn set_occluder_target(&mut self, target: &Arc<Target>, lensed: bool) -> Result<()> {
        self.check_device()?;
        let format = target.shape().format;
        if format != PixelFormat::R32F {
            return Err(Error::argument(format!("target format is {format}; an occluder's is R32F")));
        }
        let device = self.gpu()?;
        target.on(device)?.check_is_read()?;
        gpu::check_occluder(device, target.shape())?;
        self.occluder = Some(HostsThings::Target(target.clone(), lensed));
        Ok(())
    }

    /// Sets a target whose pixels are the sky's map, or the faces of a cube as `Projection::Cube` has them of a camera
    /// that looks along +x of the sky axes, +z being up; read by each frame that shows it when the frame begins.
    /// Errors:
    /// INVALID_ARGUMENT for a target of another renderer, format or shape; UNSUPPORTED for one that cannot be copied,
    /// or is too large for the device; SURFACE_LOST; the map then stays as it was.
    pub fn set_sky_target(&mut self, target: &Arc<Target>, cube: bool) -> Result<()> {
        self.check_device()?;
        let device = self.gpu()?;
        let on_device = target.on(device)?;
        on_device.check_is_read()?;
        gpu::check_sky(device, target.shape(), cube)?;
        let TargetShape { size, format, .. } = *target.shape();
        // Weak, so that a target ends when its host ends it.
        let place = OnDevice(Arc::new(Arc::downgrade(&on_device)));
        self.scene.sky_picture = Some(SkyPicture { size, cube, format, place });
        self.scene.sky_map = None;
        Ok(())
    }

    /// The distances in a target. Errors: as `Target::on`.
    pub(super) fn occluder_of(&self, target: &Arc<Target>, lensed: bool) -> Result<Occluder> {
        let on_device = target.on(self.gpu()?).map_err(|error| {
            Error::new(error.kind, format!("the occluder's {}", error.message.trim_start_matches("the ")))
        })?;
        let [width, height] = target.shape().size;
        Ok(Occluder { width, height, distances: Distances::OnDevice(OnDevice(on_device)), origin: [0, 0], lensed })
    }

    /// Errors: INVALID_ARGUMENT for a target that frames read.
    fn check_is_not_read(&self, target: &Arc<Target>, on_device: &Arc<GpuTarget>) -> Result<()> {
        let sky = self.scene.sky_picture.as_ref().and_then(|sky| sky.place.0.downcast_ref::<Weak<GpuTarget>>());
        let read = match &self.occluder {
            Some(HostsThings::Target(occluder, _)) if Arc::ptr_eq(occluder, target) => "occluder",
            _ if sky.is_some_and(|sky| std::ptr::eq(sky.as_ptr(), Arc::as_ptr(on_device))) => "sky",
            _ => return Ok(()),
        };
        Err(Error::argument(format!("target is the {read}'s, which frames read; it cannot be written as well")))
    }

    /// Renders outputs of the scene as it is now into targets and images, as [`Self::render_target`] does a picture;
    /// the images are complete when the job is. Errors: as there, of each target; INVALID_ARGUMENT for places of
    /// several sizes, a target that is there twice, formats that do not go with the outputs, two pictures, and views
    /// that take
    /// frames of their own; UNSUPPORTED for targets that kernels do not reach.
    pub fn render_shared_outputs(
        &mut self,
        outputs: Vec<(Output, SharedOutput<'_>)>,
        region: Option<Region>,
        sync: &HostSync<'_>,
        submits: Submits,
    ) -> Result<Job> {
        self.check_device()?;
        let device = self.gpu()?.clone();
        let Some(size) = outputs.first().map(|(_, to)| to.size()) else {
            return Err(Error::argument(format!("output count is 0; it must lie in [1, {MOST_OUTPUTS}]")));
        };
        let (mut light, mut of_rays, mut request) = (None, Vec::with_capacity(outputs.len()), None);
        let (mut targets, mut images) = (Vec::<&Arc<Target>>::new(), Vec::new());
        for (index, (output, to)) in outputs.into_iter().enumerate() {
            let ([width, height], [w, h]) = (size, to.size());
            let name = to.name();
            if [w, h] != size {
                return Err(Error::argument(format!(
                    "outputs[{index}] {name} is {w} x {h}; outputs[0] has {width} x {height}, and all must be of one \
                     size"
                )));
            }
            let (given, transparent) = (to.format(), to.is_transparent());
            if let Some(wanted) = output.format().filter(|wanted| *wanted != given) {
                return Err(Error::argument(format!(
                    "outputs[{index}] {name} format is {given}; its kind takes {wanted}"
                )));
            }
            let place = match to {
                SharedOutput::Target(target) => {
                    let on = target
                        .on(&device)
                        .map_err(|error| Error::new(error.kind, format!("outputs[{index}] {}", error.message)))?;
                    if targets.iter().any(|other| Arc::ptr_eq(other, target)) {
                        return Err(Error::argument(format!("outputs[{index}] target is that of another output")));
                    }
                    self.check_is_not_read(target, &on)?;
                    targets.push(target);
                    SharedPlace::Target(on)
                }
                SharedOutput::Image(mut image, _) => {
                    self.help_to_write(&mut image);
                    images.push(image);
                    SharedPlace::Image(images.len() - 1)
                }
            };
            match output {
                Output::Light if light.is_some() => {
                    return Err(Error::argument(format!(
                        "outputs[{index}] is a second LIGHT; a frame with targets takes one"
                    )));
                }
                Output::Light => {
                    request = Some(FrameRequest::checked(&self.scene, given, size, transparent, region)?);
                    light = Some(place);
                }
                Output::View(view) => {
                    return Err(Error::argument(format!(
                        "outputs[{index}] is the view {}, which takes a frame of its own: set it as the view and \
                         render it as LIGHT",
                        view.name()
                    )));
                }
                Output::Ray(output) => of_rays.push((output, place)),
            }
        }
        let sync = frame_sync(&device, sync.waits, sync.signals, submits == Submits::Now)?;
        let request = match request {
            Some(request) => request,
            None => {
                let [width, height] = size;
                let region = region.unwrap_or(Region { full_width: width, full_height: height, x: 0, y: 0 });
                region.check_image(width, height)?;
                FrameRequest { width, height, region, format: PixelFormat::Rgba32F, transparent: false }
            }
        };
        self.submit_shared(SharedFrame { request, light, outputs: of_rays, images, sync }, submits)
    }

    fn submit_shared(&mut self, frame: SharedFrame, submits: Submits) -> Result<Job> {
        let request = frame.request;
        self.scene.check_one_eye("a frame for a target on the GPU")?;
        self.scene.hole.check_shown("a frame")?;
        self.scene.lens(&request.region)?;
        let asks = (submits == Submits::InBackground).then(|| frame.sync.clone());
        let scene = match &frame.light {
            Some(_) => self.behind(&request.region, [request.width, request.height])?.into_owned(),
            // The other outputs do not regard the host's things.
            None => self.scene.clone(),
        };
        let places = frame.images.iter().map(Place::of).collect::<Vec<_>>();
        let job_request = JobRequest::new(scene, JobTarget::Shared(frame), self.tracer.clone(), self.stats.clone());
        let worker = match &self.worker {
            Some(worker) => worker,
            None => self.worker.insert(Worker::new()?),
        };
        let job = match asks {
            None => worker.submit_now(job_request),
            Some(sync) => {
                worker.check_room()?;
                ask_signals(&sync)?;
                worker.enqueue(job_request).inspect_err(|_| sync.withdraw())
            }
        }?;
        self.made.remember(&self.scene, &request.region, places);
        Ok(job)
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
