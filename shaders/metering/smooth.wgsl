// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: smooths the counts of blocks across blocks and stops, into weights and weights times stops, in a workgroup
// for each block with a thread for each stop.

#import constants
#import metering/params

@group(0) @binding(0) var<uniform> meter: MeterParams;
@group(0) @binding(1) var<storage, read> counts: array<vec2<i32>>;
@group(0) @binding(2) var smoothed: texture_storage_3d<rgba16float, write>;

var<workgroup> sums: array<vec2<f32>, BLOCK_STOPS>;

// The weight of what was counted at a stop, and its weight times stop.
fn weighted(sum: vec2<f32>, stop: f32) -> vec2<f32> {
    return vec2<f32>(sum.x, sum.x * (stop - BLOCK_MIDDLE) + sum.y);
}

@compute @workgroup_size(BLOCK_STOPS)
fn smooth_blocks(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) stop: u32) {
    // A table that is indexed has to be a variable.
    var shares = BLOCK_SHARES;
    var sum = vec2<f32>(0.0);
    for (var dy = -2; dy <= 2; dy += 1) {
        for (var dx = -2; dx <= 2; dx += 1) {
            let place = vec2<i32>(block.xy) + vec2<i32>(dx, dy);
            if all(place >= vec2<i32>(0)) && all(place < vec2<i32>(meter.blocks)) {
                let count = counts[(u32(place.y) * meter.blocks.x + u32(place.x)) * BLOCK_STOPS + stop];
                sum += shares[abs(dy)] * shares[abs(dx)] * vec2<f32>(count);
            }
        }
    }
    sums[stop] = sum;
    workgroupBarrier();
    let scale = BLOCK_WEIGHT / (CELL_PARTS * f32(meter.side * meter.side));
    var found = STOP_SHARES.x * weighted(sum, f32(stop));
    if stop > 0u {
        found += STOP_SHARES.y * weighted(sums[stop - 1u], f32(stop) - 1.0);
    }
    if stop + 1u < BLOCK_STOPS {
        found += STOP_SHARES.y * weighted(sums[stop + 1u], f32(stop) + 1.0);
    }
    textureStore(smoothed, vec3<u32>(block.xy, stop), vec4<f32>(scale * found, 0.0, 0.0));
}
