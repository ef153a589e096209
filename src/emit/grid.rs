// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sides of the grid on which the structure of a volume is baked for a frame. Knows no pattern and no light.
//!
//! A texel is a place in the azimuth that turns with the matter, in ln r and in height. Columns go around once, and
//! layers through one period of the filaments; both repeat. Rows go from the inner to the outer end of the matter.
//! Level by level all sides are halved.

use super::filaments::{FILAMENT_LAST, FILAMENT_SIDES};

/// The number of the last level of a grid: one layer is left there.
pub(crate) const GRID_LAST: usize = FILAMENT_LAST;
pub(crate) const GRID_LEVELS: usize = GRID_LAST + 1;
/// Rows at most. Matter that reaches farther has coarser ones.
pub(crate) const MOST_ROWS: usize = 2048;
/// Each level has whole rows.
const ROW_STEP: usize = 1 << GRID_LAST;

/// The sides of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Rows of the finest level.
    pub rows: usize,
    /// ln r at the two ends of the rows.
    pub ln_r: [f64; 2],
}

impl Grid {
    /// For matter between two ln r of which texels an e-fold of the radius are `fineness`.
    pub fn new(ln_r: [f64; 2], fineness: f64) -> Self {
        let rows = (fineness * (ln_r[1] - ln_r[0])).ceil().clamp(1.0, MOST_ROWS as f64) as usize;
        Self { rows: rows.next_multiple_of(ROW_STEP), ln_r }
    }

    /// Columns, rows and layers of a level.
    pub fn sides(&self, level: usize) -> [usize; 3] {
        [FILAMENT_SIDES[0], self.rows, FILAMENT_SIDES[2]].map(|side| side >> level)
    }

    pub fn rows_per_e_fold(&self) -> f64 {
        self.rows as f64 / (self.ln_r[1] - self.ln_r[0])
    }

    /// ln r in the middle of a row of a level.
    pub fn row_ln_r(&self, level: usize, row: usize) -> f64 {
        let [low, high] = self.ln_r;
        low + (high - low) * (row as f64 + 0.5) / self.sides(level)[1] as f64
    }
}
