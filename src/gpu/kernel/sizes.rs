// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sizes that kernels share with those who make their tables and dispatch them.

use crate::emit::hot_spot::HotSpot;
use crate::emit::volume::Volume;
use crate::physics::lens::critical::CRITICAL_NODES;

/// Nodes of a spin-0 lens: per octave of the distance from the critical direction; octaves of them; and in a row. The
/// CPU tracer needs a quarter of them (`Resolution::SINGLE`), as its nodes also hold derivatives by the direction, and
/// what is left of u without the critical ray. Measured from r = 30, 320 x 180 pixels, over (1 + conditioning): radii
/// of crossings here 9e-8 in the median and 7e-7 at worst, there 4e-8 and 1.4e-6; directions 2e-7 and 1.5e-6, there
/// 6e-8 and 1.5e-7.
pub const SCHWARZSCHILD_PER_OCTAVE: f64 = 32.0;
pub const SCHWARZSCHILD_OCTAVES: f64 = 22.0;
pub const SCHWARZSCHILD_INTERVALS: u32 = 128;
/// Nodes of a Kerr lens: around the critical curve, which shares their texture, and per octave of the distance from it.
/// The CPU tracer, to which a node costs more of a frame, has half as many columns (`kerr::Resolution::COARSE`), and
/// integrates 2 % of the rays about the shadow.
pub const KERR_COLUMNS: u32 = CRITICAL_NODES as u32;
pub const KERR_PER_OCTAVE: usize = 16;
/// Pixels of a row that a thread of traced/count.wgsl sums.
pub const COUNT_RUN: u32 = 8;
/// Columns of a row that a workgroup of sky/pyramid.wgsl makes.
pub const LEVEL_COLUMNS: u32 = 128;
/// Parts in which sky/source_parts.wgsl binds a picture.
pub const SKY_PARTS: usize = 6;
/// Entries of a row of the tables that shading reads: a width that every device takes.
pub const TABLE_WIDTH: usize = 2048;
/// Crossings of a ray record that records/export.wgsl writes, and vectors of four numbers of a record.
pub const EXPORT_CROSSINGS: usize = 4;
pub const EXPORT_VECTORS: usize = 4 + 3 * EXPORT_CROSSINGS;

/// Volumes and hot spots of a frame at most.
pub const MOST_MATTER: usize = Volume::MOST + HotSpot::MOST;
/// Pairs of terms of `OffsetSeries` that a frame holds: f32 knows no more.
pub const OFFSET_PAIRS: usize = 8;
