// SPDX-License-Identifier: MIT OR Apache-2.0
// Shades a pixel's record, and lists the pixel if edges run through it. take_light takes the light of the tile's pixel
// `id`; where it is called a second time, that light takes the place of the first.

#import camera/projection
#import records/record
#import records/edges
#import shade/shade
#import shared/pass
#requires fn next_crossing() -> Crossing
#requires fn with_sky(record: Record) -> Record
#requires fn edges_of_pixel(through: f32, turn: f32) -> u32
#requires fn take_light(id: vec2<u32>, light: vec4<f32>)

fn take_record(id: vec2<u32>, record: Record) {
    take_light(id, shade_record(id, record));
    if REFINES && has_look_direction(pixel_place(id)) {
        note_edges(id, edges_of_pixel(seen_through, seen_turn));
    }
}

fn seen_crossing() -> Crossing {
    var crossing = next_crossing();
    crossing.share = disk_covers(crossing.u);
    return crossing;
}

fn seen_emission(here: Record, crossing: Crossing, open: f32) -> vec4<f32> {
    return crossing_emission(here, crossing, open);
}

fn lit_crossing(crossing: Crossing) -> Crossing {
    return crossing;
}

fn seen_sky(here: Record) -> Record {
    return with_sky(here);
}
