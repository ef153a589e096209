// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bodies in free fall, in the host's terms: lengths and axes of the scene. Converts for `physics::world_line`, which
//! follows them; may not know of cameras.

use super::{Chart, Hole};
use crate::allocate::collected;
use crate::error::{Error, Number, Result};
use crate::physics::geodesic::Clock;
use crate::physics::observer::LocalFrame;
use crate::physics::world_line::table::WorldLineTable;
use crate::physics::world_line::{self, Event, LONGEST, each_event};
use glam::DVec3;

pub use crate::physics::world_line::End as WorldLineEnd;

/// The greatest speed that a body is told with: one that a host gives again is below 1 then, however it is rounded.
pub(super) const FASTEST: f64 = 1.0 - 4.0 * f64::EPSILON;

/// A body at an event.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// How position, velocity and time are told.
    pub chart: Chart,
    /// Scene axes and lengths.
    pub position: DVec3,
    /// v / c, |v| < 1, as the observer of the chart's triad measures it: the vector in scene axes.
    pub velocity: DVec3,
    /// Scene lengths.
    pub time: f64,
}

impl Body {
    /// This body in the settings of hot spots, which know no charts.
    pub fn falling(&self) -> world_line::Body {
        let Self { chart, position, velocity, time } = *self;
        world_line::Body { clock: chart.clock(), position, velocity, time }
    }

    /// The inverse of `falling`.
    pub fn of_falling(body: &world_line::Body) -> Self {
        let world_line::Body { clock, position, velocity, time } = *body;
        let chart = if clock == Clock::Rain { Chart::Rain } else { Chart::Static };
        Self { chart, position, velocity, time }
    }
}

/// A body after a proper time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyEvent {
    pub body: Body,
    /// Proper time since the start, scene lengths: what was asked for, or that of the line's end.
    pub proper_time: f64,
    /// Set where the line has ended before.
    pub end: Option<WorldLineEnd>,
}

impl Hole {
    /// Where a body in free fall is after each of `proper_times` (scene lengths, any sign, any order): gives `found`
    /// each event and the index of its proper time, in any order.
    ///
    /// Errors: INVALID_ARGUMENT for a body or a time out of range, and for results that are; UNSUPPORTED for a place
    /// that the chart does not hold, and for a line that is too long; OUT_OF_MEMORY. Some come when part of the events
    /// have been given.
    pub fn world_line(&self, body: &Body, proper_times: &[f64], found: &mut dyn FnMut(usize, BodyEvent)) -> Result<()> {
        for (index, time) in proper_times.iter().enumerate() {
            if time.is_nan() || (time / self.mass).abs() > LONGEST {
                let (time, mass) = (Number(*time), Number(self.mass));
                return Err(Error::argument(format!(
                    "proper_times[{index}] is {time}; it must lie in [-{LONGEST:e}, {LONGEST:e}] M, and M is {mass}"
                )));
            }
        }
        let start = self.in_chart(body)?;
        let times = collected(proper_times.iter().map(|time| time / self.mass), "the proper times of a body")?;
        let mut wrong = None;
        each_event(
            self.spin,
            &start,
            &[DVec3::X, DVec3::Y, DVec3::Z],
            &times,
            &mut |index, event| match self.in_scene(body, proper_times[index], &event) {
                Ok(event) => found(index, event),
                Err(error) => wrong = Some(error),
            },
        )?;
        wrong.map_or(Ok(()), Err)
    }

    /// Whether a body in the scene's axes and lengths can fall freely about this hole. Errors: as `world_line`.
    pub fn check_falling(&self, body: &world_line::Body) -> Result<()> {
        self.falling_in_chart(body).and_then(|body| WorldLineTable::new(self.spin, &body)).map(drop)
    }

    /// A body in the scene's axes and lengths in those of the chart. Errors: INVALID_ARGUMENT for one at no place.
    pub(super) fn falling_in_chart(&self, body: &world_line::Body) -> Result<world_line::Body> {
        let there = self.in_chart(&Body::of_falling(body))?;
        Ok(world_line::Body { time: body.time / self.mass, ..there })
    }

    /// The body in the chart's axes and units, at time 0.
    fn in_chart(&self, body: &Body) -> Result<world_line::Body> {
        let position = self.scene_to_chart() * body.position / self.mass;
        let velocity = triad(position)?.components(self.scene_to_chart() * body.velocity);
        Ok(world_line::Body { clock: body.chart.clock(), position, velocity, time: 0.0 })
    }

    /// An event on the line of `start`, for which `asked` was asked.
    fn in_scene(&self, start: &Body, asked: f64, event: &Event) -> Result<BodyEvent> {
        let chart_to_scene = self.scene_to_chart().transpose();
        let velocity = chart_to_scene * triad(event.body.position)?.vector(event.body.velocity);
        let body = Body {
            chart: start.chart,
            position: chart_to_scene * event.body.position * self.mass,
            velocity: velocity.clamp_length_max(FASTEST),
            time: start.time + event.body.time * self.mass,
        };
        let proper_time = if event.end.is_some() { event.proper_time * self.mass } else { asked };
        if !(body.position.is_finite() && body.time.is_finite()) {
            let (asked, mass) = (Number(asked), Number(self.mass));
            return Err(Error::argument(format!(
                "after a proper time of {asked} the body's place or time is beyond the range of doubles; M is {mass}"
            )));
        }
        Ok(BodyEvent { body, proper_time, end: event.end })
    }
}

/// The unit vectors of spherical coordinates at a place in the chart, which are those of every triad there, whatever
/// the spin is.
fn triad(position: DVec3) -> Result<LocalFrame> {
    LocalFrame::new(0.0, position).map_err(|_| {
        Error::argument(format!(
            "a body at ({}, {}, {}) M is at no place: it must be finite, and not the hole's centre",
            Number(position.x),
            Number(position.y),
            Number(position.z)
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    fn events(hole: &Hole, body: &Body, times: &[f64]) -> Vec<BodyEvent> {
        let mut events = vec![None; times.len()];
        hole.world_line(body, times, &mut |index, event| events[index] = Some(event)).unwrap();
        events.into_iter().map(|event| event.expect("each has an event")).collect()
    }

    fn turned_hole() -> Hole {
        Hole { mass: 2.5, spin: 0.7, axis: Hole::check_axis(DVec3::new(1.0, -2.0, 0.5)).unwrap() }
    }

    /// An event is that of `physics`, in the scene's axes and lengths and from the scene's time on.
    #[test]
    fn axes_lengths_and_times_are_the_scenes() {
        let (hole, plain) = (turned_hole(), Hole { spin: 0.7, ..Hole::default() });
        let chart_to_scene = hole.scene_to_chart().transpose();
        for chart in [Chart::Static, Chart::Rain] {
            let velocity = DVec3::new(0.1, 0.3, -0.2);
            let there = Body { chart, position: DVec3::new(9.0, 3.0, 4.0), velocity, time: 0.0 };
            let here = Body {
                chart,
                position: chart_to_scene * there.position * hole.mass,
                velocity: chart_to_scene * velocity,
                time: 7.0,
            };
            let times = [-30.0, 0.0, 50.0];
            let scaled = times.map(|time| time * hole.mass);
            for (ours, theirs) in events(&hole, &here, &scaled).iter().zip(events(&plain, &there, &times)) {
                let position = chart_to_scene * theirs.body.position * hole.mass;
                assert!((ours.body.position - position).length() < 1e-11, "{ours:?}, {theirs:?}");
                assert!((ours.body.velocity - chart_to_scene * theirs.body.velocity).length() < 1e-12, "{ours:?}");
                assert!((ours.body.time - 7.0 - theirs.body.time * hole.mass).abs() < 1e-10, "{ours:?}");
                assert_eq!((ours.proper_time, ours.end), (theirs.proper_time * hole.mass, None));
            }
        }
    }

    #[test]
    fn the_start_is_the_body_itself() {
        let hole = turned_hole();
        let position = DVec3::new(20.0, -11.0, 6.0);
        let body = Body { chart: Chart::Static, position, velocity: DVec3::new(0.2, -0.5, 0.4), time: 3.0 };
        let start = events(&hole, &body, &[0.0])[0].body;
        assert!((start.position - position).length() < 1e-12 && start.time == 3.0, "{start:?}");
        assert!((start.velocity - body.velocity).length() < 1e-13, "{start:?}");
    }

    #[test]
    fn bodies_and_times_that_cannot_be_are_refused() {
        let hole = Hole { mass: 2.0, spin: 0.5, ..Hole::default() };
        let good = Body { position: DVec3::new(20.0, 0.0, 0.0), ..Body::default() };
        let refused = |hole: &Hole, body: &Body, time: f64| {
            hole.world_line(body, &[1.0, time], &mut |_, _| {}).expect_err("it is refused")
        };
        for time in [f64::NAN, f64::INFINITY, -2.1e12] {
            let error = refused(&hole, &good, time);
            assert_eq!(error.kind, ErrorKind::InvalidArgument);
            assert!(error.message.contains("proper_times[1]"), "{error}");
        }
        for position in [DVec3::ZERO, DVec3::NAN, DVec3::X * f64::INFINITY, DVec3::X * 1e300] {
            let error = refused(&hole, &Body { position, ..good }, 1.0);
            assert_eq!(error.kind, ErrorKind::InvalidArgument, "{error}");
        }
        let inside = Body { position: DVec3::new(0.0, 3.0, 0.0), ..good };
        assert_eq!(refused(&hole, &inside, 1.0).kind, ErrorKind::Unsupported);
        let heavy = Hole { mass: 1e300, ..hole };
        let far = Body { position: DVec3::X * 1e308, velocity: DVec3::X * 0.9, ..good };
        assert_eq!(refused(&heavy, &far, 1e308).kind, ErrorKind::InvalidArgument);
    }
}
