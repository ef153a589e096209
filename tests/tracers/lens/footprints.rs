// SPDX-License-Identifier: MIT OR Apache-2.0
//! The footprints of records: changes to the next pixel, against true differences.

use super::errors::Errors;
use super::observers::{random_observer, shadow_edge, turn};
use super::truth::{Sight, Truth};
use super::{TRACERS, both, fail_if_any};
use crate::random::{Random, count_from};
use bhr::physics::geodesic::wrap_angle;
use bhr::physics::trace::Fate;
use bhr::scene::record::Record;
use glam::DVec3;
use rayon::prelude::*;

/// Changes to the next pixel against true differences over 1e-3 pixel. Tables know the derivative; a tracer that
/// integrates takes the difference to its neighbours: it is held to fine pixels, of less than 1 / 150 of the shadow's
/// angle, away from edges.
#[test]
#[ignore = "in tests/run all; everyday: a field of stars has the flux that the lens equation gives"]
fn footprints_agree_with_differences() {
    let (width, height) = (24, 16);
    let mut renderers = both();
    let mut random = Random(29);
    // The footprints by tracer, and by whether the record was looked up or integrated.
    let mut found: [[Footprints; 2]; 2] = Default::default();
    for index in 0..count_from("BHR_LENS_OBSERVERS", 10, 1000) {
        let mut scene = random_observer(&mut random, index);
        scene.disk.as_mut().unwrap().turbulence = 1.0;
        let edge = shadow_edge(&scene, &mut random);
        let scale = (5.0 / (scene.camera.position.length() - 1.0).max(1.0)).min(1.0);
        let pixel = scale * random.log_range(3e-3, 0.1);
        let forward = edge.filter(|_| random.next() < 0.7).unwrap_or_else(|| random.direction());
        turn(&mut scene, forward, &mut random, pixel * f64::from(height));
        let truth = Truth::new(&scene, width, height);
        let true_changes = (0..(width * height) as usize).into_par_iter().map(|i| Changes::new(&truth, i));
        let true_changes = true_changes.collect::<Vec<_>>();
        for (renderer, found) in renderers.iter_mut().zip(&mut found) {
            renderer.scene = scene.clone();
            let records = renderer.ray_records(width, height).unwrap();
            for (i, (changes, record)) in true_changes.iter().zip(&records).enumerate() {
                let integrated = record.steps > 0;
                if !integrated || pixel < scale / 150.0 {
                    found[usize::from(integrated)].compare(index, i, changes, record);
                }
            }
        }
    }
    let mut failures = Vec::new();
    for (tracer, kinds) in TRACERS.iter().zip(found) {
        assert!(
            kinds.iter().any(|f| f.sky.0.len() > 1000 && f.place.0.len() > 1000),
            "{tracer}: hardly anything was compared"
        );
        for (kind, found) in ["looked up", "integrated"].iter().zip(kinds) {
            failures.extend(found.judge(&format!("{tracer}, {kind}")));
        }
    }
    fail_if_any(failures);
}

/// d(sight) / d(pixel), to the right and down.
struct Changes {
    sky: Option<[DVec3; 2]>,
    /// Order, and changes of ln r, azimuth and delay / r, of crossings that have them.
    crossings: Vec<(u32, [[f64; 3]; 2])>,
}

impl Changes {
    const SHARE: f64 = 1e-3;

    fn new(truth: &Truth, pixel: usize) -> Self {
        let width = truth.lens.mapping.width as usize;
        let (x, y) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        let h = 0.5 * Self::SHARE;
        let at = |dx: f64, dy: f64| truth.sight(truth.lens.look_direction(x + dx, y + dy));
        let pairs = [[at(-h, 0.0), at(h, 0.0)], [at(0.0, -h), at(0.0, h)]];
        let escaped = pairs.as_flattened().iter().all(|s| s.fate == Fate::Escaped);
        let sky = pairs.each_ref().map(|[before, after]| (after.direction - before.direction) / Self::SHARE);
        let orders = 0..pairs.as_flattened().iter().map(|s| s.crossings.len()).min().unwrap_or(0);
        Self {
            sky: escaped.then_some(sky),
            crossings: orders
                .map(|k| {
                    let change = |[before, after]: &[Sight; 2]| {
                        let (p, q) = (&before.crossings[k].0, &after.crossings[k].0);
                        let delay = (q.delay - p.delay) * q.u;
                        [(p.u / q.u).ln(), wrap_angle(q.azimuth - p.azimuth), delay].map(|d| d / Self::SHARE)
                    };
                    (k as u32, pairs.each_ref().map(change))
                })
                .collect(),
        }
    }
}

/// Errors relative to the larger of both changes.
#[derive(Default)]
struct Footprints {
    sky: Errors,
    place: Errors,
}

impl Footprints {
    /// Whether neighbours' differences can tell: all there, and the change small enough to be linear.
    fn is_fair(record: &Record, size: f64, known: bool) -> bool {
        record.steps == 0 || (known && size < 0.01)
    }

    fn compare(&mut self, scene: usize, ray: usize, truth: &Changes, record: &Record) {
        if let Some(sky) = truth.sky.filter(|_| record.fate == Fate::Escaped) {
            let size = sky[0].length().max(sky[1].length());
            let error = (0..2).map(|i| (record.footprint[i] - sky[i]).length()).fold(0.0, f64::max);
            if Self::is_fair(record, size, record.footprint.iter().all(|f| f.x < 1e30)) {
                self.sky.add(error / size, scene, ray);
            }
        }
        for (order, changes) in &truth.crossings {
            let Some(x) = record.crossings.iter().find(|x| x.order == *order) else { continue };
            let size = changes.as_flattened().iter().copied().fold(0.0_f64, |m, d| m.max(d.abs()));
            let error = x.footprint.iter().zip(changes).flat_map(|(found, d)| {
                [found.ln_r - d[0], found.azimuth - d[1], found.delay * x.u - d[2]].map(f64::abs)
            });
            if Self::is_fair(record, size, x.footprint.iter().all(|f| f.ln_r < 1e30)) {
                self.place.add(error.fold(0.0, f64::max) / size, scene, ray);
            }
        }
    }

    fn judge(self, what: &str) -> Vec<String> {
        // They decide how wide a filter is; a spline of the fourth order knows its slope to the third.
        let bars = [(0.99, 3e-2)];
        let compared =
            [("sky direction", self.sky), ("crossing", self.place)].into_iter().filter(|(_, e)| !e.0.is_empty());
        compared.flat_map(|(name, errors)| errors.judge(&format!("{what}: change of a {name}"), &bars)).collect()
    }
}
