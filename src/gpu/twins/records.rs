// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of records/record, traced/layout, traced/footprints, shared/pass, and of lens/schwarzschild_record: what
//! becomes of the rays that were traced or looked up.

use super::inputs::{Inputs, Outputs};
use super::scenes::{self, FRAMES, Kind, View, push_look, view};
use super::{Group, ROUNDING, SAME, twin};
use crate::emit::{Crossing, EmissionPoint};
use crate::physics::lens::OrbitPlane;
use crate::scene::refine::{DiskEdges, Edge, looked_up_edge, near_disk_edge, turn_of, turning_edge};
use glam::DVec3;

const HEAD: &str = "
#import records/record
#import lens/schwarzschild_record
#import traced/layout
#import traced/footprints
#import shared/pass
var<private> frame: Frame;
var<private> pass_: Pass;
";

/// A direction and two changes of it, across it.
fn push_changes(i: &mut Inputs) {
    let d = i.direction();
    for _ in 0..2 {
        let change = i.random.direction() * i.random.log(1e-4, 1.0);
        i.vector(change - d * d.dot(change));
    }
}

fn push_crossing(i: &mut Inputs) {
    let view = Kind::Spinning.push(i);
    let [far, near] = view.scene.emitters().disk_u().expect("a disk");
    i.even(0.8 * far, 1.1 * near);
    i.signed(1e-5, 0.05);
    i.signed(1e-5, 0.05);
}

fn put_edge(o: &mut Outputs, edge: Edge) {
    o.word(edge as u32);
}

pub fn group() -> Group {
    let (record, layout, looked_up) = ("records/record", "traced/layout", "lens/schwarzschild_record");
    let plain = Kind::Static.constants();
    let twins = vec![
        twin(
            record,
            "footprint_of",
            "let f = footprint_of(in3(0u), in3(3u), in3(6u));
             out3(f.p * f.dx.x + f.q * f.dx.y); out3(f.p * f.dy.x + f.q * f.dy.y);
             out3(vec3<f32>(dot(f.p, f.q), dot(f.p, f.p), dot(f.q, f.q)));",
            push_changes,
            |i, o| {
                let d = i.v3(0);
                let across = |v: DVec3| v - d * d.dot(v);
                o.v3(across(i.v3(3)));
                o.v3(across(i.v3(6)));
                o.all([0.0, 1.0, 1.0], 1.0);
            },
            ROUNDING,
        ),
        twin(
            record,
            "near_disk_edge steep_change",
            "enter_scene(); out_flag(near_disk_edge(in1(1u), in2(2u)));",
            push_crossing,
            |i, o| {
                let emitters = view(i).scene.emitters();
                let disk_u = emitters.disk_u().expect("a disk").map(|u| f64::from(u as f32));
                let edges = DiskEdges::new(disk_u, emitters.fading_u(), &view(i).scene.matter());
                o.flag(near_disk_edge(i.x(1), [i.x(2), i.x(3)], &edges));
            },
            SAME,
        ),
        twin(
            record,
            "lit_about",
            "var c: Crossing; c.place = EmissionPoint(-log(in1(0u)), in1(2u), in1(3u));
             c.dx = EmissionPoint(in1(4u), in1(5u), in1(6u)); c.dy = EmissionPoint(in1(7u), in1(8u), in1(9u));
             c = lit_about(c, in1(1u), in1(10u)); out1(c.place.ln_r); out1(c.place.azimuth); out1(c.place.delay);
             out1(c.dx.ln_r); out1(c.dx.azimuth); out1(c.dx.delay);
             out1(c.dy.ln_r); out1(c.dy.azimuth); out1(c.dy.delay);",
            |i| {
                i.even(0.05, 0.2);
                i.even(0.05, 0.2);
                i.even(-3.0, 3.0);
                i.even(-50.0, 50.0);
                for unknown in [false, true] {
                    // Some sides are not known, or nothing changes along them.
                    match i.random.below(8) {
                        0 if unknown => i.push(1e30),
                        1 => i.push(0.0),
                        _ => i.signed(0.01, 0.3),
                    };
                    i.signed(0.01, 0.3);
                    i.signed(0.01, 0.3);
                }
                i.even(0.0, 1.0);
            },
            |i, o| {
                let point = |k: usize| EmissionPoint { ln_r: i.x(k), azimuth: i.x(k + 1), delay: i.x(k + 2) };
                let place = EmissionPoint { ln_r: -i.x(0).ln(), azimuth: i.x(2), delay: i.x(3) };
                let footprint = [point(4), point(7)];
                let crossing = Crossing { u: i.x(0), order: 0, g: 1.0, place, footprint, share: 1.0 };
                let lit = crossing.lit_about(i.x(1), i.x(10));
                for point in [lit.place, lit.footprint[0], lit.footprint[1]] {
                    o.all([point.ln_r, point.azimuth, point.delay], 100.0);
                }
            },
            ROUNDING,
        ),
        twin(
            record,
            "is_wanted",
            "enter_scene(); out_flag(is_wanted(in1(1u)));",
            push_crossing,
            |i, o| {
                let [far, near] = view(i).scene.emitters().disk_u().expect("a disk").map(|u| f64::from(u as f32));
                o.flag(i.x(1) >= far && i.x(1) <= near);
            },
            SAME,
        ),
        twin(
            record,
            "beyond_right_angle",
            "out1(beyond_right_angle(in1(0u)));",
            |i| {
                i.signed(1e-4, 1e4);
            },
            |i, o| {
                // d ln |t| / d psi of `SchwarzschildLookup::curve_slope`: (1 + t^2) / (2 t) up to 90 degrees, 1 beyond.
                let slope = |t: f64| (1.0 + t * t) / (2.0 * t);
                o.put(slope(i.x(0).abs()) / slope(i.x(0).abs().min(1.0)));
            },
            ROUNDING,
        ),
        twin(
            record,
            "looked_up_edge",
            "out_word(looked_up_edge(word(0u) == 1u, in1(2u), in1(1u), in1(3u)));",
            |i| {
                i.pick(2);
                i.log(0.1, 20.0);
                i.log(0.01, 10.0);
                let through = [0.0, 0.5, 1.0][i.random.below(3) as usize];
                i.push(through);
            },
            |i, o| {
                // f64 says by an infinite distance that the disk lets nothing through.
                let [turn, curve] = if i.x(3) > 0.0 { [i.x(2), i.x(1)] } else { [0.0, f64::INFINITY] };
                put_edge(o, looked_up_edge(i.word(0) == 1, turn, curve));
            },
            SAME,
        ),
        twin(
            record,
            "turning_edge",
            "out_word(turning_edge(in1(0u)));",
            |i| {
                i.log(0.01, 10.0);
            },
            |i, o| put_edge(o, turning_edge(i.x(0))),
            SAME,
        ),
        twin(
            record,
            "turn_of",
            "var record: Record;
             record.fate = select(FATE_CAPTURED, FATE_ESCAPED, word(9u) > 0u);
             record.footprint = footprint_of(in3(0u), in3(3u), in3(6u));
             out1(turn_of(record));",
            |i| {
                push_changes(i);
                i.pick(4);
            },
            |i, o| o.put(if i.word(9) > 0 { turn_of([i.v3(3), i.v3(6)]) } else { 0.0 }),
            2e-5,
        ),
        twin(
            layout,
            "pack_meta unpack_meta",
            "let m = unpack_meta(pack_meta(TracedMeta(word(0u), word(1u), word(2u), word(3u), in1(4u), in1(5u),
             0.5)));
             out_word(m.fate); out_word(m.beside_disk); out_word(m.orders); out_word(m.steps); out1(m.energy);
             out1(m.angular_momentum);",
            |i| {
                i.pick(4);
                i.pick(1 << 14);
                i.pick(1 << 16);
                i.pick(1 << 17);
                i.even(-1.0, 2.0);
                i.even(-9.0, 9.0);
            },
            |i, o| {
                (0..4).for_each(|k| o.word(i.word(k)));
                o.near(i.f(4).into(), 0.0);
                o.near(i.f(5).into(), 0.0);
            },
            SAME,
        )
        .exactly(),
        twin(
            layout,
            "pack_momentum unpack_momentum",
            "let m = TracedMeta(1u, 2u, 3u, 100000u, 0.5, 0.5, in1(0u));
             let found = unpack_meta(pack_meta(m)); out1(found.polar_momentum); out_word(found.steps);",
            |i| {
                i.log(1e-9, 1e4);
            },
            // From 2^-22 to the last number below 2^10.
            |i, o| {
                o.put(i.x(0).clamp(2.0_f64.powi(-22), 2.0_f64.powi(10)));
                o.word(100_000);
            },
            6e-4,
        ),
        twin(
            "traced/footprints",
            "place_of",
            "let p = place_of(in4(0u)); out3(vec3<f32>(p.ln_r, p.azimuth, p.delay));",
            |i| {
                i.log(1e-4, 0.5);
                i.evens(3, -3.0, 3.0);
            },
            |i, o| o.all([-i.x(0).ln(), i.x(2), i.x(3)], 1.0),
            ROUNDING,
        ),
        twin(
            "shared/pass",
            "pixel_place outside_tile",
            "pass_.origin = vec2<i32>(-1); pass_.offset = in2(0u); pass_.size = vec2<u32>(66u, 34u);
             let id = vec2<u32>(word(2u), word(3u)); out2(pixel_place(id)); out_flag(outside_tile(id));",
            |i| {
                i.evens(2, 0.0, 1.0);
                i.pick(70);
                i.pick(40);
            },
            |i, o| {
                o.put(f64::from(i.word(2)) + i.x(0));
                o.put(f64::from(i.word(3)) + i.x(1));
                o.flag(i.word(2) >= 64 || i.word(3) >= 32);
            },
            ROUNDING,
        ),
        twin(
            looked_up,
            "local_energy",
            "enter_scene(); out1(local_energy(in3(1u)));",
            |i| {
                let view = [Kind::Static, Kind::Rain][i.random.below(2) as usize].push(i);
                push_look(i, view);
            },
            |i, o| o.near(view(i).lens.observer.frame.momenta().energy(i.v3(1)), 1.0),
            ROUNDING,
        )
        .with(&plain),
        twin(
            looked_up,
            "first_crossing_angle",
            "enter_scene(); out1(first_crossing_angle(in1(4u)));",
            |i| {
                let view = Kind::Static.push(i);
                let n = push_look(i, view);
                let across = n.y.hypot(n.z);
                i.push(if across > 0.0 { n.y / across } else { 1.0 });
            },
            |i, o| {
                let View { lens, .. } = view(i);
                let plane =
                    OrbitPlane::new(&lens.observer.frame, DVec3::new(0.0, i.x(4), (1.0 - i.x(4).powi(2)).sqrt()));
                o.near(plane.crossing_angle(0).unwrap_or(1e30), 1.0);
            },
            3e-6,
        )
        .with(&plain),
    ];
    Group { name: "records", head: [HEAD, FRAMES].concat(), twins, images: Vec::new, tables: scenes::tables }
}
