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
    let coloured = (grey + film.saturation * (contrasted - grey)) * (1.0 + film.grain * grain_noise(x, y));
    return clamp(coloured, vec3<f32>(0.0), vec3<f32>(MAX_SCENE_LIGHT));
}

fn grain_noise(x: u32, y: u32) -> f32 {
    let place = (vec2<f32>(f32(x), f32(y)) + 0.5) * film.grain_cells;
    let corner = floor(place);
    let f = place - corner;
    let cell = vec2<u32>(corner);
    let left = vec2<f32>(grain_cell(cell.x, cell.y), grain_cell(cell.x, cell.y + 1u));
    let right = vec2<f32>(grain_cell(cell.x + 1u, cell.y), grain_cell(cell.x + 1u, cell.y + 1u));
    let rows = left + f.x * (right - left);
    let sum = rows.x + f.y * (rows.y - rows.x);
    let squares = 1.0 - 2.0 * f * (1.0 - f);
    return sum / sqrt(squares.x * squares.y);
}

fn grain_cell(x: u32, y: u32) -> f32 {
    let code = hash(x ^ hash(y ^ film.grain_seed)) >> 8u;
    return (f32(code) + 0.5) * GRAIN_SCALE - GRAIN_REACH;
}

fn hash(value: u32) -> u32 {
    let once = (value ^ (value >> 16u)) * 0x7feb352du;
    let twice = (once ^ (once >> 15u)) * 0x846ca68bu;
    return twice ^ (twice >> 16u);
}
