// The lens of an eye without spin, as tables: everything about a ray depends on psi, the angle between look direction and inward.
// Shared by the kernels that build the tables and those that read them; mirrors src/physics/lens/schwarzschild.rs, where the
// formulas are.
//
// Radial axis: t = tan((psi - psi_c) / 2), psi_c the critical angle; t_hat = |t| / w; node i stands for
// t_hat = 2^(i / LENS_PER_OCTAVE - LENS_OCTAVES). Branch 0: t > 0, escaping. Branch 1: t < 0, captured.

struct SchwarzschildLens {
    // psi_c: tan of its half, sine, cosine; and w.
    critical: vec4<f32>,
    // Of the separatrix: e0.
    separatrix: f32,
    // 1 for the rain frame, else sqrt(1 - 2 u).
    slope: f32,
    // Nodes of branch 0 and 1.
    outer_nodes: u32,
    inner_nodes: u32,
}

const LENS_PER_OCTAVE: f32 = 32.0;
const LENS_OCTAVES: f32 = 22.0;
// Intervals in y = phi / (angle to the end of the ray).
const LENS_INTERVALS: u32 = 128u;
// 1/r where a captured ray's column ends: inside every disk.
const LENS_INNER_END: f32 = 0.25;

// A place on the radial axis: the node before it, and how far it is to the next, 0 .. 1.
struct LensPlace {
    node: u32,
    share: f32,
}

// log2 of 1 <= m < 2, by 2 atanh((m - 1) / (m + 1)) / ln 2, to 1e-8.
fn log2_mantissa(m: f32) -> f32 {
    let z = (m - 1.0) / (m + 1.0);
    let z2 = z * z;
    let series = 1.0 + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0 + z2 * (1.0 / 11.0 + z2 / 13.0)))));
    return 2.8853900817779268 * z * series;
}

// 2^x for 0 <= x < 1, to 1e-8: Taylor series about 1/2.
fn exp2_share(x: f32) -> f32 {
    let y = (x - 0.5) * 0.6931471805599453;
    let series = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0 + y / 720.0)))));
    return 1.4142135623730951 * series;
}

// `last`: the last node that an interpolation may begin at. Exponent and mantissa apart: their sum would cost digits.
fn lens_place(t_hat: f32, last: u32) -> LensPlace {
    let clamped = max(t_hat, exp2(-LENS_OCTAVES));
    let bits = bitcast<u32>(clamped);
    let octave = f32(bits >> 23u) - 127.0 + LENS_OCTAVES;
    let x = LENS_PER_OCTAVE * log2_mantissa(bitcast<f32>((bits & 0x7fffffu) | 0x3f800000u));
    let node = min(u32(octave * LENS_PER_OCTAVE) + u32(x), last);
    return LensPlace(node, x + octave * LENS_PER_OCTAVE - f32(node));
}

fn lens_node_t_hat(node: u32) -> f32 {
    let octave = node / u32(LENS_PER_OCTAVE);
    let share = f32(node % u32(LENS_PER_OCTAVE)) / LENS_PER_OCTAVE;
    return exp2(f32(octave) - LENS_OCTAVES) * exp2_share(share);
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
    return vec4<f32>((-3.0 * s2 + 6.0 * s - 2.0) / 6.0, (3.0 * s2 - 4.0 * s - 1.0) * 0.5, (-3.0 * s2 + 2.0 * s + 2.0) * 0.5,
        (3.0 * s2 - 1.0) / 6.0);
}
