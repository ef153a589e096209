// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bodies in free fall: reference world lines, published constants, frequencies and orbits, what is conserved, how axes
//! turn, and where lines end.

use crate::random::Random;
use crate::{close, golden, list, number};
use bhr::physics::bound::{BoundOrbit, constants_of_motion};
use bhr::physics::geodesic::{Clock, Constants, wrap_angle};
use bhr::physics::metric::{Kerr, boyer_lindquist};
use bhr::physics::observer::{LocalFrame, Momentum};
use bhr::physics::orbit::{circular_orbit, horizon_outer, innermost_radius, zamo_omega};
use bhr::physics::rain::offsets;
use bhr::physics::world_line::{Body, End, Event, LEAST_RADIUS, world_line};
use glam::DVec3;
use serde_json::Value;
use std::f64::consts::TAU;

const AXES: [DVec3; 3] = DVec3::AXES;

fn place(r: f64, theta: f64, azimuth: f64) -> DVec3 {
    let (sin, cos) = theta.sin_cos();
    DVec3::new(r * sin * azimuth.cos(), r * sin * azimuth.sin(), r * cos)
}

fn body(clock: Clock, position: DVec3, velocity: DVec3) -> Body {
    Body { clock, position, velocity, time: 0.0 }
}

fn after(a: f64, body: &Body, proper: f64) -> Event {
    world_line(a, body, &AXES, &[proper]).unwrap()[0]
}

/// r, theta, azimuth, time and velocity.
fn numbers(event: &Event) -> [f64; 7] {
    let (r, theta, azimuth) = boyer_lindquist(event.body.position);
    let v = event.body.velocity;
    [r, theta, azimuth, event.body.time, v.x, v.y, v.z]
}

/// The difference of `numbers`, angles modulo a turn.
fn difference(x: [f64; 7], y: [f64; 7]) -> [f64; 7] {
    std::array::from_fn(|i| if i == 2 { wrap_angle(x[i] - y[i]) } else { x[i] - y[i] })
}

fn size(x: [f64; 7]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn vector(value: &Value) -> DVec3 {
    crate::vector(value)
}

#[test]
fn reference_world_lines() {
    let file = golden("worldlines.json");
    let lines = list(&file, "lines");
    assert_eq!(lines.len(), 13);
    let mut worst = [0.0_f64; 7];
    for line in lines {
        let (a, tau) = (number(line, "a"), number(line, "tau"));
        let start = place(number(line, "r"), number(line, "theta_deg").to_radians(), 0.0);
        let body = body(Clock::Rain, start, vector(&line["beta"]));
        let found = after(a, &body, tau);
        assert!(found.end.is_none() && found.proper_time == tau || (found.proper_time / tau - 1.0).abs() < 1e-14);
        let v = vector(&line["beta1"]);
        let [r, theta, azimuth, time] = ["r1", "theta1", "azimuth_turned", "doran_time"].map(|key| number(line, key));
        let error = difference(numbers(&found), [r, theta, azimuth, time, v.x, v.y, v.z]);
        // The effect of a change of the start, or of the time, by 1e-8 of 1.
        let nudged = |velocity: DVec3, tau: f64| {
            let nudged = after(a, &Body { velocity: body.velocity + velocity, ..body }, tau);
            size(difference(numbers(&nudged), numbers(&found))) / 1e-8
        };
        let axes = AXES.map(|axis| nudged(axis * 1e-8, tau));
        let conditioning = axes.iter().fold(nudged(DVec3::ZERO, tau * (1.0 + 1e-8)), |most, x| most.max(*x));
        for i in 0..7 {
            worst[i] = worst[i].max(error[i].abs() / (1.0 + conditioning));
        }
    }
    println!("r, theta, azimuth, time, velocity: {worst:.1?}", worst = worst.map(|x| x * 1e12));
    assert!(worst.iter().all(|worst| *worst < 1e-9), "{worst:?}");
}

#[test]
fn published_constants_and_separatrices() {
    let file = golden("kerrgeopy.json");
    let [mut energy, mut momentum, mut carter, mut turning, mut edge] = [0.0_f64; 5];
    for case in list(&file, "constants") {
        let [a, p, e, x] = ["a", "p", "e", "x"].map(|key| number(case, key));
        let found = constants_of_motion(a, p, e, x).unwrap();
        energy = energy.max((found.energy - number(case, "E")).abs());
        momentum = momentum.max((found.angular_momentum - number(case, "L")).abs());
        carter = carter.max((found.carter - number(case, "Q")).abs() / (1.0 + number(case, "Q")));
        // Both ends are turning points: u'^2 is 0 there.
        for u in [(1.0 + e) / p, (1.0 - e) / p] {
            let c = Constants::of_body(a, found.energy, found.angular_momentum, found.carter, u);
            turning = turning.max(c.radial_speed_squared(u).abs());
        }
    }
    for case in list(&file, "separatrices") {
        let [a, e, x, p] = ["a", "e", "x", "p"].map(|key| number(case, key));
        // A little outside there is an orbit, whose pericentre and inner root come together at the separatrix.
        assert!(BoundOrbit::new(a, p * (1.0 - 1e-9), e, x).is_none(), "{case}");
        let gap = |d: f64| {
            let orbit = BoundOrbit::new(a, p + d, e, x).unwrap();
            (p + d) / (1.0 + e) - orbit.separatrix_radius()
        };
        // Straight to the second order: where the gap would be 0.
        let [near, far] = [1e-5, 2e-5].map(gap);
        edge = edge.max((2e-5 - far * 1e-5 / (far - near)).abs());
    }
    println!("E {energy:.1e}, L {momentum:.1e}, Q {carter:.1e}, u'^2 {turning:.1e}, separatrix {edge:.1e}");
    // With the published values u'^2 is up to 2.5e-12: they are rounded so.
    assert!(energy < 1e-14 && momentum < 2e-12 && carter < 2e-11 && turning < 2e-15 && edge < 1e-9);
}

#[test]
fn published_frequencies() {
    let file = golden("kerrgeopy.json");
    let mut worst = 0.0_f64;
    for case in list(&file, "frequencies") {
        let [a, p, e, x] = ["a", "p", "e", "x"].map(|key| number(case, key));
        let found = BoundOrbit::new(a, p, e, x).unwrap().frequencies();
        for (found, key) in [
            (found.radial, "radial"),
            // Its sign there is a matter of how theta is counted.
            (found.polar.copysign(number(case, "polar")), "polar"),
            (found.azimuthal, "azimuthal"),
            (found.time, "time"),
        ] {
            worst = worst.max((found / number(case, key) - 1.0).abs());
        }
    }
    println!("frequencies to {worst:.1e}");
    assert!(worst < 1e-12);
}

/// The published orbits, followed from Mino time 1 back to t = 0: there they are at their pericentres, farthest north,
/// at azimuth 0.
#[test]
fn published_orbits() {
    let file = golden("kerrgeopy.json");
    let mut worst = [0.0_f64; 3];
    for case in list(&file, "orbits") {
        let [a, p, e, x] = ["a", "p", "e", "x"].map(|key| number(case, key));
        let [t, r, theta, phi] = [0, 1, 2, 3].map(|i| case["place"][i].as_f64().unwrap());
        let [ut, ur, uth, uph] = [0, 1, 2, 3].map(|i| case["velocity"][i].as_f64().unwrap());
        let g = Kerr { a }.metric(r, theta);
        let zamo = LocalFrame::new(a, place(r, theta, phi)).unwrap();
        let momentum = DVec3::new(
            g[1][1].sqrt() * ur,
            g[2][2].sqrt() * uth,
            g[3][3].sqrt() * (uph - zamo_omega(a, r, zamo.sin) * ut),
        );
        let velocity = momentum / (zamo.lapse * ut);
        let start = Body { time: t, ..body(Clock::Coordinate, place(r, theta, phi), velocity) };
        // Newton's method towards t = 0, with the rate there, by differences.
        let mut proper = -t / ut;
        for _ in 0..6 {
            let [here, beside] = [proper, proper * (1.0 + 1e-4)].map(|proper| after(a, &start, proper).body.time);
            proper -= here * proper * 1e-4 / (beside - here);
        }
        let found = after(a, &start, proper);
        let (r, theta, azimuth) = boyer_lindquist(found.body.position);
        let north = ((1.0 - x) * (1.0 + x)).sqrt();
        let errors = [r / (p / (1.0 + e)) - 1.0, theta.cos() - north, azimuth].map(f64::abs);
        println!("orbit {}: t {:.1e}, r, cos theta, azimuth {errors:?}", case["number"], found.body.time);
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
    }
    println!("r, cos theta, azimuth: {worst:?}");
    assert!(worst.iter().all(|worst| *worst < 1e-9), "{worst:?}");
}

/// A body that rises out of the past horizon and falls into the hole, from one place of its way to another.
#[test]
fn published_plunge() {
    let file = golden("kerrgeopy.json");
    for case in list(&file, "plunges") {
        let [a, energy, momentum, carter] = ["a", "E", "L", "Q"].map(|key| number(case, key));
        let [from, to] = ["from", "to"].map(|key| [0, 1, 2, 3].map(|i| case[key][i].as_f64().unwrap()));
        let [t, r, theta, phi] = from;
        let zamo = LocalFrame::new(a, place(r, theta, phi)).unwrap();
        let g = Kerr { a }.metric(r, theta);
        let c = Constants::of_body(a, energy, momentum, carter, 1.0 / r);
        // p^r = Sigma u^r / Sigma = -u' r^2 / Sigma outwards, Sigma u^th by Carter's equation southwards.
        let around = momentum / theta.sin();
        let south = (carter - theta.cos().powi(2) * (a * a * (1.0 - energy * energy) + around * around)).sqrt();
        let outwards = c.radial_speed_squared(1.0 / r).sqrt() * r * r / g[2][2];
        let seen = DVec3::new(g[1][1].sqrt() * outwards, south / g[2][2].sqrt(), momentum / g[3][3].sqrt());
        let velocity = seen / ((energy - zamo_omega(a, r, zamo.sin) * momentum) / zamo.lapse);
        let start = Body { time: t, ..body(Clock::Coordinate, place(r, theta, phi), velocity) };
        // The proper time by bisection: after it has fallen to the horizon there is no t.
        let [mut low, mut high] = [0.0, 50.0];
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let event = after(a, &start, middle);
            if event.end.is_some() || event.body.time > to[0] { high = middle } else { low = middle }
        }
        let found = after(a, &start, low);
        let (r, theta, azimuth) = boyer_lindquist(found.body.position);
        let errors = [found.body.time - to[0], r - to[1], theta - to[2], wrap_angle(azimuth - to[3])].map(f64::abs);
        println!("plunge: t, r, theta, phi to {errors:?}");
        assert!(errors.iter().all(|error| *error < 1e-10), "{errors:?}");
    }
}

/// E, L and Q of a body at an event, from its place and velocity alone; they hold mu = 1.
fn constants(a: f64, event: &Event) -> Constants {
    let frame = LocalFrame::rain(a, event.body.position).unwrap();
    frame.start_body(&Momentum::of_body(event.body.velocity)).0
}

/// A random body in the rain chart: one in three starts inside.
fn random_body(random: &mut Random, a: f64) -> Body {
    let (least, r_plus) = (innermost_radius(a).max(LEAST_RADIUS * 10.0), horizon_outer(a));
    let inside = random.next() < 0.33 && a.abs() < 1.0;
    let r = if inside { random.range(least, r_plus) } else { r_plus * random.log_range(1.0, 60.0) };
    let speed = random.next() * 0.95;
    Body {
        time: random.range(-9.0, 9.0),
        ..body(Clock::Rain, random.direction() * r.max(least * (1.0 + 1e-9)), random.direction() * speed)
    }
}

/// Energy, angular momentum, Carter's constant and the norm, along random lines that end where they must.
#[test]
fn constants_of_motion_stay_and_lines_end() {
    let mut random = Random(7);
    let (mut worst, mut turn) = (0.0_f64, 0.0_f64);
    let mut ends = [0; 3];
    for i in 0..300 {
        let a = if i % 10 == 0 { random.pick(&[-1.0, 0.0, 1.0, 1e-9]) } else { random.range(-1.0, 1.0) };
        let body = random_body(&mut random, a);
        let times = [30.0, -20.0, 0.0, 1.0, 200.0, -0.1, -300.0];
        let line = world_line(a, &body, &AXES, &times).unwrap();
        let start = constants(a, &line[2]);
        assert!((line[2].body.position - body.position).length() < 1e-12 * body.position.length());
        assert!((line[2].body.velocity - body.velocity).length() < 1e-11, "{i}");
        for (event, time) in line.iter().zip(times) {
            match event.end {
                None => {
                    ends[0] += 1;
                    assert!((event.proper_time - time).abs() < 1e-9 * (1.0 + time.abs()), "{i}: {event:?}");
                }
                Some(end) => {
                    ends[1 + usize::from(end == End::InnerHorizon)] += 1;
                    assert!(event.proper_time.abs() < time.abs() && event.proper_time * time >= 0.0);
                }
            }
            let r = event.body.position.length();
            assert!(r > 0.0 && event.body.time.is_finite() && event.body.velocity.length() < 1.0, "{i}: {event:?}");
            // Beside a horizon that the line does not pass a velocity near 1 holds few digits of E. At the inner one
            // there is no frame any more.
            let gamma = 1.0 / (1.0 - event.body.velocity.length_squared()).sqrt();
            if gamma > 50.0 || r < 0.02 || event.end == Some(End::InnerHorizon) {
                continue;
            }
            let c = constants(a, event);
            let scale = gamma * gamma;
            for (found, expected) in
                [(c.energy, start.energy), (c.angular_momentum, start.angular_momentum), (c.carter, start.carter)]
            {
                worst = worst.max((found - expected).abs() / (1.0 + expected.abs()) / scale);
            }
            // Carried axes stay orthonormal.
            for (i, x) in event.axes.iter().enumerate() {
                for (j, y) in event.axes.iter().enumerate() {
                    turn = turn.max((x.dot(*y) - f64::from(u8::from(i == j))).abs() / scale);
                }
            }
        }
    }
    println!("constants to {worst:.1e}, axes to {turn:.1e}; ends {ends:?}");
    assert!(ends[0] > 500 && ends[1] > 10 && ends[2] > 50, "{ends:?}");
    assert!(worst < 1e-10 && turn < 1e-9);
}

/// Axes that are carried along a circular orbit turn against the triad, by 2 pi (1 - sqrt(1 - 3 / r)) a revolution
/// without spin (de Sitter 1916), about e_theta.
#[test]
fn axes_on_circular_orbits_turn_as_de_sitter_has_it() {
    for r in [6.0, 10.0, 40.0, 300.0_f64] {
        let orbit = circular_orbit(0.0, r).unwrap();
        let period = TAU / (orbit.angular_velocity * orbit.ut);
        for clock in [Clock::Coordinate, Clock::Rain] {
            let mut start = body(Clock::Coordinate, DVec3::X * r, DVec3::Z * orbit.beta);
            if clock == Clock::Rain {
                // The rain observer sees it rise, by the radial boost from the static one's frame.
                let lapse = (1.0 - 2.0 / r).sqrt();
                start = body(Clock::Rain, start.position, DVec3::new((2.0 / r).sqrt(), 0.0, lapse * orbit.beta));
            }
            let event = after(0.0, &start, period);
            assert!((event.body.position - start.position).length() < 1e-8 * r, "{r}: {event:?}");
            assert!((event.body.velocity - start.velocity).length() < 1e-9);
            let expected = TAU * (1.0 - (1.0 - 3.0 / r).sqrt());
            // e_theta stays. A gyroscope is left behind by the triad, which turns with the orbit once.
            assert!((event.axes[1] - DVec3::Y).length() < 1e-9, "{r}: {:?}", event.axes);
            let found = event.axes[0].z.atan2(event.axes[0].x);
            close(wrap_angle(found - expected), 0.0, 2e-9, &format!("{r} {clock:?}: {found} {expected}"));
        }
    }
}

/// One body in both charts.
#[test]
fn both_charts_tell_the_same_line() {
    let mut worst = 0.0_f64;
    for (a, r, theta, v) in [
        (0.9, 8.0, 1.1, DVec3::new(-0.2, 0.1, 0.35)),
        (-0.6, 30.0, 2.0, DVec3::new(0.1, -0.05, 0.1)),
        (1.0, 5.0, 0.4, DVec3::new(0.3, 0.3, -0.5)),
        (0.0, 2.5, 1.5, DVec3::new(0.9, 0.1, 0.2)),
    ] {
        let still = body(Clock::Coordinate, place(r, theta, 0.3), v);
        let zamo = LocalFrame::new(a, still.position).unwrap();
        // By the boost along e_r: v_r' = (v_r + V) / (1 + v_r V), and across it v / (gamma (1 + v_r V)).
        let speed = ((1.0 - zamo.lapse) * (1.0 + zamo.lapse)).sqrt();
        let along = 1.0 + v.x * speed;
        let velocity = DVec3::new((v.x + speed) / along, zamo.lapse * v.y / along, zamo.lapse * v.z / along);
        let here = offsets(a, 1.0 / r);
        let falling = body(Clock::Rain, place(r, theta, 0.3 + here.azimuth), velocity);
        for proper in [3.0, -15.0, 80.0] {
            let [x, y] = [still, falling].map(|body| after(a, &body, proper));
            if x.end.is_some() {
                assert!((x.body.position.length() / horizon_outer(a) - 1.0 - 1e-6).abs() < 1e-9);
                continue;
            }
            let (there, r) = (offsets(a, 1.0 / x.body.position.length()), x.body.position.length());
            let (_, _, azimuth) = boyer_lindquist(x.body.position);
            let (_, _, turned) = boyer_lindquist(y.body.position);
            let late = y.body.time - x.body.time - (there.time - here.time);
            worst = worst.max(wrap_angle(turned - azimuth - there.azimuth).abs() + late.abs() / (1.0 + proper.abs()));
            worst = worst.max((y.body.position.length() / r - 1.0).abs());
        }
    }
    println!("charts agree to {worst:.1e}");
    assert!(worst < 1e-11);
}

/// On the axis the triad is that of azimuth 0 in the body's own chart: next to it nothing is much different.
#[test]
fn the_axis_is_no_place_on_the_way() {
    for clock in [Clock::Coordinate, Clock::Rain] {
        let [on, beside] = [0.0, 1e-8].map(|theta| {
            let start = body(clock, place(3.0, theta, 0.0), DVec3::new(0.1, 0.5, 0.2));
            after(0.9, &start, 4.0)
        });
        assert!(size(difference(numbers(&on), numbers(&beside))) < 1e-6, "{on:?} {beside:?}");
        for (x, y) in on.axes.iter().zip(beside.axes) {
            assert!((*x - y).length() < 1e-6, "{on:?} {beside:?}");
        }
    }
}

/// r = (9 / 2 (tau_end - tau)^2)^(1/3) of a rain observer without spin, whose clock is proper time, down to the centre.
#[test]
fn rain_observers_fall_as_in_the_textbook() {
    let start = body(Clock::Rain, DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO);
    let end = (2.0 / 9.0 * 1000.0_f64).sqrt();
    for left in [5.0, 1.0, 1e-3, 1e-6] {
        let event = after(0.0, &start, end - left);
        close(event.body.position.z / (4.5 * left * left).cbrt(), 1.0, 1e-8 / left.min(1.0).sqrt(), "r");
        close(event.body.time, end - left, 1e-11, "T");
        assert!(event.body.velocity.length() < 1e-8 / left.min(1.0), "{}", event.body.velocity);
    }
    let last = after(0.0, &start, 100.0);
    assert_eq!(last.end, Some(End::InnerHorizon));
    close(last.proper_time, end, 1e-10, "the end");
    close(last.body.position.length() / LEAST_RADIUS, 1.0, 1e-9, "r at the end");
}

#[test]
fn bad_bodies_are_refused_with_their_values() {
    let good = body(Clock::Rain, DVec3::X * 5.0, DVec3::ZERO);
    let refusal = |a: f64, body: &Body, time: f64| world_line(a, body, &AXES, &[time]).unwrap_err().message;
    for (a, body, time, says) in [
        (1.5, good, 1.0, "spin of 1.5"),
        (0.5, Body { velocity: DVec3::X, ..good }, 1.0, "velocity is 1;"),
        (0.5, Body { velocity: DVec3::NAN, ..good }, 1.0, "velocity is NaN"),
        (0.5, Body { time: f64::INFINITY, ..good }, 1.0, "time inf"),
        (0.5, Body { position: DVec3::X * 1e13, ..good }, 1.0, "at most 1e12 M"),
        (0.5, Body { position: DVec3::X * 0.05, ..good }, 1.0, "r- (1 + 1e-6)"),
        (0.5, body(Clock::Coordinate, DVec3::X * 1.5, DVec3::ZERO), 1.0, "r+ (1 + 1e-6)"),
        (0.0, Body { position: DVec3::X * 1e-10, ..good }, 1.0, "at or within"),
        (0.5, good, f64::NAN, "proper time is NaN"),
        (0.5, good, 1e13, "1e12"),
    ] {
        let message = refusal(a, &body, time);
        assert!(message.contains(says), "{says}: {message}");
    }
    // A bound orbit of longer than all steps last.
    let orbit = circular_orbit(0.0, 10.0).unwrap();
    let bound = body(Clock::Coordinate, DVec3::X * 10.0, DVec3::Z * orbit.beta);
    let message = refusal(0.0, &bound, 1e12);
    assert!(message.contains("steps"), "{message}");
    // Free bodies go any way.
    let free = after(0.9, &body(Clock::Coordinate, DVec3::X * 9.0, DVec3::X * 0.9), 1e12);
    assert!(free.end.is_none() && free.body.position.length() > 1e11, "{free:?}");
}
