// SPDX-License-Identifier: MIT OR Apache-2.0
//! World lines of bodies in free fall: where a body is after given proper times, how it moves there, and how axes that
//! it carries along in parallel have turned. The driver of the integrator for bodies; knows no light.
//!
//! They are integrated in Doran's chart, which is regular at both horizons for all that falls in, by Nystrom's method
//! in Mino time; proper time is the integral of 1/u^2 + a^2 N_z^2 (Carter 1968).

use super::geodesic::{Clock, Constants, State, turned};
use super::integrator::{Quintic, held_inside, nystrom_step, relative_limit, step_limit};
use super::observer::{LocalFrame, Momentum};
use super::orbit::{horizon_outer, innermost_radius};
use super::quadrature::gauss_legendre;
use super::rain::{Offsets, offsets};
use super::transport::{Tetrad, Vector4, carried};
use crate::allocate::{collected, with_room};
use crate::error::{Error, Number, Result};
use glam::{DVec3, DVec4};

pub mod table;

/// The longest proper time, M, and the greatest distance of a body at its start, M.
pub const LONGEST: f64 = 1e12;
/// The least r, M, that bodies without spin, or with a tiny one, are followed to.
pub const LEAST_RADIUS: f64 = 1e-9;
/// The most steps that one call takes: 1000 M of proper time at r = 10 M take some 1500.
pub const MOST_STEPS: u32 = 300_000;
/// How near, as a part of r+, a body comes to a horizon that its chart does not hold.
const BESIDE: f64 = 1e-6;

/// The step in sigma, and the greatest change of u in a step, as a part of it.
const STEP: f64 = 0.02;
const CHANGE: f64 = 0.03;

/// A body at an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The chart: `Clock::Coordinate` is that of Boyer and Lindquist with the ZAMO's triad, outside the horizon only;
    /// `Clock::Rain` is Doran's with the rain observer's.
    pub clock: Clock,
    /// The place in the chart, M.
    pub position: DVec3,
    /// The velocity (components, |v| < 1) that the observer of the triad measures.
    pub velocity: DVec3,
    /// The chart's time, M.
    pub time: f64,
}

/// Why a world line goes no farther.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// r- (1 + 1e-6), or `LEAST_RADIUS` where that is more.
    InnerHorizon,
    /// The horizon r+, within 1e-6 of it: bodies in the chart of Boyer and Lindquist fall no farther, and backward in
    /// time none is followed into the past horizon.
    Horizon,
}

/// A body after a proper time.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    pub body: Body,
    /// The axes that were carried along, as their components in the triad of the body's own observer: the chart's
    /// triad, boosted by the velocity without rotation. Right to some 1e-15 gamma^2.
    pub axes: [DVec3; 3],
    /// Proper time since the start, M; where the line has ended before what was asked for, that of its end.
    pub proper_time: f64,
    /// Set where the line has ended before.
    pub end: Option<End>,
}

/// The body after each of `proper_times` (M, any sign, any order, |t| <= `LONGEST`), in the order and the chart that it
/// is given in. `axes` are any three vectors in the triad of the body's own observer (`Event::axes`). |a| <= 1.
///
/// Errors: INVALID_ARGUMENT for a spin, a place, a velocity or a time out of range; UNSUPPORTED for a place that the
/// chart does not hold, and for a line that takes more than `MOST_STEPS` steps; OUT_OF_MEMORY.
pub fn world_line(a: f64, body: &Body, axes: &[DVec3; 3], proper_times: &[f64]) -> Result<Vec<Event>> {
    let nothing = Event { body: *body, axes: *axes, proper_time: 0.0, end: None };
    let mut events = collected(proper_times.iter().map(|_| nothing), "the events of a world line")?;
    each_event(a, body, axes, proper_times, &mut |index, event| events[index] = event)?;
    Ok(events)
}

/// `world_line` for those who keep events in memory of their own: gives `found` each event and the index of its proper
/// time, in the order in which a body that goes into the future, and then one that goes into the past, comes there.
/// Errors: as `world_line`, some of them when part of the events have been given.
pub fn each_event(
    a: f64,
    body: &Body,
    axes: &[DVec3; 3],
    proper_times: &[f64],
    found: &mut dyn FnMut(usize, Event),
) -> Result<()> {
    let (line, start) = Line::new(a, body, axes)?;
    if let Some(time) = proper_times.iter().find(|time| time.is_nan() || time.abs() > LONGEST) {
        let time = Number(*time);
        return Err(Error::argument(format!(
            "a proper time is {time} M; it must lie in [-{LONGEST:e}, {LONGEST:e}] M"
        )));
    }
    let mut order: Vec<usize> = with_room(proper_times.len(), "the order of proper times")?;
    let mut steps = MOST_STEPS;
    for past in [false, true] {
        order.clear();
        order.extend((0..proper_times.len()).filter(|i| (proper_times[*i] < 0.0) == past));
        order.sort_unstable_by(|i, j| proper_times[*i].abs().total_cmp(&proper_times[*j].abs()));
        let mut course = Course { line, past, from: start, to: start, h: 0.0, end: None, steps };
        for i in &order {
            found(*i, course.event(proper_times[*i])?);
        }
        steps = course.steps;
    }
    Ok(())
}

/// A point of a world line. `State::delay` is the rain time from there to the start.
#[derive(Clone, Copy, Debug)]
struct Point {
    state: State,
    /// Proper time since the start.
    proper: f64,
    axes: [Vector4; 3],
}

/// All that stays the same along a line.
#[derive(Clone, Copy)]
struct Line {
    c: Constants,
    clock: Clock,
    /// The chart's time at the start, and the offset of Doran's chart there if it is another.
    time: f64,
    offsets: Offsets,
}

/// Where a line ends.
#[derive(Clone, Copy, Debug)]
struct Bound {
    /// 1/r there.
    u: f64,
    /// Whether u grows towards it.
    is_inwards: bool,
    end: End,
}

impl Bound {
    fn is_reached(&self, u: f64) -> bool {
        if self.is_inwards { u >= self.u } else { u <= self.u }
    }
}

/// The offsets of Doran's chart from one of its own.
const NO_OFFSETS: Offsets = Offsets { azimuth: 0.0, time: 0.0 };

/// A vector's components (r, th, ph, T) for an observer who moves with `velocity` against the one of `components`.
fn boosted(components: DVec4, velocity: DVec3, gamma: f64) -> DVec4 {
    let (space, time) = (components.truncate(), components.w);
    let along = velocity.dot(space);
    let space = space + velocity * (gamma * gamma / (gamma + 1.0) * along - gamma * time);
    space.extend(gamma * (time - along))
}

/// The velocity of the rain observer against the ZAMO of the lapse `lapse`, and its gamma.
fn rain_motion(lapse: f64) -> (DVec3, f64) {
    (DVec3::new(-((1.0 - lapse) * (1.0 + lapse)).max(0.0).sqrt(), 0.0, 0.0), 1.0 / lapse)
}

fn refused(what: &str, r: f64, limit: f64, a: f64) -> Error {
    let (r, limit, a) = (Number(r), Number(limit), Number(a));
    Error::unsupported(format!("a body at r = {r} M lies {what} {limit} M, of a hole of spin {a}"))
}

impl Line {
    fn new(a: f64, body: &Body, axes: &[DVec3; 3]) -> Result<(Self, Point)> {
        let place = LocalFrame::rain(a, body.position)?;
        let r_plus = horizon_outer(a);
        if place.r > LONGEST || !body.time.is_finite() {
            let (r, time) = (Number(place.r), Number(body.time));
            return Err(Error::argument(format!("a body at r = {r} M and time {time} M: r is at most {LONGEST:e} M")));
        }
        if body.velocity.is_nan() || body.velocity.length_squared() >= 1.0 {
            let v = Number(body.velocity.length());
            return Err(Error::argument(format!("a body's velocity is {v}; it must be below 1, that of light")));
        }
        if let Some(axis) = axes.iter().find(|axis| !axis.is_finite()) {
            return Err(Error::argument(format!("{axis} is no axis: it must be finite")));
        }
        if place.r <= LEAST_RADIUS {
            return Err(refused("at or within", place.r, LEAST_RADIUS, a));
        }
        let is_static = body.clock == Clock::Coordinate;
        if is_static && place.r <= r_plus * (1.0 + BESIDE) {
            return Err(refused("at or within r+ (1 + 1e-6) =", place.r, r_plus * (1.0 + BESIDE), a));
        }
        let offsets = if is_static { offsets(a, 1.0 / place.r) } else { NO_OFFSETS };
        let frame = place.turned(offsets.azimuth);
        let momentum = Momentum::of_body(body.velocity);
        let (velocity, gamma) = (body.velocity, momentum.energy);
        let to_rain = |components: DVec4| match frame.static_lapse().filter(|_| is_static) {
            Some(lapse) => {
                let (motion, gamma) = rain_motion(lapse);
                boosted(components, motion, gamma)
            }
            None => components,
        };
        let seen = to_rain(momentum.space.extend(momentum.energy));
        let (c, state) = frame.start_body(&Momentum { energy: seen.w, space: seen.truncate(), mu2: 1.0 });
        let tetrad = Tetrad::new(&frame, 0.0);
        let axes = axes.map(|axis| tetrad.vector(to_rain(boosted(axis.extend(0.0), -velocity, gamma))));
        Ok((Self { c, clock: body.clock, time: body.time, offsets }, Point { state, proper: 0.0, axes }))
    }

    /// d(proper time) / d tau, which grows into the past, is -Sigma.
    fn sigma(&self, u: f64, n_z: f64) -> f64 {
        1.0 / (u * u) + (self.c.a * n_z).powi(2)
    }

    fn step(&self, from: &Point, h: f64) -> Point {
        let c = &self.c;
        let state = held_inside(c, nystrom_step(c, &from.state, h, true));
        let ends = [&from.state, &state];
        let (u, n_z) = (Quintic::of_u(c, ends[0], ends[1], h), Quintic::of_n_z(c, ends[0], ends[1], h));
        let passed = if h == 0.0 { 0.0 } else { h * gauss_legendre(|x| self.sigma(u.at(x).0, n_z.at(x).0)) };
        Point { state, proper: from.proper - passed, axes: carried(c, ends, h, from.axes) }
    }

    /// The longest step from here, > 0.
    fn limit(&self, s: &State) -> f64 {
        let c = &self.c;
        let rate = if s.u * c.r_plus < 1.0 { c.scale } else { c.turn_rate() };
        (STEP / rate).min(step_limit(c, s, STEP)).min(relative_limit(c, s, CHANGE))
    }

    /// Where what moves as `s`, into the past or not, comes to an end, if it comes so far.
    fn bound(&self, s: &State, past: bool) -> Option<Bound> {
        let (c, r_plus) = (&self.c, self.c.r_plus);
        let inner =
            Bound { u: 1.0 / innermost_radius(c.a).max(LEAST_RADIUS), is_inwards: true, end: End::InnerHorizon };
        let outer = Bound { u: 1.0 / (r_plus * (1.0 + BESIDE)), is_inwards: true, end: End::Horizon };
        if s.u * r_plus >= 1.0 {
            // Into the past it has come in from outside, or out of the past horizon or another outside.
            let out = Bound { u: 1.0 / (r_plus * (1.0 - BESIDE)), is_inwards: false, end: End::Horizon };
            return if past { Some(out).filter(|_| !c.comes_from_outside()) } else { Some(inner) };
        }
        let is_inwards = (s.du > 0.0) == past;
        let bound = if past || self.clock == Clock::Coordinate { outer } else { inner };
        is_inwards.then_some(bound)
    }

    /// A point as the host sees it.
    fn event(&self, point: &Point, end: Option<End>) -> Result<Event> {
        let (c, s) = (&self.c, &point.state);
        let is_static = self.clock == Clock::Coordinate;
        let there = if is_static { offsets(c.a, s.u) } else { NO_OFFSETS };
        let position = turned(s.chart_direction() / s.u, -there.azimuth);
        // Lines end where frames do, or a rounding farther in: without spin there is one at every place.
        let Ok(frame) = LocalFrame::new(0.0, position).map(|frame| frame.to_rain_of(c.a).turned(there.azimuth)) else {
            return Err(Error::internal("a world line has left all places"));
        };
        let tetrad = Tetrad::new(&frame, s.drag);
        let momentum = frame.momentum(c, s);
        let own = |components: DVec4| match frame.static_lapse().filter(|_| is_static) {
            Some(lapse) => {
                let (motion, gamma) = rain_motion(lapse);
                boosted(components, -motion, gamma)
            }
            None => components,
        };
        let seen = own(momentum.space.extend(momentum.energy));
        let velocity = seen.truncate() / seen.w;
        // Beside a horizon that bodies do not pass a speed may round to 1.
        let velocity = velocity.clamp_length_max(1.0 - 4.0 * f64::EPSILON);
        let axes = point.axes.map(|axis| boosted(own(tetrad.components(axis)), velocity, seen.w).truncate());
        let time = self.time - s.delay - (there.time - self.offsets.time);
        let body = Body { clock: self.clock, position, velocity, time };
        Ok(Event { body, axes, proper_time: point.proper, end })
    }
}

/// A line as it is followed in one direction. The step that was taken last lies between `from` and `to`, so that where
/// steps end does not depend on the times that are asked for.
struct Course {
    line: Line,
    past: bool,
    from: Point,
    to: Point,
    h: f64,
    end: Option<End>,
    /// Steps that are left.
    steps: u32,
}

impl Course {
    /// The event at `proper`, which no call before was beyond.
    fn event(&mut self, proper: f64) -> Result<Event> {
        let is_beyond = |point: &Point| point.proper.abs() >= proper.abs();
        while self.end.is_none() && !is_beyond(&self.to) {
            self.advance(proper)?;
        }
        if self.end.is_some() && !is_beyond(&self.to) {
            return self.line.event(&self.to, self.end);
        }
        let (point, _) = self.land(|point| (point.proper - proper, -self.line.sigma(point.state.u, point.state.n.z)));
        self.line.event(&point, None)
    }

    /// The next step. Errors: UNSUPPORTED where none is left.
    fn advance(&mut self, wanted: f64) -> Result<()> {
        let bound = self.line.bound(&self.to.state, self.past);
        self.from = self.to;
        let s = &self.from.state;
        let limit = self.line.limit(s);
        if self.steps == 0 || limit.is_nan() || limit <= 0.0 {
            let (reached, wanted) = (Number(self.to.proper), Number(wanted));
            return Err(Error::unsupported(format!(
                "a world line takes more than {MOST_STEPS} steps: it came to a proper time of {reached} M of {wanted} M"
            )));
        }
        self.steps -= 1;
        self.h = if self.past { limit } else { -limit };
        self.to = self.line.step(&self.from, self.h);
        let Some(bound) = bound else { return Ok(()) };
        if (self.from.state.du < 0.0) != (self.to.state.du < 0.0) {
            // The line has turned: just beyond its end perhaps, and come back.
            let (turn, h) = self.land(|point| (point.state.du, self.line.c.u_acceleration(point.state.u)));
            if bound.is_reached(turn.state.u) {
                (self.to, self.h) = (turn, h);
            }
        }
        if bound.is_reached(self.to.state.u) {
            (self.to, self.h) = self.land(|point| (point.state.u - bound.u, point.state.du));
            self.end = Some(bound.end);
        }
        Ok(())
    }

    /// The point of the last step at which a quantity is 0. `value` gives it and its slope by tau. Newton's method with
    /// the integrator itself, held within the step. With the point comes its tau from the begin of the step.
    fn land(&self, value: impl Fn(&Point) -> (f64, f64)) -> (Point, f64) {
        let [(begin, _), (end, _)] = [&self.from, &self.to].map(&value);
        let share = if begin == end { 1.0 } else { begin / (begin - end) };
        let mut h = self.h * share.clamp(0.0, 1.0);
        let mut point = self.line.step(&self.from, h);
        for _ in 0..8 {
            let (y, slope) = value(&point);
            let correction = y / slope;
            if correction.is_nan() || correction.abs() <= 1e-15 * self.h.abs() {
                break;
            }
            let next = h - correction;
            let (low, high) = (self.h.min(0.0), self.h.max(0.0));
            if next == h || !next.is_finite() {
                break;
            }
            h = next.clamp(low, high);
            point = self.line.step(&self.from, h);
        }
        (point, h)
    }
}
