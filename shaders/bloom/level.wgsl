// SPDX-License-Identifier: MIT OR Apache-2.0
// Bloom: a grid of mean light over a finer one, which for the finest grid is the frame itself. Mirrors
// src/film/bloom.rs, where the formulas, sources and reasons are.

struct BloomLevel {
    // Sizes of the finer grid, and of this one.
    fine: vec2<u32>,
    cells: vec2<u32>,
    // Where in the frame the texture of its light begins, pixels.
    origin: vec2<i32>,
    // The cells that are gathered in this dispatch: the first, and how many.
    first: vec2<u32>,
    count: vec2<u32>,
    // Factors on the finer grid's own light, and on what it gets from this grid.
    own: f32,
    above: f32,
    // How much there is of the finer grid's last cells in a row and in a column, the very last one last.
    tail_x: vec4<f32>,
    tail_y: vec4<f32>,
}
