//! A frame on the CPU: tile by tile, sample by sample; rows of a tile in parallel. Knows no host memory: finished tiles go to
//! the sink.

use super::CpuTracer;
use super::record::{Neighbours, Recorder};
use super::shade::Shader;
use crate::error::{Error, ErrorKind, Result};
use crate::film::{FilmParams, develop_row};
use crate::renderer::{FrameRequest, FrameStats, Progress, Tile, TileSink};
use crate::scene::frame::sample_offset;
use crate::scene::observer::Lens;
use crate::scene::record::Record;
use crate::scene::{Scene, View};
use rayon::prelude::*;

/// Steps that the rays of a tile may be expected to take, and its widest row: small enough for the caches and for prompt
/// progress, large enough to keep every core busy.
const TILE_STEPS: u64 = 20 << 15;
const TILE_WIDTH: u32 = 1024;

/// A frame being rendered.
struct Frame<'a> {
    recorder: Recorder<'a>,
    shader: Shader<'a>,
    film: FilmParams,
    request: &'a FrameRequest,
    samples: u32,
    light: bool,
}

impl CpuTracer {
    /// Errors: as `Renderer::render`.
    pub fn render(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        let lens = scene.lens(&request.region)?;
        let frame = Frame::new(scene, &lens, request);
        let tiles = tiles(request, scene.expected_steps());
        let total = (tiles.len() as u64 * u64::from(frame.samples)) as f64;
        let mut stats = FrameStats {
            rays: u64::from(request.width) * u64::from(request.height) * u64::from(frame.samples),
            ..FrameStats::default()
        };
        let mut done = 0.0;
        for tile in tiles {
            let mut sum = vec![[0.0; 4]; (tile.width * tile.height) as usize];
            for sample in 0..frame.samples {
                stats.steps += self.pool.install(|| frame.add_sample(tile, sample, &mut sum));
                done += 1.0;
                if sample + 1 == frame.samples {
                    let pixels = self.pool.install(|| frame.develop(tile, &sum));
                    sink(tile, &pixels, tile.width as usize * request.format.bytes_per_pixel())?;
                }
                // The last tile is complete: nothing is left to cancel.
                if done < total && !progress(done / total) {
                    return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the frame"));
                }
            }
        }
        progress(1.0);
        Ok(stats)
    }
}

impl CpuTracer {
    /// The records of a frame, row by row. Errors: as `Scene::lens`.
    pub fn ray_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        let lens = scene.lens(&request.region)?;
        let frame = Frame::new(scene, &lens, request);
        let tile = Tile { x: 0, y: 0, width: request.width, height: request.height };
        let origin = [f64::from(request.region.x) + 0.5, f64::from(request.region.y) + 0.5];
        let mut records = vec![Record::captured(); request.width as usize * request.height as usize];
        self.pool.install(|| frame.with_records(tile, origin, &mut records, |record, _, _, out| *out = record.clone()));
        Ok(records)
    }
}

/// Row by row from the top left.
fn tiles(request: &FrameRequest, steps: u64) -> Vec<Tile> {
    let pixels = (TILE_STEPS / steps).clamp(256, 1 << 15) as u32;
    let w = request.width.clamp(1, TILE_WIDTH.min(pixels / 4));
    let h = pixels / w;
    let columns = (0..request.width).step_by(w as usize);
    let rows = (0..request.height).step_by(h as usize);
    rows.flat_map(|y| columns.clone().map(move |x| (x, y)))
        .map(|(x, y)| Tile { x, y, width: w.min(request.width - x), height: h.min(request.height - y) })
        .collect()
}

impl<'a> Frame<'a> {
    fn new(scene: &'a Scene, lens: &'a Lens, request: &'a FrameRequest) -> Self {
        let light = scene.view == View::Light;
        Self {
            recorder: Recorder::new(scene, lens),
            shader: Shader::new(scene, lens, request.transparent),
            film: FilmParams::new(&scene.film, scene.view, request.format, request.transparent),
            request,
            samples: if light { scene.quality.samples_per_pixel } else { 1 },
            light,
        }
    }

    /// Traces and shades one sample of every pixel of `tile` and adds it to `sum`; the steps of all rays.
    fn add_sample(&self, tile: Tile, sample: u32, sum: &mut [[f64; 4]]) -> u64 {
        let region = self.request.region;
        let offset = sample_offset(sample, self.samples);
        let origin = [f64::from(region.x + tile.x) + offset[0], f64::from(region.y + tile.y) + offset[1]];
        let weight = 1.0 / f64::from(self.samples);
        self.with_records(tile, origin, sum, |record, x, y, pixel| {
            let value = if self.light {
                self.shader.pixel_light(record)
            } else {
                [self.shader.view_value(record, x, y), 0.0, 0.0, 1.0]
            };
            (0..4).for_each(|c| pixel[c] += weight * value[c]);
        })
    }

    /// Calls `take` with the record of each pixel of `tile` (the first one's ray passing through `origin` of the full frame), its
    /// place, and its item of `out`; the steps of all rays.
    fn with_records<T: Send>(
        &self,
        tile: Tile,
        origin: [f64; 2],
        out: &mut [T],
        take: impl Fn(&Record, f64, f64, &mut T) + Sync,
    ) -> u64 {
        let place = |column: u32, row: u32| (origin[0] - 1.0 + f64::from(column), origin[1] - 1.0 + f64::from(row));
        // One pixel more on each side, for the derivatives.
        let (width, height) = (tile.width + 2, tile.height + 2);
        let trace_row =
            |row| (0..width).map(|column| place(column, row)).map(|(x, y)| self.recorder.trace(x, y)).collect();
        let records: Vec<Vec<Record>> = (0..height).into_par_iter().map(trace_row).collect();
        out.par_chunks_mut(tile.width as usize).zip(records.par_windows(3)).zip(1..height).for_each(
            |((out, rows), row)| {
                let [above, middle, below] = rows else { return };
                let columns = middle.windows(3).zip(above.iter().zip(below).skip(1));
                for ((item, (across, (above, below))), column) in out.iter_mut().zip(columns).zip(1..) {
                    let [left, here, right] = across else { continue };
                    let (x, y) = place(column, row);
                    take(&Neighbours { left, right, above, below }.complete(here), x, y, item);
                }
            },
        );
        records.iter().flatten().map(|record| u64::from(record.steps)).sum()
    }

    /// Packed pixels, rows without gaps.
    fn develop(&self, tile: Tile, sum: &[[f64; 4]]) -> Vec<u8> {
        let region = self.request.region;
        let width = tile.width as usize;
        let row_bytes = width * self.request.format.bytes_per_pixel();
        let mut pixels = vec![0; row_bytes * tile.height as usize];
        pixels.par_chunks_mut(row_bytes).zip(sum.par_chunks(width)).enumerate().for_each(|(row, (out, sum))| {
            develop_row(&self.film, sum, region.x + tile.x, region.y + tile.y + row as u32, out);
        });
        pixels
    }
}
