// Kernel: does what records/each_pixel.wgsl does, for film/packed_rows.wgsl.

#import constants
#import film/packed_rows
#import records/record
#import shared/not_inlined
#import shared/fate
#import shared/pass
#requires fn ray_record(id: vec2<u32>) -> Record
#requires fn defer_pixel(id: vec2<u32>)
#requires fn take_record(id: vec2<u32>, record: Record)

// 32 threads that run together take 8 x 4 pixels that lie together; four times 32 take the 32 x 4 of a workgroup.
@compute @workgroup_size(32, 4)
fn each_pixel(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) i: u32) {
    unknown_zero = group.z;
    let x = (i & 3u) | ((i >> 1u) & 4u) | ((i >> 2u) & 24u);
    let y = ((i >> 2u) & 1u) | ((i >> 3u) & 2u);
    let corner = group.xy * vec2<u32>(ROWS_WIDTH, ROWS_PIXELS / ROWS_WIDTH);
    let id = corner + vec2<u32>(x, y);
    rows_index = y * ROWS_WIDTH + x;
    keep_words(vec4<u32>(0u));
    if !outside_tile(id) {
        let record = ray_record(id);
        if record.fate == FATE_PENDING {
            defer_pixel(id);
        } else {
            take_record(id, record);
        }
    }
    workgroupBarrier();
    write_rows(corner, i);
}
