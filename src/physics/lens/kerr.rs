//! The Kerr lens table: everything about a ray of one eye as a function of its look direction, tabulated in polar coordinates
//! about the critical curve (`critical`), interpolated instead of integrated. Physics alone: knows neither pixels nor threads;
//! callers may spread `Grid::node` and `Grid::flags`, which are one independent task per node and per cell.
//!
//! Coordinates: w(chi) along the curve (`Columns`), periodic, and x = n log2 |t^| with t^ = tan((psi - R(chi)) / 2) / T(chi), T = tan(R / 2) and
//! n nodes per octave: deflections and crossings diverge with ln |psi - R| at the curve. Two branches: outer (t^ > 0, the ray
//! escapes) and inner (captured). Both are continued a few nodes past the point where psi reaches pi or 0, on to the other side
//! of the axis, where everything stays smooth. Interpolation: cubic Lagrange, 4 x 4 nodes.
//!
//! A node holds `channels` numbers: the sky direction (chart; 0 when captured), then for every order of crossing U = u S, with
//! u = 1 / r there, continued through infinity to u < 0, and S = (1 - n_r^2)^(1/2) (a straight ray has u S = u_eye sin(angle):
//! u itself diverges like 1 / S for rays that leave radially), and if wanted the unit vector of its azimuth and its delay in a form regular at
//! infinity (`regular_delay`).

use super::critical::{CriticalCurve, Polar};
use crate::physics::geodesic::{Constants, State};
use crate::physics::integrator::{Method, Quintic, step, step_limit};
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_outer, photon_orbit};
use crate::physics::trace::{CROSSINGS_KEPT, Settings, land};
use arrayvec::ArrayVec;
use glam::DVec3;
use std::f64::consts::{LN_2, TAU};

/// Rays with |t^| below 2^-`CORE_OCTAVES` are to be integrated: so close to the curve a direction in f32 says little.
pub const CORE_OCTAVES: usize = 10;
/// Rows below the first row of cells in use, and above the row of the axis: what the error estimate's stencil reaches.
const ROWS_BELOW: usize = 2;
const ROWS_ABOVE: usize = 3;
/// Step in sigma: 1e-8 or better for a whole ray, by the fifth order of the method.
const STEP: f64 = 0.1;
/// Sigma for which a ray is followed beyond infinity: longer than one step of the table takes a crossing.
const BEYOND_INFINITY: f64 = 1.0;
/// More than any ray of the grid needs.
const MAX_STEPS: usize = 2000;
/// Eyes nearer than this, in M, have the finer outer branch; it has few octaves then.
const NEAR_EYE: f64 = 15.0;
/// Least epsilon of `Columns`: what lies within this angle of the plane of an eye yet nearer to it is to be integrated.
const NARROWEST_LAYER: f64 = 0.03;
/// Share of the nodes that gather in the layers of `Columns`.
const LAYER_SHARE: f64 = 0.5;
/// Rays are followed to this multiple of `Grid::capture_u`, so that no crossing of the disk has a neighbour without one.
const INWARD: f64 = 1.5;
/// U of a crossing that does not come: the ray is captured before (+), or gone past infinity (-).
pub const NO_CROSSING: f64 = 1e3;
/// Most numbers in one node.
pub const CHANNELS_MOST: usize = SKY + PER_CROSSING * CROSSINGS_KEPT;
const SKY: usize = 3;
const PER_CROSSING: usize = 4;
/// Bit of a cell's flags: rays in it are to be integrated. Bits 0 .. 15: a crossing of that order may hit the disk.
pub const DIRECT: u32 = 1 << 31;
/// Error that a cell may have: rad of look direction for the sky, relative to 1 + conditioning for crossings.
pub const TOLERANCE: f64 = 2e-6;
/// The same for azimuths, rad, and delays, relative to the orbital time: they move a pattern along its orbit.
pub const PATTERN_TOLERANCE: f64 = 1e-5;

pub type Node = ArrayVec<f64, CHANNELS_MOST>;

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
    /// What keeps all but about 1 % of the rays about the shadow interpolated: rows are wide at |t^| = 1, which matters inside the
    /// shadow, and behind an eye near the disk.
    pub fn for_eye(frame: &LocalFrame) -> Self {
        Self { chi_nodes: 512, nodes_per_octave: [if frame.r < NEAR_EYE { 32 } else { 16 }, 32] }
    }
}

/// Which crossings of the equatorial plane are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    /// Orders 0 .. `orders`, at most `CROSSINGS_KEPT`; 0: the sky alone.
    pub orders: usize,
    /// Only crossings with 1 / r in [low, high] matter; high at most 1 / (0.99 photon orbit).
    pub disk_u: [f64; 2],
    /// Azimuth and delay too.
    pub pattern: bool,
}

/// The coordinate along the critical curve: w = (chi + v) / 2 with tan v = tan chi / epsilon, epsilon = |cot th| of the eye.
///
/// A ray that starts at the angle chi to the plane first meets it after the orbit angle atan2(|cot th|, sin chi) (spin 0): for an
/// eye near the plane that changes from 0 to pi within epsilon about chi = 0 and pi. Half of the nodes go there, in even steps of v.
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

    /// w in [0, 2 pi) and dw/dchi.
    fn coordinate(&self, sin: f64, cos: f64) -> (f64, f64) {
        let w = (1.0 - self.share) * sin.atan2(cos) + self.share * sin.atan2(self.epsilon * cos);
        let slope = 1.0 - self.share + self.share * self.epsilon / ((self.epsilon * cos).powi(2) + sin * sin);
        (if w < 0.0 { w + TAU } else { w }, slope)
    }

    /// chi at `w`, both in [0, 2 pi), by halving: w is steep.
    fn angle(&self, w: f64) -> f64 {
        let (mut low, mut high) = (0.0, TAU);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            let (sin, cos) = middle.sin_cos();
            if self.coordinate(sin, cos).0 <= w { low = middle } else { high = middle }
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
        Some(Self { frame: *frame, curve, columns, nodes_per_octave, wanted, capture_u, rows })
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

    /// The look direction at a column and a row, which may lie between nodes.
    pub fn direction(&self, branch: Branch, column: usize, row: f64) -> DVec3 {
        let chi = self.columns.chi[column % self.columns()];
        let (t_critical, _) = self.curve.at(chi);
        let t = self.reduced_tangent(branch, row) * t_critical;
        let away = if branch == Branch::Outer { t.atan() } else { -t.atan() };
        self.curve.direction(2.0 * (t_critical.atan() + away), chi)
    }

    /// Where the unit look direction `n` lies; `None`: too close to the critical curve.
    ///
    /// tan((psi - R) / 2) = (s - T (1 + c)) / (1 + c + T s), with c, s = cos, sin psi and 1 + c = s^2 / (1 - c) beyond 90 deg.
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
        let (w, w_slope) = self.columns.coordinate(p.sin_chi, p.cos_chi);
        let column = w * self.columns() as f64 / TAU;
        let column_floor = (column as usize).min(self.columns() - 1);
        let (column_gradient, x_gradient) = self.gradients(&p, w_slope, t, (t_critical, slope));
        Some(Place {
            branch,
            column: column_floor,
            row: row_floor,
            column_fraction: column - column_floor as f64,
            row_fraction: row - row_floor as f64,
            side: side(n),
            side_gradient: n.with_x(0.0) / side(n),
            column_gradient,
            row_gradient: x_gradient * (self.nodes_per_octave[branch as usize] / LN_2),
        })
    }

    /// d chi = along . dn / sin psi; dt = (1 + t^2) / 2 (d psi - d R), d R = 2 d T / (1 + T^2), d ln |t^| = dt / t - dT / T.
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

    /// Flags of the cell whose lower corner is (`column`, `row`), from the nodes about it: `node(column, row)` with columns
    /// from `column` - 2 (wrapped) to `column` + 3, rows alike. Only cells with `row` in `ROWS_BELOW` .. rows - `ROWS_ABOVE` hold rays.
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
        let patch = Patch { at: &at, sides, angles: self.cell_angles(branch, column, row) };
        let mut flags = 0;
        if branch == Branch::Outer && !patch.sky_is_good() {
            flags |= DIRECT;
        }
        for order in 0..self.wanted.orders {
            let channel = SKY + order * self.per_crossing();
            match patch.crossing(channel, &self.wanted) {
                Hit::No => {}
                Hit::Possible => flags |= 1 << order,
                Hit::Poor => flags |= 1 << order | DIRECT,
            }
        }
        flags
    }

    /// Angles on the eye's sky, rad: a cell's extent along chi and along x, and sin R.
    fn cell_angles(&self, branch: Branch, column: usize, row: usize) -> CellAngles {
        let (i, j) = (column, row as f64);
        let here = self.direction(branch, i, j + 0.5);
        let t = self.curve.at(self.columns.chi[i]).0;
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
    n.y.hypot(n.z).max(1e-12)
}

/// 1 / u - 2 ln(|u| / u_eye) is what the delay diverges like at infinity, E = 1; without it, it passes infinity smoothly (but
/// for terms of u^2 ln |u|).
pub fn divergent_delay(u: f64, u_eye: f64) -> f64 {
    1.0 / u - 2.0 * (u / u_eye).abs().max(f64::MIN_POSITIVE).ln()
}

/// The delay less `divergent_delay`, from the state at a crossing: with `Constants::delay`,
/// 2 (1 + u') ln(|u| / u_eye) - (1 + u') / u + the integral, and (1 + u') / u from u'^2 = P(u) without cancellation.
fn regular_delay(c: &Constants, eye: &State, there: &State) -> f64 {
    let (u, du) = (there.u, there.du);
    let below = u * (c.a2e2 - c.k + u * (2.0 * c.b - u * (c.a * c.a * c.carter)));
    let ratio = if du < 0.0 { -below / (1.0 - du) } else { (1.0 + du) / u };
    let logarithm = (u / c.u_eye).abs().max(f64::MIN_POSITIVE).ln();
    2.0 * ratio * u * logarithm - ratio + eye.du / eye.u + there.delay - eye.delay
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
            let (mut next, _) = step(Method::Nystrom, c, &state, h, settings.delay);
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
                self.sky = Some(land(c, &no_delay, &state, guess, |s| (s.u, s.du)).0.chart_direction());
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
        let (mut state, _) = land(c, settings, from, guess, |s| (s.n.z, s.dn.z));
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
struct Patch<'a, 'b> {
    at: &'a dyn Fn(usize, usize) -> &'b [f64],
    /// S at the inner 4 x 4 nodes.
    sides: [[f64; 4]; 4],
    angles: CellAngles,
}

impl Patch<'_, '_> {
    fn value(&self, channel: usize, i: usize, j: usize) -> f64 {
        (self.at)(i, j)[channel]
    }

    /// Error of cubic interpolation at mid-cell, 3/128 of the fourth difference (the greater one of both centres), summed over
    /// both directions, on the cell's four edges' worst.
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

    /// Change per rad of look direction, from changes between nodes: the smaller one over the cell of the greater one of both
    /// directions.
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

    /// Least and greatest value over the 4 x 4 nodes of the interpolation, widened by a quarter of their spread: between the
    /// nodes the values may go beyond. Missing crossings count as what they are, but do not widen.
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

/// An interpolated ray.
#[derive(Clone, Debug)]
pub struct Seen {
    /// The asymptotic direction, unless the ray is captured.
    pub sky: Option<Sky>,
    /// Crossings in the disk's range, in the ray's order.
    pub crossings: ArrayVec<Crossing, CROSSINGS_KEPT>,
}

#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// Chart, unit.
    pub direction: DVec3,
    /// d direction = by_column (column_gradient . dn) + by_row (row_gradient . dn).
    by_column: DVec3,
    by_row: DVec3,
    column_gradient: DVec3,
    row_gradient: DVec3,
}

impl Sky {
    /// The change of the direction for a small change `dn` of the look direction (components).
    pub fn change(&self, dn: DVec3) -> DVec3 {
        self.by_column * self.column_gradient.dot(dn) + self.by_row * self.row_gradient.dot(dn)
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    pub order: u32,
    pub u: f64,
    /// In (-pi, pi]; 0 unless the pattern is wanted, like the delay.
    pub azimuth: f64,
    pub delay: f64,
    /// Gradient of u by the look direction (components).
    pub u_gradient: DVec3,
}

/// Weights of cubic Lagrange interpolation at nodes -1, 0, 1, 2, and their derivatives.
fn lagrange(f: f64) -> ([f64; 4], [f64; 4]) {
    let (m, p, q) = (f - 1.0, f + 1.0, f - 2.0);
    (
        [-f * m * q / 6.0, p * m * q / 2.0, -p * f * q / 2.0, p * f * m / 6.0],
        [
            -(3.0 * f * f - 6.0 * f + 2.0) / 6.0,
            (3.0 * f * f - 4.0 * f - 1.0) / 2.0,
            -(3.0 * f * f - 2.0 * f - 2.0) / 2.0,
            (3.0 * f * f - 1.0) / 6.0,
        ],
    )
}

/// Value and derivatives by column and row of the channels of a node.
struct Interpolated {
    value: Node,
    by_column: Node,
    by_row: Node,
}

impl Grid {
    fn interpolate<'a>(&self, place: &Place, node: impl Fn(usize, usize) -> &'a [f64]) -> Interpolated {
        let channels = self.channels();
        let zero = || Node::from_iter(std::iter::repeat_n(0.0, channels));
        let mut sum = Interpolated { value: zero(), by_column: zero(), by_row: zero() };
        let (wc, dc) = lagrange(place.column_fraction);
        let (wr, dr) = lagrange(place.row_fraction);
        for i in 0..4 {
            let column = (place.column + self.columns() + i - 1) % self.columns();
            for j in 0..4 {
                let values = node(column, place.row + j - 1);
                for (k, y) in values.iter().enumerate().take(channels) {
                    sum.value[k] += wc[i] * wr[j] * y;
                    sum.by_column[k] += dc[i] * wr[j] * y;
                    sum.by_row[k] += wc[i] * dr[j] * y;
                }
            }
        }
        sum
    }

    /// What the ray at `place` sees, from the cell's flags and nodes; `None`: not to be interpolated, integrate.
    pub fn see<'a>(&self, place: &Place, flags: u32, node: impl Fn(usize, usize) -> &'a [f64]) -> Option<Seen> {
        if flags & DIRECT != 0 {
            return None;
        }
        let at = self.interpolate(place, node);
        let sky = (place.branch == Branch::Outer).then(|| sky_of(&at, place));
        let orders = (0..self.wanted.orders).filter(|order| flags >> order & 1 != 0);
        let crossings = orders.filter_map(|order| self.crossing_of(&at, place, order)).collect();
        Some(Seen { sky, crossings })
    }

    fn crossing_of(&self, at: &Interpolated, place: &Place, order: usize) -> Option<Crossing> {
        let channel = SKY + order * self.per_crossing();
        let u = at.value[channel] / place.side;
        if !(u >= self.wanted.disk_u[0] && u <= self.wanted.disk_u[1]) {
            return None;
        }
        let (azimuth, delay) = if self.wanted.pattern {
            let divergent = divergent_delay(u, 1.0 / self.frame.r);
            (at.value[channel + 2].atan2(at.value[channel + 1]), at.value[channel + 3] + divergent)
        } else {
            (0.0, 0.0)
        };
        let gradient = place.column_gradient * at.by_column[channel] + place.row_gradient * at.by_row[channel];
        let u_gradient = (gradient - place.side_gradient * u) / place.side;
        Some(Crossing { order: order as u32, u, azimuth, delay, u_gradient })
    }
}

/// The interpolated direction, normalised, and its derivatives at right angles to it.
fn sky_of(at: &Interpolated, place: &Place) -> Sky {
    let vector = |v: &Node| DVec3::from_slice(&v[..SKY]);
    let raw = vector(&at.value);
    let inverse = 1.0 / raw.length();
    let direction = raw * inverse;
    let across = |v: DVec3| (v - direction * direction.dot(v)) * inverse;
    Sky {
        direction,
        by_column: across(vector(&at.by_column)),
        by_row: across(vector(&at.by_row)),
        column_gradient: place.column_gradient,
        row_gradient: place.row_gradient,
    }
}

/// A whole table.
#[derive(Clone, Debug)]
pub struct KerrLens {
    grid: Grid,
    /// By branch: `channels` numbers a node, rows of columns.
    nodes: [Vec<f64>; 2],
    flags: [Vec<u32>; 2],
}

impl KerrLens {
    /// Builds the table node by node, cell by cell, on this thread.
    pub fn new(frame: &LocalFrame, resolution: Resolution, wanted: Crossings) -> Option<Self> {
        let grid = Grid::new(frame, resolution, wanted)?;
        let nodes = [Branch::Outer, Branch::Inner].map(|branch| {
            let indices = (0..grid.rows(branch)).flat_map(|row| (0..grid.columns()).map(move |column| (column, row)));
            indices.flat_map(|(column, row)| grid.node(branch, column, row)).collect()
        });
        Some(Self::assemble(grid, nodes))
    }

    /// From nodes computed by the caller: for outer and inner branch, `Grid::node` of every column of row 0, of row 1 and so on.
    pub fn assemble(grid: Grid, nodes: [Vec<f64>; 2]) -> Self {
        let mut lens = Self { grid, nodes, flags: [Vec::new(), Vec::new()] };
        lens.flags = [Branch::Outer, Branch::Inner].map(|branch| {
            let rows = ROWS_BELOW..lens.grid.rows(branch) - ROWS_ABOVE;
            let cells = rows.flat_map(|row| (0..lens.grid.columns()).map(move |column| (column, row)));
            cells.map(|(i, j)| lens.grid.flags(branch, i, j, |i, j| lens.node(branch, i, j))).collect()
        });
        lens
    }

    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    fn node(&self, branch: Branch, column: usize, row: usize) -> &[f64] {
        let channels = self.grid.channels();
        let index = (row * self.grid.columns() + column) * channels;
        self.nodes[branch as usize].get(index..index + channels).unwrap_or(&[])
    }

    /// The flags of a cell; `DIRECT` where there is none.
    pub fn flags(&self, branch: Branch, column: usize, row: usize) -> u32 {
        let index = row.checked_sub(ROWS_BELOW).map(|row| row * self.grid.columns() + column);
        index.and_then(|index| self.flags[branch as usize].get(index).copied()).unwrap_or(DIRECT)
    }

    /// What is seen along the unit look direction `n` (components of the local frame); `None`: not to be interpolated, integrate.
    pub fn look(&self, n: DVec3) -> Option<Seen> {
        let place = self.grid.locate(n)?;
        let flags = self.flags(place.branch, place.column, place.row);
        self.grid.see(&place, flags, |i, j| self.node(place.branch, i, j))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::metric::chart;
    use crate::physics::orbit::{isco, redshift};
    use crate::physics::trace::{Fate, trace};
    use std::collections::HashMap;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// A pixel of a frame 4096 wide that shows 90 degrees, about: what errors of directions are measured in.
    const PIXEL: f64 = 4.85e-4;

    /// splitmix64 (Steele, Lea & Flood 2014), to [0, 1).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
        }

        fn sphere(&mut self) -> DVec3 {
            let z = 2.0 * self.next() - 1.0;
            let (sin, cos) = (TAU * self.next()).sin_cos();
            let rho = (1.0 - z * z).sqrt();
            DVec3::new(rho * cos, rho * sin, z)
        }
    }

    /// A table of which only the nodes are computed that are looked at.
    struct Lazy {
        grid: Grid,
        nodes: HashMap<(usize, usize, usize), Node>,
    }

    impl Lazy {
        fn new(frame: &LocalFrame, resolution: Resolution, wanted: Crossings) -> Option<Self> {
            Some(Self { grid: Grid::new(frame, resolution, wanted)?, nodes: HashMap::new() })
        }

        fn look(&mut self, n: DVec3) -> (Option<Place>, u32, Option<Seen>) {
            let Some(place) = self.grid.locate(n) else { return (None, DIRECT, None) };
            let (branch, columns) = (place.branch, self.grid.columns());
            for i in 0..6 {
                let column = (place.column + columns + i - 2) % columns;
                for row in place.row - 2..place.row + 4 {
                    self.nodes
                        .entry((branch as usize, column, row))
                        .or_insert_with(|| self.grid.node(branch, column, row));
                }
            }
            let node = |i: usize, j: usize| self.nodes[&(branch as usize, i, j)].as_slice();
            let flags = self.grid.flags(branch, place.column, place.row, node);
            (Some(place), flags, self.grid.see(&place, flags, node))
        }
    }

    /// Which part of the sky a test ray was aimed at.
    #[derive(Clone, Copy, PartialEq)]
    enum Aim {
        /// log-uniform distance from the curve.
        Curve,
        /// Uniform within three radii of the shadow.
        Shadow,
        /// Anywhere.
        Sky,
    }

    fn aim(curve: &CriticalCurve, random: &mut Random) -> (Aim, DVec3) {
        let pick = random.next();
        if pick < 0.2 {
            return (Aim::Sky, random.sphere());
        }
        let chi = TAU * random.next();
        let t = curve.at(chi).0;
        if pick < 0.5 {
            let tangent = t * (-14.0 * random.next()).exp2();
            let away = if random.next() < 0.5 { tangent.atan() } else { -tangent.atan() };
            return (Aim::Curve, curve.direction(2.0 * (t.atan() + away), chi));
        }
        let psi = (6.0 * t.atan()).min(PI) * random.next().sqrt();
        (Aim::Shadow, curve.direction(psi, chi))
    }

    #[derive(Default)]
    struct Measured {
        rays: usize,
        core: usize,
        /// Aimed at within three radii of the shadow: all, and direct beyond the core.
        about: usize,
        about_direct: usize,
        wrong_fate: usize,
        wrong_crossings: usize,
        sky: Vec<f64>,
        radius: Vec<f64>,
        redshift: Vec<f64>,
        azimuth: Vec<f64>,
        delay: Vec<f64>,
        worst: String,
    }

    fn quantile(values: &mut [f64], q: f64) -> f64 {
        values.sort_by(f64::total_cmp);
        let last = values.len().saturating_sub(1);
        values.get((q * last as f64).round() as usize).copied().unwrap_or(0.0)
    }

    impl Measured {
        fn add(&mut self, other: Self) {
            self.rays += other.rays;
            self.core += other.core;
            self.about += other.about;
            self.about_direct += other.about_direct;
            self.wrong_fate += other.wrong_fate;
            self.wrong_crossings += other.wrong_crossings;
            self.sky.extend(other.sky);
            self.radius.extend(other.radius);
            self.redshift.extend(other.redshift);
            self.azimuth.extend(other.azimuth);
            self.delay.extend(other.delay);
            self.worst += &other.worst;
        }

        fn report(&mut self, title: &str) {
            let qs = [0.5, 0.99, 0.999, 0.9999, 1.0];
            let line = |v: &mut Vec<f64>| qs.map(|q| format!("{:.0e}", quantile(v, q))).join(" ");
            println!(
                "{title}: {} rays, core {:.4}, direct about the shadow {:.4}, fates {}, crossings {} of {}; sky px {}; u {}; g {}; az {}; t {}",
                self.rays,
                self.core as f64 / self.rays as f64,
                self.about_direct as f64 / self.about as f64,
                self.wrong_fate,
                self.wrong_crossings,
                self.radius.len(),
                line(&mut self.sky),
                line(&mut self.radius),
                line(&mut self.redshift),
                line(&mut self.azimuth),
                line(&mut self.delay),
            );
        }
    }

    fn compare(lazy: &mut Lazy, count: usize, random: &mut Random) -> Measured {
        let mut m = Measured::default();
        let frame = lazy.grid.frame;
        for _ in 0..count {
            let (kind, n) = aim(&lazy.grid.curve, random);
            let (place, _, look) = lazy.look(n);
            m.rays += 1;
            m.core += usize::from(place.is_none());
            let direct = look.is_none();
            if kind == Aim::Shadow {
                m.about += 1;
                m.about_direct += usize::from(direct && place.is_some());
            }
            let (Some(seen), Some(place)) = (look, place) else { continue };
            compare_ray(&frame, &lazy.grid, n, &place, &seen, &mut m);
        }
        m
    }

    fn compare_ray(frame: &LocalFrame, grid: &Grid, n: DVec3, place: &Place, seen: &Seen, m: &mut Measured) {
        let (c, start) = frame.start(n).unwrap();
        let truth = trace(&c, &start, &Settings::exact(c.a));
        let title = || {
            format!(
                "  a {} r {} cos {} {:?} column {:.2} row {:.2}",
                c.a,
                frame.r,
                frame.cos,
                place.branch,
                place.column as f64 + place.column_fraction,
                place.row as f64 + place.row_fraction
            )
        };
        if seen.sky.is_some() != (truth.fate == Fate::Escaped) {
            m.wrong_fate += 1;
            m.worst += &format!("{} fate {:?}\n", title(), truth.fate);
            return;
        }
        let (t1, t2) = n.any_orthonormal_pair();
        if let Some(sky) = seen.sky {
            let stretch = sky.change(t1).length().hypot(sky.change(t2).length()).max(1.0);
            let error = sky.direction.distance(truth.direction) / stretch / PIXEL;
            if error > 0.05 {
                m.worst += &format!("{} sky {error:.1e} stretch {stretch:.1e}\n", title());
            }
            m.sky.push(error);
        }
        let [far, near] = grid.wanted.disk_u;
        let p = grid.curve.at(grid.columns.chi[place.column]).0;
        let critical = 2.0 * p / (1.0 + p * p);
        for crossing in truth.crossings.iter().filter(|x| (x.order as usize) < grid.wanted.orders) {
            let found = seen.crossings.iter().find(|x| x.order == crossing.order);
            let Some(found) = found else {
                // Beside the disk's edge either is right.
                if crossing.u > far * 1.001 && crossing.u < near * 0.999 {
                    m.wrong_crossings += 1;
                    m.worst += &format!("{} no crossing {} {}\n", title(), crossing.order, crossing.u);
                }
                continue;
            };
            let gradient = found.u_gradient - n * n.dot(found.u_gradient);
            let conditioning = 1.0 + critical * gradient.length() / crossing.u;
            let error = (found.u / crossing.u - 1.0).abs() / conditioning;
            if error > 1e-4 {
                m.worst +=
                    &format!("{} u {error:.1e} order {} conditioning {conditioning:.1e}\n", title(), crossing.order);
            }
            m.radius.push(error);
            let g = |u| redshift(c.a, u, false, c.energy, c.angular_momentum, c.nu_local);
            let g_error = (g(found.u) / g(crossing.u) - 1.0).abs() / conditioning;
            if g_error.is_finite() {
                m.redshift.push(g_error);
            }
            if grid.wanted.pattern {
                let turn = crossing.u * crossing.u.sqrt();
                let azimuth = crate::physics::geodesic::wrap_angle(found.azimuth - crossing.azimuth).abs();
                m.azimuth.push(azimuth / conditioning);
                m.delay.push((found.delay - crossing.delay).abs() * turn / conditioning);
            }
        }
        for found in &seen.crossings {
            let there = truth.crossings.iter().any(|x| x.order == found.order);
            if !there {
                m.wrong_crossings += 1;
                m.worst += &format!("{} invented crossing {} {}\n", title(), found.order, found.u);
            }
        }
    }

    const SPINS: [f64; 8] = [0.1, -0.5, 0.9, -0.9, 0.95, 0.998, -0.998, 0.3];

    /// Eye number `i`: spins in turn, r log-uniform, theta over the sphere, every fifth in the plane or on the axis or near.
    fn eye(i: usize, random: &mut Random) -> LocalFrame {
        let a = SPINS[i % SPINS.len()];
        let r = 4.5 * (1000.0_f64 / 4.5).powf(random.next());
        let theta = match i % 10 {
            3 => FRAC_PI_2,
            5 => 0.0,
            7 => PI,
            9 => FRAC_PI_2 + 1e-3,
            _ => (2.0 * random.next() - 1.0_f64).acos(),
        };
        let mut place = chart(r, theta, TAU * random.next());
        if i % 10 == 3 {
            place.z = 0.0;
        }
        LocalFrame::new(a, place).unwrap()
    }

    fn wanted(a: f64, pattern: bool) -> Crossings {
        Crossings { orders: 4, disk_u: [1.0 / 30.0, 1.0 / isco(a)], pattern }
    }

    /// Share of rays within three radii of the shadow, beyond the core, that are direct.
    fn direct_share(lazy: &mut Lazy, count: usize) -> f64 {
        let mut random = Random(5);
        let (mut all, mut direct) = (0, 0);
        while all < count {
            let (kind, n) = aim(&lazy.grid.curve, &mut random);
            if kind == Aim::Shadow {
                all += 1;
                let (place, _, look) = lazy.look(n);
                direct += usize::from(place.is_some() && look.is_none());
            }
        }
        direct as f64 / all as f64
    }

    /// Share of direct rays, by the eye, without and with crossings.
    #[test]
    #[ignore = "a measurement"]
    fn share_of_direct_rays() {
        for a in SPINS {
            for theta in [FRAC_PI_2, FRAC_PI_2 + 1e-3, 1.45, 1.2, 0.6, 0.0] {
                let mut shares = String::new();
                for r in [4.5, 12.0, 100.0] {
                    let mut place = chart(r, theta, 0.3);
                    if theta == FRAC_PI_2 {
                        place.z = 0.0;
                    }
                    let frame = LocalFrame::new(a, place).unwrap();
                    for orders in [0, 4] {
                        let wanted = Crossings { orders, ..wanted(a, true) };
                        let mut lazy = Lazy::new(&frame, Resolution::for_eye(&frame), wanted).unwrap();
                        shares += &format!("{:.4} ", direct_share(&mut lazy, 2000));
                    }
                }
                println!("a {a} theta {theta:.4}, r 4.5, 12, 100, without and with crossings: {shares}");
            }
        }
    }

    /// Size of the tables and cost of a node.
    #[test]
    #[ignore = "a measurement"]
    fn size() {
        for a in [0.5, 0.998] {
            for r in [4.5, 10.0, 30.0, 1000.0, 1e5] {
                let frame = LocalFrame::new(a, chart(r, 1.3, 0.0)).unwrap();
                let grid = Grid::new(&frame, Resolution::for_eye(&frame), wanted(a, true)).unwrap();
                let begin = std::time::Instant::now();
                let mut count = 0.0;
                for branch in [Branch::Outer, Branch::Inner] {
                    for row in 0..grid.rows(branch) {
                        for column in (0..grid.columns()).step_by(64) {
                            std::hint::black_box(grid.node(branch, column, row));
                            count += 1.0;
                        }
                    }
                }
                println!(
                    "a {a} r {r}: {} x ({} + {}) nodes, {:.1} us each",
                    grid.columns(),
                    grid.rows(Branch::Outer),
                    grid.rows(Branch::Inner),
                    begin.elapsed().as_secs_f64() * 1e6 / count
                );
            }
        }
    }

    fn measure(eyes: std::ops::Range<usize>, rays: usize, resolution: Option<Resolution>, pattern: bool) -> Measured {
        let mut all = Measured::default();
        for i in eyes {
            let mut random = Random(1 + i as u64);
            let frame = eye(i, &mut random);
            let resolution = resolution.unwrap_or(Resolution::for_eye(&frame));
            let mut lazy = Lazy::new(&frame, resolution, wanted(frame.a, pattern)).unwrap();
            all.add(compare(&mut lazy, rays, &mut random));
        }
        all
    }

    /// The table against integration with steps five times finer, for random eyes and rays.
    #[test]
    fn table_agrees_with_integration() {
        let mut m = measure(0..40, 250, None, true);
        m.report("for_eye");
        println!("{}", m.worst);
        assert!(m.about_direct * 100 < m.about, "{} of {} direct", m.about_direct, m.about);
        assert!(m.radius.len() > 4000 && m.sky.len() > 5000);
        assert_eq!((m.wrong_fate, m.wrong_crossings), (0, 0));
        assert!(quantile(&mut m.sky, 0.9999) < 0.01 && quantile(&mut m.sky, 1.0) < 0.1);
        assert!(quantile(&mut m.radius, 0.999) < 1e-5 && quantile(&mut m.redshift, 0.999) < 1e-5);
    }

    /// A whole table, coarse so that it is quickly built, says what its cells say one by one.
    #[test]
    fn whole_table_is_its_nodes() {
        let frame = LocalFrame::new(0.9, chart(12.0, 1.2, 0.3)).unwrap();
        let resolution = Resolution { chi_nodes: 128, nodes_per_octave: [16; 2] };
        let lens = KerrLens::new(&frame, resolution, wanted(0.9, true)).unwrap();
        let mut lazy = Lazy::new(&frame, resolution, wanted(0.9, true)).unwrap();
        let mut random = Random(3);
        let (mut seen, mut crossings) = (0, 0);
        for _ in 0..2000 {
            let (_, n) = aim(lens.grid().curve(), &mut random);
            match (lens.look(n), lazy.look(n).2) {
                (None, None) => {}
                (Some(a), Some(b)) => {
                    assert_eq!(a.sky.map(|s| s.direction), b.sky.map(|s| s.direction));
                    assert_eq!(a.crossings.len(), b.crossings.len());
                    seen += 1;
                    crossings += a.crossings.len();
                }
                (a, b) => panic!("{a:?} {b:?}"),
            }
        }
        assert!(seen > 100 && crossings > 0, "{seen} {crossings}");
    }

    /// The gradients against differences of what the table says.
    #[test]
    fn gradients_are_derivatives() {
        let frame = LocalFrame::new(0.95, chart(14.0, 1.3, 0.3)).unwrap();
        let mut lazy = Lazy::new(&frame, Resolution::for_eye(&frame), wanted(0.95, false)).unwrap();
        let mut random = Random(8);
        let (mut skies, mut radii) = (0, 0);
        for _ in 0..300 {
            let (kind, n) = aim(&lazy.grid.curve, &mut random);
            if kind != Aim::Shadow {
                continue;
            }
            let dn = n.any_orthonormal_vector();
            let mut at = |d: f64| match lazy.look((n + dn * d).normalize()) {
                (Some(place), _, Some(seen)) => Some(((place.column, place.row), seen)),
                _ => None,
            };
            let d = 1e-6;
            let (Some((c0, seen)), Some((c1, before)), Some((c2, after))) = (at(0.0), at(-d), at(d)) else { continue };
            if c0 != c1 || c0 != c2 {
                continue;
            }
            if let (Some(sky), Some(s1), Some(s2)) = (seen.sky, before.sky, after.sky) {
                let difference = (s2.direction - s1.direction) / (2.0 * d);
                let error = (sky.change(dn) - difference).length() / difference.length().max(1.0);
                assert!(error < 1e-4, "sky {error:.1e}");
                skies += 1;
            }
            for crossing in &seen.crossings {
                let u = |seen: &Seen| seen.crossings.iter().find(|x| x.order == crossing.order).map(|x| x.u);
                if let (Some(u1), Some(u2)) = (u(&before), u(&after)) {
                    let difference = (u2 - u1) / (2.0 * d);
                    let error =
                        (crossing.u_gradient.dot(dn) - difference).abs() / crossing.u_gradient.length().max(0.1);
                    assert!(error < 1e-4, "u {error:.1e}");
                    radii += 1;
                }
            }
        }
        assert!(skies > 50 && radii > 50, "{skies} {radii}");
    }

    #[test]
    #[ignore = "a measurement"]
    fn resolutions() {
        for chi_nodes in [128, 256, 512] {
            for nodes_per_octave in [8, 16, 32] {
                for pattern in [false, true] {
                    let resolution = Resolution { chi_nodes, nodes_per_octave: [nodes_per_octave; 2] };
                    let mut m = measure(0..40, 300, Some(resolution), pattern);
                    m.report(&format!("chi {chi_nodes} per octave {nodes_per_octave} pattern {pattern}"));
                }
            }
        }
    }
}
