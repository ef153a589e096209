// SPDX-License-Identifier: MIT OR Apache-2.0
// A line that light is thrown along, and how the finest grid is sheared so that it is a row. Mirrors
// src/film/bloom/spikes.rs, where the formulas, sources and reasons are.

#import constants
#requires var line: SpikeLine

struct SpikeLine {
    weights: array<vec4<f32>, SPIKE_TERMS>,
    decays: vec4<f32>,
    tail_x: vec4<f32>,
    tail_y: vec4<f32>,
    along: u32,
    across: u32,
    slope: i32,
    steep: u32,
    step: u32,
    elements: u32,
    first_row: i32,
    rows: u32,
    next_along: u32,
    next_across: u32,
    share: f32,
    above: f32,
}

// The rows that cell `j` along the axis lies beyond the first one's.
fn whole_rows(j: u32) -> i32 {
    return (line.slope * i32(j)) >> 16u;
}

// The part of a row that cell `j` lies beyond that.
fn part_of_row(j: u32) -> f32 {
    return f32(u32(line.slope * i32(j)) & 0xffffu) / 65536.0;
}

// Where the light of an element in a sheared row is kept, rows across from the first one kept.
fn row_kept(element: u32, row: i32) -> i32 {
    return row + whole_rows(element * line.step) + i32(line.step);
}
