// SPDX-License-Identifier: MIT OR Apache-2.0
//! Records of one frame beside the truth, ray by ray.

use super::errors::{Bar, Errors};
use super::observers::{aim, random_observer};
use super::truth::{Conditioning, Frame, Sight, Truth};
use super::{GPU, PIXEL_4K, TRACERS, both, fail_if_any};
use crate::random::{Random, count_from};
use bhr::physics::geodesic::wrap_angle;
use bhr::physics::trace::Fate;
use bhr::scene::record::Record;
use glam::DVec3;

/// Comparisons of one tracer with and without spin.
#[derive(Default)]
struct Comparison {
    sky: Errors,
    sky_redshift: Errors,
    radius: Errors,
    g: Errors,
    azimuth: Errors,
    wrong: Vec<String>,
    rays: usize,
    integrated: usize,
    excluded: usize,
}

impl Comparison {
    fn merge(&mut self, other: Self) {
        self.sky.merge(other.sky);
        self.sky_redshift.merge(other.sky_redshift);
        self.radius.merge(other.radius);
        self.g.merge(other.g);
        self.azimuth.merge(other.azimuth);
        self.wrong.extend(other.wrong);
        self.rays += other.rays;
        self.integrated += other.integrated;
        self.excluded += other.excluded;
    }

    fn judge(self, what: &str) -> Vec<String> {
        let Self { rays, integrated, excluded, .. } = self;
        println!("{what}: {rays} rays, {integrated} integrated, {excluded} at the critical curve");
        let mut failures = self.wrong;
        failures.truncate(20);
        let bars: [(&str, Errors, &[Bar]); 5] = [
            ("sky direction, 4K pixels", self.sky, &[(0.9999, 0.01), (1.0, 0.1)]),
            ("sky redshift", self.sky_redshift, &[(1.0, 1e-5)]),
            ("crossing radius", self.radius, &[(0.999, 1e-5)]),
            ("crossing g", self.g, &[(0.999, 1e-5)]),
            ("crossing azimuth", self.azimuth, &[(0.999, 1e-4)]),
        ];
        failures
            .extend(bars.into_iter().flat_map(|(name, errors, bars)| errors.judge(&format!("{what}: {name}"), bars)));
        failures
    }
}

impl Frame<'_> {
    fn compare(
        &self,
        ray: usize,
        look: DVec3,
        here: &Sight,
        conditioning: &Conditioning,
        record: &Record,
    ) -> Comparison {
        let mut found = Comparison { rays: 1, integrated: usize::from(record.steps > 0), ..Default::default() };
        let index = self.scene_index;
        let sky = (record.direction - here.direction).length() / conditioning.sky.max(1.0) / PIXEL_4K;
        if (record.fate != here.fate || sky.is_nan() || sky > 0.01) && self.at_critical(look, here, record) {
            found.excluded = 1;
            return found;
        }
        if record.fate != here.fate {
            found.wrong.push(format!(
                "scene {index} ray {ray}: {:?}, truly {:?}, |b/b_c - 1| {:.1e}, steps {}",
                record.fate, here.fate, here.from_critical, record.steps
            ));
            return found;
        }
        if here.fate == Fate::Escaped {
            found.sky.add(sky, index, ray);
            let error = (record.sky_redshift / here.sky_redshift - 1.0).abs();
            found.sky_redshift.add(error / (1.0 + conditioning.sky_redshift), index, ray);
        }
        self.compare_crossings(ray, here, conditioning, record, &mut found);
        found
    }

    fn compare_crossings(&self, ray: usize, here: &Sight, c: &Conditioning, record: &Record, found: &mut Comparison) {
        let index = self.scene_index;
        let listed = |order: u32| record.crossings.iter().find(|x| x.order == order);
        for ((crossing, g), conditioning) in here.crossings.iter().zip(&c.ln_r) {
            let share = 1.0 / (1.0 + conditioning);
            let Some(x) = listed(crossing.order).filter(|_| self.truth.within_disk(crossing.u)) else {
                let expected = self.truth.within_disk(crossing.u);
                if expected != listed(crossing.order).is_some() && !self.truth.at_an_edge(crossing.u, *conditioning) {
                    found.wrong.push(format!(
                        "scene {index} ray {ray}: crossing {} at r = {} listed: {}, conditioning {conditioning:.1e}",
                        crossing.order,
                        1.0 / crossing.u,
                        !expected
                    ));
                }
                continue;
            };
            found.radius.add((x.u / crossing.u - 1.0).abs() * share, index, ray);
            found.g.add((x.g / g - 1.0).abs() * share, index, ray);
            if self.truth.scene.emitters().needs().places {
                found.azimuth.add(wrap_angle(x.place.azimuth - crossing.azimuth).abs() * share, index, ray);
            }
        }
        for x in record.crossings.iter().filter(|x| here.crossings.iter().all(|(y, _)| y.order != x.order)) {
            found.wrong.push(format!("scene {index} ray {ray}: no crossing {} at r = {}", x.order, 1.0 / x.u));
        }
    }
}

/// BHR_LENS_OBSERVERS observers of 1000 rays; half of the frames look at the shadow's edge, with pixels down to 2.5e-6
/// rad.
#[test]
fn records_agree_with_integration() {
    let (width, height) = (40, 25);
    let mut renderers = both();
    let mut random = Random(23);
    let mut found: [[Comparison; 2]; 2] = Default::default();
    for index in 0..count_from("BHR_LENS_OBSERVERS", 3, 1000) {
        let mut scene = random_observer(&mut random, index);
        aim(&mut scene, &mut random);
        let truth = Truth::new(&scene, width, height);
        let rays = truth.rays();
        for (tracer, renderer) in renderers.iter_mut().enumerate() {
            renderer.scene = scene.clone();
            let records = renderer.ray_records(width, height).unwrap();
            let frame = Frame { truth: &truth, scene_index: index, single: tracer == GPU };
            let mut of_frame = Comparison::default();
            for (i, ((look, here, conditioning), record)) in rays.iter().zip(&records).enumerate() {
                of_frame.merge(frame.compare(i, *look, here, conditioning, record));
            }
            if !of_frame.wrong.is_empty() {
                let name = TRACERS[tracer];
                of_frame.wrong.push(format!("on {name}: spin {}, {:?}", scene.hole.spin, scene.camera));
            }
            found[tracer][usize::from(scene.hole.spin != 0.0)].merge(of_frame);
        }
    }
    let mut failures = Vec::new();
    for (tracer, kinds) in TRACERS.iter().zip(found) {
        for (kind, comparison) in ["spin 0", "spin"].iter().zip(kinds) {
            failures.extend(comparison.judge(&format!("{tracer}, {kind}")));
        }
    }
    fail_if_any(failures);
}
