// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: the steps of all rays of a traced rectangle, summed. In a pass of its own: a barrier or an atomic for every
// pixel would cost the tracing kernel more than this does.

#import constants
#import shared/pass
#import traced/layout

@group(0) @binding(0) var<uniform> pass_: Pass;
@group(0) @binding(1) var record_meta: texture_2d<u32>;
@group(0) @binding(2) var<storage, read_write> step_sum: atomic<u32>;

var<workgroup> group_sum: atomic<u32>;

@compute @workgroup_size(8, 16)
fn count_steps(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    if local == 0u {
        atomicStore(&group_sum, 0u);
    }
    workgroupBarrier();
    var sum = 0u;
    if id.y < pass_.size.y {
        let begin = id.x * COUNT_RUN;
        let end = min(begin + COUNT_RUN, pass_.size.x);
        for (var x = begin; x < end; x += 1u) {
            sum += unpack_meta(textureLoad(record_meta, vec2<u32>(x, id.y), 0)).steps;
        }
    }
    atomicAdd(&group_sum, sum);
    workgroupBarrier();
    if local == 0u {
        atomicAdd(&step_sum, atomicLoad(&group_sum));
    }
}
