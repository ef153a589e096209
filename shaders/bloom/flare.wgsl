// SPDX-License-Identifier: MIT OR Apache-2.0
// The ghosts of a lens: their numbers. Mirrors src/film/bloom/ghosts.rs, where the formulas, sources and reasons are.

#import constants

struct Ghost {
    shares: vec4<f32>,
    apothems: vec4<f32>,
    magnification: f32,
    softness: f32,
    reach: f32,
    reserved: f32,
}

struct GhostNumbers {
    ghosts: array<Ghost, MOST_GHOSTS>,
    normals: array<vec4<f32>, GHOST_PAIRS>,
    tail_x: vec4<f32>,
    tail_y: vec4<f32>,
    middle: vec2<f32>,
    target_cells: vec2<u32>,
    source_cells: vec2<u32>,
    step: f32,
    count: u32,
    fine: f32,
    above: f32,
    reserved: vec2<u32>,
}

// The part of what is reflected that reaches the ghosts: 1 in the middle, 0 at the border and beyond.
fn reflected(place: vec2<f32>, middle: vec2<f32>) -> f32 {
    let away = clamp((place - middle) / middle, vec2<f32>(-1.0), vec2<f32>(1.0));
    let squared = away * away;
    let sides = 1.0 - squared * squared * squared;
    return sides.x * sides.x * sides.y * sides.y;
}
