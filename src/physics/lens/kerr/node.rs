// SPDX-License-Identifier: MIT OR Apache-2.0
//! The content of a node of a Kerr lens table, by integration of its ray.

use super::grid::*;
use crate::physics::geodesic::{Constants, State};
use crate::physics::integrator::{Quintic, nystrom_step, step_limit};
use crate::physics::trace::{CROSSINGS_KEPT, Settings, land};
use arrayvec::ArrayVec;
use glam::DVec3;

/// The delay less `divergent_delay`, from the state at a crossing: with `Constants::delay`,
/// 2 (1 + u') ln(|u| / u_observer) - (1 + u') / u + the integral, and (1 + u') / u from u'^2 = P(u) without
/// cancellation.
pub(crate) fn regular_delay(c: &Constants, observer: &State, there: &State) -> f64 {
    let (u, du) = (there.u, there.du);
    let below = u * (c.a2e2 - c.k + u * (2.0 * c.b - u * (c.a * c.a * c.carter)));
    let ratio = if du < 0.0 { -below / (1.0 - du) } else { (1.0 + du) / u };
    let logarithm = (u / c.u_observer).abs().max(f64::MIN_POSITIVE).ln();
    2.0 * ratio * u * logarithm - ratio + (observer.du - 1.0) / observer.u + there.delay - observer.delay
}

/// One node's ray on its way.
pub(super) struct NodeRay<'a> {
    wanted: &'a Crossings,
    capture_u: f64,
    side: f64,
    sky: Option<DVec3>,
    crossings: ArrayVec<[f64; PER_CROSSING], CROSSINGS_KEPT>,
}

impl<'a> NodeRay<'a> {
    fn new(wanted: &'a Crossings, capture_u: f64, side: f64) -> Self {
        Self { wanted, capture_u, side, sky: None, crossings: ArrayVec::new() }
    }

    fn follow(&mut self, c: &Constants, start: &State) {
        let settings = Settings { step: STEP, delay: self.wanted.pattern, ..Settings::exact(c.a) };
        let mut state = *start;
        // A start in the plane is no crossing, as in `trace`.
        let mut side = if start.n.z != 0.0 { start.n.z } else { start.dn.z };
        let mut beyond = 0.0;
        for _ in 0..MAX_STEPS {
            let inside = state.u >= self.capture_u;
            // Beyond `capture_u` only u and N go on, which pass the horizon evenly.
            let h = if inside { STEP / c.scale } else { (STEP / c.scale).min(step_limit(c, &state, STEP)) };
            let mut next = nystrom_step(c, &state, h, settings.delay);
            if inside {
                (next.drag, next.delay) = (state.drag, state.delay);
            }
            if side * next.n.z < 0.0 {
                side = next.n.z;
                self.cross(c, start, &settings, (&state, &next, h));
            }
            if next.u <= 0.0 && self.sky.is_none() {
                let guess = h * Quintic::of_u(c, &state, &next, h).root();
                let no_delay = Settings { delay: false, ..settings };
                self.sky = Some(land(c, &no_delay, &state, guess, SLACK, |s| (s.u, s.du)).0.chart_direction());
            }
            if next.u <= 0.0 {
                beyond += h * c.scale;
            }
            // Beyond the horizon the ray is captured, however it goes on.
            let captured = next.u >= INWARD * self.capture_u || (inside && next.du < 0.0);
            let complete = (self.sky.is_some() || inside) && self.crossings.len() >= self.wanted.orders;
            if complete || captured || beyond > BEYOND_INFINITY {
                return;
            }
            state = next;
        }
    }

    fn cross(&mut self, c: &Constants, observer: &State, settings: &Settings, (from, to, h): (&State, &State, f64)) {
        if self.crossings.len() >= self.wanted.orders {
            return;
        }
        let guess = h * Quintic::of_n_z(c, from, to, h).root();
        let (mut state, _) = land(c, settings, from, guess, SLACK, |s| (s.n.z, s.dn.z));
        if from.u >= self.capture_u {
            (state.drag, state.delay) = (from.drag, from.delay);
        }
        let delay = if self.wanted.pattern { regular_delay(c, observer, &state) } else { 0.0 };
        let direction = state.chart_direction();
        self.crossings.push([state.u * self.side, direction.x, direction.y, delay]);
    }

    /// The node's numbers; crossings that did not come are marked by u.
    fn finish(self) -> Node {
        let mut node = Node::new();
        node.extend(self.sky.unwrap_or(DVec3::ZERO).to_array());
        let none = if self.sky.is_some() { -NO_CROSSING } else { NO_CROSSING };
        for order in 0..self.wanted.orders {
            let crossing = self.crossings.get(order).copied().unwrap_or([none, 0.0, 0.0, 0.0]);
            node.extend(crossing.into_iter().take(if self.wanted.pattern { PER_CROSSING } else { 1 }));
        }
        node
    }
}

impl Grid {
    /// The content of a node, by integration of its ray.
    pub fn node(&self, branch: Branch, column: usize, row: usize) -> Node {
        let n = self.direction(branch, column, row as f64);
        let mut ray = NodeRay::new(&self.wanted, self.capture_u, side(n));
        if let Some((c, start)) = self.frame.start(n) {
            ray.follow(&c, &start);
        }
        ray.finish()
    }
}
