// SPDX-License-Identifier: MIT OR Apache-2.0
//! Images of a point with spin by light that winds about the hole. Such rays lie beside the critical curve, the nearer
//! the more they wind: the angle that they sweep grows with the logarithm of their distance from it (Darwin 1959; for
//! spinning holes Bozza 2002, Phys. Rev. D 66, 103001). In that logarithm, the angle along the curve and the logarithm
//! of the time the rays of all orders change alike, and Newton's method finds them from afar.
//!
//! The ray without spin is followed while the spin grows. Where the point meets a caustic the image ends in another of
//! the opposite orientation, and that one in a third of its own: the curve of rays turns back in spin, and again. It is
//! followed by its own length (Keller 1977, in Applications of
//! Bifurcation Theory), which passes such turns.

use super::plane;
use super::shooting::{Aim, Flight, Target, fine};
use super::spin::{BESIDE, spun_way};
use crate::physics::geodesic::Constants;
use crate::physics::observer::LocalFrame;
use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};
use std::f64::consts::PI;

/// Steps in sigma on the way.
const STEP: f64 = 0.05;

/// Lengths of the curve from ray to ray, in (x, alpha, ln time, spin): first, longest, shortest.
const FIRST: f64 = 0.02;
const LONGEST: f64 = 0.25;
const SHORTEST: f64 = 1e-5;
const MOST_STEPS: usize = 600;

/// Changes for derivatives.
const SMALL: f64 = 1e-6;

/// Misses that end Newton's method on the way and at its end. On the way it is more than what the end of a ray jumps by
/// where it takes one step more.
const ON_THE_WAY: f64 = 2e-5;
const AT_THE_END: f64 = 1e-11;
/// A miss that is good enough where rounding leaves no way on.
const ENOUGH: f64 = 1e-7;

/// Scales of `Winding` that are tried, times e^-pi for each half turn. Where a curve is hard to follow in the
/// coordinates of one it often is not in those of the other.
const SCALES: [f64; 2] = [0.01, 1.0];

/// The ray to `point` after `order` half turns.
pub fn aim(frame: &LocalFrame, point: DVec3, order: u32) -> Option<Aim> {
    let mut tries = SCALES.iter().map(|scale| Winding { scale: scale * (-PI * f64::from(order)).exp() });
    let straight = tries.clone().find_map(|winding| winding.spun_up(frame, point, order));
    straight.or_else(|| {
        // From the image of a point beside it.
        tries.find_map(|winding| {
            BESIDE.iter().find_map(|[turn, lift]| {
                let beside = DQuat::from_rotation_z(*turn) * (DQuat::from_axis_angle(frame.e_phi, *lift) * point);
                let aim = winding.spun_up(frame, beside, order)?;
                let arc = DQuat::from_rotation_arc(beside.normalize(), point.normalize());
                let way = |s: f64| Some((*frame, Target::new(DQuat::IDENTITY.slerp(arc, s) * beside)));
                winding.led(&way, &aim, order)
            })
        })
    })
}

/// The ray at the end of a way that the one at its begin becomes.
pub fn led(way: &Way<'_>, begin: &Aim, order: u32) -> Option<Aim> {
    SCALES.iter().find_map(|scale| Winding { scale: scale * (-PI * f64::from(order)).exp() }.led(way, begin, order))
}

/// Whether the ray in a direction falls into the hole, told by the barrier of its radial motion: u'^2 = E^2 +
/// (a^2 E^2 - K) u^2 + 2 B u^3 - a^2 Q u^4 is least at a place u* > 0, which is a photon orbit's where it is 0.
fn is_captured(frame: &LocalFrame, look: DVec3) -> bool {
    let Some((c, start)) = frame.start(look) else { return true };
    let barrier = barrier(&c);
    let Some((place, height)) = barrier else { return start.du > 0.0 };
    match start.du > 0.0 {
        // Within the horizon it is no barrier.
        true => place <= start.u || place * c.r_plus >= 1.0 || height > 0.0,
        false => place < start.u && height < 0.0,
    }
}

/// Where u'^2 is least, and its value.
fn barrier(c: &Constants) -> Option<(f64, f64)> {
    let a2q = c.a * c.a * c.carter;
    let (constant, linear, square) = (c.a2e2 - c.k, 3.0 * c.b, -2.0 * a2q);
    let under = linear * linear - 4.0 * constant * square;
    let u = -2.0 * constant / (linear + under.max(0.0).sqrt());
    let height = c.energy * c.energy + u * u * (constant + u * (2.0 * c.b - u * a2q));
    (constant < 0.0 && under >= 0.0 && u.is_finite()).then_some((u, height))
}

/// The radius of the critical curve in the stereographic plane about the hole's centre, at an angle in it.
fn critical(frame: &LocalFrame, alpha: f64) -> Option<f64> {
    let captured = |l: f64| is_captured(frame, look(alpha, l.exp()));
    let (mut low, mut high) = (-25.0_f64, 25.0_f64);
    if !captured(low) || captured(high) {
        return None;
    }
    while high - low > 2.0 * f64::EPSILON * low.abs().max(high.abs()).max(0.1) {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if captured(middle) { low = middle } else { high = middle }
    }
    Some((0.5 * (low + high)).exp())
}

fn look(alpha: f64, rho: f64) -> DVec3 {
    Aim { y: rho * alpha.cos(), z: rho * alpha.sin(), pole: -1.0, time: 0.0 }.look()
}

/// Coordinates of rays: x with sinh x = (rho / critical - 1) / scale, the angle alpha, ln time. In x the logarithm goes
/// on smoothly through the critical curve: some rays of points within the photon orbit lie on it.
struct Winding {
    scale: f64,
}

impl Winding {
    /// The ray that the one without spin becomes.
    fn spun_up(&self, frame: &LocalFrame, point: DVec3, order: u32) -> Option<Aim> {
        let way = |s: f64| spun_way(frame, point, s);
        let (still, target) = way(0.0)?;
        let care = plane::Care { step: fine(order, target.u), tolerance: f64::EPSILON };
        let begin = plane::aim(&still, point.normalize(), target.u, order, care)?;
        self.led(&way, &begin, order)
    }

    /// The ray at the end of a way that the one at its begin becomes, with all digits.
    fn led(&self, way: &Way<'_>, begin: &Aim, order: u32) -> Option<Aim> {
        let (from, _) = way(0.0)?;
        let (to, target) = way(1.0)?;
        let near = self.follow(way, self.of_aim(&from, begin)?.extend(0.0))?;
        let end = self.finish(&to, &target, near, fine(order, target.u))?;
        self.to_aim(&to, end)
    }

    fn of_aim(&self, frame: &LocalFrame, aim: &Aim) -> Option<DVec3> {
        let look = aim.look();
        let across = look.y.hypot(look.z);
        // tan(psi / 2) from the direction towards the hole.
        let rho = across / (1.0 - look.x);
        let alpha = look.z.atan2(look.y);
        let beyond = rho / critical(frame, alpha)? - 1.0;
        let found = DVec3::new((beyond / self.scale).asinh(), alpha, aim.time.ln());
        found.is_finite().then_some(found)
    }

    fn to_aim(&self, frame: &LocalFrame, at: DVec3) -> Option<Aim> {
        let rho = critical(frame, at.y)? * (1.0 + self.scale * at.x.sinh());
        let aim = Aim { y: rho * at.y.cos(), z: rho * at.y.sin(), pole: -1.0, time: at.z.exp() };
        (rho > 0.0 && rho.is_finite() && aim.time.is_finite()).then_some(aim)
    }

    fn flight(&self, frame: &LocalFrame, target: &Target, at: DVec3, step: f64) -> Option<(Flight, DVec3)> {
        let flight = Flight::of(frame, &self.to_aim(frame, at)?, step, false)?;
        let miss = target.miss(&flight.there);
        (miss.length() < 2.0).then_some((flight, miss))
    }

    /// Derivatives of the miss by the three coordinates.
    fn derivatives(
        &self,
        frame: &LocalFrame,
        target: &Target,
        at: DVec3,
        (flight, miss): (&Flight, DVec3),
    ) -> Option<DMat3> {
        let by = |change: DVec3| {
            let turned = self.to_aim(frame, at + change * SMALL)?;
            Some((target.miss(&flight.again(frame, turned.look())?) - miss) / SMALL)
        };
        let by_time = target.miss_rate(flight) * (at.z.exp() / flight.constants.nu_local);
        Some(DMat3::from_cols(by(DVec3::X)?, by(DVec3::Y)?, by_time))
    }

    /// Newton's method at the end of the way.
    fn finish(&self, frame: &LocalFrame, target: &Target, guess: DVec3, step: f64) -> Option<DVec3> {
        let mut at = guess;
        let (mut flight, mut miss) = self.flight(frame, target, at, step)?;
        for _ in 0..12 {
            if miss.length() <= AT_THE_END {
                break;
            }
            let change = self.derivatives(frame, target, at, (&flight, miss))?.inverse() * miss;
            let shares = [1.0, 0.5, 0.25, 0.1, 0.03];
            let closer = shares.iter().find_map(|share| {
                let next = at - change * *share;
                let (flown, left) = self.flight(frame, target, next, step)?;
                (left.length() < miss.length()).then_some((next, flown, left))
            });
            let Some(found) = closer else { break };
            (at, flight, miss) = found;
        }
        (miss.length() <= ENOUGH).then_some(at)
    }

    /// The ray, its derivatives by all four, and its miss at a place of the curve's space.
    fn jacobian(&self, way: &Way<'_>, at: DVec4) -> Option<([DVec3; 4], DVec3)> {
        let (frame, target) = way(at.w)?;
        let (flight, miss) = self.flight(&frame, &target, at.truncate(), STEP)?;
        let by = self.derivatives(&frame, &target, at.truncate(), (&flight, miss))?;
        let aside = if at.w + SMALL > 1.0 { -SMALL } else { SMALL };
        let (other_frame, other_target) = way(at.w + aside)?;
        let turned = self.to_aim(&other_frame, at.truncate())?;
        let by_spin = (other_target.miss(&flight.again(&other_frame, turned.look())?) - miss) / aside;
        Some(([by.x_axis, by.y_axis, by.z_axis, by_spin], miss))
    }

    /// Follows the curve of rays from the way's begin to its end; the coordinates near there.
    fn follow(&self, way: &Way<'_>, begin: DVec4) -> Option<DVec3> {
        let mut at = begin;
        let (columns, _) = self.jacobian(way, at)?;
        let mut along = tangent(&columns)?;
        if along.w < 0.0 {
            along = -along;
        }
        let mut length = FIRST;
        for _ in 0..MOST_STEPS {
            let Some((next, ahead, iterations)) = self.corrected(way, at + along * length, along, length) else {
                length *= 0.4;
                if length < SHORTEST {
                    return None;
                }
                continue;
            };
            if next.w >= 1.0 {
                let share = (1.0 - at.w) / (next.w - at.w);
                return Some(at.lerp(next, share).truncate());
            }
            if next.w < 0.0 {
                return None;
            }
            (at, along) = (next, ahead);
            if iterations <= 3 {
                length = (1.6 * length).min(LONGEST);
            }
        }
        None
    }

    /// Newton's method to the curve, at right angles to `along`: the place, the direction of the curve there, and how
    /// many iterations it took.
    fn corrected(&self, way: &Way<'_>, guess: DVec4, along: DVec4, length: f64) -> Option<(DVec4, DVec4, usize)> {
        let mut at = guess;
        for iteration in 0..6 {
            let (columns, miss) = self.jacobian(way, at)?;
            if miss.length() <= ON_THE_WAY {
                let ahead = tangent(&columns)?;
                let ahead = if ahead.dot(along) < 0.0 { -ahead } else { ahead };
                // Beyond 25 degrees it may be another curve.
                return (ahead.dot(along) > 0.9).then_some((at, ahead, iteration));
            }
            let [a, b, c, d] = std::array::from_fn(|i| columns[i].extend(along[i]));
            let rest = miss.extend((at - guess).dot(along));
            at -= DMat4::from_cols(a, b, c, d).inverse() * rest;
            if !at.is_finite() || at.distance(guess) > 0.5 * length {
                return None;
            }
        }
        None
    }
}

/// Observer and target at a share of the spin.
pub type Way<'a> = dyn Fn(f64) -> Option<(LocalFrame, Target)> + 'a;

/// The unit vector that all rows of the derivatives are at right angles to.
fn tangent(columns: &[DVec3; 4]) -> Option<DVec4> {
    let [a, b, c, d] = *columns;
    let volume = |x: DVec3, y: DVec3, z: DVec3| x.dot(y.cross(z));
    DVec4::new(volume(b, c, d), -volume(a, c, d), volume(a, b, d), -volume(a, b, c)).try_normalize()
}
