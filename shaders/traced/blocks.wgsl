// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: traces the blocks that the pixels of a tile get their matter from (emit/half.wgsl) into textures of their
// own, whose first texel is the first block's.

#import emit/half
#import shared/not_inlined
#import shared/pass
#import traced/pixels

@compute @workgroup_size(16, 8)
fn trace_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    // The rectangle's border has no matter of its own.
    let end = pass_.origin + vec2<i32>(pass_.size) - 2;
    let block = vec2<i32>(first_block(pass_.origin.x + 1), first_block(pass_.origin.y + 1)) + vec2<i32>(id.xy);
    if block.x > first_block(end.x) + 3 || block.y > first_block(end.y) + 3 {
        return;
    }
    trace_pixel(id.xy, vec2<f32>(block_place(block.x, pass_.offset.x), block_place(block.y, pass_.offset.y)));
}
