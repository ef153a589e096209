// SPDX-License-Identifier: MIT OR Apache-2.0
//! The coordinates of a Kerr lens table, its size, and what it is computed from.

use crate::physics::lens::critical::{CriticalCurve, Polar};
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_outer, photon_orbit};
use crate::physics::trace::CROSSINGS_KEPT;
use arrayvec::ArrayVec;
use glam::{DVec3, Vec3Swizzles, Vec4};
use std::f64::consts::{LN_2, TAU};

/// Rays with |t^| below 2^-`CORE_OCTAVES` are to be integrated: a direction in f32 is not exact enough so close to the
/// curve.
pub const CORE_OCTAVES: usize = 10;
/// Rows below the first row of cells in use, and above the row of the axis, for the stencil of the error estimate.
pub(crate) const ROWS_BELOW: usize = 2;
pub(crate) const ROWS_ABOVE: usize = 3;
/// The step in sigma. It gives some 1e-7 for a whole ray, typically much less; f32 resolves no more. (Kernels take
/// shorter ones: lens/kerr_nodes.wgsl says why.)
pub(super) const STEP: f64 = 0.25;
/// The error in sigma to which crossings and ends are found.
pub(super) const SLACK: f64 = 1e-8;
/// The length in sigma for which a ray is followed beyond infinity: longer than one step of the table takes a crossing.
pub(crate) const BEYOND_INFINITY: f64 = 1.0;
/// A bound on the steps of a ray, which no ray of the grid reaches.
pub(super) const MAX_STEPS: usize = 2000;
/// The least epsilon of `Columns`. An observer yet nearer to the plane has the same columns; the directions within this
/// angle of the plane are then integrated.
pub(super) const NARROWEST_LAYER: f64 = 0.03;
/// The share of the nodes that gather in the layers of `Columns`.
pub(super) const LAYER_SHARE: f64 = 0.5;
/// Rays are followed to this multiple of `Grid::capture_u`, so that no crossing of the disk has a neighbour without
/// one.
pub(crate) const INWARD: f64 = 1.5;
/// The part of `Grid::capture_u` below which rays of rain observers go on in the chart of Boyer and Lindquist, as all
/// others do.
pub(crate) const LEAVES_DORAN: f64 = 0.95;
/// The U that marks a missing crossing: positive where the ray is captured before, negative where it has passed
/// infinity.
pub const NO_CROSSING: f64 = 1e3;
/// The most numbers in one node.
pub const CHANNELS_MOST: usize = SKY + PER_CROSSING * CROSSINGS_KEPT;
pub(super) const SKY: usize = 3;
pub(super) const PER_CROSSING: usize = 4;
pub(super) const PER_QUAD: usize = 4;
/// A bit of a cell's flags: all rays in it are to be integrated. Bits 0 .. 15: a crossing of that order may hit the
/// disk.
pub const DIRECT: u32 = 1 << 31;
/// A bit of a cell's flags: the crossings of its rays are to be integrated, while the sky may be interpolated.
pub const POOR_CROSSINGS: u32 = 1 << 30;
/// The error that a cell may have: for the sky in rad of look direction, for crossings relative to 1 + conditioning.
pub const TOLERANCE: f64 = 1e-6;
/// The error that a cell may have in azimuths, rad, and in delays, relative to the orbital time: it moves a pattern
/// along its orbit. (Kernels allow for the rounding of f32 as well: lens/kerr_flags.wgsl.)
pub const PATTERN_TOLERANCE: f64 = 1e-5;

pub type Node = ArrayVec<f64, CHANNELS_MOST>;

/// The most fours of numbers in one node.
pub(super) const QUADS_MOST: usize = 1 + CROSSINGS_KEPT;

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
    /// Nodes over chi in [0, 2 pi); at least 8.
    pub chi_nodes: usize,
    /// Nodes per octave of |t^|, in the outer and the inner branch.
    pub nodes_per_octave: [usize; 2],
}

impl Resolution {
    /// The CPU tracer's: all but 1 % of the pixels of usual frames are interpolated, and the tables are built as fast
    /// as so many rays are traced.
    pub const COARSE: Self = Self { chi_nodes: 256, nodes_per_octave: [16; 2] };
}

/// The crossings of the equatorial plane that are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossings {
    /// Orders 0 .. `orders`, at most `CROSSINGS_KEPT`; 0: the sky alone.
    pub orders: usize,
    /// Only crossings with 1 / r in [low, high] matter; high at most 1 / (0.99 photon orbit).
    pub plane_u: [f64; 2],
    /// Azimuth and delay too.
    pub pattern: bool,
}

/// Crossings of order 1 and more reach beyond `Crossings::plane_u` by so much: their images are so narrow that 1 / r
/// goes through all of it within a pixel, and pixels whose own ray crosses farther out show a part of them.
pub const NARROW_REACH: f64 = 0.3;
/// Crossings of order 1 and more also reach inwards, by this factor: beside a disk that ends far from the photon orbit,
/// as one that turns against the hole does, samples of a pixel on both sides of an image would otherwise seem to have
/// no crossing. Such crossings need not be exact.
pub const NARROW_REACH_INWARDS: f64 = 3.0;

impl Crossings {
    /// The least 1 / r at which crossings of an order are told.
    pub fn reach(&self, order: usize) -> f64 {
        self.plane_u[0] * if order > 0 { NARROW_REACH } else { 1.0 }
    }
}

/// The coordinate along the critical curve: w = (chi + v) / 2 with tan v = tan chi / epsilon, epsilon = |cot th| of
/// the observer.
///
/// A ray that starts at the angle chi to the plane first meets it after the orbit angle atan2(|cot th|, sin chi) (spin
/// 0): for an observer near the plane that changes from 0 to pi within epsilon about chi = 0 and pi. Half of the nodes
/// go there, in even steps of v.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    pub(super) epsilon: f64,
    /// Share of the nodes that v spaces.
    pub(super) share: f64,
    /// chi at the nodes, in [0, 2 pi).
    pub(super) chi: Vec<f64>,
}

impl Columns {
    pub(super) fn new(frame: &LocalFrame, count: usize) -> Self {
        Self::spaced((frame.cos / frame.sin).abs().clamp(NARROWEST_LAYER, 1.0), LAYER_SHARE, count)
    }

    pub(super) fn spaced(epsilon: f64, share: f64, count: usize) -> Self {
        let mut columns = Self { epsilon, share, chi: Vec::new() };
        columns.chi = (0..count).map(|i| columns.angle(TAU * i as f64 / count as f64)).collect();
        columns
    }

    /// w in [0, 2 pi) and dw/dchi at `chi` in (-pi, pi].
    pub(super) fn coordinate(&self, chi: f64, (sin, cos): (f64, f64)) -> (f64, f64) {
        let w = (1.0 - self.share) * chi + self.share * sin.atan2(self.epsilon * cos);
        let slope = 1.0 - self.share + self.share * self.epsilon / ((self.epsilon * cos).powi(2) + sin * sin);
        (if w < 0.0 { w + TAU } else { w }, slope)
    }

    /// chi at `w`, both in [0, 2 pi), by halving: w is steep.
    pub(super) fn angle(&self, w: f64) -> f64 {
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
    pub(super) frame: LocalFrame,
    pub(super) curve: CriticalCurve,
    pub(super) columns: Columns,
    /// The unit vector from the centre towards chi, and T, of every column.
    pub(super) spokes: Vec<(DVec3, f64)>,
    /// The nodes per octave of the outer and the inner branch; `rows` in the same order.
    pub(super) nodes_per_octave: [f64; 2],
    pub(super) wanted: Crossings,
    /// The 1/r at which drag and delay end.
    pub(super) capture_u: f64,
    pub(super) rows: [usize; 2],
}

/// A cell of the table, its lower corner's indices, and the fractions inside it.
#[derive(Clone, Copy, Debug)]
pub struct GridPosition {
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
    /// `None` when the observer is too near the photon region or too far (`CriticalCurve::new`).
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

    /// The greatest 1 / r at which crossings are told: not beyond `capture_u` unless the disk is.
    pub fn reach_inwards(&self) -> f64 {
        let near = self.wanted.plane_u[1];
        near.max(self.capture_u.min(NARROW_REACH_INWARDS * near))
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

    pub(super) fn per_crossing(&self) -> usize {
        if self.wanted.pattern { PER_CROSSING } else { 1 }
    }

    /// |t^| at a row.
    pub(super) fn reduced_tangent(&self, branch: Branch, row: f64) -> f64 {
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
    pub fn locate(&self, n: DVec3) -> Option<GridPosition> {
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
        Some(GridPosition {
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
    pub(super) fn gradients(&self, p: &Polar, w_slope: f64, t: f64, (t_critical, slope): (f64, f64)) -> (DVec3, DVec3) {
        let chi = p.along / p.sin.max(1e-9);
        let t_critical_gradient = chi * slope;
        let radius = t_critical_gradient * (2.0 / (1.0 + t_critical * t_critical));
        let t_gradient = (p.outward - radius) * (0.5 * (1.0 + t * t));
        let x = t_gradient / t - t_critical_gradient / t_critical;
        (chi * (w_slope * self.columns() as f64 / TAU), x)
    }
}

/// S of a look direction: the sine of its angle to the radius; not 0.
pub(super) fn side(n: DVec3) -> f64 {
    n.yz().length().max(1e-12)
}

/// 1 / u - 2 ln(|u| / u_observer) is what the delay diverges like at infinity, E = 1; without it, it passes infinity
/// smoothly (but for terms of u^2 ln |u|). And 1 / u_observer is what it is from far, which leaves little to round in
/// tables.
pub fn divergent_delay(u: f64, u_observer: f64) -> f64 {
    1.0 / u + 1.0 / u_observer - 2.0 * (u / u_observer).abs().max(f64::MIN_POSITIVE).ln()
}
