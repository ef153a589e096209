// SPDX-License-Identifier: MIT OR Apache-2.0
// False colour for views other than light. Mirrors src/film/false_colour.rs, where the formulas, sources and reasons
// are.

#import constants
#import film/encode
#import film/params

// The sRGB-encoded colour of a view's value.
fn false_colour(value: f32) -> vec3<f32> {
    let share = clamp((scaled(value) - film.view_low) * film.view_scale, 0.0, 1.0);
    let lab = select(sequential(share), diverging(share), film.false_colour == VIEW_REDSHIFT);
    return select(lab_encoded(lab), vec3<f32>(0.5), is_nan(vec3<f32>(value)));
}

// A view's value as its colours are spread: by itself, by its logarithm, or as METRIC has it.
fn scaled(value: f32) -> f32 {
    let spread = select(log2(max(value, 1e-9)), value, film.false_colour == VIEW_ORDER);
    return select(spread, 1.0 - sqrt(1.0 - min(value, 1.0)), film.false_colour == VIEW_METRIC);
}

fn sequential(share: f32) -> vec3<f32> {
    let turn = 4.76 + 3.78 * share;
    return vec3<f32>(15.0 + 76.0 * share, 11.0 + 56.0 * cos(turn), 21.0 + 56.0 * sin(turn));
}

fn diverging(share: f32) -> vec3<f32> {
    let arm = 2.0 * share - 1.0;
    let end = select(vec2<f32>(52.0, 33.77), vec2<f32>(21.21, -58.26), arm > 0.0);
    let distance = abs(arm);
    return vec3<f32>(95.0 - 57.0 * distance, end * distance);
}

fn lab_encoded(lab: vec3<f32>) -> vec3<f32> {
    let y = (lab.x + 16.0) / 116.0;
    let t = vec3<f32>(y + lab.y / 500.0, y, y - lab.z / 200.0);
    let xyz = select((t - 16.0 / 116.0) * (108.0 / 841.0), t * t * t, t > vec3<f32>(6.0 / 29.0));
    let rgb = vec3<f32>(
        dot(vec3<f32>(3.080399, -1.5373832, -0.5430159), xyz),
        dot(vec3<f32>(-0.9212234, 1.8759675, 0.0452559), xyz),
        dot(vec3<f32>(0.0528739, -0.203977, 1.151103), xyz),
    );
    return srgb_encode(clamp(rgb, vec3<f32>(0.0), vec3<f32>(1.0)));
}
