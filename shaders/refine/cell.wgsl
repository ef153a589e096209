// SPDX-License-Identifier: MIT OR Apache-2.0
// How a crossing of the disk's plane changes over the cell of a sample, and how much of the cell the disk covers.
// Mirrors src/scene/cell.rs, where the reasons are. Knows no lanes and no light.

#import constants
#import shared/frame

// u of a crossing over a cell, 1 x 1 about its middle.
struct CellCrossing {
    // In the middle.
    u: f32,
    // Its changes to the next cell along the strip and across the curve, or to the next quarter in the row and the
    // column.
    du: vec2<f32>,
}

// The crossing at u over the cell of its sample; `others` is u of the samples before and after it along the strip (or
// the row), and before and after it across the curve (or in the column), 0 where there is no crossing.
fn cell_crossing(u: f32, others: vec4<f32>) -> CellCrossing {
    return CellCrossing(u, vec2<f32>(change_of_u(u, others.xy), change_of_u(u, others.zw)));
}

fn change_of_u(u: f32, others: vec2<f32>) -> f32 {
    let there = others > vec2<f32>(0.0);
    let difference = select(u, others.y, there.y) - select(u, others.x, there.x);
    return difference * select(1.0, 0.5, all(there));
}

// The half of a cell before its middle across the curve (`side` -1) or behind it (1).
fn half_cell(cell: CellCrossing, side: f32) -> CellCrossing {
    return CellCrossing(cell.u + 0.25 * side * cell.du.y, vec2<f32>(1.0, 0.5) * cell.du);
}

// Between which differences from u in its middle a cell lies on the disk; the first is above the second where it does
// not.
fn levels_on_disk(cell: CellCrossing) -> vec2<f32> {
    let half = 0.5 * max(abs(cell.du.x) + abs(cell.du.y), LEAST_SLOPE);
    return vec2<f32>(max(frame.disk_u.x - cell.u, -half), min(frame.disk_u.y - cell.u, half));
}

// The part of a cell in which u differs from that in the middle by `levels`, which lie among those of levels_on_disk:
// its share of the cell, 0 or less where there is none, and the mean of u in it.
fn covered(cell: CellCrossing, levels: vec2<f32>) -> vec2<f32> {
    let du = cell.du;
    let below = vec2<f32>(share_below(levels.x, du), share_below(levels.y, du));
    let share = below.y - below.x;
    let sum = sum_below(levels.y, du) - sum_below(levels.x, du);
    // The mean of a quantity between two values, from the shares below each (integrated by parts).
    let mean = (levels.y * below.y - levels.x * below.x - sum) / max(share, 1e-20);
    let off = min(max(mean, levels.x), levels.y);
    return vec2<f32>(min(share, 1.0), cell.u + off);
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

// The integral of share_below over levels up to this one.
fn sum_below(level: f32, slope: vec2<f32>) -> f32 {
    let most = max(max(abs(slope.x), abs(slope.y)), LEAST_SLOPE);
    let least = min(abs(slope.x), abs(slope.y));
    let low = -abs(level);
    let inner = 0.5 * (most - least);
    let corner = max(0.5 * (most + least) + low, 0.0);
    let by_corner = corner * corner / (2.0 * most * max(least, LEAST_SLOPE)) * (corner / 3.0);
    let between = least * (least / (6.0 * most)) + 0.5 * (low + inner) * (1.0 + (low - inner) / most);
    return select(by_corner, between, low >= -inner) + max(level, 0.0);
}
