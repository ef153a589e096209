// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of skies in targets: cubes, whose faces are those of the projection CUBE, and the texels of maps.

use super::inputs::{Inputs, Outputs};
use super::{Group, ROUNDING, SAME, twin};
use crate::image::rgb9e5::{limited, pack, unpack};
use crate::scene::Projection;
use crate::scene::projection::{Mapping, turned_to_face};
use glam::{DVec2, DVec3};
use half::f16;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const HEAD: &str = "
#import sky/pyramid
var<private> given: bool;
fn source_row(y: u32) -> u32 { return select(y * level.source_row, 0u, given); }
fn source_word(y: u32, at: u32) -> u32 {
    if given { return word(at); }
    let k = ((at >> 2u) * 7919u + y * 104729u + (at & 3u) * 31337u) % 1021u;
    return bitcast<u32>(f32(k) / 1024.0);
}
fn enter_cube() { level.size = vec2<u32>(64u, 32u); level.source_size = vec2<u32>(96u, 16u);
    level.source = SKY_SOURCE_FLOAT; level.source_row = 0u; }
";

/// Texels along a side.
const SIDE: u32 = 16;

/// The light of a texel of the cube, as `source_word` has it.
fn light(x: u32, y: u32) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|c| f64::from((x * 7919 + y * 104_729 + c * 31_337) % 1021) / 1024.0))
}

fn mapping() -> Mapping {
    let side = f64::from(SIDE);
    Mapping {
        projection: Projection::Cube,
        width: 6.0 * side,
        height: side,
        plane: DVec2::ONE,
        centre: DVec2::ZERO,
        pixel_angle: FRAC_PI_2 / side,
    }
}

/// The face that is seen in a direction, and where on it, in texels.
fn seen(p: DVec3) -> (u32, DVec2) {
    let position = |p: DVec3| mapping().position(p).expect("a cube shows every direction");
    // A place on the border of two faces is the border of the next one as well: the face is that of a place beside it.
    let most = p.abs().max_element();
    let inwards = match p {
        p if p.z.abs() == most => DVec3::new(1.0, 1.0, 1.0 + 1e-9),
        p if p.x.abs() == most => DVec3::new(1.0 + 1e-9, 1.0, 1.0),
        _ => DVec3::new(1.0, 1.0 + 1e-9, 1.0),
    };
    let face = (position(p * inwards).x / f64::from(SIDE)).floor();
    (face as u32, position(p) - DVec2::new(face * f64::from(SIDE), 0.0))
}

/// A texel of a face, or the nearest of the face that is seen beyond it.
fn texel(face: u32, x: i32, y: i32) -> DVec3 {
    let side = SIDE as i32;
    if (0..side).contains(&x) && (0..side).contains(&y) {
        return light(face * SIDE + x as u32, y as u32);
    }
    let step = 2.0 / f64::from(SIDE);
    let at = DVec3::new((f64::from(x) + 0.5) * step - 1.0, 1.0 - (f64::from(y) + 0.5) * step, 1.0);
    let (face, at) = seen(turned_to_face(face as u8, at));
    let inside = at.floor().clamp(DVec2::ZERO, DVec2::splat(f64::from(SIDE - 1)));
    light(face * SIDE + inside.x as u32, inside.y as u32)
}

/// Between the four texels about a direction.
fn between(p: DVec3) -> DVec3 {
    let (face, at) = seen(p);
    let (first, share) = ((at - 0.5).floor(), (at - 0.5) - (at - 0.5).floor());
    let row = |y: f64| {
        let [a, b] = [0.0, 1.0].map(|x| texel(face, (first.x + x) as i32, (first.y + y) as i32));
        a.lerp(b, share.x)
    };
    row(0.0).lerp(row(1.0), share.y)
}

fn resampled(x: u32, y: u32) -> DVec3 {
    let places = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]].map(|[right, down]| {
        let (east, north) = ((f64::from(x) + right) / 64.0 - 0.5, 0.5 - (f64::from(y) + down) / 32.0);
        let ((sin_east, cos_east), (sin_north, cos_north)) = ((TAU * east).sin_cos(), (PI * north).sin_cos());
        between(DVec3::new(cos_north * sin_east, sin_north, cos_north * cos_east))
    });
    places.into_iter().sum::<DVec3>() / 4.0
}

fn put(light: [f32; 3], o: &mut Outputs) {
    light.into_iter().for_each(|v| o.put(v.into()));
}

fn any_direction(i: &mut Inputs) {
    i.direction();
}

/// Any bits at all, NaN and infinity among them.
fn any_bits(i: &mut Inputs) {
    for _ in 0..4 {
        i.bits();
    }
}

/// Light of every size that is stored, and beyond it.
fn any_light(i: &mut Inputs) {
    for _ in 0..3 {
        i.signed(1e-7, 1e6);
    }
}

pub fn group() -> Group {
    let (cube, pyramid) = ("sky/cube", "sky/pyramid");
    let twins = vec![
        twin(
            cube,
            "face_direction",
            "out3(face_direction(word(0u), in2(1u)));",
            |i| {
                i.pick(6);
                i.evens(2, -0.999, 0.999);
            },
            |i, o| {
                let (side, at) = (f64::from(SIDE), i.v2(1));
                let right = f64::from(i.word(0)) + 0.5 + 0.5 * at.x;
                o.all(mapping().point(right * side, (0.5 - 0.5 * at.y) * side).to_array(), 1.0);
            },
            ROUNDING,
        ),
        twin(
            cube,
            "face_of face_place",
            "let face = face_of(in3(0u)); out_word(face); out2(face_place(face, in3(0u)));",
            any_direction,
            |i, o| {
                let (face, at) = seen(i.v3(0));
                o.word(face);
                let at = at * (2.0 / f64::from(SIDE)) - 1.0;
                o.all([at.x, -at.y], 1.0);
            },
            ROUNDING,
        ),
        twin(
            cube,
            "cube_texel",
            "enter_cube(); out3(cube_texel(word(0u), i32(word(1u)) - 1, i32(word(2u)) - 1, 16u));",
            |i| {
                i.pick(6);
                i.pick(SIDE + 2);
                i.pick(SIDE + 2);
            },
            |i, o| o.v3(texel(i.word(0), i.word(1) as i32 - 1, i.word(2) as i32 - 1)),
            SAME,
        ),
        twin(
            cube,
            "cube_light",
            "enter_cube(); out3(cube_light(in3(0u), 16u));",
            any_direction,
            |i, o| o.all(between(i.v3(0)).to_array(), 1.0),
            // Places are counted in texels, 16 a side.
            16.0 * ROUNDING,
        ),
        twin(
            pyramid,
            "resampled_light",
            "enter_cube(); out3(resampled_light(word(0u), word(1u)));",
            |i| {
                i.pick(64);
                i.pick(32);
            },
            |i, o| o.all(resampled(i.word(0), i.word(1)).to_array(), 1.0),
            16.0 * ROUNDING,
        ),
        twin(
            pyramid,
            "pack_light limited_light",
            "out_word(pack_light(bitcast<vec3<f32>>(vec3<u32>(word(0u), word(1u), word(2u)))));",
            any_bits,
            |i, o| o.word(pack([0, 1, 2].map(|k| f32::from_bits(i.word(k))))),
            SAME,
        ),
        twin(
            pyramid,
            "pack_light",
            "out_word(pack_light(in3(0u)));",
            any_light,
            |i, o| o.word(pack([0, 1, 2].map(|k| i.f(k)))),
            SAME,
        )
        .exactly(),
        twin(
            pyramid,
            "unpack_light",
            "out3(unpack_light(word(0u)));",
            any_bits,
            |i, o| put(unpack(i.word(0)), o),
            SAME,
        ),
        twin(
            pyramid,
            "half_light",
            "out1(limited_light(vec3<f32>(half_light(word(0u)))).x);",
            any_bits,
            |i, o| o.put(limited(f16::from_bits(i.word(0) as u16).into()).into()),
            SAME,
        ),
        twin(
            pyramid,
            "source_light",
            "given = true; level.source = word(3u) % 3u; out3(source_light(0u, 0u));",
            any_bits,
            |i, o| match i.word(3) % 3 {
                0 => {
                    let halves = [i.word(0), i.word(0) >> 16, i.word(1)];
                    put(halves.map(|bits| limited(f16::from_bits(bits as u16).into())), o);
                }
                1 => put([0, 1, 2].map(|k| limited(f32::from_bits(i.word(k)))), o),
                _ => put(unpack(i.word(0)), o),
            },
            SAME,
        ),
    ];
    Group { name: "cube sky", head: HEAD.into(), twins, images: Vec::new, tables: Vec::new }
}
