// SPDX-License-Identifier: MIT OR Apache-2.0
//! A whole Kerr lens table, and its rows, of which callers may compute many at a time.

use super::grid::*;
use super::lookup::KerrLookup;
use glam::{DVec3, Vec4};

/// A whole table.
#[derive(Clone, Debug)]
pub struct KerrLens {
    grid: Grid,
    /// The two branches: rows of packed nodes, from the last column over all of them to the first two again, so that
    /// every cell's nodes lie side by side.
    nodes: [Vec<Vec4>; 2],
    flags: [Vec<u32>; 2],
}

/// Columns that a table's row repeats.
const REPEATED: usize = 3;

impl KerrLens {
    /// Builds the table from what the caller computed for the outer and the inner branch: `Grid::packed_row` of all
    /// rows and `Grid::flag_row` of all `Grid::cell_rows`, in order.
    pub fn assemble(grid: Grid, nodes: [Vec<Vec4>; 2], flags: [Vec<u32>; 2]) -> Self {
        Self { grid, nodes, flags }
    }

    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The flags of a cell; `DIRECT` where there is none.
    pub fn flags(&self, branch: Branch, column: usize, row: usize) -> u32 {
        let index = row.checked_sub(ROWS_BELOW).map(|row| row * self.grid.columns() + column);
        index.and_then(|index| self.flags[branch as usize].get(index).copied()).unwrap_or(DIRECT)
    }

    /// The image along the unit look direction `n` (components of the local frame). `None`: the ray is to be
    /// integrated.
    pub fn look_up(&self, n: DVec3) -> Option<KerrLookup<'_>> {
        let place = self.grid.locate(n)?;
        let flags = self.flags(place.branch, place.column, place.row);
        let quads = self.grid.quads();
        let nodes = &self.nodes[place.branch as usize];
        let rows = std::array::from_fn(|j| {
            let first = (place.row + j).saturating_sub(1) * (self.grid.columns() + REPEATED) + place.column;
            nodes.get(first * quads..(first + 4) * quads).unwrap_or(&[])
        });
        self.grid.look_up_at(place, flags, rows)
    }
}

impl Grid {
    /// Numbers of a `packed_row`.
    pub fn packed_row_size(&self) -> usize {
        (self.columns() + REPEATED) * self.quads()
    }

    /// `node` of all columns of a row, one after the other.
    pub fn node_row(&self, branch: Branch, row: usize) -> impl Iterator<Item = f64> {
        (0..self.columns()).flat_map(move |column| self.node(branch, column, row))
    }

    /// Rows with cells that hold rays.
    pub fn cell_rows(&self, branch: Branch) -> std::ops::Range<usize> {
        ROWS_BELOW..self.rows(branch) - ROWS_ABOVE
    }

    /// `flags` of all cells of a row, from the branch's nodes (`node_row` of all rows).
    pub fn flag_row<'a>(&'a self, branch: Branch, row: usize, nodes: &'a [f64]) -> impl Iterator<Item = u32> + 'a {
        let node = move |i: usize, j: usize| self.node_of(nodes, i, j);
        (0..self.columns()).map(move |column| self.flags(branch, column, row, node))
    }

    /// A row as a table holds it, from the branch's nodes.
    pub fn packed_row<'a>(&'a self, row: usize, nodes: &'a [f64]) -> impl Iterator<Item = Vec4> + 'a {
        let columns = self.columns();
        (0..columns + REPEATED).flat_map(move |i| self.pack(self.node_of(nodes, (i + columns - 1) % columns, row)))
    }

    fn node_of<'a>(&self, nodes: &'a [f64], column: usize, row: usize) -> &'a [f64] {
        let channels = self.channels();
        let first = (row * self.columns() + column) * channels;
        &nodes[first..first + channels]
    }
}
