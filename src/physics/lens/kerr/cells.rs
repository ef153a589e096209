// SPDX-License-Identifier: MIT OR Apache-2.0
//! Judges the cells of a Kerr lens table: whether they are good enough to be interpolated, and which crossings their
//! rays may have.

use super::grid::*;

struct CellAngles {
    column: f64,
    row: f64,
    critical: f64,
}

/// How a crossing of one order is to be had in a cell.
enum Hit {
    No,
    Possible,
    /// The crossing may occur, and is not to be interpolated.
    Poor,
}

/// The 6 x 6 nodes about a cell; the cell lies between indices 2 and 3.
struct Patch<'a> {
    at: [[&'a [f64]; 6]; 6],
    /// S at the inner 4 x 4 nodes.
    sides: [[f64; 4]; 4],
    angles: CellAngles,
}

impl Patch<'_> {
    fn value(&self, channel: usize, i: usize, j: usize) -> f64 {
        self.at[i][j][channel]
    }

    /// Error of cubic interpolation at mid-cell, 3/128 of the fourth difference (the greater one of both centres),
    /// summed over both directions, on the cell's four edges' worst.
    fn error(&self, channel: usize) -> f64 {
        let fourth = |f: &dyn Fn(usize) -> f64| {
            let at = |c: usize| (f(c - 2) - 4.0 * f(c - 1) + 6.0 * f(c) - 4.0 * f(c + 1) + f(c + 2)).abs();
            at(2).max(at(3))
        };
        let column = |j: usize| fourth(&|i| self.value(channel, i, j));
        let row = |i: usize| fourth(&|j| self.value(channel, i, j));
        3.0 / 128.0 * (column(2).max(column(3)) + row(2).max(row(3)))
    }

    /// u at one of the inner 4 x 4 nodes.
    fn u(&self, channel: usize, i: usize, j: usize) -> f64 {
        self.value(channel, i, j) / self.sides[i - 1][j - 1]
    }

    /// Change per rad of look direction, from changes between nodes: the smaller one over the cell of the greater one
    /// of both directions.
    fn stretch(&self, change: impl Fn((usize, usize), (usize, usize)) -> f64) -> f64 {
        let row = change((2, 2), (2, 3)).min(change((3, 2), (3, 3))) / self.angles.row;
        let column = change((2, 2), (3, 2)).min(change((2, 3), (3, 3))) / self.angles.column.max(1e-12);
        row.max(column)
    }

    /// The change per rad of look direction of the vector that some channels make up.
    fn vector_stretch(&self, channels: std::ops::Range<usize>) -> f64 {
        let change = |k, a: (usize, usize), b: (usize, usize)| self.value(k, a.0, a.1) - self.value(k, b.0, b.1);
        self.stretch(|a, b| channels.clone().map(|k| change(k, a, b).powi(2)).sum::<f64>().sqrt())
    }

    fn sky_is_good(&self) -> bool {
        let escaped = (0..6).all(|i| (0..6).all(|j| (0..SKY).any(|k| self.value(k, i, j) != 0.0)));
        let error = (0..SKY).map(|k| self.error(k).powi(2)).sum::<f64>().sqrt();
        // The comparison is written so that NaN does not pass for good.
        escaped && error <= TOLERANCE * self.vector_stretch(0..SKY).max(1.0)
    }

    /// `reach_inwards`: the greatest 1 / r at which crossings of the order are looked for.
    fn crossing(&self, channel: usize, order: usize, wanted: &Crossings, reach_inwards: f64) -> Hit {
        let [low, high] = self.range(channel);
        let [near, far] = [wanted.plane_u[1], wanted.plane_u[0]];
        let reach = wanted.reach(order);
        if low > reach_inwards || high < reach {
            return Hit::No;
        }
        let inside = |i: usize, j: usize| self.value(channel, i, j).abs() < NO_CROSSING;
        let come = (1..5).all(|i| (1..5).all(|j| inside(i, j)));
        if low > near {
            return if come { Hit::Possible } else { Hit::No };
        }
        if !come {
            return Hit::Poor;
        }
        let middle = 0.5 * (self.u(channel, 2, 2) + self.u(channel, 3, 3));
        let size = middle.clamp(far, near).max(f64::MIN_POSITIVE);
        // Relative change for a relative change of the impact parameter.
        let stretch = self.stretch(|a, b| (self.u(channel, a.0, a.1) - self.u(channel, b.0, b.1)).abs());
        let conditioning = 1.0 + self.angles.critical * stretch / size;
        let least_side = self.sides[1][1].min(self.sides[1][2]).min(self.sides[2][1]).min(self.sides[2][2]);
        let radius_good = self.error(channel) <= TOLERANCE * conditioning * size * least_side;
        let pattern_good = !wanted.pattern || self.pattern_is_good(channel, size);
        if radius_good && pattern_good { Hit::Possible } else { Hit::Poor }
    }

    fn pattern_is_good(&self, channel: usize, u: f64) -> bool {
        let azimuth = self.error(channel + 1).hypot(self.error(channel + 2));
        let azimuth_conditioning = 1.0 + self.angles.critical * self.vector_stretch(channel + 1..channel + 3);
        // d ph = Omega dt, Omega = r^(-3/2) (Kepler).
        let turn = u * u.sqrt();
        let delay_conditioning = 1.0 + self.angles.critical * turn * self.vector_stretch(channel + 3..channel + 4);
        azimuth <= PATTERN_TOLERANCE * azimuth_conditioning
            && turn * self.error(channel + 3) <= PATTERN_TOLERANCE * delay_conditioning
    }

    /// Least and greatest value over the 4 x 4 nodes of the interpolation, widened by a quarter of their spread:
    /// between the nodes the values may go beyond. Missing crossings count as what they are, but do not widen.
    fn range(&self, channel: usize) -> [f64; 2] {
        let (mut all, mut finite) = ([f64::INFINITY, f64::NEG_INFINITY], [f64::INFINITY, f64::NEG_INFINITY]);
        for (i, j) in (1..5).flat_map(|i| (1..5).map(move |j| (i, j))) {
            let u = self.u(channel, i, j);
            all = [all[0].min(u), all[1].max(u)];
            if self.value(channel, i, j).abs() < NO_CROSSING {
                finite = [finite[0].min(u), finite[1].max(u)];
            }
        }
        let margin = 0.25 * (finite[1] - finite[0]).max(0.0);
        [all[0] - margin, all[1] + margin]
    }
}

impl Grid {
    /// Flags of the cell whose lower corner is (`column`, `row`), from the nodes about it: `node(column, row)` with
    /// columns from `column` - 2 (wrapped) to `column` + 3, rows alike. Only cells with `row` in `ROWS_BELOW` .. rows
    /// - `ROWS_ABOVE` hold rays.
    pub fn flags<'a>(
        &self,
        branch: Branch,
        column: usize,
        row: usize,
        node: impl Fn(usize, usize) -> &'a [f64],
    ) -> u32 {
        let columns = self.columns();
        let at = |i: usize, j: usize| node((column + columns + i - 2) % columns, row + j - 2);
        let node_side = |i, j| side(self.direction(branch, column + columns + i - 2, (row + j - 2) as f64));
        let sides = std::array::from_fn(|i| std::array::from_fn(|j| node_side(i + 1, j + 1)));
        let at = std::array::from_fn(|i| std::array::from_fn(|j| at(i, j)));
        let patch = Patch { at, sides, angles: self.cell_angles(branch, column, row) };
        let mut flags = 0;
        if branch == Branch::Outer && !patch.sky_is_good() {
            flags |= DIRECT;
        }
        for order in 0..self.wanted.orders {
            let channel = SKY + order * self.per_crossing();
            let reach_inwards = if order > 0 { self.reach_inwards() } else { self.wanted.plane_u[1] };
            match patch.crossing(channel, order, &self.wanted, reach_inwards) {
                Hit::No => {}
                Hit::Possible => flags |= 1 << order,
                Hit::Poor => flags |= 1 << order | POOR_CROSSINGS,
            }
        }
        flags
    }

    /// Angles on the observer's sky, rad: a cell's extent along chi and along x, and sin R.
    fn cell_angles(&self, branch: Branch, column: usize, row: usize) -> CellAngles {
        let (i, j) = (column, row as f64);
        let here = self.direction(branch, i, j + 0.5);
        let t = self.spokes[i].1;
        CellAngles {
            // At the axis chi means nothing; the row's own extent bounds the cell there.
            column: here.distance(self.direction(branch, i + 1, j + 0.5)),
            row: self.direction(branch, i, j).distance(self.direction(branch, i, j + 1.0)),
            critical: 2.0 * t / (1.0 + t * t),
        }
    }
}
