// SPDX-License-Identifier: MIT OR Apache-2.0
// A level of a sky map's pyramid, some of whose rows a dispatch makes.

struct SkyLevel {
    size: vec2<u32>,
    source_size: vec2<u32>,
    // Words from row to row, of what is read and of what is written.
    source_row: u32,
    row: u32,
    // SKY_SOURCE_*.
    source: u32,
    // 1: the source is a cube's six faces side by side.
    cube: u32,
    // The words before those that are bound, of what is read and of what is written.
    source_begin: u32,
    begin: u32,
    // The first row that is made.
    first_row: u32,
    // Rows of each part of a source in parts.
    part_rows: u32,
}

@group(0) @binding(0) var<uniform> level: SkyLevel;
