// SPDX-License-Identifier: MIT OR Apache-2.0
// Film: develops radiance to pixels. Mirrors src/film, where the formulas, sources and reasons are. Functions that are
// called from loops have no early return, as Mesa 22.3's shader compiler crashes on some; but for those under an `if`
// over constants, which src/gpu/device/specialise.rs leaves out.

#import constants
#import film/colour_map
#import film/false_colour
#import film/encode
#import film/filmic
#import film/grade
#import film/hdr
#import film/lut
#import film/params
#import shared/not_inlined

// The number of the ToneMap that a kernel is made for, or FROM_UNIFORM where it serves all and the uniform says which.
override TONE_MAP: u32 = 1u;
// The pixel formats that a kernel is made for: RGBA8 and BGRA8 (0), RGBA16F and RGBA32F, R32F,
// RGB10A2, or FROM_UNIFORM.
override PIXELS: u32 = 0u;
// The number of the ColourMap that a kernel is made for, or FROM_UNIFORM.
override COLOUR_MAP: u32 = 0u;
// Whether a kernel is made for light that is graded (1) or not (0), or FROM_UNIFORM.
override GRADE: u32 = 0u;
// Whether a kernel is made for light whose colours go through a LUT.
override LUT: bool = false;
// Whether a kernel is made for the views other than light.
override FALSE_COLOUR: bool = false;

fn is_float() -> bool {
    if PIXELS == FROM_UNIFORM {
        let format = not_inlined(film.format);
        return (format == FORMAT_RGBA16F) | (format == FORMAT_RGBA32F);
    }
    return PIXELS == PIXELS_FLOAT;
}

fn is_r32f() -> bool {
    if PIXELS == FROM_UNIFORM {
        return not_inlined(film.format) == FORMAT_R32F;
    }
    return PIXELS == PIXELS_R32F;
}

fn is_hdr() -> bool {
    if PIXELS == FROM_UNIFORM {
        // Views have no such pixels.
        if FALSE_COLOUR {
            return false;
        }
        return not_inlined(film.format) >= FORMAT_RGB10A2_PQ;
    }
    return PIXELS == PIXELS_HDR;
}

fn is_rgba32f() -> bool {
    return not_inlined(film.format) == FORMAT_RGBA32F;
}

fn is_aces() -> bool {
    if TONE_MAP == FROM_UNIFORM {
        return not_inlined(film.tone_map) == TONE_MAP_ACES;
    }
    return TONE_MAP == TONE_MAP_ACES;
}

fn is_agx() -> bool {
    if TONE_MAP == FROM_UNIFORM {
        return not_inlined(film.tone_map) == TONE_MAP_AGX;
    }
    return TONE_MAP == TONE_MAP_AGX;
}

fn is_filmic() -> bool {
    if TONE_MAP == FROM_UNIFORM {
        return not_inlined(film.tone_map) == TONE_MAP_FILMIC;
    }
    return TONE_MAP == TONE_MAP_FILMIC;
}

fn is_graded() -> bool {
    if GRADE == FROM_UNIFORM {
        return not_inlined(film.graded) != 0u;
    }
    return GRADE != 0u;
}

fn has_colour_map() -> bool {
    if COLOUR_MAP == FROM_UNIFORM {
        return not_inlined(film.colour_map) != COLOUR_MAP_NONE;
    }
    return COLOUR_MAP != COLOUR_MAP_NONE;
}

// Whether a pixel has two words or four, and not one.
fn has_several_words() -> bool {
    return is_float();
}

// 32-bit words of a pixel.
fn pixel_words() -> u32 {
    return select(1u, select(2u, 4u, is_rgba32f()), has_several_words());
}

// One pixel, in the first pixel_words() of the four words.
fn develop(radiance: vec4<f32>, x: u32, y: u32) -> vec4<u32> {
    var words = vec4<u32>(0u);
    if is_float() {
        words = select(vec4<u32>(develop_rgba16f(radiance), 0u, 0u), develop_rgba32f(radiance), is_rgba32f());
    } else if is_r32f() {
        words.x = bitcast<u32>(radiance.x);
    } else if is_hdr() {
        let codes = develop_10bit(radiance, x, y);
        words.x = codes.x | (codes.y << 10u) | (codes.z << 20u) | (codes.w << 30u);
    } else {
        let rgba = develop_8bit(radiance, x, y);
        let codes = select(rgba, rgba.zyxw, film.format == FORMAT_BGRA8);
        words.x = codes.x | (codes.y << 8u) | (codes.z << 16u) | (codes.w << 24u);
    }
    return words;
}

fn develop_8bit(radiance: vec4<f32>, x: u32, y: u32) -> vec4<u32> {
    var codes = vec4<u32>(255u);
    if FALSE_COLOUR {
        codes = vec4<u32>(vec3<u32>(false_colour(radiance.x) * 255.0 + 0.5), 255u);
    } else {
        let scene = limited(radiance.xyz * film.exposure, MAX_SCENE_LIGHT);
        // Most of the sky is black, and black stays black, whatever the dither; but a LUT may have light for it.
        var colour = vec3<u32>(0u);
        if LUT || is_agx() || any(scene != vec3<f32>(0.0)) {
            colour = vec3<u32>(shown_colour(with_grade(scene, x, y)) * 255.0 + dither(x, y));
        }
        codes = vec4<u32>(colour, u32(alpha_of(radiance.w) * 255.0 + 0.5));
    }
    return codes;
}

fn develop_10bit(radiance: vec4<f32>, x: u32, y: u32) -> vec4<u32> {
    let scene = limited(radiance.xyz * film.exposure, MAX_SCENE_LIGHT);
    var colour = vec3<f32>(0.0);
    if any(scene != vec3<f32>(0.0)) {
        let light = with_grade(scene, x, y);
        colour = select(hlg_codes(light), pq_codes(light), vec3<bool>(film.format == FORMAT_RGB10A2_PQ));
    }
    return vec4<u32>(vec3<u32>(colour * 1023.0 + dither(x, y)), u32(alpha_of(radiance.w) * 3.0 + 0.5));
}

fn develop_rgba16f(radiance: vec4<f32>) -> vec2<u32> {
    let light = limited(radiance.xyz, MAX_F16);
    let half = f16_bits(vec4<f32>(light, alpha_of(radiance.w)));
    return vec2<u32>(half.x | (half.y << 16u), half.z | (half.w << 16u));
}

// f16 of 0 <= v <= MAX_F16, rounded to even. Not pack2x16float: its rounding is the driver's, and old GL has none.
fn f16_bits(v: vec4<f32>) -> vec4<u32> {
    let bits = bitcast<vec4<u32>>(v);
    // The exponent's bias goes from 127 to 15; adding just under half of the last place, and its lowest bit, rounds.
    let normal = (bits - 0x38000000u + 0xfffu + ((bits >> vec4<u32>(13u)) & vec4<u32>(1u))) >> vec4<u32>(13u);
    let subnormal = vec4<u32>(round(v * 16777216.0));
    return select(normal, subnormal, v < vec4<f32>(6.103515625e-5));
}

fn develop_rgba32f(radiance: vec4<f32>) -> vec4<u32> {
    return bitcast<vec4<u32>>(vec4<f32>(limited(radiance.xyz, MAX_F32), alpha_of(radiance.w)));
}

fn alpha_of(alpha: f32) -> f32 {
    return select(1.0, limited(vec3<f32>(alpha), 1.0).x, film.transparent != 0u);
}

fn dither(x: u32, y: u32) -> f32 {
    let ramp = x * 288237660u + y * 25070369u;
    let noise = ramp * 53u - (ramp >> 16u) * 1119u;
    return f32(noise >> 16u) / 65536.0;
}

// Exposed light at a pixel of the whole frame, graded if the film has a grade.
fn with_grade(scene: vec3<f32>, x: u32, y: u32) -> vec3<f32> {
    var light = scene;
    if is_graded() {
        light = graded(scene, x, y);
    }
    return light;
}

// The sRGB-encoded colour of exposed light.
fn shown_colour(scene: vec3<f32>) -> vec3<f32> {
    var colour = vec3<f32>(0.0);
    if has_colour_map() {
        colour = afmhot(tone_map(vec3<f32>(luminance(scene))).x);
    } else {
        colour = srgb_encode(tone_map(scene));
        if LUT {
            colour = through_lut(colour);
        }
    }
    return colour;
}

fn tone_map(rgb: vec3<f32>) -> vec3<f32> {
    var mapped = clamp(rgb, vec3<f32>(0.0), vec3<f32>(1.0));
    if is_aces() {
        mapped = aces(rgb);
    } else if is_agx() {
        mapped = agx(rgb);
    } else if is_filmic() {
        mapped = filmic(rgb);
    }
    return mapped;
}

// A matrix whose rows sum to 1, by what each component takes from the other two.
fn balanced(m: mat3x2<f32>, c: vec3<f32>) -> vec3<f32> {
    return c + vec3<f32>(dot(m[0], c.yz - c.x), dot(m[1], c.xz - c.y), dot(m[2], c.xy - c.z));
}

fn aces(rgb: vec3<f32>) -> vec3<f32> {
    let v = balanced(ACES_IN, rgb * ACES_EXPOSURE);
    let fit = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081);
    return clamp(balanced(ACES_OUT, fit), vec3<f32>(0.0), vec3<f32>(1.0));
}

fn agx(rgb: vec3<f32>) -> vec3<f32> {
    let inset = max(balanced(AGX_IN, rgb), vec3<f32>(1e-10));
    let x = clamp((log2(inset) - AGX_LOW) / AGX_SPAN, vec3<f32>(0.0), vec3<f32>(1.0));
    let curve = vec3<f32>(agx_sigmoid(x.x), agx_sigmoid(x.y), agx_sigmoid(x.z));
    let shown = pow(max(balanced(AGX_OUT, curve), vec3<f32>(0.0)), vec3<f32>(2.2));
    return clamp(balanced(AGX_REC709, shown), vec3<f32>(0.0), vec3<f32>(1.0));
}

fn agx_sigmoid(x: f32) -> f32 {
    let toe = x < AGX_PIVOT;
    let scale = select(AGX_SHOULDER, -AGX_TOE, toe);
    let power = select(3.25, 3.0, toe);
    let t = max(2.0 * (x - AGX_PIVOT) / scale, 0.0);
    return clamp(0.5 + scale * t / pow(1.0 + pow(t, power), 1.0 / power), 0.0, 1.0);
}
