// Kernel: shades one of several samples of a tile's pixels and adds it to the sum of those before.

// Of the tile: the sum of the samples before, and with this one.
@group(0) @binding(4) var radiance_before: texture_2d<f32>;
@group(0) @binding(5) var radiance: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(16, 8)
fn shade_sample(@builtin(global_invocation_id) id: vec3<u32>) {
    if outside_tile(id.xy) {
        return;
    }
    var sum = shade_pixel(id.xy) * pass_.weight;
    if pass_.first == 0u {
        sum += textureLoad(radiance_before, id.xy, 0);
    }
    textureStore(radiance, id.xy, sum);
}
