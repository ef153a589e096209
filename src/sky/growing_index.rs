// SPDX-License-Identifier: MIT OR Apache-2.0
//! How the star index is made: the stars are sorted, then counted cell by cell, then listed, in web pages a few at a
//! time. `index.rs` says what the index holds. Knows no scenes.

use super::catalogue::Star;
use super::galaxy::crowding;
use super::index::{
    CELL_COUNT, FAINTEST, STAR_LEVELS, StarIndex, cell_of, cells_before, mean_skies, scaled_flux, side, warp,
};
use crate::allocate::{collected, filled, with_room};
use crate::error::Result;
use crate::physics::blackbody::BlackbodyTable;

/// The name of this memory in out-of-memory errors.
const STARS: &str = "the index of a sky's stars";

/// An index that is being made.
pub struct GrowingIndex {
    stars: Vec<Star>,
    /// The parts that are made so far.
    index: StarIndex,
    /// Each cell's number of stars; once all are counted, where the next of its stars goes.
    cells: Vec<u32>,
    is_counted: bool,
    /// How many stars are counted, and then, how many are listed.
    done: usize,
}

impl GrowingIndex {
    /// The index of any stars, which are only sorted yet. Errors: OUT_OF_MEMORY.
    pub fn new(stars: impl Iterator<Item = Star>) -> Result<Self> {
        let mut stars = collected(stars, STARS)?;
        // Neighbours in the sky become neighbours in memory.
        sort_by_cell(&mut stars)?;
        let index = StarIndex {
            stars: with_room(2 * stars.len(), STARS)?,
            star_cells: Vec::new(),
            star_lists: Vec::new(),
            mean_sky: Vec::new(),
            crowding: 0.0,
        };
        Ok(Self { stars, index, cells: filled(CELL_COUNT, 0, STARS)?, is_counted: false, done: 0 })
    }

    /// Counts up to `count` more stars, or, after the last one, lists so many. Returns whether all are listed. Errors:
    /// OUT_OF_MEMORY.
    pub fn grow(&mut self, count: usize) -> Result<bool> {
        let Self { stars, index, cells, is_counted, done } = self;
        let some = *done..done.saturating_add(count).min(stars.len());
        *done = some.end;
        let numbered = some.clone().zip(stars.get(some).unwrap_or(&[]));
        if *is_counted {
            for (number, star) in numbered {
                let d = star.direction.as_vec3();
                visit_cells(star, &mut |cell| {
                    index.star_lists[cells[cell] as usize] = [d.x, d.y, d.z, number as f32];
                    cells[cell] += 1;
                });
            }
            return Ok(*done == stars.len());
        }
        for (_, star) in numbered {
            index.stars.extend(packed(star));
            visit_cells(star, &mut |cell| cells[cell] += 1);
        }
        if *done == stars.len() {
            (*is_counted, *done) = (true, 0);
            begin_lists(index, cells)?;
        }
        Ok(false)
    }

    /// The whole index. Errors: OUT_OF_MEMORY.
    pub fn grown(mut self) -> Result<StarIndex> {
        while !self.grow(usize::MAX)? {}
        Ok(self.done())
    }

    /// The index, once all stars are listed.
    pub fn done(self) -> StarIndex {
        StarIndex { mean_sky: mean_skies(&self.stars), crowding: crowding(&self.stars) as f32, ..self.index }
    }
}

impl StarIndex {
    /// The index of any stars. Errors: OUT_OF_MEMORY.
    pub fn new(stars: impl Iterator<Item = Star>) -> Result<Self> {
        GrowingIndex::new(stars)?.grown()
    }
}

/// A star's entries of `StarIndex::stars`.
fn packed(star: &Star) -> [[f32; 4]; 2] {
    let (d, temperature) = (star.direction, star.temperature());
    let (flux, log_reference) = (scaled_flux(star), BlackbodyTable::shared().ln_luminance(temperature));
    [[d.x, d.y, d.z, flux], [temperature, log_reference, 0.0, 0.0]].map(|v| v.map(|x| x as f32))
}

/// Makes room for the lists of the cells, one after the other, and turns their lengths into where each begins.
fn begin_lists(index: &mut StarIndex, cells: &mut [u32]) -> Result<()> {
    index.star_cells = with_room(cells.len(), STARS)?;
    let mut end = 0;
    for cell in cells {
        let (begin, count) = (end, *cell);
        // A length has 8 bits; lists are not that long.
        index.star_cells.push(begin << 8 | count.min(255));
        *cell = begin;
        end += count;
    }
    index.star_lists = filled(end as usize, [0.0; 4], STARS)?;
    Ok(())
}

/// Calls `visit` with every cell whose list the star belongs to: on each level that is not too coarse for it, on each
/// cube side whose plane it is near enough to, the two columns by two rows whose enlarged cells hold it.
fn visit_cells(star: &Star, visit: &mut impl FnMut(usize)) {
    let d = star.direction.to_array();
    for face in 0..6_u32 {
        let axis = (face / 2) as usize;
        let along = if face % 2 == 0 { d[axis] } else { -d[axis] };
        let (u, v) = (d[(axis + 1) % 3], d[(axis + 2) % 3]);
        // Enlarged cells reach 1 + 1 / side in w; on the coarsest level that is below 1.25 in u.
        if along <= 0.0 || u.abs() > 1.25 * along || v.abs() > 1.25 * along {
            continue;
        }
        let (u, v) = (warp(u / along), warp(v / along));
        for level in (0..STAR_LEVELS).filter(|&level| star.magnitude <= FAINTEST[level as usize]) {
            let n = side(level) as i32;
            // floor(cell - 1/2), as a conversion of a positive number: w > -1.3, so 64 moves every level's cells above
            // 0.
            let first = |w: f64| ((w + 1.0) * 0.5 * f64::from(n) + 63.5) as i32 - 64;
            let (column, row) = (first(u), first(v));
            for row in (row..=row + 1).filter(|row| (0..n).contains(row)) {
                for column in (column..=column + 1).filter(|column| (0..n).contains(column)) {
                    visit(cells_before(level) as usize + ((face as i32 * n + row) * n + column) as usize);
                }
            }
        }
    }
}

/// A stable sort, in place but for the keys; `sort_by_cached_key` cannot be refused memory.
fn sort_by_cell(stars: &mut [Star]) -> Result<()> {
    let keys = stars.iter().zip(0_u32..).map(|(star, number)| (cell_of(star.direction, 0), number));
    let mut order = collected(keys, STARS)?;
    order.sort_unstable();
    for place in 0..stars.len() {
        // The star that belongs here may have been swapped away, to where the star of its own place went.
        let mut from = order[place].1 as usize;
        while from < place {
            from = order[from].1 as usize;
        }
        order[place].1 = from as u32;
        stars.swap(place, from);
    }
    Ok(())
}
