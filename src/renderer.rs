// SPDX-License-Identifier: MIT OR Apache-2.0
//! A renderer: one scene, one tracer, and the frames they make: into memory, in the background, into windows. The safe
//! Rust face of the crate; `capi` wraps it in a lock. Chooses the adapter; knows no pixel layout beyond handing tiles
//! to the target, and nothing of C.

mod first;
mod made;
mod presets;

use crate::accumulation::Accumulation;
use crate::attempt;
use crate::error::{Error, ErrorKind, PARTLY_WRITTEN, Result};
use crate::gpu::{self, Adapter, Search};
use crate::image::{Copiers, ImageMut, PixelFormat};
use crate::interop::{Semaphore, Target};
use crate::job::{Job, JobRequest, JobTarget, Worker};
use crate::scene::host_rays::{transfer_ray, transfer_setup};
use crate::scene::record::Record;
use crate::scene::{Hit, Preset, Ray, Region, Scene, Transfer, View};
use crate::surface::{ShowOutcome, ShowRequest, Surface, WindowTracer, frame_request};
use crate::tracers::{RunsOn, SharedTracer, Tracer};
use crate::window::{NativeWindow, PresentMode, Window};
use first::{Refusal, first_that_opens};
use made::{MadeFrames, Place};
use parking_lot::Mutex;
use presets::DepthCost;
use shared::HostsThings;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Weak};
use std::time::Instant;

mod outputs;
mod shared;

pub use shared::{HostSync, SharedOutput, Submits};

pub use crate::tracer::{AdapterInfo, Backend, FrameRequest, FrameStats, PASSES, Progress, StatsBoard, Tile, TileSink};
pub use crate::tracers::adapters;
pub use presets::{FrameGoal, MatterChoice};

/// How to make a [`Renderer`].
#[derive(Clone, Copy, Debug, Default)]
pub struct RendererOptions {
    /// `None`: the best GPU, else a software driver (but none of GL's), else the CPU tracer.
    pub backend: Option<Backend>,
    /// Index into [`adapters`]; `None`: the first that `backend` allows.
    pub adapter_index: Option<u32>,
    /// Threads of the CPU tracer; 0: one per core this process may use.
    pub cpu_threads: u32,
    /// Ask the driver's validation layers to report.
    pub validation: bool,
    /// Only adapters that can present to this window.
    pub compatible_window: Option<NativeWindow>,
}

/// One scene, one tracer.
pub struct Renderer {
    /// The scene that the next frame shows. A frame works on the scene as it is when the frame is asked for.
    pub scene: Scene,
    /// The host's things before the camera, in images of their size; LIGHT only.
    occluder: Option<HostsThings>,
    options: RendererOptions,
    adapter: AdapterInfo,
    runs_on: RunsOn,
    tracer: SharedTracer,
    stats: StatsBoard,
    copiers: Arc<Copiers>,
    /// How the pixels were made that hosts may have.
    made: MadeFrames,
    /// Frames that are being added up.
    accumulation: Option<Accumulation>,
    /// How long the presets' frames with depth take, as far as that was measured.
    depth_costs: [Vec<DepthCost>; Preset::COUNT],
    /// The threads for jobs, from the first job on.
    worker: Option<Worker>,
    /// Made for this renderer, and perhaps still there.
    surfaces: Vec<Weak<Surface>>,
    targets: Vec<Weak<Target>>,
    semaphores: Vec<Weak<Semaphore>>,
}

impl Drop for Renderer {
    fn drop(&mut self) {
        // Windows, and what hosts share, go before the device that presents to them, and after the frames in them.
        let ended = catch_unwind(AssertUnwindSafe(|| {
            self.worker = None;
            self.end_surfaces("its context was destroyed");
            self.end_shared("its context was destroyed");
        }));
        // A panic that went on from here would drop the rest on its way, where another panic ends the process.
        if let Err(panic) = ended {
            std::mem::forget(panic);
            log::error!("ending a surface panicked");
        }
    }
}

impl Renderer {
    /// Errors: `NoAdapter` for a backend or index that is not there (AUTO never fails so), `Unsupported` for one that
    /// the library was built without, whatever opening a device gives.
    pub fn new(options: RendererOptions) -> Result<Self> {
        let tracer = Self::open(&options)?;
        // The window need not be there any more when the device is opened again.
        Ok(Self::on(tracer, RendererOptions { compatible_window: None, ..options }))
    }

    fn on(tracer: Tracer, options: RendererOptions) -> Self {
        Self {
            scene: Scene::default(),
            occluder: None,
            options,
            adapter: tracer.info().clone(),
            runs_on: tracer.runs_on(),
            tracer: Arc::new(Mutex::new(tracer)),
            stats: StatsBoard::default(),
            copiers: Arc::default(),
            made: MadeFrames::default(),
            accumulation: None,
            depth_costs: Default::default(),
            worker: None,
            surfaces: Vec::new(),
            targets: Vec::new(),
            semaphores: Vec::new(),
        }
    }

    fn open(options: &RendererOptions) -> Result<Tracer> {
        gpu::check_built(options.backend)?;
        let window = options.compatible_window.map(Window::open).transpose()?;
        let cpu = || crate::cpu::CpuTracer::new(options.cpu_threads).map(Tracer::Cpu);
        if options.backend == Some(Backend::Cpu) && options.adapter_index.is_none() {
            return cpu();
        }
        let check = |adapter: &Adapter| window.as_ref().map_or(Ok(()), |window| adapter.check_presents(window));
        let search = match (options.adapter_index, options.backend) {
            (Some(_), _) => Search::All,
            (None, Some(backend)) => Search::Only(backend),
            (None, None) => Search::Auto,
        };
        let found = gpu::adapters(search, options.validation);
        let count = found.len() as u32 + 1;
        if let Some(index) = options.adapter_index {
            if index >= count {
                return Err(Error::new(
                    ErrorKind::NoAdapter,
                    format!("adapter_index is {index}; this machine has {count} adapters"),
                ));
            }
            let backend = found.get(index as usize).map_or(Backend::Cpu, |a| a.info.backend);
            if options.backend.is_some_and(|wanted| wanted != backend) {
                return Err(Error::new(
                    ErrorKind::NoAdapter,
                    format!("adapter {index} is of backend {backend}, not the one asked for"),
                ));
            }
            return match found.into_iter().nth(index as usize) {
                Some(adapter) => {
                    check(&adapter).map_err(|error| Error::new(ErrorKind::NoAdapter, error.message))?;
                    Tracer::on_gpu(adapter)
                }
                None => cpu(),
            };
        }
        let (mut reasons, mut tried) = (Vec::new(), Vec::new());
        let open = |adapter: Adapter| {
            if tried.contains(&adapter.info) {
                return Err(Refusal::Unfit);
            }
            tried.push(adapter.info.clone());
            let _attempt = options.backend.is_none().then(attempt::begin);
            let name = adapter.info.name.clone();
            let presents = check(&adapter).map_err(|error| (Refusal::Unfit, error));
            let opened = presents.and_then(|()| Tracer::on_gpu(adapter).map_err(|error| (Refusal::Closed, error)));
            opened.map_err(|(refusal, error)| {
                log::warn!("adapter {name} passed over: {error}");
                reasons.push(format!("{name}: {error}"));
                refusal
            })
        };
        let more = || match options.backend {
            None => gpu::adapters(Search::Fallback, options.validation),
            Some(_) => Vec::new(),
        };
        if let Some(tracer) = first_that_opens(found, |adapter| adapter.info.software, more, open) {
            return Ok(tracer);
        }
        match options.backend {
            None => {
                log::info!("no usable GPU adapter; tracing on the CPU");
                cpu()
            }
            Some(backend) => Err(Error::new(
                ErrorKind::NoAdapter,
                format!(
                    "no adapter of backend {backend} can be used: {}. BHR_BACKEND_AUTO falls back to the CPU tracer",
                    if reasons.is_empty() { gpu::absence(backend).into() } else { reasons.join("; ") }
                ),
            )),
        }
    }

    /// Opens the device anew after it was lost, on the adapter it was on if that is still there; the scene stays. Jobs
    /// that were requested before fail, surfaces are lost.
    ///
    /// Errors: UNSUPPORTED on a host's device, which bhr cannot make anew.
    pub fn recover(&mut self) -> Result<()> {
        if let RunsOn::Gpu(_, device) = &self.runs_on
            && device.is_hosts()
        {
            return Err(Error::unsupported(
                "the context is on a device of the host's; destroy it and make it on a new device",
            ));
        }
        gpu::forget_drivers();
        let tracer = self.reopen()?;
        self.end_surfaces("its context was recovered; make it again");
        self.end_shared("its context was recovered; make it again");
        self.adapter = tracer.info().clone();
        self.runs_on = tracer.runs_on();
        self.tracer = Arc::new(Mutex::new(tracer));
        self.depth_costs = Default::default();
        Ok(())
    }

    fn reopen(&self) -> Result<Tracer> {
        if let Tracer::Cpu(_) = &*self.tracer.lock() {
            return Self::open(&self.options);
        }
        let same = gpu::adapters(Search::Only(self.adapter.backend), self.options.validation)
            .into_iter()
            .find(|found| found.info == self.adapter)
            .map(Tracer::on_gpu);
        match same {
            Some(Ok(tracer)) => Ok(tracer),
            Some(Err(error)) => {
                log::warn!("adapter {} could not be opened again: {error}", self.adapter.name);
                Self::open(&self.options)
            }
            None => Self::open(&self.options),
        }
    }

    /// Errors: DEVICE_LOST once the device is gone, until [`Self::recover`].
    fn check_device(&self) -> Result<()> {
        match &self.runs_on {
            RunsOn::Cpu => Ok(()),
            RunsOn::Gpu(_, device) => device.check(),
            RunsOn::Gl(loss) => loss.check(),
        }
    }

    /// Destroys the GPU device, as a driver may at any time: for tests.
    #[doc(hidden)]
    pub fn lose_device(&self) -> Result<()> {
        let destroyed = match (&self.runs_on, &self.tracer) {
            (RunsOn::Cpu, _) => Ok(()),
            (RunsOn::Gpu(_, device), _) => device.scoped("destroying the device", |raw| raw.destroy()),
            (RunsOn::Gl(_), tracer) => match &mut *tracer.lock() {
                Tracer::Gl(tracer) => tracer.lose_device(),
                _ => Ok(()),
            },
        };
        // By now another thread may have been told of the loss.
        destroyed.or_else(|error| if error.kind == ErrorKind::DeviceLost { Ok(()) } else { Err(error) })
    }

    /// Has a call of the GPU device fail, `passing` such calls from now: for tests.
    #[doc(hidden)]
    pub fn fail_device(&self, what: &'static str, passing: u32) {
        if let RunsOn::Gpu(_, device) = &self.runs_on {
            device.faults.arm(what, passing);
        }
    }

    /// How often frames found pipelines missing, once those that are made in the background are there; for tests.
    /// `None` on the CPU and on GL, where none are.
    #[doc(hidden)]
    pub fn settled_waits(&self) -> Option<gpu::KernelWaits> {
        match &*self.tracer.lock() {
            Tracer::Gpu(t) => Some(t.settled_waits()),
            Tracer::Cpu(_) | Tracer::Gl(_) => None,
        }
    }

    fn end_surfaces(&mut self, reason: &'static str) {
        for surface in self.surfaces.drain(..).filter_map(|surface| surface.upgrade()) {
            surface.end(reason);
        }
    }

    /// A surface for a window of the host's, to show this renderer's frames in. Errors: as `Surface::new`; DEVICE_LOST.
    pub fn create_surface(&mut self, window: NativeWindow, size: [u32; 2], mode: PresentMode) -> Result<Arc<Surface>> {
        self.check_device()?;
        let tracing = match &self.runs_on {
            RunsOn::Gpu(adapter, device) => {
                Some(WindowTracer { adapter, device: device.clone(), tracer: self.tracer.clone() })
            }
            RunsOn::Cpu | RunsOn::Gl(_) => None,
        };
        let surface = Arc::new(Surface::new(window, size, mode, tracing, self.options.validation)?);
        self.surfaces.retain(|surface| surface.strong_count() > 0);
        self.surfaces.push(Arc::downgrade(&surface));
        Ok(surface)
    }

    /// Renders the scene into the surface's window. Errors: as `render`; INVALID_ARGUMENT for another renderer's
    /// surface; SURFACE_LOST; DEVICE_LOST.
    pub fn render_surface(&mut self, surface: &Arc<Surface>) -> Result<ShowOutcome> {
        self.check_device()?;
        self.scene.check_one_eye("a window")?;
        self.scene.hole.check_shown("a frame")?;
        self.scene.observer()?;
        if !surface.has_ended() && !self.surfaces.iter().any(|ours| std::ptr::eq(ours.as_ptr(), Arc::as_ptr(surface))) {
            return Err(Error::argument("surface was made by another context"));
        }
        surface.show(&ShowRequest { scene: &self.scene, tracer: &self.tracer, stats: &self.stats })
    }

    pub fn adapter(&self) -> &AdapterInfo {
        &self.adapter
    }

    /// Numbers about the last finished frame.
    pub fn stats(&self) -> FrameStats {
        self.stats.last()
    }

    /// A GPU's frames come out of its staging memory faster than one thread writes them; the CPU tracer's are what its
    /// threads wait for.
    fn help_to_write(&self, target: &mut ImageMut<'_>) {
        if !matches!(self.runs_on, RunsOn::Cpu) {
            target.write_with(self.copiers.clone());
        }
    }

    /// The request to a tracer for an image of the scene. Errors: as [`FrameRequest::checked`].
    fn request(&self, target: &ImageMut<'_>, transparent: bool, region: Option<Region>) -> Result<FrameRequest> {
        let size = [target.width(), target.height()];
        FrameRequest::checked(&self.scene, target.format(), size, transparent, region)
    }

    /// Renders the scene into `target`, tile by tile; `region` `None`: the target is the whole frame.
    ///
    /// Errors: INVALID_ARGUMENT for a region that the image overruns or a format that does not go with the view;
    /// UNSUPPORTED for a spin beyond those of frames; INVALID_STATE where the camera's motion cannot be, for a cube of
    /// another shape, or for bloom or a beam with a region; CANCELLED when `progress` returns false (tiles not yet
    /// begun are untouched); whatever the device reports.
    pub fn render(
        &mut self,
        target: &mut ImageMut<'_>,
        transparent: bool,
        region: Option<Region>,
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        let start = Instant::now();
        let request = self.request(target, transparent, region)?;
        self.help_to_write(target);
        let mut sink = |tile: Tile, pixels: &[u8], bytes_per_row: usize| {
            target.write_tile(tile.x, tile.y, tile.width, tile.height, pixels, bytes_per_row)
        };
        let scene = self.behind(&request.region, [request.width, request.height])?;
        let rendered = self.tracer.lock().render(&scene, &request, &mut sink, progress);
        // An image that is written in part is of this frame as well.
        self.made.remember(&self.scene, &request.region, [Place::of(target)]);
        let stats = rendered.map_err(|mut error| {
            if target.is_touched() {
                error.message += PARTLY_WRITTEN;
            }
            error
        })?;
        self.stats.publish(stats, start.elapsed());
        Ok(())
    }

    /// Begins to add frames of `size` up, in place of those that were added before: the host changes the scene between
    /// them, for motion blur and depth of field. Errors: INVALID_ARGUMENT for a size beyond images', OUT_OF_MEMORY.
    pub fn begin_accumulation(&mut self, size: [u32; 2], transparent: bool) -> Result<()> {
        self.accumulation = Some(Accumulation::new(size, transparent, self.options.cpu_threads)?);
        Ok(())
    }

    /// Forgets the frames that were added.
    pub fn drop_accumulation(&mut self) {
        self.accumulation = None;
    }

    /// Renders the scene as it is, a whole frame, and adds its light times `weight`. After an error nothing is added.
    ///
    /// Errors: INVALID_STATE where nothing was begun, or too much was added; INVALID_ARGUMENT for a weight out of
    /// range; as [`Self::render`].
    pub fn accumulate(&mut self, weight: f64, progress: &mut Progress<'_>) -> Result<()> {
        let start = Instant::now();
        let begun = self.accumulation.as_ref().ok_or_else(not_accumulating)?;
        begun.check(weight)?;
        if self.scene.view != View::Light {
            let view = self.scene.view.name();
            return Err(Error::argument(format!("view is {view}; light is what is accumulated: set view LIGHT")));
        }
        let request = FrameRequest::checked(&self.scene, PixelFormat::Rgba32F, begun.size, begun.transparent, None)?;
        // The frames are put back whatever happens.
        let mut begun = self.accumulation.take().ok_or_else(not_accumulating)?;
        let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| begun.take(tile, pixels, row_bytes);
        let rendered = self
            .behind(&request.region, [request.width, request.height])
            .and_then(|scene| self.tracer.lock().render(&scene, &request, &mut sink, progress));
        if rendered.is_ok() {
            begun.add(weight);
        }
        self.accumulation = Some(begun);
        self.stats.publish(rendered?, start.elapsed());
        Ok(())
    }

    /// Develops the mean of the frames that were added, by the film as it is, into `target`, and forgets them. After an
    /// error they are kept.
    ///
    /// Errors: INVALID_STATE where no frame was added; as `Accumulation::develop`.
    pub fn end_accumulation(&mut self, target: &mut ImageMut<'_>, transparent: bool) -> Result<()> {
        let start = Instant::now();
        let lit = Scene { view: View::Light, ..self.scene.clone() };
        let begun = self.accumulation.as_mut().ok_or_else(not_accumulating)?;
        let auto_ev = begun.develop((&lit.film, lit.shown_lut().map(Arc::as_ref)), target, transparent)?;
        self.accumulation = None;
        // Files of the image say how the scene is now.
        let [full_width, full_height] = [target.width(), target.height()];
        self.made.remember(&self.scene, &Region { full_width, full_height, x: 0, y: 0 }, [Place::of(target)]);
        self.stats.publish(FrameStats { auto_ev, ..FrameStats::default() }, start.elapsed());
        Ok(())
    }

    /// Makes all that frames of the present scene need as images of this format and size, and in windows of this size:
    /// the next ones then wait for nothing but themselves.
    ///
    /// Errors: as [`Self::render`].
    pub fn prepare(
        &mut self,
        format: PixelFormat,
        size: [u32; 2],
        transparent: bool,
        region: Option<Region>,
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        let request = FrameRequest::checked(&self.scene, format, size, transparent, region)?;
        let shown = format == PixelFormat::Rgba8Srgb && !transparent && !self.scene.camera.is_omnistereo();
        let window = shown.then(|| frame_request(&self.scene, size, format));
        let scene = self.behind(&request.region, size)?;
        self.tracer.lock().prepare(&scene, &request, window.as_ref(), progress)
    }

    /// Prepares frames in windows of `size` only. Errors: as [`Self::render`].
    pub fn prepare_window(&mut self, size: [u32; 2], progress: &mut Progress<'_>) -> Result<()> {
        self.scene.hole.check_shown("a frame")?;
        let window = frame_request(&self.scene, size, PixelFormat::Rgba8Srgb);
        self.tracer.lock().prepare(&self.scene, &window, Some(&window), progress)
    }

    /// How many pipelines are not there that a frame in a window of `size` would run; for tests. `None` as in
    /// [`Self::settled_waits`]. Errors: as [`Self::render`].
    #[doc(hidden)]
    pub fn missing_in_window(&self, size: [u32; 2]) -> Result<Option<usize>> {
        match &*self.tracer.lock() {
            Tracer::Gpu(t) => {
                t.missing_on_screen(&self.scene, &frame_request(&self.scene, size, PixelFormat::Rgba8Srgb)).map(Some)
            }
            Tracer::Cpu(_) | Tracer::Gl(_) => Ok(None),
        }
    }

    /// Orders a frame of the scene as it is now, to be rendered in the background, after the jobs before it. `target`
    /// is written until the job has its outcome.
    ///
    /// Errors: INVALID_ARGUMENT and INVALID_STATE as `render`; INVALID_STATE when too many jobs are unfinished;
    /// OUT_OF_MEMORY without a thread; DEVICE_LOST.
    pub fn render_in_background(
        &mut self,
        mut target: ImageMut<'static>,
        transparent: bool,
        region: Option<Region>,
    ) -> Result<Job> {
        let request = self.request(&target, transparent, region)?;
        self.scene.lens(&request.region)?;
        self.check_device()?;
        self.help_to_write(&mut target);
        let scene = self.behind(&request.region, [request.width, request.height])?.into_owned();
        let (place, region) = (Place::of(&target), request.region);
        let job = self.enqueue(scene, JobTarget::Memory(request, target))?;
        self.made.remember(&self.scene, &region, [place]);
        Ok(job)
    }

    fn enqueue(&mut self, scene: Scene, target: JobTarget) -> Result<Job> {
        let worker = match &self.worker {
            Some(worker) => worker,
            None => self.worker.insert(Worker::new()?),
        };
        worker.enqueue(JobRequest::new(scene, target, self.tracer.clone(), self.stats.clone()))
    }

    /// The ray records of a width x height image of the scene, row by row, one ray through each pixel's centre: for
    /// tests. On the GPU the first four crossings of each.
    #[doc(hidden)]
    pub fn ray_records(&mut self, width: u32, height: u32) -> Result<Vec<Record>> {
        let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
        region.check()?;
        self.scene.hole.check_shown("a ray record")?;
        let request = FrameRequest { width, height, region, format: PixelFormat::Rgba32F, transparent: false };
        match &mut *self.tracer.lock() {
            Tracer::Cpu(t) => t.ray_records(&self.scene, &request),
            Tracer::Gpu(t) => t.ray_records(&self.scene, &request),
            Tracer::Gl(t) => t.ray_records(&self.scene, &request),
        }
    }

    /// Traces `rays`; `hits` is as long. A ray that is not valid becomes `Fate::Invalid`.
    pub fn trace_rays(&mut self, rays: &[Ray], hits: &mut [Hit]) -> Result<()> {
        match &mut *self.tracer.lock() {
            Tracer::Cpu(t) => t.trace_rays(&self.scene, rays, hits),
            Tracer::Gpu(t) => t.trace_rays(&self.scene, rays, hits),
            Tracer::Gl(t) => t.trace_rays(&self.scene, rays, hits),
        }
    }

    /// Errors: UNSUPPORTED for a spin beyond those that matter with depth is known about.
    pub fn check_transfer(&self) -> Result<()> {
        self.scene.hole.check_shown("matter along rays")
    }

    /// The matter with depth along `rays`, thin disk and sky left out; `found` is as long. Always in f64 on the CPU: on
    /// the CPU tracer's threads, else on this one. A ray that is not valid becomes `Fate::Invalid`. Errors:
    /// UNSUPPORTED for a spin beyond those of frames; OUT_OF_MEMORY.
    pub fn transfer_rays(&mut self, rays: &[Ray], found: &mut [Transfer]) -> Result<()> {
        self.check_transfer()?;
        if let Tracer::Cpu(tracer) = &mut *self.tracer.lock() {
            return tracer.transfer_rays(&self.scene, rays, found);
        }
        let setup = transfer_setup(&self.scene, rays)?;
        for (ray, found) in rays.iter().zip(found) {
            *found = transfer_ray(&self.scene, &setup, ray);
        }
        Ok(())
    }

    /// The curve a ray follows: x, y, z, t (scene axes and lengths; t <= 0, backward) per point, at most `capacity`
    /// (>= 2) points, the last one its end. Always traced in f64 on the CPU. Errors: INVALID_ARGUMENT for a ray that
    /// is not valid.
    pub fn trace_path(&self, ray: &Ray, capacity: usize) -> Result<Vec<[f64; 4]>> {
        crate::scene::host_rays::trace_path(&self.scene, ray, capacity)
    }
}

fn not_accumulating() -> Error {
    Error::state("no frames are being accumulated; bhr_begin_accumulation begins")
}
