// SPDX-License-Identifier: MIT OR Apache-2.0
// Tables of what becomes of the rays of one observer, who is outside the photon region of a spinning hole or in its
// rain frame: sky direction and crossings of the equatorial plane, by look direction. Look directions are in polar
// coordinates about the centre of the shadow: psi is the angle from the centre, chi the angle around it, psi = R(chi)
// the critical curve (the shadow's edge). Shared by the kernels that build the tables and those that read them. The
// reasons are in src/physics/lens/kerr/mod.rs and grid.rs.
//
// Columns: KERR_COLUMNS even steps of w = (chi + v) / 2 over [0, 2 pi), where tan v = tan chi / epsilon and epsilon =
// |cot theta| of the observer, within 0.03 .. 1. Rows: KERR_PER_OCTAVE to an octave of t_hat = |tan((psi - R) / 2)| /
// tan(R / 2); row KERR_ROWS_BELOW stands for t_hat = 2^-KERR_OCTAVES. The rows of rays that escape (outer branch) come
// first, those of captured rays (inner branch) follow.

#import constants
#import lens/axis
#requires var lens: KerrLens

struct KerrLens {
    // Unit vectors as (n_r, n_theta, n_phi) of the local frame: the shadow's centre (k.w is epsilon), then the
    // directions in which chi is 90 degrees (e1) and 0 (e2).
    k: vec4<f32>,
    e1: vec4<f32>,
    e2: vec4<f32>,
    outer_rows: u32,
    inner_rows: u32,
    // The number of crossings of the plane that a node holds.
    orders: u32,
    // A ray that moves inward past this 1/r, in 1/M, is captured.
    capture_u: f32,
}

// True: the crossings' table has a layer for each order, a texel being (u, x and y of the unit vector to the emission
// point, delay less the part that diverges at infinity, M). False: a texel holds u of four orders, and a layer serves
// those four.
override PATTERN: bool = false;

// The greatest 1/r at which crossings are told (Grid::reach_inwards of src/physics/lens/kerr/grid.rs); `near`: the
// greatest of those that pixels beside the disk look for.
fn kerr_reach_inwards(near: f32) -> f32 {
    return max(near, min(lens.capture_u, KERR_NARROW_REACH_INWARDS * near));
}

// The part of a delay that tables leave out, M: divergent_delay of src/physics/lens/kerr/grid.rs.
fn divergent_delay(u: f32, u_observer: f32) -> f32 {
    return 1.0 / u_observer + 1.0 / u - 2.0 * log(u / u_observer);
}

// First row of the branch among all rows.
fn kerr_first_row(inner: bool) -> u32 {
    return select(0u, lens.outer_rows, inner);
}

// Unit vector of the angle chi about the centre.
fn kerr_radial(sine: f32, cosine: f32) -> vec3<f32> {
    return lens.e1.xyz * sine + lens.e2.xyz * cosine;
}

// The look direction at the angle psi from the centre, where tan(psi / 2) = a / b; `chi` is (sin chi, cos chi).
fn kerr_direction(chi: vec2<f32>, a: f32, b: f32) -> vec3<f32> {
    let norm = 1.0 / (a * a + b * b);
    return lens.k.xyz * ((b - a) * (b + a) * norm) + kerr_radial(chi.x, chi.y) * (2.0 * a * b * norm);
}

// The look direction of the node in `row` (outer rows first), or half a row farther, which gives the width of a cell;
// `column` holds sin chi, cos chi and tan(R / 2) of the node's column.
fn kerr_node_direction(column: vec4<f32>, row: u32, half_row: bool) -> vec3<f32> {
    let inner = row >= lens.outer_rows;
    let node = i32(row - kerr_first_row(inner)) - i32(KERR_ROWS_BELOW);
    let t_hat = lens_node_t_hat(2 * node + select(0, 1, half_row), KERR_OCTAVES, 2 * i32(KERR_PER_OCTAVE));
    let t = select(t_hat, -t_hat, inner) * column.z;
    return kerr_direction(column.xy, column.z + t, 1.0 - column.z * t);
}
