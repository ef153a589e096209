//! Bloom: the glare that scattered light makes around bright things. This file says which share of a frame's light goes
//! how far, makes the grids that spread it, and spreads it on the CPU; `shaders/bloom*.wgsl` and `src/gpu/bloom.rs` do
//! the same with these numbers. Works on exposed light
//! ([`FilmParams::exposed_light`](super::FilmParams::exposed_light)); knows nothing of how that light was made, or of
//! 8-bit pixels.
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

use crate::allocate::{collected, filled, with_room};
use crate::error::Result;
use crate::image::PixelFormat;
use crate::scene::{Film, Scene, View};
use rayon::prelude::*;

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
    /// Whether a frame of this kind has any.
    pub fn is_shown(film: &Film, view: View, format: PixelFormat) -> bool {
        film.bloom > 0.0 && view == View::Light && format.is_8bit()
    }

    /// The bloom of a whole frame; `None`: it has none. Errors: OUT_OF_MEMORY.
    pub fn new(scene: &Scene, format: PixelFormat, frame: [u32; 2]) -> Result<Option<Self>> {
        Self::is_shown(&scene.film, scene.view, format).then(|| Self::of(scene.film.bloom, frame)).transpose()
    }

    /// Makes the grids for `bloom` in [0, 1] and a frame of at least one pixel. Errors: OUT_OF_MEMORY.
    pub fn of(bloom: f64, frame: [u32; 2]) -> Result<Self> {
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
        Ok(Self { frame, factor, direct: (1.0 - scattered * (1.0 - narrow)) as f32, levels })
    }

    /// The factor on the light of level `index`: its weight if it is the coarsest; else 1, because its light comes
    /// weighted already.
    pub fn weight_above(&self, index: usize) -> f32 {
        match self.levels.get(index) {
            Some(last) if index + 1 == self.levels.len() => last.weight,
            _ => 1.0,
        }
    }

    /// How the frame's light is gathered for the finest grid. Errors: OUT_OF_MEMORY.
    pub fn gathering(&self) -> Result<Gathering<'_>> {
        let cells = self.levels.first().map_or(0, |base| base.cells());
        Ok(Gathering { bloom: self, base: filled(cells, [0.0; 4], GRIDS)? })
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
    fn taken(&self, fine: &[[f32; 4]], [width, height]: [u32; 2]) -> Result<Vec<[f32; 4]>> {
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
pub struct Gathering<'a> {
    bloom: &'a Bloom,
    base: Vec<[f32; 4]>,
}

impl<'a> Gathering<'a> {
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

    /// Once all tiles are in: spreads their light. On the current pool. Errors: OUT_OF_MEMORY.
    pub fn spread(self) -> Result<Glare<'a>> {
        let Self { bloom, base } = self;
        let mut grids = vec![base];
        for pair in bloom.levels.windows(2) {
            if let ([finer, level], Some(grid)) = (pair, grids.last()) {
                let taken = level.taken(grid, finer.size)?;
                grids.push(taken);
            }
        }
        let mut glare = grids.pop().unwrap_or_default();
        for (index, grid) in grids.into_iter().enumerate().rev() {
            glare = bloom.joined(index, grid, &glare);
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
    /// The light that level `index` and those above it spread, on its grid: its own light times its weight, and theirs.
    fn joined(&self, index: usize, mut own: Vec<[f32; 4]>, above: &[[f32; 4]]) -> Vec<[f32; 4]> {
        let (Some(level), Some(coarser)) = (self.levels.get(index), self.levels.get(index + 1)) else { return own };
        let factor = self.weight_above(index + 1);
        own.par_chunks_mut(level.size[0] as usize).enumerate().for_each(|(y, row)| {
            let (rows, down) = returned(y, coarser.size[1]);
            for (x, cell) in row.iter_mut().enumerate() {
                let (columns, across) = returned(x, coarser.size[0]);
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
fn returned(i: usize, coarser: u32) -> ([usize; 3], [f32; 3]) {
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
mod tests {
    use super::*;

    type Field = Vec<[f32; 4]>;

    fn black([width, height]: [u32; 2]) -> Field {
        vec![[0.0; 4]; (width * height) as usize]
    }

    /// A field with its bloom, gathered in tiles of at most `tile` pixels.
    fn bloomed(bloom: &Bloom, light: &Field, tile: [u32; 2]) -> Field {
        let [width, height] = bloom.frame;
        let mut gathering = bloom.gathering().expect("a grid");
        for y in (0..height).step_by(tile[1] as usize) {
            for x in (0..width).step_by(tile[0] as usize) {
                let (w, h) = (tile[0].min(width - x), tile[1].min(height - y));
                let row = |row: u32| ((row * width + x) as usize)..((row * width + x + w) as usize);
                gathering.add([x, y], w, &(y..y + h).flat_map(|y| light[row(y)].to_vec()).collect::<Field>());
            }
        }
        let glare = gathering.spread().expect("grids");
        let place = |i: usize| (i as u32 % width, i as u32 / width);
        light.iter().enumerate().map(|(i, v)| glare.over(*v, place(i).0, place(i).1)).collect()
    }

    fn sum(field: &Field) -> f64 {
        field.iter().map(|v| f64::from(v[0])).sum()
    }

    /// One bright pixel and the light that it gives the others: the field without the light that is left in the pixel.
    fn point(bloom: &Bloom, [x, y]: [u32; 2]) -> Field {
        let mut light = black(bloom.frame);
        let at = (y * bloom.frame[0] + x) as usize;
        light[at] = [1e4; 4];
        let mut out = bloomed(bloom, &light, bloom.frame);
        out[at][0] -= 1e4 * bloom.direct;
        out
    }

    /// Mean of the light at `radius` from a pixel, and its standard deviation over it, each times r^2 / formula.
    fn ring(field: &Field, width: u32, [x, y]: [u32; 2], radius: f64, formula: impl Fn(f64) -> f64) -> (f64, f64) {
        let places = field.iter().enumerate().map(|(i, v)| {
            let (dx, dy) = ((i as u32 % width) as f64 - f64::from(x), (i as u32 / width) as f64 - f64::from(y));
            (dx.hypot(dy), f64::from(v[0]))
        });
        let on = places.filter(|(r, _)| (r - radius).abs() < 0.5).map(|(r, v)| v / formula(r)).collect::<Vec<_>>();
        let mean = on.iter().sum::<f64>() / on.len() as f64;
        let variance = on.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / on.len() as f64;
        (mean, variance.sqrt() / mean)
    }

    #[test]
    fn no_light_is_lost_or_made_wherever_it_lies() {
        for frame in [[1, 1], [2, 1], [7, 5], [64, 64], [101, 67], [333, 17], [1, 200], [640, 361]] {
            let bloom = Bloom::of(1.0, frame).expect("grids");
            let shares = f64::from(bloom.direct) + bloom.levels.iter().map(|l| f64::from(l.weight)).sum::<f64>();
            assert!((shares - 1.0).abs() < 1e-6, "{frame:?}: {shares}");
            let ends = |side: u32| [0, 1, side / 2, side.saturating_sub(3), side.saturating_sub(2), side - 1];
            for (x, y) in ends(frame[0]).into_iter().flat_map(|x| ends(frame[1]).map(move |y| (x, y))) {
                let mut light = black(frame);
                light[(y.min(frame[1] - 1) * frame[0] + x.min(frame[0] - 1)) as usize] = [1000.0; 4];
                let got = sum(&bloomed(&bloom, &light, frame));
                assert!((got - 1000.0).abs() < 0.1, "{frame:?} ({x}, {y}): {got}");
            }
        }
    }

    #[test]
    fn an_even_frame_stays_even() {
        for frame in [[5, 3], [129, 67], [640, 361]] {
            let out = bloomed(
                &Bloom::of(1.0, frame).expect("grids"),
                &vec![[0.5, 0.25, 2.0, 0.75]; (frame[0] * frame[1]) as usize],
                frame,
            );
            for v in out {
                assert!(
                    (0..3).all(|c| (v[c] / [0.5, 0.25, 2.0][c] - 1.0).abs() < 1e-5) && v[3] == 0.75,
                    "{frame:?}: {v:?}"
                );
            }
        }
    }

    #[test]
    fn light_falls_as_the_formula_says_and_alike_in_all_directions() {
        for height in [360, 1080] {
            let h = f64::from(height);
            let bloom = Bloom::of(1.0, [height, height]).expect("grids");
            let formula = |r: f64| {
                let q = r * r + (h / 180.0).powi(2);
                q.powf(-1.5) + 28.0 / (h * q)
            };
            for place in [[180, 180], [181, 183], [height / 2 + 4, height / 2 - 7]] {
                let glare = point(&bloom, place);
                let radii = [10.0, 12.0, 16.0, 20.0, 22.0, 30.0, 45.0, 60.0];
                let radii = radii.into_iter().filter(|r| *r <= h / 16.0);
                let rings = radii.map(|r| (r, ring(&glare, height, place, r, formula))).collect::<Vec<_>>();
                let mean = rings.iter().map(|(_, (mean, _))| mean).sum::<f64>() / rings.len() as f64;
                for (r, (ratio, spread)) in &rings {
                    println!("{height} {place:?} r {r}: {:.3} of the formula, {:.3} around", ratio / mean, spread);
                    assert!(
                        (ratio / mean - 1.0).abs() < 0.1 && *spread < 0.05,
                        "{height} {place:?} {r}: {ratio} {spread}"
                    );
                }
                let shape = (0..=height / 3).step_by(2).map(|r| ring(&glare, height, place, r.into(), |_| 1.0).0);
                let shape = shape.skip(1).collect::<Vec<_>>();
                assert!(shape.windows(2).all(|pair| pair[1] < pair[0]), "{height} {place:?} rises");
            }
        }
    }

    /// The glare of a lone light has no edges: along a row its second differences change their sign where a smooth
    /// bump's do.
    #[test]
    fn no_blocks_show() {
        let bloom = Bloom::of(1.0, [512, 512]).expect("grids");
        let glare = point(&bloom, [257, 251]);
        for y in [251_usize, 280, 330] {
            let row = glare[y * 512..(y + 1) * 512].iter().map(|v| f64::from(v[0])).collect::<Vec<_>>();
            let steps = row.windows(2).map(|p| p[1] - p[0]).collect::<Vec<_>>();
            for (x, pair) in steps.windows(2).enumerate().filter(|(x, _)| x.abs_diff(256) > 8) {
                let nearby = &steps[x.saturating_sub(8)..(x + 8).min(steps.len())];
                let largest = nearby.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                assert!((pair[1] - pair[0]).abs() < 0.45 * largest, "a crease at ({x}, {y}): {pair:?} of {largest}");
            }
        }
    }

    /// A spot of two pixels' width that moves by sixteenths of a pixel.
    #[test]
    fn glare_moves_smoothly_with_its_light() {
        let bloom = Bloom::of(1.0, [256, 256]).expect("grids");
        let frame = |shift: f64| {
            let mut light = black([256, 256]);
            for (i, v) in light.iter_mut().enumerate() {
                let (dx, dy) = ((i % 256) as f64 - 120.0 - shift, (i / 256) as f64 - 131.0);
                *v = [(100.0 * (-0.5 * (dx * dx + dy * dy)).exp()) as f32; 4];
            }
            bloomed(&bloom, &light, [256, 256])
        };
        let mut before = frame(0.0);
        for i in 1..=32 {
            let now = frame(f64::from(i) / 16.0);
            for y in [140, 150, 170] {
                for x in [121_usize, 140, 180] {
                    let [a, b] = [&before, &now].map(|f| f64::from(f[y * 256 + x][0]));
                    assert!((b / a - 1.0).abs() < 0.02, "step {i} at ({x}, {y}): {a} then {b}");
                }
            }
            before = now;
        }
    }

    #[test]
    fn tiles_do_not_show() {
        let frame = [203, 77];
        let bloom = Bloom::of(0.7, frame).expect("grids");
        let light = (0..frame[0] * frame[1]).map(|i| [(i * 7919 % 1013) as f32; 4]).collect::<Field>();
        let whole = bloomed(&bloom, &light, frame);
        for tile in [[64, 9], [1, 77], [203, 1], [50, 50]] {
            for (a, b) in whole.iter().zip(bloomed(&bloom, &light, tile)) {
                assert!((a[0] - b[0]).abs() <= 1e-5 * a[0], "{tile:?}: {a:?} {b:?}");
            }
        }
    }

    /// A coarser finest grid, as frames of more than 2^21 cells have: the same glare, but for what is smaller than its
    /// cells.
    #[test]
    fn the_finest_grid_is_bounded_and_glare_hardly_depends_on_it() {
        for frame in [[3840, 2160], [7680, 4320], [16384, 16384], [1 << 14, 1], [1 << 20, 1], [7, 1 << 20]] {
            let bloom = Bloom::of(0.5, frame).expect("grids");
            assert!(bloom.levels[0].cells() as u64 <= MOST_CELLS && bloom.factor.is_multiple_of(2), "{frame:?}");
            assert!(bloom.levels[0].size.iter().all(|&side| u64::from(side) <= MOST_SIDE + 2), "{frame:?}");
        }
        let bloom = Bloom::of(1.0, [7680, 4320]).expect("grids");
        assert_eq!(bloom.factor, 4);
        let light = |w: &Bloom| w.levels.iter().map(|l| l.weight).sum::<f32>();
        assert!((light(&bloom) - light(&Bloom::of(1.0, [3840, 2160]).expect("grids"))).abs() < 0.002);
    }

    #[test]
    fn no_bloom_where_there_is_none() {
        let mut scene = Scene::default();
        let shown = |scene: &Scene, format| Bloom::new(scene, format, [64, 64]).expect("grids").is_some();
        assert!(!shown(&scene, PixelFormat::Rgba8Srgb));
        scene.film.bloom = 0.1;
        assert!(shown(&scene, PixelFormat::Rgba8Srgb) && shown(&scene, PixelFormat::Bgra8Srgb));
        assert!(!shown(&scene, PixelFormat::Rgba16F) && !shown(&scene, PixelFormat::Rgba32F));
        scene.view = View::Order;
        assert!(!shown(&scene, PixelFormat::Rgba8Srgb));
    }
}
