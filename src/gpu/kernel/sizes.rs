//! Sizes that kernels share with those who make their tables and dispatch them.

use crate::physics::lens::critical::CRITICAL_NODES;

/// Nodes of a spin-0 lens: per octave of the distance from the critical direction; octaves of them; and in a row.
pub const SCHWARZSCHILD_PER_OCTAVE: f64 = 32.0;
pub const SCHWARZSCHILD_OCTAVES: f64 = 22.0;
pub const SCHWARZSCHILD_INTERVALS: u32 = 128;
/// Nodes of a Kerr lens: around the critical curve, which shares their texture, and per octave of the distance from it.
pub const KERR_COLUMNS: u32 = CRITICAL_NODES as u32;
pub const KERR_PER_OCTAVE: usize = 16;
/// Pixels of a row that a thread of traced/count.wgsl sums.
pub const COUNT_RUN: u32 = 8;
/// Entries of a row of the tables that shading reads: a width that every device takes.
pub const TABLE_WIDTH: usize = 2048;
/// Crossings of a ray record that records/export.wgsl writes, and vectors of four numbers of a record.
pub const EXPORT_CROSSINGS: usize = 4;
pub const EXPORT_VECTORS: usize = 4 + 3 * EXPORT_CROSSINGS;
