// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bloom: the glare that scattered light makes around bright things. This file says which share of a frame's light
//! goes how far, makes the grids that spread it, and spreads it on the CPU; `shaders/bloom` and
//! `src/gpu/frame/passes/bloom.rs` do the same with these numbers. Works on exposed light
//! ([`FilmParams::exposed_light`](super::FilmParams::exposed_light)); knows nothing of how that light was made, or of
//! 8-bit pixels. A telescope's beam (bloom/beam.rs) and a lens's spikes (bloom/spikes.rs) spread light by the same
//! grids, and so does what it reflects into ghosts (bloom/ghosts.rs).
//!
//! The result: out = (1 - s) L + s (L * K), s = 0.4 `bloom`, and K, of integral 1, K(r) ~ (r^2 + r0^2)^(-3/2) +
//! (r^2 + r0^2)^-1 / r1, r0 = H / 180, r1 = H / 28, cut off smoothly about H / 4, H the frame's height. These are the
//! wings of light scattered in the eye: 10 / theta^3 + 10 / theta^2 in degrees (G. Spencer, P. Shirley, K. Zimmerman,
//! D. Greenberg, SIGGRAPH 1995, their photopic f1 and f2, 0.478 * 20.91 and 0.138 * 72.37; likewise J. J. Vos, CIE
//! 135/1, 1999), for a frame seen from two heights away, which makes 1 degree H / 28. Photographs' aureoles fall the
//! same way (I. King 1971). Their core, 0.02 degrees, would be smaller than a pixel: blur, not glare; r0 is what
//! shows.
//!
//! How: each term is a sum of Gaussians, exactly: (1 + r^2/r0^2)^-b = 1/Gamma(b) Int t^(b-1) e^-t exp(-t r^2/r0^2) dt,
//! t = r0^2 / (2 sigma^2), which the levels of a pyramid take octave by octave. From grid to coarser grid light is
//! shared out by B-splines and comes back by the transposed sharing, divided by what each cell covers: T^t diag(1/T1)
//! T. Every column of T sums to 1 (a share that would fall outside the frame goes to the cell that its pixel lies in),
//! so that the whole is symmetric, keeps a uniform frame uniform, and keeps the sum of any light, wherever it lies.
//! The levels, smooth as they are, do not show: wherever the light lies, K is within 10 % of its formula and within 5
//! % isotropic from five of the finest cells on (10 pixels, in frames of at most 2^21 cells of 2 x 2), and within 20 %
//! nearer.

mod beam;
mod ghosts;
mod spikes;

pub use beam::{BEAM_SHARES, Beam};
pub use ghosts::{GHOST_PAIRS, Ghost, GhostNumbers, Ghosts};
pub use spikes::{SPIKE_ELEMENTS, SPIKE_TERMS, SpikeLine, Spikes};

use crate::allocate::{collected, filled, with_room};
use crate::error::Result;
use crate::image::PixelFormat;
use crate::parallel::prelude::*;
use crate::scene::{Film, Optics, Scene, View};

/// The share s that `bloom` = 1 scatters.
const MOST_SCATTERED: f64 = 0.4;
/// r0, r1 and the radius of the cut, in frame heights.
const CORE: f64 = 1.0 / 180.0;
const DEGREE: f64 = 1.0 / 28.0;
const CUT: f64 = 0.25;
/// The greatest sigma of the widest level, in frame heights.
const WIDEST: f64 = 1.0 / 3.0;
/// The most cells of the finest grid.
const MOST_CELLS: u64 = 1 << 21;
/// The most cells along a side of the finest grid, so that textures of small devices hold it.
const MOST_SIDE: u64 = 4000;
/// The most grids: each is twice as wide as the one before, from a pixel's size to the largest frame's.
pub const MOST_LEVELS: usize = 20;
/// Cells at each far edge of a grid that may cover less than the others.
pub const TAIL: usize = 4;
/// The shares of their light that the six nearest cells of a finer grid give: the B-spline of degree 4.
const SPLINE: [f64; 6] = [1.0 / 16.0, 5.0 / 16.0, 10.0 / 16.0, 10.0 / 16.0, 5.0 / 16.0, 1.0 / 16.0];

/// The name of this memory in out-of-memory errors.
const GRIDS: &str = "the grids of bloom";

/// How a frame's light is spread.
#[derive(Clone, Debug)]
pub struct Bloom {
    /// Size of the frame in pixels.
    pub frame: [u32; 2],
    /// Pixels along each side of a cell of the finest grid; even.
    pub factor: u32,
    /// The share of a pixel's light that stays in it.
    pub direct: f32,
    /// The levels from the finest on; at least one.
    pub levels: Vec<Level>,
    /// The beam, on one of the levels; `None`: the film has none.
    pub beam: Option<Beam>,
    /// Light reflected into ghosts, added on the finest grid; `None`: the film has none.
    pub ghosts: Option<Ghosts>,
    /// Light thrown along lines, on the finest grid; `None`: the film has none.
    pub spikes: Option<Spikes>,
}

/// A grid over the frame.
#[derive(Clone, Debug)]
pub struct Level {
    /// Size in cells; the last ones may reach beyond the frame.
    pub size: [u32; 2],
    /// The share of all light that spreads by this level.
    pub weight: f32,
    /// The shares that cells take from the finer grid, or the frame, in x and in y.
    taps: [Taps; 2],
}

/// The light that the cells of a row take from a finer row.
#[derive(Clone, Debug)]
struct Taps {
    /// Finer cells across a cell.
    step: usize,
    /// The shares of each cell's taps, which sum to 1; those outside are 0.
    shares: Vec<f32>,
    /// The number of taps of a cell.
    each: usize,
    /// The part of each cell that lies in the frame, 1 for all of it.
    coverage: Vec<f64>,
}

impl Taps {
    /// `fine` is the coverage of the finer row, `kernel` the shares that a cell gets of the finer ones about it, even
    /// in number. Errors: OUT_OF_MEMORY.
    fn new(fine: &[f64], step: usize, kernel: &[f64]) -> Result<Self> {
        let (each, cells) = (kernel.len(), fine.len().div_ceil(step));
        let margin = (each - step) / 2;
        let (shares, coverage) = (with_room(cells * each, GRIDS)?, with_room(cells, GRIDS)?);
        let mut taps = Self { step, shares, each, coverage };
        let mut own_shares = with_room(each, GRIDS)?;
        for cell in 0..cells {
            let share = |tap: usize| {
                let covered = (cell * step + tap).checked_sub(margin).and_then(|i| fine.get(i)).copied().unwrap_or(0.0);
                let own = tap >= margin && tap < margin + step;
                let mut share = kernel[tap];
                if own && cell == 0 {
                    share += kernel.get(tap + step).copied().unwrap_or(0.0);
                }
                if own && cell + 1 == cells {
                    share += tap.checked_sub(step).map_or(0.0, |tap| kernel[tap]);
                }
                share * covered
            };
            own_shares.clear();
            own_shares.extend((0..each).map(share));
            let sum = own_shares.iter().sum::<f64>();
            taps.shares.extend(own_shares.iter().map(|share| (share / sum) as f32));
            taps.coverage.push(sum / step as f64);
        }
        Ok(taps)
    }

    /// The first finer cell that a cell takes from, and their shares; none lies outside `fine` cells.
    fn of(&self, cell: usize, fine: usize) -> (usize, &[f32]) {
        let shares = &self.shares[cell * self.each..(cell + 1) * self.each];
        let margin = (self.each - self.step) / 2;
        let first = cell * self.step;
        let outside = margin.saturating_sub(first);
        let first = (first + outside) - margin;
        let end = shares.len().min(fine.saturating_sub(first) + outside);
        (first, &shares[outside..end])
    }
}

/// The shares that a pixel gives to the finest cells about it: linear in its distance from their centres.
fn tent(factor: u32) -> Result<Vec<f64>> {
    let f = f64::from(factor);
    collected((0..2 * factor).map(|tap| (f64::from(tap) + 0.5).min(2.0 * f - f64::from(tap) - 0.5) / f), GRIDS)
}

/// Standard deviation of level `index`'s spread, there and back, in pixels: the variance of the tent is (2 f^2 + 1) /
/// 12, that of the spline 5/12 of its cells, each level's four times that of the one before.
fn sigma(factor: u32, index: usize) -> f64 {
    let f2 = f64::from(factor).powi(2);
    (2.0 * ((2.0 * f2 + 1.0) / 12.0 + f2 * 5.0 / 12.0 * (4.0_f64.powi(index as i32) - 1.0))).sqrt()
}

/// The density, by ln sigma and not normalised, of the light that K spreads at Gaussians of `sigma` (in frame heights).
fn density(sigma: f64) -> f64 {
    let t = 0.5 * (CORE / sigma).powi(2);
    // Gamma(3/2) = sqrt(pi) / 2, Gamma(1) = 1; a Gaussian of r0^2 / t has the integral pi r0^2 / t, and dt = 2 t d(ln
    // sigma).
    let near = t.sqrt() / (0.5 * std::f64::consts::PI.sqrt() * CORE);
    (near + 1.0 / DEGREE) * (-t - (sigma / CUT).powi(2)).exp()
}

/// Weights of Gaussians of these `sigmas` (in frame heights), and of all that are narrower than the first one's
/// octave; sum 1.
fn weights(sigmas: &[f64]) -> (Vec<f64>, f64) {
    let logs = sigmas.iter().map(|sigma| sigma.ln()).collect::<Vec<_>>();
    let octave = std::f64::consts::LN_2;
    let between = |i: usize| match (i.checked_sub(1).and_then(|i| logs.get(i)), logs.get(i)) {
        (Some(a), Some(b)) => 0.5 * (a + b),
        (None, Some(b)) => b - 0.5 * octave,
        (Some(a), None) => a + 0.5 * octave,
        (None, None) => 0.0,
    };
    let spread = sigmas.iter().enumerate().map(|(i, s)| density(*s) * (between(i + 1) - between(i)));
    let spread = spread.collect::<Vec<_>>();
    const PARTS: u32 = 64;
    let part = octave / 8.0;
    let narrow = (0..PARTS).map(|i| density((between(0) - (f64::from(i) + 0.5) * part).exp()) * part).sum::<f64>();
    let sum = narrow + spread.iter().sum::<f64>();
    (spread.iter().map(|w| w / sum).collect(), narrow / sum)
}

impl Bloom {
    /// Whether a frame of this kind has any, or a beam, or has its light measured on the finest grid.
    pub fn is_shown(film: &Film, view: View, format: PixelFormat) -> bool {
        let spreads = film.bloom > 0.0 || film.beam_fwhm > 0.0 || film.optics.is_on();
        (spreads || film.is_metered()) && view == View::Light && format.is_developed()
    }

    /// The bloom of a frame; `None`: it has none. `whole`: it is not a region of a larger one, whose glare nobody
    /// knows. Errors: OUT_OF_MEMORY.
    pub fn new(scene: &Scene, format: PixelFormat, frame: [u32; 2], whole: bool) -> Result<Option<Self>> {
        let film = &scene.film;
        (whole && Self::is_shown(film, scene.view, format)).then(|| Self::of(film, frame)).transpose()
    }

    /// Makes the grids for a film that has passed its check, and a frame of at least one pixel. Errors: OUT_OF_MEMORY.
    pub fn of(film: &Film, frame: [u32; 2]) -> Result<Self> {
        let (bloom, beam_fwhm) = (film.bloom, film.beam_fwhm);
        let cells = |factor: u32| frame.map(|side| u64::from(side.div_ceil(factor)));
        let mut factor = 2;
        while cells(factor).iter().product::<u64>() > MOST_CELLS || cells(factor).iter().any(|&side| side > MOST_SIDE) {
            factor += 2;
        }
        let height = f64::from(frame[1]);
        let mut levels: Vec<Level> = Vec::new();
        let mut sigmas = Vec::new();
        while let Some(taps) = next_taps(&levels, frame, factor)?
            && (levels.is_empty() || sigma(factor, levels.len()) < WIDEST * height)
        {
            sigmas.push(sigma(factor, levels.len()) / height);
            let size = taps.each_ref().map(|taps| taps.coverage.len() as u32);
            levels.push(Level { size, weight: 0.0, taps });
        }
        let scattered = MOST_SCATTERED * bloom;
        let (weights, narrow) = weights(&sigmas);
        for (level, weight) in levels.iter_mut().zip(weights) {
            level.weight = (scattered * weight) as f32;
        }
        let direct = 1.0 - scattered * (1.0 - narrow);
        let beam = (beam_fwhm > 0.0).then(|| Beam::new(beam_fwhm * height, factor, levels.len()));
        let mut bloom = Self { frame, factor, direct: direct as f32, levels, beam, ghosts: None, spikes: None };
        if bloom.beam.is_some() {
            bloom = bloom.through_beam(direct);
        }
        // Coarser levels than these spread nothing.
        let beam_levels = bloom.beam.as_ref().map_or(1, |beam| beam.level + 1);
        let ghost_levels = if film.optics.flare > 0.0 {
            Ghosts::source_of(bloom.levels.iter().map(|level| level.size[1])) + 1
        } else {
            1
        };
        if scattered == 0.0 {
            bloom.levels.truncate(beam_levels.max(ghost_levels));
        }
        Ok(bloom.with_optics(&film.optics))
    }

    /// With the light that a lens reflects into ghosts and throws along lines, which the rest then lacks.
    fn with_optics(mut self, optics: &Optics) -> Self {
        let rest = (1.0 - Spikes::share(optics) - Ghosts::share(optics)) as f32;
        self.direct *= rest;
        self.levels.iter_mut().for_each(|level| level.weight *= rest);
        let above = self.weight_above(0);
        let grids = self.levels.iter().map(|level| (level.size, level.tails())).collect::<Vec<_>>();
        let ghosts = Ghosts::new(optics, &grids, self.factor, self.frame, above);
        let above = if ghosts.is_some() { 1.0 } else { above };
        let spikes = grids.first().and_then(|base| Spikes::new(optics, *base, self.factor, self.frame[1], above));
        Self { ghosts, spikes, ..self }
    }

    /// The pyramid with its shares as the beam needs them: all light that is spread less than the beam's level spreads
    /// it goes through that level.
    fn through_beam(mut self, direct: f64) -> Self {
        let Some(beam) = &self.beam else { return self };
        let through = (direct * beam.through) as f32;
        self.direct = (direct * (1.0 - beam.through)) as f32;
        let narrower = self.levels.iter().take(beam.level).map(|level| level.weight).sum::<f32>();
        self.levels.iter_mut().take(beam.level).for_each(|level| level.weight = 0.0);
        if let Some(level) = self.levels.get_mut(beam.level) {
            level.weight += narrower + through;
        }
        self
    }

    /// The factor on the light of level `index`: its weight if it is the coarsest; else 1, because its light comes
    /// weighted already.
    pub fn weight_above(&self, index: usize) -> f32 {
        match self.levels.get(index) {
            // Light of ghosts and lines is added to what the finest grid spreads, weighted already.
            Some(_) if index == 0 && (self.ghosts.is_some() || self.spikes.is_some()) => 1.0,
            Some(last) if index + 1 == self.levels.len() => last.weight,
            _ => 1.0,
        }
    }

    /// How the frame's light is gathered for the finest grid. Errors: OUT_OF_MEMORY.
    pub fn accumulator(&self) -> Result<BloomAccumulator<'_>> {
        let cells = self.levels.first().map_or(0, |base| base.cells());
        Ok(BloomAccumulator { bloom: self, base: filled(cells, [0.0; 4], GRIDS)? })
    }
}

/// The taps from the coarsest level so far to the next one; `None`: it cannot be coarser.
fn next_taps(levels: &[Level], frame: [u32; 2], factor: u32) -> Result<Option<[Taps; 2]>> {
    let [x, y] = match levels.last() {
        None => {
            let kernel = tent(factor)?;
            frame.map(|side| Taps::new(&filled(side as usize, 1.0, GRIDS)?, factor as usize, &kernel))
        }
        Some(level) if level.size == [1, 1] || levels.len() == MOST_LEVELS => return Ok(None),
        Some(level) => level.taps.each_ref().map(|taps| Taps::new(&taps.coverage, 2, &SPLINE)),
    };
    Ok(Some([x?, y?]))
}

impl Level {
    fn cells(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// The part that lies in the frame of the last cells of a row and of a column, the very last one last.
    pub fn tails(&self) -> [[f32; TAIL]; 2] {
        self.taps.each_ref().map(|taps| {
            let mut tail = [1.0; TAIL];
            for (out, covered) in tail.iter_mut().rev().zip(taps.coverage.iter().rev()) {
                *out = *covered as f32;
            }
            tail
        })
    }

    /// The cells' mean light, from the finer grid's.
    fn downsampled(&self, fine: &[[f32; 4]], [width, height]: [u32; 2]) -> Result<Vec<[f32; 4]>> {
        let mut cells = filled(self.cells(), [0.0; 4], GRIDS)?;
        let (width, height) = (width as usize, height as usize);
        cells.par_chunks_mut(self.size[0] as usize).enumerate().for_each(|(y, row)| {
            let (top, down) = self.taps[1].of(y, height);
            for (x, cell) in row.iter_mut().enumerate() {
                let (left, across) = self.taps[0].of(x, width);
                *cell = weighted_sum(fine, width, [left, top], across, down);
            }
        });
        Ok(cells)
    }
}

/// Sum of the values of a rectangle whose first is `begin`, each times its column's and its row's factor.
fn weighted_sum(values: &[[f32; 4]], width: usize, [left, top]: [usize; 2], across: &[f32], down: &[f32]) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for (row, down) in values.chunks_exact(width).skip(top).zip(down) {
        for (value, across) in row.iter().skip(left).zip(across) {
            let weight = across * down;
            (0..4).for_each(|c| sum[c] += weight * value[c]);
        }
    }
    sum
}

/// The finest grid as the frame's light comes in, tile by tile.
pub struct BloomAccumulator<'a> {
    bloom: &'a Bloom,
    base: Vec<[f32; 4]>,
}

impl<'a> BloomAccumulator<'a> {
    /// `light` of a tile of the frame at `begin`, rows of `width`. On the current pool.
    pub fn add(&mut self, begin: [u32; 2], width: u32, light: &[[f32; 4]]) {
        let Some(base) = self.bloom.levels.first() else { return };
        let [left, top] = begin.map(|side| side as usize);
        let (width, height) = (width as usize, light.len() / width.max(1) as usize);
        let factor = self.bloom.factor as usize;
        // Cells whose taps reach into the tile: half a cell further on both sides.
        let reach = |begin: usize, side: usize, cells: u32| {
            (begin.saturating_sub(factor / 2) / factor)
                ..((begin + side + factor / 2).div_ceil(factor)).min(cells as usize)
        };
        let (columns, rows) = (reach(left, width, base.size[0]), reach(top, height, base.size[1]));
        let [frame_width, frame_height] = self.bloom.frame.map(|side| side as usize);
        let stride = base.size[0] as usize;
        let lines = self.base.par_chunks_mut(stride).enumerate().skip(rows.start).take(rows.len());
        lines.for_each(|(y, line)| {
            let (first_row, down) = within(base.taps[1].of(y, frame_height), top, height);
            for (x, cell) in line.iter_mut().enumerate().skip(columns.start).take(columns.len()) {
                let (first, across) = within(base.taps[0].of(x, frame_width), left, width);
                let part = weighted_sum(light, width, [first, first_row], across, down);
                (0..4).for_each(|c| cell[c] += part[c]);
            }
        });
    }

    /// The light of the finest grid's cells, once all tiles are in. Errors: OUT_OF_MEMORY.
    pub fn cells(&self) -> Result<Vec<[f32; 4]>> {
        collected(self.base.iter().copied(), GRIDS)
    }

    /// Once all tiles are in: spreads their light. On the current pool. Errors: OUT_OF_MEMORY.
    pub fn spread(self) -> Result<Glare<'a>> {
        let Self { bloom, base } = self;
        let own = if bloom.spikes.is_some() { collected(base.iter().copied(), GRIDS)? } else { Vec::new() };
        let mut grids = vec![base];
        for pair in bloom.levels.windows(2) {
            if let ([finer, level], Some(grid)) = (pair, grids.last()) {
                let grid = level.downsampled(grid, finer.size)?;
                grids.push(grid);
            }
        }
        let drawn = match &bloom.ghosts {
            Some(ghosts) => grids.get(ghosts.source).map(|source| ghosts.drawn(source)).transpose()?,
            None => None,
        };
        let mut glare = bloom.after_beam(grids.len().saturating_sub(1), grids.pop().unwrap_or_default())?;
        for (index, grid) in grids.into_iter().enumerate().rev() {
            glare = bloom.after_beam(index, bloom.with_coarser(index, grid, &glare))?;
        }
        if let (Some((ghosts, drawn)), Some(base)) = (bloom.ghosts.as_ref().zip(drawn), bloom.levels.first()) {
            ghosts.add_to(&mut glare, base.size[0], &drawn);
        }
        if let Some(spikes) = &bloom.spikes {
            spikes.add_to(&mut glare, &own)?;
        }
        Ok(Glare { bloom, cells: glare })
    }
}

/// The part of the taps that lies in `begin..begin + size`, and where it begins there.
fn within((first, shares): (usize, &[f32]), begin: usize, size: usize) -> (usize, &[f32]) {
    let outside = begin.saturating_sub(first).min(shares.len());
    let first = (first + outside).saturating_sub(begin);
    let rest = &shares[outside..];
    (first, &rest[..rest.len().min(size.saturating_sub(first))])
}

impl Bloom {
    /// The light of level `index` once the beam has spread it, if that is its level. Errors: OUT_OF_MEMORY.
    fn after_beam(&self, index: usize, cells: Vec<[f32; 4]>) -> Result<Vec<[f32; 4]>> {
        let beam = self.beam.as_ref().filter(|beam| beam.level == index);
        match (beam, self.levels.get(index)) {
            (Some(beam), Some(level)) => beam.spread(cells, level.size),
            _ => Ok(cells),
        }
    }

    /// The light that level `index` and those above it spread, on its grid: its own light times its weight, and theirs.
    fn with_coarser(&self, index: usize, mut own: Vec<[f32; 4]>, above: &[[f32; 4]]) -> Vec<[f32; 4]> {
        let (Some(level), Some(coarser)) = (self.levels.get(index), self.levels.get(index + 1)) else { return own };
        let factor = self.weight_above(index + 1);
        own.par_chunks_mut(level.size[0] as usize).enumerate().for_each(|(y, row)| {
            let (rows, down) = upsampling_taps(y, coarser.size[1]);
            for (x, cell) in row.iter_mut().enumerate() {
                let (columns, across) = upsampling_taps(x, coarser.size[0]);
                let mut sum = cell.map(|v| v * level.weight);
                for (row, down) in rows.iter().zip(down) {
                    for (column, across) in columns.iter().zip(across) {
                        let value = above[row * coarser.size[0] as usize + column];
                        (0..4).for_each(|c| sum[c] += factor * down * across * value[c]);
                    }
                }
                *cell = sum;
            }
        });
        own
    }
}

/// The coarser cells that give light back to cell `i`, and their shares; at the border the share of a missing cell is
/// that of the cell itself.
fn upsampling_taps(i: usize, coarser: u32) -> ([usize; 3], [f32; 3]) {
    let own = i / 2;
    let cells = [own.saturating_sub(1), own, (own + 1).min(coarser as usize - 1)];
    let shares =
        if i.is_multiple_of(2) { [SPLINE[4], SPLINE[2], SPLINE[0]] } else { [SPLINE[5], SPLINE[3], SPLINE[1]] };
    (cells, shares.map(|share| share as f32))
}

/// The scattered light of a frame, on its finest grid.
pub struct Glare<'a> {
    bloom: &'a Bloom,
    cells: Vec<[f32; 4]>,
}

impl Glare<'_> {
    /// The mean light with its glare of a cell of the finest grid, by its number there and its own light.
    pub fn over_cell(&self, own: [f32; 4], number: usize) -> [f32; 3] {
        let above = self.bloom.weight_above(0);
        let scattered = self.cells.get(number).copied().unwrap_or_default();
        std::array::from_fn(|c| self.bloom.direct * own[c] + above * scattered[c])
    }

    /// Pixel (x, y) of the frame with its glare, of its own exposed light; alpha as it was.
    pub fn over(&self, light: [f32; 4], x: u32, y: u32) -> [f32; 4] {
        let Some(base) = self.bloom.levels.first() else { return light };
        let (rows, down) = between_cells(y, self.bloom.factor, base.size[1]);
        let (columns, across) = between_cells(x, self.bloom.factor, base.size[0]);
        let above = self.bloom.weight_above(0);
        let mut sum = light.map(|v| v * self.bloom.direct);
        for (row, down) in rows.iter().zip(down) {
            for (column, across) in columns.iter().zip(across) {
                let value = self.cells[row * base.size[0] as usize + column];
                (0..3).for_each(|c| sum[c] += above * down * across * value[c]);
            }
        }
        [sum[0], sum[1], sum[2], light[3]]
    }
}

/// The two cells between whose centres pixel `i` lies, and the shares of their light that it gets; at the border both
/// are the same.
fn between_cells(i: u32, factor: u32, cells: u32) -> ([usize; 2], [f32; 2]) {
    let (own, place) = (i / factor, i % factor);
    let before = place < factor / 2;
    let first = if before { own.saturating_sub(1) } else { own };
    let second = if before { own } else { (own + 1).min(cells - 1) };
    let share = (place as f32 + 0.5) / factor as f32 + if before { 0.5 } else { -0.5 };
    ([first as usize, second as usize], [1.0 - share, share])
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod spike_tests;

#[cfg(test)]
mod ghost_tests;
