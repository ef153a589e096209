// SPDX-License-Identifier: MIT OR Apache-2.0
// The light of the emitters in the equatorial plane. Mirrors `PlaneLight` of src/emit/mod.rs; an emitter more is called
// here.

#import emit/disk
#import emit/shift
#import records/record

// The light that a crossing adds to a ray of which the share `open` comes this far, without structure; w: the share of
// the light behind that it hides. `mu`: |cosine| of the ray's angle to the normal of the plane, as the matter sees it.
fn emitted_at_crossing(crossing: Crossing, shift: Shift, mu: f32, open: f32) -> vec4<f32> {
    return disk_at_crossing(crossing, shift, mu, open);
}

// The factor by which the emitters' structure changes the light of a crossing.
fn structure_at_crossing(crossing: Crossing) -> f32 {
    return disk_structure(crossing);
}

// The share of the light from behind that a crossing hides.
fn plane_opacity(crossing: Crossing) -> f32 {
    return disk_opacity(crossing, disk_profile(crossing.u));
}
