// Shades and develops the only sample of a tile's pixels.

fn take_record(id: vec2<u32>, record: Record) {
    put_pixel(id, shade_record(id, record));
}
