// Shades and develops the only sample of a tile's pixels.

fn take_record(id: vec2<u32>, record: Record) {
    put_pixel(id, shade_record(id, record));
    if SHOWS_LIGHT && has_look(pixel_place(id)) {
        note_edges(id, edges_of_pixel(seen_through));
    }
}

fn seen_crossing() -> Crossing {
    var crossing = next_crossing();
    crossing.share = 1.0;
    return crossing;
}
