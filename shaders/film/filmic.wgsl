// SPDX-License-Identifier: MIT OR Apache-2.0
// Hable's tone map of three powers. Mirrors src/film/filmic.rs, where the formulas and sources are.

#import constants
#import film/params

// Light in [0, MAX_SCENE_LIGHT] to [0, 1].
fn filmic(rgb: vec3<f32>) -> vec3<f32> {
    let toe = film.filmic_toe;
    let line = film.filmic_line;
    let shoulder = film.filmic_shoulder;
    let low = toe.z * pow(clamp(rgb * toe.y, vec3<f32>(LEAST_BASE), vec3<f32>(1.0)), vec3<f32>(toe.w));
    let way = clamp((rgb - line.x) * shoulder.x, vec3<f32>(0.0), vec3<f32>(1.0));
    let high = shoulder.w - shoulder.z * exp(shoulder.y * log_rest(way));
    let straight = line.y * rgb + line.z;
    let curve = select(select(straight, high, rgb > vec3<f32>(line.x)), low, rgb < vec3<f32>(toe.x));
    return select(clamp(curve, vec3<f32>(0.0), vec3<f32>(1.0)), vec3<f32>(1.0), rgb >= vec3<f32>(line.w));
}

// ln(1 - t), by its series where 1 - t would lose the digits of t.
fn log_rest(t: vec3<f32>) -> vec3<f32> {
    let series = -t * (1.0 + t * (0.5 + t * (1.0 / 3.0 + t * (0.25 + t * 0.2))));
    return select(log(max(1.0 - t, vec3<f32>(LEAST_BASE))), series, t < vec3<f32>(0.0625));
}
