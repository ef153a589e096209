// SPDX-License-Identifier: MIT OR Apache-2.0
// The words of a picture of the sky, of which one binding holds all that a dispatch reads.

#import sky/level

@group(0) @binding(1) var<storage, read> source_words: array<u32>;

// The place of the first word of row `y`, for `source_word`.
fn source_row(y: u32) -> u32 {
    return y * level.source_row - level.source_begin;
}

// A word of row `y`.
fn source_word(y: u32, at: u32) -> u32 {
    return source_words[at];
}
