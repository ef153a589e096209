// Kernel: each cell of a grid gets its share of the light that the coarser grids spread, on top of what it spreads itself.

@group(0) @binding(0) var<uniform> level: BloomLevel;
@group(0) @binding(1) var finer: texture_2d<f32>;
@group(0) @binding(2) var coarser: texture_2d<f32>;
@group(0) @binding(3) var spread: texture_storage_2d<rgba16float, write>;

// What the coarser cells before a cell's own, its own, and after it give it, by the side of its own that it lies on.
fn shares(second_half: bool) -> vec3<f32> {
    return select(vec3<f32>(5.0, 10.0, 1.0), vec3<f32>(1.0, 10.0, 5.0), second_half) / 16.0;
}

fn row(columns: vec3<i32>, y: i32, across: vec3<f32>) -> vec3<f32> {
    return across.x * textureLoad(coarser, vec2<i32>(columns.x, y), 0).xyz
        + across.y * textureLoad(coarser, vec2<i32>(columns.y, y), 0).xyz
        + across.z * textureLoad(coarser, vec2<i32>(columns.z, y), 0).xyz;
}

@compute @workgroup_size(8, 16)
fn give_back(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= level.fine) {
        return;
    }
    let cell = vec2<i32>(id.xy) / 2;
    let before = max(cell - 1, vec2<i32>(0));
    let after = min(cell + 1, vec2<i32>(level.cells) - 1);
    let columns = vec3<i32>(before.x, cell.x, after.x);
    let across = shares((id.x & 1u) == 1u);
    let down = shares((id.y & 1u) == 1u);
    let returned = down.x * row(columns, before.y, across)
        + down.y * row(columns, cell.y, across)
        + down.z * row(columns, after.y, across);
    let light = level.own * textureLoad(finer, id.xy, 0).xyz + level.above * returned;
    textureStore(spread, id.xy, rounded_to_f16(vec4<f32>(light, 1.0)));
}
