// SPDX-License-Identifier: MIT OR Apache-2.0
// Shaders: one triangle that covers a window's image, and the codes of `screen` in it. The only stage of a frame that
// is not compute.

// The image has another size than the texture.
override STRETCHED: bool = false;
// The image's format encodes what it is given: undo the sRGB curve before it.
override LINEAR: bool = false;

@group(0) @binding(0) var screen: texture_2d<f32>;
@group(0) @binding(1) var smooth_: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
}

@vertex
fn cover(@builtin(vertex_index) index: u32) -> Corner {
    // (0, 0), (2, 0), (0, 2): the unit square lies inside.
    let place = vec2<f32>(f32((index & 1u) << 1u), f32(index & 2u));
    return Corner(vec4<f32>(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0), place);
}

// IEC 61966-2-1.
fn srgb_decode(code: vec3<f32>) -> vec3<f32> {
    return select(pow((code + 0.055) / 1.055, vec3<f32>(2.4)), code / 12.92, code <= vec3<f32>(0.04045));
}

@fragment
fn show(corner: Corner) -> @location(0) vec4<f32> {
    var code: vec3<f32>;
    if STRETCHED {
        code = textureSampleLevel(screen, smooth_, corner.place, 0.0).xyz;
    } else {
        code = textureLoad(screen, vec2<u32>(corner.position.xy), 0).xyz;
    }
    if LINEAR {
        code = srgb_decode(code);
    }
    return vec4<f32>(code, 1.0);
}
