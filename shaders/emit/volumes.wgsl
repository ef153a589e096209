// SPDX-License-Identifier: MIT OR Apache-2.0
// The emitters with depth, along a ray while it is traced. Mirrors `Emitters::along` of src/emit/mod.rs and
// `Medium::add_part` of src/emit/medium.rs; an emitter more is called here.

#import constants
#import emit/haze
#import emit/medium
#import geodesic/geodesic
#import geodesic/integrator
#import geodesic/trace
#import shared/frame

// The medium since the last crossing that was kept.
var<private> medium: vec4<f32>;

// Emission and, in w, absorption of all matter per unit of affine length at a place.
fn matter_at(c: Constants, there: State, ratio: f32) -> vec4<f32> {
    return haze_matter(c, there, ratio);
}

// Adds the matter along a part of a ray to the medium: the step that begins at `from_state`, from `begin` to `end` in
// tau since then. `ratio`: nu(camera) / nu(local frame).
fn add_part(c: Constants, from_state: State, begin: f32, end: f32, ratio: f32) {
    // Half of sqrt(3/5): the places of Gauss and Legendre, good to the fifth degree.
    const OFFSET: f32 = 0.3872983346207417;
    let u = step_ray(c, from_state, begin).state.u;
    let v = step_ray(c, from_state, end).state.u;
    let count = pieces(u, v);
    let size = (end - begin) / f32(count);
    for (var i = 0u; i < 3u * count; i += 1u) {
        let place = i % 3u;
        let x = f32(i / 3u) + 0.5 + OFFSET * (f32(place) - 1.0);
        let weight = select(5.0 / 18.0, 8.0 / 18.0, place == 1u) * size;
        let there = step_ray(c, from_state, begin + size * x).state;
        // No matter is past infinity (u <= 0), where the last step of a ray may end, nor within the horizon.
        if there.u > 0.0 && there.u < 1.0 / c.r_plus {
            let a_cosine = c.a * there.n.z;
            // d lambda / d tau = Sigma (`Part::length`).
            let length = weight * c.nu_local * (1.0 / (there.u * there.u) + a_cosine * a_cosine);
            let matter = matter_at(c, there, ratio) * length;
            medium = medium_with(medium, matter.xyz, matter.w);
        }
    }
}

// The number of pieces that a part between two places is cut into.
fn pieces(u: f32, v: f32) -> u32 {
    let least = 0.01 * max(max(u, v), 1e-30);
    let change = abs(log(max(u, least) / max(v, least)));
    // u32 of NaN may be any number.
    return clamp(u32(min(ceil(change / PIECE), f32(MOST_PIECES))), 1u, MOST_PIECES);
}
