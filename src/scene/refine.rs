//! Pixels that edges run through: which these are, where their samples lie, and how much of a sample's cell the disk
//! covers. Shared by both tracers (shaders/records/record.wgsl and shaders/refine/refine.wgsl mirror it); knows no rays
//! and no light.
//!
//! One ray through a pixel's centre cannot tell how much of the pixel an edge leaves to either side, and misses rings
//! thinner than the pixel. Two kinds of pixels get more rays:
//!
//! - An edge of the disk ([`Edge::Disk`]): u of a crossing changes evenly there, so a few rays tell it all over the
//!   pixel, and with it the share of each ray's cell in which it lies between the disk's radii. That share of the
//!   disk's opacity is composed as usual.
//! - The critical curve ([`Edge::Curve`]), which images of higher orders approach by e^-pi each (Ohanian 1987, Am. J.
//!   Phys. 55, 428), so that those of order 2 and more share a pixel with it: many rays, which count as they fall where
//!   u does not change evenly.

use super::frame::lattice;

/// The kind of edge that runs through a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Edge {
    #[default]
    None,
    /// An edge of the disk, or the neighbourhood of the critical curve, where that is likely, or a steep change on the
    /// disk.
    Disk,
    /// The critical curve.
    Curve,
}

/// The number of samples of a pixel of either kind. The many also serve pixels on the disk where u does not change
/// evenly.
pub const EDGE_SAMPLES: u32 = 4;
pub const CURVE_SAMPLES: u32 = 32;
/// Relative difference of u of crossings up to which the footprint of one serves for the other.
pub const SAME_CROSSING: f64 = 1e-2;

/// Half a pixel, and half as much again: how far an edge may be from the pixel's centre.
pub(crate) const EDGE_REACH: f64 = 0.75;
/// The relative change of u from pixel to pixel above which the disk's mean light in the pixel is not that at its
/// centre.
pub(crate) const STEEP_CHANGE: f64 = 0.1;
/// Distances to the critical curve, pixels, below which a looked-up pixel is `Curve` or `Disk`.
pub(crate) const CURVE_REACH: f64 = 0.85;
pub(crate) const RINGS_REACH: f64 = 3.0;
/// The change of u between the samples of a pixel of `EDGE_SAMPLES` that still counts as even: as a share of the disk's
/// own range of u, and for the direct image relative to u, because there the light itself may not change evenly.
pub(crate) const EVEN_CHANGE: f64 = 0.5;
pub(crate) const DIRECT_CHANGE: f64 = 0.25;

/// 1/r between which crossings matter to pixels beside the disk's edges `disk_u`.
pub fn reached_u([outer, inner]: [f64; 2]) -> [f64; 2] {
    [outer / 1.5, inner * 1.15]
}

/// Whether an edge of the disk runs through the pixel whose crossing lies at `u`, or u changes steeply there;
/// `change`: of u to the next pixel right and down.
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

/// The edge of a looked-up pixel that lies `curve` pixels from the critical curve and that nothing hides; `rings`:
/// there is a disk, whose rings lie outside the curve as the pixel does.
pub fn looked_up_edge(on_edge: bool, rings: bool, curve: f64) -> Edge {
    match () {
        () if curve < CURVE_REACH => Edge::Curve,
        () if on_edge || (rings && curve < RINGS_REACH) => Edge::Disk,
        () => Edge::None,
    }
}

/// The place in its pixel, 0 .. 1, of the middle of quarter `index`.
pub fn quarter_place(index: u32) -> [f64; 2] {
    [index & 1, index >> 1 & 1].map(|side| 0.25 + 0.5 * f64::from(side))
}

/// The place in its pixel, 0 .. 1, of sample `index` of `CURVE_SAMPLES`: the strips between samples at right angles to
/// `across` are of equal area, so that each pixel gets the same share of its samples of a thin ring at right angles to
/// it; along the strips samples follow steps of the golden ratio.
pub fn curve_place(index: u32, across: [f64; 2]) -> [f64; 2] {
    let [share, along] = lattice(index, CURVE_SAMPLES);
    let length = across[0].hypot(across[1]);
    // A smaller length is rounding, at the very centre of the shadow.
    let normal = if length > 1e-15 { across.map(|c| c / length) } else { [1.0, 0.0] };
    let tangent = [-normal[1], normal[0]];
    let foot = normal.map(|c| c * level_of_share(share, normal));
    // Where the line leaves the pixel.
    let (mut begin, mut end) = (-1.0_f64, 1.0_f64);
    for c in 0..2 {
        if tangent[c].abs() > 1e-6 {
            let [one, other] = [-0.5, 0.5].map(|side| (side - foot[c]) / tangent[c]);
            begin = begin.max(one.min(other));
            end = end.min(one.max(other));
        }
    }
    let at = begin + (end - begin) * along;
    [0, 1].map(|c| 0.5 + foot[c] + tangent[c] * at)
}

/// The level of which `share` is `share_below`; `slope` is not 0.
pub(crate) fn level_of_share(share: f64, slope: [f64; 2]) -> f64 {
    let [x, y] = slope.map(f64::abs);
    let (most, least) = (x.max(y), x.min(y));
    let rest = share.min(1.0 - share);
    let corner = (2.0 * most * least * rest).sqrt();
    let size = if 2.0 * most * rest >= least { (0.5 - rest) * most } else { 0.5 * (most + least) - corner };
    size.copysign(share - 0.5)
}

/// Share of a cell, 1 x 1 about its middle, in which `slope` . (x, y) <= `level`: the half-plane cuts a corner off, or
/// two sides.
pub(crate) fn share_below(level: f64, slope: [f64; 2]) -> f64 {
    let [x, y] = slope.map(f64::abs);
    let (most, least) = (x.max(y).max(1e-20), x.min(y));
    if level.abs() <= 0.5 * (most - least) {
        return 0.5 + level / most;
    }
    let corner = (0.5 * (most + least) - level.abs()).max(0.0);
    let cut = corner * corner / (2.0 * most * least.max(1e-20));
    if level > 0.0 { 1.0 - cut } else { cut }
}

/// u of the crossing of one order at each sample of a pixel of `EDGE_SAMPLES`, row by row; 0 where there is none.
pub struct Crossings {
    pub u: [f64; 4],
    pub disk_u: [f64; 2],
}

impl Crossings {
    /// Share of the cell of a sample in which the crossing lies on the disk, u changing evenly over the cell.
    pub fn covered_share(&self, index: usize) -> f64 {
        let [outer, inner] = self.disk_u;
        let at = |i: usize| self.u.get(i).copied().unwrap_or(0.0);
        let u = at(index);
        let [left, right, above, below] = [at(index & !1), at(index | 1), at(index & !2), at(index | 2)];
        if left.min(right).min(above).min(below) <= 0.0 {
            return f64::from(u8::from(u >= outer && u <= inner));
        }
        let slope = [right - left, below - above];
        (share_below(inner - u, slope) - share_below(outer - u, slope)).clamp(0.0, 1.0)
    }

    /// Whether u may be on the disk and does not change evenly from sample to sample. `direct`: they are of order 0.
    pub fn are_ragged(&self, direct: bool) -> bool {
        let [far, near] = self.disk_u;
        let Some((low, high, all)) = self.range() else { return false };
        let span = high - low;
        if !all {
            // A crossing that some do not have may be anywhere.
            return 2.0 * high >= far && 0.7 * low <= near;
        }
        let even = (EVEN_CHANGE * (near - far)).min(if direct { DIRECT_CHANGE * high } else { f64::INFINITY });
        span > even && high + span >= far && low - span <= near
    }

    /// Whether the disk covers all of the pixel.
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
    use glam::DVec2;
    use std::f64::consts::TAU;

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

    #[test]
    fn levels_are_those_of_shares() {
        for slope in [[1.0, 0.0], [0.3, -1.0], [-0.7, -0.7], [0.0, 1e-3], [2.0, 0.01]] {
            for share in [1e-6, 0.002, 0.1, 0.3, 0.5, 0.7, 0.999] {
                let found = share_below(level_of_share(share, slope), slope);
                assert!((found - share).abs() < 1e-12, "{slope:?} {share}: {found}");
            }
        }
    }

    /// Half-planes in all directions: the samples tell the area, and best across the curve.
    #[test]
    fn samples_across_the_curve_are_even_in_all_directions() {
        for turn in 0..36 {
            let across = DVec2::from_angle(TAU * f64::from(turn) / 36.0 + 0.01);
            let places = (0..CURVE_SAMPLES).map(|i| curve_place(i, across.into()));
            let places: Vec<_> = places.map(|place| DVec2::from(place) - 0.5).collect();
            assert!(places.iter().all(|place| place.abs().max_element() < 0.5));
            for other in 0..36 {
                let normal = DVec2::from_angle(TAU * f64::from(other) / 36.0 + 0.01);
                for level in [-0.4, -0.2, 0.0, 0.1, 0.3] {
                    let counted = places.iter().filter(|place| place.dot(normal) <= level).count() as f64;
                    let error = counted / places.len() as f64 - share_below(level, normal.into());
                    let limit = if other == turn { 0.5 } else { 3.0 } / places.len() as f64;
                    assert!(error.abs() <= limit + 1e-9, "across {across} along {normal} {level}: {error}");
                }
            }
        }
    }

    #[test]
    fn the_cover_of_an_even_edge_is_exact_and_of_one_that_jumps_is_counted() {
        let disk_u = [0.05, 0.15];
        // u = 0.05 where x + 0.4 y = 0.7.
        let plane = |[x, y]: [f64; 2]| 0.05 + 0.02 * (x + 0.4 * y - 0.7);
        let u = [0, 1, 2, 3].map(|index| plane(quarter_place(index)));
        let crossings = Crossings { u, disk_u };
        let mean = (0..4).map(|index| crossings.covered_share(index)).sum::<f64>() / 4.0;
        assert!((mean - 0.5).abs() < 1e-12, "{mean}");
        assert!(!crossings.are_ragged(false) && !crossings.cover());
        let crossings = Crossings { u: [0.1, 0.1, 0.0, 0.1], disk_u };
        assert!(crossings.are_ragged(false) && crossings.covered_share(2) == 0.0 && crossings.covered_share(0) == 1.0);
        assert!(Crossings { u: [0.1, 0.101, 0.1, 0.101], disk_u }.cover());
    }
}
