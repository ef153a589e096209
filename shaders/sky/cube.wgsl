// SPDX-License-Identifier: MIT OR Apache-2.0
// Light of a picture of the sky on the six faces of a cube, side by side as BHR_PROJECTION_CUBE has them
// (src/scene/projection.rs): right, left, up, down, front, back. Knows no formats and no pyramid.

#requires fn source_light(x: u32, y: u32) -> vec3<f32>

// The direction, of any length, of a place on a face: (right, up) of its middle, -1 .. 1. Beyond the face its plane
// goes on.
fn face_direction(face: u32, at: vec2<f32>) -> vec3<f32> {
    let s = select(1.0, -1.0, (face & 1u) == 1u);
    let ahead = vec3<f32>(s * at.x, at.y, s);
    let beside = vec3<f32>(s, at.y, -s * at.x);
    let above = vec3<f32>(at.x, s, -s * at.y);
    return select(select(ahead, above, face < 4u), beside, face < 2u);
}

// The face that is seen in a direction.
fn face_of(p: vec3<f32>) -> u32 {
    let size = abs(p);
    let most = max(size.x, max(size.y, size.z));
    var face = select(2u, 3u, p.y < 0.0);
    if size.x == most {
        face = select(0u, 1u, p.x < 0.0);
    }
    if size.z == most {
        face = select(4u, 5u, p.z < 0.0);
    }
    return face;
}

// Where on a face it is seen: the reverse of `face_direction`.
fn face_place(face: u32, p: vec3<f32>) -> vec2<f32> {
    let s = select(1.0, -1.0, (face & 1u) == 1u);
    let ahead = vec3<f32>(s * p.x, p.y, s * p.z);
    let beside = vec3<f32>(-s * p.z, p.y, s * p.x);
    let above = vec3<f32>(p.x, -s * p.z, s * p.y);
    let q = select(select(ahead, above, face < 4u), beside, face < 2u);
    return q.xy / q.z;
}

// A texel of a face of `side` texels; beyond the face the nearest of the one that is seen there.
fn cube_texel(face: u32, x: i32, y: i32, side: u32) -> vec3<f32> {
    let last = i32(side) - 1;
    var seen = face;
    var texel = vec2<i32>(x, y);
    if x < 0 || y < 0 || x > last || y > last {
        let step = 2.0 / f32(side);
        let p = face_direction(face, vec2<f32>((f32(x) + 0.5) * step - 1.0, 1.0 - (f32(y) + 0.5) * step));
        seen = face_of(p);
        let at = face_place(seen, p);
        texel = vec2<i32>(floor(0.5 * f32(side) * vec2<f32>(at.x + 1.0, 1.0 - at.y)));
    }
    let inside = vec2<u32>(clamp(texel, vec2<i32>(0), vec2<i32>(last)));
    return source_light(seen * side + inside.x, inside.y);
}

// The light from a direction, between the four texels about it, of which some may lie on other faces.
fn cube_light(p: vec3<f32>, side: u32) -> vec3<f32> {
    let face = face_of(p);
    let at = face_place(face, p);
    let place = 0.5 * f32(side) * vec2<f32>(at.x + 1.0, 1.0 - at.y) - 0.5;
    let first = vec2<i32>(floor(place));
    let share = place - floor(place);
    let above = mix(cube_texel(face, first.x, first.y, side), cube_texel(face, first.x + 1, first.y, side), share.x);
    let below = mix(cube_texel(face, first.x, first.y + 1, side), cube_texel(face, first.x + 1, first.y + 1, side),
        share.x);
    return mix(above, below, share.y);
}
