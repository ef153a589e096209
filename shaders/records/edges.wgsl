// SPDX-License-Identifier: MIT OR Apache-2.0
// The list of a tile's pixels that edges run through. The kernels that shade pixels write it, refine/refine.wgsl reads
// it. Knows no light.

#import constants
#import records/record
#import shared/pass

struct Edges {
    // Three numbers for each sample of the submission: of pixels with EDGE_DISK, which fill `pixels` from its begin; of
    // pixels with EDGE_CURVE, which fill it from its end; and of those of EDGE_DISK that turned out to need what the
    // others get, which follow them.
    counts: array<atomic<u32>, 48>,
    // x in the low half, y in the high half.
    pixels: array<u32>,
}

@group(3) @binding(0) var<storage, read_write> edges: Edges;

const LIST_DISK: u32 = 0u;
const LIST_CURVE: u32 = 1u;
const LIST_RAGGED: u32 = 2u;

// The place of a list's count.
fn list_place(list: u32) -> u32 {
    return 3u * pass_.slot + list;
}

fn note_edges(id: vec2<u32>, kind: u32) {
    let place = id.x | (id.y << 16u);
    if kind == EDGE_DISK {
        let i = atomicAdd(&edges.counts[list_place(LIST_DISK)], 1u);
        edges.pixels[i] = place;
    }
    if kind == EDGE_CURVE {
        let i = atomicAdd(&edges.counts[list_place(LIST_CURVE)], 1u);
        edges.pixels[arrayLength(&edges.pixels) - 1u - i] = place;
    }
}

// Once no pixel is listed any more but these.
fn note_ragged(id: vec2<u32>) {
    let i = atomicLoad(&edges.counts[list_place(LIST_CURVE)]) + atomicAdd(&edges.counts[list_place(LIST_RAGGED)], 1u);
    edges.pixels[arrayLength(&edges.pixels) - 1u - i] = id.x | (id.y << 16u);
}

// The numbers of the list's first pixel and of the one behind its last.
fn listed_pixels(list: u32) -> vec2<u32> {
    let count = atomicLoad(&edges.counts[list_place(list)]);
    var before = 0u;
    if list == LIST_RAGGED {
        before = atomicLoad(&edges.counts[list_place(LIST_CURVE)]);
    }
    return min(vec2<u32>(before, before + count), vec2<u32>(arrayLength(&edges.pixels)));
}

// Pixel `i` of a list.
fn listed_pixel(list: u32, i: u32) -> vec2<u32> {
    let place = edges.pixels[select(arrayLength(&edges.pixels) - 1u - i, i, list == LIST_DISK)];
    return vec2<u32>(place & 0xffffu, place >> 16u);
}
