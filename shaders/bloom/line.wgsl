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

// The rows that cell `j` along the axis lies beyond the first one's: the nearest whole number.
fn whole_rows(j: u32) -> i32 {
    return (line.slope * i32(j) + 32768) >> 16u;
}

// The shares that the row before that, it, and the next have of cell `j`.
fn row_shares(j: u32) -> vec3<f32> {
    let beyond = f32(line.slope * i32(j) - whole_rows(j) * 65536) / 65536.0;
    let before = 0.5 - beyond;
    let after = 0.5 + beyond;
    return vec3<f32>(0.5 * before * before, 0.75 - beyond * beyond, 0.5 * after * after);
}

// The number of rows that are kept of every element.
fn stored_rows() -> i32 {
    return i32(line.across + 2u * line.step + 2u);
}

// Where the light of an element in a sheared row is kept, rows across from the first one kept.
fn row_kept(element: u32, row: i32) -> i32 {
    return row + whole_rows(element * line.step) + i32(line.step) + 1;
}
