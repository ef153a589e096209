// Shades and develops the only sample of a tile's pixels. (Uniforms of group 2 come after those of a lens: the other way round
// Mesa 22.3's lavapipe crashes.)

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var<storage, read_write> pixels: array<u32>;

fn take_record(id: vec2<u32>, record: Record) {
    put_pixel(id, shade_record(id, record));
}
