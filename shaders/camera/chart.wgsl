// SPDX-License-Identifier: MIT OR Apache-2.0
// Doran's chart of a spinning hole beside that of Boyer and Lindquist, in which matter moves: by how much azimuths and
// times differ. Mirrors `OffsetSeries` of src/physics/rain.rs, whose formulas it takes from the frame.

#import constants
#import geodesic/geodesic
#import shared/frame

// By how much azimuth and time that a ray is traced in differ at u from those of Boyer and Lindquist: 0 without RAIN,
// with it Kerr's azimuth and, where delays are wanted, Doran's time.
fn chart_offsets(c: Constants, u: f32) -> vec2<f32> {
    if !(SPINNING && RAIN) {
        return vec2<f32>(0.0);
    }
    if !DELAY {
        return vec2<f32>(kerr_offset(c, u), 0.0);
    }
    return vec2<f32>(kerr_offset(c, u), rain_offsets(c, u).y);
}

// Kerr's azimuth less Boyer and Lindquist's outside the horizon: kerr_offset of rain.rs.
fn kerr_offset(c: Constants, u: f32) -> f32 {
    let outer = max(1.0 - c.r_plus * u, HORIZON_ROOM);
    let inner = max(1.0 - c.r_minus * u, HORIZON_ROOM);
    return c.a / (c.r_plus - c.r_minus) * log(outer / inner);
}

// Doran's azimuth less Kerr's: doran_turn of rain.rs, in four panels in sqrt(u).
fn doran_turn(c: Constants, u: f32) -> f32 {
    let width = 0.25 * sqrt(max(u, 0.0));
    var sum = 0.0;
    for (var i = 0u; i < 12u; i += 1u) {
        let v = width * (f32(i / 3u) + GAUSS_NODES[i % 3u]);
        let q = sqrt(1.0 + c.a * c.a * v * v * v * v);
        sum += GAUSS_WEIGHTS[i % 3u] * v / (q * (q + 1.4142135624 * v));
    }
    return 2.0 * c.a * width * sum;
}

// Doran's azimuth and time less those of Boyer and Lindquist at u, outside the horizon.
fn rain_offsets(c: Constants, u: f32) -> vec2<f32> {
    let v = sqrt(u);
    let outer = sqrt(c.r_plus) * v;
    let inner = sqrt(c.r_minus) * v;
    // artanh(x) = ln((1 + x)^2 / (1 - x^2)) / 2.
    let rest = max(1.0 - c.r_plus * u, HORIZON_ROOM);
    let logs = 0.5 * (frame.offset_poles.xy * log((1.0 + outer) * (1.0 + outer) / rest)
        + frame.offset_poles.zw * log((1.0 + inner) * (1.0 + inner) / max(1.0 - c.r_minus * u, HORIZON_ROOM)));
    // Clenshaw 1955: from b(k + 1) and b(k + 2), those of two terms a turn.
    let x = 2.0 * outer - 1.0;
    var first = vec2<f32>(0.0);
    var second = vec2<f32>(0.0);
    for (var i = OFFSET_PAIRS - 1u; i > 0u; i--) {
        let pair = frame.offset_terms[i];
        second = pair.zw + 2.0 * x * first - second;
        first = pair.xy + 2.0 * x * second - first;
    }
    let pair = frame.offset_terms[0];
    second = pair.zw + 2.0 * x * first - second;
    let sum = logs + pair.xy + x * second - first;
    return -2.8284271247 * sum + vec2<f32>(0.0, 2.8284271247 / v);
}
