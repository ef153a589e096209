// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: sums the matter along the rays of the pixels that traced/fill.wgsl listed.

#import shared/not_inlined
#import shared/pass
#import traced/own_rays
#import traced/pixels

const OWN_GROUP: u32 = 64u;

@compute @workgroup_size(OWN_GROUP)
fn trace_listed(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    unknown_zero = id.z;
    let count = own_ray_count();
    for (var i = id.x; i < count; i += groups.x * OWN_GROUP) {
        let texel = own_ray(i) + 1u;
        trace_pixel(texel, vec2<f32>(pass_.origin + vec2<i32>(texel)) + pass_.offset);
        keep_nothing_more();
    }
}
