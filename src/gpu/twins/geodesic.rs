// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of shared/math, shared/f16, shared/not_inlined and geodesic/geodesic.

use super::inputs::{Inputs, Outputs};
use super::{Group, ROUNDING, SAME, TRANSCENDENTAL, twin};
use crate::physics::geodesic::{Clock, Constants, State, rain_offset, wrap_angle};
use crate::physics::integrator::{nystrom_step, step_limit};
use crate::physics::metric::chart;
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::innermost_radius;
use glam::DVec3;
use std::f64::consts::PI;

/// WGSL that reads what `ray` and `state` push, and hands states on.
pub const RAYS: &str = "
fn ray_constants() -> Constants {
    return Constants(in1(0u), in1(1u), in1(2u), in1(7u), in1(4u), in1(5u), in1(6u), in1(0u) * in1(0u) * in1(3u),
        in1(9u), in1(8u), in1(10u), in1(11u), word(12u));
}
fn ray_state(k: u32) -> State {
    return State(in1(k), in1(k + 1u), in3(k + 2u), in3(k + 5u), in1(k + 8u), in1(k + 9u));
}
fn out_state(s: State) { out2(vec2<f32>(s.u, s.du)); out3(s.n); out3(s.dn); out2(vec2<f32>(s.drag, s.delay)); }
";

/// Where the state begins, and where there is room behind it.
pub const STATE: usize = 13;
pub const BEHIND: usize = 23;

/// Pushes the constants of a ray.
pub fn push_constants(i: &mut Inputs, c: &Constants) {
    let numbers = [
        c.a,
        c.energy,
        c.angular_momentum,
        c.carter,
        c.k,
        c.b,
        c.a2e2,
        c.nu_local,
        c.u_observer,
        c.scale,
        c.r_plus,
        c.r_minus,
    ];
    numbers.into_iter().for_each(|v| {
        i.push(v);
    });
    i.push_word(c.clock as u32);
}

pub fn push_state(i: &mut Inputs, s: &State) {
    i.push(s.u);
    i.push(s.du);
    i.vector(s.n);
    i.vector(s.dn);
    i.push(s.drag);
    i.push(s.delay);
}

pub fn constants(i: &Inputs) -> Constants {
    let [a, energy, angular_momentum, carter, k, b, a2e2, nu_local, u_observer, scale, r_plus, r_minus] =
        std::array::from_fn(|k| i.x(k));
    // Rays of E = 1 have other formulas in f64: it is 1 under every shift.
    let energy = if i.f(1) == 1.0 { 1.0 } else { energy };
    let clock = if i.word(12) == Clock::Rain as u32 { Clock::Rain } else { Clock::Coordinate };
    let light = Constants::new(a, energy, angular_momentum, carter, nu_local, u_observer);
    Constants { k, b, a2e2, scale, r_plus, r_minus, clock, ..light }
}

pub fn state(i: &Inputs, k: usize) -> State {
    State { u: i.x(k), du: i.x(k + 1), n: i.v3(k + 2), dn: i.v3(k + 5), drag: i.x(k + 8), delay: i.x(k + 9) }
}

/// A random ray of E = 1, and where it is after a few steps: outside the horizon, and on this side of infinity.
pub fn random_ray(i: &mut Inputs, spinning: bool) -> (Constants, State) {
    loop {
        let a = if spinning { i.random.even(-0.998, 0.998) } else { 0.0 };
        let (r, theta) = (i.random.log(3.2, 300.0), i.random.even(0.1, PI - 0.1));
        let frame = LocalFrame::new(a, chart(r, theta, i.random.even(0.0, 6.0))).expect("outside the horizon");
        // Half of the rays towards the hole.
        let n = i.random.direction();
        let n = if i.random.below(2) == 0 { (n * (8.0 / r).min(1.0) - DVec3::X).normalize() } else { n };
        let Some((c, mut state)) = frame.start(n) else { continue };
        let mut steps = i.random.below(12);
        while steps > 0 {
            let next = nystrom_step(&c, &state, 0.2 / c.scale, false);
            if next.u <= 1e-4 || next.u * c.r_plus > 0.9 {
                break;
            }
            state = next;
            steps -= 1;
        }
        // In the ergosphere E is not 1.
        if c.energy == 1.0 && state.u * c.r_plus < 0.9 {
            return (c, state);
        }
    }
}

/// A random ray with spin, or without.
pub fn spinning_ray(i: &mut Inputs) {
    let (c, s) = random_ray(i, true);
    push_constants(i, &c);
    push_state(i, &s);
}

pub fn plain_ray(i: &mut Inputs) {
    let (c, s) = random_ray(i, false);
    push_constants(i, &c);
    push_state(i, &s);
}

/// A ray that leaves outwards from within the photon sphere, told by rain time.
pub fn rain_ray(i: &mut Inputs) {
    let r = i.random.even(0.5, 2.95);
    let theta = i.random.even(0.1, PI - 0.1);
    let frame = LocalFrame::new(0.0, chart(r, theta, i.random.even(0.0, 6.0))).expect("a place").to_rain();
    let n = (i.random.direction() * 0.7 + DVec3::X).normalize();
    let (c, s) = frame.start(n).expect("light from outside");
    push_constants(i, &c);
    push_state(i, &s);
}

/// A ray of the rain frame of a spinning hole, and where it is after a few steps: inside the horizon or outside, not
/// within 5 % of it unless it leaves, and on this side of infinity.
pub fn random_spinning_rain_ray(i: &mut Inputs) -> (Constants, State) {
    loop {
        let a = i.random.even(-0.998, 0.998);
        let r = i.random.even(1.02 * innermost_radius(a), 2.95);
        let theta = i.random.even(0.1, PI - 0.1);
        let frame = LocalFrame::rain(a, chart(r, theta, i.random.even(0.0, 6.0))).expect("a place");
        let n = (i.random.direction() + DVec3::X * 0.4).normalize();
        let Some((c, mut state)) = frame.start(n) else { continue };
        let mut steps = i.random.below(8);
        while steps > 0 && state.u > 0.05 {
            let h = (0.2 / c.scale).min(step_limit(&c, &state, 0.2));
            state = nystrom_step(&c, &state, h, false);
            steps -= 1;
        }
        let beside = (1.0 - state.u * c.r_plus).abs() < 0.05 && (state.du > 0.0 || c.radial_energy(state.u) < 0.1);
        // Far from where E is next to nothing, and where f32 and f64 choose another form by a hair.
        let clear = c.energy == 1.0 && c.radial_energy(state.u) > 0.01 && state.du.abs() > 1e-3;
        if clear && !beside && state.u > 1e-3 && state.u * 1.02 * innermost_radius(a) < 1.0 {
            return (c, state);
        }
    }
}

pub fn spinning_rain_ray(i: &mut Inputs) {
    let (c, s) = random_spinning_rain_ray(i);
    push_constants(i, &c);
    push_state(i, &s);
}

/// u' of a ray of `rain_ray`.
fn outward(c: &Constants, u: f64) -> f64 {
    -(1.0 - c.k * u * u * (1.0 - 2.0 * u)).max(0.0).sqrt()
}

/// The size of the terms of x that may cancel, for a ray of a rain frame.
fn rain_size(c: &Constants, s: &State) -> f64 {
    let size = c.energy + (c.a * c.a + (c.a * c.angular_momentum).abs()) * s.u * s.u;
    let x = c.advanced_rate(s.u, s.du).abs();
    1.0 + x * (1.0 + size / (c.radial_energy(s.u) - s.du)) + size / c.horizon_function(s.u).abs() + s.du.abs()
}

fn rate(i: &Inputs, o: &mut Outputs) {
    let (c, s) = (constants(i), state(i, STATE));
    let du = if c.clock == Clock::Rain { outward(&c, s.u) } else { s.du };
    let rate = c.delay_rate(s.u, du, s.n.z);
    // Terms of the size of K u cancel.
    o.near(rate, c.k * s.u * (1.0 + (s.u / c.u_observer).ln().abs()));
}

fn boundary(i: &Inputs, o: &mut Outputs) {
    let (c, s) = (constants(i), state(i, STATE));
    o.near(c.delay_boundary(s.u, s.du), (s.du / s.u).abs());
}

/// A ray of another E than 1, as WGSL has it: constants and slopes are E times those of E = 1, their squares E^2 times.
fn ray_of_other_energy(i: &mut Inputs) {
    let (mut c, mut s) = random_ray(i, true);
    let e = i.random.log(0.06, 3.0);
    for v in [&mut c.energy, &mut c.angular_momentum, &mut c.nu_local, &mut c.scale] {
        *v *= e;
    }
    for v in [&mut c.carter, &mut c.k, &mut c.b, &mut c.a2e2] {
        *v *= e * e;
    }
    (s.du, s.dn) = (s.du * e, s.dn * e);
    push_constants(i, &c);
    push_state(i, &s);
}

fn of_unit_energy(c: &Constants) -> Constants {
    let e = c.energy;
    Constants {
        k: c.k / (e * e),
        b: c.b / (e * e),
        ..Constants::new(c.a, 1.0, c.angular_momentum / e, c.carter / (e * e), c.nu_local / e, c.u_observer)
    }
}

pub fn group() -> Group {
    let spinning = [("SPINNING", 1.0), ("DELAY", 1.0)];
    let plain = [("SPINNING", 0.0), ("DELAY", 1.0)];
    let rain = [("SPINNING", 1.0), ("DELAY", 1.0), ("RAIN", 1.0)];
    let geodesic = "geodesic/geodesic";
    let twins = vec![
        twin(
            "shared/math",
            "sincos sincos_quarters",
            "out2(sincos(in1(0u)));",
            |i| {
                i.even(-1e3, 1e3);
            },
            |i, o| {
                let (sin, cos) = i.x(0).sin_cos();
                o.all([sin, cos], 1.0);
            },
            // Its comment promises 2e-7 for |x| < 1e3.
            2e-7,
        )
        .exactly(),
        twin(
            "shared/math",
            "sincos_turn",
            "out2(sincos_turn(in1(0u), in1(1u)));",
            |i| {
                let whole = i.random.below(16384) + 1;
                i.push(f64::from(i.random.clone().below(2 * whole)) * 0.5);
                i.push(f64::from(whole));
            },
            |i, o| {
                let (sin, cos) = (2.0 * PI * i.x(0) / i.x(1)).sin_cos();
                o.all([sin, cos], 1.0);
            },
            2e-7,
        )
        .exactly(),
        twin(
            "shared/math",
            "arctan2",
            "out1(arctan2(in1(0u), in1(1u)));",
            |i| {
                i.signed(1e-6, 1e6);
                i.signed(1e-6, 1e6);
            },
            |i, o| o.near(i.x(0).atan2(i.x(1)), 1.0),
            // Its comment promises 3e-7, and pi is rounded besides.
            4e-7,
        )
        .exactly(),
        twin(
            "shared/math",
            "wrap_angle",
            "out1(wrap_angle(in1(0u)));",
            |i| {
                i.even(-30.0, 30.0);
            },
            |i, o| o.near(wrap_angle(i.x(0)), 1.0),
            // A few turns are taken off; that of WGSL goes to [-pi, pi], at whose ends rounding decides.
            2e-6,
        ),
        twin(
            "shared/f16",
            "rounded_to_f16",
            "out4(rounded_to_f16(in4(0u)));",
            |i| {
                (0..4).for_each(|_| {
                    i.log(1e-9, 65504.0);
                })
            },
            |i, o| (0..4).for_each(|k| o.near(f64::from(half::f16::from_f32(i.f(k))), 0.0)),
            SAME,
        )
        .exactly(),
        twin(
            "shared/not_inlined",
            "not_inlined",
            "out_word(not_inlined(word(0u)));",
            |i| {
                i.bits();
            },
            |i, o| o.word(i.word(0)),
            SAME,
        ),
        twin(
            geodesic,
            "u_acceleration",
            "out1(u_acceleration(ray_constants(), in1(13u)));",
            ray_of_other_energy,
            |i, o| o.put(constants(i).u_acceleration(i.x(STATE))),
            ROUNDING,
        ),
        twin(
            geodesic,
            "n_acceleration",
            "out3(n_acceleration(ray_constants(), in3(15u)));",
            ray_of_other_energy,
            |i, o| o.v3(constants(i).n_acceleration(i.v3(15))),
            ROUNDING,
        )
        .with(&spinning),
        twin(
            geodesic,
            "n_acceleration",
            "out3(n_acceleration(ray_constants(), in3(15u)));",
            plain_ray,
            |i, o| o.v3(constants(i).n_acceleration(i.v3(15))),
            ROUNDING,
        )
        .with(&plain),
        twin(
            geodesic,
            "horizon_function",
            "out1(horizon_function(ray_constants(), in1(13u)));",
            spinning_ray,
            |i, o| o.put(constants(i).horizon_function(i.x(STATE))),
            ROUNDING,
        ),
        twin(
            geodesic,
            "drag_rate",
            "out1(drag_rate(ray_constants(), in1(13u)));",
            ray_of_other_energy,
            |i, o| o.put(constants(i).drag_rate(i.x(STATE))),
            ROUNDING,
        )
        .with(&spinning),
        twin(
            geodesic,
            "delay_rate coordinate_delay_rate delay_by_parts",
            "out1(delay_rate(ray_constants(), in1(13u), in1(17u)));",
            spinning_ray,
            rate,
            TRANSCENDENTAL,
        )
        .with(&spinning),
        twin(
            geodesic,
            "delay_rate plain_rain_delay_rate",
            "out1(delay_rate(ray_constants(), in1(13u), in1(17u)));",
            rain_ray,
            rate,
            TRANSCENDENTAL,
        )
        .with(&plain),
        // The rate by tau of another E is E times that of E = 1.
        twin(
            geodesic,
            "coordinate_delay_rate",
            "out1(coordinate_delay_rate(ray_constants(), in1(13u), in1(17u)));",
            ray_of_other_energy,
            |i, o| {
                let (c, s) = (constants(i), state(i, STATE));
                let unit = of_unit_energy(&c);
                let scale = unit.k * s.u * (1.0 + (s.u / c.u_observer).ln().abs());
                o.near(c.energy * unit.delay_rate(s.u, s.du / c.energy, s.n.z), c.energy * scale);
            },
            TRANSCENDENTAL,
        )
        .with(&spinning),
        // Below 0.05, neither integrates by parts.
        twin(
            geodesic,
            "coordinate_delay_rate",
            "out1(coordinate_delay_rate(ray_constants(), in1(13u), in1(17u)));",
            |i| {
                let (mut c, s) = random_ray(i, true);
                c.energy = i.random.even(-0.5, 0.04);
                push_constants(i, &c);
                push_state(i, &s);
            },
            |i, o| {
                let (c, s) = (constants(i), state(i, STATE));
                // f64 has E^2 / E for E.
                let frame = (c.a * c.a * c.energy - c.a2e2 / c.energy) * s.n.z * s.n.z;
                o.near(c.delay_rate(s.u, s.du, s.n.z) + frame, c.energy.abs() / (s.u * s.u) + 4.0);
            },
            TRANSCENDENTAL,
        )
        .with(&spinning),
        twin(
            geodesic,
            "delay_boundary coordinate_delay_boundary",
            "out1(delay_boundary(ray_constants(), in1(13u), in1(14u)));",
            spinning_ray,
            boundary,
            TRANSCENDENTAL,
        )
        .with(&spinning),
        twin(
            geodesic,
            "delay_boundary",
            "out1(delay_boundary(ray_constants(), in1(13u), in1(14u)));",
            rain_ray,
            boundary,
            TRANSCENDENTAL,
        )
        .with(&plain),
        twin(
            geodesic,
            "radial_energy advanced_rate signed_horizon_function turn_rate",
            "let c = ray_constants(); let s = ray_state(13u);
             out3(vec3<f32>(radial_energy(c, s.u), advanced_rate(c, s.u, s.du), turn_rate(c)));
             out1(signed_horizon_function(c, s.u));",
            spinning_rain_ray,
            |i, o| {
                let (c, s) = (constants(i), state(i, STATE));
                let size = c.energy + (c.a * c.a + (c.a * c.angular_momentum).abs()) * s.u * s.u;
                o.near(c.radial_energy(s.u), size);
                // W - u' of what falls, and (W + u') / D of what does not, cancel.
                let d = c.horizon_function(s.u);
                let x = c.advanced_rate(s.u, s.du);
                o.near(x, x.abs() * (1.0 + size / (c.radial_energy(s.u) - s.du)) + size / d.abs());
                o.put(c.turn_rate());
                o.near(d, 1.0 + s.u * c.r_plus);
            },
            TRANSCENDENTAL,
        )
        .with(&rain),
        twin(
            geodesic,
            "kerr_drag_rate",
            "let c = ray_constants(); let s = ray_state(13u); out1(kerr_drag_rate(c, s.u, s.du));",
            spinning_rain_ray,
            |i, o| {
                let (c, s) = (constants(i), state(i, STATE));
                o.near(c.kerr_drag_rate(s.u, s.du), rain_size(&c, &s));
            },
            TRANSCENDENTAL,
        )
        .with(&rain),
        twin(
            geodesic,
            "rain_delay_rate delay_boundary",
            "let c = ray_constants(); let s = ray_state(13u);
             out2(vec2<f32>(rain_delay_rate(c, s.u, s.du, s.n.z), delay_boundary(c, s.u, s.du)));",
            spinning_rain_ray,
            |i, o| {
                let (c, s) = (constants(i), state(i, STATE));
                let size = (c.k.abs() + c.b.abs() * s.u) * s.u * (1.0 + s.u.ln().abs()) * (1.0 + s.u);
                o.near(c.delay_rate(s.u, s.du, s.n.z), size + 2.0 * rain_size(&c, &s) / s.u);
                o.near(c.delay_boundary(s.u, s.du), (s.du / s.u).abs() + s.du.abs());
            },
            TRANSCENDENTAL,
        )
        .with(&rain),
        twin(
            geodesic,
            "clock_offset",
            "out1(clock_offset(ray_constants(), in1(23u)));",
            |i| {
                rain_ray(i);
                i.log(1e-4, 0.4);
            },
            |i, o| {
                let (w, u) = ((2.0 * i.x(BEHIND)).sqrt(), i.x(BEHIND));
                assert_eq!(constants(i).clock_offset(u), rain_offset(u, 1.0 - 2.0 * u));
                o.near(constants(i).clock_offset(u), 4.0 / w);
            },
            TRANSCENDENTAL,
        )
        .with(&plain),
        twin(
            geodesic,
            "retardation",
            "let s = ray_state(13u);
             out1(retardation(ray_constants(), in1(23u), in1(24u), s.u, s.du, in1(25u)));",
            |i| {
                spinning_ray(i);
                i.even(0.003, 0.3);
                i.even(-1.0, 1.0);
                i.even(-50.0, 50.0);
            },
            |i, o| {
                let (c, s) = (constants(i), state(i, STATE));
                let observer = State { u: i.x(BEHIND), du: i.x(BEHIND + 1), delay: 0.0, ..s };
                let there = State { delay: i.x(BEHIND + 2), ..s };
                o.near(c.retardation(&observer, &there), (s.du / s.u).abs() + (observer.du / observer.u).abs());
            },
            TRANSCENDENTAL,
        )
        .with(&spinning),
        twin(
            geodesic,
            "chart_direction",
            "out3(chart_direction(in3(15u), in1(23u)));",
            |i| {
                spinning_ray(i);
                i.even(-20.0, 20.0);
            },
            |i, o| o.v3(State { drag: i.x(BEHIND), ..state(i, STATE) }.chart_direction()),
            ROUNDING,
        )
        .with(&spinning),
    ];
    let imports = "#import geodesic/geodesic\n#import shared/math\n#import shared/f16\n#import shared/not_inlined\n";
    Group { name: "geodesic", head: [imports, RAYS].concat(), twins, images: Vec::new, tables: Vec::new }
}
