// SPDX-License-Identifier: MIT OR Apache-2.0
//! One light ray from its start to its fate: steps, crossings of the equatorial plane, escape and capture. The only
//! driver of the integrators; knows no light, no camera and no pixel. Mirrored by `shaders/geodesic/trace.wgsl`.
//!
//! Lengths and times are in M, u = 1/r, tau is Mino time, and steps are measured in sigma = S tau (`Constants::scale`).

use super::geodesic::{Constants, State, wrap_angle};
use super::integrator::{Method, Quintic, held_inside, step, step_limit};
use super::observer::LocalFrame;
use super::plunge::Matter;
use crate::allocate::{collected, push};
use crate::error::Result;
use arrayvec::ArrayVec;
use glam::DVec3;

/// Crossings a trace can keep: a ray's direct image of the plane and 15 higher orders.
pub const CROSSINGS_KEPT: usize = 16;

/// How to trace.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub method: Method,
    /// Step in sigma of the fixed-step methods; the first step of the adaptive one, whose steps never exceed 0.5.
    pub step: f64,
    /// The greatest error of an accepted step of the adaptive method, as the integrator measures it.
    pub tolerance: f64,
    /// A ray that needs more steps is unresolved.
    pub max_steps: u32,
    /// The number of crossings to keep, at most `CROSSINGS_KEPT`; the ray is followed to its fate all the same.
    pub max_crossings: usize,
    /// Integrate the delay.
    pub delay: bool,
    /// 1/r beyond which a ray that moves inwards counts as captured: at most 1/r+. A smaller value saves steps where no
    /// crossing so near the horizon matters.
    pub capture_u: f64,
    /// A kept crossing with 1/r in this interval ends the ray: the matter there hides everything behind it.
    pub opaque_u: Option<[f64; 2]>,
}

impl Settings {
    /// Settings for reference values: small steps, every crossing, everything down to the horizon.
    pub fn exact(a: f64) -> Self {
        Self {
            method: Method::Nystrom,
            step: 0.02,
            tolerance: 1e-10,
            max_steps: 100_000,
            max_crossings: CROSSINGS_KEPT,
            delay: true,
            capture_u: 1.0 / super::orbit::horizon_outer(a),
            opaque_u: None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    Captured,
    Escaped,
    /// `max_steps` ran out.
    Unresolved,
    /// Ended on something opaque in the plane (`Settings::opaque_u`).
    Hidden,
}

/// A crossing of the equatorial plane.
#[derive(Clone, Copy, Debug)]
pub struct PlaneCrossing {
    /// 1/r.
    pub u: f64,
    /// Azimuth in Boyer and Lindquist's chart, in (-pi, pi].
    pub azimuth: f64,
    /// The time from the crossing to the observer (`Constants::retardation`); 0 unless `Settings::delay`.
    pub delay: f64,
    /// Number of this crossing along the ray, from 0.
    pub order: u32,
    /// u' of `State` there: above 0 on the ray's way in, below 0 on its way out.
    pub du: f64,
}

/// The result of tracing a ray.
#[derive(Clone, Debug)]
pub struct RayTrace {
    pub fate: Fate,
    /// Asymptotic chart direction, unit; 0 unless escaped.
    pub direction: DVec3,
    /// sqrt(K) tau, the angle about the hole that a ray without spin sweeps, rad: to infinity, to the horizon, or to
    /// `Settings::capture_u` if that is farther out. NaN with spin, and for rays that are unresolved or hidden.
    pub swept: f64,
    /// `Constants::azimuth_turned` from the observer to infinity; NaN unless escaped.
    pub turned: f64,
    pub steps: u32,
    pub crossings: ArrayVec<PlaneCrossing, CROSSINGS_KEPT>,
    /// The orders of crossings within the horizon, a bit each; they are not kept.
    pub inside: u16,
}

impl RayTrace {
    /// A ray of which nothing is known but its fate.
    pub fn of(fate: Fate) -> Self {
        let (swept, turned) = (f64::NAN, f64::NAN);
        Self { fate, direction: DVec3::ZERO, swept, turned, steps: 0, crossings: ArrayVec::new(), inside: 0 }
    }
}

/// One accepted step of `follow`.
pub struct Segment<'a> {
    pub from: &'a State,
    pub to: &'a State,
    /// Mino time at `from`, and the length of the step in it.
    pub tau: f64,
    pub h: f64,
}

/// A stretch of a ray without a kept crossing: a step, or the part of a step before or after a crossing. `constants`
/// and the states give the light's momentum.
pub struct Part<'a> {
    pub constants: &'a Constants,
    /// The state at the observer.
    pub observer: &'a State,
    /// The begin and the end of the step that the part lies in, and its length in tau.
    from: &'a State,
    to: &'a State,
    step: f64,
    /// Tau from `from` to the part's begin and end.
    begin: f64,
    end: f64,
    /// Whether this is the last part of a captured ray, from where its steps end to the horizon.
    pub to_horizon: bool,
    settings: &'a Settings,
}

/// Dense output along a part: 1/r and N_z, each by the share of the step, of which the part is a share.
pub struct PartCourse {
    u: Quintic,
    n_z: Quintic,
    share: [f64; 2],
}

impl PartCourse {
    /// 1/r and N_z at the share `x`, 0 .. 1, of the part: to the fifth order in the step.
    pub fn at(&self, x: f64) -> [f64; 2] {
        let [begin, end] = self.share;
        let there = begin + (end - begin) * x;
        [self.u.at(there).0, self.n_z.at(there).0]
    }
}

impl Part<'_> {
    /// The largest 1/r at the ends of the step that the part lies in.
    pub fn innermost_end(&self) -> f64 {
        self.from.u.max(self.to.u)
    }

    /// The angle about the hole that the part sweeps, rad; with spin an upper bound.
    pub fn swept(&self) -> f64 {
        (self.end - self.begin).abs() * self.constants.scale
    }

    pub fn course(&self) -> PartCourse {
        let (c, h) = (self.constants, self.step);
        PartCourse {
            u: Quintic::of_u(c, self.from, self.to, h),
            n_z: Quintic::of_n_z(c, self.from, self.to, h),
            share: [self.begin / h, self.end / h],
        }
    }

    /// The part from one share of its Mino time to another.
    pub fn between(&self, from: f64, to: f64) -> Self {
        let at = |x: f64| self.begin + (self.end - self.begin) * x;
        Self { begin: at(from), end: at(to), ..*self }
    }

    /// The state at the share `x`, 0 .. 1, of the part's Mino time. A part may reach past infinity, where u < 0.
    pub fn at(&self, x: f64) -> State {
        let tau = self.begin + (self.end - self.begin) * x;
        // The ends of steps are known.
        if tau == 0.0 || tau == self.step {
            return if tau == 0.0 { *self.from } else { *self.to };
        }
        step(self.settings.method, self.constants, self.from, tau, self.settings.delay).0
    }

    /// The affine length of the part, if d(lambda)/d(tau) were all along what it is at `there`: Sigma = r^2 +
    /// a^2 cos^2 theta (Carter 1968). lambda is scaled so that the observer of the local frame measures frequency 1.
    pub fn length(&self, there: &State) -> f64 {
        let a_cos = self.constants.a * there.n.z;
        (self.end - self.begin) * self.constants.nu_local * (1.0 / (there.u * there.u) + a_cos * a_cos)
    }
}

/// The receiver of a ray's parts and crossings, in order, while the ray is traced: emitters with depth need them.
pub trait Visitor {
    /// The next part of the ray.
    fn part(&mut self, part: &Part<'_>);
    /// The ray crosses the plane here.
    fn crossing(&mut self, crossing: &PlaneCrossing);
}

/// The receiver that ignores everything.
impl Visitor for () {
    fn part(&mut self, _: &Part<'_>) {}
    fn crossing(&mut self, _: &PlaneCrossing) {}
}

/// The reason why the stepping loop ended.
enum End {
    Escaped,
    Captured,
    OutOfSteps,
    Hidden,
}

/// The next step of an adaptive method: 0.9 h (tolerance / error)^(1/5), at least h / 5 and at most 5 h.
fn next_step(h: f64, error: f64, tolerance: f64) -> f64 {
    h * (0.9 * (tolerance / error.max(1e-300)).powf(0.2)).clamp(0.2, 5.0)
}

/// Follows the ray and calls `visit` for every accepted step, until the ray ends or `visit` returns false. Gives the
/// reason, and the number of steps, rejected ones included.
fn follow(c: &Constants, start: &State, settings: &Settings, visit: &mut impl FnMut(&Segment) -> bool) -> (End, u32) {
    let adaptive = settings.method == Method::DormandPrince;
    let u_plus = 1.0 / c.r_plus;
    let mut state = *start;
    let mut tau = 0.0;
    let mut h_wish = settings.step / c.scale;
    // Sigma-steps of the adaptive method never exceed 0.5: crossings are found by their change of side.
    let h_most = if adaptive { 0.5 / c.scale } else { h_wish };
    for count in 1..=settings.max_steps {
        let limit = step_limit(c, &state, settings.step);
        // Inside the horizon one fixed step in sigma could change u of a nearly radial ray by any amount, or by next to
        // nothing: only the step limit, with spin N, and the adaptive method's own choice bound steps there.
        let inside = state.u >= u_plus;
        let h = match (inside, adaptive) {
            (true, false) if c.a == 0.0 => limit,
            (true, false) => limit.min(settings.step / c.turn_rate()),
            (true, true) => h_wish.min(limit),
            (false, _) => h_wish.min(h_most).min(limit),
        };
        let (next, error) = step(settings.method, c, &state, h, settings.delay);
        let next = held_inside(c, next);
        if adaptive {
            h_wish = next_step(h, error, settings.tolerance);
            // A NaN error is rejected; a step too small to change anything is accepted whatever its error.
            let accepted = error <= settings.tolerance || h * c.scale <= 1e-9;
            if !accepted {
                continue;
            }
        }
        if !visit(&Segment { from: &state, to: &next, tau, h }) {
            return (End::Hidden, count);
        }
        if next.u <= 0.0 {
            return (End::Escaped, count);
        }
        // Steps stop short of the horizon, so capture is not a step across it but a state near it that moves inwards.
        if next.du > 0.0 && (next.u >= settings.capture_u || u_plus - next.u < 1e-6 * u_plus) {
            return (End::Captured, count);
        }
        tau += h;
        state = next;
    }
    (End::OutOfSteps, settings.max_steps)
}

/// Corrections of sigma smaller than this are rounding error, sigma being of order 1.
const ROUNDING: f64 = 1e-15;

/// The state inside the step from `from` at which a quantity is 0, and its Mino time from there. `value` gives the
/// quantity and its slope by tau; `guess` comes from dense output. Newton's method with the integrator itself follows,
/// at most three times; corrections below `slack` in sigma are left out.
pub(crate) fn land(
    c: &Constants,
    s: &Settings,
    from: &State,
    guess: f64,
    slack: f64,
    value: impl Fn(&State) -> (f64, f64),
) -> (State, f64) {
    let mut h = guess;
    let mut state = step(s.method, c, from, h, s.delay).0;
    for _ in 0..3 {
        let (y, slope) = value(&state);
        let correction = y / slope;
        if !(correction.abs() > slack / c.scale && correction.abs() < 0.1 / c.scale) {
            break;
        }
        h -= correction;
        state = step(s.method, c, from, h, s.delay).0;
    }
    (state, h)
}

/// Traces the backward ray (`constants`, `start`) to its fate.
pub fn trace(constants: &Constants, start: &State, settings: &Settings) -> RayTrace {
    trace_visited(constants, start, settings, &mut ())
}

/// [`trace`], with `visitor` told of all parts of the ray and of the crossings that are kept, in order.
pub fn trace_visited(
    constants: &Constants,
    start: &State,
    settings: &Settings,
    visitor: &mut impl Visitor,
) -> RayTrace {
    let c = constants;
    let mut crossings = ArrayVec::<PlaneCrossing, CROSSINGS_KEPT>::new();
    let (mut order, mut inside) = (0, 0);
    // A start in the plane is no crossing: the side is then the one it leaves to.
    let mut side = if start.n.z != 0.0 { start.n.z } else { start.dn.z };
    let mut last = (*start, *start, 0.0, 0.0);
    let crossing_limit = settings.max_crossings.min(CROSSINGS_KEPT);
    let (end, steps) = follow(c, start, settings, &mut |segment| {
        last = (*segment.from, *segment.to, segment.tau, segment.h);
        let mut part = Part {
            constants: c,
            observer: start,
            from: segment.from,
            to: segment.to,
            step: segment.h,
            begin: 0.0,
            end: segment.h,
            to_horizon: false,
            settings,
        };
        if side * segment.to.n.z < 0.0 {
            side = segment.to.n.z;
            order += 1;
            if order as usize <= crossing_limit
                && let Some((crossing, h)) = find_crossing(c, start, settings, segment, order - 1)
            {
                visitor.part(&Part { end: h, ..part });
                visitor.crossing(&crossing);
                part.begin = h;
                crossings.push(crossing);
                if settings.opaque_u.is_some_and(|[low, high]| crossing.u >= low && crossing.u <= high) {
                    return false;
                }
            } else if order as usize <= crossing_limit && segment.to.u > 0.0 {
                // Past infinity, where u is below 0, there are none.
                inside |= 1 << (order - 1);
            }
        }
        visitor.part(&part);
        true
    });
    let (from, to, tau, h) = last;
    let mut result = RayTrace { steps, crossings, inside, ..RayTrace::of(Fate::Unresolved) };
    let swept = |tau: f64| if c.a == 0.0 { c.k.max(0.0).sqrt() * tau } else { f64::NAN };
    match end {
        End::OutOfSteps => {}
        End::Hidden => result.fate = Fate::Hidden,
        End::Escaped => {
            let guess = h * Quintic::of_u(c, &from, &to, h).root();
            // The delay is infinite at infinity and not needed there.
            let no_delay = Settings { delay: false, ..*settings };
            let (state, h) = land(c, &no_delay, &from, guess, ROUNDING, |s| (s.u, s.du));
            result.fate = Fate::Escaped;
            result.direction = state.chart_direction();
            result.swept = swept(tau + h);
            result.turned = c.azimuth_turned(state.drag - start.drag, tau + h);
        }
        End::Captured => {
            result.fate = Fate::Captured;
            visit_rest(c, start, settings, &to, visitor);
            result.swept = swept(tau + h + time_to_horizon(c, settings, &to));
        }
    }
    result
}

/// Tells `visitor` of the last part of a captured ray, from the end of its last step, `end`, to the horizon: steps stop
/// short of it. There is none where `Settings::capture_u` ends rays farther out.
fn visit_rest(c: &Constants, observer: &State, settings: &Settings, end: &State, visitor: &mut impl Visitor) {
    let room = 1.0 / c.r_plus - end.u;
    if settings.capture_u * c.r_plus < 1.0 || room <= 0.0 {
        return;
    }
    // u+ = u + u' h + u'' h^2 / 2.
    let rest = 2.0 * room / (end.du + (end.du * end.du + 2.0 * c.u_acceleration(end.u).max(0.0) * room).sqrt());
    let at_horizon = State { u: 1.0 / c.r_plus, ..*end };
    visitor.part(&Part {
        constants: c,
        observer,
        from: end,
        to: &at_horizon,
        step: rest,
        begin: 0.0,
        end: rest,
        to_horizon: true,
        settings,
    });
}

/// Mino time from the end of a captured ray to the horizon, without spin, where u and N are regular. 0 with spin, and
/// where `Settings::capture_u` ends rays farther out.
pub(crate) fn time_to_horizon(c: &Constants, settings: &Settings, end: &State) -> f64 {
    if c.a != 0.0 || settings.capture_u < 1.0 / c.r_plus {
        return 0.0;
    }
    let no_delay = Settings { delay: false, ..*settings };
    let u_plus = 1.0 / c.r_plus;
    land(c, &no_delay, end, (u_plus - end.u) / end.du, ROUNDING, |s| (s.u - u_plus, s.du)).1
}

/// 1/r of the innermost crossings that are kept, about a hole of the outer horizon `r_plus`: bhr.h promises them down
/// to r+ (1 + 1e-5).
pub fn innermost_u(r_plus: f64) -> f64 {
    1.0 / (r_plus * (1.0 + 1e-5))
}

/// The crossing of the plane within a step, and its tau from the step's begin.
pub(crate) fn find_crossing(
    c: &Constants,
    observer: &State,
    s: &Settings,
    segment: &Segment,
    order: u32,
) -> Option<(PlaneCrossing, f64)> {
    let (from, to) = (segment.from, segment.to);
    let guess = segment.h * Quintic::of_n_z(c, from, to, segment.h).root();
    let (state, h) = land(c, s, from, guess, ROUNDING, |s| (s.n.z, s.dn.z));
    // Past infinity, u <= 0, there are none.
    if !(state.u > 0.0 && state.u <= innermost_u(c.r_plus)) {
        return None;
    }
    let delay = if s.delay { c.retardation(observer, &state) } else { 0.0 };
    Some((PlaneCrossing { u: state.u, azimuth: wrap_angle(c.matter_azimuth(&state)), delay, order, du: state.du }, h))
}

/// Traces along the look direction `n` (unit, components in `frame`). Where no light can come from that direction it
/// gives no constants, and a captured ray.
pub fn trace_look(frame: &LocalFrame, n: DVec3, settings: &Settings) -> (Option<Constants>, RayTrace) {
    trace_look_visited(frame, n, settings, &mut ())
}

/// [`trace_look`], of which `visitor` is told.
pub fn trace_look_visited(
    frame: &LocalFrame,
    n: DVec3,
    settings: &Settings,
    visitor: &mut impl Visitor,
) -> (Option<Constants>, RayTrace) {
    match frame.start(n) {
        Some((c, state)) => (Some(c), trace_visited(&c, &state, settings, visitor)),
        None => (None, RayTrace { swept: 0.0, ..RayTrace::of(Fate::Captured) }),
    }
}

impl PlaneCrossing {
    /// g = nu(observer of the local frame) / nu(matter); NaN where there is no matter: inside the ISCO, unless it
    /// plunges.
    pub fn redshift(&self, c: &Constants, matter: &Matter) -> f64 {
        if matter.is_at(self.u) { matter.redshift(c, self.u, self.du) } else { f64::NAN }
    }
}

/// A point of a ray's path: its place in the chart, and the time from there to the observer.
#[derive(Clone, Copy, Debug)]
pub struct PathPoint {
    pub position: DVec3,
    pub delay: f64,
}

/// The path in `count` (>= 2) points, evenly spaced in Mino time from the observer to the end: the horizon (1 + 1e-6),
/// or, for a ray that escapes, the radius `far`. Errors: OUT_OF_MEMORY.
pub fn path(c: &Constants, start: &State, settings: &Settings, far: f64, count: usize) -> Result<Vec<PathPoint>> {
    let point = |s: &State| PathPoint { position: s.chart_direction() / s.u, delay: c.delay(start, s) };
    let u_far = 1.0 / far;
    let mut segments: Vec<(State, f64, f64)> = Vec::new();
    let mut end_tau = 0.0;
    let mut kept = Ok(());
    follow(c, start, settings, &mut |segment| {
        kept = push(&mut segments, (*segment.from, segment.tau, segment.h), "the steps of a path");
        if kept.is_err() {
            return false;
        }
        end_tau = segment.tau + segment.h;
        if segment.to.u < u_far && segment.to.du < 0.0 {
            let q = Quintic::new(
                segment.from.u - u_far,
                segment.from.du,
                c.u_acceleration(segment.from.u),
                segment.to.u - u_far,
                segment.to.du,
                c.u_acceleration(segment.to.u),
                segment.h,
            );
            end_tau = segment.tau + segment.h * q.root();
            return false;
        }
        true
    });
    kept?;
    let mut index = 0;
    let points = (0..count).map(|i| {
        let tau = end_tau * i as f64 / (count - 1).max(1) as f64;
        while index + 1 < segments.len() && segments[index + 1].1 <= tau {
            index += 1;
        }
        let Some((from, begin, _)) = segments.get(index) else { return point(start) };
        point(&step(settings.method, c, from, tau - begin, settings.delay).0)
    });
    collected(points, "the points of a path")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::orbit::{horizon_inner, horizon_outer};

    /// Boyer-Lindquist time along the ray from the observer to Mino time `tau`, by Simpson's rule on dt/dtau as Carter
    /// 1968 has it: [(r^2 + a^2)(E (r^2 + a^2) - a L)] / Delta + a (L - a E sin^2 theta).
    fn coordinate_time(c: &Constants, start: &State, tau: f64) -> f64 {
        let rate = |s: &State| {
            let (a, r) = (c.a, 1.0 / s.u);
            let sum = r * r + a * a;
            let delta = (r - horizon_outer(a)) * (r - horizon_inner(a));
            sum * (c.energy * sum - a * c.angular_momentum) / delta
                + a * (c.angular_momentum - a * c.energy * (1.0 - s.n.z * s.n.z))
        };
        let (n, h) = (20_000, tau / 40_000.0);
        let (mut state, mut sum) = (*start, 0.0);
        for _ in 0..n {
            let middle = step(Method::Nystrom, c, &state, h, false).0;
            let end = step(Method::Nystrom, c, &middle, h, false).0;
            sum += h / 3.0 * (rate(&state) + 4.0 * rate(&middle) + rate(&end));
            state = end;
        }
        sum
    }

    #[test]
    fn delay_is_the_integral_of_dt() {
        let mut compared = 0;
        for a in [0.0, 0.6, -0.95] {
            for (r, theta) in [(6.0, 1.2), (30.0, 0.4), (500.0, 1.5)] {
                let frame = LocalFrame::new(a, super::super::metric::chart(r, theta, 0.7)).unwrap();
                for i in 0..8 {
                    let tilt = 8.0 / r * (f64::from(i) / 4.0 - 1.0);
                    let n = DVec3::new(-1.0, 0.6 * tilt + 0.1 / r, tilt).normalize();
                    let (c, start) = frame.start(n).unwrap();
                    let traced = trace(&c, &start, &Settings::exact(a));
                    for crossing in traced.crossings.iter().filter(|x| x.u > 1e-3 && x.u < 0.4) {
                        let tau = tau_of(&c, &start, crossing);
                        let expected = coordinate_time(&c, &start, tau);
                        let error = (crossing.delay / expected - 1.0).abs();
                        assert!(error < 1e-9, "a {a} r {r} ray {i}: {} {expected} {error:.1e}", crossing.delay);
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 30, "{compared}");
    }

    /// Mino time of a crossing, by following the ray again.
    fn tau_of(c: &Constants, start: &State, crossing: &PlaneCrossing) -> f64 {
        let settings = Settings { delay: false, ..Settings::exact(c.a) };
        let (mut order, mut side, mut tau) = (0, if start.n.z != 0.0 { start.n.z } else { start.dn.z }, f64::NAN);
        follow(c, start, &settings, &mut |segment| {
            if side * segment.to.n.z < 0.0 {
                side = segment.to.n.z;
                if order == crossing.order {
                    let guess = segment.h * Quintic::of_n_z(c, segment.from, segment.to, segment.h).root();
                    tau = segment.tau + land(c, &settings, segment.from, guess, ROUNDING, |s| (s.n.z, s.dn.z)).1;
                }
                order += 1;
            }
            true
        });
        tau
    }

    /// t = r_observer - r + 2 ln((r_observer - 2) / (r - 2)) along a radial ray; the rain time of an observer inside is
    /// finite through r = 2.
    #[test]
    fn radial_paths_take_the_textbook_time() {
        let frame = LocalFrame::new(0.0, DVec3::new(0.0, 40.0, 0.0)).unwrap();
        let (c, start) = frame.start(DVec3::NEG_X).unwrap();
        for point in path(&c, &start, &Settings::exact(0.0), 1000.0, 12).unwrap().iter().take(11) {
            let r = point.position.length();
            let expected = 40.0 - r + 2.0 * (38.0 / (r - 2.0)).ln();
            assert!((point.delay - expected).abs() < 1e-8 * expected.max(1.0), "r {r}: {} {expected}", point.delay);
        }
        let inside = LocalFrame::new(0.0, DVec3::new(1.5, 0.0, 0.0)).unwrap();
        let (c, start) = inside.start(DVec3::X).unwrap();
        let points = path(&c, &start, &Settings::exact(0.0), 100.0, 9).unwrap();
        for pair in points.windows(2) {
            // Outgoing light looked back along: dT/dr = 1 / (1 + sqrt(2/r)) on the radial ray that falls in with the
            // observer.
            let [r0, r1] = [0, 1].map(|i| pair[i].position.length());
            assert!(r1 > r0 && pair[1].delay > pair[0].delay && pair[1].delay.is_finite());
            let time = |r: f64| r - 2.0 * (2.0 * r).sqrt() + 4.0 * (1.0 + (r / 2.0).sqrt()).ln();
            let expected = time(r1) - time(r0);
            assert!((pair[1].delay - pair[0].delay - expected).abs() < 1e-7, "{r0} {r1}: {expected}");
        }
    }
}
