//! Ray records of pixels, made by tracing each ray in f64; derivatives come from the neighbours' rays.

use crate::physics::geodesic::{Constants, wrap_angle};
use crate::physics::orbit::redshift;
use crate::physics::trace::{Fate, RayTrace, Settings, trace_look};
use crate::scene::Scene;
use crate::scene::observer::Lens;
use crate::scene::projection::Mapping;
use crate::scene::record::{DiskCrossing, Record, UNKNOWN_DIRECTION, UNKNOWN_PLACE};
use crate::scene::turbulence::Place;
use glam::DVec3;

/// What traces the records of a frame.
pub struct Recorder<'a> {
    pub lens: &'a Lens,
    pub(super) settings: Settings,
    pub(super) disk_u: Option<[f64; 2]>,
    pub(super) retrograde: bool,
}

/// The records one pixel to the left, right, above and below.
pub struct Neighbours<'a> {
    pub left: &'a Record,
    pub right: &'a Record,
    pub above: &'a Record,
    pub below: &'a Record,
}

impl<'a> Recorder<'a> {
    pub fn new(scene: &Scene, lens: &'a Lens) -> Self {
        Self { lens, settings: scene.pixel_settings(), disk_u: scene.disk_u(), retrograde: scene.retrograde() }
    }

    /// The record of position (x, y) of the full frame, without footprints.
    pub fn trace(&self, x: f64, y: f64) -> Record {
        let observer = &self.lens.observer;
        let (n, frequency_ratio) = observer.look(self.lens.look(x, y));
        let (constants, traced) = trace_look(&observer.frame, n, &self.settings);
        let mut record = Record {
            fate: traced.fate,
            direction: traced.direction,
            steps: traced.steps,
            plane_u: traced.crossings.first().map_or(0.0, |c| c.u),
            ..Record::captured()
        };
        if let Some(c) = constants {
            self.complete(&mut record, &c, &traced, frequency_ratio);
        }
        record
    }

    fn complete(&self, record: &mut Record, c: &Constants, traced: &RayTrace, frequency_ratio: f64) {
        record.energy = c.energy / c.nu_local;
        record.angular_momentum = c.angular_momentum / c.nu_local;
        if record.fate == Fate::Escaped {
            record.sky_redshift = frequency_ratio / record.energy;
        }
        let Some([outer, inner]) = self.disk_u else { return };
        let within = |u: f64| u >= outer && u <= inner;
        record.crossings.extend(traced.crossings.iter().filter(|x| within(x.u)).map(|x| DiskCrossing {
            u: x.u,
            order: x.order,
            g: frequency_ratio * redshift(c.a, x.u, self.retrograde, c.energy, c.angular_momentum, c.nu_local),
            place: Place { ln_r: -x.u.ln(), azimuth: x.azimuth, delay: x.delay },
            footprint: [UNKNOWN_PLACE; 2],
        }));
    }
}

impl<'a> Neighbours<'a> {
    /// Of the position at x: a neighbour on another face of a cube counts as none, for which `stranger`, captured, stands.
    pub fn apart(self, mapping: &Mapping, x: f64, stranger: &'a Record) -> Self {
        let or_stranger = |record, there| if mapping.same_face(x, there) { record } else { stranger };
        Self { left: or_stranger(self.left, x - 1.0), right: or_stranger(self.right, x + 1.0), ..self }
    }

    /// `here` with its footprints.
    pub fn complete(&self, here: &Record) -> Record {
        let mut record = here.clone();
        let pairs = [(self.left, self.right), (self.above, self.below)];
        if here.fate == Fate::Escaped {
            record.footprint = pairs.map(|(before, after)| derivative_of_direction(here, before, after));
        }
        for crossing in &mut record.crossings {
            crossing.footprint = pairs.map(|(before, after)| derivative_of_place(crossing, before, after));
        }
        record
    }
}

/// d(sky direction) / d(pixel): central where both neighbours escaped, else one-sided.
fn derivative_of_direction(here: &Record, before: &Record, after: &Record) -> DVec3 {
    match (before.fate == Fate::Escaped, after.fate == Fate::Escaped) {
        (true, true) => 0.5 * (after.direction - before.direction),
        (false, true) => after.direction - here.direction,
        (true, false) => here.direction - before.direction,
        (false, false) => UNKNOWN_DIRECTION,
    }
}

/// d(place) / d(pixel) of a crossing, from the crossings of its order of two neighbours, as `derivative_of_direction`.
fn derivative_of_place(here: &DiskCrossing, before: &Record, after: &Record) -> Place {
    let same = |record: &Record| record.crossings.iter().find(|c| c.order == here.order).map(|c| c.place);
    let (before, after) = (same(before), same(after));
    if before.is_none() && after.is_none() {
        return UNKNOWN_PLACE;
    }
    let share = if before.is_some() && after.is_some() { 0.5 } else { 1.0 };
    let (first, last) = (before.unwrap_or(here.place), after.unwrap_or(here.place));
    Place {
        ln_r: share * (last.ln_r - first.ln_r),
        azimuth: share * wrap_angle(last.azimuth - first.azimuth),
        delay: share * (last.delay - first.delay),
    }
}
