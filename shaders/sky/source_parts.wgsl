// SPDX-License-Identifier: MIT OR Apache-2.0
// The words of a picture of the sky that is larger than a binding: six of them hold its rows, each as many.

#import sky/level

@group(0) @binding(1) var<storage, read> source_part_0: array<u32>;
@group(0) @binding(3) var<storage, read> source_part_1: array<u32>;
@group(0) @binding(4) var<storage, read> source_part_2: array<u32>;
@group(0) @binding(5) var<storage, read> source_part_3: array<u32>;
@group(0) @binding(6) var<storage, read> source_part_4: array<u32>;
@group(0) @binding(7) var<storage, read> source_part_5: array<u32>;

// The place of the first word of row `y`, for `source_word`.
fn source_row(y: u32) -> u32 {
    return (y % level.part_rows) * level.source_row;
}

// A word of row `y`.
fn source_word(y: u32, at: u32) -> u32 {
    switch y / level.part_rows {
        case 0u: { return source_part_0[at]; }
        case 1u: { return source_part_1[at]; }
        case 2u: { return source_part_2[at]; }
        case 3u: { return source_part_3[at]; }
        case 4u: { return source_part_4[at]; }
        default: { return source_part_5[at]; }
    }
}
