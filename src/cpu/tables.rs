// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tables of observers' lenses (`physics::lens`), built in parallel and kept while what they depend on stays, of
//! several observers by turns; and the structure of matter with depth of the last frame. Knows no pixels.

use crate::allocate::{filled, with_room};
use crate::emit::baked::{Baked, BakedCache};
use crate::error::Result;
use crate::parallel::{join, prelude::*};
use crate::physics::lens::kerr::{self, Crossings, Grid, KerrLens};
use crate::physics::lens::schwarzschild::{Branch, Column, Family, Resolution};
use crate::physics::lens::{LENS, SchwarzschildLens};
use crate::physics::observer::LocalFrame;
use crate::recent::Recent;
use crate::scene::observer::Lens;
use crate::scene::refine::reached_u;
use crate::scene::{Lensing, Scene};
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// The tables of the last frames that looked rays up in some.
#[derive(Default)]
pub struct LensCache {
    schwarzschild: Recent<(f64, bool, bool), SchwarzschildLens>,
    kerr: Recent<KerrKey, KerrLens>,
    structure: BakedCache,
    /// Tables made so far.
    pub made: u64,
}

/// Everything that the tables of a spinning hole depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct KerrKey {
    spin: f64,
    r: f64,
    /// Unit vector from the hole to the observer.
    e_r: DVec3,
    /// Azimuth.
    e_phi: DVec3,
    rain: bool,
    wanted: Crossings,
}

/// The tables of a frame.
#[derive(Clone, Copy)]
pub enum Tables<'a> {
    Schwarzschild(&'a SchwarzschildLens),
    Kerr(&'a KerrLens),
}

impl LensCache {
    /// The tables for `lensing` by the observer at `frame`, built on the current pool unless they are those of before.
    /// `None`: rays are to be traced. Errors: OUT_OF_MEMORY.
    pub fn tables(&mut self, scene: &Scene, frame: &LocalFrame, lensing: Lensing) -> Result<Option<Tables<'_>>> {
        Ok(match lensing {
            Lensing::Traced => None,
            Lensing::Kerr => self.kerr(frame, wanted(scene))?.map(Tables::Kerr),
            Lensing::Schwarzschild => {
                self.schwarzschild(frame, scene.emitters().needs().delays)?.map(Tables::Schwarzschild)
            }
        })
    }

    /// The structure of each of the scene's volumes as its camera sees it, made on the current pool unless it is there
    /// from the frame before. Errors: OUT_OF_MEMORY.
    pub fn structure(&mut self, scene: &Scene, lens: &Lens) -> Result<Vec<Option<Arc<Baked>>>> {
        let volumes = scene.shown_volumes();
        self.structure.prepare(&volumes.volumes, scene.hole.spin, lens.observer.frame.r, lens.least_pixel_angle())
    }

    fn schwarzschild(&mut self, frame: &LocalFrame, with_delay: bool) -> Result<Option<&SchwarzschildLens>> {
        let key = (frame.r, frame.rain, with_delay);
        if !self.schwarzschild.find(&key) {
            drop(self.schwarzschild.make_room(&key));
            let Some(lens) = build_schwarzschild(frame, with_delay)? else { return Ok(None) };
            self.schwarzschild.put(key, lens);
            self.made += 1;
        }
        Ok(self.schwarzschild.first())
    }

    fn kerr(&mut self, frame: &LocalFrame, wanted: Crossings) -> Result<Option<&KerrLens>> {
        let key = KerrKey { spin: frame.a, r: frame.r, e_r: frame.e_r, e_phi: frame.e_phi, rain: frame.rain, wanted };
        if !self.kerr.find(&key) {
            // The old tables go first, because they are large.
            drop(self.kerr.make_room(&key));
            let Some(lens) = build_kerr(frame, wanted)? else { return Ok(None) };
            self.kerr.put(key, lens);
            self.made += 1;
        }
        Ok(self.kerr.first())
    }
}

/// The contents that a frame of `scene` asks of tables.
pub(super) fn wanted(scene: &Scene) -> Crossings {
    let orders = scene.pixel_settings().max_crossings;
    let emitters = scene.emitters();
    match emitters.plane_u() {
        Some(plane_u) => Crossings { orders, plane_u: reached_u(plane_u), pattern: emitters.needs().places },
        None => Crossings { orders: 0, plane_u: [1.0, 0.0], pattern: false },
    }
}

/// A table of `rows`, each `width` long.
fn by_rows<T: Copy + Default + Send, I: Iterator<Item = T>>(
    rows: Range<usize>,
    width: usize,
    make: impl Fn(usize) -> I + Sync,
) -> Result<Vec<T>> {
    let mut table = filled(rows.len() * width, T::default(), LENS)?;
    table.par_chunks_mut(width).zip(rows).for_each(|(row, number)| {
        row.iter_mut().zip(make(number)).for_each(|(out, value)| *out = value);
    });
    Ok(table)
}

pub(super) fn build_kerr(frame: &LocalFrame, wanted: Crossings) -> Result<Option<KerrLens>> {
    let Some(grid) = Grid::new(frame, kerr::Resolution::COARSE, wanted) else { return Ok(None) };
    let tables = |branch| {
        let rows = 0..grid.rows(branch);
        let nodes = by_rows(rows.clone(), grid.columns() * grid.channels(), |row| grid.node_row(branch, row))?;
        let flags = by_rows(grid.cell_rows(branch), grid.columns(), |row| grid.flag_row(branch, row, &nodes))?;
        Ok((by_rows(rows, grid.packed_row_size(), |row| grid.packed_row(row, &nodes))?, flags))
    };
    let ((outer, outer_flags), (inner, inner_flags)) = (tables(kerr::Branch::Outer)?, tables(kerr::Branch::Inner)?);
    Ok(Some(KerrLens::assemble(grid, [outer, inner], [outer_flags, inner_flags])))
}

pub(super) fn build_schwarzschild(frame: &LocalFrame, with_delay: bool) -> Result<Option<SchwarzschildLens>> {
    let Some(family) = Family::new(frame, with_delay, Resolution::SINGLE) else { return Ok(None) };
    let columns = |branch| -> Result<Option<Vec<Column>>> {
        let count = family.columns(branch);
        let (mut made, mut columns) = (with_room(count, LENS)?, with_room(count, LENS)?);
        (0..count).into_par_iter().map(|i| family.column(branch, i)).collect_into_vec(&mut made);
        for column in made {
            let Some(column) = column? else { return Ok(None) };
            columns.push(column);
        }
        Ok(Some(columns))
    };
    let (escaping, captured) = join(|| columns(Branch::Escaping), || columns(Branch::Captured));
    let (Some(escaping), Some(captured)) = (escaping?, captured?) else { return Ok(None) };
    SchwarzschildLens::from_columns(family, escaping, captured)
}
