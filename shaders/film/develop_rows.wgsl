// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: does what film/develop.wgsl does, for film/packed_rows.wgsl.

#import constants
#import film/packed_rows
#import shared/not_inlined
#import shared/pass
#requires fn tile_light(id: vec2<u32>) -> vec4<f32>

@group(0) @binding(0) var<uniform> pass_: Pass;

@compute @workgroup_size(32, 4)
fn develop_tile(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) i: u32) {
    unknown_zero = group.z;
    let corner = group.xy * vec2<u32>(ROWS_WIDTH, ROWS_PIXELS / ROWS_WIDTH);
    let id = corner + vec2<u32>(i % ROWS_WIDTH, i / ROWS_WIDTH);
    rows_index = i;
    if !outside_tile(id) {
        write_pixel(id, tile_light(id));
    }
    workgroupBarrier();
    write_rows(corner, i);
}
