// SPDX-License-Identifier: MIT OR Apache-2.0
// The parts that the lens tables of both kinds share: the logarithmic axis of distance from the critical curve, and
// cubic interpolation. Mirrors src/physics/lens/coordinate.rs.

// A place on an axis: the node before it, and how far it is to the next, 0 .. 1.
struct AxisPosition {
    node: u32,
    share: f32,
}

// log2 of 1 <= m < 2, by 2 atanh((m - 1) / (m + 1)) / ln 2, to 1e-8.
fn log2_mantissa(m: f32) -> f32 {
    let z = (m - 1.0) / (m + 1.0);
    let z2 = z * z;
    let series = 1.0 + z2 * (1.0 / 3.0
        + z2 * (0.2 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0 + z2 * (1.0 / 11.0 + z2 / 13.0)))));
    return 2.8853900817779268 * z * series;
}

// 2^x for 0 <= x < 1, to 1e-8: Taylor series about 1/2.
fn exp2_share(x: f32) -> f32 {
    let y = (x - 0.5) * 0.6931471805599453;
    let series = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0 + y / 720.0)))));
    return 1.4142135623730951 * series;
}

// The place of t_hat >= 2^-octaves on an axis of `per_octave` nodes that begins there; `last` is the last node that an
// interpolation may begin at. Exponent and mantissa are kept apart: their sum would cost digits.
fn axis_position(t_hat: f32, octaves: f32, per_octave: f32, last: u32) -> AxisPosition {
    let bits = bitcast<u32>(max(t_hat, exp2(-octaves)));
    let octave = (f32(bits >> 23u) - 127.0 + octaves) * per_octave;
    let x = per_octave * log2_mantissa(bitcast<f32>((bits & 0x7fffffu) | 0x3f800000u));
    let node = min(u32(octave) + u32(x), last);
    return AxisPosition(node, x + (octave - f32(node)));
}

// t_hat of a node, which may lie before the axis' begin.
fn lens_node_t_hat(node: i32, octaves: f32, per_octave: i32) -> f32 {
    // Rounds down, negative nodes too.
    let octave = (node + 64 * per_octave) / per_octave - 64;
    let share = f32(node - octave * per_octave) / f32(per_octave);
    return exp2(f32(octave) - octaves) * exp2_share(share);
}

// Weights of cubic interpolation through the nodes -1, 0, 1, 2 at 0 <= s <= 1 (Lagrange), and their derivatives.
fn lagrange(s: f32) -> vec4<f32> {
    let a = s + 1.0;
    let b = s - 1.0;
    let c = s - 2.0;
    return vec4<f32>(-s * b * c / 6.0, a * b * c * 0.5, -a * s * c * 0.5, a * s * b / 6.0);
}

fn lagrange_slope(s: f32) -> vec4<f32> {
    let s2 = s * s;
    return vec4<f32>((-3.0 * s2 + 6.0 * s - 2.0) / 6.0, (3.0 * s2 - 4.0 * s - 1.0) * 0.5,
        (-3.0 * s2 + 2.0 * s + 2.0) * 0.5, (3.0 * s2 - 1.0) / 6.0);
}

// tan((psi - R) / 2), where tan(R / 2) = half_tangent and sine, cosine are psi's; no cancellation in 1 + cos psi.
fn lens_tangent(cosine: f32, sine2: f32, half_tangent: f32) -> f32 {
    let sine = sqrt(sine2);
    let one_plus = select(1.0 + cosine, sine2 / (1.0 - cosine), cosine < 0.0);
    // Straight away from the centre both vanish: the limit is cot(R / 2).
    let below = one_plus + half_tangent * sine;
    return select((sine - half_tangent * one_plus) / max(below, 1e-30), 1.0 / half_tangent, below <= 0.0);
}
