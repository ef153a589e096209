//! Pixels that edges run through: which these are, where their samples lie, and how much of a sample's cell the disk covers. Shared by
//! both tracers (shaders/record.wgsl and shaders/refine.wgsl mirror it); knows no rays and no light.
//!
//! One ray through a pixel's centre cannot tell how much of the pixel an edge leaves to either side, and misses rings thinner than the
//! pixel. Two kinds of pixels get more rays:
//!
//! - An edge of the disk ([`Edge::Disk`]): u of a crossing changes evenly there, so a few rays tell it all over the pixel, and with it
//!   the share of each ray's cell in which it lies between the disk's radii. That share of the disk's opacity is composed as usual.
//! - The critical curve ([`Edge::Curve`]), which images of higher orders approach by e^-pi each (Ohanian 1987, Am. J. Phys. 55, 428),
//!   so that those of order 2 and more share a pixel with it: many rays, which count as they fall where u does not change evenly.

/// What runs through a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Edge {
    #[default]
    None,
    /// An edge of the disk, or the neighbourhood of the critical curve, where that is likely, or a steep change on the disk.
    Disk,
    /// The critical curve.
    Curve,
}

/// Samples of a row, and of a column, in pixels of either kind.
pub const EDGE_GRID: u32 = 2;
pub const CURVE_GRID: u32 = 8;

/// Half a pixel, and half as much again: how far an edge may be from the pixel's centre.
const EDGE_REACH: f64 = 0.75;
/// Relative change of u from pixel to pixel from which on the disk's light in the pixel is not that at its centre.
const STEEP_CHANGE: f64 = 0.1;
/// Distances to the critical curve, pixels, below which a looked-up pixel is `Curve` or `Disk`.
const CURVE_REACH: f64 = 1.25;
const RINGS_REACH: f64 = 3.0;
/// What u may change over a cell, or between the samples of a pixel of `EDGE_GRID`, and still count as even: of the disk's own range of u.
const EVEN_CHANGE: f64 = 0.5;
const EVEN_CHANGE_OF_PIXEL: f64 = 0.3;
/// The latter for the direct image, relative to u: there the light itself may not change evenly.
const DIRECT_CHANGE: f64 = 0.25;

/// 1/r between which crossings matter to pixels beside the disk's edges `disk_u`.
pub fn reached_u([outer, inner]: [f64; 2]) -> [f64; 2] {
    [outer / 1.5, inner * 1.15]
}

/// Whether an edge of the disk runs through the pixel whose crossing lies at `u`, or u changes steeply there; `change`: of u to the next
/// pixel right and down.
pub fn near_disk_edge(u: f64, change: [f64; 2], disk_u: [f64; 2]) -> bool {
    let sum = change[0].abs() + change[1].abs();
    let [far, near] = disk_u;
    let steep = u >= far && u <= near && is_steep(u, sum);
    steep || disk_u.iter().any(|edge| (u - edge).abs() < EDGE_REACH * sum)
}

/// Whether the light of a crossing at `u` that changes by so much to the next pixels is not that at the pixel's centre.
pub fn is_steep(u: f64, change: f64) -> bool {
    change > STEEP_CHANGE * u
}

/// Of a looked-up pixel `curve` pixels from the critical curve that nothing hides.
pub fn looked_up_edge(on_edge: bool, has_disk: bool, curve: f64) -> Edge {
    match () {
        () if curve < CURVE_REACH => Edge::Curve,
        () if on_edge || (has_disk && curve < RINGS_REACH) => Edge::Disk,
        () => Edge::None,
    }
}

/// How much of a cell each row of samples lies to the right of the one above, and each column below the one before. Of many, that count
/// as they fall, no two may have the same x or y (Kensler 2013, Correlated Multi-Jittered Sampling, its canonical arrangement); few,
/// that stand for their surroundings, must reach equally far to all sides.
fn grid_skew(grid: u32) -> f64 {
    if grid == EDGE_GRID { 0.0 } else { 1.0 / f64::from(grid) }
}

/// Of sample (column, row) in its cell, 0 .. 1.
pub fn place_in_cell([column, row]: [u32; 2], grid: u32) -> [f64; 2] {
    [row, column].map(|i| 0.5 + grid_skew(grid) * (f64::from(i) + 0.5 - 0.5 * f64::from(grid)))
}

/// The same in the pixel.
pub fn sample_place(cell: [u32; 2], grid: u32) -> [f64; 2] {
    let within = place_in_cell(cell, grid);
    std::array::from_fn(|i| (f64::from(cell[i]) + within[i]) / f64::from(grid))
}

/// Share of a cell, 1 x 1 about its middle, in which `slope` . (x, y) <= `level`: the half-plane cuts a corner off, or two sides.
fn share_below(level: f64, slope: [f64; 2]) -> f64 {
    let [x, y] = slope.map(f64::abs);
    let (most, least) = (x.max(y).max(1e-20), x.min(y));
    if level.abs() <= 0.5 * (most - least) {
        return 0.5 + level / most;
    }
    let corner = (0.5 * (most + least) - level.abs()).max(0.0);
    let cut = corner * corner / (2.0 * most * least.max(1e-20));
    if level > 0.0 { 1.0 - cut } else { cut }
}

/// u of the crossing of one order at each sample of a pixel, row by row; 0 where there is none.
pub struct Crossings<'a> {
    pub u: &'a [f64],
    pub grid: u32,
    pub disk_u: [f64; 2],
}

impl Crossings<'_> {
    /// Share of the cell of sample (column, row) in which the crossing lies on the disk.
    pub fn covered_share(&self, cell: [u32; 2]) -> f64 {
        let [outer, inner] = self.disk_u;
        let u = self.at(cell);
        if u <= 0.0 {
            return 0.0;
        }
        let within = f64::from(u8::from(u >= outer && u <= inner));
        let (Some(across), Some(down)) = (self.change(cell, 0), self.change(cell, 1)) else { return within };
        // The next sample to the right lies so much of a cell lower, and the next below so much to the right.
        let skew = grid_skew(self.grid);
        let slope = [across - skew * down, down - skew * across].map(|d| d / (1.0 - skew * skew));
        if slope[0].abs() + slope[1].abs() > EVEN_CHANGE * (inner - outer) {
            return within;
        }
        let place = place_in_cell(cell, self.grid);
        let middle = u + slope[0] * (0.5 - place[0]) + slope[1] * (0.5 - place[1]);
        (share_below(inner - middle, slope) - share_below(outer - middle, slope)).clamp(0.0, 1.0)
    }

    fn at(&self, [column, row]: [u32; 2]) -> f64 {
        self.u.get((row * self.grid + column) as usize).copied().unwrap_or(0.0)
    }

    /// Change of u to the next sample along an axis. `None`: neither neighbour has the crossing.
    fn change(&self, cell: [u32; 2], axis: usize) -> Option<f64> {
        let shifted = |to: Option<u32>| -> Option<f64> {
            let mut other = cell;
            other[axis] = to.filter(|i| *i < self.grid)?;
            Some(self.at(other)).filter(|u| *u > 0.0)
        };
        let here = self.at(cell);
        match (shifted(cell[axis].checked_sub(1)), shifted(Some(cell[axis] + 1))) {
            (Some(before), Some(after)) => Some(0.5 * (after - before)),
            (Some(before), None) => Some(here - before),
            (None, Some(after)) => Some(after - here),
            (None, None) => None,
        }
    }

    /// Of `EDGE_GRID`: whether u may be on the disk and does not change evenly from sample to sample. `direct`: they are of order 0.
    pub fn are_ragged(&self, direct: bool) -> bool {
        let [far, near] = self.disk_u;
        let Some((low, high, all)) = self.range() else { return false };
        let span = high - low;
        if !all {
            // A crossing that some do not have may be anywhere.
            return 2.0 * high >= far && 0.7 * low <= near;
        }
        let even = (EVEN_CHANGE_OF_PIXEL * (near - far)).min(if direct { DIRECT_CHANGE * high } else { f64::INFINITY });
        span > even && high + span >= far && low - span <= near
    }

    /// Of `EDGE_GRID`: whether the disk covers all of the pixel.
    pub fn cover(&self) -> bool {
        let [far, near] = self.disk_u;
        self.range().is_some_and(|(low, high, all)| {
            let span = high - low;
            all && low - span >= far && high + span <= near
        })
    }

    /// Least and greatest u, and whether all samples have the crossing.
    fn range(&self) -> Option<(f64, f64, bool)> {
        let present = || self.u.iter().copied().filter(|u| *u > 0.0);
        let (low, high) = (present().fold(f64::INFINITY, f64::min), present().fold(0.0, f64::max));
        (high > 0.0).then(|| (low, high, self.u.iter().all(|u| *u > 0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By counting points.
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

    #[test]
    fn the_cover_of_an_even_edge_is_exact_and_of_one_that_jumps_is_counted() {
        let disk_u = [0.05, 0.15];
        // u = 0.05 where x + 0.4 y = 0.7.
        let plane = |[x, y]: [f64; 2]| 0.05 + 0.02 * (x + 0.4 * y - 0.7);
        let u: Vec<f64> = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|cell| plane(sample_place(cell, 2))).into();
        let crossings = Crossings { u: &u, grid: 2, disk_u };
        let mean = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|cell| crossings.covered_share(cell)).iter().sum::<f64>() / 4.0;
        assert!((mean - 0.5).abs() < 1e-12, "{mean}");
        assert!(!crossings.are_ragged(false) && !crossings.cover());
        let jump = [0.1, 0.1, 0.0, 0.1];
        let crossings = Crossings { u: &jump, grid: 2, disk_u };
        assert!(crossings.are_ragged(false) && crossings.covered_share([0, 1]) == 0.0);
        assert!(crossings.covered_share([1, 0]) == 1.0);
    }

    #[test]
    fn many_samples_have_each_their_own_x_and_y() {
        let grid = CURVE_GRID;
        let places = (0..grid * grid).map(|i| sample_place([i % grid, i / grid], grid)).collect::<Vec<_>>();
        for axis in 0..2 {
            let mut along = places.iter().map(|p| p[axis]).collect::<Vec<_>>();
            along.sort_by(f64::total_cmp);
            let step = 1.0 / f64::from(grid * grid);
            let even = along.iter().zip(0..).all(|(x, i)| (x - (f64::from(i) + 0.5) * step).abs() < 1e-12);
            assert!(even, "{along:?}");
        }
        assert_eq!(
            [[0, 0], [1, 0], [1, 1]].map(|cell| sample_place(cell, 2)),
            [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75]]
        );
    }
}
