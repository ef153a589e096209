// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pixels that edges run through: which these are, and where their samples lie. Shared by both tracers
//! (shaders/records/record.wgsl and the files of shaders/refine mirror it); knows no rays and no light.
//!
//! One ray through a pixel's centre cannot tell how much of the pixel an edge leaves to either side, misses rings
//! thinner than the pixel, and has no footprint that holds all over a pixel beside the shadow, where the sky and every
//! image of the disk wind up as the logarithm of the distance from the critical curve (Ohanian 1987, Am. J. Phys. 55,
//! 428). Two kinds of pixels get more rays:
//!
//! - An edge of the disk, or the neighbourhood of the critical curve ([`Edge::Disk`]): a ray for each quarter of the
//!   pixel.
//! - The critical curve itself, or an image of the disk that does not change evenly over the pixel ([`Edge::Curve`]):
//!   rays in strips along the curve, the narrower the nearer they are to it ([`Strips`]), so that images of high order
//!   are found however narrow.
//!
//! In both each ray stands for a cell of its own, with neighbours. Differences between neighbours tell how the sky and
//! the crossings of the disk's plane change over the cell, however the rays were found: with that the sky is filtered
//! over the cell, and the light of the disk found that falls into it ([`super::cell`]).

use super::cell::share_below;
use crate::physics::plunge::Matter;
use glam::DVec3;

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

/// The number of samples of a pixel of either kind: its quarters, and two in each of the strips along the curve.
pub const EDGE_SAMPLES: u32 = 4;
pub const CURVE_SAMPLES: u32 = 32;
/// Samples of a pixel of the second kind where matter with depth is summed along them, which takes many times as long
/// as the ray itself. Half as many, set as below, come as near to pictures of 16 samples a pixel: these pixels of a
/// soft disk at 960 x 540 are then off by 16.6 of 255 (root mean square), with 32 by 16.8.
pub const MATTER_CURVE_SAMPLES: u32 = CURVE_SAMPLES / 2;
/// Samples of a pixel of the second kind; `matter`: whether matter with depth is summed along them.
pub fn curve_samples(matter: bool) -> u32 {
    if matter { MATTER_CURVE_SAMPLES } else { CURVE_SAMPLES }
}

/// Strips get narrower towards the curve down to about this width, pixels: images that are narrower add some hundredths
/// to a pixel's light. With narrower strips fewer are left for wider images. Found by trial, as is the density below:
/// with 0.01 and 0.5 about twice as many pixels are off by 20 %, and with 0.12 thin images are missed.
pub(crate) const NARROWEST: f64 = 0.02;
/// `NARROWEST` for pixels of `MATTER_CURVE_SAMPLES`.
pub(crate) const MATTER_NARROWEST: f64 = 0.01;
/// How densely the captured side of the curve is sampled, the other side being 1; it shows little. With fewer samples
/// they are worth more on the other side.
pub(crate) const CAPTURED_DENSITY: f64 = 0.25;
pub(crate) const MATTER_CAPTURED_DENSITY: f64 = 0.2;
/// The fewest strips on a side of the curve that the pixel has any of, of 16.
pub(crate) const FEWEST_STRIPS: u32 = 3;
/// The distance from the curve, pixels, from which on strips are even; that below which they bend with the curve.
pub(crate) const FARTHEST: f64 = 16.0;
pub(crate) const BENT: f64 = 2.0;
/// The curve is searched for so far, pixels, on both sides of a pixel's centre, by so many steps of the Illinois method
/// (Dowell & Jarratt 1971).
pub(crate) const SEARCH_REACH: f64 = 2.0;
pub(crate) const SEARCH_STEPS: u32 = 5;
/// Where the level is even, one step of Newton's method ends so near to the curve, pixels, that no search is needed.
pub(crate) const EVEN_LEVEL: f64 = 0.02;
/// Half of the distance, pixels, over which the level of the critical curve is differenced.
pub(crate) const LEVEL_STEP: f64 = 0.25;
/// Relative difference of u of crossings up to which the footprint of one serves for the other.
pub const SAME_CROSSING: f64 = 1e-2;

/// Half a pixel, and a little more because u is not quite linear: how far an edge may be from the pixel's centre.
pub(crate) const EDGE_REACH: f64 = 0.6;
/// The relative change of u from pixel to pixel above which the disk's mean light in the pixel is not that at its
/// centre.
pub(crate) const STEEP_CHANGE: f64 = 0.1;
/// Near the ISCO the disk's light goes to 0 as a high power of the distance from it (Page & Thorne 1974). The share of
/// that distance, in u, above which a change of u from pixel to pixel makes the pixel's mean light differ from that at
/// its centre.
pub(crate) const DIM_CHANGE: f64 = 0.33;
/// The least change of u, as a share of u of the ISCO, for which this is looked at. With smaller ones all pixels that
/// it concerns are too dim for it to be seen, on disks of up to some 10,000 K: at 6500 K they have a hundredth of the
/// hottest ring's light.
pub(crate) const LEAST_DIM_CHANGE: f64 = 0.012;
/// The distance to the critical curve, pixels, below which a looked-up pixel is `Curve`.
pub(crate) const CURVE_REACH: f64 = 0.85;
/// Turns of the sky direction from pixel to pixel, rad, above which a pixel is `Curve` or `Disk`. Near the curve the
/// direction goes as -ln of the distance from it (of a hole without spin), so that it turns by one radian a pixel at a
/// distance of one pixel; the thin images of higher orders lie where it turns fast.
pub(crate) const FAST_TURN: f64 = 0.75;
pub(crate) const TURN: f64 = 0.25;
/// A turn of a ray that is not known, in WGSL, where NaN may be taken for any number.
pub(crate) const UNKNOWN_TURN: f64 = 1e30;
/// The change of u from pixel to pixel, in widths of the fading of a disk's edge, above which the edge shows: below it
/// little of the disk's light comes into a pixel from beyond the edge.
pub(crate) const FADING_CHANGE: f64 = 0.1;
/// The change of u between the samples of a pixel of `EDGE_SAMPLES` that still counts as even: as a share of the disk's
/// own range of u, and for the direct image relative to u, because there the light itself may not change evenly.
pub(crate) const EVEN_CHANGE: f64 = 0.25;
pub(crate) const DIRECT_CHANGE: f64 = 0.25;

/// Where some of a pixel's samples lack a crossing: the ratio of the pixel's largest u to the largest of the samples,
/// at most. (With u = 0 where there is no crossing, it would be 2 in a corner.)
pub(crate) const PARTIAL_REACH: f64 = 4.0;

/// How far beyond the disk's outer and inner edge, in 1/r, crossings matter to pixels beside it.
pub(crate) const DISK_REACH: [f64; 2] = [1.5, 1.15];

/// 1/r between which crossings matter to pixels beside the disk's edges `disk_u`.
pub fn reached_u([outer, inner]: [f64; 2]) -> [f64; 2] {
    [outer / DISK_REACH[0], inner * DISK_REACH[1]]
}

/// The disk's edges, as pixels beside them see them.
#[derive(Clone, Copy, Debug)]
pub struct DiskEdges {
    /// 1/r of the outer and the inner one.
    pub u: [f64; 2],
    /// The change of u to the next pixels below which each does not show, because the disk fades out there: a pixel's
    /// centre tells as much as its quarters.
    pub least: [f64; 2],
    /// 1/r at which the disk's light goes to 0, that of the ISCO; infinite where matter shines on its way inwards.
    pub dark_u: f64,
}

impl DiskEdges {
    /// `fading`: over how much of 1/r the disk fades out at each, 0 where it ends sharply.
    pub fn new(u: [f64; 2], fading: [f64; 2], matter: &Matter) -> Self {
        Self { u, least: fading.map(|width| FADING_CHANGE * width), dark_u: dark_u(matter) }
    }
}

/// Whether an edge of the disk that shows runs through the pixel whose crossing lies at `u`, or u changes steeply
/// there; `change`: of u to the next pixel right and down.
pub fn near_disk_edge(u: f64, change: [f64; 2], edges: &DiskEdges) -> bool {
    let sum = change[0].abs() + change[1].abs();
    let [far, near] = edges.u;
    let steep = u >= far && u <= near && is_steep(u, sum, edges.dark_u);
    let shows = |(edge, least): (&f64, &f64)| (u - edge).abs() < EDGE_REACH * sum && sum >= *least;
    steep || edges.u.iter().zip(&edges.least).any(shows)
}

/// `DiskEdges::dark_u`.
pub fn dark_u(matter: &Matter) -> f64 {
    if matter.plunge.is_some() { f64::INFINITY } else { 1.0 / matter.isco }
}

/// Whether the light of a crossing at `u` that changes by so much to the next pixels is not that at the pixel's centre.
pub fn is_steep(u: f64, change: f64, dark_u: f64) -> bool {
    let dim = u < dark_u && change > (DIM_CHANGE * (dark_u - u)).max(LEAST_DIM_CHANGE * dark_u);
    dim || change > STEEP_CHANGE * u
}

/// The edge of a looked-up pixel that lies `curve` pixels from the critical curve and that nothing hides; `turn`: of
/// its sky direction to the next pixels, 0 where its ray is captured.
pub fn looked_up_edge(on_edge: bool, turn: f64, curve: f64) -> Edge {
    let on_edge = if on_edge { Edge::Disk } else { Edge::None };
    if curve < CURVE_REACH { Edge::Curve } else { turning_edge(turn).max(on_edge) }
}

/// The edge of a pixel whose sky direction turns by so much, rad, to the next pixels.
pub fn turning_edge(turn: f64) -> Edge {
    match () {
        () if turn > FAST_TURN => Edge::Curve,
        () if turn > TURN => Edge::Disk,
        () => Edge::None,
    }
}

/// The turn of the sky direction to the next pixels, rad.
pub fn turn_of(footprint: [DVec3; 2]) -> f64 {
    footprint[0].length().hypot(footprint[1].length())
}

/// The place in its pixel, 0 .. 1, of the middle of quarter `index`.
pub fn quarter_place(index: u32) -> [f64; 2] {
    [index & 1, index >> 1 & 1].map(|side| 0.25 + 0.5 * f64::from(side))
}

/// The strips of a pixel along the critical curve. Distances are in pixels, positive where rays escape.
#[derive(Clone, Copy, Debug)]
pub struct Strips {
    /// Unit vector from the curve outwards, in pixels right and down.
    pub(crate) normal: [f64; 2],
    /// The distance of the pixel's centre.
    pub(crate) level: f64,
    /// `spread` of the least and the greatest distance in the pixel.
    range: [f64; 2],
    /// `NARROWEST` or `MATTER_NARROWEST`.
    narrowest: f64,
    /// The number of strips, and of those where rays are captured, which come first.
    count: u32,
    captured: u32,
}

/// A sample's part of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Place in the pixel, 0 .. 1, were the curve straight.
    pub place: [f64; 2],
    /// The distance from the curve, pixels, that it is meant to have.
    pub distance: f64,
    /// The cell's share of the pixel, and of that the share of its first half, that towards captured rays.
    pub weight: f64,
    pub first_half: f64,
}

/// The scale on which strips are of equal width: even near the curve, logarithmic farther away.
pub(crate) fn spread(distance: f64, narrowest: f64) -> f64 {
    (distance / narrowest).asinh()
}

impl Strips {
    /// `level`: the distance of the pixel's centre from the curve; `gradient`, of any length, points away from it;
    /// `samples`: `CURVE_SAMPLES` or `MATTER_CURVE_SAMPLES`.
    pub fn new(level: f64, gradient: [f64; 2], samples: u32) -> Self {
        let length = gradient[0].hypot(gradient[1]);
        let normal = if length > 0.0 { gradient.map(|c| c / length) } else { [1.0, 0.0] };
        let level = level.clamp(-FARTHEST, FARTHEST);
        let reach = 0.5 * (normal[0].abs() + normal[1].abs());
        let (narrowest, density) = match samples {
            CURVE_SAMPLES => (NARROWEST, CAPTURED_DENSITY),
            _ => (MATTER_NARROWEST, MATTER_CAPTURED_DENSITY),
        };
        let range = [level - reach, level + reach].map(|distance| spread(distance, narrowest));
        let (inside, outside) = ((-range[0]).max(0.0) * density, range[1].max(0.0));
        let count = samples / 2;
        let fewest = FEWEST_STRIPS * count / 16;
        let captured = match () {
            () if range[0] >= 0.0 => 0,
            () if range[1] <= 0.0 => count,
            () => {
                let share = f64::from(count) * inside / (inside + outside);
                (share.round() as u32).clamp(fewest, count - fewest)
            }
        };
        Self { normal, level, range, narrowest, count, captured }
    }

    /// The distance at `strip`, a whole number at the begin of one of those on the side `outside` of the curve.
    fn distance(&self, outside: bool, strip: f64) -> f64 {
        let [low, high] = self.range;
        let captured = f64::from(self.captured);
        let (first, last, share) = if outside {
            (low.max(0.0), high, (strip - captured) / (f64::from(self.count) - captured))
        } else {
            (low, high.min(0.0), strip / captured)
        };
        self.narrowest * (first + (last - first) * share).sinh()
    }

    pub fn cell(&self, index: u32) -> Cell {
        let strip = f64::from(index / 2 % self.count);
        let outside = index / 2 % self.count >= self.captured;
        let [begin, middle, end] = [0.0, 0.5, 1.0].map(|part| self.distance(outside, strip + part) - self.level);
        let tangent = [-self.normal[1], self.normal[0]];
        let foot = self.normal.map(|c| c * middle);
        // Where the line leaves the pixel.
        let (mut first, mut last) = (-1.0_f64, 1.0_f64);
        for c in 0..2 {
            if tangent[c].abs() > 1e-6 {
                let [one, other] = [-0.5, 0.5].map(|side| (side - foot[c]) / tangent[c]);
                first = first.max(one.min(other));
                last = last.min(one.max(other));
            }
        }
        let at = first + (last - first) * (0.25 + 0.5 * f64::from(index & 1));
        let [begin, middle_share, end] = [begin, middle, end].map(|distance| share_below(distance, self.normal));
        let share = end - begin;
        Cell {
            place: [0, 1].map(|c| 0.5 + foot[c] + tangent[c] * at),
            distance: self.level + middle,
            weight: 0.5 * share,
            first_half: if share > 0.0 { (middle_share - begin) / share } else { 0.5 },
        }
    }

    /// The place beside a cell's sample where the curve would be, were it straight; in the pixel or not.
    pub fn foot(&self, cell: &Cell) -> [f64; 2] {
        [0, 1].map(|c| cell.place[c] - self.normal[c] * cell.distance)
    }

    /// The place of a cell's sample where that foot is `distance` away from the curve.
    pub fn corrected(&self, cell: &Cell, distance: f64) -> [f64; 2] {
        // Far from the curve it does not matter how it bends.
        let off = if self.level.abs() < BENT { distance.clamp(-0.25, 0.25) } else { 0.0 };
        [0, 1].map(|c| cell.place[c] - self.normal[c] * off)
    }

    /// The samples beside a sample of a strip, before and after it along and across the curve, on the same side of it.
    pub fn beside(&self, index: u32) -> [[Option<u32>; 2]; 2] {
        let strip = index / 2 % self.count;
        let same_side = |other: u32| (other >= self.captured) == (strip >= self.captured);
        let before = strip.checked_sub(1).filter(|other| same_side(*other)).map(|_| index - 2);
        let after = Some(strip + 1).filter(|other| *other < self.count && same_side(*other)).map(|_| index + 2);
        [[(index & 1 == 1).then(|| index - 1), (index & 1 == 0).then(|| index + 1)], [before, after]]
    }
}

/// The quarters beside a quarter, before and after it in its row and its column.
pub fn beside_quarter(index: u32) -> [[Option<u32>; 2]; 2] {
    [1, 2].map(|side| [(index & side != 0).then(|| index - side), (index & side == 0).then(|| index + side)])
}

/// u of the crossing of one order in each quarter of a pixel, row by row; 0 where there is none.
pub struct Crossings {
    pub u: [f64; 4],
    pub disk_u: [f64; 2],
}

impl Crossings {
    /// Whether u may be on the disk and does not change evenly from sample to sample. `direct`: they are of order 0.
    pub fn are_ragged(&self, direct: bool) -> bool {
        let [far, near] = self.disk_u;
        let Some((low, high, all)) = self.range() else { return false };
        let span = high - low;
        if !all {
            // A crossing that some do not have goes through infinity, u = 0, on its way to them, and as steeply on its
            // way to the pixel's corners.
            return PARTIAL_REACH * high >= far;
        }
        let even = (EVEN_CHANGE * (near - far)).min(if direct { DIRECT_CHANGE * high } else { f64::INFINITY });
        span > even && high + span >= far && low - span <= near
    }

    /// Whether all of the pixel lies where the disk hides what is behind it: 1/r within `opaque_u`.
    pub fn cover(&self, [far, near]: [f64; 2]) -> bool {
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
    use crate::scene::cell::CellCrossing;
    use glam::DVec2;
    use std::f64::consts::TAU;

    fn share_on(u: f64, beside: [[f64; 2]; 2], disk_u: [f64; 2]) -> f64 {
        let cell = CellCrossing::new(u, beside);
        cell.covered(cell.levels_on(disk_u)).map_or(0.0, |covered| covered.share)
    }

    /// Curves in all directions and at all distances: cells fill the pixel, samples lie in it, none across the curve
    /// from others of its side, and mirrored pixels have mirrored samples.
    #[test]
    fn strips_fill_the_pixel_on_both_sides_of_the_curve() {
        for (turn, samples) in (0..36).flat_map(|turn| [CURVE_SAMPLES, MATTER_CURVE_SAMPLES].map(|n| (turn, n))) {
            let normal = DVec2::from_angle(TAU * f64::from(turn) / 36.0 + 0.01);
            for level in [-1e9, -2.0, -0.7, -0.4, -1e-3, 0.0, 1e-6, 0.3, 0.69, 0.8, 3.0, 1e9] {
                let strips = Strips::new(level, (normal * 7.0).into(), samples);
                let mirrored = Strips::new(level, [-7.0 * normal.x, 7.0 * normal.y], samples);
                let cells: Vec<_> = (0..samples).map(|i| strips.cell(i)).collect();
                let total = cells.iter().map(|cell| cell.weight).sum::<f64>();
                assert!((total - 1.0).abs() < 1e-9 && cells.iter().all(|cell| cell.weight >= 0.0), "{level}: {total}");
                for (cell, index) in cells.iter().zip(0..) {
                    let place = DVec2::from(cell.place) - 0.5;
                    assert!(place.abs().max_element() < 0.5 + 1e-9, "{level} {normal}: {place}");
                    if level.abs() < FARTHEST {
                        assert!((place.dot(normal) + level - cell.distance).abs() < 1e-9);
                    }
                    assert!((cell.distance > 0.0) == (index / 2 >= strips.captured));
                    let twin = mirrored.cell(index ^ 1).place;
                    assert!((twin[0] - 1.0 + cell.place[0]).abs() < 1e-12 && (twin[1] - cell.place[1]).abs() < 1e-12);
                    for other in strips.beside(index).into_iter().flatten().flatten() {
                        assert!(strips.beside(other).into_iter().flatten().flatten().any(|back| back == index));
                        assert!((cells[other as usize].distance > 0.0) == (cell.distance > 0.0));
                    }
                }
                // The mean of the samples' places is the pixel's centre, but for what strips are curved by.
                let mean: DVec2 = cells.iter().map(|cell| cell.weight * (DVec2::from(cell.place) - 0.5)).sum();
                // Where captured rays have one strip its sample lies nearer to the curve, where more is to be seen.
                let most = if samples == CURVE_SAMPLES { 0.05 } else { 0.25 };
                assert!(mean.length() < most, "{level} {normal}: {mean}");
            }
        }
    }

    /// A ring that is narrow in ln(distance): its light is found wherever it lies.
    #[test]
    fn narrow_rings_are_integrated() {
        let disk_u = [0.05, 0.15];
        let places = (0..64).flat_map(|step| [0.003, 0.03, 0.3].map(|width| (step, width)));
        for ((step, width), samples) in places.flat_map(|at| [CURVE_SAMPLES, MATTER_CURVE_SAMPLES].map(|n| (at, n))) {
            let level = -0.4 + f64::from(step) / 80.0;
            let strips = Strips::new(level, [0.9, 0.5], samples);
            // u falls with the logarithm of the distance, through the disk's range over one e-fold.
            let u_at = |distance: f64| 0.15 - 0.1 * (distance / width).ln();
            let u: Vec<f64> = (0..samples)
                .map(|i| strips.cell(i).distance)
                .map(|d| if d > 0.0 { u_at(d).clamp(0.0, 0.33) } else { 0.0 })
                .collect();
            let found: f64 = (0..samples)
                .filter(|i| u[*i as usize] > 0.0)
                .map(|i| {
                    let beside = strips.beside(i).map(|pair| pair.map(|o| o.map_or(0.0, |o| u[o as usize])));
                    strips.cell(i).weight * share_on(u[i as usize], beside, disk_u)
                })
                .sum();
            let at = |distance: f64| share_below(distance - level, strips.normal);
            let truth = at(width * 1.0_f64.exp()) - at(width);
            let most = if samples == CURVE_SAMPLES { 0.1 * truth + 4e-3 } else { 0.2 * truth + 8e-3 };
            assert!((found - truth).abs() < most, "{level} {width} {samples}: {found} of {truth}");
        }
    }

    #[test]
    fn the_cover_of_an_even_edge_is_exact_and_missing_crossings_are_at_infinity() {
        let disk_u = [0.05, 0.15];
        // u = 0.05 where x + 0.4 y = 0.7.
        let plane = |[x, y]: [f64; 2]| 0.05 + 0.02 * (x + 0.4 * y - 0.7);
        let u = [0, 1, 2, 3].map(|index| plane(quarter_place(index)));
        let share = |u: [f64; 4], index: u32| {
            let beside = beside_quarter(index).map(|pair| pair.map(|other| other.map_or(0.0, |i| u[i as usize])));
            share_on(u[index as usize], beside, disk_u)
        };
        let mean = (0..4).map(|index| share(u, index)).sum::<f64>() / 4.0;
        assert!((mean - 0.5).abs() < 1e-12, "{mean}");
        let crossings = Crossings { u, disk_u };
        assert!(!crossings.are_ragged(false) && !crossings.cover(disk_u));
        assert!(Crossings { u: [0.1, 0.1, 0.0, 0.1], disk_u }.are_ragged(false));
        assert!((share([0.1, 0.1, 0.0, 0.1], 0) - 1.0).abs() < 1e-12);
        // The disk lies between the lower quarters, inside its inner edge, and the upper ones, beyond infinity.
        assert!(Crossings { u: [0.0, 0.0, 0.294, 0.268], disk_u }.are_ragged(false));
        assert!(Crossings { u: [0.1, 0.101, 0.1, 0.101], disk_u }.cover(disk_u));
    }
}
