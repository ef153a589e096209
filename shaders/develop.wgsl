// Kernel: radiance of a tile to packed pixels. The curves are in film.wgsl.

@group(0) @binding(0) var<uniform> film: FilmParams;
@group(0) @binding(1) var<uniform> pass_: Pass;
@group(0) @binding(2) var radiance: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(8, 16)
fn develop_tile(@builtin(global_invocation_id) id: vec3<u32>) {
    if outside_tile(id.xy) {
        return;
    }
    put_pixel(id.xy, textureLoad(radiance, id.xy, 0));
}
