// SPDX-License-Identifier: MIT OR Apache-2.0
// How a crossing of the disk's plane changes over the cell of a sample, and how much of the cell the disk covers.
// Mirrors src/scene/cell.rs, where the reasons are. Knows no lanes and no light.

#import constants
#import shared/frame

// A crossing over a cell, 1 x 1 about its middle.
struct CellCrossing {
    // In the middle.
    u: f32,
    g: f32,
    // Changes of u and of ln g to the next cell along the curve and across it.
    du: vec2<f32>,
    dg: vec2<f32>,
}

// The crossing over the cell of a sample where it has `u` and `g`; `others_u` and `others_g` are those of the samples
// before and after it along the curve, and before and after it across. u is 0 where there is no crossing, g is 0 where
// it is not known.
fn cell_crossing(u: f32, g: f32, others_u: vec4<f32>, others_g: vec4<f32>) -> CellCrossing {
    let along = select(others_g.y, others_g.x, others_g.x > 0.0);
    let across = select(others_g.w, others_g.z, others_g.z > 0.0);
    let nearest = select(along, across, across > 0.0);
    // Beyond the disk's inner edge g may be known in the next cell only.
    let known = select(select(1.0, nearest, nearest > 0.0), g, g > 0.0);
    let ln = log(select(vec4<f32>(known), others_g, others_g > vec4<f32>(0.0)) / known);
    let pairs = vec2<bool>(all(others_g.xy > vec2<f32>(0.0)), all(others_g.zw > vec2<f32>(0.0)));
    let dg = select(vec2<f32>(1.0), vec2<f32>(0.5), pairs) * (ln.yw - ln.xz);
    return CellCrossing(u, known, vec2<f32>(change_of_u(u, others_u.xy), change_of_u(u, others_u.zw)), dg);
}

fn change_of_u(u: f32, others: vec2<f32>) -> f32 {
    let there = others > vec2<f32>(0.0);
    let difference = select(u, others.y, there.y) - select(u, others.x, there.x);
    return difference * select(1.0, 0.5, all(there));
}

// The half of a cell before its middle across the curve (`side` -1) or behind it (1).
fn half_cell(cell: CellCrossing, side: f32) -> CellCrossing {
    let off = 0.25 * side;
    let halved = vec2<f32>(1.0, 0.5);
    return CellCrossing(cell.u + off * cell.du.y, cell.g * exp(off * cell.dg.y), halved * cell.du, halved * cell.dg);
}

// Share of a cell that the disk covers, and u and g in the middle of this part.
fn covered(cell: CellCrossing) -> vec3<f32> {
    let u = cell.u;
    let du = cell.du;
    let share = clamp(share_below(frame.disk_u.y - u, du) - share_below(frame.disk_u.x - u, du), 0.0, 1.0);
    let half = 0.5 * (abs(du.x) + abs(du.y));
    let low = max(u - half, frame.disk_u.x);
    let high = min(u + half, frame.disk_u.y);
    // The less of the cell is left out, the less does that move the middle of the rest.
    let part = clamp(2.0 * (1.0 - share), 0.0, 1.0);
    let off = select(0.0, part * (0.5 * (low + high) - u), low < high);
    // The nearest place of the cell where u is so much off.
    let steepness = max(length(du), LEAST_SLOPE);
    let ln_g = off / steepness * dot(du / steepness, cell.dg);
    return vec3<f32>(share, u + off, cell.g * exp(ln_g));
}

// Share of a cell, 1 x 1 about its middle, in which slope . (x, y) <= level: the half-plane cuts a corner off, or two
// sides.
fn share_below(level: f32, slope: vec2<f32>) -> f32 {
    let most = max(max(abs(slope.x), abs(slope.y)), LEAST_SLOPE);
    let least = min(abs(slope.x), abs(slope.y));
    let corner = max(0.5 * (most + least) - abs(level), 0.0);
    let cut = corner * corner / (2.0 * most * max(least, LEAST_SLOPE));
    let by_corner = select(cut, 1.0 - cut, level > 0.0);
    return select(by_corner, 0.5 + level / most, abs(level) <= 0.5 * (most - least));
}
