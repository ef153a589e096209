// Kernel: light of a tile to pixels. The curves are in film.wgsl; whose light it is, in summed.wgsl or glare.wgsl.

@group(0) @binding(0) var<uniform> pass_: Pass;

@compute @workgroup_size(8, 16)
fn develop_tile(@builtin(global_invocation_id) id: vec3<u32>) {
    zero = id.z;
    if outside_tile(id.xy) {
        return;
    }
    put_pixel(id.xy, tile_light(id.xy));
}
