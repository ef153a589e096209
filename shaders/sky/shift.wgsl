// SPDX-License-Identifier: MIT OR Apache-2.0
// The light of sky maps under frequency shifts. Mirrors src/sky/shift.rs, where the formulas and reasons are.

#import constants
#requires fn light_table(i: u32) -> vec4<f32>

// (m / g)^(1/4) of the channels of light of this colour, between the nodes. g > 0.
fn shift_root(colour: f32, g: f32) -> vec3<f32> {
    const COLUMNS = f32(SHIFT_COLOURS - 1u) / (HOTTEST_COLOUR - COOLEST_COLOUR);
    let x = clamp((colour - COOLEST_COLOUR) * COLUMNS, 0.0, f32(SHIFT_COLOURS - 1u));
    let y = (1.0 - 1.0 / (1.0 + g)) * SHIFT_SCALE;
    let column = min(u32(x), SHIFT_COLOURS - 2u);
    let row = u32(y);
    let share = vec2<f32>(x - f32(column), y - f32(row));
    let first = SHIFT_TABLE + row * SHIFT_COLOURS + column;
    let a = light_table(first).xyz;
    let b = light_table(first + 1u).xyz;
    let c = light_table(first + SHIFT_COLOURS).xyz;
    let d = light_table(first + SHIFT_COLOURS + 1u).xyz;
    let above = a + (b - a) * share.x;
    let below = c + (d - c) * share.x;
    return above + (below - above) * share.y;
}

fn shifted_map_light(rgb: vec3<f32>, g_colour: f32, g_beaming: f32) -> vec3<f32> {
    // Most of the Milky Way is black.
    if all(rgb == vec3<f32>(0.0)) || !(g_colour > 0.0 && g_beaming > 0.0) {
        return vec3<f32>(0.0);
    }
    let red = sqrt(max(rgb.x, TINY_LIGHT));
    let blue = sqrt(max(rgb.z, TINY_LIGHT));
    let root = shift_root(blue / (red + blue), g_colour);
    let beaming = min(g_beaming / g_colour, MAX_BEAMING);
    let gain = (beaming * beaming) * (beaming * beaming);
    let root2 = root * root;
    let factor = min(root2 * root2 * (min(g_colour, MAX_BEAMING) * gain), vec3<f32>(MAX_RATIO));
    return min(rgb * factor, vec3<f32>(MAX_MAP_LIGHT));
}
