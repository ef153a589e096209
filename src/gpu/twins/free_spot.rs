// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of emit/free_spot: hot spots in free fall.

use super::inputs::Inputs;
use super::{Group, ROUNDING, twin};
use crate::emit::bands::When;
use crate::emit::free_spot::Centre;
use crate::emit::matter::SpotMatter;
use crate::physics::flow::Place;
use crate::physics::orbit::horizon_outer;
use crate::physics::rain_motion::{rain_velocity, zamo_velocity};
use crate::physics::world_line::table::Node;
use crate::scene::HotSpot;
use glam::DVec3;

const HEAD: &str = "#import emit/free_spot
fn light_table(i: u32) -> vec4<f32> { return vec4<f32>(f32(i)); }
";

/// A place anywhere from inside the horizon of a hole of spin `a` to far away, off the axis, where azimuths turn fast.
fn push_position(i: &mut Inputs) -> DVec3 {
    let direction = i.random.direction();
    let r = i.random.log(0.3, 50.0);
    let position = DVec3::new(direction.x + 0.2_f64.copysign(direction.x), direction.y, direction.z) * r;
    i.vector(position);
    position
}

fn node(i: &Inputs, first: usize) -> Node {
    Node { position: i.v3(first), rate: i.v3(first + 4), time: i.x(first + 7) }
}

pub fn group() -> Group {
    let free = "emit/free_spot";
    let twins = vec![
        twin(
            free,
            "centre_between",
            "let s = centre_between(in4(0u), in4(4u), in4(8u), in4(12u), in1(16u));
             out3(s.position); out3(s.rate); out1(s.share);",
            |i| {
                push_position(i);
                i.push(1.0);
                i.evens(3, -1.0, 1.0);
                let begin = i.even(-200.0, 40.0);
                // The next place is about as far as the body gets.
                let span = i.random.even(0.2, 3.0);
                for k in 0..3 {
                    let change = i.random.even(-1.0, 1.0);
                    i.push(i.x(k) + span * change);
                }
                i.even(0.0, 1.0);
                i.evens(3, -1.0, 1.0);
                i.push(begin + span);
                let share = i.random.even(0.0, 1.0);
                i.push(begin + span * share);
            },
            |i, o| {
                let (before, after) = (node(i, 0), node(i, 8));
                let (found, span) = (Node::between(&before, &after, i.x(16)), after.time - before.time);
                // Times of hundreds of M are told to 1e-5 of them.
                o.all(found.position.to_array(), before.position.length().max(1.0));
                o.all(found.rate.to_array(), before.position.length().max(1.0) / span.min(1.0));
                let share = (i.x(16) - before.time) / span;
                o.near(1.0 + (i.x(11) - 1.0) * share, 1.0);
            },
            1e-4,
        ),
        twin(
            free,
            "free_density",
            "var m: Matter; m.size = in1(0u);
             out1(free_density(in1(1u), in1(2u), in1(3u), SpotCentre(in3(4u), vec3<f32>(0.0), in1(7u)), m));",
            |i| {
                i.log(0.1, 3.0);
                let r = i.log(1.0, 30.0);
                i.even(-0.95, 0.95);
                let azimuth = i.even(-3.0, 3.0);
                let (cos, size) = (i.x(2), i.x(0));
                let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
                let place = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos) * r;
                let beside = place + i.random.direction() * (2.0 * size);
                i.vector(beside);
                i.even(0.1, 1.0);
            },
            |i, o| {
                let when = When::default();
                let spot = SpotMatter::new(&HotSpot::default(), 0.0, &when, None).expect("it is on a circle");
                let (r, cos, azimuth) = (i.x(1), i.x(2), i.x(3));
                let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
                let place = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos) * r;
                let centre = Centre { position: i.v3(4), rate: DVec3::ZERO, share: i.x(7) };
                o.near(SpotMatter { size: i.x(0), ..spot }.free_density(place, &centre), 1e-2);
            },
            1e-4,
        ),
        twin(
            free,
            "rain_velocity",
            "out3(rain_velocity(in1(6u), in3(0u), in3(3u)));",
            |i| {
                push_position(i);
                i.evens(3, -1.0, 1.0);
                i.even(-0.999, 0.999);
            },
            |i, o| {
                let found = rain_velocity(i.x(6), i.v3(0), i.v3(3));
                o.all(found.to_array(), 1.0 + found.length());
            },
            ROUNDING * 16.0,
        ),
        twin(
            free,
            "zamo_velocity",
            "let p = Place(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, in1(0u), 0.0); out3(zamo_velocity(p, in3(1u)));",
            |i| {
                i.even(0.05, 0.99);
                let (direction, speed) = (i.random.direction(), i.random.even(0.0, 0.95));
                i.vector(direction * speed);
            },
            |i, o| {
                let at = Place { lapse: i.x(0), ..Place::new(0.0, 1.0 / (3.0 * horizon_outer(0.0)), 0.0) };
                let found = zamo_velocity(&at, i.v3(1));
                let size = 1.0 + found.radial.abs();
                o.all([found.around, found.radial, found.polar], size);
            },
            ROUNDING * 32.0,
        ),
    ];
    Group { name: "free spots", head: HEAD.into(), twins, images: Vec::new, tables: Vec::new }
}
