// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that are aimed: where one is after some Mino time, how that changes with its direction, and Newton's method to
//! bring it to a point. Knows nothing of how many rays lead there.

use crate::physics::geodesic::{Constants, State};
use crate::physics::integrator::{held_inside, nystrom_step, step_limit};
use crate::physics::observer::LocalFrame;
use glam::{DMat3, DVec3};

/// Steps in sigma of rays that lead to others.
pub const COARSE: f64 = 0.1;

/// Steps in sigma of rays that are handed out: each half turn more makes them e^pi times as sensitive, and a small 1/r
/// at their end that much to errors near the hole.
pub fn fine(order: u32, u: f64) -> f64 {
    if order < 2 && u > 1e-3 { 0.05 } else { 0.025 }
}

/// Most steps of a ray: beside the horizon they are small.
pub const MOST_STEPS: usize = 4000;

/// A point that rays are to pass through.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    pub u: f64,
    /// The unit chart direction, and two at right angles to it.
    n: DVec3,
    across: [DVec3; 2],
}

impl Target {
    pub fn new(point: DVec3) -> Self {
        let n = point.normalize();
        let (first, second) = n.any_orthonormal_pair();
        Self { u: 1.0 / point.length(), n, across: [first, second] }
    }

    /// How far a ray is beside the point: in ln r, and in angles about the hole.
    pub fn miss(&self, there: &State) -> DVec3 {
        let direction = there.chart_direction();
        let beside = DVec3::new(0.0, direction.dot(self.across[0]), direction.dot(self.across[1]));
        let (sin, cos) = (beside.length(), direction.dot(self.n));
        // The angle, not its sine, which is 0 on the other side, too.
        let angle = if cos > 0.0 && sin < 1e-4 { 1.0 } else { sin.atan2(cos) / sin.max(1e-300) };
        DVec3::new((there.u - self.u) / self.u, beside.y * angle, beside.z * angle)
    }

    /// d(miss) / d(tau) of a ray that is near the point.
    pub fn miss_rate(&self, flight: &Flight) -> DVec3 {
        let velocity = flight.velocity();
        DVec3::new(flight.there.du / self.u, velocity.dot(self.across[0]), velocity.dot(self.across[1]))
    }
}

/// A direction to look in, and how long the ray is followed.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// tan(psi / 2) along e_theta and e_phi, psi being the angle from `pole` e_r: stereographic coordinates, which hold
    /// small angles from the hole as well as they hold large ones.
    pub y: f64,
    pub z: f64,
    /// -1: measured from the direction towards the hole; 1: from that away from it.
    pub pole: f64,
    /// Mino time, in units in which the observer of the local frame measures frequency 1: rays of all energies, those
    /// of an ergosphere too, differ smoothly from each other in it.
    pub time: f64,
}

impl Aim {
    /// `look`: unit, components.
    pub fn new(look: DVec3, time: f64) -> Self {
        let pole = if look.x > 0.0 { 1.0 } else { -1.0 };
        let share = 1.0 / (1.0 + pole * look.x);
        Self { y: look.y * share, z: look.z * share, pole, time }
    }

    pub fn look(&self) -> DVec3 {
        let squared = self.y * self.y + self.z * self.z;
        DVec3::new(self.pole * (1.0 - squared), 2.0 * self.y, 2.0 * self.z) / (1.0 + squared)
    }

    pub fn vector(&self) -> DVec3 {
        DVec3::new(self.y, self.z, self.time)
    }

    pub fn with(&self, vector: DVec3) -> Self {
        Self { y: vector.x, z: vector.y, time: vector.z, ..*self }
    }

    /// A change of y or z that is small beside what turns the ray away after `order` half turns.
    pub fn small(&self, frame: &LocalFrame, order: u32) -> f64 {
        let angle = self.y.hypot(self.z).max((1.0 / frame.r).min(1.0));
        1e-7 * angle * (-std::f64::consts::PI * f64::from(order)).exp()
    }
}

/// A ray that was followed.
#[derive(Clone, Debug)]
pub struct Flight {
    pub constants: Constants,
    pub start: State,
    pub there: State,
    time: f64,
    /// The lengths of its steps, as shares of `time`: neighbours that take the same differ smoothly from it.
    shares: Vec<f64>,
}

impl Flight {
    /// Follows a ray, steps being `step` long in sigma. `None`: it does not come so far.
    pub fn of(frame: &LocalFrame, aim: &Aim, step: f64, with_delay: bool) -> Option<Self> {
        let (constants, start) = frame.start(aim.look())?;
        let c = &constants;
        if aim.time.is_nan() || aim.time <= 0.0 {
            return None;
        }
        let tau = aim.time / c.nu_local;
        let (mut state, mut left, mut shares) = (start, tau, Vec::new());
        while left > 0.0 {
            let most = (step / c.scale).min(step_limit(c, &state, step));
            // No last step that is much shorter than the others.
            let h = if left > 1.5 * most { most } else { left };
            state = held_inside(c, nystrom_step(c, &state, h, with_delay));
            left = if h == left { 0.0 } else { left - h };
            shares.push(h / tau);
            let captured = state.du > 0.0 && state.u * c.r_plus >= 1.0 - 1e-9;
            if captured || !state.u.is_finite() || state.u < -0.3 || shares.len() > MOST_STEPS {
                return None;
            }
        }
        Some(Self { constants, start, there: state, time: aim.time, shares })
    }

    /// The place of the ray in the direction `look` after the same time, by the same steps.
    pub fn again(&self, frame: &LocalFrame, look: DVec3) -> Option<State> {
        let (c, start) = frame.start(look)?;
        let tau = self.time / c.nu_local;
        let advance = |state: State, share: &f64| held_inside(&c, nystrom_step(&c, &state, share * tau, false));
        let there = self.shares.iter().fold(start, advance);
        there.u.is_finite().then_some(there)
    }

    /// d(chart direction) / d(tau) at the end.
    pub fn velocity(&self) -> DVec3 {
        let there = &self.there;
        let c = &self.constants;
        let n = there.n.normalize();
        let dn = there.dn - n * n.dot(there.dn);
        let (sin, cos) = there.drag.sin_cos();
        let turned = DVec3::new(dn.x * cos - dn.y * sin, dn.x * sin + dn.y * cos, dn.z);
        turned + DVec3::Z.cross(there.chart_direction()) * c.turning_rate(there.u, there.du)
    }
}

/// How well a ray is brought to a point.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    pub step: f64,
    /// The miss, as of `Target::miss`, that is striven for, and the one that is good enough where rounding leaves no
    /// way on.
    pub tolerance: f64,
    pub enough: f64,
    pub iterations: usize,
    /// The largest miss of the first guess: beyond it, Newton's method may lead to another image.
    pub most: f64,
}

/// Newton's method, damped. The number of iterations goes with the result.
pub fn bring(frame: &LocalFrame, target: &Target, guess: Aim, order: u32, effort: &Effort) -> Option<(Aim, usize)> {
    let mut aim = guess;
    let mut flight = Flight::of(frame, &aim, effort.step, false)?;
    let mut miss = target.miss(&flight.there);
    if miss.is_nan() || miss.length() > effort.most {
        return None;
    }
    for iteration in 0..effort.iterations {
        if miss.length() <= effort.tolerance {
            return Some((aim, iteration));
        }
        let change = correction(frame, target, &aim, &flight, miss, order)?;
        let mut share = 1.0;
        loop {
            let next = aim.with(aim.vector() - change * share);
            let flown = Flight::of(frame, &next, effort.step, false).map(|flight| (target.miss(&flight.there), flight));
            if let Some((closer, found)) = flown.filter(|(closer, _)| closer.length() < miss.length()) {
                (aim, flight, miss) = (next, found, closer);
                break;
            }
            share *= 0.5;
            // Only rounding error is left, or there is no way on.
            if share < 0.02 {
                return (miss.length() <= effort.enough).then_some((aim, iteration));
            }
        }
    }
    (miss.length() <= effort.enough).then_some((aim, effort.iterations))
}

/// The step of Newton's method.
fn correction(
    frame: &LocalFrame,
    target: &Target,
    aim: &Aim,
    flight: &Flight,
    miss: DVec3,
    order: u32,
) -> Option<DVec3> {
    let step = aim.small(frame, order);
    let by = |change: DVec3| {
        let turned = aim.with(aim.vector() + change * step).look();
        Some((target.miss(&flight.again(frame, turned)?) - miss) / step)
    };
    let by_time = target.miss_rate(flight) / flight.constants.nu_local;
    let jacobian = DMat3::from_cols(by(DVec3::X)?, by(DVec3::Y)?, by_time);
    let change = jacobian.inverse() * miss;
    change.is_finite().then_some(change)
}
