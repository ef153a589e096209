// SPDX-License-Identifier: MIT OR Apache-2.0
// Words of uniforms that by themselves decide an `if`, a `switch` or a loop's end go through `not_inlined`. Knows no
// other file; used by kernels, which set `unknown_zero` first.
//
// Why: Mesa's lavapipe (22.3: lvp_inline_uniforms.c, update_inline_shader_state in lvp_execute.c) looks, in kernels of
// more than 100 values, for branches whose condition is made of nothing but constants and 32-bit words of uniform
// buffers, a loop's counter aside. For a kernel that has one it compiles a new one whenever a uniform is bound, so in
// every submission, and keeps it as long as the device lives: 0.5 to 4 MiB and up to 0.25 s a frame. (It stops after a
// binding whose values made the kernel a little smaller, which is why it may not show. What it puts in place of the
// word is, by a slip in the stride of its table, the first word of the buffer; and for a fourth uniform buffer it
// writes beyond the table, and the first dispatch crashes.) What a `select`, or an `if` short enough to become one,
// depends on does not matter.

// Set this to the z of workgroup_id or global_invocation_id at the entry point: 0, as every dispatch is one workgroup
// deep, but no compiler knows; and the same for all threads, so that a GPU's branch stays uniform.
var<private> unknown_zero: u32;

fn not_inlined(word: u32) -> u32 {
    // `unknown_zero` comes first: lavapipe notes the words that it meets in a condition before it meets what is not
    // one.
    return unknown_zero + word;
}
