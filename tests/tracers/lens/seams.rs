// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scan lines through the lens tables: their errors neither jump nor step.

use super::errors::Errors;
use super::observers::{random_observer, shadow_edge};
use super::truth::{Frame, TrueRay, Truth};
use super::{GPU, PIXEL_4K, TRACERS, both, fail_if_any};
use crate::random::{Random, count_from};
use bhr::physics::observer::Observer;
use bhr::physics::trace::Fate;
use bhr::scene::record::Record;
use bhr::scene::{Camera, Scene};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// The error that a record may have from sample to sample of a scan line: in the components of the sky direction
/// (`sky_path`) divided by the stretch, rad, and in ln r of a crossing divided by (1 + conditioning). A few roundings
/// of f32, which differ from one sample to the next, make second differences; a seam is a step that stays, and shows in
/// the means of `WINDOW` samples on either side, where rounding averages out: 0.005 pixel of a 3840 x 2160 frame,
/// 2.4e-6 rad, is one and a half times the bar.
const ROUNDING_BAR: f64 = 5e-6;
const STEP_BAR: f64 = 1.6e-6;
const WINDOW: usize = 32;

/// Samples of a scan line.
const SAMPLES: u32 = 2048;

/// The errors of the samples of a scan line; `None` where there is nothing to compare.
type Wrong = Vec<Option<DVec3>>;

/// The largest component of `measure` of every run of `length` samples that are all there, and the run's middle.
fn along(wrong: &Wrong, length: usize, measure: impl Fn(&[DVec3]) -> DVec3) -> Vec<(f64, usize)> {
    let mut found = Vec::new();
    for (first, run) in wrong.windows(length).enumerate() {
        let run = run.iter().copied().flatten().collect::<Vec<_>>();
        if run.len() == length {
            found.push((measure(&run).abs().max_element(), first + length / 2));
        }
    }
    found
}

fn second_differences(wrong: &Wrong) -> Vec<(f64, usize)> {
    along(wrong, 3, |run| run[0] - 2.0 * run[1] + run[2])
}

fn steps(wrong: &Wrong) -> Vec<(f64, usize)> {
    let mean = |part: &[DVec3]| part.iter().sum::<DVec3>() / part.len() as f64;
    along(wrong, 2 * WINDOW, |run| mean(&run[WINDOW..]) - mean(&run[..WINDOW]))
}

/// The checkers themselves: rounding alone passes, and 0.005 pixel more from some sample on, or 0.01 pixel in one,
/// does not.
#[test]
fn a_step_would_be_seen() {
    let mut random = Random(31);
    let largest = |found: Vec<(f64, usize)>| found.into_iter().fold(0.0, |m: f64, d| m.max(d.0));
    for at in [WINDOW, 700, SAMPLES as usize - WINDOW] {
        let mut rounding = || random.range(-5e-7, 5e-7);
        let mut wrong = (0..SAMPLES).map(|_| Some(DVec3::new(0.0, rounding(), rounding()))).collect::<Wrong>();
        let (second, step) = (largest(second_differences(&wrong)), largest(steps(&wrong)));
        assert!(second < ROUNDING_BAR && step < STEP_BAR, "{second:e} {step:e}");
        let mut outlier = wrong.clone();
        outlier[at].as_mut().unwrap().z += 0.01 * PIXEL_4K;
        assert!(largest(second_differences(&outlier)) > ROUNDING_BAR, "an outlier at {at}");
        wrong.iter_mut().skip(at).flatten().for_each(|e| e.y += 0.005 * PIXEL_4K);
        assert!(largest(steps(&wrong)) > STEP_BAR, "a step at {at}: {:e}", largest(steps(&wrong)));
    }
}

/// Directions (chart) in whose middle scan lines lie, and the lines' widths, rad: four that go round the sky through
/// the hole's direction, two across the shadow's edge, one anywhere.
fn scan_lines(scene: &Scene, random: &mut Random) -> Vec<(DVec3, DVec3, f64)> {
    let observer = scene.observer().unwrap();
    let inward = Observer::moving(observer.frame, -observer.beta).aberrate(DVec3::NEG_X).0;
    let inward = observer.frame.vector(inward);
    let aside = inward.cross(random.direction()).normalize();
    let turned = random.range(0.0, PI / 2.0);
    let mut lines = Vec::new();
    for quarter in 0..4 {
        let (s, c) = (turned + PI / 2.0 * f64::from(quarter)).sin_cos();
        lines.push((inward * c + aside * s, aside * c - inward * s, PI / 2.0));
    }
    for _ in 0..2 {
        if let Some(edge) = shadow_edge(scene, random) {
            lines.push((edge, edge.cross(random.direction()), random.log_range(3e-3, 0.5)));
        }
    }
    let anywhere = random.direction();
    lines.push((anywhere, anywhere.cross(random.direction()), random.range(0.1, 2.0)));
    lines
}

/// Second differences and steps of sky directions and of radii.
#[derive(Default)]
struct Seams {
    sky: [Errors; 2],
    radius: [Errors; 2],
}

impl Seams {
    fn look_at(&mut self, wrong: &[Wrong], scene: usize, line: usize) {
        for (kind, wrong) in wrong.iter().enumerate() {
            let errors = if kind == 0 { &mut self.sky } else { &mut self.radius };
            for (errors, found) in errors.iter_mut().zip([second_differences(wrong), steps(wrong)]) {
                found.into_iter().for_each(|(error, i)| errors.add(error, scene, line * 10_000 + i));
            }
        }
    }

    fn judge(self, what: &str) -> Vec<String> {
        let mut failures = Vec::new();
        for (quantity, [second, step]) in [("sky direction", self.sky), ("crossing radius", self.radius)] {
            for (name, errors, bar) in [("second differences", second, ROUNDING_BAR), ("steps", step, STEP_BAR)] {
                if !errors.0.is_empty() {
                    failures.extend(errors.judge(&format!("{what}: {name} of {quantity}"), &[(1.0, bar)]));
                }
            }
        }
        failures
    }
}

/// Scan lines through table edges, across the critical curve and to where integration takes over.
#[test]
fn no_seam() {
    let mut renderers = both();
    let mut random = Random(37);
    // The lines by tracer, and by whether they were looked up (partly, at least) or integrated.
    let mut found: [[Seams; 2]; 2] = Default::default();
    for index in 0..count_from("BHR_LENS_OBSERVERS", 10, 1000) / 5 {
        let mut scene = random_observer(&mut random, index);
        for (line, (forward, right, width)) in scan_lines(&scene, &mut random).into_iter().enumerate() {
            let fov_y = 2.0 * ((0.5 * width).tan() / f64::from(SAMPLES)).atan();
            scene.camera = Camera { forward, up: right.cross(forward), fov_y, ..scene.camera };
            let truth = Truth::new(&scene, SAMPLES, 1);
            let rays = truth.rays();
            for (tracer, renderer) in renderers.iter_mut().enumerate() {
                renderer.scene = scene.clone();
                let records = renderer.ray_records(SAMPLES, 1).unwrap();
                let integrated = records.iter().all(|r| r.steps > 0);
                let frame = Frame { truth: &truth, scene_index: index, single: tracer == GPU };
                found[tracer][usize::from(integrated)].look_at(&frame.wrong(&rays, &records), index, line);
            }
        }
    }
    let mut failures = Vec::new();
    for (tracer, kinds) in TRACERS.iter().zip(found) {
        let compared = |f: &Seams| f.sky[1].0.len() > 5000 && f.radius[1].0.len() > 1000;
        assert!(kinds.iter().any(compared), "{tracer}: hardly anything was compared");
        for (kind, seams) in ["looked up", "integrated"].iter().zip(kinds) {
            failures.extend(seams.judge(&format!("{tracer}, {kind}")));
        }
    }
    fail_if_any(failures);
}

/// Axes that go with the true sky direction along a scan line: the way it moves, across, and outward. In them an error
/// that changes slowly is one, however fast the sky turns beside the critical curve.
fn sky_path(rays: &[TrueRay], i: usize) -> Option<DMat3> {
    let [before, here, after] =
        [i.wrapping_sub(1), i, i + 1].map(|k| rays.get(k).filter(|r| r.1.fate == Fate::Escaped));
    let outward = here?.1.direction;
    let along = (after?.1.direction - before?.1.direction).reject_from_normalized(outward).try_normalize()?;
    Some(DMat3::from_cols(along, outward.cross(along), outward))
}

impl Frame<'_> {
    /// The errors of the samples: of sky directions, and of ln r of the crossings of each order.
    fn wrong(&self, rays: &[TrueRay], records: &[Record]) -> Vec<Wrong> {
        let orders = self.truth.settings.max_crossings;
        let mut all = vec![vec![None; rays.len()]; 1 + orders];
        for (i, ((look, here, conditioning), record)) in rays.iter().zip(records).enumerate() {
            let wrong = (record.direction - here.direction) / conditioning.sky.max(1.0);
            let judged = record.fate == here.fate && (wrong.length() < 1e-6 || !self.at_critical(*look, here, record));
            if judged && here.fate == Fate::Escaped {
                all[0][i] = sky_path(rays, i).map(|axes| axes.transpose() * wrong);
            }
            for ((crossing, _), conditioning) in here.crossings.iter().zip(&conditioning.ln_r) {
                let listed = record.crossings.iter().find(|x| judged && x.order == crossing.order);
                let ratio = listed.map(|x| (x.u / crossing.u).ln() / (1.0 + conditioning));
                all[1 + crossing.order as usize][i] = ratio.map(|e| DVec3::new(e, 0.0, 0.0));
            }
        }
        all
    }
}
