// Shades and develops the only sample of a tile's pixels.

@group(0) @binding(4) var<uniform> film: FilmParams;
@group(0) @binding(5) var<storage, read_write> pixels: array<u32>;

fn take_record(id: vec2<u32>, record: Record) {
    put_pixel(id, shade_record(id, record));
}
