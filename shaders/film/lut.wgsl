// SPDX-License-Identifier: MIT OR Apache-2.0
// LUTs of developed colours. Mirrors src/film/lut.rs, where the formulas and sources are.

#import film/params

// The nodes, red along x, green along y, blue along z, bound behind what film/packed.wgsl and the other fragments that
// write pixels bind; one texel without a LUT. A texture, because OpenGL ES 3.1 promises four storage buffers, and
// kernels that refine have as many.
@group(2) @binding(2) var film_lut: texture_3d<f32>;

// The sRGB-encoded colour that takes the place of one.
fn through_lut(colour: vec3<f32>) -> vec3<f32> {
    let cells = vec3<f32>(f32(film.lut_side - 1u));
    let place = clamp((colour - film.lut_low) * film.lut_scale, vec3<f32>(0.0), cells);
    let corner = min(floor(place), cells - 1.0);
    let part = place - corner;
    // From corner to corner: along the axis of the largest part, then of the middle one, then of the least.
    let x_largest = part.x >= part.y && part.x >= part.z;
    let y_largest = !x_largest && part.y >= part.z;
    let z_least = part.z <= part.x && part.z <= part.y;
    let y_least = !z_least && part.y <= part.x;
    let first = vec3<f32>(vec3<bool>(x_largest, y_largest, !x_largest && !y_largest));
    let second = vec3<f32>(vec3<bool>(z_least || y_least, !y_least, !z_least));
    let most = max(max(part.x, part.y), part.z);
    let fewest = min(min(part.x, part.y), part.z);
    let middle = max(min(part.x, part.y), min(max(part.x, part.y), part.z));
    let found = (1.0 - most) * lut_node(corner) + (most - middle) * lut_node(corner + first)
        + (middle - fewest) * lut_node(corner + second) + fewest * lut_node(corner + 1.0);
    let shown = clamp(found, vec3<f32>(0.0), vec3<f32>(1.0));
    return (1.0 - film.lut_strength) * colour + film.lut_strength * shown;
}

fn lut_node(place: vec3<f32>) -> vec3<f32> {
    return textureLoad(film_lut, vec3<i32>(place), 0).xyz;
}
