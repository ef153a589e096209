// SPDX-License-Identifier: MIT OR Apache-2.0
//! Images of a point without spin, where a ray stays in a plane: one unknown, the angle from the hole that the observer
//! looks at, and 1/r after a given angle falls steadily with it.

use super::shooting::{Aim, MOST_STEPS};
use crate::physics::geodesic::State;
use crate::physics::integrator::{held_inside, nystrom_step, step_limit};
use crate::physics::observer::LocalFrame;
use glam::DVec3;
use std::f64::consts::PI;

/// Directions within e^-60 rad of the hole's centre, or of the opposite, are radial.
const RADIAL: f64 = 60.0;

/// How well a ray is found.
#[derive(Clone, Copy, Debug)]
pub struct Care {
    /// Steps in sigma.
    pub step: f64,
    /// The relative error of ln tan(psi / 2).
    pub tolerance: f64,
}

/// The ray to the place with direction `n` and 1/r `u` after `order` half turns.
pub fn aim(frame: &LocalFrame, n: DVec3, u: f64, order: u32, care: Care) -> Option<Aim> {
    let beside = n - frame.e_r * frame.e_r.dot(n);
    let apart = beside.length().atan2(frame.e_r.dot(n));
    // Beside the line through the hole any plane will do: the image is a ring, of which this is a point.
    let across = if beside.length() > 1e-15 { beside.normalize() } else { frame.e_theta };
    let odd = order % 2 == 1;
    let half_turns = PI * f64::from(order);
    let swept = if odd { half_turns + (PI - apart) } else { half_turns + apart };
    let across = frame.components(if odd { -across } else { across });
    if swept < 1e-14 {
        return radial(frame, u);
    }
    let look = |t: f64| {
        // t = ln tan(psi / 2).
        let (sin, cos) = (1.0 / t.cosh(), -t.tanh());
        (DVec3::new(-cos, 0.0, 0.0) + across * sin).normalize()
    };
    let f = |t: f64| excess(frame, look(t), swept, u, care.step);
    let range = around(&f, straight(frame, apart, u, order));
    let t = root(f, range, care.tolerance)?;
    let (constants, _) = frame.start(look(t))?;
    // Stereographic coordinates straight from t: small angles keep their digits.
    let pole = if t > 0.0 { 1.0 } else { -1.0 };
    let side = across * (-t.abs()).exp();
    Some(Aim { y: side.y, z: side.z, pole, time: swept / constants.k.max(0.0).sqrt() * constants.nu_local })
}

/// The radial ray to a place straight above or below.
fn radial(frame: &LocalFrame, u: f64) -> Option<Aim> {
    let outward = u < 1.0 / frame.r;
    let look = if outward { DVec3::X } else { DVec3::NEG_X };
    let (c, start) = frame.start(look)?;
    // u' is constant: K = 0.
    let tau = (u - start.u) / start.du;
    (tau > 0.0 && c.k == 0.0).then(|| Aim::new(look, tau * c.nu_local))
}

/// t of the straight line to a place that is `apart` from the observer about the hole; light bends round the hole, so
/// that its own t is larger. `None` for images that are not direct.
fn straight(frame: &LocalFrame, apart: f64, u: f64, order: u32) -> Option<f64> {
    let (sin, cos) = apart.sin_cos();
    // From the observer: towards the hole, and across.
    let (ahead, across) = (frame.r - cos / u, sin / u);
    let t = (0.5 * across.atan2(ahead)).tan().ln();
    (order == 0 && t.abs() < 0.5 * RADIAL).then_some(t)
}

/// A range that a falling function has its root in, from a guess below it; all of them without one.
fn around(f: &impl Fn(f64) -> f64, guess: Option<f64>) -> [f64; 2] {
    let Some(guess) = guess else { return [-RADIAL, RADIAL] };
    let mut low = guess - 1e-3;
    if f(low) < 0.0 {
        return [-RADIAL, RADIAL];
    }
    let mut width = 0.02;
    while low + width < RADIAL {
        let high = low + width;
        if f(high) < 0.0 {
            return [low, high];
        }
        (low, width) = (high, 4.0 * width);
    }
    [low, RADIAL]
}

/// 1/r after the ray has swept an angle, less `u`; for rays that are captured or have escaped before, more or less than
/// all others, by the angle that is left. It falls as the look direction turns away from the hole. Rays that take more
/// steps than any image's count as captured: an observer on the horizon has some with energies next to 0, whose steps
/// are too short for 1/r to change.
fn excess(frame: &LocalFrame, look: DVec3, swept: f64, u: f64, step: f64) -> f64 {
    let Some((c, start)) = frame.start(look) else { return 10.0 + swept + 1.0 - look.x };
    let rate = c.k.max(0.0).sqrt();
    let (mut state, mut left): (State, f64) = (start, swept);
    for _ in 0..MOST_STEPS {
        let most = (step / c.scale).min(step_limit(&c, &state, step));
        let last = left <= 1.5 * most * rate;
        let h = if last { left / rate } else { most };
        let next = held_inside(&c, nystrom_step(&c, &state, h, false));
        if next.u <= 0.0 {
            // Past infinity; a part of the step was before it.
            let part = (state.u / (state.u - next.u)).clamp(0.0, 1.0);
            return -u - (left - part * h * rate).max(0.0);
        }
        if next.du > 0.0 && next.u >= 0.5 * (1.0 - 1e-9) {
            return 0.5 + left;
        }
        if last {
            return next.u - u;
        }
        left -= h * rate;
        state = next;
    }
    0.5 + left
}

/// The root of a function that falls, within a range: Chandrupatla's method (1997, Advances in Engineering
/// Software 28, 145), which mixes bisection with inverse quadratic interpolation.
fn root(f: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], tolerance: f64) -> Option<f64> {
    let (mut fa, mut fb) = (f(a), f(b));
    if fa.is_nan() || fb.is_nan() || fa < 0.0 || fb > 0.0 {
        return None;
    }
    let mut share = 0.5;
    for _ in 0..200 {
        let x = a + share * (b - a);
        let fx = f(x);
        // b and c bracket the root with a, the newest point.
        let (c, fc);
        if fx.is_sign_positive() == fa.is_sign_positive() {
            (c, fc) = (a, fa);
        } else {
            (c, fc) = (b, fb);
            (b, fb) = (a, fa);
        }
        (a, fa) = (x, fx);
        let best = if fa.abs() < fb.abs() { a } else { b };
        let least = tolerance * best.abs().max(0.1) / (b - a).abs();
        if least > 0.5 || fa == 0.0 {
            return Some(best);
        }
        let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
        let interpolates = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        share = if interpolates {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        } else {
            0.5
        };
        share = share.clamp(least, 1.0 - least);
    }
    None
}
