// SPDX-License-Identifier: MIT OR Apache-2.0
//! The class of tracers: frames into canvases and into memory. A script awaits a call before the next one; web/index.ts
//! sees to that.

use super::message::thrown;
use super::numbers;
use super::text::scene_of;
use crate::capi::scene_file::Moment;
use crate::cpu::CpuTracer;
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{Canvas, CanvasTexture, Device, FrameTarget, GpuTracer, in_tasks};
use crate::image::{ImageRef, Layout, Lut, PixelFormat};
use crate::platform::Instant;
use crate::scene::Scene;
use crate::sky::{GrowingMap, MAX_MAP_SIZE, StoredMap};
use crate::tracer::{FrameRequest, FrameStats, StatsBoard, Tile, TileSink};
use js_sys::Object;
use std::collections::VecDeque;
use std::sync::Arc;
use wasm_bindgen::prelude::wasm_bindgen;
use web_sys::{AbortSignal, HtmlCanvasElement};

/// Steps under way at once: one is read while the next runs.
const AHEAD: usize = 2;

/// Texels of a map that are made at a time, in a few milliseconds.
const TEXELS: u32 = 1 << 14;

enum Traces {
    Gpu(Box<GpuTracer>),
    Cpu(Box<CpuTracer>),
}

/// A tracer of a page.
#[wasm_bindgen]
pub struct Tracer {
    /// Dropped before the device that it belongs to, by the order of fields.
    canvas: Option<Canvas>,
    traces: Traces,
    /// The picture of the sky flag MAP, and the film's table of colours.
    map: Option<Arc<StoredMap>>,
    lut: Option<Arc<Lut>>,
    stats: StatsBoard,
}

#[wasm_bindgen]
impl Tracer {
    /// On the browser's WebGPU. Throws where there is none.
    #[wasm_bindgen(js_name = onWebGpu)]
    pub async fn on_web_gpu() -> Result<Tracer, js_sys::Error> {
        let tracer = GpuTracer::of_page().await.map_err(thrown)?;
        Ok(Self::of(Traces::Gpu(Box::new(tracer))))
    }

    /// The CPU tracer, in double precision. Its frames take seconds, in which the thread does nothing else: it is for
    /// workers.
    #[wasm_bindgen(js_name = onCpu)]
    pub fn on_cpu() -> Result<Tracer, js_sys::Error> {
        let tracer = CpuTracer::new(1).map_err(thrown)?;
        Ok(Self::of(Traces::Cpu(Box::new(tracer))))
    }

    /// The adapter.
    pub fn adapter(&self) -> Object {
        numbers::of_adapter(match &self.traces {
            Traces::Gpu(tracer) => &tracer.adapter().info,
            Traces::Cpu(tracer) => tracer.adapter(),
        })
    }

    /// Numbers about the last finished frame.
    pub fn stats(&self) -> Object {
        numbers::of_stats(&self.stats.last())
    }

    /// Throws once the device is lost, and what the browser found wrong since the last call.
    pub fn check(&self) -> Result<(), js_sys::Error> {
        match &self.traces {
            Traces::Gpu(tracer) => tracer.device().check().map_err(thrown),
            Traces::Cpu(_) => Ok(()),
        }
    }

    /// Resolves with the error when the device is lost.
    pub fn lost(&self) -> js_sys::Promise {
        match &self.traces {
            Traces::Gpu(tracer) => {
                let loss = tracer.device().loss();
                wasm_bindgen_futures::future_to_promise(async move { Ok(thrown(loss.told().await).into()) })
            }
            // The processor is never lost.
            Traces::Cpu(_) => js_sys::Promise::new(&mut |_, _| {}),
        }
    }

    /// The device, apart from the tracer, which is lent to nobody while a frame is under way.
    pub fn device(&self) -> DeviceHandle {
        DeviceHandle(match &self.traces {
            Traces::Gpu(tracer) => Some(tracer.device()),
            Traces::Cpu(_) => None,
        })
    }

    /// Another tracer has painted in the canvas.
    #[wasm_bindgen(js_name = forgetCanvas)]
    pub fn forget_canvas(&mut self) {
        self.canvas = None;
    }

    /// Gives the sky flag MAP its picture, packed rows of RGBA in 8 bits, or takes it away (bhr_set_sky_map), a part in
    /// each of the page's tasks. Throws the messages of that function.
    #[wasm_bindgen(js_name = setSkyMap)]
    pub async fn set_sky_map(&mut self, pixels: Option<Vec<u8>>, width: u32, height: u32) -> Result<(), js_sys::Error> {
        let map = match pixels {
            Some(pixels) => Some(sky_map(&pixels, [width, height]).await.map_err(thrown)?),
            None => None,
        };
        self.map = map.map(Arc::new);
        Ok(())
    }

    /// Gives the film the LUT in the text of a .cube file, or takes it away (bhr_set_film_lut_file). Throws the
    /// messages of that function.
    #[wasm_bindgen(js_name = setFilmLut)]
    pub fn set_film_lut(&mut self, cube: Option<String>) -> Result<(), js_sys::Error> {
        self.lut = cube.map(|text| Lut::of_cube(&text)).transpose().map_err(thrown)?.map(Arc::new);
        Ok(())
    }

    /// The frame of a scene's text, as packed rows of RGBA: bytes, or with `floats` numbers of 32 bits of the light
    /// before the film. A frame on the GPU ends early when `signal` is aborted. Throws the C API's messages.
    pub async fn image(
        &mut self,
        scene: String,
        seconds: f64,
        width: u32,
        height: u32,
        floats: bool,
        signal: Option<AbortSignal>,
    ) -> Result<Vec<u8>, js_sys::Error> {
        let format = if floats { PixelFormat::Rgba32F } else { PixelFormat::Rgba8Srgb };
        let made = self.try_image(&scene, seconds, [width, height], format, &Aborts(signal)).await;
        made.map_err(thrown)
    }

    /// The frame of a scene's text in a canvas, which has no other context, and the frame's size from then on. Ends
    /// early as `image`. Throws the C API's messages.
    pub async fn paint(
        &mut self,
        scene: String,
        seconds: f64,
        canvas: HtmlCanvasElement,
        width: u32,
        height: u32,
        signal: Option<AbortSignal>,
    ) -> Result<(), js_sys::Error> {
        self.try_paint(&scene, seconds, canvas, [width, height], &Aborts(signal)).await.map_err(thrown)
    }
}

/// A tracer's device.
#[wasm_bindgen]
pub struct DeviceHandle(Option<Arc<Device>>);

#[wasm_bindgen]
impl DeviceHandle {
    /// Destroys the device, as a driver may at any time: for tests.
    pub fn lose(&self) -> Result<(), js_sys::Error> {
        match &self.0 {
            Some(device) => device.scoped("destroying the device", |raw| raw.destroy()).map_err(thrown),
            None => Ok(()),
        }
    }
}

/// A page's wish that a frame end.
struct Aborts(Option<AbortSignal>);

impl Aborts {
    /// Errors: CANCELLED.
    fn check(&self) -> Result<()> {
        match &self.0 {
            Some(signal) if signal.aborted() => {
                Err(Error::new(ErrorKind::Cancelled, "the page's AbortSignal cancelled the frame"))
            }
            _ => Ok(()),
        }
    }
}

/// The map of a picture.
async fn sky_map(pixels: &[u8], [width, height]: [u32; 2]) -> Result<StoredMap> {
    let image = ImageRef::new(Layout::packed(PixelFormat::Rgba8Srgb, width, height), pixels)?;
    let mut growing = GrowingMap::new([width, height])?;
    // A level is at least as wide as it is high.
    let columns = width.max(height).min(MAX_MAP_SIZE[0]);
    in_tasks(|| growing.grow_from(&image, (TEXELS / columns.max(1)).max(1))).await?;
    Ok(growing.done().into())
}

impl Tracer {
    fn of(traces: Traces) -> Self {
        Self { canvas: None, traces, map: None, lut: None, stats: StatsBoard::default() }
    }

    /// The scene and the request of a frame. Errors: the C API's.
    fn asked(&self, text: &str, seconds: f64, size: [u32; 2], format: PixelFormat) -> Result<(Scene, FrameRequest)> {
        let Moment { mut scene, region } = scene_of(text, seconds)?;
        (scene.sky_map, scene.film_lut) = (self.map.clone(), self.lut.clone());
        let request = FrameRequest::checked(&scene, format, size, false, region)?;
        Ok((scene, request))
    }

    async fn try_image(
        &mut self,
        text: &str,
        seconds: f64,
        size: [u32; 2],
        format: PixelFormat,
        aborts: &Aborts,
    ) -> Result<Vec<u8>> {
        let start = Instant::now();
        let (scene, request) = self.asked(text, seconds, size, format)?;
        let row_bytes = size[0] as usize * format.bytes_per_pixel();
        let mut bytes = Vec::new();
        crate::image::probe(row_bytes as u64 * u64::from(size[1]))?;
        bytes.resize(row_bytes * size[1] as usize, 0);
        let mut sink = |tile: Tile, pixels: &[u8], pitch: usize| {
            let begin = tile.x as usize * format.bytes_per_pixel();
            let length = tile.width as usize * format.bytes_per_pixel();
            let rows = bytes.chunks_exact_mut(row_bytes).skip(tile.y as usize).take(tile.height as usize);
            for (row, made) in rows.zip(pixels.chunks(pitch)) {
                row[begin..begin + length].copy_from_slice(&made[..length]);
            }
            Ok(())
        };
        let stats = match &mut self.traces {
            Traces::Cpu(tracer) => tracer.render(&scene, &request, &mut sink, &mut |_| true)?,
            Traces::Gpu(tracer) => {
                let _ready = tracer.make_ready(&scene, &request, false, &|| aborts.check()).await?;
                let traced = step_by_step(tracer, &scene, &request, FrameTarget::Host, &mut sink, aborts).await;
                // Nobody knows what the tables of lenses hold after a frame that failed.
                traced.inspect_err(|_| tracer.forget())?
            }
        };
        self.stats.publish(stats, start.elapsed());
        Ok(bytes)
    }

    async fn try_paint(
        &mut self,
        text: &str,
        seconds: f64,
        element: HtmlCanvasElement,
        size: [u32; 2],
        aborts: &Aborts,
    ) -> Result<()> {
        let (scene, request) = self.asked(text, seconds, size, PixelFormat::Rgba8Srgb)?;
        let Traces::Gpu(tracer) = &self.traces else {
            return Err(Error::unsupported("the CPU tracer paints no canvas: put its image there"));
        };
        if tracer.edges_are_late(&scene, &request).await? {
            let mut first = scene.clone();
            first.quality.edges_later = true;
            self.paint_scene(&first, &request, &element, aborts).await?;
        }
        self.paint_scene(&scene, &request, &element, aborts).await
    }

    async fn paint_scene(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        element: &HtmlCanvasElement,
        aborts: &Aborts,
    ) -> Result<()> {
        let start = Instant::now();
        let Traces::Gpu(tracer) = &mut self.traces else { return Ok(()) };
        aborts.check()?;
        let (device, size) = (tracer.device(), [request.width, request.height]);
        let most = device.limits().max_texture_dimension_2d;
        if let Some((name, side)) = ["width", "height"].into_iter().zip(size).find(|(_, side)| *side > most) {
            return Err(Error::argument(format!("{name} is {side}; a canvas of this device has at most {most}")));
        }
        let ready = tracer.make_ready(scene, request, true, &|| aborts.check()).await?;
        aborts.check()?;
        let canvas = match &mut self.canvas {
            Some(canvas) if canvas.is_of(element) => canvas,
            place => place.insert(Canvas::new(tracer, element.clone())?),
        };
        let stats = if ready.steps <= AHEAD as u64 {
            let texture = canvas.texture(&device, size)?;
            let traced = in_one_task(tracer, scene, request, texture).await;
            traced.inspect_err(|_| tracer.forget())?
        } else {
            let target = FrameTarget::screen(canvas.kept(&device, size)?);
            let traced = step_by_step(tracer, scene, request, target, &mut |_, _, _| Ok(()), aborts).await;
            let stats = traced.inspect_err(|_| tracer.forget())?;
            canvas.show_kept(&device)?;
            stats
        };
        self.stats.publish(stats, start.elapsed());
        Ok(())
    }
}

/// Traces a frame of few steps into the texture of a canvas: all are submitted in this task, as the texture is the
/// browser's after it.
async fn in_one_task(
    tracer: &mut GpuTracer,
    scene: &Scene,
    request: &FrameRequest,
    texture: CanvasTexture,
) -> Result<FrameStats> {
    let device = tracer.device();
    let mut frame = tracer.begin(scene, request, texture.target())?;
    let mut stats = frame.stats();
    let mut under_way = Vec::new();
    while let Some(step) = tracer.submit(&mut frame)? {
        under_way.push(step);
    }
    texture.show(&device)?;
    device.ran().await?;
    for step in under_way {
        step.finish(&device, &mut stats, &mut |_, _, _| Ok(()))?;
    }
    stats.device_bytes = device.bytes();
    Ok(stats)
}

/// Traces a frame by a few steps at a time, and ends before the next one where `aborts` says so.
async fn step_by_step(
    tracer: &mut GpuTracer,
    scene: &Scene,
    request: &FrameRequest,
    target: FrameTarget<'_>,
    sink: &mut TileSink<'_>,
    aborts: &Aborts,
) -> Result<FrameStats> {
    let device = tracer.device();
    let mut frame = tracer.begin(scene, request, target)?;
    let mut stats = frame.stats();
    let mut under_way = VecDeque::new();
    loop {
        while under_way.len() < AHEAD
            && let Some(step) = tracer.submit(&mut frame)?
        {
            under_way.push_back(step);
        }
        let Some(step) = under_way.pop_front() else { break };
        device.ran().await?;
        step.finish(&device, &mut stats, sink)?;
        if !(frame.is_submitted() && under_way.is_empty()) {
            aborts.check()?;
        }
    }
    stats.device_bytes = device.bytes();
    Ok(stats)
}
