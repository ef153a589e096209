// The lens of an observer outside the photon region of a spinning hole, as tables over the look direction in polar
// coordinates (psi, chi) about the centre of the critical curve psi = R(chi). Shared by the kernels that build the
// tables and those that read them; mirrors src/physics/lens/kerr/, where the reasons are.
//
// Columns: w = (chi + v) / 2, tan v = tan chi / epsilon, KERR_COLUMNS around. Rows: log2 of t_hat = |tan((psi - R) /
// 2)| / tan(R / 2), KERR_PER_OCTAVE an octave, row KERR_ROWS_BELOW standing for 2^-KERR_OCTAVES; those of the inner
// branch (captured) follow those of the outer (escaping).

#import constants
#import lens/axis
#requires var lens: KerrLens

struct KerrLens {
    // The centre, and the directions of chi = 90 degrees and 0; local components. w of the first: epsilon.
    k: vec4<f32>,
    e1: vec4<f32>,
    e2: vec4<f32>,
    outer_rows: u32,
    inner_rows: u32,
    // The number of crossings of the plane that a node holds.
    orders: u32,
    // 1/r beyond which an inward ray is captured.
    capture_u: f32,
}

// Nodes hold where the light of a crossing left, and when: a layer for each order with u, the unit vector of the
// azimuth and the regular delay; else a layer for each four orders with their u.
override PATTERN: bool = false;

// First row of the branch among all rows.
fn kerr_first_row(inner: bool) -> u32 {
    return select(0u, lens.outer_rows, inner);
}

// Unit vector of the angle chi about the centre.
fn kerr_radial(sine: f32, cosine: f32) -> vec3<f32> {
    return lens.e1.xyz * sine + lens.e2.xyz * cosine;
}

// Look direction of a node at tan(psi / 2) = a / b.
fn kerr_direction(chi: vec2<f32>, a: f32, b: f32) -> vec3<f32> {
    let norm = 1.0 / (a * a + b * b);
    return lens.k.xyz * ((b - a) * (b + a) * norm) + kerr_radial(chi.x, chi.y) * (2.0 * a * b * norm);
}

// The look direction of row `row` among all rows, or half a row on; `column` holds sin chi, cos chi and tan(R / 2)
// there.
fn kerr_node_direction(column: vec4<f32>, row: u32, half_row: bool) -> vec3<f32> {
    let inner = row >= lens.outer_rows;
    let node = i32(row - kerr_first_row(inner)) - i32(KERR_ROWS_BELOW);
    let t_hat = lens_node_t_hat(2 * node + select(0, 1, half_row), KERR_OCTAVES, 2 * i32(KERR_PER_OCTAVE));
    let t = select(t_hat, -t_hat, inner) * column.z;
    return kerr_direction(column.xy, column.z + t, 1.0 - column.z * t);
}
