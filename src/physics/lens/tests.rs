// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tables against integrating each ray (`physics::trace`). Knows the public face of `lens` only.

use super::*;
use crate::physics::metric::chart;
use crate::physics::observer::LocalFrame;
use crate::physics::trace::{Fate, PlaneCrossing, Settings, trace_look};
use glam::DVec3;
use std::f64::consts::PI;

/// Numbers in [0, 1): a fixed sequence (Knuth's multiplier, TAOCP 3.3.4).
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A direction at `psi` from the inward radius.
    fn look(&mut self, psi: f64) -> DVec3 {
        let (sin, cos) = psi.sin_cos();
        let (a, b) = (2.0 * PI * self.next()).sin_cos();
        DVec3::new(-cos, sin * a, sin * b)
    }

    /// psi over the whole sky, near the critical angle or near a pole of the sky.
    fn angle(&mut self, critical: f64) -> f64 {
        let tiny = 10f64.powf(-7.0 + 6.0 * self.next());
        match (self.next() * 5.0) as u32 {
            0 => critical * (1.0 + tiny),
            1 => critical * (1.0 - tiny),
            2 => PI - tiny,
            3 => (critical * (1.0 + 4.0 * self.next())).min(3.1),
            _ => PI * self.next(),
        }
    }
}

fn observer(r: f64, theta: f64, rain: bool) -> LocalFrame {
    let frame = LocalFrame::new(0.0, chart(r, theta, 0.7)).unwrap();
    if rain { frame.to_rain() } else { frame }
}

fn observers() -> Vec<LocalFrame> {
    let mut all = Vec::new();
    for (i, r) in [2.1, 2.7, 3.0, 3.2, 5.0, 6.5, 12.0, 30.0, 200.0, 1000.0].into_iter().enumerate() {
        all.push(observer(r, 0.3 + 0.25 * i as f64, false));
    }
    for (i, r) in [1.0, 1.7, 2.4, 3.0, 4.5, 8.0, 40.0, 1000.0].into_iter().enumerate() {
        all.push(observer(r, 0.4 + 0.3 * i as f64, true));
    }
    all
}

/// Largest and median of what was measured.
#[derive(Default)]
struct Errors(Vec<f64>);

impl Errors {
    fn add(&mut self, error: f64) {
        self.0.push(error);
    }

    fn at(&mut self, share: f64) -> f64 {
        assert!(self.0.len() > 30, "{}", self.0.len());
        self.0.sort_by(f64::total_cmp);
        self.0[((self.0.len() - 1) as f64 * share) as usize]
    }
}

/// Builds all columns on this thread. `None`: there is no memory for them.
fn build(family: Family) -> Option<SchwarzschildLens> {
    let columns =
        |branch| (0..family.columns(branch)).map(|i| family.column(branch, i).ok()?).collect::<Option<Vec<_>>>();
    let [escaping, captured] = [columns(Branch::Escaping)?, columns(Branch::Captured)?];
    SchwarzschildLens::from_columns(family, escaping, captured).ok()?
}

/// The table for the observer of `frame`, as fine as the CPU tracer has it.
fn lens_of(frame: &LocalFrame, with_delay: bool) -> Option<SchwarzschildLens> {
    build(Family::new(frame, with_delay, Resolution::SINGLE)?)
}

/// Errors over (1 + conditioning) of the swept angle, of u, and of the delay (over 1 + delay) at crossings outside 6 M.
fn errors(frame: &LocalFrame, resolution: Resolution, rays: usize) -> [Errors; 3] {
    let lens = build(Family::new(frame, true, resolution).unwrap()).unwrap();
    let axis = lens.family().coordinate;
    let critical = axis.sin_critical.atan2(axis.cos_critical);
    let mut sequence = Sequence(7);
    let mut all = [Errors::default(), Errors::default(), Errors::default()];
    for _ in 0..rays {
        let psi = sequence.angle(critical);
        let n = sequence.look(psi);
        let lookup = lens.look_up(n);
        let traced = trace_look(frame, n, &Settings::exact(0.0)).1;
        assert_eq!(lookup.escaped, traced.fate == Fate::Escaped, "r {} psi {psi}", frame.r);
        if lookup.escaped {
            all[0].add((lookup.swept - traced.swept).abs() / (1.0 + lookup.swept_slope.abs()));
        }
        let plane = OrbitPlane::new(frame, n);
        for expected in traced.crossings.iter().filter(|c| c.u <= 1.0 / 6.0) {
            let Some(crossing) = plane.crossing(&lookup, expected.order) else {
                panic!("r {} psi {psi}: crossing {} at {} missing", frame.r, expected.order, expected.u);
            };
            let conditioning = (crossing.u_psi.abs() + crossing.u_phi.abs()) / expected.u;
            all[1].add((crossing.u / expected.u - 1.0).abs() / (1.0 + conditioning));
            let image = plane.image(&lookup, &crossing);
            // Beside infinity the delay is the radius, known no better than u.
            let scale = (1.0 + expected.delay.abs()) * (1.0 + conditioning);
            all[2].add((image.delay - expected.delay).abs() / scale);
            let turned = (image.azimuth - expected.azimuth + PI).rem_euclid(2.0 * PI) - PI;
            assert!(turned.abs() < 1e-8, "r {} psi {psi}: azimuth {turned:e}", frame.r);
        }
    }
    all
}

/// Typical and worst errors.
#[test]
fn agrees_with_tracing() {
    for frame in observers() {
        let [mut swept, mut u, mut delay] = errors(&frame, Resolution::SINGLE, 600);
        let (r, rain) = (frame.r, frame.rain);
        assert!(swept.at(0.5) < 3e-8 && swept.at(1.0) < 5e-7, "r {r} {rain}: {:e} {:e}", swept.at(0.5), swept.at(1.0));
        assert!(u.at(0.5) < 2e-8 && u.at(1.0) < 2e-7, "r {r} {rain}: {:e} {:e}", u.at(0.5), u.at(1.0));
        assert!(delay.at(0.5) < 5e-7 && delay.at(1.0) < 5e-5, "r {r} {rain}: {:e} {:e}", delay.at(0.5), delay.at(1.0));
    }
}

/// Twice the nodes, a sixteenth of the error: the derivatives in the tables are those of the values.
#[test]
fn converges_with_fourth_order() {
    let frame = observer(20.0, 1.0, false);
    let worst = |nodes_per_octave, intervals| {
        let [mut swept, mut u, _] = errors(&frame, Resolution { nodes_per_octave, intervals, step: 0.02 }, 600);
        [swept.at(1.0), u.at(1.0)]
    };
    let (coarse, fine) = (worst(4, 16), worst(8, 32));
    for i in 0..2 {
        assert!(fine[i] < 0.12 * coarse[i], "{coarse:?} {fine:?}");
    }
}

/// Directions about `n` along two axes across it, and the differences of `f` there.
fn differences<T>(n: DVec3, across: DVec3, h: f64, f: impl Fn(DVec3) -> T) -> [T; 2] {
    [h, -h].map(|h| f((n + across * h).normalize()))
}

#[test]
fn sky_changes_as_differences_do() {
    let mut sequence = Sequence(3);
    for frame in observers() {
        let lens = lens_of(&frame, false).unwrap();
        let axis = lens.family().coordinate;
        let critical = axis.sin_critical.atan2(axis.cos_critical);
        for i in 0..60 {
            let radial = i % 4 == 0;
            let beyond =
                if radial { PI - 1e-4 * sequence.next() } else { critical + (PI - critical) * sequence.next() };
            let n = sequence.look(if i == 0 { PI } else { beyond });
            let across = n.cross(DVec3::new(sequence.next(), sequence.next(), 0.2)).normalize();
            let lookup = lens.look_up(n);
            let plane = OrbitPlane::new(&frame, n);
            let h = 1e-5 * (beyond - critical).min(axis.sin_critical);
            let sky = |n: DVec3| OrbitPlane::new(&frame, n).sky(&lens.look_up(n)).direction;
            let [ahead, behind] = differences(n, across, h, sky);
            let expected = (ahead - behind) / (2.0 * h);
            let change = plane.sky(&lookup).change(&plane.turn(&frame, &lookup, across));
            let error = (change - expected).length() / (1.0 + lookup.swept_slope.abs());
            assert!(error < 3e-5, "r {} ray {i} psi {beyond}: {change} {expected}", frame.r);
            assert!((sky(n).length() - 1.0).abs() < 1e-7, "r {} {beyond}", frame.r);
        }
    }
}

#[test]
fn images_change_as_differences_of_traces_do() {
    let mut sequence = Sequence(5);
    let mut compared = 0;
    for frame in observers() {
        let lens = lens_of(&frame, true).unwrap();
        let axis = lens.family().coordinate;
        let critical = axis.sin_critical.atan2(axis.cos_critical);
        for _ in 0..150 {
            let psi = sequence.angle(critical).max(0.01 * critical);
            let n = sequence.look(psi);
            let across = n.cross(DVec3::new(sequence.next(), sequence.next(), 0.2)).normalize();
            let (lookup, plane) = (lens.look_up(n), OrbitPlane::new(&frame, n));
            let h = 1e-4 * (psi - critical).abs().min(critical).min(psi.sin());
            let traced = differences(n, across, h, |n| trace_look(&frame, n, &Settings::exact(0.0)).1);
            for order in 0..3 {
                let Some(crossing) = plane.crossing(&lookup, order) else { continue };
                let [Some(ahead), Some(behind)] = [0, 1].map(|i| traced[i].crossings.iter().find(|c| c.order == order))
                else {
                    continue;
                };
                if !(0.002..0.17).contains(&crossing.u) || (ahead.azimuth - behind.azimuth).abs() > 1.0 {
                    continue;
                }
                let slope = |f: fn(&PlaneCrossing) -> f64| (f(ahead) - f(behind)) / (2.0 * h);
                let change = plane.image_change(&lookup, &crossing, &plane.turn(&frame, &lookup, across));
                let pairs = [
                    (change.u, slope(|i| i.u), crossing.u),
                    (change.azimuth, slope(|i| i.azimuth), 1.0),
                    (change.delay, slope(|i| i.delay), 1.0 / crossing.u),
                ];
                let conditioning = 1.0 + (crossing.u_psi.abs() + crossing.u_phi.abs()) / crossing.u / psi.sin();
                for (name, (got, expected, scale)) in ["u", "azimuth", "delay"].into_iter().zip(pairs) {
                    let error = (got - expected).abs() / (scale * conditioning);
                    // The gradient of the delay has u in its denominator, twice.
                    let limit = if name == "delay" { 1e-3 } else { 2e-4 };
                    assert!(error < limit, "r {} psi {psi} {order} {name}: {got} {expected} {error:e}", frame.r);
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 400, "{compared}");
}

/// Light that starts in the plane crosses it again after half a turn; light that stays in it crosses nowhere.
#[test]
fn observer_in_the_plane() {
    let frame = LocalFrame::new(0.0, DVec3::new(20.0, 0.0, 0.0)).unwrap();
    let lens = lens_of(&frame, false).unwrap();
    for psi in [0.27, 0.3, 0.5] {
        let n = DVec3::new(-f64::cos(psi), -f64::sin(psi), 0.0);
        let traced = trace_look(&frame, n, &Settings::exact(0.0)).1;
        let (lookup, plane) = (lens.look_up(n), OrbitPlane::new(&frame, n));
        for (order, expected) in traced.crossings.iter().enumerate() {
            let crossing = plane.crossing(&lookup, order as u32).unwrap();
            assert!((crossing.u / expected.u - 1.0).abs() < 5e-6, "{psi}: {} {}", crossing.u, expected.u);
        }
        assert!(plane.crossing(&lookup, traced.crossings.len() as u32).is_none());
        let within = DVec3::new(n.x, 0.0, n.y);
        assert!(OrbitPlane::new(&frame, within).crossing_angle(0).is_none());
    }
}

/// The ray at the seam is in the table twice: no step there.
#[test]
fn the_seam_is_no_step() {
    for r in [2.5, 4.0, 20.0] {
        let frame = observer(r, 0.5, false);
        let lens = lens_of(&frame, true).unwrap();
        let axis = lens.family().coordinate;
        let [below, above] = [0.25 * (1.0 - 1e-12), 0.25 * (1.0 + 1e-12)].map(|t_hat| {
            let angle = axis.angle(t_hat);
            let lookup = lens.look_up(DVec3::new(-angle.cos, angle.sin, 0.0));
            let crossing = lookup.crossing(0.6 * lookup.swept).unwrap();
            [lookup.swept, crossing.u, crossing.u_psi, crossing.u_phi, lookup.delay(&crossing)]
        });
        for i in 0..5 {
            assert!((above[i] - below[i]).abs() < 1e-6 * (1.0 + below[i].abs()), "r {r}: {below:?} {above:?}");
        }
    }
}

/// All columns are finite and the fates right at the ends of what is served; nothing is made outside.
#[test]
fn the_domain_is_served_to_its_ends() {
    for (r, rain) in
        [(0.9, true), (2.0, true), (1e6, true), (2.0005, false), (2.01, false), (6.0001, false), (1e6, false)]
    {
        let frame = observer(r * (1.0 + if r < 1e6 { 1e-12 } else { -1e-12 }), 1.0, rain);
        let resolution = Resolution { nodes_per_octave: 8, intervals: 32, step: 0.1 };
        let family = Family::new(&frame, true, resolution).unwrap();
        for branch in [Branch::Escaping, Branch::Captured] {
            for i in 0..family.columns(branch) {
                let column = family.column(branch, i).unwrap().unwrap();
                assert!(
                    column.swept.iter().chain(column.v.as_flattened()).all(|x| x.is_finite()),
                    "r {r} {branch:?} {i}"
                );
                assert!(column.delay.as_flattened().iter().all(|x| x.is_finite()), "r {r} {branch:?} {i}");
            }
        }
        let [mut swept, ..] = errors(&frame, resolution, 100);
        assert!(swept.at(0.5) < 1e-7 && swept.at(1.0) < 3e-6, "r {r}: {:e} {:e}", swept.at(0.5), swept.at(1.0));
    }
    for (r, rain) in [(0.89, true), (2.0004, false), (1.1e6, false)] {
        assert!(lens_of(&observer(r, 1.0, rain), false).is_none());
    }
    let spinning = LocalFrame::new(0.5, DVec3::new(20.0, 0.0, 0.0)).unwrap();
    assert!(lens_of(&spinning, false).is_none());
}

#[test]
fn columns_that_do_not_fit_make_no_table() {
    let family = Family::new(&observer(10.0, 1.0, false), false, Resolution::SINGLE).unwrap();
    let columns = |branch| -> Vec<_> {
        (0..family.columns(branch)).map(|i| family.column(branch, i).unwrap().unwrap()).collect()
    };
    let (escaping, captured) = (columns(Branch::Escaping), columns(Branch::Captured));
    assert!(SchwarzschildLens::from_columns(family, escaping[1..].to_vec(), captured.clone()).unwrap().is_none());
    let mut short = captured.clone();
    short[3].v.pop();
    assert!(SchwarzschildLens::from_columns(family, escaping.clone(), short).unwrap().is_none());
    assert!(SchwarzschildLens::from_columns(family, escaping, captured).unwrap().is_some());
}
