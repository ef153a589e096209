// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: spreads the light of a grid's cells by the beam's Gaussian, along rows or along columns. Mirrors
// src/film/bloom/beam.rs, where the formulas, sources and reasons are.

#import constants
#import shared/f16

struct BeamPass {
    cells: vec2<u32>,
    // From a cell to the next one along a row or a column.
    next: vec2<i32>,
    // BEAM_SHARES numbers; the first is half of its share, because it is taken twice.
    shares: array<vec4<f32>, BEAM_QUARTERS>,
}

@group(0) @binding(0) var<uniform> beam: BeamPass;
@group(0) @binding(1) var cells: texture_2d<f32>;
@group(0) @binding(2) var spread: texture_storage_2d<rgba16float, write>;

// The light of a cell; beyond the grid's borders, which mirror it.
fn light_at(place: vec2<i32>) -> vec3<f32> {
    let count = beam.cells;
    // Not below 0, where GLSL leaves % undefined.
    let turn = vec2<u32>(place + 8 * BEAM_QUARTERS * vec2<i32>(count)) % (2u * count);
    return textureLoad(cells, select(turn, 2u * count - 1u - turn, turn >= count), 0).xyz;
}

// The light of the two cells that are so far away on both sides.
fn both_sides(here: vec2<i32>, away: i32) -> vec3<f32> {
    return light_at(here - away * beam.next) + light_at(here + away * beam.next);
}

@compute @workgroup_size(8, 16)
fn spread_beam(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= beam.cells) {
        return;
    }
    let here = vec2<i32>(id.xy);
    var sum = vec3<f32>(0.0);
    for (var quarter = 0; quarter < BEAM_QUARTERS; quarter += 1) {
        let shares = beam.shares[quarter];
        let away = 4 * quarter;
        sum += shares.x * both_sides(here, away) + shares.y * both_sides(here, away + 1)
            + shares.z * both_sides(here, away + 2) + shares.w * both_sides(here, away + 3);
    }
    textureStore(spread, id.xy, rounded_to_f16(vec4<f32>(sum, 1.0)));
}
