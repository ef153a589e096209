// SPDX-License-Identifier: MIT OR Apache-2.0
//! Looking into a Kerr lens table: interpolation between its nodes.

use super::grid::*;
use crate::physics::lens::plane::PlaneImage;
use glam::{DVec3, Vec4};
use std::f64::consts::LN_2;

/// A look direction in a table, to be interpolated there.
#[derive(Clone, Debug)]
pub struct KerrLookup<'a> {
    grid: &'a Grid,
    pub place: GridPosition,
    flags: u32,
    /// The four nodes about the cell in each of the four rows about it, one after the other.
    rows: [&'a [Vec4]; 4],
    columns: Weights,
    along_rows: Weights,
}

/// The end of an escaping ray.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// Chart, unit.
    pub direction: DVec3,
    by_column: DVec3,
    by_row: DVec3,
}

/// A crossing of the equatorial plane. Farther out than the disk its azimuth and delay mean nothing.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    pub order: u32,
    /// Azimuth and delay 0 unless the pattern is wanted.
    pub image: PlaneImage,
    by_column: PlaneImage,
    by_row: PlaneImage,
    by_side: PlaneImage,
}

/// A small change of a place in a table.
#[derive(Clone, Copy, Debug)]
pub struct GridStep {
    column: f64,
    row: f64,
    side: f64,
}

impl GridPosition {
    /// The change of column, row and S for a small change `dn` of the look direction (components).
    pub fn step(&self, dn: DVec3) -> GridStep {
        GridStep {
            column: self.column_gradient.dot(dn),
            row: self.row_gradient.dot(dn),
            side: self.side_gradient.dot(dn),
        }
    }
}

impl Sky {
    /// The change of the direction for a small `step` (`GridPosition::step`).
    pub fn change(&self, step: &GridStep) -> DVec3 {
        self.by_column * step.column + self.by_row * step.row
    }
}

impl Crossing {
    /// The change of the image for a small `step` (`GridPosition::step`).
    pub fn change(&self, step: &GridStep) -> PlaneImage {
        let sum = |f: fn(&PlaneImage) -> f64| {
            step.column * f(&self.by_column) + step.row * f(&self.by_row) + step.side * f(&self.by_side)
        };
        PlaneImage { u: sum(|i| i.u), azimuth: sum(|i| i.azimuth), delay: sum(|i| i.delay) }
    }
}

/// Weights of cubic Lagrange interpolation at nodes -1, 0, 1, 2, and their derivatives.
#[derive(Clone, Copy, Debug)]
struct Weights {
    value: [f32; 4],
    slope: [f32; 4],
}

impl Weights {
    fn new(f: f64) -> Self {
        let (m, p, q) = (f - 1.0, f + 1.0, f - 2.0);
        let value = [-f * m * q / 6.0, p * m * q / 2.0, -p * f * q / 2.0, p * f * m / 6.0];
        let slope = [
            -(3.0 * f * f - 6.0 * f + 2.0) / 6.0,
            (3.0 * f * f - 4.0 * f - 1.0) / 2.0,
            -(3.0 * f * f - 2.0 * f - 2.0) / 2.0,
            (3.0 * f * f - 1.0) / 6.0,
        ];
        Self { value: value.map(|w| w as f32), slope: slope.map(|w| w as f32) }
    }
}

/// Four numbers interpolated, and their derivatives by column and row.
struct Interpolated {
    value: Vec4,
    by_column: Vec4,
    by_row: Vec4,
}

impl Grid {
    /// Fours of numbers in a packed node: the sky, then either a crossing each, or u of four crossings each.
    pub fn quads(&self) -> usize {
        let crossings = if self.wanted.pattern { self.wanted.orders } else { self.wanted.orders.div_ceil(PER_QUAD) };
        1 + crossings
    }

    /// A node as tables hold it.
    pub fn pack(&self, node: &[f64]) -> PackedNode {
        let (sky, crossings) = node.split_at(SKY.min(node.len()));
        let quad = |numbers: &[f64]| {
            Vec4::from_array(std::array::from_fn(|i| numbers.get(i).copied().unwrap_or_default() as f32))
        };
        std::iter::once(sky).chain(crossings.chunks(PER_QUAD)).map(quad).take(QUADS_MOST).collect()
    }

    /// The image at `place`, from the cell's flags and rows of packed nodes. `None`: the ray is to be integrated.
    pub fn look_up_at<'a>(&'a self, place: GridPosition, flags: u32, rows: [&'a [Vec4]; 4]) -> Option<KerrLookup<'a>> {
        if flags & DIRECT != 0 || rows.iter().any(|row| row.len() < 4 * self.quads()) {
            return None;
        }
        let (columns, along_rows) = (Weights::new(place.column_fraction), Weights::new(place.row_fraction));
        Some(KerrLookup { grid: self, place, flags, rows, columns, along_rows })
    }
}

impl KerrLookup<'_> {
    #[inline]
    fn interpolate(&self, quad: usize) -> Interpolated {
        let quads = self.grid.quads();
        let mut sum = Interpolated { value: Vec4::ZERO, by_column: Vec4::ZERO, by_row: Vec4::ZERO };
        for (j, row) in self.rows.into_iter().enumerate() {
            let (mut value, mut by_column) = (Vec4::ZERO, Vec4::ZERO);
            for i in 0..4 {
                let node = row[i * quads + quad];
                value += node * self.columns.value[i];
                by_column += node * self.columns.slope[i];
            }
            sum.value += value * self.along_rows.value[j];
            sum.by_column += by_column * self.along_rows.value[j];
            sum.by_row += value * self.along_rows.slope[j];
        }
        sum
    }

    /// The end of the ray, unless it is captured: the interpolated direction, normalised, and its derivatives at right
    /// angles to it.
    pub fn sky(&self) -> Option<Sky> {
        if self.place.branch == Branch::Inner {
            return None;
        }
        let at = self.interpolate(0);
        let vector = |v: Vec4| v.truncate().as_dvec3();
        let raw = vector(at.value);
        let inverse = 1.0 / raw.length();
        let direction = raw * inverse;
        let across = |v: DVec3| (v - direction * direction.dot(v)) * inverse;
        Some(Sky { direction, by_column: across(vector(at.by_column)), by_row: across(vector(at.by_row)) })
    }

    /// Distance to the critical curve, in the unit that `steps` go at right angles.
    pub fn curve_distance(&self, steps: &[GridStep; 2]) -> f64 {
        let rows = steps[0].row.hypot(steps[1].row).max(f64::MIN_POSITIVE);
        // Beyond 90 degrees from the curve d ln |t| rises again: its antipode is not near it.
        let t = self.place.t.abs().max(1.0);
        self.grid.nodes_per_octave[self.place.branch as usize] / (LN_2 * rows) * (0.5 * (t + 1.0 / t))
    }

    /// False where only integration tells the crossings of the ray well enough.
    pub fn crossings_are_good(&self) -> bool {
        self.flags & POOR_CROSSINGS == 0
    }

    /// The crossings in the disk's range, in the ray's order.
    #[cfg(test)]
    pub fn crossings(&self) -> impl Iterator<Item = Crossing> {
        self.crossings_and_beyond().filter(|crossing| self.is_reached(crossing))
    }

    /// The crossings in the disk's range, and of rays beside such those farther out, past infinity as well, and farther
    /// in; in the ray's order.
    pub fn crossings_and_beyond(&self) -> impl Iterator<Item = Crossing> {
        let possible = (0..self.grid.wanted.orders).filter(|order| self.flags >> order & 1 != 0);
        possible.filter_map(|order| self.crossing_or_beyond(order))
    }

    /// The crossing of that order, good or not. `None`: not in the disk's range.
    pub fn crossing(&self, order: usize) -> Option<Crossing> {
        self.crossing_or_beyond(order).filter(|crossing| self.is_reached(crossing))
    }

    fn is_reached(&self, crossing: &Crossing) -> bool {
        let wanted = &self.grid.wanted;
        crossing.image.u >= wanted.reach(crossing.order as usize) && crossing.image.u <= wanted.plane_u[1]
    }

    /// `None`: nearer than its range, or missing.
    fn crossing_or_beyond(&self, order: usize) -> Option<Crossing> {
        let wanted = &self.grid.wanted;
        let at = self.interpolate(1 + if wanted.pattern { order } else { order / PER_QUAD });
        let lane = if wanted.pattern { 0 } else { order % PER_QUAD };
        let inverse_side = 1.0 / self.place.side;
        let u = f64::from(at.value[lane]) * inverse_side;
        if !(u <= self.grid.reach_inwards() && f64::from(at.value[lane].abs()) < 0.5 * NO_CROSSING) {
            return None;
        }
        let order = order as u32;
        let only = |u: f64| PlaneImage { u, azimuth: 0.0, delay: 0.0 };
        // u = U / S.
        let by_side = -u * inverse_side;
        if !wanted.pattern {
            let by = |v: Vec4| only(f64::from(v[lane]) * inverse_side);
            let [by_column, by_row] = [at.by_column, at.by_row].map(by);
            return Some(Crossing { order, image: only(u), by_column, by_row, by_side: only(by_side) });
        }
        let [_, x, y, delay] = at.value.as_dvec4().to_array();
        // d / du of `divergent_delay`.
        let by_u = -(1.0 / u + 2.0) / u;
        let change = |v: Vec4| {
            let [change, dx, dy, dt] = v.as_dvec4().to_array();
            let du = change * inverse_side;
            PlaneImage { u: du, azimuth: (x * dy - y * dx) / (x * x + y * y), delay: dt + by_u * du }
        };
        Some(Crossing {
            order,
            image: PlaneImage { u, azimuth: y.atan2(x), delay: delay + divergent_delay(u, 1.0 / self.grid.frame.r) },
            by_column: change(at.by_column),
            by_row: change(at.by_row),
            by_side: PlaneImage { u: by_side, azimuth: 0.0, delay: by_u * by_side },
        })
    }
}
