// The lens of an observer without spin, as tables: everything about a ray depends on psi, the angle between the look
// direction and the inward one. Shared by the kernels that build the tables and those that read them; mirrors
// src/physics/lens/schwarzschild.rs, where the formulas are.
//
// Radial axis: t = tan((psi - psi_c) / 2), psi_c the critical angle; t_hat = |t| / w; node i stands for
// t_hat = 2^(i / LENS_PER_OCTAVE - LENS_OCTAVES). Branch 0: t > 0, escaping. Branch 1: t < 0, captured.

struct SchwarzschildLens {
    // psi_c: tan of its half, sine, cosine; and w.
    critical: vec4<f32>,
    // e0 of the separatrix.
    separatrix: f32,
    // 1 for the rain frame, else sqrt(1 - 2 u).
    slope: f32,
    // Nodes of branch 0 and 1.
    outer_nodes: u32,
    inner_nodes: u32,
}

