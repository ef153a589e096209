// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: draws the ghosts of a lens, each cell of their grid from the light whose images lie there: four threads, each
// by every fourth row of the source, as cells in the frame's middle have all ghosts. Mirrors src/film/bloom/ghosts.rs.

#import bloom/flare
#import constants
#import shared/f16

@group(0) @binding(0) var<uniform> flare: GhostNumbers;
@group(0) @binding(1) var reflected_light: texture_2d<f32>;
@group(0) @binding(2) var drawn: texture_storage_2d<rgba16float, write>;

const THREADS_A_CELL: u32 = 4u;
const ACROSS: u32 = 8u;
const DOWN: u32 = 4u;
// The light of the threads of each part.
var<workgroup> parts: array<vec4<f32>, ACROSS * DOWN * THREADS_A_CELL>;

// The source's cells, from and up to, whose images may reach a place.
fn seen(ghost: Ghost, place: vec2<f32>) -> vec4<i32> {
    let middle = (flare.middle + (place - flare.middle) / ghost.magnification) / flare.step - 0.5;
    let reach = ghost.reach / (abs(ghost.magnification) * flare.step);
    let cells = vec2<f32>(flare.source_cells);
    let begin = clamp(ceil(middle - reach), vec2<f32>(0.0), cells);
    let end = clamp(floor(middle + reach) + 1.0, vec2<f32>(0.0), cells);
    return vec4<i32>(vec2<i32>(begin), vec2<i32>(end));
}

// A place in a ghost as the aperture lies, from the middle of the image of a source's cell.
fn offset(ghost: Ghost, place: vec2<f32>, cell: vec2<i32>) -> vec2<f32> {
    let source = (vec2<f32>(cell) + 0.5) * flare.step - flare.middle;
    return sign(ghost.magnification) * (place - flare.middle - ghost.magnification * source);
}

// How much a ghost has of its light at a place, by colour.
fn inside(ghost: Ghost, place: vec2<f32>) -> vec3<f32> {
    var edges = vec2<f32>(0.0);
    for (var pair = 0u; pair < GHOST_PAIRS; pair += 1u) {
        let along = flare.normals[pair] * place.xyxy;
        edges = max(edges, along.xz + along.yw);
    }
    let edge = max(edges.x, edges.y);
    return clamp((ghost.apothems.xyz - edge) / ghost.softness + 0.5, vec3<f32>(0.0), vec3<f32>(1.0));
}

// The light that a cell of the source gives a ghost at a place; none from the column `end` on.
fn cell_light(ghost: Ghost, place: vec2<f32>, cell: vec2<i32>, end: i32) -> vec3<f32> {
    let light = textureLoad(reflected_light, vec2<i32>(min(cell.x, end - 1), cell.y), 0).xyz;
    return select(vec3<f32>(0.0), inside(ghost, offset(ghost, place, cell)) * light, cell.x < end);
}

// The light that a ghost has at a place, from the rows of a part: of every source's cell whose image lies there. Four
// cells at a time, so that none waits for the one before it.
fn ghost_light(ghost: Ghost, place: vec2<f32>, part: u32) -> vec3<f32> {
    let cells = seen(ghost, place);
    var sum = vec3<f32>(0.0);
    for (var y = cells.y + i32(part); y < cells.w; y += i32(THREADS_A_CELL)) {
        for (var x = cells.x; x < cells.z; x += 4) {
            let light0 = cell_light(ghost, place, vec2<i32>(x, y), cells.z);
            let light1 = cell_light(ghost, place, vec2<i32>(x + 1, y), cells.z);
            let light2 = cell_light(ghost, place, vec2<i32>(x + 2, y), cells.z);
            let light3 = cell_light(ghost, place, vec2<i32>(x + 3, y), cells.z);
            sum += (light0 + light1) + (light2 + light3);
        }
    }
    return ghost.shares.xyz * sum;
}

@compute @workgroup_size(ACROSS, DOWN, THREADS_A_CELL)
fn draw_ghosts(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) thread: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
) {
    let cell = group.xy * vec2<u32>(ACROSS, DOWN) + thread.xy;
    let place = vec2<f32>(cell) + 0.5;
    var sum = vec3<f32>(0.0);
    for (var i = 0u; i < min(flare.count, MOST_GHOSTS); i += 1u) {
        sum += ghost_light(flare.ghosts[i], place, thread.z);
    }
    parts[index] = vec4<f32>(sum, 1.0);
    workgroupBarrier();
    if thread.z == 0u && all(cell < flare.target_cells) {
        const NEXT: u32 = ACROSS * DOWN;
        let light = (parts[index] + parts[index + NEXT]) + (parts[index + 2u * NEXT] + parts[index + 3u * NEXT]);
        textureStore(drawn, cell, rounded_to_f16(vec4<f32>(light.xyz, 1.0)));
    }
}
