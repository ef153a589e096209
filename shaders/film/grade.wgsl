// SPDX-License-Identifier: MIT OR Apache-2.0
// The grade of exposed light. Mirrors src/film/grade.rs, where the formulas and sources are.

#import constants
#import film/colour_map
#import film/params

// Exposed light at a pixel of the whole frame.
fn graded(scene: vec3<f32>, x: u32, y: u32) -> vec3<f32> {
    let d = vec2<f32>(f32(x), f32(y)) + 0.5 - film.vignette_centre;
    let cos2 = 1.0 / (1.0 + film.vignette_scale * dot(d, d));
    let lens = 1.0 + film.vignette * (cos2 * cos2 - 1.0);
    let balanced = max(film.white_balance * (scene * lens), vec3<f32>(LEAST_BASE));
    let contrasted = film.contrast_factor * pow(balanced, vec3<f32>(film.contrast));
    let grey = luminance(contrasted);
    let coloured = grey + film.saturation * (contrasted - grey);
    return clamp(coloured, vec3<f32>(0.0), vec3<f32>(MAX_SCENE_LIGHT));
}
