// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame that is set up: finds, shades and develops the pixels of a tile, its rows in parallel. Does not know how a
//! frame is cut into tiles.

use super::half::Blocks;
use super::lens::LensLookup;
use super::record::{Neighbours, Recorder};
use super::record_source::RecordSource;
use super::refine::Refiner;
use super::shade::{Shader, Shading};
use super::tables::LensCache;
use crate::allocate::filled;
use crate::emit::half::Evenness;
use crate::emit::moment::Shutter;
use crate::error::Result;
use crate::film::{FilmParams, develop_row};
use crate::image::Lut;
use crate::parallel::prelude::*;
use crate::scene::frame::sample_of;
use crate::scene::observer::Lens;
use crate::scene::record::Record;
use crate::scene::{KerrThreshold, Scene, View};
use crate::sky::StarIndex;
use crate::tracer::{FrameRequest, Tile};
use std::sync::Arc;

/// A frame being rendered.
pub struct Frame<'a> {
    lens: &'a Lens,
    source: RecordSource<'a>,
    shader: Shader<'a>,
    /// How pixels get their matter with depth from blocks; `None`: each sums its own.
    pub half: Option<Evenness>,
    /// Refines pixels with edges; `None` where values of views are shown, which are not to be averaged.
    refiner: Option<Refiner<'a>>,
    pub film: FilmParams,
    lut: Option<&'a Lut>,
    request: &'a FrameRequest,
    pub samples: u32,
    shutter: Shutter,
}

impl<'a> Frame<'a> {
    /// Renders on the current pool. Errors: OUT_OF_MEMORY.
    pub(super) fn new(
        scene: &'a Scene,
        lens: &'a Lens,
        stars: Arc<StarIndex>,
        cache: &'a mut LensCache,
        request: &'a FrameRequest,
    ) -> Result<Self> {
        let light = scene.view == View::Light;
        let region = &request.region;
        let pixels = u64::from(region.full_width) * u64::from(region.full_height);
        let observer = &lens.observer.frame;
        let structure = cache.structure(scene, lens)?;
        let tables = cache.tables(scene, observer, scene.lensing(observer, pixels, KerrThreshold::CPU))?;
        let source = |recorder| match tables {
            Some(tables) => RecordSource::LensLookup(LensLookup::new(recorder, tables)),
            None => RecordSource::Traced(recorder),
        };
        let samples = if light { scene.quality.samples_per_pixel } else { 1 };
        let lut = scene.shown_lut().map(Arc::as_ref);
        Ok(Self {
            lens,
            source: source(Recorder::new(scene, lens, &structure)),
            half: scene.half_resolution(),
            refiner: scene
                .refines(request.transparent)
                .then(|| Refiner::new(scene, lens, source(Recorder::whole_plane(scene, lens, &structure)))),
            shader: Shader::new(scene, lens, stars, request.transparent)?,
            film: FilmParams::new(&scene.film, scene.view, request.format, request.transparent)
                .over_frame(request.region.full_width, request.region.full_height)
                .with_lut(lut, &scene.film),
            lut,
            request,
            samples,
            shutter: scene.open_shutter(),
        })
    }

    /// The steps of a ray on average; looking one up takes as long as one.
    pub(super) fn expected_steps(&self, scene: &Scene) -> u64 {
        match self.source {
            RecordSource::Traced(_) => scene.expected_steps(),
            RecordSource::LensLookup(_) => 1,
        }
    }

    /// Finds and shades one sample of every pixel of `tile` and adds it to `sum`; the steps of all rays. Errors:
    /// OUT_OF_MEMORY.
    pub fn add_sample(&self, tile: Tile, sample: u32, sum: &mut [[f64; 4]]) -> Result<u64> {
        let (offset, moment) = sample_of(sample, self.samples, self.lens.mapping.projection, self.shutter);
        let shading = Shading { shader: &self.shader, moment };
        let weight = 1.0 / f64::from(self.samples);
        self.with_records(tile, (offset, moment), sum, |record, x, y, pixel| {
            let refiner = self.refiner.as_ref().filter(|_| self.lens.mapping.has_look_direction(x, y));
            let refined = refiner.and_then(|r| r.light(shading, record, [x, y]));
            let value = refined.unwrap_or_else(|| shading.shade_record(record, x, y));
            (0..4).for_each(|c| pixel[c] += weight * value[c]);
        })
    }

    /// Calls `take` with the record of each pixel of `tile` (its ray passing through the place `offset`, 0 .. 1, of
    /// the pixel, and seeing matter `moment` after the frame's time, M), its place, and its item of `out`; the steps of
    /// all rays. Errors: OUT_OF_MEMORY.
    pub(super) fn with_records<T: Send>(
        &self,
        tile: Tile,
        (offset, moment): ([f64; 2], f64),
        out: &mut [T],
        take: impl Fn(&Record, f64, f64, &mut T) + Sync,
    ) -> Result<u64> {
        let region = self.request.region;
        let tile = Tile { x: region.x + tile.x, y: region.y + tile.y, ..tile };
        let origin = [f64::from(tile.x) + offset[0], f64::from(tile.y) + offset[1]];
        match &self.source {
            RecordSource::Traced(recorder) => trace_records((recorder, self.half), tile, (offset, moment), out, take),
            RecordSource::LensLookup(lookup) => Ok(look_records_up(lookup, tile, origin, out, take)),
        }
    }

    /// Packed pixels, rows without gaps. Errors: OUT_OF_MEMORY.
    pub fn develop(&self, film: &FilmParams, tile: Tile, sum: &[[f64; 4]]) -> Result<Vec<u8>> {
        let region = self.request.region;
        let width = tile.width as usize;
        let row_bytes = width * self.request.format.bytes_per_pixel();
        let mut pixels = filled(row_bytes * tile.height as usize, 0, "the pixels of a tile")?;
        pixels.par_chunks_mut(row_bytes).zip(sum.par_chunks(width)).enumerate().for_each(|(row, (out, sum))| {
            develop_row(film, self.lut, sum, region.x + tile.x, region.y + tile.y + row as u32, out);
        });
        Ok(pixels)
    }
}

/// Does the work of `Frame::with_records` by tracing; `tile`: its place in the full frame.
fn trace_records<T: Send>(
    (recorder, half): (&Recorder<'_>, Option<Evenness>),
    tile: Tile,
    (offset, moment): ([f64; 2], f64),
    out: &mut [T],
    take: impl Fn(&Record, f64, f64, &mut T) + Sync,
) -> Result<u64> {
    let begin = [tile.x as i32, tile.y as i32];
    let place = |column: u32, row: u32| {
        let at = |begin: i32, past: u32, offset: f64| f64::from(begin) + offset - 1.0 + f64::from(past);
        (at(begin[0], column, offset[0]), at(begin[1], row, offset[1]))
    };
    let blocks = |evenness| Blocks::new(recorder, evenness, begin, [tile.width, tile.height], (offset, moment));
    let blocks = half.map(blocks).transpose()?;
    // One pixel more on each side, for the derivatives.
    let (width, height) = (tile.width + 2, tile.height + 2);
    let stride = width as usize;
    // The records are one allocation: rows that many threads make and free would leave their allocators in shreds.
    let mut records = filled(stride * height as usize, Record::captured(), "the records of a tile's rays")?;
    records.par_chunks_mut(stride).zip(0..height).for_each(|(records, row)| {
        for (record, column) in records.iter_mut().zip(0..) {
            let (x, y) = place(column, row);
            *record = if blocks.is_some() { recorder.trace_bare(x, y) } else { recorder.trace_among(x, y, 1, moment) };
        }
    });
    let rows =
        records.par_chunks(stride).zip(records.par_chunks(stride).skip(1)).zip(records.par_chunks(stride).skip(2));
    out.par_chunks_mut(tile.width as usize).zip(rows).zip(1..height).for_each(
        |((out, ((above, middle), below)), row)| {
            let columns = middle.windows(3).zip(above.iter().zip(below).skip(1));
            for ((item, (across, (above, below))), column) in out.iter_mut().zip(columns).zip(1..) {
                let [left, here, right] = across else { continue };
                let (x, y) = place(column, row);
                let neighbours = Neighbours::of(&recorder.lens.mapping, x, [left, right, above, below]);
                let mut record = neighbours.complete(here, &recorder.matter);
                if let Some(blocks) = &blocks {
                    let pixel = [begin[0] + column as i32 - 1, begin[1] + row as i32 - 1];
                    record.media = blocks.media(pixel, here).0;
                }
                take(&record, x, y, item);
            }
        },
    );
    Ok(records.iter().map(|record| u64::from(record.steps)).sum())
}

/// Does the work of `Frame::with_records` by looking up: each record is used as it is made.
fn look_records_up<T: Send>(
    lookup: &LensLookup<'_>,
    tile: Tile,
    origin: [f64; 2],
    out: &mut [T],
    take: impl Fn(&Record, f64, f64, &mut T) + Sync,
) -> u64 {
    let row = |(row, out): (usize, &mut [T])| {
        let mut record = Record::captured();
        let mut steps = 0;
        for (column, item) in out.iter_mut().enumerate() {
            let (x, y) = (origin[0] + column as f64, origin[1] + row as f64);
            lookup.record(x, y, &mut record);
            steps += u64::from(record.steps);
            take(&record, x, y, item);
        }
        steps
    };
    out.par_chunks_mut(tile.width as usize).enumerate().map(row).sum()
}
