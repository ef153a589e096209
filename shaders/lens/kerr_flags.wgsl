// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: what may happen in each cell of the tables of lens/kerr.wgsl, and whether it may be interpolated; one thread
// a cell. Mirrors `Patch` of src/physics/lens/kerr/cells.rs.

#import constants
#import lens/kerr
#import shared/not_inlined
#import shared/frame

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lens: KerrLens;
@group(0) @binding(2) var curve: texture_2d<f32>;
@group(0) @binding(3) var sky: texture_2d<f32>;
@group(0) @binding(4) var crossings: texture_2d_array<f32>;
@group(0) @binding(5) var flags_out: texture_storage_2d<r32uint, write>;

// Errors that a cell may have beside KERR_TOLERANCE, which is that of the sky, rad of look direction: of radii of
// crossings, relative to 1 + conditioning; of azimuths, rad, and delays, relative to the orbital time. Both are twice
// what f64 allows: the fourth differences hold the rounding of f32 as well. Measured at spin 0.9 from r = 30, 320 x 180
// pixels: with f64's numbers 825 and 714 pixels are integrated, instead of 672, and the worst errors of those looked up
// go from 1.5e-6 to 8e-7 (radii) and from 2.4e-6 to 2.0e-6 (azimuths); their medians, 8e-8 and 5e-8, stay.
const KERR_RADIUS_TOLERANCE: f32 = 2e-6;
const KERR_PATTERN_TOLERANCE: f32 = 2e-5;

// Lower corner of the cell.
var<private> cell: vec2<u32>;
// Its extent along chi and along x, and sin R: angles on the observer's sky.
var<private> column_angle: f32;
var<private> row_angle: f32;
var<private> critical: f32;

fn place(i: u32, j: u32) -> vec2<u32> {
    return vec2<u32>((cell.x + KERR_COLUMNS + i - 2u) % KERR_COLUMNS, cell.y + j - 2u);
}

// `layer` 0xffff: the sky.
const SKY_LAYER: u32 = 0xffffu;

fn value(layer: u32, i: u32, j: u32) -> vec4<f32> {
    if layer == SKY_LAYER {
        return textureLoad(sky, place(i, j), 0);
    }
    return textureLoad(crossings, place(i, j), layer, 0);
}

fn fourth(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>, e: vec4<f32>) -> vec4<f32> {
    return abs(a + e - 4.0 * (b + d) + 6.0 * c);
}

struct Patch {
    // Error of cubic interpolation at mid-cell: 3/128 of the fourth differences.
    error: vec4<f32>,
    // Least and greatest value over the nodes of the interpolation, of all and of the crossings that come.
    low: vec4<f32>,
    high: vec4<f32>,
    finite_low: vec4<f32>,
    finite_high: vec4<f32>,
    // Change along x and along chi.
    by_row: array<vec4<f32>, 2>,
    by_column: array<vec4<f32>, 2>,
    // Whether no node is 0 in x, y and z.
    filled: bool,
}

fn patch_of(layer: u32) -> Patch {
    var p: Patch;
    p.low = vec4<f32>(1e30);
    p.high = vec4<f32>(-1e30);
    p.finite_low = p.low;
    p.finite_high = p.high;
    p.filled = true;
    var v: array<vec4<f32>, 6>;
    var differences = vec4<f32>(0.0);
    for (var k = 2u; k < 4u; k += 1u) {
        var along_chi = vec4<f32>(0.0);
        var along_x = vec4<f32>(0.0);
        for (var m = 0u; m < 2u; m += 1u) {
            for (var i = 0u; i < 6u; i += 1u) {
                v[i] = value(layer, select(i, k, m == 1u), select(k, i, m == 1u));
                p.filled = p.filled && any(v[i].xyz != vec3<f32>(0.0));
            }
            let worst = max(fourth(v[0], v[1], v[2], v[3], v[4]), fourth(v[1], v[2], v[3], v[4], v[5]));
            if m == 0u {
                along_chi = worst;
                p.by_column[k - 2u] = v[3] - v[2];
            } else {
                along_x = worst;
                p.by_row[k - 2u] = v[3] - v[2];
            }
        }
        p.error = max(p.error, along_chi);
        differences = max(differences, along_x);
    }
    p.error = (p.error + differences) * (3.0 / 128.0);
    for (var i = 1u; i < 5u; i += 1u) {
        for (var j = 1u; j < 5u; j += 1u) {
            let at = value(layer, i, j);
            p.low = min(p.low, at);
            p.high = max(p.high, at);
            let comes = abs(at) < vec4<f32>(KERR_NO_CROSSING);
            p.finite_low = select(p.finite_low, min(p.finite_low, at), comes);
            p.finite_high = select(p.finite_high, max(p.finite_high, at), comes);
        }
    }
    return p;
}

// The stretch of a cell, from the lengths of its changes along x and chi: change per rad of look direction, the smaller
// one over the cell of the greater one of both directions.
fn stretch_of(rows: vec2<f32>, columns: vec2<f32>) -> f32 {
    return max(min(rows.x, rows.y) / row_angle, min(columns.x, columns.y) / max(column_angle, 1e-12));
}

fn sky_is_good() -> bool {
    let p = patch_of(SKY_LAYER);
    let stretch = stretch_of(vec2<f32>(length(p.by_row[0].xyz), length(p.by_row[1].xyz)),
        vec2<f32>(length(p.by_column[0].xyz), length(p.by_column[1].xyz)));
    // Written so that NaN is not good.
    return p.filled && length(p.error.xyz) <= KERR_TOLERANCE * max(stretch, 1.0);
}

// Flags of the crossings in component `k` of a layer, whose order is `order`. Bits 0 .. 15 say that a crossing of that
// order may hit the disk, KERR_DIRECT that the rays of the cell are to be integrated.
fn crossing_flags(p: Patch, k: u32, order: u32) -> u32 {
    let margin = margin_of(p, k);
    let near = nearest_u();
    let far = frame.plane_u.x / DISK_REACH_OUTWARDS;
    let reach = far * select(1.0, KERR_NARROW_REACH, order > 0u);
    let reach_inwards = select(near, kerr_reach_inwards(near), order > 0u);
    if near < far || p.low[k] - margin > reach_inwards || p.high[k] + margin < reach {
        return 0u;
    }
    let bit = 1u << order;
    let come = max(abs(p.low[k]), abs(p.high[k])) < KERR_NO_CROSSING;
    if is_inside_disk(p, k) {
        return select(0u, bit, come);
    }
    if !come {
        return bit | KERR_DIRECT;
    }
    let size = clamp(p.low[k], far, near);
    let stretch = stretch_of(abs(vec2<f32>(p.by_row[0][k], p.by_row[1][k])),
        abs(vec2<f32>(p.by_column[0][k], p.by_column[1][k])));
    let conditioning = 1.0 + critical * stretch / size;
    // The error that rounding leaves of nodes much larger than the least.
    let noise = 6e-8 * max(abs(p.low[k]), abs(p.high[k]));
    let good = p.error[k] + noise <= KERR_RADIUS_TOLERANCE * conditioning * size;
    return bit | select(KERR_DIRECT, 0u, good);
}

// Greatest 1/r of crossings that pixels beside the disk's inner edge look for (reached_u of src/scene/refine.rs).
fn nearest_u() -> f32 {
    return frame.plane_u.y * DISK_REACH_INWARDS;
}

// By how much values may lie beyond those of the nodes.
fn margin_of(p: Patch, k: u32) -> f32 {
    return 0.25 * max(p.finite_high[k] - p.finite_low[k], 0.0);
}

// Whether all crossings of the cell lie farther in than pixels beside the disk look for. Such crossings need not be
// exact.
fn is_inside_disk(p: Patch, k: u32) -> bool {
    return p.low[k] - margin_of(p, k) > nearest_u();
}

fn pattern_is_good(p: Patch) -> bool {
    let azimuth_stretch = stretch_of(vec2<f32>(length(p.by_row[0].yz), length(p.by_row[1].yz)),
        vec2<f32>(length(p.by_column[0].yz), length(p.by_column[1].yz)));
    let delay_stretch =
        stretch_of(abs(vec2<f32>(p.by_row[0].w, p.by_row[1].w)), abs(vec2<f32>(p.by_column[0].w, p.by_column[1].w)));
    // d ph = Omega dt, Omega = r^(-3/2) (Kepler).
    let u = clamp(p.high.x, frame.plane_u.x, frame.plane_u.y);
    let turn = u * sqrt(u);
    // Crossings in Doran's chart have no place (kerr_nodes.wgsl).
    let placed = any(p.low.yz != vec2<f32>(0.0)) || any(p.high.yz != vec2<f32>(0.0));
    return placed && length(p.error.yz) <= KERR_PATTERN_TOLERANCE * (1.0 + critical * azimuth_stretch)
        && turn * p.error.w <= KERR_PATTERN_TOLERANCE * (1.0 + critical * turn * delay_stretch);
}

@compute @workgroup_size(8, 16)
fn flag_cells(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    let inner = id.y >= lens.outer_rows;
    let row = id.y - kerr_first_row(inner);
    let rows = select(lens.outer_rows, lens.inner_rows, inner);
    if id.x >= KERR_COLUMNS || row < KERR_ROWS_BELOW || row + KERR_ROWS_ABOVE >= rows {
        return;
    }
    cell = id.xy;
    let column = textureLoad(curve, vec2<u32>(id.x, 1u), 0);
    let next_column = textureLoad(curve, vec2<u32>((id.x + 1u) % KERR_COLUMNS, 1u), 0);
    column_angle = distance(kerr_node_direction(column, id.y, true), kerr_node_direction(next_column, id.y, true));
    row_angle = distance(kerr_node_direction(column, id.y, false), kerr_node_direction(column, id.y + 1u, false));
    critical = 2.0 * column.z / (1.0 + column.z * column.z);
    var flags = 0u;
    if !inner && !sky_is_good() {
        flags = KERR_DIRECT;
    }
    let orders = not_inlined(lens.orders);
    if PATTERN {
        for (var order = 0u; order < orders; order += 1u) {
            let p = patch_of(order);
            let here = crossing_flags(p, 0u, order);
            let good = here == 0u || is_inside_disk(p, 0u) || pattern_is_good(p);
            flags |= here | select(KERR_DIRECT, 0u, good);
        }
    } else {
        for (var order = 0u; order < orders; order += 4u) {
            let p = patch_of(order / 4u);
            for (var k = 0u; k < 4u && order + k < orders; k += 1u) {
                flags |= crossing_flags(p, k, order + k);
            }
        }
    }
    textureStore(flags_out, id.xy, vec4<u32>(flags, 0u, 0u, 0u));
}
