// SPDX-License-Identifier: MIT OR Apache-2.0
// The last cells of a grid, which may lie in the frame in part. Mirrors src/film/bloom.rs.

// The part of the cell that is `from_end` before the last one that lies in the frame.
fn covered(from_end: i32, tail: vec4<f32>) -> f32 {
    let last = select(select(tail.y, tail.z, from_end == 1), tail.w, from_end == 0);
    return select(select(1.0, tail.x, from_end == 3), last, from_end < 3);
}
