// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Kerr lens table: everything about a ray of one observer as a function of its look direction, tabulated in polar
//! coordinates about the critical curve (`critical`), interpolated instead of integrated. Physics alone: knows neither
//! pixels nor threads; callers may spread `Grid::node` and `Grid::flags`, which are one independent task per node and
//! per cell.
//!
//! Coordinates: w(chi) along the curve (`Columns`), periodic, and x = n log2 |t^| with t^ = tan((psi - R(chi)) / 2) /
//! T(chi), T = tan(R / 2) and n nodes per octave: deflections and crossings diverge with ln |psi - R| at the curve.
//! Rain observers have the same coordinates, inside the hole too: each line from the centre meets the curve once.
//! Two branches: outer (t^ > 0, the ray escapes) and inner (captured). Both are continued a few nodes past the point
//! where psi reaches pi or 0, on to the other side of the axis, where everything stays smooth. Interpolation: cubic
//! Lagrange, 4 x 4 nodes.
//!
//! A node is `channels` numbers: the sky direction (chart; 0 when captured), then for every order of crossing U = u S,
//! with u = 1 / r there, continued through infinity to u < 0, and S = (1 - n_r^2)^(1/2) (a straight ray has u S =
//! u_observer sin(angle): u itself diverges like 1 / S for rays that leave radially), and if wanted the unit vector of
//! its azimuth and its delay in a form regular at infinity (`delay_from`). Tables hold them in f32 and by fours, as
//! interpolation loads them (`Grid::pack`).

mod grid;
mod cells;
mod lookup;
mod node;
mod table;
#[cfg(test)]
mod tests;

pub(crate) use grid::{BEYOND_INFINITY, INWARD, LEAVES_DORAN, ROWS_ABOVE, ROWS_BELOW};
pub use grid::{
    Branch, CHANNELS_MOST, CORE_OCTAVES, Crossings, DIRECT, Grid, GridPosition, NARROW_REACH, NARROW_REACH_INWARDS,
    NO_CROSSING, Node, PATTERN_TOLERANCE, POOR_CROSSINGS, PackedNode, Resolution, TOLERANCE, divergent_delay,
};
pub use lookup::{Crossing, GridStep, KerrLookup, Sky};
#[cfg(test)]
pub(crate) use node::{delay_from, delay_to};
pub use table::KerrLens;
