// SPDX-License-Identifier: MIT OR Apache-2.0
// The uniform `film`, which says how pixels are developed; the fragment that writes the pixels binds it. Mirrors
// `FilmParams` of src/film/mod.rs.

#requires var film: FilmParams

struct FilmParams {
    exposure: f32,
    tone_map: u32,
    format: u32,
    false_colour: u32,
    view_low: f32,
    view_scale: f32,
    transparent: u32,
    colour_map: u32,
    graded: u32,
    contrast: f32,
    contrast_factor: f32,
    saturation: f32,
    vignette_centre: vec2<f32>,
    vignette_scale: f32,
    vignette: f32,
    white_balance: mat3x3<f32>,
    grain: f32,
    grain_cells: f32,
    grain_seed: u32,
    unused: u32,
    filmic_toe: vec4<f32>,
    filmic_line: vec4<f32>,
    filmic_shoulder: vec4<f32>,
    lut_low: vec3<f32>,
    lut_side: u32,
    lut_scale: vec3<f32>,
    lut_strength: f32,
}
