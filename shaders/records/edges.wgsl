// SPDX-License-Identifier: MIT OR Apache-2.0
// The list of a tile's pixels that edges run through. The kernels that shade pixels write it, refine/refine.wgsl reads
// it. Knows no light.

#import constants
#import records/record
#import shared/pass

struct Edges {
    // Two numbers for each sample of the submission: of pixels with EDGE_DISK, which fill `pixels` from its begin, and
    // of pixels with EDGE_CURVE, which fill it from its end.
    counts: array<atomic<u32>, 32>,
    // x in the low half, y in the high half.
    pixels: array<u32>,
}

@group(3) @binding(0) var<storage, read_write> edges: Edges;

// The place of a list's count; list 0 is that of EDGE_DISK, list 1 that of EDGE_CURVE.
fn list_place(list: u32) -> u32 {
    return 2u * pass_.slot + list;
}

fn note_edges(id: vec2<u32>, kind: u32) {
    let place = id.x | (id.y << 16u);
    if kind == EDGE_DISK {
        let i = atomicAdd(&edges.counts[list_place(0u)], 1u);
        edges.pixels[i] = place;
    }
    if kind == EDGE_CURVE {
        let i = atomicAdd(&edges.counts[list_place(1u)], 1u);
        edges.pixels[arrayLength(&edges.pixels) - 1u - i] = place;
    }
}

// Pixel `i` of the list that `counts[kind]` counts.
fn listed_pixel(kind: u32, i: u32) -> vec2<u32> {
    let place = edges.pixels[select(i, arrayLength(&edges.pixels) - 1u - i, kind == 1u)];
    return vec2<u32>(place & 0xffffu, place >> 16u);
}
