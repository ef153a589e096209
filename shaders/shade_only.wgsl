// Kernel: shades and develops the only sample of a tile's pixels.

@group(0) @binding(4) var<uniform> film: FilmParams;
@group(0) @binding(5) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(16, 8)
fn shade_only(@builtin(global_invocation_id) id: vec3<u32>) {
    if outside_tile(id.xy) {
        return;
    }
    put_pixel(id.xy, shade_pixel(id.xy));
}
