// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a crossing of the disk's plane changes over the cell of a sample, and how much of the cell the disk covers.
//! Shared by both tracers (shaders/refine/cell.wgsl mirrors it); knows no rays and no light.
//!
//! Over a cell u and ln g are taken to change evenly, as the samples beside it say. A cell is seen in two parts, each
//! with the light of the mean u of what the disk covers of it:
//!
//! - Cells of strips in two halves, one nearer to the critical curve (`CellCrossing::half`): images of high order
//!   change much from one strip to the next. Three or four strips may hold all of such an image, and the light of one
//!   be ten times that of the next.
//! - Quarters of a pixel in two ranges of u: the disk's light vanishes at its inner edge, and grows steeply from there.

/// u and g of the crossing of one order in a sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct Crossed {
    /// 0 where there is no such crossing.
    pub u: f64,
    /// 0 where it is not known: inside the photon orbit, unless matter plunges.
    pub g: f64,
}

impl Crossed {
    pub fn new(u: f64, g: f64) -> Self {
        Self { u, g: if g > 0.0 && g.is_finite() { g } else { 0.0 } }
    }
}

/// A crossing over a cell, 1 x 1 about its middle.
#[derive(Clone, Copy, Debug)]
pub struct CellCrossing {
    /// In the middle; g is 0 where it is not known.
    pub u: f64,
    pub g: f64,
    /// Changes of u and of ln g to the next cell along the strip and across the curve, or to the next quarter in the
    /// row and the column.
    pub du: [f64; 2],
    pub dg: [f64; 2],
}

/// A part of a cell that lies on the disk.
#[derive(Clone, Copy, Debug)]
pub struct Covered {
    /// The share of the cell, above 0.
    pub share: f64,
    /// The mean of u in the part, and g where u is that.
    pub u: f64,
    pub g: f64,
}

impl CellCrossing {
    /// `beside`: the crossings of the same order before and after `here` along the strip (or the row) and across the
    /// curve (or in the column).
    pub fn new(here: Crossed, beside: [[Crossed; 2]; 2]) -> Self {
        // Inside the photon orbit g may be known in the next cell only.
        let known = |crossed: Crossed| if crossed.g > 0.0 { Some(crossed.g) } else { None };
        let [along, across] = beside;
        let g = known(here).or_else(|| across.into_iter().chain(along).find_map(known)).unwrap_or(0.0);
        Self {
            u: here.u,
            g,
            du: beside.map(|pair| change_of_u(here.u, pair.map(|there| there.u))),
            dg: beside.map(|pair| change_of_g(g, pair.map(|there| there.g))),
        }
    }

    /// The half of the cell before its middle across the curve (`side` -1) or behind it (1).
    pub fn half(&self, side: f64) -> Self {
        let ([du_along, du], [dg_along, dg]) = (self.du, self.dg);
        let g = self.g * (0.25 * side * dg).exp();
        Self { u: self.u + 0.25 * side * du, g, du: [du_along, 0.5 * du], dg: [dg_along, 0.5 * dg] }
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
        // The nearest place of the cell where u is so much off.
        let steepness = du[0].hypot(du[1]).max(LEAST_SLOPE);
        let ln_g = off / steepness * ((du[0] * self.dg[0] + du[1] * self.dg[1]) / steepness);
        Some(Covered { share: share.min(1.0), u: self.u + off, g: self.g * ln_g.exp() })
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

/// The most that ln g changes from one cell to the next where it is known in one of those beside only: there one cell
/// holds nearly all of an image, and g may fall to 0 in the next one.
pub(crate) const MOST_ONE_SIDED: f64 = 0.5;

/// The change of ln g from one cell to the next: the mean of those from the cell before and to the cell after, but at
/// most twice the smaller of the two, and 0 where one rises and the other falls (the monotonized central limiter; van
/// Leer 1977, J. Comput. Phys. 23, 276). Towards the photon orbit, and that of plunging matter towards the horizon, g
/// falls to 0: an unlimited difference would let it grow as much on the other side.
fn change_of_g(here: f64, pair: [f64; 2]) -> f64 {
    let [before, after] = pair.map(|there| there > 0.0);
    let from = if before { (here / pair[0]).ln() } else { 0.0 };
    let to = if after { (pair[1] / here).ln() } else { 0.0 };
    if before && after {
        let most = 2.0 * (from.min(to).max(0.0) - from.max(to).min(0.0));
        (0.5 * (from + to)).max(-most).min(most)
    } else {
        (from + to).clamp(-MOST_ONE_SIDED, MOST_ONE_SIDED)
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

    fn crossing(du: [f64; 2], dg: [f64; 2]) -> CellCrossing {
        CellCrossing { u: 0.1, g: 0.8, du, dg }
    }

    /// Halves, and ranges of u, cover together what the whole does, and their mean u is that of the whole.
    #[test]
    fn parts_make_the_whole() {
        for du in [[0.0, 0.3], [0.04, -0.2], [-0.1, 0.01], [0.0, 0.0], [0.2, 0.2]] {
            let whole = crossing(du, [0.1, -0.4]);
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
            assert!((low.g * high.g - 0.64).abs() < 1e-12 && low.g > high.g, "{low:?} {high:?}");
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
                let covered = crossing(du, [0.0; 2]).covered(levels).unwrap();
                let error = covered.u - 0.1 - mean;
                assert!(error.abs() < 2e-4, "{du:?} {levels:?}: {error} of {mean}");
            }
        }
    }

    /// g goes with u to the middle of what is covered: here g is a power of u.
    #[test]
    fn g_goes_with_u() {
        let power = 1.5;
        let at = |u: f64| Crossed::new(u, u.powf(power));
        for step in [-0.004, 0.003] {
            let here = at(0.1);
            let cell = CellCrossing::new(
                here,
                [[at(0.1 - 0.3 * step), at(0.1 + 0.3 * step)], [at(0.1 - step), at(0.1 + step)]],
            );
            let covered = cell.covered(cell.levels_on([0.1005, 0.2])).unwrap();
            assert!(covered.u > 0.1005 && covered.share < 0.5, "{covered:?}");
            let expected = covered.u.powf(power);
            assert!((covered.g / expected - 1.0).abs() < 4e-4 && covered.g > 1.01 * here.g, "{covered:?} {expected}");
        }
    }

    /// Halves are not brighter than what lies beside them, however steeply g falls on the other side.
    #[test]
    fn g_does_not_overshoot() {
        let none = Crossed::default();
        let at = Crossed::new;
        for last in [0.5, 0.1, 1e-3, 1e-9] {
            let cell = CellCrossing::new(at(0.3, 0.6), [[none; 2], [at(0.2, 0.7), at(0.4, last)]]);
            let g = [-1.0, 1.0].map(|side| cell.half(side).g);
            assert!(g[0] <= 0.7 && g[0] > 0.6 && g[1] < 0.6 && g[1] > 0.5, "{last}: {g:?}");
            let alone = CellCrossing::new(at(0.3, 0.6), [[none; 2], [none, at(0.4, last)]]);
            assert!(alone.half(-1.0).g < 0.69, "{last}: {}", alone.half(-1.0).g);
        }
        assert_eq!(CellCrossing::new(at(0.3, 0.6), [[none; 2], [at(0.2, 0.7), at(0.4, 0.8)]]).dg[1], 0.0);
    }

    /// Crossings that samples beside lack, and g that is known on one side only or nowhere.
    #[test]
    fn what_is_missing_is_left_out() {
        let none = Crossed::default();
        let [low, high] = [0.08, 0.13].map(|u| Crossed::new(u, 2.0 * u));
        let here = Crossed::new(0.1, 0.2);
        let across = |pair| CellCrossing::new(here, [[none; 2], pair]);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        near(across([low, high]).du[1], 0.025);
        near(across([low, none]).du[1], 0.02);
        near(across([none, high]).du[1], 0.03);
        near(across([none, high]).dg[1], (0.26_f64 / 0.2).ln());
        near(across([none, none]).du[1], 0.0);
        near(across([none, none]).dg[1], 0.0);
        for unknown in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
            let here = Crossed::new(0.1, unknown);
            near(CellCrossing::new(here, [[none; 2], [none, high]]).g, high.g);
            near(CellCrossing::new(here, [[low, none], [none; 2]]).g, low.g);
            near(CellCrossing::new(here, [[none; 2]; 2]).g, 0.0);
            near(CellCrossing::new(here, [[none; 2]; 2]).dg[1], 0.0);
        }
    }
}
