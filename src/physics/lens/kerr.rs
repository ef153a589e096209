//! The Kerr lens table: everything about a ray of one eye as a function of its look direction, tabulated in polar
//! coordinates about the critical curve (`critical`), interpolated instead of integrated. Physics alone: knows neither
//! pixels nor threads; callers may spread `Grid::node` and `Grid::flags`, which are one independent task per node and
//! per cell.
//!
//! Coordinates: w(chi) along the curve (`Columns`), periodic, and x = n log2 |t^| with t^ = tan((psi - R(chi)) / 2) /
//! T(chi), T = tan(R / 2) and n nodes per octave: deflections and crossings diverge with ln |psi - R| at the curve.
//! Two branches: outer (t^ > 0, the ray escapes) and inner (captured). Both are continued a few nodes past the point
//! where psi reaches pi or 0, on to the other side of the axis, where everything stays smooth. Interpolation: cubic
//! Lagrange, 4 x 4 nodes.
//!
//! A node is `channels` numbers: the sky direction (chart; 0 when captured), then for every order of crossing U = u S,
//! with u = 1 / r there, continued through infinity to u < 0, and S = (1 - n_r^2)^(1/2) (a straight ray has u S =
//! u_eye sin(angle): u itself diverges like 1 / S for rays that leave radially), and if wanted the unit vector of its
//! azimuth and its delay in a form regular at infinity (`regular_delay`). Tables hold them in f32 and by fours, as
//! interpolation loads them (`Grid::pack`).

use super::critical::{CriticalCurve, Polar};
use super::plane::PlaneImage;
use crate::physics::geodesic::{Constants, State};
use crate::physics::integrator::{Quintic, nystrom_step, step_limit};
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_outer, photon_orbit};
use crate::physics::trace::{CROSSINGS_KEPT, Settings, land};
use arrayvec::ArrayVec;
use glam::{DVec3, Vec3Swizzles, Vec4};
use std::f64::consts::{LN_2, TAU};

/// Rays with |t^| below 2^-`CORE_OCTAVES` are to be integrated: so close to the curve a direction in f32 says little.
pub const CORE_OCTAVES: usize = 10;
/// Rows below the first row of cells in use, and above the row of the axis: what the error estimate's stencil reaches.
pub(crate) const ROWS_BELOW: usize = 2;
pub(crate) const ROWS_ABOVE: usize = 3;
/// Step in sigma: some 1e-7 for a whole ray, typically much less: what f32 resolves.
const STEP: f64 = 0.25;
/// Of crossings and ends, in sigma.
const SLACK: f64 = 1e-8;
/// Sigma for which a ray is followed beyond infinity: longer than one step of the table takes a crossing.
pub(crate) const BEYOND_INFINITY: f64 = 1.0;
/// More than any ray of the grid needs.
const MAX_STEPS: usize = 2000;
/// Eyes nearer than this, in M, have the finer outer branch; it has few octaves then.
const NEAR_EYE: f64 = 15.0;
/// Least epsilon of `Columns`: what lies within this angle of the plane of an eye yet nearer to it is to be integrated.
const NARROWEST_LAYER: f64 = 0.03;
/// Share of the nodes that gather in the layers of `Columns`.
const LAYER_SHARE: f64 = 0.5;
/// Rays are followed to this multiple of `Grid::capture_u`, so that no crossing of the disk has a neighbour without
/// one.
pub(crate) const INWARD: f64 = 1.5;
/// U of a crossing that does not come: the ray is captured before (+), or gone past infinity (-).
pub const NO_CROSSING: f64 = 1e3;
/// Most numbers in one node.
pub const CHANNELS_MOST: usize = SKY + PER_CROSSING * CROSSINGS_KEPT;
const SKY: usize = 3;
const PER_CROSSING: usize = 4;
const PER_QUAD: usize = 4;
/// Bit of a cell's flags: rays in it are to be integrated. Bits 0 .. 15: a crossing of that order may hit the disk.
pub const DIRECT: u32 = 1 << 31;
/// Another: so they are for their crossings; the sky may be interpolated.
pub const POOR_CROSSINGS: u32 = 1 << 30;
/// Error that a cell may have: rad of look direction for the sky, relative to 1 + conditioning for crossings.
pub const TOLERANCE: f64 = 1e-6;
/// The same for azimuths, rad, and delays, relative to the orbital time: they move a pattern along its orbit.
pub const PATTERN_TOLERANCE: f64 = 1e-5;

pub type Node = ArrayVec<f64, CHANNELS_MOST>;

/// Most fours of numbers in one node.
const QUADS_MOST: usize = 1 + CROSSINGS_KEPT;

/// A node as tables hold it.
pub type PackedNode = ArrayVec<Vec4, QUADS_MOST>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Rays that escape.
    Outer,
    /// Rays that fall in.
    Inner,
}

/// Spacing of the nodes.
#[derive(Clone, Copy, Debug)]
pub struct Resolution {
    /// Over chi in [0, 2 pi); at least 8.
    pub chi_nodes: usize,
    /// Of |t^|, in the outer and the inner branch.
    pub nodes_per_octave: [usize; 2],
}

impl Resolution {
    /// What keeps all but about 1 % of the rays about the shadow interpolated: rows are wide at |t^| = 1, which
    /// matters inside the shadow, and behind an eye near the disk.
    pub fn for_eye(frame: &LocalFrame) -> Self {
        Self { chi_nodes: 512, nodes_per_octave: [if frame.r < NEAR_EYE { 32 } else { 16 }, 32] }
    }
}

/// Which crossings of the equatorial plane are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossings {
    /// Orders 0 .. `orders`, at most `CROSSINGS_KEPT`; 0: the sky alone.
    pub orders: usize,
    /// Only crossings with 1 / r in [low, high] matter; high at most 1 / (0.99 photon orbit).
    pub disk_u: [f64; 2],
    /// Azimuth and delay too.
    pub pattern: bool,
}

/// The coordinate along the critical curve: w = (chi + v) / 2 with tan v = tan chi / epsilon, epsilon = |cot th| of
/// the eye.
///
/// A ray that starts at the angle chi to the plane first meets it after the orbit angle atan2(|cot th|, sin chi) (spin
/// 0): for an eye near the plane that changes from 0 to pi within epsilon about chi = 0 and pi. Half of the nodes go
/// there, in even steps of v.
#[derive(Clone, Debug)]
struct Columns {
    epsilon: f64,
    /// Share of the nodes that v spaces.
    share: f64,
    /// chi at the nodes, in [0, 2 pi).
    chi: Vec<f64>,
}

impl Columns {
    fn new(frame: &LocalFrame, count: usize) -> Self {
        Self::spaced((frame.cos / frame.sin).abs().clamp(NARROWEST_LAYER, 1.0), LAYER_SHARE, count)
    }

    fn spaced(epsilon: f64, share: f64, count: usize) -> Self {
        let mut columns = Self { epsilon, share, chi: Vec::new() };
        columns.chi = (0..count).map(|i| columns.angle(TAU * i as f64 / count as f64)).collect();
        columns
    }

    /// w in [0, 2 pi) and dw/dchi at `chi` in (-pi, pi].
    fn coordinate(&self, chi: f64, (sin, cos): (f64, f64)) -> (f64, f64) {
        let w = (1.0 - self.share) * chi + self.share * sin.atan2(self.epsilon * cos);
        let slope = 1.0 - self.share + self.share * self.epsilon / ((self.epsilon * cos).powi(2) + sin * sin);
        (if w < 0.0 { w + TAU } else { w }, slope)
    }

    /// chi at `w`, both in [0, 2 pi), by halving: w is steep.
    fn angle(&self, w: f64) -> f64 {
        let (mut low, mut high) = (0.0, TAU);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            let (sin, cos) = middle.sin_cos();
            if self.coordinate(sin.atan2(cos), (sin, cos)).0 <= w { low = middle } else { high = middle }
        }
        low
    }
}

/// Coordinates, size and contents of a table: all that nodes and cells are computed from.
#[derive(Clone, Debug)]
pub struct Grid {
    frame: LocalFrame,
    curve: CriticalCurve,
    columns: Columns,
    /// Of every column: the unit vector from the centre towards chi, and T.
    spokes: Vec<(DVec3, f64)>,
    /// Outer, inner; so `rows`.
    nodes_per_octave: [f64; 2],
    wanted: Crossings,
    /// Where drag and delay end.
    capture_u: f64,
    rows: [usize; 2],
}

/// A cell of the table, its lower corner's indices, and the fractions inside it.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub branch: Branch,
    pub column: usize,
    pub row: usize,
    pub column_fraction: f64,
    pub row_fraction: f64,
    /// tan((psi - R) / 2): infinite at the critical curve's antipode.
    pub t: f64,
    /// S and its gradient.
    pub side: f64,
    pub side_gradient: DVec3,
    /// Gradients, by the look direction (components), of the grid coordinates column and row.
    pub column_gradient: DVec3,
    pub row_gradient: DVec3,
}

impl Grid {
    /// `None` when the eye is too near the photon region or too far (`CriticalCurve::new`).
    pub fn new(frame: &LocalFrame, resolution: Resolution, wanted: Crossings) -> Option<Self> {
        let curve = CriticalCurve::new(frame)?;
        let columns = Columns::new(frame, resolution.chi_nodes.max(8));
        let spokes = columns.chi.iter().map(|chi| (curve.radial(*chi), curve.at(*chi).0)).collect();
        let nodes_per_octave = resolution.nodes_per_octave.map(|n| n.max(1) as f64);
        // t^ of the axis is 1 / T^2 outside and -1 inside.
        let octaves = -2.0 * curve.tangent_range()[0].log2();
        let rows = |octaves: f64, per_octave: f64| {
            let to_axis = ((CORE_OCTAVES as f64 + octaves) * per_octave).ceil().max(1.0);
            to_axis as usize + ROWS_BELOW + ROWS_ABOVE + 1
        };
        let wanted = Crossings { orders: wanted.orders.min(CROSSINGS_KEPT), ..wanted };
        // Circular orbits end at the photon orbit; beside the horizon the drag diverges.
        let spin = frame.a.abs();
        let capture_u = (1.0 / (0.99 * photon_orbit(spin))).min(0.99 / horizon_outer(spin));
        let rows = [rows(octaves, nodes_per_octave[0]), rows(0.0, nodes_per_octave[1])];
        Some(Self { frame: *frame, curve, columns, spokes, nodes_per_octave, wanted, capture_u, rows })
    }

    pub fn curve(&self) -> &CriticalCurve {
        &self.curve
    }

    /// 1/r beyond which an inward ray of a node is captured.
    pub fn capture_u(&self) -> f64 {
        self.capture_u
    }

    /// Epsilon of the coordinate along the critical curve.
    pub fn epsilon(&self) -> f64 {
        self.columns.epsilon
    }

    /// chi of each column, in [0, 2 pi).
    pub fn column_angles(&self) -> &[f64] {
        &self.columns.chi
    }

    /// Nodes along chi.
    pub fn columns(&self) -> usize {
        self.columns.chi.len()
    }

    /// Nodes along x.
    pub fn rows(&self, branch: Branch) -> usize {
        self.rows[branch as usize]
    }

    /// Numbers in a node.
    pub fn channels(&self) -> usize {
        SKY + self.per_crossing() * self.wanted.orders
    }

    fn per_crossing(&self) -> usize {
        if self.wanted.pattern { PER_CROSSING } else { 1 }
    }

    /// |t^| at a row.
    fn reduced_tangent(&self, branch: Branch, row: f64) -> f64 {
        let octaves = (row - ROWS_BELOW as f64) / self.nodes_per_octave[branch as usize];
        (octaves - CORE_OCTAVES as f64).exp2()
    }

    /// The look direction at a column and a row, which may lie between nodes: tan(psi / 2) = (T + t) / (1 - T t).
    pub fn direction(&self, branch: Branch, column: usize, row: f64) -> DVec3 {
        let (radial, t_critical) = self.spokes[column % self.columns()];
        let away = self.reduced_tangent(branch, row) * t_critical;
        let t = if branch == Branch::Outer { away } else { -away };
        // Sine and cosine of psi / 2 times their common length: psi may be pi.
        let (sin, cos) = (t_critical + t, 1.0 - t_critical * t);
        let inverse = 1.0 / (sin * sin + cos * cos);
        self.curve.k * ((cos * cos - sin * sin) * inverse) + radial * (2.0 * sin * cos * inverse)
    }

    /// Where the unit look direction `n` lies; `None`: too close to the critical curve.
    ///
    /// tan((psi - R) / 2) = (s - T (1 + c)) / (1 + c + T s), with c, s = cos, sin psi and 1 + c = s^2 / (1 - c) beyond
    /// 90 deg.
    pub fn locate(&self, n: DVec3) -> Option<Place> {
        let p = self.curve.polar(n);
        let (t_critical, slope) = self.curve.at(p.chi);
        let one_plus_cos = if p.cos < 0.0 { p.sin * p.sin / (1.0 - p.cos) } else { 1.0 + p.cos };
        let t = (p.sin - t_critical * one_plus_cos) / (one_plus_cos + t_critical * p.sin).max(f64::MIN_POSITIVE);
        // The antipode of k: 0 / 0.
        let t = if one_plus_cos > 0.0 { t } else { 1.0 / t_critical };
        let branch = if t > 0.0 { Branch::Outer } else { Branch::Inner };
        let octaves = (t / t_critical).abs().log2() + CORE_OCTAVES as f64;
        if octaves.is_nan() || octaves < 0.0 {
            return None;
        }
        let row = octaves * self.nodes_per_octave[branch as usize] + ROWS_BELOW as f64;
        let row_floor = (row.floor() as usize).min(self.rows(branch) - ROWS_ABOVE - 1);
        let (w, w_slope) = self.columns.coordinate(p.chi, (p.sin_chi, p.cos_chi));
        let column = w * self.columns() as f64 / TAU;
        let column_floor = (column as usize).min(self.columns() - 1);
        let side = side(n);
        let (column_gradient, x_gradient) = self.gradients(&p, w_slope, t, (t_critical, slope));
        Some(Place {
            branch,
            column: column_floor,
            row: row_floor,
            column_fraction: column - column_floor as f64,
            row_fraction: row - row_floor as f64,
            t,
            side,
            side_gradient: n.with_x(0.0) / side,
            column_gradient,
            row_gradient: x_gradient * (self.nodes_per_octave[branch as usize] / LN_2),
        })
    }

    /// d chi = along . dn / sin psi; dt = (1 + t^2) / 2 (d psi - d R), d R = 2 d T / (1 + T^2), d ln |t^| = dt / t -
    /// dT / T.
    fn gradients(&self, p: &Polar, w_slope: f64, t: f64, (t_critical, slope): (f64, f64)) -> (DVec3, DVec3) {
        let chi = p.along / p.sin.max(1e-9);
        let t_critical_gradient = chi * slope;
        let radius = t_critical_gradient * (2.0 / (1.0 + t_critical * t_critical));
        let t_gradient = (p.outward - radius) * (0.5 * (1.0 + t * t));
        let x = t_gradient / t - t_critical_gradient / t_critical;
        (chi * (w_slope * self.columns() as f64 / TAU), x)
    }

    /// The content of a node, by integration of its ray.
    pub fn node(&self, branch: Branch, column: usize, row: usize) -> Node {
        let n = self.direction(branch, column, row as f64);
        let mut ray = NodeRay::new(&self.wanted, self.capture_u, side(n));
        if let Some((c, start)) = self.frame.start(n) {
            ray.follow(&c, &start);
        }
        ray.finish()
    }

    /// Flags of the cell whose lower corner is (`column`, `row`), from the nodes about it: `node(column, row)` with
    /// columns from `column` - 2 (wrapped) to `column` + 3, rows alike. Only cells with `row` in `ROWS_BELOW` .. rows
    /// - `ROWS_ABOVE` hold rays.
    pub fn flags<'a>(
        &self,
        branch: Branch,
        column: usize,
        row: usize,
        node: impl Fn(usize, usize) -> &'a [f64],
    ) -> u32 {
        let columns = self.columns();
        let at = |i: usize, j: usize| node((column + columns + i - 2) % columns, row + j - 2);
        let node_side = |i, j| side(self.direction(branch, column + columns + i - 2, (row + j - 2) as f64));
        let sides = std::array::from_fn(|i| std::array::from_fn(|j| node_side(i + 1, j + 1)));
        let at = std::array::from_fn(|i| std::array::from_fn(|j| at(i, j)));
        let patch = Patch { at, sides, angles: self.cell_angles(branch, column, row) };
        let mut flags = 0;
        if branch == Branch::Outer && !patch.sky_is_good() {
            flags |= DIRECT;
        }
        for order in 0..self.wanted.orders {
            let channel = SKY + order * self.per_crossing();
            match patch.crossing(channel, &self.wanted) {
                Hit::No => {}
                Hit::Possible => flags |= 1 << order,
                Hit::Poor => flags |= 1 << order | POOR_CROSSINGS,
            }
        }
        flags
    }

    /// Angles on the eye's sky, rad: a cell's extent along chi and along x, and sin R.
    fn cell_angles(&self, branch: Branch, column: usize, row: usize) -> CellAngles {
        let (i, j) = (column, row as f64);
        let here = self.direction(branch, i, j + 0.5);
        let t = self.spokes[i].1;
        CellAngles {
            // At the axis chi means nothing; the row's own extent bounds the cell there.
            column: here.distance(self.direction(branch, i + 1, j + 0.5)),
            row: self.direction(branch, i, j).distance(self.direction(branch, i, j + 1.0)),
            critical: 2.0 * t / (1.0 + t * t),
        }
    }
}

/// S of a look direction: the sine of its angle to the radius; not 0.
fn side(n: DVec3) -> f64 {
    n.yz().length().max(1e-12)
}

/// 1 / u - 2 ln(|u| / u_eye) is what the delay diverges like at infinity, E = 1; without it, it passes infinity
/// smoothly (but for terms of u^2 ln |u|). And 1 / u_eye is what it is from far, which leaves little to round in
/// tables.
pub fn divergent_delay(u: f64, u_eye: f64) -> f64 {
    1.0 / u + 1.0 / u_eye - 2.0 * (u / u_eye).abs().max(f64::MIN_POSITIVE).ln()
}

/// The delay less `divergent_delay`, from the state at a crossing: with `Constants::delay`,
/// 2 (1 + u') ln(|u| / u_eye) - (1 + u') / u + the integral, and (1 + u') / u from u'^2 = P(u) without cancellation.
fn regular_delay(c: &Constants, eye: &State, there: &State) -> f64 {
    let (u, du) = (there.u, there.du);
    let below = u * (c.a2e2 - c.k + u * (2.0 * c.b - u * (c.a * c.a * c.carter)));
    let ratio = if du < 0.0 { -below / (1.0 - du) } else { (1.0 + du) / u };
    let logarithm = (u / c.u_eye).abs().max(f64::MIN_POSITIVE).ln();
    2.0 * ratio * u * logarithm - ratio + (eye.du - 1.0) / eye.u + there.delay - eye.delay
}

/// One node's ray on its way.
struct NodeRay<'a> {
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
        // As in `trace`: a start in the plane is no crossing.
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
            // Inside, the ray is captured however it goes on.
            let captured = next.u >= INWARD * self.capture_u || (inside && next.du < 0.0);
            let complete = (self.sky.is_some() || inside) && self.crossings.len() >= self.wanted.orders;
            if complete || captured || beyond > BEYOND_INFINITY {
                return;
            }
            state = next;
        }
    }

    fn cross(&mut self, c: &Constants, eye: &State, settings: &Settings, (from, to, h): (&State, &State, f64)) {
        if self.crossings.len() >= self.wanted.orders {
            return;
        }
        let guess = h * Quintic::of_n_z(c, from, to, h).root();
        let (mut state, _) = land(c, settings, from, guess, SLACK, |s| (s.n.z, s.dn.z));
        if from.u >= self.capture_u {
            (state.drag, state.delay) = (from.drag, from.delay);
        }
        let delay = if self.wanted.pattern { regular_delay(c, eye, &state) } else { 0.0 };
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

struct CellAngles {
    column: f64,
    row: f64,
    critical: f64,
}

/// What a cell's crossing of one order can do.
enum Hit {
    No,
    Possible,
    /// Possible, and not to be interpolated.
    Poor,
}

/// The 6 x 6 nodes about a cell; the cell lies between indices 2 and 3.
struct Patch<'a> {
    at: [[&'a [f64]; 6]; 6],
    /// S at the inner 4 x 4 nodes.
    sides: [[f64; 4]; 4],
    angles: CellAngles,
}

impl Patch<'_> {
    fn value(&self, channel: usize, i: usize, j: usize) -> f64 {
        self.at[i][j][channel]
    }

    /// Error of cubic interpolation at mid-cell, 3/128 of the fourth difference (the greater one of both centres),
    /// summed over both directions, on the cell's four edges' worst.
    fn error(&self, channel: usize) -> f64 {
        let fourth = |f: &dyn Fn(usize) -> f64| {
            let at = |c: usize| (f(c - 2) - 4.0 * f(c - 1) + 6.0 * f(c) - 4.0 * f(c + 1) + f(c + 2)).abs();
            at(2).max(at(3))
        };
        let column = |j: usize| fourth(&|i| self.value(channel, i, j));
        let row = |i: usize| fourth(&|j| self.value(channel, i, j));
        3.0 / 128.0 * (column(2).max(column(3)) + row(2).max(row(3)))
    }

    /// u at one of the inner 4 x 4 nodes.
    fn u(&self, channel: usize, i: usize, j: usize) -> f64 {
        self.value(channel, i, j) / self.sides[i - 1][j - 1]
    }

    /// Change per rad of look direction, from changes between nodes: the smaller one over the cell of the greater one
    /// of both directions.
    fn stretch(&self, change: impl Fn((usize, usize), (usize, usize)) -> f64) -> f64 {
        let row = change((2, 2), (2, 3)).min(change((3, 2), (3, 3))) / self.angles.row;
        let column = change((2, 2), (3, 2)).min(change((2, 3), (3, 3))) / self.angles.column.max(1e-12);
        row.max(column)
    }

    /// The same of the vector of some channels.
    fn vector_stretch(&self, channels: std::ops::Range<usize>) -> f64 {
        let change = |k, a: (usize, usize), b: (usize, usize)| self.value(k, a.0, a.1) - self.value(k, b.0, b.1);
        self.stretch(|a, b| channels.clone().map(|k| change(k, a, b).powi(2)).sum::<f64>().sqrt())
    }

    fn sky_is_good(&self) -> bool {
        let escaped = (0..6).all(|i| (0..6).all(|j| (0..SKY).any(|k| self.value(k, i, j) != 0.0)));
        let error = (0..SKY).map(|k| self.error(k).powi(2)).sum::<f64>().sqrt();
        // Written so that NaN is not good.
        escaped && error <= TOLERANCE * self.vector_stretch(0..SKY).max(1.0)
    }

    fn crossing(&self, channel: usize, wanted: &Crossings) -> Hit {
        let [low, high] = self.range(channel);
        let [near, far] = [wanted.disk_u[1], wanted.disk_u[0]];
        if low > near || high < far {
            return Hit::No;
        }
        let inside = |i: usize, j: usize| self.value(channel, i, j).abs() < NO_CROSSING;
        if !(1..5).all(|i| (1..5).all(|j| inside(i, j))) {
            return Hit::Poor;
        }
        let middle = 0.5 * (self.u(channel, 2, 2) + self.u(channel, 3, 3));
        let size = middle.clamp(far, near).max(f64::MIN_POSITIVE);
        // Relative change for a relative change of the impact parameter.
        let stretch = self.stretch(|a, b| (self.u(channel, a.0, a.1) - self.u(channel, b.0, b.1)).abs());
        let conditioning = 1.0 + self.angles.critical * stretch / size;
        let least_side = self.sides[1][1].min(self.sides[1][2]).min(self.sides[2][1]).min(self.sides[2][2]);
        let radius_good = self.error(channel) <= TOLERANCE * conditioning * size * least_side;
        let pattern_good = !wanted.pattern || self.pattern_is_good(channel, size);
        if radius_good && pattern_good { Hit::Possible } else { Hit::Poor }
    }

    fn pattern_is_good(&self, channel: usize, u: f64) -> bool {
        let azimuth = self.error(channel + 1).hypot(self.error(channel + 2));
        let azimuth_conditioning = 1.0 + self.angles.critical * self.vector_stretch(channel + 1..channel + 3);
        // d ph = Omega dt, Omega = r^(-3/2) (Kepler).
        let turn = u * u.sqrt();
        let delay_conditioning = 1.0 + self.angles.critical * turn * self.vector_stretch(channel + 3..channel + 4);
        azimuth <= PATTERN_TOLERANCE * azimuth_conditioning
            && turn * self.error(channel + 3) <= PATTERN_TOLERANCE * delay_conditioning
    }

    /// Least and greatest value over the 4 x 4 nodes of the interpolation, widened by a quarter of their spread:
    /// between the nodes the values may go beyond. Missing crossings count as what they are, but do not widen.
    fn range(&self, channel: usize) -> [f64; 2] {
        let (mut all, mut finite) = ([f64::INFINITY, f64::NEG_INFINITY], [f64::INFINITY, f64::NEG_INFINITY]);
        for (i, j) in (1..5).flat_map(|i| (1..5).map(move |j| (i, j))) {
            let u = self.u(channel, i, j);
            all = [all[0].min(u), all[1].max(u)];
            if self.value(channel, i, j).abs() < NO_CROSSING {
                finite = [finite[0].min(u), finite[1].max(u)];
            }
        }
        let margin = 0.25 * (finite[1] - finite[0]).max(0.0);
        [all[0] - margin, all[1] + margin]
    }
}

/// A look direction in a table, to be interpolated there.
#[derive(Clone, Debug)]
pub struct Seen<'a> {
    grid: &'a Grid,
    pub place: Place,
    flags: u32,
    /// The four nodes about the cell in each of the four rows about it, one after the other.
    rows: [&'a [Vec4]; 4],
    columns: Weights,
    along_rows: Weights,
}

/// The end of an escaping ray.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// Chart, unit.
    pub direction: DVec3,
    by_column: DVec3,
    by_row: DVec3,
}

/// A crossing of the equatorial plane in the disk's range.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    pub order: u32,
    /// Azimuth and delay 0 unless the pattern is wanted.
    pub image: PlaneImage,
    by_column: PlaneImage,
    by_row: PlaneImage,
    by_side: PlaneImage,
}

/// A small change of a place in a table.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    column: f64,
    row: f64,
    side: f64,
}

impl Place {
    /// The change of column, row and S for a small change `dn` of the look direction (components).
    pub fn step(&self, dn: DVec3) -> Step {
        Step { column: self.column_gradient.dot(dn), row: self.row_gradient.dot(dn), side: self.side_gradient.dot(dn) }
    }
}

impl Sky {
    /// The change of the direction for a small `step` (`Place::step`).
    pub fn change(&self, step: &Step) -> DVec3 {
        self.by_column * step.column + self.by_row * step.row
    }
}

impl Crossing {
    /// The change of the image for a small `step` (`Place::step`).
    pub fn change(&self, step: &Step) -> PlaneImage {
        let sum = |f: fn(&PlaneImage) -> f64| {
            step.column * f(&self.by_column) + step.row * f(&self.by_row) + step.side * f(&self.by_side)
        };
        PlaneImage { u: sum(|i| i.u), azimuth: sum(|i| i.azimuth), delay: sum(|i| i.delay) }
    }
}

/// Weights of cubic Lagrange interpolation at nodes -1, 0, 1, 2, and their derivatives.
#[derive(Clone, Copy, Debug)]
struct Weights {
    value: [f32; 4],
    slope: [f32; 4],
}

impl Weights {
    fn new(f: f64) -> Self {
        let (m, p, q) = (f - 1.0, f + 1.0, f - 2.0);
        let value = [-f * m * q / 6.0, p * m * q / 2.0, -p * f * q / 2.0, p * f * m / 6.0];
        let slope = [
            -(3.0 * f * f - 6.0 * f + 2.0) / 6.0,
            (3.0 * f * f - 4.0 * f - 1.0) / 2.0,
            -(3.0 * f * f - 2.0 * f - 2.0) / 2.0,
            (3.0 * f * f - 1.0) / 6.0,
        ];
        Self { value: value.map(|w| w as f32), slope: slope.map(|w| w as f32) }
    }
}

/// Four numbers interpolated, and their derivatives by column and row.
struct Interpolated {
    value: Vec4,
    by_column: Vec4,
    by_row: Vec4,
}

impl Grid {
    /// Fours of numbers in a packed node: the sky, then either a crossing each, or u of four crossings each.
    pub fn quads(&self) -> usize {
        let crossings = if self.wanted.pattern { self.wanted.orders } else { self.wanted.orders.div_ceil(PER_QUAD) };
        1 + crossings
    }

    /// A node as tables hold it.
    pub fn pack(&self, node: &[f64]) -> PackedNode {
        let (sky, crossings) = node.split_at(SKY.min(node.len()));
        let quad = |numbers: &[f64]| {
            Vec4::from_array(std::array::from_fn(|i| numbers.get(i).copied().unwrap_or_default() as f32))
        };
        std::iter::once(sky).chain(crossings.chunks(PER_QUAD)).map(quad).take(QUADS_MOST).collect()
    }

    /// What is seen at `place`, from the cell's flags and rows of packed nodes. `None`: to be integrated.
    pub fn see<'a>(&'a self, place: Place, flags: u32, rows: [&'a [Vec4]; 4]) -> Option<Seen<'a>> {
        if flags & DIRECT != 0 || rows.iter().any(|row| row.len() < 4 * self.quads()) {
            return None;
        }
        let (columns, along_rows) = (Weights::new(place.column_fraction), Weights::new(place.row_fraction));
        Some(Seen { grid: self, place, flags, rows, columns, along_rows })
    }
}

impl Seen<'_> {
    #[inline]
    fn interpolate(&self, quad: usize) -> Interpolated {
        let quads = self.grid.quads();
        let mut sum = Interpolated { value: Vec4::ZERO, by_column: Vec4::ZERO, by_row: Vec4::ZERO };
        for (j, row) in self.rows.into_iter().enumerate() {
            let (mut value, mut by_column) = (Vec4::ZERO, Vec4::ZERO);
            for i in 0..4 {
                let node = row[i * quads + quad];
                value += node * self.columns.value[i];
                by_column += node * self.columns.slope[i];
            }
            sum.value += value * self.along_rows.value[j];
            sum.by_column += by_column * self.along_rows.value[j];
            sum.by_row += value * self.along_rows.slope[j];
        }
        sum
    }

    /// The end of the ray, unless it is captured: the interpolated direction, normalised, and its derivatives at right
    /// angles to it.
    pub fn sky(&self) -> Option<Sky> {
        if self.place.branch == Branch::Inner {
            return None;
        }
        let at = self.interpolate(0);
        let vector = |v: Vec4| v.truncate().as_dvec3();
        let raw = vector(at.value);
        let inverse = 1.0 / raw.length();
        let direction = raw * inverse;
        let across = |v: DVec3| (v - direction * direction.dot(v)) * inverse;
        Some(Sky { direction, by_column: across(vector(at.by_column)), by_row: across(vector(at.by_row)) })
    }

    /// Distance to the critical curve, in the unit that `steps` go at right angles.
    pub fn curve_distance(&self, steps: &[Step; 2]) -> f64 {
        let rows = steps[0].row.hypot(steps[1].row).max(f64::MIN_POSITIVE);
        // Beyond 90 degrees from the curve d ln |t| rises again: its antipode is not near it.
        let t = self.place.t.abs().max(1.0);
        self.grid.nodes_per_octave[self.place.branch as usize] / (LN_2 * rows) * (0.5 * (t + 1.0 / t))
    }

    /// False: only a ray's integration tells its crossings well enough.
    pub fn crossings_are_good(&self) -> bool {
        self.flags & POOR_CROSSINGS == 0
    }

    /// The crossings in the disk's range, in the ray's order.
    pub fn crossings(&self) -> impl Iterator<Item = Crossing> {
        let possible = (0..self.grid.wanted.orders).filter(|order| self.flags >> order & 1 != 0);
        possible.filter_map(|order| self.crossing(order))
    }

    /// The crossing of that order, good or not. `None`: not in the disk's range.
    pub fn crossing(&self, order: usize) -> Option<Crossing> {
        let wanted = &self.grid.wanted;
        let at = self.interpolate(1 + if wanted.pattern { order } else { order / PER_QUAD });
        let lane = if wanted.pattern { 0 } else { order % PER_QUAD };
        let inverse_side = 1.0 / self.place.side;
        let u = f64::from(at.value[lane]) * inverse_side;
        if !(u >= wanted.disk_u[0] && u <= wanted.disk_u[1]) {
            return None;
        }
        let order = order as u32;
        let only = |u: f64| PlaneImage { u, azimuth: 0.0, delay: 0.0 };
        // u = U / S.
        let by_side = -u * inverse_side;
        if !wanted.pattern {
            let by = |v: Vec4| only(f64::from(v[lane]) * inverse_side);
            let [by_column, by_row] = [at.by_column, at.by_row].map(by);
            return Some(Crossing { order, image: only(u), by_column, by_row, by_side: only(by_side) });
        }
        let [_, x, y, delay] = at.value.as_dvec4().to_array();
        // d / du of `divergent_delay`.
        let by_u = -(1.0 / u + 2.0) / u;
        let change = |v: Vec4| {
            let [change, dx, dy, dt] = v.as_dvec4().to_array();
            let du = change * inverse_side;
            PlaneImage { u: du, azimuth: (x * dy - y * dx) / (x * x + y * y), delay: dt + by_u * du }
        };
        Some(Crossing {
            order,
            image: PlaneImage { u, azimuth: y.atan2(x), delay: delay + divergent_delay(u, 1.0 / self.grid.frame.r) },
            by_column: change(at.by_column),
            by_row: change(at.by_row),
            by_side: PlaneImage { u: by_side, azimuth: 0.0, delay: by_u * by_side },
        })
    }
}

/// A whole table.
#[derive(Clone, Debug)]
pub struct KerrLens {
    grid: Grid,
    /// By branch: rows of packed nodes, from the last column over all of them to the first two again, so that every
    /// cell's lie side by side.
    nodes: [Vec<Vec4>; 2],
    flags: [Vec<u32>; 2],
}

/// Columns that a table's row repeats.
const REPEATED: usize = 3;

impl KerrLens {
    /// Builds the table node by node, cell by cell, on this thread.
    pub fn new(frame: &LocalFrame, resolution: Resolution, wanted: Crossings) -> Option<Self> {
        let grid = Grid::new(frame, resolution, wanted)?;
        let nodes = [Branch::Outer, Branch::Inner]
            .map(|branch| -> Vec<f64> { (0..grid.rows(branch)).flat_map(|row| grid.node_row(branch, row)).collect() });
        let flags = [Branch::Outer, Branch::Inner].map(|branch| -> Vec<u32> {
            grid.cell_rows(branch).flat_map(|row| grid.flag_row(branch, row, &nodes[branch as usize])).collect()
        });
        let packed = [Branch::Outer, Branch::Inner].map(|branch| -> Vec<Vec4> {
            (0..grid.rows(branch)).flat_map(|row| grid.packed_row(row, &nodes[branch as usize])).collect()
        });
        Some(Self::assemble(grid, packed, flags))
    }

    /// From what the caller computed for outer and inner branch: `Grid::packed_row` of all rows and `Grid::flag_row`
    /// of all `Grid::cell_rows`, in order.
    pub fn assemble(grid: Grid, nodes: [Vec<Vec4>; 2], flags: [Vec<u32>; 2]) -> Self {
        Self { grid, nodes, flags }
    }

    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The flags of a cell; `DIRECT` where there is none.
    pub fn flags(&self, branch: Branch, column: usize, row: usize) -> u32 {
        let index = row.checked_sub(ROWS_BELOW).map(|row| row * self.grid.columns() + column);
        index.and_then(|index| self.flags[branch as usize].get(index).copied()).unwrap_or(DIRECT)
    }

    /// What is seen along the unit look direction `n` (components of the local frame). `None`: the ray is to be
    /// integrated.
    pub fn look(&self, n: DVec3) -> Option<Seen<'_>> {
        let place = self.grid.locate(n)?;
        let flags = self.flags(place.branch, place.column, place.row);
        let quads = self.grid.quads();
        let nodes = &self.nodes[place.branch as usize];
        let rows = std::array::from_fn(|j| {
            let first = (place.row + j).saturating_sub(1) * (self.grid.columns() + REPEATED) + place.column;
            nodes.get(first * quads..(first + 4) * quads).unwrap_or(&[])
        });
        self.grid.see(place, flags, rows)
    }
}

impl Grid {
    /// Numbers of a `packed_row`.
    pub fn packed_row_size(&self) -> usize {
        (self.columns() + REPEATED) * self.quads()
    }

    /// `node` of all columns of a row, one after the other.
    pub fn node_row(&self, branch: Branch, row: usize) -> impl Iterator<Item = f64> {
        (0..self.columns()).flat_map(move |column| self.node(branch, column, row))
    }

    /// Rows with cells that hold rays.
    pub fn cell_rows(&self, branch: Branch) -> std::ops::Range<usize> {
        ROWS_BELOW..self.rows(branch) - ROWS_ABOVE
    }

    /// `flags` of all cells of a row, from the branch's nodes (`node_row` of all rows).
    pub fn flag_row<'a>(&'a self, branch: Branch, row: usize, nodes: &'a [f64]) -> impl Iterator<Item = u32> + 'a {
        let node = move |i: usize, j: usize| self.node_of(nodes, i, j);
        (0..self.columns()).map(move |column| self.flags(branch, column, row, node))
    }

    /// A row as a table holds it, from the branch's nodes.
    pub fn packed_row<'a>(&'a self, row: usize, nodes: &'a [f64]) -> impl Iterator<Item = Vec4> + 'a {
        let columns = self.columns();
        (0..columns + REPEATED).flat_map(move |i| self.pack(self.node_of(nodes, (i + columns - 1) % columns, row)))
    }

    fn node_of<'a>(&self, nodes: &'a [f64], column: usize, row: usize) -> &'a [f64] {
        let channels = self.channels();
        let first = (row * self.columns() + column) * channels;
        &nodes[first..first + channels]
    }
}

#[cfg(test)]
#[path = "kerr_tests.rs"]
mod tests;
