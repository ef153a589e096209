// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light that a lens throws along lines: the diffraction spikes of an aperture's blades, and the streak of an
//! anamorphic lens. This file says which lines there are and how light falls along them, and spreads it on the CPU;
//! `shaders/bloom/spikes.wgsl` does the same with these numbers. Knows cells and their light, not how they were
//! gathered.
//!
//! A straight edge diffracts light along its normal, to both sides, with an intensity that falls as 1/x^2 on average
//! and stretches with the wavelength (J. Komrska, J. Opt. Soc. Am. 72, 1382, 1982: the aperture's Fourier transform is
//! a sum over its edges): n blades make n spikes where n is even, as opposite edges share their line, and 2n where it
//! is odd. A cylindrical element's streak is one line, whatever the aperture.
//!
//! How: along a line light spreads by K(x) = sum over k of w_k exp(-|x| / l_k) / (2 l_k), l_k = l / 4^k, which two
//! recursions for each k compute exactly, one in each direction. A line is a shear of the finest grid: its cells are
//! summed along it, each shared between the rows about it, in elements of a few cells, and elements give light back to
//! cells by the same shares. Light that K would carry out of the frame stays where it is. So the whole is symmetric: no
//! light is lost or made, and an even frame stays even.
//!
//! A cell gives its light to the three nearest rows by the quadratic B-spline of its distance from them, whose variance
//! does not depend on where between rows it lies, so that spikes do not ripple. Across it a spike's deviation, with
//! that of the finest grid, is sqrt(1.5 + 2 cos^2 a) pixels at 2 pixels a cell, a its angle to the nearest axis.

use super::{GRIDS, MOST_SCATTERED};
use crate::allocate::filled;
use crate::error::Result;
use crate::parallel::prelude::*;
use crate::scene::Optics;

/// The exponentials that a line's kernel is made of, and how much shorter each is than the one before.
pub const SPIKE_TERMS: usize = 4;
const SHORTER: f64 = 4.0;
/// The most elements along a line, so that a workgroup holds them.
pub const SPIKE_ELEMENTS: u32 = 1024;
/// The share of all light that `spikes` = 1 takes, and `streak` = 1: that of `bloom`.
const MOST_THROWN: f64 = MOST_SCATTERED;
/// Wavelengths of the primaries of Rec. 709 over that of green: 611, 549 and 464 nm.
const STRETCH: [f64; 3] = [611.0 / 549.0, 1.0, 464.0 / 549.0];
/// The shares that red, green and blue keep of a streak whose tint is 1.
const BLUE: [f64; 3] = [0.12, 0.45, 1.0];
/// Parts of a cell that a line's offset is counted in.
const PARTS: f32 = 65536.0;

/// The lines of a frame.
#[derive(Clone, Debug)]
pub struct Spikes {
    /// At least one.
    pub lines: Vec<SpikeLine>,
}

/// A line through every cell: `SpikeLine` of bloom/spikes.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SpikeLine {
    /// The kernel's values at 0 for red, green and blue, by exponential.
    pub weights: [[f32; 4]; SPIKE_TERMS],
    /// The factor by which each exponential falls from an element to the next.
    pub decays: [f32; SPIKE_TERMS],
    /// The part of the last cells of a row and of a column that lies in the frame, the very last one last.
    pub tails: [[f32; 4]; 2],
    /// Cells of the grid along the line's axis, and across.
    pub along: u32,
    pub across: u32,
    /// Cells across from one cell along to the next, in 65536 parts; at most one cell.
    pub slope: i32,
    /// 1: the axis is the grid's columns; 0: its rows.
    pub steep: u32,
    /// Cells along the axis that make an element.
    pub step: u32,
    /// Elements along the axis.
    pub elements: u32,
    /// The first row of the sheared grid, and how many there are.
    pub first_row: i32,
    pub rows: u32,
    /// Between neighbouring elements along and across, in the memory that holds a line's light.
    pub next_along: u32,
    pub next_across: u32,
    /// The share of the light of red, green and blue that the line takes; all the same.
    pub share: f32,
    /// The factor on what the grid had before.
    pub above: f32,
}

impl Spikes {
    /// The share of all light that a lens throws along lines.
    pub(super) fn share(optics: &Optics) -> f64 {
        MOST_THROWN * (optics.spikes + optics.streak)
    }

    /// `None`: the lens has none. `cells`: the finest grid, of cells of `factor` pixels; `tails`: of its last cells;
    /// `height`: of the frame in pixels; `above`: the factor on what the grid spreads already.
    pub(super) fn new(
        optics: &Optics,
        (cells, tails): ([u32; 2], [[f32; 4]; 2]),
        factor: u32,
        height: u32,
        above: f32,
    ) -> Option<Self> {
        let (spikes, streak) = (MOST_THROWN * optics.spikes, MOST_THROWN * optics.streak);
        let blades = optics.blades();
        let count = if blades.is_multiple_of(2) { blades / 2 } else { blades };
        let cells_a_height = f64::from(height) / f64::from(factor);
        let mut lines = Vec::new();
        let mut add = |angle: f64, length: f64, share: f64, colours: [[f64; 3]; SPIKE_TERMS]| {
            let above = if lines.is_empty() { above } else { 1.0 };
            lines.push(SpikeLine::new((cells, tails), (angle, length * cells_a_height), (share, colours), above));
        };
        if spikes > 0.0 {
            let colours = spike_colours();
            for line in 0..count {
                let turn = f64::from(line) / f64::from(count);
                let angle = optics.spike_angle + std::f64::consts::PI * (turn + 0.5);
                add(angle, optics.spike_length, spikes / f64::from(count), colours);
            }
        }
        if streak > 0.0 {
            add(0.0, optics.streak_length, streak, streak_colours(optics.streak_tint));
        }
        (!lines.is_empty()).then_some(Self { lines })
    }

    /// Adds the light of all lines to what the grid spreads already. `own`: the light of its cells. On the current
    /// pool. Errors: OUT_OF_MEMORY.
    pub(super) fn add_to(&self, spread: &mut [[f32; 4]], own: &[[f32; 4]]) -> Result<()> {
        for line in &self.lines {
            line.add_to(spread, own)?;
        }
        Ok(())
    }

    /// The most numbers of four that the light of a line takes.
    pub fn memory(&self) -> u64 {
        let numbers = self.lines.iter().map(|line| u64::from(line.elements) * u64::from(line.stored_rows()));
        numbers.max().unwrap_or(0)
    }
}

/// The part of a spike's light that each exponential has, by colour: in green 1 / l_k of the sum, so that the kernel
/// falls as 1/x^2. A kernel that is stretched by s has s times as much light far out; the shortest has the rest.
fn spike_colours() -> [[f64; 3]; SPIKE_TERMS] {
    let near = |k: usize| SHORTER.powi(k as i32);
    let sum = (0..SPIKE_TERMS).map(near).sum::<f64>();
    let mut colours = [[0.0; 3]; SPIKE_TERMS];
    for (k, colour) in colours.iter_mut().enumerate().take(SPIKE_TERMS - 1) {
        *colour = STRETCH.map(|stretch| stretch * near(k) / sum);
    }
    let rest: [f64; 3] = std::array::from_fn(|c| 1.0 - colours.iter().map(|colour| colour[c]).sum::<f64>());
    colours[SPIKE_TERMS - 1] = rest;
    colours
}

/// The part of a streak's light that each exponential has, by colour; what a tint takes stays where it is.
fn streak_colours(tint: f64) -> [[f64; 3]; SPIKE_TERMS] {
    let kept = if tint < 0.0 { [BLUE[2], BLUE[1], BLUE[0]] } else { BLUE };
    let colour = kept.map(|kept| 1.0 + tint.abs() * (kept - 1.0));
    [colour.map(|part| part / SPIKE_TERMS as f64); SPIKE_TERMS]
}

impl SpikeLine {
    /// `angle`: anticlockwise from the picture's right; `length` of the longest exponential, in cells; `share` of all
    /// light, and the part of it that each exponential has by colour.
    fn new(
        (cells, tails): ([u32; 2], [[f32; 4]; 2]),
        (angle, length): (f64, f64),
        (share, colours): (f64, [[f64; 3]; SPIKE_TERMS]),
        above: f32,
    ) -> Self {
        // Rows count downwards.
        let (y, x) = (-angle).sin_cos();
        let steep = y.abs() > x.abs();
        let slope = if steep { x / y } else { y / x };
        let [along, across] = if steep { [cells[1], cells[0]] } else { cells };
        let step = along.div_ceil(SPIKE_ELEMENTS);
        let slope_parts = (slope * f64::from(PARTS)).round() as i32;
        let mut line = Self {
            weights: [[0.0; 4]; SPIKE_TERMS],
            decays: [0.0; SPIKE_TERMS],
            tails,
            along,
            across,
            slope: slope_parts,
            steep: u32::from(steep),
            step,
            elements: along.div_ceil(step),
            first_row: 0,
            rows: 0,
            next_along: 1,
            next_across: 1,
            share: share as f32,
            above,
        };
        let last = line.whole_rows(along - 1);
        (line.first_row, line.rows) = (-1 - last.max(0), across + 2 + last.unsigned_abs());
        // Threads that read go along the grid's rows.
        if steep {
            line.next_along = line.stored_rows();
        } else {
            line.next_across = line.elements;
        }
        let element = f64::from(step) * slope.hypot(1.0);
        for (k, colour) in colours.iter().enumerate() {
            let decay = (-element * SHORTER.powi(k as i32) / length).exp();
            // The sum of all powers, in both directions, over cells.
            let sum = (1.0 + decay) / (1.0 - decay) * f64::from(step);
            line.decays[k] = decay as f32;
            line.weights[k][..3].copy_from_slice(&colour.map(|part| (share * part / sum) as f32));
        }
        line
    }

    /// Rows across that are kept of every element.
    fn stored_rows(&self) -> u32 {
        self.across + 2 * self.step + 2
    }

    /// The rows that cell `j` along the axis lies beyond the first one's: the nearest whole number.
    fn whole_rows(&self, j: u32) -> i32 {
        (self.slope * j as i32 + (1 << 15)) >> 16
    }

    /// The shares that the row before that, it, and the next have of cell `j`.
    fn row_shares(&self, j: u32) -> [f32; 3] {
        let beyond = (self.slope * j as i32 - (self.whole_rows(j) << 16)) as f32 / PARTS;
        let (before, after) = (0.5 - beyond, 0.5 + beyond);
        [0.5 * before * before, 0.75 - beyond * beyond, 0.5 * after * after]
    }

    /// The number of the cell `j` along and `i` across.
    fn cell(&self, j: u32, i: u32) -> usize {
        (if self.steep == 1 { j * self.across + i } else { i * self.along + j }) as usize
    }

    /// The part of a cell that lies in the frame.
    fn coverage(&self, j: u32, i: u32) -> f32 {
        let [along, across] = if self.steep == 1 { [self.tails[1], self.tails[0]] } else { self.tails };
        let part = |tail: [f32; 4], from_end: u32| if from_end < 4 { tail[3 - from_end as usize] } else { 1.0 };
        part(along, self.along - 1 - j) * part(across, self.across - 1 - i)
    }

    /// The light, and the cells, that an element of a sheared row takes.
    fn element_light(&self, own: &[[f32; 4]], element: u32, row: i32) -> [f32; 4] {
        let mut sum = [0.0; 4];
        for j in (element * self.step)..((element + 1) * self.step).min(self.along) {
            for (i, share) in (row + self.whole_rows(j) - 1..).zip(self.row_shares(j)) {
                let Some(i) = u32::try_from(i).ok().filter(|i| *i < self.across) else { continue };
                let covered = share * self.coverage(j, i);
                let light = own[self.cell(j, i)];
                (0..3).for_each(|c| sum[c] += covered * light[c]);
                sum[3] += covered;
            }
        }
        sum
    }

    /// The light of a sheared row's elements after they have spread it along the line.
    fn spread_row(&self, elements: &[[f32; 4]], out: &mut [[f32; 3]]) {
        let mut kept = vec![[0.0_f32; 3]; elements.len()];
        let mut back = vec![[0.0_f32; 4]; elements.len()];
        out.fill([0.0; 3]);
        for (decay, weights) in self.decays.iter().zip(&self.weights) {
            let next = |sum: [f32; 4], light: &[f32; 4]| std::array::from_fn(|c| light[c] + decay * sum[c]);
            let mut sum = [0.0; 4];
            for (back, light) in back.iter_mut().zip(elements).rev() {
                *back = sum;
                sum = next(sum, light);
            }
            sum = [0.0; 4];
            for (((out, kept), light), back) in out.iter_mut().zip(&mut kept).zip(elements).zip(&back) {
                sum = next(sum, light);
                for c in 0..3 {
                    out[c] += weights[c] * (sum[c] + decay * back[c]);
                    kept[c] += weights[c] * (sum[3] + decay * back[3]);
                }
            }
        }
        // Light that would leave the frame stays, by the light of a whole cell.
        for ((out, kept), light) in out.iter_mut().zip(&kept).zip(elements).filter(|(_, light)| light[3] > 0.0) {
            (0..3).for_each(|c| out[c] += (self.share - kept[c]) * light[c] / light[3]);
        }
    }

    fn add_to(&self, spread: &mut [[f32; 4]], own: &[[f32; 4]]) -> Result<()> {
        let (elements, count) = (self.elements, self.elements as usize);
        let mut sheared = filled(count * self.rows as usize, [0.0_f32; 3], GRIDS)?;
        sheared.par_chunks_mut(count).zip(self.first_row..self.first_row + self.rows as i32).for_each(|(out, row)| {
            let light = (0..elements).map(|element| self.element_light(own, element, row)).collect::<Vec<_>>();
            self.spread_row(&light, out);
        });
        let light = |element: u32, row: i32| {
            let row = usize::try_from(row - self.first_row).ok().filter(|row| *row < self.rows as usize);
            row.map_or([0.0; 3], |row| sheared[row * count + element as usize])
        };
        let width = if self.steep == 1 { self.across } else { self.along };
        spread.par_chunks_mut(width as usize).enumerate().for_each(|(y, cells)| {
            for (cell, x) in cells.iter_mut().zip(0_u32..) {
                let [j, i] = if self.steep == 1 { [y as u32, x] } else { [x, y as u32] };
                let (row, shares) = (i as i32 - self.whole_rows(j), self.row_shares(j));
                let from = [row + 1, row, row - 1].map(|row| light(j / self.step, row));
                for c in 0..3 {
                    let sum = shares.iter().zip(from).map(|(share, light)| share * light[c]).sum::<f32>();
                    cell[c] = self.above * cell[c] + sum;
                }
            }
        });
        Ok(())
    }
}
