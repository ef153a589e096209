//! The second look at a pixel that edges run through: more rays, on edges of the disk its cover of each one's cell,
//! and their mean light. Mirrored by shaders/refine/refine.wgsl; `scene::refine` has the rules. Knows no film.

use super::frame::RecordSource;
use super::shade::Shader;
use crate::physics::lens::critical::shadow_centre;
use crate::physics::trace::CROSSINGS_KEPT;
use crate::scene::Scene;
use crate::scene::observer::Lens;
use crate::scene::record::{Record, UNKNOWN_EMISSION_POINT};
use crate::scene::refine::{CURVE_SAMPLES, Crossings, Edge, curve_place, quarter_place};
use glam::DVec3;

/// Refines the pixels of a frame.
pub struct Refiner<'a> {
    /// Gives crossings of the whole plane; nothing is hidden in it.
    plane: RecordSource<'a>,
    plane_u: Option<[f64; 2]>,
    disk_u: Option<[f64; 2]>,
    opaque: bool,
    lens: &'a Lens,
    /// The shadow's centre.
    shadow: DVec3,
}

impl<'a> Refiner<'a> {
    /// `plane`: of records of the whole plane (`Recorder::whole_plane`).
    pub fn new(scene: &Scene, lens: &'a Lens, plane: RecordSource<'a>) -> Self {
        let emitters = scene.emitters();
        let (plane_u, disk_u) = (emitters.plane_u(), emitters.disk_u());
        let opaque = emitters.opaque_u().is_some();
        Self { plane, plane_u, disk_u, opaque, lens, shadow: shadow_centre(&lens.observer.frame) }
    }

    /// Light and alpha of the pixel whose centre `at` has the record `here`; `source`: of the frame's records. `None`:
    /// nothing runs through it.
    pub fn light(
        &self,
        shader: &Shader<'_>,
        source: &RecordSource<'_>,
        here: &Record,
        at: [f64; 2],
    ) -> Option<[f64; 4]> {
        let smooth = match here.edge {
            Edge::None => return None,
            Edge::Disk => self.smooth_light(shader, here, at),
            Edge::Curve => None,
        };
        Some(smooth.unwrap_or_else(|| self.counted_light(shader, source, here, at)))
    }

    /// The light from how much the disk covers the cells of a few samples. `None`: what the samples show cannot change
    /// evenly from one to the next.
    fn smooth_light(&self, shader: &Shader<'_>, here: &Record, at: [f64; 2]) -> Option<[f64; 4]> {
        let places = [0, 1, 2, 3].map(|index| place_about(at, quarter_place(index)));
        let mut records = places.map(|place| sample(&self.plane, here, place));
        let orders = self.orders(&records);
        if self.are_ragged(&records, &orders) {
            return None;
        }
        for (record, index) in records.iter_mut().zip(0..) {
            for crossing in &mut record.crossings {
                let of_order = orders.as_ref().and_then(|orders| orders.get(crossing.order as usize));
                crossing.share = of_order.map_or(0.0, |crossings| crossings.covered_share(index));
                if let Some([outer, inner]) = self.plane_u {
                    // Where nothing shines g may be no number at all.
                    if crossing.share == 0.0 && !(crossing.u >= outer && crossing.u <= inner) {
                        crossing.g = 1.0;
                    }
                    crossing.u = crossing.u.clamp(outer, inner);
                }
            }
        }
        Some(mean(records.iter().zip(places).map(|(record, [x, y])| shader.shade_record(record, x, y))))
    }

    /// The light from many samples, each counted as it falls.
    fn counted_light(&self, shader: &Shader<'_>, source: &RecordSource<'_>, here: &Record, at: [f64; 2]) -> [f64; 4] {
        let across = self.lens.across(self.shadow, at);
        mean((0..CURVE_SAMPLES).map(|index| {
            let [x, y] = place_about(at, curve_place(index, across));
            shader.shade_record(&sample(source, here, [x, y]), x, y)
        }))
    }

    /// The samples' crossings by order. `None`: there is no disk.
    fn orders(&self, records: &[Record; 4]) -> Option<[Crossings; CROSSINGS_KEPT]> {
        let disk_u = self.disk_u?;
        let of =
            |record: &Record, order: usize| record.crossings.iter().find(|c| c.order as usize == order).map(|c| c.u);
        Some(std::array::from_fn(|order| Crossings {
            u: records.each_ref().map(|record| of(record, order).unwrap_or(0.0)),
            disk_u,
        }))
    }

    fn are_ragged(&self, records: &[Record; 4], orders: &Option<[Crossings; CROSSINGS_KEPT]>) -> bool {
        for (crossings, order) in orders.iter().flatten().zip(0..) {
            if crossings.are_ragged(order == 0) {
                return true;
            }
            if self.opaque && crossings.cover() {
                return false;
            }
        }
        let [first, rest @ ..] = records;
        rest.iter().any(|other| other.fate != first.fate)
    }
}

/// The position of a sample at `place`, 0 .. 1, in the pixel about `at`.
fn place_about(at: [f64; 2], place: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| at[i] + place[i] - 0.5)
}

/// The record of the sample at a place. A traced one's footprints are those of the pixel's own record `here`, where
/// that has any.
fn sample(source: &RecordSource<'_>, here: &Record, [x, y]: [f64; 2]) -> Record {
    match source {
        RecordSource::LensLookup(lookup) => {
            let mut record = Record::captured();
            lookup.sample(x, y, &mut record);
            record
        }
        RecordSource::Traced(recorder) => {
            let mut record = recorder.trace(x, y);
            record.footprint = here.footprint;
            for crossing in &mut record.crossings {
                let same = here.crossings.iter().find(|c| c.order == crossing.order);
                crossing.footprint = same.map_or([UNKNOWN_EMISSION_POINT; 2], |c| c.footprint);
            }
            record
        }
    }
}

fn mean(lights: impl Iterator<Item = [f64; 4]>) -> [f64; 4] {
    let (sum, count) =
        lights.fold(([0.0; 4], 0.0), |(sum, count), light| (std::array::from_fn(|c| sum[c] + light[c]), count + 1.0));
    sum.map(|v: f64| v / count)
}
