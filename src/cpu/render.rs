// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame on the CPU: tile by tile, sample by sample; rows of a tile in parallel. Knows no host memory: finished
//! tiles go to the sink.

use super::CpuTracer;
use super::delivery::Delivery;
use super::frame::Frame;
use super::pool::Pool;
use crate::allocate::{self, collected, filled};
use crate::error::Result;
use crate::film::bloom::Bloom;
use crate::film::metering::MeterParams;
use crate::scene::Scene;
use crate::scene::record::Record;
use crate::tracer::{FrameRequest, FrameStats, Progress, Tile, TileSink};

/// Steps that the rays of a tile may be expected to take, and its widest row: small enough for the caches and for
/// prompt progress, large enough to keep every core busy.
const TILE_STEPS: u64 = 20 << 15;
pub(super) const TILE_WIDTH: u32 = 1024;
/// The width of tiles with matter at half resolution: nearer to a square, as more blocks are traced than the tile has.
const TILE_WIDTH_HALF: u32 = 160;

impl CpuTracer {
    /// Errors: as `Renderer::render`.
    pub fn render(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        allocate::check_room(0, "a frame")?;
        let before = (self.lenses.made, self.exposure);
        let (stats, exposure) = self.with_frame(scene, request, |pool, frame| {
            let widest = if frame.half.is_some() { TILE_WIDTH_HALF } else { TILE_WIDTH };
            let tiles = tiles(request, frame.expected_steps(scene), widest)?;
            let mut delivery = Delivery::new(pool, frame, sink, progress, before.1);
            let mut auto_stops = None;
            match Bloom::new(scene, request.format, [request.width, request.height], request.is_whole())? {
                None => delivery.plain(&tiles)?,
                Some(bloom) => {
                    let meter = MeterParams::new(&scene.film, &bloom);
                    delivery.with_glare(&tiles, (&bloom, meter), scene.quality.keep_light)?;
                    auto_stops = meter.and(delivery.exposure.stops);
                }
            }
            let rays = u64::from(request.width) * u64::from(request.height) * u64::from(frame.samples);
            let auto_ev = auto_stops.map_or(0.0, f64::from);
            let stats = FrameStats { rays, steps: delivery.steps, auto_ev, ..FrameStats::default() };
            Ok((stats, delivery.exposure))
        })?;
        self.exposure = exposure;
        Ok(FrameStats { lens_tables: self.lenses.made - before.0, ..stats })
    }

    /// Sets a frame up, and keeps its sky and its lens for the next ones. Errors: as `Scene::lens`; OUT_OF_MEMORY;
    /// those of `work`.
    fn with_frame<T>(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        work: impl FnOnce(&Pool, &Frame<'_>) -> Result<T>,
    ) -> Result<T> {
        let lens = scene.lens(&request.region)?;
        let stars = self.stars.insert(scene.stars()?).clone();
        let frame = self.pool.install(|| Frame::new(scene, &lens, stars, &mut self.lenses, request))?;
        work(&self.pool, &frame)
    }

    /// Makes all that frames of the scene like this one need, its sky and its lens, and keeps it. Errors: as
    /// `Renderer::render`.
    pub fn prepare(&mut self, scene: &Scene, request: &FrameRequest) -> Result<()> {
        self.with_frame(scene, request, |_, _| Ok(()))
    }

    /// The records of a frame, row by row. Errors: as `Scene::lens`; OUT_OF_MEMORY.
    pub fn ray_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        let tile = Tile { x: 0, y: 0, width: request.width, height: request.height };
        let count = request.width as usize * request.height as usize;
        let mut records = filled(count, Record::captured(), "the records of a frame's rays")?;
        let keep = |record: &Record, _: f64, _: f64, out: &mut Record| *out = record.clone();
        self.with_frame(scene, request, |pool, frame| {
            pool.install(|| frame.with_records(tile, ([0.5; 2], 0.0), &mut records, keep))
        })?;
        Ok(records)
    }
}

/// Row by row from the top left. Errors: OUT_OF_MEMORY.
pub(super) fn tiles(request: &FrameRequest, steps: u64, widest: u32) -> Result<Vec<Tile>> {
    let pixels = (TILE_STEPS / steps).clamp(256, 1 << 15) as u32;
    let w = request.width.clamp(1, widest.min(pixels / 4));
    let h = pixels / w;
    let columns = (0..request.width).step_by(w as usize);
    let rows = (0..request.height).step_by(h as usize);
    let tiles = rows.flat_map(|y| columns.clone().map(move |x| (x, y))).map(|(x, y)| Tile {
        x,
        y,
        width: w.min(request.width - x),
        height: h.min(request.height - y),
    });
    collected(tiles, "the list of a frame's tiles")
}
