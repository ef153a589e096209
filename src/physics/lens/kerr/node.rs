// SPDX-License-Identifier: MIT OR Apache-2.0
//! The content of a node of a Kerr lens table, by integration of its ray.

use super::grid::*;
use crate::physics::geodesic::{Clock, Constants, State};
use crate::physics::integrator::{Quintic, held_inside, nystrom_step, step_limit};
use crate::physics::trace::{CROSSINGS_KEPT, Settings, innermost_u, land};
use arrayvec::ArrayVec;
use glam::DVec3;

/// The delay less `divergent_delay`, from the state at a crossing to `observer`, is `delay_from` the crossing +
/// `delay_to` the observer: with `Constants::delay`, 2 (1 + u') ln(|u| / u_observer) - (1 + u') / u + the integral, and
/// (1 + u') / u from u'^2 = P(u) without cancellation.
pub(crate) fn delay_from(c: &Constants, there: &State) -> f64 {
    let (u, du) = (there.u, there.du);
    let below = u * (c.a2e2 - c.k + u * (2.0 * c.b - u * (c.a * c.a * c.carter)));
    let ratio = if du < 0.0 { -below / (1.0 - du) } else { (1.0 + du) / u };
    let logarithm = (u / c.u_observer).abs().max(f64::MIN_POSITIVE).ln();
    2.0 * ratio * u * logarithm - ratio + there.delay
}

pub(crate) fn delay_to(observer: &State) -> f64 {
    (observer.du - 1.0) / observer.u - observer.delay
}

/// One node's ray on its way.
pub(super) struct NodeRay<'a> {
    wanted: &'a Crossings,
    settings: Settings,
    capture_u: f64,
    /// S.
    side: f64,
    /// Above 0 above the plane, below 0 below it; a start in the plane counts for where it leads, as in `trace`.
    height: f64,
    /// `delay_to` the observer.
    arrival: f64,
    sky: Option<DVec3>,
    crossings: ArrayVec<[f64; PER_CROSSING], CROSSINGS_KEPT>,
}

impl<'a> NodeRay<'a> {
    fn new(wanted: &'a Crossings, capture_u: f64, side: f64, c: &Constants, start: &State) -> Self {
        let settings = Settings { step: STEP, delay: wanted.pattern, ..Settings::exact(c.a) };
        let height = if start.n.z != 0.0 { start.n.z } else { start.dn.z };
        let (sky, crossings) = (None, ArrayVec::new());
        Self { wanted, settings, capture_u, side, height, arrival: delay_to(start), sky, crossings }
    }

    /// Follows the ray of a rain observer until it is far enough outside the horizon for Boyer and Lindquist's chart:
    /// the state there in that chart. `None` where it does not come so far.
    fn leave_dorans_chart(&mut self, c: &Constants, start: &State) -> Option<(Constants, State)> {
        let u_plus = 1.0 / c.r_plus;
        let mut state = *start;
        for _ in 0..MAX_STEPS {
            if state.u < LEAVES_DORAN * self.capture_u {
                let chart = Constants { clock: Clock::Coordinate, offsets: None, ..*c };
                let drag = c.matter_azimuth(&state) - state.n.y.atan2(state.n.x);
                let there = State { drag, delay: 0.0, ..state };
                if self.settings.delay {
                    self.arrival = c.retardation(start, &state);
                    if c.is_unit_energy() {
                        self.arrival -= divergent_delay(state.u, c.u_observer) + delay_from(&chart, &there);
                    }
                }
                return Some((chart, there));
            }
            // Steps are those of `trace`.
            let most = STEP / if state.u >= u_plus { c.turn_rate() } else { c.scale };
            let h = most.min(step_limit(c, &state, STEP));
            let next = held_inside(c, nystrom_step(c, &state, h, self.settings.delay));
            if self.height * next.n.z < 0.0 {
                self.cross(c, (&state, &next, h), Some(start));
            }
            if next.du > 0.0 && u_plus - next.u < 1e-6 * u_plus {
                return None;
            }
            state = next;
        }
        None
    }

    /// Follows the ray from `state`, in the chart of Boyer and Lindquist, to its end.
    fn follow(&mut self, c: &Constants, mut state: State) {
        let mut beyond = 0.0;
        for _ in 0..MAX_STEPS {
            let inside = state.u >= self.capture_u;
            // Beyond `capture_u` only u and N go on, which pass the horizon evenly.
            let h = if inside { STEP / c.scale } else { (STEP / c.scale).min(step_limit(c, &state, STEP)) };
            let mut next = nystrom_step(c, &state, h, self.settings.delay);
            if inside {
                (next.drag, next.delay) = (state.drag, state.delay);
            }
            if self.height * next.n.z < 0.0 {
                self.cross(c, (&state, &next, h), None);
            }
            if next.u <= 0.0 && self.sky.is_none() {
                let guess = h * Quintic::of_u(c, &state, &next, h).root();
                let no_delay = Settings { delay: false, ..self.settings };
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

    /// Keeps the crossing within a step. `rain`: the state of the rain observer whose light is still in Doran's chart;
    /// crossings within the horizon, where no disk is, have no azimuth and delay then.
    fn cross(&mut self, c: &Constants, (from, to, h): (&State, &State, f64), rain: Option<&State>) {
        self.height = to.n.z;
        if self.crossings.len() >= self.wanted.orders {
            return;
        }
        let guess = h * Quintic::of_n_z(c, from, to, h).root();
        let (mut state, _) = land(c, &self.settings, from, guess, SLACK, |s| (s.n.z, s.dn.z));
        if let Some(observer) = rain {
            let mut crossing = [state.u * self.side, 0.0, 0.0, 0.0];
            if self.wanted.pattern && state.u <= innermost_u(c.r_plus) {
                let (sin, cos) = c.matter_azimuth(&state).sin_cos();
                let delay = c.retardation(observer, &state) - divergent_delay(state.u, c.u_observer);
                crossing = [crossing[0], cos, sin, delay];
            }
            self.crossings.push(crossing);
            return;
        }
        if from.u >= self.capture_u {
            (state.drag, state.delay) = (from.drag, from.delay);
        }
        // Rays with too little energy to integrate the delay by parts have no such delay past infinity: 0 stands for
        // it.
        let delay = match (self.wanted.pattern, c.is_unit_energy()) {
            (false, _) => 0.0,
            (true, true) => delay_from(c, &state) + self.arrival,
            (true, false) if state.u > 0.0 => state.delay + self.arrival - divergent_delay(state.u, c.u_observer),
            (true, false) => 0.0,
        };
        let direction = state.chart_direction();
        self.crossings.push([state.u * self.side, direction.x, direction.y, delay]);
    }
}

impl Grid {
    /// The content of a node, by integration of its ray.
    pub fn node(&self, branch: Branch, column: usize, row: usize) -> Node {
        let n = self.direction(branch, column, row as f64);
        // Captured rays leave nothing to keep but crossings.
        let start = self.frame.start(n).filter(|_| branch == Branch::Outer || self.wanted.orders > 0);
        let Some((c, start)) = start else { return self.wanted.node_of(None, &[]) };
        let mut ray = NodeRay::new(&self.wanted, self.capture_u, side(n), &c, &start);
        let outside = if self.frame.rain { ray.leave_dorans_chart(&c, &start) } else { Some((c, start)) };
        if let Some((c, state)) = outside {
            ray.follow(&c, state);
        }
        self.wanted.node_of(ray.sky, &ray.crossings)
    }
}

impl Crossings {
    /// A node's numbers; crossings that did not come are marked by u.
    fn node_of(&self, sky: Option<DVec3>, crossings: &[[f64; PER_CROSSING]]) -> Node {
        let mut node = Node::new();
        node.extend(sky.unwrap_or(DVec3::ZERO).to_array());
        let none = if sky.is_some() { -NO_CROSSING } else { NO_CROSSING };
        for order in 0..self.orders {
            let crossing = crossings.get(order).copied().unwrap_or([none, 0.0, 0.0, 0.0]);
            node.extend(crossing.into_iter().take(if self.pattern { PER_CROSSING } else { 1 }));
        }
        node
    }
}
