// SPDX-License-Identifier: MIT OR Apache-2.0
//! Images of a point with spin: the ray without spin is followed while the spin grows, places keeping their distance
//! from the horizon. Where that fails, on the caustics that a spinning hole has, the point is approached from beside.

use super::shooting::{Aim, COARSE, Effort, Target, bring, fine};
use super::spin::{BESIDE, spun_way};
use super::{plane, winding};
use crate::physics::observer::LocalFrame;
use glam::{DQuat, DVec3};

/// Newton's method on the way, and at its end.
fn on_the_way(step: f64) -> Effort {
    Effort { step, tolerance: 1e-6, enough: 1e-5, iterations: 6, most: 0.3 }
}
fn at_the_end(step: f64) -> Effort {
    Effort { step, tolerance: 1e-10, enough: 1e-8, iterations: 12, most: 0.3 }
}

/// The ray without spin, from which others are followed.
const WITHOUT_SPIN: plane::Care = plane::Care { step: COARSE, tolerance: 1e-6 };

/// The shortest stretch of the way, which is 1 long.
const SHORTEST: f64 = 1e-5;

/// Most stretches of a way.
const MOST_STRETCHES: usize = 300;

/// The ray to `point` after `order` half turns, for a spinning hole.
pub fn aim(frame: &LocalFrame, point: DVec3, order: u32) -> Option<Aim> {
    if order >= 2 {
        return winding::aim(frame, point, order);
    }
    let straight = spun_up(frame, point, order).and_then(|aim| finished(frame, point, aim, order));
    straight.or_else(|| winding::aim(frame, point, order)).or_else(|| {
        BESIDE.iter().find_map(|[turn, lift]| {
            let beside = DQuat::from_rotation_z(*turn) * (DQuat::from_axis_angle(frame.e_phi, *lift) * point);
            let aim = spun_up(frame, beside, order)?;
            let (from, to) = (beside.normalize(), point.normalize());
            let arc = DQuat::from_rotation_arc(from, to);
            let way = |s: f64| {
                let turned = DQuat::IDENTITY.slerp(arc, s) * beside;
                Some((*frame, Target::new(turned)))
            };
            finished(frame, point, follow(way, aim, order, COARSE)?, order)
        })
    })
}

/// The ray with all digits.
fn finished(frame: &LocalFrame, point: DVec3, aim: Aim, order: u32) -> Option<Aim> {
    let target = Target::new(point);
    brought(frame, &target, aim, order, fine(order, target.u))
}

/// The ray with all digits that steps of a length have.
pub(super) fn brought(frame: &LocalFrame, target: &Target, aim: Aim, order: u32, step: f64) -> Option<Aim> {
    bring(frame, target, aim, order, &at_the_end(step)).map(|(aim, _)| aim)
}

/// The ray that the one without spin becomes.
fn spun_up(frame: &LocalFrame, point: DVec3, order: u32) -> Option<Aim> {
    let way = |s: f64| spun_way(frame, point, s);
    let (still, target) = way(0.0)?;
    follow(way, plane::aim(&still, point.normalize(), target.u, order, WITHOUT_SPIN)?, order, COARSE)
}

/// Follows a ray along a way from 0 to 1, which gives observer and target, in steps of a length in sigma.
pub(super) fn follow(
    way: impl Fn(f64) -> Option<(LocalFrame, Target)>,
    begin: Aim,
    order: u32,
    step: f64,
) -> Option<Aim> {
    let effort = on_the_way(step);
    let mut passed = vec![(0.0, begin)];
    // Rays of higher orders keep to their image in a range that is smaller by e^pi for each half turn.
    let mut stretch = (-2.0 * f64::from(order)).exp();
    while let Some(&(s, _)) = passed.last().filter(|(s, _)| *s < 1.0) {
        if passed.len() > MOST_STRETCHES {
            return None;
        }
        let next = (s + stretch).min(1.0);
        let (frame, target) = way(next)?;
        match bring(&frame, &target, expected(&passed, next), order, &effort) {
            Some((aim, iterations)) => {
                passed.push((next, aim));
                if iterations <= 3 {
                    stretch *= 2.0;
                }
            }
            None => {
                stretch *= 0.4;
                if stretch < SHORTEST {
                    return None;
                }
            }
        }
    }
    passed.last().map(|(_, aim)| *aim)
}

/// Lagrange's polynomial through the last places of the way.
fn expected(passed: &[(f64, Aim)], s: f64) -> Aim {
    let last = &passed[passed.len().saturating_sub(4)..];
    let mut sum = DVec3::ZERO;
    for (i, (own, aim)) in last.iter().enumerate() {
        let others = last.iter().enumerate().filter(|(j, _)| *j != i);
        let weight: f64 = others.map(|(_, (other, _))| (s - other) / (own - other)).product();
        sum += aim.vector() * weight;
    }
    last[last.len() - 1].1.with(sum)
}
