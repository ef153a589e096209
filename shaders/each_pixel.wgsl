// Kernel: makes the record of each pixel of a tile and has it taken.

@compute @workgroup_size(8, 16)
fn each_pixel(@builtin(global_invocation_id) id: vec3<u32>) {
    if outside_tile(id.xy) {
        return;
    }
    let record = ray_record(id.xy);
    if record.fate == FATE_PENDING {
        defer_pixel(id.xy);
    } else {
        take_record(id.xy, record);
    }
}
