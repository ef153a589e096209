// Kernel: radiance of a tile to packed pixels, rows without gaps. The curves are in film.wgsl.

@group(0) @binding(0) var<uniform> film: FilmParams;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(0) @binding(2) var radiance: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(16, 8)
fn develop_tile(@builtin(global_invocation_id) id: vec3<u32>) {
    let tile = pass_.size - 2u;
    if id.x >= tile.x || id.y >= tile.y {
        return;
    }
    let i = id.y * tile.x + id.x;
    let place = vec2<u32>(pass_.origin + vec2<i32>(id.xy) + 1);
    let words = develop(textureLoad(radiance, id.xy, 0), place.x, place.y);
    switch film.format {
        case FORMAT_RGBA16F: {
            pixels[2u * i] = words.x;
            pixels[2u * i + 1u] = words.y;
        }
        case FORMAT_RGBA32F: {
            for (var k = 0u; k < 4u; k++) {
                pixels[4u * i + k] = words[k];
            }
        }
        default: {
            pixels[i] = words.x;
        }
    }
}
