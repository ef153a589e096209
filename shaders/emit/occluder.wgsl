// SPDX-License-Identifier: MIT OR Apache-2.0
// The host's things before a pixel, as a distance. Mirrors `Shown` of src/scene/occluder.rs. Knows no crossing and no
// matter.

#import camera/observer
#import camera/projection
#import constants
#import shared/frame

// Distances of the host's things, scene lengths: with OCCLUDED a texel for each pixel of the image, else one.
@group(0) @binding(9) var occluder: texture_2d<f32>;

// The host has things before the camera.
override OCCLUDED: bool = false;

// The farthest that light of the direct image comes from, M, and whether the ray ends there.
var<private> occluder_farthest: f32;
var<private> occluder_ends: bool;
// The ray that is traced has ended there.
var<private> occluder_passed: bool;

// 1/r between which a crossing hides the rest of the ray of the sample at hand: everywhere that the disk is opaque, but
// where the host's things may hide the crossing itself.
fn opaque_u_at() -> vec2<f32> {
    return select(frame.opaque_u, vec2<f32>(1.0, 0.0), OCCLUDED && occluder_farthest < BEYOND_ALL);
}

// Goes to the sample at `place` of the full frame.
fn set_occluder(place: vec2<f32>) {
    let size = vec2<i32>(textureDimensions(occluder));
    let texel = clamp(vec2<i32>(floor(place)) - vec2<i32>(frame.occluder_origin), vec2<i32>(0), size - 1);
    occluder_farthest = textureLoad(occluder, texel, 0).x / frame.hole_mass;
    let closest = closest_approach(aberrate(look_direction(place.x, place.y)).n);
    occluder_ends = occluder_farthest < select(closest, NO_THING, frame.occluder_lensed > 0.0);
    occluder_passed = false;
}
