// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where the centre of a hot spot in free fall is, about the time of a frame. Mirrored by shaders/emit/free_spot.wgsl,
//! which reads it from a table. Knows no density and no light.
//!
//! The centre's world line is told in Doran's chart, which goes on through the horizon as the body does: a spot that
//! falls in is seen to fade in the time that its light takes, and leaves nothing behind.

use super::bands::When;
use super::shape::smooth_step;
use crate::allocate::collected;
use crate::physics::geodesic::Clock;
use crate::physics::orbit::horizon_outer;
use crate::physics::rain::OffsetSeries;
use crate::physics::world_line::Body;
use crate::physics::world_line::table::{Node, WorldLineTable};
use glam::DVec3;
use std::sync::{Arc, Mutex, PoisonError};

/// Places of the centre in the table of the shaders.
pub const TABLE_NODES: usize = 512;
/// A spot is not shown while its centre is farther out, M.
pub const FARTHEST: f64 = 1e4;
/// Light that is seen at a time left the neighbourhood of r at most r + `EARLIER` before, and r + `LATER` after, it
/// would have passed the hole: two turns about the hole, the delay of light that passes it closely, and what lingers
/// at the horizon. M.
const EARLIER: f64 = 140.0;
const LATER: f64 = 40.0;
/// Where the two clocks are compared: beside the horizon t has no end.
const LEAST_COMPARED: f64 = 1.05;
/// The time, in sizes, in which a spot goes whose centre has come to the end of its line.
const GOES: f64 = 2.0;
/// World lines that are kept for frames to come.
const KEPT: usize = 16;

/// The centre at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centre {
    /// The place in Doran's chart, M, and its change with T.
    pub position: DVec3,
    pub rate: DVec3,
    /// The share of the spot that is there: 1, but after the end of its line.
    pub share: f64,
}

/// The centre about the time of a frame.
#[derive(Clone, Debug)]
pub struct FreeCentre {
    /// In the order of time, one at least; times are T less that of the frame.
    nodes: Vec<Node>,
    /// Whether the line begins with the first of them, and ends with the last.
    ends: [bool; 2],
    /// The time in which it goes there.
    goes: f64,
    /// Its r at the time of the frame, M.
    pub r: f64,
    /// The rain time T that goes by at the centre while t does, over the time that a shutter is open.
    pub pace: f64,
}

/// A world line by what it begins with.
type Key = (u64, Clock, [u64; 7]);

/// The world lines of the spots that were shown last, the last one first.
static LINES: Mutex<Vec<(Key, Arc<Mutex<WorldLineTable>>)>> = Mutex::new(Vec::new());

fn table_of(spin: f64, body: &Body) -> Option<Arc<Mutex<WorldLineTable>>> {
    let ([x, y, z], [u, v, w]) = (body.position.to_array(), body.velocity.to_array());
    let key = (spin.to_bits(), body.clock, [x, y, z, u, v, w, body.time].map(f64::to_bits));
    let mut lines = LINES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(place) = lines.iter().position(|(kept, _)| *kept == key) {
        lines[..=place].rotate_right(1);
    } else {
        let table = WorldLineTable::new(spin, body).ok()?;
        lines.truncate(KEPT - 1);
        lines.insert(0, (key, Arc::new(Mutex::new(table))));
    }
    lines.first().map(|(_, table)| table.clone())
}

/// The nodes of a table in the order of time, by number.
struct Ordered<'a> {
    past: &'a [Node],
    future: &'a [Node],
}

impl Ordered<'_> {
    fn len(&self) -> usize {
        self.past.len() + self.future.len() - 1
    }

    fn node(&self, i: usize) -> &Node {
        // The start is the first of both.
        let before = self.past.len() - 1;
        if i < before { &self.past[before - i] } else { &self.future[i - before] }
    }

    /// The first node of which `is_later` holds, as it does of all after it; their number if it holds of none.
    fn first(&self, is_later: impl Fn(&Node) -> bool) -> usize {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = low + (high - low) / 2;
            (low, high) = if is_later(self.node(middle)) { (low, middle) } else { (middle + 1, high) };
        }
        low
    }
}

impl FreeCentre {
    /// About the moment `when`: as far as light comes from that is seen at once, or if it is not delayed, at that time
    /// itself. `None`: the centre is nowhere then, or nowhere near.
    pub fn new(spin: f64, body: &Body, size: f64, series: &OffsetSeries, when: &When) -> Option<Self> {
        let When { time, delayed, shutter, .. } = *when;
        let table = table_of(spin, body)?;
        let mut table = table.lock().unwrap_or_else(PoisonError::into_inner);
        if (time - table.nodes(false).first()?.time).abs() > table.longest() + EARLIER + 0.5 * shutter {
            return None;
        }
        let r_plus = horizon_outer(spin);
        // t of a node less the frame's, and its r; where t has no end, as if it were outside.
        let since = |node: &Node| {
            let r = node.position.length();
            let compared = r.max(LEAST_COMPARED * r_plus);
            let offsets = series.at(1.0 / compared, 1.0 - r_plus / compared);
            (node.time - offsets.time - time, r)
        };
        let [earlier, later] = if delayed { [EARLIER, LATER] } else { [0.0; 2] }.map(|beside| beside + 0.5 * shutter);
        let reach = if delayed { 1.0 } else { 0.0 };
        let is_before = |node: &Node| {
            let (since, r) = since(node);
            since < -reach * r - earlier
        };
        let is_after = |node: &Node| {
            let (since, r) = since(node);
            // From beyond the observer light comes the later, the farther it is.
            since > reach * r.min(2.0 * when.reference_delay - r) + later
        };
        let reaches = [table.extend(false, is_after).ok()?, table.extend(true, is_before).ok()?];
        if !reaches[0] && !is_after(table.nodes(false).last()?) || !reaches[1] && !is_before(table.nodes(true).last()?)
        {
            return None;
        }
        let ends = [table.end(true).is_some(), table.end(false).is_some()];
        let all = Ordered { past: table.nodes(true), future: table.nodes(false) };
        let now = Self::at_time(&all, |node| since(node).0);
        let beside = |moment: f64| Self::at_time(&all, |node| since(node).0 - moment).time;
        let pace = if shutter > 0.0 { (beside(0.5 * shutter) - beside(-0.5 * shutter)) / shutter } else { 1.0 };
        // In the time of one frame, an end that has come before may still be seen to go.
        if delayed && (is_after(all.node(0)) || is_before(all.node(all.len() - 1))) {
            return None;
        }
        // One node before all that is asked for, and one behind it.
        let begin = all.first(|node| !is_before(node)).saturating_sub(1);
        let end = (all.first(is_after) + 1).min(all.len());
        let is_near = |node: &Node| node.position.length() <= FARTHEST;
        let (begin, end) = ((begin..end).find(|i| is_near(all.node(*i)))?, end);
        let end = (begin..end).find(|i| !is_near(all.node(*i))).unwrap_or(end);
        let ends = [ends[0] && begin == 0, ends[1] && end == all.len()];
        let origin = if delayed { time } else { now.time };
        let nodes = (begin..end).map(|i| Node { time: all.node(i).time - origin, ..*all.node(i) });
        let nodes = collected(nodes, "a hot spot's places").ok()?;
        Some(Self { nodes, ends, goes: GOES * size, r: now.position.length(), pace })
    }

    /// The place at which `since` is 0, which grows along the line; where it is so at none, the end that is nearest,
    /// at the time at which it would be.
    fn at_time(all: &Ordered<'_>, since: impl Fn(&Node) -> f64) -> Node {
        let after = all.first(|node| since(node) > 0.0);
        if after == 0 || after == all.len() {
            let end = all.node(after.min(all.len() - 1));
            return Node { time: end.time - since(end), ..*end };
        }
        let (from, to) = (all.node(after - 1), all.node(after));
        let (mut low, mut high) = (from.time, to.time);
        // Halves: 1e-12 of the time between two nodes.
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            (low, high) = if since(&Node::between(from, to, middle)) > 0.0 { (low, middle) } else { (middle, high) };
        }
        Node::between(from, to, 0.5 * (low + high))
    }

    /// The centre at `later`, T less that of the frame. `None`: it is nowhere.
    pub fn at(&self, later: f64) -> Option<Centre> {
        let (first, last) = (self.nodes.first()?, self.nodes.last()?);
        let beyond = (later - last.time).max(first.time - later);
        if beyond > 0.0 {
            let (end, ends) = if later > last.time { (last, self.ends[1]) } else { (first, self.ends[0]) };
            let share = 1.0 - smooth_step([0.0, self.goes], beyond);
            return (ends && share > 0.0).then_some(Centre { position: end.position, rate: end.rate, share });
        }
        let after = self.nodes.partition_point(|node| node.time <= later).clamp(1, self.nodes.len().max(2) - 1);
        let there = match &self.nodes[..] {
            [only] => *only,
            nodes => Node::between(&nodes[after - 1], &nodes[after], later),
        };
        Some(Centre { position: there.position, rate: there.rate, share: 1.0 })
    }

    /// The times between which it is anywhere, T less that of the frame.
    pub fn times(&self) -> [f64; 2] {
        let [begin, end] = [self.nodes.first(), self.nodes.last()].map(|node| node.map_or(0.0, |node| node.time));
        let goes = |ends: bool| if ends { self.goes } else { 0.0 };
        [begin - goes(self.ends[0]), end + goes(self.ends[1])]
    }

    /// Whether its table is the denser the nearer to its end: what falls in moves the faster, the deeper it is.
    pub fn is_denser_at_end(&self) -> bool {
        self.ends[1]
    }

    /// Its places at `TABLE_NODES` times from the first to the last of `times`, with these.
    pub fn table(&self) -> impl Iterator<Item = (f64, Centre)> {
        let [begin, end] = self.times();
        let nowhere = self.nodes.first().map_or(DVec3::X, |node| node.position);
        let share = move |i: usize| {
            let even = i as f64 / (TABLE_NODES - 1) as f64;
            if self.is_denser_at_end() { 1.0 - (1.0 - even).powi(2) } else { even }
        };
        (0..TABLE_NODES).map(move |i| {
            let later = begin + (end - begin) * share(i);
            (later, self.at(later).unwrap_or(Centre { position: nowhere, rate: DVec3::ZERO, share: 0.0 }))
        })
    }

    /// Between which r it is, and the greatest |cos th|, of places within `cut` of it.
    pub fn reach(&self, cut: f64, horizon: f64) -> ([f64; 2], f64) {
        self.nodes.iter().fold(([f64::INFINITY, 0.0], 0.0), |([low, high], cos), node| {
            let r = node.position.length();
            let nearest = (r - cut).max(horizon);
            let steepest = ((node.position.z.abs() + cut) / nearest).min(1.0);
            ([low.min(nearest), high.max(r + cut)], f64::max(cos, steepest))
        })
    }
}
