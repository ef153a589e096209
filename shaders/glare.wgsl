// The light that develop.wgsl and develop_rows.wgsl take in frames with bloom: what is left in a pixel of its own, and its share of what
// spreads over the finest grid.

// Pixels along a cell's side, even.
override STEP: i32 = 2;

@group(1) @binding(0) var exposed_light: texture_2d<f32>;
@group(1) @binding(1) var glare: texture_2d<f32>;
@group(1) @binding(2) var<uniform> level: BloomLevel;

fn tile_light(id: vec2<u32>) -> vec4<f32> {
    let place = pass_.origin + vec2<i32>(id) + 1;
    let light = textureLoad(exposed_light, place - pass_.light_origin, 0);
    // Between the centres of two cells; at the border both are the same.
    let cell = place / STEP;
    let within = place - cell * STEP;
    let before = within < vec2<i32>(STEP / 2);
    let first = max(select(cell, cell - 1, before), vec2<i32>(0));
    let second = min(select(cell + 1, cell, before), vec2<i32>(level.cells) - 1);
    let share = (vec2<f32>(within) + 0.5) / f32(STEP) + select(vec2<f32>(-0.5), vec2<f32>(0.5), before);
    let top = mix(textureLoad(glare, first, 0), textureLoad(glare, vec2<i32>(second.x, first.y), 0), share.x);
    let bottom = mix(textureLoad(glare, vec2<i32>(first.x, second.y), 0), textureLoad(glare, second, 0), share.x);
    return vec4<f32>(level.own * light.xyz + level.above * mix(top, bottom, share.y).xyz, light.w);
}
