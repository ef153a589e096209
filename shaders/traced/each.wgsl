// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: traces each pixel of a tile's rectangle.

#import shared/not_inlined
#import shared/pass
#import traced/pixels

@compute @workgroup_size(16, 8)
fn trace_pixels(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    if id.x >= pass_.size.x || id.y >= pass_.size.y {
        return;
    }
    trace_pixel(id.xy, vec2<f32>(pass_.origin + vec2<i32>(id.xy)) + pass_.offset);
}
