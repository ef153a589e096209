// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a crossing of the disk's plane changes over the cell of a sample, and how much of the cell the disk covers.
//! Shared by both tracers (shaders/refine/cell.wgsl mirrors it); knows no rays and no light.
//!
//! Over a cell u is taken to change evenly, as the samples beside it say. A cell is seen in two parts, each with the
//! light of the mean u of what the disk covers of it, and with g of the ray's light there, unless matter
//! plunges (`Matter::redshift_beside`):
//!
//! - Cells of strips in two halves, one nearer to the critical curve (`CellCrossing::half`): images of high order
//!   change much from one strip to the next. Three or four strips may hold all of such an image, and the light of one
//!   be ten times that of the next.
//! - Quarters of a pixel in two ranges of u: the disk's light vanishes at its inner edge, and grows steeply from there.

/// u = 1/r, in 1/M, of a crossing over a cell, 1 x 1 about its middle.
#[derive(Clone, Copy, Debug)]
pub struct CellCrossing {
    /// In the middle.
    pub u: f64,
    /// Its changes to the next cell along the strip and across the curve, or to the next quarter in the row and the
    /// column.
    pub du: [f64; 2],
}

/// A part of a cell that lies on the disk.
#[derive(Clone, Copy, Debug)]
pub struct Covered {
    /// The share of the cell, above 0, at most 1.
    pub share: f64,
    /// The mean of u in the part.
    pub u: f64,
}

impl CellCrossing {
    /// `beside`: u of the crossings of the same order before and after that at `u`, along the strip (or the row) and
    /// across the curve (or in the column); 0 where there is none.
    pub fn new(u: f64, beside: [[f64; 2]; 2]) -> Self {
        Self { u, du: beside.map(|pair| change_of_u(u, pair)) }
    }

    /// The half of the cell before its middle across the curve (`side` -1) or behind it (1).
    pub fn half(&self, side: f64) -> Self {
        let [along, across] = self.du;
        Self { u: self.u + 0.25 * side * across, du: [along, 0.5 * across] }
    }

    /// Twelve times the variance of u over the cell.
    pub fn spread2(&self) -> f64 {
        self.du[0] * self.du[0] + self.du[1] * self.du[1]
    }

    /// Twelve times the variance of u over the part of the cell between `levels`, nearly: as if all of it were alike
    /// between them, and not more than over the cell.
    pub fn spread2_between(&self, [low, high]: [f64; 2]) -> f64 {
        ((high - low) * (high - low)).min(self.spread2())
    }

    /// Between which differences from `u` the cell lies on the disk, whose edges are at `disk_u`; the first is above
    /// the second where it does not.
    pub fn levels_on(&self, [outer, inner]: [f64; 2]) -> [f64; 2] {
        let half = 0.5 * (self.du[0].abs() + self.du[1].abs()).max(LEAST_SLOPE);
        [(outer - self.u).max(-half), (inner - self.u).min(half)]
    }

    /// The part in which u differs from that in the middle by `levels`, which lie among those of `levels_on`. `None`:
    /// there is none.
    pub fn covered(&self, levels: [f64; 2]) -> Option<Covered> {
        let du = self.du;
        let [below_low, below_high] = levels.map(|level| share_below(level, du));
        let share = below_high - below_low;
        if share.is_nan() || share <= 0.0 {
            return None;
        }
        let [low, high] = levels;
        let sum = sum_below(high, du) - sum_below(low, du);
        // The mean of a quantity between two values, from the shares below each (integrated by parts).
        let off = ((high * below_high - low * below_low - sum) / share).max(low).min(high);
        Some(Covered { share: share.min(1.0), u: self.u + off })
    }
}

/// The change of u from one cell to the next: central where both samples beside it, `pair`, have the crossing (u > 0),
/// else one-sided.
fn change_of_u(here: f64, pair: [f64; 2]) -> f64 {
    match pair.map(|there| there > 0.0) {
        [true, true] => 0.5 * (pair[1] - pair[0]),
        [true, false] => here - pair[0],
        [false, true] => pair[1] - here,
        [false, false] => 0.0,
    }
}

/// The least slope that counts: its square is a normal number in f32, which GPUs do not take for 0.
pub(crate) const LEAST_SLOPE: f64 = 1e-15;

/// Share of a cell, 1 x 1 about its middle, in which `slope` . (x, y) <= `level`: the half-plane cuts a corner off, or
/// two sides.
pub(crate) fn share_below(level: f64, slope: [f64; 2]) -> f64 {
    let [x, y] = slope.map(f64::abs);
    let (most, least) = (x.max(y).max(LEAST_SLOPE), x.min(y));
    if level.abs() <= 0.5 * (most - least) {
        return 0.5 + level / most;
    }
    let corner = (0.5 * (most + least) - level.abs()).max(0.0);
    let cut = corner * corner / (2.0 * most * least.max(LEAST_SLOPE));
    if level > 0.0 { 1.0 - cut } else { cut }
}

/// The integral of `share_below` over levels up to this one.
fn sum_below(level: f64, slope: [f64; 2]) -> f64 {
    let [x, y] = slope.map(f64::abs);
    let (most, least) = (x.max(y).max(LEAST_SLOPE), x.min(y));
    let low = -level.abs();
    let inner = 0.5 * (most - least);
    let sum = if low >= -inner {
        least * (least / (6.0 * most)) + 0.5 * (low + inner) * (1.0 + (low - inner) / most)
    } else {
        let corner = (0.5 * (most + least) + low).max(0.0);
        corner * corner / (2.0 * most * least.max(LEAST_SLOPE)) * (corner / 3.0)
    };
    sum + level.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The share by counting points.
    fn counted(level: f64, slope: [f64; 2]) -> f64 {
        const N: u32 = 400;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(N) - 0.5;
        let below = |(i, j): (u32, u32)| slope[0] * place(i) + slope[1] * place(j) <= level;
        let points = (0..N).flat_map(|i| (0..N).map(move |j| (i, j)));
        points.filter(|at| below(*at)).count() as f64 / f64::from(N * N)
    }

    /// Where all of a cell lies on the disk, its parts have its variance, so that the footprint of an evenly lit cell
    /// stays as it is.
    #[test]
    fn parts_have_the_spread_of_the_cell() {
        let disk_u = [0.05, 0.15];
        for du in [[0.0, 0.02], [0.004, 0.02], [0.01, -0.02], [0.02, 0.02]] {
            let cell = CellCrossing { u: 0.1, du };
            let halves = [-1.0, 1.0].map(|side| {
                let half = cell.half(side);
                let levels = half.levels_on(disk_u);
                (half.covered(levels).unwrap().u - cell.u, half.spread2_between(levels))
            });
            let [low, high] = cell.levels_on(disk_u);
            let ranges = [[low, 0.0], [0.0, high]]
                .map(|levels| (cell.covered(levels).unwrap().u - cell.u, cell.spread2_between(levels)));
            let of = |parts: [(f64, f64); 2]| {
                let spread2: f64 = parts.iter().map(|(off, spread2)| 0.5 * (12.0 * off * off + spread2)).sum();
                (spread2 / cell.spread2()).sqrt()
            };
            assert!((of(halves) - 1.0).abs() < 1e-9, "{du:?}: {}", of(halves));
            assert!(of(ranges) > 0.999 && of(ranges) < 1.1, "{du:?}: {}", of(ranges));
        }
        // A range of a tenth of the cell.
        let cell = CellCrossing { u: 0.1, du: [0.0, 0.1] };
        assert!((cell.spread2_between([0.01, 0.02]) - 1e-4).abs() < 1e-12);
    }

    #[test]
    fn shares_of_half_planes_are_areas() {
        for slope in [[1.0, 0.0], [0.3, -1.0], [-0.7, -0.7], [0.0, 1e-3], [2.0, 0.01]] {
            for part in [-0.9, -0.5, -0.1, 0.0, 0.3, 0.6, 0.99, 1.2] {
                let level = part * 0.5 * (f64::abs(slope[0]) + f64::abs(slope[1]));
                let error = share_below(level, slope) - counted(level, slope);
                assert!(error.abs() < 4e-3, "{slope:?} {level}: {error}");
            }
        }
    }

    fn crossing(du: [f64; 2]) -> CellCrossing {
        CellCrossing { u: 0.1, du }
    }

    /// Halves, and ranges of u, cover together what the whole does, and their mean u is that of the whole.
    #[test]
    fn parts_make_the_whole() {
        for du in [[0.0, 0.3], [0.04, -0.2], [-0.1, 0.01], [0.0, 0.0], [0.2, 0.2]] {
            let whole = crossing(du);
            for disk_u in [[0.05, 0.15], [0.0, 1.0], [0.11, 0.2], [0.3, 0.4]] {
                let levels = whole.levels_on(disk_u);
                let middle = 0.5 * (levels[0] + levels[1]);
                let halves = [-1.0, 1.0].map(|side| whole.half(side)).map(|half| half.covered(half.levels_on(disk_u)));
                let ranges = [[levels[0], middle], [middle, levels[1]]].map(|levels| whole.covered(levels));
                let all = whole.covered(levels).map_or([0.0; 2], |all| [all.share, all.share * all.u]);
                for (parts, weight) in [(halves, 0.5), (ranges, 1.0)] {
                    let sum = |of: &dyn Fn(&Covered) -> f64| weight * parts.iter().flatten().map(of).sum::<f64>();
                    let [share, u] = [sum(&|part| part.share), sum(&|part| part.share * part.u)];
                    assert!((share - all[0]).abs() < 1e-12, "{du:?} {disk_u:?}: {share} of {}", all[0]);
                    assert!((u - all[1]).abs() < 1e-12, "{du:?} {disk_u:?}: {u} of {}", all[1]);
                }
            }
            let [low, high] = [-1.0, 1.0].map(|side| whole.half(side).covered([-1.0, 1.0]).unwrap());
            assert!((high.u - low.u - 0.5 * du[1]).abs() < 1e-12, "{du:?}");
        }
    }

    /// By counting points.
    #[test]
    fn the_mean_u_of_a_part_is_that_of_its_points() {
        const N: u32 = 400;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(N) - 0.5;
        for du in [[0.03, 0.02], [0.001, -0.08], [-0.05, -0.05], [0.0, 0.06]] {
            for levels in [[-0.02, 0.01], [0.005, 0.02], [-0.01, 1.0], [-1.0, -0.015]] {
                let u = |(i, j): (u32, u32)| du[0] * place(i) + du[1] * place(j);
                let points = (0..N).flat_map(|i| (0..N).map(move |j| (i, j))).map(u);
                let within: Vec<f64> = points.filter(|u| *u >= levels[0] && *u <= levels[1]).collect();
                let mean = within.iter().sum::<f64>() / within.len() as f64;
                let covered = crossing(du).covered(levels).unwrap();
                let error = covered.u - 0.1 - mean;
                assert!(error.abs() < 2e-4, "{du:?} {levels:?}: {error} of {mean}");
            }
        }
    }

    /// Crossings that samples beside lack.
    #[test]
    fn changes_are_central_where_they_can_be() {
        let across = |pair| CellCrossing::new(0.1, [[0.0; 2], pair]).du;
        for (pair, change) in [([0.08, 0.13], 0.025), ([0.08, 0.0], 0.02), ([0.0, 0.13], 0.03), ([0.0; 2], 0.0)] {
            let [along, found] = across(pair);
            assert!(along == 0.0 && (found - change).abs() < 1e-15, "{pair:?}: {along} {found}");
        }
    }
}
