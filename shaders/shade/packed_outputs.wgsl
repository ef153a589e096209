// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes all outputs of a tile into one buffer, for the host, whichever are wanted. For outputs that go to targets on
// the GPU src/gpu/kernel/wgsl.rs writes the same functions, for those that are wanted.

#import shade/wanted
#import shared/not_inlined

@group(2) @binding(1) var<storage, read_write> output_words: array<u32>;

// OUTPUT_*; the crossing that it is of; its numbers a pixel; 0.
fn wanted_output(k: u32) -> vec4<u32> {
    return outputs.wanted[k];
}

fn output_count() -> u32 {
    return outputs.count;
}

// How many crossings of a ray are asked for, unless the scene shows fewer.
fn output_crossings() -> u32 {
    return not_inlined(outputs.crossings);
}

fn put_numbers(k: u32, at: u32, place: vec2<u32>, bits: vec4<u32>) {
    output_words[at] = bits.x;
    if outputs.wanted[k].z == 4u {
        output_words[at + 1u] = bits.y;
        output_words[at + 2u] = bits.z;
        output_words[at + 3u] = bits.w;
    }
}
