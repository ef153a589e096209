// SPDX-License-Identifier: MIT OR Apache-2.0
//! The beam of a telescope: a Gaussian that the whole frame's light is spread by, as the images of the Event Horizon
//! Telescope are. This file says on which grid of the bloom it is done and by which shares, and does it on the CPU;
//! `shaders/bloom/beam.wgsl` does the same with these numbers. Knows cells and their light, not how they were gathered.
//!
//! The grids spread light by nearly Gaussian splines already. The beam takes the coarsest one that leaves enough to
//! do, and spreads its cells by a Gaussian of the variance that is missing, row by row and column by column. A beam
//! that is narrower than the finest grid's own spread mixes that with the light as it was, in shares that give its
//! variance.

use super::{GRIDS, sigma};
use crate::allocate::filled;
use crate::error::Result;
use crate::parallel::prelude::*;

/// Full width at half maximum over the standard deviation: sqrt(8 ln 2).
const FWHM: f64 = 2.354_820_045_030_949;
/// The least standard deviation that is left to a grid, in its cells: with less, its splines would show.
const LEAST_SPREAD: f64 = 1.5;
/// The shares of a cell's light: what stays, and what goes to each of so many cells further on, on each side. The
/// standard deviation is at most 3.5 cells.
pub const BEAM_SHARES: usize = 16;

/// The beam of a frame.
#[derive(Clone, Debug)]
pub struct Beam {
    /// The level whose cells are spread.
    pub level: usize,
    /// Half the part of the light that stays in its cell; the part that goes to each neighbour, to each one further on,
    /// and so on: so the light of every two cells at the same distance is summed alike.
    pub shares: [f32; BEAM_SHARES],
    /// The part of all light that goes through the grids; 1 but for the narrowest beams.
    pub(super) through: f64,
}

impl Beam {
    /// `fwhm`: full width at half maximum, in pixels; `levels`: how many there are, one or more.
    pub(super) fn new(fwhm: f64, factor: u32, levels: usize) -> Self {
        let variance = (fwhm / FWHM).powi(2);
        let own = |level: usize| sigma(factor, level).powi(2);
        let missing = |level: usize| (variance - own(level)) / (f64::from(factor) * (level as f64).exp2()).powi(2);
        let enough = |level: &usize| missing(*level) >= LEAST_SPREAD * LEAST_SPREAD;
        let level = (0..levels).rev().find(enough).unwrap_or(0);
        Self { level, shares: shares(missing(level).max(0.0)), through: (variance / own(0)).min(1.0) }
    }

    /// The cells of a grid of `size` after the beam. On the current pool. Errors: OUT_OF_MEMORY.
    pub(super) fn spread(&self, mut cells: Vec<[f32; 4]>, [width, height]: [u32; 2]) -> Result<Vec<[f32; 4]>> {
        let (width, height) = (width as usize, height as usize);
        let mut rows = filled(cells.len(), [0.0; 4], GRIDS)?;
        rows.par_chunks_mut(width).zip(cells.par_chunks(width)).for_each(|(out, row)| {
            out.iter_mut().enumerate().for_each(|(x, out)| *out = self.at(x, width, |x| row[x]));
        });
        cells.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
            out.iter_mut().enumerate().for_each(|(x, out)| *out = self.at(y, height, |y| rows[y * width + x]));
        });
        Ok(cells)
    }

    /// The light at cell `i` of a row of `count`.
    fn at(&self, i: usize, count: usize, light: impl Fn(usize) -> [f32; 4]) -> [f32; 4] {
        let mut sum = [0.0; 4];
        for (away, share) in (0_i64..).zip(self.shares) {
            let both = [i as i64 - away, i as i64 + away].map(|i| light(mirrored(i, count)));
            (0..4).for_each(|c| sum[c] += share * (both[0][c] + both[1][c]));
        }
        sum
    }
}

/// The cell that stands for cell `i` beyond a row's ends, which mirror it.
fn mirrored(i: i64, count: usize) -> usize {
    let count = count as i64;
    let turn = i.rem_euclid(2 * count);
    (if turn < count { turn } else { 2 * count - 1 - turn }) as usize
}

/// Shares of this variance: of a Gaussian at the cells' centres, whose variance they have to 1e-3 from `LEAST_SAMPLED`
/// on; below that of the cell and its neighbours, which have it exactly.
fn shares(variance: f64) -> [f32; BEAM_SHARES] {
    const LEAST_SAMPLED: f64 = 0.35;
    let mut shares = [0.0; BEAM_SHARES];
    if variance < LEAST_SAMPLED {
        (shares[0], shares[1]) = (0.5 * (1.0 - variance), 0.5 * variance);
    } else {
        shares = std::array::from_fn(|away| (-0.5 * (away as f64).powi(2) / variance).exp());
        shares[0] *= 0.5;
    }
    let sum = 2.0 * shares.iter().sum::<f64>();
    shares.map(|share| (share / sum) as f32)
}
