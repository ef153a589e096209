// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: takes the distances of the host's things out of a buffer whose rows lie as no copy into a texture takes them.

struct OccluderRows {
    size: vec2<u32>,
    // Words from row to row, and those before the ones that are bound.
    row: u32,
    begin: u32,
    // The first row that is taken.
    first_row: u32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> rows: OccluderRows;
@group(0) @binding(1) var<storage, read> distances: array<u32>;
@group(0) @binding(2) var taken: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 16)
fn take_distances(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= rows.size.x || id.y >= rows.size.y {
        return;
    }
    let place = vec2<u32>(id.x, id.y + rows.first_row);
    let distance = bitcast<f32>(distances[place.y * rows.row - rows.begin + place.x]);
    textureStore(taken, place, vec4<f32>(distance, 0.0, 0.0, 1.0));
}
