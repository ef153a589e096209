// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: each cell of a grid takes the mean of what the finer cells, or pixels, about it give it of their light.

#import bloom/level
#import shared/f16

// The number of finer cells along a cell's side; it is even.
override STEP: i32 = 2;
// True: the finer grid's cells are gathered, weighted by the spline. False: pixels are, weighted by their distance from
// the cells' centres.
override GRID: bool = true;

@group(0) @binding(0) var<uniform> level: BloomLevel;
@group(0) @binding(1) var finer: texture_2d<f32>;
@group(0) @binding(2) var smooth_: sampler;
@group(0) @binding(3) var gathered: texture_storage_2d<rgba16float, write>;

// The weight of tap `tap`, wherever the cell lies; 0 beyond the taps.
fn kernel(tap: i32) -> f32 {
    if GRID {
        let from_end = min(tap, 5 - tap);
        let inner = select(10.0, 5.0, from_end == 1) / 16.0;
        return select(select(inner, 1.0 / 16.0, from_end == 0), 0.0, from_end < 0);
    }
    let from_end = min(f32(tap) + 0.5, f32(2 * STEP - tap) - 0.5);
    return max(from_end, 0.0) / f32(STEP);
}

// How much there is of the finer cell that is `from_end` before the last.
fn coverage(from_end: i32, tail: vec4<f32>) -> f32 {
    if !GRID {
        return 1.0;
    }
    let last = select(tail.z, tail.w, from_end == 0);
    return select(select(1.0, tail.y, from_end == 2), last, from_end < 2);
}

// The weight of tap `tap`, which is finer cell `i`, along one side of a cell. The share that would go to a missing cell
// stays with the pixel's own cell.
fn tap_weight(tap: i32, i: i32, cell: i32, cells: u32, fine: u32, tail: vec4<f32>) -> f32 {
    let own = i / STEP == cell;
    let before = select(0.0, kernel(tap + STEP), own && cell == 0);
    let after = select(0.0, kernel(tap - STEP), own && cell + 1 == i32(cells));
    let there = i >= 0 && i < i32(fine);
    return select(0.0, (kernel(tap) + before + after) * coverage(i32(fine) - 1 - i, tail), there);
}

// The light of finer cells at a place between their centres, which lie at whole numbers.
fn between(place: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(finer, smooth_, (place + 0.5) / vec2<f32>(textureDimensions(finer)), 0.0).xyz;
}

// The light that a cell gathers from a grid whose ends are far away: of the six finer cells along a side, which give
// 1 5 10 10 5 1 parts of 32, each two are one sample.
fn gathered_within(cell: vec2<i32>) -> vec3<f32> {
    let middle = vec2<f32>(2 * cell) + 0.5;
    const REACH: f32 = 5.0 / 3.0;
    let rows = vec3<f32>(middle.y - REACH, middle.y, middle.y + REACH);
    var sum = vec3<f32>(0.0);
    for (var i = 0u; i < 3u; i += 1u) {
        let y = rows[i];
        let sides = between(vec2<f32>(middle.x - REACH, y)) + between(vec2<f32>(middle.x + REACH, y));
        sum += select(6.0, 20.0, i == 1u) * (6.0 * sides + 20.0 * between(vec2<f32>(middle.x, y)));
    }
    return sum / 1024.0;
}

@compute @workgroup_size(8, 16)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= level.count) {
        return;
    }
    let most = select(2 * STEP, 6, GRID);
    let cell = vec2<i32>(level.first + id.xy);
    let corner = STEP * cell - (most - STEP) / 2;
    let last = vec2<i32>(level.fine) - 1;
    // No taps where samples do, which software drivers take as well.
    let within = GRID && all(cell > vec2<i32>(0)) && all(corner + 5 < last - 2);
    // Only those in the frame, which in wide and low frames are few: lavapipe leaves the loops of a thread after 65535
    // turns.
    let first = max(-corner, vec2<i32>(0));
    let taps = select(min(vec2<i32>(most), last + 1 - corner), vec2<i32>(0), within);
    var sum = vec3<f32>(0.0);
    var weights = 0.0;
    for (var y = first.y; y < taps.y; y += 1) {
        let row = corner.y + y;
        let down = tap_weight(y, row, cell.y, level.cells.y, level.fine.y, level.tail_y);
        for (var x = first.x; x < taps.x; x += 1) {
            let column = corner.x + x;
            let weight = down * tap_weight(x, column, cell.x, level.cells.x, level.fine.x, level.tail_x);
            let place = clamp(vec2<i32>(column, row), vec2<i32>(0), last) - level.origin;
            sum += weight * textureLoad(finer, place, 0).xyz;
            weights += weight;
        }
    }
    if within {
        sum = gathered_within(cell);
        weights = 1.0;
    }
    textureStore(gathered, level.first + id.xy, rounded_to_f16(vec4<f32>(sum / weights, 1.0)));
}
