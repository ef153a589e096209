// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: makes the records of the pixels that records/each_pixel.wgsl deferred, and hands each to take_record.

#import lens/kerr_record
#import records/record
#import shared/not_inlined
#import shared/pass
#requires fn ray_record(id: vec2<u32>) -> Record
#requires fn take_record(id: vec2<u32>, record: Record)

const DEFERRED_GROUP: u32 = 64u;

@compute @workgroup_size(DEFERRED_GROUP)
fn each_deferred(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    unknown_zero = id.z;
    let count = min(atomicLoad(&deferred.counts[pass_.slot]), arrayLength(&deferred.pixels));
    for (var i = id.x; i < count; i += groups.x * DEFERRED_GROUP) {
        let place = deferred.pixels[i];
        let pixel = vec2<u32>(place & 0xffffu, place >> 16u);
        take_record(pixel, ray_record(pixel));
    }
}
