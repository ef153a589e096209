// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes all outputs of a tile into one buffer, for the host. For outputs that go to targets on the GPU
// src/gpu/kernel/wgsl.rs writes the same function.

#import shade/wanted

@group(2) @binding(1) var<storage, read_write> output_words: array<u32>;

fn put_numbers(k: u32, at: u32, place: vec2<u32>, bits: vec4<u32>) {
    output_words[at] = bits.x;
    if outputs.wanted[k].z == 4u {
        output_words[at + 1u] = bits.y;
        output_words[at + 2u] = bits.z;
        output_words[at + 3u] = bits.w;
    }
}
