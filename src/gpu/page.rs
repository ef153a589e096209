// SPDX-License-Identifier: MIT OR Apache-2.0
//! The GPU tracer in a page, where nothing may wait: adapter and device are awaited, and so is what was submitted.
//! Frames go straight into the textures of canvases.

use super::device::adapter::{Adapter, device_descriptor};
use super::device::texture::{SCREEN, Texture, TextureKind};
use super::device::wgpu_device::Device;
use super::frame::plan::setup::{FrameTarget, Setup};
use super::frame::resources::tables::{TablePart, Tables};
use super::frame::submission::delivery::Delivery;
use super::frame::tracer::GpuTracer;
use super::kernel::key::KernelKind;
use super::kernel::variant::{PixelTarget, StoredFormat};
use crate::emit::streaks;
use crate::error::{Error, ErrorKind, Result};
use crate::physics::blackbody::BlackbodyTable;
use crate::platform::Instant;
use crate::scene::Scene;
use crate::sky::StarField;
use crate::sky::index::StarIndex;
use crate::sky::milky_way::Drawing;
use crate::sky::shift::ShiftTable;
use crate::tracer::FrameRequest;
use js_sys::{Function, Promise};
use std::future::poll_fn;
use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Poll, Waker};
use std::time::Duration;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen_futures::JsFuture;
use wgpu::web_sys::HtmlCanvasElement;

fn none(why: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::NoAdapter, format!("WebGPU: {why}"))
}

impl GpuTracer {
    /// Opens the adapter that the browser gives. Errors: `NoAdapter`.
    pub async fn of_page() -> Result<Self> {
        let descriptor = wgpu::InstanceDescriptor {
            backends: wgpu::Backends::BROWSER_WEBGPU,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        };
        let instance = wgpu::Instance::new(descriptor);
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let raw = instance.request_adapter(&options).await.map_err(none)?;
        let adapter = Adapter::of_host(raw, instance, None).map_err(none)?;
        let descriptor = device_descriptor(adapter.raw()?, false);
        let opened = adapter.raw()?.request_device(&descriptor).await.map_err(none)?;
        let device = Device::of(&adapter, descriptor.required_limits, opened);
        in_a_task(|| Self::on(adapter, device)).await
    }

    /// Makes what such a frame needs, for the host or `shown` in an image, a part in each of the page's tasks:
    /// pipelines one after the other, so that the browser's GPU process is free between two; meanwhile the Milky Way,
    /// the stars and the disk's streaks. `go_on` is asked before each pipeline. Errors: those of `go_on`, of
    /// [`Self::begin`].
    pub async fn make_ready(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        shown: bool,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Ready> {
        let (pixels, delivery) = match shown {
            true => (PixelTarget::SCREEN, Delivery::Image),
            false => (self.planner().host_pixels(scene), Delivery::Host),
        };
        let setup = self.planner().set_up(scene, request, pixels)?;
        let missing = self.kernels.missing(&self.kernels_of(scene, Some(&setup)));
        let kernels = async {
            for key in missing {
                go_on()?;
                self.kernels.get(key)?;
                self.device.ran().await?;
            }
            Ok(())
        };
        // The browser makes pipelines beside the page's thread, which meanwhile draws.
        let (kernels, stars) = both(kernels, drawn(scene, &setup)).await;
        let stars = kernels.and(stars)?;
        let (tables, device) = (&mut self.tables, &self.device);
        let tables = in_a_task(|| Tables::with_stars(tables, device, scene)).await?;
        for part in TablePart::ALL {
            in_a_task(|| tables.update(part, device, scene, &setup)).await?;
        }
        Ok(Ready { steps: self.steps(scene, request, &setup, None, &delivery)?.count(), _stars: stars })
    }

    /// Whether the kernel that refines edges is missing for such a frame in an image. The browser takes longer to make
    /// it than all others, and a picture without it is nearly the same. Errors: as [`Self::begin`].
    pub async fn edges_are_late(&self, scene: &Scene, request: &FrameRequest) -> Result<bool> {
        let missing = in_a_task(|| {
            let setup = self.planner().set_up(scene, request, PixelTarget::SCREEN)?;
            Ok(self.kernels.missing(&self.kernels_of(scene, Some(&setup))))
        });
        Ok(missing.await?.iter().any(|key| matches!(key.kind, KernelKind::Refine(..))))
    }
}

/// The stars; and what else a frame shows is drawn.
async fn drawn(scene: &Scene, setup: &Setup) -> Result<Arc<StarIndex>> {
    let shows_milky_way = setup.variants.shade.milky_way;
    let mut way = in_a_task(|| if shows_milky_way { Drawing::begun() } else { Ok(None) }).await?;
    in_tasks(|| {
        way = way.take().map(|drawing| drawing.draw(ROWS)).transpose()?.flatten();
        Ok(way.is_none())
    })
    .await?;
    in_a_task(BlackbodyTable::shared).await;
    in_a_task(ShiftTable::shared).await;
    let stars = stars(scene).await?;
    let shows_streaks = setup.variants.shade.turbulent;
    let mut streaks = in_a_task(|| if shows_streaks { streaks::Drawing::begun() } else { Ok(None) }).await?;
    in_tasks(|| {
        streaks = streaks.take().map(|drawing| drawing.draw(STREAK_ROWS)).transpose()?.flatten();
        Ok(streaks.is_none())
    })
    .await?;
    Ok(stars)
}

/// [`Scene::stars`], made a few at a time.
async fn stars(scene: &Scene) -> Result<Arc<StarIndex>> {
    let field = scene.shown_field().unwrap_or(StarField::Catalogue);
    if scene.given_stars.is_some() || field.index_if_made().is_some() {
        return scene.stars();
    }
    let mut growing = in_a_task(|| field.growing()).await?;
    in_tasks(|| growing.grow(STARS)).await?;
    in_a_task(|| field.share(growing.done())).await
}

/// Does a piece of work part by part, until `part` returns true; after each `SLICE` the page has its thread. Errors:
/// those of `part`.
pub async fn in_tasks(mut part: impl FnMut() -> Result<bool>) -> Result<()> {
    loop {
        let begun = Instant::now();
        while begun.elapsed() < SLICE {
            if part()? {
                return Ok(());
            }
        }
        next_task().await;
    }
}

/// Does a part of a frame's work, and gives the page its thread if that took long. After short work it goes on, because
/// browsers put off each further timer by 4 ms.
async fn in_a_task<T>(work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let done = work();
    if begun.elapsed() > LONG {
        next_task().await;
    }
    done
}

/// Gives the page its thread until its next task.
async fn next_task() {
    #[wasm_bindgen]
    extern "C" {
        #[wasm_bindgen(js_name = setTimeout)]
        fn set_timeout(call: &Function);
    }
    let later = Promise::new(&mut |resolve, _| set_timeout(&resolve));
    // A timer does not fail.
    let _ = JsFuture::from(later).await;
}

/// Waits for both at once.
async fn both<A, B>(one: impl Future<Output = A>, other: impl Future<Output = B>) -> (A, B) {
    let (mut one, mut other) = (pin!(one), pin!(other));
    let (mut first, mut second) = (None, None);
    poll_fn(move |context| {
        if first.is_none()
            && let Poll::Ready(done) = one.as_mut().poll(context)
        {
            first = Some(done);
        }
        if second.is_none()
            && let Poll::Ready(done) = other.as_mut().poll(context)
        {
            second = Some(done);
        }
        match (first.take(), second.take()) {
            (Some(one), Some(other)) => Poll::Ready((one, other)),
            left => {
                (first, second) = left;
                Poll::Pending
            }
        }
    })
    .await
}

/// A frame's needs, as far as they are made.
pub struct Ready {
    /// The number of steps that the frame will take.
    pub steps: u64,
    /// Kept while somebody has it.
    _stars: Arc<StarIndex>,
}

/// Work of more than this ends a task of the page's.
const LONG: Duration = Duration::from_millis(4);

/// How long parts of one piece of work share a task.
const SLICE: Duration = Duration::from_millis(12);

/// Rows of the Milky Way's finest level that are one part, of a few milliseconds.
const ROWS: u32 = 8;
/// Rows of the disk's streaks that are one part.
const STREAK_ROWS: usize = 16;
/// Stars that are counted or listed in one part.
const STARS: usize = 5000;

impl Device {
    /// Until all that was submitted has run, or the device is gone, and the browser has told of all buffers whose
    /// mapping was asked for before. Errors: `DeviceLost`; what the browser found wrong meanwhile.
    pub async fn ran(&self) -> Result<()> {
        #[derive(Default)]
        struct State {
            is_done: bool,
            waker: Option<Waker>,
        }
        let state = Arc::new(Mutex::new(State::default()));
        let told = state.clone();
        self.queue()?.on_submitted_work_done(move || {
            let mut state = told.lock().unwrap_or_else(PoisonError::into_inner);
            state.is_done = true;
            if let Some(waker) = state.waker.take() {
                waker.wake();
            }
        });
        poll_fn(|context| {
            let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
            if state.is_done {
                return Poll::Ready(());
            }
            state.waker = Some(context.waker().clone());
            Poll::Pending
        })
        .await;
        self.check()
    }
}

/// A canvas of a page, whose textures frames are written into.
pub struct Canvas {
    surface: wgpu::Surface<'static>,
    element: HtmlCanvasElement,
    /// Width and height that it was configured for.
    size: Option<[u32; 2]>,
    /// The last frame of several steps is in it.
    kept: Option<Texture>,
}

/// A canvas' texture, until the page's task ends: then the browser shows it.
pub struct CanvasTexture {
    view: wgpu::TextureView,
    texture: wgpu::SurfaceTexture,
}

impl CanvasTexture {
    pub fn target(&self) -> FrameTarget<'_> {
        FrameTarget::Image(&self.view, StoredFormat::Rgba8)
    }

    /// The frame is in it: it is to be shown. Errors: `DeviceLost`.
    pub fn show(self, device: &Device) -> Result<()> {
        device.queue()?.present(self.texture);
        Ok(())
    }

    /// [`Self::show`] of what is in a texture of its size. Errors: as there.
    fn show_copy(self, device: &Device, of: &Texture) -> Result<()> {
        let mut encoder = device.encoder("canvas")?;
        let (from, to) = (of.clone_raw(), &self.texture.texture);
        encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), to.size());
        device.submit(encoder)?;
        self.show(device)
    }
}

impl Canvas {
    /// Errors: `SurfaceLost` for a canvas that has another context.
    pub fn new(tracer: &GpuTracer, element: HtmlCanvasElement) -> Result<Self> {
        let instance =
            tracer.adapter().instance().ok_or_else(|| Error::internal("a page's adapter has an instance"))?;
        let surface = instance
            .create_surface(wgpu::SurfaceTarget::Canvas(element.clone()))
            .map_err(|error| Error::new(ErrorKind::SurfaceLost, format!("the canvas: {error}")))?;
        Ok(Self { surface, element, size: None, kept: None })
    }

    /// Whether it is the canvas of `element`.
    pub fn is_of(&self, element: &HtmlCanvasElement) -> bool {
        self.element == *element
    }

    /// A texture for a frame of such a size that takes several of the page's tasks, longer than the canvas' own lives.
    /// Errors: as [`Device::scoped`].
    pub fn kept(&mut self, device: &Device, size: [u32; 2]) -> Result<&Texture> {
        let kept = match self.kept.take().filter(|kept| kept.size() == size) {
            Some(kept) => kept,
            None => {
                let TextureKind { format, dimension } = SCREEN;
                let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC;
                device.any_texture("canvas", format, dimension, size, [1, 1], usage)?
            }
        };
        Ok(self.kept.insert(kept))
    }

    /// Shows what is in the texture that [`Self::kept`] gave. Errors: as [`Self::texture`].
    pub fn show_kept(&mut self, device: &Device) -> Result<()> {
        let Some(kept) = self.kept.take() else { return Err(Error::internal("no frame is kept for the canvas")) };
        let shown = self.texture(device, kept.size()).and_then(|texture| texture.show_copy(device, &kept));
        self.kept = Some(kept);
        shown
    }

    /// The texture for the next frame, of such a size, which the canvas has from now on. Errors: `SurfaceLost`; as
    /// [`Device::scoped`].
    pub fn texture(&mut self, device: &Device, size: [u32; 2]) -> Result<CanvasTexture> {
        let [width, height] = size;
        if self.size != Some(size) || [self.element.width(), self.element.height()] != size {
            let config = wgpu::SurfaceConfiguration {
                usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_DST,
                format: wgpu::TextureFormat::Rgba8Unorm,
                width,
                height,
                present_mode: wgpu::PresentMode::Fifo,
                desired_maximum_frame_latency: 2,
                alpha_mode: wgpu::CompositeAlphaMode::Opaque,
                view_formats: Vec::new(),
                color_space: wgpu::SurfaceColorSpace::Auto,
            };
            device.scoped("the canvas", |raw| self.surface.configure(raw, &config))?;
            self.size = Some(size);
        }
        use wgpu::CurrentSurfaceTexture::{Suboptimal, Success};
        match self.surface.get_current_texture() {
            Success(texture) | Suboptimal(texture) => {
                let view = texture.texture.create_view(&Default::default());
                Ok(CanvasTexture { view, texture })
            }
            _ => Err(Error::new(ErrorKind::SurfaceLost, "the canvas gives no texture")),
        }
    }
}
