// SPDX-License-Identifier: MIT OR Apache-2.0
//! The two tracers behind one face: the CPU's, the GPU's, and the GPU's with GL, which runs on a thread of its own.
//! Renderers, their jobs and their windows take turns with one. Knows no target of frames.

use crate::cpu::CpuTracer;
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{self, Adapter, AdapterIds, GlTracer, GpuTracer, Search};
use crate::scene::{LensTables, RayOutput, Region, Scene};
use crate::tracer::{AdapterInfo, Backend, FrameRequest, FrameStats, OutputSink, Progress, Tile, TileSink};
use parking_lot::Mutex;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Every adapter on this machine, best first; the CPU tracer, always there, is last.
pub fn adapters() -> Vec<AdapterInfo> {
    let mut list = gpu::adapters(Search::All, false).into_iter().map(|a| a.info).collect::<Vec<_>>();
    list.push(crate::cpu::adapter_info());
    list
}

/// By what other interfaces know each of [`adapters`], in that order.
pub fn adapter_ids() -> Vec<AdapterIds> {
    let mut list = gpu::adapters(Search::All, false).iter().map(Adapter::ids).collect::<Vec<_>>();
    list.push(AdapterIds::default());
    list
}

/// A tracer, which renders one frame at a time.
pub enum Tracer {
    Cpu(CpuTracer),
    Gpu(Box<GpuTracer>),
    Gl(Box<GlTracer>),
}

/// The device that a tracer runs on, as far as it can be asked while the tracer is at work.
pub enum RunsOn {
    Cpu,
    Gpu(Arc<Adapter>, Arc<gpu::Device>),
    Gl(gpu::Loss),
}

/// A tracer that a renderer, its jobs and its windows take turns with.
pub type SharedTracer = Arc<Mutex<Tracer>>;

/// The scene of a strip: tables would be made for each, which is too small to pay for them.
fn without_tables(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    if scene.quality.lens_tables == LensTables::Auto {
        scene.quality.lens_tables = LensTables::Never;
    }
    scene
}

impl Tracer {
    /// Renders a frame and waits for it. Errors: as `Renderer::render`.
    pub fn render(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        if scene.camera.is_omnistereo() {
            return self.render_strips(scene, request, sink, progress);
        }
        self.render_from_one_place(scene, request, sink, progress)
    }

    /// Renders a frame whose columns are seen from several places: strip by strip, each as a part of the frame. Errors:
    /// as `Renderer::render`.
    fn render_strips(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        let strips = scene.camera.strips(&request.region, request.width)?;
        let mut scene = without_tables(scene);
        // A strip may be all of a narrow frame, and would have the glare that others have not.
        scene.film = scene.film.of_parts();
        let mut sum = FrameStats::default();
        let count = strips.len();
        for (number, strip) in strips.into_iter().enumerate() {
            scene.camera = strip.camera;
            let region = Region { x: request.region.x + strip.begin, ..request.region };
            let part = FrameRequest { width: strip.width, region, ..*request };
            let mut goes_on = true;
            let mut place = |tile: Tile, pixels: &[u8], row_bytes: usize| {
                sink(Tile { x: tile.x + strip.begin, ..tile }, pixels, row_bytes)
            };
            let mut report = |done: f64| {
                goes_on = progress((number as f64 + done) / count as f64);
                goes_on
            };
            sum.add(&self.render_from_one_place(&scene, &part, &mut place, &mut report)?);
            if !goes_on && number + 1 < count {
                return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the frame"));
            }
        }
        Ok(sum)
    }

    fn render_from_one_place(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        match self {
            Self::Cpu(t) => t.render(scene, request, sink, progress),
            Self::Gpu(t) => t.render(scene, request, sink, progress),
            Self::Gl(t) => t.render(scene, request, sink, progress),
        }
    }

    /// Gives the numbers that `outputs` want of the frame's rays, packed, 4 bytes each; `scene` is
    /// `Scene::for_outputs` of them. The request's format does not matter. Errors: as `Renderer::render`.
    pub fn render_outputs(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        outputs: &[RayOutput],
        sink: &mut OutputSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        match self {
            Self::Cpu(t) => t.render_outputs(scene, request, outputs, sink, progress),
            Self::Gpu(t) => t.render_outputs(scene, request, outputs, sink, progress),
            Self::Gl(t) => t.render_outputs(scene, request, outputs, sink, progress),
        }
    }

    /// Errors: as `Device::open`.
    pub fn on_gpu(adapter: Adapter) -> Result<Self> {
        match adapter.info.backend {
            Backend::Gl => GlTracer::open(adapter).map(|t| Self::Gl(Box::new(t))),
            _ => {
                let name = adapter.info.name.clone();
                let opened = catch_unwind(AssertUnwindSafe(|| GpuTracer::new(adapter)));
                let panicked = |_| Err(Error::new(ErrorKind::NoAdapter, format!("{name}: opening it panicked")));
                opened.unwrap_or_else(panicked).map(|t| Self::Gpu(Box::new(t)))
            }
        }
    }

    /// Makes all that such frames need, and a window's frames like `window`, and keeps it. Errors: as
    /// `Renderer::render`.
    pub fn prepare(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        window: Option<&FrameRequest>,
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        // The first strip of a picture that is seen from several places needs all that the others do.
        if scene.camera.is_omnistereo()
            && let Some(strip) = scene.camera.strips(&request.region, request.width)?.first()
        {
            let scene = Scene { camera: strip.camera, ..without_tables(scene) };
            return self.prepare(&scene, &FrameRequest { width: strip.width, ..*request }, None, progress);
        }
        match self {
            Self::Cpu(t) => window.into_iter().chain([request]).try_for_each(|request| t.prepare(scene, request)),
            Self::Gpu(t) => t.prepare(scene, request, window, progress),
            Self::Gl(t) => t.prepare(scene, request, window, progress),
        }
    }

    pub fn info(&self) -> &AdapterInfo {
        match self {
            Self::Cpu(t) => t.adapter(),
            Self::Gpu(t) => &t.adapter().info,
            Self::Gl(t) => t.info(),
        }
    }

    pub fn runs_on(&self) -> RunsOn {
        match self {
            Self::Cpu(_) => RunsOn::Cpu,
            Self::Gpu(t) => RunsOn::Gpu(t.adapter().clone(), t.device()),
            Self::Gl(t) => RunsOn::Gl(t.loss().clone()),
        }
    }
}
