// SPDX-License-Identifier: MIT OR Apache-2.0
// How traced/pixels.wgsl leaves what it traced for traced/record.wgsl: in textures of the traced rectangle's size,
// because neighbours are read together and software drivers reach into buffers lane by lane.
//
//     record_sky    xyz: sky direction, chart; w: sky_redshift, 0 unless the ray escaped.
//     record_meta   TracedMeta.
//     record_disk   a layer for each crossing where emitters shine, in order: u, g, azimuth (with AZIMUTH, else 0),
//                   delay (with DELAY, else 0). With PARTS, from layer frame.medium_layer on, the medium before each
//                   crossing and behind the last (emit/medium.wgsl).

// x: bits 0 .. 1 the fate; bit 2 + k, k < 14: the crossing of order k lies inside the disk's inner edge, within the
// horizon too, or is kept outside its outer edge; bit 16 + k: it is kept. y: bits 0 .. 16 the steps, 17 .. 31
// polar_momentum over r of the camera (pack_momentum). z, w: E and L; in the METRIC view z is plane_u.
struct TracedMeta {
    fate: u32,
    beside_disk: u32,
    orders: u32,
    steps: u32,
    energy: f32,
    angular_momentum: f32,
    // Over r of the camera.
    polar_momentum: f32,
}

fn pack_meta(m: TracedMeta) -> vec4<u32> {
    return vec4<u32>(m.fate | ((m.beside_disk & 0x3fffu) << 2u) | (m.orders << 16u),
        min(m.steps, 0x1ffffu) | (pack_momentum(m.polar_momentum) << 17u), bitcast<u32>(m.energy),
        bitcast<u32>(m.angular_momentum));
}

fn unpack_meta(v: vec4<u32>) -> TracedMeta {
    return TracedMeta(v.x & 3u, (v.x >> 2u) & 0x3fffu, v.x >> 16u, v.y & 0x1ffffu, bitcast<f32>(v.z),
        bitcast<f32>(v.w), unpack_momentum(v.y >> 17u));
}

// 2^-22 as bits: numbers from there to 2^10 take 15 bits, 5 of the exponent and 10 of the mantissa.
const LEAST_MOMENTUM: u32 = 105u << 23u;

fn pack_momentum(x: f32) -> u32 {
    let bits = max(bitcast<u32>(max(x, 0.0)), LEAST_MOMENTUM) - LEAST_MOMENTUM;
    return min((bits + 0x1000u) >> 13u, 0x7fffu);
}

// To 5e-4.
fn unpack_momentum(bits: u32) -> f32 {
    return bitcast<f32>((bits << 13u) + LEAST_MOMENTUM);
}
