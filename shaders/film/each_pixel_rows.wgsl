// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: makes the record of each pixel of a tile and hands it to take_record, as records/each_pixel.wgsl does; but a
// workgroup gathers its 32 x 4 pixels and writes them row by row, which is faster where the pixels lie in the host's
// memory (film/packed_rows.wgsl says by how much).

#import constants
#import film/packed_rows
#import records/record
#import shared/not_inlined
#import shared/fate
#import shared/pass
#requires fn ray_record(id: vec2<u32>) -> Record
#requires fn defer_pixel(id: vec2<u32>)
#requires fn take_record(id: vec2<u32>, record: Record)

// Thread i does not take pixel (i % 32, i / 32): each 32 consecutive threads, which a GPU runs together, take a block
// of 8 x 4 neighbouring pixels, whose rays take much the same steps. Four such blocks side by side are the workgroup's
// 32 x 4 pixels.
@compute @workgroup_size(32, 4)
fn each_pixel(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) i: u32) {
    unknown_zero = group.z;
    let x = (i & 3u) | ((i >> 1u) & 4u) | ((i >> 2u) & 24u);
    let y = ((i >> 2u) & 1u) | ((i >> 3u) & 2u);
    let corner = group.xy * vec2<u32>(ROWS_WIDTH, ROWS_PIXELS / ROWS_WIDTH);
    let id = corner + vec2<u32>(x, y);
    rows_index = y * ROWS_WIDTH + x;
    // Deferred pixels are written by a later kernel; until then their words are 0.
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
