// SPDX-License-Identifier: MIT OR Apache-2.0
// The list of a tile's pixels whose own rays matter is summed along, at half resolution: traced/fill.wgsl writes it,
// traced/listed.wgsl reads it. Knows no matter.

#import shared/pass

struct OwnRays {
    // One for each sample of the submission.
    counts: array<atomic<u32>, 16>,
    // x in the low half, y in the high half; one sample's take the places of those before.
    pixels: array<u32>,
}

@group(1) @binding(0) var<storage, read_write> own_rays: OwnRays;

// Room for so many pixels: the place of the first.
fn take_own_rays(count: u32) -> u32 {
    return atomicAdd(&own_rays.counts[pass_.slot], count);
}

fn note_own_ray(i: u32, id: vec2<u32>) {
    own_rays.pixels[i] = id.x | (id.y << 16u);
}

fn own_ray_count() -> u32 {
    return min(atomicLoad(&own_rays.counts[pass_.slot]), arrayLength(&own_rays.pixels));
}

fn own_ray(i: u32) -> vec2<u32> {
    let place = own_rays.pixels[i];
    return vec2<u32>(place & 0xffffu, place >> 16u);
}
