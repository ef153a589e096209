// SPDX-License-Identifier: MIT OR Apache-2.0
//! Images of a point as rain observers see them beside a spinning hole's horizon and inside it, in Doran's chart, in
//! which nothing happens at the horizon: the ray to a rain observer above, at the same angles, is followed while the
//! observer moves inwards.

use super::path::{self, brought, follow};
use super::shooting::{Aim, COARSE, Target};
use super::spin::BESIDE;
use super::winding::{self, Way};
use crate::physics::geodesic::turned;
use crate::physics::observer::{LocalFrame, Observer};
use crate::physics::orbit::horizon_outer;
use crate::physics::rain::offsets;
use glam::{DQuat, DVec3};

/// How far above the horizon rays are found as static observers see them, M: nearer to it those see nearly all light
/// from one side. The others are tried where the way down from the first one fails.
const ABOVE: [f64; 4] = [0.3, 1.0, 0.1, 3.0];

/// Steps in sigma of rays that are handed out: what they are off by near the hole grows on their way out.
pub const STEP: f64 = 0.0125;

/// Steps of rays on the way down: the second where the first does not lead to the end.
const STEPS_ON_THE_WAY: [f64; 2] = [COARSE, 0.025];

/// Whether the images of a rain frame's observer are found by those above.
pub fn is_below(frame: &LocalFrame) -> bool {
    frame.rain && frame.a != 0.0 && frame.r < horizon_outer(frame.a) + ABOVE[0]
}

/// The ray to `point` (whose azimuth is Doran's) after `order` half turns, for the observer of a rain frame.
pub fn aim(frame: &LocalFrame, point: DVec3, order: u32) -> Option<Aim> {
    let straight = ABOVE.iter().find_map(|above| down(frame, point, order, *above));
    straight.or_else(|| {
        // From the image of a point beside it.
        BESIDE.iter().find_map(|[turn, lift]| {
            let beside = DQuat::from_rotation_z(*turn) * (DQuat::from_axis_angle(frame.e_phi, *lift) * point);
            let arc = DQuat::from_rotation_arc(beside.normalize(), point.normalize());
            let way = |s: f64| Some((*frame, Target::new(DQuat::IDENTITY.slerp(arc, s) * beside)));
            arrived(frame, point, order, &way, down(frame, beside, order, ABOVE[0])?)
        })
    })
}

/// The ray that the one to the rain observer `above` the horizon becomes.
fn down(frame: &LocalFrame, point: DVec3, order: u32, above: f64) -> Option<Aim> {
    let begin = horizon_outer(frame.a) + above;
    let at = |r: f64| LocalFrame { r, offsets: None, ..*frame };
    let way = |s: f64| Some((at(begin * (frame.r / begin).powf(s)), Target::new(point)));
    arrived(frame, point, order, &way, from_above(&at(begin), point, order)?)
}

/// The ray at the end of a way that leads to `frame` and `point`, with all digits.
fn arrived(frame: &LocalFrame, point: DVec3, order: u32, way: &Way<'_>, begun: Aim) -> Option<Aim> {
    let all_digits = |aim: Aim| brought(frame, &Target::new(point), aim, order, STEP);
    // Deep inside long steps lead to other rays; and where the point meets a caustic, the curve of rays turns.
    let steps = if order < 2 { &STEPS_ON_THE_WAY[..] } else { &[] };
    let led = steps.iter().find_map(|step| follow(way, begun, order, *step).and_then(all_digits));
    led.or_else(|| winding::led(way, &begun, order).and_then(all_digits))
}

/// The ray for the rain observer of a frame outside the horizon, found as the static observer's there.
fn from_above(frame: &LocalFrame, point: DVec3, order: u32) -> Option<Aim> {
    let zamo = frame.to_static();
    let there = turned(point, -offsets(frame.a, 1.0 / point.length()).azimuth);
    let aim = path::aim(&zamo, there, order)?;
    let rain = Observer::rain_against(zamo);
    let (look, ratio) = Observer { beta: -rain.beta, ..rain }.aberrate(aim.look());
    // `ratio` is nu(static) / nu(rain) of light that both see, and times are in units of 1 / nu.
    Some(Aim::new(look, aim.time / ratio))
}
