// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a crossing of the disk's plane changes over the cell of a sample, and how much of the cell the disk covers.
//! Shared by both tracers (shaders/refine/cell.wgsl mirrors it); knows no rays and no light.
//!
//! Over a cell u and ln g are taken to change evenly, as the samples beside it say. Where the disk covers only part of
//! the cell, its light is that in the middle of this part. Across the curve images of high order change much from one
//! strip to the next: three or four strips may hold all of such an image, and the light of one be ten times that of the
//! next. Hence the cells of strips are seen in two halves (`CellCrossing::half`).

/// u and g of the crossing of one order in a sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct Crossed {
    /// 0 where there is no such crossing.
    pub u: f64,
    /// 0 where it is not known: where matter can have no circular orbit.
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
    /// In the middle.
    pub u: f64,
    pub g: f64,
    /// Changes of u and of ln g to the next cell along the curve and across it.
    pub du: [f64; 2],
    pub dg: [f64; 2],
}

/// The part of a cell that the disk covers.
#[derive(Clone, Copy, Debug)]
pub struct Covered {
    /// The share of the cell.
    pub share: f64,
    /// In the middle of the part that is covered.
    pub u: f64,
    pub g: f64,
}

impl CellCrossing {
    /// `beside`: the crossings of the same order before and after `here` along the curve and across it.
    pub fn new(here: Crossed, beside: [[Crossed; 2]; 2]) -> Self {
        // Beyond the disk's inner edge g may be known in the next cell only.
        let known = |crossed: Crossed| if crossed.g > 0.0 { Some(crossed.g) } else { None };
        let [along, across] = beside;
        let g = known(here).or_else(|| across.into_iter().chain(along).find_map(known)).unwrap_or(1.0);
        Self {
            u: here.u,
            g,
            du: beside.map(|pair| change(here.u, pair.map(|there| there.u))),
            dg: beside.map(|pair| {
                let ln = pair.map(|there| if there.g > 0.0 { (there.g / g).ln() } else { 0.0 });
                let share = if pair.iter().all(|there| there.g > 0.0) { 0.5 } else { 1.0 };
                share * (ln[1] - ln[0])
            }),
        }
    }

    /// The half of the cell before its middle across the curve (`side` -1) or behind it (1).
    pub fn half(&self, side: f64) -> Self {
        let ([du_along, du], [dg_along, dg]) = (self.du, self.dg);
        let g = self.g * (0.25 * side * dg).exp();
        Self { u: self.u + 0.25 * side * du, g, du: [du_along, 0.5 * du], dg: [dg_along, 0.5 * dg] }
    }

    /// The part that lies between `outer` and `inner`, 1/r of the disk's edges: light that vanishes at the disk's edge
    /// does not all over the cell.
    pub fn covered(&self, [outer, inner]: [f64; 2]) -> Covered {
        let (u, du) = (self.u, self.du);
        let share = (share_below(inner - u, du) - share_below(outer - u, du)).clamp(0.0, 1.0);
        let half = 0.5 * (du[0].abs() + du[1].abs());
        let [low, high] = [(u - half).max(outer), (u + half).min(inner)];
        // The less of the cell is left out, the less does that move the middle of the rest.
        let part = (2.0 * (1.0 - share)).min(1.0);
        let off = if low < high { part * (0.5 * (low + high) - u) } else { 0.0 };
        // The nearest place of the cell where u is so much off.
        let steepness = du[0].hypot(du[1]).max(LEAST_SLOPE);
        let ln_g = off / steepness * ((du[0] * self.dg[0] + du[1] * self.dg[1]) / steepness);
        Covered { share, u: u + off, g: self.g * ln_g.exp() }
    }
}

/// The change of u from one cell to the next: central where both samples beside it, `pair`, have the crossing (u > 0),
/// else one-sided.
fn change(here: f64, pair: [f64; 2]) -> f64 {
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

    /// Halves cover together what the whole does, and light that changes evenly with u is the same in both.
    #[test]
    fn halves_make_the_whole() {
        for du in [[0.0, 0.3], [0.04, -0.2], [-0.1, 0.01], [0.0, 0.0], [0.2, 0.2]] {
            let whole = crossing(du, [0.1, -0.4]);
            for disk_u in [[0.05, 0.15], [0.0, 1.0], [0.11, 0.2], [0.3, 0.4]] {
                let halves = [-1.0, 1.0].map(|side| whole.half(side).covered(disk_u));
                let mean = 0.5 * (halves[0].share + halves[1].share);
                assert!((mean - whole.covered(disk_u).share).abs() < 1e-12, "{du:?} {disk_u:?}: {mean}");
            }
            let all = [-1.0, 1.0].map(|side| whole.half(side).covered([-1.0, 1.0]));
            let u = |half: &Covered| half.u;
            assert!((0.5 * (u(&all[0]) + u(&all[1])) - 0.1).abs() < 1e-12, "{du:?}");
            assert!((u(&all[1]) - u(&all[0]) - 0.5 * du[1]).abs() < 1e-12, "{du:?}");
            assert!((all[0].g * all[1].g - 0.64).abs() < 1e-12 && all[0].g > all[1].g, "{all:?}");
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
            let covered = cell.covered([0.1005, 0.2]);
            assert!(covered.u > 0.1005 && covered.share < 0.5, "{covered:?}");
            let expected = covered.u.powf(power);
            assert!((covered.g / expected - 1.0).abs() < 4e-4 && covered.g > 1.003 * here.g, "{covered:?} {expected}");
        }
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
        near(across([none, none]).du[1] + across([none, none]).dg[1], 0.0);
        for unknown in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
            let here = Crossed::new(0.1, unknown);
            near(CellCrossing::new(here, [[none; 2], [none, high]]).g, high.g);
            near(CellCrossing::new(here, [[low, none], [none; 2]]).g, low.g);
            near(CellCrossing::new(here, [[none; 2]; 2]).g, 1.0);
        }
    }
}
