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
}
