// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: a level of the grid that holds the structure of a volume for a frame. Mirrors src/emit/baked.rs and
// src/emit/baking.rs, where the reasons are. Four columns a thread, as two words each with two halves.

#import constants
#import emit/filaments
#import shared/math

// A level of a grid. Mirrors `BakeUniform` of src/gpu/frame/uniforms/bake.rs.
struct BakeLevel {
    columns: u32,
    rows: u32,
    layers: u32,
    // The level of the filaments that are no finer than its texels.
    level: f32,
    // Where its first row and its first motion are, and how many motions a row has.
    first_row: u32,
    first_motion: u32,
    heights: u32,
    // Its first word, and words from row to row.
    begin: u32,
    row_words: u32,
    // `row_texels`, `row_size` and `layer_size` of BakeLevel in src/emit/baking.rs.
    row_texels: f32,
    row_size: f32,
    layer_size: f32,
    // The variance of each level of the filaments and of the next one; 0, 0.
    variances: array<vec4<f32>, FILAMENT_LEVELS>,
}

struct RowGeneration {
    scale: f32,
    age: f32,
    turn: f32,
    row: f32,
    layer: f32,
}

struct RowMotion {
    omega: f32,
    lean: f32,
}

@group(0) @binding(0) var<uniform> bake: BakeLevel;
@group(0) @binding(1) var<storage, read> generations_of_rows: array<RowGeneration>;
@group(0) @binding(2) var<storage, read> motions_of_rows: array<RowMotion>;
@group(0) @binding(3) var filaments: texture_3d<f32>;
@group(0) @binding(4) var filament_sampler: sampler;
@group(0) @binding(5) var<storage, read_write> baked_words: array<u32>;

fn filament_texel(place: vec3<f32>, level: f32) -> f32 {
    return textureSampleLevel(filaments, filament_sampler, place, level).x;
}

fn level_variances(level: u32) -> vec2<f32> {
    return bake.variances[level].xy;
}

// The level of the filaments that a generation of an age is made from.
fn bake_grain(motion: RowMotion, age: f32) -> f32 {
    let wound = SHEAR * abs(motion.omega) * age;
    let drawn = wound * bake.row_size;
    let along = sqrt(drawn * drawn + bake.row_texels * bake.row_texels);
    return max(log2(max(along, wound * motion.lean * bake.layer_size)), bake.level);
}

// The half float that is nearest to a factor; of two that are, the even one.
fn half_bits(factor: f32) -> u32 {
    let bits = bitcast<u32>(clamp(factor, LEAST_FACTOR, MOST_FACTOR));
    return (bits - (112u << 23u) + 0xfffu + ((bits >> 13u) & 1u)) >> 13u;
}

@compute @workgroup_size(8, 16)
fn bake_texels(@builtin(global_invocation_id) id: vec3<u32>) {
    let layer = id.y / bake.rows;
    let row = id.y % bake.rows;
    if 4u * id.x >= bake.columns || layer >= bake.layers {
        return;
    }
    let height_class = select(0u, min(layer, bake.layers - 1u - layer), bake.heights > 1u);
    let motion = motions_of_rows[bake.first_motion + row * bake.heights + height_class];
    let height = (f32(layer) + 0.5) / f32(bake.layers);
    let turns = (f32(4u * id.x) + vec4<f32>(0.5, 1.5, 2.5, 3.5)) / f32(bake.columns);
    var sum = vec4<f32>(0.0);
    for (var k = 0u; k < ROW_GENERATIONS; k += 1u) {
        let generation = generations_of_rows[ROW_GENERATIONS * (bake.first_row + row) + k];
        if generation.scale > 0.0 {
            let grain = bake_grain(motion, generation.age);
            let begin = generation.turn - motion.omega * generation.age / TAU;
            let x = turns + (begin - floor(begin));
            let z = height + generation.layer;
            let g = vec4<f32>(
                filament_value(vec3<f32>(x.x, generation.row, z), grain),
                filament_value(vec3<f32>(x.y, generation.row, z), grain),
                filament_value(vec3<f32>(x.z, generation.row, z), grain),
                filament_value(vec3<f32>(x.w, generation.row, z), grain),
            );
            let lost = filament_log_mean(generation.scale * sqrt(filament_variance(grain)));
            sum += generation.scale * g - lost;
        }
    }
    let factors = exp(sum);
    let at = bake.begin + id.y * bake.row_words + 2u * id.x;
    baked_words[at] = half_bits(factors.x) | (half_bits(factors.y) << 16u);
    baked_words[at + 1u] = half_bits(factors.z) | (half_bits(factors.w) << 16u);
}
