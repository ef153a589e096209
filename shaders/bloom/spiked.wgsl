// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: adds the light of a line to what the finest grid spreads already. Mirrors src/film/bloom/spikes.rs.

#import bloom/line
#import shared/f16

@group(0) @binding(0) var<uniform> line: SpikeLine;
@group(0) @binding(1) var glare: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> sheared: array<vec4<f32>>;
@group(0) @binding(3) var spread: texture_storage_2d<rgba16float, write>;

// The light of an element in a sheared row.
fn kept_light(element: u32, row: i32) -> vec3<f32> {
    return sheared[element * line.next_along + u32(row_kept(element, row)) * line.next_across].xyz;
}

@compute @workgroup_size(8, 16)
fn add_line(@builtin(global_invocation_id) id: vec3<u32>) {
    let steep = line.steep == 1u;
    let j = select(id.x, id.y, steep);
    let i = select(id.y, id.x, steep);
    if j >= line.along || i >= line.across {
        return;
    }
    let element = j / line.step;
    let row = i32(i) - whole_rows(j);
    let shares = row_shares(j);
    let light = shares.x * kept_light(element, row + 1) + shares.y * kept_light(element, row)
        + shares.z * kept_light(element, row - 1);
    let sum = line.above * textureLoad(glare, id.xy, 0).xyz + light;
    textureStore(spread, id.xy, rounded_to_f16(vec4<f32>(sum, 1.0)));
}
