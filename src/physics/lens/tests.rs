//! The tables against integrating each ray (`physics::trace`). Knows the public face of `lens` only.

use super::*;
use crate::physics::metric::chart;
use crate::physics::observer::LocalFrame;
use crate::physics::trace::{Fate, Settings, trace_look};
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

fn eye(r: f64, theta: f64, rain: bool) -> LocalFrame {
    let frame = LocalFrame::new(0.0, chart(r, theta, 0.7)).unwrap();
    if rain { frame.to_rain() } else { frame }
}

fn eyes() -> Vec<LocalFrame> {
    let mut all = Vec::new();
    for (i, r) in [2.1, 2.7, 3.0, 3.2, 5.0, 6.5, 12.0, 30.0, 200.0, 1000.0].into_iter().enumerate() {
        all.push(eye(r, 0.3 + 0.25 * i as f64, false));
    }
    for (i, r) in [1.0, 1.7, 2.4, 3.0, 4.5, 8.0, 40.0, 1000.0].into_iter().enumerate() {
        all.push(eye(r, 0.4 + 0.3 * i as f64, true));
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

/// Errors over (1 + conditioning) of the swept angle, of u, and of the delay (over 1 + delay) at crossings outside 6 M.
fn errors(frame: &LocalFrame, resolution: Resolution, rays: usize) -> [Errors; 3] {
    let lens = SchwarzschildLens::build(Family::new(frame, true, resolution).unwrap()).unwrap();
    let axis = lens.family().coordinate;
    let critical = axis.sin_critical.atan2(axis.cos_critical);
    let mut sequence = Sequence(7);
    let mut all = [Errors::default(), Errors::default(), Errors::default()];
    for _ in 0..rays {
        let psi = sequence.angle(critical);
        let n = sequence.look(psi);
        let look = lens.look(n);
        let traced = trace_look(frame, n, &Settings::exact(0.0)).1;
        assert_eq!(look.escaped, traced.fate == Fate::Escaped, "r {} psi {psi}", frame.r);
        if look.escaped {
            all[0].add((look.swept - traced.swept).abs() / (1.0 + look.swept_slope.abs()));
        }
        let plane = OrbitPlane::new(frame, n);
        for expected in traced.crossings.iter().filter(|c| c.u <= 1.0 / 6.0) {
            let Some(crossing) = plane.crossing(&look, expected.order) else {
                panic!("r {} psi {psi}: crossing {} at {} missing", frame.r, expected.order, expected.u);
            };
            let conditioning = (crossing.u_psi.abs() + crossing.u_phi.abs()) / expected.u;
            all[1].add((crossing.u / expected.u - 1.0).abs() / (1.0 + conditioning));
            let image = plane.image(&look, &crossing);
            // Beside infinity the delay is the radius, known no better than u.
            let scale = (1.0 + expected.delay.abs()) * (1.0 + conditioning);
            all[2].add((image.delay - expected.delay).abs() / scale);
            let turned = (image.azimuth - expected.azimuth + PI).rem_euclid(2.0 * PI) - PI;
            assert!(turned.abs() < 1e-8, "r {} psi {psi}: azimuth {turned:e}", frame.r);
        }
    }
    all
}

#[test]
#[ignore = "a measurement: prints the errors by resolution"]
fn measure() {
    let resolutions = [(32, 128, 0.1), (16, 128, 0.1), (16, 64, 0.1), (16, 32, 0.1), (16, 64, 0.05), (8, 64, 0.1), (8, 32, 0.2)];
    for (nodes_per_octave, intervals, step) in resolutions {
        println!("{nodes_per_octave} nodes per octave, {intervals} intervals, step {step}");
        for frame in eyes() {
            let resolution = Resolution { nodes_per_octave, intervals, step };
            let family = Family::new(&frame, true, resolution).unwrap();
            let begin = std::time::Instant::now();
            let without = Family::new(&frame, false, resolution).unwrap();
            let built = SchwarzschildLens::build(without).is_some();
            let time = begin.elapsed().as_secs_f64() * 1e3;
            let begin = std::time::Instant::now();
            let with = SchwarzschildLens::build(family).is_some();
            let time_with = begin.elapsed().as_secs_f64() * 1e3;
            assert!(built && with);
            let nodes = [Branch::Escaping, Branch::Captured].map(|b| family.columns(b));
            print!("r {:7.1} rain {:5} nodes {nodes:4?} {time:5.1} {time_with:5.1} ms", frame.r, frame.rain);
            for mut e in errors(&frame, resolution, 1500) {
                print!("  {:.0e} {:.0e} {:.0e}", e.at(0.5), e.at(0.99), e.at(1.0));
            }
            println!();
        }
    }
}
