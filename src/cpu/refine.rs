//! The second look at a pixel that edges run through: more rays, the disk's cover of each one's cell, and their mean light. Mirrored by
//! shaders/refine.wgsl; `scene::refine` has the rules. Knows no film.

use super::frame::Source;
use super::shade::Shader;
use crate::physics::trace::{CROSSINGS_KEPT, Fate};
use crate::scene::Scene;
use crate::scene::record::{Record, UNKNOWN_PLACE};
use crate::scene::refine::{CURVE_GRID, Crossings, EDGE_GRID, Edge, sample_place};

/// What refines the pixels of a frame.
pub struct Refiner<'a> {
    /// Gives crossings of the whole plane; nothing is hidden in it.
    source: Source<'a>,
    disk_u: Option<[f64; 2]>,
    opaque: bool,
}

/// Samples of one pixel, row by row: their records, and u of their crossings by order, 0 where there is none.
struct Samples {
    grid: u32,
    records: Vec<Record>,
    u: [Vec<f64>; CROSSINGS_KEPT],
}

impl<'a> Refiner<'a> {
    /// `source`: of records of the whole plane (`Recorder::whole_plane`).
    pub fn new(scene: &Scene, source: Source<'a>) -> Self {
        Self { source, disk_u: scene.disk_u(), opaque: scene.disk.is_some_and(|disk| disk.opacity >= 1.0) }
    }

    /// Light and alpha of the pixel whose centre (x, y) has the record `here`. `None`: nothing runs through it.
    pub fn light(&self, shader: &Shader<'_>, here: &Record, x: f64, y: f64) -> Option<[f64; 4]> {
        let mut samples = match here.edge {
            Edge::None => return None,
            Edge::Disk => self.samples(here, [x, y], EDGE_GRID),
            Edge::Curve => self.samples(here, [x, y], CURVE_GRID),
        };
        if samples.grid == EDGE_GRID && self.is_ragged(&samples) {
            samples = self.samples(here, [x, y], CURVE_GRID);
        }
        self.cover(&mut samples);
        let mut sum = [0.0; 4];
        for record in &samples.records {
            let light = shader.pixel_light(record);
            (0..4).for_each(|c| sum[c] += light[c]);
        }
        Some(sum.map(|v| v / samples.records.len() as f64))
    }

    fn samples(&self, here: &Record, [x, y]: [f64; 2], grid: u32) -> Samples {
        let count = (grid * grid) as usize;
        let mut samples =
            Samples { grid, records: Vec::with_capacity(count), u: std::array::from_fn(|_| vec![0.0; count]) };
        for (index, i) in (0..grid * grid).zip(0..) {
            let [dx, dy] = sample_place([index % grid, index / grid], grid);
            let record = self.record(here, x + dx - 0.5, y + dy - 0.5);
            for crossing in &record.crossings {
                if let Some(u) = samples.u.get_mut(crossing.order as usize).and_then(|u| u.get_mut::<usize>(i)) {
                    *u = crossing.u;
                }
            }
            samples.records.push(record);
        }
        samples
    }

    /// A traced sample's footprints are those of the pixel's own record, where that has any.
    fn record(&self, here: &Record, x: f64, y: f64) -> Record {
        match &self.source {
            Source::LookedUp(lookup) => {
                let mut record = Record::captured();
                lookup.record(x, y, &mut record);
                record
            }
            Source::Traced(recorder) => {
                let mut record = recorder.trace(x, y);
                record.footprint = here.footprint;
                for crossing in &mut record.crossings {
                    let same = here.crossings.iter().find(|c| c.order == crossing.order);
                    crossing.footprint = same.map_or([UNKNOWN_PLACE; 2], |c| c.footprint);
                }
                record
            }
        }
    }

    fn crossings<'b>(&self, samples: &'b Samples, order: usize) -> Option<Crossings<'b>> {
        let (disk_u, u) = (self.disk_u?, samples.u.get(order)?);
        Some(Crossings { u, grid: samples.grid, disk_u })
    }

    /// Whether what samples show cannot change evenly from one to the next.
    fn is_ragged(&self, samples: &Samples) -> bool {
        for order in 0..CROSSINGS_KEPT {
            let Some(crossings) = self.crossings(samples, order) else { break };
            if crossings.are_ragged(order == 0) {
                return true;
            }
            if self.opaque && crossings.cover() {
                return false;
            }
        }
        let fate = |record: &Record| record.fate;
        samples.records.iter().map(fate).any(|other| samples.records.first().map_or(Fate::Captured, fate) != other)
    }

    /// Gives crossings their share of their cell, and keeps those that have any.
    fn cover(&self, samples: &mut Samples) {
        let mut records = std::mem::take(&mut samples.records);
        for (record, index) in records.iter_mut().zip(0..) {
            let cell = [index % samples.grid, index / samples.grid];
            for crossing in &mut record.crossings {
                let of_order = self.crossings(samples, crossing.order as usize);
                crossing.share = of_order.map_or(0.0, |crossings| crossings.covered_share(cell));
                if let Some([outer, inner]) = self.disk_u {
                    crossing.u = crossing.u.clamp(outer, inner);
                }
            }
            record.crossings.retain(|crossing| crossing.share > 0.0);
        }
        samples.records = records;
    }
}
