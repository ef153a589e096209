// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ray records of pixels, made by tracing each ray in f64; derivatives come from the neighbours' rays.

use crate::emit::along::{Limit, MediaAlong};
use crate::emit::baked::Baked;
use crate::emit::medium::{Media, Medium};
use crate::emit::volumes::Seen;
use crate::emit::{Crossing, EmissionPoint, Emitters};
use crate::physics::geodesic::{Constants, wrap_angle};
use crate::physics::plunge::Matter;
use crate::physics::trace::{Fate, RayTrace, Settings, trace_look, trace_look_visited};
use crate::scene::observer::Lens;
use crate::scene::occluder::{BEYOND_ALL, Shown};
use crate::scene::projection::Mapping;
use crate::scene::record::{Record, UNKNOWN_DIRECTION, UNKNOWN_EMISSION_POINT, polar_momentum};
use crate::scene::refine::{Edge, dark_u, is_steep, turning_edge};
use crate::scene::{Occluder, Scene};
use glam::DVec3;
use std::sync::Arc;

/// Traces the records of a frame.
pub struct Recorder<'a> {
    pub lens: &'a Lens,
    pub(super) settings: Settings,
    pub(super) emitters: Emitters,
    /// 1/r between which crossings are kept, and of the disk's edges.
    pub(super) plane_u: Option<[f64; 2]>,
    pub(super) disk_u: Option<[f64; 2]>,
    pub(super) matter: Matter,
    occluder: Option<Occluder>,
    mass: f64,
}

/// The records one pixel to the left, right, above and below; none across a border between two faces of a cube.
pub struct Neighbours<'a> {
    pub left: Option<&'a Record>,
    pub right: Option<&'a Record>,
    pub above: Option<&'a Record>,
    pub below: Option<&'a Record>,
}

impl<'a> Recorder<'a> {
    /// `structure`: that of the volumes ([`super::tables::LensCache::structure`]).
    pub fn new(scene: &Scene, lens: &'a Lens, structure: &[Option<Arc<Baked>>]) -> Self {
        let mut emitters = scene.emitters();
        emitters.volumes.baked = structure.to_vec();
        Self {
            lens,
            settings: scene.pixel_settings(),
            plane_u: emitters.plane_u(),
            disk_u: emitters.disk_u(),
            emitters,
            matter: scene.matter(),
            occluder: scene.occluder.clone(),
            mass: scene.hole.mass,
        }
    }

    /// A recorder that gives crossings of the whole plane, unless nothing shines in it, and goes on behind those that
    /// would hide the rest.
    pub fn whole_plane(scene: &Scene, lens: &'a Lens, structure: &[Option<Arc<Baked>>]) -> Self {
        let mut recorder = Self::new(scene, lens, structure);
        recorder.settings.opaque_u = None;
        recorder.plane_u = recorder.plane_u.map(|_| [0.0, f64::INFINITY]);
        recorder.disk_u = recorder.plane_u;
        recorder
    }

    /// The record of position (x, y) of the full frame, without footprints, at the frame's time.
    pub fn trace(&self, x: f64, y: f64) -> Record {
        self.trace_among(x, y, 1, 0.0)
    }

    /// The record of position (x, y), as one of `rays` of a pixel, `moment` after the frame's time, M.
    pub fn trace_among(&self, x: f64, y: f64, rays: u32, moment: f64) -> Record {
        self.trace_with(x, y, self.emitters.needs().parts, (rays, moment))
    }

    /// The record of position (x, y), without the matter along the ray.
    pub fn trace_bare(&self, x: f64, y: f64) -> Record {
        self.trace_with(x, y, false, (1, 0.0))
    }

    /// The settings of the ray through (x, y): what hides the rest of it may itself be hidden by the host's things.
    fn settings_at(&self, x: f64, y: f64) -> Settings {
        Settings { opaque_u: self.opaque_u_at(x, y), ..self.settings }
    }

    /// 1/r between which a crossing hides the rest of the ray through (x, y).
    pub(super) fn opaque_u_at(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        self.settings.opaque_u.filter(|_| self.is_whole(x, y))
    }

    /// Whether none of the host's things is before the ray through (x, y).
    pub(super) fn is_whole(&self, x: f64, y: f64) -> bool {
        self.occluder.as_ref().is_none_or(|occluder| occluder.at(x, y) / self.mass >= BEYOND_ALL)
    }

    /// How far the matter along the ray through (x, y) is seen before the host's things.
    fn limit(&self, x: f64, y: f64) -> Option<Limit> {
        let occluder = self.occluder.as_ref()?;
        let farthest = occluder.at(x, y) / self.mass;
        let ends = Shown::new(farthest, self.lens.closest_approach(x, y), occluder.lensed).ends;
        let eye = self.lens.observer.frame.e_r * self.lens.observer.frame.r;
        (farthest < f64::INFINITY).then_some(Limit { eye, farthest, ends, ended: false })
    }

    fn trace_with(&self, x: f64, y: f64, parts: bool, (rays, moment): (u32, f64)) -> Record {
        let observer = &self.lens.observer;
        let (n, frequency_ratio) = observer.aberrate(self.lens.look_direction(x, y));
        let settings = self.settings_at(x, y);
        let (constants, traced, media) = if parts {
            let (emitters, plane_u) = (&self.emitters, self.plane_u);
            let (media, medium) = (Media::new(), Medium::default());
            // Aberration makes angles as much smaller as frequencies larger.
            let pixel_angle = self.lens.mapping.pixel_angle * frequency_ratio;
            let static_observer = observer.frame.static_observer();
            let seen = Seen { frequency_ratio, static_observer, pixel_angle, swept: 0.0, rays, moment };
            let limit = self.limit(x, y);
            let mut along = MediaAlong { emitters, seen, plane_u, media, medium, limit };
            let (constants, traced) = trace_look_visited(&observer.frame, n, &settings, &mut along);
            (constants, traced, along.finish())
        } else {
            let (constants, traced) = trace_look(&observer.frame, n, &settings);
            (constants, traced, Media::new())
        };
        let mut record = Record {
            fate: traced.fate,
            direction: traced.direction,
            turned: traced.turned,
            steps: traced.steps,
            plane_u: traced.crossings.first().map_or(0.0, |c| c.u),
            media,
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
        record.polar_momentum = polar_momentum(c, frequency_ratio);
        record.sky_redshift = frequency_ratio / record.energy;
        let Some([outer, inner]) = self.plane_u else { return };
        let within = |u: f64| u >= outer && u <= inner;
        let edge = self.disk_u.map_or(inner, |[_, inner]| inner);
        // Crossings that are kept outside the disk count as well, so that those on the disk, which are kept, differ.
        let beyond = |u: f64| self.disk_u.is_some_and(|[outer, _]| u < outer && within(u));
        let off_disk = traced.crossings.iter().filter(|x| x.u > edge || beyond(x.u));
        // Within the horizon, too: a crossing that passes through it is in no way beside an edge of the disk.
        record.beside_disk = off_disk.fold(traced.inside, |bits, x| bits | 1 << (x.order & 15));
        record.crossings.extend(traced.crossings.iter().filter(|x| within(x.u)).map(|x| Crossing {
            u: x.u,
            order: x.order,
            g: frequency_ratio * self.matter.redshift(c, x.u, x.du),
            place: EmissionPoint { ln_r: -x.u.ln(), azimuth: x.azimuth, delay: x.delay },
            footprint: [UNKNOWN_EMISSION_POINT; 2],
            share: self.emitters.covered(x.u),
        }));
    }
}

impl<'a> Neighbours<'a> {
    /// The neighbours of the position at x: left, right, above, below.
    pub fn of(mapping: &Mapping, x: f64, [left, right, above, below]: [&'a Record; 4]) -> Self {
        Self {
            left: mapping.same_face(x, x - 1.0).then_some(left),
            right: mapping.same_face(x, x + 1.0).then_some(right),
            above: Some(above),
            below: Some(below),
        }
    }

    /// `here` with its footprints and its edge; `matter`: the disk's.
    pub fn complete(&self, here: &Record, matter: &Matter) -> Record {
        let mut record = here.clone();
        let kinds = [self.left, self.right, self.above, self.below]
            .map(|there| there.map_or(Edge::None, |there| edge_between(here, there)));
        let steep =
            if is_steep_between(here, [self.right, self.below], dark_u(matter)) { Edge::Disk } else { Edge::None };
        record.edge = kinds.into_iter().fold(steep, Edge::max);
        let pairs = [(self.left, self.right), (self.above, self.below)];
        if here.fate == Fate::Escaped {
            record.footprint = pairs.map(|(before, after)| derivative_of_direction(here, before, after));
            record.edge = record.edge.max(turning_edge(widest_turn(here, pairs)));
        }
        for crossing in &mut record.crossings {
            crossing.footprint = pairs.map(|(before, after)| derivative_of_place(crossing, before, after));
        }
        record
    }
}

/// The turn of the sky direction to the neighbours in each row on the side where it turns more, rad: between two that
/// are a whole turn apart it would seem to be none.
fn widest_turn(here: &Record, pairs: [(Option<&Record>, Option<&Record>); 2]) -> f64 {
    let turn = |there: Option<&Record>| {
        there.filter(|r| r.fate == Fate::Escaped).map_or(0.0, |r| (r.direction - here.direction).length())
    };
    let [x, y] = pairs.map(|(before, after)| turn(before).max(turn(after)));
    x.hypot(y)
}

/// Neighbours' rays that meet other things, or the same inside the disk's edge and not outside: two that miss a thin
/// ring, each on its side, differ, too.
fn edge_between(here: &Record, there: &Record) -> Edge {
    if here.fate != there.fate && here.fate != Fate::Hidden && there.fate != Fate::Hidden {
        return Edge::Curve;
    }
    let alike = here.fate == there.fate && here.beside_disk == there.beside_disk && here.orders() == there.orders();
    if alike { Edge::None } else { Edge::Disk }
}

/// At the first crossing; where neighbours do not have it, its change is not known but that it is one.
fn is_steep_between(here: &Record, neighbours: [Option<&Record>; 2], dark_u: f64) -> bool {
    let Some(first) = here.crossings.first() else { return false };
    let u = |there: &Record| there.crossings.iter().find(|c| c.order == first.order).map_or(0.0, |c| c.u);
    let changes = neighbours.map(|there| there.map_or(0.0, |there| (u(there) - first.u).abs()));
    is_steep(first.u, changes.iter().sum(), dark_u)
}

/// d(sky direction) from `here` to the next of a row: central where both neighbours escaped, else one-sided.
pub(super) fn derivative_of_direction(here: &Record, before: Option<&Record>, after: Option<&Record>) -> DVec3 {
    let escaped = |there: Option<&Record>| there.filter(|r| r.fate == Fate::Escaped).map(|r| r.direction);
    match (escaped(before), escaped(after)) {
        (Some(before), Some(after)) => 0.5 * (after - before),
        (None, Some(after)) => after - here.direction,
        (Some(before), None) => here.direction - before,
        (None, None) => UNKNOWN_DIRECTION,
    }
}

/// d(place) of a crossing to the next of a row, from the crossings of its order there, as `derivative_of_direction`.
pub(super) fn derivative_of_place(here: &Crossing, before: Option<&Record>, after: Option<&Record>) -> EmissionPoint {
    let same = |record: &Record| record.crossings.iter().find(|c| c.order == here.order).map(|c| c.place);
    let (before, after) = (before.and_then(same), after.and_then(same));
    if before.is_none() && after.is_none() {
        return UNKNOWN_EMISSION_POINT;
    }
    let share = if before.is_some() && after.is_some() { 0.5 } else { 1.0 };
    let (first, last) = (before.unwrap_or(here.place), after.unwrap_or(here.place));
    EmissionPoint {
        ln_r: share * (last.ln_r - first.ln_r),
        azimuth: share * wrap_angle(last.azimuth - first.azimuth),
        delay: share * (last.delay - first.delay),
    }
}
