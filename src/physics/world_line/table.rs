// SPDX-License-Identifier: MIT OR Apache-2.0
//! A world line as a table over the time T of Doran's chart, for those who ask for it again and again. It grows as far
//! as it is asked for. Knows no chart but Doran's and nothing of light.

use super::{Body, Course, End, Line};
use crate::allocate::{push, with_room};
use crate::error::Result;
use crate::physics::geodesic::Clock;
use crate::physics::rain_motion::chart_rate;
use glam::DVec3;

/// Most nodes each way from the start: some six hundred turns about the hole.
pub const MOST_NODES: usize = 1 << 16;
/// The time between two nodes, over r^(3/2), in which a circular orbit turns by so many rad. Cubic interpolation by
/// values and slopes is then off by 1e-5 r at most.
const SPACING: f64 = 0.06;
/// The least r, M, that is put into that.
const LEAST_SPACED: f64 = 0.3;
/// Nodes that room is made for at first.
const ROOM: usize = 1024;

/// A place of a world line, in Doran's chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// T, M.
    pub time: f64,
    pub position: DVec3,
    /// d(position)/dT.
    pub rate: DVec3,
}

impl Node {
    /// Between two nodes, at `time`.
    pub fn between(before: &Self, after: &Self, time: f64) -> Self {
        let span = after.time - before.time;
        let x = if span > 0.0 { (time - before.time) / span } else { 0.0 };
        let (rise, begin, end) = (after.position - before.position, before.rate * span, after.rate * span);
        let (second, third) = (rise * 3.0 - begin * 2.0 - end, begin + end - rise * 2.0);
        let slope = begin + (second * 2.0 + third * (3.0 * x)) * x;
        Self {
            time,
            position: before.position + (begin + (second + third * x) * x) * x,
            rate: if span > 0.0 { slope / span } else { before.rate },
        }
    }
}

/// Nodes in one direction of time, the start first.
struct Side {
    course: Course,
    nodes: Vec<Node>,
}

/// A world line as far as it was asked for.
pub struct WorldLineTable {
    /// The future, then the past.
    sides: [Side; 2],
}

impl WorldLineTable {
    /// Errors: as `world_line`.
    pub fn new(a: f64, body: &Body) -> Result<Self> {
        let (line, start) = Line::new(a, body, &[DVec3::X, DVec3::Y, DVec3::Z])?;
        // Lines are integrated in Doran's chart, whatever the body is told in, and told in it here.
        let line = Line { clock: Clock::Rain, ..line };
        let side = |past: bool| -> Result<Side> {
            let course = Course { line, past, from: start, to: start, h: 0.0, end: None, steps: u32::MAX };
            let mut nodes = with_room(ROOM, "the nodes of a world line")?;
            push(&mut nodes, course.node()?, "the nodes of a world line")?;
            Ok(Side { course, nodes })
        };
        Ok(Self { sides: [side(false)?, side(true)?] })
    }

    /// The longest time from the start that `MOST_NODES` can reach: a body of E < 1 comes no farther out than 2 / (1 -
    /// E^2), where its nodes are farthest apart; each may be a step longer than the spacing.
    pub fn longest(&self) -> f64 {
        let e2 = self.sides[0].course.line.c.energy.powi(2);
        let farthest = if e2 < 1.0 { 2.0 / (1.0 - e2) } else { f64::INFINITY };
        2.0 * SPACING * MOST_NODES as f64 * farthest.max(LEAST_SPACED).powf(1.5)
    }

    /// The nodes into the past or the future as far as they are known, the start first.
    pub fn nodes(&self, past: bool) -> &[Node] {
        &self.sides[usize::from(past)].nodes
    }

    /// Why the line goes no farther in a direction; `None` while more may be known.
    pub fn end(&self, past: bool) -> Option<End> {
        self.sides[usize::from(past)].course.end
    }

    /// Makes the line longer in a direction until `enough` of its outermost node, or the line ends. Whether it is so
    /// long then; no, if it would have more than `MOST_NODES`. Errors: OUT_OF_MEMORY.
    pub fn extend(&mut self, past: bool, enough: impl Fn(&Node) -> bool) -> Result<bool> {
        let Side { course, nodes } = &mut self.sides[usize::from(past)];
        loop {
            let Some(last) = nodes.last().copied() else { return Ok(false) };
            if course.end.is_some() || enough(&last) {
                return Ok(true);
            }
            if nodes.len() >= MOST_NODES {
                return Ok(false);
            }
            let spacing = SPACING * last.position.length().max(LEAST_SPACED).powf(1.5);
            // No step is counted: nodes are, of which each has some three.
            course.advance(f64::INFINITY)?;
            while (course.time() - last.time).abs() < spacing && course.end.is_none() {
                course.advance(f64::INFINITY)?;
            }
            push(nodes, course.node()?, "the nodes of a world line")?;
        }
    }
}

impl Course {
    /// T at the end of the last step.
    fn time(&self) -> f64 {
        self.line.time + self.line.offsets.time - self.to.state.delay
    }

    /// The end of the last step.
    fn node(&self) -> Result<Node> {
        let Body { position, velocity, time, .. } = self.line.event(&self.to, None)?.body;
        Ok(Node { time, position, rate: chart_rate(self.line.c.a, position, velocity) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::geodesic::Clock;
    use crate::physics::world_line::world_line;
    use glam::dvec3;

    fn bodies() -> [(f64, Body); 3] {
        let eccentric = Body {
            clock: Clock::Coordinate,
            position: dvec3(9.0, 0.0, 2.0),
            velocity: dvec3(0.05, 0.1, 0.36),
            time: 7.0,
        };
        let plunge = Body { clock: Clock::Rain, velocity: dvec3(0.0, 0.1, 0.25), ..eccentric };
        [(0.9, eccentric), (-0.5, plunge), (0.0, Body { velocity: dvec3(0.7, 0.1, 0.1), ..eccentric })]
    }

    /// Places between nodes against the line itself, both ways.
    #[test]
    fn tables_are_world_lines() {
        for (a, body) in bodies() {
            let mut table = WorldLineTable::new(a, &body).unwrap();
            let start = table.nodes(false)[0].time;
            assert!(table.extend(false, |node| node.time > start + 400.0).unwrap());
            assert!(table.extend(true, |node| node.time < start - 400.0).unwrap());
            // Proper times of which the events lie within 400 M; the line told in Doran's chart.
            let rain = Body { clock: Clock::Rain, position: table.nodes(false)[0].position, ..body };
            let velocity = crate::physics::rain_motion::rain_velocity(a, rain.position, table.nodes(false)[0].rate);
            let rain = Body { velocity, time: start, ..rain };
            let times = [-230.3, -77.7, -3.01, 0.0, 0.77, 11.1, 64.2, 190.0];
            let mut compared = 0;
            for event in world_line(a, &rain, &[DVec3::X; 3], &times).unwrap().iter().filter(|e| e.end.is_none()) {
                let nodes = table.nodes(event.proper_time < 0.0);
                let at = nodes.partition_point(|node| (node.time - start).abs() <= (event.body.time - start).abs());
                if at == nodes.len() {
                    continue;
                }
                let (near, far) = (&nodes[at - 1], &nodes[at]);
                let pair = if near.time < far.time { [near, far] } else { [far, near] };
                let found = Node::between(pair[0], pair[1], event.body.time);
                let r = event.body.position.length();
                assert!((found.position - event.body.position).length() < 1e-5 * r, "{a} {event:?}: {found:?}");
                let rate = chart_rate(a, event.body.position, event.body.velocity);
                assert!((found.rate - rate).length() < 1e-4, "{a} {event:?}: {found:?} {rate}");
                compared += 1;
            }
            assert!(compared >= 5, "{compared} of {a}");
        }
    }

    /// A plunge ends at the inner horizon, and what was known before does not depend on how it was asked for.
    #[test]
    fn tables_end_where_lines_do() {
        let (a, body) = bodies()[1];
        let body = Body { position: dvec3(4.0, 0.0, 0.5), velocity: dvec3(-0.3, 0.0, 0.1), ..body };
        let [mut whole, mut parts] = [(), ()].map(|()| WorldLineTable::new(a, &body).unwrap());
        assert!(whole.extend(false, |_| false).unwrap());
        assert_eq!(whole.end(false), Some(End::InnerHorizon));
        for i in 0..40 {
            assert!(parts.extend(false, |node| node.time > body.time + f64::from(i)).unwrap());
        }
        assert_eq!(whole.nodes(false), parts.nodes(false));
        let (a, bound) = bodies()[0];
        let longest = WorldLineTable::new(a, &bound).unwrap().longest();
        assert!((1e4..1e7).contains(&longest), "{longest}");
        assert_eq!(whole.end(true), None);
    }
}
