// SPDX-License-Identifier: MIT OR Apache-2.0
//! The class of tracers: frames into canvases and into memory. A script awaits a call before the next one; web/index.ts
//! sees to that.

use super::message::thrown;
use super::numbers;
use super::text::scene_of;
use crate::capi::scene_file::Moment;
use crate::cpu::CpuTracer;
use crate::error::{Error, Result};
use crate::gpu::{Canvas, CanvasTexture, FrameTarget, GpuTracer};
use crate::image::PixelFormat;
use crate::platform::Instant;
use crate::tracer::{FrameRequest, FrameStats, StatsBoard, Tile, TileSink};
use js_sys::Object;
use std::collections::VecDeque;
use wasm_bindgen::prelude::wasm_bindgen;
use web_sys::HtmlCanvasElement;

/// Steps under way at once: one is read while the next runs.
const AHEAD: usize = 2;

enum Traces {
    Gpu(Box<GpuTracer>),
    Cpu(Box<CpuTracer>),
}

/// A tracer of a page.
#[wasm_bindgen]
pub struct Tracer {
    /// Goes before the device that it belongs to.
    canvas: Option<(HtmlCanvasElement, Canvas)>,
    traces: Traces,
    stats: StatsBoard,
}

#[wasm_bindgen]
impl Tracer {
    /// On the browser's WebGPU. Throws where there is none.
    #[wasm_bindgen(js_name = onWebGpu)]
    pub async fn on_web_gpu() -> Result<Tracer, js_sys::Error> {
        let tracer = GpuTracer::of_page().await.map_err(thrown)?;
        Ok(Self { canvas: None, traces: Traces::Gpu(Box::new(tracer)), stats: StatsBoard::default() })
    }

    /// The CPU tracer, in double precision. Its frames take seconds, in which the thread does nothing else: it is for
    /// workers.
    #[wasm_bindgen(js_name = onCpu)]
    pub fn on_cpu() -> Result<Tracer, js_sys::Error> {
        let tracer = CpuTracer::new(1).map_err(thrown)?;
        Ok(Self { canvas: None, traces: Traces::Cpu(Box::new(tracer)), stats: StatsBoard::default() })
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

    /// Destroys the device, as a driver may at any time: for tests.
    #[wasm_bindgen(js_name = loseDevice)]
    pub fn lose_device(&self) -> Result<(), js_sys::Error> {
        match &self.traces {
            Traces::Gpu(tracer) => tracer.device().scoped("destroying the device", |raw| raw.destroy()).map_err(thrown),
            Traces::Cpu(_) => Ok(()),
        }
    }

    /// The frame of a scene's text, as packed rows of RGBA: bytes, or with `floats` numbers of 32 bits of the light
    /// before the film. Throws the C API's messages.
    pub async fn image(
        &mut self,
        scene: String,
        seconds: f64,
        width: u32,
        height: u32,
        floats: bool,
    ) -> Result<Vec<u8>, js_sys::Error> {
        let format = if floats { PixelFormat::Rgba32F } else { PixelFormat::Rgba8Srgb };
        self.try_image(&scene, seconds, [width, height], format).await.map_err(thrown)
    }

    /// The frame of a scene's text in a canvas of its size, which has no other context. Throws the C API's messages.
    pub async fn paint(&mut self, scene: String, seconds: f64, canvas: HtmlCanvasElement) -> Result<(), js_sys::Error> {
        self.try_paint(&scene, seconds, canvas).await.map_err(thrown)
    }
}

impl Tracer {
    async fn try_image(&mut self, text: &str, seconds: f64, size: [u32; 2], format: PixelFormat) -> Result<Vec<u8>> {
        let start = Instant::now();
        let (scene, request) = asked(text, seconds, size, format)?;
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
                let traced = traced(tracer, &scene, &request, None, &mut sink).await;
                traced.inspect_err(|_| tracer.forget())?
            }
        };
        self.stats.publish(stats, start.elapsed());
        Ok(bytes)
    }

    async fn try_paint(&mut self, text: &str, seconds: f64, element: HtmlCanvasElement) -> Result<()> {
        let start = Instant::now();
        let size = [element.width(), element.height()];
        let (scene, request) = asked(text, seconds, size, PixelFormat::Rgba8Srgb)?;
        let Traces::Gpu(tracer) = &mut self.traces else {
            return Err(Error::unsupported("the CPU tracer paints no canvas: put its image there"));
        };
        let canvas = match &mut self.canvas {
            Some((of, canvas)) if *of == element => canvas,
            place => &mut place.insert((element.clone(), Canvas::new(tracer, element)?)).1,
        };
        let texture = canvas.texture(&tracer.device(), size)?;
        let traced = traced(tracer, &scene, &request, Some(texture), &mut |_, _, _| Ok(())).await;
        let stats = traced.inspect_err(|_| tracer.forget())?;
        self.stats.publish(stats, start.elapsed());
        Ok(())
    }
}

/// The scene and the request of a frame. Errors: the C API's.
fn asked(text: &str, seconds: f64, size: [u32; 2], format: PixelFormat) -> Result<(crate::scene::Scene, FrameRequest)> {
    let Moment { scene, region } = scene_of(text, seconds)?;
    let request = FrameRequest::checked(&scene, format, size, false, region)?;
    Ok((scene, request))
}

/// Traces a frame: into the texture of a canvas, whose steps are all submitted in this task, as the texture is the
/// browser's after it; or to the sink, by a few steps at a time.
async fn traced(
    tracer: &mut GpuTracer,
    scene: &crate::scene::Scene,
    request: &FrameRequest,
    texture: Option<CanvasTexture>,
    sink: &mut TileSink<'_>,
) -> Result<FrameStats> {
    let device = tracer.device();
    let target = texture.as_ref().map_or(FrameTarget::Host, CanvasTexture::target);
    let mut frame = tracer.begin(scene, request, target)?;
    let mut stats = frame.stats();
    let ahead = if texture.is_some() { usize::MAX } else { AHEAD };
    let mut under_way = VecDeque::new();
    while under_way.len() < ahead
        && let Some(step) = tracer.submit(&mut frame)?
    {
        under_way.push_back(step);
    }
    if let Some(texture) = texture {
        texture.show(&device)?;
    }
    while let Some(step) = under_way.pop_front() {
        device.ran().await?;
        step.finish(&device, &mut stats, sink)?;
        if let Some(step) = tracer.submit(&mut frame)? {
            under_way.push_back(step);
        }
    }
    stats.device_bytes = device.bytes();
    Ok(stats)
}
