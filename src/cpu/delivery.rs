// SPDX-License-Identifier: MIT OR Apache-2.0
//! How the tiles of a frame go to the sink: each as soon as it has its light, or, with bloom, once all have theirs, as
//! every pixel gets a little of every other's. Knows neither how light is made nor host memory.

use super::frame::Frame;
use super::pool::Pool;
use crate::allocate::{collected, filled, with_room};
use crate::error::{Error, ErrorKind, Result};
use crate::film::FilmParams;
use crate::film::bloom::Bloom;
use crate::film::metering::{MeterParams, SpreadLight};
use crate::parallel::prelude::*;
use crate::tracer::{Progress, Tile, TileSink};

/// Bytes of a whole frame's light; a frame with bloom that needs more is traced twice instead.
const LIGHT_MEMORY: u64 = 192 << 20;
/// The name of this memory in out-of-memory errors.
const LIGHT: &str = "the light of a tile";
/// Bytes of a pixel's light.
const LIGHT_BYTES: u64 = size_of::<[f32; 4]>() as u64;

/// The stops that auto exposure added to the last metered frame; `None`: there was none.
#[derive(Clone, Copy, Default)]
pub struct Exposure {
    /// The size of that frame's finest grid.
    cells: [u32; 2],
    pub stops: Option<f32>,
}

/// A frame on its way to the sink.
pub struct Delivery<'a, 'b, 'c> {
    pool: &'a Pool,
    frame: &'a Frame<'a>,
    sink: &'a mut TileSink<'b>,
    progress: &'a mut Progress<'c>,
    /// The stops that auto exposure added to the last frame of this size, and then to this one.
    pub exposure: Exposure,
    /// Parts of the frame's work.
    done: u64,
    total: u64,
    /// The steps of all rays so far.
    pub steps: u64,
}

impl<'a, 'b, 'c> Delivery<'a, 'b, 'c> {
    pub fn new(
        pool: &'a Pool,
        frame: &'a Frame<'a>,
        sink: &'a mut TileSink<'b>,
        progress: &'a mut Progress<'c>,
        exposure: Exposure,
    ) -> Self {
        Self { pool, frame, sink, progress, exposure, done: 0, total: 0, steps: 0 }
    }

    /// Delivers a frame without bloom. Errors: those of the sink; CANCELLED; OUT_OF_MEMORY.
    pub fn plain(&mut self, tiles: &[Tile]) -> Result<()> {
        self.total = tiles.len() as u64 * u64::from(self.frame.samples);
        for tile in tiles {
            let light = self.light(*tile)?;
            self.deliver(*tile, &self.frame.film, &light)?;
            self.tick()?;
        }
        Ok(())
    }

    /// Delivers a frame with bloom, or one that is metered. `keep`: whether light is kept; `None`: as its size allows.
    /// Errors: those of the sink; CANCELLED; OUT_OF_MEMORY.
    pub fn with_glare(
        &mut self,
        tiles: &[Tile],
        (bloom, meter): (&Bloom, Option<MeterParams>),
        keep: Option<bool>,
    ) -> Result<()> {
        let [width, height] = bloom.frame.map(|side| side as usize);
        let keep = keep.unwrap_or((width * height) as u64 * LIGHT_BYTES <= LIGHT_MEMORY);
        let samples = u64::from(self.frame.samples);
        self.total = tiles.len() as u64 * (samples + if keep { 1 } else { samples });
        let mut kept = filled(if keep { width * height } else { 0 }, [0.0; 4], "the light of a frame with bloom")?;
        let mut accumulator = bloom.accumulator()?;
        for tile in tiles {
            let light = self.exposed_light(*tile)?;
            self.pool.install(|| accumulator.add([tile.x, tile.y], tile.width, &light));
            for (row, light) in rows(*tile, width).zip(light.chunks_exact(tile.width as usize)) {
                if let Some(row) = kept.get_mut(row) {
                    row.copy_from_slice(light);
                }
            }
            self.tick()?;
        }
        let before = self.exposure.stops.filter(|_| meter.is_some_and(|meter| meter.cells == self.exposure.cells));
        let spread = self.pool.install(|| SpreadLight::new(accumulator, meter, before))?;
        if let Some(meter) = meter {
            self.exposure = Exposure { cells: meter.cells, stops: spread.stops() };
        }
        let film = self.frame.film.of_exposed();
        for tile in tiles {
            let light = match keep {
                true => {
                    let mut light = with_room((tile.width * tile.height) as usize, LIGHT)?;
                    rows(*tile, width).filter_map(|row| kept.get(row)).for_each(|row| light.extend_from_slice(row));
                    light
                }
                false => self.exposed_light(*tile)?,
            };
            let light = self.pool.install(|| with_glare(&spread, *tile, &light))?;
            self.deliver(*tile, &film, &light)?;
            self.tick()?;
        }
        Ok(())
    }

    /// Errors: CANCELLED; OUT_OF_MEMORY.
    fn light(&mut self, tile: Tile) -> Result<Vec<[f64; 4]>> {
        let mut sum = filled((tile.width * tile.height) as usize, [0.0; 4], LIGHT)?;
        for sample in 0..self.frame.samples {
            if sample > 0 {
                self.tick()?;
            }
            self.steps += self.pool.install(|| self.frame.add_sample(tile, sample, &mut sum))?;
        }
        Ok(sum)
    }

    /// Light as bloom spreads it. Errors: CANCELLED; OUT_OF_MEMORY.
    fn exposed_light(&mut self, tile: Tile) -> Result<Vec<[f32; 4]>> {
        let light = self.light(tile)?;
        collected(light.into_iter().map(|radiance| self.frame.film.exposed_light(radiance)), LIGHT)
    }

    fn deliver(&mut self, tile: Tile, film: &FilmParams, light: &[[f64; 4]]) -> Result<()> {
        let pixels = self.pool.install(|| self.frame.develop(film, tile, light))?;
        (self.sink)(tile, &pixels, pixels.len() / tile.height.max(1) as usize)
    }

    /// A part is done. Errors: CANCELLED; but at the last one the frame is complete, and nothing is left to cancel.
    fn tick(&mut self) -> Result<()> {
        self.done += 1;
        if !(self.progress)(self.done as f64 / self.total as f64) && self.done < self.total {
            return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the frame"));
        }
        Ok(())
    }
}

/// Where a tile's rows lie in a frame of `width`.
fn rows(tile: Tile, width: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
    let begin = tile.y as usize * width + tile.x as usize;
    (0..tile.height as usize).map(move |row| begin + row * width..begin + row * width + tile.width as usize)
}

/// Errors: OUT_OF_MEMORY.
fn with_glare(spread: &SpreadLight<'_>, tile: Tile, light: &[[f32; 4]]) -> Result<Vec<[f64; 4]>> {
    let mut with = with_room(light.len(), LIGHT)?;
    let place = |i: usize| (tile.x + i as u32 % tile.width, tile.y + i as u32 / tile.width);
    let pixel = |(i, light): (usize, &[f32; 4])| {
        let (x, y) = place(i);
        spread.over(*light, x, y).map(f64::from)
    };
    light.par_iter().enumerate().map(pixel).collect_into_vec(&mut with);
    Ok(with)
}
