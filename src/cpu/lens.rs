// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ray records of pixels, looked up in tables of the observer's lens (`physics::lens`). Records and their footprints
//! are as `record` makes them by tracing. Mirrored by `shaders/lens/schwarzschild_record.wgsl`. Knows no shading.

use super::record::{Neighbours, Recorder};
use super::tables::Tables;
use crate::emit::{Crossing, EmissionPoint, Needs};
use crate::physics::lens::kerr;
use crate::physics::lens::{OrbitPlane, PlaneImage, SchwarzschildLens};
use crate::physics::observer::Momenta;
use crate::physics::orbit::redshift;
use crate::physics::trace::Fate;
use crate::scene::record::{Record, UNKNOWN_EMISSION_POINT, polar_momentum};
use crate::scene::refine::{DiskEdges, SAME_CROSSING, looked_up_edge, near_disk_edge, turn_of};
use glam::DVec3;
use std::f64::consts::PI;

/// Looks the records of a frame up.
pub struct LensLookup<'a> {
    recorder: Recorder<'a>,
    tables: Tables<'a>,
    momenta: Momenta,
    /// Without `delays` these are 0, whatever the tables hold.
    needs: Needs,
    edges: Option<DiskEdges>,
}

/// A pixel's look direction in the local frame, its changes to the next pixel right and down, nu(camera) / nu(local
/// frame), and 1/r between which a crossing hides what is behind it.
struct LookDirection {
    n: DVec3,
    changes: [DVec3; 2],
    ratio: f64,
    opaque_u: Option<[f64; 2]>,
}

impl<'a> LensLookup<'a> {
    pub fn new(recorder: Recorder<'a>, tables: Tables<'a>) -> Self {
        let momenta = recorder.lens.observer.frame.momenta();
        let edges = recorder.disk_u.map(|u| DiskEdges::new(u, recorder.emitters.fading_u(), &recorder.matter));
        Self { needs: recorder.emitters.needs(), edges, recorder, tables, momenta }
    }

    pub fn recorder(&self) -> &Recorder<'a> {
        &self.recorder
    }

    /// Makes `record` that of position (x, y) of the full frame, with footprints.
    pub fn record(&self, x: f64, y: f64, record: &mut Record) {
        self.look_up(x, y, record, |_| self.traced(x, y));
    }

    /// Makes `record` that of one of many samples of a pixel: footprints that the tables do not hold stay unknown.
    pub fn sample(&self, x: f64, y: f64, record: &mut Record) {
        self.look_up(x, y, record, |found| found.unwrap_or_else(|| self.recorder.trace(x, y)));
    }

    /// `fallback` makes the record of a ray that the tables do not hold; it is given that record, if some footprints
    /// are known.
    fn look_up(&self, x: f64, y: f64, record: &mut Record, fallback: impl Fn(Option<Record>) -> Record) {
        record.clear();
        let seen = self.look_direction(x, y);
        let energy = self.momenta.energy(seen.n);
        let angular_momentum = self.momenta.angular_momentum(seen.n);
        let frame = &self.recorder.lens.observer.frame;
        if frame.rain && !frame.sees_outside(energy, angular_momentum) {
            return;
        }
        record.energy = energy;
        record.angular_momentum = angular_momentum;
        record.sky_redshift = seen.ratio / energy;
        if let (true, Some((c, _))) = (self.needs.angles, frame.start(seen.n)) {
            record.polar_momentum = polar_momentum(&c, seen.ratio);
        }
        match self.tables {
            Tables::Schwarzschild(lens) => self.look_up_schwarzschild(lens, &seen, record),
            Tables::Kerr(lens) => match lens.look_up(seen.n) {
                Some(found) if found.crossings_are_good() => self.look_up_kerr(&found, &seen, record),
                Some(found) => {
                    let (traced, complete) = self.traced_once(x, y, &found, &seen);
                    *record = if complete { traced } else { fallback(Some(traced)) };
                }
                None => *record = fallback(None),
            },
        }
    }

    /// Makes the record by tracing the pixel and its neighbours.
    fn traced(&self, x: f64, y: f64) -> Record {
        let trace = |dx, dy| self.recorder.trace(x + dx, y + dy);
        let [left, right, above, below] = [trace(-1.0, 0.0), trace(1.0, 0.0), trace(0.0, -1.0), trace(0.0, 1.0)];
        let here = trace(0.0, 0.0);
        Neighbours::of(&self.recorder.lens.mapping, x, [&left, &right, &above, &below])
            .complete(&here, &self.recorder.matter)
    }

    /// Makes the record by tracing the pixel; its footprints, which need not be as exact, come from the table. The
    /// result says whether all are known.
    fn traced_once(&self, x: f64, y: f64, found: &kerr::KerrLookup, seen: &LookDirection) -> (Record, bool) {
        let mut record = self.recorder.trace(x, y);
        let steps = seen.changes.map(|change| found.place.step(change));
        if let (Some(sky), Fate::Escaped) = (found.sky(), record.fate) {
            record.footprint = steps.map(|step| sky.change(&step));
        }
        let orders = 0..self.recorder.settings.max_crossings;
        let on_edge = orders
            .filter_map(|order| found.crossing(order))
            .any(|c| self.is_near_disk_edge(c.image.u, steps.each_ref().map(|step| c.change(step).u)));
        self.note_edge(&mut record, on_edge, found.curve_distance(&steps));
        if !self.needs.places {
            return (record, true);
        }
        let mut complete = true;
        for crossing in &mut record.crossings {
            let near = |other: &kerr::Crossing| (other.image.u / crossing.u - 1.0).abs() < SAME_CROSSING;
            match found.crossing(crossing.order as usize).filter(near) {
                Some(alike) => {
                    crossing.footprint = steps.map(|step| self.change_of_place(crossing.u, &alike.change(&step)))
                }
                None => complete = false,
            }
        }
        (record, complete)
    }

    /// Looks a record up in the tables of a spinning hole.
    fn look_up_kerr(&self, found: &kerr::KerrLookup, seen: &LookDirection, record: &mut Record) {
        let steps = seen.changes.map(|change| found.place.step(change));
        let mut on_edge = false;
        for crossing in found.crossings_and_beyond() {
            let u = crossing.image.u;
            on_edge |= self.is_near_disk_edge(u, steps.each_ref().map(|step| crossing.change(step).u));
            if !self.recorder.plane_u.is_some_and(|[outer, inner]| u >= outer && u <= inner) {
                continue;
            }
            let place = self.needs.places.then(|| {
                let changes = steps.map(|step| self.change_of_place(u, &crossing.change(&step)));
                (self.place_of(&crossing.image), changes)
            });
            if self.cross(record, seen, u, crossing.order, place) {
                break;
            }
        }
        if let (Some(sky), false) = (found.sky(), record.fate == Fate::Hidden) {
            escape(record, sky.direction, steps.map(|step| sky.change(&step)));
        }
        self.note_edge(record, on_edge, found.curve_distance(&steps));
    }

    /// `change`: of u to the next pixel right and down.
    fn is_near_disk_edge(&self, u: f64, change: [f64; 2]) -> bool {
        self.edges.as_ref().is_some_and(|edges| near_disk_edge(u, change, edges))
    }

    /// `curve`: distance to the critical curve, pixels. The record's fate and footprint are known.
    fn note_edge(&self, record: &mut Record, on_edge: bool, curve: f64) {
        let turn = if record.fate == Fate::Escaped { turn_of(record.footprint) } else { 0.0 };
        let seen = if record.fate == Fate::Hidden { f64::INFINITY } else { curve };
        record.edge = looked_up_edge(on_edge, turn, seen);
    }

    fn look_direction(&self, x: f64, y: f64) -> LookDirection {
        let Recorder { lens, .. } = self.recorder;
        let (look, changes) = lens.look_direction_and_changes(x, y);
        let (n, ratio) = lens.observer.aberrate(look);
        let changes = changes.map(|change| lens.observer.aberrate_change((n, ratio), change));
        LookDirection { n, changes, ratio, opaque_u: self.recorder.opaque_u_at(x, y) }
    }

    /// Looks a record up in the tables of a spin-0 lens.
    fn look_up_schwarzschild(&self, lens: &SchwarzschildLens, seen: &LookDirection, record: &mut Record) {
        let frame = &self.recorder.lens.observer.frame;
        let lookup = lens.look_up(seen.n);
        let plane = OrbitPlane::new(frame, seen.n);
        let turns = seen.changes.map(|change| plane.turn(frame, &lookup, change));
        let mut on_edge = false;
        if let (Some([outer, inner]), Some(first)) = (self.recorder.plane_u, plane.crossing_angle(0)) {
            for order in 0..self.recorder.settings.max_crossings as u32 {
                let Some(crossing) = lookup.crossing(first + PI * f64::from(order)) else { break };
                let change = turns.map(|turn| plane.u_change(&lookup, &crossing, &turn));
                on_edge |= self.is_near_disk_edge(crossing.u, change);
                if !(crossing.u >= outer && crossing.u <= inner) {
                    continue;
                }
                let place = self.needs.places.then(|| {
                    let image = plane.image(&lookup, &crossing);
                    let changes = turns.map(|turn| plane.image_change(&lookup, &crossing, &turn));
                    (self.place_of(&image), changes.map(|change| self.change_of_place(crossing.u, &change)))
                });
                if self.cross(record, seen, crossing.u, order, place) {
                    break;
                }
            }
        }
        let slope = lookup.curve_slope() * turns[0].dpsi.hypot(turns[1].dpsi);
        if lookup.escaped && record.fate != Fate::Hidden {
            let sky = plane.sky(&lookup);
            escape(record, sky.direction, turns.map(|turn| sky.change(&turn)));
        }
        self.note_edge(record, on_edge, 1.0 / slope.abs().max(f64::MIN_POSITIVE));
    }

    /// Adds a crossing where emitters shine, with its place and footprint if known; true if it hides all behind it.
    fn cross(
        &self,
        record: &mut Record,
        seen: &LookDirection,
        u: f64,
        order: u32,
        place: Option<(EmissionPoint, [EmissionPoint; 2])>,
    ) -> bool {
        let spin = self.recorder.lens.observer.frame.a;
        // Scenes in which matter plunges use no tables.
        let g = redshift(spin, u, self.recorder.matter.retrograde, record.energy, record.angular_momentum, 1.0);
        let nowhere = EmissionPoint { ln_r: 0.0, azimuth: 0.0, delay: 0.0 };
        let (place, footprint) = place.unwrap_or((nowhere, [UNKNOWN_EMISSION_POINT; 2]));
        // Tables hold no more crossings than a record does.
        let share = self.recorder.emitters.covered(u);
        let _ = record.crossings.try_push(Crossing { u, order, g: seen.ratio * g, place, footprint, share });
        let hidden = seen.opaque_u.is_some_and(|[outer, inner]| u >= outer && u <= inner);
        if hidden {
            record.fate = Fate::Hidden;
        }
        hidden
    }

    fn place_of(&self, image: &PlaneImage) -> EmissionPoint {
        EmissionPoint { ln_r: -image.u.ln(), azimuth: image.azimuth, delay: self.delay(image) }
    }

    fn change_of_place(&self, u: f64, change: &PlaneImage) -> EmissionPoint {
        EmissionPoint { ln_r: -change.u / u, azimuth: change.azimuth, delay: self.delay(change) }
    }

    fn delay(&self, image: &PlaneImage) -> f64 {
        if self.needs.delays { image.delay } else { 0.0 }
    }
}

fn escape(record: &mut Record, direction: DVec3, changes: [DVec3; 2]) {
    record.fate = Fate::Escaped;
    record.direction = direction;
    record.footprint = changes;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::tables::LensCache;
    use crate::physics::geodesic::wrap_angle;
    use crate::physics::trace::Settings;
    use crate::random::runs_all;
    use crate::scene::observer::Lens;
    use crate::scene::{Camera, Chart, KerrThreshold, LensTables, Lensing, Motion, Region, Scene};

    /// Numbers in [0, 1): a fixed sequence (Knuth's multiplier, TAOCP 3.3.4).
    struct Sequence(u64);

    impl Sequence {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    const REGION: Region = Region { full_width: 1280, full_height: 720, x: 0, y: 0 };

    /// A turbulent, translucent disk seen from (r, inclination in degrees).
    fn scene(spin: f64, r: f64, inclination: f64, fov: f64, motion: Motion) -> Scene {
        let theta = f64::to_radians(inclination);
        let height = if inclination == 90.0 { 0.0 } else { theta.cos() };
        let position = DVec3::new(theta.sin() * 0.6, theta.sin() * 0.8, height) * r;
        let mut scene = Scene::plain();
        scene.hole.spin = spin;
        scene.camera = Camera {
            position,
            // An observer inside the photon sphere sees most of the sky behind.
            forward: position * if r < 3.0 { 1.0 } else { -1.0 }
                + DVec3::new(0.1, -0.1, 0.05) * r * f64::to_radians(fov),
            up: DVec3::new(0.3, 0.1, 0.8),
            fov_y: fov.to_radians(),
            motion,
            velocity: DVec3::new(0.3, -0.4, 0.2),
            ..Camera::plain()
        };
        let disk = scene.disk.as_mut().unwrap();
        (disk.opacity, disk.turbulence) = (0.5, 1.0);
        scene.quality.lens_tables = LensTables::Always;
        scene
    }

    /// Traces as exactly as it can.
    fn exact<'a>(scene: &Scene, lens: &'a Lens) -> Recorder<'a> {
        let mut recorder = Recorder::new(scene, lens, &[]);
        recorder.settings = Settings { step: 0.02, max_steps: 100_000, ..recorder.settings };
        recorder
    }

    /// Largest errors, each over what the comment says.
    #[derive(Debug, Default)]
    struct Errors {
        pixels: usize,
        traced: usize,
        /// Stretch: change of sky direction by look direction, at least 1.
        direction: f64,
        /// 1 + conditioning: relative change of u, or change of azimuth or of delay in orbital time, by look direction.
        u: f64,
        g: f64,
        azimuth: f64,
        delay: f64,
        crossings: usize,
        /// The errors of the footprints, relative to their own size.
        sky_footprint: f64,
        place_footprint: f64,
        footprints: usize,
    }

    impl Errors {
        fn direction(&mut self, found: &Record, truth: &Record, look_step: f64) {
            let stretch = found.footprint[0].length().max(found.footprint[1].length()) / look_step;
            let error = found.direction.distance(truth.direction) / stretch.max(1.0);
            self.direction = self.direction.max(error);
            assert!((found.sky_redshift / truth.sky_redshift - 1.0).abs() < 1e-12);
        }

        fn crossing(&mut self, found: &Crossing, truth: &Crossing, look_step: f64, sin_critical: f64) {
            let turn = truth.u * truth.u.sqrt();
            let by = |f: fn(&EmissionPoint) -> f64| {
                found.footprint.iter().map(|change| f(change).abs()).fold(0.0, f64::max) / look_step * sin_critical
            };
            let radial = 1.0 + by(|place| place.ln_r);
            self.u = self.u.max((found.u / truth.u - 1.0).abs() / radial);
            self.g = self.g.max((found.g / truth.g - 1.0).abs() / radial);
            let azimuth = wrap_angle(found.place.azimuth - truth.place.azimuth).abs();
            self.azimuth = self.azimuth.max(azimuth / (radial + by(|place| place.azimuth)));
            let delay = (found.place.delay - truth.place.delay).abs() * turn;
            self.delay = self.delay.max(delay / (radial + turn * by(|place| place.delay)));
            assert!((found.place.ln_r + found.u.ln()).abs() < 1e-12);
            self.crossings += 1;
        }

        /// Derivatives against differences over `step` of a pixel, where these are small enough to tell.
        fn footprints(&mut self, found: &Record, before: &Record, after: &Record, axis: usize, step: f64) {
            let scale = 1.0 / (2.0 * step);
            if [found, before, after].iter().all(|record| record.fate == Fate::Escaped) {
                let difference = (after.direction - before.direction) * scale;
                let size = found.footprint[0].length().max(found.footprint[1].length());
                self.sky_footprint = self.sky_footprint.max(found.footprint[axis].distance(difference) / size);
            }
            for crossing in &found.crossings {
                let same =
                    |record: &Record| record.crossings.iter().find(|c| c.order == crossing.order).map(|c| c.place);
                let (Some(before), Some(after)) = (same(before), same(after)) else { continue };
                let change = crossing.footprint[axis];
                let turn = crossing.u * crossing.u.sqrt();
                let errors = [
                    change.ln_r - (after.ln_r - before.ln_r) * scale,
                    change.azimuth - wrap_angle(after.azimuth - before.azimuth) * scale,
                    turn * (change.delay - (after.delay - before.delay) * scale),
                ];
                let size: f64 = crossing.footprint.iter().map(|c| c.ln_r.abs() + c.azimuth.abs()).sum();
                let worst = errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
                self.place_footprint = self.place_footprint.max(worst / size);
                self.footprints += 1;
            }
        }
    }

    fn compare(scene: &Scene, count: usize) -> Errors {
        let lens = scene.lens(&REGION).unwrap();
        let mut cache = LensCache::default();
        let frame = &lens.observer.frame;
        let lensing = scene.lensing(frame, 1, KerrThreshold::CPU);
        assert_ne!(lensing, Lensing::Traced);
        let tables = cache.tables(scene, frame, lensing).unwrap().unwrap();
        let lookup = LensLookup::new(Recorder::new(scene, &lens, &[]), tables);
        let truth = exact(scene, &lens);
        let mut sequence = Sequence(11);
        let mut errors = Errors { pixels: count, ..Errors::default() };
        let mut found = Record::captured();
        let critical = crate::physics::shadow::CRITICAL_IMPACT_PARAMETER / frame.r.max(5.2);
        for _ in 0..count {
            let (x, y) = (1280.0 * sequence.next(), 720.0 * sequence.next());
            lookup.record(x, y, &mut found);
            if found.steps > 0 {
                errors.traced += 1;
                continue;
            }
            let expected = truth.trace(x, y);
            assert_eq!(found.fate, expected.fate, "at {x} {y}");
            assert!((found.energy - expected.energy).abs() < 1e-13);
            assert!((found.angular_momentum - expected.angular_momentum).abs() < 1e-12 * frame.r);
            let [dx, dy] = lookup.look_direction(x, y).changes.map(|change| change.length());
            let look_step = dx.max(dy);
            if found.fate == Fate::Escaped {
                errors.direction(&found, &expected, look_step);
            }
            for crossing in &found.crossings {
                match expected.crossings.iter().find(|c| c.order == crossing.order) {
                    Some(truth) => errors.crossing(crossing, truth, look_step, critical),
                    None => assert!(beside_edge(scene, crossing.u), "invented at {x} {y}: {crossing:?}"),
                }
            }
            for crossing in &expected.crossings {
                let seen = found.crossings.iter().any(|c| c.order == crossing.order);
                assert!(seen || beside_edge(scene, crossing.u), "missed at {x} {y}: {crossing:?}");
            }
            let step = 1e-3;
            for (axis, [ax, ay]) in [[step, 0.0], [0.0, step]].into_iter().enumerate() {
                let [before, after] = [-1.0, 1.0].map(|side| truth.trace(x + side * ax, y + side * ay));
                // Beside the shadow's edge differences say little.
                let calm = found.footprint[axis].length() < 30.0 * look_step || found.fate != Fate::Escaped;
                if calm {
                    errors.footprints(&found, &before, &after, axis, step);
                }
            }
        }
        errors
    }

    fn beside_edge(scene: &Scene, u: f64) -> bool {
        scene.emitters().disk_u().is_some_and(|edges| edges.iter().any(|edge| (u / edge - 1.0).abs() < 1e-4))
    }

    fn schwarzschild_scenes() -> Vec<Scene> {
        vec![
            scene(0.0, 30.0, 80.0, 60.0, Motion::Static),
            scene(0.0, 30.0, 90.0, 40.0, Motion::Velocity),
            scene(0.0, 12.0, 20.0, 100.0, Motion::Orbit),
            scene(0.0, 400.0, 70.0, 3.0, Motion::FreeFall),
            scene(0.0, 2.6, 60.0, 120.0, Motion::Velocity),
            scene(0.0, 1.5, 60.0, 120.0, Motion::FreeFall),
        ]
    }

    fn kerr_scenes() -> Vec<Scene> {
        vec![
            scene(0.9, 30.0, 80.0, 60.0, Motion::Static),
            scene(0.9, 20.0, 90.0, 40.0, Motion::Orbit),
            scene(-0.9, 12.0, 40.0, 100.0, Motion::Velocity),
            scene(0.998, 300.0, 70.0, 5.0, Motion::FreeFall),
        ]
    }

    #[test]
    fn looking_up_with_spin_is_as_tracing() {
        for scene in kerr_scenes() {
            let errors = compare(&scene, 1500);
            println!("r {} {:?}: {errors:?}", scene.camera.position.length(), scene.camera.motion);
            assert!(errors.traced * 4 < errors.pixels, "{errors:?}");
            assert!(errors.direction < 4e-6 && errors.u < 4e-6 && errors.g < 4e-6, "{errors:?}");
            assert!(errors.azimuth < 2e-5 && errors.delay < 2e-5, "{errors:?}");
            assert!(errors.sky_footprint < 1e-2 && errors.place_footprint < 1e-2, "{errors:?}");
        }
    }

    /// Rain observers inside the hole, between its horizons and about to fall in.
    fn rain_scenes() -> Vec<Scene> {
        let places = [
            (0.9, 1.2, 60.0, Motion::FreeFall),
            (-0.5, 2.4, 40.0, Motion::Velocity),
            (0.998, 1.3, 110.0, Motion::FreeFall),
            (0.9, 0.6, 80.0, Motion::Velocity),
        ];
        places
            .map(|(spin, r, inclination, motion)| {
                let mut scene = scene(spin, r, inclination, 120.0, motion);
                scene.camera.chart = Chart::Rain;
                scene.camera.forward = -scene.camera.forward;
                scene
            })
            .into()
    }

    #[test]
    fn looking_up_from_within_is_as_tracing() {
        for mut scene in rain_scenes() {
            for disk in [scene.disk, None] {
                scene.disk = disk;
                let errors = compare(&scene, if runs_all() { 1500 } else { 500 });
                println!("r {} {:?}: {errors:?}", scene.camera.position.length(), scene.camera.motion);
                assert!(errors.traced * if disk.is_some() { 4 } else { 10 } < errors.pixels, "{errors:?}");
                assert!(errors.direction < 3e-5 && errors.u < 1e-4 && errors.g < 2e-4, "{errors:?}");
                assert!(errors.azimuth < 3e-4 && errors.delay < 5e-4, "{errors:?}");
                assert!(errors.sky_footprint < 1e-2 && errors.place_footprint < 3e-2, "{errors:?}");
            }
        }
    }

    #[test]
    fn looking_up_without_spin_is_as_tracing() {
        for scene in schwarzschild_scenes() {
            let errors = compare(&scene, 1500);
            println!("r {} {:?}: {errors:?}", scene.camera.position.length(), scene.camera.motion);
            assert!(errors.direction < 4e-7 && errors.u < 3e-6 && errors.g < 1e-6, "{errors:?}");
            assert!(errors.azimuth < 1e-6 && errors.delay < 1e-5, "{errors:?}");
            assert!(errors.sky_footprint < 1e-3 && errors.place_footprint < 1e-3, "{errors:?}");
        }
    }

    /// The tables are always those of the frame at hand.
    #[test]
    fn tables_follow_what_they_depend_on() {
        let mut scene = scene(0.9, 30.0, 80.0, 60.0, Motion::Static);
        let mut cache = LensCache::default();
        let mut place = |scene: &Scene| {
            let frame = scene.lens(&REGION).unwrap().observer.frame;
            match cache.tables(scene, &frame, scene.lensing(&frame, 1, KerrThreshold::CPU)).unwrap().unwrap() {
                Tables::Schwarzschild(lens) => lens.family().r,
                Tables::Kerr(lens) => {
                    lens.grid().direction(kerr::Branch::Outer, 0, 40.0).x + lens.grid().channels() as f64
                }
            }
        };
        let first = place(&scene);
        scene.camera.forward += DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(place(&scene), first);
        scene.camera.position *= 1.1;
        let moved = place(&scene);
        assert_ne!(moved, first);
        scene.quality.max_disk_order = 1;
        assert_ne!(place(&scene), moved);
        scene.hole.spin = 0.0;
        assert!((place(&scene) - 33.0).abs() < 1e-9);
    }
}
