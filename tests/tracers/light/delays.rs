// SPDX-License-Identifier: MIT OR Apache-2.0
//! Times along rays: the delay of a crossing and the t of a path, against Carter's equations in Boyer-Lindquist
//! coordinates, written and integrated here. The tracer has other variables, another method and another form of dt.

use super::{both, cpu};
use bhr::physics::orbit::horizon_outer;
use bhr::renderer::Renderer;
use bhr::scene::{Hit, Ray};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const MASS: f64 = 2.5;

/// Constants of a ray with E = 1 (Carter 1968), M = 1.
#[derive(Clone, Copy)]
struct Carter {
    a: f64,
    lambda: f64,
    eta: f64,
}

/// u = 1/r, theta, their derivatives by Mino time along the backward ray, phi, and the time gone by.
type State = [f64; 6];

/// The ray that the ZAMO at (r, theta, phi = 0) sees at the components `n` of its frame (Bardeen, Press & Teukolsky
/// 1972, eq. 3.2).
fn start(a: f64, r: f64, theta: f64, n: DVec3) -> (Carter, State) {
    let (sin, cos) = theta.sin_cos();
    let sigma = r * r + a * a * cos * cos;
    let delta = r * r - 2.0 * r + a * a;
    let big_a = (r * r + a * a).powi(2) - delta * a * a * sin * sin;
    // The photon flies against the look.
    let l = -(big_a / sigma).sqrt() * sin * n.z;
    let e = (sigma * delta / big_a).sqrt() + 2.0 * a * r / big_a * l;
    let p_theta = sigma.sqrt() * n.y;
    let eta = (p_theta * p_theta + cos * cos * (l * l / (sin * sin) - a * a * e * e)) / (e * e);
    let u = 1.0 / r;
    (Carter { a, lambda: l / e, eta }, [u, -u * u * (sigma * delta).sqrt() * n.x / e, theta, p_theta / e, 0.0, 0.0])
}

impl Carter {
    /// u'^2 = R / r^4 and theta'^2 = Theta, differentiated once more: regular where the ray turns.
    fn rates(&self, [u, du, theta, dtheta, ..]: State) -> State {
        let Self { a, lambda, eta } = *self;
        let (sin, cos) = theta.sin_cos();
        let (r2, delta) = (1.0 / (u * u), 1.0 / (u * u) - 2.0 / u + a * a);
        let sum = r2 + a * a;
        let force = (a * a - lambda * lambda - eta) * u + 3.0 * ((lambda - a).powi(2) + eta) * u * u
            - 2.0 * a * a * eta * u.powi(3);
        let turn = a * (sum - a * lambda) / delta - a + lambda / (sin * sin);
        let time = sum * (sum - a * lambda) / delta + a * (lambda - a * sin * sin);
        [du, force, dtheta, cos * (lambda * lambda / sin.powi(3) - a * a * sin), -turn, time]
    }

    /// A step of RK4.
    fn step(&self, s: State, h: f64) -> State {
        let moved = |k: State, h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
        let k1 = self.rates(s);
        let k2 = self.rates(moved(k1, 0.5 * h));
        let k3 = self.rates(moved(k2, 0.5 * h));
        let k4 = self.rates(moved(k3, h));
        std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }

    /// A step short beside the scales of r^2 and of the way to the horizon.
    fn length(&self, s: &State) -> f64 {
        let u_plus = 1.0 / horizon_outer(self.a);
        1e-3 * s[0].min(u_plus - s[0]).min(0.3)
    }

    /// The state within the step from `s` where `f`, which changes its sign there, is 0: bisection.
    fn root(&self, s: State, h: f64, f: impl Fn(&State) -> f64) -> State {
        let (mut low, mut high) = (0.0, h);
        let before = f(&s);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if f(&self.step(s, middle)) * before > 0.0 { low = middle } else { high = middle }
        }
        self.step(s, 0.5 * (low + high))
    }

    /// Crossings of the plane, down to 1.1 horizons: r, phi, delay.
    fn crossings(&self, mut s: State) -> Vec<[f64; 3]> {
        let mut list = Vec::new();
        let least = 1.1 * horizon_outer(self.a);
        while s[0] > 1e-4 && s[0] * least < 1.0 && list.len() < 4 {
            let h = self.length(&s);
            let next = self.step(s, h);
            if (s[2] - FRAC_PI_2) * (next[2] - FRAC_PI_2) < 0.0 {
                let [u, _, _, _, phi, time] = self.root(s, h, |s| s[2] - FRAC_PI_2);
                if u * least < 1.0 {
                    list.push([1.0 / u, phi, time]);
                }
            }
            s = next;
        }
        list
    }
}

fn spins_and_observers() -> impl Iterator<Item = (f64, f64, f64)> {
    let observers = [(8.0, 1.1), (30.0, 0.5), (100.0, 1.45), (1000.0, 0.9)];
    [0.0, 0.9, -0.6].into_iter().flat_map(move |a| observers.into_iter().map(move |(r, theta)| (a, r, theta)))
}

/// Look directions past the hole on all sides, from near misses to wide ones.
fn looks(r: f64) -> impl Iterator<Item = DVec3> {
    (0..24).map(move |i| {
        let (sin, cos) = (TAU * 0.382 * f64::from(i)).sin_cos();
        let b = 2.0 + 0.6 * f64::from(i);
        DVec3::new(-1.0, b * sin / r, b * cos / r).normalize()
    })
}

fn ray_of(r: f64, theta: f64, n: DVec3) -> Ray {
    let (sin, cos) = theta.sin_cos();
    let (e_r, e_theta) = (DVec3::new(sin, 0.0, cos), DVec3::new(cos, 0.0, -sin));
    Ray { position: e_r * r * MASS, direction: e_r * n.x + e_theta * n.y + DVec3::Y * n.z, frequency_ratio: 1.0 }
}

fn trace(renderer: &mut Renderer, ray: Ray) -> Hit {
    let mut hits = [Hit::default()];
    renderer.trace_rays(&[ray], &mut hits).unwrap();
    hits[0]
}

/// Relative, divided by (1 + the conditioning): 1e-9 on the CPU, 2e-5 on the GPU, as radii.
#[test]
fn delays_of_crossings_are_carters_integral() {
    for (tracer, mut renderer) in both() {
        let bar = if tracer == "cpu" { 1e-9 } else { 2e-5 };
        renderer.scene.hole.mass = MASS;
        let (mut compared, mut worst) = (0, 0.0_f64);
        for (a, r, theta) in spins_and_observers() {
            renderer.scene.hole.spin = a;
            for (i, n) in looks(r).enumerate() {
                let hit = trace(&mut renderer, ray_of(r, theta, n));
                let (carter, begin) = start(a, r, theta, n);
                let nudge = 1e-7;
                let nudged = (n + DVec3::new(0.0, nudge, nudge)).normalize();
                let (beside, beside_begin) = start(a, r, theta, nudged);
                let expected = carter.crossings(begin).into_iter().zip(beside.crossings(beside_begin)).enumerate();
                for (k, ([radius, phi, time], nudged)) in expected {
                    let found = hit.crossings[k];
                    let case = format!("{tracer}: a {a} r {r} ray {i} crossing {k} at {radius}");
                    assert!(hit.crossing_count as usize > k, "{case}: {} crossings", hit.crossing_count);
                    let error = |found: f64, expected: f64, nudged: f64| {
                        (found / expected - 1.0).abs() / (1.0 + (nudged / expected - 1.0).abs() / nudge)
                    };
                    let errors = [
                        error(found.radius, MASS * radius, MASS * nudged[0]),
                        error(found.delay, MASS * time, MASS * nudged[2]),
                    ];
                    assert!(errors.iter().all(|e| *e < bar), "{case}: {found:?}, delay {}: {errors:?}", MASS * time);
                    let turn = (found.azimuth - phi + PI).rem_euclid(TAU) - PI;
                    assert!(
                        turn.abs() < 1e-3 * (1.0 + (nudged[1] - phi).abs() / nudge),
                        "{case}: azimuth {phi}: {found:?}"
                    );
                    worst = worst.max(errors[1]);
                    compared += 1;
                }
            }
        }
        println!("{tracer}: {compared} delays within {worst:.1e}");
        assert!(compared > 200, "{tracer}: {compared}");
    }
}

/// Every point of a path lies where light is at that time, to 1e-9 of the way it went and of the radius.
#[test]
fn paths_keep_carters_time() {
    let mut renderer = cpu();
    renderer.scene.hole.mass = MASS;
    let (mut compared, mut worst) = (0, 0.0_f64);
    for (a, r, theta) in spins_and_observers() {
        renderer.scene.hole.spin = a;
        for (i, n) in looks(r).enumerate().step_by(3) {
            let points = renderer.trace_path(&ray_of(r, theta, n), 40).unwrap();
            let (carter, mut s) = start(a, r, theta, n);
            assert_eq!(points[0][3], 0.0);
            for point in &points[1..points.len() - 1] {
                let wanted = -point[3] / MASS;
                let mut h = carter.length(&s);
                let mut next = carter.step(s, h);
                while next[5] < wanted {
                    s = next;
                    h = carter.length(&s);
                    next = carter.step(s, h);
                }
                let [u, _, theta, _, phi, _] = carter.root(s, h, |s| s[5] - wanted);
                let expected = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()) * (MASS / u);
                let found = DVec3::new(point[0], point[1], point[2]);
                let error = (found - expected).length() / (expected.length() - point[3]);
                assert!(error < 1e-9, "a {a} r {r} ray {i}: {found}, not {expected} at t = {}: {error:e}", point[3]);
                worst = worst.max(error);
                compared += 1;
            }
        }
    }
    println!("{compared} points within {worst:.1e}");
    assert!(compared > 1000, "{compared}");
}

/// The integrator of this file: a radial ray takes r_observer - r + 2 ln((r_observer - 2) / (r - 2)).
#[test]
fn integral_here_has_the_closed_form() {
    let (carter, mut s) = start(0.0, 50.0, 1.0, DVec3::NEG_X);
    while s[0] < 0.45 {
        s = carter.step(s, carter.length(&s));
        let r = 1.0 / s[0];
        let expected = 50.0 - r + 2.0 * (48.0 / (r - 2.0)).ln();
        assert!((s[5] / expected - 1.0).abs() < 1e-11, "r {r}: {} {expected}", s[5]);
    }
}
