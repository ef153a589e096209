// SPDX-License-Identifier: MIT OR Apache-2.0
// How far look directions are from the critical curve, by their rays' constants alone. Mirrors `CurveLevel` of
// src/physics/lens/critical.rs, where the formulas are; knows no tables and integrates nothing.

#import constants
#import camera/observer
#import geodesic/geodesic
#import shared/frame
#import shared/math
#import shared/not_inlined

// u of the least radial potential between infinity and the horizon.
fn potential_minimum(c: Constants) -> f32 {
    let rise = max(c.k - c.a2e2, 0.0);
    let b3 = 3.0 * c.b;
    let root = sqrt(max(b3 * b3 - 8.0 * c.a2q * rise, 0.0));
    return min(2.0 * rise / max(b3 + root, 1e-30), 1.0 / c.r_plus);
}

// CurveLevel::within. `begin`: the ray's begin_local; `m`: its potential_minimum.
fn curve_level_within(begin: RayBegin, m: f32) -> f32 {
    let c = begin.c;
    let u = begin.state.u;
    let du = begin.state.du;
    let rest = c.a2e2 - c.k + m * (4.0 * c.b - 3.0 * c.a2q * m) + u * (2.0 * c.b - c.a2q * (u + 2.0 * m));
    let least = c.energy * c.energy + m * m * (c.a2e2 - c.k + m * (2.0 * c.b - m * c.a2q));
    let rise = select(du * du - least, (m - u) * (m - u) * rest, m * c.r_plus < 1.0 - AT_HORIZON);
    let root = sqrt(max(rise, 0.0));
    let level = (select(root, -root, u > m) - du) / c.nu_local;
    return select(-1.0, level, begin.has_light && c.energy > 0.0);
}

// 0 on the curve, positive where rays escape. `n`: look direction in the local frame.
fn curve_level(n: vec3<f32>) -> f32 {
    if SPINNING {
        let by_margin = not_inlined(frame.critical_by_margin);
        if by_margin == MARGIN_OF_ALL || (by_margin != 0u && n.x < 0.0) {
            let begin = begin_local(n);
            let u = potential_minimum(begin.c);
            if by_margin == MARGIN_OF_ALL {
                return curve_level_within(begin, u);
            }
            let c = begin.c;
            // 1 - P / E^2.
            let ratio = u * u * (c.k - c.a2e2 - u * (2.0 * c.b - u * c.a2q)) / (c.energy * c.energy);
            return sqrt(max(ratio, 0.0)) - 1.0;
        }
    }
    let sine = length(n.yz);
    let critical = frame.critical;
    return arctan2(sine * critical.y + n.x * critical.x, sine * critical.x - n.x * critical.y);
}
