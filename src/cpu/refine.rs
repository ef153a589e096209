// SPDX-License-Identifier: MIT OR Apache-2.0
//! The second look at a pixel that edges run through: more rays, each for a cell of its own, and their mean light.
//! Mirrored by shaders/refine/refine.wgsl and strips.wgsl; `scene::refine` has the rules. Knows no film.

use super::record::{derivative_of_direction, derivative_of_place};
use super::record_source::RecordSource;
use super::shade::Shading;
use crate::emit::{Crossing, Emission};
use crate::physics::lens::critical::CurveLevel;
use crate::physics::plunge::Matter;
use crate::physics::trace::{CROSSINGS_KEPT, Fate};
use crate::scene::Scene;
use crate::scene::cell::{CellCrossing, Covered};
use crate::scene::observer::Lens;
use crate::scene::record::Record;
use crate::scene::refine::{
    CURVE_REACH, CURVE_SAMPLES, Crossings, EDGE_SAMPLES, EVEN_LEVEL, Edge, FARTHEST, LEVEL_STEP, SEARCH_REACH,
    SEARCH_STEPS, Strips, beside_quarter, curve_samples, quarter_place,
};
use arrayvec::ArrayVec;
use glam::DVec3;
use std::f64::consts::PI;

/// Refines the pixels of a frame.
pub struct Refiner<'a> {
    /// Gives crossings of the whole plane; nothing is hidden in it.
    plane: RecordSource<'a>,
    disk_u: Option<[f64; 2]>,
    matter: Matter,
    spin: f64,
    /// Where the disk hides what is behind it.
    opaque_u: Option<[f64; 2]>,
    lens: &'a Lens,
    level: CurveLevel,
    /// Samples of a pixel that the critical curve runs through.
    curve_samples: u32,
}

/// Where a sample lies, and its cell's share of the pixel.
#[derive(Clone, Copy, Default)]
struct Place {
    at: [f64; 2],
    weight: f64,
    /// `Cell::first_half`; `None`: the cell is not seen in halves.
    first_half: Option<f64>,
}

/// Where the light of a cell comes from: sums over its parts of the light, of it times the difference of u from the
/// crossing's, and of it times that squared.
#[derive(Default)]
struct Lit {
    light: f64,
    off: f64,
    off2: f64,
}

impl Lit {
    /// Adds the light of a part: `off` is the mean of its u less the crossing's, and `spread2` is twelve times the
    /// variance of u over it.
    fn add(&mut self, light: f64, off: f64, spread2: f64) {
        self.light += light;
        self.off += light * off;
        self.off2 += light * (off * off + spread2 / 12.0);
    }

    /// The crossing as the disk's structure is to be seen there: that of the places that the light comes from, which
    /// may be few of those in the cell. `spread2`: twelve times the variance of u over the cell.
    fn crossing(&self, crossing: &Crossing, spread2: f64) -> Crossing {
        let known = self.light > 0.0 && spread2 > 0.0;
        if !known {
            return *crossing;
        }
        let [off, off2] = [self.off, self.off2].map(|sum| sum / self.light);
        crossing.lit_about(crossing.u + off, (12.0 * (off2 - off * off).max(0.0) / spread2).sqrt().min(1.0))
    }
}

/// The records of a pixel's samples, and the samples beside each.
struct Samples<'a> {
    records: &'a [Record],
    beside: &'a dyn Fn(u32) -> [[Option<u32>; 2]; 2],
}

impl<'a> Refiner<'a> {
    /// `plane`: of records of the whole plane (`Recorder::whole_plane`).
    pub fn new(scene: &Scene, lens: &'a Lens, plane: RecordSource<'a>) -> Self {
        let emitters = scene.emitters();
        Self {
            plane,
            disk_u: emitters.disk_u(),
            matter: scene.matter(),
            spin: scene.hole.spin,
            opaque_u: emitters.opaque_u(),
            lens,
            level: CurveLevel::new(&lens.observer.frame),
            curve_samples: curve_samples(emitters.needs().parts),
        }
    }

    /// Light and alpha of the pixel whose centre `at` has the record `here`. `None`: nothing runs through it.
    pub fn light(&self, shading: Shading<'_, '_>, here: &Record, at: [f64; 2]) -> Option<[f64; 4]> {
        let smooth = match here.edge {
            Edge::None => return None,
            Edge::Disk => self.light_of_quarters(shading, at),
            Edge::Curve => None,
        };
        Some(smooth.unwrap_or_else(|| self.light_of_strips(shading, at)))
    }

    /// `None`: they do not suffice, being uneven or near the critical curve.
    fn light_of_quarters(&self, shading: Shading<'_, '_>, at: [f64; 2]) -> Option<[f64; 4]> {
        let places = [0, 1, 2, 3].map(|index| place_about(at, quarter_place(index)));
        let records = places.map(|place| self.sample(place, EDGE_SAMPLES, shading.moment));
        let is_even = match self.evenness(&records, at) {
            Evenness::Ragged => false,
            // The critical curve and thin images may cross the pixel with all samples on one side.
            Evenness::Even => LevelAbout::new(self.lens, &self.level, at).curve_distance() >= CURVE_REACH,
            Evenness::Hidden => true,
        };
        if !is_even {
            return None;
        }
        let samples = Samples { records: &records, beside: &beside_quarter };
        let cell = |index| Place { at: places[index as usize % 4], weight: 0.25, first_half: None };
        Some(self.mean(shading, &samples, cell))
    }

    fn light_of_strips(&self, shading: Shading<'_, '_>, at: [f64; 2]) -> [f64; 4] {
        let level = LevelAbout::new(self.lens, &self.level, at);
        let (strips, slope) = level.strips(self.curve_samples);
        let mut records = ArrayVec::<Record, { CURVE_SAMPLES as usize }>::new();
        let mut places = [Place::default(); CURVE_SAMPLES as usize];
        for (place, index) in places.iter_mut().zip(0..self.curve_samples) {
            let cell = strips.cell(index);
            let distance = level.at(strips.foot(&cell).map(|c| c - 0.5)) / slope;
            let at = place_about(at, strips.corrected(&cell, distance));
            *place = Place { at, weight: cell.weight, first_half: Some(cell.first_half) };
            records.push(self.sample(at, self.curve_samples, shading.moment));
        }
        let beside = |index| strips.beside(index);
        let samples = Samples { records: &records, beside: &beside };
        self.mean(shading, &samples, |index| places[(index % CURVE_SAMPLES) as usize])
    }

    /// The record at a place, one of `rays` of its pixel, without footprints.
    fn sample(&self, [x, y]: [f64; 2], rays: u32, moment: f64) -> Record {
        match &self.plane {
            RecordSource::LensLookup(lookup) => {
                let mut record = Record::captured();
                lookup.sample(x, y, &mut record);
                record
            }
            RecordSource::Traced(recorder) => recorder.trace_among(x, y, rays, moment),
        }
    }

    /// The mean light of cells.
    fn mean(&self, shading: Shading<'_, '_>, samples: &Samples<'_>, place: impl Fn(u32) -> Place) -> [f64; 4] {
        let (mut sum, mut total) = ([0.0; 4], 0.0);
        for index in 0..samples.records.len() as u32 {
            let Place { at: [x, y], weight, first_half } = place(index);
            let Some(record) = samples.completed(index) else { continue };
            let light = shading.shade_record_with(&record, x, y, |crossing, open| {
                let mut emission = Emission { light: [0.0; 3], opacity: 0.0 };
                let mut lit = Lit::default();
                for (part, weight, spread2) in self.seen_parts(samples, index, crossing, first_half) {
                    let seen = shading.shader.emission(&record, &part, open);
                    (0..3).for_each(|c| emission.light[c] += weight * seen.light[c]);
                    emission.opacity += weight * seen.opacity;
                    lit.add(weight * seen.light.iter().sum::<f64>(), part.u - crossing.u, spread2);
                }
                (emission, lit.crossing(crossing, samples.over_cell(index, crossing).spread2()))
            });
            (0..4).for_each(|c| sum[c] += weight * light[c]);
            total += weight;
        }
        sum.map(|v: f64| v / total.max(f64::MIN_POSITIVE))
    }

    /// A crossing of sample `index` in the two parts of its cell in which it is seen, as crossings of their own: the
    /// halves of a strip's cell, of which the first is `first_half` of it, or two ranges of u; with a weight of each,
    /// and its `spread2`. Those that the disk does not cover are left out.
    fn seen_parts(
        &self,
        samples: &Samples<'_>,
        index: u32,
        crossing: &Crossing,
        first_half: Option<f64>,
    ) -> ArrayVec<(Crossing, f64, f64), 2> {
        let (Some(disk_u), Some(record)) = (self.disk_u, samples.records.get(index as usize)) else {
            return ArrayVec::new();
        };
        let cell = samples.over_cell(index, crossing);
        let parts = match first_half {
            Some(first) => [(-1.0, first), (1.0, 1.0 - first)].map(|(side, weight)| {
                let half = cell.half(side);
                (half, half.levels_on(disk_u), weight)
            }),
            None => {
                let [low, high] = cell.levels_on(disk_u);
                let middle = 0.5 * (low + high);
                [[low, middle], [middle, high]].map(|levels| (cell, levels, 1.0))
            }
        };
        let ray = [record.energy, record.angular_momentum, record.sky_redshift * record.energy];
        let seen = parts.into_iter().filter_map(|(part, levels, weight)| {
            let Covered { share, u } = part.covered(levels)?;
            let u = u.max(disk_u[0]).min(disk_u[1]);
            let g = self.matter.redshift_beside(self.spin, ray, u, [crossing.u, crossing.g]);
            Some((Crossing { u, g, share, ..*crossing }, weight, part.spread2_between(levels)))
        });
        seen.collect()
    }

    /// How evenly the samples of the pixel about `at` change from one to the next.
    fn evenness(&self, records: &[Record; 4], [x, y]: [f64; 2]) -> Evenness {
        let opaque_u = self.opaque_u.filter(|_| self.plane.recorder().is_whole(x, y));
        let of =
            |record: &Record, order: usize| record.crossings.iter().find(|c| c.order as usize == order).map(|c| c.u);
        for order in 0..CROSSINGS_KEPT {
            let Some(disk_u) = self.disk_u else { break };
            let crossings = Crossings { u: records.each_ref().map(|record| of(record, order).unwrap_or(0.0)), disk_u };
            if crossings.are_ragged(order == 0) {
                return Evenness::Ragged;
            }
            if opaque_u.is_some_and(|opaque_u| crossings.cover(opaque_u)) {
                return Evenness::Hidden;
            }
        }
        let [first, rest @ ..] = records;
        let differs = rest.iter().any(|other| other.fate != first.fate);
        if differs { Evenness::Ragged } else { Evenness::Even }
    }
}

impl<'a> Samples<'a> {
    /// The records beside that of a sample.
    fn beside(&self, index: u32) -> [[Option<&'a Record>; 2]; 2] {
        (self.beside)(index).map(|pair| pair.map(|other| other.and_then(|other| self.records.get(other as usize))))
    }

    /// The record of a sample with the footprints of its cell.
    fn completed(&self, index: u32) -> Option<Record> {
        let mut record = self.records.get(index as usize)?.clone();
        let beside = self.beside(index);
        if record.fate == Fate::Escaped {
            record.footprint = beside.map(|[before, after]| {
                let change = derivative_of_direction(&record, before, after);
                with_whole_turns(change, record.direction, change_of_turn(&record, before, after))
            });
        }
        for crossing in &mut record.crossings {
            crossing.footprint = beside.map(|[before, after]| derivative_of_place(crossing, before, after));
        }
        Some(record)
    }

    /// A crossing of a sample over its cell.
    fn over_cell(&self, index: u32, crossing: &Crossing) -> CellCrossing {
        let same = |there: Option<&Record>| {
            there.and_then(|there| there.crossings.iter().find(|c| c.order == crossing.order)).map_or(0.0, |c| c.u)
        };
        CellCrossing::new(crossing.u, self.beside(index).map(|pair| pair.map(same)))
    }
}

/// How evenly a pixel changes from one of its quarters to the next.
enum Evenness {
    /// So unevenly that more samples are needed.
    Ragged,
    Even,
    /// Evenly, and the disk hides all that lies behind it.
    Hidden,
}

/// The change of `Record::turned` as `derivative_of_direction`, if that spans more than half a turn; else 0.
fn change_of_turn(here: &Record, before: Option<&Record>, after: Option<&Record>) -> f64 {
    let turned = |there: Option<&Record>| there.filter(|r| r.fate == Fate::Escaped).map(|r| r.turned);
    let (before, after) = (turned(before), turned(after));
    let share = if before.is_some() && after.is_some() { 0.5 } else { 1.0 };
    let all = after.unwrap_or(here.turned) - before.unwrap_or(here.turned);
    if all.abs() > PI { share * all } else { 0.0 }
}

/// A cell's change of the sky direction `d`, of which the part about the hole's axis is `turn`, unless that is 0.
/// Beside the shadow of a fast hole, on the side where its spin carries light along, rays wind about the axis by
/// several turns for each e-fold of their distance from the curve (Teo 2003, Gen. Relativ. Gravit. 35, 1909): from one
/// strip to the next by more than a turn, which the difference of the directions does not tell.
pub(crate) fn with_whole_turns(change: DVec3, d: DVec3, turn: f64) -> DVec3 {
    let around = DVec3::new(-d.y, d.x, 0.0);
    let length2 = around.length_squared().max(f64::MIN_POSITIVE);
    if turn == 0.0 { change } else { change + around * (turn - change.dot(around) / length2) }
}

/// The position of a sample at `place`, 0 .. 1, in the pixel about `at`.
fn place_about(at: [f64; 2], place: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| at[i] + place[i] - 0.5)
}

/// The level of the critical curve (`CurveLevel::at`) about a pixel: that of the image plane or its tangent there, so
/// that it goes on beyond the border of a cube's face.
pub(crate) struct LevelAbout<'a> {
    lens: &'a Lens,
    level: &'a CurveLevel,
    /// A point in the direction seen at the pixel's centre, and its changes to the next pixel right and down.
    point: DVec3,
    changes: [DVec3; 2],
}

impl<'a> LevelAbout<'a> {
    pub(crate) fn new(lens: &'a Lens, level: &'a CurveLevel, [x, y]: [f64; 2]) -> Self {
        let changes = lens.mapping.changes(x, y).map(|change| lens.axes * change);
        Self { lens, level, point: lens.axes * lens.mapping.point(x, y), changes }
    }

    /// At so many pixels right of the pixel's centre and below it.
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let look = (self.point + self.changes[0] * x + self.changes[1] * y).normalize();
        self.level.at(self.lens.observer.aberrate(look).0)
    }

    /// The change of the level to the next pixel right and down.
    fn change(&self) -> [f64; 2] {
        [[LEVEL_STEP, 0.0], [0.0, LEVEL_STEP]].map(|[x, y]| (self.at([x, y]) - self.at([-x, -y])) / (2.0 * LEVEL_STEP))
    }

    /// The curve's distance from the pixel's centre, pixels, if the level is linear.
    pub(crate) fn curve_distance(&self) -> f64 {
        let [right, down] = self.change();
        self.at([0.0; 2]).abs() / right.hypot(down).max(f64::MIN_POSITIVE)
    }

    /// The strips of the pixel for so many samples, and the change of the level in a pixel across the curve.
    pub(crate) fn strips(&self, samples: u32) -> (Strips, f64) {
        let change = self.change();
        let steepness = change[0].hypot(change[1]).max(f64::MIN_POSITIVE);
        let along = |part: f64| self.at(change.map(|c| c / steepness * part));
        let here = along(0.0);
        let step = -here / steepness;
        if step.abs() >= FARTHEST {
            return (Strips::new(-step, change, samples), steepness);
        }
        // Nearly everywhere one step of Newton's method does.
        let rest = along(step) / steepness;
        if step.abs() < SEARCH_REACH && rest.abs() <= EVEN_LEVEL {
            return (Strips::new(rest - step, change, samples), steepness);
        }
        let (mut low, mut high) = ([-SEARCH_REACH, along(-SEARCH_REACH)], [SEARCH_REACH, along(SEARCH_REACH)]);
        if !(low[1] < 0.0 && high[1] > 0.0) {
            return (Strips::new(here / steepness, change, samples), steepness);
        }
        if here > 0.0 {
            high = [0.0, here]
        } else {
            low = [0.0, here]
        }
        // Near the axis of a fast hole the level is far from even.
        let (mut found, mut side) = (0.0, 0.0);
        for _ in 0..SEARCH_STEPS {
            found = (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1]);
            let value = along(found);
            if value > 0.0 {
                high = [found, value];
                low[1] *= if side > 0.0 { 0.5 } else { 1.0 };
                side = 1.0;
            } else {
                low = [found, value];
                high[1] *= if side < 0.0 { 0.5 } else { 1.0 };
                side = -1.0;
            }
        }
        let slope = (along(found + LEVEL_STEP) - along(found - LEVEL_STEP)) / (2.0 * LEVEL_STEP);
        (Strips::new(-found, change, samples), slope.max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::lens::LensLookup;
    use crate::cpu::record::Recorder;
    use crate::cpu::tables::LensCache;
    use crate::scene::{KerrThreshold, LensTables, Region};

    /// The shares of a frame's pixels that are refined for an edge of the disk and for the critical curve.
    fn shares_refined(scene: &Scene) -> [f64; 2] {
        let region = Region { full_width: 960, full_height: 540, x: 0, y: 0 };
        let lens = scene.lens(&region).expect("a lens");
        let observer = lens.observer.frame;
        let mut cache = LensCache::default();
        let lensing = scene.lensing(&observer, 1 << 20, KerrThreshold::CPU);
        let tables = cache.tables(scene, &observer, lensing).expect("tables").expect("a scene that is looked up");
        let lookup = LensLookup::new(Recorder::new(scene, &lens, &[]), tables);
        let (mut record, mut counts) = (Record::captured(), [0; 2]);
        for (x, y) in (0..region.full_height).flat_map(|y| (0..region.full_width).map(move |x| (x, y))) {
            lookup.record(f64::from(x) + 0.5, f64::from(y) + 0.5, &mut record);
            match record.edge {
                Edge::None => {}
                Edge::Disk => counts[0] += 1,
                Edge::Curve => counts[1] += 1,
            }
        }
        counts.map(|count| f64::from(count) / f64::from(region.full_width * region.full_height))
    }

    /// An edge that fades over many pixels needs no more rays than the rest of the disk, but where the disk's light
    /// goes to 0 at the ISCO, and what lies behind the disk's opaque part needs none.
    #[test]
    fn soft_edges_are_refined_in_thin_images_only() {
        for spin in [0.0, 0.9] {
            let mut scene = Scene::default();
            (scene.hole.spin, scene.quality.lens_tables) = (spin, LensTables::Always);
            let [soft, curve] = shares_refined(&scene);
            scene.disk.as_mut().expect("a disk").edge_softness = 0.0;
            let [sharp, sharp_curve] = shares_refined(&scene);
            println!("spin {spin}: soft {soft:.5} and {curve:.5}, sharp {sharp:.5} and {sharp_curve:.5}");
            assert!(soft < 0.8 * sharp && soft > 0.0, "spin {spin}: {soft} {sharp}");
            assert!(curve < 0.01 && curve > 0.0, "spin {spin}: {curve}");
        }
    }
}
