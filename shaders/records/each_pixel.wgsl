// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: makes the record of each pixel of a tile, and hands it to take_record.

#import records/record
#import shared/not_inlined
#import shared/fate
#import shared/pass
#requires fn ray_record(id: vec2<u32>) -> Record
#requires fn defer_pixel(id: vec2<u32>)
#requires fn take_record(id: vec2<u32>, record: Record)

// Threads that run together, 32 or on software drivers 8, take pixels that lie together: 8 x 4, or 4 x 2.
@compute @workgroup_size(8, 16)
fn each_pixel(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) i: u32) {
    unknown_zero = group.z;
    let x = (i & 3u) | ((i >> 1u) & 4u);
    let y = ((i >> 2u) & 1u) | ((i >> 3u) & 14u);
    let id = group.xy * vec2<u32>(8u, 16u) + vec2<u32>(x, y);
    if outside_tile(id) {
        return;
    }
    let record = ray_record(id);
    if record.fate == FATE_PENDING {
        defer_pixel(id);
    } else {
        take_record(id, record);
    }
}
