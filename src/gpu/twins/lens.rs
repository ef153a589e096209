// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of lens/axis and of the tables of a spin-0 lens (lens/schwarzschild_curve, lens/schwarzschild_columns).

use super::inputs::{Inputs, Outputs};
use super::scenes::{self, FRAMES, Kind, view};
use super::{Group, ROUNDING, twin};
use crate::gpu::kernel::sizes::{SCHWARZSCHILD_OCTAVES, SCHWARZSCHILD_PER_OCTAVE};
use crate::gpu::lens::schwarzschild::SchwarzschildUniform;
use crate::physics::geodesic::{Constants, State};
use crate::physics::integrator::{Quintic, nystrom_step};
use crate::physics::lens::coordinate::{Coordinate, LEAST_OCTAVE};
use crate::physics::lens::schwarzschild::separatrix;
use crate::physics::lens::table::lagrange;
use crate::physics::observer::LocalFrame;
use crate::physics::shadow::critical_direction;
use glam::DVec3;

const HEAD: &str = "
#import lens/axis
#import lens/schwarzschild_columns
fn enter_lens() {
    enter_scene();
    lens = SchwarzschildLens(in4(1u), in1(5u), in1(6u), word(7u), word(8u));
}
fn followed(curve: Curve, steps: u32) -> CurvePoint {
    let h = 0.2 * min(1.0, 0.5 / frame.observer_u);
    let decay = step_decay(curve, h);
    var inner: vec3<f32>;
    var at = CurvePoint(0.0, curve.v, curve.dv);
    for (var k = 0u; k < steps; k += 1u) { at = curve_step(curve, at, h, decay, &inner); }
    return at;
}
";

/// Places behind the uniform.
const NODE: usize = 9;
const BRANCH: usize = 10;
const STEPS: usize = 11;

fn frame(i: &Inputs) -> LocalFrame {
    view(i).lens.observer.frame
}

/// A scene and its lens.
fn push_lens(i: &mut Inputs, kinds: &[Kind]) {
    kinds[i.random.below(kinds.len() as u32) as usize].push(i);
    let uniform = SchwarzschildUniform::new(&frame(i));
    let words: [u32; 8] = bytemuck::cast(uniform);
    words[..6].iter().for_each(|word| {
        i.push(f32::from_bits(*word).into());
    });
    words[6..].iter().for_each(|word| {
        i.push_word(*word);
    });
}

fn coordinate(frame: &LocalFrame) -> Coordinate {
    let (sin, cos) = critical_direction(frame.r, frame.rain);
    Coordinate::new(sin, cos, SCHWARZSCHILD_PER_OCTAVE as u32)
}

/// t_hat of a node.
fn t_hat(coordinate: &Coordinate, node: u32) -> f64 {
    coordinate.t_hat_at(f64::from(node) + SCHWARZSCHILD_PER_OCTAVE * (-LEAST_OCTAVE - SCHWARZSCHILD_OCTAVES))
}

/// The ray of the item's node, and how far in tau each step of the kernel is.
fn node_ray(i: &Inputs) -> (Constants, State, f64) {
    let frame = frame(i);
    let coordinate = coordinate(&frame);
    let t_hat = t_hat(&coordinate, i.word(NODE));
    let angle = coordinate.angle(if i.word(BRANCH) == 1 { -t_hat } else { t_hat });
    let (c, s) = frame.start(DVec3::new(-angle.cos, 0.0, angle.sin.abs())).expect("light of a static observer");
    (c, s, 0.2 * (0.5 * frame.r).min(1.0) / c.scale)
}

/// A node of a static observer's lens, and steps that its ray takes before it ends.
fn push_node(i: &mut Inputs) {
    push_lens(i, &[Kind::Static]);
    let branch = u32::from(i.word(8) > 0 && i.random.below(2) == 1);
    let nodes = i.word(7 + branch as usize);
    i.pick(nodes - 4);
    i.push_word(branch);
    let (c, mut s, h) = node_ray(i);
    let mut steps = 0;
    while steps < 60 {
        s = nystrom_step(&c, &s, h, false);
        if s.u <= 0.0 || s.u > 0.3 {
            break;
        }
        steps += 1;
    }
    i.pick(steps + 1);
}

fn followed(i: &Inputs, o: &mut Outputs) {
    let (c, mut s, h) = node_ray(i);
    for _ in 0..4 * i.word(STEPS) {
        s = nystrom_step(&c, &s, 0.25 * h, false);
    }
    // Beside the critical ray, u is the separatrix's, a difference of numbers of 1/3, and what it deviates by.
    let deviates = t_hat(&coordinate(&frame(i)), i.word(NODE)) < 0.07;
    let scale = if deviates { 1.0 / 3.0 } else { 1.0 / frame(i).r };
    o.near(s.u, scale);
    o.near(s.du / c.scale, scale);
    o.near(c.u_acceleration(s.u) / (c.scale * c.scale), scale);
}

fn push_cubic(i: &mut Inputs) {
    i.evens(4, -1.0, 1.0);
    i.even(0.0, 1.0);
}

fn cubic(i: &Inputs, x: f64) -> f64 {
    lagrange(i.v4(0).to_array(), x)
}

fn push_psi(i: &mut Inputs) {
    let critical = i.random.log(0.01, 2.5);
    let psi = i.random.even(0.0, std::f64::consts::PI);
    i.push(psi.cos());
    i.push(psi.sin().powi(2));
    i.push((0.5 * critical).tan());
}

pub fn group() -> Group {
    let (axis, curve, columns) = ("lens/axis", "lens/schwarzschild_curve", "lens/schwarzschild_columns");
    let plain = Kind::Static.constants();
    let twins = vec![
        twin(
            axis,
            "log2_mantissa",
            "out1(log2_mantissa(in1(0u)));",
            |i| {
                i.even(1.0, 1.9999);
            },
            |i, o| o.near(i.x(0).log2(), 1.0),
            // A dozen roundings; an H200 divides less exactly than lavapipe.
            4e-7,
        )
        .exactly(),
        twin(
            axis,
            "exp2_share",
            "out1(exp2_share(in1(0u)));",
            |i| {
                i.even(0.0, 0.9999);
            },
            |i, o| o.put(i.x(0).exp2()),
            3e-7,
        )
        .exactly(),
        twin(
            axis,
            "axis_position",
            "let p = axis_position(in1(0u), 22.0, 32.0, 2000u); out1(f32(i32(p.node) - i32(word(1u))) + p.share);",
            |i| {
                let t_hat = i.log(3e-7, 30.0);
                i.push_word((32.0 * (t_hat.log2() + 22.0)) as u32);
            },
            |i, o| {
                let x = Coordinate::new(1.0, 0.0, 32).x(i.x(0)) + 32.0 * (22.0 + LEAST_OCTAVE);
                o.near(x - f64::from(i.word(1)), 1.0);
            },
            // Its last sum is one of numbers up to 870, which f32 knows to 3e-5.
            6e-5,
        ),
        twin(
            axis,
            "lens_node_t_hat",
            "out1(lens_node_t_hat(i32(word(0u)) - 3, 22.0, 32));",
            |i| {
                i.pick(800);
            },
            |i, o| {
                let node = f64::from(i.word(0)) - 3.0;
                o.put(Coordinate::new(1.0, 0.0, 32).t_hat_at(node - 32.0 * (22.0 + LEAST_OCTAVE)));
            },
            ROUNDING,
        ),
        twin(
            axis,
            "lagrange",
            "out1(dot(lagrange(in1(4u)), in4(0u)));",
            push_cubic,
            |i, o| o.near(cubic(i, i.x(4)), 1.0),
            ROUNDING,
        ),
        twin(
            axis,
            "lagrange_slope",
            "out1(dot(lagrange_slope(in1(4u)), in4(0u)));",
            push_cubic,
            // A cubic's slope by central differences of fourth order is exact.
            |i, o| {
                let pair = |h: f64| cubic(i, i.x(4) + h) - cubic(i, i.x(4) - h);
                o.near((8.0 * pair(0.5) - pair(1.0)) / 6.0, 1.0);
            },
            ROUNDING,
        ),
        twin(
            axis,
            "lens_tangent",
            "out1(lens_tangent(in1(0u), in1(1u), in1(2u)));",
            push_psi,
            |i, o| {
                let half = i.x(2);
                let norm = 1.0 / (1.0 + half * half);
                let coordinate = Coordinate::new(2.0 * half * norm, (1.0 - half * half) * norm, 32);
                o.near(coordinate.t_hat(i.x(1).sqrt(), i.x(0)) * coordinate.scale, 0.01);
            },
            2e-5,
        ),
        twin(
            curve,
            "separatrix_root",
            "let q = separatrix_root(in1(0u)); out1(0.5 * q * q - 1.0 / 6.0);",
            |i| {
                i.even(-0.1, 0.7);
            },
            |i, o| o.near(separatrix(i.x(0)), 1.0),
            ROUNDING,
        ),
        twin(
            curve,
            "node_t nodes_of",
            "enter_lens(); out2(node_t(vec2<u32>(word(9u), word(10u)))); out_word(nodes_of(word(10u)));",
            push_node,
            |i, o| {
                let coordinate = coordinate(&frame(i));
                let t_hat = t_hat(&coordinate, i.word(NODE));
                o.put(if i.word(BRANCH) == 1 { -t_hat } else { t_hat } * coordinate.scale);
                o.put(t_hat);
                o.word(i.word(7 + i.word(BRANCH) as usize));
            },
            ROUNDING,
        )
        .with(&plain),
        twin(
            curve,
            "curve_of step_decay curve_step curve_acceleration curve_u curve_slope separatrix_u separatrix_root",
            "enter_lens(); let t = node_t(vec2<u32>(word(9u), word(10u))); let curve = curve_of(t.x, t.y);
             out3(column_point(curve, followed(curve, word(11u))));",
            push_node,
            followed,
            // Steps as large as those of the tables: below 1e-6 each beside the hole.
            2e-5,
        )
        .with(&plain),
        twin(
            columns,
            "column_point",
            "enter_lens(); let t = node_t(vec2<u32>(word(9u), word(10u))); let curve = curve_of(t.x, t.y);
             out3(column_point(curve, followed(curve, 0u)));",
            |i| {
                push_node(i);
                i.words[STEPS] = 0;
            },
            followed,
            4e-6,
        )
        .with(&plain),
        twin(
            columns,
            "column_middle",
            "out2(column_middle(in3(0u), in3(3u), in1(6u)));",
            |i| {
                i.evens(6, -1.0, 1.0);
                i.even(0.05, 0.5);
            },
            |i, o| {
                let (a, b, h) = (i.v3(0), i.v3(3), i.x(6));
                let (value, slope) = Quintic::new(a.x, a.y, a.z, b.x, b.y, b.z, h).at(0.5);
                o.near(value, 1.0);
                o.near(slope, 2.0 / h);
            },
            ROUNDING,
        ),
        twin(
            columns,
            "delay_slope",
            "enter_lens(); let t = node_t(vec2<u32>(word(9u), word(10u))); let curve = curve_of(t.x, t.y);
             out1(delay_slope(curve, in1(12u)));",
            |i| {
                push_node(i);
                i.log(1e-3, 0.3);
            },
            |i, o| {
                let (c, s, _) = node_ray(i);
                let rate = c.delay_rate(i.x(12), s.du, 0.0) / c.scale;
                o.near(rate, c.k * i.x(12) * (1.0 + (i.x(12) / c.u_observer).ln().abs()) / c.scale + 1.0);
            },
            5e-6,
        )
        .with(&plain),
    ];
    Group { name: "lens", head: [HEAD, FRAMES].concat(), twins, images: Vec::new, tables: scenes::tables }
}
