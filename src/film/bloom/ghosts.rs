// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lens flare: the ghosts that light makes which is reflected twice between the surfaces of a lens. This file says
//! where they lie, how large and of which colour they are, and draws them on the CPU; `shaders/bloom/ghosts.wgsl` does
//! the same with these numbers. Knows cells and their light, not how they were gathered.
//!
//! To first order in the angles, as matrices of paraxial optics have it, such light arrives as an image of the
//! aperture, out of focus, whose centre lies on the line from the light's own image through the middle of the frame, at
//! a multiple of its distance that the two surfaces give (M. Hullin, E. Eisemann, H.-P. Seidel, S. Lee, ACM Trans.
//! Graph. 30, 108, 2011; S. Lee, E. Eisemann, Comput. Graph. Forum 32, 1, 2013: a ghost is an affine map of the
//! aperture). Coatings reflect what they do not transmit, so that each ghost has a colour of its own. The ghosts here
//! are those of no particular lens: their magnifications, sizes and colours are chosen within the range that these
//! papers show. None reaches out of the frame, and together they are neutral. Light from near the frame's border meets
//! the lens's barrel on its way to and fro and is lost: ghosts of wide lights would else end in an image of the border,
//! which no lens knows. A telescope's beam does not blur ghosts.
//!
//! How: the light of one of the coarser grids, a few dozen rows, is gathered through the aperture's polygon, which
//! falls off linearly at its edges, on a grid of a few hundred rows; that is added to what the finest grid spreads.

use crate::allocate::filled;
use crate::error::Result;
use crate::parallel::prelude::*;
use crate::scene::Optics;
use crate::scene::film::MOST_GHOSTS;
use std::f64::consts::PI;

/// The share of all light that `flare` = 1 takes.
const MOST_REFLECTED: f64 = 0.15;
/// Pairs of normals of an aperture of eight blades, the most.
pub const GHOST_PAIRS: usize = 4;
/// The most rows of the grid whose light is reflected, and of that on which ghosts are drawn.
const MOST_SOURCE_ROWS: u32 = 96;
const MOST_TARGET_ROWS: u32 = 288;
/// The width over which a ghost's edge falls off, in cells of the target, at least.
const LEAST_SOFTNESS: f64 = 2.0;
/// The least radius of a ghost, in widths of its edge: smaller ones would have no even middle.
const LEAST_RADIUS: f64 = 0.75;
/// By how much red ghosts are wider than green ones, and blue ones narrower.
const DISPERSION: f64 = 0.02;

/// Magnification, radius of a circle of the same area in frame heights, and colour. For each, |magnification| + 2 *
/// 1.56 radius <= 1, so that a triangle, the aperture that reaches furthest, stays in the frame.
const GHOSTS: [(f64, f64, [f64; 3]); MOST_GHOSTS as usize] = [
    (-0.38, 0.050, [1.0, 0.72, 0.42]),
    (0.52, 0.028, [0.42, 0.90, 0.60]),
    (-0.70, 0.075, [0.48, 0.62, 1.0]),
    (0.24, 0.018, [1.0, 0.52, 0.80]),
    (-0.16, 0.030, [0.60, 1.0, 0.85]),
    (-0.88, 0.035, [0.95, 0.60, 0.50]),
    (0.76, 0.060, [0.55, 0.75, 1.0]),
    (-0.54, 0.014, [0.80, 1.0, 0.60]),
];

/// The name of this memory in out-of-memory errors.
const GHOST_GRID: &str = "the ghosts of a lens";

/// The size of a grid in cells, and the part that lies in the frame of the last cells of a row and of a column, the
/// very last one last.
pub(super) type Grid = ([u32; 2], [[f32; 4]; 2]);

/// The ghosts of a frame.
#[derive(Clone, Debug)]
pub struct Ghosts {
    /// The level whose light is reflected, and the one on whose grid ghosts are drawn.
    pub source: usize,
    pub target: usize,
    pub numbers: GhostNumbers,
}

/// `GhostNumbers` of bloom/flare.wgsl. Lengths are in cells of the target.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GhostNumbers {
    pub ghosts: [Ghost; MOST_GHOSTS as usize],
    /// Unit normals of the aperture's edges, two in each. Those beyond the blades are 0, as no place lies on the inner
    /// side of all edges' parallels through the middle.
    pub normals: [[f32; 4]; GHOST_PAIRS],
    /// The part of the source's last cells of a row and of a column that lies in the frame, the very last one last.
    pub tails: [[f32; 4]; 2],
    /// The frame's middle.
    pub middle: [f32; 2],
    /// The sizes of both grids, in their cells.
    pub target_cells: [u32; 2],
    pub source_cells: [u32; 2],
    /// The side of a source's cell.
    pub step: f32,
    /// How many ghosts there are.
    pub count: u32,
    /// The part of a target's cell that a cell of the finest grid is wide.
    pub fine: f32,
    /// The factor on what the finest grid had before.
    pub above: f32,
    pub reserved: [u32; 2],
}

/// A ghost: `Ghost` of bloom/flare.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Ghost {
    /// The share of a source's cell's light that a target's cell gets within the ghost, by colour.
    pub shares: [f32; 4],
    /// From the ghost's middle to its edges, by colour, where the fall-off is half.
    pub apothems: [f32; 4],
    pub magnification: f32,
    /// The width over which the edges fall off.
    pub softness: f32,
    /// From the ghost's middle to its furthest corner.
    pub reach: f32,
    pub reserved: f32,
}

impl Ghosts {
    /// The share of all light that a lens reflects into ghosts.
    pub(super) fn share(optics: &Optics) -> f64 {
        MOST_REFLECTED * optics.flare
    }

    /// The level whose light is reflected, by the rows of all levels.
    pub(super) fn source_of(rows: impl ExactSizeIterator<Item = u32>) -> usize {
        level_of(rows, MOST_SOURCE_ROWS)
    }

    /// `None`: the lens has none. `levels` of a `frame` in pixels, the finest with cells of `factor` pixels; `above`:
    /// the factor on what the finest grid spreads already.
    pub(super) fn new(optics: &Optics, levels: &[Grid], factor: u32, frame: [u32; 2], above: f32) -> Option<Self> {
        let share = Self::share(optics);
        let rows = || levels.iter().map(|(size, _)| size[1]);
        let (source, target) = (Self::source_of(rows()), level_of(rows(), MOST_TARGET_ROWS));
        let ((from, tails), (to, _)) = levels.get(source).zip(levels.get(target)).filter(|_| share > 0.0)?;
        let cell = f64::from(factor) * 2.0_f64.powi(target as i32);
        let height = f64::from(frame[1]) / cell;
        let step = 2.0_f64.powi((source - target) as i32);
        let (count, blades) = (optics.ghosts(), optics.blades());
        let mut numbers = GhostNumbers {
            ghosts: [bytemuck::Zeroable::zeroed(); MOST_GHOSTS as usize],
            normals: [[0.0; 4]; GHOST_PAIRS],
            tails: *tails,
            middle: frame.map(|side| (0.5 * f64::from(side) / cell) as f32),
            target_cells: *to,
            source_cells: *from,
            step: step as f32,
            count,
            fine: 0.5_f64.powi(target as i32) as f32,
            above,
            reserved: [0; 2],
        };
        for (blade, normal) in (0..blades).zip(numbers.normals.as_flattened_mut().chunks_exact_mut(2)) {
            let angle = optics.spike_angle + PI * (0.5 + 2.0 * f64::from(blade) / f64::from(blades));
            // Rows count downwards.
            normal.copy_from_slice(&[angle.cos() as f32, -angle.sin() as f32]);
        }
        let shown = &GHOSTS[..count as usize];
        let mean = |c: usize| shown.iter().map(|(_, _, colour)| colour[c]).sum::<f64>();
        let neutral: [f64; 3] = std::array::from_fn(mean);
        for (ghost, (magnification, radius, colour)) in numbers.ghosts.iter_mut().zip(shown) {
            let part = std::array::from_fn(|c| share * colour[c] / neutral[c]);
            *ghost = Ghost::new((*magnification, radius * height), step, f64::from(blades), part);
        }
        Some(Self { source, target, numbers })
    }

    /// The light of all ghosts on the target's grid, from the light of the source's cells. On the current pool. Errors:
    /// OUT_OF_MEMORY.
    pub(super) fn drawn(&self, source: &[[f32; 4]]) -> Result<Vec<[f32; 4]>> {
        let [width, height] = self.numbers.target_cells.map(|side| side as usize);
        let source = self.numbers.reflected_light(source)?;
        let mut target = filled(width * height, [0.0_f32; 4], GHOST_GRID)?;
        target.par_chunks_mut(width).enumerate().for_each(|(y, cells)| {
            for (x, cell) in cells.iter_mut().enumerate() {
                let place = [x as f32 + 0.5, y as f32 + 0.5];
                for ghost in &self.numbers.ghosts[..self.numbers.count as usize] {
                    let light = self.numbers.ghost_light(&source, ghost, place);
                    (0..3).for_each(|c| cell[c] += light[c]);
                }
            }
        });
        Ok(target)
    }

    /// Adds what is `drawn` to what the finest grid, of rows of `width`, spreads already. On the current pool.
    pub(super) fn add_to(&self, spread: &mut [[f32; 4]], width: u32, drawn: &[[f32; 4]]) {
        let [columns, rows] = self.numbers.target_cells;
        let near = |i: usize, cells: u32| {
            let place = ((i as f32 + 0.5) * self.numbers.fine - 0.5).clamp(0.0, (cells - 1) as f32);
            let first = place.floor();
            ([first as usize, (first as usize + 1).min(cells as usize - 1)], [1.0 - (place - first), place - first])
        };
        spread.par_chunks_mut(width as usize).enumerate().for_each(|(y, cells)| {
            let (rows, down) = near(y, rows);
            for (x, cell) in cells.iter_mut().enumerate() {
                let (between, across) = near(x, columns);
                let mut sum = cell.map(|v| self.numbers.above * v);
                for (row, down) in rows.iter().zip(down) {
                    for (column, across) in between.iter().zip(across) {
                        let light = drawn[row * columns as usize + column];
                        (0..3).for_each(|c| sum[c] += down * across * light[c]);
                    }
                }
                *cell = sum;
            }
        });
    }
}

/// The first level of at most so many rows.
fn level_of(mut rows: impl ExactSizeIterator<Item = u32>, most: u32) -> usize {
    let last = rows.len().saturating_sub(1);
    rows.position(|rows| rows <= most).unwrap_or(last)
}

impl Ghost {
    /// `magnification`, and the radius in cells of the target; `step`: the side of a source's cell; `part`: of all
    /// light, by colour.
    fn new((magnification, radius): (f64, f64), step: f64, blades: f64, part: [f64; 3]) -> Self {
        // The area of a regular polygon of apothem 1.
        let area = blades * (PI / blades).tan();
        // Ghosts of neighbouring cells lie as far apart as the source's cells are magnified: their edges, which fall
        // off over as much, join without steps. Over a whole number of cells they keep their light, wherever between
        // cells they lie.
        let softness = LEAST_SOFTNESS.max((magnification.abs() * step).ceil());
        let apothem = radius.max(LEAST_RADIUS * softness) * (PI / area).sqrt();
        let apothems = [1.0 + DISPERSION, 1.0, 1.0 - DISPERSION].map(|wider| wider * apothem);
        let mut ghost = Self {
            shares: [0.0; 4],
            apothems: [0.0; 4],
            magnification: magnification as f32,
            softness: softness as f32,
            reach: ((apothems[0] + 0.5 * softness) / (PI / blades).cos()) as f32,
            reserved: 0.0,
        };
        for c in 0..3 {
            // The area that the fall-off covers, and that of a source's cell.
            let covered = area * ghost_area(apothems[c], softness);
            ghost.shares[c] = (part[c] * step * step / covered) as f32;
            ghost.apothems[c] = apothems[c] as f32;
        }
        ghost
    }
}

/// The integral of 2 t s(t) over t >= 0, s falling linearly from 1 at `apothem` - `softness` / 2 to 0 at `apothem` +
/// `softness` / 2.
fn ghost_area(apothem: f64, softness: f64) -> f64 {
    let (near, far) = (apothem - 0.5 * softness, apothem + 0.5 * softness);
    let whole = |near: f64| (far.powi(3) - near.powi(3)) / (3.0 * softness);
    if near >= 0.0 { whole(near) } else { far * far * far / (3.0 * softness) }
}

impl GhostNumbers {
    /// The light of the source's cells that reaches ghosts.
    fn reflected_light(&self, source: &[[f32; 4]]) -> Result<Vec<[f32; 4]>> {
        let mut light = filled(source.len(), [0.0_f32; 4], GHOST_GRID)?;
        for (number, (light, own)) in (0..).zip(light.iter_mut().zip(source)) {
            let cell: [u32; 2] = [number % self.source_cells[0], number / self.source_cells[0]];
            let part = |side: usize| {
                let place = (cell[side] as f32 + 0.5) * self.step;
                self.coverage(side, cell[side]) * self.reflected(side, place)
            };
            *light = own.map(|v| part(0) * part(1) * v);
        }
        Ok(light)
    }

    /// The light that a ghost has at a place of the target: of every source's cell whose image lies there.
    fn ghost_light(&self, source: &[[f32; 4]], ghost: &Ghost, place: [f32; 2]) -> [f32; 3] {
        let [columns, rows] = [0, 1].map(|side| self.seen(ghost, place[side], side));
        let mut sum = [0.0; 3];
        for y in rows {
            for x in columns.clone() {
                let inside = self.inside(ghost, self.offset(ghost, place, [x, y]));
                let light = source[(y * self.source_cells[0] + x) as usize];
                (0..3).for_each(|c| sum[c] += inside[c] * light[c]);
            }
        }
        std::array::from_fn(|c| ghost.shares[c] * sum[c])
    }

    /// The source's cells along one side whose images may reach a place.
    fn seen(&self, ghost: &Ghost, place: f32, side: usize) -> std::ops::Range<u32> {
        let middle = (self.middle[side] + (place - self.middle[side]) / ghost.magnification) / self.step - 0.5;
        let reach = ghost.reach / (ghost.magnification.abs() * self.step);
        let cells = self.source_cells[side] as f32;
        (middle - reach).ceil().clamp(0.0, cells) as u32..((middle + reach).floor() + 1.0).clamp(0.0, cells) as u32
    }

    /// A place in a ghost as the aperture lies, from the middle of the image of a source's cell.
    fn offset(&self, ghost: &Ghost, place: [f32; 2], cell: [u32; 2]) -> [f32; 2] {
        std::array::from_fn(|side| {
            let from = (cell[side] as f32 + 0.5) * self.step - self.middle[side];
            ghost.magnification.signum() * (place[side] - self.middle[side] - ghost.magnification * from)
        })
    }

    /// The part of what is reflected that reaches the ghosts, as far as one side decides it: 1 in the middle, 0 at the
    /// border and beyond.
    fn reflected(&self, side: usize, place: f32) -> f32 {
        let from = ((place - self.middle[side]) / self.middle[side]).clamp(-1.0, 1.0);
        (1.0 - from.powi(6)).powi(2)
    }

    /// How much a ghost has of its light at a place, by colour.
    fn inside(&self, ghost: &Ghost, [x, y]: [f32; 2]) -> [f32; 3] {
        let edges = self.normals.map(|[ax, ay, bx, by]| (ax * x + ay * y).max(bx * x + by * y));
        let edge = edges.into_iter().fold(0.0, f32::max);
        std::array::from_fn(|c| ((ghost.apothems[c] - edge) / ghost.softness + 0.5).clamp(0.0, 1.0))
    }

    /// The part of a source's cell that lies in the frame, along one side.
    fn coverage(&self, side: usize, cell: u32) -> f32 {
        let from_end = (self.source_cells[side] - 1 - cell) as usize;
        if from_end < 4 { self.tails[side][3 - from_end] } else { 1.0 }
    }
}
