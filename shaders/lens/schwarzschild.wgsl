// SPDX-License-Identifier: MIT OR Apache-2.0
// Tables of what becomes of an observer's rays about a hole without spin. A ray depends on psi alone, the angle between
// its look direction and the direction to the hole. Shared by the kernels that build the tables and those that read
// them; the formulas are in src/physics/lens/schwarzschild.rs and coordinate.rs.
//
// Nodes: t = tan((psi - psi_c) / 2), psi_c being the critical angle (the shadow's edge); t_hat = |t| / w with w =
// min(tan(psi_c / 2), cot(psi_c / 2)); node i stands for t_hat = 2^(i / LENS_PER_OCTAVE - LENS_OCTAVES). Branch 0 has
// the rays that escape, t > 0; branch 1 has captured rays, t < 0.

struct SchwarzschildLens {
    // tan(psi_c / 2), sin psi_c, cos psi_c, w.
    critical: vec4<f32>,
    // e0 of the critical ray (lens/schwarzschild_curve.wgsl).
    separatrix: f32,
    // f in du/dphi = f u (cos psi - beta) / sin psi at the observer: 1 in the rain frame, else sqrt(1 - 2 u).
    slope: f32,
    // Nodes of branch 0 and 1.
    outer_nodes: u32,
    inner_nodes: u32,
}

