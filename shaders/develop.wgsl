// Kernel: radiance of a tile to pixels. The curves are in film.wgsl.

@group(0) @binding(0) var<uniform> pass_: Pass;
@group(1) @binding(0) var radiance: texture_2d<f32>;

@compute @workgroup_size(8, 16)
fn develop_tile(@builtin(global_invocation_id) id: vec3<u32>) {
    if outside_tile(id.xy) {
        return;
    }
    put_pixel(id.xy, textureLoad(radiance, id.xy, 0));
}
